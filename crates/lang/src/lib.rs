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
///
/// | | lenient | strict |
/// |---|---|---|
/// | numbers below 10⁻⁶ | are numbers | count as 0 in divisions, powers, `=` and conditions |
/// | an undefined value | counts where it is used | makes the whole point undefined, used or not |
/// | `sign`, `mod`, `hfA_Cerp`, `hfA_LookUpTable`, `hfA_Circles`, `hfA_Crackles` | as documented | as in C |
/// | `hfFMapBlob`, `hfCylX`, `hfCylY`, `hfCylZ` | functions | names like any other |
/// | arithmetic behind a parenthesis that begins a condition, `(x[1]+1)*2 > 3` | is read | is an error |
/// | `01`, `1e05`, carriage returns, empty statements | are read | are errors |
/// | arrays declared after statements, or of computed length; literals with expressions | are read | are errors |
/// | assignments to `x[i]` and `a[i]`, several of the object's value | are read | are errors |
/// | calls of objects further down, and recursion | are followed | are errors |
///
/// In nothing else do they differ. `1e-12` is 10⁻¹² in both, although the C interpreter's scanner makes 10⁻⁸ of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Dialect {
    /// Mathematics: what the text says.
    #[default]
    Lenient,
    /// The C interpreter's values.
    Strict,
}
