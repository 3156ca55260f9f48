//! The operations on mixed affine forms.

use super::Affine;
use crate::domain::Domain;
use crate::function::expand;
use crate::interval::Interval;
use crate::{Function, Real};

impl<R: Real> Domain for Affine<R> {
    type Real = R;
    const IS_SET: bool = true;

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
        let image: Interval<R> = Domain::call(function, &ranges, token);
        let count = arguments.len();
        let (mut boxes, mut point, mut gradient) =
            (vec![Interval::undefined(); count], vec![0.0; count], vec![0.0; count]);
        let (mut slopes, mut errors, mut magnitudes) = ([0.0; 64], [0.0; 64], [0.0; 64]);
        let centre = R::from_lanes(token, |i| {
            for (k, form) in arguments.iter().enumerate() {
                boxes[k] = Interval::new(form.range.lo.lane(i), form.range.hi.lane(i));
                point[k] = form.centre.lane(i).max(boxes[k].lo).min(boxes[k].hi);
            }
            let Some(expansion) = expand(function, &boxes, &point, &mut gradient) else {
                errors[i] = f64::INFINITY;
                return 0.0;
            };
            let mut centre = 0.5 * expansion.value.lo + 0.5 * expansion.value.hi;
            (slopes[i], errors[i]) = (0.0, (expansion.value.hi - expansion.value.lo) + expansion.bend);
            magnitudes[i] = centre.abs();
            for ((form, g), p) in arguments.iter().zip(&gradient).zip(&point) {
                let (moved, slope) = (g * (form.centre.lane(i) - p), g * form.slope.lane(i));
                centre += moved;
                slopes[i] += slope;
                errors[i] += g.abs() * form.error.lane(i);
                magnitudes[i] += g.abs() * p.abs() + moved.abs() + slope.abs();
            }
            centre
        });
        let [slope, error, magnitude] =
            [slopes, errors, magnitudes].map(|lanes| R::from_lanes(token, |i| lanes[i]));
        Self::make(centre, slope, error, image, magnitude)
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
        // The product of two small reciprocals may have underflowed.
        let lost = (self.range.magnitude() + self.slope.magnitude()) * self.centre.like(4.0 * R::TINY);
        // The image is infinite, and the fit NaN, where 0 is among the values.
        let poison = (image.hi - image.lo) * self.centre.like(0.0);
        self.fitted(alpha, arithmetic + mean, delta + lost + poison, image)
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
        let (sine, cosine) = self.middle().sin_cos();
        let image = Domain::sin(self.range);
        self.taylor(sine, cosine, -image, image)
    }
    #[inline(always)]
    fn cos(self) -> Self {
        let (sine, cosine) = self.middle().sin_cos();
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
        let (m, one) = (self.middle(), self.centre.like(1.0));
        let first = one / (one - m * m).root();
        self.taylor(Domain::asin(m), first, self.asin_bend(), Domain::asin(self.range))
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let (m, one) = (self.middle(), self.centre.like(1.0));
        let first = -one / (one - m * m).root();
        self.taylor(Domain::acos(m), first, -self.asin_bend(), Domain::acos(self.range))
    }
    #[inline(always)]
    fn atan(self) -> Self {
        let (m, one) = (self.middle(), self.centre.like(1.0));
        let denominator = Domain::square(Domain::square(self.range) + Interval::point(one));
        // |atan″| = |2x/(1 + x²)²| ≤ 3√3/8.
        let second = -((self.range + self.range) / denominator).within(self.centre.like(0.6496));
        self.taylor(Domain::atan(m), one / (one + m * m), second, Domain::atan(self.range))
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
        let (image, one) = (Domain::tanh(self.range), self.centre.like(1.0));
        // |tanh″| = |2·tanh·(1 − tanh²)| ≤ 4√3/9.
        let bend = (image + image) * (Interval::point(one) - Domain::square(image));
        self.taylor(value, one - value * value, -bend.within(self.centre.like(0.7699)), image)
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        let (m, one) = (self.middle(), self.centre.like(1.0));
        let denominator = Domain::square(Interval::point(one) - Domain::square(self.range));
        let second = (self.range + self.range) / denominator;
        self.taylor(Domain::atanh(m), one / (one - m * m), second, Domain::atanh(self.range))
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
    /// The tangent plane in the middle of the box; the angle bends by at most 1/r² in any direction.
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let image = Domain::atan2(self.range, other.range);
        let (y, x) = (self.middle(), other.middle());
        let square = x * x + y * y;
        let (by_y, by_x) = (x / square, -(y / square));
        let nearest = (Domain::square(self.range) + Domain::square(other.range)).lo;
        let (reach_y, reach_x) = (self.range.hi - self.range.lo, other.range.hi - other.range.lo);
        // Half of the squares of the half widths over r², with room for rounding.
        let bend = (reach_y * reach_y + reach_x * reach_x) * self.centre.like(0.1250001) / nearest;
        // Across the cut on the negative x axis the angle jumps; no line is steep enough there.
        let zero = self.centre.like(0.0);
        let cut = self.range.lo.is_le(zero) & zero.is_le(self.range.hi) & other.range.lo.is_le(zero);
        // So small a square, and one that overflowed, says nothing of the slopes.
        let says_nothing =
            square.is_le(self.centre.like(R::TINY / R::ULP)) | !square.is_le(self.centre.like(R::HUGE));
        let bend = R::pick(cut | says_nothing, self.centre.like(f64::INFINITY), bend);
        let moved = self.centre.magnitude() + self.slope.magnitude() + self.error + y.magnitude();
        let other_moved = other.centre.magnitude() + other.slope.magnitude() + other.error + x.magnitude();
        let bend = bend + (moved + other_moved) * self.centre.like(4.0 * R::TINY);
        let value: R = Domain::atan2(y, x);
        let centre = value + by_y * (self.centre - y) + by_x * (other.centre - x);
        let slope = by_y * self.slope + by_x * other.slope;
        let error = by_y.magnitude() * self.error + by_x.magnitude() * other.error + bend;
        let magnitude = self.centre.like(4.0)
            + by_y.magnitude() * (y.magnitude() + self.centre.magnitude() + self.slope.magnitude())
            + by_x.magnitude() * (x.magnitude() + other.centre.magnitude() + other.slope.magnitude());
        Self::make(centre, slope, error, image, magnitude)
    }
    #[inline(always)]
    fn rem(self, other: Self) -> Self {
        let quotient = Domain::trunc(self.range / other.range);
        self.remainder(other, quotient, Domain::rem(self.range, other.range))
    }
    #[inline(always)]
    fn modulo(self, other: Self) -> Self {
        let divisor = Domain::abs(other);
        let quotient = Domain::floor(self.range / divisor.range);
        self.remainder(divisor, quotient, Domain::modulo(self.range, other.range))
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
