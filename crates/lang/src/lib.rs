//! Front ends of Fieldstone: HyperFun files, formulas and `.vm` programs become field programs.
//!
//! Every front end turns a [`Source`] into a [`Model`] or into [`Diagnostics`] that show file, line, column, a caret
//! and what to do. All deliver fields that are negative inside, whatever the sign of the file.

mod diagnostic;
mod formula;
mod hyperfun;
mod model;
mod suggest;
mod vm;

pub use diagnostic::{Diagnostic, Diagnostics, Severity, Source};
pub use formula::parse_formula;
pub use hyperfun::{HyperFunOptions, Signature, hyperfun_functions, parse_hyperfun};
pub use model::{FileSign, Model, Object, Parameter, UpAxis};
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
