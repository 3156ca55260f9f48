//! Rods and balls in cells: what strands and particles are made of.
//!
//! A rod that is thinner than a cell is a length of thread in each cell on its way: the amount is π/4 · width · length. A ball
//! that is smaller than a cell is an amount in the cell of its centre. What is as wide as a cell or wider is a body:
//! all that come near a cell are one solid there, the distance to which is cut in parts as a field's value is. Flakes of
//! bodies are surfaces, of threads fibres, of small balls isotropic.

use super::cell::{Finish, Gathered, ISOTROPIC, opaque};
use super::mask::{Mask, PARTS};
use super::slice::slice_area;
use super::{MAX_CELLS, Paint, SourceError};
use crate::{Builder, Texel};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Half of a unit cell's diagonal, and a little more.
const HALF_DIAGONAL: f64 = 0.87;

/// A rod with round ends, in coordinates of the volume; a ball if both ends are the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    pub(super) ends: [DVec3; 2],
    pub(super) radii: [f64; 2],
    pub(super) paint: Paint,
}

/// How flakes spread around the normals of rods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finishes {
    surface: Finish,
    fibre: Finish,
}

impl Finishes {
    pub(super) fn new(roughness: f64) -> Result<Self, SourceError> {
        let good = (0.0..=1.0).contains(&roughness);
        SourceError::check("roughness", roughness, good, "a number from 0 to 1")?;
        Ok(Self { surface: Finish::surface(roughness), fibre: Finish::fibre(roughness) })
    }
}

/// Adds rods to a volume.
pub(super) fn add_rods(builder: &mut Builder, rods: &[Rod], finishes: &Finishes) -> Result<(), SourceError> {
    let grid = Grid { edge: builder.edge(), width: f64::from(builder.edge()).recip() };
    let too_many =
        SourceError::TooMany { what: "the cells that strands or particles touch", most: MAX_CELLS };
    let pieces = rods.iter().map(|rod| grid.piece_count(rod)).sum::<f64>();
    if pieces > MAX_CELLS as f64 {
        return Err(too_many);
    }
    let pieces: Vec<Rod> = rods.par_iter().flat_map_iter(|rod| grid.pieces(rod)).collect();
    let counts = pieces.par_iter().map(|rod| grid.count(rod)).sum::<u64>();
    if counts > MAX_CELLS as u64 {
        return Err(too_many);
    }
    let mut entries: Vec<([u32; 3], u32)> = pieces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, rod)| grid.cells(rod).map(move |cell| (cell, number as u32)))
        .collect();
    entries.par_sort_unstable();
    let texels = entries.par_chunk_by(|a, b| a.0 == b.0).filter_map(|entries| {
        let rods: Vec<&Rod> = entries.iter().map(|(_, number)| &pieces[*number as usize]).collect();
        let cell = entries[0].0;
        grid.texel(cell, &rods, finishes).map(|texel| (cell, texel))
    });
    builder.extend(texels);
    Ok(())
}

impl Rod {
    fn radius(&self) -> f64 {
        self.radii[0].max(self.radii[1])
    }

    fn is_ball(&self) -> bool {
        self.ends[0] == self.ends[1]
    }

    /// The distance from the surface, negative inside, and its gradient; exact for equal radii.
    fn distance(&self, p: DVec3) -> (f64, DVec3) {
        let [a, b] = self.ends;
        let axis = b - a;
        let square = axis.length_squared();
        let t = if square > 0.0 { ((p - a).dot(axis) / square).clamp(0.0, 1.0) } else { 0.0 };
        let away = p - (a + axis * t);
        let distance = away.length();
        let widening = self.radii[1] - self.radii[0];
        let slope = if t > 0.0 && t < 1.0 { axis * (widening / square) } else { DVec3::ZERO };
        (distance - (self.radii[0] + t * widening), away / distance.max(f64::MIN_POSITIVE) - slope)
    }

    /// The part of the axis inside a cube, as shares of the way from one end to the other.
    fn clipped(&self, low: DVec3, width: f64) -> Option<[f64; 2]> {
        let [a, b] = self.ends;
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for axis in 0..3 {
            let (start, way) = (a[axis] - low[axis], b[axis] - a[axis]);
            if way == 0.0 {
                if !(0.0..width).contains(&start) {
                    return None;
                }
                continue;
            }
            let (enter, leave) = (-start / way, (width - start) / way);
            from = from.max(enter.min(leave));
            to = to.min(enter.max(leave));
        }
        (from < to).then_some([from, to])
    }
}

/// The cells of the finest level.
struct Grid {
    edge: u32,
    width: f64,
}

impl Grid {
    /// Whether something is too small to be seen as a body.
    fn is_thin(&self, rod: &Rod) -> bool {
        2.0 * rod.radius() < self.width
    }

    /// Rods are cut in pieces, so that the box around each holds few cells beside.
    fn piece_count(&self, rod: &Rod) -> f64 {
        let length = rod.ends[0].distance(rod.ends[1]);
        (length / (4.0 * self.width.max(rod.radius()))).ceil().max(1.0)
    }

    fn pieces(&self, rod: &Rod) -> impl Iterator<Item = Rod> {
        let count = self.piece_count(rod);
        let rod = *rod;
        let [a, b] = rod.ends;
        let end = move |t: f64| (a.lerp(b, t), rod.radii[0] + t * (rod.radii[1] - rod.radii[0]));
        (0..count as u32).map(move |i| {
            let (from, to) = (end(f64::from(i) / count), end(f64::from(i + 1) / count));
            Rod { ends: [from.0, to.0], radii: [from.1, to.1], ..rod }
        })
    }

    /// The box of cells around a rod: first cell and counts.
    fn range(&self, rod: &Rod) -> ([u32; 3], [u32; 3]) {
        let reach = if self.is_thin(rod) { 0.0 } else { rod.radius() };
        let [a, b] = rod.ends;
        let cell = |x: f64| (x / self.width).floor();
        let low = (a.min(b) - reach).to_array().map(|x| cell(x).max(0.0));
        let high = (a.max(b) + reach).to_array().map(|x| cell(x).min(f64::from(self.edge) - 1.0));
        let first = low.map(|c| c as u32);
        (first, [0, 1, 2].map(|i| (high[i] - low[i] + 1.0).max(0.0) as u32))
    }

    fn count(&self, rod: &Rod) -> u64 {
        self.range(rod).1.iter().map(|n| u64::from(*n)).product()
    }

    /// The cells that a rod may be in.
    fn cells(&self, rod: &Rod) -> impl Iterator<Item = [u32; 3]> {
        let (first, [nx, ny, nz]) = self.range(rod);
        let all = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let (rod, is_thin, width) = (*rod, self.is_thin(rod), self.width);
        all.map(move |at| [0, 1, 2].map(|i| first[i] + at[i])).filter(move |cell| {
            let low = DVec3::from_array(cell.map(f64::from)) * width;
            if is_thin {
                rod.is_ball() || rod.clipped(low, width).is_some()
            } else {
                rod.distance(low + 0.5 * width).0 < HALF_DIAGONAL * width
            }
        })
    }

    fn texel(&self, cell: [u32; 3], rods: &[&Rod], finishes: &Finishes) -> Option<Texel> {
        let mut gathered = Gathered::default();
        let low = DVec3::from_array(cell.map(f64::from)) * self.width;
        let (thin, thick): (Vec<&Rod>, Vec<&Rod>) = rods.iter().partition(|rod| self.is_thin(rod));
        for rod in thin {
            self.add_thin(&mut gathered, rod, low, &finishes.fibre);
        }
        if let Some(inner) = self.add_thick(&mut gathered, &thick, low, &finishes.surface) {
            return Some(inner);
        }
        let is_seen = gathered.amount > 0.0 || gathered.depth.iter().any(|depth| *depth > 0.0);
        is_seen.then(|| gathered.texel(self.width))
    }

    /// Adds a thread or a small ball.
    fn add_thin(&self, gathered: &mut Gathered, rod: &Rod, low: DVec3, fibre: &Finish) {
        let face = self.width * self.width;
        if rod.is_ball() {
            let disc = PI * rod.radius().powi(2);
            gathered.add(disc, &ISOTROPIC, &rod.paint);
            gathered.cover([disc / face; 3]);
        } else if let Some([from, to]) = rod.clipped(low, self.width) {
            let axis = rod.ends[1] - rod.ends[0];
            let radius = rod.radii[0] + 0.5 * (from + to) * (rod.radii[1] - rod.radii[0]);
            let (length, tangent) = (axis.length() * (to - from), axis.normalize_or_zero());
            gathered.add(FRAC_PI_2 * radius * length, &fibre.around(tangent), &rod.paint);
            let shadow = 2.0 * radius * length / face;
            gathered.cover(DVec3::AXES.map(|axis| shadow * tangent.cross(axis).length()));
        }
    }

    /// Adds bodies; makes the whole cell if it lies inside of them.
    fn add_thick(
        &self,
        gathered: &mut Gathered,
        rods: &[&Rod],
        low: DVec3,
        surface: &Finish,
    ) -> Option<Texel> {
        let nearest = |p: DVec3| {
            let distances = rods.iter().map(|rod| (*rod, rod.distance(p)));
            distances.min_by(|a, b| a.1.0.total_cmp(&b.1.0))
        };
        let (rod, (value, slope)) = nearest(low + 0.5 * self.width)?;
        let inner = || opaque(slope.try_normalize().map_or(ISOTROPIC, |n| surface.around(n)), &rod.paint);
        if value < -HALF_DIAGONAL * self.width {
            return Some(inner());
        }
        let part = self.width / PARTS as f64;
        let mut mask = Mask::default();
        let mut surfaces = 0.0;
        for i in 0..PARTS.pow(3) {
            let place = [i % PARTS, i / PARTS % PARTS, i / PARTS / PARTS];
            let centre = low + (DVec3::from_array(place.map(|c| c as f64)) + 0.5) * part;
            let (rod, (value, slope)) = nearest(centre)?;
            mask.fill_below(place, value, slope * part);
            let steepness = slope.length();
            if steepness > 0.0 {
                let normal = slope / steepness;
                let area = slice_area(normal, -value / (steepness * part)) * part * part;
                gathered.add(0.25 * area, &surface.around(normal), &rod.paint);
                surfaces += area;
            }
        }
        if surfaces == 0.0 && mask.is_full() {
            return Some(inner());
        }
        gathered.cover(mask.cover());
        None
    }
}
