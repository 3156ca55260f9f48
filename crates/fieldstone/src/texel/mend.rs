//! Reads a TOML text into a structure and tells all that is wrong with it.
//!
//! The reader stops at the first thing that it cannot understand. That thing is noted and taken out of the text, and
//! what is left is read again, until nothing is wrong any more. Where a key was taken out that has to be there, its
//! table goes too, without a word.

use fieldstone_lang::Diagnostic;
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue, Deserializer};

/// A text with more errors than these has another problem.
const MOST: usize = 20;

/// What was read.
pub(super) struct Mended<T> {
    /// What is left without all that is wrong; nothing if nothing is.
    pub(super) value: Option<T>,
    pub(super) errors: Vec<Diagnostic>,
    /// Tables from which something was taken out.
    pub(super) damaged: Vec<Range<usize>>,
}

/// Reads a text.
pub(super) fn read<T: DeserializeOwned>(text: &str) -> Mended<T> {
    let mut mended = Mended { value: None, errors: Vec::new(), damaged: Vec::new() };
    let mut root = match DeTable::parse(text) {
        Ok(root) => root,
        Err(error) => {
            mended.errors.push(diagnostic(&error, text));
            return mended;
        }
    };
    let mut taken: Vec<(Range<usize>, String)> = Vec::new();
    while mended.errors.len() < MOST {
        let error = match T::deserialize(Deserializer::from(root.clone())) {
            Ok(value) => {
                mended.value = Some(value);
                return mended;
            }
            Err(error) => error,
        };
        let span = error.span();
        let missing = error.message().strip_prefix("missing field `").and_then(|rest| rest.split('`').next());
        let is_known = missing
            .is_some_and(|key| taken.iter().any(|(table, name)| Some(table) == span.as_ref() && name == key));
        if !is_known {
            mended.errors.push(diagnostic(&error, text));
        }
        let table = root.span();
        let out = span.and_then(|span| take_from_table(root.get_mut(), &table, &span));
        let Some((table, key)) = out else { return mended };
        mended.damaged.push(table.clone());
        taken.push((table, key));
    }
    mended
}

fn diagnostic(error: &toml::de::Error, text: &str) -> Diagnostic {
    let span = error.span().unwrap_or(text.len()..text.len());
    let message = error.message().lines().collect::<Vec<_>>().join(": ");
    Diagnostic::error(span, message, "here").with_help("docs/texels.md describes what may stand here")
}

/// A table and a key in it.
type Place = (Range<usize>, String);

fn holds(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

/// Takes out the innermost entry at a place. The places of tables are those of their headers, which do not hold what is
/// below them.
fn take_from_table(table: &mut DeTable<'_>, whole: &Range<usize>, span: &Range<usize>) -> Option<Place> {
    for (_, value) in table.iter_mut() {
        if let Some(place) = take_from_value(value, span) {
            return Some(place);
        }
    }
    let found = table.iter().find(|(key, value)| holds(&key.span(), span) || holds(&value.span(), span));
    let key = found.map(|(key, _)| key.clone())?;
    table.remove(&key);
    Some((whole.clone(), key.into_inner().into_owned()))
}

fn take_from_value(value: &mut Spanned<DeValue<'_>>, span: &Range<usize>) -> Option<Place> {
    let whole = value.span();
    match value.get_mut() {
        DeValue::Table(table) => take_from_table(table, &whole, span),
        DeValue::Array(list) => {
            if let Some(place) = list.iter_mut().find_map(|element| take_from_value(element, span)) {
                return Some(place);
            }
            // A list of tables can do without one of them, one of numbers cannot.
            let at = list.iter().position(|element| {
                holds(&element.span(), span) && matches!(element.get_ref(), DeValue::Table(_))
            })?;
            let all = std::mem::replace(list, DeArray::new()).into_iter().enumerate();
            all.filter(|(place, _)| *place != at).for_each(|(_, element)| list.push(element));
            Some((whole, String::new()))
        }
        _ => None,
    }
}
