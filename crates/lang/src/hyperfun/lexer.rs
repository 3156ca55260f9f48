//! From text to tokens.
//!
//! Letter case means nothing in HyperFun: names are lower-cased here. What other languages write instead of a
//! HyperFun symbol (`==`, `&&`, `//` …) is reported and read as meant, so that one slip gives one error.
//!
//! Numbers mean what they say in both dialects. The strict one refuses the forms that the C interpreter refuses (`01`,
//! `1e05`) and carriage returns. It does not follow that interpreter in reading `1e-12` as 10⁻⁸: that is a slip of its
//! scanner, which no model means.

use super::report::{Report, Span};
use crate::Dialect;
use crate::diagnostic::{Diagnostic, MAX_NAME, MAX_WORDS};
use rustc_hash::FxHashMap;

/// A lower-cased name, by number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Symbol(u32);

impl Symbol {
    pub(super) const X: Symbol = Symbol(0);
    pub(super) const A: Symbol = Symbol(1);
    pub(super) const S: Symbol = Symbol(2);
}

/// The names of a text.
pub(super) struct Names {
    list: Vec<String>,
    known: FxHashMap<String, Symbol>,
}

impl Names {
    fn new() -> Self {
        let mut names = Self { list: Vec::new(), known: FxHashMap::default() };
        for name in ["x", "a", "s"] {
            names.intern(name.to_owned());
        }
        names
    }

    fn intern(&mut self, name: String) -> Symbol {
        let next = Symbol(self.list.len() as u32);
        *self.known.entry(name).or_insert_with_key(|name| {
            self.list.push(name.clone());
            next
        })
    }

    pub(super) fn text(&self, symbol: Symbol) -> &str {
        &self.list[symbol.0 as usize]
    }
}

/// What the grammar knows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Token {
    Name(Symbol),
    Number(f64),
    String,
    And,
    Or,
    Not,
    Array,
    If,
    Then,
    Else,
    Endif,
    While,
    Loop,
    Endloop,
    Open,
    Close,
    OpenBracket,
    CloseBracket,
    OpenBrace,
    CloseBrace,
    Comma,
    Semicolon,
    Plus,
    Minus,
    Times,
    Divide,
    Power,
    Union,
    Intersect,
    Subtract,
    Complement,
    Product,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    End,
}

const KEYWORDS: &[(&str, Token)] = &[
    ("and", Token::And),
    ("or", Token::Or),
    ("not", Token::Not),
    ("array", Token::Array),
    ("if", Token::If),
    ("then", Token::Then),
    ("else", Token::Else),
    ("endif", Token::Endif),
    ("while", Token::While),
    ("loop", Token::Loop),
    ("endloop", Token::Endloop),
];

/// Symbols, longer ones before their beginnings.
const SYMBOLS: &[(&str, Token)] = &[
    ("/=", Token::Unequal),
    ("<=", Token::LessEqual),
    (">=", Token::GreaterEqual),
    ("(", Token::Open),
    (")", Token::Close),
    ("[", Token::OpenBracket),
    ("]", Token::CloseBracket),
    ("{", Token::OpenBrace),
    ("}", Token::CloseBrace),
    (",", Token::Comma),
    (";", Token::Semicolon),
    ("+", Token::Plus),
    ("-", Token::Minus),
    ("*", Token::Times),
    ("/", Token::Divide),
    ("^", Token::Power),
    ("|", Token::Union),
    ("&", Token::Intersect),
    ("\\", Token::Subtract),
    ("~", Token::Complement),
    ("@", Token::Product),
    ("=", Token::Equal),
    ("<", Token::Less),
    (">", Token::Greater),
];

/// What other languages write, the token that it is read as, and how HyperFun writes it.
const FOREIGN: &[(&str, Token, &str)] = &[
    ("==", Token::Equal, "equality is written `=`"),
    ("!=", Token::Unequal, "`not equal` is written `/=`"),
    ("<>", Token::Unequal, "`not equal` is written `/=`"),
    (":=", Token::Equal, "assignments are written `=`"),
    ("=<", Token::LessEqual, "`at most` is written `<=`"),
    ("=>", Token::GreaterEqual, "`at least` is written `>=`"),
    ("&&", Token::And, "both conditions: `and`; the intersection of solids: `&`"),
    ("||", Token::Or, "either condition: `or`; the union of solids: `|`"),
    ("**", Token::Power, "powers are written `^`"),
    ("!", Token::Not, "negation is written `not`"),
    ("%", Token::Divide, "the remainder of a division is `mod(a, b)`"),
    ("\u{2212}", Token::Minus, "the minus sign is the ASCII `-`"),
    ("\u{2013}", Token::Minus, "the minus sign is the ASCII `-`"),
    ("\u{d7}", Token::Times, "products are written `*`"),
    ("\u{b7}", Token::Times, "products are written `*`"),
];

/// The tokens of a text, `End` last, and its names; `None` if there are too many tokens or errors.
pub(super) fn tokenize(
    text: &str,
    dialect: Dialect,
    report: &mut Report,
) -> Option<(Vec<(Token, Span)>, Names)> {
    let mut lexer = Lexer { text, at: 0, names: Names::new(), report };
    if dialect == Dialect::Strict {
        lexer.carriage_return();
    }
    let mut tokens = Vec::new();
    while let Some((token, span)) = lexer.next() {
        if dialect == Dialect::Strict && matches!(token, Token::Number(_)) {
            lexer.check_number(span);
        }
        if tokens.len() == MAX_WORDS {
            let message = format!("the text has more than {MAX_WORDS} words");
            lexer.report.error(span, message, "here the limit is reached");
            return None;
        }
        tokens.push((token, span));
    }
    tokens.push((Token::End, Span::new(text.len(), text.len())));
    (!lexer.report.is_full()).then_some((tokens, lexer.names))
}

/// The label of what only the lenient dialect reads.
pub(super) const NOT_IN_C: &str = "not in the language of the C interpreter";

struct Lexer<'s, 'r> {
    text: &'s str,
    at: usize,
    names: Names,
    report: &'r mut Report,
}

impl<'s> Lexer<'s, '_> {
    fn rest(&self) -> &'s str {
        &self.text[self.at..]
    }

    /// Moves on by `length` bytes, which are returned as a place.
    fn take(&mut self, length: usize) -> Span {
        let start = self.at;
        self.at += length;
        Span::new(start, self.at)
    }

    fn next(&mut self) -> Option<(Token, Span)> {
        while !self.report.is_full() {
            self.skip_blanks();
            let first = self.rest().chars().next()?;
            if first.is_ascii_alphabetic() || first == '_' {
                return Some(self.name());
            }
            if let Some(length) = number_length(self.rest().as_bytes()) {
                let value = self.rest()[..length].parse().unwrap_or(f64::NAN);
                let span = self.take(length);
                if value == f64::INFINITY {
                    self.report.error(span, "the number is too large", "above 1.8e308");
                }
                return Some((Token::Number(value), span));
            }
            if first == '"' {
                return Some(self.string());
            }
            if let Some(found) = self.symbol() {
                return Some(found);
            }
            self.illegal();
        }
        None
    }

    /// Reports the first carriage return, an illegal character of the C interpreter.
    fn carriage_return(&mut self) {
        if let Some(at) = self.text.find('\r') {
            let span = Span::new(at, at + 1);
            let error = Diagnostic::error(span.range(), "a carriage return", NOT_IN_C);
            self.report.add(error.with_help("end lines with a line feed alone, or use the lenient dialect"));
        }
    }

    /// Reports a number that the C interpreter refuses: one that begins with a superfluous 0, or whose exponent begins
    /// with 0.
    fn check_number(&mut self, span: Span) {
        let text = self.text[span.range()].as_bytes();
        let exponent = text.iter().position(|b| matches!(b, b'e' | b'E')).map(|e| &text[e + 1..]);
        let exponent = exponent.map(|e| e.strip_prefix(b"-").or(e.strip_prefix(b"+")).unwrap_or(e));
        let what = if text.len() > 1 && text[0] == b'0' && text[1].is_ascii_digit() {
            "a number that begins with 0"
        } else if exponent.is_some_and(|digits| digits.first() == Some(&b'0')) {
            "an exponent that begins with 0"
        } else {
            return;
        };
        let error = Diagnostic::error(span.range(), what, NOT_IN_C);
        self.report.add(error.with_help("the lenient dialect reads it"));
    }

    /// Blanks, comments, and what others write as comments.
    fn skip_blanks(&mut self) {
        loop {
            let rest = self.rest();
            let blanks = rest.len()
                - rest.trim_start_matches([' ', '\t', '\n', '\r', '\u{c}', '\u{a0}', '\u{feff}']).len();
            self.at += blanks;
            let rest = self.rest();
            let line = || rest.find(['\n', '\r']).unwrap_or(rest.len());
            if rest.starts_with("--") {
                self.at += line();
            } else if rest.starts_with("//") {
                self.foreign_comment(line());
            } else if rest.starts_with("/*") {
                self.foreign_comment(rest.find("*/").map_or(rest.len(), |end| end + 2));
            } else {
                return;
            }
        }
    }

    fn foreign_comment(&mut self, length: usize) {
        let span = Span::new(self.at, self.at + 2);
        self.at += length;
        let message = "this is not how comments are written";
        let error = Diagnostic::error(span.range(), message, "expected `--`");
        self.report.add(error.with_help("a comment goes from `--` to the end of the line"));
    }

    fn name(&mut self) -> (Token, Span) {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let length = self.rest().find(|c| !is_part(c)).unwrap_or(self.rest().len());
        let text = self.rest()[..length.min(MAX_NAME)].to_ascii_lowercase();
        let span = self.take(length);
        if length > MAX_NAME {
            self.report.error(span, format!("a name of more than {MAX_NAME} letters"), "too long");
        }
        if text.starts_with('_') {
            self.report.error(span, "a name begins with a letter", "not with an underscore");
        }
        if text == "xor" {
            let error =
                Diagnostic::error(span.range(), "`xor` is reserved and has no meaning", "expected `or`");
            self.report.add(error.with_help("write `(a or b) and not (a and b)`"));
            return (Token::Or, span);
        }
        let keyword = KEYWORDS.iter().find(|(word, _)| *word == text);
        (keyword.map_or_else(|| Token::Name(self.names.intern(text)), |(_, token)| *token), span)
    }

    fn string(&mut self) -> (Token, Span) {
        let rest = &self.rest()[1..];
        let length = rest.find(['"', '\n', '\r']).unwrap_or(rest.len());
        let closed = rest[length..].starts_with('"');
        let span = self.take(1 + length + usize::from(closed));
        if !closed {
            self.report.error(span, "the string does not end on its line", "expected a closing `\"`");
        }
        (Token::String, span)
    }

    fn symbol(&mut self) -> Option<(Token, Span)> {
        let rest = self.rest();
        if let Some((text, token, help)) = FOREIGN.iter().find(|(text, ..)| rest.starts_with(text)) {
            let span = self.take(text.len());
            let error =
                Diagnostic::error(span.range(), format!("`{text}` is not HyperFun"), "unknown symbol");
            self.report.add(error.with_help(*help));
            return Some((*token, span));
        }
        let (text, token) = SYMBOLS.iter().find(|(text, _)| rest.starts_with(text))?;
        Some((*token, self.take(text.len())))
    }

    /// Reports and skips characters that nothing begins with.
    fn illegal(&mut self) {
        let known = |c: char| {
            c.is_ascii_alphanumeric() || c.is_ascii_whitespace() || "_\"()[]{},;+-*/^|&\\~@=<>.".contains(c)
        };
        let first = self.rest().chars().next().map_or(1, char::len_utf8);
        let more = &self.rest()[first..];
        let run = more.find(known).unwrap_or(more.len());
        let span = self.take(first + run);
        let text: String = self.text[span.range()].chars().take(20).collect();
        let error =
            Diagnostic::error(span.range(), format!("`{text}` has no meaning here"), "illegal characters");
        self.report.add(error);
    }
}

/// How many bytes of `text` are a number: digits with or without a point, then perhaps an exponent.
fn number_length(text: &[u8]) -> Option<usize> {
    let digits = |from: usize| text[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(0);
    let mut length = whole;
    if text.get(whole) == Some(&b'.') {
        let fraction = digits(whole + 1);
        if whole + fraction == 0 {
            return None;
        }
        length = whole + 1 + fraction;
    }
    if length == 0 {
        return None;
    }
    if matches!(text.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(length + 1), Some(b'+' | b'-')));
        let from = (length + 1 + sign).min(text.len());
        if digits(from) > 0 {
            length = from + digits(from);
        }
    }
    Some(length)
}
