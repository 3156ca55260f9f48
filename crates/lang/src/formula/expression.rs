//! From words to a tree: expressions, by operator precedence with an explicit stack.

use super::functions::Function;
use super::lexer::{Token, Word};
use super::names::built_in;
use super::parser::Parser;
use super::tree::{Expr, ExprId, Infix, Power, Prefix};
use crate::diagnostic::Diagnostic;
use fieldstone_field::Binary;
use std::ops::Range;

/// How deep parentheses, calls and absolute values may nest.
const MAX_DEPTH: usize = 1_000;

/// Something open whose end is still to come.
struct Group {
    kind: GroupKind,
    /// The word that opened it.
    span: Range<usize>,
    /// The number of operators that wait outside of it.
    outside: usize,
}

enum GroupKind {
    Parentheses,
    Absolute,
    Call { callee: Callee, name: Range<usize>, arguments: Vec<ExprId> },
}

/// A function that is being called; none if its name is unknown.
type Callee = Option<&'static Function>;

/// An operator that waits for its right operand to end.
enum Operator {
    Prefix(Prefix),
    Infix(Infix),
}

impl Operator {
    fn power(&self) -> Power {
        match self {
            Operator::Prefix(prefix) => prefix.power(),
            Operator::Infix(infix) => infix.power(),
        }
    }
}

/// An expression that is being read.
#[derive(Default)]
struct Pending {
    operands: Vec<ExprId>,
    operators: Vec<Operator>,
    groups: Vec<Group>,
}

/// What may stand next.
enum Expect {
    Operand,
    Operator,
    Nothing,
}

impl Parser<'_> {
    /// An expression up to a `;`, an `=` or the end.
    pub(super) fn expression(&mut self) -> Result<ExprId, Diagnostic> {
        let mut pending = Pending::default();
        let mut expect = Expect::Operand;
        loop {
            expect = match expect {
                Expect::Operand => self.operand(&mut pending)?,
                Expect::Operator => self.operator(&mut pending)?,
                Expect::Nothing => return Ok(self.last_operand(&mut pending)),
            }
        }
    }

    fn last_operand(&mut self, pending: &mut Pending) -> ExprId {
        pending.operands.pop().unwrap_or_else(|| self.placeholder())
    }

    /// What may stand where a value begins.
    fn operand(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        let token = self.token();
        match token {
            Token::Number(value) => {
                let operand = self.push(Expr::Number(value));
                pending.operands.push(operand);
                self.advance();
                return Ok(Expect::Operator);
            }
            Token::Name => return self.name(pending),
            Token::Minus => pending.operators.push(Operator::Prefix(Prefix::Neg)),
            Token::Not => pending.operators.push(Operator::Prefix(Prefix::Not)),
            Token::Plus => {}
            Token::Open => self.open(pending, GroupKind::Parentheses, self.span())?,
            Token::Bar | Token::Bars => {
                self.open(pending, GroupKind::Absolute, self.span())?;
                self.advance_bar();
                return Ok(Expect::Operand);
            }
            _ => return Err(self.no_operand()),
        }
        self.advance();
        Ok(Expect::Operand)
    }

    fn no_operand(&self) -> Diagnostic {
        let message = format!("expected a value, found {}", self.found());
        let error = Diagnostic::error(self.span(), message, "expected a number, a name or `(`");
        match (self.token(), self.at.checked_sub(1).map(|before| self.words[before].token)) {
            (Token::Times, Some(Token::Times)) => error.with_help("a power is written `^` or `**`"),
            (Token::Assign, Some(Token::Less | Token::Greater | Token::Not | Token::Assign))
            | (Token::Less | Token::Greater, Some(Token::Assign)) => {
                error.with_help("comparisons are written `<=`, `>=`, `==` and `!=`")
            }
            (Token::Superscript(_), _) => error.with_help("a power stands after its base: `x²`"),
            _ => error,
        }
    }

    fn open(&self, pending: &mut Pending, kind: GroupKind, span: Range<usize>) -> Result<(), Diagnostic> {
        if pending.groups.len() == MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} parentheses inside one another");
            let error = Diagnostic::error(span, message, "one too many");
            return Err(error.with_help("give inner parts a name: `part = …;`"));
        }
        pending.groups.push(Group { kind, span, outside: pending.operators.len() });
        Ok(())
    }

    /// Goes past one `|`, which may be half of a `||`.
    fn advance_bar(&mut self) {
        match &mut self.words[self.at] {
            Word { token: token @ Token::Bars, span } => {
                *token = Token::Bar;
                span.start += 1;
            }
            _ => self.advance(),
        }
    }

    /// A name where a value begins: a value or a call.
    fn name(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        let (at, name) = (self.at, self.word_text());
        let is_called = self.second() == Token::Open;
        let is_value = built_in(name).is_some() || self.defined.contains_key(name);
        let callee = Function::named(name);
        if let (Some(function), false, false) = (callee, is_called, is_value) {
            return Err(self.missing_parentheses(function, name));
        }
        // Functions whose names may be defined are those where they are called.
        let is_value = is_value && !(is_called && Function::may_be_defined(name));
        if is_value || !is_called {
            let operand = self.variable(at);
            pending.operands.push(operand);
            self.advance();
            return Ok(Expect::Operator);
        }
        if callee.is_none() {
            self.report_unknown(at);
        }
        let call = GroupKind::Call { callee, name: self.span(), arguments: Vec::new() };
        self.advance();
        self.open(pending, call, self.span())?;
        self.advance();
        if self.token() == Token::Close {
            return self.close(pending);
        }
        Ok(Expect::Operand)
    }

    fn missing_parentheses(&self, function: &Function, name: &str) -> Diagnostic {
        let help = match self.second() {
            Token::Caret | Token::Superscript(_) => format!("a power of its value is written `{name}(x)^2`"),
            _ => format!("write `{}`", function.usage(name)),
        };
        Diagnostic::error(self.span(), format!("`{name}` is a function"), "expected `(` after it")
            .with_help(help)
    }

    /// What may stand after a value.
    fn operator(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        let inside_bars = matches!(pending.groups.last(), Some(Group { kind: GroupKind::Absolute, .. }));
        match self.token() {
            Token::Superscript(power) => {
                let base = self.last_operand(pending);
                let exponent = self.push(Expr::Number(f64::from(power)));
                pending.operands.push(self.push(Expr::Infix(Infix::Plain(Binary::Pow), base, exponent)));
                self.advance();
                Ok(Expect::Operator)
            }
            Token::Bar | Token::Bars if inside_bars => self.close_absolute(pending),
            Token::Number(_) if self.follows_number() => Err(self.two_numbers()),
            Token::Number(_) | Token::Name | Token::Open | Token::Bar => {
                self.infix(pending, Infix::Plain(Binary::Mul))?;
                Ok(Expect::Operand)
            }
            Token::Close => self.close(pending),
            Token::Comma => self.comma(pending),
            Token::Assign | Token::Semicolon | Token::End => self.end_of_expression(pending),
            token => {
                let Some(infix) = infix(token) else { return Err(self.no_operator()) };
                self.infix(pending, infix)?;
                self.advance();
                Ok(Expect::Operand)
            }
        }
    }

    fn no_operator(&self) -> Diagnostic {
        let message = format!("expected an operator, found {}", self.found());
        let error = Diagnostic::error(self.span(), message, "expected `+`, `*` or the like before it");
        match self.token() {
            Token::Let => error.with_help("a definition begins after a `;`"),
            _ => error,
        }
    }

    fn follows_number(&self) -> bool {
        self.at > 0 && matches!(self.words[self.at - 1].token, Token::Number(_))
    }

    fn two_numbers(&self) -> Diagnostic {
        Diagnostic::error(self.span(), "two numbers side by side", "expected an operator before it")
            .with_help("write `*` between factors")
    }

    /// Makes `infix` wait for its right operand, after what binds its left operand tighter.
    fn infix(&mut self, pending: &mut Pending, infix: Infix) -> Result<(), Diagnostic> {
        let power = infix.power();
        let outside = pending.groups.last().map_or(0, |group| group.outside);
        while let Some(last) = pending.operators[outside..].last() {
            if last.power() < power || (power == Power::Exponent && last.power() == power) {
                break;
            }
            if power == Power::Comparison && last.power() == power {
                let error = Diagnostic::error(self.span(), "a chain of comparisons", "a second comparison");
                return Err(error.with_help("write `a < b and b < c`"));
            }
            self.apply_last(pending);
        }
        pending.operators.push(Operator::Infix(infix));
        Ok(())
    }

    /// Applies the operator that waits last to its operands.
    fn apply_last(&mut self, pending: &mut Pending) {
        let right = self.last_operand(pending);
        let expr = match pending.operators.pop() {
            Some(Operator::Prefix(prefix)) => Expr::Prefix(prefix, right),
            Some(Operator::Infix(infix)) => Expr::Infix(infix, self.last_operand(pending), right),
            None => return pending.operands.push(right),
        };
        pending.operands.push(self.push(expr));
    }

    /// Applies the operators of the innermost group; its value is then the last operand.
    fn apply_group(&mut self, pending: &mut Pending) {
        let outside = pending.groups.last().map_or(0, |group| group.outside);
        while pending.operators.len() > outside {
            self.apply_last(pending);
        }
    }

    fn close_absolute(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        self.apply_group(pending);
        pending.groups.pop();
        let operand = self.last_operand(pending);
        pending.operands.push(self.call(Function::named("abs"), vec![operand]));
        self.advance_bar();
        Ok(Expect::Operator)
    }

    /// At a `)`, after the value before it or right after the `(` of a call.
    fn close(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        self.apply_group(pending);
        match pending.groups.pop() {
            None => {
                let error = Diagnostic::error(self.span(), "`)` without `(`", "closes nothing");
                return Err(error.with_help("leave it out, or write the `(` before its part"));
            }
            Some(Group { kind: GroupKind::Absolute, span, .. }) => return Err(unclosed("|", span)),
            Some(Group { kind: GroupKind::Parentheses, .. }) => {}
            Some(Group { kind: GroupKind::Call { callee, name, mut arguments }, .. }) => {
                let is_empty = arguments.is_empty() && self.words[self.at - 1].token == Token::Open;
                if !is_empty {
                    arguments.push(self.last_operand(pending));
                }
                self.check_arguments(callee, arguments.len(), name);
                pending.operands.push(self.call(callee, arguments));
            }
        }
        self.advance();
        Ok(Expect::Operator)
    }

    fn check_arguments(&mut self, callee: Callee, count: usize, span: Range<usize>) {
        if let Some(function) = callee.filter(|function| !function.takes(count)) {
            let name = &self.text[span.clone()];
            let message = format!("`{name}` takes {}, not {count}", function.argument_count());
            let error = Diagnostic::error(span, message, "wrong number of arguments");
            self.report(error.with_help(format!("write `{}`", function.usage(name))));
        }
    }

    fn call(&mut self, callee: Callee, arguments: Vec<ExprId>) -> ExprId {
        match callee {
            Some(function) => self.push(Expr::Call(function, arguments)),
            None => self.placeholder(),
        }
    }

    fn comma(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        self.apply_group(pending);
        let operand = self.last_operand(pending);
        match pending.groups.last_mut() {
            Some(Group { kind: GroupKind::Call { arguments, .. }, .. }) => arguments.push(operand),
            _ => return Err(self.comma_outside_of_a_call()),
        }
        self.advance();
        Ok(Expect::Operand)
    }

    fn comma_outside_of_a_call(&self) -> Diagnostic {
        let error = Diagnostic::error(self.span(), "`,` outside of a call", "not expected");
        if !self.follows_number() || !matches!(self.second(), Token::Number(_)) {
            let help = "a definition ends with `;`, and arguments stand in parentheses: `min(a, b)`";
            return error.with_help(help);
        }
        let text = |at: usize| &self.text[self.words[at].span.clone()];
        error.with_help(format!("write a decimal point: `{}.{}`", text(self.at - 1), text(self.at + 1)))
    }

    fn end_of_expression(&mut self, pending: &mut Pending) -> Result<Expect, Diagnostic> {
        match pending.groups.pop() {
            Some(_) if self.token() == Token::Assign => {
                let error = Diagnostic::error(self.span(), "`=` inside of parentheses", "not expected");
                Err(error.with_help("a comparison is written `==`"))
            }
            Some(Group { kind: GroupKind::Absolute, span, .. }) => Err(unclosed("|", span)),
            Some(Group { span, .. }) => Err(unclosed("(", span)),
            None => {
                self.apply_group(pending);
                Ok(Expect::Nothing)
            }
        }
    }
}

fn unclosed(sign: &str, span: Range<usize>) -> Diagnostic {
    let error = Diagnostic::error(span, format!("`{sign}` is never closed"), "opened here");
    if sign == "|" { error.with_help("an absolute value may also be written `abs(x)`") } else { error }
}

/// The operation that a word between two operands asks for.
fn infix(token: Token) -> Option<Infix> {
    Some(match token {
        Token::Bars | Token::Or => Infix::Or,
        Token::And => Infix::And,
        Token::Less => Infix::Plain(Binary::Lt),
        Token::LessEqual => Infix::Plain(Binary::Le),
        Token::Equal => Infix::Plain(Binary::Eq),
        Token::NotEqual => Infix::NotEqual,
        Token::Greater => Infix::Greater,
        Token::GreaterEqual => Infix::GreaterEqual,
        Token::Plus => Infix::Plain(Binary::Add),
        Token::Minus => Infix::Plain(Binary::Sub),
        Token::Times => Infix::Plain(Binary::Mul),
        Token::Slash => Infix::Plain(Binary::Div),
        Token::Caret => Infix::Plain(Binary::Pow),
        _ => return None,
    })
}
