//! Sine and cosine over lanes.
//!
//! Argument reduction by three parts of π/2 (Cody and Waite) and the minimax polynomials that Sun's fdlibm publishes
//! (`k_sin.c`, `k_cos.c`). Absolute error below 1.5·2⁻⁵³ for |x| ≤ 10⁵; beyond, and in `f32`, the standard library's
//! functions in `f64` are used.

use crate::Real;

/// π/2 in three parts; the first two have 33 bits, so that their products with whole numbers below 2²⁰ are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_007e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];
/// The largest argument that is reduced here.
const LARGEST: f64 = 1e5;

#[inline(always)]
fn polynomial<R: Real>(z: R, coefficients: [f64; 6]) -> R {
    let [a, b, c, d, e, f] = coefficients;
    ((((z.like(f) * z + z.like(e)) * z + z.like(d)) * z + z.like(c)) * z + z.like(b)) * z + z.like(a)
}

/// (sin x, cos x).
#[inline(always)]
pub(crate) fn sin_cos<R: Real>(x: R) -> (R, R) {
    if R::ULP != f64::EPSILON {
        return (x.map(f64::sin), x.map(f64::cos));
    }
    // Chosen lane by lane, so that no value depends on its neighbours.
    let far = !x.magnitude().is_le(x.like(LARGEST));
    let (sine, cosine) = reduced_sin_cos(x);
    if R::any(far) {
        return (R::pick(far, x.map(f64::sin), sine), R::pick(far, x.map(f64::cos), cosine));
    }
    (sine, cosine)
}

/// (sin x, cos x) for |x| ≤ [`LARGEST`].
#[inline(always)]
fn reduced_sin_cos<R: Real>(x: R) -> (R, R) {
    let turns = (x * x.like(std::f64::consts::FRAC_2_PI) + x.like(0.5)).round_down();
    let [first, second, third] = HALF_PI;
    let reduced = ((x - turns * x.like(first)) - turns * x.like(second)) - turns * x.like(third);
    let z = reduced * reduced;
    let sine = reduced + reduced * z * polynomial(z, SIN);
    let half = z * x.like(0.5);
    let near_one = x.like(1.0) - half;
    let cosine = near_one + (((x.like(1.0) - near_one) - half) + z * z * polynomial(z, COS));

    let quadrant = turns - x.like(4.0) * (turns * x.like(0.25)).round_down();
    let odd = quadrant.is_eq(x.like(1.0)) | quadrant.is_eq(x.like(3.0));
    let (s, c) = (R::pick(odd, cosine, sine), R::pick(odd, sine, cosine));
    let s = R::pick(x.like(1.5).is_lt(quadrant), -s, s);
    let c_negative = quadrant.is_eq(x.like(1.0)) | quadrant.is_eq(x.like(2.0));
    (s, R::pick(c_negative, -c, c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_library() {
        let mut worst = 0.0f64;
        for i in 0..200_000 {
            let x = (f64::from(i) - 1e5) * 0.731_234_567_1 * if i % 3 == 0 { 1.0 } else { 1e-4 };
            let (s, c) = sin_cos(x);
            worst = worst.max((s - x.sin()).abs()).max((c - x.cos()).abs());
        }
        for k in -40..40 {
            let x = f64::from(k) * std::f64::consts::FRAC_PI_2;
            let (s, c) = sin_cos(x);
            worst = worst.max((s - x.sin()).abs()).max((c - x.cos()).abs());
        }
        assert!(worst < 2.3e-16, "worst error {worst:e}");
    }
}
