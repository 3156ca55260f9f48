//! The slice that a plane cuts from a cube.

use glam::DVec3;

/// The area of the part of the plane {p : n·p = d} that lies in the unit cube around the origin; n is a unit vector.
///
/// It is the density of n·u for u even in the cube: the convolution of three boxes as wide as the parts of n. Two of
/// them make a trapezoid, and the third is the difference of its integral at two places. Exact to 10⁻⁹; where the plane lies
/// in a face, the half of it.
pub(super) fn slice_area(n: DVec3, d: f64) -> f64 {
    let mut widths = n.abs().to_array();
    widths.sort_by(f64::total_cmp);
    let [narrow, middle, wide] = widths;
    if narrow < 1e-6 {
        return trapezoid(middle, wide, d);
    }
    let integral = |d: f64| integrated_trapezoid(middle, wide, d);
    ((integral(d + 0.5 * narrow) - integral(d - 0.5 * narrow)) / narrow).max(0.0)
}

/// The convolution of two even densities, of the widths `narrow` ≤ `wide`, at `d`.
fn trapezoid(narrow: f64, wide: f64, d: f64) -> f64 {
    if narrow < 1e-9 {
        let beyond = d.abs() - 0.5 * wide;
        return if beyond.abs() < 1e-12 { 0.5 / wide } else { f64::from(beyond < 0.0) / wide };
    }
    ((0.5 * (wide + narrow) - d.abs()) / narrow).clamp(0.0, 1.0) / wide
}

/// The integral of [`trapezoid`] from 0 to `d`.
fn integrated_trapezoid(narrow: f64, wide: f64, d: f64) -> f64 {
    let (flat, end) = (0.5 * (wide - narrow), 0.5 * (wide + narrow));
    let x = d.abs().min(end);
    let slope = x - flat;
    let area =
        if slope <= 0.0 || narrow < 1e-9 { x.min(0.5 * wide) } else { x - 0.5 * slope * slope / narrow };
    (area / wide).copysign(d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_of_a_cube_have_their_areas() {
        let half = 0.5f64;
        assert!((slice_area(DVec3::X, 0.3) - 1.0).abs() < 1e-12);
        assert_eq!(slice_area(DVec3::X, 0.51), 0.0);
        // Along a diagonal of a face the middle slice is √2 wide.
        let diagonal = DVec3::new(1.0, 1.0, 0.0).normalize();
        assert!((slice_area(diagonal, 0.0) - 2f64.sqrt()).abs() < 1e-9);
        // Along the diagonal of the cube it is a regular hexagon of the side √½.
        let space = DVec3::ONE.normalize();
        let hexagon = 1.5 * 3f64.sqrt() * half;
        assert!((slice_area(space, 0.0) - hexagon).abs() < 1e-9);
        // Near a corner it is a triangle.
        let height = 0.1;
        let triangle = 1.5 * 3f64.sqrt() * height * height;
        assert!((slice_area(space, 0.75f64.sqrt() - height) - triangle).abs() < 1e-9);
    }

    #[test]
    fn all_slices_make_the_volume_of_the_cube() {
        for n in [[0.9, 0.1, 0.3], [1.0, 1e-5, 0.0], [0.2, 0.3, -1.0], [1.0, 1e-7, 0.5]] {
            let n = DVec3::from_array(n).normalize();
            let count = 20_000;
            let sum: f64 = (0..count).map(|i| slice_area(n, (f64::from(i) + 0.5) / 10_000.0 - 1.0)).sum();
            assert!((sum / 10_000.0 - 1.0).abs() < 1e-3, "{n}: {sum}");
        }
    }
}
