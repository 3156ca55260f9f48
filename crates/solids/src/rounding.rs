//! Bounds of rounding errors of programs as programs, so that they can be evaluated over boxes.
//!
//! A running error analysis (Wilkinson 1963; Higham 2002, section 3.3) with the sizes of all numbers over the box: if
//! the operands of an operation are wrong by at most E₁ and E₂, the result is wrong by at most what the operation makes
//! of that and what it rounds itself. The inputs are taken as exact. Where nothing is known (jumps, loops, calls),
//! the bound is undefined.

use crate::slope::where_decided;
use fieldstone_field::{Binary, Graph, Node, NodeId, Unary};
use std::collections::HashMap;

/// One rounding, with room for the products of errors that are left out.
const ROUNDING: f64 = f64::EPSILON;
/// The elementary functions are wrong by at most four units in the last place.
const LIBRARY: f64 = 4.0 * f64::EPSILON;
/// R-functions, as their intervals have it.
const R_FUNCTION: f64 = 8.0 * f64::EPSILON;
/// Room for errors of errors.
const ROOM: f64 = 1.01;

/// Programs that bound by how much the computed outputs may differ from the exact ones.
pub(crate) fn rounding(graph: &mut Graph, outputs: &[NodeId]) -> Vec<NodeId> {
    let mut nodes = graph.reachable(outputs);
    nodes.sort_unstable();
    let mut known: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    for node in nodes {
        let error = error(graph, node, &known);
        known.insert(node, error);
    }
    let zero = graph.constant(0.0);
    outputs.iter().map(|output| known.get(output).copied().flatten().unwrap_or(zero)).collect()
}

/// The error of a node whose operands have theirs; `None` for 0.
fn error(graph: &mut Graph, n: NodeId, known: &HashMap<NodeId, Option<NodeId>>) -> Option<NodeId> {
    let of = |node: &NodeId| known.get(node).copied().flatten();
    match graph.node(n).clone() {
        Node::Constant(_) | Node::Input(_) => None,
        Node::Unary(op, a) => unary(graph, op, (n, a), of(&a)),
        Node::Powi(a, k) => {
            let lower = graph.powi(a, k - 1);
            let steep = scaled(graph, lower, f64::from(k) * ROOM);
            let handed = of(&a).map(|e| product(graph, steep, e));
            // Squarings and products, each of which may double the relative error so far.
            Some(with_own(graph, n, (handed, 2.0 * f64::from(k).abs() * ROUNDING)))
        }
        Node::Binary(op, a, b) => binary(graph, op, [n, a, b], [of(&a), of(&b)]),
        Node::Select(condition, a, b) => {
            let zero = graph.constant(0.0);
            let [first, second] = [of(&a), of(&b)].map(|e| e.unwrap_or(zero));
            let chosen = graph.select(condition, first, second);
            // The condition is decided for computed numbers and exact ones alike.
            Some(where_decided(graph, condition, chosen))
        }
        _ => Some(graph.constant(f64::NAN)),
    }
}

fn unary(graph: &mut Graph, op: Unary, (n, a): (NodeId, NodeId), e: Option<NodeId>) -> Option<NodeId> {
    let (handed, own) = match op {
        Unary::Neg | Unary::Abs => return e,
        Unary::Sqrt => (e.map(|e| root(graph, n, e)), ROUNDING),
        Unary::Square => (e.map(|e| squared(graph, a, e)), ROUNDING),
        Unary::Recip => (e.map(|e| quotient(graph, n, (a, e), None)), ROUNDING),
        Unary::Exp => (e.map(|e| steeper(graph, n, e)), LIBRARY),
        Unary::Ln => (
            e.map(|e| {
                let rest = less(graph, a, e);
                graph.div(e, rest)
            }),
            LIBRARY,
        ),
        Unary::Sin | Unary::Cos | Unary::Atan | Unary::Tanh => (e, LIBRARY),
        Unary::Tan => {
            let handed = e.map(|e| {
                let (one, square) = (graph.constant(1.0), graph.square(n));
                let steep = graph.add(one, square);
                steeper(graph, steep, e)
            });
            (handed, LIBRARY)
        }
        Unary::Sinh | Unary::Cosh => {
            let handed = e.map(|e| {
                let steep = graph.cosh(a);
                steeper(graph, steep, e)
            });
            (handed, LIBRARY)
        }
        _ => return Some(graph.constant(f64::NAN)),
    };
    Some(with_own(graph, n, (handed, own)))
}

fn binary(
    graph: &mut Graph,
    op: Binary,
    [n, a, b]: [NodeId; 3],
    errors: [Option<NodeId>; 2],
) -> Option<NodeId> {
    let zero = graph.constant(0.0);
    let [e, f] = errors.map(|e| e.unwrap_or(zero));
    let has_errors = errors != [None; 2];
    let (handed, own) = match op {
        Binary::Add | Binary::Sub => (graph.add(e, f), ROUNDING),
        Binary::Min | Binary::Max => return has_errors.then(|| graph.max(e, f)),
        Binary::Mul => {
            let (left, right, both) = (product(graph, b, e), product(graph, a, f), graph.mul(e, f));
            let sum = graph.add(left, right);
            (graph.add(sum, both), ROUNDING)
        }
        Binary::Div => (quotient(graph, n, (b, f), Some(e)), ROUNDING),
        Binary::RMin | Binary::RMax => {
            let sum = graph.add(e, f);
            (scaled(graph, sum, 2.0 * ROOM), R_FUNCTION)
        }
        Binary::Pow if errors[1].is_none() => {
            let one = graph.constant(1.0);
            let less = graph.sub(b, one);
            let (power, by) = (graph.pow(a, less), scaled(graph, b, ROOM));
            let steep = graph.mul(by, power);
            (product(graph, steep, e), LIBRARY)
        }
        _ => return Some(graph.constant(f64::NAN)),
    };
    Some(with_own(graph, n, (has_errors.then_some(handed), own)))
}

/// What was handed on and what the operation rounds itself.
fn with_own(graph: &mut Graph, n: NodeId, (handed, own): (Option<NodeId>, f64)) -> NodeId {
    let (relative, smallest) = (scaled(graph, n, own), graph.constant(f64::MIN_POSITIVE));
    let size = graph.abs(relative);
    let own = graph.add(size, smallest);
    handed.map_or(own, |handed| graph.add(handed, own))
}

fn scaled(graph: &mut Graph, n: NodeId, by: f64) -> NodeId {
    let factor = graph.constant(by);
    graph.mul(n, factor)
}

/// |n|·e.
fn product(graph: &mut Graph, n: NodeId, e: NodeId) -> NodeId {
    let size = graph.abs(n);
    graph.mul(size, e)
}

fn steeper(graph: &mut Graph, steep: NodeId, e: NodeId) -> NodeId {
    let wide = scaled(graph, e, ROOM);
    product(graph, steep, wide)
}

/// |a| − 2e, which must not reach 0.
fn less(graph: &mut Graph, a: NodeId, e: NodeId) -> NodeId {
    let (size, twice) = (graph.abs(a), scaled(graph, e, 2.0));
    let rest = graph.sub(size, twice);
    // Undefined where it does.
    let root = graph.sqrt(rest);
    graph.square(root)
}

/// |√a − √a′| = |a − a′| / (√a + √a′), and at most √|a − a′|.
fn root(graph: &mut Graph, n: NodeId, e: NodeId) -> NodeId {
    let short = graph.sqrt(e);
    let longer = graph.max(n, short);
    let wide = scaled(graph, e, ROOM);
    graph.div(wide, longer)
}

/// 2|a|e + e².
fn squared(graph: &mut Graph, a: NodeId, e: NodeId) -> NodeId {
    let (linear, square) = (product(graph, a, e), graph.square(e));
    let twice = graph.add(linear, linear);
    graph.add(twice, square)
}

/// Of the quotient n = a/b with an error f of b: (e + |n|·f) / (|b| − 2f).
fn quotient(graph: &mut Graph, n: NodeId, (b, f): (NodeId, NodeId), e: Option<NodeId>) -> NodeId {
    let moved = product(graph, n, f);
    let top = e.map_or(moved, |e| graph.add(e, moved));
    let rest = less(graph, b, f);
    graph.div(top, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_field::{F64, Field, Input, Interval, Intervals, Points, Tape, TapeOptions, Workspace};

    /// The bound of Σ xᵏ around a place against the same sum in exact arithmetic: all numbers are multiples of 2⁻²⁰.
    #[test]
    fn the_bound_holds_and_is_near() {
        let mut graph = Graph::new();
        let x = graph.input(Input::Coordinate(0));
        let mut sum = graph.constant(0.0);
        for k in 1..5 {
            let power = graph.powi(x, k);
            let third = graph.constant(0.375);
            let term = graph.mul(power, third);
            sum = graph.sub(term, sum);
        }
        let bound = rounding(&mut graph, &[sum])[0];
        let tape = Tape::new(
            &Field::new(graph, sum, vec![bound]),
            &TapeOptions { attributes: true, varying: vec![Input::Coordinate(0)], ..TapeOptions::default() },
        );
        let (mut points, mut boxes) = (Workspace::<F64, Points>::new(), Workspace::<F64, Intervals>::new());
        let mut largest = 0.0f64;
        for i in 0..2000i64 {
            let whole = 1_500_001 + 1237 * i;
            let x = whole as f64 / f64::from(1 << 20);
            points.input(0, 0)[0] = x;
            points.run(&tape, 1);
            (boxes.input(0, 0)[0], boxes.input(0, 1)[0]) = (x, x + 0.01);
            boxes.run(&tape, 1);
            let side = Interval::new(boxes.output(1, 0)[0], boxes.output(1, 1)[0]);
            // 8·2⁸⁰·exact: Σ ±3 xᵏ 2⁸⁰/… with x = whole / 2²⁰.
            let exact = [1, 2, 3, 4]
                .iter()
                .fold(0i128, |sum, &k| 3 * i128::from(whole).pow(k) * (1i128 << (20 * (4 - k))) - sum);
            // The computed value as a multiple of 2⁻⁸³, if it is one, as sums of such numbers are.
            let scaled = points.output(0, 0)[0] * 2f64.powi(83);
            let error = ((scaled as i128) - exact) as f64 / 2f64.powi(83);
            assert!(error.abs() <= side.hi, "{error:e} {side:?}");
            largest = largest.max(error.abs() / side.hi);
        }
        assert!(largest > 0.02, "{largest}");
    }
}
