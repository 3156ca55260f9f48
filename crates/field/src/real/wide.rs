//! Numbers side by side in SIMD registers.

use super::{Real, Scalar};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! wide_real {
    ($(#[$doc:meta])* $name:ident, $scalar:ident, $vector:ident, $mask:ident) => {
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
    Wide64, f64, f64s, mask64s
);
wide_real!(
    /// As many `f32` side by side as the processor works on at once.
    Wide32, f32, f32s, mask32s
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
