//! Derivatives of programs as programs, so that they can be evaluated over boxes.
//!
//! Over a box the result bounds the difference quotients of the program (Clarke's generalised derivative: at a kink
//! both sides are joined). Where a program may jump, and in calls and loops, it is undefined. Derivatives of derivatives
//! are undefined wherever the box holds a kink.

use fieldstone_field::{Binary, Graph, Input, Node, NodeId, Unary};
use std::collections::HashMap;

/// The derivative of `output` along an input.
pub(crate) fn slope(graph: &mut Graph, output: NodeId, along: Input) -> NodeId {
    let mut known: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    // Operands are older than what is made of them.
    let mut nodes = graph.reachable(&[output]);
    nodes.sort_unstable();
    for node in nodes {
        let derivative = derive(graph, (node, along), &known);
        known.insert(node, derivative);
    }
    known.get(&output).copied().flatten().unwrap_or_else(|| graph.constant(0.0))
}

/// The derivative of a node whose operands have theirs; `None` for 0.
fn derive(
    graph: &mut Graph,
    (n, along): (NodeId, Input),
    known: &HashMap<NodeId, Option<NodeId>>,
) -> Option<NodeId> {
    let slope = |node: &NodeId| known.get(node).copied().flatten();
    let node = graph.node(n).clone();
    match node {
        Node::Constant(_) => None,
        Node::Input(input) => (input == along).then(|| graph.constant(1.0)),
        Node::Unary(op, a) => slope(&a).map(|s| unary(graph, op, (n, a), s)),
        Node::Powi(a, k) => slope(&a).map(|s| {
            let (power, factor) = (graph.powi(a, k - 1), graph.constant(f64::from(k)));
            let by = graph.mul(factor, power);
            graph.mul(by, s)
        }),
        Node::Binary(op, a, b) => binary(graph, op, [n, a, b], [slope(&a), slope(&b)]),
        Node::Select(condition, a, b) => {
            let zero = graph.constant(0.0);
            let [first, second] = [slope(&a), slope(&b)];
            let is_fixed = slope(&condition).is_none();
            if is_fixed && first.or(second).is_none() {
                return None;
            }
            let chosen = graph.select(condition, first.unwrap_or(zero), second.unwrap_or(zero));
            Some(if is_fixed { chosen } else { where_decided(graph, condition, chosen) })
        }
        Node::LoopVar(..) | Node::LoopOut(..) => Some(graph.constant(f64::NAN)),
        Node::Call(_, arguments) => {
            arguments.iter().any(|a| slope(a).is_some()).then(|| graph.constant(f64::NAN))
        }
    }
}

/// `value` where a condition is decided; undefined over boxes in which it may hold and may not.
pub(crate) fn where_decided(graph: &mut Graph, condition: NodeId, value: NodeId) -> NodeId {
    let [plus, minus] = [1.0, -1.0].map(|k| graph.constant(k));
    let side = graph.select(condition, plus, minus);
    let guard = nothing_but_at_sides(graph, side);
    graph.add(value, guard)
}

/// 0 where s is −1 or 1, undefined where it may lie between: 0·√(s² − ½).
fn nothing_but_at_sides(graph: &mut Graph, side: NodeId) -> NodeId {
    let [half, zero] = [0.5, 0.0].map(|k| graph.constant(k));
    let square = graph.square(side);
    let rest = graph.sub(square, half);
    let root = graph.sqrt(rest);
    graph.mul(zero, root)
}

fn unary(graph: &mut Graph, op: Unary, (n, a): (NodeId, NodeId), s: NodeId) -> NodeId {
    let by = match op {
        Unary::Neg => return graph.neg(s),
        Unary::Abs => graph.sign(a),
        // Constant but at the jump.
        Unary::Sign => return nothing_but_at_sides(graph, n),
        Unary::Sqrt => {
            let twice = graph.add(n, n);
            return graph.div(s, twice);
        }
        Unary::Square => graph.add(a, a),
        Unary::Recip => {
            let square = graph.square(n);
            graph.neg(square)
        }
        Unary::Exp => n,
        Unary::Ln => graph.recip(a),
        Unary::Sin => graph.cos(a),
        Unary::Cos => {
            let sine = graph.sin(a);
            graph.neg(sine)
        }
        Unary::Atan | Unary::Tanh | Unary::Tan => {
            let (one, of) = (graph.constant(1.0), if op == Unary::Atan { a } else { n });
            let square = graph.square(of);
            let sum = if op == Unary::Tanh { graph.sub(one, square) } else { graph.add(one, square) };
            if op == Unary::Atan { graph.recip(sum) } else { sum }
        }
        Unary::Sinh => graph.cosh(a),
        Unary::Cosh => graph.sinh(a),
        _ => return graph.constant(f64::NAN),
    };
    graph.mul(by, s)
}

fn binary(
    graph: &mut Graph,
    op: Binary,
    [n, a, b]: [NodeId; 3],
    slopes: [Option<NodeId>; 2],
) -> Option<NodeId> {
    if slopes == [None; 2] {
        return None;
    }
    let zero = graph.constant(0.0);
    let [s, t] = slopes.map(|slope| slope.unwrap_or(zero));
    Some(match op {
        Binary::Add => graph.add(s, t),
        Binary::Sub => graph.sub(s, t),
        Binary::Mul => {
            let (left, right) = (graph.mul(s, b), graph.mul(a, t));
            graph.add(left, right)
        }
        Binary::Div => {
            let moved = graph.mul(n, t);
            let rise = graph.sub(s, moved);
            graph.div(rise, b)
        }
        Binary::Min | Binary::Max => {
            let (low, high) = if op == Binary::Min { (a, b) } else { (b, a) };
            let less = graph.lt(low, high);
            graph.select(less, s, t)
        }
        Binary::RMin | Binary::RMax => {
            let squares = [a, b].map(|x| graph.square(x));
            let sum = graph.add(squares[0], squares[1]);
            let length = graph.sqrt(sum);
            let one = graph.constant(1.0);
            let [left, right] = [(a, s), (b, t)].map(|(x, slope)| {
                let share = graph.div(x, length);
                let by = if op == Binary::RMin { graph.sub(one, share) } else { graph.add(one, share) };
                graph.mul(by, slope)
            });
            graph.add(left, right)
        }
        Binary::Pow if slopes[1].is_none() => {
            let one = graph.constant(1.0);
            let less = graph.sub(b, one);
            let power = graph.pow(a, less);
            let by = graph.mul(b, power);
            graph.mul(by, s)
        }
        _ => graph.constant(f64::NAN),
    })
}
