//! What fills a cell.

use crate::Sggx;
use glam::DVec3;

/// The greatest optical depth that is told from opaque: e⁻²⁰ = 2·10⁻⁹ of the light passes.
pub const MAX_DEPTH: f32 = 20.0;

/// What fills a cell, at any level.
///
/// A cell is what rays see of it ([`Texel::depth`]) and what light does there (`flakes`, `albedo`, `gloss`). The
/// `density` says how much surface there is: it weighs a cell when cells are joined. All sources and the painter keep to this: the
/// inside of a solid stops all light and has a density of 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// The area of the surfaces inside, projected and in the mean over all directions, per unit of volume, ≥ 0. Where they lie about
    /// by chance that is the extinction, per unit of length (the volume's edge): along w that of an evenly
    /// filled cell is density · σ(w). Above the finest level of a volume of the rules of 1995 it is the mean extinction that
    /// the depths of the finest level speak of.
    pub density: f32,
    /// Optical depth straight across the cell along x, y and z: −ln of the transmittance in the mean over the
    /// cell's face, from 0 to [`MAX_DEPTH`]. Unlike the density it knows how the content is spread over the face: an
    /// opaque wall and an opaque speck of the same amount differ. In other directions see [`Texel::extinction`].
    pub depth: [f32; 3],
    /// Which way the flakes face, with a mean projected area of 1.
    pub flakes: Sggx,
    /// The share of light that is scattered and not absorbed, red, green, blue, linear, 0 to 1.
    pub albedo: [f32; 3],
    /// The share of scattered light that flakes mirror; the rest they scatter as matt surfaces do. 0 to 1. How wide a
    /// highlight is, is told by the spread of the flakes (`roughness` of [`Sggx::surface`]), so no exponent is kept.
    pub gloss: f32,
}

impl Texel {
    /// An evenly filled cell of the given `width`: depths follow from `density` and `flakes`, which are normalised.
    pub fn even(density: f32, flakes: Sggx, width: f64) -> Self {
        let flakes = flakes.normalised();
        let along = |w: DVec3| {
            let depth = f64::from(density) * flakes.projected_area(w) * width;
            (depth as f32).clamp(0.0, MAX_DEPTH)
        };
        let depth = [along(DVec3::X), along(DVec3::Y), along(DVec3::Z)];
        Self { density, depth, flakes, albedo: [1.0; 3], gloss: 0.0 }
    }

    /// The same with a colour (linear, 0 to 1) and a share of mirrored light.
    pub fn coloured(self, albedo: [f32; 3], gloss: f32) -> Self {
        Self { albedo, gloss, ..self }
    }

    /// The extinction along the unit direction `w` in a cell of the given `width`: √(Σ wᵢ wⱼ rᵢⱼ τᵢ τⱼ) / width, where τ
    /// are the depths and rᵢⱼ = Sᵢⱼ / √(Sᵢᵢ Sⱼⱼ). Along the axes it is that of the depths, and in an evenly filled cell it is
    /// density · σ(w) in every direction.
    pub fn extinction(&self, w: DVec3, width: f64) -> f64 {
        let s = &self.flakes;
        let seen = [0, 1, 2].map(|axis| w[axis] * f64::from(self.depth[axis]));
        let tied = |entry: f32, a: f32, b: f32| {
            let product = f64::from(a) * f64::from(b);
            if product > 0.0 { f64::from(entry) / product.sqrt() } else { 0.0 }
        };
        let [x, y, z] = seen;
        let mixed =
            x * y * tied(s.xy, s.xx, s.yy) + x * z * tied(s.xz, s.xx, s.zz) + y * z * tied(s.yz, s.yy, s.zz);
        (x * x + y * y + z * z + 2.0 * mixed).max(0.0).sqrt() / width
    }
}

/// The coefficients of Phong's reflection that the rules of 1995 keep for a whole volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Share of diffuse light, 0 to 1.
    pub diffuse: f32,
    /// Share of specular light, 0 to 1.
    pub specular: f32,
    /// Exponent of the highlight, > 0.
    pub exponent: f32,
}

impl Default for Phong {
    fn default() -> Self {
        Self { diffuse: 0.8, specular: 0.2, exponent: 20.0 }
    }
}
