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
