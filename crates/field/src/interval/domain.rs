//! The operations on intervals.

use super::{FAR, Interval, function_ulps};
use crate::domain::Domain;
use crate::elementary::*;
use crate::function::expand;
use crate::real::whole_power;
use crate::{Function, Real, Scalar};
use std::f64::consts::{FRAC_PI_2, PI};

/// The image of a box under a function: what it says itself, and what its expansion around the middle leaves.
fn image(function: &dyn Function, boxes: &[Interval<f64>], scratch: &mut [Vec<f64>; 2]) -> Interval<f64> {
    let image = function.interval(boxes);
    let [point, gradient] = scratch;
    for (p, b) in point.iter_mut().zip(boxes) {
        *p = (0.5 * b.lo + 0.5 * b.hi).max(b.lo).min(b.hi);
    }
    let Some(expansion) = expand(function, boxes, point, gradient) else { return image };
    let mut reach = expansion.bend;
    for ((b, p), g) in boxes.iter().zip(point).zip(gradient) {
        reach += g.abs() * (b.hi - *p).max(*p - b.lo);
    }
    let reach = reach * (1.0 + 1e-12);
    let (lo, hi) = ((expansion.value.lo - reach).next_down(), (expansion.value.hi + reach).next_up());
    // A comparison with an undefined end is false, which leaves it.
    Interval { lo: if image.lo < lo { lo } else { image.lo }, hi: if hi < image.hi { hi } else { image.hi } }
}

impl<R: Real> Domain for Interval<R> {
    type Real = R;
    const IS_SET: bool = true;

    #[inline(always)]
    fn token(self) -> R::Token {
        self.lo.token()
    }
    #[inline(always)]
    fn constant(token: R::Token, k: f64) -> Self {
        let nearest = R::splat(token, k);
        if R::Scalar::holds(k) { Self::point(nearest) } else { Self::rounded(nearest, nearest, 1.0) }
    }
    #[inline(always)]
    fn undefined(token: R::Token) -> Self {
        Self::point(R::splat(token, f64::NAN))
    }
    #[inline(always)]
    fn truth(self) -> (R::Mask, R::Mask) {
        let zero = self.zero();
        (!(self.lo.is_eq(zero) & self.hi.is_eq(zero)), self.straddles_zero())
    }
    #[inline(always)]
    fn is_undefined(self) -> R::Mask {
        self.lo.is_nan_mask()
    }
    #[inline(always)]
    fn choose(mask: R::Mask, a: Self, b: Self) -> Self {
        Self { lo: R::pick(mask, a.lo, b.lo), hi: R::pick(mask, a.hi, b.hi) }
    }
    #[inline(always)]
    fn join(self, other: Self) -> Self {
        let hull = Self { lo: self.lo.lesser(other.lo), hi: self.hi.greater(other.hi) };
        hull.undefined_where(self.lo.is_nan_mask() | other.lo.is_nan_mask())
    }
    fn call(function: &dyn Function, arguments: &[Self], token: R::Token) -> Self {
        let mut boxes = vec![Interval::undefined(); arguments.len()];
        let mut scratch = [vec![0.0; arguments.len()], vec![0.0; arguments.len()]];
        let mut upper = [0.0; 64];
        let lo = R::from_lanes(token, |i| {
            for (b, a) in boxes.iter_mut().zip(arguments) {
                *b = Interval { lo: a.lo.lane(i), hi: a.hi.lane(i) };
            }
            let any_undefined = boxes.iter().any(|b| b.lo.is_nan());
            let image =
                if any_undefined { Interval::undefined() } else { image(function, &boxes, &mut scratch) };
            upper[i] = image.hi;
            image.lo
        });
        let image = Self { lo, hi: R::from_lanes(token, |i| upper[i]) };
        if R::ULP == f64::EPSILON { image } else { Self::rounded(image.lo, image.hi, 1.0) }
    }

    #[inline(always)]
    fn scaled(self, k: f64) -> Self {
        let factor = self.constant_real(k);
        let (p, q) = (self.lo * factor, self.hi * factor);
        let (lo, hi) = if k < 0.0 { (q, p) } else { (p, q) };
        let product =
            Self::rounded(lo, hi, 1.0).undefined_where((p + q).is_nan_mask() & !(p.is_eq(p) & q.is_eq(q)));
        // What was not negative is not after a positive factor either.
        if k < 0.0 {
            return product;
        }
        let positive = self.zero().is_le(self.lo) & product.lo.is_lt(self.zero());
        Self { lo: R::pick(positive, self.zero(), product.lo), hi: product.hi }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let (l, h) = (self.lo.magnitude(), self.hi.magnitude());
        let lo = R::pick(self.straddles_zero(), self.zero(), l.lesser(h));
        Self { lo, hi: l.greater(h) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = Self::rounded(self.lo.root(), self.hi.root(), 1.0).at_least(self.zero());
        root.undefined_where(self.lo.is_lt(self.zero()))
    }
    #[inline(always)]
    fn square(self) -> Self {
        let a = Domain::abs(self);
        Self::rounded(a.lo * a.lo, a.hi * a.hi, 1.0).at_least(self.zero())
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        let ulps = 2.0 * f64::from(n.unsigned_abs());
        let magnitude = n.unsigned_abs() as i32;
        let power = if n % 2 == 0 {
            let a = Domain::abs(self);
            let ends = (whole_power(a.lo, magnitude), whole_power(a.hi, magnitude));
            Self::rounded(ends.0, ends.1, ulps).at_least(self.zero())
        } else {
            Self::rounded(whole_power(self.lo, magnitude), whole_power(self.hi, magnitude), ulps)
        };
        if n < 0 { power.recip() } else { power }
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let one = self.constant_real(1.0);
        Self::rounded(one / self.hi, one / self.lo, 1.0).whole_where(self.straddles_zero())
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.rising(Exp).at_least(self.zero())
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.rising(Ln).undefined_where(self.lo.is_lt(self.zero()))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.wave(
            #[inline(always)]
            |x| Domain::sin(x),
            FRAC_PI_2,
        )
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.wave(
            #[inline(always)]
            |x| Domain::cos(x),
            0.0,
        )
    }
    #[inline(always)]
    fn tan(self) -> Self {
        let range = self.rising(Tan);
        let wide = !((self.hi - self.lo).is_lt(self.constant_real(PI)))
            | !self.magnitude().is_lt(self.constant_real(FAR))
            | self.meets(FRAC_PI_2, PI);
        let infinite = !self.magnitude().is_le(self.constant_real(R::HUGE));
        range.whole_where(wide).undefined_where(infinite)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.rising(Asin).undefined_where(self.leaves_unit())
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let range = Self::rounded(self.hi.apply(Acos), self.lo.apply(Acos), function_ulps::<R>());
        range.at_least(self.zero()).undefined_where(self.leaves_unit())
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.rising(Atan)
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        self.rising(Sinh)
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        Domain::abs(self).rising(Cosh).at_least(self.constant_real(1.0))
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        let one = self.constant_real(1.0);
        self.rising(Tanh).at_least(-one).at_most(one)
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        self.rising(Atanh).undefined_where(self.leaves_unit())
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.step(
            #[inline(always)]
            |x| Domain::floor(x),
        )
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        self.step(
            #[inline(always)]
            |x| Domain::ceil(x),
        )
    }
    #[inline(always)]
    fn round(self) -> Self {
        self.step(
            #[inline(always)]
            |x| Domain::round(x),
        )
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        self.step(
            #[inline(always)]
            |x| Domain::trunc(x),
        )
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.step(
            #[inline(always)]
            |x| Domain::sign(x),
        )
    }
    #[inline(always)]
    fn not(self) -> Self {
        let (may_hold, may_fail) = self.truth();
        self.verdict(self, !may_hold, !may_fail)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let lesser = Self { lo: self.lo.lesser(other.lo), hi: self.hi.lesser(other.hi) };
        lesser.undefined_where(self.lo.is_nan_mask() | other.lo.is_nan_mask())
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        -Domain::min(-self, -other)
    }
    /// Rises with both operands: exact at the ends.
    #[inline(always)]
    fn rmin(self, other: Self) -> Self {
        Self::rounded(Domain::rmin(self.lo, other.lo), Domain::rmin(self.hi, other.hi), 8.0)
    }
    #[inline(always)]
    fn rmax(self, other: Self) -> Self {
        -Domain::rmin(-self, -other)
    }
    /// For positive bases the extremes lie in the corners; otherwise only one whole exponent is defined.
    #[inline(always)]
    fn pow(self, other: Self) -> Self {
        let single = other.lo.is_eq(other.hi);
        let (a, b) = (self.lo.apply2(other.lo, Pow), self.hi.apply2(other.lo, Pow));
        // Of a single exponent these are the same.
        let (c, d) = if R::any(!single) {
            (self.lo.apply2(other.hi, Pow), self.hi.apply2(other.hi, Pow))
        } else {
            (a, b)
        };
        let zero = self.zero();
        let positive = zero.is_lt(self.lo) | (zero.is_le(self.lo) & zero.is_lt(other.lo));
        let range = Self::hull4([a, b, c, d], function_ulps::<R>()).at_least(zero);
        let even = (other.lo * self.constant_real(0.5)).round_down() * self.constant_real(2.0);
        let is_even = single & even.is_eq(other.lo);
        let is_odd = single & !is_even & other.lo.round_down().is_eq(other.lo);
        let rising_whole = (is_even | is_odd) & zero.is_lt(other.lo);
        let least = R::pick(self.straddles_zero(), zero, a.lesser(b));
        let through_zero = Self::rounded(
            R::pick(is_even, least, a),
            R::pick(is_even, a.greater(b), b),
            function_ulps::<R>(),
        );
        let any_nan = self.lo.is_nan_mask() | other.lo.is_nan_mask();
        Self::choose(positive, range, through_zero).undefined_where(!(positive | rising_whole) | any_nan)
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let corners = [
            self.lo.apply2(other.lo, Atan2),
            self.lo.apply2(other.hi, Atan2),
            self.hi.apply2(other.lo, Atan2),
            self.hi.apply2(other.hi, Atan2),
        ];
        let cut = self.straddles_zero() & other.lo.is_le(self.zero());
        let pi = self.constant_real(PI);
        let range = Self::hull4(corners, function_ulps::<R>());
        let any_nan = self.lo.is_nan_mask() | other.lo.is_nan_mask();
        let whole = Self::rounded(-pi, pi, 1.0);
        Self::choose(cut, whole, range).undefined_where(any_nan)
    }
    #[inline(always)]
    fn rem(self, other: Self) -> Self {
        let (zero, bound) = (self.zero(), Domain::abs(other).hi.lesser(self.magnitude()));
        let lo = R::pick(self.lo.is_lt(zero), -bound, zero);
        let hi = R::pick(zero.is_lt(self.hi), bound, zero);
        self.remainder(
            other,
            #[inline(always)]
            |x| Domain::trunc(x),
            Self { lo, hi },
        )
    }
    #[inline(always)]
    fn modulo(self, other: Self) -> Self {
        let divisor = Domain::abs(other);
        self.remainder(
            divisor,
            #[inline(always)]
            |x| Domain::floor(x),
            Self { lo: self.zero(), hi: divisor.hi },
        )
    }
    #[inline(always)]
    fn compare(self, other: Self) -> Self {
        let (zero, one) = (self.zero(), self.constant_real(1.0));
        let below = R::pick(self.hi.is_le(other.lo), zero, one);
        let hi = R::pick(self.hi.is_lt(other.lo), -one, below);
        let above = R::pick(other.hi.is_le(self.lo), zero, -one);
        let lo = R::pick(other.hi.is_lt(self.lo), one, above);
        Self { lo, hi }.undefined_where(self.lo.is_nan_mask() | other.lo.is_nan_mask())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        self.verdict(other, self.hi.is_lt(other.lo), other.hi.is_le(self.lo))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self {
        self.verdict(other, self.hi.is_le(other.lo), other.hi.is_lt(self.lo))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self {
        let single = self.lo.is_eq(self.hi) & other.lo.is_eq(other.hi) & self.lo.is_eq(other.lo);
        self.verdict(other, single, self.hi.is_lt(other.lo) | other.hi.is_lt(self.lo))
    }
}
