//! The text format of Java's properties: `key=value` lines with escapes.
//!
//! After `java.util.Properties.load`: a line whose first character is `#` or `!` is a comment; a key ends at the first
//! `=`, `:` or blank that no backslash stands before; a backslash at the end of a line continues it, without the blanks
//! that the next line begins with; `\t`, `\n`, `\r`, `\f` and `\uXXXX` are characters, and a backslash before any other
//! character is left out.

use crate::diagnostic::Diagnostic;
use std::iter::Peekable;
use std::ops::Range;
use std::str::CharIndices;

/// A text without its escapes that knows where it comes from.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Piece {
    pub(super) text: String,
    /// For each byte of the text, and for its end, the byte of the file.
    places: Vec<usize>,
}

/// A line.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Property {
    pub(super) key: Piece,
    pub(super) value: Piece,
}

impl Piece {
    fn push(&mut self, c: char, at: usize) {
        self.text.push(c);
        self.places.resize(self.text.len(), at);
    }

    /// Where bytes of the text stand in the file.
    pub(super) fn in_file(&self, span: Range<usize>) -> Range<usize> {
        let last = self.places.len().saturating_sub(1);
        let place = |at: usize| self.places.get(at.min(last)).copied().unwrap_or(0);
        let (start, end) = (place(span.start), place(span.end));
        start..end.max(start)
    }

    /// Where the text stands in the file, without the blanks around it.
    pub(super) fn span(&self) -> Range<usize> {
        let start = self.text.len() - self.text.trim_start().len();
        self.in_file(start..self.text.trim_end().len().max(start))
    }

    /// The diagnostic of a message about this text, with its place in the file.
    pub(super) fn diagnostic(&self, diagnostic: Diagnostic) -> Diagnostic {
        Diagnostic { span: self.in_file(diagnostic.span.clone()), ..diagnostic }
    }
}

/// The properties of a text, in its order.
pub(super) fn read(text: &str) -> (Vec<Property>, Vec<Diagnostic>) {
    const BYTE_ORDER_MARK: char = '\u{feff}';
    let mut reader = Reader { text, chars: text.char_indices().peekable(), errors: Vec::new() };
    reader.skip(|c| c == BYTE_ORDER_MARK);
    let mut properties = Vec::new();
    loop {
        reader.skip(char::is_whitespace);
        match reader.chars.peek() {
            None => return (properties, reader.errors),
            Some((_, '#' | '!')) => reader.skip(|c| !is_line_end(c)),
            Some(_) => properties.push(reader.property()),
        }
    }
}

fn is_line_end(c: char) -> bool {
    matches!(c, '\n' | '\r')
}

fn is_blank(c: char) -> bool {
    c.is_whitespace() && !is_line_end(c)
}

struct Reader<'a> {
    text: &'a str,
    chars: Peekable<CharIndices<'a>>,
    errors: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn at(&mut self) -> usize {
        self.chars.peek().map_or(self.text.len(), |(at, _)| *at)
    }

    fn skip(&mut self, belongs: impl Fn(char) -> bool) {
        while self.chars.next_if(|(_, c)| belongs(*c)).is_some() {}
    }

    fn property(&mut self) -> Property {
        let key = self.piece(|c| matches!(c, '=' | ':') || is_blank(c));
        self.skip(is_blank);
        if self.chars.next_if(|(_, c)| matches!(c, '=' | ':')).is_some() {
            self.skip(is_blank);
        }
        Property { key, value: self.piece(|_| false) }
    }

    /// What stands before the end of the line, or before a character that `ends` it.
    fn piece(&mut self, ends: impl Fn(char) -> bool) -> Piece {
        let mut piece = Piece::default();
        while let Some((at, c)) = self.chars.next_if(|(_, c)| !is_line_end(*c) && !ends(*c)) {
            match c {
                '\\' => self.escape(at, &mut piece),
                _ => piece.push(c, at),
            }
        }
        let end = self.at();
        piece.places.push(end);
        piece
    }

    /// What stands after a backslash at byte `start`.
    fn escape(&mut self, start: usize, piece: &mut Piece) {
        let Some((_, c)) = self.chars.next() else { return };
        match c {
            't' => piece.push('\t', start),
            'n' => piece.push('\n', start),
            'r' => piece.push('\r', start),
            'f' => piece.push('\u{c}', start),
            'u' => self.code_point(start, piece),
            c if is_line_end(c) => {
                if c == '\r' {
                    let _ = self.chars.next_if(|(_, c)| *c == '\n');
                }
                self.skip(is_blank);
            }
            c => piece.push(c, start),
        }
    }

    fn code_point(&mut self, start: usize, piece: &mut Piece) {
        let mut code = 0;
        for _ in 0..4 {
            let Some((_, digit)) = self.chars.next_if(|(_, c)| c.is_ascii_hexdigit()) else {
                let end = self.at();
                let error = Diagnostic::error(start..end, "`\\u` without four digits", "expected `\\u00e9`");
                self.errors.push(error.with_help("a character is written with four hexadecimal digits"));
                return;
            };
            code = 16 * code + digit.to_digit(16).unwrap_or(0);
        }
        piece.push(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER), start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(text: &str) -> Vec<(String, String)> {
        let (properties, errors) = read(text);
        assert_eq!(errors, []);
        properties.into_iter().map(|p| (p.key.text, p.value.text)).collect()
    }

    #[track_caller]
    fn one(text: &str, key: &str, value: &str) {
        assert_eq!(pairs(text), [(key.to_owned(), value.to_owned())]);
    }

    #[test]
    fn the_three_separators() {
        one("a=b", "a", "b");
        one(" a : b ", "a", "b ");
        one("a  b c", "a", "b c");
        one("a = = b", "a", "= b");
        one("a", "a", "");
    }

    #[test]
    fn comments_and_blank_lines_are_nothing() {
        assert_eq!(pairs("# a=b\n\n  ! c=d\r\n"), []);
        one("a=b # c", "a", "b # c");
    }

    #[test]
    fn escapes() {
        one(r"a\=b\:c\ d=e\=\u0041\q\\", "a=b:c d", r"e=Aq\");
        one(r"a=b\tc", "a", "b\tc");
    }

    #[test]
    fn a_backslash_continues_a_line() {
        for end in ["\n", "\r\n", "\r"] {
            one(&format!("a=b\\{end}   c"), "a", "bc");
        }
        one("a=b\\", "a", "b");
    }

    #[test]
    fn an_incomplete_code_is_an_error() {
        let (_, errors) = read("a=\\u00g0");
        assert_eq!(errors.len(), 1);
        assert_eq!(errors[0].span, 2..6);
    }

    #[test]
    fn places_go_back_through_escapes_and_continued_lines() {
        let text = "key = x\\=y\\\n   z";
        let (properties, _) = read(text);
        let value = &properties[0].value;
        assert_eq!(value.text, "x=yz");
        assert_eq!(&text[value.in_file(0..1)], "x");
        assert_eq!(&text[value.in_file(1..2)], "\\=");
        assert_eq!(&text[value.in_file(3..4)], "z");
        assert_eq!(value.in_file(4..4), text.len()..text.len());
    }
}
