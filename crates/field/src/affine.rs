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

use crate::domain::Domain;
use crate::interval::Interval;
use crate::{Function, Real};
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
        let error = first.magnitude() * self.error + (most - least) + poison;
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

impl<R: Real> Domain for Affine<R> {
    type Real = R;

    #[inline(always)]
    fn token(self) -> R::Token {
        self.centre.token()
    }
    #[inline(always)]
    fn constant(token: R::Token, k: f64) -> Self {
        let range: Interval<R> = Domain::constant(token, k);
        let zero = R::splat(token, 0.0);
        let centre = R::splat(token, k);
        // No error where the constant is exact.
        let error = (range.hi - centre).greater(centre - range.lo);
        Self { centre, slope: zero, error, range }
    }
    #[inline(always)]
    fn undefined(token: R::Token) -> Self {
        Self::from_interval(Domain::undefined(token))
    }
    #[inline(always)]
    fn truth(self) -> (R::Mask, R::Mask) {
        self.range.truth()
    }
    #[inline(always)]
    fn is_undefined(self) -> R::Mask {
        self.range.is_undefined()
    }
    #[inline(always)]
    fn choose(mask: R::Mask, a: Self, b: Self) -> Self {
        Self {
            centre: R::pick(mask, a.centre, b.centre),
            slope: R::pick(mask, a.slope, b.slope),
            error: R::pick(mask, a.error, b.error),
            range: Interval::choose(mask, a.range, b.range),
        }
    }
    #[inline(always)]
    fn join(self, other: Self) -> Self {
        Self::only(self.range.join(other.range))
    }
    fn call(function: &dyn Function, arguments: &[Self], token: R::Token) -> Self {
        let ranges: Vec<Interval<R>> = arguments.iter().map(|a| a.range).collect();
        Self::only(Domain::call(function, &ranges, token))
    }

    #[inline(always)]
    fn scaled(self, k: f64) -> Self {
        let factor = R::splat(self.centre.token(), k);
        let (centre, slope) = (self.centre * factor, self.slope * factor);
        let error = self.error * factor.magnitude();
        Self::make(centre, slope, error, self.range.scaled(k), centre.magnitude() + slope.magnitude())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let (l, h) = (self.range.lo, self.range.hi);
        let zero = R::splat(self.centre.token(), 0.0);
        let width = h - l;
        let crossing =
            Self::fitted(self, (h + l) / width, -(l / width) * h, -(l / width) * h, Domain::abs(self.range));
        let one_sided = Self::choose(zero.is_le(l), self, -self);
        Self::choose(l.is_lt(zero) & zero.is_lt(h), crossing, one_sided)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let (a, b) = (self.range.lo.greater(self.centre.like(0.0)).root(), self.range.hi.root());
        let sum = a + b;
        let alpha = self.centre.like(1.0) / sum;
        let (eighth, product) = (sum * self.centre.like(0.125), a * b * alpha * self.centre.like(0.5));
        let slack = sum * self.centre.like(4.0 * R::ULP);
        let delta = (b - a) * (b - a) * alpha * self.centre.like(0.125) + slack;
        self.fitted(alpha, eighth + product, delta, Domain::sqrt(self.range))
    }
    #[inline(always)]
    fn square(self) -> Self {
        let half = R::splat(self.centre.token(), 0.5);
        let reach = self.slope.magnitude() + self.error;
        let bend = half * (reach * reach);
        let c = self.centre;
        let cs = c * self.slope;
        let error = (c * self.error).magnitude();
        let magnitude = c * c + bend + cs.magnitude();
        Self::make(c * c + bend, cs + cs, error + error + bend, Domain::square(self.range), magnitude)
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        let image = self.range.powi(n);
        if n == 4 {
            let fit = Domain::square(Domain::square(self));
            return Self::make(fit.centre, fit.slope, fit.error, image, R::splat(self.centre.token(), 0.0));
        }
        if !(3..=8).contains(&n) {
            // Higher powers are far from any line; 2 and −1 are operations of their own.
            return Self::only(image);
        }
        let (m, order) = (self.middle(), f64::from(n));
        let below: R = Domain::powi(m, n - 1);
        let second = self.range.powi(n - 2) * Domain::constant(Domain::token(self), order * (order - 1.0));
        // A power by repeated squaring carries more than one rounding error.
        let value = below * m;
        let fit = self.taylor(value, self.centre.like(order) * below, second, image);
        let extra = value.magnitude() * self.centre.like(4.0 * order * R::ULP);
        Self::make(fit.centre, fit.slope, fit.error + extra, image, extra)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let image = self.range.recip();
        let (l, h) = (self.range.lo, self.range.hi);
        let (p, q) = (self.centre.like(1.0) / l, self.centre.like(1.0) / h);
        let alpha = -(p * q);
        // The tangent touches at the geometric mean of the ends.
        let mean = (p * q).root();
        let mean = R::pick(l.is_lt(self.centre.like(0.0)), -mean, mean);
        let arithmetic = (p + q) * self.centre.like(0.5);
        let delta = (arithmetic - mean).magnitude()
            + (arithmetic.magnitude() + mean.magnitude()) * self.centre.like(4.0 * R::ULP);
        self.fitted(alpha, arithmetic + mean, delta, image)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = Domain::exp(self.middle());
        let image = Domain::exp(self.range);
        self.taylor(value, value, image, image)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        let first: R = Domain::recip(self.middle());
        let second = -Domain::square(Domain::recip(self.range));
        self.taylor(Domain::ln(self.middle()), first, second, Domain::ln(self.range))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        let (sine, cosine) = crate::trig::sin_cos(self.middle());
        let image = Domain::sin(self.range);
        self.taylor(sine, cosine, -image, image)
    }
    #[inline(always)]
    fn cos(self) -> Self {
        let (sine, cosine) = crate::trig::sin_cos(self.middle());
        let image = Domain::cos(self.range);
        self.taylor(cosine, -sine, -image, image)
    }
    #[inline(always)]
    fn tan(self) -> Self {
        let one = R::splat(self.centre.token(), 1.0);
        let image = Domain::tan(self.range);
        let value: R = Domain::tan(self.middle());
        let bend = image * (Domain::square(image) + Interval::point(one));
        self.taylor(value, one + value * value, bend + bend, image)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        Self::only(Domain::asin(self.range))
    }
    #[inline(always)]
    fn acos(self) -> Self {
        Self::only(Domain::acos(self.range))
    }
    #[inline(always)]
    fn atan(self) -> Self {
        let m = self.middle();
        // |atan″| ≤ 3√3/8.
        let second = Interval { lo: self.centre.like(-0.6496), hi: self.centre.like(0.6496) };
        self.taylor(
            Domain::atan(m),
            self.centre.like(1.0) / (self.centre.like(1.0) + m * m),
            second,
            Domain::atan(self.range),
        )
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        let (m, image) = (self.middle(), Domain::sinh(self.range));
        self.taylor(Domain::sinh(m), Domain::cosh(m), image, image)
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        let (m, image) = (self.middle(), Domain::cosh(self.range));
        self.taylor(Domain::cosh(m), Domain::sinh(m), image, image)
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        let value: R = Domain::tanh(self.middle());
        // |tanh″| ≤ 4√3/9.
        let second = Interval { lo: self.centre.like(-0.7699), hi: self.centre.like(0.7699) };
        self.taylor(value, self.centre.like(1.0) - value * value, second, Domain::tanh(self.range))
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        Self::only(Domain::atanh(self.range))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::only(Domain::floor(self.range))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self::only(Domain::ceil(self.range))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::only(Domain::round(self.range))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self::only(Domain::trunc(self.range))
    }
    #[inline(always)]
    fn sign(self) -> Self {
        Self::only(Domain::sign(self.range))
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self::only(Domain::not(self.range))
    }
    /// ½(x + y − |x − y|), or the operand that the sign of x − y shows to be the smaller.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let difference = self - other;
        let image = Domain::min(self.range, other.range);
        let half = self.centre.like(0.5);
        let both = self + other - Domain::abs(difference);
        let magnitude = both.centre.magnitude() + both.slope.magnitude();
        let mixed = Self::make(both.centre * half, both.slope * half, both.error * half, image, magnitude);
        let first = Self::choose(difference.range.hi.is_le(self.centre.like(0.0)), self, mixed);
        let chosen = Self::choose(self.centre.like(0.0).is_le(difference.range.lo), other, first);
        Self::choose(image.lo.is_nan_mask(), mixed, chosen)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        -Domain::min(-self, -other)
    }
    #[inline(always)]
    fn rmin(self, other: Self) -> Self {
        let fit = self + other - self.length(other);
        let image = Domain::rmin(self.range, other.range);
        let magnitude = fit.centre.magnitude() + fit.slope.magnitude();
        Self::make(fit.centre, fit.slope, fit.error, image, magnitude)
    }
    #[inline(always)]
    fn rmax(self, other: Self) -> Self {
        -Domain::rmin(-self, -other)
    }
    /// For positive bases e^(b·ln a), together with the interval's corners.
    #[inline(always)]
    fn pow(self, other: Self) -> Self {
        let image = Domain::pow(self.range, other.range);
        let fit = Domain::exp(other * Domain::ln(self));
        let magnitude = fit.centre.magnitude() + fit.slope.magnitude();
        let fit = Self::make(fit.centre, fit.slope, fit.error, image, magnitude);
        Self::choose(R::splat(self.centre.token(), 0.0).is_lt(self.range.lo), fit, Self::only(image))
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        Self::only(Domain::atan2(self.range, other.range))
    }
    #[inline(always)]
    fn rem(self, other: Self) -> Self {
        Self::only(Domain::rem(self.range, other.range))
    }
    #[inline(always)]
    fn modulo(self, other: Self) -> Self {
        Self::only(Domain::modulo(self.range, other.range))
    }
    #[inline(always)]
    fn compare(self, other: Self) -> Self {
        Self::only(Domain::compare(self.range, other.range))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        Self::only(Domain::lt((self - other).range, Interval::point(R::splat(self.centre.token(), 0.0))))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self {
        Self::only(Domain::le((self - other).range, Interval::point(R::splat(self.centre.token(), 0.0))))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self {
        Self::only(Domain::eq(self.range, other.range))
    }
}
