//! Partial derivatives of a program as programs themselves.
//!
//! Derivatives are made node by node (forward mode), so that they can be evaluated over intervals like every other
//! program: 64 boxes at a time. Over a box the result is more than a derivative. It bounds the *slopes* of the field:
//! where it is finite, the field is continuous in the box, and for all p, q in the box f(p) − f(q) = g·(p − q) for some g
//! in it (the mean-value theorem; at kinks in the form of Clarke 1983, because a choice that is open joins both
//! gradients).
//!
//! Steps and conditions jump, and the mean-value theorem fails there. So each gets a *jump* as its derivative: a
//! program that is 0 up to rounding where the operation is decided, and all reals where it is open.

use fieldstone_field::{Binary, Function, Graph, Input, Interval, Node, NodeId, Unary};
use std::collections::HashMap;
use std::sync::Arc;

/// The derivatives of a node along x, y and z; `None` where it does not depend on the axis.
type Slopes = [Option<NodeId>; 3];

/// The derivative of a function along one of its arguments. Over boxes it is bounded by the curvature: the gradient turns
/// by at most as much as the largest second derivative times the way.
struct SlopeOf {
    function: Arc<dyn Function>,
    argument: usize,
}

/// The error that [`Function::curvature`] allows gradients, relative to the largest component.
const GRADIENT_ERROR: f64 = 1e-10;

impl Function for SlopeOf {
    fn name(&self) -> &str {
        "slope"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        let mut gradient = vec![0.0; arguments.len()];
        self.function.gradient(arguments, &mut gradient);
        gradient[self.argument]
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        let curvature = self.function.curvature(arguments);
        if !curvature.is_finite() {
            return Interval::undefined();
        }
        let centre: Vec<f64> = arguments.iter().map(|a| 0.5 * a.lo + 0.5 * a.hi).collect();
        let mut gradient = vec![0.0; arguments.len()];
        self.function.gradient(&centre, &mut gradient);
        let way = arguments.iter().zip(&centre).map(|(a, c)| (a.hi - c).max(c - a.lo).powi(2)).sum::<f64>();
        let steepest = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        let reach = (curvature * way.sqrt() + GRADIENT_ERROR * steepest) * (1.0 + 1e-12);
        let slope = gradient[self.argument];
        let (lo, hi) = (slope - reach, slope + reach);
        if lo.is_finite() && hi.is_finite() { Interval { lo, hi } } else { Interval::undefined() }
    }

    fn is_black_box(&self) -> bool {
        false
    }
}

/// Makes derivatives of nodes of one graph; what nodes share is made once.
#[derive(Debug, Default)]
pub(crate) struct Gradients {
    known: HashMap<NodeId, Slopes>,
}

impl Gradients {
    /// The partial derivatives of `node` along the first three coordinates.
    pub(crate) fn of(&mut self, graph: &mut Graph, node: NodeId) -> [NodeId; 3] {
        let mut stack = vec![node];
        while let Some(&n) = stack.last() {
            if self.known.contains_key(&n) {
                stack.pop();
                continue;
            }
            let operands = graph.node(n).operands();
            let before = stack.len();
            stack.extend(operands.into_iter().filter(|o| !self.known.contains_key(o)));
            if stack.len() == before {
                stack.pop();
                let slopes = self.derive(graph, n);
                self.known.insert(n, slopes);
            }
        }
        let zero = graph.constant(0.0);
        self.slopes(node).map(|slope| slope.unwrap_or(zero))
    }

    fn slopes(&self, node: NodeId) -> Slopes {
        self.known.get(&node).copied().unwrap_or_default()
    }

    /// The derivatives of a node whose operands have theirs.
    fn derive(&self, graph: &mut Graph, n: NodeId) -> Slopes {
        match graph.node(n).clone() {
            Node::Constant(_) => [None; 3],
            Node::Input(input) => {
                let one = graph.constant(1.0);
                [0, 1, 2].map(|axis| (input == Input::Coordinate(axis)).then_some(one))
            }
            Node::Unary(op, a) => self.unary(graph, n, op, a),
            Node::Powi(a, k) => {
                let (power, factor) = (graph.powi(a, k - 1), graph.constant(f64::from(k)));
                let by = graph.mul(factor, power);
                scaled(graph, by, self.slopes(a))
            }
            Node::Binary(op, a, b) => self.binary(graph, n, op, (a, b)),
            Node::Select(c, a, b) => {
                let decided = graph.not(c);
                let jump = jump_of(graph, decided);
                let branches = chosen(graph, c, self.slopes(a), self.slopes(b));
                let jumps = self.slopes(c).map(|slope| slope.map(|_| jump));
                plus(graph, branches, jumps)
            }
            Node::Call(function, arguments) => {
                let function = graph.function(function).clone();
                self.called(graph, &function, &arguments)
            }
            // Nothing is known of the slopes of what loops carry.
            Node::LoopVar(..) | Node::LoopOut(..) => [Some(graph.constant(f64::NAN)); 3],
        }
    }

    fn unary(&self, graph: &mut Graph, n: NodeId, op: Unary, a: NodeId) -> Slopes {
        let slopes = self.slopes(a);
        if slopes == [None; 3] {
            return slopes;
        }
        let by = match op {
            Unary::Neg => return slopes.map(|slope| slope.map(|s| graph.neg(s))),
            Unary::Abs => graph.sign(a),
            Unary::Sqrt => {
                let twice = graph.add(n, n);
                graph.recip(twice)
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
            Unary::Tan => one_plus(graph, n),
            Unary::Asin => arc(graph, a),
            Unary::Acos => {
                let slope = arc(graph, a);
                graph.neg(slope)
            }
            Unary::Atan => {
                let below = one_plus(graph, a);
                graph.recip(below)
            }
            Unary::Sinh => graph.cosh(a),
            Unary::Cosh => graph.sinh(a),
            Unary::Tanh => one_minus(graph, n),
            Unary::Atanh => {
                let below = one_minus(graph, a);
                graph.recip(below)
            }
            Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Sign | Unary::Not => {
                let jump = jump_of(graph, n);
                return slopes.map(|slope| slope.map(|_| jump));
            }
        };
        scaled(graph, by, slopes)
    }

    fn binary(&self, graph: &mut Graph, n: NodeId, op: Binary, (a, b): (NodeId, NodeId)) -> Slopes {
        let (by_a, by_b) = (self.slopes(a), self.slopes(b));
        match op {
            Binary::Add => plus(graph, by_a, by_b),
            Binary::Sub => {
                let negative = by_b.map(|slope| slope.map(|s| graph.neg(s)));
                plus(graph, by_a, negative)
            }
            Binary::Mul => {
                let (left, right) = (scaled(graph, b, by_a), scaled(graph, a, by_b));
                plus(graph, left, right)
            }
            Binary::Div => {
                let inverse = graph.recip(b);
                let falling = graph.mul(n, inverse);
                let falling = graph.neg(falling);
                let (left, right) = (scaled(graph, inverse, by_a), scaled(graph, falling, by_b));
                plus(graph, left, right)
            }
            Binary::Min | Binary::Max => {
                let less = graph.lt(a, b);
                let (first, second) = if op == Binary::Min { (by_a, by_b) } else { (by_b, by_a) };
                chosen(graph, less, first, second)
            }
            Binary::RMin | Binary::RMax => self.r_function(graph, op, (a, b)),
            Binary::Pow => self.power(graph, n, (a, b)),
            Binary::Atan2 => self.angle(graph, (a, b)),
            Binary::Rem | Binary::Modulo => self.remainder(graph, op, (a, b)),
            Binary::Compare | Binary::Lt | Binary::Le | Binary::Eq => {
                let jump = jump_of(graph, n);
                [0, 1, 2].map(|axis| by_a[axis].or(by_b[axis]).map(|_| jump))
            }
        }
    }

    /// The slopes of a function that is known as a whole, by those of its arguments.
    fn called(&self, graph: &mut Graph, function: &Arc<dyn Function>, arguments: &[NodeId]) -> Slopes {
        let mut sum = [None; 3];
        for (argument, &node) in arguments.iter().enumerate() {
            let slopes = self.slopes(node);
            if slopes == [None; 3] {
                continue;
            }
            let slope: Arc<dyn Function> = Arc::new(SlopeOf { function: function.clone(), argument });
            let by = graph.call(&slope, arguments);
            let term = scaled(graph, by, slopes);
            sum = plus(graph, sum, term);
        }
        sum
    }

    /// 1 ∓ a/√(a² + b²) along a, and the same along b.
    fn r_function(&self, graph: &mut Graph, op: Binary, (a, b): (NodeId, NodeId)) -> Slopes {
        let squares = [a, b].map(|n| graph.square(n));
        let sum = graph.add(squares[0], squares[1]);
        let length = graph.sqrt(sum);
        let one = graph.constant(1.0);
        let terms = [a, b].map(|n| {
            let share = graph.div(n, length);
            let by = if op == Binary::RMin { graph.sub(one, share) } else { graph.add(one, share) };
            scaled(graph, by, self.slopes(n))
        });
        plus(graph, terms[0], terms[1])
    }

    fn power(&self, graph: &mut Graph, n: NodeId, (a, b): (NodeId, NodeId)) -> Slopes {
        let one = graph.constant(1.0);
        let less = graph.sub(b, one);
        let rest = graph.pow(a, less);
        let by_base = graph.mul(b, rest);
        let base = scaled(graph, by_base, self.slopes(a));
        if self.slopes(b) == [None; 3] {
            return base;
        }
        let log = graph.ln(a);
        let by_exponent = graph.mul(n, log);
        let exponent = scaled(graph, by_exponent, self.slopes(b));
        plus(graph, base, exponent)
    }

    /// The angle of (x, y), with its jump where y changes sign at negative x.
    fn angle(&self, graph: &mut Graph, (y, x): (NodeId, NodeId)) -> Slopes {
        let squares = [x, y].map(|n| graph.square(n));
        let sum = graph.add(squares[0], squares[1]);
        let scale = graph.recip(sum);
        let (by_y, by_x) = (graph.mul(x, scale), graph.mul(y, scale));
        let by_x = graph.neg(by_x);
        let (left, right) = (scaled(graph, by_y, self.slopes(y)), scaled(graph, by_x, self.slopes(x)));
        let smooth = plus(graph, left, right);
        let zero = graph.constant(0.0);
        let (below, behind) = (graph.lt(y, zero), graph.lt(x, zero));
        let jump = jump_of(graph, below);
        let jump = graph.select(behind, jump, zero);
        let jumps = self.slopes(y).map(|slope| slope.map(|_| jump));
        plus(graph, smooth, jumps)
    }

    /// a − divisor·turns, where `turns` is a step.
    fn remainder(&self, graph: &mut Graph, op: Binary, (a, b): (NodeId, NodeId)) -> Slopes {
        let (turns, by_divisor) = if op == Binary::Rem {
            let quotient = graph.div(a, b);
            let turns = graph.trunc(quotient);
            (turns, turns)
        } else {
            let (size, sign) = (graph.abs(b), graph.sign(b));
            let quotient = graph.div(a, size);
            let turns = graph.floor(quotient);
            (turns, graph.mul(turns, sign))
        };
        let falling = graph.neg(by_divisor);
        let divisor = scaled(graph, falling, self.slopes(b));
        let smooth = plus(graph, self.slopes(a), divisor);
        let jump = jump_of(graph, turns);
        let (by_a, by_b) = (self.slopes(a), self.slopes(b));
        let jumps = [0, 1, 2].map(|axis| by_a[axis].or(by_b[axis]).map(|_| jump));
        plus(graph, smooth, jumps)
    }
}

/// 0 up to rounding where `step`, a node with finitely many values, is decided; all reals where it may jump.
fn jump_of(graph: &mut Graph, step: NodeId) -> NodeId {
    // Over intervals `step = step` is certain only if the interval is one number.
    let (half, two) = (graph.constant(0.5), graph.constant(2.0));
    let same = graph.eq(step, step);
    let above_half = graph.sub(same, half);
    let inverse = graph.recip(above_half);
    graph.sub(inverse, two)
}

/// 1 + a².
fn one_plus(graph: &mut Graph, a: NodeId) -> NodeId {
    let (one, square) = (graph.constant(1.0), graph.square(a));
    graph.add(one, square)
}

/// 1 − a².
fn one_minus(graph: &mut Graph, a: NodeId) -> NodeId {
    let (one, square) = (graph.constant(1.0), graph.square(a));
    graph.sub(one, square)
}

/// 1/√(1 − a²).
fn arc(graph: &mut Graph, a: NodeId) -> NodeId {
    let below = one_minus(graph, a);
    let root = graph.sqrt(below);
    graph.recip(root)
}

fn scaled(graph: &mut Graph, by: NodeId, slopes: Slopes) -> Slopes {
    slopes.map(|slope| slope.map(|s| graph.mul(by, s)))
}

fn plus(graph: &mut Graph, a: Slopes, b: Slopes) -> Slopes {
    [0, 1, 2].map(|axis| match (a[axis], b[axis]) {
        (Some(p), Some(q)) => Some(graph.add(p, q)),
        (one, other) => one.or(other),
    })
}

fn chosen(graph: &mut Graph, condition: NodeId, a: Slopes, b: Slopes) -> Slopes {
    let zero = graph.constant(0.0);
    [0, 1, 2].map(|axis| {
        let any = a[axis].or(b[axis]);
        any.map(|_| graph.select(condition, a[axis].unwrap_or(zero), b[axis].unwrap_or(zero)))
    })
}

#[cfg(test)]
mod tests {
    use crate::measure::pieces::Pieces;
    use fieldstone_field::{Bindings, F64, Interval, Intervals, Workspace};
    use fieldstone_lang::{Source, parse_formula};

    type Range = Interval<f64>;

    /// The value over a box and the slopes over it, of a formula that is one piece.
    fn slopes(text: &str, cell: &[Range; 3]) -> [Range; 3] {
        let field = parse_formula(&Source::new("formula", text)).unwrap().field;
        let pieces = Pieces::new(&field, &Bindings::new());
        // Besides the condition that its operands lie in their domains.
        assert_eq!(pieces.count, 1 + usize::from(pieces.domain.is_some()), "{text}");
        let piece = usize::from(pieces.domain == Some(0));
        let mut workspace: Workspace<F64, Intervals> = Workspace::new();
        for (axis, side) in cell.iter().enumerate() {
            workspace.input(axis, 0)[0] = side.lo;
            workspace.input(axis, 1)[0] = side.hi;
        }
        workspace.run(&pieces.gradients, 1);
        let output = |axis: usize, end: usize| workspace.output(3 * piece + axis, end)[0];
        [0, 1, 2].map(|axis| Range::new(output(axis, 0), output(axis, 1)))
    }

    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }

    /// f(p) − f(q) lies in G·(p − q), for one formula per operation, boxes of all sizes, and pairs of points.
    #[test]
    fn slopes_hold_all_differences() {
        let formulas = [
            "x*y - z/(2 + x)",
            "sqrt(x + 2)*z",
            "abs(x) - abs(y*z)",
            "exp(x)*log(y + 3)",
            "sin(3*x)*cos(2*y)",
            "tan(x/2) + y",
            "asin(x/2) + acos(y/2)",
            "atan(5*x) + z",
            "sinh(x) - cosh(y)",
            "tanh(4*x)",
            "(x + 2)^(y + z)",
            "x^3 + y^4 + z^(0-2)",
            "(x + 2)^1.5",
            "x + min(x, y)*z",
            "1 + max(x*y, z)",
            "2*runion(x, y) + z",
            "z - 2*rinter(x, y*z)",
            "floor(2*x) + y",
            "x*round(y)",
            "mod(x, 0.7) + z",
            "atan2(y, x) + z",
            "atan2(x*z, y)",
            "if(x < 0.2, y, z + 1)",
            "1/x + y",
            "ceil(x)*floor(y + z)",
        ];
        let (mut state, mut finite, mut broken) = (11, 0, 0);
        for text in formulas {
            let field = parse_formula(&Source::new("formula", text)).unwrap().field;
            let value = |p: &[f64; 3]| field.at(p, &Bindings::new())[0];
            for k in 0..60 {
                let side = 2f64.powi(-(k % 12));
                let cell =
                    [0, 1, 2].map(|_| 2.0 * random(&mut state) - 1.0).map(|x| Range::new(x, x + side * 0.5));
                let found = slopes(text, &cell);
                if found.iter().any(|s| !(s.hi - s.lo).is_finite()) {
                    continue;
                }
                finite += 1;
                for _ in 0..20 {
                    let mut point = || cell.map(|side| side.lo + side.width() * random(&mut state));
                    let (p, q) = (point(), point());
                    let difference = value(&p) - value(&q);
                    let image =
                        (0..3).fold(Range::point(0.0), |sum, i| sum + found[i] * Range::point(p[i] - q[i]));
                    let slack = 1e-12 * (1.0 + value(&p).abs());
                    let is_held = image.lo - slack <= difference && difference <= image.hi + slack;
                    assert!(is_held, "{text}: {difference} is not in {image:?} over {cell:?}");
                    // What no comparer may accept: half of the way outside.
                    broken += usize::from(image.hi + slack < difference + 1.5 * image.width() + 1e-9);
                }
            }
        }
        assert!(finite > 700 && broken > 0, "{finite} {broken}");
    }

    #[test]
    fn slopes_are_close_to_the_derivative() {
        let cell = [0.5, 0.25, 0.75].map(|x: f64| Range::new(x, x + 1e-6));
        let cases: [(&str, [f64; 3]); 4] = [
            ("x^2*y + sin(z)", [0.25, 0.25, 0.75f64.cos()]),
            ("sqrt(x^2 + y^2) - z", [0.5 / 0.3125f64.sqrt(), 0.25 / 0.3125f64.sqrt(), -1.0]),
            ("floor(x + 0.2) + 3*y", [0.0, 3.0, 0.0]),
            ("x - 2*z", [1.0, 0.0, -2.0]),
        ];
        for (text, expected) in cases {
            let found = slopes(text, &cell);
            for (slope, expected) in found.iter().zip(expected) {
                assert!(slope.lo <= expected + 2e-6 && expected - 2e-6 <= slope.hi, "{text}: {found:?}");
                assert!(slope.width() < 1e-5, "{text}: {found:?}");
            }
        }
    }

    #[test]
    fn jumps_have_no_finite_slope() {
        let cell = [-0.1, -0.2, 0.1].map(|x: f64| Range::new(x, x + 0.3));
        let jumping =
            ["floor(x)", "if(x, y, z)", "round(x*5)", "mod(x, 0.5)", "atan2(y, x - 1)", "sign(y)*z", "1/x"];
        for text in jumping {
            let found = slopes(text, &cell);
            assert!(found.iter().any(|s| !(s.hi - s.lo).is_finite()), "{text}: {found:?}");
        }
        assert!(slopes("atan2(y, x + 1)", &cell).iter().all(|s| (s.hi - s.lo).is_finite()));
    }
}
