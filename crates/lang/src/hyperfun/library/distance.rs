//! Solids whose function is the signed distance from their boundary, positive inside.

use super::call::{Call, Outcome, unless_zero};
use super::ellipsoid::ELLIPSOID;

/// hfDCylinder: R less the distance from an axis through a point in any direction.
pub(super) fn cylinder<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (p, axis) = (call.point(0)? - call.vector(1)?, call.vector(2)?);
    Ok(call.real(3) - axis.unit().cross(p).length())
}

/// hfDConeX, Y, Z: a double cone of radius R at distance 1 from its apex; negative values outside are distances only
/// up to the apex's normal cone.
pub(super) fn cone<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let (along, [u, v]) = (call.point(0)? - call.vector(1)?).along_and_across(axis);
    let slope = call.real(2);
    let radial = (u.square() + v.square()).sqrt();
    Ok((along.abs() * slope - radial) / (1.0 + slope.square()).sqrt())
}

/// hfDTorusX, Y, Z.
pub(super) fn torus<'g>(call: &mut Call<'g>, axis: usize) -> Outcome<'g> {
    let (along, [u, v]) = (call.point(0)? - call.vector(1)?).along_and_across(axis);
    let [ring, tube] = call.reals(2);
    let radial = (u.square() + v.square()).sqrt();
    Ok(tube - ((radial - ring).square() + along.square()).sqrt())
}

/// hfDEllipsoid.
pub(super) fn ellipsoid<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [x, y, z] = (call.point(0)? - call.vector(1)?).0;
    let axes: [_; 3] = call.reals(2);
    Ok(unless_zero(&axes, x.call(&ELLIPSOID, &[y, z, axes[0], axes[1], axes[2]])))
}
