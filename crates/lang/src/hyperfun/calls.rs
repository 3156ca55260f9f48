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
    if let Some(header) = parser.header_of(name) {
        if let Some(error) = not_above(parser, name, span) {
            return Err(parser.fail(error));
        }
        return Ok(Callee::Object(header.object));
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

/// The strict dialect's error where an object calls itself or one that stands further down.
fn not_above(parser: &Parser<'_>, name: Symbol, span: Span) -> Option<Diagnostic> {
    let (text, header) = (parser.name(name), parser.header_of(name)?);
    let (message, label) = if text == parser.own_name() {
        (format!("`{text}` calls itself"), "no recursion in the language of the C interpreter")
    } else if parser.is_further_down(header) {
        (format!("the object `{text}` is defined further down"), "not known here in the C interpreter")
    } else {
        return None;
    };
    let error = Diagnostic::error(span.range(), message, label);
    parser
        .strict()
        .then(|| error.with_help("objects call only objects above them, or in the lenient dialect"))
}

fn unknown(parser: &Parser<'_>, name: Symbol, span: Span) -> Diagnostic {
    let text = parser.name(name);
    let error = |message: String, label: &str| Diagnostic::error(span.range(), message, label);
    if let Some(reason) = library::unsupported(text) {
        return error(format!("`{text}` cannot run: {reason}"), "no such function here")
            .with_help("write its formula out in the model");
    }
    if let Some(slot) = parser.variable(name) {
        let slot = parser.slot(slot);
        let (message, help) = match slot.is_array() {
            true => {
                (format!("`{text}` is an array, not a function"), format!("elements are written `{text}[1]`"))
            }
            false => (
                format!("`{text}` is a number, not a function"),
                format!("products are written `{text}*(…)`"),
            ),
        };
        return error(message, "cannot be called").with_help(help);
    }
    let mut known = parser.object_names();
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
pub(super) fn check(
    parser: &mut Parser<'_>,
    (callee, name): (Callee, Symbol),
    passed: &[Passed],
    call: Span,
) -> Parsed<()> {
    let problem = match callee {
        Callee::Builtin(builtin) => {
            let parameters: Vec<_> = builtin.parameters.iter().map(|name| (*name, Kind::Real)).collect();
            check_kinds(parser, builtin.name, &parameters, passed, call)
        }
        Callee::Library(function) => check_kinds(parser, function.name, function.parameters, passed, call),
        Callee::Object(_) => check_sizes(parser, name, passed, call),
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
fn check_sizes(parser: &Parser<'_>, object: Symbol, passed: &[Passed], call: Span) -> Option<Diagnostic> {
    let (header, object) = (parser.header_of(object)?, parser.name(object));
    let sizes = [("x", header.coordinates), ("a", header.parameters), ("s", header.attributes.unwrap_or(1))];
    let written = if header.attributes.is_some() { 3 } else { 2 };
    let header =
        sizes[..written].iter().map(|(name, size)| format!("{name}[{size}]")).collect::<Vec<_>>().join(", ");
    let form = format!("expected `{object}({header})`");
    if !(2..=3).contains(&passed.len()) {
        let message =
            format!("`{object}` takes two or three arrays, not {}", plural(passed.len(), "argument"));
        return Some(Diagnostic::error(call.range(), message, form));
    }
    for ((name, size), argument) in sizes.iter().zip(passed) {
        let Some(array) = argument.array else {
            let message = format!("`{name}` of `{object}` is a whole array");
            let error = Diagnostic::error(argument.span.range(), message, form);
            return Some(error.with_help("pass the name of an array, without an index"));
        };
        // A length that is computed is compared where the call is followed.
        let Some(length) = parser.slot(array).length() else { continue };
        if length != *size {
            let message = format!("`{name}` of `{object}` has {}, not {length}", plural(*size, "element"));
            return Some(Diagnostic::error(argument.span.range(), message, form));
        }
    }
    None
}
