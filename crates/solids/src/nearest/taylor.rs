//! Power series of programs of one variable, with intervals for coefficients.
//!
//! The coefficients at a point hold those of the exact series, and the one of order n over a part of the range holds the
//! Lagrange remainder after order n − 1 everywhere in that part (Moore 1966, chapter 11): together they are a Taylor model.

use fieldstone_field::{Binary, Domain, Graph, Interval, Node, NodeId, Unary};

/// How many coefficients there are: those of the polynomial and the remainder.
pub(super) const ORDERS: usize = 10;

type Coefficient = Interval<f64>;
/// The coefficients of 1, v, v², …
pub(super) type Series = [Coefficient; ORDERS];

const ZERO: Coefficient = Interval::new(0.0, 0.0);

/// A program of one input, ready to be expanded.
pub(super) struct Program<'a> {
    graph: &'a Graph,
    outputs: [NodeId; 3],
    /// What the outputs depend on, operands first.
    nodes: Vec<NodeId>,
}

impl<'a> Program<'a> {
    pub(super) fn new(graph: &'a Graph, outputs: [NodeId; 3]) -> Self {
        let mut nodes = graph.reachable(&outputs);
        nodes.sort_unstable();
        Self { graph, outputs, nodes }
    }

    /// How many operations there are.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Where a node stands among them.
    fn place(&self, node: NodeId) -> usize {
        self.nodes.binary_search(&node).unwrap_or(0)
    }

    /// The series of the outputs at all points of a part of the range, in v/`half`; undefined where nothing is known.
    pub(super) fn expand(&self, part: Interval<f64>, half: f64) -> [Series; 3] {
        let mut series: Vec<Series> = Vec::with_capacity(self.nodes.len());
        for &node in &self.nodes {
            let next = self.node(node, (part, half), &series);
            series.push(next);
        }
        self.outputs.map(|output| series[self.place(output)])
    }

    fn node(&self, node: NodeId, (part, half): (Interval<f64>, f64), known: &[Series]) -> Series {
        let of = |node: NodeId| &known[self.place(node)];
        match *self.graph.node(node) {
            Node::Constant(bits) => constant(Interval::new(f64::from_bits(bits), f64::from_bits(bits))),
            Node::Input(_) => {
                let mut series = constant(part);
                series[1] = Interval::new(half, half);
                series
            }
            Node::Unary(op, a) => unary(op, of(a)),
            Node::Powi(a, k) => power(of(a), k),
            Node::Binary(op, a, b) => binary(op, of(a), of(b)),
            Node::Select(condition, a, b) => {
                let side = of(condition)[0];
                if side.lo > 0.0 || side.hi < 0.0 {
                    *of(a)
                } else if side.lo == 0.0 && side.hi == 0.0 {
                    *of(b)
                } else {
                    unknown(joined(of(a)[0], of(b)[0]))
                }
            }
            _ => unknown(Interval::undefined()),
        }
    }
}

fn constant(value: Coefficient) -> Series {
    let mut series = [ZERO; ORDERS];
    series[0] = value;
    series
}

/// A series of which only the values are known.
fn unknown(values: Coefficient) -> Series {
    let mut series = [Interval::undefined(); ORDERS];
    series[0] = values;
    series
}

fn joined(a: Coefficient, b: Coefficient) -> Coefficient {
    if a.lo.is_nan() || b.lo.is_nan() {
        return Interval::undefined();
    }
    Interval::new(a.lo.min(b.lo), a.hi.max(b.hi))
}

fn is_constant(a: &Series) -> bool {
    a[1..].iter().all(|c| *c == ZERO)
}

fn number(k: f64) -> Coefficient {
    Interval::new(k, k)
}

fn each(a: &Series, b: &Series, by: impl Fn(Coefficient, Coefficient) -> Coefficient) -> Series {
    std::array::from_fn(|k| by(a[k], b[k]))
}

fn product(a: &Series, b: &Series) -> Series {
    let mut series: Series = std::array::from_fn(|k| (0..=k).fold(ZERO, |sum, i| sum + a[i] * b[k - i]));
    // Tighter where both are the same.
    if a == b {
        series[0] = a[0].square();
    }
    series
}

fn quotient(a: &Series, b: &Series) -> Series {
    let mut series = [ZERO; ORDERS];
    for k in 0..ORDERS {
        let rest = (1..=k).fold(a[k], |rest, j| rest - b[j] * series[k - j]);
        series[k] = rest / b[0];
    }
    series
}

fn power(a: &Series, k: i32) -> Series {
    let mut rest = k.unsigned_abs();
    let (mut result, mut base) = (constant(number(1.0)), *a);
    while rest > 0 {
        if rest & 1 == 1 {
            result = product(&result, &base);
        }
        rest >>= 1;
        if rest > 0 {
            base = product(&base, &base);
        }
    }
    result[0] = Domain::powi(a[0], k.abs());
    if k < 0 { quotient(&constant(number(1.0)), &result) } else { result }
}

fn root(a: &Series) -> Series {
    let mut series = [ZERO; ORDERS];
    series[0] = Domain::sqrt(a[0]);
    for k in 1..ORDERS {
        let rest = (1..k).fold(a[k], |rest, j| rest - series[j] * series[k - j]);
        series[k] = rest / (series[0] + series[0]);
    }
    series
}

/// The series whose derivative is a′ times another: Σ j·aⱼ·b₍ₖ₋ⱼ₎ / k, where b is known up to order k − 1.
fn integrated(a: &Series, b: &Series, k: usize) -> Coefficient {
    let sum = (1..=k).fold(ZERO, |sum, j| sum + number(j as f64) * a[j] * b[k - j]);
    sum / number(k as f64)
}

fn exponential(a: &Series) -> Series {
    let mut series = constant(a[0].exp());
    for k in 1..ORDERS {
        series[k] = integrated(a, &series, k);
    }
    series
}

/// Sine and cosine; with `sign` 1 those of hyperbolas.
fn waves(a: &Series, [sine, cosine]: [Coefficient; 2], sign: f64) -> [Series; 2] {
    let (mut s, mut c) = (constant(sine), constant(cosine));
    for k in 1..ORDERS {
        s[k] = integrated(a, &c, k);
        c[k] = number(sign) * integrated(a, &s, k);
    }
    [s, c]
}

/// A function by its derivative, which is a series itself: f′(a)·a′.
fn by_derivative(a: &Series, value: Coefficient, derivative: &Series) -> Series {
    let mut series = constant(value);
    for (k, coefficient) in series.iter_mut().enumerate().skip(1) {
        *coefficient = integrated(a, derivative, k);
    }
    series
}

fn hyperbolic_tangent(a: &Series) -> Series {
    let mut series = constant(Domain::tanh(a[0]));
    for k in 1..ORDERS {
        let squared = product(&series, &series);
        let slope = each(&constant(number(1.0)), &squared, |p, q| p - q);
        series[k] = integrated(a, &slope, k);
    }
    series
}

fn unary(op: Unary, a: &Series) -> Series {
    if is_constant(a) {
        return constant(op.apply(a[0]));
    }
    let one = constant(number(1.0));
    match op {
        Unary::Neg => a.map(|c| -c),
        Unary::Abs if a[0].lo >= 0.0 => *a,
        Unary::Abs if a[0].hi <= 0.0 => a.map(|c| -c),
        Unary::Sqrt => root(a),
        Unary::Square => product(a, a),
        Unary::Recip => quotient(&one, a),
        Unary::Exp => exponential(a),
        Unary::Ln => by_derivative(a, a[0].ln(), &quotient(&one, a)),
        Unary::Sin => waves(a, [a[0].sin(), a[0].cos()], -1.0)[0],
        Unary::Cos => waves(a, [a[0].sin(), a[0].cos()], -1.0)[1],
        Unary::Tan => {
            let [sine, cosine] = waves(a, [a[0].sin(), a[0].cos()], -1.0);
            quotient(&sine, &cosine)
        }
        Unary::Sinh => waves(a, [a[0].sinh(), a[0].cosh()], 1.0)[0],
        Unary::Cosh => waves(a, [a[0].sinh(), a[0].cosh()], 1.0)[1],
        Unary::Tanh => hyperbolic_tangent(a),
        Unary::Atan => {
            let square = each(&one, &product(a, a), |p, q| p + q);
            by_derivative(a, a[0].atan(), &quotient(&one, &square))
        }
        _ => unknown(op.apply(a[0])),
    }
}

fn binary(op: Binary, a: &Series, b: &Series) -> Series {
    if is_constant(a) && is_constant(b) {
        return constant(op.apply(a[0], b[0]));
    }
    match op {
        Binary::Add => each(a, b, |p, q| p + q),
        Binary::Sub => each(a, b, |p, q| p - q),
        Binary::Mul => product(a, b),
        Binary::Div => quotient(a, b),
        Binary::Min if a[0].hi <= b[0].lo => *a,
        Binary::Min if b[0].hi <= a[0].lo => *b,
        Binary::Max if a[0].lo >= b[0].hi => *a,
        Binary::Max if b[0].lo >= a[0].hi => *b,
        Binary::Lt | Binary::Le if a[0].hi < b[0].lo => constant(number(1.0)),
        Binary::Lt | Binary::Le if a[0].lo > b[0].hi => constant(number(0.0)),
        // aᵇ = e^(b ln a).
        Binary::Pow if a[0].lo > 0.0 => {
            let logarithm = by_derivative(a, a[0].ln(), &quotient(&constant(number(1.0)), a));
            exponential(&product(b, &logarithm))
        }
        _ => unknown(op.apply(a[0], b[0])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::{Expr, write};
    use fieldstone_field::Input;

    /// What the series says of a function near a place, with the remainder, holds its values.
    #[test]
    fn models_hold_the_values() {
        type Function = for<'g> fn(Expr<'g>) -> Expr<'g>;
        type Exact = fn(f64) -> f64;
        let functions: [(&str, Function, Exact); 8] = [
            ("polynomial", |u| u.powi(5) - 2.0 * u.square() + 0.3, |u| u.powi(5) - 2.0 * u * u + 0.3),
            ("waves", |u| (3.0 * u).sin() * (2.0 * u).cos(), |u| (3.0 * u).sin() * (2.0 * u).cos()),
            ("quotient", |u| u / (u.square() + 1.0), |u| u / (u * u + 1.0)),
            ("root", |u| (u + 2.0).sqrt(), |u| (u + 2.0).sqrt()),
            ("exponential", |u| (0.0 - u.square()).exp(), |u| (-u * u).exp()),
            (
                "tangents",
                |u| u.atan() + u.tanh() + (0.5 * u).tan(),
                |u| u.atan() + u.tanh() + (0.5 * u).tan(),
            ),
            ("power", |u| (u + 2.0).pow(1.5), |u| (u + 2.0).powf(1.5)),
            ("sides", |u| (u + 3.0).abs().min(10.0), |u| (u + 3.0).abs().min(10.0)),
        ];
        for (name, program, function) in functions {
            let mut graph = Graph::new();
            let u = graph.input(Input::Coordinate(0));
            let output = write(&mut graph, |cell| program(Expr::new(cell, u)).id());
            let program = Program::new(&graph, [output; 3]);
            for middle in [-0.7, 0.0, 0.4] {
                let half = 0.1;
                let at = program.expand(Interval::new(middle, middle), half)[0];
                let over = program.expand(Interval::new(middle - half, middle + half), half)[0];
                for i in -10..=10 {
                    let t = f64::from(i) / 10.0;
                    let mut sum = over[ORDERS - 1];
                    for k in (0..ORDERS - 1).rev() {
                        let t = number(t);
                        sum = at[k] + t * sum;
                    }
                    let exact = function(middle + t * half);
                    let wide = Interval::new(sum.lo - 1e-15, sum.hi + 1e-15);
                    assert!(wide.contains(exact), "{name} {middle} {t}: {exact} {sum:?}");
                    assert!(sum.width() < 1e-7, "{name}: {sum:?}");
                }
            }
        }
    }

    #[test]
    fn kinks_have_values_and_no_series() {
        let mut graph = Graph::new();
        let u = graph.input(Input::Coordinate(0));
        let kink = graph.abs(u);
        let program = Program::new(&graph, [kink; 3]);
        let series = program.expand(Interval::new(-0.5, 1.0), 0.75)[0];
        assert_eq!((series[0].lo, series[0].hi), (0.0, 1.0));
        assert!(series[1].lo.is_nan());
    }
}
