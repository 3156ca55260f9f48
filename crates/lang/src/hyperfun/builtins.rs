//! The mathematical functions of the language.

use crate::Dialect;
use fieldstone_field::{Graph, NodeId};

/// A mathematical function.
pub(super) struct Builtin {
    pub(super) name: &'static str,
    pub(super) parameters: &'static [&'static str],
    value: fn(&mut Graph, Dialect, &[NodeId]) -> NodeId,
    /// Where the C interpreter computes it: elsewhere it stops.
    domain: Option<fn(&mut Graph, &[NodeId]) -> NodeId>,
}

impl Builtin {
    /// Its value.
    pub(super) fn value(&self, graph: &mut Graph, dialect: Dialect, arguments: &[NodeId]) -> NodeId {
        (self.value)(graph, dialect, arguments)
    }

    /// A condition that holds where the C interpreter computes it; `None`: everywhere.
    pub(super) fn domain(&self, graph: &mut Graph, arguments: &[NodeId]) -> Option<NodeId> {
        self.domain.map(|domain| domain(graph, arguments))
    }
}

/// The function of a name in lower case.
pub(super) fn lookup(name: &str) -> Option<&'static Builtin> {
    BUILTINS.iter().find(|b| b.name == name)
}

pub(super) fn names() -> impl Iterator<Item = &'static str> {
    BUILTINS.iter().map(|b| b.name)
}

macro_rules! one {
    (@domain) => { None };
    (@domain $domain:expr) => { Some($domain) };
    ($name:literal, $method:ident $(, $domain:expr)?) => {
        Builtin {
            name: $name,
            parameters: &["a"],
            value: |g, _, a| g.$method(a[0]),
            domain: one!(@domain $($domain)?),
        }
    };
}

const BUILTINS: &[Builtin] = &[
    one!("sqrt", sqrt, not_negative),
    one!("exp", exp),
    one!("log", ln, positive),
    Builtin { name: "logd", parameters: &["a"], value: |g, _, a| log10(g, a[0]), domain: Some(positive) },
    one!("sin", sin),
    one!("cos", cos),
    one!("tan", tan, away_from_poles),
    one!("asin", asin, within_one),
    one!("acos", acos, within_one),
    one!("atan", atan),
    one!("abs", abs),
    one!("sinh", sinh),
    one!("cosh", cosh),
    one!("tanh", tanh),
    Builtin { name: "sign", parameters: &["a"], value: sign, domain: None },
    one!("ceil", ceil),
    one!("floor", floor),
    one!("int", trunc),
    Builtin { name: "frac", parameters: &["a"], value: fraction, domain: None },
    Builtin { name: "mod", parameters: &["p", "q"], value: remainder, domain: None },
    Builtin { name: "max", parameters: &["a", "b"], value: |g, _, a| g.max(a[0], a[1]), domain: None },
    Builtin { name: "min", parameters: &["a", "b"], value: |g, _, a| g.min(a[0], a[1]), domain: None },
    Builtin { name: "atan2", parameters: &["y", "x"], value: |g, _, a| g.atan2(a[0], a[1]), domain: None },
];

/// The nearest whole number, halves upwards.
pub(super) fn round_half_up(graph: &mut Graph, a: NodeId) -> NodeId {
    let half = graph.constant(0.5);
    let above = graph.add(a, half);
    graph.floor(above)
}

fn log10(graph: &mut Graph, a: NodeId) -> NodeId {
    if let Some(value) = graph.constant_value(a) {
        // Exact at powers of ten, so that `int(logd(1000))` is 3.
        return graph.constant(value.log10());
    }
    let ten = graph.constant(std::f64::consts::LN_10);
    let ln = graph.ln(a);
    graph.div(ln, ten)
}

/// −1, 0 or 1; in the C interpreter always 1.
fn sign(graph: &mut Graph, dialect: Dialect, a: &[NodeId]) -> NodeId {
    match dialect {
        Dialect::Lenient => graph.sign(a[0]),
        Dialect::Strict => graph.constant(1.0),
    }
}

fn fraction(graph: &mut Graph, _: Dialect, a: &[NodeId]) -> NodeId {
    let whole = graph.trunc(a[0]);
    graph.sub(a[0], whole)
}

/// The remainder with the sign of the first argument; the C interpreter rounds both arguments first.
fn remainder(graph: &mut Graph, dialect: Dialect, a: &[NodeId]) -> NodeId {
    match dialect {
        Dialect::Lenient => graph.rem(a[0], a[1]),
        Dialect::Strict => {
            let p = round_half_up(graph, a[0]);
            let q = round_half_up(graph, a[1]);
            graph.rem(p, q)
        }
    }
}

fn not_negative(graph: &mut Graph, a: &[NodeId]) -> NodeId {
    let zero = graph.constant(0.0);
    graph.le(zero, a[0])
}

fn positive(graph: &mut Graph, a: &[NodeId]) -> NodeId {
    let zero = graph.constant(0.0);
    graph.lt(zero, a[0])
}

fn within_one(graph: &mut Graph, a: &[NodeId]) -> NodeId {
    let one = graph.constant(1.0);
    let size = graph.abs(a[0]);
    graph.le(size, one)
}

fn away_from_poles(graph: &mut Graph, a: &[NodeId]) -> NodeId {
    let cosine = graph.cos(a[0]);
    super::strict::is_not_small(graph, cosine)
}
