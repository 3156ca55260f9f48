//! Flakes as a distribution of normals: how many face a direction, which of them are seen, and what maps do to them.
//!
//! After Heitz, Dupuy, Crassin and Dachsbacher, "The SGGX Microflake Distribution" (SIGGRAPH 2015). The flakes of a
//! matrix S have the normals of the ellipsoid xᵀ Q x = 1 with S = adj(Q⁻¹) = det(Q⁻¹) Q: S is proportional to the
//! form Q of F. Neyret (Graphics Interface 1995), whose mean is taken of Q⁻¹.
//!
//! What differs from the paper: D is written with the adjugate of S, which exists where S has no inverse, and flat
//! distributions are thickened before they are evaluated ([`Flakes::FLATTEST`]).

use crate::Sggx;
use crate::symmetric::{adjugate, eigenvectors};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A distribution of normals ready for use: S in double precision, and never flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flakes {
    s: DMat3,
    adjugate: DMat3,
    determinant: f64,
}

impl Flakes {
    /// The smallest eigenvalue of S that is evaluated, as a share of the trace: the square of a roughness of 0.01 of flat
    /// flakes. Eigenvalues of S below are raised to it, all by the same amount, since mirrors without any roughness have no
    /// density of normals.
    pub const FLATTEST: f64 = 1e-4;

    /// The flakes of S, thickened if they are flat. Where S is 0 or not a number they face all ways alike.
    pub fn new(sggx: &Sggx) -> Self {
        let s = sggx.matrix();
        let trace = s.x_axis.x + s.y_axis.y + s.z_axis.z;
        if !(trace > 0.0 && trace.is_finite() && s.is_finite()) {
            return Self::of_matrix(DMat3::IDENTITY);
        }
        let lacking = (Self::FLATTEST * trace - sggx.eigenvalues()[0]).max(0.0);
        Self::of_matrix(s + DMat3::from_diagonal(DVec3::splat(lacking)))
    }

    /// The flakes of a symmetric, positive matrix.
    fn of_matrix(s: DMat3) -> Self {
        Self { s, adjugate: adjugate(s), determinant: s.determinant() }
    }

    /// S.
    pub fn matrix(&self) -> DMat3 {
        self.s
    }

    /// The projected area σ(w) = √(wᵀ S w) along the unit direction `w`.
    pub fn projected_area(&self, w: DVec3) -> f64 {
        w.dot(self.s * w).max(0.0).sqrt()
    }

    /// The density of normals D(n) = |S|^{3/2} / (π (nᵀ adj(S) n)²) at the unit normal `n`: ∫ ⟨w, n⟩₊ D(n) dn = σ(w).
    pub fn normal_density(&self, n: DVec3) -> f64 {
        let form = n.dot(self.adjugate * n);
        self.determinant * self.determinant.sqrt() / (PI * form * form)
    }

    /// The density D_w(n) = ⟨w, n⟩₊ D(n) / σ(w) of the normals that are seen from the unit direction `w`, per
    /// steradian. Its integral is 1.
    pub fn visible_density(&self, w: DVec3, n: DVec3) -> f64 {
        w.dot(n).max(0.0) * self.normal_density(n) / self.projected_area(w)
    }

    /// The inverse quadratic form Q⁻¹ = adj(S) / √|S| of the ellipsoid with these normals and projected areas π σ.
    pub fn inverse_form(&self) -> DMat3 {
        self.adjugate * self.determinant.sqrt().recip()
    }
}

/// The normals that are seen from one direction, by the points of a disc: equal areas of the disc stand for equal shares
/// of what is seen. The disc is the apparent ellipse of the ellipsoid.
#[derive(Clone, Copy, Debug)]
pub struct VisibleNormals {
    /// What the two coordinates in the disc, and the height above it on the unit ball, are multiplied by.
    columns: DMat3,
}

impl VisibleNormals {
    /// Those of `flakes` that are seen from the unit direction `w`.
    pub fn new(flakes: &Flakes, w: DVec3) -> Self {
        let (k, j) = w.any_orthonormal_pair();
        let frame = DMat3::from_cols(k, j, w);
        let t = frame.transpose() * flakes.s * frame;
        let (kj, ki, ji) = (t.y_axis.x, t.z_axis.x, t.z_axis.y);
        let (jj, ii) = (t.y_axis.y, t.z_axis.z);
        let seen = ii.sqrt();
        let tau = (jj * ii - ji * ji).max(f64::MIN_POSITIVE).sqrt();
        let first = DVec3::X * (flakes.determinant.sqrt() / tau);
        let second = DVec3::new((kj * ii - ki * ji) / (seen * tau), tau / seen, 0.0);
        let third = DVec3::new(ki, ji, ii) / seen;
        Self { columns: frame * DMat3::from_cols(first, second, third) }
    }

    /// The unit normal of a point of the unit disc.
    pub fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        let height = (1.0 - u * u - v * v).max(0.0).sqrt();
        (self.columns * DVec3::new(u, v, height)).normalize_or_zero()
    }
}

/// The point of the unit disc of two numbers from 0 to 1; areas stay in proportion.
pub fn disc_point([share, turn]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
    let radius = share.clamp(0.0, 1.0).sqrt();
    [radius * cos, radius * sin]
}

impl Sggx {
    /// The flakes with the normals of the ellipsoid xᵀ `form` x = 1, with a mean projected area of 1. A form that is not
    /// positive, as of a cylinder, stands for the limit of those that are.
    pub fn from_quadratic_form(form: DMat3) -> Self {
        Self::from_matrix(form * form_scale(form)).normalised()
    }

    /// The flakes with the normals of the ellipsoid xᵀ A⁻¹ x = 1, A being `inverse`, with a mean projected area of 1. A may be
    /// singular.
    pub fn from_inverse_form(inverse: DMat3) -> Self {
        let scaled = inverse * form_scale(inverse);
        Self::from_matrix(adjugate(scaled)).normalised()
    }

    /// Fits flakes to unit `normals`, with a mean projected area of 1: the axes are those of Σ n nᵀ, the projected areas along them
    /// the means of |n · axis| (Heitz et al. 2015). Without normals they face all ways alike.
    pub fn fitted(normals: impl Iterator<Item = DVec3> + Clone) -> Self {
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        let covariance = normals.clone().fold(DMat3::ZERO, |sum, n| sum + outer(n));
        let axes = eigenvectors(covariance);
        let mut areas = [0.0; 3];
        let mut count = 0.0;
        for n in normals {
            for (area, axis) in areas.iter_mut().zip([axes.x_axis, axes.y_axis, axes.z_axis]) {
                *area += n.dot(axis).abs();
            }
            count += 1.0;
        }
        let [x, y, z] = areas.map(|area| (area / f64::max(count, 1.0)).powi(2));
        let s = outer(axes.x_axis) * x + outer(axes.y_axis) * y + outer(axes.z_axis) * z;
        Self::from_matrix(s).normalised()
    }

    /// The flakes after a linear map of space (columns are the images of the axes): S' = M S Mᵀ with the cofactor matrix
    /// M, since areas map by it. The mean projected area of S' is that of S times the growth of the flakes' area; a rotation
    /// keeps it.
    pub fn mapped(&self, map: DMat3) -> Self {
        let cofactors = DMat3::from_cols(
            map.y_axis.cross(map.z_axis),
            map.z_axis.cross(map.x_axis),
            map.x_axis.cross(map.y_axis),
        );
        Self::from_matrix(cofactors * self.matrix() * cofactors.transpose())
    }
}

/// What brings the greatest entry of a matrix to 1.
fn form_scale(form: DMat3) -> f64 {
    let greatest = form.to_cols_array().into_iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    if greatest > 0.0 { greatest.recip() } else { 1.0 }
}
