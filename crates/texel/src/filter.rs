//! Joining eight cells to the cell above.
//!
//! **`Sggx`.** S is the mean weighted by density: σ² is linear in S, so that the sum keeps zero areas zero, and is
//! associative. It is normalised when it is stored, so that a node's mean projected area is exact. Depths come from transmittances: the
//! product along an axis, the mean across it, so that a wall stays opaque and a speck stays a speck.
//!
//! **`Neyret1995`.** The inverse quadratic form A = Q⁻¹ is the mean weighted by density, with every form normalised
//! to a mean apparent area of 1 along its three axes; the density is the mean; depths follow from the two, so that opaque
//! things thin out. Q⁻¹ of flat or thin shapes has no bound: eigenvalues of S below 10⁻⁴ of its trace are raised by that.

use crate::texel::MAX_DEPTH;
use crate::{Sggx, Texel};
use glam::{DMat3, DVec3};

/// The rule by which cells are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Means of S, transmittances along the axes.
    #[default]
    Sggx,
    /// Means of inverse quadratic forms and of densities, as in the paper of 1995.
    Neyret1995,
}

/// A cell on its way up, before it is packed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joined {
    /// As the texel's, but with flakes that are not normalised where `shape` is S.
    pub(crate) texel: Texel,
    /// S (not normalised) or Q⁻¹ (normalised), by the mode.
    shape: [f32; 6],
}

impl Joined {
    pub(crate) fn leaf(texel: Texel, mode: Mode) -> Self {
        let shape = match mode {
            Mode::Sggx => texel.flakes.entries(),
            Mode::Neyret1995 => Sggx::from_matrix(inverse_form(&texel.flakes)).entries(),
        };
        Self { texel, shape }
    }

    /// The same content in a cell twice as wide.
    pub(crate) fn doubled(self) -> Self {
        let depth = self.texel.depth.map(|depth| (2.0 * depth).min(MAX_DEPTH));
        Self { texel: Texel { depth, ..self.texel }, ..self }
    }
}

/// Joins the filled ones of eight cells, each with its octant (bit 0: x, bit 1: y, bit 2: z). `width` is that of the
/// new cell.
pub(crate) fn join(cells: &[(usize, Joined)], mode: Mode, width: f64) -> Joined {
    let total: f32 = cells.iter().map(|(_, cell)| cell.texel.density).sum();
    // Cells without density but with depth (their density is below what can be stored) count alike.
    let weight =
        |cell: &Joined| if total > 0.0 { cell.texel.density / total } else { 1.0 / cells.len() as f32 };
    let mut shape = [0.0; 6];
    let (mut albedo, mut gloss) = ([0.0; 3], 0.0);
    for (_, cell) in cells {
        let weight = weight(cell);
        for (sum, entry) in shape.iter_mut().zip(cell.shape) {
            *sum += weight * entry;
        }
        for (sum, share) in albedo.iter_mut().zip(cell.texel.albedo) {
            *sum += weight * share;
        }
        gloss += weight * cell.texel.gloss;
    }
    let density = total / 8.0;
    match mode {
        Mode::Sggx => {
            let flakes = Sggx::from_entries(shape).normalised();
            Joined { texel: Texel { density, depth: depths(cells), flakes, albedo, gloss }, shape }
        }
        Mode::Neyret1995 => {
            let form = three_axis_normalised(Sggx::from_entries(shape).matrix());
            let seen = adjugate(form);
            let depth = [seen.x_axis.x, seen.y_axis.y, seen.z_axis.z]
                .map(|area| ((f64::from(density) * area.max(0.0).sqrt() * width) as f32).min(MAX_DEPTH));
            let flakes = Sggx::from_matrix(seen).normalised();
            let shape = Sggx::from_matrix(form).entries();
            Joined { texel: Texel { density, depth, flakes, albedo, gloss }, shape }
        }
    }
}

/// −ln of the transmittance along each axis: the product along, the mean across. Empty cells let everything pass.
fn depths(cells: &[(usize, Joined)]) -> [f32; 3] {
    std::array::from_fn(|axis| {
        let mut columns = [0.0f64; 4];
        for (octant, cell) in cells {
            let column = match axis {
                0 => octant >> 1,
                1 => octant & 1 | octant >> 1 & 2,
                _ => octant & 3,
            };
            columns[column] += f64::from(cell.texel.depth[axis]);
        }
        let absorbed: f64 = columns.iter().map(|depth| -(-depth).exp_m1()).sum();
        (-(-0.25 * absorbed).ln_1p() as f32).min(MAX_DEPTH)
    })
}

/// Q⁻¹ of flakes, normalised by the mean apparent area along its three axes.
fn inverse_form(flakes: &Sggx) -> DMat3 {
    let s = flakes.matrix();
    let trace = s.x_axis.x + s.y_axis.y + s.z_axis.z;
    let s = s + DMat3::from_diagonal(DVec3::splat(1e-4 * trace));
    // S = adj(A) and det S = (det A)², so that A = √|S| S⁻¹ = adj(S) / √|S|.
    three_axis_normalised(adjugate(s) * s.determinant().max(f64::MIN_POSITIVE).sqrt().recip())
}

/// A scaled so that the ellipsoid's apparent areas along its own axes, π left out, have a mean of 1. They are the
/// products of two half axes, and the square roots of the eigenvalues of adj(A).
fn three_axis_normalised(form: DMat3) -> DMat3 {
    let areas = Sggx::from_matrix(adjugate(form)).eigenvalues().map(|value| value.max(0.0).sqrt());
    let mean = (areas[0] + areas[1] + areas[2]) / 3.0;
    if mean > 0.0 && mean.is_finite() { form * mean.recip() } else { DMat3::IDENTITY }
}

/// The adjugate of a symmetric matrix: the products of its columns.
fn adjugate(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}
