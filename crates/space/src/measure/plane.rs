//! A field in a cell between two parallel planes.
//!
//! With c the middle of a cell and G ⊇ ∇f over it, the mean-value form says f(x) ∈ f(c) + G·(x − c). With g the middle of
//! G and r its radius that is a linear function and an error, |f(x) − (f(c) + g·(x − c))| ≤ e = Σ rᵢhᵢ, hᵢ being half the
//! sides of the cell: both r and h fall with the size of the cell, so e falls with its square. Where the linear function
//! is below −e the point is inside, where it is above e outside. All fractions of the cell follow from that.

use fieldstone_field::Interval;

/// Error bound of a computed fraction: a few hundred roundings of numbers up to 1.
const FRACTION_ERROR: f64 = 1e-12;

/// A closed range of numbers.
pub(super) type Range = Interval<f64>;

/// `value + Σ step[i]·uᵢ ± error`, where uᵢ ∈ \[−1, 1\] is the place in the cell along axis i.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Plane {
    value: f64,
    step: [f64; 3],
    error: f64,
    /// A direction of length 1, not more.
    pub(super) direction: [f64; 3],
    /// A bound on 1/cos of the angle between the gradient and `direction`; infinite where the gradient may vanish.
    pub(super) secant: f64,
}

impl Plane {
    /// From the value in the middle of a cell and the slopes over it; `None` where those are not finite.
    pub(super) fn new(cell: &[Range; 3], value: Range, slopes: &[Range; 3]) -> Option<Self> {
        let middle = |range: &Range| 0.5 * range.lo + 0.5 * range.hi;
        let above = 1.0 + 8.0 * f64::EPSILON;
        let g = [0, 1, 2].map(|i| middle(&slopes[i]));
        let radius = [0, 1, 2].map(|i| (slopes[i].hi - g[i]).max(g[i] - slopes[i].lo) * above);
        let half = [0, 1, 2].map(|i| 0.5 * (cell[i].hi - cell[i].lo) * above);
        let step = [0, 1, 2].map(|i| g[i] * half[i]);
        let centre = middle(&value);
        // How far rounding may move the middle and the ends of the cell.
        let moved = |i: usize| 4.0 * f64::EPSILON * cell[i].lo.abs().max(cell[i].hi.abs());
        let from_slopes: f64 =
            (0..3).map(|i| radius[i] * half[i] + (g[i].abs() + radius[i]) * moved(i)).sum();
        let rounding = 16.0 * f64::EPSILON * (centre.abs() + step.iter().map(|s| s.abs()).sum::<f64>());
        let error = (from_slopes + (value.hi - value.lo)) * above + rounding + f64::MIN_POSITIVE;
        let (direction, secant) = direction(g, radius);
        (error.is_finite() && centre.is_finite()).then_some(Self {
            value: centre,
            step,
            error,
            direction,
            secant,
        })
    }

    /// Bounds of the part of the cell where the field is negative.
    pub(super) fn fraction(&self) -> Range {
        self.bounded(self.value, self.step)
    }

    /// Bounds of the part of a face where the field is negative: the upper or lower face along `axis`.
    pub(super) fn face_fraction(&self, axis: usize, upper: bool) -> Range {
        let mut step = self.step;
        let value = self.value + if upper { step[axis] } else { -step[axis] };
        step[axis] = 0.0;
        self.bounded(value, step)
    }

    fn bounded(&self, value: f64, step: [f64; 3]) -> Range {
        let reach: f64 = step.iter().map(|s| s.abs()).sum();
        let at = |shift: f64| match value + shift {
            v if v + reach < 0.0 => 1.0,
            v if v - reach >= 0.0 => 0.0,
            v => below_zero(v, step),
        };
        let (lo, hi) = (at(self.error), at(-self.error));
        let (down, up) =
            (if lo < 1.0 { FRACTION_ERROR } else { 0.0 }, if hi > 0.0 { FRACTION_ERROR } else { 0.0 });
        Range::new((lo - down).max(0.0), (hi + up).min(1.0))
    }

    /// Bounds of ∫ u du along an axis over the part where the field is negative, in units of the volume of the cell.
    ///
    /// The part that is certainly negative has its moment; what else is negative lies between −1 and 1.
    pub(super) fn moment(&self, axis: usize) -> Range {
        let fraction = self.fraction();
        let certain = moment_below_zero(self.value + self.error, self.step, axis);
        let rest = fraction.hi - fraction.lo + FRACTION_ERROR;
        Range::new((certain - rest).max(-fraction.hi), (certain + rest).min(fraction.hi))
    }

    /// Between which places −1 ≤ u ≤ 1 along an axis everything lies where the field is negative; `None`: nowhere.
    pub(super) fn outer_reach(&self, axis: usize) -> Option<Range> {
        self.reach(axis, -self.error, FRACTION_ERROR)
    }

    /// Between which places the field certainly takes negative values near either; `None`: perhaps nowhere.
    pub(super) fn inner_reach(&self, axis: usize) -> Option<Range> {
        self.reach(axis, self.error, -FRACTION_ERROR)
    }

    fn reach(&self, axis: usize, shift: f64, slack: f64) -> Option<Range> {
        let least = |i: usize| -self.step[i].abs();
        let others: f64 = (0..3).filter(|&i| i != axis).map(least).sum();
        let rest = self.value + shift + others;
        let step = self.step[axis];
        if rest - step.abs() >= 0.0 {
            return None;
        }
        // rest + step·u < 0.
        let limit = -rest / step;
        let (lo, hi) = match step {
            s if s > 0.0 => (-1.0, (limit + slack).min(1.0)),
            s if s < 0.0 => ((limit - slack).max(-1.0), 1.0),
            _ => (-1.0, 1.0),
        };
        (lo <= hi).then_some(Range::new(lo, hi))
    }
}

/// The direction of `g` and a bound on 1/cos of its angle to all g + r, |rᵢ| ≤ radius\[i\].
///
/// The part of g + r along the direction d is at least |g| − Σ radius\[i\]·|dᵢ|, the part across it at most |radius|.
fn direction(g: [f64; 3], radius: [f64; 3]) -> ([f64; 3], f64) {
    let largest = g.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let scaled = g.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    let d = scaled.map(|x| x / length * (1.0 - 8.0 * f64::EPSILON));
    let along = largest * length * (1.0 - 16.0 * f64::EPSILON)
        - (0..3).map(|i| radius[i] * d[i].abs()).sum::<f64>() * (1.0 + 32.0 * f64::EPSILON);
    let across = radius.iter().map(|r| r * r).sum::<f64>().sqrt();
    // NaN, where the gradient may vanish all over, is not above 0.
    if along > 0.0 && across.is_finite() {
        let tangent = across / along * (1.0 + 32.0 * f64::EPSILON);
        (d, (1.0 + tangent * tangent).sqrt() * (1.0 + 32.0 * f64::EPSILON))
    } else {
        ([0.0; 3], f64::INFINITY)
    }
}

/// The part of the cube \[−1, 1\]³ where value + Σ step\[i\]·uᵢ < 0.
///
/// With m the |steps| in rising order that is an average over \[0, 1\] of parts of a square, which is piecewise
/// a polynomial of degree 2 between known places, so that Simpson's rule is exact (with a factor u too, for moments). Nothing cancels,
/// however small a step is.
fn below_zero(value: f64, step: [f64; 3]) -> f64 {
    let mut m = step.map(|s| 2.0 * s.abs());
    m.sort_unstable_by(f64::total_cmp);
    let level = 0.5 * (m[0] + m[1] + m[2]) - value;
    let part = if m[0] > 0.0 { solid_part(level, m) } else { plane_part(level, [m[1], m[2]]) };
    part.clamp(0.0, 1.0)
}

/// The average over \[−1, 1\]³ of the place along `axis` where value + Σ step\[i\]·uᵢ < 0, and of 0 elsewhere.
fn moment_below_zero(value: f64, step: [f64; 3], axis: usize) -> f64 {
    let along = 2.0 * step[axis].abs();
    let mut m = [step[(axis + 1) % 3], step[(axis + 2) % 3]].map(|s| 2.0 * s.abs());
    m.sort_unstable_by(f64::total_cmp);
    let level = 0.5 * (along + m[0] + m[1]) - value;
    // In both cases the field rises along the axis.
    let moment = if m[1] > 0.0 {
        let kinks = [0.0, m[0], m[1], m[0] + m[1]].map(|k| (level - k) / along);
        averaged(kinks, |u| (2.0 * u - 1.0) * plane_part(level - along * u, m))
    } else if along > 0.0 {
        let part = (level / along).clamp(0.0, 1.0);
        part * (part - 1.0)
    } else {
        0.0
    };
    if step[axis] < 0.0 { -moment } else { moment }
}

/// The part of \[0, 1\]³ where Σ m\[i\]·uᵢ < level.
fn solid_part(level: f64, m: [f64; 3]) -> f64 {
    let kinks = [0.0, m[1], m[2], m[1] + m[2]].map(|k| (level - k) / m[0]);
    averaged(kinks, |u| plane_part(level - m[0] * u, [m[1], m[2]]))
}

/// The part of \[0, 1\]² where Σ m\[i\]·uᵢ < level, for m\[0\] ≤ m\[1\], which is above 0.
fn plane_part(level: f64, m: [f64; 2]) -> f64 {
    let [small, large] = m;
    let left = small + large - level;
    if level <= 0.0 {
        0.0
    } else if left <= 0.0 {
        1.0
    } else if level < small {
        0.5 * (level / small) * (level / large)
    } else if left < small {
        1.0 - 0.5 * (left / small) * (left / large)
    } else {
        (level - 0.5 * small) / large
    }
}

/// The average over \[0, 1\] of a function that is a parabola between neighbouring kinks.
#[inline(always)]
fn averaged(mut kinks: [f64; 4], f: impl Fn(f64) -> f64) -> f64 {
    kinks.sort_unstable_by(f64::total_cmp);
    let mut sum = 0.0;
    let mut from = 0.0;
    for to in kinks.into_iter().chain([1.0]) {
        // Kinks far outside, and those that are none because the step is 0, are left out.
        if !(to > from && to <= 1.0) {
            continue;
        }
        let middle = 0.5 * (from + to);
        sum += (to - from) * (f(from) + 4.0 * f(middle) + f(to)) / 6.0;
        from = to;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Corners that the plane cuts off, signs alternating: the textbook formula, good for steps that are not small.
    fn by_corners(value: f64, step: [f64; 3]) -> f64 {
        let corner = |bits: usize| {
            let sign = |i: usize| if bits >> i & 1 == 1 { 1.0 } else { -1.0 };
            let at: f64 = value + (0..3).map(|i| sign(i) * step[i].abs()).sum::<f64>();
            let parity = if bits.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
            parity * (-at).max(0.0).powi(3)
        };
        (0..8).map(corner).sum::<f64>() / (48.0 * step.iter().map(|s| s.abs()).product::<f64>())
    }

    #[test]
    fn parts_of_a_cube() {
        let mut state = 5;
        for _ in 0..2000 {
            let step =
                [0, 1, 2].map(|_| random(&mut state) * 2.0 - 1.0).map(|s: f64| s + 0.05f64.copysign(s));
            let value = 4.0 * random(&mut state) - 2.0;
            let (found, expected) = (below_zero(value, step), by_corners(value, step).clamp(0.0, 1.0));
            assert!((found - expected).abs() < 1e-11, "{value} {step:?}: {found}, not {expected}");
        }
    }

    #[test]
    fn moments_of_a_cube() {
        let mut state = 7;
        for _ in 0..20 {
            let step = [0, 1, 2].map(|_| random(&mut state) * 2.0 - 1.0);
            let value = 2.0 * random(&mut state) - 1.0;
            let axis = (random(&mut state) * 3.0) as usize;
            let count = 60;
            let place = |i: usize| (2 * i + 1) as f64 / count as f64 - 1.0;
            let mut sum = 0.0;
            for i in 0..count * count * count {
                let u = [i % count, i / count % count, i / count / count].map(place);
                let inside = value + (0..3).map(|k| step[k] * u[k]).sum::<f64>() < 0.0;
                sum += if inside { u[axis] } else { 0.0 };
            }
            let expected = sum / (count as f64).powi(3);
            let found = moment_below_zero(value, step, axis);
            assert!((found - expected).abs() < 2e-3, "{value} {step:?}: {found}, not {expected}");
        }
        // Half of the cube, the lower one, and the upper one.
        assert_eq!(moment_below_zero(0.0, [0.0, 0.0, 1.0], 2), -0.25);
        assert_eq!(moment_below_zero(0.0, [0.0, 0.0, -1.0], 2), 0.25);
        assert_eq!(moment_below_zero(0.0, [0.0, 0.0, -1.0], 0), 0.0);
    }

    #[test]
    fn steps_that_vanish_do_no_harm() {
        for tiny in [0.0, 1e-300, 1e-18, 1e-9] {
            assert!((below_zero(0.0, [tiny, 1.0, tiny]) - 0.5).abs() < 1e-8);
            assert!((below_zero(-0.5, [tiny, tiny, -1.0]) - 0.75).abs() < 1e-8);
            // A corner of a square: a right triangle with sides 0.5 of 2.
            assert!((below_zero(1.5, [1.0, tiny, 1.0]) - 0.03125).abs() < 1e-8);
        }
        assert_eq!(below_zero(-1.0, [0.0, 0.0, 1.0]), 1.0);
    }

    #[test]
    fn directions_hold_the_angle() {
        let mut state = 9;
        for _ in 0..500 {
            let g = [0, 1, 2].map(|_| random(&mut state) - 0.5);
            let radius = [0, 1, 2].map(|_| 0.3 * random(&mut state));
            let (d, secant) = direction(g, radius);
            for _ in 0..50 {
                let v = [0, 1, 2].map(|i| g[i] + radius[i] * (2.0 * random(&mut state) - 1.0));
                let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
                let along: f64 = (0..3).map(|i| v[i] * d[i]).sum();
                assert!(secant.is_infinite() || length <= along * secant, "{g:?} {radius:?} {v:?}");
            }
        }
        assert_eq!(direction([0.0; 3], [0.0; 3]).1, f64::INFINITY);
        assert!(direction([1e-200, 0.0, 0.0], [0.0; 3]).1 < 1.0 + 1e-12);
    }
}
