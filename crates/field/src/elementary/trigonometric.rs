//! Sine, cosine and tangent.
//!
//! Argument reduction by four parts of π/2 (Cody and Waite), of which three have 33 bits, so that their products with whole
//! numbers below 2²⁰ are exact; their rounding errors are kept, so that what is left is good to 2⁻⁶² of itself even
//! next to the multiples of π/2. Beyond [`LARGEST`] the standard library's functions are used.

use super::pair::Pair;
use super::polynomial;
use crate::real::{Double, Real};
use std::f64::consts::FRAC_2_PI;

/// π/2.
const HALF_PI: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
    8.478_427_660_368_9e-32,
];
/// The largest argument that is reduced here.
const LARGEST: f64 = 1e6;

/// (sin r / r − 1)/z for z = r² ≤ (π/4)²: error 2⁻⁵⁷, which is the rounding of 1/6.
#[inline(always)]
fn sin_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        -0.166_666_666_666_666_66,
        0.008_333_333_333_333_331,
        -0.000_198_412_698_412_650_68,
        2.755_731_921_934_074e-6,
        -2.505_210_623_293_885e-8,
        1.605_853_168_966_728e-10,
        -7.586_700_931_151_669e-13
    )
}

/// (cos r − 1 + z/2)/z² for z = r² ≤ (π/4)²: error 2⁻⁶⁰.
#[inline(always)]
fn cos_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        0.041_666_666_666_666_664,
        -0.001_388_888_888_888_739_8,
        2.480_158_729_876_702_7e-5,
        -2.755_731_727_233_733_3e-7,
        2.087_614_638_079_887e-9,
        -1.138_263_970_326_269_8e-11
    )
}

/// What is left of an angle behind a whole number of quarter turns, with its sine and cosine.
struct Reduced<R> {
    quarters: R,
    sine: Pair<R>,
    cosine: Pair<R>,
}

/// For |x| ≤ [`LARGEST`]. The low parts may be as large as a tenth.
#[inline(always)]
fn reduced<R: Double>(x: R) -> Reduced<R> {
    let [first, second, third, fourth] = HALF_PI;
    let quarters = (x * x.like(FRAC_2_PI)).nearest_whole();
    let after_two = Pair::sum(x - quarters * x.like(first), -(quarters * x.like(second)));
    let after_three = Pair::sum(after_two.high, -(quarters * x.like(third)));
    let rest = (after_two.low + after_three.low) - quarters * x.like(fourth);
    let r = Pair::ordered_sum(after_three.high, rest);

    let z = r.high * r.high;
    let (zz, half) = (z * z, z * x.like(0.5));
    let one = Pair::ordered_sum(x.like(1.0), -half);
    Reduced {
        quarters,
        sine: Pair { high: r.high, low: r.high * (z * sin_rest(z, zz)) + r.low * one.high },
        cosine: Pair { high: one.high, low: (one.low - r.high * r.low) + zz * cos_rest(z, zz) },
    }
}

/// (sin x, cos x).
#[inline(always)]
pub(crate) fn sin_cos<R: Double>(x: R) -> (R, R) {
    let Reduced { quarters, sine, cosine } = reduced(x);
    let (sine, cosine) = (sine.high + sine.low, cosine.high + cosine.low);
    let quadrant = quarters - x.like(4.0) * (quarters * x.like(0.25)).round_down();
    let odd = quadrant.is_eq(x.like(1.0)) | quadrant.is_eq(x.like(3.0));
    let (s, c) = (R::pick(odd, cosine, sine), R::pick(odd, sine, cosine));
    let s = R::pick(x.like(1.5).is_lt(quadrant), -s, s);
    let negative = quadrant.is_eq(x.like(1.0)) | quadrant.is_eq(x.like(2.0));
    let c = R::pick(negative, -c, c);
    // Chosen lane by lane, so that no value depends on its neighbours.
    let far = !x.magnitude().is_le(x.like(LARGEST));
    if R::any(far) {
        return (R::pick(far, x.map(f64::sin), s), R::pick(far, x.map(f64::cos), c));
    }
    (s, c)
}

/// sin/cos after an even number of quarter turns, −cos/sin after an odd one.
#[inline(always)]
pub(super) fn tan<R: Double>(x: R) -> R {
    let Reduced { quarters, sine, cosine } = reduced(x);
    let half = quarters * x.like(0.5);
    let odd = !half.round_down().is_eq(half);
    let (sine, cosine) = (Pair::ordered_sum(sine.high, sine.low), Pair::ordered_sum(cosine.high, cosine.low));
    let above =
        Pair { high: R::pick(odd, -cosine.high, sine.high), low: R::pick(odd, -cosine.low, sine.low) };
    let below = Pair { high: R::pick(odd, sine.high, cosine.high), low: R::pick(odd, sine.low, cosine.low) };
    let quotient = above.over(below);
    let value = quotient.high + quotient.low;
    let far = !x.magnitude().is_le(x.like(LARGEST));
    if R::any(far) {
        return R::pick(far, Real::map(x, f64::tan), value);
    }
    value
}
