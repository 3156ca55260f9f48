//! What names mean, and what to say of those that mean nothing.

use super::functions::{Function, function_names};
use super::lexer::{Token, Word};
use crate::diagnostic::Diagnostic;
use crate::suggest::closest;
use fieldstone_field::Input;
use std::collections::HashMap;
use std::f64::consts;
use std::ops::Range;

/// A name that stands for a value in every formula.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum BuiltIn {
    Input(Input),
    Constant(f64),
}

const BUILT_IN: [(&str, BuiltIn); 8] = [
    ("x", BuiltIn::Input(Input::Coordinate(0))),
    ("y", BuiltIn::Input(Input::Coordinate(1))),
    ("z", BuiltIn::Input(Input::Coordinate(2))),
    ("w", BuiltIn::Input(Input::Coordinate(3))),
    ("t", BuiltIn::Input(Input::Time)),
    ("pi", BuiltIn::Constant(consts::PI)),
    ("π", BuiltIn::Constant(consts::PI)),
    ("e", BuiltIn::Constant(consts::E)),
];

/// The built-in value of a name.
pub(super) fn built_in(name: &str) -> Option<BuiltIn> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// The definitions of a formula so far, by name.
pub(super) type Defined<'a> = HashMap<&'a str, usize>;

/// Says that `name` cannot be given a value, unless it can.
pub(super) fn check_definition(
    name: &str,
    span: &Range<usize>,
    defined: &Defined<'_>,
) -> Result<(), Diagnostic> {
    let (what, help) = match built_in(name) {
        Some(BuiltIn::Input(Input::Coordinate(_))) => (
            "a coordinate",
            format!("for the surface `{name} = …` leave out the `;`; otherwise choose another name"),
        ),
        Some(BuiltIn::Input(_)) => {
            ("the time", "choose another name; the time is set when rendering".to_owned())
        }
        Some(BuiltIn::Constant(value)) => ("a constant", format!("it is {value:.5}; choose another name")),
        None if Function::named(name).is_some() && !Function::may_be_defined(name) => {
            ("a function", "choose another name".to_owned())
        }
        None if defined.contains_key(name) => {
            let error =
                Diagnostic::error(span.clone(), format!("`{name}` is defined twice"), "defined again");
            return Err(error.with_help("choose another name, or leave out one of the definitions"));
        }
        None => return Ok(()),
    };
    Err(Diagnostic::error(span.clone(), format!("`{name}` is {what} and cannot be defined"), what)
        .with_help(help))
}

/// The definitions so far, and how to write one for a name.
type Definitions<'a> = (&'a Defined<'a>, fn(&str) -> String);

/// The error for a name without a meaning. `words` are all words of the text, `at` is the name's.
pub(super) fn unknown_name(
    text: &str,
    words: &[Word],
    at: usize,
    definitions: Definitions<'_>,
) -> Diagnostic {
    let span = words[at].span.clone();
    let name = &text[span.clone()];
    let next = words.get(at + 1).map(|word| word.token);
    let kind = if next == Some(Token::Open) { "function" } else { "name" };
    let error = Diagnostic::error(span, format!("unknown {kind} `{name}`"), "not defined");
    error.with_help(help_for_unknown(text, words, at, definitions))
}

fn help_for_unknown(text: &str, words: &[Word], at: usize, definitions: Definitions<'_>) -> String {
    let (defined, how_to_define) = definitions;
    let name = &text[words[at].span.clone()];
    let next = words.get(at + 1).map(|word| word.token);
    let defined_later = words[at + 1..].windows(3).any(|w| {
        let definition = matches!(w[0].token, Token::Semicolon | Token::Let);
        definition && w[2].token == Token::Assign && &text[w[1].span.clone()] == name
    });
    if defined_later {
        return format!("move the definition `{name} = …;` above its use");
    }
    if next == Some(Token::Assign) {
        return format!(
            "to give `{name}` a value, write `;` after it, and then the formula: `{name} = 1; …`"
        );
    }
    if let Some(product) = product(name, defined) {
        return format!("write `{product}`");
    }
    let is_called = next == Some(Token::Open);
    let mut known: Vec<&str> = Vec::new();
    if !is_called {
        known.extend(defined.keys());
        known.sort_unstable();
        known.extend(BUILT_IN.iter().map(|(name, _)| name));
    }
    for function in function_names() {
        known.push(function);
    }
    match (closest(name, known), is_called) {
        (Some(known), true) => format!("did you mean `{known}`?"),
        (None, true) => format!("for a product write `{name}*(…)`; functions cannot be defined"),
        (Some(known), false) => format!("did you mean `{known}`? Otherwise {}", how_to_define(name)),
        (None, false) => how_to_define(name),
    }
}

/// `xy` as `x*y` and `x2` as `x^2`, if the letters are known.
fn product(name: &str, defined: &Defined<'_>) -> Option<String> {
    let is_known = |c: char| {
        let letter = c.to_string();
        built_in(&letter).is_some() || defined.contains_key(letter.as_str())
    };
    let letters: Vec<char> = name.trim_end_matches(|c: char| c.is_ascii_digit()).chars().collect();
    if letters.is_empty() || !letters.iter().all(|&c| is_known(c)) {
        return None;
    }
    let factors: Vec<String> = letters.iter().map(char::to_string).collect();
    let product = factors.join("*");
    match &name[letters.iter().map(|c| c.len_utf8()).sum()..] {
        "" => Some(product),
        digits => Some(format!("{product}^{digits}` or `{digits}*{product}")),
    }
}
