//! hfConvArc: arcs of circles convolved with the Cauchy kernel.

use super::call::{Call, Outcome};
use super::expression::{Expr, Vector};

/// π as the C library has it.
#[allow(clippy::approx_constant, reason = "the library's values depend on it")]
const PI: f64 = 3.141592;

/// What the C library adds to angles and axes.
const NUDGE: f64 = 1e-6;

/// hfConvArc. An arc starts at (r, 0, 0) of its own frame and runs counter-clockwise in the plane z = 0; a rotation
/// about an axis and a shift to the centre place it. Angles are in degrees. The arrays of the call are not changed.
pub(super) fn arcs<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, widths) = (call.point(0)?, call.array(6));
    let count = widths.len();
    let (centers, axes) = (call.vectors_of(1, count)?, call.vectors_of(4, count)?);
    let (radii, spans) = (call.array_of(2, count)?, call.array_of(3, count)?);
    let turns = call.array_of(5, count)?;
    let terms = (0..count).map(|i| {
        let axis = axes[i].map(|a| a + NUDGE).unit();
        let local = rotated(x - centers[i], axis, -radians(turns[i] + NUDGE));
        whole_arc(local, radii[i], spans[i].min(360.0), widths[i])
    });
    Ok(call.sum(terms) - call.real(7))
}

fn radians(degrees: Expr<'_>) -> Expr<'_> {
    degrees * PI / 180.0
}

/// Rodrigues' rotation about a unit axis.
fn rotated<'g>(p: Vector<'g>, axis: Vector<'g>, angle: Expr<'g>) -> Vector<'g> {
    let (cos, sin) = (angle.cos(), angle.sin());
    p * cos + axis.cross(p) * sin + axis * (axis.dot(p) * (1.0 - cos))
}

/// An arc of up to a full turn: what exceeds half a turn is an arc of its own.
fn whole_arc<'g>(p: Vector<'g>, r: Expr<'g>, degrees: Expr<'g>, s: Expr<'g>) -> Expr<'g> {
    let half_turn = degrees.number(-PI);
    let vertical = Vector([0.0, 0.0, 1.0].map(|k| degrees.number(k)));
    let rest = arc(rotated(p, vertical, half_turn), r, degrees - 180.0, s);
    arc(p, r, degrees.min(180.0), s) + degrees.le(180.0).select(0.0, rest)
}

/// The convolution of an arc of up to half a turn, integrated over its angle, not its length: the C library leaves
/// out the factor r.
///
/// The quotients of the published form have the common factor X, which makes it singular on the plane X = 0; here it
/// is cancelled. Their denominators b − aX and b − a(X cos θ + Y sin θ) are 1 + S²r² for the distances from the
/// arc's ends, and −p₂ = (1 + S²d² − S²r²)² + 4S²r²(1 + S²Z²) is positive, so that the form for p₂ ≥ 0 never applies.
fn arc<'g>(p: Vector<'g>, r: Expr<'g>, degrees: Expr<'g>, s: Expr<'g>) -> Expr<'g> {
    let theta = radians(degrees);
    let (cos, sin, tan) = (theta.cos(), theta.sin(), (theta * 0.5).tan());
    let [x, y, z] = p.0;
    let (s2, zero) = (s.square(), s.number(0.0));
    let near = |cx: Expr<'g>, cy: Expr<'g>| 1.0 + s2 * ((x - cx).square() + (y - cy).square() + z.square());
    let (rim, squared) = (r.square() * s2, s2 * p.squared());
    let (a, b) = (2.0 * r * s2, 1.0 + rim + squared);
    let minus_p2 = (1.0 + squared - rim).square() + 4.0 * rim * (1.0 + s2 * z.square());
    let p1 = minus_p2.sqrt();

    let (start, end) = (near(r, zero), near(r * cos, r * sin));
    let numerator = a * (x.square() + y.square()) * sin - b * (y * (1.0 - cos) + x * sin);
    let ends = -a * numerator / (minus_p2 * start * end);
    let ahead = near(-r, zero);
    let angles = ((a * y - ahead * tan) / p1).atan() - (a * y / p1).atan();
    ends - 2.0 * b * angles / (p1 * minus_p2)
}
