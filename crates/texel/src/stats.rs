//! What a volume takes, and how far its coarser levels are from its finest.

use crate::{Ray, Volume};
use glam::DVec3;
use rayon::prelude::*;

/// The size of a volume; see [`Volume::size`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Cells of the finest level that are filled.
    pub filled: u64,
    /// Cells of the finest level.
    pub cells: u64,
    /// Bytes of the volume's file, with all levels.
    pub stored_bytes: u64,
    /// Bytes of all cells of the finest level alone, at 16 bytes.
    pub dense_bytes: u64,
}

impl Size {
    /// 1 − stored / dense bytes: 0.9 means a tenth is stored. Below 0 for a volume that is full.
    pub fn compression(&self) -> f64 {
        1.0 - self.stored_bytes as f64 / self.dense_bytes as f64
    }
}

/// How a level compares with the finest level, box-filtered to its size; see [`Volume::compare`] and
/// [`Volume::compare_in_sun`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fidelity {
    /// The level, from 1.
    pub level: u32,
    /// Root mean square difference of opacities, 0 to 1.
    pub rmse: f64,
    /// Mean opacity of the level minus that of the finest level: below 0 where matter thins out.
    pub drift: f64,
    /// The standard deviation of the level's shadow over that of the finest level, box-filtered: 1 is right, less is
    /// haze. Nothing if the shadow is the same everywhere.
    pub contrast: Option<f64>,
}

impl Volume {
    /// What the volume takes.
    pub fn size(&self) -> Size {
        let mut filled = 0;
        for (level, content) in self.levels.iter().enumerate() {
            let whole = content.texels.len() - content.parts.iter().filter(|parts| **parts != 0).count();
            filled += (whole as u64) << (3 * level);
        }
        let cells = u64::from(self.edge()).pow(3);
        Size { filled, cells, stored_bytes: self.file_bytes(), dense_bytes: 16 * cells }
    }

    /// Every level from 1 beside the finest one, by the shadows that parallel light along x, y and z throws: pictures of
    /// opacity with a pixel for every column of cells. The finest level's picture is box-filtered to the size of
    /// the other.
    pub fn compare(&self) -> Vec<Fidelity> {
        let finest = Shadows::new(self, 0);
        let mut expected = finest.clone();
        (1..self.levels())
            .map(|level| {
                expected = expected.halved();
                Shadows::new(self, level).fidelity(level, &expected, finest.mean())
            })
            .collect()
    }

    /// The same by the shadow that parallel light from the direction `to_sun` throws on a plane across it: a picture of the square
    /// around the cube, as wide as its diagonal, with as many rays along a side as the finest level has cells, at most 256.
    /// Those of coarser levels have the same rays, and both pictures are box-filtered to the size of the level.
    ///
    /// Nothing if the direction is 0 or not finite.
    pub fn compare_in_sun(&self, to_sun: DVec3) -> Vec<Fidelity> {
        let Some(w) = to_sun.try_normalize() else { return Vec::new() };
        let finest = Shadows::in_sun(self, 0, w);
        let halved = |shadow: &Shadows, level: u32| {
            (0..level).fold(shadow.clone(), |s, _| if s.side > 1 { s.halved() } else { s })
        };
        let row = |level| {
            let found = halved(&Shadows::in_sun(self, level, w), level);
            found.fidelity(level, &halved(&finest, level), finest.mean())
        };
        (1..self.levels()).map(row).collect()
    }
}

/// The most rays along a side of the picture of a shadow.
const MOST_RAYS: u32 = 256;

/// Pictures of opacity along x, y and z, one after the other, or one along another direction.
#[derive(Clone, Debug)]
struct Shadows {
    side: usize,
    opacity: Vec<f64>,
}

impl Shadows {
    fn new(volume: &Volume, level: u32) -> Self {
        let side = (volume.edge() >> level) as usize;
        let mut depths = vec![0.0f64; 3 * side * side];
        volume.for_each(level, |cell, texel| {
            let [x, y, z] = cell.map(|c| c as usize);
            for (axis, pixel) in [y + side * z, x + side * z, x + side * y].into_iter().enumerate() {
                depths[axis * side * side + pixel] += f64::from(texel.depth[axis]);
            }
        });
        Self { side, opacity: depths.iter().map(|depth| -(-depth).exp_m1()).collect() }
    }

    fn in_sun(volume: &Volume, level: u32, w: DVec3) -> Self {
        let side = volume.edge().min(MOST_RAYS) as usize;
        let (u, v) = w.any_orthonormal_pair();
        let place = |i: usize| 3f64.sqrt() * ((i as f64 + 0.5) / side as f64 - 0.5);
        let pixel = |i: usize| {
            let ray = Ray { origin: 0.5 + u * place(i % side) + v * place(i / side), direction: w };
            // Cyclic volumes go on beyond the cube.
            let depth = ray.span().map_or(0.0, |span| volume.depth_along(&ray, span, |_| level as f32));
            -(-depth).exp_m1()
        };
        Self { side, opacity: (0..side * side).into_par_iter().map(pixel).collect() }
    }

    /// Means of 2 × 2 pixels.
    fn halved(&self) -> Self {
        let side = self.side / 2;
        let pixel = |index: usize| {
            let (picture, row, column) = (index / (side * side), index / side % side, index % side);
            let at = picture * self.side * self.side + 2 * row * self.side + 2 * column;
            0.25 * (self.opacity[at] + self.opacity[at + 1])
                + 0.25 * (self.opacity[at + self.side] + self.opacity[at + self.side + 1])
        };
        Self { side, opacity: (0..self.opacity.len() / 4).map(pixel).collect() }
    }

    fn mean(&self) -> f64 {
        self.opacity.iter().sum::<f64>() / self.opacity.len() as f64
    }

    /// The standard deviation over each picture, in the mean.
    fn contrast(&self) -> f64 {
        let deviation = |picture: &[f64]| {
            let mean = picture.iter().sum::<f64>() / picture.len() as f64;
            let squares: f64 = picture.iter().map(|value| (value - mean).powi(2)).sum();
            (squares / picture.len() as f64).sqrt()
        };
        let pictures = self.opacity.chunks_exact(self.side * self.side);
        let count = pictures.len() as f64;
        pictures.map(deviation).sum::<f64>() / count
    }

    fn fidelity(&self, level: u32, expected: &Self, mean: f64) -> Fidelity {
        let squares = self.opacity.iter().zip(&expected.opacity).map(|(a, b)| (a - b).powi(2));
        let rmse = (squares.sum::<f64>() / self.opacity.len() as f64).sqrt();
        let right = expected.contrast();
        let contrast = (right > 1e-9).then(|| self.contrast() / right);
        Fidelity { level, rmse, drift: self.mean() - mean, contrast }
    }
}
