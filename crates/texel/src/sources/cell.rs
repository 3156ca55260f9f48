//! What is gathered in a cell.

use super::Paint;
use crate::{MAX_DEPTH, Sggx, Texel};
use glam::DVec3;

/// The matrix of flakes whose normals spread around one direction, normalised, without the direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finish {
    along: f64,
    across: f64,
}

impl Finish {
    /// Surfaces of a roughness, 0 to 1.
    pub(super) fn surface(roughness: f64) -> Self {
        Self::of(&Sggx::surface(DVec3::Z, roughness))
    }

    /// Fibres of a roughness, 0 to 1.
    pub(super) fn fibre(roughness: f64) -> Self {
        Self::of(&Sggx::fibre(DVec3::Z, roughness))
    }

    fn of(flakes: &Sggx) -> Self {
        Self { along: f64::from(flakes.zz), across: f64::from(flakes.xx) }
    }

    /// xx, yy, zz, xy, xz, yz of S for a unit direction.
    pub(super) fn around(&self, n: DVec3) -> [f64; 6] {
        let k = self.along - self.across;
        [
            self.across + k * n.x * n.x,
            self.across + k * n.y * n.y,
            self.across + k * n.z * n.z,
            k * n.x * n.y,
            k * n.x * n.z,
            k * n.y * n.z,
        ]
    }
}

/// S of flakes that face all ways alike.
pub(super) const ISOTROPIC: [f64; 6] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// Sums over what is in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gathered {
    /// The mean projected area, in squares of the volume's edge.
    pub(super) amount: f64,
    shape: [f64; 6],
    albedo: [f64; 3],
    gloss: f64,
    /// Optical depth along each axis.
    pub(super) depth: [f64; 3],
}

impl Gathered {
    /// Adds flakes with the normalised matrix `shape`.
    pub(super) fn add(&mut self, amount: f64, shape: &[f64; 6], paint: &Paint) {
        self.amount += amount;
        for (sum, entry) in self.shape.iter_mut().zip(shape) {
            *sum += amount * entry;
        }
        for (sum, share) in self.albedo.iter_mut().zip(paint.albedo) {
            *sum += amount * f64::from(share);
        }
        self.gloss += amount * f64::from(paint.gloss);
    }

    /// Puts something before the rest that covers these shares of the faces across x, y and z.
    pub(super) fn cover(&mut self, shares: [f64; 3]) {
        for (depth, share) in self.depth.iter_mut().zip(shares) {
            *depth = (*depth + depth_of(share)).min(f64::from(MAX_DEPTH));
        }
    }

    /// The texel of a cell of a width.
    pub(super) fn texel(&self, width: f64) -> Texel {
        let share = if self.amount > 0.0 { self.amount.recip() } else { 0.0 };
        Texel {
            density: (self.amount / width.powi(3)) as f32,
            depth: self.depth.map(|depth| depth as f32),
            flakes: Sggx::from_entries(self.shape.map(|entry| (entry * share) as f32)).normalised(),
            albedo: self.albedo.map(|sum| (sum * share) as f32),
            gloss: (self.gloss * share) as f32,
        }
    }
}

/// The optical depth of something that covers a share of what is seen.
pub(super) fn depth_of(share: f64) -> f64 {
    (-(-share.clamp(0.0, 1.0)).ln_1p()).min(f64::from(MAX_DEPTH))
}

/// A cell inside of a solid: it stops all light and holds no surface. `shape` is S of the nearest one, normalised.
pub(super) fn opaque(shape: [f64; 6], paint: &Paint) -> Texel {
    Texel {
        density: 0.0,
        depth: [MAX_DEPTH; 3],
        flakes: Sggx::from_entries(shape.map(|entry| entry as f32)),
        albedo: paint.albedo,
        gloss: paint.gloss,
    }
}
