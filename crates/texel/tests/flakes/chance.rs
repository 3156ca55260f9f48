//! Numbers by chance that are the same everywhere.

use glam::{DMat3, DQuat, DVec3};

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Of a normal distribution with the deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    pub(crate) fn rotation(&mut self) -> DMat3 {
        let [x, y, z, w] = [(); 4].map(|()| self.normal());
        DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())
    }
}

/// Directions that share the sphere evenly (a spiral of Fibonacci).
pub(crate) fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    let turn = std::f64::consts::PI * (1.0 + 5.0f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (turn * (f64::from(i) + 0.5)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    })
}

/// ∫ f over the directions within `angle` of the unit `axis`, by rings: the error falls with the square of their number.
pub(crate) fn integral(axis: DVec3, angle: f64, rings: u32, f: impl Fn(DVec3) -> f64) -> f64 {
    let (x, y) = axis.any_orthonormal_pair();
    let (step, turns) = (angle / f64::from(rings), rings / 2);
    let mut sum = 0.0;
    for ring in 0..rings {
        let (sin, cos) = ((f64::from(ring) + 0.5) * step).sin_cos();
        let about = |turn: u32| {
            let (s, c) = (std::f64::consts::TAU * f64::from(turn) / f64::from(turns)).sin_cos();
            f(axis * cos + (x * c + y * s) * sin)
        };
        sum += sin * (0..turns).map(about).sum::<f64>() / f64::from(turns);
    }
    sum * step * std::f64::consts::TAU
}
