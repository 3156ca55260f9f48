//! A curve in stretches that hardly bend, in a tree.
//!
//! On each stretch the parameter is t from −1 to 1, and the leaves are polynomials of t: what a Taylor model (`taylor`) leaves is
//! an error of the place of the curve.

use super::taylor::{ORDERS, Program, Series};
use fieldstone_field::{Graph, Input, Interval, Node, NodeId};

/// A stretch is cut until it leaves its tangent by no more than this part of its half length.
const BENT: f64 = 0.05;
/// Or this part of the size of the curve.
const TINY: f64 = 1e-9;
/// Or so often.
const DEEPEST: u32 = 14;
/// No curve is cut into more stretches.
const MOST_LEAVES: usize = 4096;
/// And no more operations are spent on it.
const MOST_WORK: usize = 4_000_000;
/// No stretch is longer than this part of the size of the curve, so that boxes are bounded well from above too.
const LONG: f64 = 0.125;
/// Models with larger errors, as parts of the size of the curve, are cut.
const INEXACT: f64 = 3e-14;
/// And where they stay larger than this, the curve is none for this module.
const WRONG: f64 = 1e-10;
/// Where q is above this part of |c′|², the squared distance is called convex.
pub(super) const CONVEX: f64 = 0.02;

pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn less(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// c, c′ and c″ at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub(super) at: Vector,
    pub(super) slope: Vector,
    pub(super) bend: Vector,
}

/// A part of the curve: all of it within `sag` of the line from at − `tangent` to at + `tangent`. Derivatives are by t.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// The part of the range.
    from: f64,
    to: f64,
    pub(super) at: Vector,
    pub(super) tangent: Vector,
    /// 1/|tangent|², or 0.
    per_tangent: f64,
    pub(super) sag: f64,
    /// The corners of a box around it.
    corners: [Vector; 2],
    /// How far the curve goes from the middle.
    pub(super) radius: f64,
    /// |c′|², from and to.
    pub(super) speed: [f64; 2],
    /// All c″ lie within `spread` of this, whose length stands beside it.
    bend: (Vector, f64),
    spread: f64,
    /// Whether the derivatives are known; otherwise the line is a point.
    is_smooth: bool,
    /// By how much the polynomial may be wrong, and its derivative.
    pub(super) errors: [f64; 2],
    /// The two halves, if any: numbers of stretches.
    pub(super) halves: Option<[u32; 2]>,
    /// The number of the polynomial.
    pub(super) curve: u32,
}

impl Stretch {
    /// Below the distances of all its places.
    pub(super) fn below(&self, x: Vector) -> f64 {
        if self.halves.is_some() {
            let [low, high] = self.corners;
            let gap = |k: usize| (low[k] - x[k]).max(x[k] - high[k]).max(0.0);
            return length([gap(0), gap(1), gap(2)]) * (1.0 - 1e-14);
        }
        let to_x = less(x, self.at);
        let part = (dot(to_x, self.tangent) * self.per_tangent).clamp(-1.0, 1.0);
        let rest = less(to_x, self.tangent.map(|t| t * part));
        (length(rest) * (1.0 - 1e-14) - self.sag).max(0.0)
    }

    /// Below q = |c′|² + (c − x)·c″ all over the stretch, for all x within `reach` of one; `None` where nothing is known.
    pub(super) fn lowest_q(&self, x: Vector, reach: f64) -> Option<f64> {
        let from_x = less(self.at, x);
        let (bend, bent) = self.bend;
        let (away, moved) = (length(from_x), self.radius + reach);
        let slack = (moved + 1e-14 * away) * bent + (away + moved) * self.spread;
        let q = self.speed[0] + dot(from_x, bend) - slack * (1.0 + 1e-12);
        self.is_smooth.then_some(q)
    }

    /// The same if it is well above 0.
    pub(super) fn convexity(&self, x: Vector, reach: f64) -> Option<f64> {
        self.lowest_q(x, reach).filter(|&q| q > CONVEX * self.speed[1] && self.speed[0] > 0.0)
    }
}

/// Coefficients of 1, t, t², …
type Polynomial = [Vector; ORDERS - 1];

/// A curve.
pub(super) struct Tree {
    /// The first is the whole curve.
    pub(super) stretches: Vec<Stretch>,
    curves: Vec<Polynomial>,
    /// Whether the end follows the start without a corner.
    pub(super) is_closed: bool,
    /// How far the two ends are apart then.
    pub(super) gap: f64,
    /// Places are searched for points whose coordinates are multiples of this, a power of two.
    pub(super) grid: f64,
}

impl Tree {
    /// The curve of a program; `None` where it is not finite, has corners within the range of u, or depends on something else.
    pub(super) fn new(
        program: &Graph,
        coordinates: [NodeId; 3],
        (over, range): (Input, [f64; 2]),
    ) -> Option<Self> {
        let is_other = |n: NodeId| matches!(program.node(n), Node::Input(input) if *input != over);
        if program.reachable(&coordinates).into_iter().any(is_other) {
            return None;
        }
        let program = Program::new(program, coordinates);
        let most = (MOST_WORK / (program.len() * ORDERS * 2)).clamp(64, MOST_LEAVES);
        let (root, _) = stretch(&program, range)?;
        let places = program.expand(Interval::new(range[0], range[1]), 1.0).map(|series| series[0].width());
        let size = places.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let mut tree =
            Self { stretches: vec![root], curves: Vec::new(), is_closed: false, gap: 0.0, grid: 0.0 };
        let (mut depths, mut next) = (vec![0], 0);
        while next < tree.stretches.len() {
            let whole = tree.stretches[next];
            let is_last = tree.stretches.len() - next + tree.curves.len() >= most;
            let (_, polynomial) = stretch(&program, [whole.from, whole.to])?;
            if is_last || depths[next] >= DEEPEST || is_fine(&whole, size) {
                if whole.errors[0] > WRONG * size {
                    return None;
                }
                tree.stretches[next].curve = tree.curves.len() as u32;
                tree.curves.push(polynomial);
            } else {
                let first = tree.stretches.len() as u32;
                let middle = 0.5 * whole.from + 0.5 * whole.to;
                for part in [[whole.from, middle], [middle, whole.to]] {
                    tree.stretches.push(stretch(&program, part)?.0);
                    depths.push(depths[next] + 1);
                }
                tree.stretches[next].halves = Some([first, first + 1]);
            }
            next += 1;
        }
        // All bounds hold for the polynomials too.
        let leaves = tree.stretches.iter().filter(|s| s.halves.is_none());
        let error = leaves.map(|leaf| leaf.errors[0]).fold(0.0, f64::max);
        for stretch in &mut tree.stretches {
            stretch.widen(error);
        }
        // Halves stand behind what they are halves of.
        for i in (0..tree.stretches.len()).rev() {
            if let Some([a, b]) = tree.stretches[i].halves {
                let [a, b] = [a, b].map(|half| tree.stretches[half as usize].corners);
                tree.stretches[i].corners =
                    [[0, 1, 2].map(|k| a[0][k].min(b[0][k])), [0, 1, 2].map(|k| a[1][k].max(b[1][k]))];
            }
        }
        tree.finish();
        Some(tree)
    }

    /// Looks whether the curve closes, and how large it is.
    fn finish(&mut self) {
        let end = |side: usize| {
            let mut at = 0;
            while let Some(halves) = self.stretches[at as usize].halves {
                at = halves[side];
            }
            self.jet(&self.stretches[at as usize], if side == 0 { -1.0 } else { 1.0 })
        };
        let [start, end] = [end(0), end(1)];
        let gap = length(less(start.at, end.at));
        let [a, b] = [start, end].map(|jet| jet.slope.map(|x| x / length(jet.slope)));
        let [low, high] = self.stretches[0].corners;
        let whole = length(less(high, low));
        self.grid = 2f64.powi((whole.log2().floor() as i32 - 46).clamp(-900, 900));
        self.is_closed = gap <= 1e-13 * whole && length(less(a, b)) <= 1e-12;
        self.gap = if self.is_closed { gap + 1e-12 * whole } else { 0.0 };
    }

    /// Whether a stretch is the first or the last of the curve.
    pub(super) fn is_end(&self, stretch: &Stretch) -> [bool; 2] {
        [stretch.from == self.stretches[0].from, stretch.to == self.stretches[0].to]
    }

    /// c, c′ and c″ at a place of a leaf, by Horner's rule.
    pub(super) fn jet(&self, leaf: &Stretch, t: f64) -> Jet {
        let polynomial = &self.curves[leaf.curve as usize];
        let (mut at, mut slope, mut bend) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for c in polynomial.iter().rev() {
            for k in 0..3 {
                bend[k] = bend[k] * t + 2.0 * slope[k];
                slope[k] = slope[k] * t + at[k];
                at[k] = at[k] * t + c[k];
            }
        }
        Jet { at, slope, bend }
    }
}

impl Stretch {
    /// Adds an error of all places.
    fn widen(&mut self, error: f64) {
        self.sag += error + 1e-14 * length(self.tangent);
        self.radius = (length(self.tangent) + self.sag) * (1.0 + 1e-14);
        let reach = self.tangent.map(|t| t.abs() + self.sag);
        let squared = dot(self.tangent, self.tangent);
        self.per_tangent = if squared > 0.0 { 1.0 / squared } else { 0.0 };
        self.corners = [-1.0, 1.0]
            .map(|side| [0, 1, 2].map(|k| self.at[k] + side * (reach[k] + 1e-15 * self.at[k].abs())));
    }

    /// Whether this one ends where another starts.
    pub(super) fn is_followed_by(&self, other: &Self) -> bool {
        self.to == other.from
    }
}

fn is_fine(stretch: &Stretch, size: f64) -> bool {
    let long = length(stretch.tangent);
    let is_straight = stretch.sag <= BENT * long && long <= LONG * size && stretch.is_smooth;
    (is_straight && stretch.errors[0] <= INEXACT * size) || stretch.radius <= TINY * size
}

/// The sum of squares.
fn sized(sides: [Interval<f64>; 3]) -> Interval<f64> {
    let squares = sides.map(|side| {
        let (a, b) = (side.lo.abs(), side.hi.abs());
        let least = if side.lo <= 0.0 && side.hi >= 0.0 { 0.0 } else { a.min(b) };
        [least * least, a.max(b) * a.max(b)]
    });
    let sum = |k: usize| squares.iter().map(|s| s[k]).sum::<f64>();
    Interval::new(sum(0) * (1.0 - 1e-14), sum(1) * (1.0 + 1e-14))
}

/// The middle of a box and its half diagonal.
fn ball_of(sides: [Interval<f64>; 3]) -> (Vector, f64) {
    let middle = sides.map(middle_of);
    let reach = [0, 1, 2].map(|k| (sides[k].hi - middle[k]).max(middle[k] - sides[k].lo));
    (middle, length(reach) * (1.0 + 1e-14))
}

fn middle_of(side: Interval<f64>) -> f64 {
    0.5 * side.lo + 0.5 * side.hi
}

fn is_finite(sides: &[Interval<f64>; 3]) -> bool {
    sides.iter().all(|s| s.lo.is_finite() && s.hi.is_finite())
}

/// By how much the polynomial of a model, its derivative and its second derivative may be wrong, rounding included.
fn errors_of(at: &[Series; 3], over: &[Series; 3], polynomial: &Polynomial) -> [f64; 3] {
    let mut errors = [[0.0; 3]; 3];
    for axis in 0..3 {
        for k in 0..ORDERS {
            let (wrong, size) = match polynomial.get(k) {
                Some(c) => (at[axis][k].width(), c[axis].abs()),
                None => (over[axis][k].lo.abs().max(over[axis][k].hi.abs()), 0.0),
            };
            // Horner's rule rounds twice at each of its steps.
            let wrong = wrong + 32.0 * f64::EPSILON * size;
            let k = k as f64;
            for (error, times) in errors.iter_mut().zip([1.0, k, k * (k - 1.0)]) {
                error[axis] += times * wrong;
            }
        }
    }
    errors.map(|e| {
        let size = length(e) * (1.0 + 1e-12);
        if size.is_nan() { f64::INFINITY } else { size }
    })
}

/// A derivative of the curve all over a stretch: how far it goes from where the polynomial has it in the middle.
fn spread_of(order: usize, polynomial: &Polynomial, error: f64) -> f64 {
    let falling = |k: usize| (0..order).map(|i| (k - i) as f64).product::<f64>();
    let sides = [0, 1, 2].map(|axis| {
        (order + 1..polynomial.len()).map(|k| falling(k) * polynomial[k][axis].abs()).sum::<f64>()
    });
    length(sides) * (1.0 + 1e-12) + error
}

/// What is known of a part of the curve beside where it is.
struct Derivatives {
    /// |c′|², from and to.
    speed: [f64; 2],
    /// c″ in the middle and how far it goes from there.
    bend: Vector,
    spread: f64,
}

/// From the Taylor model, or from intervals where they are narrower.
fn derivatives(over: &[Series; 3], polynomial: &Polynomial, errors: [f64; 3]) -> Option<Derivatives> {
    let order = |k: usize| [0, 1, 2].map(|axis| over[axis][k]);
    let (slopes, bends) = (order(1), order(2).map(|c| Interval::new(2.0 * c.lo, 2.0 * c.hi)));
    if !is_finite(&slopes) || !is_finite(&bends) || errors.iter().any(|e| !e.is_finite()) {
        return None;
    }
    let (speed, reach) = (length(polynomial[1]), spread_of(1, polynomial, errors[1]));
    let model = [(speed - reach).max(0.0).powi(2) * (1.0 - 1e-14), (speed + reach).powi(2) * (1.0 + 1e-14)];
    let ranges = sized(slopes);
    let speed = [
        model[0].max((ranges.lo.sqrt() - errors[1]).max(0.0).powi(2) * (1.0 - 1e-14)),
        model[1].min((ranges.hi.sqrt() + errors[1]).powi(2) * (1.0 + 1e-14)),
    ];
    let (middle, radius) = ball_of(bends);
    let spread = spread_of(2, polynomial, errors[2]);
    let (bend, spread) = if spread < radius + errors[2] {
        (polynomial[2].map(|c| 2.0 * c), spread)
    } else {
        (middle, radius + errors[2])
    };
    Some(Derivatives { speed, bend, spread })
}

/// A part of the curve, and its polynomial.
fn stretch(program: &Program<'_>, range: [f64; 2]) -> Option<(Stretch, Polynomial)> {
    let [from, to] = range;
    let centre = 0.5 * from + 0.5 * to;
    let half = (to - centre).max(centre - from);
    let at = program.expand(Interval::new(centre, centre), half);
    let over = program.expand(Interval::new(from, to), half);
    let order = |series: &[Series; 3], k: usize| [0, 1, 2].map(|axis| series[axis][k]);
    let places = order(&over, 0);
    if !is_finite(&places) {
        return None;
    }
    let mut polynomial: Polynomial = std::array::from_fn(|k| [0, 1, 2].map(|axis| middle_of(at[axis][k])));
    let mut errors = errors_of(&at, &over, &polynomial);
    let known = derivatives(&over, &polynomial, errors);
    if known.is_none() {
        // A point in the middle of all places.
        polynomial = [[0.0; 3]; ORDERS - 1];
        polynomial[0] = places.map(middle_of);
        errors = [ball_of(places).1, 0.0, 0.0];
    }
    // The middle may be anywhere in the box of all places.
    let around = 2.0 * ball_of(places).1 * (1.0 + 1e-14);
    let is_smooth = known.is_some();
    let known = known.unwrap_or(Derivatives { speed: [0.0, 0.0], bend: [0.0; 3], spread: 0.0 });
    let bent = 0.5 * (length(known.bend) + known.spread) * (1.0 + 1e-12);
    let sag = bent + ball_of(order(&at, 0)).1 + ball_of(order(&at, 1)).1;
    let is_line = is_smooth && sag <= around;
    let mut stretch = Stretch {
        from,
        to,
        at: polynomial[0],
        tangent: if is_line { polynomial[1] } else { [0.0; 3] },
        per_tangent: 0.0,
        sag: if is_line { sag } else { around },
        radius: 0.0,
        corners: [[0.0; 3]; 2],
        speed: known.speed,
        bend: (known.bend, length(known.bend)),
        spread: known.spread,
        is_smooth,
        errors: [errors[0], errors[1]],
        halves: None,
        curve: 0,
    };
    stretch.widen(0.0);
    Some((stretch, polynomial))
}
