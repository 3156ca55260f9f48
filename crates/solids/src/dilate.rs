//! Solids grown by a ball, whatever their function is.

use crate::expression::{Expr, Vector, write};
use crate::least::{Course, least};
use crate::map::moved;
use crate::minimum::MinimumError;
use fieldstone_field::{Graph, Input, NodeId};

/// Stand for the three parameters of a place in a ball.
const PARAMETERS: [Input; 3] =
    [Input::Coordinate(u16::MAX), Input::Coordinate(u16::MAX - 1), Input::Coordinate(u16::MAX - 2)];

/// Dilates a solid by a ball: min over |q| ≤ radius of f(p + q), the union of its copies moved by all vectors that are no
/// longer than the radius (a Minkowski sum). So it grows by the radius everywhere, and its edges are rounded, whatever the
/// values of f are.
///
/// The minima over three parameters are searched within each other, as [`Minimum`](crate::Minimum) does: a million and a half
/// evaluations of f for one value, tens of milliseconds, which is too slow for pictures. This is the general form, for
/// values and bounds at some places. Where f is a distance outside of the solid, [`offset`](crate::offset) gives the same solid
/// at no cost.
///
/// # Errors
/// A radius that is not above 0 and finite; a solid with a black box.
pub fn dilate(
    graph: &mut Graph,
    (program, output): (&Graph, NodeId),
    radius: f64,
) -> Result<NodeId, MinimumError> {
    let mut inner = Graph::new();
    let at = place(&mut inner, radius);
    let value = moved(&mut inner, program, &[output], at)[0];
    let mut middle = Graph::new();
    let value = least(&mut middle, (&inner, value), &course(2, 1.0), Graph::input)?;
    let mut outer = Graph::new();
    let value = least(&mut outer, (&middle, value), &course(1, 1.0), Graph::input)?;
    least(graph, (&outer, value), &course(0, radius), Graph::input)
}

fn course(parameter: usize, end: f64) -> Course {
    Course { over: PARAMETERS[parameter], range: [-end, end], parts: 1, corners: Vec::new() }
}

/// p + (a, b √(r² − a²), c √(r² − a²) √(1 − b²)) with a from −r to r, b and c from −1 to 1.
fn place(graph: &mut Graph, radius: f64) -> [NodeId; 3] {
    let point = [0, 1, 2].map(|k| graph.input(Input::Coordinate(k)));
    let parameters = PARAMETERS.map(|input| graph.input(input));
    write(graph, |cell| {
        let [a, b, c] = parameters.map(|id| Expr::new(cell, id));
        let disc = (radius * radius - a.square()).max(0.0).sqrt();
        let chord = disc * (1.0 - b.square()).max(0.0).sqrt();
        let moved = Vector(point.map(|id| Expr::new(cell, id))) + Vector([a, b * disc, c * chord]);
        moved.0.map(Expr::id)
    })
}
