//! Solids with a formula: quadrics, tori, the block and the superellipsoid.

use super::call::{Call, INVALID, Outcome, unless_zero};
use super::expression::{Expr, Vector};

/// hfSphere: R² − p·p.
pub(super) fn sphere<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    Ok(call.real(2).square() - p.squared())
}

/// hfEllipsoid: 1 − (p₁/a)² − (p₂/b)² − (p₃/c)².
pub(super) fn ellipsoid<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let axes: [_; 3] = call.reals(2);
    let [u, v, w] = [0, 1, 2].map(|k| (p.0[k] / axes[k]).square());
    Ok(unless_zero(&axes, 1.0 - u - v - w))
}

/// hfCylinderX, Y, Z: R² less the squares of the two coordinates across the axis.
pub(super) fn cylinder<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let (_, [u, v]) = (call.point(0)? - call.vector(1)?).along_and_across(axis);
    Ok(call.real(2).square() - u.square() - v.square())
}

/// hfEllCylX, Y, Z.
pub(super) fn elliptic_cylinder<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let axes = call.reals(2);
    Ok(unless_zero(&axes, 1.0 - ellipse(p, axis, axes)))
}

/// hfConeX, Y, Z: a double cone of radius R at distance 1 from its apex.
pub(super) fn cone<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let radius = call.real(2);
    Ok(unless_zero(&[radius], p.0[axis].square() - ellipse(p, axis, [radius; 2])))
}

/// hfEllConeX, Y, Z.
pub(super) fn elliptic_cone<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let axes = call.reals(2);
    Ok(unless_zero(&axes, p.0[axis].square() - ellipse(p, axis, axes)))
}

/// (u/a)² + (v/b)² with the two coordinates across the axis in the order of their letters.
fn ellipse<'g>(p: Vector<'g>, axis: usize, [a, b]: [Expr<'g>; 2]) -> Expr<'g> {
    let [u, v] = match axis {
        0 => [p.0[1], p.0[2]],
        1 => [p.0[0], p.0[2]],
        _ => [p.0[0], p.0[1]],
    };
    (u / a).square() + (v / b).square()
}

/// hfTorusX, Y, Z: r₀² − p·p − R² + 2R√q with the squared distance q from the axis.
///
/// Written r₀² − axial² − (√q − R)², which is the same and tighter over intervals.
pub(super) fn torus<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let (along, [u, v]) = (call.point(0)? - call.vector(1)?).along_and_across(axis);
    let [ring, tube] = call.reals(2);
    let radial = (u.square() + v.square()).sqrt();
    Ok(tube.square() - along.square() - (radial - ring).square())
}

/// hfBlock: the R-intersection of three slabs.
pub(super) fn block<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let sizes: [_; 3] = call.reals(2);
    let [bx, by, bz] = [0, 1, 2].map(|k| slab(p.0[k], sizes[k]));
    let value = bx.rmin(by).rmin(bz);
    Ok(sizes.iter().fold(value, |value, d| d.lt(0.0).select(INVALID, value)))
}

/// p(d − p), written with one occurrence of p: (d/2)² − (p − d/2)².
fn slab<'g>(p: Expr<'g>, size: Expr<'g>) -> Expr<'g> {
    let half = size * 0.5;
    half.square() - (p - half).square()
}

/// hfSuperell: 1 − (|p₁/a|^(2/s₂) + |p₂/b|^(2/s₂))^(s₂/s₁) − |p₃/c|^(2/s₁).
pub(super) fn superellipsoid<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let p = call.point(0)? - call.vector(1)?;
    let [a, b, c, s1, s2] = call.reals(2);
    let [x, y, z] = p.0;
    let section = (x / a).abs().pow(2.0 / s2) + (y / b).abs().pow(2.0 / s2);
    let value = 1.0 - section.pow(s2 / s1) - (z / c).abs().pow(2.0 / s1);
    Ok(unless_zero(&[a, b, c, s1, s2], value))
}
