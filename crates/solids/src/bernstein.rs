//! Polynomials over a box by their Bernstein coefficients: values, slopes, and bounds from the convex hull.
//!
//! A polynomial lies between its least and its greatest coefficient over the unit cube (the convex hull property), and
//! its derivatives have the differences of the coefficients as theirs. Over a part of the cube the coefficients are
//! found by de Casteljau's construction; how far they lie from the values falls with the square of its size.
//!
//! # Rounding
//! With u = 2⁻⁵³ and M the largest size of the coefficients: a step a + t(b − a) with t in \[0, 1\] rounds by at most 2u·2M + uM =
//! 5uM, and hands on errors of a and b without making them larger. Values take n − 1 rows of such steps along each of three axes,
//! parts 2(n − 1), with one more rounding of where they start, which moves them by u along rows as steep as 2(n − 1)M.
//! Coefficients of cubic kinds are made of at most seven operations along each axis on numbers up to 6M/6. Together:
//! less than (51(n − 1) + 21)uM; [`slack`] has that twice. Where a point is in its piece is rounded three times relative to the number of
//! pieces p: 3up along rows as steep as 2(n − 1)M.

use fieldstone_field::Interval;

/// The most coefficients along an axis.
pub(crate) const MAX_COUNT: usize = 16;

/// A bound of the rounding errors of values and bounds, for coefficients of at most this size, at most `count` along an
/// axis, in `pieces` along each.
pub(crate) fn slack(largest: f64, count: usize, pieces: [usize; 3]) -> f64 {
    let degree = (count - 1) as f64;
    let places: f64 = pieces.iter().map(|&p| 6.0 * degree * p as f64).sum();
    f64::EPSILON * largest * (51.0 * degree + 21.0 + places) + f64::MIN_POSITIVE
}

/// A polynomial of three variables over the unit cube.
#[derive(Clone, Debug)]
pub(crate) struct Patch {
    /// How many coefficients there are along each axis: the degree and 1.
    counts: [usize; 3],
    /// The coefficients, those along x next to one another.
    coefficients: Vec<f64>,
}

impl Patch {
    /// As many coefficients as the counts say.
    pub(crate) fn new(counts: [usize; 3], coefficients: Vec<f64>) -> Self {
        debug_assert_eq!(counts.iter().product::<usize>(), coefficients.len());
        Self { counts, coefficients }
    }

    /// How far apart neighbours along an axis stand.
    fn stride(&self, axis: usize) -> usize {
        self.counts[..axis].iter().product()
    }

    /// Changes each row along an axis.
    pub(crate) fn map_rows(&mut self, axis: usize, mut change: impl FnMut(&mut [f64])) {
        let (stride, count) = (self.stride(axis), self.counts[axis]);
        let mut row = [0.0; MAX_COUNT];
        let row = &mut row[..count];
        for block in self.coefficients.chunks_mut(stride * count) {
            for start in 0..stride {
                for (i, value) in row.iter_mut().enumerate() {
                    *value = block[start + i * stride];
                }
                change(row);
                for (i, value) in row.iter().enumerate() {
                    block[start + i * stride] = *value;
                }
            }
        }
    }

    /// The polynomial over a part of the cube, as one over the unit cube.
    pub(crate) fn restricted(mut self, part: [Interval<f64>; 3]) -> Self {
        for (axis, side) in part.into_iter().enumerate() {
            if side.lo == 0.0 && side.hi == 1.0 {
                continue;
            }
            self.map_rows(axis, |row| restrict(row, side));
        }
        self
    }

    /// The least and the greatest coefficient: bounds of the values.
    pub(crate) fn hull(&self) -> Interval<f64> {
        hull(&self.coefficients)
    }

    /// The derivative along an axis, per side of the cube.
    pub(crate) fn derivative(&self, axis: usize) -> Self {
        let (stride, count) = (self.stride(axis), self.counts[axis]);
        let mut counts = self.counts;
        counts[axis] = (count - 1).max(1);
        if count == 1 {
            return Self::new(counts, vec![0.0; self.coefficients.len()]);
        }
        let degree = (count - 1) as f64;
        let mut coefficients = Vec::with_capacity(self.coefficients.len());
        for block in self.coefficients.chunks(stride * count) {
            coefficients.extend(block[stride..].iter().zip(block).map(|(next, this)| degree * (next - this)));
        }
        Self::new(counts, coefficients)
    }

    /// The value at a point of the cube.
    pub(crate) fn value(&self, at: [f64; 3]) -> f64 {
        let mut values = self.coefficients.clone();
        let mut rest = values.len();
        for (axis, &t) in at.iter().enumerate() {
            let count = self.counts[axis];
            for i in 0..rest / count {
                let value = blend_row(&mut values[i * count..(i + 1) * count], t);
                values[i] = value;
            }
            rest /= count;
        }
        values[0]
    }

    /// The partial derivatives at a point, per side of the cube.
    pub(crate) fn gradient(&self, at: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.derivative(axis).value(at))
    }

    /// A bound of the norm of the second derivatives, where the sides of the cube are 1/`scale` units long, with what rounding
    /// does to differences of coefficients that are wrong by `wrong`.
    pub(crate) fn bend(&self, scale: [f64; 3], wrong: f64) -> f64 {
        let mut squares = 0.0;
        for a in 0..3 {
            let first = self.derivative(a);
            for b in a..3 {
                let range = first.derivative(b).hull();
                let [m, n] = [a, b].map(|axis| self.counts[axis] as f64);
                let size = (range.lo.abs().max(range.hi.abs()) + 8.0 * m * n * wrong) * scale[a] * scale[b];
                squares += if a == b { size * size } else { 2.0 * size * size };
            }
        }
        squares.sqrt() * (1.0 + 1e-9)
    }

    /// A bound of the errors of [`gradient`](Self::gradient) times `scale`, for coefficients that are wrong by `wrong`.
    pub(crate) fn gradient_error(&self, scale: [f64; 3], wrong: f64) -> f64 {
        (0..3).map(|k| 4.0 * self.counts[k] as f64 * wrong * scale[k]).fold(0.0, f64::max)
    }
}

/// What an error of the gradient, which does not shrink with boxes as their bends do, adds to a bound of second
/// derivatives: from every point of a box, half of it times the square of the distance to the farthest corner is
/// above the error times the sum of the distances along the axes.
pub(crate) fn gradient_room(error: f64, sides: &[Interval<f64>]) -> f64 {
    let squares: f64 = sides.iter().map(|s| 0.25 * s.width() * s.width()).sum();
    if squares > 0.0 { 4.0 * error / squares.sqrt() } else { 0.0 }
}

/// The least and the greatest of numbers.
pub(crate) fn hull(numbers: &[f64]) -> Interval<f64> {
    let fold = |range: Interval<f64>, &c: &f64| Interval::new(range.lo.min(c), range.hi.max(c));
    numbers.iter().fold(Interval::new(f64::INFINITY, f64::NEG_INFINITY), fold)
}

/// The value of a row of coefficients at t, which overwrites it.
fn blend_row(row: &mut [f64], t: f64) -> f64 {
    for last in (1..row.len()).rev() {
        for i in 0..last {
            row[i] += t * (row[i + 1] - row[i]);
        }
    }
    row[0]
}

/// The coefficients over a part of the unit interval.
fn restrict(row: &mut [f64], part: Interval<f64>) {
    // First what lies left of `hi`, then of that what lies right of `lo`.
    for first in 1..row.len() {
        for i in (first..row.len()).rev() {
            row[i] = row[i - 1] + part.hi * (row[i] - row[i - 1]);
        }
    }
    let start = if part.hi > 0.0 { part.lo / part.hi } else { 0.0 };
    for last in (1..row.len()).rev() {
        for i in 0..last {
            row[i] += start * (row[i + 1] - row[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic() -> Patch {
        let coefficients = (0..64).map(|i| f64::from(i * 37 % 23) - 11.0).collect();
        Patch::new([4; 3], coefficients)
    }

    #[test]
    fn a_part_has_the_values_of_the_whole() {
        let part = [(0.25, 0.75), (0.0, 0.125), (0.5, 1.0)].map(|(lo, hi)| Interval::new(lo, hi));
        let small = cubic().restricted(part);
        for at in [[0.0; 3], [1.0; 3], [0.3, 0.9, 0.5]] {
            let place = [0, 1, 2].map(|k| part[k].lo + at[k] * (part[k].hi - part[k].lo));
            let [a, b] = [small.value(at), cubic().value(place)];
            assert!((a - b).abs() < 1e-12, "{a} {b}");
            let hull = small.hull();
            assert!(hull.lo <= a && a <= hull.hi);
        }
    }

    #[test]
    fn the_hull_closes_with_the_square_of_the_part() {
        // (1 − 2t)² around its minimum, which is 0.
        let excess = |size: f64| {
            let whole = Interval::new(0.0, 1.0);
            let part = [Interval::new(0.5 - size, 0.5 + size), whole, whole];
            -Patch::new([3, 1, 1], vec![1.0, -1.0, 1.0]).restricted(part).hull().lo
        };
        assert!((excess(0.1) - 0.04).abs() < 1e-12 && (excess(0.01) - 0.0004).abs() < 1e-12);
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let at = [0.3, 0.6, 0.2];
        let gradient = cubic().gradient(at);
        for axis in 0..3 {
            let near = |step: f64| {
                let mut p = at;
                p[axis] += step;
                cubic().value(p)
            };
            let slope = (near(1e-5) - near(-1e-5)) / 2e-5;
            assert!((slope - gradient[axis]).abs() < 1e-6);
        }
    }
}
