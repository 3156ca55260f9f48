//! Errors and warnings with their place in the source.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;

/// A front end stops after this many errors: what follows is rarely about the text's own faults.
pub(crate) const MAX_ERRORS: usize = 20;

/// A named text.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file's name as the user gave it, or what stands for it.
    pub name: String,
    /// The text.
    pub text: String,
}

impl Source {
    /// A named text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// The line and the column of a byte, both counted from 1; columns count characters. A byte inside a character or
    /// behind the end stands for the character's start or the end.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let before = &self.text[..floor_char_boundary(&self.text, byte)];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// How grave a diagnostic is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// The model cannot be read.
    Error,
    /// The model is read, but perhaps not as meant.
    Warning,
}

/// A message about a place in a source.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong, on one line.
    pub message: String,
    /// The bytes of the source that it is about.
    pub span: Range<usize>,
    /// What stands at the caret: "expected `;`".
    pub label: String,
    /// What to do about it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at `span`.
    pub fn error(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { severity: Severity::Error, message: message.into(), span, label: label.into(), help: None }
    }

    /// A warning at `span`.
    pub fn warning(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(span, message, label) }
    }

    /// Adds what to do about it.
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The message with file, line, column, the source line and carets under it, as plain text.
    pub fn render(&self, source: &Source) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let end = floor_char_boundary(&source.text, self.span.end);
        let start = floor_char_boundary(&source.text, self.span.start.min(end));
        let annotation = AnnotationKind::Primary.span(start..end).label(self.label.as_str());
        let snippet = Snippet::source(source.text.as_str()).path(source.name.as_str()).annotation(annotation);
        let mut group = level.primary_title(self.message.as_str()).element(snippet);
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        Renderer::plain().render(&[group])
    }
}

fn floor_char_boundary(text: &str, at: usize) -> usize {
    let at = at.min(text.len());
    (0..=at).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// The errors of a source that cannot be read, at least one, in the order of the text; warnings may stand among them.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    /// What the messages are about.
    pub source: Source,
    /// The messages.
    pub list: Vec<Diagnostic>,
}

impl Diagnostics {
    /// The messages about a source, put in the order of its text.
    pub(crate) fn in_order(source: &Source, mut list: Vec<Diagnostic>) -> Self {
        list.sort_by_key(|diagnostic| diagnostic.span.start);
        Self { source: source.clone(), list }
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, diagnostic) in self.list.iter().enumerate() {
            if i > 0 {
                f.write_str("\n\n")?;
            }
            f.write_str(&diagnostic.render(&self.source))?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one() {
        let source = Source::new("test", "a\nπb\n");
        let places =
            [(0, (1, 1)), (1, (1, 2)), (2, (2, 1)), (3, (2, 1)), (4, (2, 2)), (6, (3, 1)), (99, (3, 1))];
        for (byte, place) in places {
            assert_eq!(source.line_and_column(byte), place, "byte {byte}");
        }
    }

    #[test]
    fn lines_and_columns_are_those_of_the_rendered_message() {
        let source = Source::new("test", "first\nsecond");
        let (line, column) = source.line_and_column(9);
        let message = Diagnostic::error(9..10, "wrong", "here").render(&source);
        assert!(message.contains(&format!("test:{line}:{column}")), "{message}");
    }
}
