//! Things without a surface of their own: densities in space, in cells.
//!
//! A cell is sampled at n × n × n places. Its depth along an axis is that of the mean transmittance of its columns. Where the
//! density changes much, light meets something like a surface across the gradient: with ρ the density and L the length
//! over which a change counts as a surface, the share |∇ρ| L / ρ (1 at most) of the flakes lie across ∇ρ, and the rest face
//! all ways. (A choice of ours; the weight |∇ρ| of the normals is the area of the isosurfaces, by the coarea
//! formula.)

use super::cell::{Finish, Gathered, ISOTROPIC};
use super::{MAX_CELLS, Paint, SourceError};
use crate::{Builder, MAX_DEPTH, Texel};
use glam::DVec3;
use rayon::prelude::*;

/// Cells along the edge of a block, which may be empty as a whole.
const BLOCK: u32 = 16;

/// What is at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    /// Extinction over the length of the volume's edge.
    pub(super) density: f64,
    pub(super) paint: Paint,
}

/// A density in space, in coordinates of the volume.
pub(super) trait Medium: Sync {
    /// What a thread keeps between calls.
    type Memory: Default;

    /// What is at some points, in their order.
    fn samples(&self, memory: &mut Self::Memory, points: &[DVec3], samples: &mut Vec<Sample>);

    /// Whether there may be something in a cube.
    fn may_fill(&self, memory: &mut Self::Memory, low: DVec3, width: f64) -> bool;
}

/// How a medium is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Samples along the edge of a cell, 2 at least.
    pub(super) samples: usize,
    /// Over how many cells a change of the density counts as a surface.
    pub(super) surface: f64,
    pub(super) finish: Finish,
}

impl Look {
    /// Checks options that all media have.
    pub(super) fn new(samples: usize, surface: f64, roughness: f64) -> Result<Self, SourceError> {
        SourceError::check("surface", surface, surface >= 0.0, "a number of cells from 0 on")?;
        let good = (0.0..=1.0).contains(&roughness);
        SourceError::check("roughness", roughness, good, "a number from 0 to 1")?;
        Ok(Self { samples: samples.clamp(2, 4), surface, finish: Finish::surface(roughness) })
    }
}

/// Adds a medium to a volume.
pub(super) fn add_medium<M: Medium>(
    builder: &mut Builder,
    medium: &M,
    look: &Look,
) -> Result<(), SourceError> {
    let edge = builder.edge();
    let size = edge.min(BLOCK);
    let n = edge / size;
    let blocks: Vec<[u32; 3]> =
        (0..n.pow(3)).map(|i| [i % n, i / n % n, i / n / n].map(|c| c * size)).collect();
    // So many blocks at a time that the limit is noticed before there is much more.
    for some in blocks.chunks(1024) {
        let cells: Vec<_> = some
            .par_iter()
            .map_init(M::Memory::default, |memory, block| fill(medium, memory, look, (*block, size, edge)))
            .flatten_iter()
            .collect();
        builder.extend(cells);
        if builder.len() > MAX_CELLS {
            return Err(SourceError::TooMany { what: "the filled cells of a medium", most: MAX_CELLS });
        }
    }
    Ok(())
}

/// The filled cells of a block.
fn fill<M: Medium>(
    medium: &M,
    memory: &mut M::Memory,
    look: &Look,
    (block, size, edge): ([u32; 3], u32, u32),
) -> Vec<([u32; 3], Texel)> {
    let width = f64::from(edge).recip();
    let mut found = Vec::new();
    let corner = |cell: [u32; 3]| DVec3::from_array(cell.map(f64::from)) * width;
    if !medium.may_fill(memory, corner(block), f64::from(size) * width) {
        return found;
    }
    let n = look.samples;
    let step = width / n as f64;
    let places: Vec<DVec3> = (0..n.pow(3))
        .map(|i| (DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64) + 0.5) * step)
        .collect();
    let (mut points, mut samples) = (Vec::new(), Vec::new());
    for row in 0..size * size {
        let cells = (0..size).map(|x| [block[0] + x, block[1] + row % size, block[2] + row / size]);
        points.clear();
        samples.clear();
        points.extend(cells.clone().flat_map(|cell| places.iter().map(move |place| corner(cell) + *place)));
        medium.samples(memory, &points, &mut samples);
        let texels = cells.zip(samples.chunks(places.len()));
        found.extend(texels.filter_map(|(cell, samples)| Some((cell, texel(samples, look, width)?))));
    }
    found
}

/// The texel of a cell's samples.
fn texel(samples: &[Sample], look: &Look, width: f64) -> Option<Texel> {
    let n = look.samples;
    let total: f64 = samples.iter().map(|sample| sample.density).sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let mut gathered = Gathered::default();
    let volume = width.powi(3) / samples.len() as f64;
    let changes = changes(samples, n);
    let steepness: f64 = changes.iter().map(|change| change.length()).sum();
    // The mean of |∇ρ| over the mean of ρ, per cell.
    let relative = steepness / changes.len() as f64 * n as f64 / (total / samples.len() as f64);
    let share = (relative * look.surface).min(1.0);
    for sample in samples.iter().filter(|sample| sample.density > 0.0) {
        gathered.add((1.0 - share) * sample.density * volume, &ISOTROPIC, &sample.paint);
    }
    if share > 0.0 {
        let paint = mean_paint(samples, total);
        for change in changes.iter().filter(|change| **change != DVec3::ZERO) {
            let amount = share * total * volume * change.length() / steepness;
            gathered.add(amount, &look.finish.around(change.normalize()), &paint);
        }
    }
    gathered.depth = depths(samples, n, width / n as f64);
    Some(gathered.texel(width))
}

/// By how much the density changes from one sample to the next, along each axis, in each cube of 2 × 2 × 2 samples.
fn changes(samples: &[Sample], n: usize) -> Vec<DVec3> {
    let at = |x: usize, y: usize, z: usize| samples[x + n * (y + n * z)].density;
    let m = n - 1;
    let cubes = (0..m.pow(3)).map(|i| [i % m, i / m % m, i / m / m]);
    cubes
        .map(|[x, y, z]| {
            let mut change = DVec3::ZERO;
            for corner in 0..8 {
                let [i, j, k] = [corner & 1, corner >> 1 & 1, corner >> 2];
                let sign = |bit: usize| if bit == 1 { 0.25 } else { -0.25 };
                change += DVec3::new(sign(i), sign(j), sign(k)) * at(x + i, y + j, z + k);
            }
            change
        })
        .collect()
}

fn mean_paint(samples: &[Sample], total: f64) -> Paint {
    let mean = |value: &dyn Fn(&Paint) -> f32| {
        (samples.iter().map(|s| s.density * f64::from(value(&s.paint))).sum::<f64>() / total) as f32
    };
    Paint {
        albedo: [mean(&|p| p.albedo[0]), mean(&|p| p.albedo[1]), mean(&|p| p.albedo[2])],
        gloss: mean(&|p| p.gloss),
    }
}

/// −ln of the mean transmittance of the columns along each axis.
fn depths(samples: &[Sample], n: usize, step: f64) -> [f64; 3] {
    let strides = [1, n, n * n];
    [0, 1, 2].map(|axis| {
        let (u, v) = (strides[(axis + 1) % 3], strides[(axis + 2) % 3]);
        let column = |i: usize| {
            let start = i % n * u + i / n * v;
            let depth: f64 = (0..n).map(|k| samples[start + k * strides[axis]].density * step).sum();
            (-depth).exp()
        };
        let mean = (0..n * n).map(column).sum::<f64>() / (n * n) as f64;
        (-mean.ln()).clamp(0.0, f64::from(MAX_DEPTH))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(density: f64) -> Sample {
        Sample { density, paint: Paint::default() }
    }

    #[test]
    fn an_even_medium_is_isotropic() {
        let look = Look::new(2, 4.0, 0.0).unwrap();
        let texel = texel(&[sample(3.0); 8], &look, 0.25).unwrap();
        assert_eq!(texel.flakes, crate::Sggx::ISOTROPIC);
        assert!((texel.density - 3.0).abs() < 1e-6);
        assert!(texel.depth.iter().all(|depth| (depth - 0.75).abs() < 1e-6), "{texel:?}");
    }

    #[test]
    fn a_step_is_a_surface() {
        let look = Look::new(4, 4.0, 0.0).unwrap();
        // Full for y < ½.
        let samples: Vec<Sample> = (0..64).map(|i| sample(if i / 4 % 4 < 2 { 1e4 } else { 0.0 })).collect();
        let texel = texel(&samples, &look, 0.25).unwrap();
        assert!((texel.flakes.yy - 4.0).abs() < 1e-4, "{texel:?}");
        assert_eq!(texel.depth[1], MAX_DEPTH);
        assert!((texel.depth[0] - 2f32.ln()).abs() < 1e-5 && texel.depth[2] == texel.depth[0], "{texel:?}");
    }
}
