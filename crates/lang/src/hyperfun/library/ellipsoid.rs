//! The signed distance from an ellipsoid.

use fieldstone_field::{Function, Interval};
use std::sync::{Arc, LazyLock};

/// The distance of (x, y, z) from the ellipsoid with half-axes (a, b, c) about the origin, positive inside.
pub(super) static ELLIPSOID: LazyLock<Arc<dyn Function>> = LazyLock::new(|| Arc::new(EllipsoidDistance));

struct EllipsoidDistance;

/// The signed distance, and the unit normal n ≥ 0 at the closest point, for coordinates y ≥ 0.
///
/// The closest point is e²y/(e² + t) in each coordinate, e being the half-axes. With the smallest one e₀,
/// σ = 1 + t/e₀² and the excess d = e²/e₀² − 1 ≥ 0 of each axis, e² + t is e₀²(σ + d); outside, σ > 1.
struct Closest {
    normal: [f64; 3],
    distance: f64,
}

/// The terms wᵢ/(σ + dᵢ) whose squares sum up to 1 at the closest point.
struct Secular {
    weights: [f64; 3],
    excesses: [f64; 3],
}

impl Secular {
    fn new(y: [f64; 3], e: [f64; 3], smallest: f64) -> Self {
        let weights = [0, 1, 2].map(|k| y[k] * e[k] / (smallest * smallest));
        let excesses = e.map(|e| (e - smallest) * (e + smallest) / (smallest * smallest));
        Self { weights, excesses }
    }

    /// Σ (w/(σ + d))², and its derivative.
    fn sum(&self, sigma: f64) -> (f64, f64) {
        let (mut sum, mut slope) = (0.0, 0.0);
        for (w, d) in self.weights.iter().zip(self.excesses) {
            if *w > 0.0 {
                let term = (w / (sigma + d)).powi(2);
                sum += term;
                slope -= 2.0 * term / (sigma + d);
            }
        }
        (sum, slope)
    }

    /// The root σ ≥ 0 of Σ = 1; 0 if the sum is nowhere as large.
    ///
    /// Where each term alone is at most 1 and one is 1, the sum is in \[1, 3\]; where each is at most 1/√3, it is at
    /// most 1. Between the two, the bracket is halved in the logarithm until Newton's method takes over on the
    /// concave and almost linear function Σ^(−1/2): from the left it never passes the root.
    fn root(&self) -> f64 {
        let reach =
            |scale: f64| (0..3).map(|k| scale * self.weights[k] - self.excesses[k]).fold(0.0, f64::max);
        let (mut low, mut high) = (reach(1.0), reach(3f64.sqrt() * (1.0 + 1e-15)));
        if low == 0.0 {
            if self.sum(0.0).0 <= 1.0 {
                return 0.0;
            }
            low = f64::MIN_POSITIVE;
        }
        for _ in 0..200 {
            if high > 4.0 * low {
                let middle = low.sqrt() * high.sqrt();
                if self.sum(middle).0 > 1.0 {
                    low = middle;
                } else {
                    high = middle;
                }
                continue;
            }
            let (sum, slope) = self.sum(low);
            let next = low + 2.0 * sum * (1.0 - sum.sqrt()) / slope;
            if next.partial_cmp(&low) != Some(std::cmp::Ordering::Greater) {
                break;
            }
            low = next;
        }
        low
    }
}

impl Closest {
    /// For coordinates y ≥ 0 and half-axes e > 0.
    fn new(y: [f64; 3], e: [f64; 3]) -> Self {
        let smallest = e[0].min(e[1]).min(e[2]);
        let secular = Secular::new(y, e, smallest);
        let sigma = secular.root();
        if sigma == 0.0 {
            return Self::from_the_middle(y, e, &secular);
        }
        let scaled = [0, 1, 2].map(|k| y[k] / (sigma + secular.excesses[k]));
        let length = length(scaled);
        Self { normal: scaled.map(|n| n / length), distance: (1.0 - sigma) * length }
    }

    /// For points so close to the middle plane or line, across the shortest axis, that the closest points lie in
    /// mirrored pairs or on a circle: one of them.
    fn from_the_middle(y: [f64; 3], e: [f64; 3], secular: &Secular) -> Self {
        let mut point = [0.0; 3];
        let (mut rest, mut shortest) = (1.0, 0);
        for k in 0..3 {
            if secular.excesses[k] > 0.0 {
                point[k] = y[k] * (1.0 + secular.excesses[k]) / secular.excesses[k];
                rest -= (point[k] / e[k]).powi(2);
            } else {
                shortest = k;
            }
        }
        point[shortest] = e[shortest] * rest.max(0.0).sqrt();
        let away = [0, 1, 2].map(|k| point[k] - y[k]);
        let gradient = [0, 1, 2].map(|k| point[k] / (e[k] * e[k]));
        let steepness = length(gradient);
        Self { normal: gradient.map(|n| n / steepness), distance: length(away) }
    }
}

fn length(v: [f64; 3]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

/// The coordinates and the half-axes of a call; their signs do not matter to the distance.
fn split(arguments: &[f64]) -> Option<([f64; 3], [f64; 3])> {
    let &[x, y, z, a, b, c] = arguments else { return None };
    let is_solid = [a, b, c].iter().all(|axis| axis.is_finite() && *axis != 0.0);
    let is_point = [x, y, z].iter().all(|coordinate| !coordinate.is_nan());
    (is_solid && is_point).then_some(([x.abs(), y.abs(), z.abs()], [a.abs(), b.abs(), c.abs()]))
}

impl Function for EllipsoidDistance {
    fn name(&self) -> &str {
        "hfDEllipsoid"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        match split(arguments) {
            Some((y, _)) if y.contains(&f64::INFINITY) => f64::NEG_INFINITY,
            Some((y, e)) => Closest::new(y, e).distance,
            None => f64::NAN,
        }
    }

    /// The distance is the minimum over unit normals n ≥ 0 of √Σ(en)² − n·|p|: it falls with each |coordinate| and
    /// grows with each half-axis, so that two opposite corners of the box have the extreme values.
    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        let magnitudes: Vec<(f64, f64)> = arguments.iter().map(magnitude).collect();
        let &[x, y, z, a, b, c] = magnitudes.as_slice() else { return Interval::undefined() };
        let lo = self.value(&[x.1, y.1, z.1, a.0, b.0, c.0]);
        let hi = self.value(&[x.0, y.0, z.0, a.1, b.1, c.1]);
        if lo.is_nan() || hi.is_nan() {
            return Interval::undefined();
        }
        let error =
            |x: f64, y: f64, z: f64| ROUNDING * [x, y, z, a.1, b.1, c.1].into_iter().fold(0.0, f64::max);
        Interval { lo: lo - error(x.1, y.1, z.1), hi: hi + error(x.0, y.0, z.0) }
    }

    /// The distance bends like its level surfaces: at the distance f inside, with a curvature of κ/(1 − κf), where
    /// κ ≤ e₂/e₀² is that of the ellipsoid. Deeper than the smallest radius of curvature lie its creases.
    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        let &[.., a, b, c] = arguments else { return f64::INFINITY };
        if [a, b, c].iter().any(|axis| axis.lo != axis.hi) {
            return f64::INFINITY;
        }
        let axes = [a.lo.abs(), b.lo.abs(), c.lo.abs()];
        let (smallest, largest) = axes.iter().fold((f64::MAX, 0.0f64), |(s, l), e| (s.min(*e), l.max(*e)));
        let sharpest = largest / (smallest * smallest);
        let rest = 1.0 - sharpest * self.interval(arguments).hi;
        // An undefined rest fails the comparison.
        if rest > 0.0 { sharpest / rest * (1.0 + 1e-12) } else { f64::INFINITY }
    }

    fn is_black_box(&self) -> bool {
        false
    }

    /// By the envelope theorem: −n for the point, and eₖnₖ²/√Σ(en)² for the half-axes.
    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let Some((y, e)) = split(arguments) else {
            gradient.fill(f64::NAN);
            return;
        };
        let normal = Closest::new(y, e).normal;
        let support = length([0, 1, 2].map(|k| e[k] * normal[k]));
        for k in 0..3 {
            gradient[k] = -normal[k].copysign(arguments[k]);
            gradient[k + 3] = (e[k] * normal[k] * normal[k] / support).copysign(arguments[k + 3]);
        }
    }
}

/// More than the rounding errors of a distance, relative to the largest argument.
const ROUNDING: f64 = 1e-13;

/// The smallest and the largest |value|.
fn magnitude(interval: &Interval<f64>) -> (f64, f64) {
    let (lo, hi) = (interval.lo, interval.hi);
    let smallest = if lo <= 0.0 && hi >= 0.0 { 0.0 } else { lo.abs().min(hi.abs()) };
    // `max` would hide an undefined end.
    let largest = if lo.is_nan() || hi.is_nan() { f64::NAN } else { lo.abs().max(hi.abs()) };
    (smallest, largest)
}
