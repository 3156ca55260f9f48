//! Expressions that read like the formulas they stand for: nodes with operators, and vectors of three of them.
//!
//! ```
//! use fieldstone_field::{Graph, Input};
//! use fieldstone_solids::expression::{Expr, write};
//!
//! let mut graph = Graph::new();
//! let [x, y] = [0, 1].map(|i| graph.input(Input::Coordinate(i)));
//! let circle = write(&mut graph, |cell| {
//!     let [x, y] = [x, y].map(|id| Expr::new(cell, id));
//!     (x.square() + y.square() - 1.0).id()
//! });
//! assert_eq!(graph.len(), 7);
//! # let _ = circle;
//! ```

use fieldstone_field::{Binary, Function, Graph, NodeId, Unary};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// Lets expressions write into a graph. The graph in the cell is the one given, which must not be kept.
pub fn write<R>(graph: &mut Graph, formula: impl FnOnce(&RefCell<Graph>) -> R) -> R {
    let cell = RefCell::new(std::mem::take(graph));
    let result = formula(&cell);
    *graph = cell.into_inner();
    result
}

/// A node and the graph it belongs to.
#[derive(Clone, Copy, Debug)]
pub struct Expr<'g> {
    graph: &'g RefCell<Graph>,
    id: NodeId,
}

/// What may stand beside an expression: another one, or a number.
pub trait Operand<'g> {
    /// Its node in the graph.
    fn node_in(self, graph: &'g RefCell<Graph>) -> NodeId;
}

impl<'g> Operand<'g> for Expr<'g> {
    fn node_in(self, _graph: &'g RefCell<Graph>) -> NodeId {
        self.id
    }
}

impl<'g> Operand<'g> for f64 {
    fn node_in(self, graph: &'g RefCell<Graph>) -> NodeId {
        graph.borrow_mut().constant(self)
    }
}

macro_rules! unary_methods {
    ($($method:ident $op:ident),*) => {
        $(
            #[doc = concat!("[`Unary::", stringify!($op), "`].")]
            pub fn $method(self) -> Self { self.unary(Unary::$op) }
        )*
    };
}

macro_rules! binary_methods {
    ($($method:ident $op:ident),*) => {
        $(
            #[doc = concat!("[`Binary::", stringify!($op), "`].")]
            pub fn $method(self, other: impl Operand<'g>) -> Self { self.binary(Binary::$op, other) }
        )*
    };
}

impl<'g> Expr<'g> {
    /// A node of the graph.
    pub fn new(graph: &'g RefCell<Graph>, id: NodeId) -> Self {
        Self { graph, id }
    }

    /// The node.
    pub fn id(self) -> NodeId {
        self.id
    }

    /// Another node of the same graph.
    pub fn sibling(self, id: NodeId) -> Self {
        Self::new(self.graph, id)
    }

    /// A number in the same graph.
    pub fn number(self, value: f64) -> Self {
        Self::new(self.graph, value.node_in(self.graph))
    }

    /// The value if it does not depend on anything.
    pub fn constant_value(self) -> Option<f64> {
        self.graph.borrow().constant_value(self.id)
    }

    fn unary(self, op: Unary) -> Self {
        Self::new(self.graph, self.graph.borrow_mut().unary(op, self.id))
    }

    fn binary(self, op: Binary, other: impl Operand<'g>) -> Self {
        let other = other.node_in(self.graph);
        Self::new(self.graph, self.graph.borrow_mut().binary(op, self.id, other))
    }

    unary_methods!(abs Abs, sqrt Sqrt, square Square, exp Exp, sin Sin, cos Cos, tan Tan, atan Atan);
    unary_methods!(floor Floor, trunc Trunc, tanh Tanh);
    binary_methods!(min Min, max Max, rmin RMin, rmax RMax, pow Pow, modulo Modulo, lt Lt, le Le, eq Eq, atan2 Atan2);

    /// The whole power selfⁿ.
    pub fn powi(self, n: usize) -> Self {
        Self::new(self.graph, self.graph.borrow_mut().powi(self.id, n as i32))
    }

    /// Kept between two bounds.
    pub fn clamp(self, low: impl Operand<'g>, high: impl Operand<'g>) -> Self {
        self.max(low).min(high)
    }

    /// 1 where both conditions hold.
    pub fn and(self, other: Self) -> Self {
        self * other
    }

    /// Reads a condition: `if_true` where it holds, `if_false` elsewhere.
    pub fn select(self, if_true: impl Operand<'g>, if_false: impl Operand<'g>) -> Self {
        let (if_true, if_false) = (if_true.node_in(self.graph), if_false.node_in(self.graph));
        Self::new(self.graph, self.graph.borrow_mut().select(self.id, if_true, if_false))
    }

    /// A call of a function whose first argument this is.
    pub fn call(self, function: &Arc<dyn Function>, others: &[Self]) -> Self {
        let arguments: Vec<NodeId> = [self].iter().chain(others).map(|a| a.id).collect();
        Self::new(self.graph, self.graph.borrow_mut().call(function, &arguments))
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<'g, O: Operand<'g>> $trait<O> for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: O) -> Expr<'g> {
                self.binary(Binary::$trait, other)
            }
        }

        impl<'g> $trait<Expr<'g>> for f64 {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                other.number(self).binary(Binary::$trait, other)
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Expr<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Neg)
    }
}

/// A point or a direction in space.
#[derive(Clone, Copy, Debug)]
pub struct Vector<'g>(
    /// x, y and z.
    pub [Expr<'g>; 3],
);

impl<'g> Vector<'g> {
    /// Component by component.
    pub fn map(self, f: impl FnMut(Expr<'g>) -> Expr<'g>) -> Self {
        Self(self.0.map(f))
    }

    /// Component by component, with another vector.
    pub fn zip(self, other: Self, f: impl Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        Self([0, 1, 2].map(|k| f(self.0[k], other.0[k])))
    }

    /// The inner product.
    pub fn dot(self, other: Self) -> Expr<'g> {
        let [a, b, c] = self.zip(other, |p, q| p * q).0;
        a + b + c
    }

    /// The square of the length.
    pub fn squared(self) -> Expr<'g> {
        self.dot(self)
    }

    /// The length.
    pub fn length(self) -> Expr<'g> {
        self.squared().sqrt()
    }

    /// The same direction with length 1.
    pub fn unit(self) -> Self {
        let length = self.length();
        self.map(|a| a / length)
    }

    /// The vector product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [p, q, r]) = (self.0, other.0);
        Self([b * r - c * q, c * p - a * r, a * q - b * p])
    }

    /// The component along an axis, and the two across it in the order of a right-handed frame.
    pub fn along_and_across(self, axis: usize) -> (Expr<'g>, [Expr<'g>; 2]) {
        (self.0[axis], [self.0[(axis + 1) % 3], self.0[(axis + 2) % 3]])
    }

    /// `self` where a condition holds, `other` elsewhere.
    pub fn where_else(self, condition: Expr<'g>, other: Self) -> Self {
        self.zip(other, |a, b| condition.select(a, b))
    }
}

impl<'g> Add for Vector<'g> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<'g> Sub for Vector<'g> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<'g> Mul<Expr<'g>> for Vector<'g> {
    type Output = Self;
    fn mul(self, factor: Expr<'g>) -> Self {
        self.map(|a| a * factor)
    }
}
