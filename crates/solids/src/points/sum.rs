//! Weighted sums of radial functions.

use super::kernel::Kernel;
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

    /// The value at a point.
    pub(super) fn value(&self, p: [f64; 3]) -> f64 {
        let mut sum = self.plane_at(p);
        self.near(p, self.kernel.reach(), |i| {
            let (_, r) = self.offset(i, p);
            sum.add(self.weights[i] * self.kernel.value(r));
        });
        sum.total()
    }

    fn plane_at(&self, p: [f64; 3]) -> Accurate {
        let mut sum = Accurate::default();
        sum.add(self.constant);
        for (b, (x, o)) in self.linear.iter().zip(p.iter().zip(&self.origin)) {
            sum.add(b * (x - o));
        }
        sum
    }

    /// All that is known about the sum near a point, found in one pass over the centres.
    pub(super) fn study(&self, p: [f64; 3], distance: f64) -> Study {
        let (mut value, mut gradient) = (self.plane_at(p), [Accurate::default(); 3]);
        for (sum, b) in gradient.iter_mut().zip(self.linear) {
            sum.add(b);
        }
        let (mut matrix, mut size, mut total) = ([0.0f64; 6], 0.0, 0.0);
        self.near(p, self.kernel.reach() + distance, |i| {
            let (d, r) = self.offset(i, p);
            if r > self.kernel.reach() + distance {
                return;
            }
            let weight = self.weights[i];
            total += weight.abs();
            value.add(weight * self.kernel.value(r));
            let (slope, bend) = (weight * self.kernel.slope(r), weight * self.kernel.bend(r));
            for (sum, d) in gradient.iter_mut().zip(d) {
                sum.add(slope * d);
            }
            size += slope.abs() + bend.abs();
            let n = if r > 0.0 { d.map(|x| x / r) } else { [0.0; 3] };
            for (entry, (a, b)) in matrix.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
                *entry += bend * n[a] * n[b] + if a == b { slope } else { 0.0 };
            }
        });
        let [a, b, c, d, e, f] = matrix.map(|x| x * x);
        let count = self.centres.len() as f64;
        Study {
            value: value.total(),
            error: 16.0 * f64::EPSILON * value.size + f64::MIN_POSITIVE,
            gradient: gradient.map(Accurate::total),
            bend: (a + b + c + 2.0 * (d + e + f)).sqrt() + count * f64::EPSILON * size,
            twist: total * self.kernel.twist(),
        }
    }
}

fn cell(x: f64, side: f64) -> i64 {
    (x / side).floor() as i64
}

/// A sum near a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Study {
    pub(super) value: f64,
    /// A bound of the rounding error of the value.
    pub(super) error: f64,
    pub(super) gradient: [f64; 3],
    /// The norm of the second derivatives, rounding included.
    pub(super) bend: f64,
    /// How fast the second derivatives may change within the distance.
    pub(super) twist: f64,
}

impl Study {
    pub(super) fn and(self, other: Self) -> Self {
        let value = self.value + other.value;
        Self {
            value,
            error: self.error + other.error + f64::EPSILON * value.abs(),
            gradient: [0, 1, 2].map(|k| self.gradient[k] + other.gradient[k]),
            bend: self.bend + other.bend,
            twist: self.twist + other.twist,
        }
    }
}
