//! Fields of which only the sign matters.

use fieldstone_field::{Binary, Field, Graph, Node, NodeId, Unary};
use std::collections::HashMap;

/// A field with the same sign everywhere in which R-functions (Rvachev 1963) that nothing but set operations read are
/// minima and maxima: these are shortened in every cell where one operand decides, and have closer bounds.
///
/// On the surface both have gradients of the same direction.
pub(super) fn sign_form(field: &Field) -> Field {
    let mut graph = (**field.graph()).clone();
    let value = Signs::default().of(&mut graph, field.value());
    Field::new(graph, value, Vec::new()).with_fuel(field.fuel())
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
            let read = read_by_sign(graph.node(n));
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
            _ => n,
        }
    }
}

/// The operands of which a node reads but the sign, if only its sign is read.
fn read_by_sign(node: &Node) -> [Option<NodeId>; 2] {
    match *node {
        Node::Unary(Unary::Neg, a) => [Some(a), None],
        Node::Binary(Binary::Min | Binary::Max | Binary::RMin | Binary::RMax, a, b) => [Some(a), Some(b)],
        Node::Select(_, a, b) => [Some(a), Some(b)],
        _ => [None, None],
    }
}
