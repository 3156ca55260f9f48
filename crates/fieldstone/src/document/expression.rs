//! Formulas inside of a scene file, which use its names.

use super::Document;
use super::fault::{Fault, Outcome};
use super::tree::{Value, place_in_text};
use fieldstone_field::Input;
use fieldstone_lang::{Diagnostic, Model, Parameter, Source, parse_formula};

/// The names of the outward unit normal in textures.
pub(super) const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// Which names of the scene a formula may use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names {
    pub(super) parameters: bool,
    pub(super) fields: bool,
    pub(super) normal: bool,
}

/// A formula that was read.
#[derive(Clone, Debug)]
pub(super) struct Expression {
    /// Its program. Names of the scene are parameters of it.
    pub(super) model: Model,
    /// The names of the scene that it uses.
    pub(super) names: Vec<String>,
}

impl Expression {
    /// The parameter that an input is.
    pub(super) fn parameter(&self, input: Input) -> Option<&Parameter> {
        self.model.parameters.iter().find(|parameter| parameter.input == input)
    }
}

/// Reads a formula that stands at `value` in the scene file.
///
/// A formula has no names but its own, so that those of the scene are defined before it, each in the place of a parameter.
pub(super) fn read(document: &Document, value: &Value, text: &str, names: Names) -> Outcome<Expression> {
    read_of(document, value, text, (names, &[]))
}

/// The same for a formula of further names.
pub(super) fn read_of(
    document: &Document,
    value: &Value,
    text: &str,
    (names, further): (Names, &[&str]),
) -> Outcome<Expression> {
    let own = own_names(text);
    let is_known = |name: &str| {
        names.parameters && document.parameter(name).is_some()
            || names.fields && document.field(name).is_some()
            || names.normal && NORMAL.contains(&name)
            || further.contains(&name)
    };
    let mut used: Vec<String> = Vec::new();
    for word in words(text) {
        if is_known(word) && !own.contains(&word) && !used.iter().any(|u| u == word) {
            used.push(word.to_owned());
        }
    }
    let prelude: String = used.iter().map(|name| format!("{name} = 0; ")).collect();
    let shift = prelude.len();
    let source = Source::new("formula", prelude + text);
    let place = |span: &std::ops::Range<usize>| {
        let part = span.start.saturating_sub(shift)..span.end.saturating_sub(shift);
        // A part of the text at `value` keeps its place by blanks before it.
        place_in_text(&document.source().text, &value.span, value.text().unwrap_or(text), part)
    };
    match parse_formula(&source) {
        Ok(model) => Ok(Expression { model, names: used }),
        Err(errors) => {
            let here = |d: Diagnostic| Diagnostic { span: place(&d.span), ..d };
            Err(Fault::Here(errors.list.into_iter().map(here).collect()))
        }
    }
}

/// What a name must be to be used in formulas, if `name` is not that.
pub(super) fn check_name(name: &str) -> Result<(), (String, Option<String>)> {
    let is_word = words(name).next() == Some(name);
    if !is_word || NORMAL.contains(&name) {
        let message = format!("`{name}` cannot be a name in formulas");
        let help = "names are letters, digits and _, and begin with a letter; nx, ny and nz are the normal";
        return Err((message, Some(help.to_owned())));
    }
    match parse_formula(&Source::new("name", format!("{name} = 0; {name}"))) {
        Ok(_) => Ok(()),
        Err(errors) => {
            let first = errors.list.into_iter().next();
            Err(first.map_or((format!("`{name}` cannot be a name"), None), |d| (d.message, d.help)))
        }
    }
}

/// The words of a text that may be names.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    text.split(move |c| !is_letter(c))
        .map(|word| word.trim_start_matches(|c: char| c.is_ascii_digit()))
        .filter(|word| !word.is_empty())
}

/// The names that a formula defines itself: `a = 2; …` or `let a = 2; …`.
fn own_names(text: &str) -> Vec<&str> {
    let mut statements: Vec<&str> = text.split(';').collect();
    // What stands last is the formula, and may be an equation.
    statements.pop();
    statements.into_iter().filter_map(|statement| words(statement.split_once('=')?.0).last()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_names_are_those_before_the_formula() {
        assert_eq!(own_names("a = 2; let b2 = a == 3; x = a + b2"), ["a", "b2"]);
        assert!(own_names("x = y").is_empty());
    }

    #[test]
    fn words_are_what_may_be_names() {
        assert_eq!(words("2r + sin(r_1*π)^2").collect::<Vec<_>>(), ["r", "sin", "r_1", "π"]);
    }

    #[test]
    fn names_that_mean_something_else_are_refused() {
        assert!(check_name("radius").is_ok() && check_name("größe").is_ok());
        for wrong in ["x", "t", "pi", "sin", "nx", "", "a b", "2a", "a-b", "let"] {
            assert!(check_name(wrong).is_err(), "{wrong}");
        }
    }
}
