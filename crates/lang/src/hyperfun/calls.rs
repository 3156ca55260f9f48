//! Which function a call means, and whether its arguments fit.

use super::ast::{Callee, SlotId};
use super::lexer::Symbol;
use super::library::Kind;
use super::parser::{Parsed, Parser};
use super::report::Span;
use super::{builtins, library};
use crate::diagnostic::Diagnostic;
use crate::suggest;

/// An argument of a call.
pub(super) struct Passed {
    /// The array that is passed as a whole, if one is.
    pub(super) array: Option<SlotId>,
    pub(super) span: Span,
}

/// What is called by a name in front of a parenthesis.
pub(super) fn callee(parser: &mut Parser<'_>, name: Symbol, span: Span) -> Parsed<Callee> {
    let text = parser.name(name);
    if let Some(object) = parser.objects.iter().position(|o| o.name == text) {
        return Ok(Callee::Object(object));
    }
    if let Some(builtin) = builtins::lookup(text) {
        return Ok(Callee::Builtin(builtin));
    }
    if let Some(function) = library::lookup(text, parser.dialect()) {
        return Ok(Callee::Library(function));
    }
    let error = unknown(parser, name, span);
    Err(parser.fail(error))
}

fn unknown(parser: &Parser<'_>, name: Symbol, span: Span) -> Diagnostic {
    let text = parser.name(name);
    let error = |message: String, label: &str| Diagnostic::error(span.range(), message, label);
    if let Some(reason) = library::unsupported(text) {
        return error(format!("`{text}` cannot run: {reason}"), "no such function here")
            .with_help("write its formula out in the model");
    }
    if text == parser.own_name() {
        return error(format!("`{text}` calls itself"), "no recursion")
            .with_help("objects call only objects above them; repetition is written with `while`");
    }
    if parser.is_object_further_down(name) {
        return error(format!("the object `{text}` is defined further down"), "not known here")
            .with_help("objects call only objects above them: move it up");
    }
    if let Some(slot) = parser.variable(name) {
        let slot = parser.slot(slot);
        let (message, help) = match slot.length {
            Some(_) => {
                (format!("`{text}` is an array, not a function"), format!("elements are written `{text}[1]`"))
            }
            None => (
                format!("`{text}` is a number, not a function"),
                format!("products are written `{text}*(…)`"),
            ),
        };
        return error(message, "cannot be called").with_help(help);
    }
    let mut known: Vec<&str> = parser.objects.iter().map(|o| o.name.as_str()).collect();
    for name in builtins::names().chain(library::names()) {
        known.push(name);
    }
    let error = error(format!("there is no function `{text}`"), "unknown function");
    match suggest::closest(text, known) {
        Some(near) => error.with_help(format!("did you mean `{near}`?")),
        None => error,
    }
}

/// Reports arguments that do not fit.
pub(super) fn check(parser: &mut Parser<'_>, callee: Callee, passed: &[Passed], call: Span) -> Parsed<()> {
    let problem = match callee {
        Callee::Builtin(builtin) => {
            let parameters: Vec<_> = builtin.parameters.iter().map(|name| (*name, Kind::Real)).collect();
            check_kinds(parser, builtin.name, &parameters, passed, call)
        }
        Callee::Library(function) => check_kinds(parser, function.name, function.parameters, passed, call),
        Callee::Object(object) => check_sizes(parser, object, passed, call),
    };
    match problem {
        Some(error) => Err(parser.fail(error)),
        None => Ok(()),
    }
}

fn plural(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}

fn signature(name: &str, parameters: &[(&str, Kind)]) -> String {
    let parameters = parameters.iter().map(|(name, kind)| match kind {
        Kind::Real => (*name).to_owned(),
        Kind::Array => format!("{name}[]"),
    });
    format!("`{name}({})`", parameters.collect::<Vec<_>>().join(", "))
}

fn check_kinds(
    parser: &Parser<'_>,
    name: &str,
    parameters: &[(&str, Kind)],
    passed: &[Passed],
    call: Span,
) -> Option<Diagnostic> {
    let form = signature(name, parameters);
    if passed.len() != parameters.len() {
        let count = plural(parameters.len(), "argument");
        let message = format!("`{name}` takes {count}, not {}", passed.len());
        let span = passed.get(parameters.len()).map_or(call, |surplus| surplus.span);
        return Some(Diagnostic::error(span.range(), message, format!("expected {form}")));
    }
    for ((parameter, kind), argument) in parameters.iter().zip(passed) {
        let (message, help) = match (kind, argument.array) {
            (Kind::Real, Some(array)) => {
                let array = &parser.slot(array).name;
                (
                    format!("`{parameter}` of `{name}` is a number"),
                    format!("write `{array}[1]` for the first element"),
                )
            }
            (Kind::Array, None) => {
                let help = "pass the name of an array, without an index";
                (format!("`{parameter}` of `{name}` is a whole array"), help.to_owned())
            }
            _ => continue,
        };
        let error = Diagnostic::error(argument.span.range(), message, format!("expected {form}"));
        return Some(error.with_help(help));
    }
    None
}

/// Objects take their arrays in exactly the sizes of their headers; s\[\] may be left out.
fn check_sizes(parser: &Parser<'_>, object: usize, passed: &[Passed], call: Span) -> Option<Diagnostic> {
    let object = &parser.objects[object];
    let sizes = [("x", object.coordinates), ("a", object.parameters), ("s", object.attribute_count())];
    let written = if object.attributes.is_some() { 3 } else { 2 };
    let header =
        sizes[..written].iter().map(|(name, size)| format!("{name}[{size}]")).collect::<Vec<_>>().join(", ");
    let form = format!("expected `{}({header})`", object.name);
    if !(2..=3).contains(&passed.len()) {
        let message =
            format!("`{}` takes two or three arrays, not {}", object.name, plural(passed.len(), "argument"));
        return Some(Diagnostic::error(call.range(), message, form));
    }
    for ((name, size), argument) in sizes.iter().zip(passed) {
        let Some(array) = argument.array else {
            let message = format!("`{name}` of `{}` is a whole array", object.name);
            let error = Diagnostic::error(argument.span.range(), message, form);
            return Some(error.with_help("pass the name of an array, without an index"));
        };
        let length = parser.slot(array).length.unwrap_or(1);
        if length != *size {
            let message =
                format!("`{name}` of `{}` has {}, not {length}", object.name, plural(*size, "element"));
            return Some(Diagnostic::error(argument.span.range(), message, form));
        }
    }
    None
}
