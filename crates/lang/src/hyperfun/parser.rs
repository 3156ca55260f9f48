//! From tokens to objects; their statements are read in `statements`.
//!
//! Errors are reported where they are found; reading goes on at the end of the statement, so that one run shows
//! several. Nothing here recurses deeper than statements may be nested.

mod statements;

pub(super) use statements::wrong_number_of_values;

use super::ast::{A, Extent, OWN, Object, S, Slot, SlotId, Statement, X};
use super::lexer::{NOT_IN_C, Names, Symbol, Token};
use super::report::{Report, Span};
use super::{builtins, hints, library};
use crate::Dialect;
use crate::diagnostic::Diagnostic;
use crate::suggest;
use rustc_hash::FxHashMap;

/// How many elements an array may have: inputs are numbered by 16 bits.
pub(super) const MAX_ELEMENTS: f64 = 65_535.0;

/// How many values all variables of an object may have.
const MAX_VALUES: usize = 1_000_000;
/// How far is looked for what a writer may have meant.
const MAX_SEARCH: usize = 10_000;

/// Stands for an error that is in the report.
pub(super) struct Reported;
pub(super) type Parsed<T> = Result<T, Reported>;

/// The objects of a text, as far as it can be read.
pub(super) fn parse(
    text: &str,
    tokens: Vec<(Token, Span)>,
    names: Names,
    dialect: Dialect,
    report: &mut Report,
) -> Vec<Object> {
    let mut parser = Parser {
        text,
        headers: Headers::new(&tokens),
        tokens,
        at: 0,
        names,
        dialect,
        report,
        objects: Vec::new(),
        scope: Scope::default(),
        blocks: 0,
        last_error: None,
    };
    parser.program();
    parser.objects
}

/// The variables of the object that is being read.
#[derive(Default)]
struct Scope {
    slots: Vec<Slot>,
    known: FxHashMap<Symbol, SlotId>,
    /// How often the object's own name was assigned.
    results: usize,
    /// How many arrays of computed length there are.
    computed: usize,
    has_statements: bool,
}

pub(super) struct Parser<'s> {
    pub(super) text: &'s str,
    tokens: Vec<(Token, Span)>,
    at: usize,
    names: Names,
    dialect: Dialect,
    pub(super) report: &'s mut Report,
    pub(super) objects: Vec<Object>,
    headers: Headers,
    scope: Scope,
    blocks: usize,
    last_error: Option<usize>,
}

/// What a header says: how an object is called.
#[derive(Clone, Copy)]
pub(super) struct Header {
    /// Where it stands, as the number of its first token.
    at: usize,
    /// The number that the object will have.
    pub(super) object: usize,
    /// The sizes of x\[\], a\[\] and s\[\]; the last only if declared.
    pub(super) coordinates: usize,
    pub(super) parameters: usize,
    pub(super) attributes: Option<usize>,
}

/// The headers of all objects, which may be called above their texts; of each name the first.
struct Headers {
    known: FxHashMap<Symbol, Header>,
}

impl Headers {
    /// In a text without errors these are all objects, in their order.
    fn new(tokens: &[(Token, Span)]) -> Self {
        let size = |at: usize| match tokens.get(at).map(|t| t.0) {
            Some(Token::Number(size)) => size as usize,
            _ => 0,
        };
        let mut headers = Self { known: FxHashMap::default() };
        for at in 0..tokens.len() {
            let Token::Name(name) = tokens[at].0 else { continue };
            if !is_header(&tokens[at..]) {
                continue;
            }
            let attributes = (tokens[at + 11].0 == Token::Comma).then(|| size(at + 14));
            let (coordinates, parameters) = (size(at + 4), size(at + 9));
            let object = headers.known.len();
            let header = Header { at, object, coordinates, parameters, attributes };
            headers.known.entry(name).or_insert(header);
        }
        headers
    }
}

/// Whether a whole header, `name(x[3], a[1]) {` or `name(x[3], a[1], s[3]) {`, begins here.
fn is_header(tokens: &[(Token, Span)]) -> bool {
    let kind = |i: usize| tokens.get(i).map(|t| t.0);
    let array = |i: usize, name: Symbol| {
        kind(i) == Some(Token::Name(name))
            && kind(i + 1) == Some(Token::OpenBracket)
            && kind(i + 3) == Some(Token::CloseBracket)
    };
    let end = |i: usize| kind(i) == Some(Token::Close) && kind(i + 1) == Some(Token::OpenBrace);
    let begins = matches!(kind(0), Some(Token::Name(_))) && kind(1) == Some(Token::Open);
    let arrays = begins && array(2, Symbol::X) && kind(6) == Some(Token::Comma) && array(7, Symbol::A);
    arrays && (end(11) || (kind(11) == Some(Token::Comma) && array(12, Symbol::S) && end(16)))
}

impl<'s> Parser<'s> {
    pub(super) fn peek(&self) -> Token {
        self.tokens[self.at].0
    }

    pub(super) fn peek_after(&self) -> Token {
        self.tokens[(self.at + 1).min(self.tokens.len() - 1)].0
    }

    pub(super) fn span(&self) -> Span {
        self.tokens[self.at].1
    }

    pub(super) fn last_span(&self) -> Span {
        self.tokens[self.at.saturating_sub(1)].1
    }

    pub(super) fn bump(&mut self) -> Span {
        let span = self.span();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        span
    }

    pub(super) fn accept(&mut self, token: Token) -> bool {
        let found = self.peek() == token;
        if found {
            self.bump();
        }
        found
    }

    pub(super) fn name(&self, symbol: Symbol) -> &str {
        self.names.text(symbol)
    }

    /// The text at a place, in quotes and not too long.
    pub(super) fn quote(&self, span: Span) -> String {
        let text = &self.text[span.range()];
        match text.char_indices().nth(40) {
            _ if text.is_empty() => "the end of the file".to_owned(),
            Some((end, _)) => format!("`{}…`", &text[..end]),
            None => format!("`{text}`"),
        }
    }

    pub(super) fn line(&self, span: Span) -> usize {
        self.text[..span.start as usize].matches('\n').count() + 1
    }

    pub(super) fn dialect(&self) -> Dialect {
        self.dialect
    }

    pub(super) fn strict(&self) -> bool {
        self.dialect == Dialect::Strict
    }

    /// Reports an error, unless one is known at this very token: the second would only be its echo.
    pub(super) fn fail(&mut self, diagnostic: Diagnostic) -> Reported {
        if self.last_error != Some(self.at) {
            self.report.add(diagnostic);
            self.last_error = Some(self.at);
        }
        Reported
    }

    /// Reports what the C interpreter would not read, if it is asked for.
    pub(super) fn extension(&mut self, span: Span, what: &str) {
        if self.strict() {
            let error = Diagnostic::error(span.range(), what, NOT_IN_C);
            self.report.add(error.with_help("the lenient dialect reads it"));
        }
    }

    pub(super) fn unexpected(&mut self, expected: &str) -> Diagnostic {
        let message = format!("unexpected {}", self.quote(self.span()));
        Diagnostic::error(self.span().range(), message, format!("expected {expected}"))
    }

    pub(super) fn expect(&mut self, token: Token, expected: &str) -> Parsed<Span> {
        if self.peek() == token {
            return Ok(self.bump());
        }
        let error = self.unexpected(expected);
        Err(self.fail(error))
    }

    fn program(&mut self) {
        while self.peek() != Token::End && !self.report.is_full() {
            let start = self.at;
            if self.report.has_errors() && self.peek_after() != Token::Open {
                // After an error, what does not look like an object is the rest of the one before.
                self.skip_to_header(start);
                continue;
            }
            match self.object() {
                Ok(object) => self.objects.push(object),
                Err(Reported) => self.skip_to_header(start),
            }
        }
        if self.objects.is_empty() && !self.report.has_errors() {
            let error =
                Diagnostic::error(0..0, "the file has no object", "expected `my_model(x[3], a[1]) { … }`");
            self.fail(error.with_help(
                "an object is a function of the point x[]: `my_model(x[3], a[1]) { my_model = 1 - x[1]; }`",
            ));
        }
    }

    fn skip_to_header(&mut self, start: usize) {
        self.at = self.at.max(start + 1).min(self.tokens.len() - 1);
        while self.peek() != Token::End && !is_header(&self.tokens[self.at..]) {
            self.bump();
        }
    }

    fn object(&mut self) -> Parsed<Object> {
        let (span, errors) = (self.span(), self.report.error_count());
        let Token::Name(name) = self.peek() else {
            let error = self.unexpected("an object: `name(x[3], a[1]) { … }`");
            return Err(self.fail(error));
        };
        self.check_object_name(name, span);
        self.bump();
        let (coordinates, parameters, attributes) = self.header()?;
        self.open_scope(name, [coordinates, parameters, attributes.unwrap_or(1)]);
        let open = self.expect(Token::OpenBrace, "`{`")?;
        let body = self.body(open)?;
        if self.scope.results == 0 && errors == self.report.error_count() {
            let message = format!("`{}` never gets its value", self.name(name));
            let label = format!("expected `{} = …;` before the `}}`", self.name(name));
            self.report.error(span, message, label);
        }
        let slots = std::mem::take(&mut self.scope.slots);
        Ok(Object {
            name: self.name(name).to_owned(),
            span,
            coordinates,
            parameters,
            attributes,
            slots,
            body,
        })
    }

    fn check_object_name(&mut self, name: Symbol, span: Span) {
        let text = self.name(name);
        if let Some(first) = self.header_of(name).filter(|header| header.at < self.at) {
            let message = format!("two objects are called `{text}`");
            let error = Diagnostic::error(span.range(), message, "second object of this name");
            let help = format!("the first one begins in line {}", self.line(self.tokens[first.at].1));
            self.report.add(error.with_help(help));
        } else if let Some(what) = self.reserved(name) {
            self.report.error(span, format!("`{text}` is {what}"), "expected another name");
        }
    }

    /// What stops a name from being an object or a variable.
    fn reserved(&self, name: Symbol) -> Option<&'static str> {
        let text = self.name(name);
        if matches!(name, Symbol::X | Symbol::A | Symbol::S) {
            Some("the name of an array that every object has")
        } else if builtins::lookup(text).is_some() || library::lookup(text, self.dialect).is_some() {
            Some("the name of a function")
        } else {
            None
        }
    }

    fn header(&mut self) -> Parsed<(usize, usize, Option<usize>)> {
        const FORM: &str = "`(`: objects begin with `name(x[3], a[1]) {`";
        self.expect(Token::Open, FORM)?;
        let coordinates = self.header_array(Symbol::X, "`x[3]`, the coordinates")?;
        self.expect(Token::Comma, "`, a[1]`: parameters are declared even if there are none")?;
        let parameters = self.header_array(Symbol::A, "`a[1]`, the parameters")?;
        let mut attributes = None;
        if self.accept(Token::Comma) {
            attributes = Some(self.header_array(Symbol::S, "`s[3]`, the attributes")?);
        }
        self.expect(Token::Close, if attributes.is_some() { "`)`" } else { "`)` or `, s[3]`" })?;
        Ok((coordinates, parameters, attributes))
    }

    fn header_array(&mut self, name: Symbol, expected: &str) -> Parsed<usize> {
        self.expect(Token::Name(name), expected)?;
        self.expect(Token::OpenBracket, "`[` and a size")?;
        self.size()
    }

    /// A size and its closing bracket.
    fn size(&mut self) -> Parsed<usize> {
        let span = self.span();
        let Token::Number(size) = self.peek() else {
            let error = self.unexpected("a size").with_help("sizes are whole numbers, written out");
            return Err(self.fail(error));
        };
        if size.fract() != 0.0 || !(1.0..=MAX_ELEMENTS).contains(&size) {
            let text = &self.text[span.range()];
            let message = match size > MAX_ELEMENTS {
                true => format!("an array has at most {MAX_ELEMENTS} elements, not {text}"),
                false => format!("an array cannot have {text} elements"),
            };
            let label = format!("expected a whole number from 1 to {MAX_ELEMENTS}");
            return Err(self.fail(Diagnostic::error(span.range(), message, label)));
        }
        self.bump();
        self.expect(Token::CloseBracket, "`]`")?;
        Ok(size as usize)
    }

    fn open_scope(&mut self, own: Symbol, sizes: [usize; 3]) {
        self.scope = Scope::default();
        for (name, size) in [Symbol::X, Symbol::A, Symbol::S].into_iter().zip(sizes) {
            self.declare(name, Extent::Array(size));
        }
        // The own name is assignable everywhere, but a variable only once it has a value.
        let slot = self.declare(own, Extent::Scalar);
        debug_assert_eq!([X, A, S, OWN], [0, 1, 2, slot]);
    }

    fn declare(&mut self, name: Symbol, extent: Extent) -> SlotId {
        let slots = &mut self.scope.slots;
        let offset = slots.last().map_or(0, Slot::end);
        slots.push(Slot { name: self.names.text(name).to_owned(), offset, extent });
        self.scope.known.insert(name, slots.len() - 1);
        slots.len() - 1
    }

    fn body(&mut self, open: Span) -> Parsed<Vec<Statement>> {
        let mut statements = Vec::new();
        loop {
            statements.append(&mut self.block());
            match self.peek() {
                Token::CloseBrace => {
                    self.bump();
                    return Ok(statements);
                }
                Token::Else | Token::Endif | Token::Endloop if !self.report.is_full() => {
                    let opener = if self.peek() == Token::Endloop { "`while`" } else { "`if`" };
                    let message = format!("{} without {opener}", self.quote(self.span()));
                    let error = Diagnostic::error(self.span().range(), message, "nothing to close here");
                    self.fail(error);
                    self.bump();
                    self.accept(Token::Semicolon);
                }
                _ => {
                    let help = format!("`{{` in line {} is still open", self.line(open));
                    let error = self.unexpected("`}` or a statement").with_help(help);
                    return Err(self.fail(error));
                }
            }
        }
    }

    pub(super) fn undeclared_array(&mut self, name: Symbol, span: Span) -> Reported {
        let text = self.name(name).to_owned();
        if self.variable(name).is_some() {
            let message = format!("`{text}` is a number, not an array");
            return self.fail(Diagnostic::error(span.range(), message, "has no elements"));
        }
        let error = Diagnostic::error(span.range(), format!("`{text}` is not an array"), "unknown array");
        let arrays = self.scope.slots.iter().filter(|slot| slot.is_array()).map(|slot| slot.name.as_str());
        let help = match suggest::closest(&text, arrays) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("arrays are declared before they are used: `array {text}[3];`"),
        };
        self.fail(error.with_help(help))
    }

    /// The slot of a name, if it is a variable at this place of the text.
    pub(super) fn variable(&self, name: Symbol) -> Option<SlotId> {
        let slot = self.scope.known.get(&name).copied();
        slot.filter(|&slot| slot != OWN || self.scope.results > 0)
    }

    pub(super) fn slot(&self, slot: SlotId) -> &Slot {
        &self.scope.slots[slot]
    }

    /// The header of an object of the text.
    pub(super) fn header_of(&self, name: Symbol) -> Option<Header> {
        self.headers.known.get(&name).copied()
    }

    /// The name of the object that is being read.
    pub(super) fn own_name(&self) -> &str {
        &self.scope.slots[OWN].name
    }

    /// Whether a header stands behind this place.
    pub(super) fn is_further_down(&self, header: Header) -> bool {
        header.at > self.at
    }

    /// The names of all objects.
    pub(super) fn object_names(&self) -> Vec<&str> {
        let mut headers: Vec<_> = self.headers.known.iter().collect();
        headers.sort_unstable_by_key(|(_, header)| header.at);
        headers.into_iter().map(|(name, _)| self.name(*name)).collect()
    }

    /// Reports a name without a value, which counts as a variable from then on.
    pub(super) fn unknown_variable(&mut self, name: Symbol, span: Span) {
        let text = self.name(name).to_owned();
        let later = self.tokens[self.at..].windows(2).take(MAX_SEARCH);
        let later = later.take_while(|w| w[0].0 != Token::CloseBrace);
        let assigned_later = later.into_iter().any(|w| w[0].0 == Token::Name(name) && w[1].0 == Token::Equal);
        let known =
            self.scope.slots.iter().enumerate().filter(|(i, _)| *i != OWN).map(|(_, s)| s.name.as_str());
        let known = known.take(MAX_SEARCH);
        let help = if assigned_later {
            "it gets its value only further down".to_owned()
        } else if let Some(help) = hints::foreign_value(&text) {
            help.to_owned()
        } else if let Some(near) = suggest::closest(&text, known) {
            format!("did you mean `{near}`?")
        } else {
            format!("assign it first: `{text} = …;`")
        };
        let error =
            Diagnostic::error(span.range(), format!("`{text}` has no value here"), "unknown variable");
        self.report.add(error.with_help(help));
        if !self.scope.known.contains_key(&name) {
            self.declare(name, Extent::Scalar);
        }
    }
}
