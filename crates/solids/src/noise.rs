//! Gradient noise: random, smooth, and with a feature size of 1.

use fieldstone_field::{Function, Interval};
use std::sync::{Arc, LazyLock};

/// Perlin's gradient noise of x, y and z: from −√3/2 to √3/2, 0 at whole coordinates, repeated after 256. The bounds of
/// its second derivatives are those of the cell, so that affine forms follow it.
pub fn gradient_noise() -> &'static Arc<dyn Function> {
    &PERLIN
}

static PERLIN: LazyLock<Arc<dyn Function>> = LazyLock::new(|| Arc::new(Perlin::new()));

/// The number of cells after which the noise repeats.
const PERIOD: usize = 256;

/// Perlin's gradient noise (SIGGRAPH 1985, the version with the fade 3t² − 2t³).
///
/// The C library fills its tables from `rand()`, so that its values differ from platform to platform. Here they come
/// from SplitMix64 with seed 0: first the gradients, each from three numbers in \[−1, 1) that are drawn again
/// outside the unit ball, then a Fisher–Yates shuffle of the permutation.
struct Perlin {
    permutation: [u8; PERIOD],
    gradients: [[f64; 3]; PERIOD],
}

/// The noise of one cell: the gradients of its corners, and the position in it.
struct Cell {
    corners: [[f64; 3]; 8],
    fraction: [f64; 3],
}

impl Perlin {
    fn new() -> Self {
        let mut state = 0u64;
        let gradients = std::array::from_fn(|_| random_direction(&mut state));
        let mut permutation: [u8; PERIOD] = std::array::from_fn(|i| i as u8);
        for i in (1..PERIOD).rev() {
            permutation.swap(i, (split_mix(&mut state) % (i as u64 + 1)) as usize);
        }
        Self { permutation, gradients }
    }

    fn cell(&self, point: [f64; 3]) -> Cell {
        let low = point.map(|x| x.floor().rem_euclid(PERIOD as f64) as usize % PERIOD);
        let at = |index: usize| usize::from(self.permutation[index % PERIOD]);
        let corners = std::array::from_fn(|corner| {
            let [i, j, k] = [0, 1, 2].map(|axis| (low[axis] + (corner >> axis & 1)) % PERIOD);
            self.gradients[(at(at(i) + j) + k) % PERIOD]
        });
        Cell { corners, fraction: point.map(|x| x - x.floor()) }
    }

    /// No value is larger: with weights w of the corners at distances r, |Σ w g·r| ≤ √(Σ w r²) ≤ √3/2.
    const BOUND: f64 = 0.8660254037844388;

    /// No partial derivative is larger: |Σ w g| ≤ 1, and the derivative of the fade, at most 3/2, times the
    /// difference of two opposite faces, at most 2·√(3/4), both taken in the middle, where their product is largest.
    const SLOPE: f64 = 1.0 + 1.5 * 2.0 * Self::BOUND;

    /// No second derivative along a unit vector u is larger: those of the weights sum up to at most
    /// 2·6·|u|² + 4·(3/2)²·(|u|₁² − |u|²) ≤ 30 and act on heights of at most √3, and twice the first ones, which sum up
    /// to at most 3·|u|₁ ≤ 3√3, act on slopes of at most 1.
    const BEND: f64 = 62.4;
}

/// The fade 3t² − 2t³ of the two sides of a cell, 1 − fade first, with two derivatives, for t in an interval.
struct Fade {
    value: [Interval<f64>; 2],
    first: [Interval<f64>; 2],
    second: [Interval<f64>; 2],
}

impl Fade {
    fn new(t: Interval<f64>) -> Self {
        let fade = |t: f64| t * t * (3.0 - 2.0 * t);
        let slope = |t: f64| 6.0 * t * (1.0 - t);
        let steepest = if t.lo <= 0.5 && t.hi >= 0.5 { 1.5 } else { slope(t.lo).max(slope(t.hi)) };
        let value = Interval::new(fade(t.lo), fade(t.hi));
        let first = Interval::new(slope(t.lo).min(slope(t.hi)), steepest);
        let second = Interval::new(6.0 - 12.0 * t.hi, 6.0 - 12.0 * t.lo);
        let one = Interval::new(1.0, 1.0);
        Self { value: [one - value, value], first: [-first, first], second: [-second, second] }
    }
}

impl Cell {
    /// A bound of the second derivatives in a part of the cell: the Frobenius norm of the matrix of their bounds.
    fn bend(&self, fractions: [Interval<f64>; 3]) -> f64 {
        let fades = fractions.map(Fade::new);
        let mut squares = 0.0;
        for a in 0..3 {
            for b in a..3 {
                let size = self.second_derivative(&fades, fractions, (a, b)).magnitude();
                squares += if a == b { size * size } else { 2.0 * size * size };
            }
        }
        // Far more than the rounding errors of the interval ends.
        squares.sqrt() * (1.0 + 1e-9) + 1e-9
    }

    /// ∂²/∂a∂b of Σ w·g·(t − corner) over a part of the cell.
    fn second_derivative(
        &self,
        fades: &[Fade; 3],
        fractions: [Interval<f64>; 3],
        (a, b): (usize, usize),
    ) -> Interval<f64> {
        let number = |k: f64| Interval::new(k, k);
        let mut sum = number(0.0);
        for (corner, direction) in self.corners.iter().enumerate() {
            let side = [0, 1, 2].map(|axis| corner >> axis & 1);
            let value = [0, 1, 2].map(|k| fades[k].value[side[k]]);
            let first = [0, 1, 2].map(|k| fades[k].first[side[k]]);
            let heights = [0, 1, 2].map(|k| number(direction[k]) * (fractions[k] - number(side[k] as f64)));
            let height = heights[0] + heights[1] + heights[2];
            sum = if a == b {
                let others = value[(a + 1) % 3] * value[(a + 2) % 3];
                let bend = fades[a].second[side[a]] * height + first[a] * number(2.0 * direction[a]);
                sum + others * bend
            } else {
                let tilt = first[a] * first[b] * height
                    + first[a] * value[b] * number(direction[b])
                    + value[a] * first[b] * number(direction[a]);
                sum + value[3 - a - b] * tilt
            };
        }
        sum
    }

    /// The value and its partial derivatives.
    fn value_and_gradient(&self) -> (f64, [f64; 3]) {
        let fade = self.fraction.map(|t| t * t * (3.0 - 2.0 * t));
        let slope = self.fraction.map(|t| 6.0 * t * (1.0 - t));
        let (mut value, mut gradient) = (0.0, [0.0; 3]);
        for (corner, direction) in self.corners.iter().enumerate() {
            let side = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weight = [0, 1, 2].map(|a| if side[a] == 1 { fade[a] } else { 1.0 - fade[a] });
            let change = [0, 1, 2].map(|a| if side[a] == 1 { slope[a] } else { -slope[a] });
            let height: f64 = (0..3).map(|a| direction[a] * (self.fraction[a] - side[a] as f64)).sum();
            let product = weight[0] * weight[1] * weight[2];
            value += product * height;
            for a in 0..3 {
                let others = weight[(a + 1) % 3] * weight[(a + 2) % 3];
                gradient[a] += product * direction[a] + change[a] * others * height;
            }
        }
        (value, gradient)
    }
}

impl Function for Perlin {
    fn name(&self) -> &str {
        "hfA_NoiseP"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        let &[x, y, z] = arguments else { return f64::NAN };
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return f64::NAN;
        }
        self.cell([x, y, z]).value_and_gradient().0
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        if arguments.iter().any(|a| a.lo.is_nan() || a.hi.is_nan()) {
            return Interval::undefined();
        }
        let bound = Self::BOUND + ROUNDING;
        if arguments.iter().any(|a| a.lo.is_infinite() || a.hi.is_infinite()) {
            return Interval { lo: -bound, hi: bound };
        }
        let center: Vec<f64> = arguments.iter().map(|a| 0.5 * a.lo + 0.5 * a.hi).collect();
        let reach: f64 = arguments.iter().zip(&center).map(|(a, c)| (a.hi - c).max(c - a.lo)).sum();
        let (middle, radius) = (self.value(&center), Self::SLOPE * reach + ROUNDING);
        Interval { lo: (middle - radius).max(-bound), hi: (middle + radius).min(bound) }
    }

    /// In one cell the norm of the second derivatives, by interval arithmetic; across cells what holds everywhere.
    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        let &[x, y, z] = arguments else { return f64::INFINITY };
        let sides = [x, y, z];
        let is_finite = sides.iter().all(|side| side.lo.is_finite() && side.hi.is_finite());
        if !is_finite {
            return f64::INFINITY;
        }
        let floors = sides.map(|side| side.lo.floor());
        let in_one_cell = (0..3).all(|k| sides[k].hi <= floors[k] + 1.0);
        if !in_one_cell {
            return Self::BEND;
        }
        let middle = [0, 1, 2].map(|k| floors[k] + 0.5);
        let fractions = [0, 1, 2].map(|k| Interval::new(sides[k].lo - floors[k], sides[k].hi - floors[k]));
        self.cell(middle).bend(fractions).min(Self::BEND)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let slopes = match *arguments {
            [x, y, z] if self.value(arguments).is_finite() => self.cell([x, y, z]).value_and_gradient().1,
            _ => [f64::NAN; 3],
        };
        for (slope, value) in gradient.iter_mut().zip(slopes) {
            *slope = value;
        }
    }
}

/// More than the rounding errors of a value of [`Perlin`], a sum of eight products of numbers below 2.
const ROUNDING: f64 = 1e-13;

/// The generator SplitMix64.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

fn random_direction(state: &mut u64) -> [f64; 3] {
    loop {
        let direction = [0; 3].map(|_| (split_mix(state) >> 11) as f64 * (2.0 / (1u64 << 53) as f64) - 1.0);
        let squared: f64 = direction.iter().map(|d| d * d).sum();
        if squared > 1e-3 && squared <= 1.0 {
            return direction.map(|d| d / squared.sqrt());
        }
    }
}
