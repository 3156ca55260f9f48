//! What a program may be evaluated over.
//!
//! A [`Domain`] gives each operation of the table its meaning: on reals the value, on intervals and affine forms a
//! set that holds every value, on duals the value with its derivatives. Domains are generic over a [`Real`]: one
//! number, or several side by side in a SIMD register, so that each rule is written once.
//!
//! Every rule is compiled into the evaluators: a call that is left over passes its SIMD registers through memory, which
//! costs a factor of 3. So rules are `#[inline(always)]`, closures in arguments too, and no closure is bound by `let`,
//! no method passed by its path, no array of such values looped over.

use crate::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A set of values on which all operations of the table are defined.
///
/// The rule for conditions: a value counts as *true* unless it is 0. A condition that may be both leads to both
/// branches, joined.
pub trait Domain:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The numbers that it is made of.
    type Real: Real;
    /// Whether it stands for many values at once, so that what is undefined may be defined for some of them.
    const IS_SET: bool;

    /// The token that this value was made with.
    fn token(self) -> <Self::Real as Real>::Token;
    /// The constant `k`, which [`Real`] may have to round: a domain of sets holds both.
    fn constant(token: <Self::Real as Real>::Token, k: f64) -> Self;
    /// An undefined value.
    fn undefined(token: <Self::Real as Real>::Token) -> Self;
    /// Where the value may be true, and where it may be 0. Where it may be undefined, neither says anything.
    fn truth(self) -> (<Self::Real as Real>::Mask, <Self::Real as Real>::Mask);
    /// Where the value is (for sets: may be) undefined.
    fn is_undefined(self) -> <Self::Real as Real>::Mask;
    /// Lane by lane, `a` where the mask is set, `b` elsewhere.
    fn choose(mask: <Self::Real as Real>::Mask, a: Self, b: Self) -> Self;
    /// A set that holds both; for single values, the second.
    fn join(self, other: Self) -> Self;
    /// Calls a function that is known as a whole.
    fn call(function: &dyn crate::Function, arguments: &[Self], token: <Self::Real as Real>::Token) -> Self;
    /// The derivative of such a call along a direction in which the arguments change by `slopes`; undefined over sets.
    fn call_derivative(
        _function: &dyn crate::Function,
        _arguments: &[Self],
        _slopes: &[Self],
        token: <Self::Real as Real>::Token,
    ) -> Self {
        Self::undefined(token)
    }

    /// −a.
    #[inline(always)]
    fn neg(self) -> Self {
        -self
    }
    /// a + b.
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    /// a − b.
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - other
    }
    /// a · b.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
    /// a / b.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self / other
    }
    /// `a` where the condition holds, `b` where it does not, undefined where the condition is.
    #[inline(always)]
    fn select(self, a: Self, b: Self, token: <Self::Real as Real>::Token) -> Self {
        let (may_hold, may_fail) = self.truth();
        let decided = Self::choose(may_hold, a, b);
        let joined = Self::choose(may_hold & may_fail, a.join(b), decided);
        Self::choose(self.is_undefined(), Self::undefined(token), joined)
    }

    /// k·a for a finite constant that the numbers hold exactly; cheaper than the product of two sets.
    #[inline(always)]
    fn scaled(self, k: f64) -> Self {
        self * Self::constant(self.token(), k)
    }

    /// |a|.
    fn abs(self) -> Self;
    /// √a.
    fn sqrt(self) -> Self;
    /// a².
    fn square(self) -> Self;
    /// aⁿ for whole n.
    fn powi(self, n: i32) -> Self;
    /// 1/a.
    fn recip(self) -> Self;
    /// eᵃ.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Tangent.
    fn tan(self) -> Self;
    /// Arc sine.
    fn asin(self) -> Self;
    /// Arc cosine.
    fn acos(self) -> Self;
    /// Arc tangent.
    fn atan(self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Inverse hyperbolic tangent.
    fn atanh(self) -> Self;
    /// Largest whole number ≤ a.
    fn floor(self) -> Self;
    /// Smallest whole number ≥ a.
    fn ceil(self) -> Self;
    /// Nearest whole number, halves away from zero.
    fn round(self) -> Self;
    /// Nearest whole number towards zero.
    fn trunc(self) -> Self;
    /// −1, 0 or 1.
    fn sign(self) -> Self;
    /// 1 if a = 0, otherwise 0.
    fn not(self) -> Self;
    /// The smaller.
    fn min(self, other: Self) -> Self;
    /// The larger.
    fn max(self, other: Self) -> Self;
    /// a + b − √(a² + b²).
    fn rmin(self, other: Self) -> Self;
    /// a + b + √(a² + b²).
    fn rmax(self, other: Self) -> Self;
    /// aᵇ.
    fn pow(self, other: Self) -> Self;
    /// Angle of the point (b, a).
    fn atan2(self, other: Self) -> Self;
    /// a − b·trunc(a/b).
    fn rem(self, other: Self) -> Self;
    /// a − |b|·floor(a/|b|).
    fn modulo(self, other: Self) -> Self;
    /// −1, 0 or 1.
    fn compare(self, other: Self) -> Self;
    /// 1 if a < b, otherwise 0.
    fn lt(self, other: Self) -> Self;
    /// 1 if a ≤ b, otherwise 0.
    fn le(self, other: Self) -> Self;
    /// 1 if a = b, otherwise 0.
    fn eq(self, other: Self) -> Self;
}
