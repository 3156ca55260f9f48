//! Signed approximate real distance functions (SARDF; Fayolle, Pasko, Schmitt, Mirenkov 2006): set operations like
//! min and max whose level lines have rounded corners.

use super::call::{Call, Outcome};
use super::expression::Expr;
use crate::Dialect;
use fieldstone_field::{Function, Interval};
use std::sync::{Arc, LazyLock};

/// hfDInt.
pub(super) fn intersection<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, g] = call.reals(0);
    Ok(intersection_of(call, f, g))
}

/// hfDUni.
pub(super) fn union<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, g] = call.reals(0);
    Ok(-intersection_of(call, -f, -g))
}

/// hfDSub.
pub(super) fn subtraction<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, g] = call.reals(0);
    Ok(intersection_of(call, f, -g))
}

fn intersection_of<'g>(call: &Call<'g>, f: Expr<'g>, g: Expr<'g>) -> Expr<'g> {
    let function = match call.dialect {
        Dialect::Lenient => &EXACT,
        Dialect::Strict => &SNAPPING,
    };
    f.call(function, &[g, call.real(2), call.real(3)])
}

/// hfDBlendUni.
pub(super) fn blend_union<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, g, r] = call.reals(0);
    Ok(f.max(g) + bulge(f, g, r))
}

/// hfDBlendInt.
pub(super) fn blend_intersection<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, g, r] = call.reals(0);
    Ok(f.min(g) - bulge(f, g, r))
}

/// By how much a rounded corner of radius r differs from a sharp one: r − e − √(r²/2 − e²), e = |f − g|/2 ≤ r/2.
///
/// Written (r − 2e)²/2 / (r − e + √(r²/2 − e²)), which has no cancellation.
fn bulge<'g>(f: Expr<'g>, g: Expr<'g>, r: Expr<'g>) -> Expr<'g> {
    let difference = (f - g).abs().min(r);
    let e = difference * 0.5;
    let root = (r.square() * 0.5 - e.square()).max(0.0).sqrt();
    let bulge = (r - difference).square() * 0.5 / (r - e + root);
    r.le(0.0).select(0.0, bulge)
}

pub(super) static EXACT: LazyLock<Arc<dyn Function>> =
    LazyLock::new(|| Arc::new(Intersection { snaps: false }));
pub(super) static SNAPPING: LazyLock<Arc<dyn Function>> =
    LazyLock::new(|| Arc::new(Intersection { snaps: true }));

/// The SARDF intersection d of x and y with the arguments (x, y, R, α).
///
/// Level lines of d > 0 are corners rounded by an arc whose radius grows to R at d = R and stays so; those of d < 0
/// by an arc that meets the straight parts at the lines of slope tan α. All are continuous, and for
/// 0 ≤ α ≤ π/4 d increases with x and with y.
struct Intersection {
    /// Whether operands below 10⁻⁷ count as 0, as in C. Where they do, d jumps at 0.
    snaps: bool,
}

/// Below this, the C library takes an operand as 0.
const SNAP: f64 = 1e-7;

/// More than the relative rounding error of a value.
const ROUNDING: f64 = 1e-13;

/// What the level line through a point is.
enum Zone {
    /// A straight part: d = x.
    X,
    /// A straight part: d = y.
    Y,
    /// An arc that grows with d: its centre is (c, c), c = 2√(Rd), its radius c − d.
    Growing,
    /// An arc of radius R about (d + R, d + R).
    Fixed,
    /// An arc about (td, td) of radius (1 − t)|d|, t = tan α.
    Negative,
}

impl Intersection {
    fn arguments(&self, arguments: &[f64]) -> Option<[f64; 4]> {
        let &[x, y, r, alpha] = arguments else { return None };
        let snap = |v: f64| if self.snaps && v.abs() < SNAP { 0.0 } else { v };
        let all = [snap(x), snap(y), r, alpha];
        all.iter().all(|v| !v.is_nan()).then_some(all)
    }
}

fn zone([x, y, r, alpha]: [f64; 4]) -> Zone {
    if x > 0.0 && y > 0.0 {
        return positive_zone(x, y, r);
    }
    if x >= 0.0 || y >= 0.0 {
        return if x <= y { Zone::X } else { Zone::Y };
    }
    let t = alpha.tan();
    if x / y >= 1.0 / t {
        Zone::X
    } else if x / y <= t {
        Zone::Y
    } else {
        Zone::Negative
    }
}

fn positive_zone(x: f64, y: f64, r: f64) -> Zone {
    let is_in_the_corner = x <= 2.0 * r && y <= 2.0 * r;
    let grows = x <= r || y <= r || (is_in_the_corner && (x - 2.0 * r).hypot(y - 2.0 * r) >= r);
    if grows {
        if x * x >= 4.0 * r * y {
            Zone::Y
        } else if y * y >= 4.0 * r * x {
            Zone::X
        } else {
            Zone::Growing
        }
    } else if (x - y).abs() <= r {
        Zone::Fixed
    } else if x <= y {
        Zone::X
    } else {
        Zone::Y
    }
}

/// The value of d in the growing zone.
///
/// In units of R, μ = √d is the root of the concave function (c − d)² − (x − c)² − (y − c)², c = 2μ, that lies below
/// √min(x, y), where the function is at most 0: from there Newton's method descends to it and never passes it.
fn growing(x: f64, y: f64, r: f64) -> f64 {
    let (x, y) = (x / r, y / r);
    let mut mu = x.min(y).sqrt();
    for _ in 0..60 {
        let (c, d) = (2.0 * mu, mu * mu);
        let excess = (c - d) * (c - d) - (x - c) * (x - c) - (y - c) * (y - c);
        let slope = 2.0 * (c - d) * (2.0 - c) + 4.0 * (x - c) + 4.0 * (y - c);
        let next = mu - excess / slope;
        if next.partial_cmp(&mu) != Some(std::cmp::Ordering::Less) {
            break;
        }
        mu = next;
    }
    mu * mu * r
}

/// d in the zone of constant arcs: (x + y)/2 − R + √(R²/2 − (x − y)²/4).
fn fixed(x: f64, y: f64, r: f64) -> f64 {
    0.5 * (x + y) - r + fixed_root(x, y, r)
}

fn fixed_root(x: f64, y: f64, r: f64) -> f64 {
    let e = 0.5 * (x - y);
    (0.5 * r * r - e * e).max(0.0).sqrt()
}

/// d in the arcs of the negative quadrant: the negative root of (1 − t² − 2t)d² + 2t(x + y)d = x² + y², in a form
/// that stands for every t in \[0, 1).
fn negative(x: f64, y: f64, t: f64) -> f64 {
    let (sum, difference) = (x + y, x - y);
    let spread = 0.5 * (1.0 - t).powi(2) * (sum * sum + difference * difference);
    let root = (spread - (t * difference).powi(2)).max(0.0).sqrt();
    -(x * x + y * y) / (root - t * sum)
}

impl Function for Intersection {
    fn name(&self) -> &str {
        "hfDInt"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        let Some(arguments) = self.arguments(arguments) else { return f64::NAN };
        let [x, y, r, alpha] = arguments;
        match zone(arguments) {
            _ if x.min(y) == f64::NEG_INFINITY => f64::NEG_INFINITY,
            Zone::X => x,
            Zone::Y => y,
            Zone::Growing => growing(x, y, r),
            Zone::Fixed => fixed(x, y, r),
            Zone::Negative => negative(x, y, alpha.tan()),
        }
    }

    /// Two corners of the box have the extreme values, R and α being points with 0 ≤ α ≤ π/4. For others only the
    /// range of the operation is known: between −|(x, y)| and max(x, y).
    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        let &[x, y, r, alpha] = arguments else { return Interval::undefined() };
        let is_point = r.lo == r.hi && alpha.lo == alpha.hi;
        let is_monotone = is_point && (0.0..=std::f64::consts::FRAC_PI_4).contains(&alpha.lo);
        let (lo, hi) = if is_monotone {
            (self.value(&[x.lo, y.lo, r.lo, alpha.lo]), self.value(&[x.hi, y.hi, r.lo, alpha.lo]))
        } else {
            (-x.lo.min(0.0).hypot(y.lo.min(0.0)), x.hi.max(y.hi).max(0.0))
        };
        let has_nan = [x, y].iter().any(|a| a.lo.is_nan() || a.hi.is_nan());
        // With an infinite radius or angle there is no value.
        let is_open = [r, alpha].iter().any(|a| !a.lo.is_finite() || !a.hi.is_finite());
        if has_nan || is_open || lo.is_nan() || hi.is_nan() {
            return Interval::undefined();
        }
        let widen = |v: f64| ROUNDING * v.abs() + f64::MIN_POSITIVE;
        Interval { lo: lo - widen(lo), hi: hi + widen(hi) }
    }

    /// On straight parts nothing bends. On arcs of constant radius R the second derivative is at most 2/R, as e² changes
    /// by at most ½ and √(R²/2 − e²) ≥ R/2; on those of the negative quadrant the level lines have the radius
    /// (1 − t)|d|, |d| being at least the larger operand, and |∇d| ≤ 1. Growing arcs end in a point, where nothing
    /// bounds them.
    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        let &[x, y, r, alpha] = arguments else { return f64::INFINITY };
        let near_zero = |v: Interval<f64>| v.lo < SNAP && v.hi > -SNAP;
        let is_smooth = r.lo == r.hi && alpha.lo == alpha.hi && r.lo >= 0.0;
        let t = alpha.lo.tan();
        if !(is_smooth && (0.0..=1.0).contains(&t)) || (self.snaps && (near_zero(x) || near_zero(y))) {
            return f64::INFINITY;
        }
        let r = r.lo;
        // The straight part d = x reaches to the left and upwards from each of its points, d = y to the other side.
        if matches!(zone([x.hi, y.lo, r, alpha.lo]), Zone::X)
            || matches!(zone([x.lo, y.hi, r, alpha.lo]), Zone::Y)
        {
            return 0.0;
        }
        if x.hi < 0.0 && y.hi < 0.0 {
            return 1.0 / ((1.0 - t) * x.hi.min(y.hi).abs());
        }
        let outer = 2.0 * r * (1.0 + 1e-12);
        let is_fixed = x.lo.min(y.lo) > r && x.lo.max(y.lo) > outer;
        if is_fixed && r > 0.0 { 2.0 / r } else { f64::INFINITY }
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let slopes = self.arguments(arguments).map_or([f64::NAN; 4], |all| self.slopes(all));
        for (slope, value) in gradient.iter_mut().zip(slopes) {
            *slope = value;
        }
    }
}

impl Intersection {
    /// Implicit differentiation of the equation of the level line.
    fn slopes(&self, arguments: [f64; 4]) -> [f64; 4] {
        let [x, y, r, alpha] = arguments;
        match zone(arguments) {
            Zone::X => [1.0, 0.0, 0.0, 0.0],
            Zone::Y => [0.0, 1.0, 0.0, 0.0],
            Zone::Growing => {
                let d = growing(x, y, r);
                let c = 2.0 * (r * d).sqrt();
                let (p, q, radius) = (c - x, c - y, c - d);
                let lever = p + q - radius;
                let by_d = (r / d).sqrt() * lever + radius;
                [p / by_d, q / by_d, -(d / r).sqrt() * lever / by_d, 0.0]
            }
            Zone::Fixed => {
                let root = fixed_root(x, y, r);
                let tilt = 0.25 * (x - y) / root;
                [0.5 - tilt, 0.5 + tilt, 0.5 * r / root - 1.0, 0.0]
            }
            Zone::Negative => {
                let t = alpha.tan();
                let d = negative(x, y, t);
                let (p, q, radius) = (t * d - x, t * d - y, (t - 1.0) * d);
                let by_d = t * (p + q) + (1.0 - t) * radius;
                let by_t = d * (p + q) - d * radius;
                [p / by_d, q / by_d, 0.0, -by_t * (1.0 + t * t) / by_d]
            }
        }
    }
}
