//! How much smooth boundaries mirror, and where they bend light.

use fieldstone_scene::Rgb;
use glam::DVec3;

/// The part of unpolarised light that the boundary of two dielectrics mirrors, exactly. `cosine` is that of the angle
/// against the normal, from 0 to 1, `eta` the refractive index beyond relative to here. 1 is total reflection.
pub(crate) fn dielectric(cosine: f64, eta: f64) -> f64 {
    // Without a boundary nothing is mirrored, not even at grazing angles.
    if eta == 1.0 {
        return 0.0;
    }
    let cosine = cosine.clamp(0.0, 1.0);
    let sine_squared = (1.0 - cosine * cosine) / (eta * eta);
    if sine_squared >= 1.0 {
        return 1.0;
    }
    let beyond = (1.0 - sine_squared).sqrt();
    let parallel = (eta * cosine - beyond) / (eta * cosine + beyond);
    let perpendicular = (cosine - eta * beyond) / (cosine + eta * beyond);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// C. Schlick's approximation (1994) from what is mirrored at a right angle.
pub(crate) fn schlick(at_normal: Rgb, cosine: f64) -> Rgb {
    let grazing = (1.0 - cosine.clamp(0.0, 1.0)).powi(5);
    at_normal + (DVec3::ONE - at_normal) * grazing
}

/// What is mirrored at a right angle by the boundary of two dielectrics.
pub(crate) fn at_normal(eta: f64) -> f64 {
    let ratio = (eta - 1.0) / (eta + 1.0);
    ratio * ratio
}

/// The direction in which a mirror sends light on; `normal` is on the side that it comes from.
pub(crate) fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    (direction - 2.0 * direction.dot(normal) * normal).normalize_or(direction)
}

/// The direction beyond a boundary by Snell's law; none under total reflection.
pub(crate) fn refracted(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    if eta == 1.0 {
        return Some(direction);
    }
    let cosine = -direction.dot(normal);
    let beyond_squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    let beyond = (beyond_squared > 0.0).then(|| beyond_squared.sqrt())?;
    (direction / eta + (cosine / eta - beyond) * normal).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_exact_formula() {
        for eta in [1.33, 1.5, 2.4, 1.0 / 1.5] {
            assert!((dielectric(1.0, eta) - at_normal(eta)).abs() < 1e-15);
            assert!((dielectric(0.0, eta) - 1.0).abs() < 1e-15);
        }
        assert_eq!(dielectric(0.3, 1.0), 0.0);
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-15);
    }

    /// At Brewster's angle, tan θ = η, nothing of the parallel component is mirrored; what remains is
    /// ½ ((η² − 1) / (η² + 1))².
    #[test]
    fn brewsters_angle() {
        for eta in [1.33, 1.5, 2.4] {
            let cosine = 1.0 / f64::hypot(1.0, eta);
            let ratio = (eta * eta - 1.0) / (eta * eta + 1.0);
            assert!((dielectric(cosine, eta) - 0.5 * ratio * ratio).abs() < 1e-15);
        }
    }

    #[test]
    fn total_reflection_begins_at_the_critical_angle() {
        let eta = 1.0 / 1.5f64;
        let critical = (1.0 - eta * eta).sqrt();
        assert!(dielectric(critical + 1e-9, eta) < 1.0);
        assert_eq!(dielectric(critical - 1e-9, eta), 1.0);
        let incoming = |cosine: f64| DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine);
        assert!(refracted(incoming(critical + 1e-9), DVec3::Z, eta).is_some());
        assert_eq!(refracted(incoming(critical - 1e-9), DVec3::Z, eta), None);
    }

    #[test]
    fn snells_law() {
        for (eta, angle) in [(1.5, 0.3f64), (1.5, 1.4), (1.0 / 1.5, 0.6), (2.4, 1.0)] {
            let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
            let beyond = refracted(direction, DVec3::Z, eta).expect("no total reflection");
            assert!((beyond.x * eta - angle.sin()).abs() < 1e-14 && beyond.z < 0.0 && beyond.y == 0.0);
            let back = mirrored(direction, DVec3::Z);
            assert!((back - DVec3::new(angle.sin(), 0.0, angle.cos())).length() < 1e-15);
        }
    }

    #[test]
    fn reflection_is_the_same_from_both_sides() {
        for cosine in [0.1f64, 0.5, 0.9] {
            let beyond = (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt();
            assert!((dielectric(cosine, 1.5) - dielectric(beyond, 1.0 / 1.5)).abs() < 1e-14);
        }
    }
}
