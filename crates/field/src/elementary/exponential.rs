//! The exponential function and the hyperbolic ones.
//!
//! x = k·ln 2 + r with |r| ≤ ½ ln 2, ln 2 in two parts of which the first times k is exact, and r as a pair. Then
//! eˣ = 2ᵏ·eʳ, and 1 + r is added exactly to the rest of the series, which is at most 0.07.

use super::pair::Pair;
use super::{polynomial, with_sign_of};
use crate::real::Double;
use std::f64::consts::LOG2_E;

/// ln 2, the first part with 42 bits.
const LN_2: [f64; 2] = [0.693_147_180_559_890_3, 5.497_923_018_708_371e-14];
/// Below, eˣ is 0; above, infinite.
const LEAST: f64 = -746.0;
const MOST: f64 = 710.5;

/// (eʳ − 1 − r − r²/2)/r³ for |r| ≤ ½ ln 2: error 2⁻⁶⁰.
#[inline(always)]
fn exp_rest<R: Double>(r: R, rr: R) -> R {
    polynomial!(
        r, rr;
        0.166_666_666_666_666_69,
        0.041_666_666_666_666_67,
        0.008_333_333_333_330_063,
        0.001_388_888_888_888_094_7,
        0.000_198_412_698_630_492_27,
        2.480_158_733_394_286e-5,
        2.755_726_846_737_395_5e-6,
        2.755_726_432_590_593e-7,
        2.510_038_178_918_013_3e-8,
        2.091_813_380_830_572e-9
    )
}

/// (sinh x / x − 1)/x² for z = x² ≤ 1: error 2⁻⁵⁶, which is the rounding of 1/6.
#[inline(always)]
fn sinh_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        0.166_666_666_666_666_66,
        0.008_333_333_333_333_333,
        0.000_198_412_698_412_697_73,
        2.755_731_922_404_036_5e-6,
        2.505_210_836_404_993_3e-8,
        1.605_904_839_753_959_6e-10,
        7.646_625_275_177_843e-13,
        2.844_528_887_899_936_2e-15
    )
}

/// (tanh x / x − 1)/x² for z = x² ≤ 0.390626: error 2⁻⁵⁶.
#[inline(always)]
fn tanh_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        -0.333_333_333_333_333_3,
        0.133_333_333_333_333_22,
        -0.053_968_253_968_236_804,
        0.021_869_488_535_176_295,
        -0.008_863_235_500_863_23,
        0.003_592_127_523_028_917,
        -0.001_455_828_542_060_819,
        0.000_589_982_678_975_625,
        -0.000_238_892_940_875_763_7,
        9.605_043_699_341_008e-5,
        -3.709_691_972_196_768_5e-5,
        1.222_536_643_650_586_3e-5,
        -2.445_416_132_014_259_4e-6
    )
}

/// 2ᵏ·(high + low) with a whole k and 0.7 ≤ high < 1.42.
struct Scaled<R> {
    k: R,
    pair: Pair<R>,
}

/// e to the power of a pair; its high part is within [`LEAST`] and [`MOST`], or NaN. The low part of the result may be
/// as large as 0.07.
#[inline(always)]
fn exp_of<R: Double>(x: Pair<R>) -> Scaled<R> {
    let k = (x.high * x.high.like(LOG2_E)).nearest_whole();
    let [first, second] = LN_2;
    let r = Pair::ordered_sum(x.high - k * k.like(first), x.low - k * k.like(second));
    let rr = r.high * r.high;
    let rest = rr * (r.high * exp_rest(r.high, rr) + k.like(0.5)) + r.low;
    let Pair { high, low } = Pair::ordered_sum(k.like(1.0), r.high);
    Scaled { k, pair: Pair { high, low: low + rest } }
}

/// `x`·2ᵏ for |k| ≤ 2000, rounded once.
#[inline(always)]
fn scaled<R: Double>(x: R, k: R) -> R {
    let half = (k * k.like(0.5)).nearest_whole();
    x * half.power_of_two() * (k - half).power_of_two()
}

/// `x` between two ends; NaN stays.
#[inline(always)]
fn clamped<R: Double>(x: R, least: f64, most: f64) -> R {
    let x = R::pick(x.is_lt(x.like(least)), x.like(least), x);
    R::pick(x.like(most).is_lt(x), x.like(most), x)
}

/// e to the power of a pair.
#[inline(always)]
pub(super) fn exp_pair<R: Double>(x: Pair<R>) -> R {
    let high = clamped(x.high, LEAST, MOST);
    let low = R::pick(high.is_eq(x.high), x.low, x.high.like(0.0));
    let Scaled { k, pair } = exp_of(Pair { high, low });
    scaled(pair.high + pair.low, k)
}

#[inline(always)]
pub(super) fn exp<R: Double>(x: R) -> R {
    let Scaled { k, pair } = exp_of(Pair { high: clamped(x, LEAST, MOST), low: x.like(0.0) });
    scaled(pair.high + pair.low, k)
}

/// For x ≥ 0, eˣ as 2ᵏ·pair, and e⁻ˣ as 2ᵏ·number, too small to matter where k is large.
#[inline(always)]
fn both_exponentials<R: Double>(x: R) -> (Scaled<R>, R) {
    let Scaled { k, pair } = exp_of(Pair { high: clamped(x, LEAST, 711.0), low: x.like(0.0) });
    let pair = Pair::ordered_sum(pair.high, pair.low);
    let inverse = x.like(1.0) / pair.high;
    let inverse = inverse - (pair.low * inverse) * inverse;
    let twice = clamped(-(k + k), -1000.0, 0.0);
    (Scaled { k, pair }, inverse * twice.power_of_two())
}

#[inline(always)]
pub(super) fn sinh<R: Double>(x: R) -> R {
    let size = x.magnitude();
    let (Scaled { k, pair }, inverse) = both_exponentials(size);
    let difference = Pair::ordered_sum(pair.high, -inverse);
    let large = scaled(difference.high + (difference.low + pair.low), k - k.like(1.0));
    let z = x * x;
    let small = size + size * (z * sinh_rest(z, z * z));
    with_sign_of(x, R::pick(size.is_lt(x.like(1.0)), small, large))
}

#[inline(always)]
pub(super) fn cosh<R: Double>(x: R) -> R {
    let (Scaled { k, pair }, inverse) = both_exponentials(x.magnitude());
    let sum = Pair::ordered_sum(pair.high, inverse);
    scaled(sum.high + (sum.low + pair.low), k - k.like(1.0))
}

/// x + x³·p(x²) up to 0.625, 1 − 2/(e²ˣ + 1) beyond.
#[inline(always)]
pub(super) fn tanh<R: Double>(x: R) -> R {
    let (size, one) = (x.magnitude(), x.like(1.0));
    let limited = clamped(size, 0.0, 20.0);
    let Scaled { k, pair } = exp_of(Pair { high: limited + limited, low: x.like(0.0) });
    let power = k.power_of_two();
    let pair = Pair::ordered_sum(pair.high * power, pair.low * power);
    let sum = Pair::ordered_sum(pair.high, one);
    let divisor = Pair { high: sum.high, low: sum.low + pair.low };
    let quotient = Pair { high: x.like(2.0), low: x.like(0.0) }.over(divisor);
    let rest = Pair::ordered_sum(one, -quotient.high);
    let large = rest.high + (rest.low - quotient.low);
    let z = x * x;
    let small = size + size * (z * tanh_rest(z, z * z));
    with_sign_of(x, R::pick(size.is_lt(x.like(0.625)), small, large))
}
