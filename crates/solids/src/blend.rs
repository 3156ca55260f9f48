//! Set operations with a rounded or filled joint, and how much of either material it is made of.
//!
//! A blend is written for the union; the intersection of f and g is the complement of the union of the complements,
//! −U(−f, −g), and the difference −U(−f, g). Only the blends that add a displacement to an R-function keep its sign in
//! all three, as their papers do: positive amounts add material to intersections and differences too.

use crate::expression::{Expr, write};
use fieldstone_field::{Graph, NodeId};

/// What becomes of two solids.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Joint {
    /// What is in either.
    Union,
    /// What is in both.
    Intersection,
    /// What is in the first and not in the second.
    Difference,
}

/// How two solids meet. Parameters are nodes, so that they may vary with time; f and g are the values of the solids.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Blend {
    /// min(f, g): an edge.
    Sharp,
    /// f + g − √(f² + g²): an edge, smooth everywhere else (Rvachev; Pasko et al. 1995).
    Rvachev,
    /// f·g − c, and −f·g − c where both are negative. Where neither field is negative anywhere, f·g − c as it is.
    Product {
        /// How much is added, from 0 on, in the unit of f·g. The edge for 0.
        c: NodeId,
    },
    /// ½ (f + g − √((f − g)² + 4c)): a hyperbola of f and g. min(f, g) for c = 0.
    Hyperbolic {
        /// The square of how far the joint lies below min(f, g) where f = g; from 0 on.
        c: NodeId,
    },
    /// 1 − max(0, 1 − f/a)ᵖ − max(0, 1 − g/b)ᵖ: a quarter of a super-ellipse fills the joint (Rockwood 1989).
    SuperElliptic {
        /// How far the blend reaches along the first field, above 0.
        a: NodeId,
        /// How far it reaches along the second, above 0.
        b: NodeId,
        /// The exponent, above 1: 2 is an ellipse; the larger, the closer to the edge.
        p: NodeId,
    },
    /// The R-function less a₀ / (1 + (f/a₁)² + (g/a₂)²) (Pasko and Savchenko 1994; `hfBlendUni` of HyperFun).
    Displacement {
        /// How much is added where f = g = 0; negative amounts are removed.
        a0: NodeId,
        /// How far the blend reaches along the first field, above 0.
        a1: NodeId,
        /// How far it reaches along the second, above 0.
        a2: NodeId,
    },
    /// The R-function less a₀ b w₂ / (w₁ + b w₂), with w₁ = f² + g², and w₂ = h² inside of a third solid h and 0
    /// outside of it, where nothing is changed (bounded blending; Pasko et al. 2005).
    Bounded {
        /// How much is added where f = g = 0; negative amounts are removed.
        a0: NodeId,
        /// How far the blend reaches, as a factor of h², above 0.
        b: NodeId,
        /// The solid h to which the blend is bounded.
        bound: NodeId,
    },
    /// min(f, g) − k/4 max(0, 1 − |f − g|/k)²: a parabola where |f − g| < k, min(f, g) elsewhere (Quilez 2013).
    Quadratic {
        /// How far the blend reaches, from 0 on. min(f, g) for 0.
        k: NodeId,
    },
    /// min(f, g) − k/6 max(0, 1 − |f − g|/k)³: the same with a continuous curvature.
    Cubic {
        /// How far the blend reaches, from 0 on. min(f, g) for 0.
        k: NodeId,
    },
}

/// A joint of two solids.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Blended {
    /// The joint solid.
    pub value: NodeId,
    /// The part of the second material, from 0 where the first solid alone makes the surface to 1 where the second does.
    pub share: NodeId,
}

/// Divisions by what may be 0 are divisions by at least this.
const TINY: f64 = 1e-30;

/// Joins two solids.
pub fn join(graph: &mut Graph, joint: Joint, blend: &Blend, first: NodeId, second: NodeId) -> Blended {
    write(graph, |cell| {
        let [f, g] = [first, second].map(|id| Expr::new(cell, id));
        // The operands of the union that this is, or is the complement of.
        let [p, q] = match joint {
            Joint::Union => [f, g],
            Joint::Intersection => [-f, -g],
            Joint::Difference => [-f, g],
        };
        let parameter = |id: NodeId| Expr::new(cell, id);
        let value = match *blend {
            Blend::Displacement { a0, a1, a2 } => {
                let [a0, a1, a2] = [a0, a1, a2].map(parameter);
                rvachev(joint, [p, q]) - a0 / (1.0 + (f / a1).square() + (g / a2).square())
            }
            Blend::Bounded { a0, b, bound } => {
                let [a0, b, bound] = [a0, b, bound].map(parameter);
                rvachev(joint, [p, q]) - bounded_displacement([f, g], a0, b, bound)
            }
            Blend::Rvachev => rvachev(joint, [p, q]),
            _ => {
                let union = union(blend, [p, q], parameter);
                if joint == Joint::Union { union } else { -union }
            }
        };
        Blended { value: value.id(), share: share(blend, [p, q], parameter).id() }
    })
}

/// The R-function of a joint whose union has these operands.
fn rvachev<'g>(joint: Joint, [p, q]: [Expr<'g>; 2]) -> Expr<'g> {
    if joint == Joint::Union { p.rmin(q) } else { (-p).rmax(-q) }
}

/// a₀ / (1 + w₁ / (b w₂)), which is 0 where w₂ is, w₁ = 0 or not.
fn bounded_displacement<'g>([f, g]: [Expr<'g>; 2], a0: Expr<'g>, b: Expr<'g>, bound: Expr<'g>) -> Expr<'g> {
    let near = (f.square() + g.square()).max(TINY.sqrt());
    let inside = bound.min(0.0).square().max(TINY);
    a0 / (1.0 + near / (b * inside))
}

/// The union for the blends whose other joints are its complements.
fn union<'g>(blend: &Blend, [f, g]: [Expr<'g>; 2], parameter: impl Fn(NodeId) -> Expr<'g>) -> Expr<'g> {
    match *blend {
        Blend::Product { c } => {
            let product = f * g;
            f.max(g).lt(0.0).select(-product, product) - parameter(c)
        }
        Blend::Hyperbolic { c } => 0.5 * (f + g - ((f - g).square() + 4.0 * parameter(c)).sqrt()),
        Blend::SuperElliptic { a, b, p } => {
            let p = parameter(p);
            1.0 - closeness(f, parameter(a)).pow(p) - closeness(g, parameter(b)).pow(p)
        }
        Blend::Quadratic { k } => {
            let k = parameter(k);
            f.min(g) - 0.25 * k * nearness([f, g], k).square()
        }
        Blend::Cubic { k } => {
            let k = parameter(k);
            f.min(g) - k / 6.0 * nearness([f, g], k).powi(3)
        }
        Blend::Sharp | Blend::Rvachev | Blend::Displacement { .. } | Blend::Bounded { .. } => f.min(g),
    }
}

/// max(0, 1 − f/a).
fn closeness<'g>(f: Expr<'g>, a: Expr<'g>) -> Expr<'g> {
    (1.0 - f / a).max(0.0)
}

/// max(0, 1 − |f − g|/k), and 0 for k = 0.
fn nearness<'g>([f, g]: [Expr<'g>; 2], k: Expr<'g>) -> Expr<'g> {
    (k - (f - g).abs()).max(0.0) / k.max(TINY)
}

/// The part of the second material in a union.
///
/// Where the blend is smooth in both fields, it is the part that the second has in its slope, ∂U/∂g / (∂U/∂f + ∂U/∂g).
/// The slopes of products and displacements never vanish, so that theirs is f₊² / (f₊² + g₊²) of f₊ = max(f, 0),
/// and g² / (f² + g²) where both are negative: 0 in the first solid and 1 in the second.
fn share<'g>(blend: &Blend, [f, g]: [Expr<'g>; 2], parameter: impl Fn(NodeId) -> Expr<'g>) -> Expr<'g> {
    let by_squares = |f: Expr<'g>, g: Expr<'g>| {
        let outside = [f.max(0.0).square(), g.max(0.0).square()];
        let ratio = outside[0] / (outside[0] + outside[1]).max(TINY);
        let inside = [f.square(), g.square()];
        f.max(g).lt(0.0).select(inside[1] / (inside[0] + inside[1]).max(TINY), ratio)
    };
    match *blend {
        Blend::Sharp | Blend::Rvachev => g.lt(f),
        Blend::Product { .. } | Blend::Bounded { .. } => by_squares(f, g),
        Blend::Displacement { a1, a2, .. } => by_squares(f / parameter(a1), g / parameter(a2)),
        Blend::Hyperbolic { c } => {
            let root = ((f - g).square() + 4.0 * parameter(c)).sqrt();
            0.5 + 0.5 * (f - g) / root.max(TINY)
        }
        Blend::SuperElliptic { a, b, p } => {
            let (a, b, p) = (parameter(a), parameter(b), parameter(p) - 1.0);
            let [first, second] = [closeness(f, a).pow(p) / a, closeness(g, b).pow(p) / b];
            second / (first + second).max(TINY)
        }
        Blend::Quadratic { k } | Blend::Cubic { k } => {
            let k = parameter(k).max(TINY);
            (0.5 + 0.5 * (f - g) / k).clamp(0.0, 1.0)
        }
    }
}

/// (1 − w) f + w g: the metamorphosis of one solid into another, for a weight w from 0 to 1, which is the share.
///
/// The weight may be a function of time (a metamorphosis), of a fourth coordinate, or of space; see
/// [`sigmoid`](crate::sigmoid) and [`gaussian`](crate::gaussian).
pub fn linear(graph: &mut Graph, first: NodeId, second: NodeId, weight: NodeId) -> Blended {
    let value = write(graph, |cell| {
        let [f, g, w] = [first, second, weight].map(|id| Expr::new(cell, id));
        ((1.0 - w) * f + w * g).id()
    });
    Blended { value, share: weight }
}
