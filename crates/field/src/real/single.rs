//! Numbers one at a time.

use super::{
    Double, EXPONENT_BIAS, HALF_OF_HIGH_PART, HIGH_PART, LAST_WHOLE, ONE, Real, SIGNIFICAND,
    SIGNIFICAND_BITS, Scalar,
};
use crate::elementary::{self, Elementary, Elementary2, LIBRARY_ULPS};

impl Scalar for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

macro_rules! scalar_real {
    ($scalar:ident) => {
        impl Real for $scalar {
            type Scalar = $scalar;
            type Token = ();
            type Mask = bool;
            const LANES: usize = 1;
            const ULP: f64 = $scalar::EPSILON as f64;
            const TINY: f64 = $scalar::MIN_POSITIVE as f64;
            const HUGE: f64 = $scalar::MAX as f64;
            const FUNCTION_ULPS: f64 = LIBRARY_ULPS;

            #[inline(always)]
            fn token(self) {}
            #[inline(always)]
            fn splat((): (), value: f64) -> Self {
                value as $scalar
            }
            #[inline(always)]
            fn load((): (), source: &[$scalar]) -> Self {
                source[0]
            }
            #[inline(always)]
            fn store(self, target: &mut [$scalar]) {
                target[0] = self;
            }
            #[inline(always)]
            fn map(self, f: fn(f64) -> f64) -> Self {
                f(self as f64) as $scalar
            }
            #[inline(always)]
            fn map2(self, other: Self, f: fn(f64, f64) -> f64) -> Self {
                f(self as f64, other as f64) as $scalar
            }
            #[inline(always)]
            fn apply<F: Elementary>(self, _: F) -> Self {
                F::library(self as f64) as $scalar
            }
            #[inline(always)]
            fn apply2<F: Elementary2>(self, other: Self, _: F) -> Self {
                F::library(self as f64, other as f64) as $scalar
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let (sine, cosine) = elementary::sin_cos(self as f64);
                (sine as $scalar, cosine as $scalar)
            }
            #[inline(always)]
            fn from_lanes((): (), mut f: impl FnMut(usize) -> f64) -> Self {
                f(0) as $scalar
            }
            #[inline(always)]
            fn lane(self, _lane: usize) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                $scalar::abs(self)
            }
            #[inline(always)]
            fn root(self) -> Self {
                $scalar::sqrt(self)
            }
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn round_down(self) -> Self {
                $scalar::floor(self)
            }
            #[inline(always)]
            fn round_up(self) -> Self {
                $scalar::ceil(self)
            }
            #[inline(always)]
            fn is_lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn is_le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn is_eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn pick(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn mask_from_lanes((): (), mut f: impl FnMut(usize) -> bool) -> bool {
                f(0)
            }
            #[inline(always)]
            fn mask_lane(mask: bool, _lane: usize) -> bool {
                mask
            }
        }
    };
}
scalar_real!(f64);
scalar_real!(f32);

impl Double for f64 {
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits((self + (LAST_WHOLE + EXPONENT_BIAS)).to_bits() << SIGNIFICAND_BITS)
    }
    #[inline(always)]
    fn exponent(self) -> Self {
        f64::from_bits(self.to_bits() >> SIGNIFICAND_BITS | LAST_WHOLE.to_bits())
            - (LAST_WHOLE + EXPONENT_BIAS)
    }
    #[inline(always)]
    fn significand(self) -> Self {
        f64::from_bits(self.to_bits() & SIGNIFICAND | ONE)
    }
    #[inline(always)]
    fn high_part(self) -> Self {
        f64::from_bits((self.to_bits() + HALF_OF_HIGH_PART) & HIGH_PART)
    }
}
