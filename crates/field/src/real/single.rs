//! Numbers one at a time.

use super::{Real, Scalar};

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
