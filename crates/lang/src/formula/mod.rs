//! Formulas, as given on the command line, in `.txt` files and in scene files.
//!
//! Words ([`lexer`]) become a tree with every name resolved ([`parser`] for statements, [`expression`] for what stands
//! in them), and the tree a field program ([`lower`]). The parser keeps its own stack and the tree is a list in which
//! operands stand before what reads them, so that neither long sums nor deep nesting can exhaust the thread's stack.
//!
//! A `|` closes an absolute value where one was opened last and a value stands before it; otherwise it opens one. A
//! `||` is `or` after a value outside of absolute values, otherwise two `|`.

mod expression;
mod functions;
mod lexer;
mod lower;
mod names;
mod parser;
mod tree;

#[cfg(test)]
mod tests;

use crate::diagnostic::{Diagnostic, Diagnostics, Source};
use crate::model::{Model, Parameter};
use fieldstone_field::{Field, Input};

/// Reads a formula: `x^2 + y^2 + z^2 - 1`.
///
/// A formula is a function that is negative inside, or an equation `f = g`, which means f − g. Before it stand
/// definitions: `r = 5;` (or `let r = 5;`) gives a name a value. A value that depends on nothing is the default of a
/// parameter; any other is an abbreviation.
///
/// | operations, from the loosest to the tightest | |
/// |---|---|
/// | `or` `\|\|` | 1 or 0; the right side counts only where the left is 0 |
/// | `and` `&&` | 1 or 0; the right side counts only where the left is not 0 |
/// | `not` `!` | 1 or 0 |
/// | `<` `<=` `>` `>=` `==` `!=` | 1 or 0; no chains |
/// | `+` `-` | from left to right |
/// | `*` `/` and nothing at all | from left to right: `1/2x` is (1/2)·x |
/// | `-` before its operand | `-x^2` is −(x²) |
/// | `^` `**` | from right to left; `2^-1` may be written |
/// | `x²`, calls, `( )`, `\|x\|` | |
///
/// The coordinates are x, y, z and w, the time is t; `pi` and `e` are the constants. Functions are `sin`, `cos`, `tan`
/// and their inverses (`asin` or `arcsin`, …), `atan2(y, x)`, `sinh`, `cosh`, `tanh` and their inverses, `exp`, `log`
/// (natural, also `ln`), `log10`, `log2`, `sqrt`, `cbrt`, `square`, `pow`, `abs`, `sign`, `floor`, `ceil`, `round`,
/// `trunc`, `frac`, `mod` (never negative), `min`, `max`, `length` (also `hypot`), `clamp(x, a, b)`, `mix(a, b, t)`,
/// `step(a, x)`, `smoothstep(a, b, x)`, `if(condition, a, b)`, and the set operations of R-functions `runion`, `rinter`
/// and `rsub`. `#` and `//` begin comments.
///
/// The model has the sign f < 0 inside, z up, and three coordinates (four if its value depends on w). Its parameters
/// are the definitions with a constant value, in the order of the text.
///
/// ```
/// use fieldstone_field::Bindings;
/// use fieldstone_lang::{Source, parse_formula};
///
/// let model = parse_formula(&Source::new("sphere", "r = 2; x² + y² + z² = r²"))?;
/// assert_eq!(model.parameters[0].default, 2.0);
/// let mut bindings = Bindings::new();
/// bindings.set(model.parameters[0].input, 3.0);
/// assert_eq!(model.field.at(&[1.0, 0.0, 0.0], &bindings), [-8.0]);
/// # Ok::<(), fieldstone_lang::Diagnostics>(())
/// ```
///
/// # Errors
/// What cannot be read: one syntax error for each statement, and every other error, up to a limit.
pub fn parse_formula(source: &Source) -> Result<Model, Diagnostics> {
    let how_to_define = |name: &str| format!("give it a value: `{name} = 1; …`");
    let setting = Setting { parameters: &[], how_to_define };
    let (field, parameters) =
        parse_in(&source.text, &setting).map_err(|errors| Diagnostics::in_order(source, errors))?;
    let varies = field.inputs().iter().any(|input| matches!(input, Input::Coordinate(_)));
    let warnings = if varies { Vec::new() } else { vec![constant_formula(&source.text)] };
    Ok(Model::plain("formula", field, parameters, warnings))
}

/// What a formula may take for granted.
pub(crate) struct Setting<'a> {
    /// Names with their defaults; they hide what is built in, and become the first parameters.
    pub(crate) parameters: &'a [(String, f64)],
    /// The help for a name without a meaning: how to give it one.
    pub(crate) how_to_define: fn(&str) -> String,
}

/// The field and the parameters of a formula in a setting; the places of errors are those in `text`.
pub(crate) fn parse_in<'a>(
    text: &'a str,
    setting: &Setting<'a>,
) -> Result<(Field, Vec<Parameter>), Vec<Diagnostic>> {
    Ok(lower::lower(&parser::parse(text, setting)?))
}

/// Whether a text is a name that a formula can define.
pub(crate) fn is_definable(name: &str) -> bool {
    let (words, errors) = lexer::words(name);
    let is_name = matches!(words.as_slice(), [word, _] if word.token == lexer::Token::Name && word.span == (0..name.len()));
    is_name
        && errors.is_empty()
        && names::built_in(name).is_none()
        && functions::Function::named(name).is_none()
}

fn constant_formula(text: &str) -> Diagnostic {
    Diagnostic::warning(
        0..text.trim_end().len(),
        "the formula is the same everywhere",
        "depends on no coordinate",
    )
    .with_help("a solid needs a function of x, y, z that is negative inside: `x^2 + y^2 + z^2 - 1`")
}
