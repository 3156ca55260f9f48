//! A texel in 16 bytes.
//!
//! | content | bits | code | error |
//! |---|---|---|---|
//! | √Sxx, √Syy, √Szz | 3 × 8 | even steps from 0 to 2 | ≤ 0.004 of a mean projected area of 1 |
//! | Sij / √(Sii Sjj) | 3 × 8 | even steps from −1 to 1 | ≤ 0.004 |
//! | density | 12 | logarithmic from 10⁻⁴ to 10⁶, or 0 | ≤ 0.29 % |
//! | depths | 3 × 12 | logarithmic from 10⁻⁶ to 20, or 0 | ≤ 0.21 %, ≤ 0.0008 of the transmittance |
//! | albedo | 3 × 8 | even steps of the square root | ≤ 0.004 |
//! | gloss | 8 | even steps | ≤ 0.002 |

use crate::texel::MAX_DEPTH;
use crate::{Sggx, Texel};
use glam::DVec3;
use std::sync::LazyLock;

/// A texel as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Packed(pub(crate) [u64; 2]);

const DENSITY: LogCode = LogCode { low: 1e-4, high: 1e6 };
const DEPTH: LogCode = LogCode { low: 1e-6, high: MAX_DEPTH };
static DENSITIES: LazyLock<Vec<f32>> = LazyLock::new(|| DENSITY.table());
static DEPTHS: LazyLock<Vec<f32>> = LazyLock::new(|| DEPTH.table());

/// 4,096 numbers: 0, then even ratios from `low` to `high`.
struct LogCode {
    low: f32,
    high: f32,
}

impl LogCode {
    const STEPS: f64 = 4094.0;

    fn ratio(&self) -> f64 {
        (f64::from(self.high) / f64::from(self.low)).ln()
    }

    fn encode(&self, value: f32) -> u64 {
        let position = (f64::from(value) / f64::from(self.low)).ln() / self.ratio() * Self::STEPS;
        // What is nearer to 0 than to the smallest number, and what is no number, is 0.
        if value < 0.5 * self.low || position.is_nan() {
            return 0;
        }
        1 + position.round().clamp(0.0, Self::STEPS) as u64
    }

    fn table(&self) -> Vec<f32> {
        let value = |step: u32| f64::from(self.low) * (f64::from(step) / Self::STEPS * self.ratio()).exp();
        std::iter::once(0.0).chain((0..4095).map(|step| value(step) as f32)).collect()
    }
}

/// A number from 0 to 1 in 8 bits.
fn unit(value: f32) -> u64 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u64
}

fn from_unit(bits: u64) -> f32 {
    (bits & 255) as f32 / 255.0
}

/// A number from −1 to 1 in 8 bits, 0 exact.
fn signed(value: f32) -> u64 {
    ((value.clamp(-1.0, 1.0) * 127.0).round() as i64 + 128) as u64
}

fn from_signed(bits: u64) -> f32 {
    (((bits & 255) as f32 - 128.0) / 127.0).max(-1.0)
}

impl Packed {
    /// Packs a texel; its flakes are normalised, numbers outside their ranges moved to the nearest end.
    pub(crate) fn new(texel: &Texel) -> Self {
        let s = texel.flakes.normalised();
        let roots = [s.xx, s.yy, s.zz].map(|entry| entry.max(0.0).sqrt());
        let share = |entry: f32, a: f32, b: f32| if a * b > 1e-9 { signed(entry / (a * b)) } else { 128 };
        let [x, y, z] = roots;
        let flakes = [
            unit(0.5 * x),
            unit(0.5 * y),
            unit(0.5 * z),
            share(s.xy, x, y),
            share(s.xz, x, z),
            share(s.yz, y, z),
        ];
        let [red, green, blue] = texel.albedo.map(|share| unit(share.max(0.0).sqrt()));
        let low = flakes.iter().rev().fold(0, |bits, entry| bits << 8 | entry)
            | unit(texel.gloss) << 48
            | red << 56;
        let depths = texel.depth.iter().rev().fold(0, |bits, depth| bits << 12 | DEPTH.encode(*depth));
        let high = green | blue << 8 | DENSITY.encode(texel.density) << 16 | depths << 28;
        Self([low, high])
    }

    /// The extinction of what was packed along `w`, per unit of length in a cell of the given `width`: that of
    /// [`Texel::extinction`], without a texel in between.
    pub(crate) fn extinction(self, w: DVec3, width: f64) -> f64 {
        let [low, high] = self.0;
        let seen = |axis: usize, shift: u32| w[axis] * f64::from(DEPTHS[(high >> shift & 4095) as usize]);
        let [x, y, z] = [seen(0, 28), seen(1, 40), seen(2, 52)];
        // What has no projected area along an axis is not tied to others.
        let [a, b, c] = [low & 255 != 0, low >> 8 & 255 != 0, low >> 16 & 255 != 0];
        let tied = |is_so: bool, shift: u32| if is_so { f64::from(from_signed(low >> shift)) } else { 0.0 };
        let mixed = x * y * tied(a && b, 24) + x * z * tied(a && c, 32) + y * z * tied(b && c, 40);
        (x * x + y * y + z * z + 2.0 * mixed).max(0.0).sqrt() / width
    }

    /// What was packed.
    pub(crate) fn texel(self) -> Texel {
        let [low, high] = self.0;
        let [x, y, z] = [0, 8, 16].map(|shift| 2.0 * from_unit(low >> shift));
        let [xy, xz, yz] = [24, 32, 40].map(|shift| from_signed(low >> shift));
        let colour = |bits: u64| from_unit(bits) * from_unit(bits);
        Texel {
            density: DENSITIES[(high >> 16 & 4095) as usize],
            depth: [28, 40, 52].map(|shift| DEPTHS[(high >> shift & 4095) as usize]),
            flakes: Sggx { xx: x * x, yy: y * y, zz: z * z, xy: xy * x * y, xz: xz * x * z, yz: yz * y * z },
            albedo: [colour(low >> 56), colour(high), colour(high >> 8)],
            gloss: from_unit(low >> 48),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat, DVec3};

    /// Numbers from 0 to 1 (Weyl's sequences of three roots).
    fn numbers(count: u32) -> impl Iterator<Item = DVec3> {
        let step = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);
        (1..=count).map(move |i| (step * f64::from(i)).fract())
    }

    fn through(texel: &Texel) -> Texel {
        Packed::new(texel).texel()
    }

    #[test]
    fn flakes_keep_their_projected_areas() {
        let mut worst: f64 = 0.0;
        for (turn, size) in numbers(500).zip(numbers(1000).skip(500)) {
            let axes =
                DMat3::from_quat(DQuat::from_rotation_z(7.0 * turn.x) * DQuat::from_rotation_x(5.0 * turn.y))
                    * DMat3::from_diagonal(size + 0.02);
            let flakes = Sggx::ellipsoid(axes);
            let read = through(&Texel { flakes, ..Texel::default() }).flakes;
            for w in numbers(40).map(|v| (v - 0.5).normalize()) {
                // Cancellation in σ² weighs more where σ is small: σ² is what is kept evenly.
                worst = worst.max((read.projected_area(w).powi(2) - flakes.projected_area(w).powi(2)).abs());
            }
        }
        assert!(worst < 0.06, "{worst}");
    }

    #[test]
    fn entries_keep_their_bounds() {
        for (turn, size) in numbers(500).zip(numbers(1000).skip(500)) {
            let axes =
                DMat3::from_quat(DQuat::from_rotation_y(7.0 * turn.x) * DQuat::from_rotation_x(5.0 * turn.y))
                    * DMat3::from_diagonal(size + 0.02);
            let given = Sggx::ellipsoid(axes);
            let read = through(&Texel { flakes: given, ..Texel::default() }).flakes;
            for (a, b) in [(given.xx, read.xx), (given.yy, read.yy), (given.zz, read.zz)] {
                assert!((a.sqrt() - b.sqrt()).abs() <= 0.004, "{a} {b}");
            }
            let share = |s: &Sggx| s.xz / (s.xx * s.zz).sqrt();
            assert!((share(&given) - share(&read)).abs() <= 0.004);
        }
    }

    #[test]
    fn amounts_keep_their_ratios() {
        for step in 0..3000 {
            let density = 1e-4 * 10f32.powf(step as f32 / 300.0);
            let depth = (1e-6 * 10f32.powf(step as f32 / 400.0)).min(MAX_DEPTH);
            let read = through(&Texel { density, depth: [depth; 3], ..Texel::default() });
            assert!((read.density / density - 1.0).abs() <= 0.0029, "{density} {}", read.density);
            assert!((read.depth[1] / depth - 1.0).abs() <= 0.0021, "{depth} {:?}", read.depth);
            assert!(((-read.depth[2]).exp() - (-depth).exp()).abs() <= 0.0008);
        }
        assert_eq!(through(&Texel::default()).depth, [0.0; 3]);
    }

    #[test]
    fn extinctions_are_those_of_what_is_unpacked() {
        for (turn, size) in numbers(500).zip(numbers(1000).skip(500)) {
            let axes =
                DMat3::from_quat(DQuat::from_rotation_z(7.0 * turn.x) * DQuat::from_rotation_x(5.0 * turn.y))
                    * DMat3::from_diagonal(size);
            let packed = Packed::new(&Texel::even(30.0, Sggx::ellipsoid(axes), 0.25));
            let along = [DVec3::X, DVec3::Y, DVec3::Z].map(|w| packed.texel().extinction(w, 0.25));
            let steepest = along.into_iter().fold(0.0, f64::max);
            for w in numbers(20).map(|v| v - 0.5) {
                let (found, expected) = (packed.extinction(w, 0.25), packed.texel().extinction(w, 0.25));
                // Flat flakes seen edge-on: what is left of a difference of squares.
                let error = (found * found - expected * expected).abs();
                assert!(error <= 2e-7 * steepest * steepest, "{found} {expected}");
            }
        }
        let flat = Packed::new(&Texel::even(3.0, Sggx::from_entries([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 1.0));
        assert_eq!(flat.extinction(DVec3::Y, 1.0), 0.0);
    }

    #[test]
    fn colours_keep_their_steps() {
        for v in numbers(500) {
            let albedo = [v.x as f32, v.y as f32, v.z as f32];
            let read = through(&Texel { albedo, gloss: albedo[0], ..Texel::default() });
            for (given, read) in albedo.iter().zip(read.albedo) {
                assert!((given - read).abs() <= 0.004, "{given} {read}");
            }
            assert!((read.gloss - albedo[0]).abs() <= 0.002);
        }
    }

    #[test]
    fn what_is_no_number_is_stored_as_some_texel() {
        let odd = Texel {
            density: f32::NAN,
            depth: [f32::INFINITY, -1.0, f32::NAN],
            flakes: Sggx::from_entries([f32::NAN; 6]),
            albedo: [f32::NAN, 7.0, -2.0],
            gloss: f32::NAN,
        };
        let read = through(&odd);
        assert_eq!(read.depth, [MAX_DEPTH, 0.0, 0.0]);
        assert_eq!((read.density, read.albedo[1], read.albedo[2]), (0.0, 1.0, 0.0));
    }
}
