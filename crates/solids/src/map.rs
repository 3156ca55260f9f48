//! Mappings of space: where in its own space a solid is asked for the value at a point.
//!
//! A function of this module takes the coordinates of a point of the *mapped* solid and gives those of the point of the
//! original that lands there: it is the inverse of the mapping. [`moved`] puts a program there. A chain of mappings is
//! applied from the last one to the first. Angles are in radians; axes are counted from 0.

use crate::expression::{Expr, Vector, write};
use fieldstone_field::{Graph, Input, NodeId};

/// A point, by the nodes of its coordinates.
type Point = [NodeId; 3];

/// Copies the outputs of a program with the point `at` in the place of x, y and z; all other inputs stay.
pub fn moved(graph: &mut Graph, program: &Graph, outputs: &[NodeId], at: Point) -> Vec<NodeId> {
    graph.import(program, outputs, |graph, input| match input {
        Input::Coordinate(k) if k < 3 => at[usize::from(k)],
        other => graph.input(other),
    })
}

fn mapped(graph: &mut Graph, at: Point, map: impl FnOnce(Vector<'_>) -> Vector<'_>) -> Point {
    write(graph, |cell| map(Vector(at.map(|id| Expr::new(cell, id)))).0.map(Expr::id))
}

/// An expression of the same graph as the point's.
fn beside<'g>(point: Vector<'g>, id: NodeId) -> Expr<'g> {
    point.0[0].sibling(id)
}

/// Moved by a vector.
pub fn translate(graph: &mut Graph, at: Point, by: Point) -> Point {
    mapped(graph, at, |p| p - Vector(by.map(|id| beside(p, id))))
}

/// Scaled about the origin along each axis. Values stay what they were: a distance is none any more.
pub fn scale(graph: &mut Graph, at: Point, factors: Point) -> Point {
    mapped(graph, at, |p| p.zip(Vector(factors.map(|id| beside(p, id))), |x, s| x / s))
}

/// Turned about a coordinate axis through the origin, counter-clockwise where the axis points to the eye.
pub fn rotate(graph: &mut Graph, at: Point, axis: usize, angle: NodeId) -> Point {
    mapped(graph, at, |p| turned_back(p, axis, beside(p, angle)))
}

fn turned_back<'g>(p: Vector<'g>, axis: usize, angle: Expr<'g>) -> Vector<'g> {
    let (along, [u, v]) = p.along_and_across(axis % 3);
    let (sin, cos) = (angle.sin(), angle.cos());
    from_frame(axis, along, [u * cos + v * sin, v * cos - u * sin])
}

/// The point with these components along an axis and across it.
fn from_frame<'g>(axis: usize, along: Expr<'g>, across: [Expr<'g>; 2]) -> Vector<'g> {
    let mut point = [along; 3];
    point[(axis + 1) % 3] = across[0];
    point[(axis + 2) % 3] = across[1];
    Vector(point)
}

/// Any affine mapping, by the rows of its inverse: `original = inverse[..3] · at + inverse[3]`, column by column.
pub fn affine(graph: &mut Graph, at: Point, inverse_columns: [[f64; 3]; 4]) -> Point {
    mapped(graph, at, |p| {
        Vector([0, 1, 2].map(|row| {
            let [a, b, c, d] = inverse_columns.map(|column| column[row]);
            let x = p.0[0];
            let terms = [a, b, c].into_iter().zip(p.0).filter(|(k, _)| *k != 0.0).map(|(k, x)| k * x);
            let sum = terms.reduce(|sum, term| sum + term).unwrap_or_else(|| x.number(0.0));
            sum + d
        }))
    })
}

/// Twisted about a coordinate axis: turned by `rate` radians for each unit of length along it.
pub fn twist(graph: &mut Graph, at: Point, axis: usize, rate: NodeId) -> Point {
    mapped(graph, at, |p| {
        let rate = beside(p, rate);
        turned_back(p, axis, rate * p.0[axis % 3])
    })
}

/// Tapered along a coordinate axis: scaled across it by a factor that goes from `factors[0]` at `from` to `factors[1]` at
/// `to` and stays what it is beyond; factors above 0.
pub fn taper(
    graph: &mut Graph,
    at: Point,
    axis: usize,
    [from, to]: [NodeId; 2],
    factors: [NodeId; 2],
) -> Point {
    mapped(graph, at, |p| {
        let [from, to, first, last] = [from, to, factors[0], factors[1]].map(|id| beside(p, id));
        let (along, across) = p.along_and_across(axis % 3);
        let place = ((along - from) / (to - from)).clamp(0.0, 1.0);
        let factor = first + (last - first) * place;
        from_frame(axis, along, across.map(|u| u / factor))
    })
}

/// Bent about the y axis: what lay along x lies on a circle of radius 1/`curvature` that touches the x axis at the origin
/// with its centre on the z axis; `curvature` is not 0. What is farther along x than half a turn is cut off.
pub fn bend(graph: &mut Graph, at: Point, curvature: NodeId) -> Point {
    mapped(graph, at, |p| {
        let curvature = beside(p, curvature);
        let [x, y, z] = p.0;
        let radius = 1.0 / curvature;
        // Seen from the centre of the circle, with the angle 0 towards the origin.
        let up = radius - z;
        let sign = (curvature.lt(0.0)).select(-1.0, 1.0);
        let angle = (sign * x).atan2(sign * up);
        Vector([angle * radius, y, radius - sign * (x.square() + up.square()).sqrt()])
    })
}

/// The side of 0 with positive coordinates along an axis, and its image in the mirror.
pub fn mirror(graph: &mut Graph, at: Point, axis: usize) -> Point {
    mapped(graph, at, |p| {
        let (along, across) = p.along_and_across(axis % 3);
        from_frame(axis, along.abs(), across)
    })
}

/// The image in the mirror through the origin with this unit normal, instead of the original.
pub fn mirror_across(graph: &mut Graph, at: Point, normal: [f64; 3]) -> Point {
    mapped(graph, at, |p| {
        let normal = Vector(normal.map(|k| p.0[0].number(k)));
        let height = 2.0 * p.dot(normal);
        p - normal * height
    })
}

/// Repeated without end along an axis: what lies within half a `period` > 0 of the origin, everywhere.
pub fn repeat(graph: &mut Graph, at: Point, axis: usize, period: NodeId) -> Point {
    mapped(graph, at, |p| {
        let period = beside(p, period);
        let (along, across) = p.along_and_across(axis % 3);
        let half = 0.5 * period;
        from_frame(axis, (along + half).modulo(period) - half, across)
    })
}

/// Repeated along an axis, `count` times to each side of the original (a whole number), `period` > 0 apart.
pub fn repeat_times(graph: &mut Graph, at: Point, axis: usize, period: NodeId, count: NodeId) -> Point {
    mapped(graph, at, |p| {
        let (period, count) = (beside(p, period), beside(p, count));
        let (along, across) = p.along_and_across(axis % 3);
        let nearest = (along / period + 0.5).floor().clamp(-count, count);
        from_frame(axis, along - period * nearest, across)
    })
}

/// Repeated along an axis in its direction: `count` in all (a whole number from 1 on), `period` > 0 apart, of which the
/// original is the first.
pub fn repeat_onward(graph: &mut Graph, at: Point, axis: usize, period: NodeId, count: NodeId) -> Point {
    mapped(graph, at, |p| {
        let (period, count) = (beside(p, period), beside(p, count));
        let (along, across) = p.along_and_across(axis % 3);
        let nearest = (along / period + 0.5).floor().clamp(0.0, count - 1.0);
        from_frame(axis, along - period * nearest, across)
    })
}

/// Repeated `count` times around an axis: what lies in the sector about the first axis across it, turned.
pub fn polar_repeat(graph: &mut Graph, at: Point, axis: usize, count: NodeId) -> Point {
    mapped(graph, at, |p| {
        let (along, [u, v]) = p.along_and_across(axis % 3);
        let nearest = nearest_sector([u, v.abs()], beside(p, count));
        let folded = from_frame(axis, along, [u, v.abs()]);
        let (_, [u, w]) = turned_back(folded, axis, nearest).along_and_across(axis % 3);
        from_frame(axis, along, [u, v.lt(0.0).select(-w, w)])
    })
}

/// The angle of the middle of the sector in which a point with v ≥ 0 is. Bounds of the angle from the v axis are close
/// everywhere: they have no cut there.
pub(crate) fn nearest_sector<'g>([u, v]: [Expr<'g>; 2], count: Expr<'g>) -> Expr<'g> {
    let sector = std::f64::consts::TAU / count;
    let angle = std::f64::consts::FRAC_PI_2 - u.atan2(v);
    (angle / sector + 0.5).floor() * sector
}

/// Turned inside out at a sphere about the origin: r² p / |p|². Undefined at the origin.
pub fn invert(graph: &mut Graph, at: Point, radius: NodeId) -> Point {
    mapped(graph, at, |p| {
        let factor = beside(p, radius).square() / p.squared();
        p * factor
    })
}
