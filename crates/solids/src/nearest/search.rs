//! The nearest place of a curve.

use super::MOST_STRETCHES;
use super::tree::{CONVEX, Jet, Stretch, Tree, Vector, dot, length, less};
use fieldstone_field::Interval;

/// Places in a stretch along which the squared distance is not known to be convex.
const LOOKS: usize = 16;
/// Newton's method, which falls back on halving, takes at most so many steps.
const MOST_STEPS: usize = 60;
/// How closely the nearest place is found, in half lengths of its stretch.
const CLOSE: f64 = 1e-13;

/// The nearest place of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// c(u) there.
    pub(super) at: Vector,
    /// Its squared distance, the value of the function.
    pub(super) squared: f64,
    /// Below the distance of the exact curve.
    pub(super) floor: f64,
    /// The stretch.
    pub(super) leaf: u32,
}

/// The stretches that may be nearest to points of a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// A bound of second derivatives where the squared distance is convex along all of them.
    pub(super) convexity: Option<f64>,
    /// Whether they follow one another.
    pub(super) is_single: bool,
    /// By how much distances that the search finds are too large.
    pub(super) error: f64,
    /// How far from the nearest place the search may end.
    pub(super) drift: f64,
}

impl Tree {
    /// Finds the nearest place.
    pub(super) fn search(&self, x: Vector) -> Found {
        let mut best = Found { at: [0.0; 3], squared: f64::INFINITY, floor: f64::INFINITY, leaf: 0 };
        let mut floor = f64::INFINITY;
        let mut stack = [(0u32, 0.0f64); 64];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (number, below) = stack[count];
            if below * below > best.squared {
                // Farther than what was found.
                floor = floor.min(below);
                continue;
            }
            let stretch = &self.stretches[number as usize];
            let Some([a, b]) = stretch.halves else {
                let found = self.in_leaf(x, number, below);
                floor = floor.min(found.floor);
                if found.squared < best.squared {
                    best = found;
                }
                continue;
            };
            let [p, q] = [a, b].map(|half| self.stretches[half as usize].below(x).max(below));
            // The nearer half is looked at first: it lies on top.
            let pair = if p <= q { [(b, q), (a, p)] } else { [(a, p), (b, q)] };
            stack[count..count + 2].copy_from_slice(&pair);
            count += 2;
        }
        best.floor = floor.min(best.squared.sqrt());
        best
    }

    fn in_leaf(&self, x: Vector, leaf: u32, below: f64) -> Found {
        let stretch = &self.stretches[leaf as usize];
        if stretch.convexity(x, 0.0).is_some() {
            let found = found(x, self.descend(x, stretch), leaf);
            let lost = self.error(stretch, found.squared.sqrt()) + self.errors[0];
            return Found { floor: (found.squared.sqrt() * (1.0 - 1e-14) - lost).max(below), ..found };
        }
        Found { floor: below, ..self.look(x, stretch, leaf) }
    }

    /// Where |(c − x)·c′| is below this, a search ends.
    fn enough(&self, stretch: &Stretch, distance: f64) -> f64 {
        let close = CLOSE * stretch.radius() + 8.0 * self.errors[0] + 8.0 * f64::EPSILON * distance;
        close * stretch.speed[1].sqrt() + 2.0 * distance * self.errors[1]
    }

    /// How much farther than the minimum what [`descend`](Self::descend) finds may be. With g = (c − x)·c′ the squared
    /// distance is above its minimum by at most g²/q, and so the distance by that over twice itself, or its root.
    fn error(&self, stretch: &Stretch, distance: f64) -> f64 {
        let g = 2.0 * self.enough(stretch, distance);
        let squared = g * g / (CONVEX * stretch.speed[1].max(f64::MIN_POSITIVE));
        squared.sqrt().min(squared / distance.max(f64::MIN_POSITIVE)) + self.errors[0]
    }

    /// The minimum along a stretch where the squared distance is convex.
    fn descend(&self, x: Vector, stretch: &Stretch) -> Jet {
        // The ends of the bracket, and whether the derivative there is known.
        let (mut low, mut high) = ((stretch.from, false), (stretch.to, false));
        let mut place = (stretch.centre() + guess(x, stretch)).clamp(stretch.from, stretch.to);
        let mut jet = self.jet(place);
        for _ in 0..MOST_STEPS {
            let from_x = less(jet.at, x);
            let g = dot(from_x, jet.slope);
            let is_at_end = (place == stretch.from && g > 0.0) || (place == stretch.to && g < 0.0);
            if is_at_end || g.abs() <= self.enough(stretch, length(from_x)) {
                break;
            }
            *(if g > 0.0 { &mut high } else { &mut low }) = (place, true);
            let next = place - g / (dot(jet.slope, jet.slope) + dot(from_x, jet.bend));
            place = if low.0 < next && next < high.0 {
                next
            } else if next >= high.0 && !high.1 {
                high.0
            } else if next <= low.0 && !low.1 {
                low.0
            } else {
                0.5 * low.0 + 0.5 * high.0
            };
            if high.1 && low.1 && (place == low.0 || place == high.0) {
                break;
            }
            jet = self.jet(place);
        }
        jet
    }

    /// The least of some places of a stretch, its middle among them, and what Newton's method makes of it.
    fn look(&self, x: Vector, stretch: &Stretch, leaf: u32) -> Found {
        let step = (stretch.to - stretch.from) / LOOKS as f64;
        let place = |i: usize| if i == LOOKS { stretch.to } else { stretch.from + i as f64 * step };
        let mut places = [0.0; LOOKS + 2];
        for (i, p) in places.iter_mut().enumerate() {
            *p = if i > LOOKS { stretch.centre() } else { place(i) };
        }
        let mut least = f64::INFINITY;
        let mut chosen = 0;
        let jet = self.jets(&places, |best, (jet, lane)| {
            if least == f64::INFINITY {
                least = squared(x, best);
            }
            if squared(x, jet) < least {
                (least, chosen) = (squared(x, jet), lane);
                jet
            } else {
                best
            }
        });
        let mut best = found(x, jet, leaf);
        let (mut place, mut jet) = (places[chosen], jet);
        for _ in 0..4 {
            let from_x = less(jet.at, x);
            let (g, q) = (dot(from_x, jet.slope), dot(jet.slope, jet.slope) + dot(from_x, jet.bend));
            let next = (place - g / q).clamp(stretch.from, stretch.to);
            if !(q > 0.0) || !next.is_finite() {
                break;
            }
            place = next;
            jet = self.jet(place);
            let next = found(x, jet, leaf);
            if next.squared < best.squared {
                best = next;
            }
        }
        best
    }

    /// Above the distance from every point of a box to the middle of a stretch.
    pub(super) fn farthest(&self, leaf: u32, sides: [Interval<f64>; 3]) -> f64 {
        let at = self.stretches[leaf as usize].middle.at;
        let far = [0, 1, 2].map(|k| (sides[k].hi - at[k]).abs().max((at[k] - sides[k].lo).abs()));
        length(far) * (1.0 + 1e-14) + 2.0 * self.errors[0]
    }

    /// What may be nearest to points within `reach` of x.
    pub(super) fn near(&self, (x, reach): (Vector, f64), found: &Found) -> Near {
        let mut near = Near { convexity: Some(2.0), is_single: true, error: 0.0, drift: 0.0 };
        let mut stack = [0u32; 64];
        let (mut count, mut leaves, mut runs) = (1, 0, 0);
        let (mut end, mut first_is_in, mut last_is_in) = (f64::NAN, false, false);
        while count > 0 {
            count -= 1;
            let stretch = &self.stretches[stack[count] as usize];
            if !self.may_be_nearest(stretch, (x, reach), found) {
                continue;
            }
            if let Some([a, b]) = stretch.halves {
                stack[count..count + 2].copy_from_slice(&[b, a]);
                count += 2;
                continue;
            }
            leaves += 1;
            runs += usize::from(stretch.from != end);
            end = stretch.to;
            first_is_in |= stretch.from == self.stretches[0].from;
            last_is_in |= stretch.to == self.stretches[0].to;
            self.add_to(&mut near, stretch, (x, reach));
            if leaves > MOST_STRETCHES || near.convexity.is_none() {
                return Near { convexity: None, ..near };
            }
        }
        near.is_single = runs == 1 || (runs == 2 && self.is_closed && first_is_in && last_is_in);
        near
    }

    /// Whether a place of a stretch may be nearer than the one found, for a point within `reach` of x.
    fn may_be_nearest(&self, stretch: &Stretch, (x, reach): (Vector, f64), found: &Found) -> bool {
        let below = stretch.below(x);
        let apart = length(less(stretch.middle.at, found.at)) + stretch.radius() + 2.0 * self.errors[0];
        below * below * (1.0 - 1e-14) - found.squared * (1.0 + 1e-14) <= 2.0 * reach * apart * (1.0 + 1e-12)
    }

    fn add_to(&self, near: &mut Near, stretch: &Stretch, (x, reach): (Vector, f64)) {
        let Some(q) = stretch.convexity(x, reach) else {
            near.convexity = None;
            return;
        };
        // (c − x)·c″ over q, which is |c′|² more: the smaller, the farther from 0.
        let turn = q - stretch.speed[0];
        let along = if turn < 0.0 { 2.0 * -turn / q } else { 2.0 };
        near.convexity = near.convexity.map(|most| most.max(along * (1.0 + 1e-9)));
        let farthest = length(less(x, stretch.middle.at)) + stretch.radius() + reach;
        near.error = near.error.max(self.error(stretch, farthest));
        let off = 2.0 * self.enough(stretch, farthest) * stretch.speed[1].sqrt() / q;
        near.drift = near.drift.max(off + 2.0 * self.errors[0]);
    }
}

/// Where the parabola c + c′v + ½c″v² is nearest: Newton's method from the nearest place of the tangent on.
fn guess(x: Vector, stretch: &Stretch) -> f64 {
    let Jet { at, slope, bend } = stretch.middle;
    let half = stretch.half();
    let to_x = less(at, x);
    let [a, b, c] = [dot(to_x, slope), dot(slope, slope) + dot(to_x, bend), 1.5 * dot(slope, bend)];
    let d = 0.5 * dot(bend, bend);
    let mut v = (-a / b).clamp(-half, half);
    for _ in 0..3 {
        let (g, q) = (a + v * (b + v * (c + v * d)), b + v * (2.0 * c + 3.0 * d * v));
        v = (v - g / q).clamp(-half, half);
    }
    if v.is_nan() { 0.0 } else { v }
}

fn squared(x: Vector, jet: Jet) -> f64 {
    let away = less(x, jet.at);
    dot(away, away)
}

fn found(x: Vector, jet: Jet, leaf: u32) -> Found {
    Found { at: jet.at, squared: squared(x, jet), floor: 0.0, leaf }
}
