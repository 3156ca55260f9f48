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

/// hfSawtooth: the first n − 1 terms of the Fourier series of a sawtooth, (2/πa)(1/2 − Σ sin(2πift)/i).
pub(super) fn sawtooth<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    const MOST_TERMS: f64 = 4096.0;
    let [time, _, amplitude, frequency] = call.reals(0);
    let count = call.constant(1)?.trunc();
    if count <= 1.0 {
        return Ok(call.number(0.0));
    }
    if count.is_nan() || count > MOST_TERMS {
        return Err(format!("`{}` must be at most {MOST_TERMS}, not {count}", call.name(1)).into());
    }
    let turn = time * frequency * std::f64::consts::TAU;
    let waves = (1..count as u32).map(|i| (turn * f64::from(i)).sin() / f64::from(i));
    Ok(2.0 / (amplitude * std::f64::consts::PI) * (0.5 - call.sum(waves)))
}
