//! HyperFun: a language for solids as functions of the point.
//!
//! A file holds *objects*, real functions of coordinates x\[\], parameters a\[\] and attributes s\[\]; the solid is
//! where the value is ≥ 0. The way of a text: `lexer` → `parser` and `expression` (names resolved, calls checked,
//! expressions as postfix code) → `lower` (the program is followed symbolically, which leaves a graph).
//!
//! The language is that of the C interpreter with its operator levels (set operators share one with `+` and `-`,
//! signs bind tightest, powers are read from the left), and more leniently written: arrays may be declared anywhere,
//! coordinates assigned, the value assigned several times, and objects may call themselves. [`Dialect::Strict`] takes
//! back both the leniency and the mathematics, see there.
//!
//! Objects are written out where they are called. So the end of a recursion, and the length of an array, must follow from
//! numbers: what depends on the point or on parameters is an error. Loops have no such limits.
//!
//! Texts are not trusted: words, depth, operations and steps have limits, which are errors.

mod arrays;
mod ast;
mod builtins;
mod calls;
mod counted;
mod expression;
mod hints;
mod lexer;
pub(crate) mod library;
mod limits;
mod loops;
mod lower;
mod operators;
mod parser;
mod report;
mod signature;
mod state;
mod strict;

pub use signature::{Signature, hyperfun_functions};

use crate::Dialect;
use crate::diagnostic::{Diagnostic, Diagnostics, Source};
use crate::model::{FileSign, Model, Object, Parameter, UpAxis};
use crate::presentation::Presentation;
use crate::suggest;
use fieldstone_field::{Field, Input};
use loops::LoopLimits;
use lower::Lowered;
use report::{Report, Span};

/// How to read a HyperFun file.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct HyperFunOptions {
    /// The object to draw; if none is given, `my_model`, or the first object. Letter case means nothing.
    pub object: Option<String>,
    /// Whose values are wanted.
    pub dialect: Dialect,
}

/// Reads a HyperFun file.
///
/// The model's field is −F of the chosen object, so that it is negative inside; its attributes are s\[\] if the
/// object declares them. Undefined values are NaN.
///
/// # Errors
/// All that is wrong with the text, each with its place, up to a limit.
pub fn parse_hyperfun(source: &Source, options: &HyperFunOptions) -> Result<Model, Diagnostics> {
    let mut report = Report::default();
    match read(&source.text, options, LoopLimits::default(), &mut report) {
        Some(model) if !report.has_errors() => Ok(Model { warnings: report.into_list(), ..model }),
        _ => Err(Diagnostics { source: source.clone(), list: report.into_list() }),
    }
}

/// The model; `None` only after an error.
fn read(text: &str, options: &HyperFunOptions, limits: LoopLimits, report: &mut Report) -> Option<Model> {
    if u32::try_from(text.len()).is_err() {
        report.error(Span::new(0, 0), "the file is larger than 4 GiB", "too large");
        return None;
    }
    let (tokens, names) = lexer::tokenize(text, options.dialect, report)?;
    let objects = parser::parse(text, tokens, names, options.dialect, report);
    if report.has_errors() {
        return None;
    }
    let chosen = choose(&objects, options.object.as_deref(), report)?;
    let lowered = lower::lower(&objects, chosen, (options.dialect, limits), report).ok()?;
    if report.has_errors() {
        return None;
    }
    Some(model(&objects, chosen, lowered, report))
}

/// The number of the object to draw.
fn choose(objects: &[ast::Object], wanted: Option<&str>, report: &mut Report) -> Option<usize> {
    let find = |name: &str| objects.iter().position(|o| o.name == name);
    let Some(wanted) = wanted else {
        return find("my_model").or(Some(0));
    };
    let wanted = wanted.to_ascii_lowercase();
    let found = find(&wanted);
    if found.is_none() {
        let names = || objects.iter().map(|o| o.name.as_str());
        let help = match suggest::closest(&wanted, names()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "choose one of the objects above".to_owned(),
        };
        let list = names().take(20).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let more = if objects.len() > 20 { ", …" } else { "" };
        let message = format!("there is no object `{wanted}`; the file has {list}{more}");
        let error = Diagnostic::error(objects[0].span.range(), message, "the first object");
        report.add(error.with_help(help));
    }
    found
}

fn model(objects: &[ast::Object], chosen: usize, lowered: Lowered, report: &mut Report) -> Model {
    let object = &objects[chosen];
    let Lowered { mut graph, value, attributes, loops } = lowered;
    match graph.constant_value(value) {
        Some(0.0) => {
            let message = format!("`{}` is 0 everywhere", object.name);
            let warning = Diagnostic::warning(object.span.range(), message, "counts as empty");
            report.add(
                warning.with_help("a solid is where the value is positive; flat at 0 it has no surface"),
            );
        }
        Some(constant) if constant.is_nan() => {
            let message = format!("`{}` is undefined everywhere", object.name);
            report.add(Diagnostic::warning(object.span.range(), message, "counts as empty"));
        }
        _ => {}
    }
    let parameter = |i: usize| Parameter {
        name: format!("a[{}]", i + 1),
        input: Input::Parameter(i as u16),
        default: 0.0,
    };
    let value = graph.neg(value);
    Model {
        field: Field::new(graph, value, attributes),
        name: object.name.clone(),
        objects: objects.iter().map(header).collect(),
        coordinates: object.coordinates,
        has_attributes: object.attributes.is_some(),
        parameters: (0..object.parameters).map(parameter).collect(),
        sign: FileSign::PositiveInside,
        up: UpAxis::Y,
        loops: loops.iter().map(|span| span.range()).collect(),
        presentation: Presentation::default(),
        warnings: Vec::new(),
    }
}

fn header(object: &ast::Object) -> Object {
    Object {
        name: object.name.clone(),
        coordinates: object.coordinates,
        parameters: object.parameters,
        attributes: object.attributes,
    }
}
