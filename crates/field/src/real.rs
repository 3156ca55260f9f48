//! Numbers that the domains are made of: `f64` and `f32`, one at a time or side by side in SIMD registers.

use crate::Function;
use crate::domain::Domain;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The scalar behind a [`Real`].
pub trait Scalar: Copy + Default + PartialOrd + Send + Sync + std::fmt::Debug + 'static {
    /// Rounds to nearest.
    fn from_f64(value: f64) -> Self;
    /// Exact.
    fn to_f64(self) -> f64;
    /// Whether this is exactly `value`.
    #[inline(always)]
    fn to_f64_is(self, value: f64) -> bool {
        self.to_f64() == value
    }
}

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

/// The meaning of the operations on single values: plain floating-point arithmetic.
impl<R: Real> Domain for R {
    type Real = R;

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
        whole_power(self, n)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        R::splat(Real::token(self), 1.0) / self
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.map(f64::exp)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.map(f64::ln)
    }
    #[inline(always)]
    fn sin(self) -> Self {
        crate::trig::sin_cos(self).0
    }
    #[inline(always)]
    fn cos(self) -> Self {
        crate::trig::sin_cos(self).1
    }
    #[inline(always)]
    fn tan(self) -> Self {
        self.map(f64::tan)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.map(f64::asin)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        self.map(f64::acos)
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.map(f64::atan)
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        self.map(f64::sinh)
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        self.map(f64::cosh)
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        self.map(f64::tanh)
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        self.map(f64::atanh)
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
        self.map(f64::round)
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
        let stable = (a + a) / (self.like(1.0) + ratio + (self.like(1.0) + ratio * ratio).root());
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
        self.map2(other, f64::powf)
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        self.map2(other, f64::atan2)
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
