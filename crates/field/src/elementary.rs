//! Elementary functions over lanes.
//!
//! Every function is a straight line of additions, products, quotients and roots, with masks where a formula changes, so
//! that all lanes of a SIMD register go the same way. They use no table, and a fused operation only where its
//! result is exact: what they give is the same, to the last bit, on every processor.
//!
//! Methods: argument reduction by constants in parts (Cody and Waite 1980, *Software Manual for the Elementary
//! Functions*), sums and products with their rounding errors (Dekker 1971), and the ways of keeping the low part of the
//! reduced argument of fdlibm (Sun 1993) and of Muller et al. (*Handbook of Floating-Point Arithmetic*, 2nd ed., chapters
//! 10 and 11). The polynomials are minimax: the exchange of Remez in 60 digits finds their coefficients, which are then
//! rounded; `tests/elementary/minimax.py` does so. Each is named with its largest error, relative to the result.
//!
//! Errors, in units in the last place of the result, stay below [`OWN_ULPS`]. The largest ones among 10⁵ arguments of each,
//! against 60 digits: asin, acos, atan and atan2 0.62, exp 0.69, cosh 0.74, sin and cos 0.78, ln and pow 0.79, sinh and
//! atanh 0.81, tanh 0.81, tan 0.93. Angles of `atan2` below 2⁻⁹⁰⁰ are rounded twice and may be off by two. Single precision is
//! computed in double and rounded: 0.51. Zeros have no sign: that of a result which is 0 says nothing.

mod arc;
mod exponential;
mod logarithm;
mod pair;
mod trigonometric;

use crate::real::Double;

pub(crate) use trigonometric::sin_cos;

/// Bound of the errors of the functions over lanes, in units in the last place.
pub(crate) const OWN_ULPS: f64 = 1.0;
/// Bound of the errors of the standard library's functions, which documents one to two units in the last place.
pub(crate) const LIBRARY_ULPS: f64 = 2.0;

/// A function of one number.
pub trait Elementary: Copy {
    /// Its value by the standard library.
    fn library(x: f64) -> f64;
    /// Its values over lanes, within [`OWN_ULPS`].
    fn over_lanes<R: Double>(x: R) -> R;
}

/// A function of two numbers.
pub trait Elementary2: Copy {
    /// Its value by the standard library.
    fn library(x: f64, y: f64) -> f64;
    /// Its values over lanes, within [`OWN_ULPS`].
    fn over_lanes<R: Double>(x: R, y: R) -> R;
}

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident: $library:path, $lanes:path;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub(crate) struct $name;

            impl Elementary for $name {
                #[inline(always)]
                fn library(x: f64) -> f64 {
                    $library(x)
                }
                #[inline(always)]
                fn over_lanes<R: Double>(x: R) -> R {
                    $lanes(x)
                }
            }
        )*
    };
}
functions! {
    /// eˣ.
    Exp: f64::exp, exponential::exp;
    /// Natural logarithm: −∞ at 0, NaN below.
    Ln: f64::ln, logarithm::ln;
    /// Tangent.
    Tan: f64::tan, trigonometric::tan;
    /// Arc sine; NaN outside [−1, 1].
    Asin: f64::asin, arc::asin;
    /// Arc cosine; NaN outside [−1, 1].
    Acos: f64::acos, arc::acos;
    /// Arc tangent.
    Atan: f64::atan, arc::atan;
    /// Hyperbolic sine.
    Sinh: f64::sinh, exponential::sinh;
    /// Hyperbolic cosine.
    Cosh: f64::cosh, exponential::cosh;
    /// Hyperbolic tangent.
    Tanh: f64::tanh, exponential::tanh;
    /// Inverse hyperbolic tangent; NaN outside [−1, 1]. The standard library's is 170 units off at −0.999.
    Atanh: logarithm::atanh, logarithm::atanh;
}

/// xʸ; NaN for x < 0 and y not whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pow;

impl Elementary2 for Pow {
    /// The sign of a zero is left out.
    #[inline(always)]
    fn library(x: f64, y: f64) -> f64 {
        (x + 0.0).powf(y)
    }
    #[inline(always)]
    fn over_lanes<R: Double>(x: R, y: R) -> R {
        logarithm::pow(x, y)
    }
}

/// Angle of the point (y, x), whose ordinate comes first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Atan2;

impl Elementary2 for Atan2 {
    /// The signs of zeros are left out.
    #[inline(always)]
    fn library(y: f64, x: f64) -> f64 {
        (y + 0.0).atan2(x + 0.0)
    }
    #[inline(always)]
    fn over_lanes<R: Double>(y: R, x: R) -> R {
        arc::atan2(y, x)
    }
}

/// The value of a polynomial at `$z`, coefficients from the lowest, given `$zz` = z²: pairs first, for half the depth.
macro_rules! polynomial {
    ($z:expr, $zz:expr; $a:expr) => { $z.like($a) };
    ($z:expr, $zz:expr; $a:expr, $b:expr) => { $z * $z.like($b) + $z.like($a) };
    ($z:expr, $zz:expr; $a:expr, $b:expr, $($rest:expr),+) => {
        $crate::elementary::polynomial!($z, $zz; $($rest),+) * $zz + ($z * $z.like($b) + $z.like($a))
    };
}
pub(crate) use polynomial;

/// −y where x < 0, y elsewhere.
#[inline(always)]
fn with_sign_of<R: Double>(x: R, y: R) -> R {
    R::pick(x.is_lt(x.like(0.0)), -y, y)
}
