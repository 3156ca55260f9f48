//! The domain of single values.

use super::{Real, length2, whole_power};
use crate::Function;
use crate::domain::Domain;
use crate::elementary::*;

/// The meaning of the operations on single values: plain floating-point arithmetic.
impl<R: Real> Domain for R {
    type Real = R;
    const IS_SET: bool = false;

    #[inline(always)]
    fn token(self) -> R::Token {
        Real::token(self)
    }
    #[inline(always)]
    fn constant(token: R::Token, k: f64) -> Self {
        R::splat(token, k)
    }
    #[inline(always)]
    fn undefined(token: R::Token) -> Self {
        R::splat(token, f64::NAN)
    }
    #[inline(always)]
    fn truth(self) -> (R::Mask, R::Mask) {
        let zero = self.is_eq(R::splat(Real::token(self), 0.0));
        (!zero, zero)
    }
    #[inline(always)]
    fn is_undefined(self) -> R::Mask {
        self.is_nan_mask()
    }
    #[inline(always)]
    fn choose(mask: R::Mask, a: Self, b: Self) -> Self {
        R::pick(mask, a, b)
    }
    #[inline(always)]
    fn join(self, other: Self) -> Self {
        other
    }
    fn call(function: &dyn Function, arguments: &[Self], token: R::Token) -> Self {
        let mut point = vec![0.0; arguments.len()];
        R::from_lanes(token, |lane| {
            read_lane(&mut point, arguments, lane);
            function.value(&point)
        })
    }
    fn call_derivative(
        function: &dyn Function,
        arguments: &[Self],
        slopes: &[Self],
        token: R::Token,
    ) -> Self {
        let mut point = vec![0.0; arguments.len()];
        let mut gradient = vec![0.0; arguments.len()];
        R::from_lanes(token, |lane| {
            read_lane(&mut point, arguments, lane);
            function.gradient(&point, &mut gradient);
            gradient.iter().zip(slopes).map(|(g, s)| g * s.lane(lane)).sum()
        })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.magnitude()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.root()
    }
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        let power = whole_power(self, n.abs());
        if n < 0 { Domain::recip(power) } else { power }
    }
    // A zero has no sign: the smaller of 0 and −0 may be either, and nothing may depend on which.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self / (other + R::splat(Real::token(self), 0.0))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        R::splat(Real::token(self), 1.0) / (self + R::splat(Real::token(self), 0.0))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.apply(Exp)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.apply(Ln)
    }
    #[inline(always)]
    fn sin(self) -> Self {
        Real::sin_cos(self).0
    }
    #[inline(always)]
    fn cos(self) -> Self {
        Real::sin_cos(self).1
    }
    #[inline(always)]
    fn tan(self) -> Self {
        self.apply(Tan)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.apply(Asin)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        self.apply(Acos)
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.apply(Atan)
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        self.apply(Sinh)
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        self.apply(Cosh)
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        self.apply(Tanh)
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        self.apply(Atanh)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.round_down()
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        self.round_up()
    }
    #[inline(always)]
    fn round(self) -> Self {
        let whole = Domain::trunc(self);
        let rest = (self - whole).magnitude();
        R::pick(rest.is_lt(self.like(0.5)), whole, whole + Domain::sign(self))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        let zero = R::splat(Real::token(self), 0.0);
        R::pick(self.is_lt(zero), self.round_up(), self.round_down())
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.compare(R::splat(Real::token(self), 0.0))
    }
    #[inline(always)]
    fn not(self) -> Self {
        let t = Real::token(self);
        let truth = R::pick(self.is_eq(R::splat(t, 0.0)), R::splat(t, 1.0), R::splat(t, 0.0));
        R::pick(self.is_nan_mask(), self, truth)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        R::pick(self.is_nan_mask(), self, R::pick(self.is_lt(other), self, other))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        R::pick(self.is_nan_mask(), self, R::pick(other.is_lt(self), self, other))
    }
    /// Without cancellation: 2ab/(a + b + √(a² + b²)) where a + b > 0, divided through by the larger.
    #[inline(always)]
    fn rmin(self, other: Self) -> Self {
        let (sum, length) = (self + other, length2(self, other));
        let (a, b) = (self.lesser(other), self.greater(other));
        let ratio = a / b;
        // Both infinite: as for any two that are equal.
        let ratio = R::pick(ratio.is_nan_mask(), self.like(1.0), ratio);
        // Halving the divisor, and not doubling a, overflows nowhere.
        let divisor = self.like(1.0) + ratio + (self.like(1.0) + ratio * ratio).root();
        let stable = a / (divisor * self.like(0.5));
        let value = R::pick(self.like(0.0).is_lt(sum), stable, sum - length);
        // +∞ and −∞: the limit.
        let opposite = sum.is_nan_mask() & self.is_eq(self) & other.is_eq(other);
        R::pick(opposite, self.like(f64::NEG_INFINITY), value)
    }
    #[inline(always)]
    fn rmax(self, other: Self) -> Self {
        -Domain::rmin(-self, -other)
    }
    #[inline(always)]
    fn pow(self, other: Self) -> Self {
        self.apply2(other, Pow)
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        self.apply2(other, Atan2)
    }
    #[inline(always)]
    fn rem(self, other: Self) -> Self {
        self.map2(other, |a, b| a % b)
    }
    #[inline(always)]
    fn modulo(self, other: Self) -> Self {
        self.map2(other, f64::rem_euclid)
    }
    #[inline(always)]
    fn compare(self, other: Self) -> Self {
        let t = Real::token(self);
        let above = R::pick(other.is_lt(self), R::splat(t, 1.0), R::splat(t, 0.0));
        let order = R::pick(self.is_lt(other), R::splat(t, -1.0), above);
        either_nan(self, other, order)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        truth_value(self, other, self.is_lt(other))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self {
        truth_value(self, other, self.is_le(other))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self {
        truth_value(self, other, self.is_eq(other))
    }
}

/// The numbers that stand in one lane of the arguments.
fn read_lane<R: Real>(point: &mut [f64], arguments: &[R], lane: usize) {
    for (p, a) in point.iter_mut().zip(arguments) {
        *p = a.lane(lane);
    }
}

/// 1 where the mask is set, 0 elsewhere, NaN where an operand is.
#[inline(always)]
fn truth_value<R: Real>(a: R, b: R, mask: R::Mask) -> R {
    let t = Real::token(a);
    either_nan(a, b, R::pick(mask, R::splat(t, 1.0), R::splat(t, 0.0)))
}

/// `value`, but NaN where `a` or `b` is.
#[inline(always)]
fn either_nan<R: Real>(a: R, b: R, value: R) -> R {
    R::pick(a.is_nan_mask() | b.is_nan_mask(), a + b, value)
}
