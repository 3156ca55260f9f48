//! Functions that a program calls as a whole: black boxes of the user, and library functions without a closed form.

use crate::Interval;
use std::fmt;

/// A function of several reals that a program calls as one operation.
///
/// Only [`value`](Function::value) must be written. Without [`interval`](Function::interval) the function is a black
/// box: nothing can be proved about it, so that rays find it by sampling only and their hits are *undecided*.
pub trait Function: Send + Sync {
    /// A name for listings and messages.
    fn name(&self) -> &str;

    /// The value at a point; NaN where undefined.
    fn value(&self, arguments: &[f64]) -> f64;

    /// An interval that holds the value at every point of the box `arguments`, rounding errors of
    /// [`value`](Function::value) included; [`Interval::undefined`] where nothing is known (the default).
    fn interval(&self, _arguments: &[Interval<f64>]) -> Interval<f64> {
        Interval::undefined()
    }

    /// A bound of the second derivative along every unit direction of the argument space, all over the box
    /// `arguments`; the gradient may have kinks, but no jumps. Infinite where nothing is known (the default).
    ///
    /// A finite bound is a promise about [`gradient`](Function::gradient) too: its error is below 10⁻¹⁰ of its largest
    /// component. Intervals and affine forms then follow the function with an error that falls with the square of
    /// the size of the box.
    fn curvature(&self, _arguments: &[Interval<f64>]) -> f64 {
        f64::INFINITY
    }

    /// Whether nothing but single values is known.
    fn is_black_box(&self) -> bool {
        true
    }

    /// The partial derivatives at a point, one for each argument; central differences by default.
    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let mut moved = arguments.to_vec();
        for (i, slope) in gradient.iter_mut().enumerate() {
            let step = 6e-6 * arguments[i].abs().max(1.0);
            moved[i] = arguments[i] + step;
            let above = self.value(&moved);
            moved[i] = arguments[i] - step;
            let below = self.value(&moved);
            moved[i] = arguments[i];
            *slope = (above - below) / (2.0 * step);
        }
    }
}

impl fmt::Debug for dyn Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Function({})", self.name())
    }
}

/// A function near a point of a box: it lies in `value` + gradient · (X − point) ± `bend` all over the box.
pub(crate) struct Expansion {
    /// The value at the point, with its rounding errors.
    pub(crate) value: Interval<f64>,
    /// By how much the function may leave its tangent in the box.
    pub(crate) bend: f64,
}

/// Expands a function around a point of a box and leaves its derivatives in `gradient`; `None` where its second
/// derivatives have no known bound.
pub(crate) fn expand(
    function: &dyn Function,
    boxes: &[Interval<f64>],
    point: &[f64],
    gradient: &mut [f64],
) -> Option<Expansion> {
    let curvature = function.curvature(boxes);
    if !curvature.is_finite() {
        return None;
    }
    let single: Vec<Interval<f64>> = point.iter().map(|&p| Interval::new(p, p)).collect();
    let value = function.interval(&single);
    function.gradient(point, gradient);
    let steepest = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    let (mut reach, mut squares) = (0.0, 0.0);
    for (b, p) in boxes.iter().zip(point) {
        let distance = (b.hi - p).max(p - b.lo);
        reach += distance;
        squares += distance * distance;
    }
    let bend = (0.5 * curvature * squares + GRADIENT_ERROR * steepest * reach) * (1.0 + 1e-12);
    (value.lo.is_finite() && value.hi.is_finite() && bend.is_finite()).then_some(Expansion { value, bend })
}

/// The error of gradients, relative to their largest component.
const GRADIENT_ERROR: f64 = 1e-10;

/// A closure as a black box.
pub(crate) struct Closure<F> {
    pub(crate) value: F,
}

impl<F: Fn(&[f64]) -> f64 + Send + Sync> Function for Closure<F> {
    fn name(&self) -> &str {
        "black box"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        (self.value)(arguments)
    }
}
