//! What HyperFun and formulas have in common: arithmetic in infix form.
//!
//! Both read `+ -` and `* /` from the left and differ in how they read powers and signs, so that the operands of those
//! are always put in parentheses unless they are names, calls or numbers.

use super::shortest;
use fieldstone_field::{Binary, Node, NodeId, Unary};

/// A text longer than this becomes a variable: lines stay readable, and parentheses are never nested deeply.
const LONGEST: usize = 80;

/// How tightly a text is bound together; later variants bind tighter.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Level {
    /// A set operation of HyperFun, which is never left without parentheses inside of another operation.
    Set,
    /// `a + b`, `-a`: also negative numbers.
    Sum,
    /// `a*b`.
    Product,
    /// `a^b`.
    Power,
    /// A name, a call, a number without a sign, or something in parentheses.
    Atom,
}

/// An expression that may still become part of another.
#[derive(Clone, Debug)]
pub(super) struct Expr {
    pub(super) text: String,
    pub(super) level: Level,
}

impl Expr {
    pub(super) fn atom(text: impl Into<String>) -> Self {
        Self { text: text.into(), level: Level::Atom }
    }

    pub(super) fn at(level: Level, text: String) -> Self {
        Self { text, level }
    }

    /// A number as both languages read it.
    pub(super) fn number(value: f64) -> Self {
        if value.is_nan() {
            return Self::atom("(0/0)");
        }
        if value.is_infinite() {
            return Self::atom(if value > 0.0 { "(1/0)" } else { "(-1/0)" });
        }
        let level = if value.is_sign_negative() { Level::Sum } else { Level::Atom };
        Self { text: shortest(value), level }
    }

    /// The text as an operand that must bind at least so tightly.
    pub(super) fn within(&self, level: Level) -> String {
        if self.level >= level { self.text.clone() } else { format!("({})", self.text) }
    }

    /// Whether it should get a name even if it is read only once.
    pub(super) fn is_long(&self) -> bool {
        self.text.len() > LONGEST
    }
}

/// `name(a, b, …)`.
pub(super) fn call(name: &str, arguments: &[&Expr]) -> Expr {
    let list: Vec<&str> = arguments.iter().map(|argument| argument.text.as_str()).collect();
    Expr::atom(format!("{name}({})", list.join(", ")))
}

/// `left operator right`, read from the left, both operands at `level`.
pub(super) fn infix(a: &Expr, operator: &str, b: &Expr, level: Level) -> Expr {
    let tighter = if level == Level::Sum { Level::Product } else { Level::Power };
    Expr::at(level, format!("{}{operator}{}", a.within(level), b.within(tighter)))
}

/// −a.
pub(super) fn negative(a: &Expr) -> Expr {
    Expr::at(Level::Sum, format!("-{}", a.within(Level::Atom)))
}

fn power(a: &Expr, exponent: &Expr) -> Expr {
    Expr::at(Level::Power, format!("{}^{}", a.within(Level::Atom), exponent.within(Level::Atom)))
}

/// The node as both languages write it; `None` where they differ.
pub(super) fn common<'e>(node: &Node, operand: impl Fn(NodeId) -> &'e Expr) -> Option<Expr> {
    Some(match *node {
        Node::Constant(bits) => Expr::number(f64::from_bits(bits)),
        Node::Powi(a, n) => power(operand(a), &Expr::number(f64::from(n))),
        Node::Unary(op, a) => match op {
            Unary::Neg => negative(operand(a)),
            Unary::Square => power(operand(a), &Expr::number(2.0)),
            Unary::Recip => infix(&Expr::number(1.0), "/", operand(a), Level::Product),
            Unary::Ln => call("log", &[operand(a)]),
            Unary::Atanh | Unary::Round | Unary::Trunc | Unary::Not => return None,
            // The rest is called so in both.
            _ => call(op.name(), &[operand(a)]),
        },
        Node::Binary(op, a, b) => {
            let (a, b) = (operand(a), operand(b));
            match op {
                Binary::Add => infix(a, " + ", b, Level::Sum),
                Binary::Sub => infix(a, " - ", b, Level::Sum),
                Binary::Mul => infix(a, "*", b, Level::Product),
                Binary::Div => infix(a, "/", b, Level::Product),
                Binary::Pow => power(a, b),
                Binary::Min | Binary::Max | Binary::Atan2 => call(op.name(), &[a, b]),
                _ => return None,
            }
        }
        _ => return None,
    })
}

/// What stands between the operands of a comparison that both languages write alike.
pub(super) fn relation(op: Binary) -> Option<&'static str> {
    match op {
        Binary::Lt => Some(" < "),
        Binary::Le => Some(" <= "),
        _ => None,
    }
}
