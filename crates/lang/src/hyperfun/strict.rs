//! What the C interpreter does differently: it takes numbers below 10⁻⁶ for 0.

use fieldstone_field::{Graph, NodeId};

/// What counts as 0.
const SMALL: f64 = 1e-6;

/// A value and the condition under which the interpreter computes it.
pub(super) struct Checked {
    pub(super) value: NodeId,
    pub(super) defined: NodeId,
}

/// 1 if |a| < 10⁻⁶, otherwise 0.
pub(super) fn is_small(graph: &mut Graph, a: NodeId) -> NodeId {
    let (size, small) = (graph.abs(a), graph.constant(SMALL));
    graph.lt(size, small)
}

/// 1 if |a| ≥ 10⁻⁶, otherwise 0.
pub(super) fn is_not_small(graph: &mut Graph, a: NodeId) -> NodeId {
    let (size, small) = (graph.abs(a), graph.constant(SMALL));
    graph.le(small, size)
}

/// 1 if |a − b| < 10⁻⁶, otherwise 0.
pub(super) fn equal(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let difference = graph.sub(a, b);
    is_small(graph, difference)
}

/// a / b, defined for |b| ≥ 10⁻⁶.
pub(super) fn divide(graph: &mut Graph, a: NodeId, b: NodeId) -> Checked {
    Checked { value: graph.div(a, b), defined: is_not_small(graph, b) }
}

/// aᵇ: 0 for a small base and b > 10⁻⁶; a whole power if b is at most 10⁻⁶ above a whole number.
pub(super) fn power(graph: &mut Graph, a: NodeId, b: NodeId) -> Checked {
    let (zero, small) = (graph.constant(0.0), graph.constant(SMALL));
    let whole = graph.floor(b);
    let excess = graph.sub(b, whole);
    let is_whole = graph.lt(excess, small);
    let exponent = graph.select(is_whole, whole, b);
    let plain = graph.pow(a, exponent);
    let small_base = is_small(graph, a);
    let value = graph.select(small_base, zero, plain);
    let is_positive = graph.lt(small, b);
    let base_fits = graph.lt(zero, a);
    let otherwise = graph.max(is_whole, base_fits);
    let defined = graph.select(small_base, is_positive, otherwise);
    Checked { value, defined }
}
