//! The library functions `hf…`.

use crate::Dialect;
use fieldstone_field::{Graph, NodeId};

/// What a parameter takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    /// A number.
    Real,
    /// A whole array, which the function may change.
    Array,
}

/// What is passed for a parameter.
#[derive(Clone, Debug)]
pub(crate) enum Argument {
    /// A number.
    Real(NodeId),
    /// The elements of an array.
    Array(Vec<NodeId>),
}

/// What a function is written into.
pub(crate) struct Context<'g> {
    /// The program that grows.
    pub(crate) graph: &'g mut Graph,
    /// Whose values are wanted.
    #[allow(dead_code)]
    pub(crate) dialect: Dialect,
}

/// Writes a call into the program. Arrays may be changed in place; an `Err` says what is wrong with the call.
pub(crate) type Body = fn(&mut Context<'_>, &mut [Argument]) -> Result<NodeId, String>;

/// A function of the library.
pub(crate) struct Function {
    /// In lower case.
    pub(crate) name: &'static str,
    /// Names and kinds.
    pub(crate) parameters: &'static [(&'static str, Kind)],
    /// Its meaning.
    pub(crate) body: Body,
}

const FUNCTIONS: &[Function] = &[
    Function {
        name: "hfsphere",
        parameters: &[("x", Kind::Array), ("center", Kind::Array), ("R", Kind::Real)],
        body: sphere,
    },
    Function {
        name: "hfshift3d",
        parameters: &[("xt", Kind::Array), ("dx", Kind::Real), ("dy", Kind::Real), ("dz", Kind::Real)],
        body: shift,
    },
];

/// The function of a name.
pub(crate) fn lookup(lower_case_name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|f| f.name == lower_case_name)
}

/// All names, in lower case.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|f| f.name)
}

fn sphere(context: &mut Context<'_>, arguments: &mut [Argument]) -> Result<NodeId, String> {
    let [Argument::Array(x), Argument::Array(center), Argument::Real(radius)] = arguments else {
        return Err("takes x[], center[] and R".to_owned());
    };
    if x.len() != center.len() {
        return Err(format!("x[] has {} elements, center[] {}", x.len(), center.len()));
    }
    let g = &mut *context.graph;
    let mut value = g.square(*radius);
    for (&x, &c) in x.iter().zip(center.iter()) {
        let p = g.sub(x, c);
        let square = g.square(p);
        value = g.sub(value, square);
    }
    Ok(value)
}

fn shift(context: &mut Context<'_>, arguments: &mut [Argument]) -> Result<NodeId, String> {
    let [Argument::Array(x), offsets @ ..] = arguments else {
        return Err("takes xt[], dx, dy and dz".to_owned());
    };
    if x.len() != 3 {
        return Err(format!("xt[] has {} elements, not 3", x.len()));
    }
    for (x, offset) in x.iter_mut().zip(offsets) {
        if let Argument::Real(d) = offset {
            *x = context.graph.sub(*x, *d);
        }
    }
    Ok(context.graph.constant(1.0))
}
