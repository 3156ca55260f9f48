//! A TOML text as a tree in which everything knows its place.

use fieldstone_lang::Diagnostic;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place in the text.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) kind: Kind,
    pub(super) span: Range<usize>,
}

/// What a value is.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    Number(f64),
    Text(String),
    Flag(bool),
    List(Vec<Value>),
    Table(Table),
    /// Dates, and numbers that are too large.
    Other(&'static str),
}

/// A table; its entries stand in the order of the text.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
    pub(super) span: Range<usize>,
}

/// A table without entries.
pub(super) static EMPTY: Table = Table { entries: Vec::new(), span: 0..0 };

/// A key with its value.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) key_span: Range<usize>,
    pub(super) value: Value,
}

impl Table {
    /// The value of a key.
    pub(super) fn get(&self, key: &str) -> Option<&Value> {
        let is_meant = |entry: &&Entry| entry.key == key || (key == "colour" && entry.key == "color");
        self.entries.iter().find(is_meant).map(|entry| &entry.value)
    }

    /// The table that stands under a key.
    pub(super) fn table(&self, key: &str) -> Option<&Self> {
        self.get(key).and_then(Value::table)
    }

    /// The entries of the table that stands under a key; none where there is none.
    pub(super) fn entries_of(&self, key: &str) -> &[Entry] {
        self.get(key).and_then(Value::table).map_or(&[], |table| &table.entries)
    }
}

impl Value {
    pub(super) fn text(&self) -> Option<&str> {
        match &self.kind {
            Kind::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(super) fn flag(&self) -> Option<bool> {
        match self.kind {
            Kind::Flag(flag) => Some(flag),
            _ => None,
        }
    }

    pub(super) fn table(&self) -> Option<&Table> {
        match &self.kind {
            Kind::Table(table) => Some(table),
            _ => None,
        }
    }

    pub(super) fn list(&self) -> Option<&[Value]> {
        match &self.kind {
            Kind::List(list) => Some(list),
            _ => None,
        }
    }

    /// The elements of a list, or the value itself where it is none.
    pub(super) fn one_or_many(&self) -> &[Value] {
        self.list().unwrap_or(std::slice::from_ref(self))
    }

    /// What it is, in words.
    pub(super) fn describe(&self) -> &'static str {
        match self.kind {
            Kind::Number(_) => "a number",
            Kind::Text(_) => "a text",
            Kind::Flag(_) => "true or false",
            Kind::List(_) => "a list",
            Kind::Table(_) => "a table",
            Kind::Other(what) => what,
        }
    }

    /// An error at this value.
    pub(super) fn error(&self, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::error(self.span.clone(), message, label)
    }
}

/// Reads a TOML text.
pub(super) fn parse(text: &str) -> Result<Table, Diagnostic> {
    let parsed = DeTable::parse(text).map_err(|error| {
        let message = error.message().lines().next().unwrap_or("this is no TOML").to_owned();
        let span = error.span().unwrap_or(text.len()..text.len());
        if message.contains("recursion") {
            let error =
                Diagnostic::error(span, "tables and lists stand in each other too deeply", "too deep");
            return error.with_help("give inner solids a name: [solids.NAME]");
        }
        Diagnostic::error(span, message, "here").with_help("scene files are written in TOML: https://toml.io")
    })?;
    let span = parsed.span();
    Ok(table(parsed.into_inner(), span))
}

fn table(parsed: DeTable<'_>, span: Range<usize>) -> Table {
    let entry = |(key, value): (Spanned<_>, Spanned<_>)| {
        let key_span = key.span();
        let key: std::borrow::Cow<'_, str> = key.into_inner();
        Entry { key: key.into_owned(), key_span, value: self::value(value) }
    };
    let mut entries: Vec<Entry> = parsed.into_iter().map(entry).collect();
    entries.sort_by_key(|entry| entry.key_span.start);
    Table { entries, span }
}

fn value(parsed: Spanned<DeValue<'_>>) -> Value {
    let span = parsed.span();
    let kind = match parsed.into_inner() {
        DeValue::String(text) => Kind::Text(text.into_owned()),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) => Kind::Number(number as f64),
            Err(_) => Kind::Other("a number that is too large"),
        },
        DeValue::Float(number) => match number.as_str().parse() {
            Ok(number) => Kind::Number(number),
            Err(_) => Kind::Other("a number that cannot be read"),
        },
        DeValue::Boolean(flag) => Kind::Flag(flag),
        DeValue::Datetime(_) => Kind::Other("a date"),
        DeValue::Array(list) => Kind::List(list.into_iter().map(value).collect()),
        DeValue::Table(inner) => Kind::Table(table(inner, span.clone())),
    };
    Value { kind, span }
}

/// The place in a file of a part of a text that stands there in quotes at `span`.
///
/// Texts with escapes are taken as a whole: what stands in the file is not what they say.
pub(crate) fn place_in_text(file: &str, span: &Range<usize>, text: &str, part: Range<usize>) -> Range<usize> {
    let raw = file.get(span.clone()).unwrap_or_default();
    let quotes = if raw.starts_with("\"\"\"") || raw.starts_with("'''") { 3 } else { 1 };
    let inner = raw.get(quotes..raw.len().saturating_sub(quotes)).unwrap_or_default();
    // A line break after three quotes is no part of the text.
    let body = if quotes == 3 { inner.strip_prefix("\r\n").or(inner.strip_prefix('\n')) } else { None };
    let body = body.unwrap_or(inner);
    if body != text {
        return span.clone();
    }
    let start = span.start + quotes + (inner.len() - body.len());
    start + part.start.min(text.len())..start + part.end.min(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_knows_its_place() {
        let text = "[solids]\nball = \"x^2 - 1\"\n[[objects]]\nsolid = \"ball\"\n";
        let root = parse(text).unwrap();
        let ball = &root.entries_of("solids")[0];
        assert_eq!(&text[ball.key_span.clone()], "ball");
        assert_eq!(&text[ball.value.span.clone()], "\"x^2 - 1\"");
        let part = place_in_text(text, &ball.value.span, "x^2 - 1", 2..3);
        assert_eq!(&text[part], "2");
        assert_eq!(root.get("objects").and_then(Value::list).map(<[Value]>::len), Some(1));
        assert!(parse("a = = 1").is_err());
    }

    #[test]
    fn places_in_long_and_escaped_texts() {
        for text in ["a = \"\"\"\nx + y\"\"\"", "a = '''x + y'''", "a = 'x + y'"] {
            let root = parse(text).unwrap();
            let value = root.get("a").unwrap();
            assert_eq!(&text[place_in_text(text, &value.span, "x + y", 4..5)], "y", "{text}");
        }
        let text = r#"a = "x\u0020+ y""#;
        let root = parse(text).unwrap();
        let value = root.get("a").unwrap();
        assert_eq!(place_in_text(text, &value.span, "x + y", 4..5), value.span);
    }
}
