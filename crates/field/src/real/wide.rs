//! Numbers side by side in SIMD registers.

use super::{
    Double, EXPONENT_BIAS, HALF_OF_HIGH_PART, HIGH_PART, LAST_WHOLE, ONE, Real, SIGNIFICAND,
    SIGNIFICAND_BITS, Scalar,
};
use crate::elementary::{self, Elementary, Elementary2, OWN_ULPS};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, SimdNarrow, SimdWiden};
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! wide_real {
    ($(#[$doc:meta])* $name:ident, $scalar:ident, $vector:ident, $mask:ident, $functions:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name<S: Simd> {
            value: S::$vector,
            token: S,
        }

        impl<S: Simd> Add for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self { value: self.value + other.value, ..self }
            }
        }

        impl<S: Simd> Sub for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self { value: self.value - other.value, ..self }
            }
        }

        impl<S: Simd> Mul for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self { value: self.value * other.value, ..self }
            }
        }

        impl<S: Simd> Div for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self { value: self.value / other.value, ..self }
            }
        }

        impl<S: Simd> Neg for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self { value: -self.value, ..self }
            }
        }

        impl<S: Simd> Real for $name<S> {
            type Scalar = $scalar;
            type Token = S;
            type Mask = S::$mask;
            const LANES: usize = S::$vector::LEN;
            const ULP: f64 = $scalar::EPSILON as f64;
            const TINY: f64 = $scalar::MIN_POSITIVE as f64;
            const HUGE: f64 = $scalar::MAX as f64;
            const FUNCTION_ULPS: f64 = OWN_ULPS;

            #[inline(always)]
            fn token(self) -> S {
                self.token
            }
            #[inline(always)]
            fn splat(token: S, value: f64) -> Self {
                Self { value: S::$vector::splat(token, value as $scalar), token }
            }
            #[inline(always)]
            fn load(token: S, source: &[$scalar]) -> Self {
                Self { value: S::$vector::from_slice(token, &source[..Self::LANES]), token }
            }
            #[inline(always)]
            fn store(self, target: &mut [$scalar]) {
                self.value.store_slice(&mut target[..Self::LANES]);
            }
            #[inline(always)]
            fn map(self, f: fn(f64) -> f64) -> Self {
                let mut lanes = [0.0; MOST_LANES];
                spread(self.value.as_slice(), &mut lanes);
                map_lanes(&mut lanes[..Self::LANES], f);
                Self { value: S::$vector::from_fn(self.token, |i| lanes[i] as $scalar), ..self }
            }
            #[inline(always)]
            fn map2(self, other: Self, f: fn(f64, f64) -> f64) -> Self {
                let (mut a, mut b) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
                spread(self.value.as_slice(), &mut a);
                spread(other.value.as_slice(), &mut b);
                map2_lanes(&mut a[..Self::LANES], &b, f);
                Self { value: S::$vector::from_fn(self.token, |i| a[i] as $scalar), ..self }
            }
            #[inline(always)]
            fn apply<F: Elementary>(self, f: F) -> Self {
                $functions::apply(self, f)
            }
            #[inline(always)]
            fn apply2<F: Elementary2>(self, other: Self, f: F) -> Self {
                $functions::apply2(self, other, f)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $functions::sin_cos(self)
            }
            #[inline(always)]
            fn from_lanes(token: S, mut f: impl FnMut(usize) -> f64) -> Self {
                Self { value: S::$vector::from_fn(token, |i| f(i) as $scalar), token }
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> f64 {
                self.value.as_slice()[lane] as f64
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                Self { value: self.value.abs(), ..self }
            }
            #[inline(always)]
            fn root(self) -> Self {
                Self { value: self.value.sqrt(), ..self }
            }
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                Self { value: self.value.min(other.value), ..self }
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                Self { value: self.value.max(other.value), ..self }
            }
            #[inline(always)]
            fn round_down(self) -> Self {
                Self { value: self.value.floor(), ..self }
            }
            #[inline(always)]
            fn round_up(self) -> Self {
                Self { value: self.value.ceil(), ..self }
            }
            #[inline(always)]
            fn is_lt(self, other: Self) -> Self::Mask {
                self.value.simd_lt(other.value)
            }
            #[inline(always)]
            fn is_le(self, other: Self) -> Self::Mask {
                self.value.simd_le(other.value)
            }
            #[inline(always)]
            fn is_eq(self, other: Self) -> Self::Mask {
                self.value.simd_eq(other.value)
            }
            #[inline(always)]
            fn pick(mask: Self::Mask, a: Self, b: Self) -> Self {
                Self { value: mask.select(a.value, b.value), ..a }
            }
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                mask.any_true()
            }
            #[inline(always)]
            fn mask_from_lanes(token: S, mut f: impl FnMut(usize) -> bool) -> Self::Mask {
                let bits = (0..Self::LANES).fold(0u64, |bits, i| bits | (u64::from(f(i)) << i));
                S::$mask::from_bitmask(token, bits)
            }
            #[inline(always)]
            fn mask_lane(mask: Self::Mask, lane: usize) -> bool {
                mask.to_bitmask() >> lane & 1 != 0
            }
        }
    };
}
wide_real!(
    /// As many `f64` side by side as the processor works on at once.
    Wide64, f64, f64s, mask64s, double
);
wide_real!(
    /// As many `f32` side by side as the processor works on at once.
    Wide32, f32, f32s, mask32s, single
);

/// As many lanes as any processor has, and more.
const MOST_LANES: usize = 16;

#[inline(always)]
fn spread<T: Scalar>(from: &[T], to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = from.to_f64();
    }
}

/// Kept out of the evaluators, whose code would grow with every lane.
#[inline(never)]
fn map_lanes(lanes: &mut [f64], f: fn(f64) -> f64) {
    for lane in lanes {
        *lane = f(*lane);
    }
}

#[inline(never)]
fn map2_lanes(lanes: &mut [f64], others: &[f64], f: fn(f64, f64) -> f64) {
    for (lane, &other) in lanes.iter_mut().zip(others) {
        *lane = f(*lane, other);
    }
}

impl<S: Simd> Double for Wide64<S> {
    #[inline(always)]
    fn power_of_two(self) -> Self {
        let biased = self.value + (LAST_WHOLE + EXPONENT_BIAS);
        Self { value: S::f64s::from_bits(biased.to_bits() << SIGNIFICAND_BITS), ..self }
    }
    #[inline(always)]
    fn exponent(self) -> Self {
        let bits = self.value.to_bits() >> SIGNIFICAND_BITS | LAST_WHOLE.to_bits();
        Self { value: S::f64s::from_bits(bits) - (LAST_WHOLE + EXPONENT_BIAS), ..self }
    }
    #[inline(always)]
    fn significand(self) -> Self {
        Self { value: S::f64s::from_bits(self.value.to_bits() & SIGNIFICAND | ONE), ..self }
    }
    #[inline(always)]
    fn high_part(self) -> Self {
        let bits = (self.value.to_bits() + HALF_OF_HIGH_PART) & HIGH_PART;
        Self { value: S::f64s::from_bits(bits), ..self }
    }
    #[inline(always)]
    fn fused(self, other: Self, c: Self) -> Option<Self> {
        if !has_fused_operations(self.token) {
            return None;
        }
        Some(Self { value: self.value.mul_sub_precise(other.value, c.value), ..self })
    }
}

/// Known when the evaluators are compiled.
#[inline(always)]
fn has_fused_operations<S: Simd>(simd: S) -> bool {
    let level = simd.level();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    let has = level.as_avx2().is_some();
    #[cfg(target_arch = "aarch64")]
    let has = level.as_neon().is_some();
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
    let has = false;
    has
}

/// Elementary functions over double precision: each is compiled once for a set of instructions and called by all
/// evaluators. Its operands go through memory, which is little beside what it computes.
mod double {
    use super::*;

    #[inline(never)]
    pub(super) fn apply<S: Simd, F: Elementary>(x: Wide64<S>, _: F) -> Wide64<S> {
        x.token.vectorize(
            #[inline(always)]
            || F::over_lanes(x),
        )
    }
    #[inline(never)]
    pub(super) fn apply2<S: Simd, F: Elementary2>(x: Wide64<S>, y: Wide64<S>, _: F) -> Wide64<S> {
        x.token.vectorize(
            #[inline(always)]
            || F::over_lanes(x, y),
        )
    }
    #[inline(never)]
    pub(super) fn sin_cos<S: Simd>(x: Wide64<S>) -> (Wide64<S>, Wide64<S>) {
        x.token.vectorize(
            #[inline(always)]
            || elementary::sin_cos(x),
        )
    }
}

/// The same over single precision, computed in double.
mod single {
    use super::*;

    #[inline(always)]
    fn halves<S: Simd>(x: Wide32<S>) -> (Wide64<S>, Wide64<S>) {
        let (low, high) = x.value.widen();
        (Wide64 { value: low, token: x.token }, Wide64 { value: high, token: x.token })
    }
    #[inline(always)]
    fn joined<S: Simd>(low: Wide64<S>, high: Wide64<S>) -> Wide32<S> {
        Wide32 { value: low.value.narrow(high.value), token: low.token }
    }
    #[inline(never)]
    pub(super) fn apply<S: Simd, F: Elementary>(x: Wide32<S>, f: F) -> Wide32<S> {
        x.token.vectorize(
            #[inline(always)]
            || {
                let (low, high) = halves(x);
                joined(double::apply(low, f), double::apply(high, f))
            },
        )
    }
    #[inline(never)]
    pub(super) fn apply2<S: Simd, F: Elementary2>(x: Wide32<S>, y: Wide32<S>, f: F) -> Wide32<S> {
        x.token.vectorize(
            #[inline(always)]
            || {
                let ((a, b), (c, d)) = (halves(x), halves(y));
                joined(double::apply2(a, c, f), double::apply2(b, d, f))
            },
        )
    }
    #[inline(never)]
    pub(super) fn sin_cos<S: Simd>(x: Wide32<S>) -> (Wide32<S>, Wide32<S>) {
        x.token.vectorize(
            #[inline(always)]
            || {
                let (low, high) = halves(x);
                let ((s, c), (t, d)) = (double::sin_cos(low), double::sin_cos(high));
                (joined(s, t), joined(c, d))
            },
        )
    }
}
