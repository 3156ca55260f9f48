//! Joining eight cells to the cell above.
//!
//! **`Sggx`.** S is the mean weighted by density: σ² is linear in S, so that the sum keeps zero areas zero, and is
//! associative. It is normalised only when it is stored, so that a cell's mean extinction is exact and S is the mean
//! over all finest cells below. Depths come from transmittances: a cell knows the optical depth of every straight
//! column of finest cells through it, and its depth along an axis is −ln of the mean transmittance of those columns. So
//! a wall stays opaque, a speck stays a speck, and what stands in line is not counted twice.
//!
//! **`Neyret1995`.** The inverse quadratic form A = Q⁻¹ is the mean weighted by density, with every form normalised
//! to a mean apparent area of 1 along its three axes; the density is the mean; depths follow from the two, so that
//! opaque things thin out. Q⁻¹ of flat or thin shapes has no bound: S is first raised by 10⁻⁴ of its trace.
//!
//! The densities of the two are not the same: in the paper it is a probability of occlusion, here the amount of surface. The
//! inside of a solid has much of the one and nothing of the other. Those of 1995 therefore come from the depths of
//! the finest cells, where an opaque cell counts as an optical depth of [`OPAQUE`].

use crate::symmetric::adjugate;
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

/// A cell on its way up.
#[derive(Clone, Debug)]
pub(crate) struct Joined {
    density: f32,
    albedo: [f32; 3],
    gloss: f32,
    /// S (not normalised) or Q⁻¹ (normalised), by the mode.
    shape: [f32; 6],
    columns: Columns,
}

/// Optical depths of the columns of finest cells along x, y and z.
#[derive(Clone, Debug)]
enum Columns {
    /// All columns along an axis are the same.
    Even([f32; 3]),
    /// s² columns along x, then y, then z. A column is found by its other two coordinates, the first of
    /// (y, z), (x, z), (x, y) fastest.
    Each(Box<[f32]>),
}

/// The optical depth that an opaque cell counts as by the rules of 1995.
const OPAQUE: f64 = 5.0;

/// The density by the rules of 1995 of a cell of the finest level: the extinction that its depths speak of.
fn occlusion(texel: &Texel, width: f64) -> f32 {
    let hidden: f64 = texel.depth.iter().map(|depth| f64::from(*depth).min(OPAQUE)).sum();
    let seen: f64 = DVec3::AXES.iter().map(|w| texel.flakes.projected_area(*w)).sum();
    if seen > 0.0 { (hidden / (seen * width)) as f32 } else { 0.0 }
}

impl Joined {
    /// A cell of the finest level, of the given `width`.
    pub(crate) fn leaf(texel: &Texel, mode: Mode, width: f64) -> Self {
        let (density, shape) = match mode {
            Mode::Sggx => (texel.density, texel.flakes.entries()),
            Mode::Neyret1995 => {
                let form = inverse_form(&texel.flakes);
                (occlusion(texel, width), Sggx::from_matrix(form).entries())
            }
        };
        let Texel { albedo, gloss, depth, .. } = *texel;
        Self { density, albedo, gloss, shape, columns: Columns::Even(depth) }
    }

    /// The same content in a cell twice as wide, for cells that are evenly filled.
    pub(crate) fn doubled(&self) -> Self {
        let columns = match &self.columns {
            Columns::Even(depth) => Columns::Even(depth.map(|depth| 2.0 * depth)),
            Columns::Each(depths) => Columns::Each(depths.clone()),
        };
        Self { columns, ..*self }
    }

    /// What is stored of a cell of the given `width`.
    pub(crate) fn texel(&self, mode: Mode, width: f64) -> Texel {
        let (flakes, depth) = match mode {
            Mode::Sggx => (Sggx::from_entries(self.shape), self.columns.depths()),
            Mode::Neyret1995 => {
                let seen = adjugate(Sggx::from_entries(self.shape).matrix());
                let areas = [seen.x_axis.x, seen.y_axis.y, seen.z_axis.z].map(|area| area.max(0.0).sqrt());
                (Sggx::from_matrix(seen), areas.map(|area| (f64::from(self.density) * area * width) as f32))
            }
        };
        let depth = depth.map(|depth| depth.min(MAX_DEPTH));
        Texel {
            density: self.density,
            depth,
            flakes: flakes.normalised(),
            albedo: self.albedo,
            gloss: self.gloss,
        }
    }
}

impl Columns {
    /// −ln of the mean transmittance along each axis.
    fn depths(&self) -> [f32; 3] {
        match self {
            Self::Even(depths) => *depths,
            Self::Each(depths) => std::array::from_fn(|axis| {
                let count = depths.len() / 3;
                let columns = &depths[axis * count..(axis + 1) * count];
                let absorbed: f64 = columns.iter().map(|depth| f64::from(-(-depth).exp_m1())).sum();
                -(-absorbed / count as f64).ln_1p() as f32
            }),
        }
    }

    /// The columns of eight cells of s³ finest cells.
    fn joined(cells: &[(usize, &Joined)], s: usize) -> Self {
        let (count, row) = (s * s, 2 * s);
        let mut sums = vec![0.0; 3 * 4 * count];
        for (octant, cell) in cells {
            for axis in 0..3 {
                let [u, v] = [[1, 2], [0, 2], [0, 1]][axis].map(|other| (octant >> other & 1) * s);
                let target = &mut sums[axis * 4 * count..(axis + 1) * 4 * count];
                for j in 0..s {
                    let line = &mut target[(v + j) * row + u..][..s];
                    match &cell.columns {
                        Columns::Even(depths) => line.iter_mut().for_each(|sum| *sum += depths[axis]),
                        Columns::Each(depths) => {
                            let source = &depths[axis * count + j * s..][..s];
                            line.iter_mut().zip(source).for_each(|(sum, depth)| *sum += depth);
                        }
                    }
                }
            }
        }
        Self::Each(sums.into_boxed_slice())
    }
}

/// Joins the filled ones of eight cells, each with its octant (bit 0: x, bit 1: y, bit 2: z) and `side` finest cells
/// along its edge.
pub(crate) fn join(cells: &[(usize, &Joined)], mode: Mode, side: usize) -> Joined {
    let total: f32 = cells.iter().map(|(_, cell)| cell.density).sum();
    let mut sum = Joined {
        density: total / 8.0,
        albedo: [0.0; 3],
        gloss: 0.0,
        shape: [0.0; 6],
        columns: Columns::Even([0.0; 3]),
    };
    for (_, cell) in cells {
        // Cells with depth and a density below what can be stored count alike.
        let weight = if total > 0.0 { cell.density / total } else { 1.0 / cells.len() as f32 };
        sum.shape.iter_mut().zip(cell.shape).for_each(|(sum, entry)| *sum += weight * entry);
        sum.albedo.iter_mut().zip(cell.albedo).for_each(|(sum, share)| *sum += weight * share);
        sum.gloss += weight * cell.gloss;
    }
    match mode {
        Mode::Sggx => sum.columns = Columns::joined(cells, side),
        Mode::Neyret1995 => {
            let form = three_axis_normalised(Sggx::from_entries(sum.shape).matrix());
            sum.shape = Sggx::from_matrix(form).entries();
        }
    }
    sum
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
