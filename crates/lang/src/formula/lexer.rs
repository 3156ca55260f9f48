//! Words of a formula.

use crate::diagnostic::{Diagnostic, MAX_ERRORS, MAX_NAME, MAX_WORDS};
use std::ops::Range;

/// What a word is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Token {
    Number(f64),
    /// A power written as superscript digits.
    Superscript(i32),
    Name,
    Let,
    Plus,
    Minus,
    Times,
    Slash,
    Caret,
    Assign,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Not,
    /// `|`, one side of an absolute value.
    Bar,
    /// `||`: two sides of absolute values, or the word `or`.
    Bars,
    Open,
    Close,
    Comma,
    Semicolon,
    /// The end of the text.
    End,
}

/// A word and its place in the text.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Word {
    pub(super) token: Token,
    pub(super) span: Range<usize>,
}

/// Signs; a longer one stands before those that it begins with.
const SIGNS: [(&str, Token); 28] = [
    ("**", Token::Caret),
    ("<=", Token::LessEqual),
    (">=", Token::GreaterEqual),
    ("==", Token::Equal),
    ("!=", Token::NotEqual),
    ("&&", Token::And),
    ("||", Token::Bars),
    ("+", Token::Plus),
    ("-", Token::Minus),
    ("−", Token::Minus),
    ("*", Token::Times),
    ("·", Token::Times),
    ("⋅", Token::Times),
    ("×", Token::Times),
    ("/", Token::Slash),
    ("^", Token::Caret),
    ("=", Token::Assign),
    ("<", Token::Less),
    ("≤", Token::LessEqual),
    (">", Token::Greater),
    ("≥", Token::GreaterEqual),
    ("≠", Token::NotEqual),
    ("!", Token::Not),
    ("|", Token::Bar),
    ("(", Token::Open),
    (")", Token::Close),
    (",", Token::Comma),
    (";", Token::Semicolon),
];

const KEYWORDS: [(&str, Token); 4] =
    [("let", Token::Let), ("and", Token::And), ("or", Token::Or), ("not", Token::Not)];

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
const SUPERSCRIPT_MINUS: char = '⁻';

/// Splits a text into words, the last of which is the end; what is no word is left out and reported.
pub(super) fn words(text: &str) -> (Vec<Word>, Vec<Diagnostic>) {
    let mut lexer = Lexer { text, at: 0, words: Vec::new(), errors: Vec::new() };
    while lexer.errors.len() < MAX_ERRORS {
        lexer.skip_blanks();
        if lexer.at == text.len() {
            break;
        }
        if lexer.words.len() == MAX_WORDS {
            lexer.error(
                0,
                format!("the formula has more than {MAX_WORDS} words"),
                "here the limit is reached",
                "",
            );
            lexer.words.clear();
            break;
        }
        lexer.word();
    }
    // The end stands where the last word ends, so that a message about it shows that word.
    let end = lexer.words.last().map_or(0, |word| word.span.end);
    lexer.words.push(Word { token: Token::End, span: end..end });
    (lexer.words, lexer.errors)
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    words: Vec<Word>,
    errors: Vec<Diagnostic>,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        const BYTE_ORDER_MARK: char = '\u{feff}';
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start_matches(|c: char| c.is_whitespace() || c == BYTE_ORDER_MARK);
            self.at = self.text.len() - trimmed.len();
            if !trimmed.starts_with('#') && !trimmed.starts_with("//") {
                return;
            }
            self.at += trimmed.find('\n').unwrap_or(trimmed.len());
        }
    }

    fn word(&mut self) {
        let rest = self.rest();
        let first = rest.chars().next().unwrap_or_default();
        let digits = rest.strip_prefix('.').unwrap_or(rest);
        if digits.starts_with(|c: char| c.is_ascii_digit()) {
            self.number();
        } else if is_superscript(first) {
            self.superscript();
        } else if first.is_alphabetic() || first == '_' {
            let name = prefix(rest, |c| c.is_alphabetic() || c.is_ascii_digit() || c == '_');
            if name.len() > MAX_NAME {
                self.error(name.len(), format!("a name of more than {MAX_NAME} bytes"), "too long", "");
                self.at += name.len();
                return;
            }
            let keyword = KEYWORDS.iter().find(|(keyword, _)| *keyword == name);
            self.push(keyword.map_or(Token::Name, |(_, token)| *token), name.len());
        } else if let Some((sign, token)) = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign)) {
            self.push(*token, sign.len());
        } else {
            self.unexpected(first);
        }
    }

    fn push(&mut self, token: Token, length: usize) {
        self.words.push(Word { token, span: self.at..self.at + length });
        self.at += length;
    }

    fn error(&mut self, length: usize, message: String, label: &str, help: &str) {
        let error = Diagnostic::error(self.at..self.at + length, message, label);
        self.errors.push(if help.is_empty() { error } else { error.with_help(help) });
    }

    fn number(&mut self) {
        let length = number_length(self.rest());
        let digits = &self.rest()[..length];
        let value = digits.parse().unwrap_or(f64::INFINITY);
        if value == f64::INFINITY {
            self.error(length, "the number is too large".to_owned(), "above 1.8e308", "");
        }
        self.push(Token::Number(value), length);
    }

    fn superscript(&mut self) {
        let word = prefix(self.rest(), is_superscript);
        let digit =
            |c| SUPERSCRIPTS.iter().position(|&s| s == c).and_then(|d| char::from_digit(d as u32, 10));
        let plain: String = word.chars().map(|c| digit(c).unwrap_or('-')).collect();
        let power = plain.parse().unwrap_or_else(|_| {
            let message = format!("`{word}` is not a power");
            self.error(word.len(), message, "expected a whole number", "write the power as `^(…)`");
            1
        });
        self.push(Token::Superscript(power), word.len());
    }

    fn unexpected(&mut self, first: char) {
        let help = match first {
            '[' | ']' | '{' | '}' => "group with `(` and `)`",
            '%' => "write `mod(a, b)` for the remainder",
            '&' => "write `and`",
            '√' => "write `sqrt(…)`",
            '÷' => "write `/`",
            ':' => "a name is given a value by `name = value;`",
            _ => "",
        };
        let message = format!("unexpected character `{}`", first.escape_debug());
        self.error(first.len_utf8(), message, "not part of a formula", help);
        self.at += prefix(self.rest(), |c| c == first).len();
    }
}

fn is_superscript(c: char) -> bool {
    c == SUPERSCRIPT_MINUS || SUPERSCRIPTS.contains(&c)
}

/// The longest beginning of `text` of such characters.
fn prefix(text: &str, belongs: impl Fn(char) -> bool) -> &str {
    &text[..text.find(|c| !belongs(c)).unwrap_or(text.len())]
}

/// The length of the number that `text` begins with: digits, a point, digits, and an exponent if it has digits
/// (`2e` is 2·e).
fn number_length(text: &str) -> usize {
    let digits = |from: usize| prefix(&text[from..], |c| c.is_ascii_digit()).len();
    let mut length = digits(0);
    if text[length..].starts_with('.') {
        length += 1 + digits(length + 1);
    }
    if text[length..].starts_with(['e', 'E']) {
        let sign = usize::from(text[length + 1..].starts_with(['+', '-']));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}
