//! The field of a cell between two planes.

use fieldstone_field::Interval;

/// An enclosure of the field in a cell: f(x) ∈ value + gradient·(x − centre) ± error, and all slopes of the field lie
/// within `radius` of the gradient, axis by axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) centre: [f64; 3],
    pub(super) value: f64,
    pub(super) gradient: [f64; 3],
    pub(super) radius: [f64; 3],
    pub(super) error: f64,
}

/// The slopes of a facet that needs no closer look differ by at most so much of their size.
const CLOSE: f64 = 0.4;

/// More than all roundings of the few sums that make a facet.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Facet {
    /// From the value at the centre of a cell, bounds of the slopes in the cell, and half its extent. None unless all are
    /// finite.
    pub(super) fn new(
        centre: [f64; 3],
        half: [f64; 3],
        value: Interval<f64>,
        slopes: [Interval<f64>; 3],
    ) -> Option<Self> {
        let gradient = slopes.map(|s| 0.5 * s.lo + 0.5 * s.hi);
        let radius = slopes.map(|s| (0.5 * s.hi - 0.5 * s.lo) * (1.0 + ROUNDING) + f64::MIN_POSITIVE);
        let middle = 0.5 * value.lo + 0.5 * value.hi;
        let mut error = 0.5 * value.hi - 0.5 * value.lo;
        let mut size = middle.abs();
        for axis in 0..3 {
            error += radius[axis] * half[axis];
            size += gradient[axis].abs() * half[axis];
        }
        let error = error * (1.0 + ROUNDING) + ROUNDING * size;
        let is_finite = error.is_finite() && size.is_finite();
        is_finite.then_some(Self { centre, value: middle, gradient, radius, error })
    }

    /// Bounds of the field in the cell.
    pub(super) fn range(&self, half: [f64; 3]) -> (f64, f64) {
        let sway: f64 = (0..3).map(|axis| self.gradient[axis].abs() * half[axis]).sum();
        let reach = (sway + self.error) * (1.0 + ROUNDING);
        (self.value - reach, self.value + reach)
    }

    /// Whether the field is certainly negative (`true`) or certainly positive at a point of the cell.
    pub(super) fn side(&self, point: [f64; 3]) -> Option<bool> {
        let way = |axis: usize| self.gradient[axis] * (point[axis] - self.centre[axis]);
        let value = self.value + way(0) + way(1) + way(2);
        // Roundings of the sum are far below those that the error has room for.
        let error = self.error * (1.0 + ROUNDING) + ROUNDING * value.abs();
        (value.abs() > error).then_some(value < 0.0)
    }

    /// Whether the slopes lie so close together that nearly all rays need nothing else.
    pub(super) fn is_close(&self) -> bool {
        let length = |v: [f64; 3]| v.into_iter().map(|x| x * x).sum::<f64>().sqrt();
        length(self.radius) <= CLOSE * length(self.gradient)
    }
}
