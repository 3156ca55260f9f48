//! Mappings of space: they change the point in place, inversely to how the solid moves, and return 1.
//!
//! A zero factor of scaling or stretching leaves coordinates that are infinite or undefined, as in C, and so do twists
//! with k₁ = k₂ and a zero range of hfSpaceMapCubic and hfSpaceMapExp.

use super::call::{Call, Failure, Outcome};
use super::expression::{Expr, Vector};

/// Maps the point in argument 0.
fn map_point<'g>(
    call: &mut Call<'g>,
    map: impl FnOnce(&Call<'g>, Vector<'g>) -> Result<Vector<'g>, Failure>,
) -> Outcome<'g> {
    let point = call.vector(0)?;
    let mapped = map(call, point)?;
    call.write(0, mapped.0);
    Ok(call.number(1.0))
}

/// hfScale3D.
pub(super) fn scale<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    map_point(call, |call, p| Ok(p.zip(Vector(call.reals(1)), |x, s| x / s)))
}

/// hfShift3D.
pub(super) fn shift<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    map_point(call, |call, p| Ok(p - Vector(call.reals(1))))
}

/// hfStretch3D: scaling about a point.
pub(super) fn stretch<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    map_point(call, |call, p| {
        let center = call.vector(1)?;
        Ok(center + (p - center).zip(Vector(call.reals(2)), |x, s| x / s))
    })
}

/// hfRotate3DX, Y, Z: the solid turns by an angle about an axis.
pub(super) fn rotate<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    map_point(call, |call, p| Ok(turned(p, axis, call.real(1))))
}

/// hfTwistX, Y, Z: the angle varies linearly along the axis, from θ₁ at k₁ to θ₂ at k₂ and on.
pub(super) fn twist<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    map_point(call, |call, p| {
        let [k1, k2, angle1, angle2] = call.reals(1);
        let t = (p.0[axis] - k1) / (k2 - k1);
        Ok(turned(p, axis, angle1 + t * (angle2 - angle1)))
    })
}

fn turned<'g>(p: Vector<'g>, axis: usize, angle: Expr<'g>) -> Vector<'g> {
    let (cos, sin) = (angle.cos(), angle.sin());
    let (_, [u, v]) = p.along_and_across(axis);
    let mut turned = p;
    turned.0[(axis + 1) % 3] = u * cos + v * sin;
    turned.0[(axis + 2) % 3] = v * cos - u * sin;
    turned
}

/// hfTaperX, Y, Z: the scale across the axis varies linearly, from s₁ at k₁ to s₂ at k₂, and no further; a scale
/// below 10⁻⁶ counts as 1.
pub(super) fn taper<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    map_point(call, |call, p| {
        let [k1, k2, s1, s2] = call.reals(1);
        let along = p.0[axis];
        let t = ((along - k1) / (k2 - k1)).clamp(0.0, 1.0);
        let step = along.lt(k1).select(s1, s2);
        let scale = k1.lt(k2).select(s1 + t * (s2 - s1), step);
        let scale = scale.abs().lt(1e-6).select(1.0, scale);
        let mut tapered = p.map(|x| x / scale);
        tapered.0[axis] = along;
        Ok(tapered)
    })
}

/// hfSpaceMapCubic: pulls the surroundings of each source point to its target, with a cut-off.
pub(super) fn map_cubic<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    map_by_points(call, |u| {
        let t = u.length().min(1.0);
        (1.0 - t).powi(3) / (1.0 + t)
    })
}

/// hfSpaceMapExp: the same with a Gaussian weight.
pub(super) fn map_exponential<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    map_by_points(call, |u| (-u.squared()).exp())
}

/// Moves the point by each pair of source and target in turn, with a weight of the scaled distance from the target.
fn map_by_points<'g>(call: &mut Call<'g>, weight: impl Fn(Vector<'g>) -> Expr<'g>) -> Outcome<'g> {
    map_point(call, |call, p| {
        let sources = call.vectors(1)?;
        let (targets, ranges) = (call.vectors_of(2, sources.len())?, call.vectors_of(3, sources.len())?);
        Ok((0..sources.len()).fold(p, |p, i| {
            let way = targets[i] - sources[i];
            let range = ranges[i].zip(way, |b, d| b * (1.0 + d.abs()));
            let u = (p - targets[i]).zip(range, |x, b| x / b);
            p - way * weight(u)
        }))
    })
}
