//! Free-form solids: scalar splines of three variables over a box, by control values.

use crate::bernstein::{Patch, gradient_room, slack};
use crate::voxels::b_spline;
use fieldstone_field::{Function, Interval};

/// No Bézier volume has more control values along an axis.
const MAX_BEZIER: usize = crate::bernstein::MAX_COUNT;
/// No volume has more control values in all.
const MAX_CONTROLS: usize = 1 << 20;
/// A box over more pieces than this is bounded by the control values alone.
const FEW_PIECES: usize = 27;

/// How control values make a function.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Basis {
    /// One polynomial Σ cᵢⱼₖ Bᵢ(u) Bⱼ(v) Bₖ(w), of a degree one less than the number of control values.
    Bezier,
    /// Uniform cubic B-splines: pieces that change with few control values; at least four along each axis.
    BSpline,
}

/// A scalar spline over a box; negative is inside. Beyond the box it is what it is at the nearest point of it.
#[derive(Clone, Debug)]
pub struct SplineVolume {
    counts: [usize; 3],
    controls: Vec<f64>,
    basis: Basis,
    low: [f64; 3],
    size: [f64; 3],
    /// A bound of the rounding errors of values and bounds.
    slack: f64,
}

/// Why numbers make no [`SplineVolume`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum SplineError {
    /// Too few or too many control values.
    #[error("{} × {} × {} control values are too few or too many: {} along each axis", .counts[0], .counts[1], .counts[2], match .basis { Basis::Bezier => "2 to 16", Basis::BSpline => "4 or more" })]
    Counts {
        /// How many along each axis.
        counts: [usize; 3],
        /// Of which splines.
        basis: Basis,
    },
    /// Not as many control values as the counts say.
    #[error("the volume needs {needed} control values, and {found} are given")]
    Missing {
        /// How many it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A number that is not finite, or a box without a size.
    #[error("control values must be finite numbers, and the box finite and not empty")]
    NotFinite,
}

impl SplineVolume {
    /// `controls` are those along x first, then along y, then z, for the box from `low` to `high`.
    ///
    /// # Errors
    /// Control values that are missing, too many or not finite; an empty box.
    pub fn new(
        counts: [usize; 3],
        controls: Vec<f64>,
        basis: Basis,
        [low, high]: [[f64; 3]; 2],
    ) -> Result<Self, SplineError> {
        let allowed = match basis {
            Basis::Bezier => 2..=MAX_BEZIER,
            Basis::BSpline => 4..=MAX_CONTROLS,
        };
        let needed = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        let needed = match needed {
            Some(needed) if needed <= MAX_CONTROLS && counts.iter().all(|n| allowed.contains(n)) => needed,
            _ => return Err(SplineError::Counts { counts, basis }),
        };
        if controls.len() != needed {
            return Err(SplineError::Missing { needed, found: controls.len() });
        }
        let size = [0, 1, 2].map(|k| high[k] - low[k]);
        let is_box = size.iter().all(|s| s.is_finite() && *s > 0.0) && low.iter().all(|l| l.is_finite());
        if !is_box || controls.iter().any(|c| !c.is_finite()) {
            return Err(SplineError::NotFinite);
        }
        let largest = controls.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let (count, pieces) = match basis {
            Basis::Bezier => (MAX_BEZIER, [1; 3]),
            Basis::BSpline => (4, counts),
        };
        let slack = slack(largest, count, pieces);
        Ok(Self { counts, controls, basis, low, size, slack })
    }

    /// How many pieces there are along an axis.
    fn pieces(&self, axis: usize) -> usize {
        match self.basis {
            Basis::Bezier => 1,
            Basis::BSpline => self.counts[axis] - 3,
        }
    }

    /// A coordinate in pieces from the lower side, kept in the box.
    fn place(&self, axis: usize, x: f64) -> f64 {
        let pieces = self.pieces(axis) as f64;
        ((x - self.low[axis]) / self.size[axis] * pieces).clamp(0.0, pieces)
    }

    fn piece_of(&self, axis: usize, place: f64) -> usize {
        (place as usize).min(self.pieces(axis) - 1)
    }

    fn patch(&self, piece: [usize; 3]) -> Patch {
        if self.basis == Basis::Bezier {
            return Patch::new(self.counts, self.controls.clone());
        }
        let [m, n, _] = self.counts;
        let control = |c: usize| {
            let i = [0, 1, 2].map(|k| piece[k] + (c >> (2 * k) & 3));
            self.controls[i[0] + m * (i[1] + n * i[2])]
        };
        let mut patch = Patch::new([4; 3], (0..64).map(control).collect());
        for axis in 0..3 {
            patch.map_rows(axis, b_spline);
        }
        patch
    }

    fn at(&self, arguments: &[f64]) -> Option<(Patch, [f64; 3])> {
        if arguments.len() != 3 || arguments.iter().any(|a| !a.is_finite()) {
            return None;
        }
        let places = [0, 1, 2].map(|k| self.place(k, arguments[k]));
        let piece = [0, 1, 2].map(|k| self.piece_of(k, places[k]));
        Some((self.patch(piece), [0, 1, 2].map(|k| places[k] - piece[k] as f64)))
    }

    /// The pieces that a box meets with the parts of them in the box; `None` where these are many.
    fn parts(&self, sides: &[Interval<f64>]) -> Option<Vec<(Patch, [Interval<f64>; 3])>> {
        let spans = [0, 1, 2].map(|k| [self.place(k, sides[k].lo), self.place(k, sides[k].hi)]);
        let first = [0, 1, 2].map(|k| self.piece_of(k, spans[k][0]));
        let counts = [0, 1, 2].map(|k| self.piece_of(k, spans[k][1]) - first[k] + 1);
        let all: usize = counts.iter().product();
        let part = |c: usize| {
            let offset = [c % counts[0], c / counts[0] % counts[1], c / counts[0] / counts[1]];
            let piece = [0, 1, 2].map(|k| first[k] + offset[k]);
            let part = [0, 1, 2].map(|k| {
                let [lo, hi] = spans[k].map(|p| (p - piece[k] as f64).clamp(0.0, 1.0));
                Interval::new(lo, hi)
            });
            (self.patch(piece), part)
        };
        (all <= FEW_PIECES).then(|| (0..all).map(part).collect())
    }

    fn is_within(&self, sides: &[Interval<f64>]) -> bool {
        let high = |k: usize| self.low[k] + self.size[k];
        (0..3).all(|k| sides[k].lo >= self.low[k] && sides[k].hi <= high(k))
    }
}

impl Function for SplineVolume {
    fn name(&self) -> &str {
        "a spline volume"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        self.at(arguments).map_or(f64::NAN, |(patch, at)| patch.value(at))
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        if arguments.len() != 3 || arguments.iter().any(|a| a.lo.is_nan() || a.hi.is_nan()) {
            return Interval::undefined();
        }
        if arguments.iter().all(|a| a.lo == a.hi) {
            let value = self.value(&[arguments[0].lo, arguments[1].lo, arguments[2].lo]);
            return Interval::new(value - self.slack, value + self.slack);
        }
        let join = |a: Interval<f64>, b: Interval<f64>| Interval::new(a.lo.min(b.lo), a.hi.max(b.hi));
        let parts = self.parts(arguments).into_iter().flatten();
        let hulls = parts.map(|(patch, part)| patch.restricted(part).hull());
        let range = hulls.reduce(join).unwrap_or_else(|| crate::bernstein::hull(&self.controls));
        Interval::new(range.lo - self.slack, range.hi + self.slack)
    }

    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        if arguments.len() != 3 || !self.is_within(arguments) {
            return f64::INFINITY;
        }
        let Some(parts) = self.parts(arguments) else { return f64::INFINITY };
        let scale = [0, 1, 2].map(|k| self.pieces(k) as f64 / self.size[k]);
        let bends = parts.into_iter().map(|(patch, _)| {
            let error = patch.gradient_error(scale, self.slack);
            patch.bend(scale, self.slack) + gradient_room(error, arguments)
        });
        bends.fold(0.0, f64::max)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let Some((patch, at)) = self.at(arguments) else {
            gradient.fill(f64::NAN);
            return;
        };
        let slopes = patch.gradient(at);
        for (k, slope) in gradient.iter_mut().enumerate() {
            let x = arguments[k];
            let is_within = self.low[k] <= x && x <= self.low[k] + self.size[k];
            *slope = if is_within { slopes[k] * self.pieces(k) as f64 / self.size[k] } else { 0.0 };
        }
    }
}
