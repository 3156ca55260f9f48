//! Mixed affine arithmetic: a revised affine form with one symbol, carried together with an interval.
//!
//! A value over a span of a ray is `centre + slope·ε ± error`, ε ∈ \[−1, 1\] being the place in the span, and at the
//! same time lies in an interval. Products follow the revised affine form (Vu 2004; Fryazinov, Pasko and Comninos 2010),
//! square roots and reciprocals the Chebyshev fit, smooth functions a Taylor form whose second derivative the
//! interval bounds, and √(x² + y²) inside R-functions the tangent of Cauchy and Schwarz. After every operation
//! the two ranges are intersected, and a form whose error alone exceeds the interval is made anew from it.
//!
//! Differences from the literature: every operation adds its rounding errors (Knoll et al. 2009 leave them out), and
//! fits are made over the intersected range.

mod domain;

use crate::Real;
use crate::domain::Domain;
use crate::interval::Interval;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A set of values over a span, with its slope along the span.
///
/// Cost: about seven times one value for each operation; the width falls with the square of the span's length.
#[derive(Clone, Copy, Debug)]
pub struct Affine<R> {
    /// The value in the middle of the span.
    pub centre: R,
    /// Half the change over the span.
    pub slope: R,
    /// How far values may lie from the line, ≥ 0; infinite or NaN where the line says nothing.
    pub error: R,
    /// The range.
    pub range: Interval<R>,
}

impl<R: Real> Affine<R> {
    /// The line `centre + slope·ε ± error`.
    #[inline(always)]
    pub fn line(centre: R, slope: R, error: R) -> Self {
        let range = Interval::everything(centre);
        Self::make(centre, slope, error, range, centre.magnitude() + slope.magnitude())
    }

    /// A coordinate of a ray, origin + direction·t, for t from `start` to `end`.
    #[inline(always)]
    pub fn along_ray(origin: R, direction: R, start: R, end: R) -> Self {
        let half = R::splat(origin.token(), 0.5);
        let (middle, reach) = ((start + end) * half, (end - start) * half);
        let furthest = start.magnitude().greater(end.magnitude());
        let magnitude = origin.magnitude() + direction.magnitude() * furthest;
        let slack = magnitude * R::splat(origin.token(), 2.0 * R::ULP);
        Self::line(origin + direction * middle, direction * reach, slack)
    }

    /// A value in an interval of which nothing else is known.
    #[inline(always)]
    pub fn from_interval(range: Interval<R>) -> Self {
        let t = range.lo.token();
        let (half, zero) = (R::splat(t, 0.5), R::splat(t, 0.0));
        let centre = range.lo * half + range.hi * half;
        let slack = (range.lo.magnitude() + range.hi.magnitude()) * R::splat(t, R::ULP);
        let error = (range.hi - centre).greater(centre - range.lo) + slack + R::splat(t, R::TINY);
        Self { centre, slope: zero, error, range }
    }

    /// A line and an interval that both hold, `magnitude` bounding the terms that were rounded on the way.
    #[inline(always)]
    fn make(centre: R, slope: R, error: R, range: Interval<R>, magnitude: R) -> Self {
        let error = error * centre.like(1.0 + 8.0 * R::ULP)
            + (magnitude * centre.like(4.0 * R::ULP) + centre.like(R::TINY));
        let reach = slope.magnitude() + error;
        let (lo, hi) = (centre - reach, centre + reach);
        let lo = R::pick(range.lo.is_lt(lo), lo, range.lo);
        let hi = R::pick(hi.is_lt(range.hi), hi, range.hi);
        // A line whose error alone reaches as far as the range says nothing that the range does not. Comparisons with
        // NaN are false, so that a line that overflowed is dropped here, as one where the value may be undefined.
        let keep = error.is_lt((hi - lo) * centre.like(0.5));
        let line = Self { centre, slope, error, range: Interval { lo, hi } };
        if !R::any(!keep) {
            return line;
        }
        Self::choose(keep, line, Self::from_interval(line.range))
    }

    /// α·X + ζ ± δ.
    #[inline(always)]
    fn fitted(self, alpha: R, zeta: R, delta: R, range: Interval<R>) -> Self {
        let (centre, slope) = (alpha * self.centre, alpha * self.slope);
        let magnitude = centre.magnitude() + zeta.magnitude() + slope.magnitude();
        Self::make(centre + zeta, slope, alpha.magnitude() * self.error + delta, range, magnitude)
    }

    /// The middle of the range.
    #[inline(always)]
    fn middle(self) -> R {
        let half = R::splat(self.centre.token(), 0.5);
        self.range.lo * half + self.range.hi * half
    }

    /// A smooth function by its value and first derivative at the middle `m` of the range, its second derivative over
    /// the range, and its image.
    #[inline(always)]
    fn taylor(self, value: R, first: R, second: Interval<R>, image: Interval<R>) -> Self {
        let (m, zero) = (self.middle(), self.centre.like(0.0));
        let reach = (self.range.hi - m).greater(m - self.range.lo) * self.centre.like(1.0 + 4.0 * R::ULP);
        let quarter = reach * reach * self.centre.like(0.25);
        let (least, most) = (second.lo.lesser(zero) * quarter, second.hi.greater(zero) * quarter);
        let distance = self.centre - m;
        let magnitude = value.magnitude() * self.centre.like(2.0)
            + first.magnitude() * (self.centre.like(2.0) * reach + self.centre.magnitude() + m.magnitude())
            + (most - least);
        let slope = first * self.slope;
        // A second derivative that overflowed, or is undefined, leaves NaN here and with it only the image.
        let poison = (second.hi - second.lo) * zero;
        // The derivative may have underflowed.
        let lost = (reach + self.slope.magnitude() + self.error) * self.centre.like(R::TINY);
        let error = first.magnitude() * self.error + (most - least) + poison + lost;
        Self::make(value + first * distance + (most + least), slope, error, image, magnitude)
    }

    /// The image of an operation that leaves nothing to be said of the slope.
    #[inline(always)]
    fn only(image: Interval<R>) -> Self {
        Self::from_interval(image)
    }

    /// √(x² + y²) as a tangent plane: ux + vy + gap, gap between 0 and the largest gap at a corner.
    #[inline(always)]
    fn length(self, other: Self) -> Self {
        let (x, y) = (self.range, other.range);
        let centre_length = plain_length(self.centre, other.centre);
        let (u, v) = (self.centre / centre_length, other.centre / centre_length);
        let gaps = [
            tangent_gap((u, v), x.lo, y.lo),
            tangent_gap((u, v), x.lo, y.hi),
            tangent_gap((u, v), x.hi, y.lo),
            tangent_gap((u, v), x.hi, y.hi),
        ];
        let largest = (gaps[0].greater(gaps[1])).greater(gaps[2].greater(gaps[3]));
        // A gap that overflowed is NaN, and the larger of NaN and a number may be either.
        let poison = ((gaps[0] + gaps[1]) + (gaps[2] + gaps[3])) * self.centre.like(0.0);
        // u and v are rounded, so that the gap may be negative by as much as their error allows.
        let slack = (x.magnitude() + y.magnitude()) * self.centre.like(8.0 * R::ULP) + poison;
        // Squares may underflow, which a root makes large.
        let slack = slack + self.centre.like(8.0 * R::TINY.sqrt());
        let half = largest * self.centre.like(0.5) + slack;
        let centre = u * self.centre + v * other.centre + half;
        let slope = u * self.slope + v * other.slope;
        let error = u.magnitude() * self.error + v.magnitude() * other.error + half + slack;
        let magnitude = x.magnitude() + y.magnitude() + half;
        let image = (Domain::square(x) + Domain::square(y)).whole_if_undefined().sqrt();
        Self::make(centre, slope, error, image, magnitude)
    }
}

#[inline(always)]
fn plain_length<R: Real>(a: R, b: R) -> R {
    (a * a + b * b).root()
}

/// How far √(a² + b²) lies above the tangent ua + vb.
#[inline(always)]
fn tangent_gap<R: Real>((u, v): (R, R), a: R, b: R) -> R {
    plain_length(a, b) - u * a - v * b
}

impl<R: Real> Interval<R> {
    /// All reals; undefined where `like` is.
    #[inline(always)]
    fn everything(like: R) -> Self {
        let infinity = R::splat(like.token(), f64::INFINITY);
        let nan = like.is_nan_mask();
        Self { lo: R::pick(nan, like, -infinity), hi: R::pick(nan, like, infinity) }
    }

    /// A sum of squares that overflowed is not undefined: it lies above 0.
    #[inline(always)]
    fn whole_if_undefined(self) -> Self {
        let nan = self.lo.is_nan_mask();
        let t = self.lo.token();
        Self {
            lo: R::pick(nan, R::splat(t, 0.0), self.lo),
            hi: R::pick(nan, R::splat(t, f64::INFINITY), self.hi),
        }
    }
}

impl<R: Real> Add for Affine<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (centre, slope) = (self.centre + other.centre, self.slope + other.slope);
        let magnitude = centre.magnitude() + slope.magnitude();
        Self::make(centre, slope, self.error + other.error, self.range + other.range, magnitude)
    }
}

impl<R: Real> Sub for Affine<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<R: Real> Mul for Affine<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let half = R::splat(self.centre.token(), 0.5);
        let slopes = half * (self.slope * other.slope);
        let centre = self.centre * other.centre + slopes;
        let slope = self.centre * other.slope + self.slope * other.centre;
        let u = self.centre.magnitude() + self.slope.magnitude();
        let v = other.centre.magnitude() + other.slope.magnitude();
        let error = self.error * (v + other.error) + other.error * u + slopes.magnitude();
        Self::make(centre, slope, error, self.range * other.range, u * v)
    }
}

impl<R: Real> Div for Affine<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let product = self * other.recip();
        let image = self.range / other.range;
        let magnitude = product.centre.magnitude() + product.slope.magnitude();
        Self::make(product.centre, product.slope, product.error, image, magnitude)
    }
}

impl<R: Real> Neg for Affine<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { centre: -self.centre, slope: -self.slope, error: self.error, range: -self.range }
    }
}

impl<R: Real> Affine<R> {
    /// Bounds of asin″ = x/(1 − x²)^(3/2).
    #[inline(always)]
    fn asin_bend(self) -> Interval<R> {
        let rest = Interval::point(self.centre.like(1.0)) - Domain::square(self.range);
        self.range / (rest * Domain::sqrt(rest))
    }

    /// `self − divisor·q` wherever the whole number q is the same all over, otherwise nothing but the image.
    #[inline(always)]
    fn remainder(self, divisor: Self, quotient: Interval<R>, image: Interval<R>) -> Self {
        let q = quotient.lo;
        let same = q.is_eq(quotient.hi) & q.magnitude().is_lt(self.centre.like(1e9));
        let zero = self.centre.like(0.0);
        let whole = Self { centre: q, slope: zero, error: zero, range: Interval::point(q) };
        let line = self - divisor * whole;
        let error = R::pick(same, line.error, self.centre.like(f64::INFINITY));
        Self::make(line.centre, line.slope, error, image, line.centre.magnitude() + line.slope.magnitude())
    }
}

impl<R: Real> Interval<R> {
    /// The same set without what lies further from 0 than `bound`, which is known to be one; undefined ends become it.
    #[inline(always)]
    fn within(self, bound: R) -> Self {
        let lo = R::pick((-bound).is_lt(self.lo), self.lo, -bound);
        Self { lo, hi: R::pick(self.hi.is_lt(bound), self.hi, bound) }
    }
}
