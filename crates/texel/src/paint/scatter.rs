//! Many shapes by chance.

use super::piece::Frame;
use super::shape::axes;
use super::{Material, Shape, Solid};
use crate::chance::{hash, normal, unit};
use glam::DVec3;

/// The greatest number of shapes of one scatter.
pub const MAX_SHAPES: u32 = 100_000;

/// A region is divided into no more parts than these.
const MAX_PARTS: u64 = 1 << 20;

/// Copies of a shape, spread over a box, a rectangle, or what is round in it.
///
/// The region is divided evenly, by at least as many parts as there are copies, and each copy gets a part of
/// its own. All that chance decides comes from the seed and the number of the copy.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// What is copied; its own place is left out.
    pub shape: Shape,
    /// How many, at most [`MAX_SHAPES`].
    pub count: u32,
    /// What chance starts from.
    pub seed: u64,
    /// Two corners of where copies stand. Axes along which both are the same are not divided.
    pub region: [DVec3; 2],
    /// Whether copies stand in the ellipsoid, or ellipse, inside the region alone.
    pub round: bool,
    /// How often the region is divided along x, y and z; if nothing is said, as often along each axis as the count needs.
    pub grid: Option<[u32; 3]>,
    /// How far from the middle of its part a copy may stand: 0 a grid, 1 anywhere in the part.
    pub jitter: f64,
    /// Added to the direction up, (0, 0, 1), in which copies grow: they are combed that way. If it is not 0, they bend that
    /// way too, or else any way.
    pub comb: DVec3,
    /// How much of the way from the middle of the region, 1 at its faces, is added to the direction in which copies grow.
    pub outward: f64,
    /// Where nothing combs them, copies are turned about the direction up, from the x of the shape, by chance: by at most
    /// this share of a whole turn.
    pub spin: f64,
    /// How far directions stray, radians (standard deviation).
    pub lean: f64,
    /// How far curls stray from that of the shape, radians (standard deviation).
    pub curl: f64,
    /// The smallest and the greatest scale.
    pub size: [f64; 2],
    /// How much lighter or darker copies are, relative (standard deviation).
    pub tint: f64,
}

impl Scatter {
    /// All copies, in a fixed order.
    pub fn solids(&self) -> impl Iterator<Item = Solid> {
        let copies = 0..u64::from(self.count.min(MAX_SHAPES));
        copies.zip(self.places()).map(|(copy, at)| self.copy(copy, at))
    }

    /// The parts of the region in an order by chance, each as the place of a copy.
    fn places(&self) -> Vec<DVec3> {
        let count = self.count.min(MAX_SHAPES) as usize;
        if let Some(grid) = self.grid {
            return self.places_of(grid);
        }
        let span = (self.region[1] - self.region[0]).to_array();
        let wide = span.map(|length| length != 0.0);
        let dimensions = wide.iter().filter(|is_wide| **is_wide).count().max(1) as u32;
        let mut side = (1u32..).find(|side| (*side as usize).pow(dimensions) >= count).unwrap_or(1);
        loop {
            let places = self.places_of(wide.map(|is_wide| if is_wide { side } else { 1 }));
            // What is round leaves a part of the box empty, the less of it the finer the parts are.
            if places.len() >= count || side as usize > count + 4 {
                return places;
            }
            side += 1 + side / 16;
        }
    }

    /// The places in the parts of a grid.
    fn places_of(&self, grid: [u32; 3]) -> Vec<DVec3> {
        let [low, high] = self.region;
        let grid = grid.map(|parts| u64::from(parts.max(1)));
        let count = grid.iter().fold(1, |product: u64, parts| product.saturating_mul(*parts));
        let mut parts: Vec<u64> = (0..count.min(MAX_PARTS)).collect();
        parts.sort_by_key(|part| hash(self.seed, &[0, *part]));
        let place = |part: u64| {
            let mut rest = part;
            DVec3::from_array(std::array::from_fn(|axis| {
                let index = rest % grid[axis];
                rest /= grid[axis];
                let stray = self.jitter * (unit(self.seed, &[1, part, axis as u64]) - 0.5);
                low[axis] + (high[axis] - low[axis]) * (index as f64 + 0.5 + stray) / grid[axis] as f64
            }))
        };
        let places = parts.into_iter().map(place);
        places.filter(|place| !self.round || self.seen_from_middle(*place).length_squared() <= 1.0).collect()
    }

    /// A place as seen from the middle of the region, 1 at its faces.
    fn seen_from_middle(&self, place: DVec3) -> DVec3 {
        let [low, high] = self.region;
        let (way, half) = (place - 0.5 * (low + high), 0.5 * (high - low));
        DVec3::select(half.cmpgt(DVec3::ZERO), way / half, DVec3::ZERO)
    }

    fn copy(&self, copy: u64, origin: DVec3) -> Solid {
        let by_chance = |what: u64| normal(self.seed, &[2, copy, what]);
        let stray = DVec3::new(by_chance(0), by_chance(1), 0.0) * self.lean;
        let grown = DVec3::Z + self.comb + self.outward * self.seen_from_middle(origin);
        let up = grown.normalize_or(DVec3::Z) + stray;
        let x = self.shape.frame.axes.x_axis;
        let spin = x.y.atan2(x.x) + self.spin * std::f64::consts::TAU * unit(self.seed, &[3, copy]);
        let any_way = DVec3::new(spin.cos(), spin.sin(), 0.0);
        let toward = if self.comb == DVec3::ZERO { any_way } else { self.comb + 0.5 * stray };
        let [least, most] = self.size;
        let size = least + (most - least) * unit(self.seed, &[4, copy]);
        let frame = Frame { origin, axes: axes(up, toward, size) };
        let light = (1.0 + self.tint * by_chance(2)).clamp(0.0, 4.0) as f32;
        let albedo = self.shape.material.albedo.map(|share| (share * light).min(1.0));
        let material = Material { albedo, ..self.shape.material.clone() };
        let curl = self.curl * by_chance(3);
        Solid::new(&self.shape.form, &frame, curl, material, hash(self.seed, &[5, copy]))
    }
}
