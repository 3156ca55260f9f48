//! Weights from 0 to 1, for linear blends and metamorphoses.

use crate::expression::{Expr, write};
use fieldstone_field::{Graph, NodeId};

/// (σ(k(t − ½)) − σ(−k/2)) / (σ(k/2) − σ(−k/2)) with the logistic function σ: slow, fast, slow. Exactly 0 for t ≤ 0 and 1
/// for t ≥ 1; the larger `steepness` k > 0, the faster in the middle.
///
/// Written with the hyperbolic tangent, ½ + ½ tanh(k(t − ½)/2) / tanh(k/4), in which t stands once.
pub fn sigmoid(graph: &mut Graph, steepness: NodeId, t: NodeId) -> NodeId {
    write(graph, |cell| {
        let [k, t] = [steepness, t].map(|id| Expr::new(cell, id));
        let quarter = 0.25 * k;
        (0.5 + 0.5 * (quarter * (2.0 * t.clamp(0.0, 1.0) - 1.0)).tanh() / quarter.tanh()).id()
    })
}

/// e^(−t²/2σ²): 1 for t = 0, falling to both sides; `deviation` is σ > 0.
pub fn gaussian(graph: &mut Graph, deviation: NodeId, t: NodeId) -> NodeId {
    write(graph, |cell| {
        let [deviation, t] = [deviation, t].map(|id| Expr::new(cell, id));
        (-0.5 * (t / deviation).square()).exp().id()
    })
}
