//! Fields of which only the sign matters.

use fieldstone_field::{Binary, Field, Graph, Node, NodeId, Unary};
use std::collections::HashMap;

/// A field with the same sign everywhere in which R-functions (Rvachev 1963) that nothing but set operations read are
/// minima and maxima: these are shortened in every cell where one operand decides, and have closer bounds. So are slabs
/// |a| − b, since max(a − b, −a − b) has no kink but where its operands meet.
///
/// On the surface both have gradients of the same direction.
pub(super) fn sign_form(field: &Field) -> Field {
    let mut graph = (**field.graph()).clone();
    let value = Signs::default().of(&mut graph, field.value());
    Field::new(graph, value, Vec::new()).with_fuel(field.fuel())
}

/// Whether a field is a minimum or a maximum.
pub(super) fn is_set_operation(field: &Field) -> bool {
    let graph = field.graph();
    let mut node = field.value();
    while let Node::Unary(Unary::Neg, a) = graph.node(node) {
        node = *a;
    }
    matches!(graph.node(node), Node::Binary(Binary::Min | Binary::Max, ..))
}

#[derive(Default)]
struct Signs {
    known: HashMap<NodeId, NodeId>,
}

impl Signs {
    /// A node with the same sign; without recursion, because programs may be deep.
    fn of(&mut self, graph: &mut Graph, node: NodeId) -> NodeId {
        let mut stack = vec![node];
        while let Some(&n) = stack.last() {
            let read = read_by_sign(graph, n);
            let missing: Vec<NodeId> =
                read.iter().flatten().copied().filter(|o| !self.known.contains_key(o)).collect();
            if !missing.is_empty() {
                stack.extend(missing);
                continue;
            }
            stack.pop();
            let sign = self.rebuilt(graph, n);
            self.known.insert(n, sign);
        }
        self.known[&node]
    }

    /// A node whose operands are known.
    fn rebuilt(&self, graph: &mut Graph, n: NodeId) -> NodeId {
        let sign = |o: &NodeId| self.known[o];
        match graph.node(n).clone() {
            Node::Unary(Unary::Neg, a) => graph.neg(sign(&a)),
            Node::Binary(Binary::Min | Binary::RMin, a, b) => graph.min(sign(&a), sign(&b)),
            Node::Binary(Binary::Max | Binary::RMax, a, b) => graph.max(sign(&a), sign(&b)),
            Node::Select(c, a, b) => graph.select(c, sign(&a), sign(&b)),
            Node::Binary(Binary::Mul, a, b) => match factor(graph, (a, b)) {
                Some((rest, true)) => sign(&rest),
                Some((rest, false)) => graph.neg(sign(&rest)),
                None => n,
            },
            Node::Binary(op @ (Binary::Add | Binary::Sub), a, b) => slab(graph, op, (a, b)).unwrap_or(n),
            _ => n,
        }
    }
}

/// A sum with an absolute value as a minimum or a maximum: |a| ± b and b ± |a|.
fn slab(graph: &mut Graph, op: Binary, (a, b): (NodeId, NodeId)) -> Option<NodeId> {
    let inner = |graph: &Graph, n: NodeId| match *graph.node(n) {
        Node::Unary(Unary::Abs, inner) => Some(inner),
        _ => None,
    };
    if let Some(a) = inner(graph, a) {
        let (up, down) = (graph.binary(op, a, b), graph.neg(a));
        let down = graph.binary(op, down, b);
        return Some(graph.max(up, down));
    }
    let b = inner(graph, b)?;
    let (plus, minus) = (graph.add(a, b), graph.sub(a, b));
    Some(if op == Binary::Add { graph.max(plus, minus) } else { graph.min(plus, minus) })
}

/// The other operand of a product with a constant that is not 0, and whether the constant is positive.
fn factor(graph: &Graph, (a, b): (NodeId, NodeId)) -> Option<(NodeId, bool)> {
    let of = |constant: NodeId, rest: NodeId| {
        let value = graph.constant_value(constant).filter(|k| k.is_finite() && *k != 0.0)?;
        Some((rest, value > 0.0))
    };
    of(a, b).or_else(|| of(b, a))
}

/// The operands of which a node reads but the sign, if only its sign is read.
fn read_by_sign(graph: &Graph, n: NodeId) -> [Option<NodeId>; 2] {
    match *graph.node(n) {
        Node::Binary(Binary::Mul, a, b) => [factor(graph, (a, b)).map(|(rest, _)| rest), None],
        Node::Unary(Unary::Neg, a) => [Some(a), None],
        Node::Binary(Binary::Min | Binary::Max | Binary::RMin | Binary::RMax, a, b) => [Some(a), Some(b)],
        Node::Select(_, a, b) => [Some(a), Some(b)],
        _ => [None, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_field::{Bindings, Input};

    #[test]
    fn constant_factors_are_left_out() {
        let mut graph = Graph::new();
        let [x, y] = [0, 1].map(|k| graph.input(Input::Coordinate(k)));
        let (union, k) = (graph.min(x, y), graph.constant(-0.25));
        let scaled = graph.mul(union, k);
        let sign = sign_form(&Field::new(graph, scaled, Vec::new()));
        assert!(is_set_operation(&sign));
        for p in [[0.3, 0.2, 0.0], [-0.3, 0.7, 0.0], [-0.9, -0.4, 0.0]] {
            assert_eq!(sign.at(&p, &Bindings::new())[0], -p[0].min(p[1]));
        }
    }

    #[test]
    fn slabs_keep_their_values() {
        let mut graph = Graph::new();
        let [x, y] = [0, 1].map(|k| graph.input(Input::Coordinate(k)));
        let (wide, half) = (graph.abs(x), graph.constant(0.5));
        let high = graph.abs(y);
        let sums = [graph.sub(wide, half), graph.sub(half, high), graph.add(wide, y), graph.add(x, high)];
        for sum in sums {
            let field = Field::new(graph.clone(), sum, Vec::new());
            let sign = sign_form(&field);
            assert!(is_set_operation(&sign) && !is_set_operation(&field));
            for p in [[0.3, 0.2, 0.0], [-0.3, 0.7, 0.0], [-0.9, -0.4, 0.0], [0.8, -0.6, 0.0]] {
                let value = |field: &Field| field.at(&p, &Bindings::new())[0];
                assert_eq!(value(&sign), value(&field), "{p:?}");
            }
        }
    }
}
