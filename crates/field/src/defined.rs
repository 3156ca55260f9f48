//! Where a field is certainly undefined.
//!
//! NaN means *anything, or nothing* to domains of sets, so that no set of values ever proves that there is nothing. But
//! where a square root, a logarithm or another partial operation has its operand outside of its domain, there is nothing for
//! certain, and an undefined value is outside of the solid. That is a condition like any other: a node that is 0
//! there. With it a field is made that is positive where it is certainly undefined, and otherwise the same.

use crate::field::Field;
use crate::graph::{Graph, Node, NodeId};
use crate::op::{Binary, Unary};
use rustc_hash::FxHashMap;

/// The field whose sign is that of `field`, and which is 1 where a partial operation that the value cannot do without has
/// its operand outside of its domain.
pub(crate) fn outside_where_undefined(field: &Field) -> Field {
    let mut definition = Definition { graph: Graph::clone(field.graph()), conditions: FxHashMap::default() };
    match definition.of(field.value()) {
        None => field.clone(),
        Some(condition) => {
            let mut graph = definition.graph;
            let outside = graph.constant(1.0);
            let value = graph.select(condition, field.value(), outside);
            Field::new(graph, value, field.attributes().to_vec()).with_fuel(field.fuel())
        }
    }
}

struct Definition {
    graph: Graph,
    /// For each node that was seen, a node that is 0 where it is certainly undefined and 1 elsewhere, itself defined
    /// everywhere but where loops and calls are not; `None`: nothing is known.
    conditions: FxHashMap<NodeId, Option<NodeId>>,
}

impl Definition {
    fn of(&mut self, root: NodeId) -> Option<NodeId> {
        let mut stack = vec![root];
        while let Some(&node) = stack.last() {
            if self.conditions.contains_key(&node) {
                stack.pop();
                continue;
            }
            // A loop hides what happens inside.
            let operands = self.graph.node(node).operands();
            let waiting = stack.len();
            stack.extend(operands.iter().filter(|operand| !self.conditions.contains_key(operand)));
            if stack.len() == waiting {
                let condition = self.compute(node, &operands);
                self.conditions.insert(node, condition);
                stack.pop();
            }
        }
        self.known(root)
    }

    fn known(&self, node: NodeId) -> Option<NodeId> {
        self.conditions.get(&node).copied().flatten()
    }

    fn compute(&mut self, node: NodeId, operands: &[NodeId]) -> Option<NodeId> {
        match self.graph.node(node).clone() {
            Node::Constant(bits) => f64::from_bits(bits).is_nan().then(|| self.graph.constant(0.0)),
            Node::Select(condition, yes, no) => {
                let sides = (self.known(yes), self.known(no));
                let chosen = match sides {
                    (None, None) => None,
                    (yes, no) => {
                        let one = self.graph.constant(1.0);
                        Some(self.graph.select(condition, yes.unwrap_or(one), no.unwrap_or(one)))
                    }
                };
                let condition = self.known(condition);
                self.both(condition, chosen)
            }
            other => {
                let operands = operands.iter().fold(None, |all, operand| {
                    let condition = self.known(*operand);
                    self.both(all, condition)
                });
                let own = self.domain(&other);
                self.both(operands, own)
            }
        }
    }

    /// 1 where the operand of a partial operation lies in its domain; `None` for all others.
    fn domain(&mut self, node: &Node) -> Option<NodeId> {
        let zero = self.graph.constant(0.0);
        match *node {
            Node::Unary(Unary::Sqrt | Unary::Ln, a) => Some(self.graph.le(zero, a)),
            Node::Unary(Unary::Asin | Unary::Acos | Unary::Atanh, a) => {
                let (size, one) = (self.graph.abs(a), self.graph.constant(1.0));
                Some(self.graph.le(size, one))
            }
            Node::Binary(Binary::Pow, base, exponent) => {
                let exponent = self.graph.constant_value(exponent)?;
                (exponent.is_finite() && exponent.fract() != 0.0).then(|| self.graph.le(zero, base))
            }
            _ => None,
        }
    }

    /// 0 where the first is, and otherwise the second, which need not be defined where the first is 0.
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
        for boxes in [[(-1.0, 2.0), all, all], [all, (-1.0, 1.0), all], [all, all, (4.0, 6.0)]] {
            assert!(over(boxes).lo.is_nan(), "{boxes:?}");
        }
    }

    #[test]
    fn total_fields_are_left_alone() {
        let mut g = Graph::new();
        let x = g.input(Input::Coordinate(0));
        let square = g.square(x);
        let nodes = g.len();
        assert_eq!(outside_where_undefined(&Field::new(g, square, Vec::new())).graph().len(), nodes);
    }
}
