//! A field as set operations on pieces.
//!
//! {min(f, g) < 0} is the union of {f < 0} and {g < 0}, {max(f, g) < 0} their intersection, and the same holds of the
//! R-functions. So the set operations at the top of a program are taken apart: each *piece* below them is bounded by a
//! plane of its own where the field itself has an edge.

use crate::gradient::Gradients;
use fieldstone_field::{Binary, Bindings, Field, Graph, Node, NodeId, Reading, Tape, TapeOptions, Unary};
use std::collections::{HashMap, HashSet, VecDeque};

/// No program is taken apart into more pieces than this; what is left stays together.
const MOST_PIECES: usize = 24;

/// A set made of pieces.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    /// Where a piece is negative.
    Piece(usize),
    /// The union of two earlier parts.
    Union(usize, usize),
    /// The intersection of two earlier parts.
    Intersection(usize, usize),
}

/// A field taken apart, ready to be evaluated over boxes.
#[derive(Debug)]
pub(crate) struct Pieces {
    /// The set operations; operands stand before what they make, the whole last.
    pub(crate) parts: Vec<Part>,
    /// How many pieces there are.
    pub(crate) count: usize,
    /// The piece that is positive where the field is certainly undefined, if that is known of any place.
    pub(crate) domain: Option<usize>,
    /// Outputs: the value of each piece.
    pub(crate) values: Tape,
    /// Outputs: the derivatives of each piece along x, y and z.
    pub(crate) gradients: Tape,
}

/// A node, or its negative.
type Signed = (NodeId, bool);

impl Pieces {
    pub(crate) fn new(field: &Field, bindings: &Bindings) -> Self {
        let (mut graph, value, outside) = with_domain(field);
        let root = without_signs(&graph, (value, false));
        let inner = set_operations(&graph, root);
        let mut places: HashMap<Signed, usize> = HashMap::new();
        let (mut parts, mut pieces) = (Vec::new(), Vec::new());
        let mut all: Vec<Signed> =
            inner.iter().flat_map(|&key| operands(&graph, key)).chain([root]).collect();
        // Operands are older than what is made of them.
        all.sort_unstable();
        all.dedup();
        for key in all {
            let place_of = |operand: Signed| places.get(&operand).copied().unwrap_or_default();
            let part = match operation(&graph, key) {
                Some((is_union, a, b)) if inner.contains(&key) => {
                    let (a, b) = (place_of(a), place_of(b));
                    if is_union { Part::Union(a, b) } else { Part::Intersection(a, b) }
                }
                _ => {
                    let (node, negative) = key;
                    pieces.push(if negative { graph.neg(node) } else { node });
                    Part::Piece(pieces.len() - 1)
                }
            };
            places.insert(key, parts.len());
            parts.push(part);
        }
        let domain = outside.and_then(|node| match parts[*places.get(&(node, false))?] {
            Part::Piece(piece) => Some(piece),
            _ => None,
        });
        let mut gradients = Gradients::default();
        let slopes: Vec<NodeId> = pieces.iter().flat_map(|&piece| gradients.of(&mut graph, piece)).collect();
        let graph = std::sync::Arc::new(graph);
        let tape = |outputs: &[NodeId]| {
            let outputs = Field::new(graph.clone(), outputs[0], outputs[1..].to_vec());
            let field = outputs.with_fuel(field.fuel());
            let (bindings, reading) = (bindings.clone(), Reading::Value);
            Tape::new(&field, &TapeOptions { bindings, reading, attributes: true, ..TapeOptions::default() })
        };
        Self { parts, count: pieces.len(), domain, values: tape(&pieces), gradients: tape(&slopes) }
    }
}

/// A graph with a node of the same sign as a field, intersected with another one that is positive where the field is
/// certainly undefined, which is outside of the solid.
fn with_domain(field: &Field) -> (Graph, NodeId, Option<NodeId>) {
    let Some((clamped, condition)) = field.clamped_to_domain() else {
        return (Graph::clone(field.graph()), field.value(), None);
    };
    let mut graph = Graph::clone(clamped.graph());
    let half = graph.constant(0.5);
    let outside = graph.sub(half, condition);
    let value = graph.max(clamped.value(), outside);
    (graph, value, Some(outside))
}

/// The set operations that are taken apart, the topmost first.
fn set_operations(graph: &Graph, root: Signed) -> HashSet<Signed> {
    let mut inner = HashSet::new();
    let mut seen = HashSet::from([root]);
    let mut queue = VecDeque::from([root]);
    while let Some(key) = queue.pop_front() {
        // Whatever is taken apart has two operands, at worst both new.
        let fits = seen.len() - inner.len() < MOST_PIECES;
        if fits && operation(graph, key).is_some() {
            inner.insert(key);
            queue.extend(operands(graph, key).into_iter().filter(|&operand| seen.insert(operand)));
        }
    }
    inner
}

fn operands(graph: &Graph, key: Signed) -> Vec<Signed> {
    operation(graph, key).map_or_else(Vec::new, |(_, a, b)| vec![a, b])
}

/// Whether a node is a union, and of what; `None` if it is no set operation.
fn operation(graph: &Graph, (node, negative): Signed) -> Option<(bool, Signed, Signed)> {
    let Node::Binary(op, a, b) = *graph.node(node) else { return None };
    let is_union = match op {
        Binary::Min | Binary::RMin => !negative,
        Binary::Max | Binary::RMax => negative,
        _ => return None,
    };
    let operand = |n| without_signs(graph, (n, negative));
    Some((is_union, operand(a), operand(b)))
}

fn without_signs(graph: &Graph, (mut node, mut negative): Signed) -> Signed {
    while let Node::Unary(Unary::Neg, inner) = *graph.node(node) {
        (node, negative) = (inner, !negative);
    }
    (node, negative)
}
