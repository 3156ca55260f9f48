//! The nearest place of a curve.

use super::MOST_STRETCHES;
use super::tree::{CONVEX, Jet, Stretch, Tree, Vector, dot, length, less};
use fieldstone_field::Interval;

/// Places in a stretch along which the squared distance is not known to be convex.
const LOOKS: usize = 16;
/// Newton's method, which falls back on halving, takes at most so many steps.
const MOST_STEPS: usize = 100;
/// Parts of such a stretch that are bounded together at most, and their least half length.
const MOST_PARTS: usize = 64;
const FINEST: f64 = 1e-7;
/// How closely the nearest place is found, in half lengths of its stretch.
const CLOSE: f64 = 1e-13;

/// The nearest place of a point of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// c(u) there.
    pub(super) at: Vector,
    /// The stretch.
    pub(super) leaf: u32,
    /// Whether the squared distance is convex along it, so that its minimum was found.
    pub(super) is_least: bool,
    /// Below the distances of all places of other stretches, or of all if this is not known to be the least.
    pub(super) floor: f64,
}

impl Found {
    pub(super) const NONE: Self =
        Self { at: [f64::INFINITY; 3], leaf: 0, is_least: false, floor: f64::INFINITY };
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
    /// The point of the grid near a point, at most as far away as a side of its cells is long.
    pub(super) fn on_grid(&self, x: Vector) -> Vector {
        x.map(|x| (x / self.grid).round() * self.grid)
    }

    /// Finds the nearest place of a point of the grid.
    pub(super) fn search(&self, x: Vector) -> Found {
        let mut best = Found::NONE;
        let mut squared = f64::INFINITY;
        let mut floor = f64::INFINITY;
        let mut stack = [(0u32, 0.0f64); 64];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (number, below) = stack[count];
            let stretch = &self.stretches[number as usize];
            // What is farther than what was found need not be looked at.
            if below * below > squared {
                floor = floor.min(below);
            } else if let Some([a, b]) = stretch.halves {
                let [p, q] = [a, b].map(|half| self.stretches[half as usize].below(x).max(below));
                // The nearer half is looked at first: it lies on top.
                let pair = if p <= q { [(b, q), (a, p)] } else { [(a, p), (b, q)] };
                stack[count..count + 2].copy_from_slice(&pair);
                count += 2;
            } else {
                let is_least = stretch.convexity(x, 0.0).is_some();
                let (at, below) = if is_least {
                    (self.descend(x, stretch).at, below)
                } else {
                    let at = self.look(x, stretch);
                    (at, self.parts_below(x, stretch, at).max(below))
                };
                let distance = length(less(x, at));
                let lost = if is_least { self.error(stretch, distance) } else { f64::INFINITY };
                let own = (distance * (1.0 - 1e-14) - lost).max(below);
                if distance * distance < squared {
                    // The floor of what was the best becomes one of others.
                    if best.is_least {
                        floor = floor.min(best.floor);
                    }
                    squared = distance * distance;
                    best = Found { at, leaf: number, is_least, floor: own };
                } else {
                    floor = floor.min(own);
                }
                if !is_least {
                    floor = floor.min(own);
                }
            }
        }
        best.floor = floor;
        best
    }

    /// Below the distance of the exact curve from a point whose nearest place on the grid was found.
    pub(super) fn floor(&self, x: Vector, found: &Found) -> f64 {
        let others = found.floor - 2.0 * self.grid;
        if !found.is_least {
            return others.max(0.0);
        }
        let distance = length(less(x, found.at));
        let own = distance * (1.0 - 1e-14) - self.error(&self.stretches[found.leaf as usize], distance);
        own.min(others).max(0.0)
    }

    /// Where |(c − x)·c′| is below this, a search ends.
    fn enough(&self, stretch: &Stretch, distance: f64) -> f64 {
        let close = CLOSE * stretch.radius + 8.0 * stretch.errors[0] + 8.0 * f64::EPSILON * distance;
        close * stretch.speed[1].sqrt() + 2.0 * distance * stretch.errors[1]
    }

    /// The same for a point near that of the grid, and for the exact curve.
    fn slack(&self, stretch: &Stretch, distance: f64) -> f64 {
        2.0 * self.enough(stretch, distance) + (2.0 * self.grid + self.gap) * stretch.speed[1].sqrt()
    }

    /// How much farther than the minimum what [`descend`](Self::descend) finds may be. With g = (c − x)·c′ the squared
    /// distance is above its minimum by at most g²/q, and so the distance by that over itself, or its root.
    fn error(&self, stretch: &Stretch, distance: f64) -> f64 {
        let g = self.slack(stretch, distance);
        let squared = g * g / (CONVEX * stretch.speed[1].max(f64::MIN_POSITIVE));
        squared.sqrt().min(squared / distance.max(f64::MIN_POSITIVE)) + 2.0 * stretch.errors[0] + self.gap
    }

    /// The minimum along a stretch where the squared distance is convex.
    fn descend(&self, x: Vector, stretch: &Stretch) -> Jet {
        // The ends of the bracket, and whether the derivative there is known.
        let (mut low, mut high) = ((-1.0, false), (1.0, false));
        let squared = dot(stretch.tangent, stretch.tangent).max(f64::MIN_POSITIVE);
        let mut place = (dot(less(x, stretch.at), stretch.tangent) / squared).clamp(-1.0, 1.0);
        let mut jet = self.jet(stretch, place);
        let enough = self.enough(stretch, length(less(x, stretch.at)));
        for _ in 0..MOST_STEPS {
            let from_x = less(jet.at, x);
            let g = dot(from_x, jet.slope);
            let is_at_end = (place == -1.0 && g > 0.0) || (place == 1.0 && g < 0.0);
            if is_at_end || g.abs() <= enough {
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
            jet = self.jet(stretch, place);
        }
        jet
    }

    /// The nearest of some places of a stretch, its middle among them, and of what Newton's method makes of it.
    fn look(&self, x: Vector, stretch: &Stretch) -> Vector {
        let squared = |jet: &Jet| dot(less(x, jet.at), less(x, jet.at));
        let mut best = (f64::INFINITY, stretch.at);
        let mut start = 0.0;
        for i in 0..=LOOKS {
            let jet = self.jet(stretch, look_at(i));
            if squared(&jet) < best.0 {
                best = (squared(&jet), jet.at);
                start = look_at(i);
            }
        }
        for _ in 0..4 {
            let jet = self.jet(stretch, start);
            if squared(&jet) < best.0 {
                best = (squared(&jet), jet.at);
            }
            let from_x = less(jet.at, x);
            let (g, q) = (dot(from_x, jet.slope), dot(jet.slope, jet.slope) + dot(from_x, jet.bend));
            let next = (start - g / q).clamp(-1.0, 1.0);
            if q.is_nan() || q <= 0.0 || !next.is_finite() {
                break;
            }
            start = next;
        }
        best.1
    }

    /// Below the distances of all places of a stretch where `at` is near the nearest one: in a part with the middle m and the half
    /// length h the squared distance is at least what it is in m, less |its slope| h, less h² times what q may be below 0.
    /// Parts that may hold a nearer place are halved, if they are few.
    fn parts_below(&self, x: Vector, stretch: &Stretch, at: Vector) -> f64 {
        let Some(q) = stretch.lowest_q(x, 0.0) else { return 0.0 };
        let enough = dot(less(x, at), less(x, at)) * (1.0 - 1e-13);
        let (mut middles, mut half, mut count) = ([0.0; MOST_PARTS], 1.0, 1);
        let mut floor = f64::INFINITY;
        while count > 0 {
            let (mut left, mut lowest) = (0, f64::INFINITY);
            let parts = middles;
            for &middle in &parts[..count] {
                let jet = self.jet(stretch, middle);
                let from_x = less(jet.at, x);
                let value = dot(from_x, from_x);
                let fall = 2.0 * dot(from_x, jet.slope).abs() * half + (-q).max(0.0) * half * half;
                let below = value - fall * (1.0 + 1e-12) - 1e-14 * value;
                if below >= enough || half < FINEST {
                    floor = floor.min(below);
                    continue;
                }
                lowest = lowest.min(below);
                if left + 2 <= MOST_PARTS {
                    middles[left..left + 2].copy_from_slice(&[middle - 0.5 * half, middle + 0.5 * half]);
                }
                left += 2;
            }
            if left > MOST_PARTS {
                floor = floor.min(lowest);
                break;
            }
            (half, count) = (0.5 * half, left);
        }
        floor.max(0.0).sqrt() * (1.0 - 1e-14) - 2.0 * stretch.errors[0]
    }

    /// Above the distances from all points of a box to what a search finds, which looks at some places of every stretch that may
    /// be nearest.
    pub(super) fn farthest(&self, leaf: u32, sides: [Interval<f64>; 3]) -> f64 {
        let stretch = &self.stretches[leaf as usize];
        let from = |i: usize| {
            let at = self.jet(stretch, look_at(i)).at;
            length([0, 1, 2].map(|k| (sides[k].hi - at[k]).abs().max((at[k] - sides[k].lo).abs())))
        };
        let distance = (0..=LOOKS).map(from).fold(f64::INFINITY, f64::min) * (1.0 + 1e-14);
        distance + 4.0 * self.grid + self.error(stretch, distance)
    }

    /// What may be nearest to points within `reach` of x.
    pub(super) fn near(&self, (x, reach): (Vector, f64), found: &Found) -> Near {
        let reach = reach + 4.0 * self.grid;
        let mut near = Near { convexity: Some(2.0), is_single: true, error: 0.0, drift: 0.0 };
        let squared = dot(less(x, found.at), less(x, found.at));
        let mut stack = [0u32; 64];
        let (mut count, mut leaves, mut runs) = (1, 0, 0);
        let (mut before, mut ends) = (None::<&Stretch>, [false; 2]);
        while count > 0 {
            count -= 1;
            let stretch = &self.stretches[stack[count] as usize];
            if !may_be_nearest(stretch, (x, reach), (found, squared)) {
                continue;
            }
            if let Some([a, b]) = stretch.halves {
                stack[count..count + 2].copy_from_slice(&[b, a]);
                count += 2;
                continue;
            }
            leaves += 1;
            runs += usize::from(!before.is_some_and(|before| before.is_followed_by(stretch)));
            before = Some(stretch);
            let is_end = self.is_end(stretch);
            ends = [0, 1].map(|side| ends[side] || is_end[side]);
            self.add_to(&mut near, stretch, (x, reach));
            if leaves > MOST_STRETCHES || near.convexity.is_none() {
                return Near { convexity: None, ..near };
            }
        }
        near.is_single = runs == 1 || (runs == 2 && self.is_closed && ends == [true; 2]);
        near
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
        let farthest = length(less(x, stretch.at)) + stretch.radius + reach;
        near.error = near.error.max(self.error(stretch, farthest));
        let off = self.slack(stretch, farthest) * stretch.speed[1].sqrt() / q;
        near.drift = near.drift.max(2.0 * (off + 2.0 * stretch.errors[0] + self.gap));
    }
}

/// Where stretches are looked at, from −1 to 1.
fn look_at(i: usize) -> f64 {
    2.0 * i as f64 / LOOKS as f64 - 1.0
}

/// Whether a place of a stretch may be nearer than the one found, for a point within `reach` of x.
fn may_be_nearest(stretch: &Stretch, (x, reach): (Vector, f64), (found, squared): (&Found, f64)) -> bool {
    let below = stretch.below(x);
    let apart = length(less(stretch.at, found.at)) + stretch.radius;
    below * below * (1.0 - 1e-14) - squared * (1.0 + 1e-14) <= 2.0 * reach * apart * (1.0 + 1e-12)
}
