//! What becomes of normals under the [mappings of space](crate::map).
//!
//! A function takes the point `at` and a normal there of the mapped solid, and gives the normal of the original at the
//! place that the mapping of the same name gives, of any length: J⁻ᵀ n with the derivative J of that place. Patterns
//! that depend on the normal move with their solid so.

use crate::expression::{Expr, Vector, write};
use crate::map::nearest_sector;
use fieldstone_field::{Graph, NodeId};

/// A point or a normal, by the nodes of its coordinates.
type Point = [NodeId; 3];

fn normal(
    graph: &mut Graph,
    (at, normal): (Point, Point),
    map: impl for<'g> FnOnce(Vector<'g>, Vector<'g>) -> [Expr<'g>; 3],
) -> Point {
    write(graph, |cell| {
        let [p, n] = [at, normal].map(|v| Vector(v.map(|id| Expr::new(cell, id))));
        map(p, n).map(Expr::id)
    })
}

fn turned_back<'g>(v: Vector<'g>, sin: Expr<'g>, cos: Expr<'g>) -> [Expr<'g>; 3] {
    let [x, y, z] = v.0;
    [x * cos + y * sin, y * cos - x * sin, z]
}

/// Of [`twist`](crate::twist) about z.
pub fn twist_normal(graph: &mut Graph, at: (Point, Point), rate: NodeId) -> Point {
    normal(graph, at, |p, n| {
        let rate = p.0[0].sibling(rate);
        let (sin, cos) = ((rate * p.0[2]).sin(), (rate * p.0[2]).cos());
        let [[qx, qy, _], [mx, my, _]] = [p, n].map(|v| turned_back(v, sin, cos));
        [mx, my, n.0[2] - rate * (qy * mx - qx * my)]
    })
}

/// Of [`taper`](crate::taper) along z.
pub fn taper_normal(
    graph: &mut Graph,
    at: (Point, Point),
    [from, to]: [NodeId; 2],
    factors: [NodeId; 2],
) -> Point {
    normal(graph, at, |p, n| {
        let [from, to, first, last] = [from, to, factors[0], factors[1]].map(|id| p.0[0].sibling(id));
        let place = (p.0[2] - from) / (to - from);
        let factor = first + (last - first) * place.clamp(0.0, 1.0);
        // Beyond the ends the factor stays what it is.
        let is_between = place.eq(place.clamp(0.0, 1.0));
        let slope = is_between.select((last - first) / (to - from), 0.0);
        let across = p.0[0] * n.0[0] + p.0[1] * n.0[1];
        [factor * n.0[0], factor * n.0[1], n.0[2] + slope / factor * across]
    })
}

/// Of [`bend`](crate::bend).
pub fn bend_normal(graph: &mut Graph, at: (Point, Point), curvature: NodeId) -> Point {
    normal(graph, at, |p, n| {
        let curvature = p.0[0].sibling(curvature);
        let ([x, _, z], [nx, ny, nz]) = (p.0, n.0);
        let up = 1.0 / curvature - z;
        let sign = (curvature.lt(0.0)).select(-1.0, 1.0);
        let distance = (x.square() + up.square()).sqrt();
        [curvature * (nx * up + nz * x), ny, sign * (nz * up - nx * x) / distance]
    })
}

/// Of [`mirror`](crate::mirror) along z.
pub fn mirror_normal(graph: &mut Graph, at: (Point, Point)) -> Point {
    normal(graph, at, |p, n| {
        let is_image = p.0[2].lt(0.0);
        [n.0[0], n.0[1], is_image.select(-n.0[2], n.0[2])]
    })
}

/// Of [`polar_repeat`](crate::polar_repeat) around z.
pub fn polar_repeat_normal(graph: &mut Graph, at: (Point, Point), count: NodeId) -> Point {
    normal(graph, at, |p, n| {
        let [u, v, _] = p.0;
        let angle = nearest_sector([u, v.abs()], u.sibling(count));
        let sign = v.lt(0.0).select(-1.0, 1.0);
        turned_back(n, sign * angle.sin(), angle.cos())
    })
}

/// Of [`invert`](crate::invert); its radius does not matter.
pub fn invert_normal(graph: &mut Graph, at: (Point, Point)) -> Point {
    normal(graph, at, |p, n| (n - p * (2.0 * p.dot(n) / p.squared())).0)
}
