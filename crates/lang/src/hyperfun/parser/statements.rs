//! From tokens to statements.

use super::{MAX_VALUES, Parsed, Parser, Reported, is_header};
use crate::diagnostic::Diagnostic;
use crate::hyperfun::ast::{A, Code, Extent, OWN, Slot, SlotId, Statement, X};
use crate::hyperfun::lexer::{Symbol, Token};
use crate::hyperfun::report::Span;
use crate::hyperfun::{expression, hints};

/// How deep `if` and `while` may be nested in a text.
const MAX_BLOCKS: usize = 250;

impl Parser<'_> {
    /// Statements up to what can only end the block.
    pub(super) fn block(&mut self) -> Vec<Statement> {
        let mut statements = Vec::new();
        loop {
            let start = self.at;
            match self.peek() {
                Token::CloseBrace | Token::Else | Token::Endif | Token::Endloop | Token::End => {
                    return statements;
                }
                _ if self.report.is_full() || is_header(&self.tokens[start..]) => return statements,
                Token::Semicolon => {
                    let span = self.bump();
                    self.extension(span, "an empty statement");
                }
                _ => match self.statement() {
                    Ok(statement) => statements.extend(statement),
                    Err(Reported) => self.recover(start),
                },
            }
        }
    }

    /// Goes to the end of a statement that could not be read.
    fn recover(&mut self, start: usize) {
        if self.at == start {
            self.bump();
        }
        loop {
            match self.peek() {
                Token::Semicolon => {
                    self.bump();
                    return;
                }
                Token::CloseBrace
                | Token::If
                | Token::While
                | Token::Else
                | Token::Endif
                | Token::Endloop => return,
                Token::Array | Token::End => return,
                _ if is_header(&self.tokens[self.at..]) => return,
                _ => self.bump(),
            };
        }
    }

    fn statement(&mut self) -> Parsed<Vec<Statement>> {
        if self.peek() == Token::Array {
            return self.array_declaration();
        }
        self.scope.has_statements = true;
        if self.strict() && self.scope.results > 0 {
            let span = self.span();
            self.extension(span, "a statement after the object got its value");
        }
        match self.peek() {
            Token::If => self.nested(Self::if_statement),
            Token::While => self.nested(Self::while_statement),
            Token::Name(name) => self.assignment(name),
            _ => {
                let error = self.unexpected("a statement");
                let help = "statements are `name = …;`, `name[i] = …;`, `if … then … endif;`, `while … loop … endloop;`";
                Err(self.fail(error.with_help(help)))
            }
        }
        .map(|statement| vec![statement])
    }

    fn nested(&mut self, parse: fn(&mut Self) -> Parsed<Statement>) -> Parsed<Statement> {
        if self.blocks >= MAX_BLOCKS {
            let message = format!("more than {MAX_BLOCKS} statements inside each other");
            let error = Diagnostic::error(self.span().range(), message, "nested too deep");
            return Err(self.fail(error));
        }
        self.blocks += 1;
        let statement = parse(self);
        self.blocks -= 1;
        statement
    }

    /// `array name[size], …;`: statements for the sizes that have to be computed.
    fn array_declaration(&mut self) -> Parsed<Vec<Statement>> {
        let keyword = self.bump();
        if self.scope.has_statements {
            self.extension(keyword, "an array declared after the first statement");
        }
        let mut statements = Vec::new();
        loop {
            statements.extend(self.declared_array()?);
            if !self.accept(Token::Comma) {
                self.semicolon()?;
                return Ok(statements);
            }
        }
    }

    fn declared_array(&mut self) -> Parsed<Option<Statement>> {
        let span = self.span();
        let Token::Name(name) = self.peek() else {
            let error = self.unexpected("the name of an array");
            return Err(self.fail(error));
        };
        if let Some(what) = self.reserved(name) {
            let message = format!("`{}` is {what}", self.name(name));
            return Err(self.fail(Diagnostic::error(span.range(), message, "expected another name")));
        }
        self.bump();
        self.expect(Token::OpenBracket, "`[` and a size")?;
        let is_number = matches!(self.peek(), Token::Number(_)) && self.peek_after() == Token::CloseBracket;
        if is_number || self.strict() {
            let size = self.size()?;
            self.declare_array(name, span, Extent::Array(size));
            if self.scope.slots.last().is_some_and(|slot| slot.end() > MAX_VALUES) {
                let message = format!("`{}` has more than {MAX_VALUES} values in all", self.own_name());
                return Err(self.fail(Diagnostic::error(span.range(), message, "here the limit is reached")));
            }
            return Ok(None);
        }
        let start = self.span();
        let length = expression::parse(self, false)?;
        let place = start.to(self.last_span());
        self.expect(Token::CloseBracket, "an operator or `]`")?;
        let number = self.scope.computed;
        self.scope.computed += 1;
        let declared = self.declare_array(name, span, Extent::Computed(number));
        Ok(declared.map(|target| Statement::Declare { target, length, span: place }))
    }

    /// A new array; an error if the name has another meaning here.
    fn declare_array(&mut self, name: Symbol, span: Span, extent: Extent) -> Option<SlotId> {
        if self.scope.known.contains_key(&name) {
            let message = format!("`{}` exists already", self.name(name));
            self.report.error(span, message, "second declaration");
            return None;
        }
        Some(self.declare(name, extent))
    }

    /// The end of a statement.
    fn semicolon(&mut self) -> Parsed<()> {
        if self.accept(Token::Semicolon) {
            return Ok(());
        }
        let last = self.last_span();
        let new_line = self.text[last.end as usize..self.span().start as usize].contains(['\n', '\r']);
        let closes = matches!(self.peek(), Token::CloseBrace | Token::Else | Token::Endif | Token::Endloop);
        let begins = matches!(self.peek(), Token::If | Token::While | Token::Array | Token::Name(_));
        let mut error = if new_line || closes {
            Diagnostic::error(last.after().range(), "the statement does not end", "expected `;`")
        } else {
            self.unexpected("an operator or `;`")
        };
        let word = &self.text[last.range()];
        if word.eq_ignore_ascii_case("endif") || word.eq_ignore_ascii_case("endloop") {
            error = error.with_help("`;` stands after `endif` and `endloop`, too");
        } else if let (Token::Name(_), false) = (self.peek(), new_line) {
            error = error.with_help("products are written with `*`");
        }
        let reported = self.fail(error);
        if closes || (begins && new_line) { Ok(()) } else { Err(reported) }
    }

    fn if_statement(&mut self) -> Parsed<Statement> {
        let span = self.bump();
        let condition = self.condition(Token::Then)?;
        self.expect_word(Token::Then, "then", "after the condition of `if` stands `then`")?;
        let then = self.block();
        let otherwise = if self.accept(Token::Else) { self.block() } else { Vec::new() };
        self.close_block(Token::Endif, "`endif`", span)?;
        Ok(Statement::If { condition, then, otherwise, span })
    }

    fn while_statement(&mut self) -> Parsed<Statement> {
        let span = self.bump();
        let condition = self.condition(Token::Loop)?;
        self.expect_word(Token::Loop, "loop", "after the condition of `while` stands `loop`")?;
        let body = self.block();
        self.close_block(Token::Endloop, "`endloop`", span)?;
        Ok(Statement::While { condition, body, span })
    }

    /// The condition in front of a word. If it cannot be read, its block is read all the same: what ends the block would
    /// be an error otherwise.
    fn condition(&mut self, word: Token) -> Parsed<Code> {
        expression::parse(self, true).or_else(|reported| {
            let mut rest = self.tokens[self.at..].iter().map(|token| token.0);
            let ends = |token: &Token| {
                use Token::*;
                matches!(token, Then | Loop | Else | Endif | Endloop | Semicolon | CloseBrace | End)
            };
            let length = rest.clone().take_while(|token| !ends(token)).count();
            if rest.nth(length) != Some(word) {
                return Err(reported);
            }
            self.at += length;
            Ok(Code::new())
        })
    }

    fn expect_word(&mut self, token: Token, word: &str, help: &str) -> Parsed<()> {
        if self.accept(token) {
            return Ok(());
        }
        let error = self.unexpected(&format!("an operator or `{word}`")).with_help(help);
        let reported = self.fail(error);
        // The block is read all the same if it begins here: its end would be an error otherwise.
        let begins = matches!(self.peek(), Token::OpenBrace | Token::Name(_) | Token::Then | Token::Loop);
        if matches!(self.peek(), Token::OpenBrace | Token::Then | Token::Loop) {
            self.bump();
        }
        if begins { Ok(()) } else { Err(reported) }
    }

    fn close_block(&mut self, token: Token, expected: &str, open: Span) -> Parsed<()> {
        if !self.accept(token) {
            let help = format!("{} in line {} is still open", self.quote(open), self.line(open));
            let error = self.unexpected(expected).with_help(help);
            return Err(self.fail(error));
        }
        self.semicolon()
    }

    fn assignment(&mut self, name: Symbol) -> Parsed<Statement> {
        let span = self.bump();
        let target = self.target(name, span)?;
        let index = if self.accept(Token::OpenBracket) {
            let index = expression::parse(self, false)?;
            self.expect(Token::CloseBracket, "`]`")?;
            Some(index)
        } else {
            None
        };
        let place = span.to(self.last_span());
        self.equals_sign(name)?;
        let is_array = self.scope.slots[target].is_array();
        if matches!(target, X | A) {
            self.extension(place, "an assignment to coordinates or parameters");
        }
        if self.peek() == Token::OpenBracket && is_array && index.is_none() {
            let (items, span) = self.literal(target)?;
            self.semicolon()?;
            return Ok(Statement::Fill { target, items, span });
        }
        self.check_shape(target, index.is_some(), place)?;
        let value = expression::parse(self, false);
        if target == OWN {
            self.own_value(span);
        }
        let value = value?;
        self.semicolon()?;
        Ok(Statement::Assign { target, index, value, span: place })
    }

    fn own_value(&mut self, span: Span) {
        self.scope.results += 1;
        if self.blocks > 0 {
            self.extension(span, "the object's value assigned inside `if` or `while`");
        }
    }

    fn equals_sign(&mut self, name: Symbol) -> Parsed<()> {
        if self.accept(Token::Equal) {
            return Ok(());
        }
        let mut error = self.unexpected("`=`");
        if let Some(help) = hints::foreign_statement(self.name(name)) {
            error = error.with_help(help);
        }
        Err(self.fail(error))
    }

    /// Whether an array is assigned by element and a scalar as a whole.
    fn check_shape(&mut self, target: SlotId, indexed: bool, place: Span) -> Parsed<()> {
        let slot = &self.scope.slots[target];
        let name = &slot.name;
        let error = match (slot.is_array(), indexed) {
            (true, false) => {
                let message = format!("the array `{name}` cannot be assigned as a whole");
                Diagnostic::error(place.range(), message, "expected an index")
                    .with_help(format!("write `{name}[1] = …;`, or `{name} = [ … ];` with all its elements"))
            }
            (false, true) => {
                let message = format!("`{name}` is a number, not an array");
                Diagnostic::error(place.range(), message, "has no elements")
            }
            _ => return Ok(()),
        };
        Err(self.fail(error))
    }

    /// The variable that is assigned; a new scalar if the name is new.
    fn target(&mut self, name: Symbol, span: Span) -> Parsed<SlotId> {
        if let Some(&slot) = self.scope.known.get(&name) {
            return Ok(slot);
        }
        let text = self.name(name).to_owned();
        if self.peek() == Token::Open {
            let error =
                Diagnostic::error(span.range(), "a call is not a statement", "expected an assignment");
            return Err(self.fail(error.with_help(format!("write `t = {text}(…);`"))));
        }
        if let Some(what) = self.reserved(name) {
            let error = Diagnostic::error(span.range(), format!("`{text}` is {what}"), "expected a variable");
            let help = hints::foreign_statement(&text)
                .map_or_else(|| "choose another name".to_owned(), str::to_owned);
            return Err(self.fail(error.with_help(help)));
        }
        if self.peek() == Token::OpenBracket {
            return Err(self.undeclared_array(name, span));
        }
        // A foreign word like `elseif` must not become a variable; `equals_sign` reports it.
        Ok(if self.peek() == Token::Equal { self.declare(name, Extent::Scalar) } else { OWN })
    }

    /// Whether a number, perhaps with one sign, stands here alone.
    fn is_signed_number(&self) -> bool {
        let signs = usize::from(matches!(self.peek(), Token::Plus | Token::Minus));
        let token = |i: usize| self.tokens.get(self.at + i).map(|t| t.0);
        matches!(token(signs), Some(Token::Number(_)))
            && matches!(token(signs + 1), Some(Token::Comma | Token::CloseBracket))
    }

    /// `[ … ]` with a value for each element.
    fn literal(&mut self, target: SlotId) -> Parsed<(Vec<Code>, Span)> {
        let open = self.bump();
        let mut items = Vec::new();
        loop {
            let (span, is_number) = (self.span(), self.is_signed_number());
            items.push(expression::parse(self, false)?);
            if !is_number {
                self.extension(span, "an array literal with more than numbers");
            }
            if !self.accept(Token::Comma) {
                break;
            }
        }
        let close = self.expect(Token::CloseBracket, "`,` or `]`")?;
        let slot = &self.scope.slots[target];
        let span = open.to(close);
        if let Some(size) = slot.length().filter(|size| *size != items.len()) {
            let error = wrong_number_of_values(slot, size, items.len(), span);
            return Err(self.fail(error));
        }
        Ok((items, span))
    }
}

/// The error for `[ … ]` with too many or too few values.
pub(in crate::hyperfun) fn wrong_number_of_values(
    slot: &Slot,
    size: usize,
    found: usize,
    span: Span,
) -> Diagnostic {
    let message = format!("`{}` has {size} elements, not {found}", slot.name);
    Diagnostic::error(span.range(), message, format!("expected {size} values"))
}
