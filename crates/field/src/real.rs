//! Numbers that the domains are made of: `f64` and `f32`, one at a time or side by side in SIMD registers.

mod single;
mod values;
mod wide;

use crate::elementary::{Elementary, Elementary2};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

pub use wide::{Wide32, Wide64};

/// The scalar behind a [`Real`].
pub trait Scalar: Copy + Default + PartialOrd + Send + Sync + std::fmt::Debug + 'static {
    /// Rounds to nearest.
    fn from_f64(value: f64) -> Self;
    /// Exact.
    fn to_f64(self) -> f64;
    /// Whether `value` is finite and needs no rounding.
    #[inline(always)]
    fn holds(value: f64) -> bool {
        value.is_finite() && Self::from_f64(value).to_f64() == value
    }
}

/// One floating-point number, or several side by side (*lanes*).
///
/// Arithmetic is that of IEEE 754, rounded to nearest, lane by lane; no operation contracts into a fused one.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// What one lane holds.
    type Scalar: Scalar;
    /// Proof that the processor has the instructions; `()` for single numbers.
    type Token: Copy;
    /// A truth value for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;
    /// How many numbers stand side by side.
    const LANES: usize;
    /// Distance from 1 to the next number: twice the largest relative error of one rounding.
    const ULP: f64;
    /// The smallest normal number, above every absolute error of an underflow.
    const TINY: f64;
    /// The largest finite number.
    const HUGE: f64;
    /// Bound of the errors of elementary functions, in units in the last place.
    const FUNCTION_ULPS: f64;

    /// The token that this number was made with.
    fn token(self) -> Self::Token;
    /// `value`, rounded to nearest, in every lane.
    fn splat(token: Self::Token, value: f64) -> Self;
    /// Reads the first [`LANES`](Self::LANES) numbers of a slice.
    fn load(token: Self::Token, source: &[Self::Scalar]) -> Self;
    /// Writes to the first [`LANES`](Self::LANES) numbers of a slice.
    fn store(self, target: &mut [Self::Scalar]);
    /// A function, lane by lane, computed in `f64`.
    fn map(self, f: fn(f64) -> f64) -> Self;
    /// A function of two numbers, lane by lane, computed in `f64`.
    fn map2(self, other: Self, f: fn(f64, f64) -> f64) -> Self;
    /// An elementary function: the standard library's for single numbers, this crate's over lanes.
    fn apply<F: Elementary>(self, f: F) -> Self;
    /// An elementary function of two numbers.
    fn apply2<F: Elementary2>(self, other: Self, f: F) -> Self;
    /// (sin a, cos a).
    fn sin_cos(self) -> (Self, Self);
    /// A function of the lane's number.
    fn from_lanes(token: Self::Token, f: impl FnMut(usize) -> f64) -> Self;
    /// The number in one lane.
    fn lane(self, lane: usize) -> f64;

    /// |a|.
    fn magnitude(self) -> Self;
    /// √a, NaN for a < 0.
    fn root(self) -> Self;
    /// The smaller; either one if any is NaN.
    fn lesser(self, other: Self) -> Self;
    /// The larger; either one if any is NaN.
    fn greater(self, other: Self) -> Self;
    /// The largest whole number ≤ a.
    fn round_down(self) -> Self;
    /// The smallest whole number ≥ a.
    fn round_up(self) -> Self;
    /// a < b; false if any is NaN.
    fn is_lt(self, other: Self) -> Self::Mask;
    /// a ≤ b; false if any is NaN.
    fn is_le(self, other: Self) -> Self::Mask;
    /// a = b; false if any is NaN.
    fn is_eq(self, other: Self) -> Self::Mask;
    /// Lane by lane, `a` where the mask is set, `b` elsewhere.
    fn pick(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Whether any lane is set.
    fn any(mask: Self::Mask) -> bool;
    /// A mask with bit i set where `f(i)`.
    fn mask_from_lanes(token: Self::Token, f: impl FnMut(usize) -> bool) -> Self::Mask;
    /// Whether one lane of a mask is set.
    fn mask_lane(mask: Self::Mask, lane: usize) -> bool;

    /// The constant `k`, rounded to nearest, in every lane.
    #[inline(always)]
    fn like(self, k: f64) -> Self {
        Self::splat(Real::token(self), k)
    }
    /// Where the number is NaN.
    #[inline(always)]
    fn is_nan_mask(self) -> Self::Mask {
        !self.is_eq(self)
    }
}

/// Double precision, whose bits can be taken apart: what elementary functions are computed with.
pub trait Double: Real {
    /// 2ᵏ for a whole number k from −1022 to 1023.
    fn power_of_two(self) -> Self;
    /// k of 2ᵏ ≤ a < 2ᵏ⁺¹, for normal positive numbers; −1023 for smaller ones.
    fn exponent(self) -> Self;
    /// a/2ᵏ, at least 1 and below 2, for normal positive numbers.
    fn significand(self) -> Self;
    /// The significand rounded to 26 bits: the product of two such numbers is exact, and so are those of what is left.
    fn high_part(self) -> Self;

    /// a·b − c rounded once, where the processor has an instruction for it.
    #[inline(always)]
    fn fused(self, _other: Self, _c: Self) -> Option<Self> {
        None
    }

    /// a·b − `product`, the rounding error of a product: exact, and so the same with a fused operation and without, where no
    /// part of it overflows or underflows (Dekker 1971).
    #[inline(always)]
    fn product_error(self, other: Self, product: Self) -> Self {
        if let Some(error) = self.fused(other, product) {
            return error;
        }
        let (a, b) = (self.high_part(), other.high_part());
        let (a_rest, b_rest) = (self - a, other - b);
        ((a * b - product) + a * b_rest + a_rest * b) + a_rest * b_rest
    }

    /// The nearest whole number, halves to even, for |a| < 2⁵¹.
    #[inline(always)]
    fn nearest_whole(self) -> Self {
        let shift = self.like(1.5 * LAST_WHOLE);
        (self + shift) - shift
    }
}

/// From here to its double, neighbouring numbers are 1 apart: 2⁵².
const LAST_WHOLE: f64 = (1u64 << SIGNIFICAND_BITS) as f64;
/// Bits of a significand behind the point.
const SIGNIFICAND_BITS: u32 = 52;
/// What is added to exponents.
const EXPONENT_BIAS: f64 = 1023.0;
/// The bits of 1, which are those of its exponent.
const ONE: u64 = 1f64.to_bits();
/// The bits of a significand behind the point.
const SIGNIFICAND: u64 = (1 << SIGNIFICAND_BITS) - 1;
/// All bits but the 27 last ones, and half of the last that it leaves.
const HIGH_PART: u64 = !((1 << 27) - 1);
const HALF_OF_HIGH_PART: u64 = 1 << 26;

/// A whole power by repeated squaring; exact wherever every step is.
#[inline(always)]
pub(crate) fn whole_power<R: Real>(base: R, n: i32) -> R {
    let mut result = R::splat(Real::token(base), 1.0);
    let mut square = base;
    let mut rest = n.unsigned_abs();
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        rest >>= 1;
        if rest > 0 {
            square = square * square;
        }
    }
    if n < 0 { R::splat(Real::token(base), 1.0) / result } else { result }
}

/// |(a, b)| without overflow or underflow on the way.
#[inline(always)]
pub(crate) fn length2<R: Real>(a: R, b: R) -> R {
    let (a, b) = (a.magnitude(), b.magnitude());
    let (large, small) = (a.greater(b), a.lesser(b));
    let zero = R::splat(Real::token(a), 0.0);
    let ratio = R::pick(zero.is_lt(large), small / large, zero);
    let infinite = R::splat(Real::token(a), R::HUGE).is_lt(large);
    let finite = large * (R::splat(Real::token(a), 1.0) + ratio * ratio).root();
    R::pick(infinite, large, finite)
}
