//! Numbers that look random: evenly spread for the samples of a pixel and over neighbouring pixels, unrelated between uses.
//!
//! Points of the first two dimensions of Sobol's sequence, a (0,2)-sequence: any 2ᵏ in a row that start at a multiple of
//! 2ᵏ are as evenly spread over the square as 2ᵏ points can be. Owen's scrambling by hashing (Burley 2020) makes others of
//! them for every seed, with the same property.
//!
//! The pixels of a region share a sequence, of which they take pieces in the order of a Z curve: so the points of each
//! 2 × 2 pixels, 4 × 4 and so on are evenly spread too, and what noise there is has no low frequencies, which the eye sees
//! best (Ahmed and Wonka 2020). Nothing depends on time or threads.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

/// A hash with full avalanche (C. Wellons 2018, `lowbias32`).
pub(crate) fn hash(x: u32) -> u32 {
    let mut x = x.wrapping_add(0x9e37_79b9);
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0x735a_2d97);
    x ^ (x >> 15)
}

/// The seed for one more choice among those of a seed.
pub(crate) fn derive(seed: u32, choice: u32) -> u32 {
    hash(seed ^ hash(choice))
}

/// Owen's scrambling in base 2 of the digits of a number, most significant first (Laine and Karras 2011, with the
/// constants of N. Vegdahl 2021).
fn scramble(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// The second dimension of Sobol's sequence; the first is the index with its bits reversed.
fn second_dimension(mut index: u32) -> u32 {
    let (mut result, mut direction) = (0, 1 << 31);
    while index > 0 {
        if index & 1 == 1 {
            result ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    result
}

/// Point `index` of the sequence that belongs to a seed, in the half-open unit square.
pub(crate) fn point(index: u32, seed: u32) -> (f64, f64) {
    // Scrambling wants seeds whose bits are all random.
    let index = scramble(index, derive(seed, 0));
    let unit = |x: u32| f64::from(x) / (1u64 << 32) as f64;
    let (x, y) = (index.reverse_bits(), second_dimension(index));
    (unit(scramble(x, derive(seed, 1))), unit(scramble(y, derive(seed, 2))))
}

/// The luminance of light, by the weights of ITU-R BT.709.
pub(crate) fn luminance(light: fieldstone_scene::Rgb) -> f64 {
    light.dot(glam::DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The numbers of a pixel's sample: points `index` of the sequences of seeds that are derived from `seed`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Draw {
    pub(crate) seed: u32,
    pub(crate) index: u32,
    /// Whether it is the first sample of its pixel.
    pub(crate) is_first: bool,
}

/// The side of a region whose pixels share a sequence; a power of 2.
const REGION: u32 = 32;

impl Draw {
    /// Those of a sample of a pixel, from 0 on. The samples that are taken together, 0, 1 to 3, 4 to 7, 8 to 15 and so
    /// on, share sequences with those of other pixels.
    pub(crate) fn new((x, y): (u32, u32), sample: u32) -> Self {
        // Not of both coordinates alike, or noise would be mirrored about the diagonal.
        let region = hash(hash(x / REGION).wrapping_add(y / REGION));
        let rank = interleave(x % REGION) | interleave(y % REGION) << 1;
        let (set, each, place) = match sample {
            0 => (0, 1, 0),
            1..=3 => (1, 4, sample),
            _ => (sample.ilog2(), 1 << sample.ilog2(), sample - (1 << sample.ilog2())),
        };
        let index = rank.wrapping_mul(each).wrapping_add(place);
        Self { seed: derive(region, set), index, is_first: sample == 0 }
    }

    /// The numbers of a ray that parts from this one.
    pub(crate) fn branch(self, choice: u32) -> Self {
        Self { seed: derive(self.seed, choice), ..self }
    }

    /// The point for a choice.
    pub(crate) fn point(self, choice: u32) -> (f64, f64) {
        point(self.index, derive(self.seed, choice))
    }

    /// So many points for a choice, evenly spread.
    pub(crate) fn points(self, choice: u32, count: u32) -> impl Iterator<Item = (f64, f64)> {
        let (first, seed) = (self.index.wrapping_mul(count.next_power_of_two()), derive(self.seed, choice));
        (0..count).map(move |k| point(first.wrapping_add(k), seed))
    }

    /// A number from 0 to 1 that has nothing to do with its neighbours'.
    pub(crate) fn unrelated(self) -> f64 {
        f64::from(derive(self.seed, self.index)) / (1u64 << 32) as f64
    }
}

/// The bits of a number below [`REGION`] with a 0 before each.
fn interleave(x: u32) -> u32 {
    (0..REGION.ilog2()).map(|bit| (x >> bit & 1) << (2 * bit)).sum()
}

/// From the unit square to the unit disc, keeping areas in proportion and neighbours together (Shirley and Chiu 1997).
pub(crate) fn disc((u, v): (f64, f64)) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
    (radius * angle.cos(), radius * angle.sin())
}

/// A direction above the plane of x and y, with a density of cos θ / π.
pub(crate) fn cosine_hemisphere(square: (f64, f64)) -> glam::DVec3 {
    let (x, y) = disc(square);
    glam::DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// A direction of the sphere, all alike.
pub(crate) fn sphere((u, v): (f64, f64)) -> glam::DVec3 {
    let z = 2.0 * u - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    glam::DVec3::new(radius * cos, radius * sin, z)
}

/// The direction at a height z above the plane of x and y, `turn` of the way around.
pub(crate) fn at_height(z: f64, turn: f64) -> glam::DVec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * turn).sin_cos();
    glam::DVec3::new(radius * cos, radius * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every 16 of a sequence lie in different cells of every division of the square into 16 equal boxes.
    #[test]
    fn points_are_evenly_spread_whatever_the_seed() {
        for seed in 0..50 {
            for start in [0, 16, 160] {
                let points: Vec<_> = (start..start + 16).map(|i| point(i, hash(seed))).collect();
                for columns in [1, 2, 4, 8, 16u32] {
                    let rows = 16 / columns;
                    let mut cells = vec![0; 16];
                    for (x, y) in &points {
                        assert!((0.0..1.0).contains(x) && (0.0..1.0).contains(y));
                        let cell = (x * f64::from(columns)) as u32 + columns * (y * f64::from(rows)) as u32;
                        cells[cell as usize] += 1;
                    }
                    assert!(cells.iter().all(|&n| n == 1), "{seed} from {start}: {cells:?}");
                }
            }
        }
    }

    #[test]
    fn seeds_are_unrelated() {
        // The correlation of the same point under neighbouring seeds, over many seeds.
        let pairs = (0..4000).map(|s| (point(3, derive(7, s)).0 - 0.5, point(3, derive(7, s + 1)).0 - 0.5));
        let correlation = pairs.map(|(a, b)| 12.0 * a * b).sum::<f64>() / 4000.0;
        assert!(correlation.abs() < 0.06, "{correlation}");
        let mean = (0..4000).map(|s| point(0, derive(s, 5)).1).sum::<f64>() / 4000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }

    /// The error of means over blocks of pixels, of points below a slanting line: with unrelated pixels, and as they are.
    #[test]
    fn neighbours_fill_each_others_gaps() {
        let below = |(u, v): (f64, f64)| f64::from(u8::from(v < 0.2 + 0.5 * u));
        let error = |side: u32, value: &dyn Fn((u32, u32)) -> f64| {
            let blocks = (0..64 / side).flat_map(|v| (0..64 / side).map(move |u| (u * side, v * side)));
            let squares = blocks.map(|(x, y)| {
                let pixels = (0..side * side).map(|i| value((x + i % side, y + i / side)));
                (pixels.sum::<f64>() / f64::from(side * side) - 0.45).powi(2)
            });
            (squares.sum::<f64>() / f64::from((64 / side) * (64 / side))).sqrt()
        };
        for samples in [0..1, 1..4, 4..8] {
            let count = 4.0 * samples.len() as f64;
            let together = |pixel| {
                let points = samples.clone().flat_map(|i| Draw::new(pixel, i).points(7, 4));
                points.map(below).sum::<f64>() / count
            };
            let alone = |(x, y)| {
                let points = (0..4 * samples.len() as u32).map(|k| point(k, hash(x ^ hash(y))));
                points.map(below).sum::<f64>() / count
            };
            assert!(error(1, &together) < 1.3 * error(1, &alone), "a pixel has no more noise: {samples:?}");
            assert!(error(4, &together) < 0.7 * error(4, &alone), "16 pixels have less: {samples:?}");
        }
    }

    /// Pixels of a region, and samples of a pixel, have points of their own.
    #[test]
    fn draws_are_different() {
        let of = |sample| (0..64 * 64).map(move |i| Draw::new((i % 64, i / 64), sample));
        let mut all: Vec<_> = (0..9).flat_map(of).map(|draw| (draw.seed, draw.index)).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 9 * 64 * 64);
    }

    #[test]
    fn discs_are_filled_evenly() {
        let places: Vec<_> = (0..4096).map(|i| disc(point(i, 9))).collect();
        let within = |r: f64| places.iter().filter(|(x, y)| x.hypot(*y) <= r).count() as f64 / 4096.0;
        assert!((within(0.5) - 0.25).abs() < 0.01 && within(1.0 + 1e-12) == 1.0);
        let right = places.iter().filter(|(x, _)| *x > 0.0).count();
        assert!((2000..2100).contains(&right), "{right}");
        let mean = (0..4096).map(|i| cosine_hemisphere(point(i, 3)).z).sum::<f64>() / 4096.0;
        assert!((mean - 2.0 / 3.0).abs() < 1e-3, "{mean}");
    }
}
