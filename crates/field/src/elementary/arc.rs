//! Arc functions.
//!
//! An arc tangent of n/d is base + artan t, with base 0, π/4 or π/2 and |t| ≤ tan(π/8); t is a pair, from one division.
//! An arc sine beyond ½ is π/2 − 2·arcsin √((1 − x)/2).

use super::pair::Pair;
use super::{polynomial, with_sign_of};
use crate::real::Double;
use std::f64::consts;

const PI: [f64; 2] = [consts::PI, 1.224_646_799_147_353_2e-16];
const THREE_QUARTERS_PI: [f64; 2] = [2.356_194_490_192_345, 9.184_850_993_605_148e-17];
const HALF_PI: [f64; 2] = [consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
const QUARTER_PI: [f64; 2] = [consts::FRAC_PI_4, 3.061_616_997_868_383e-17];
/// tan(π/8) and tan(3π/8).
const BREAKS: [f64; 2] = [0.414_213_562_373_095_03, 2.414_213_562_373_095];

/// Below, a quotient is one number: 2⁻⁹⁰⁰.
const LEAST_PAIR: f64 = 1.183_052_186_166_774_7e-271;

/// (arctan t / t − 1)/z for z = t² ≤ tan²(π/8): error 2⁻⁵⁸.
#[inline(always)]
fn atan_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        -0.333_333_333_333_333_3,
        0.199_999_999_999_998_15,
        -0.142_857_142_856_624_85,
        0.111_111_111_053_964_19,
        -0.090_909_087_647_132_97,
        0.076_922_966_794_578_9,
        -0.066_664_300_394_270_25,
        0.058_789_850_366_371_306,
        -0.052_308_457_433_617_48,
        0.045_532_914_756_965_304,
        -0.034_612_198_541_286_6,
        0.016_329_841_569_261_28
    )
}

/// (arcsin s / s − 1)/z for z = s² ≤ ¼: error 2⁻⁵⁷.
#[inline(always)]
fn asin_rest<R: Double>(z: R, zz: R) -> R {
    polynomial!(
        z, zz;
        0.166_666_666_666_666_69,
        0.074_999_999_999_982_4,
        0.044_642_857_146_723_974,
        0.030_381_944_110_914_626,
        0.022_372_174_010_715_055,
        0.017_352_368_337_355_966,
        0.013_971_565_559_767_8,
        0.011_475_822_342_524_075,
        0.010_344_105_693_586_436,
        0.005_368_283_412_943_111,
        0.017_637_946_335_785_616,
        -0.015_213_676_105_633_905,
        0.028_999_377_306_393_972
    )
}

/// A pair of numbers where a mask is set, another elsewhere.
#[inline(always)]
fn either<R: Double>(mask: R::Mask, a: Pair<R>, b: Pair<R>) -> Pair<R> {
    Pair { high: R::pick(mask, a.high, b.high), low: R::pick(mask, a.low, b.low) }
}

/// The angle of a point whose coordinates are finite and not both 0: |y| and |x|, and where x was negative.
#[inline(always)]
fn angle<R: Double>(y: R, x: R, behind: R::Mask) -> R {
    let zero = y.like(0.0);
    let steep = (x * y.like(BREAKS[1])).is_lt(y);
    let middle = !steep & (x * y.like(BREAKS[0])).is_lt(y);
    let (difference, sum) = (Pair::sum(y, -x), Pair::sum(y, x));
    let flat = Pair { high: y, low: zero };
    let above = either(middle, difference, either(steep, Pair { high: -x, low: zero }, flat));
    let below = either(middle, sum, Pair { high: R::pick(steep, y, x), low: zero });
    let t = above.over(below);
    // What is left over of so small a quotient underflows, on some processors before others.
    let small = t.high.magnitude().is_lt(y.like(LEAST_PAIR));
    let t = Pair { high: t.high, low: R::pick(small, zero, t.low) };

    let forward = Pair {
        high: R::pick(steep, y.like(HALF_PI[0]), R::pick(middle, y.like(QUARTER_PI[0]), zero)),
        low: R::pick(steep, y.like(HALF_PI[1]), R::pick(middle, y.like(QUARTER_PI[1]), zero)),
    };
    let [three, three_low] = THREE_QUARTERS_PI;
    let backward = Pair {
        high: R::pick(steep, y.like(HALF_PI[0]), R::pick(middle, y.like(three), y.like(PI[0]))),
        low: R::pick(steep, y.like(HALF_PI[1]), R::pick(middle, y.like(three_low), y.like(PI[1]))),
    };
    let base = either(behind, backward, forward);
    let t = either(behind, Pair { high: -t.high, low: -t.low }, t);
    let z = t.high * t.high;
    let rest = (t.low - t.low * z) + t.high * (z * atan_rest(z, z * z));
    let value = Pair::ordered_sum(base.high, t.high);
    value.high + (value.low + (base.low + rest))
}

/// Beyond 2⁶⁰ the angle is π/2.
#[inline(always)]
pub(super) fn atan<R: Double>(x: R) -> R {
    let size = x.magnitude();
    let most = x.like((1u64 << 60) as f64);
    let limited = R::pick(most.is_lt(size), most, size);
    let one = x.like(1.0);
    with_sign_of(x, angle(limited, one, one.is_lt(one)))
}

/// Zeros count as positive, and infinite coordinates as equal to each other.
#[inline(always)]
pub(super) fn atan2<R: Double>(y: R, x: R) -> R {
    let (zero, one, infinity) = (x.like(0.0), x.like(1.0), x.like(f64::INFINITY));
    let (height, width) = (y.magnitude(), x.magnitude());
    let largest = height.greater(width);
    let infinite = largest.is_eq(infinity);
    // Brought near 1, so that nothing overflows, and no product underflows that matters.
    let exponent = -largest.exponent();
    let tiny = x.like(-1022.0);
    let scale = R::pick(exponent.is_lt(tiny), tiny, exponent).power_of_two();
    let finite_height = R::pick(infinite, R::pick(height.is_eq(infinity), one, zero), height * scale);
    let finite_width = R::pick(infinite, R::pick(width.is_eq(infinity), one, zero), width * scale);
    let finite_width = R::pick(largest.is_eq(zero), one, finite_width);
    let value = with_sign_of(y, angle(finite_height, finite_width, x.is_lt(zero)));
    R::pick(x.is_nan_mask() | y.is_nan_mask(), x.like(f64::NAN), value)
}

/// For s, |x| or √((1 − |x|)/2) where |x| > ½: s, what its arc sine is longer by, and where it is the root.
#[inline(always)]
fn half_arc<R: Double>(x: R) -> (R, R, R::Mask) {
    let (size, half, zero) = (x.magnitude(), x.like(0.5), x.like(0.0));
    let far = half.is_lt(size);
    let rest = (x.like(1.0) - size) * half;
    let s = R::pick(far, rest.root(), size);
    let z = R::pick(far, rest, size * size);
    // What rounding took from the root.
    let square = Pair::product(s, s);
    let lost = ((rest - square.high) - square.low) * half / s;
    let lost = R::pick(far & zero.is_lt(s), lost, zero);
    (s, s * (z * asin_rest(z, z * z)) + lost, far)
}

#[inline(always)]
pub(super) fn asin<R: Double>(x: R) -> R {
    let (s, longer, far) = half_arc(x);
    let right = Pair::constant(x, HALF_PI);
    let difference = Pair::ordered_sum(right.high, -(s + s));
    let large = difference.high + (difference.low + (right.low - (longer + longer)));
    with_sign_of(x, R::pick(far, large, s + longer))
}

#[inline(always)]
pub(super) fn acos<R: Double>(x: R) -> R {
    let (s, longer, far) = half_arc(x);
    let negative = x.is_lt(x.like(0.0));
    let right = Pair::constant(x, HALF_PI);
    let base = either(far, Pair::constant(x, PI), right);
    let (length, longer) = (R::pick(far, s + s, s), R::pick(far, longer + longer, longer));
    // π/2 ± s, or π − 2s.
    let towards = !negative & !far;
    let (length, longer) = (R::pick(towards | far, length, -length), R::pick(towards | far, longer, -longer));
    let difference = Pair::ordered_sum(base.high, -length);
    let value = difference.high + (difference.low + (base.low - longer));
    R::pick(far & !negative, length + longer, value)
}
