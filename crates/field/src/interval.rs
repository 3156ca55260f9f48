//! Intervals, rounded outward.

/// A set of extended reals between two ends.
///
/// NaN ends mean *anything, or nothing at all*: the value may be undefined somewhere. An infinite end is only an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<R> {
    /// The lower end.
    pub lo: R,
    /// The upper end.
    pub hi: R,
}

impl Interval<f64> {
    /// Anything, or nothing at all.
    pub const fn undefined() -> Self {
        Self { lo: f64::NAN, hi: f64::NAN }
    }
}
