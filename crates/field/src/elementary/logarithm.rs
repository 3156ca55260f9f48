//! Logarithm, power, and inverse hyperbolic tangent.
//!
//! x = 2ᵉ·m with √½ ≤ m < √2, and with s = (m − 1)/(m + 1), |s| ≤ 0.172, ln m = 2·artanh s = 2s + s·z·(2/3 + …), z = s².
//! A power needs the logarithm to 2⁻⁶⁴, because the exponential makes of an absolute error a relative one: there s, z and
//! the first coefficient are pairs.

use super::exponential::exp_pair;
use super::pair::Pair;
use super::{polynomial, with_sign_of};
use crate::real::Double;
use std::f64::consts::SQRT_2;

/// ln 2, the first part with 42 bits.
const LN_2: [f64; 2] = [0.693_147_180_559_890_3, 5.497_923_018_708_371e-14];
/// 2/3 in two parts.
const TWO_THIRDS: [f64; 2] = [0.666_666_666_666_666_6, 3.700_743_415_417_188e-17];

/// (2·artanh s / s − 2)/z for z = s² ≤ 0.02944: error 2⁻⁵⁷.
#[inline(always)]
fn artanh_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        0.666_666_666_666_667,
        0.399_999_999_998_985_1,
        0.285_714_286_263_706_6,
        0.222_222_110_774_545_37,
        0.181_828_928_851_697_46,
        0.153_316_079_870_392_84,
        0.146_177_369_260_852_65
    )
}

/// ((2·artanh s / s − 2)/z − 2/3)/z for z = s² ≤ 0.02944: error 2⁻⁶⁶.
#[inline(always)]
fn artanh_far_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        0.4,
        0.285_714_285_714_293_75,
        0.222_222_222_216_516_77,
        0.181_818_183_362_435_2,
        0.153_845_948_806_392_05,
        0.133_348_087_382_724_44,
        0.117_061_372_979_622_31,
        0.117_241_312_775_155_7
    )
}

/// e and m of positive numbers; infinity and NaN give something.
#[inline(always)]
fn taken_apart<R: Double>(x: R) -> (R, R) {
    let subnormal = x.is_lt(x.like(f64::MIN_POSITIVE));
    let x = R::pick(subnormal, x * x.like((1u64 << 54) as f64), x);
    let (e, m) = (x.exponent(), x.significand());
    let e = R::pick(subnormal, e - x.like(54.0), e);
    let large = x.like(SQRT_2).is_le(m);
    (R::pick(large, e + x.like(1.0), e), R::pick(large, m * x.like(0.5), m))
}

/// ln x + `small` for finite positive x.
#[inline(always)]
fn ln_plus<R: Double>(x: R, small: R) -> R {
    let (e, m) = taken_apart(x);
    let [first, second] = LN_2;
    let f = m - x.like(1.0);
    let s = f / (m + x.like(1.0));
    let (z, half) = (s * s, f * f * x.like(0.5));
    let rest = s * (half + z * artanh_rest(z, z * z)) + (e * x.like(second) + small);
    e * x.like(first) - ((half - rest) - f)
}

#[inline(always)]
pub(super) fn ln<R: Double>(x: R) -> R {
    let (zero, infinity) = (x.like(0.0), x.like(f64::INFINITY));
    let value = R::pick(x.is_eq(zero), -infinity, ln_plus(x, zero));
    let value = R::pick(x.is_lt(infinity), value, x);
    R::pick(x.is_lt(zero), x.like(f64::NAN), value)
}

/// The logarithm of a finite positive number as a pair, relative error 2⁻⁶⁴.
#[inline(always)]
fn ln_pair<R: Double>(x: R) -> Pair<R> {
    let (e, m) = taken_apart(x);
    let [first, second] = LN_2;
    let one = x.like(1.0);
    let f = Pair { high: m - one, low: x.like(0.0) };
    let s = f.over(Pair::ordered_sum(one, m));
    let z = s.times(s);
    let [t, t_low] = TWO_THIRDS;
    let far = z.high * artanh_far_rest(z.high, z.high * z.high);
    let t = Pair::ordered_sum(x.like(t), far);
    let t = Pair { high: t.high, low: t.low + x.like(t_low) };
    let rest = z.times(t);
    let factor = Pair::ordered_sum(x.like(2.0), rest.high);
    let of_m = s.times(Pair { high: factor.high, low: factor.low + rest.low });
    let sum = Pair::ordered_sum(e * x.like(first), of_m.high);
    Pair { high: sum.high, low: sum.low + (of_m.low + e * x.like(second)) }
}

/// e^(y·ln|x|), y·ln|x| as a pair, with the special values of the standard library's `powf` for a positive zero.
#[inline(always)]
pub(super) fn pow<R: Double>(x: R, y: R) -> R {
    let (zero, one, infinity) = (x.like(0.0), x.like(1.0), x.like(f64::INFINITY));
    let size = x.magnitude();
    let ln = ln_pair(size);
    // Larger exponents say the same: |ln x| is at least 2⁻⁵³, or 0.
    let reach = x.like(1e22);
    let limited = with_sign_of(y, R::pick(reach.is_lt(y.magnitude()), reach, y.magnitude()));
    let product = Pair::product(limited, ln.high);
    let power = exp_pair(Pair::ordered_sum(product.high, product.low + limited * ln.low));

    let grows = one.is_lt(size) & zero.is_lt(y) | size.is_lt(one) & y.is_lt(zero);
    let extreme = size.is_eq(zero) | size.is_eq(infinity);
    let power = R::pick(extreme, R::pick(grows, infinity, zero), power);
    let whole = y.round_down().is_eq(y);
    let half = y * x.like(0.5);
    let odd = whole & !half.round_down().is_eq(half);
    let negative = x.is_lt(zero);
    let power = R::pick(negative & odd, -power, power);
    let undefined = (negative & !whole & !size.is_eq(infinity)) | x.is_nan_mask() | y.is_nan_mask();
    let power = R::pick(undefined, x.like(f64::NAN), power);
    R::pick(y.is_eq(zero) | x.is_eq(one), one, power)
}

/// ½·ln((1 + x)/(1 − x)) with the quotient as a pair; x + ½·x·z·p(z) where it is near 1.
#[inline(always)]
pub(super) fn atanh<R: Double>(x: R) -> R {
    let (size, one, half) = (x.magnitude(), x.like(1.0), x.like(0.5));
    let z = size * size;
    let small = size + size * (z * artanh_rest(z, z * z) * half);
    let quotient = Pair::ordered_sum(one, size).over(Pair::ordered_sum(one, -size));
    let large = half * ln_plus(quotient.high, quotient.low / quotient.high);
    let large = R::pick(size.is_lt(one), large, x.like(f64::INFINITY));
    let large = R::pick(size.is_le(one), large, x.like(f64::NAN));
    with_sign_of(x, R::pick(size.is_lt(x.like(0.171)), small, large))
}
