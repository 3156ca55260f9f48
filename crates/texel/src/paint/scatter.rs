//! Many shapes by chance.

use super::piece::Frame;
use super::shape::axes;
use super::{Material, Shape, Solid};
use crate::chance::{hash, normal, unit};
use glam::DVec3;

/// The greatest number of shapes of one scatter.
pub const MAX_SHAPES: u32 = 100_000;

/// Copies of a shape, spread over a box or a rectangle.
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
    /// How far from the middle of its part a copy may stand: 0 a grid, 1 anywhere in the part.
    pub jitter: f64,
    /// Added to the direction up, (0, 0, 1), in which copies grow: they are combed that way. If it is not 0, they bend that
    /// way too, or else any way.
    pub comb: DVec3,
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
    fn places(&self) -> impl Iterator<Item = DVec3> + use<> {
        let [low, high] = self.region;
        let span = (high - low).to_array();
        let dimensions = span.iter().filter(|length| **length != 0.0).count().max(1) as i32;
        let count = self.count.min(MAX_SHAPES);
        let side = (1u32..).find(|side| u64::from(*side).pow(dimensions as u32) >= u64::from(count));
        let side = u64::from(side.unwrap_or(1));
        let mut parts: Vec<u64> = (0..side.pow(dimensions as u32)).collect();
        parts.sort_by_key(|part| hash(self.seed, &[0, *part]));
        let (seed, jitter) = (self.seed, self.jitter);
        parts.into_iter().map(move |part| {
            let mut rest = part;
            let place = std::array::from_fn(|axis| {
                if span[axis] == 0.0 {
                    return low[axis];
                }
                let index = rest % side;
                rest /= side;
                let stray = jitter * (unit(seed, &[1, part, axis as u64]) - 0.5);
                low[axis] + span[axis] * (index as f64 + 0.5 + stray) / side as f64
            });
            DVec3::from_array(place)
        })
    }

    fn copy(&self, copy: u64, origin: DVec3) -> Solid {
        let by_chance = |what: u64| normal(self.seed, &[2, copy, what]);
        let stray = DVec3::new(by_chance(0), by_chance(1), 0.0) * self.lean;
        let up = (DVec3::Z + self.comb).normalize_or(DVec3::Z) + stray;
        let spin = std::f64::consts::TAU * unit(self.seed, &[3, copy]);
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
