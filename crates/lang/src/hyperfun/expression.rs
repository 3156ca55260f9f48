//! From tokens to postfix code, by operator precedence and without recursion.
//!
//! One grammar serves values and conditions; comparisons and logic are errors in values. The levels are those of the
//! C interpreter: signs bind tightest, all operators of a level are read from the left (powers too), and the set
//! operators share a level with `+` and `-`. Where that is not how mathematics is read, a warning says so.
//!
//! In a condition the C interpreter takes a parenthesis that begins an operand of a comparison as one around a
//! condition, behind which no arithmetic may follow: `(x[1]+1)*2 > 3` is an error of the strict dialect.

use super::ast::{Action, Call, Callee, Code, Level, Operator, SlotId, Step};
use super::lexer::{Symbol, Token};
use super::parser::{Parsed, Parser};
use super::report::Span;
use super::{builtins, calls, library};
use crate::diagnostic::Diagnostic;

/// How deep parentheses, brackets and calls may be nested.
const MAX_DEPTH: usize = 1000;

/// Reads an expression, or a condition.
pub(super) fn parse(parser: &mut Parser<'_>, condition: bool) -> Parsed<Code> {
    let base =
        Frame { kind: FrameKind::Base, open: parser.span(), comparisons: condition, set_operator: false };
    let mut expression = Expression {
        parser,
        code: Vec::new(),
        pending: Vec::new(),
        frames: vec![base],
        marks: vec![0],
        plus: false,
        behind_condition: false,
    };
    loop {
        expression.operand()?;
        if expression.operators()? {
            return Ok(right_to_left(expression.code));
        }
    }
}

/// The same postfix code with the operands of each operation in reverse order: the interpreter evaluates the right
/// operand and the last argument first, which shows where calls change arrays.
fn right_to_left(code: Code) -> Code {
    // Where the code of each step's value begins: its operands end just before it, one behind the other.
    let mut starts: Vec<usize> = Vec::with_capacity(code.len());
    for (i, step) in code.iter().enumerate() {
        let start =
            (0..step.action.arity()).fold(i, |end, _| end.checked_sub(1).map_or(0, |last| starts[last]));
        starts.push(start);
    }
    // Reversed, "right, left, operation" is "operation, left, right": a walk from the root, left operands first.
    let mut order = Vec::with_capacity(code.len());
    let mut stack: Vec<usize> = code.len().checked_sub(1).into_iter().collect();
    while let Some(i) = stack.pop() {
        order.push(i);
        let mut end = i;
        for _ in 0..code[i].action.arity() {
            let Some(operand) = end.checked_sub(1) else { break };
            stack.push(operand);
            end = starts[operand];
        }
    }
    let mut steps: Vec<Option<Step>> = code.into_iter().map(Some).collect();
    order.into_iter().rev().filter_map(|i| steps[i].take()).collect()
}

/// What is open.
struct Frame {
    kind: FrameKind,
    open: Span,
    /// Whether comparisons may stand here.
    comparisons: bool,
    /// Whether a set operator stands in the sum that is being read.
    set_operator: bool,
}

enum FrameKind {
    Base,
    /// A parenthesis, and whether it stands around a condition as the C interpreter sees it.
    Group {
        condition: bool,
    },
    Index(SlotId),
    Call(Box<OpenCall>),
}

/// A call whose arguments are being read.
struct OpenCall {
    callee: Callee,
    name: Symbol,
    arguments: Vec<calls::Passed>,
    /// The argument that is being read.
    array: Option<SlotId>,
    start: Span,
}

struct Expression<'p, 's> {
    parser: &'p mut Parser<'s>,
    code: Code,
    /// Operators whose right operand is not complete.
    pending: Vec<(Operator, Span)>,
    frames: Vec<Frame>,
    /// For each frame how many operators were pending before.
    marks: Vec<usize>,
    /// Whether the operand that is being read began with a `+`.
    plus: bool,
    /// Whether a parenthesis around a condition was closed just now.
    behind_condition: bool,
}

impl Expression<'_, '_> {
    /// The innermost frame; the base is never popped.
    fn frame(&mut self) -> &mut Frame {
        let last = self.frames.len() - 1;
        &mut self.frames[last]
    }

    fn open(&mut self, kind: FrameKind, open: Span) -> Parsed<()> {
        // An element of an array may stand inside of all parentheses.
        let depth = self.frames.len() - usize::from(matches!(kind, FrameKind::Index(_)));
        if depth > MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} parentheses and brackets inside each other");
            let error = Diagnostic::error(open.range(), message, "nested too deep");
            return Err(self.parser.fail(error));
        }
        let comparisons = match kind {
            FrameKind::Group { condition } => {
                condition || (self.frame().comparisons && !self.parser.strict())
            }
            _ => false,
        };
        self.frames.push(Frame { kind, open, comparisons, set_operator: false });
        self.marks.push(self.pending.len());
        Ok(())
    }

    /// Whether an operand of a comparison begins here: no sign and no arithmetic operator stands before it.
    fn begins_factor(&mut self) -> bool {
        let mark = self.marks.last().copied().unwrap_or(0);
        let before = self.pending[mark..].last().map(|(operator, _)| operator.level());
        self.frame().comparisons && !self.plus && before.is_none_or(|level| level <= Level::Not)
    }

    /// Reads signs and opening parentheses up to an operand, and the operand.
    fn operand(&mut self) -> Parsed<()> {
        self.plus = false;
        loop {
            let span = self.parser.span();
            match self.parser.peek() {
                Token::Plus => {
                    self.parser.bump();
                    self.plus = true;
                }
                Token::Minus | Token::Complement => {
                    self.parser.bump();
                    self.pending.push((Operator::Negate, span));
                }
                Token::Not => {
                    self.check_comparison()?;
                    if !self.begins_factor() {
                        return Err(self.misplaced_not());
                    }
                    self.parser.bump();
                    self.pending.push((Operator::Not, span));
                }
                Token::Open => {
                    let condition = self.begins_factor();
                    self.parser.bump();
                    self.open(FrameKind::Group { condition }, span)?;
                    self.plus = false;
                }
                Token::Number(value) => {
                    self.parser.bump();
                    self.code.push(Step { action: Action::Number(value), span });
                    return Ok(());
                }
                Token::Name(name) => {
                    if self.name(name)? {
                        return Ok(());
                    }
                }
                _ => return self.no_operand(),
            }
        }
    }

    fn no_operand(&mut self) -> Parsed<()> {
        let error = self.parser.unexpected("an expression");
        let error = match self.parser.peek() {
            Token::String => error.with_help("strings have no use in models"),
            Token::OpenBracket => {
                error.with_help("`[ … ]` stands only in `name = [ … ];` for a declared array")
            }
            _ => error,
        };
        Err(self.parser.fail(error))
    }

    fn misplaced_not(&mut self) -> super::parser::Reported {
        let message = "`not` stands only before a condition";
        let error = Diagnostic::error(self.parser.span().range(), message, "expected a number");
        self.parser.fail(error.with_help("write the parts of the condition apart, with `and` or `or`"))
    }

    /// A name and what must follow it; whether that is an operand already.
    fn name(&mut self, name: Symbol) -> Parsed<bool> {
        let span = self.parser.bump();
        if self.parser.peek() == Token::Open {
            return self.call(name, span);
        }
        let slot = self.parser.variable(name);
        let array = slot.filter(|&slot| self.parser.slot(slot).is_array());
        match (array, slot) {
            (Some(array), _) if self.parser.peek() == Token::OpenBracket => {
                self.parser.bump();
                self.open(FrameKind::Index(array), span)?;
                Ok(false)
            }
            (Some(array), _) => Err(self.bare_array(array, span)),
            (None, _) if self.parser.peek() == Token::OpenBracket => {
                Err(self.parser.undeclared_array(name, span))
            }
            (None, Some(scalar)) => {
                self.code.push(Step { action: Action::Scalar(scalar), span });
                Ok(true)
            }
            (None, None) => {
                if is_function(self.parser, name) {
                    let message = format!("`{}` is a function", self.parser.name(name));
                    let error =
                        Diagnostic::error(span.to(self.parser.span()).range(), message, "expected `(`");
                    return Err(self.parser.fail(error));
                }
                self.parser.unknown_variable(name, span);
                self.code.push(Step { action: Action::Number(f64::NAN), span });
                Ok(true)
            }
        }
    }

    fn bare_array(&mut self, array: SlotId, span: Span) -> super::parser::Reported {
        let name = self.parser.slot(array).name.clone();
        let error = Diagnostic::error(
            span.range(),
            format!("the array `{name}` is not a number"),
            "expected an index",
        );
        self.parser.fail(error.with_help(format!("write `{name}[1]` for its first element")))
    }

    /// A call up to its first argument; whether it is complete.
    fn call(&mut self, name: Symbol, span: Span) -> Parsed<bool> {
        let callee = calls::callee(self.parser, name, span)?;
        self.parser.bump();
        let start = self.parser.span();
        let call = OpenCall { callee, name, arguments: Vec::new(), array: None, start };
        self.open(FrameKind::Call(Box::new(call)), span)?;
        if self.parser.peek() == Token::Close {
            // No arguments: `operators` closes the call.
            return Ok(true);
        }
        Ok(self.array_argument())
    }

    /// Takes a whole array as an argument if one stands here.
    fn array_argument(&mut self) -> bool {
        let Token::Name(name) = self.parser.peek() else { return false };
        let after = self.parser.peek_after();
        let array = self.parser.variable(name).filter(|&slot| self.parser.slot(slot).is_array());
        let Some(array) = array.filter(|_| !matches!(after, Token::OpenBracket | Token::Open)) else {
            return false;
        };
        self.parser.bump();
        if let FrameKind::Call(call) = &mut self.frame().kind {
            call.array = Some(array);
        }
        true
    }

    /// Reads what may follow an operand; whether the expression ends here.
    fn operators(&mut self) -> Parsed<bool> {
        loop {
            let token = self.parser.peek();
            let behind_condition = std::mem::take(&mut self.behind_condition);
            if let Some(operator) = binary(token) {
                if behind_condition && operator.level() > Level::Relation {
                    let span = self.parser.span();
                    self.parser.extension(span, "arithmetic behind a parenthesis that begins a condition");
                }
                self.operator(operator)?;
                return Ok(false);
            }
            let in_base = matches!(self.frame().kind, FrameKind::Base);
            match token {
                _ if in_base => {
                    self.reduce(None);
                    return Ok(true);
                }
                Token::Close => self.close_parenthesis()?,
                Token::CloseBracket => self.close_bracket()?,
                Token::Comma if matches!(self.frame().kind, FrameKind::Call(_)) => {
                    if !self.next_argument() {
                        return Ok(false);
                    }
                }
                _ => return Err(self.unclosed()),
            }
        }
    }

    fn operator(&mut self, operator: Operator) -> Parsed<()> {
        if let FrameKind::Call(call) = &self.frame().kind
            && let Some(array) = call.array
        {
            let span = call.start;
            return Err(self.bare_array(array, span));
        }
        if operator.level() <= Level::Relation {
            self.check_comparison()?;
        }
        let span = self.parser.bump();
        self.reduce(Some(operator));
        self.warn_about_sums(operator, span);
        self.pending.push((operator, span));
        Ok(())
    }

    fn check_comparison(&mut self) -> Parsed<()> {
        if self.frame().comparisons {
            return Ok(());
        }
        let message = format!("{} stands only in conditions", self.parser.quote(self.parser.span()));
        let error = Diagnostic::error(
            self.parser.span().range(),
            message,
            "expected an arithmetic operator or the end",
        );
        Err(self.parser.fail(error.with_help("conditions stand after `if` and `while`")))
    }

    /// Emits the pending operators of this frame that bind at least as tight as `next`; all at its end.
    fn reduce(&mut self, next: Option<Operator>) {
        let mark = self.marks.last().copied().unwrap_or(0);
        while self.pending.len() > mark {
            let (operator, span) = self.pending[self.pending.len() - 1];
            if next.is_some_and(|next| operator.level() < next.level()) {
                return;
            }
            self.pending.pop();
            self.code.push(Step { action: Action::Operator(operator), span });
            if let Some(next) = next {
                self.warn_about_reading(operator, next, span);
            }
        }
    }

    /// Warns where `next` takes the result of `operator` as its left side, and mathematics would not.
    fn warn_about_reading(&mut self, operator: Operator, next: Operator, span: Span) {
        let (message, help) = match (operator, next) {
            (Operator::Negate, Operator::Power) if !self.exponent_is_odd() => (
                "a sign binds tighter than `^`: this is the power of the negative",
                "write `-(a^b)` or `(-a)^b`",
            ),
            (Operator::Power, Operator::Power) => {
                ("powers are read from the left: `a^b^c` is `(a^b)^c`", "write the parentheses")
            }
            (Operator::Or, Operator::And) => {
                ("`and` and `or` are read from the left, none before the other", "write the parentheses")
            }
            (Operator::Not, next) if next.level() == Level::Relation => {
                ("`not` binds tighter than a comparison: `not a < b` is `(not a) < b`", "write `not (a < b)`")
            }
            (first, next) if first.level() == Level::Relation && next.level() == Level::Relation => {
                ("a chain of comparisons compares 0 or 1 with the last value", "write `a < b and b < c`")
            }
            _ => return,
        };
        self.warn(span, message, help);
    }

    fn exponent_is_odd(&self) -> bool {
        matches!(self.parser.peek(), Token::Number(n) if n.rem_euclid(2.0) == 1.0)
    }

    /// Warns where `+` or `-` follows a set operator, which mathematics would read the other way round.
    fn warn_about_sums(&mut self, operator: Operator, span: Span) {
        let frame = self.frame();
        if operator.level() < Level::Sum {
            frame.set_operator = false;
        } else if operator.is_set_operator() {
            frame.set_operator = true;
        } else if operator.level() == Level::Sum && frame.set_operator {
            frame.set_operator = false;
            let message = "set operators and `+`, `-` are read from the left: `a|b+c` is `(a|b)+c`";
            self.warn(span, message, "write the parentheses");
        }
    }

    fn warn(&mut self, span: Span, message: &str, help: &str) {
        let warning = Diagnostic::warning(span.range(), message, "perhaps not read as meant");
        self.parser.report.add(warning.with_help(help));
    }

    fn close_frame(&mut self) -> Option<Frame> {
        self.reduce(None);
        self.marks.pop();
        self.frames.pop()
    }

    fn close_parenthesis(&mut self) -> Parsed<()> {
        if matches!(self.frame().kind, FrameKind::Index(_)) {
            return Err(self.unclosed());
        }
        let here = self.parser.span();
        if matches!(&self.frame().kind, FrameKind::Call(call) if here != call.start) {
            self.end_argument();
        }
        let frame = self.close_frame();
        let close = self.parser.bump();
        self.behind_condition =
            matches!(frame, Some(Frame { kind: FrameKind::Group { condition: true }, .. }));
        if let Some(Frame { kind: FrameKind::Call(call), open, .. }) = frame {
            let span = open.to(close);
            calls::check(self.parser, (call.callee, call.name), &call.arguments, span)?;
            let arguments = call.arguments.iter().map(|a| a.array).collect();
            let call = Call { callee: call.callee, arguments };
            self.code.push(Step { action: Action::Call(Box::new(call)), span });
        }
        Ok(())
    }

    fn close_bracket(&mut self) -> Parsed<()> {
        if !matches!(self.frame().kind, FrameKind::Index(_)) {
            return Err(self.unclosed());
        }
        let frame = self.close_frame();
        let close = self.parser.bump();
        if let Some(Frame { kind: FrameKind::Index(slot), open, .. }) = frame {
            self.code.push(Step { action: Action::Element(slot), span: open.to(close) });
        }
        Ok(())
    }

    fn end_argument(&mut self) {
        self.reduce(None);
        let end = self.parser.last_span();
        if let FrameKind::Call(call) = &mut self.frame().kind {
            let span = call.start.to(end);
            call.arguments.push(calls::Passed { array: call.array.take(), span });
        }
    }

    /// Goes to the next argument; whether it is a whole array.
    fn next_argument(&mut self) -> bool {
        self.end_argument();
        self.parser.bump();
        let start = self.parser.span();
        self.frame().set_operator = false;
        if let FrameKind::Call(call) = &mut self.frame().kind {
            call.start = start;
        }
        self.array_argument()
    }

    fn unclosed(&mut self) -> super::parser::Reported {
        let open = self.frame().open;
        let (expected, opener) = match self.frame().kind {
            FrameKind::Index(_) => ("an operator or `]`", "`[`"),
            FrameKind::Call(_) => ("an operator, `,` or `)`", "`(`"),
            _ => ("an operator or `)`", "`(`"),
        };
        let error = self.parser.unexpected(expected);
        let help = format!("{opener} of line {} is still open", self.parser.line(open));
        self.parser.fail(error.with_help(help))
    }
}

fn is_function(parser: &Parser<'_>, name: Symbol) -> bool {
    let name = parser.name(name);
    builtins::lookup(name).is_some() || library::lookup(name, parser.dialect()).is_some()
}

fn binary(token: Token) -> Option<Operator> {
    Some(match token {
        Token::Or => Operator::Or,
        Token::And => Operator::And,
        Token::Equal => Operator::Equal,
        Token::Unequal => Operator::Unequal,
        Token::Less => Operator::Less,
        Token::LessEqual => Operator::LessEqual,
        Token::Greater => Operator::Greater,
        Token::GreaterEqual => Operator::GreaterEqual,
        Token::Plus => Operator::Add,
        Token::Minus => Operator::Subtract,
        Token::Union => Operator::Union,
        Token::Intersect => Operator::Intersection,
        Token::Subtract => Operator::Difference,
        Token::Product => Operator::Product,
        Token::Times => Operator::Multiply,
        Token::Divide => Operator::Divide,
        Token::Power => Operator::Power,
        _ => return None,
    })
}
