//! Noise: gradient noise and sums of it.
//!
//! K. Perlin, "Improving Noise" (SIGGRAPH 2002), with directions from a hash of the lattice point and a seed in place of a
//! table, so that it does not repeat and is the same everywhere.

use crate::chance::hash;
use glam::DVec3;
use serde::Deserialize;

/// The noise's own greatest value is below this.
const GREATEST: f64 = 1.04;

/// A sum of octaves of noise.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Noise {
    /// Lattice points per unit of length of the first octave, > 0; most of the power lies around half as many
    /// waves.
    pub frequency: f64,
    /// The number of octaves, 1 to 16.
    pub octaves: u32,
    /// By how much the frequency rises from one to the next, > 1.
    pub lacunarity: f64,
    /// By how much the amplitude falls from one to the next, 0 to 1.
    pub gain: f64,
    /// Whether absolute values are added (Perlin's turbulence, 0 to 1), not values (−1 to 1).
    pub turbulence: bool,
    /// Other seeds make other noise.
    pub seed: u64,
}

impl Default for Noise {
    /// Four octaves from 4 on, each half as strong as the one before.
    fn default() -> Self {
        Self { frequency: 4.0, octaves: 4, lacunarity: 2.0, gain: 0.5, turbulence: false, seed: 0 }
    }
}

impl Noise {
    /// The value at a point: −1 to 1, with turbulence 0 to 1.
    pub fn at(&self, p: DVec3) -> f64 {
        let (mut sum, mut whole, mut amplitude, mut frequency) = (0.0, 0.0, 1.0, self.frequency);
        for octave in 0..self.octaves {
            let value = gradient_noise(p * frequency, self.seed.wrapping_add(u64::from(octave)));
            sum += amplitude * if self.turbulence { value.abs() } else { value };
            whole += amplitude;
            (amplitude, frequency) = (amplitude * self.gain, frequency * self.lacunarity);
        }
        if whole > 0.0 { sum / whole } else { 0.0 }
    }

    /// This noise without the octaves that have more than `most` lattice points per unit of length; the first stays.
    pub fn limited(self, most: f64) -> Self {
        let above = (most / self.frequency).ln() / self.lacunarity.ln();
        let octaves = if above.is_finite() { above.floor().clamp(0.0, 15.0) as u32 + 1 } else { 1 };
        Self { octaves: self.octaves.min(octaves), ..self }
    }

    /// The frequency of the last octave.
    pub fn highest(&self) -> f64 {
        self.frequency * self.lacunarity.powi(self.octaves.saturating_sub(1) as i32)
    }
}

/// Gradient noise with lattice points at whole numbers, −1 to 1, 0 at lattice points; twice differentiable.
pub fn gradient_noise(p: DVec3, seed: u64) -> f64 {
    let base = p.floor();
    let from = p - base;
    let fade = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let share = from.to_array().map(fade);
    let cell = base.to_array().map(|c| c as i64);
    let mut sum = 0.0;
    for corner in 0..8usize {
        let bit = [corner & 1, corner >> 1 & 1, corner >> 2];
        let weight: f64 = (0..3).map(|k| if bit[k] == 1 { share[k] } else { 1.0 - share[k] }).product();
        let lattice = [0, 1, 2].map(|k| cell[k].wrapping_add(bit[k] as i64));
        let away = from - DVec3::from_array(bit.map(|b| b as f64));
        sum += weight * along(hash(seed, &lattice.map(|c| c as u64)), away);
    }
    sum / GREATEST
}

/// The scalar product with one of the twelve directions to the middles of a cube's edges.
fn along(hash: u64, p: DVec3) -> f64 {
    let (a, b) = match hash % 3 {
        0 => (p.x, p.y),
        1 => (p.y, p.z),
        _ => (p.z, p.x),
    };
    let sign = |bit: u64, x: f64| if hash >> bit & 1 == 1 { -x } else { x };
    sign(40, a) + sign(41, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn noise_is_bounded_and_takes_both_signs() {
        let (mut low, mut high) = (0.0f64, 0.0f64);
        for i in 0..200_000 {
            let t = f64::from(i);
            let value = gradient_noise(DVec3::new(t * 0.618, t * 0.414, t * 0.733), 7);
            (low, high) = (low.min(value), high.max(value));
        }
        assert!((-1.0..-0.7).contains(&low) && (0.7..1.0).contains(&high), "{low} {high}");
    }

    #[test]
    fn noise_joins_smoothly_at_lattice_points() {
        for p in [DVec3::new(3.0, 0.4, 0.7), DVec3::new(-2.0, -5.0, 0.3), DVec3::new(1.5, 2.0, -7.0)] {
            let step = DVec3::splat(1e-6);
            let [before, here, after] = [p - step, p, p + step].map(|p| gradient_noise(p, 1));
            assert!((after - 2.0 * here + before).abs() < 1e-10, "{p}");
        }
        assert_eq!(gradient_noise(DVec3::new(4.0, -3.0, 9.0), 5), 0.0);
    }

    /// The share of the power of a line through the noise that lies in waves from `low` to `high` per unit.
    fn power(noise: &Noise, low: f64, high: f64) -> f64 {
        let (count, length) = (2048, 64.0);
        let window = |t: f64| 0.5 - 0.5 * (TAU * t).cos();
        let values: Vec<f64> = (0..count)
            .map(|i| {
                let t = f64::from(i) / f64::from(count);
                window(t) * noise.at(DVec3::new(length * t, 0.37, 0.61))
            })
            .collect();
        let mut shares = [0.0; 2];
        for wave in 0..count / 2 {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, value) in values.iter().enumerate() {
                let (sin, cos) = (TAU * f64::from(wave) * i as f64 / f64::from(count)).sin_cos();
                (re, im) = (re + value * cos, im + value * sin);
            }
            let frequency = f64::from(wave) / length;
            shares[usize::from((low..high).contains(&frequency))] += re * re + im * im;
        }
        shares[1] / (shares[0] + shares[1])
    }

    #[test]
    fn the_spectrum_of_noise_has_an_end() {
        let one = Noise { frequency: 2.0, octaves: 1, ..Noise::default() };
        // Half of 2 lattice points per unit is one wave.
        let most = power(&one, 0.0, 2.0);
        assert!(most > 0.98, "{most}");
        let above = power(&one, 4.0, 16.0);
        assert!(above < 0.002, "{above}");
        let four = Noise { frequency: 2.0, octaves: 4, gain: 1.0, ..Noise::default() };
        assert!(power(&four, 4.0, 16.0) > 0.2);
    }

    #[test]
    fn octaves_beyond_a_limit_are_left_out() {
        let noise = Noise { frequency: 4.0, octaves: 8, ..Noise::default() };
        assert_eq!(noise.limited(20.0).octaves, 3);
        assert!(noise.limited(20.0).highest() <= 20.0);
        assert_eq!(noise.limited(1.0).octaves, 1);
    }

    #[test]
    fn seeds_make_other_noise() {
        let p = DVec3::new(0.3, 0.4, 0.5);
        assert_ne!(gradient_noise(p, 1), gradient_noise(p, 2));
    }
}
