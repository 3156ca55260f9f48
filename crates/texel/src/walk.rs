//! Rays through a volume: the exact segments that lie in filled cells, front to back.
//!
//! The cell after a cell is found from whole numbers, never from places: rounding moves the ends of segments by some
//! 10⁻¹⁵ of the edge, but no cell of any width is skipped or met twice, and every walk ends. From cell to cell the octree is
//! climbed to the smallest common cell and descended again (two steps on average), not searched from its top. Empty and evenly
//! filled cells are crossed at once, however great.
//!
//! How fine a level is looked at may change along the ray: by the footprint of a pixel ([`Footprint`]), as in the paper
//! of 1995 (F. Neyret, Graphics Interface 1995), but with two levels blended. A whole number asks for one level alone, as in
//! the paper.

use crate::pack::Packed;
use crate::{Texel, Volume};
use glam::DVec3;

/// Optical depths beyond this are as good as opaque: e⁻²⁰ = 2·10⁻⁹ of the light passes.
const OPAQUE: f64 = crate::MAX_DEPTH as f64;

/// How often a ray comes round in a cyclic volume before it ends.
const MOST_ROUNDS: u32 = 4096;

/// A ray, in units of the volume's edge: the volume is the unit cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t is 0.
    pub origin: DVec3,
    /// The way per unit of t, of any length. Optical depths are those of the way through the unit cube.
    pub direction: DVec3,
}

impl Ray {
    /// The place at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// From where to where the ray is in the unit cube.
    pub fn span(&self) -> Option<(f64, f64)> {
        let within = |(near, far): (f64, f64), axis: usize| {
            let (o, d) = (self.origin[axis], self.direction[axis]);
            if d == 0.0 {
                return if (0.0..=1.0).contains(&o) { (near, far) } else { (f64::INFINITY, far) };
            }
            let (a, b) = (-o / d, (1.0 - o) / d);
            (near.max(a.min(b)), far.min(a.max(b)))
        };
        let (near, far) = (0..3).fold((f64::NEG_INFINITY, f64::INFINITY), within);
        (near <= far).then_some((near, far))
    }
}

/// The width of what a ray stands for: w(t) = `width` + `spread` · |t|, in units of the volume's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// At t = 0, ≥ 0.
    pub width: f64,
    /// Growth per unit of t, ≥ 0.
    pub spread: f64,
}

impl Footprint {
    /// The level of a volume with cells as wide as the footprint at `t`, with a fraction: log₂ of the width in cells, ≥ 0.
    pub fn level(&self, volume: &Volume, t: f64) -> f32 {
        let cells = (self.width + self.spread * t.abs()) / volume.cell_width(0);
        cells.log2().max(0.0) as f32
    }
}

/// What fills a segment, at one level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layer {
    /// The content of its cell.
    pub texel: Texel,
    /// The width of the cell that the texel's depths are for.
    pub width: f64,
    /// How much the level counts, 0 to 1.
    pub share: f64,
}

impl Layer {
    /// The extinction along `direction`, per unit of t, with its share.
    pub fn extinction(&self, direction: DVec3) -> f64 {
        self.share * self.texel.extinction(direction, self.width)
    }
}

/// A piece of a ray in which nothing changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it begins along the ray.
    pub from: f64,
    /// Where it ends, after `from`.
    pub to: f64,
    layers: [Layer; 2],
    count: usize,
}

impl Segment {
    /// The levels that are blended: one or two.
    pub fn layers(&self) -> &[Layer] {
        &self.layers[..self.count]
    }

    /// The extinction along the ray, per unit of t: that of the levels, by their shares.
    pub fn extinction(&self, ray: &Ray) -> f64 {
        self.layers().iter().map(|layer| layer.extinction(ray.direction)).sum()
    }

    /// The optical depth from end to end.
    pub fn depth(&self, ray: &Ray) -> f64 {
        self.extinction(ray) * (self.to - self.from)
    }
}

impl Volume {
    /// The segments of `ray` in filled cells from `span.0` to `span.1`, front to back. `level` is the level that is looked at,
    /// by t; a fraction blends two levels. It is asked once for each cell, where the ray enters it.
    ///
    /// Along cyclic axes the volume goes on beyond the unit cube, some thousand times at most.
    pub fn segments<F: Fn(f64) -> f32>(&self, ray: &Ray, span: (f64, f64), level: F) -> Segments<'_, F> {
        Segments { walk: Walk::new(self, ray, span), level }
    }

    /// The optical depth of `ray` from `span.0` to `span.1`: −ln of what passes. It is no longer added up where it has
    /// passed 20.
    pub fn depth_along<F: Fn(f64) -> f32>(&self, ray: &Ray, span: (f64, f64), level: F) -> f64 {
        let mut walk = Walk::new(self, ray, span);
        let mut depth = 0.0;
        while let Some(from) = walk.here() {
            let extinction = walk.extinction(level(from), ray.direction);
            let to = walk.cross();
            if extinction > 0.0 && to > from {
                depth += extinction * (to - from);
                if depth > OPAQUE {
                    break;
                }
            }
        }
        depth
    }

    /// The share of light that passes from one place to another, by the cells of one level, or of two if `level` has a
    /// fraction.
    pub fn transmittance(&self, from: DVec3, to: DVec3, level: f32) -> f64 {
        let ray = Ray { origin: from, direction: to - from };
        (-self.depth_along(&ray, (0.0, 1.0), |_| level)).exp()
    }
}

/// The segments of a ray: see [`Volume::segments`].
#[derive(Clone, Debug)]
pub struct Segments<'v, F> {
    walk: Walk<'v>,
    level: F,
}

impl<F: Fn(f64) -> f32> Iterator for Segments<'_, F> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        while let Some(from) = self.walk.here() {
            let (layers, count) = self.walk.look((self.level)(from));
            let to = self.walk.cross();
            if count > 0 && to > from {
                return Some(Segment { from, to, layers, count });
            }
        }
        None
    }
}

/// A place in a volume, on its way along a ray. Lengths are in cells of the finest level.
#[derive(Clone, Debug)]
struct Walk<'v> {
    cursor: Cursor<'v>,
    origin: DVec3,
    direction: DVec3,
    /// 1 / `direction`, of each component.
    pace: DVec3,
    t: f64,
    end: f64,
    /// The finest cell, and the level of the greatest cell around it in which nothing changes.
    cell: [u32; 3],
    level: u32,
    rounds: u32,
}

impl<'v> Walk<'v> {
    fn new(volume: &'v Volume, ray: &Ray, span: (f64, f64)) -> Self {
        let edge = f64::from(volume.edge());
        let (origin, direction) = (ray.origin * edge, ray.direction * edge);
        let mut walk = Self {
            cursor: Cursor::new(volume),
            origin,
            direction,
            pace: direction.recip(),
            t: span.0,
            end: span.1,
            cell: [0; 3],
            level: 0,
            rounds: 0,
        };
        let is_ray = origin.is_finite() && direction.is_finite() && direction != DVec3::ZERO;
        // Also where the span is not a number.
        let is_span = span.0 < span.1;
        if !is_ray || !is_span || is_empty(volume) {
            walk.end = f64::NEG_INFINITY;
            return walk;
        }
        walk.enter(edge, volume.cyclic());
        walk
    }

    /// Goes to where the ray enters the volume.
    fn enter(&mut self, edge: f64, cyclic: [bool; 3]) {
        for axis in (0..3).filter(|axis| !cyclic[*axis]) {
            let (o, d) = (self.origin[axis], self.direction[axis]);
            if d == 0.0 {
                if !(0.0..=edge).contains(&o) {
                    self.end = f64::NEG_INFINITY;
                }
                continue;
            }
            let (a, b) = (-o / d, (edge - o) / d);
            self.t = self.t.max(a.min(b));
            self.end = self.end.min(a.max(b));
        }
        if !(self.t < self.end && self.t.is_finite()) {
            self.end = f64::NEG_INFINITY;
            return;
        }
        for (axis, cyclic) in cyclic.into_iter().enumerate() {
            let mut place = self.origin[axis] + self.t * self.direction[axis];
            if cyclic {
                let round = (place / edge).floor() * edge;
                self.origin[axis] -= round;
                place -= round;
            }
            // Negative places become 0.
            self.cell[axis] = (place as u32).min(edge as u32 - 1);
        }
    }

    /// Where the ray is, if it has not left.
    fn here(&self) -> Option<f64> {
        (self.t < self.end).then_some(self.t)
    }

    /// What there is, at a level.
    fn look(&mut self, level: f32) -> ([Layer; 2], usize) {
        let places = self.places(level);
        let mut layers = [Layer::default(); 2];
        let mut count = 0;
        for place in places.into_iter().flatten() {
            layers[count] = self.cursor.layer(place);
            count += 1;
        }
        (layers, count)
    }

    /// The extinction of what there is at a level along a direction, per unit of t.
    fn extinction(&mut self, level: f32, direction: DVec3) -> f64 {
        let places = self.places(level);
        places.into_iter().flatten().map(|place| self.cursor.extinction(place, direction)).sum()
    }

    /// The stored cells that say what there is at a level: one or two, or none where it is empty.
    fn places(&mut self, level: f32) -> [Option<Place>; 2] {
        let top = self.cursor.volume.levels() - 1;
        let level = level.max(0.0).min(top as f32);
        let (fine, blend) = (level as u32, f64::from(level - level.floor()));
        let found = self.cursor.seek(self.cell, fine);
        self.level = found.level;
        // Where nothing changes in a greater cell, both levels are the same.
        let differ = blend > 0.0 && found.level == fine;
        let share = if differ { 1.0 - blend } else { 1.0 };
        let coarse = || Place { level: fine + 1, index: self.cursor.path[fine as usize + 1], share: blend };
        [found.index.map(|index| Place { level: found.level, index, share }), differ.then(coarse)]
    }

    /// Goes on to the next cell; where the ray leaves this one.
    fn cross(&mut self) -> f64 {
        let size = 1u32 << self.level;
        let low = self.cell.map(|c| c & !(size - 1));
        let mut exit = (f64::INFINITY, 0);
        for (axis, low) in low.into_iter().enumerate() {
            let d = self.direction[axis];
            if d != 0.0 {
                let face = if d > 0.0 { low + size } else { low };
                let t = (f64::from(face) - self.origin[axis]) * self.pace[axis];
                if t < exit.0 {
                    exit = (t, axis);
                }
            }
        }
        let (t, through) = exit;
        let t = t.max(self.t);
        for axis in (0..3).filter(|axis| *axis != through) {
            let place = self.origin[axis] + t * self.direction[axis];
            self.cell[axis] = (place as u32).clamp(low[axis], low[axis] + size - 1);
        }
        let leaves = t.min(self.end);
        self.t = t;
        self.step(through, low[through], size);
        leaves
    }

    /// Steps from the cell at `low` through a face; to the other side of a cyclic volume, out of others.
    fn step(&mut self, axis: usize, low: u32, size: u32) {
        let edge = self.cursor.volume.edge();
        let forward = self.direction[axis] > 0.0;
        if forward && low + size < edge {
            self.cell[axis] = low + size;
        } else if !forward && low > 0 {
            self.cell[axis] = low - 1;
        } else if self.cursor.volume.cyclic()[axis] && self.rounds < MOST_ROUNDS {
            self.rounds += 1;
            self.cell[axis] = if forward { 0 } else { edge - 1 };
            self.origin[axis] -= f64::from(edge).copysign(self.direction[axis]);
        } else {
            self.end = f64::NEG_INFINITY;
        }
    }
}

fn is_empty(volume: &Volume) -> bool {
    volume.stored(volume.levels() - 1) == 0
}

/// The way from the top of an octree to a cell.
#[derive(Clone, Debug)]
struct Cursor<'v> {
    volume: &'v Volume,
    cell: [u32; 3],
    /// The stored cells on the way, by level, from `lowest` on.
    path: [u32; 16],
    lowest: u32,
}

/// A stored cell that is looked at.
#[derive(Clone, Copy)]
struct Place {
    level: u32,
    index: u32,
    /// How much its level counts, 0 to 1.
    share: f64,
}

/// What a cursor came upon.
struct Region {
    /// The level of the cell in which nothing changes.
    level: u32,
    /// Where it is stored, if it is not empty.
    index: Option<u32>,
}

impl<'v> Cursor<'v> {
    fn new(volume: &'v Volume) -> Self {
        Self { volume, cell: [0; 3], path: [0; 16], lowest: volume.levels() - 1 }
    }

    /// Goes to the cell of `level` around a cell of the finest, or to a greater one in which nothing changes.
    fn seek(&mut self, cell: [u32; 3], level: u32) -> Region {
        let differing = (0..3).fold(0, |bits, axis| bits | cell[axis] ^ self.cell[axis]);
        let common = u32::BITS - differing.leading_zeros();
        let mut at = common.max(self.lowest).max(level);
        let mut index = self.path[at as usize];
        self.cell = cell;
        while at > level {
            let here = &self.volume.levels[at as usize];
            let parts = here.parts[index as usize];
            if parts == 0 {
                break;
            }
            let octant = (0..3).fold(0, |bits, axis| bits | (cell[axis] >> (at - 1) & 1) << axis);
            if parts >> octant & 1 == 0 {
                self.lowest = at;
                return Region { level: at - 1, index: None };
            }
            let before = parts & ((1u32 << octant) - 1) as u8;
            index = here.first[index as usize] + before.count_ones();
            at -= 1;
            self.path[at as usize] = index;
        }
        self.lowest = at;
        Region { level: at, index: Some(index) }
    }

    fn layer(&self, place: Place) -> Layer {
        let (packed, width) = self.content(place);
        Layer { texel: packed.texel(), width, share: place.share }
    }

    fn extinction(&self, place: Place, direction: DVec3) -> f64 {
        let (packed, width) = self.content(place);
        place.share * packed.extinction(direction, width)
    }

    /// What is stored in a place, and the width of the cell that its depths are for.
    fn content(&self, Place { level, index, .. }: Place) -> (Packed, f64) {
        let stored = &self.volume.levels[level as usize];
        // An evenly filled cell holds what fills the finest ones.
        let even = level > 0 && stored.parts[index as usize] == 0;
        (stored.texels[index as usize], self.volume.cell_width(if even { 0 } else { level }))
    }
}
