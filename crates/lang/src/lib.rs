//! Front ends of Fieldstone: HyperFun files, formulas, `.vm` programs and SURFER's `.jsurf` files become field programs.
//!
//! Every front end turns a [`Source`] into a [`Model`] or into [`Diagnostics`] that show file, line, column, a caret
//! and what to do. [`print_model`] goes the other way. All deliver fields that are negative inside, whatever the sign of the file.

mod diagnostic;
mod formula;
mod hyperfun;
mod jsurf;
mod model;
mod presentation;
mod print;
mod suggest;
mod vm;

pub use diagnostic::{Diagnostic, Diagnostics, Severity, Source};
pub use formula::parse_formula;
pub use hyperfun::{HyperFunOptions, Signature, hyperfun_functions, parse_hyperfun};
pub use jsurf::parse_jsurf;
pub use model::{FileSign, Model, Object, Parameter, UpAxis};
pub use presentation::{Finish, Lamp, Lens, Presentation, Viewpoint};
pub use print::{PrintError, Printed, Syntax, print_model};
pub use vm::parse_vm;

/// Which meaning HyperFun texts have where mathematics and the C interpreter differ.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Dialect {
    /// Mathematics: what the text says.
    #[default]
    Lenient,
    /// The C interpreter's values.
    Strict,
}
