//! Errors and warnings with their place in the source.

use annotate_snippets::{AnnotationKind, Level, Origin, Renderer, Snippet};
use std::fmt;
use std::ops::Range;

/// A front end stops after this many errors: what follows is rarely about the text's own faults.
pub(crate) const MAX_ERRORS: usize = 20;
/// Further warnings are left out.
pub(crate) const MAX_WARNINGS: usize = 50;
/// How many words a text may have; a formula or a program of so many is read in a few seconds.
pub(crate) const MAX_WORDS: usize = 4_000_000;
/// How many bytes a name may have.
pub(crate) const MAX_NAME: usize = 255;

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
        let (message, label) = (shortened(message.into()), shortened(label.into()));
        Self { severity: Severity::Error, message, span, label, help: None }
    }

    /// A warning at `span`.
    pub fn warning(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(span, message, label) }
    }

    /// Adds what to do about it.
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(shortened(help.into())), ..self }
    }

    /// The message with file, line, column, the source line and carets under it, as plain text.
    pub fn render(&self, source: &Source) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let view = View::new(&source.text, &self.span);
        let annotation = AnnotationKind::Primary.span(view.span.clone()).label(self.label.as_str());
        let snippet = Snippet::source(view.text).line_start(view.line).annotation(annotation);
        let title = level.primary_title(self.message.as_str());
        let mut group = match view.cut_column {
            None => title.element(snippet.path(source.name.as_str())),
            // The column in the text, not in the part of the line that is shown.
            Some(column) => {
                let origin = Origin::path(source.name.as_str()).line(view.line).char_column(column);
                title.element(origin).element(snippet)
            }
        };
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        Renderer::plain().render(&[group])
    }
}

/// A text for a message, in which words from a source that nobody would read to the end are cut in their middles.
fn shortened(text: String) -> String {
    /// The most letters of a word, and of a text.
    const LONGEST: (usize, usize) = (300, 2000);
    /// How many letters are left on each side of a cut.
    const LEFT: usize = 40;
    let cut = |part: &str, longest: usize, left: usize| {
        let count = part.chars().count();
        if count <= longest {
            return part.to_owned();
        }
        let (first, last) = (part.chars().take(left), part.chars().skip(count - left));
        first.chain(['…']).chain(last).collect()
    };
    // No text so short has a long word.
    if text.len() <= LONGEST.0 {
        return text;
    }
    let words: String = text.split_inclusive(char::is_whitespace).map(|w| cut(w, LONGEST.0, LEFT)).collect();
    cut(&words, LONGEST.1, LONGEST.1 / 2)
}

/// The lines of a text that a message is about.
struct View<'s> {
    /// Whole lines, or a part of a line that is too long.
    text: &'s str,
    /// The number of the first of them, counted from 1.
    line: usize,
    /// The place of the message among them.
    span: Range<usize>,
    /// The column of the message, counted from 1, if the beginning of its line is not shown.
    cut_column: Option<usize>,
}

impl<'s> View<'s> {
    /// How many bytes of a long line, or of several lines, are shown behind and before a place.
    const REACH: usize = 4096;

    fn new(text: &'s str, span: &Range<usize>) -> Self {
        let start = floor_char_boundary(text, span.start.min(span.end));
        let end = floor_char_boundary(text, span.end.min(start + Self::REACH)).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let from = line_start.max(floor_char_boundary(text, start.saturating_sub(Self::REACH)));
        let line_end = text[end..].find('\n').map_or(text.len(), |length| end + length);
        let to = line_end.min(floor_char_boundary(text, end + Self::REACH));
        let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let cut_column = (from > line_start).then(|| text[line_start..start].chars().count() + 1);
        Self { text: &text[from..to], line, span: start - from..end - from, cut_column }
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

    fn rendered(text: &str, span: Range<usize>) -> String {
        Diagnostic::error(span, "wrong", "here").render(&Source::new("name", text))
    }

    #[test]
    fn far_lines_and_columns_are_told_and_little_is_shown() {
        let lines = "x + y\n".repeat(10_000);
        let text = rendered(&lines, 6 * 7_000 + 2..6 * 7_000 + 3);
        assert!(text.contains("name:7001:3") && text.contains("7001 | x + y"), "{text}");
        let long = "é+".repeat(50_000);
        let text = rendered(&long, 3 * 30_000..3 * 30_000 + 2);
        assert!(text.contains("name:1:60001") && text.len() < 2_000, "{text}");
        assert!(rendered(&long, 0..long.len()).len() < 40_000);
    }

    #[test]
    fn long_words_are_cut_in_messages() {
        let word = "é".repeat(100_000);
        let message = format!("`{word}` has no meaning here");
        let warning = Diagnostic::warning(0..word.len(), message, word.clone()).with_help(word);
        let few = |text: &str| text.chars().count() < 120 && text.contains("éé…éé");
        assert!(few(&warning.message) && few(&warning.label) && warning.help.as_deref().is_some_and(few));
        assert!(warning.message.starts_with("`éé") && warning.message.ends_with("é` has no meaning here"));
        let many = Diagnostic::error(0..0, "a ".repeat(100_000), "x".repeat(255));
        assert!(many.message.len() < 2_100 && many.label.len() == 255);
    }

    #[test]
    fn places_outside_of_the_text_are_shown_at_its_end() {
        for span in [5..9, 2..2, 3..9, 0..0] {
            assert!(rendered("é\n", span).contains("wrong"));
        }
        assert!(rendered("", 0..0).contains("name:1:1"));
    }
}
