//! Interval arithmetic, rounded outward.
//!
//! An interval holds every value that an operation takes on its operands, both the exact one and the one that
//! floating-point arithmetic computes. Ends are computed to nearest and then moved outward by more than the error of
//! the operation, so that no rounding mode is ever changed; sums are left alone where they are exact, so that loop
//! counters stay whole numbers.
//!
//! NaN ends mean *anything, or nothing at all*: the value may be undefined somewhere. Every operation hands that on.
//! An infinite end is only an end: the lower end is never +∞, the upper never −∞.

mod domain;

use crate::Real;
use crate::domain::Domain;
use crate::elementary::{Elementary, LIBRARY_ULPS};
use std::f64::consts::{PI, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How far the ends of elementary functions are moved outward, in units of [`Real::ULP`]: by the largest error of an
/// end, and by that of any value inside, which the standard library may have computed. An end moved by a whole number
/// of units is rounded to one that lies no less far out.
#[inline(always)]
fn function_ulps<R: Real>() -> f64 {
    R::FUNCTION_ULPS + LIBRARY_ULPS
}

/// Waves are looked at closely up to here; arguments further away may be anywhere in their period.
const FAR: f64 = 1e6;

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

    /// The reals from `lo` to `hi`.
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// Whether `value` is inside; an undefined interval contains everything, NaN too.
    pub fn contains(&self, value: f64) -> bool {
        self.lo.is_nan() || (self.lo <= value && value <= self.hi)
    }

    /// hi − lo.
    pub fn width(&self) -> f64 {
        self.hi - self.lo
    }
}

impl<R: Real> Interval<R> {
    /// The point `x`, in every lane.
    #[inline(always)]
    pub fn point(x: R) -> Self {
        Self { lo: x, hi: x }
    }

    /// Where every value is certainly above 0.
    #[inline(always)]
    pub fn is_positive(self) -> R::Mask {
        self.zero().is_lt(self.lo)
    }

    /// Where every value is certainly below 0.
    #[inline(always)]
    pub fn is_negative(self) -> R::Mask {
        self.hi.is_lt(self.zero())
    }

    #[inline(always)]
    fn zero(self) -> R {
        R::splat(self.lo.token(), 0.0)
    }

    #[inline(always)]
    fn constant_real(self, k: f64) -> R {
        R::splat(self.lo.token(), k)
    }

    /// Where 0 lies between the ends.
    #[inline(always)]
    fn straddles_zero(self) -> R::Mask {
        self.lo.is_le(self.zero()) & self.zero().is_le(self.hi)
    }

    /// The largest |value|.
    #[inline(always)]
    pub fn magnitude(self) -> R {
        self.lo.magnitude().greater(self.hi.magnitude())
    }

    /// The ends as computed, moved outward by `ulps` relative errors and one underflow.
    #[inline(always)]
    fn rounded(lo: R, hi: R, ulps: f64) -> Self {
        let (lo, hi) = finite_inner_ends(lo, hi);
        let slack = R::splat(lo.token(), ulps * R::ULP);
        let tiny = R::splat(lo.token(), R::TINY);
        Self { lo: lo - (lo.magnitude() * slack + tiny), hi: hi + (hi.magnitude() * slack + tiny) }
    }

    /// The same set without what lies below `floor`, which is known to be a bound.
    #[inline(always)]
    fn at_least(self, floor: R) -> Self {
        Self { lo: R::pick(self.lo.is_lt(floor), floor, self.lo), hi: self.hi }
    }

    /// The same set without what lies above `ceiling`, which is known to be a bound.
    #[inline(always)]
    fn at_most(self, ceiling: R) -> Self {
        Self { lo: self.lo, hi: R::pick(ceiling.is_lt(self.hi), ceiling, self.hi) }
    }

    /// Undefined where the mask is set.
    #[inline(always)]
    fn undefined_where(self, mask: R::Mask) -> Self {
        let nan = self.constant_real(f64::NAN);
        Self { lo: R::pick(mask, nan, self.lo), hi: R::pick(mask, nan, self.hi) }
    }

    /// All reals where the mask is set.
    #[inline(always)]
    fn whole_where(self, mask: R::Mask) -> Self {
        let infinity = self.constant_real(f64::INFINITY);
        Self { lo: R::pick(mask, -infinity, self.lo), hi: R::pick(mask, infinity, self.hi) }
    }

    /// The image under an elementary function that never falls.
    #[inline(always)]
    fn rising(self, f: impl Elementary) -> Self {
        Self::rounded(self.lo.apply(f), self.hi.apply(f), function_ulps::<R>())
    }

    /// Where any value lies outside [−1, 1].
    #[inline(always)]
    fn leaves_unit(self) -> R::Mask {
        self.lo.is_lt(self.constant_real(-1.0)) | self.constant_real(1.0).is_lt(self.hi)
    }

    /// What lies between the least and the greatest of four candidates, undefined where any is.
    #[inline(always)]
    fn hull4(candidates: [R; 4], ulps: f64) -> Self {
        let [p, q, r, s] = candidates;
        let poison = (p + q) + (r + s);
        let lo = (p.lesser(q)).lesser(r.lesser(s));
        let hi = (p.greater(q)).greater(r.greater(s));
        Self::rounded(lo, hi, ulps).undefined_where(poison.is_nan_mask())
    }

    /// Where a periodic extremum at `phase` + k·`period` may lie inside.
    #[inline(always)]
    fn meets(self, phase: f64, period: f64) -> R::Mask {
        let (inverse, phase) = (self.constant_real(1.0 / period), self.constant_real(phase));
        // Nudged outward by far more than the rounding errors of the quotient.
        let nudge = self.constant_real(1e-6) + self.magnitude() * self.constant_real(8.0 * R::ULP / period);
        let below = ((self.lo - phase) * inverse - nudge).round_down();
        let above = ((self.hi - phase) * inverse + nudge).round_down();
        !below.is_eq(above)
    }

    /// A sine-like function with maxima at `maximum` + 2kπ and minima half a turn further.
    #[inline(always)]
    fn wave(self, at: impl Fn(R) -> R, maximum: f64) -> Self {
        let one = self.constant_real(1.0);
        let (l, h) = (at(self.lo), at(self.hi));
        let range = Self::rounded(l.lesser(h), l.greater(h), function_ulps::<R>());
        let wide = !((self.hi - self.lo).is_lt(self.constant_real(TAU)))
            | !self.magnitude().is_lt(self.constant_real(FAR));
        let hi = R::pick(wide | self.meets(maximum, TAU), one, range.hi);
        let lo = R::pick(wide | self.meets(maximum + PI, TAU), -one, range.lo);
        // The sine of an infinity is undefined.
        let infinite = !self.magnitude().is_le(self.constant_real(R::HUGE));
        Self { lo, hi }.at_least(-one).at_most(one).undefined_where(infinite)
    }

    /// A step function that never falls, exact.
    #[inline(always)]
    fn step(self, f: impl Fn(R) -> R) -> Self {
        Self { lo: f(self.lo), hi: f(self.hi) }
    }

    /// A truth value that is certainly 1 or certainly 0 where the masks are set.
    #[inline(always)]
    fn verdict(self, other: Self, surely: R::Mask, surely_not: R::Mask) -> Self {
        let (zero, one) = (self.zero(), self.constant_real(1.0));
        let lo = R::pick(surely, one, zero);
        let hi = R::pick(surely_not, zero, one);
        Self { lo, hi }.undefined_where(self.lo.is_nan_mask() | other.lo.is_nan_mask())
    }

    /// `self − divisor·q` where the whole number q = `round`(self / divisor) is the same all over, otherwise `spread`.
    #[inline(always)]
    fn remainder(self, divisor: Self, round: impl Fn(R) -> R, spread: Self) -> Self {
        let quotient = self / divisor;
        let (q, q_high) = (round(quotient.lo), round(quotient.hi));
        let exact = self - divisor * Self::point(q);
        let same = q.is_eq(q_high) & q.magnitude().is_lt(self.constant_real(1e9));
        let clipped = exact.at_least(spread.lo).at_most(spread.hi);
        // What is left of an infinity is undefined.
        let infinite = !self.magnitude().is_le(self.constant_real(R::HUGE));
        let nothing = divisor.straddles_zero() | quotient.lo.is_nan_mask() | infinite;
        Self::choose(same, clipped, spread).undefined_where(nothing)
    }
}

/// The ends with the lower never +∞ and the upper never −∞.
#[inline(always)]
fn finite_inner_ends<R: Real>(lo: R, hi: R) -> (R, R) {
    let huge = R::splat(lo.token(), R::HUGE);
    (R::pick(huge.is_lt(lo), huge, lo), R::pick(hi.is_lt(-huge), -huge, hi))
}

/// a + b with the sign of the rounding error: what is exact stays exact.
#[inline(always)]
fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The sum rounded down; NaN where it overflows.
#[inline(always)]
fn add_down<R: Real>(a: R, b: R) -> R {
    let (sum, error) = two_sum(a, b);
    let zero = R::splat(a.token(), 0.0);
    let lower = sum - sum.magnitude() * R::splat(a.token(), R::ULP);
    R::pick(zero.is_le(error), sum, lower)
}

impl<R: Real> Add for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let lo = add_down(self.lo, other.lo);
        let hi = -add_down(-self.hi, -other.hi);
        let finite = (hi - lo).is_le(self.constant_real(R::HUGE));
        let sum = Self { lo, hi };
        if R::any(!finite) {
            // Chosen lane by lane, so that no value depends on its neighbours.
            return Self::choose(finite, sum, Self::add_unbounded(self, other));
        }
        sum
    }
}

impl<R: Real> Interval<R> {
    /// A sum of which an end may be infinite or undefined.
    #[inline(always)]
    fn add_unbounded(self, other: Self) -> Self {
        let (lo, hi) = (self.lo + other.lo, self.hi + other.hi);
        let infinity = self.constant_real(f64::INFINITY);
        let sum = Self::rounded(lo, hi, 1.0);
        // ∞ − ∞ can only come about where both ends are infinite.
        sum.undefined_where(sum.lo.is_eq(-infinity) & sum.hi.is_eq(infinity))
    }
}

impl<R: Real> Sub for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<R: Real> Mul for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let products = [self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi];
        let [p, q, r, s] = products;
        let (lo, hi) = (p.lesser(q).lesser(r.lesser(s)), p.greater(q).greater(r.greater(s)));
        let (zero, huge) = (self.zero(), self.constant_real(R::HUGE));
        // NaN among the products shows in their sum.
        let finite = ((p + q) + (r + s)).magnitude().is_lt(huge) & (hi - lo).is_lt(huge);
        let product = if R::any(!finite) {
            Self::hull4(products, 1.0)
        } else {
            let (slack, tiny) = (self.constant_real(R::ULP), self.constant_real(R::TINY));
            Self { lo: lo - (lo.magnitude() * slack + tiny), hi: hi + (hi.magnitude() * slack + tiny) }
        };
        // A comparison, because the larger of NaN and 0 may be 0: what is undefined must stay so.
        let positive = zero.is_le(self.lo) & zero.is_le(other.lo) & product.lo.is_lt(zero);
        Self { lo: R::pick(positive, zero, product.lo), hi: product.hi }
    }
}

impl<R: Real> Div for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotients = [self.lo / other.lo, self.lo / other.hi, self.hi / other.lo, self.hi / other.hi];
        let quotient = Self::hull4(quotients, 1.0);
        let pole = other.straddles_zero();
        // ∞/∞ is undefined wherever both ends may be reached; without a pole the quotients show it themselves.
        let huge = self.constant_real(R::HUGE);
        let infinite = huge.is_lt(self.magnitude()) & huge.is_lt(other.magnitude());
        let nothing = self.lo.is_nan_mask() | (pole & (self.straddles_zero() | infinite));
        quotient.whole_where(pole).undefined_where(nothing)
    }
}

impl<R: Real> Neg for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}
