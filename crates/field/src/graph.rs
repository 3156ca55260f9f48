//! Field programs as a graph of hash-consed operations.
//!
//! A node is made once: asking for the same operation on the same operands returns the node that exists. Constants
//! are folded with the meaning of the operation on `f64`, and the written-out R-functions `f + g ± √(f² + g²)` become
//! the operations [`Binary::RMin`] and [`Binary::RMax`], whose interval forms are far tighter than the composition.

use crate::function::Function;
use crate::op::{Binary, Unary};
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::Arc;

/// A node of a [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct NodeId(pub(crate) u32);

/// A loop of a [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct LoopId(pub(crate) u32);

/// What a program depends on. Inputs are never baked into a program.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum Input {
    /// A coordinate of the point, counted from 0: x, y, z, w, ….
    Coordinate(u16),
    /// A parameter of the model, counted from 0.
    Parameter(u16),
    /// The time t, in seconds.
    Time,
}

/// An operation and its operands.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// A constant, by its bits.
    Constant(u64),
    /// An input.
    Input(Input),
    /// An operation with one operand.
    Unary(Unary, NodeId),
    /// A whole power.
    Powi(NodeId, i32),
    /// An operation with two operands.
    Binary(Binary, NodeId, NodeId),
    /// The second operand where the first is not 0, the third where it is; undefined where the first is.
    Select(NodeId, NodeId, NodeId),
    /// A call of the function with this number.
    Call(u32, Box<[NodeId]>),
    /// A value that a loop carries, seen from inside the loop.
    LoopVar(LoopId, u32),
    /// A value that a loop carries, after the loop.
    LoopOut(LoopId, u32),
}

/// A loop: carried values start at `initial` and become `next` as long as `condition` is not 0.
#[derive(Clone, Debug)]
pub(crate) struct Loop {
    pub(crate) initial: Vec<NodeId>,
    pub(crate) condition: NodeId,
    pub(crate) next: Vec<NodeId>,
    pub(crate) parent: Option<LoopId>,
    depth: u32,
}

/// A program under construction, or done.
#[derive(Clone, Default, Debug)]
pub struct Graph {
    pub(crate) nodes: Vec<Node>,
    /// The innermost loop that a node depends on.
    pub(crate) scopes: Vec<Option<LoopId>>,
    pub(crate) functions: Vec<Arc<dyn Function>>,
    pub(crate) loops: Vec<Loop>,
    ids: FxHashMap<Node, NodeId>,
}

impl Graph {
    /// An empty program.
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of nodes made so far.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether no node has been made.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The operation of a node.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    /// The value of a node if it is a constant.
    pub fn constant_value(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    /// The function that a [`Node::Call`] names by this number.
    pub fn function(&self, number: u32) -> &Arc<dyn Function> {
        &self.functions[number as usize]
    }

    fn intern(&mut self, node: Node) -> NodeId {
        if let Some(&id) = self.ids.get(&node) {
            return id;
        }
        let id = NodeId(self.nodes.len() as u32);
        self.scopes.push(self.scope_of(&node));
        self.nodes.push(node.clone());
        self.ids.insert(node, id);
        id
    }

    fn scope_of(&self, node: &Node) -> Option<LoopId> {
        match node {
            Node::LoopVar(id, _) => Some(*id),
            Node::LoopOut(id, _) => self.loop_scope(*id),
            other => {
                other.operands().iter().fold(None, |scope, &o| self.inner(scope, self.scopes[o.0 as usize]))
            }
        }
    }

    /// The deeper of two scopes, of which one encloses the other.
    fn inner(&self, a: Option<LoopId>, b: Option<LoopId>) -> Option<LoopId> {
        let depth = |s: Option<LoopId>| s.map_or(0, |l| self.loops[l.0 as usize].depth + 1);
        if depth(b) > depth(a) { b } else { a }
    }

    /// The innermost loop around loop `id` that anything inside it depends on.
    fn loop_scope(&self, id: LoopId) -> Option<LoopId> {
        self.loop_free_nodes(id)
            .into_iter()
            .fold(None, |scope, n| self.inner(scope, self.scopes[n.0 as usize]))
    }

    /// Whether `scope` is loop `id` or lies inside it.
    pub(crate) fn is_within(&self, scope: Option<LoopId>, id: LoopId) -> bool {
        let mut scope = scope;
        while let Some(l) = scope {
            if l == id {
                return true;
            }
            scope = self.loops[l.0 as usize].parent;
        }
        false
    }

    /// The nodes outside loop `id` that the loop reads, the initial values among them.
    pub(crate) fn loop_free_nodes(&self, id: LoopId) -> Vec<NodeId> {
        let l = &self.loops[id.0 as usize];
        let mut free = l.initial.clone();
        let mut seen: FxHashSet<NodeId> = FxHashSet::default();
        let mut stack: Vec<NodeId> = l.next.iter().copied().chain([l.condition]).collect();
        while let Some(n) = stack.pop() {
            if !seen.insert(n) {
                continue;
            }
            if !self.is_within(self.scopes[n.0 as usize], id) {
                free.push(n);
                continue;
            }
            match self.node(n) {
                Node::LoopVar(..) => {}
                Node::LoopOut(inner, _) => stack.extend(self.loop_free_nodes(*inner)),
                other => stack.extend(other.operands()),
            }
        }
        free
    }

    /// Everything that `outputs` depend on, themselves included, through loops too.
    pub fn reachable(&self, outputs: &[NodeId]) -> Vec<NodeId> {
        let mut seen = vec![false; self.len()];
        let mut loops_seen = vec![false; self.loops.len()];
        let mut stack = outputs.to_vec();
        let mut found = Vec::new();
        while let Some(n) = stack.pop() {
            if std::mem::replace(&mut seen[n.0 as usize], true) {
                continue;
            }
            found.push(n);
            match self.node(n) {
                Node::LoopOut(l, _) if !std::mem::replace(&mut loops_seen[l.0 as usize], true) => {
                    let body = &self.loops[l.0 as usize];
                    stack.extend(body.initial.iter().chain(&body.next).chain([&body.condition]));
                }
                other => stack.extend(other.operands()),
            }
        }
        found
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> NodeId {
        // One NaN only, so that equal programs have equal nodes.
        let value = if value.is_nan() { f64::NAN } else { value };
        self.intern(Node::Constant(value.to_bits()))
    }

    /// An input.
    pub fn input(&mut self, input: Input) -> NodeId {
        self.intern(Node::Input(input))
    }

    /// An operation with one operand.
    pub fn unary(&mut self, op: Unary, a: NodeId) -> NodeId {
        if let Some(value) = self.constant_value(a) {
            return self.constant(op.apply(value));
        }
        match (op, self.node(a).clone()) {
            (Unary::Neg, Node::Unary(Unary::Neg, inner)) => return inner,
            (Unary::Neg, Node::Binary(Binary::Sub, p, q)) => return self.binary(Binary::Sub, q, p),
            (Unary::Abs, Node::Unary(Unary::Neg, inner)) => return self.unary(Unary::Abs, inner),
            (Unary::Abs, Node::Unary(Unary::Square | Unary::Abs | Unary::Sqrt | Unary::Exp, _)) => return a,
            (Unary::Square, Node::Unary(Unary::Neg | Unary::Abs, inner)) => {
                return self.unary(Unary::Square, inner);
            }
            _ => {}
        }
        self.intern(Node::Unary(op, a))
    }

    /// The whole power aⁿ.
    pub fn powi(&mut self, a: NodeId, n: i32) -> NodeId {
        match n {
            0 => return self.constant(1.0),
            1 => return a,
            2 => return self.unary(Unary::Square, a),
            -1 => return self.unary(Unary::Recip, a),
            // Exponents have a negative.
            i32::MIN => {
                let root = self.powi(a, i32::MIN / 2);
                return self.unary(Unary::Square, root);
            }
            _ => {}
        }
        if let Some(value) = self.constant_value(a) {
            return self.constant(crate::Domain::powi(value, n));
        }
        self.intern(Node::Powi(a, n))
    }

    /// An operation with two operands.
    pub fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        let (p, q) = (self.constant_value(a), self.constant_value(b));
        if let (Some(p), Some(q)) = (p, q) {
            return self.constant(op.apply(p, q));
        }
        if let Some(simpler) = self.simplify(op, a, b, p, q) {
            return simpler;
        }
        let (a, b) = if op.is_commutative() && b < a { (b, a) } else { (a, b) };
        self.intern(Node::Binary(op, a, b))
    }

    /// A cheaper node with the same value, for operands whose constant values are `p` and `q`.
    fn simplify(
        &mut self,
        op: Binary,
        a: NodeId,
        b: NodeId,
        p: Option<f64>,
        q: Option<f64>,
    ) -> Option<NodeId> {
        use Binary::*;
        match (op, p, q) {
            (Add, Some(0.0), _) | (Mul, Some(1.0), _) => return Some(b),
            (Add | Sub, _, Some(0.0)) | (Mul | Div | Pow, _, Some(1.0)) => return Some(a),
            (Sub, Some(0.0), _) | (Mul, Some(-1.0), _) => return Some(self.unary(Unary::Neg, b)),
            (Mul | Div, _, Some(-1.0)) => return Some(self.unary(Unary::Neg, a)),
            (Div, Some(1.0), _) => return Some(self.unary(Unary::Recip, b)),
            (Pow, _, Some(0.5)) => return Some(self.unary(Unary::Sqrt, a)),
            (Pow, _, Some(q)) if q == q.trunc() && q.abs() <= 4096.0 => return Some(self.powi(a, q as i32)),
            _ => {}
        }
        let negated = |graph: &Self, n: NodeId| match graph.node(n) {
            Node::Unary(Unary::Neg, inner) => Some(*inner),
            _ => None,
        };
        match op {
            Mul if a == b => Some(self.unary(Unary::Square, a)),
            Min | Max if a == b => Some(a),
            Add | Sub => {
                if let Some(r) = self.written_out_r_function(op, a, b) {
                    return Some(r);
                }
                let (opposite, inner) = (if op == Add { Sub } else { Add }, negated(self, b));
                if let Some(inner) = inner {
                    return Some(self.binary(opposite, a, inner));
                }
                match (op, negated(self, a)) {
                    (Add, Some(inner)) => Some(self.binary(Sub, b, inner)),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Recognises `f + g ± √(f² + g²)`.
    fn written_out_r_function(&mut self, op: Binary, a: NodeId, b: NodeId) -> Option<NodeId> {
        let (sum, root) = match (self.node(a), self.node(b)) {
            (_, Node::Unary(Unary::Sqrt, root)) => (a, *root),
            (Node::Unary(Unary::Sqrt, root), _) if op == Binary::Add => (b, *root),
            _ => return None,
        };
        let radicand = match self.node(root) {
            Node::Unary(Unary::Abs, inner) => *inner,
            _ => root,
        };
        let Node::Binary(Binary::Add, s, t) = *self.node(radicand) else { return None };
        let (Node::Unary(Unary::Square, f), Node::Unary(Unary::Square, g)) = (self.node(s), self.node(t))
        else {
            return None;
        };
        let (f, g) = (*f, *g);
        // The squares do not show a sign, so that the sum tells with which signs f and g are meant.
        let (f, g) = match *self.node(sum) {
            Node::Binary(Binary::Add, p, q) if (p, q) == (f, g) || (q, p) == (f, g) => (f, g),
            Node::Binary(Binary::Sub, p, q) if (p, q) == (f, g) || (q, p) == (f, g) => {
                let negated = self.unary(Unary::Neg, q);
                (p, negated)
            }
            _ => return None,
        };
        Some(self.binary(if op == Binary::Add { Binary::RMax } else { Binary::RMin }, f, g))
    }

    /// `if_true` where `condition` is not 0, `if_false` where it is, undefined where the condition is.
    pub fn select(&mut self, condition: NodeId, if_true: NodeId, if_false: NodeId) -> NodeId {
        match self.constant_value(condition) {
            Some(c) if c.is_nan() => self.constant(f64::NAN),
            Some(0.0) => if_false,
            Some(_) => if_true,
            None if if_true == if_false => if_true,
            None => self.intern(Node::Select(condition, if_true, if_false)),
        }
    }

    /// A call of a function.
    pub fn call(&mut self, function: &Arc<dyn Function>, arguments: &[NodeId]) -> NodeId {
        let values: Option<Vec<f64>> = arguments.iter().map(|&a| self.constant_value(a)).collect();
        if let Some(values) = values {
            return self.constant(function.value(&values));
        }
        let known = self.functions.iter().position(|f| Arc::ptr_eq(f, function));
        let number = known.unwrap_or_else(|| {
            self.functions.push(function.clone());
            self.functions.len() - 1
        });
        self.intern(Node::Call(number as u32, arguments.into()))
    }

    /// Opens a loop that carries values, which start at `initial`. Nodes made from its
    /// [`loop_var`](Self::loop_var)s belong to its body until [`end_loop`](Self::end_loop).
    ///
    /// `parent` is the loop around this one.
    pub fn begin_loop(&mut self, initial: &[NodeId], parent: Option<LoopId>) -> LoopId {
        let id = LoopId(self.loops.len() as u32);
        let depth = parent.map_or(0, |p| self.loops[p.0 as usize].depth + 1);
        // Known only when the loop is closed.
        let condition = NodeId(u32::MAX);
        self.loops.push(Loop { initial: initial.to_vec(), condition, next: Vec::new(), parent, depth });
        id
    }

    /// The carried value `index`, seen from inside the loop.
    pub fn loop_var(&mut self, id: LoopId, index: usize) -> NodeId {
        self.intern(Node::LoopVar(id, index as u32))
    }

    /// Closes a loop: as long as `condition` is not 0, the carried values become `next`. Returns the carried values
    /// after the loop.
    ///
    /// A loop that runs out of fuel, or whose condition is undefined, leaves undefined values.
    pub fn end_loop(&mut self, id: LoopId, condition: NodeId, next: &[NodeId]) -> Vec<NodeId> {
        let l = &mut self.loops[id.0 as usize];
        debug_assert_eq!(l.initial.len(), next.len());
        l.condition = condition;
        l.next = next.to_vec();
        (0..next.len()).map(|i| self.intern(Node::LoopOut(id, i as u32))).collect()
    }
}

macro_rules! unary_methods {
    ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
        /// One method for each unary operation.
        #[allow(clippy::should_implement_trait, reason = "they make nodes, and are named after the table")]
        impl Graph {
            $($(#[$doc])* pub fn $method(&mut self, a: NodeId) -> NodeId { self.unary(Unary::$variant, a) })*
        }
    };
}
crate::for_each_unary!(unary_methods);

macro_rules! binary_methods {
    ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
        /// One method for each binary operation.
        #[allow(clippy::should_implement_trait, reason = "they make nodes, and are named after the table")]
        impl Graph {
            $($(#[$doc])* pub fn $method(&mut self, a: NodeId, b: NodeId) -> NodeId {
                self.binary(Binary::$variant, a, b)
            })*
        }
    };
}
crate::for_each_binary!(binary_methods);

impl Node {
    /// The nodes that this one reads; those that a loop reads are not among them.
    pub fn operands(&self) -> Vec<NodeId> {
        match self {
            Node::Constant(_) | Node::Input(_) | Node::LoopVar(..) | Node::LoopOut(..) => Vec::new(),
            Node::Unary(_, a) | Node::Powi(a, _) => vec![*a],
            Node::Binary(_, a, b) => vec![*a, *b],
            Node::Select(c, a, b) => vec![*c, *a, *b],
            Node::Call(_, arguments) => arguments.to_vec(),
        }
    }
}
