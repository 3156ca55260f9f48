//! A formula as read: every name resolved, every call with the right number of arguments.

use super::functions::Function;
use fieldstone_field::{Binary, Input};

/// An expression of a [`Formula`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ExprId(pub(super) usize);

/// An expression and its operands, which stand before it in [`Formula::exprs`].
#[derive(Clone, Debug)]
pub(super) enum Expr {
    Number(f64),
    Input(Input),
    /// A definition of the formula, by its number, whose value stands before this expression.
    Defined(usize),
    Prefix(Prefix, ExprId),
    Infix(Infix, ExprId, ExprId),
    Call(&'static Function, Vec<ExprId>),
}

/// An operation written before its operand.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Prefix {
    Neg,
    Not,
}

/// An operation written between its operands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Infix {
    Or,
    And,
    NotEqual,
    Greater,
    GreaterEqual,
    /// Operations that field programs have as they are.
    Plain(Binary),
}

/// How tightly an operation binds its operands; later variants bind tighter.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Power {
    Or,
    And,
    Not,
    Comparison,
    Sum,
    Product,
    Sign,
    Exponent,
}

impl Prefix {
    pub(super) fn power(self) -> Power {
        match self {
            Prefix::Neg => Power::Sign,
            Prefix::Not => Power::Not,
        }
    }
}

impl Infix {
    pub(super) fn power(self) -> Power {
        match self {
            Infix::Or => Power::Or,
            Infix::And => Power::And,
            Infix::NotEqual | Infix::Greater | Infix::GreaterEqual => Power::Comparison,
            Infix::Plain(Binary::Lt | Binary::Le | Binary::Eq) => Power::Comparison,
            Infix::Plain(Binary::Add | Binary::Sub) => Power::Sum,
            Infix::Plain(Binary::Mul | Binary::Div) => Power::Product,
            Infix::Plain(_) => Power::Exponent,
        }
    }
}

impl Expr {
    /// Whether the value is a truth, 1 or 0.
    pub(super) fn is_condition(&self) -> bool {
        match self {
            Expr::Prefix(prefix, _) => *prefix == Prefix::Not,
            Expr::Infix(infix, ..) => infix.power() <= Power::Comparison,
            _ => false,
        }
    }
}

/// `name = value;`
#[derive(Clone, Debug)]
pub(super) struct Definition {
    pub(super) name: String,
    pub(super) value: ExprId,
}

/// A formula: definitions in the order of the text, and the function that uses them.
#[derive(Clone, Debug)]
pub(super) struct Formula {
    /// All expressions, operands before what reads them.
    pub(super) exprs: Vec<Expr>,
    pub(super) definitions: Vec<Definition>,
    /// The function, negative inside.
    pub(super) value: ExprId,
}
