//! Where a field is certainly undefined.
//!
//! NaN means *anything, or nothing* to domains of sets, so that no set of values ever proves that there is nothing. But
//! where a square root, a logarithm or another partial operation has its operand outside of its domain, there is nothing for
//! certain, and an undefined value is outside of the solid. That is a condition like any other: a node that is 0
//! there. With it a field is made that is positive where it is certainly undefined, and otherwise the same. Its
//! partial operations have their operands clamped to their domains, which changes nothing where the condition holds,
//! so that boxes across the edge of a domain have bounds too.

use crate::field::Field;
use crate::graph::{Graph, Node, NodeId};
use crate::op::{Binary, Unary};
use rustc_hash::FxHashMap;

/// The field whose sign is that of `field`, and which is 1 where a partial operation that the value cannot do without has
/// its operand outside of its domain.
pub(crate) fn outside_where_undefined(field: &Field) -> Field {
    let Some((clamped, condition)) = clamped_to_domain(field) else { return field.clone() };
    let mut graph = Graph::clone(clamped.graph());
    let outside = graph.constant(1.0);
    let value = graph.select(condition, clamped.value(), outside);
    Field::new(graph, value, field.attributes().to_vec()).with_fuel(field.fuel())
}

/// The field with clamped operands, and a node of its graph that is 0 where `field` is certainly undefined and 1
/// elsewhere; nothing if no place is known to be undefined.
pub(crate) fn clamped_to_domain(field: &Field) -> Option<(Field, NodeId)> {
    let mut definition = Definition { graph: Graph::clone(field.graph()), parts: FxHashMap::default() };
    let Part { value, condition } = definition.of(field.value());
    let clamped = Field::new(definition.graph, value, field.attributes().to_vec());
    Some((clamped.with_fuel(field.fuel()), condition?))
}

/// What a node becomes.
#[derive(Clone, Copy)]
struct Part {
    /// The node with clamped operands: the same wherever the condition holds.
    value: NodeId,
    /// A node that is 0 where the node is certainly undefined and 1 elsewhere; `None`: nothing is known.
    condition: Option<NodeId>,
}

/// How deep the form of an operand is looked at.
const DEPTH: usize = 12;

struct Definition {
    graph: Graph,
    /// The nodes that were seen.
    parts: FxHashMap<NodeId, Part>,
}

impl Definition {
    fn of(&mut self, root: NodeId) -> Part {
        let mut stack = vec![root];
        while let Some(&node) = stack.last() {
            if self.parts.contains_key(&node) {
                stack.pop();
                continue;
            }
            // A loop hides what happens inside.
            let operands = self.graph.node(node).operands();
            let waiting = stack.len();
            stack.extend(operands.iter().filter(|operand| !self.parts.contains_key(operand)));
            if stack.len() == waiting {
                let part = self.compute(node, &operands);
                self.parts.insert(node, part);
                stack.pop();
            }
        }
        self.known(root)
    }

    fn known(&self, node: NodeId) -> Part {
        self.parts.get(&node).copied().unwrap_or(Part { value: node, condition: None })
    }

    fn compute(&mut self, node: NodeId, operands: &[NodeId]) -> Part {
        let kind = self.graph.node(node).clone();
        if let Node::Select(condition, yes, no) = kind {
            return self.select([condition, yes, no].map(|operand| self.known(operand)));
        }
        if let Node::Constant(bits) = kind {
            if !f64::from_bits(bits).is_nan() {
                return Part { value: node, condition: None };
            }
            let (value, never) = (self.graph.constant(1.0), self.graph.constant(0.0));
            return Part { value, condition: Some(never) };
        }
        let known: Vec<Part> = operands.iter().map(|operand| self.known(*operand)).collect();
        let all = known.iter().fold(None, |all, part| self.both(all, part.condition));
        let values: Vec<NodeId> = known.iter().map(|part| part.value).collect();
        let (value, own) = self.clamped(node, &kind, &values);
        Part { value, condition: self.both(all, own) }
    }

    fn select(&mut self, [condition, yes, no]: [Part; 3]) -> Part {
        let chosen = match (yes.condition, no.condition) {
            (None, None) => None,
            (yes, no) => {
                let one = self.graph.constant(1.0);
                Some(self.graph.select(condition.value, yes.unwrap_or(one), no.unwrap_or(one)))
            }
        };
        let value = self.graph.select(condition.value, yes.value, no.value);
        Part { value, condition: self.both(condition.condition, chosen) }
    }

    /// An operation on other operands, those of a partial one clamped to its domain, and the condition that they lie there.
    fn clamped(&mut self, node: NodeId, kind: &Node, values: &[NodeId]) -> (NodeId, Option<NodeId>) {
        let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
        match (kind, values) {
            (Node::Unary(op @ (Unary::Sqrt | Unary::Ln), _), &[a]) if !self.is_never_negative(a, DEPTH) => {
                let (inside, clamped) = (self.graph.le(zero, a), self.graph.max(a, zero));
                (self.graph.unary(*op, clamped), Some(inside))
            }
            (Node::Unary(op @ (Unary::Asin | Unary::Acos | Unary::Atanh), _), &[a]) => {
                let (size, least) = (self.graph.abs(a), self.graph.constant(-1.0));
                let inside = self.graph.le(size, one);
                let raised = self.graph.max(a, least);
                let clamped = self.graph.min(raised, one);
                (self.graph.unary(*op, clamped), Some(inside))
            }
            (Node::Binary(Binary::Pow, ..), &[base, exponent])
                if self.is_fraction(exponent) && !self.is_never_negative(base, DEPTH) =>
            {
                let (inside, clamped) = (self.graph.le(zero, base), self.graph.max(base, zero));
                (self.graph.pow(clamped, exponent), Some(inside))
            }
            (Node::Unary(op, _), &[a]) => (self.graph.unary(*op, a), None),
            (Node::Binary(op, ..), &[a, b]) => (self.graph.binary(*op, a, b), None),
            (Node::Powi(_, n), &[a]) => (self.graph.powi(a, *n), None),
            (Node::Call(function, _), values) => {
                let function = self.graph.functions[*function as usize].clone();
                (self.graph.call(&function, values), None)
            }
            _ => (node, None),
        }
    }

    /// Whether the form of a node shows that it is never negative: a sum of squares, say.
    fn is_never_negative(&self, node: NodeId, depth: usize) -> bool {
        let Some(depth) = depth.checked_sub(1) else { return false };
        let holds = |n: NodeId| self.is_never_negative(n, depth);
        match *self.graph.node(node) {
            Node::Constant(bits) => f64::from_bits(bits) >= 0.0,
            Node::Unary(
                Unary::Square | Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Cosh | Unary::Acos,
                _,
            ) => true,
            Node::Powi(a, n) => n % 2 == 0 || holds(a),
            Node::Binary(Binary::Add | Binary::Mul | Binary::Div | Binary::Min, a, b) => holds(a) && holds(b),
            Node::Binary(Binary::Max, a, b) => holds(a) || holds(b),
            _ => false,
        }
    }

    fn is_fraction(&self, exponent: NodeId) -> bool {
        self.graph.constant_value(exponent).is_some_and(|e| e.is_finite() && e.fract() != 0.0)
    }

    /// 0 where the first is, and otherwise the second, which means nothing where the first is 0.
    fn both(&mut self, first: Option<NodeId>, second: Option<NodeId>) -> Option<NodeId> {
        match (first, second) {
            (Some(first), Some(second)) => {
                let zero = self.graph.constant(0.0);
                Some(self.graph.select(first, second, zero))
            }
            (one, other) => one.or(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bindings, Input, Interval, reference};

    /// √(√x − 1) + ln y, or NaN where z > 5.
    fn partial() -> Field {
        let mut g = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|i| g.input(Input::Coordinate(i)));
        let (one, five, nothing) = (g.constant(1.0), g.constant(5.0), g.constant(f64::NAN));
        let root = g.sqrt(x);
        let less = g.sub(root, one);
        let nested = g.sqrt(less);
        let logarithm = g.ln(y);
        let sum = g.add(nested, logarithm);
        let far = g.lt(five, z);
        let value = g.select(far, nothing, sum);
        Field::new(g, value, Vec::new())
    }

    #[test]
    fn points_without_a_value_are_outside_and_the_others_as_before() {
        let (field, guarded) = (partial(), outside_where_undefined(&partial()));
        for point in [
            [4.0, 2.0, 0.0],
            [1.0, 0.5, 5.0],
            [-1.0, 2.0, 0.0],
            [0.5, 2.0, 0.0],
            [4.0, -2.0, 0.0],
            [4.0, 2.0, 6.0],
        ] {
            let before = field.at(&point, &Bindings::new())[0];
            let after = guarded.at(&point, &Bindings::new())[0];
            assert_eq!(after, if before.is_nan() { 1.0 } else { before }, "{point:?}");
        }
    }

    #[test]
    fn boxes_without_a_value_are_positive() {
        let guarded = outside_where_undefined(&partial());
        let over = |boxes: [(f64, f64); 3]| {
            let input = |i| match i {
                Input::Coordinate(k) => Interval::new(boxes[usize::from(k)].0, boxes[usize::from(k)].1),
                _ => Interval::undefined(),
            };
            reference::evaluate(guarded.graph(), &[guarded.value()], (), input, 10)[0]
        };
        let all = (1.5, 2.0);
        let nowhere = [
            [(-2.0, -1.0), all, all],
            [(0.2, 0.8), all, all],
            [all, (-2.0, -1.0), all],
            [all, all, (5.5, 6.0)],
        ];
        for boxes in nowhere {
            assert_eq!(over(boxes), Interval::new(1.0, 1.0), "{boxes:?}");
        }
        assert!(over([all, all, all]).lo > 0.4);
        // Across the edges of domains there are bounds of both sides.
        for boxes in [[(-1.0, 2.0), all, all], [all, all, (4.0, 6.0)]] {
            let range = over(boxes);
            assert!(range.lo > 0.3 && range.contains(1.0), "{boxes:?}: {range:?}");
        }
        let logarithm = over([all, (-1.0, 1.0), all]);
        assert!(logarithm.lo == f64::NEG_INFINITY && logarithm.hi == 1.0, "{logarithm:?}");
    }

    #[test]
    fn total_fields_are_left_alone() {
        let mut g = Graph::new();
        let [x, y] = [0, 1].map(|i| g.input(Input::Coordinate(i)));
        let (p, q) = (g.square(x), g.square(y));
        let sum = g.add(p, q);
        let distance = g.sqrt(sum);
        let field = Field::new(g, distance, Vec::new());
        let guarded = outside_where_undefined(&field);
        assert!(std::sync::Arc::ptr_eq(guarded.graph(), field.graph()));
    }
}
