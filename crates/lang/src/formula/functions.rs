//! The functions of formulas: tables of names, arguments and meanings.

mod solids;

use fieldstone_field::{Graph, NodeId};
use std::fmt;

/// A function of formulas.
pub(super) struct Function {
    /// Its names, the usual one first.
    names: &'static [&'static str],
    /// Its arguments as a message writes them: `a, b`, or `a, b, …` for two or more.
    arguments: &'static str,
    /// Its meaning, for as many arguments as [`takes`](Self::takes) accepts.
    pub(super) lower: fn(&mut Graph, &[NodeId]) -> NodeId,
}

const MORE: &str = ", …";

impl Function {
    /// The function of this name.
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        all().find(|function| function.names.contains(&name))
    }

    /// Whether a formula may give this name of a function to a value, which goes before the function where it is not
    /// called: so for blends and patterns.
    pub(super) fn may_be_defined(name: &str) -> bool {
        let mut names = solids::BLENDS.iter().chain(solids::PATTERNS).flat_map(|function| function.names);
        names.any(|known| *known == name)
    }

    /// Whether it can be called with this many arguments.
    pub(super) fn takes(&self, count: usize) -> bool {
        match self.arguments.strip_suffix(MORE) {
            Some(least) => count >= least.split(',').count(),
            None => count == self.arguments.split(',').count(),
        }
    }

    /// How many arguments it takes, in words.
    pub(super) fn argument_count(&self) -> String {
        let (least, arguments) = match self.arguments.strip_suffix(MORE) {
            Some(arguments) => ("at least ", arguments),
            None => ("", self.arguments),
        };
        let count = arguments.split(',').count();
        format!("{least}{count} argument{}", if count == 1 { "" } else { "s" })
    }

    /// A call of it under one of its names, as a message writes it.
    pub(super) fn usage(&self, name: &str) -> String {
        format!("{name}({})", self.arguments)
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.names[0])
    }
}

/// The names of all functions.
pub(super) fn function_names() -> impl Iterator<Item = &'static str> {
    all().flat_map(|function| function.names).copied()
}

fn all() -> impl Iterator<Item = &'static Function> {
    TABLE.iter().chain(solids::BLENDS).chain(solids::PATTERNS)
}

const fn row(
    names: &'static [&'static str],
    arguments: &'static str,
    lower: fn(&mut Graph, &[NodeId]) -> NodeId,
) -> Function {
    Function { names, arguments, lower }
}

static TABLE: [Function; 40] = [
    row(&["sin"], "x", |g, a| g.sin(a[0])),
    row(&["cos"], "x", |g, a| g.cos(a[0])),
    row(&["tan"], "x", |g, a| g.tan(a[0])),
    row(&["asin", "arcsin"], "x", |g, a| g.asin(a[0])),
    row(&["acos", "arccos"], "x", |g, a| g.acos(a[0])),
    row(&["atan", "arctan"], "x", |g, a| g.atan(a[0])),
    row(&["atan2", "arctan2"], "y, x", |g, a| g.atan2(a[0], a[1])),
    row(&["sinh"], "x", |g, a| g.sinh(a[0])),
    row(&["cosh"], "x", |g, a| g.cosh(a[0])),
    row(&["tanh"], "x", |g, a| g.tanh(a[0])),
    row(&["asinh", "arsinh", "arcsinh"], "x", |g, a| asinh(g, a[0])),
    row(&["acosh", "arcosh", "arccosh"], "x", |g, a| acosh(g, a[0])),
    row(&["atanh", "artanh", "arctanh"], "x", |g, a| g.atanh(a[0])),
    row(&["exp"], "x", |g, a| g.exp(a[0])),
    row(&["log", "ln"], "x", |g, a| g.ln(a[0])),
    row(&["log10"], "x", |g, a| logarithm(g, a[0], std::f64::consts::LN_10)),
    row(&["log2"], "x", |g, a| logarithm(g, a[0], std::f64::consts::LN_2)),
    row(&["sqrt"], "x", |g, a| g.sqrt(a[0])),
    row(&["cbrt"], "x", |g, a| cbrt(g, a[0])),
    row(&["square", "sqr"], "x", |g, a| g.square(a[0])),
    row(&["pow"], "a, b", |g, a| power(g, a[0], a[1])),
    row(&["abs"], "x", |g, a| g.abs(a[0])),
    row(&["sign", "sgn"], "x", |g, a| g.sign(a[0])),
    row(&["floor"], "x", |g, a| g.floor(a[0])),
    row(&["ceil"], "x", |g, a| g.ceil(a[0])),
    row(&["round"], "x", |g, a| g.round(a[0])),
    row(&["trunc"], "x", |g, a| g.trunc(a[0])),
    row(&["frac", "fract"], "x", |g, a| fraction(g, a[0])),
    row(&["mod"], "a, b", |g, a| g.modulo(a[0], a[1])),
    row(&["min"], "a, b, …", |g, a| fold(g, a, Graph::min)),
    row(&["max"], "a, b, …", |g, a| fold(g, a, Graph::max)),
    row(&["runion"], "a, b, …", |g, a| fold(g, a, Graph::rmin)),
    row(&["rinter", "rintersect"], "a, b, …", |g, a| fold(g, a, Graph::rmax)),
    row(&["rsub"], "a, b", |g, a| r_difference(g, a[0], a[1])),
    row(&["length", "hypot"], "a, b, …", length),
    row(&["clamp"], "x, a, b", |g, a| clamp(g, a[0], [a[1], a[2]])),
    row(&["mix"], "a, b, t", |g, a| mix(g, [a[0], a[1]], a[2])),
    row(&["step"], "a, x", |g, a| g.le(a[0], a[1])),
    row(&["smoothstep"], "a, b, x", |g, a| smoothstep(g, [a[0], a[1]], a[2])),
    row(&["if"], "condition, a, b", |g, a| g.select(a[0], a[1], a[2])),
];

/// `op` over all arguments, from left to right.
fn fold(g: &mut Graph, a: &[NodeId], op: fn(&mut Graph, NodeId, NodeId) -> NodeId) -> NodeId {
    a[1..].iter().fold(a[0], |folded, &b| op(g, folded, b))
}

/// aᵇ. The base e is the exponential function, whose bounds are tighter.
pub(super) fn power(g: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if g.constant_value(a) == Some(std::f64::consts::E) { g.exp(b) } else { g.pow(a, b) }
}

/// ln(|x| + √(x² + 1)) with the sign of x: no cancellation for x < 0.
fn asinh(g: &mut Graph, x: NodeId) -> NodeId {
    let (one, square) = (g.constant(1.0), g.square(x));
    let radicand = g.add(square, one);
    let (magnitude, root) = (g.abs(x), g.sqrt(radicand));
    let sum = g.add(magnitude, root);
    let (sign, value) = (g.sign(x), g.ln(sum));
    g.mul(sign, value)
}

/// ln(x + √((x − 1)(x + 1))); undefined for x < 1.
fn acosh(g: &mut Graph, x: NodeId) -> NodeId {
    let one = g.constant(1.0);
    let (below, above) = (g.sub(x, one), g.add(x, one));
    let radicand = g.mul(below, above);
    let root = g.sqrt(radicand);
    let sum = g.add(x, root);
    g.ln(sum)
}

fn logarithm(g: &mut Graph, x: NodeId, ln_base: f64) -> NodeId {
    let (natural, scale) = (g.ln(x), g.constant(ln_base));
    g.div(natural, scale)
}

fn cbrt(g: &mut Graph, x: NodeId) -> NodeId {
    let (sign, magnitude, third) = (g.sign(x), g.abs(x), g.constant(1.0 / 3.0));
    let root = g.pow(magnitude, third);
    g.mul(sign, root)
}

fn fraction(g: &mut Graph, x: NodeId) -> NodeId {
    let whole = g.floor(x);
    g.sub(x, whole)
}

/// The points of a that are not in b.
fn r_difference(g: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let outside = g.neg(b);
    g.rmax(a, outside)
}

fn length(g: &mut Graph, a: &[NodeId]) -> NodeId {
    let squares: Vec<NodeId> = a.iter().map(|&x| g.square(x)).collect();
    let sum = fold(g, &squares, Graph::add);
    g.sqrt(sum)
}

fn clamp(g: &mut Graph, x: NodeId, [low, high]: [NodeId; 2]) -> NodeId {
    let above = g.max(x, low);
    g.min(above, high)
}

/// a(1 − t) + bt: exact at both ends.
fn mix(g: &mut Graph, [a, b]: [NodeId; 2], t: NodeId) -> NodeId {
    let one = g.constant(1.0);
    let rest = g.sub(one, t);
    let (from_a, from_b) = (g.mul(a, rest), g.mul(b, t));
    g.add(from_a, from_b)
}

/// k²(3 − 2k), k = (x − a)/(b − a) kept in \[0, 1\].
fn smoothstep(g: &mut Graph, [a, b]: [NodeId; 2], x: NodeId) -> NodeId {
    let (zero, one, two, three) = (g.constant(0.0), g.constant(1.0), g.constant(2.0), g.constant(3.0));
    let (past, span) = (g.sub(x, a), g.sub(b, a));
    let ratio = g.div(past, span);
    let k = clamp(g, ratio, [zero, one]);
    let (square, twice) = (g.square(k), g.mul(two, k));
    let slope = g.sub(three, twice);
    g.mul(square, slope)
}
