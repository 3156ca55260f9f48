//! Models as texts of the languages that they are read from.
//!
//! A [`plan`] puts the operations of a model in order and finds those that are read more than once; they become
//! variables. HyperFun and formulas share the writer of [`expression`]s and differ in how they spell what is not
//! arithmetic; a `.vm` program is one line for each operation. Numbers are written so that they read back exactly.

mod expression;
mod formula;
mod hyperfun;
mod plan;
mod substitute;
mod vm;

use crate::model::{Model, Parameter};
use crate::presentation::Presentation;
use fieldstone_field::{Graph, Input, NodeId};
use std::fmt;

/// A language that models are written in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Syntax {
    /// HyperFun: F ≥ 0 inside.
    HyperFun,
    /// A formula: f < 0 inside.
    Formula,
    /// A `.vm` program: f < 0 inside.
    Vm,
}

impl fmt::Display for Syntax {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Syntax::HyperFun => "HyperFun",
            Syntax::Formula => "a formula",
            Syntax::Vm => "a .vm program",
        })
    }
}

/// A model as a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Printed {
    /// The text.
    pub text: String,
    /// What of the model is not in it, or not as it was.
    pub warnings: Vec<String>,
}

/// Why a model has no text in a language.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum PrintError {
    /// A loop that is still one after reading.
    #[error("{0} cannot say it: the model has a loop, and how often it turns depends on the point")]
    Loop(Syntax),
    /// A function that is called as a whole.
    #[error("{syntax} cannot say it: the model calls {name}, which has no closed form{}", elsewhere(name))]
    Function {
        /// What the function is called.
        name: &'static str,
        /// The language.
        syntax: Syntax,
    },
    /// A coordinate beyond those that the language has names for.
    #[error(
        "{syntax} cannot say it: the model depends on coordinate {number} (fix it with --coord {number}=V)"
    )]
    Coordinate {
        /// The coordinate, counted from 1.
        number: usize,
        /// The language.
        syntax: Syntax,
    },
}

/// Where a function can be said that has no closed form.
fn elsewhere(name: &str) -> &'static str {
    if name.starts_with("hf") { " (HyperFun has it: write a .hf file)" } else { "" }
}

/// Writes a model in a language.
///
/// `fixed` gives inputs of which only this value is wanted: they become constants. Where the language has parameters
/// they stay ones, under their names if it has names for them; a `.vm` program has their defaults. HyperFun has no
/// defaults: its parameters are 0 unless set, and a comment says what they were. The time is an input of formulas, 0 in
/// HyperFun. Attributes are kept in HyperFun only. Coordinates stay what they are: nothing is turned, though y is up in
/// HyperFun and z in the others.
///
/// Read again, the text gives the same values but for rounding in operations that the language has to compose.
///
/// ```
/// use fieldstone_lang::{Source, Syntax, parse_formula, print_model};
///
/// let ball = parse_formula(&Source::new("ball", "r = 2; x^2 + y^2 + z^2 - r^2"))?;
/// let printed = print_model(&ball, Syntax::Formula, &[])?;
/// assert_eq!(printed.text, "r = 2;\nx^2 + y^2 + z^2 - r^2\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// What the language has no words for, see [`PrintError`].
pub fn print_model(model: &Model, syntax: Syntax, fixed: &[(Input, f64)]) -> Result<Printed, PrintError> {
    let lost = lost(model, syntax, fixed);
    let all: Vec<(Input, f64)> = fixed.iter().copied().chain(lost.iter().map(|(input, ..)| *input)).collect();
    let substituted = if all.is_empty() { None } else { Some(substitute::substitute(model, syntax, &all)?) };
    let printing = Printing { model: substituted.as_ref().unwrap_or(model), syntax };
    let printed = match syntax {
        Syntax::HyperFun => hyperfun::print(&printing)?,
        Syntax::Formula => formula::print(&printing)?,
        Syntax::Vm => vm::print(&printing)?,
    };
    let mut warnings: Vec<String> = lost.into_iter().map(|(_, warning)| warning).collect();
    warnings.extend(printing.lost_attributes());
    if model.presentation != Presentation::default() {
        warnings.push(
            "how the file wants it shown is left out: view, colours, lights, what is cut off".to_owned(),
        );
    }
    warnings.extend(printed.warnings);
    Ok(Printed { text: printed.text, warnings })
}

/// The inputs for which the language has no words and which are not fixed, with the values that they get and the
/// warnings about that.
fn lost(model: &Model, syntax: Syntax, fixed: &[(Input, f64)]) -> Vec<((Input, f64), String)> {
    let is_open = |input: Input| !fixed.iter().any(|(known, _)| *known == input);
    match syntax {
        Syntax::Formula => Vec::new(),
        Syntax::HyperFun => {
            let is_lost = is_open(Input::Time) && model.field.inputs().contains(&Input::Time);
            let warning = "the time is 0 now: HyperFun has none".to_owned();
            if is_lost { vec![((Input::Time, 0.0), warning)] } else { Vec::new() }
        }
        Syntax::Vm => {
            let open = model.parameters.iter().filter(|p| is_open(p.input));
            let warning =
                |p: &Parameter| format!("the parameter {} is the constant {} now", p.name, p.default);
            open.map(|p| ((p.input, p.default), warning(p))).collect()
        }
    }
}

/// What is printed.
struct Printing<'m> {
    model: &'m Model,
    syntax: Syntax,
}

impl<'m> Printing<'m> {
    fn graph(&self) -> &'m Graph {
        self.model.field.graph()
    }

    /// The outputs: the value, and the attributes where the language has them.
    fn outputs(&self) -> Vec<NodeId> {
        let attributes = match self.syntax {
            Syntax::HyperFun if self.model.has_attributes => self.model.field.attributes(),
            _ => &[],
        };
        [&[self.model.field.value()], attributes].concat()
    }

    /// The warning for a model whose attributes the language has no words for.
    fn lost_attributes(&self) -> Option<String> {
        let has_attributes = self.model.has_attributes && !self.model.field.attributes().is_empty();
        let lost = has_attributes && self.syntax != Syntax::HyperFun;
        lost.then(|| format!("the attributes are left out: {} has none", self.syntax))
    }

    fn unknown_coordinate(&self, index: u16) -> PrintError {
        PrintError::Coordinate { number: usize::from(index) + 1, syntax: self.syntax }
    }
}

/// A number in the shortest form that reads back exactly; it may begin with a sign. Not for what is not finite.
fn shortest(value: f64) -> String {
    let is_plain = value.fract() == 0.0 && value.abs() < 1e16;
    if is_plain { format!("{value}") } else { format!("{value:?}") }
}
