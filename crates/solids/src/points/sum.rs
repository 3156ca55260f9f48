//! Weighted sums of radial functions.

use super::kernel::Kernel;
use fieldstone_field::Interval;
use std::collections::HashMap;

/// Boxes that meet more cells than this look at all centres.
const MOST_CELLS: f64 = 216.0;

/// Σ wᵢ φ(|p − cᵢ|) + a + b · (p − o).
#[derive(Clone, Debug)]
pub(super) struct Sum {
    pub(super) kernel: Kernel,
    centres: Vec<[f64; 3]>,
    weights: Vec<f64>,
    constant: f64,
    linear: [f64; 3],
    origin: [f64; 3],
    /// The centres in each cube with the kernel's reach as its side, if that is finite.
    cells: HashMap<[i64; 3], Vec<u32>>,
}

/// A plane a + b · (p − o).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plane {
    pub(super) constant: f64,
    pub(super) linear: [f64; 3],
    pub(super) origin: [f64; 3],
}

/// A sum with what its additions lost (Neumaier 1974), and the sum of the sizes.
#[derive(Clone, Copy, Default)]
struct Accurate {
    sum: f64,
    lost: f64,
    size: f64,
}

impl Accurate {
    fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.lost +=
            if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
        self.size += term.abs();
    }

    fn total(self) -> f64 {
        self.sum + self.lost
    }
}

impl Sum {
    pub(super) fn new(kernel: Kernel, centres: Vec<[f64; 3]>, weights: Vec<f64>, plane: Plane) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        if kernel.reach().is_finite() {
            for (i, c) in centres.iter().enumerate() {
                cells.entry(c.map(|x| cell(x, kernel.reach()))).or_default().push(i as u32);
            }
        }
        let Plane { constant, linear, origin } = plane;
        Self { kernel, centres, weights, constant, linear, origin, cells }
    }

    /// Calls for each centre that may lie within `distance` of a point, in an order that is always the same.
    pub(super) fn near(&self, p: [f64; 3], distance: f64, mut visit: impl FnMut(usize)) {
        let side = self.kernel.reach();
        let spans = p.map(|x| [cell(x - distance, side), cell(x + distance, side)]);
        let count: f64 = spans.iter().map(|[a, b]| (b - a + 1) as f64).product();
        if !side.is_finite() || count > MOST_CELLS {
            (0..self.centres.len()).for_each(visit);
            return;
        }
        for i in spans[0][0]..=spans[0][1] {
            for j in spans[1][0]..=spans[1][1] {
                for k in spans[2][0]..=spans[2][1] {
                    let list = self.cells.get(&[i, j, k]).map_or(&[][..], Vec::as_slice);
                    list.iter().for_each(|&c| visit(c as usize));
                }
            }
        }
    }

    fn offset(&self, centre: usize, p: [f64; 3]) -> ([f64; 3], f64) {
        let c = self.centres[centre];
        let d = [p[0] - c[0], p[1] - c[1], p[2] - c[2]];
        (d, (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt())
    }

    /// The value at a point and a bound of its rounding error.
    fn value_with_error(&self, p: [f64; 3]) -> (f64, f64) {
        let mut sum = Accurate::default();
        sum.add(self.constant);
        for k in 0..3 {
            sum.add(self.linear[k] * (p[k] - self.origin[k]));
        }
        self.near(p, self.kernel.reach(), |i| {
            let (_, r) = self.offset(i, p);
            sum.add(self.weights[i] * self.kernel.value(r));
        });
        (sum.total(), 16.0 * f64::EPSILON * sum.size + f64::MIN_POSITIVE)
    }

    pub(super) fn value(&self, p: [f64; 3]) -> f64 {
        self.value_with_error(p).0
    }

    pub(super) fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let mut sums = [Accurate::default(); 3];
        for k in 0..3 {
            sums[k].add(self.linear[k]);
        }
        self.near(p, self.kernel.reach(), |i| {
            let (d, r) = self.offset(i, p);
            let slope = self.weights[i] * self.kernel.slope(r);
            for k in 0..3 {
                sums[k].add(slope * d[k]);
            }
        });
        sums.map(Accurate::total)
    }

    /// The norm of the second derivatives at a point, rounding included, and how fast they may change within `distance`.
    fn bend_and_twist(&self, p: [f64; 3], distance: f64) -> (f64, f64) {
        let (mut matrix, mut size, mut total) = ([0.0f64; 6], 0.0, 0.0);
        self.near(p, self.kernel.reach() + distance, |i| {
            let (d, r) = self.offset(i, p);
            if r > self.kernel.reach() + distance {
                return;
            }
            let weight = self.weights[i];
            total += weight.abs();
            let (slope, bend) = (weight * self.kernel.slope(r), weight * self.kernel.bend(r));
            size += slope.abs() + bend.abs();
            let n = if r > 0.0 { d.map(|x| x / r) } else { [0.0; 3] };
            for (entry, (a, b)) in matrix.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
                *entry += bend * n[a] * n[b] + if a == b { slope } else { 0.0 };
            }
        });
        let [a, b, c, d, e, f] = matrix.map(|x| x * x);
        let count = self.centres.len() as f64;
        ((a + b + c + 2.0 * (d + e + f)).sqrt() + count * f64::EPSILON * size, total * self.kernel.twist())
    }

    /// A bound of the second derivatives in a box: that of its middle, and what they change on the way to a corner.
    pub(super) fn curvature(&self, sides: [Interval<f64>; 3]) -> f64 {
        let (middle, _, reach) = middle_and_reach(sides);
        let (bend, twist) = self.bend_and_twist(middle, reach);
        (bend + twist * reach) * (1.0 + 1e-12)
    }

    /// Bounds of the values in a box: the Taylor series of second order about its middle with its remainder, and, where
    /// the functions are bounded, the sums of the weights of either sign.
    pub(super) fn interval(&self, sides: [Interval<f64>; 3]) -> Interval<f64> {
        let (middle, reaches, reach) = middle_and_reach(sides);
        let (value, error) = self.value_with_error(middle);
        if reach == 0.0 {
            return Interval::new(value - error, value + error);
        }
        let gradient = self.gradient(middle);
        let (bend, twist) = self.bend_and_twist(middle, reach);
        let first: f64 = (0..3).map(|k| gradient[k].abs() * reaches[k]).sum();
        let rest = (0.5 * bend + twist * reach / 6.0) * reach * reach;
        let spread = (first + rest) * (1.0 + 1e-9) + 2.0 * error;
        let taylor = Interval::new(value - spread, value + spread);
        if !self.kernel.reach().is_finite() {
            return taylor;
        }
        let (mut low, mut high) = (0.0, 0.0);
        self.near(middle, self.kernel.reach() + reach, |i| {
            let weight = self.weights[i];
            *(if weight < 0.0 { &mut low } else { &mut high }) += weight;
        });
        let slack = 1e-9 * (high - low);
        Interval::new(taylor.lo.max(low - slack), taylor.hi.min(high + slack))
    }
}

fn cell(x: f64, side: f64) -> i64 {
    (x / side).floor() as i64
}

/// The middle of a box, how far its sides lie from it, and how far its corners do.
fn middle_and_reach(sides: [Interval<f64>; 3]) -> ([f64; 3], [f64; 3], f64) {
    let middle = sides.map(|s| (0.5 * s.lo + 0.5 * s.hi).clamp(s.lo, s.hi));
    let reaches = [0, 1, 2].map(|k| (sides[k].hi - middle[k]).max(middle[k] - sides[k].lo));
    let reach = reaches.iter().map(|r| r * r).sum::<f64>().sqrt() * (1.0 + 1e-12);
    (middle, reaches, reach)
}
