//! From words to a tree: statements.

use super::Setting;
use super::lexer::{Token, Word, words};
use super::names::{BuiltIn, Defined, built_in, check_definition, unknown_name};
use super::tree::{Definition, Expr, ExprId, Formula, Infix};
use crate::diagnostic::{Diagnostic, MAX_ERRORS};
use fieldstone_field::Binary;
use std::collections::HashSet;
use std::ops::Range;

/// Reads a formula, or says what is wrong with it.
pub(super) fn parse<'a>(text: &'a str, setting: &Setting<'a>) -> Result<Formula, Vec<Diagnostic>> {
    let (words, errors) = words(text);
    let mut parser = Parser {
        text,
        words,
        at: 0,
        exprs: Vec::new(),
        definitions: Vec::new(),
        defined: Defined::new(),
        unknown: HashSet::new(),
        value: None,
        how_to_define: setting.how_to_define,
        errors,
    };
    parser.assume(setting.parameters);
    while parser.token() != Token::End && parser.errors.len() < MAX_ERRORS {
        if let Err(error) = parser.statement() {
            parser.report(error);
            parser.skip_statement();
        }
    }
    match parser.value {
        Some(value) if parser.errors.is_empty() => {
            Ok(Formula { exprs: parser.exprs, definitions: parser.definitions, value })
        }
        _ => Err(parser.into_errors()),
    }
}

/// A text that is being read, and what was read of it.
pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    /// All words; the last is the end.
    pub(super) words: Vec<Word>,
    pub(super) at: usize,
    exprs: Vec<Expr>,
    definitions: Vec<Definition>,
    pub(super) defined: Defined<'a>,
    value: Option<ExprId>,
    /// See [`Setting`].
    how_to_define: fn(&str) -> String,
    /// The names without a meaning that were reported.
    unknown: HashSet<&'a str>,
    errors: Vec<Diagnostic>,
}

impl<'a> Parser<'a> {
    /// Defines names that the text need not define.
    fn assume(&mut self, parameters: &'a [(String, f64)]) {
        for (name, value) in parameters {
            let value = self.push(Expr::Number(*value));
            self.defined.insert(name, self.definitions.len());
            self.definitions.push(Definition { name: name.clone(), value });
        }
    }

    pub(super) fn token(&self) -> Token {
        self.words[self.at].token
    }

    pub(super) fn span(&self) -> Range<usize> {
        self.words[self.at].span.clone()
    }

    /// The token after the next.
    pub(super) fn second(&self) -> Token {
        self.words.get(self.at + 1).map_or(Token::End, |word| word.token)
    }

    pub(super) fn word_text(&self) -> &'a str {
        &self.text[self.span()]
    }

    /// Goes past the next word, but never past the end.
    pub(super) fn advance(&mut self) {
        self.at = (self.at + 1).min(self.words.len() - 1);
    }

    pub(super) fn push(&mut self, expr: Expr) -> ExprId {
        self.exprs.push(expr);
        ExprId(self.exprs.len() - 1)
    }

    /// What stands in a formula in error, which is never evaluated.
    pub(super) fn placeholder(&mut self) -> ExprId {
        self.push(Expr::Number(f64::NAN))
    }

    pub(super) fn found(&self) -> String {
        match self.token() {
            Token::End => "the end of the text".to_owned(),
            _ => format!("`{}`", self.word_text()),
        }
    }

    fn skip_statement(&mut self) {
        while !matches!(self.token(), Token::Semicolon | Token::End) {
            self.advance();
        }
        self.advance();
    }

    fn into_errors(self) -> Vec<Diagnostic> {
        let end = self.span();
        let mut errors = self.errors;
        if errors.is_empty() {
            let error = Diagnostic::error(end, "there is no formula", "expected a formula");
            errors.push(error.with_help("write a function that is negative inside: `x^2 + y^2 + z^2 - 1`"));
        }
        errors
    }

    /// One statement with the `;` after it.
    fn statement(&mut self) -> Result<(), Diagnostic> {
        match self.token() {
            Token::Semicolon => {
                self.advance();
                Ok(())
            }
            Token::Let => self.let_statement(),
            Token::Name if self.second() == Token::Assign => self.named_statement(false),
            _ => self.formula_statement(),
        }
    }

    fn let_statement(&mut self) -> Result<(), Diagnostic> {
        const HELP: &str = "a definition is written `let name = value;`";
        self.advance();
        if self.token() != Token::Name {
            return Err(self.expected("a name", HELP));
        }
        if self.second() != Token::Assign {
            self.advance();
            return Err(self.expected("`=`", HELP));
        }
        self.named_statement(true)
    }

    fn expected(&self, what: &str, help: &str) -> Diagnostic {
        let message = format!("expected {what}, found {}", self.found());
        Diagnostic::error(self.span(), message, format!("expected {what}")).with_help(help)
    }

    /// `name = value;`, or the equation `name = value` without `;`.
    fn named_statement(&mut self, is_let: bool) -> Result<(), Diagnostic> {
        let (name_at, name, span) = (self.at, self.word_text(), self.span());
        self.advance();
        self.advance();
        let value = self.expression();
        let mut rest = self.words[self.at..].iter().map(|word| word.token);
        let is_definition =
            rest.find(|t| matches!(t, Token::Semicolon | Token::End)) == Some(Token::Semicolon);
        if is_definition {
            // A value in error still gives the name a meaning, so that its uses are not errors too.
            let (value, error) =
                value.map_or_else(|error| (self.placeholder(), Some(error)), |id| (id, None));
            self.define(name, span, value);
            return error.map_or_else(|| self.end_of_definition(), Err);
        }
        let right = value?;
        if is_let {
            let help = "a definition is written `let name = value;`, and the formula after it";
            return Err(self.expected("`;`", help));
        }
        let left = self.variable(name_at);
        self.equation(left, right, span.start)
    }

    fn end_of_definition(&mut self) -> Result<(), Diagnostic> {
        if self.token() == Token::Assign {
            return Err(self.second_equals());
        }
        self.advance();
        Ok(())
    }

    fn define(&mut self, name: &'a str, span: Range<usize>, value: ExprId) {
        match check_definition(name, &span, &self.defined) {
            Ok(()) => {
                self.defined.insert(name, self.definitions.len());
                self.definitions.push(Definition { name: name.to_owned(), value });
            }
            Err(error) => self.report(error),
        }
    }

    /// A function or an equation.
    fn formula_statement(&mut self) -> Result<(), Diagnostic> {
        let start = self.span().start;
        let left = self.expression()?;
        if self.token() != Token::Assign {
            return self.end_of_formula(left, start);
        }
        self.advance();
        let right = self.expression()?;
        self.equation(left, right, start)
    }

    fn equation(&mut self, left: ExprId, right: ExprId, start: usize) -> Result<(), Diagnostic> {
        if self.token() == Token::Assign {
            return Err(self.second_equals());
        }
        let value = self.push(Expr::Infix(Infix::Plain(Binary::Sub), left, right));
        self.end_of_formula(value, start)
    }

    fn second_equals(&self) -> Diagnostic {
        Diagnostic::error(self.span(), "a second `=` in one equation", "not expected")
            .with_help("an equation has two sides: `f = g`; a comparison is written `==`")
    }

    /// Takes the formula that began at byte `start`, and the `;` after it if there is one.
    fn end_of_formula(&mut self, value: ExprId, start: usize) -> Result<(), Diagnostic> {
        let span = start..self.words[self.at.saturating_sub(1)].span.end.max(start);
        self.advance();
        if self.value.replace(value).is_some() {
            let error = Diagnostic::error(span, "a second formula", "there is one already");
            self.report(error.with_help("a text is one formula; join solids by `min(f, g)`"));
        } else if self.exprs[value.0].is_condition() {
            let error =
                Diagnostic::error(span, "the formula is a condition, not a function", "true or false");
            self.report(error.with_help("for the solid where f < g, write `f - g`"));
        }
        Ok(())
    }

    /// Notes an error, unless there are enough of them.
    pub(super) fn report(&mut self, error: Diagnostic) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(error);
        }
    }

    /// Notes that the name at word `at` means nothing, once for each name.
    pub(super) fn report_unknown(&mut self, at: usize) {
        let name = &self.text[self.words[at].span.clone()];
        if self.errors.len() < MAX_ERRORS && self.unknown.insert(name) {
            let error = unknown_name(self.text, &self.words, at, (&self.defined, self.how_to_define));
            self.report(error);
        }
    }

    /// The value of the name at word `at`.
    pub(super) fn variable(&mut self, at: usize) -> ExprId {
        let name = &self.text[self.words[at].span.clone()];
        let expr = match (built_in(name), self.defined.get(name)) {
            (_, Some(&number)) => Expr::Defined(number),
            (Some(BuiltIn::Input(input)), None) => Expr::Input(input),
            (Some(BuiltIn::Constant(value)), None) => Expr::Number(value),
            (None, None) => {
                self.report_unknown(at);
                Expr::Number(f64::NAN)
            }
        };
        self.push(expr)
    }
}
