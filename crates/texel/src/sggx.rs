//! The matrix of a distribution of flakes.

use glam::{DMat3, DVec3};

/// A distribution of flakes by the matrix S of SGGX (Heitz et al. 2015): symmetric, not negative. Its eigenvalues are
/// the squared projected areas along its eigenvectors, so that the projected area along a unit direction w is
/// σ(w) = √(wᵀ S w).
///
/// The size of S has no meaning of its own: amounts are kept in densities. Flakes in a [`crate::Volume`] have a
/// projected area of 1 in the mean over all directions ([`Sggx::normalised`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sggx {
    /// S along x.
    pub xx: f32,
    /// S along y.
    pub yy: f32,
    /// S along z.
    pub zz: f32,
    /// S between x and y.
    pub xy: f32,
    /// S between x and z.
    pub xz: f32,
    /// S between y and z.
    pub yz: f32,
}

impl Default for Sggx {
    fn default() -> Self {
        Self::ISOTROPIC
    }
}

impl Sggx {
    /// Flakes that face all ways alike: the normals of a ball.
    pub const ISOTROPIC: Self = Self { xx: 1.0, yy: 1.0, zz: 1.0, xy: 0.0, xz: 0.0, yz: 0.0 };

    /// The flakes of a surface with the unit `normal`: S = n nᵀ + α² (1 − n nᵀ), normalised. `roughness` is α, from 0
    /// (all flakes lie in the surface) to 1 (isotropic).
    pub fn surface(normal: DVec3, roughness: f64) -> Self {
        Self::from_matrix(Self::surface_form(normal, roughness)).normalised()
    }

    /// The flakes of fibres along the unit `tangent`: S = (1 − t tᵀ) + α² t tᵀ, normalised. `roughness` is α, from 0
    /// (normals stand on the fibre) to 1 (isotropic).
    pub fn fibre(tangent: DVec3, roughness: f64) -> Self {
        Self::from_matrix(Self::fibre_form(tangent, roughness)).normalised()
    }

    /// The normals of an ellipsoid: `axes` are its three half axes, as columns at right angles to each other. S is
    /// proportional to adj(A), where A = Σ aₖ aₖᵀ is the inverse of the quadratic form; normalised.
    pub fn ellipsoid(axes: DMat3) -> Self {
        let areas =
            [axes.y_axis.cross(axes.z_axis), axes.z_axis.cross(axes.x_axis), axes.x_axis.cross(axes.y_axis)];
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        Self::from_matrix(outer(areas[0]) + outer(areas[1]) + outer(areas[2])).normalised()
    }

    /// S of a surface before it is normalised: its mean projected area depends on the roughness alone.
    pub(crate) fn surface_form(normal: DVec3, roughness: f64) -> DMat3 {
        around(normal, 1.0, roughness * roughness)
    }

    /// S of fibres before it is normalised: its mean projected area depends on the roughness alone.
    pub(crate) fn fibre_form(tangent: DVec3, roughness: f64) -> DMat3 {
        around(tangent, roughness * roughness, 1.0)
    }

    /// The symmetric part of a matrix.
    pub fn from_matrix(m: DMat3) -> Self {
        let mean = |a: f64, b: f64| (0.5 * (a + b)) as f32;
        Self {
            xx: m.x_axis.x as f32,
            yy: m.y_axis.y as f32,
            zz: m.z_axis.z as f32,
            xy: mean(m.x_axis.y, m.y_axis.x),
            xz: mean(m.x_axis.z, m.z_axis.x),
            yz: mean(m.y_axis.z, m.z_axis.y),
        }
    }

    /// S as a matrix.
    pub fn matrix(&self) -> DMat3 {
        let [xx, yy, zz, xy, xz, yz] = self.entries().map(f64::from);
        DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
    }

    /// xx, yy, zz, xy, xz, yz.
    pub fn entries(&self) -> [f32; 6] {
        [self.xx, self.yy, self.zz, self.xy, self.xz, self.yz]
    }

    /// S from its entries in the order of [`Sggx::entries`].
    pub fn from_entries([xx, yy, zz, xy, xz, yz]: [f32; 6]) -> Self {
        Self { xx, yy, zz, xy, xz, yz }
    }

    /// The projected area σ(w) = √(wᵀ S w) along the unit direction w.
    pub fn projected_area(&self, w: DVec3) -> f64 {
        w.dot(self.matrix() * w).max(0.0).sqrt()
    }

    /// The mean of σ over all directions: R_G(λ₁, λ₂, λ₃) of the eigenvalues, Carlson's symmetric integral (DLMF
    /// 19.16.3), exact to 10⁻⁹ of the greatest projected area. Negative eigenvalues count as 0.
    pub fn mean_projected_area(&self) -> f64 {
        let [a, b, c] = self.eigenvalues();
        symmetric_surface(a.max(0.0), b.max(0.0), c.max(0.0))
    }

    /// S scaled so that the mean projected area is 1; isotropic if S is 0 or not a number.
    pub fn normalised(&self) -> Self {
        let mean = self.mean_projected_area();
        let scale = (mean * mean).recip() as f32;
        if !(scale.is_finite() && scale > 0.0) {
            return Self::ISOTROPIC;
        }
        Self::from_entries(self.entries().map(|entry| entry * scale))
    }

    /// The eigenvalues, the smallest first (O. Smith's trigonometric form, 1961).
    pub fn eigenvalues(&self) -> [f64; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.entries().map(f64::from);
        let mean = (xx + yy + zz) / 3.0;
        let off = xy * xy + xz * xz + yz * yz;
        let spread =
            ((xx - mean).powi(2) + (yy - mean).powi(2) + (zz - mean).powi(2) + 2.0 * off).max(0.0) / 6.0;
        let p = spread.sqrt();
        if p <= mean.abs() * 1e-12 {
            return [mean; 3];
        }
        let deviation = (self.matrix() - DMat3::from_diagonal(DVec3::splat(mean))) * p.recip();
        let angle = (0.5 * deviation.determinant()).clamp(-1.0, 1.0).acos() / 3.0;
        let largest = mean + 2.0 * p * angle.cos();
        let smallest = mean + 2.0 * p * (angle + std::f64::consts::TAU / 3.0).cos();
        [smallest, 3.0 * mean - largest - smallest, largest]
    }
}

/// The matrix with one eigenvalue along an axis and another across it.
fn around(axis: DVec3, along: f64, across: f64) -> DMat3 {
    let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
    outer * (along - across) + DMat3::from_diagonal(DVec3::splat(across))
}

/// Carlson's R_G: the mean over the sphere of √(x l² + y m² + z n²), for x, y, z ≥ 0 in rising order.
///
/// R_G = ½ (z R_F − ⅓ (x − z)(y − z) R_D + √(x y / z)), and both R_F and R_D by duplication (DLMF 19.36).
fn symmetric_surface(x: f64, y: f64, z: f64) -> f64 {
    if z <= 0.0 {
        return 0.0;
    }
    // At 0, R_F grows without bound while R_G does not: 10⁻¹⁸ moves R_G by less than 10⁻⁹.
    let (x, y, z) = ((x / z).max(1e-18), (y / z).max(1e-18), z);
    let (first, second) = duplicated(x, y, 1.0);
    0.5 * z.sqrt() * (first - (x - 1.0) * (y - 1.0) * second / 3.0 + (x * y).sqrt())
}

/// R_F(x, y, z) and R_D(x, y, z).
fn duplicated(x: f64, y: f64, z: f64) -> (f64, f64) {
    let (mut x, mut y, mut z) = (x, y, z);
    let (mut sum, mut weight) = (0.0, 1.0);
    // Each turn divides the differences by 4. The series leaves out their sixth powers.
    for _ in 0..40 {
        let (a, b, c) = (x.sqrt(), y.sqrt(), z.sqrt());
        let lambda = a * b + a * c + b * c;
        sum += weight / (c * (z + lambda));
        weight *= 0.25;
        (x, y, z) = (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda));
        if (x - z).abs().max((y - z).abs()) < 0.01 * z {
            break;
        }
    }
    // DLMF 19.36.1 and 19.36.2, to the fifth power.
    let mean = (x + y + z) / 3.0;
    let (u, v) = (1.0 - x / mean, 1.0 - y / mean);
    let w = -(u + v);
    let (second, third) = (u * v - w * w, u * v * w);
    let first = 1.0 - second / 10.0 + third / 14.0 + second * second / 24.0 - 3.0 * second * third / 44.0;
    let mean_of_five = 0.2 * (x + y + 3.0 * z);
    let (u, v) = (1.0 - x / mean_of_five, 1.0 - y / mean_of_five);
    let w = -(u + v) / 3.0;
    let (uv, ww) = (u * v, w * w);
    let (e2, e3) = (uv - 6.0 * ww, (3.0 * uv - 8.0 * ww) * w);
    let (e4, e5) = (3.0 * (uv - ww) * ww, uv * w * ww);
    let series =
        1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0
            + 3.0 * e5 / 26.0;
    (first / mean.sqrt(), 3.0 * sum + weight * series / (mean_of_five * mean_of_five.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of σ by a spiral of directions.
    fn summed(flakes: &Sggx) -> f64 {
        let count = 200_000;
        let turn = std::f64::consts::PI * (1.0 + 5.0f64.sqrt());
        let directions = (0..count).map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (turn * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cos, r * sin, z)
        });
        directions.map(|w| flakes.projected_area(w)).sum::<f64>() / f64::from(count)
    }

    #[test]
    fn the_mean_projected_area_is_the_mean_over_directions() {
        let shapes = [
            [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [0.3, 0.9, 2.0, 0.1, -0.4, 0.7],
            [0.01, 0.02, 4.0, 0.0, 0.001, 0.1],
        ];
        for entries in shapes {
            let flakes = Sggx::from_entries(entries);
            let (exact, sum) = (flakes.mean_projected_area(), summed(&flakes));
            assert!((exact - sum).abs() < 2e-5, "{entries:?}: {exact} beside {sum}");
        }
    }

    #[test]
    fn a_flat_flake_is_seen_with_half_its_area() {
        let flake = Sggx::surface(DVec3::Z, 0.0);
        assert!((flake.projected_area(DVec3::Z) - 2.0).abs() < 1e-6);
        let fibre = Sggx::fibre(DVec3::Z, 0.0);
        assert!((fibre.projected_area(DVec3::X) - 4.0 / std::f64::consts::PI).abs() < 1e-6);
    }

    #[test]
    fn an_ellipsoid_projects_like_its_shadow() {
        let axes = DMat3::from_diagonal(DVec3::new(0.3, 0.9, 1.7));
        let flakes = Sggx::ellipsoid(axes);
        let ratio = flakes.projected_area(DVec3::X) / flakes.projected_area(DVec3::Z);
        assert!((ratio - (0.9 * 1.7) / (0.3 * 0.9)).abs() < 1e-5);
    }
}
