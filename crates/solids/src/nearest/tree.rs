//! A curve in stretches that hardly bend, in a tree.

use crate::rounding::rounding;
use crate::slope::slope;
use fieldstone_field::{
    F64, Field, Graph, Input, Interval, Intervals, NodeId, Points, Tape, TapeOptions, Workspace,
};
use std::cell::RefCell;

/// A stretch is cut until it leaves its tangent by no more than this part of its half length.
const BENT: f64 = 0.04;
/// Or this part of the size of the curve.
const TINY: f64 = 1e-9;
/// Or so often.
const DEEPEST: u32 = 14;
/// And no curve is cut into more stretches.
const MOST_LEAVES: usize = 4096;
/// No stretch is longer than this part of the size of the curve, so that boxes are bounded well from above too.
const LONG: f64 = 0.125;
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

/// A part of the curve: all of it within `sag` of the line from at − `tangent` to at + `tangent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) middle: Jet,
    pub(super) tangent: Vector,
    pub(super) sag: f64,
    /// |c′|², from and to.
    pub(super) speed: [f64; 2],
    /// All c″ lie within `spread` of this.
    pub(super) bend: Vector,
    pub(super) spread: f64,
    /// Whether the derivatives are known; otherwise the line is a point.
    pub(super) is_smooth: bool,
    /// The two halves, if any: numbers of stretches.
    pub(super) halves: Option<[u32; 2]>,
}

impl Stretch {
    pub(super) fn centre(&self) -> f64 {
        0.5 * self.from + 0.5 * self.to
    }

    pub(super) fn half(&self) -> f64 {
        (self.to - self.centre()).max(self.centre() - self.from)
    }

    /// How far the curve goes from the middle.
    pub(super) fn radius(&self) -> f64 {
        (length(self.tangent) + self.sag) * (1.0 + 1e-14)
    }

    /// Below the distances of all its places.
    pub(super) fn below(&self, x: Vector) -> f64 {
        let to_x = less(x, self.middle.at);
        let squared = dot(self.tangent, self.tangent);
        let part = if squared > 0.0 { (dot(to_x, self.tangent) / squared).clamp(-1.0, 1.0) } else { 0.0 };
        let rest = less(to_x, self.tangent.map(|t| t * part));
        (length(rest) * (1.0 - 1e-14) - self.sag).max(0.0)
    }

    /// Below (c − x)·c″ all over the stretch, for all x within `reach` of one.
    pub(super) fn turn(&self, x: Vector, reach: f64) -> f64 {
        let from_x = less(self.middle.at, x);
        let moved = self.radius() + reach;
        let slack = moved * length(self.bend) + (length(from_x) + moved) * self.spread;
        dot(from_x, self.bend) - slack * (1.0 + 1e-12) - 1e-14 * length(from_x) * length(self.bend)
    }

    /// Below q, as [`turn`](Self::turn); `None` where it may not be well above 0.
    pub(super) fn convexity(&self, x: Vector, reach: f64) -> Option<f64> {
        let q = self.speed[0] + self.turn(x, reach);
        (self.is_smooth && q > CONVEX * self.speed[1] && self.speed[0] > 0.0).then_some(q)
    }
}

/// A curve.
pub(super) struct Tree {
    /// c, c′ and c″ of u.
    curve: Tape,
    /// The first is the whole curve.
    pub(super) stretches: Vec<Stretch>,
    /// Whether the end follows the start without a corner.
    pub(super) is_closed: bool,
    pub(super) last_leaf: u32,
    /// By how much computed places may be wrong, and computed derivatives.
    pub(super) errors: [f64; 2],
}

thread_local! {
    static POINTS: RefCell<Workspace<F64, Points>> = RefCell::new(Workspace::new());
}

/// Evaluates what is only needed while a tree is made.
struct Surveyor<'a> {
    curve: &'a Tape,
    /// The bounds of rounding errors of c and c′.
    errors: &'a Tape,
    boxes: Workspace<F64, Intervals>,
    /// The size of the curve.
    size: f64,
}

impl Tree {
    /// The curve of a program; `None` where it is not finite.
    pub(super) fn new(
        program: &Graph,
        coordinates: [NodeId; 3],
        (over, range): (Input, [f64; 2]),
    ) -> Option<Self> {
        let mut graph = program.clone();
        let slopes = coordinates.map(|c| slope(&mut graph, c, over));
        let bends = slopes.map(|s| slope(&mut graph, s, over));
        let jet: Vec<NodeId> = coordinates.iter().chain(&slopes).chain(&bends).copied().collect();
        let errors = rounding(&mut graph, &jet[..6]);
        let tape = |outputs: &[NodeId]| {
            let field = Field::new(graph.clone(), outputs[0], outputs[1..].to_vec());
            Tape::new(
                &field,
                &TapeOptions { varying: vec![over], attributes: true, ..TapeOptions::default() },
            )
        };
        let (curve, errors) = (tape(&jet), tape(&errors));
        let mut surveyor = Surveyor { curve: &curve, errors: &errors, boxes: Workspace::new(), size: 0.0 };
        let whole = surveyor.places(range)?;
        surveyor.size = whole.iter().map(|side| side.hi - side.lo).fold(0.0, f64::max);
        let mut stretches = vec![surveyor.stretch(range)?];
        let mut wrong = [0.0f64; 2];
        let (mut leaves, mut next) = (0, 0);
        let mut depths = vec![0];
        while next < stretches.len() {
            let stretch: Stretch = stretches[next];
            let is_fine = surveyor.is_fine(&stretch) || depths[next] >= DEEPEST;
            if is_fine || leaves + (stretches.len() - next) >= MOST_LEAVES {
                let rounded = surveyor.rounding(&stretch);
                wrong = [0, 1].map(|k| wrong[k].max(rounded[k]));
                leaves += 1;
            } else {
                let first = stretches.len() as u32;
                let middle = stretch.centre();
                for part in [[stretch.from, middle], [middle, stretch.to]] {
                    stretches.push(surveyor.stretch(part)?);
                    depths.push(depths[next] + 1);
                }
                stretches[next].halves = Some([first, first + 1]);
            }
            next += 1;
        }
        if !wrong[0].is_finite() {
            return None;
        }
        let mut tree = Self { curve, stretches, is_closed: false, last_leaf: 0, errors: wrong };
        tree.finish(range);
        Some(tree)
    }

    /// Adds what rounding may do to the sags, and looks whether the curve closes.
    fn finish(&mut self, range: [f64; 2]) {
        let [place, slope] = self.errors;
        for stretch in &mut self.stretches {
            if !slope.is_finite() {
                stretch.is_smooth = false;
            }
            let moved = if stretch.is_smooth { slope * stretch.half() } else { 0.0 };
            stretch.sag += 2.0 * place + moved + 1e-14 * length(stretch.tangent);
        }
        let mut last = 0;
        while let Some([_, second]) = self.stretches[last as usize].halves {
            last = second;
        }
        self.last_leaf = last;
        let [start, end] = range.map(|u| self.jet(u));
        let whole = self.stretches[0].radius();
        let gap = length(less(start.at, end.at));
        let [a, b] = [start, end].map(|jet| jet.slope.map(|x| x / length(jet.slope)));
        let turned = length(less(a, b));
        self.is_closed = gap <= 1e-13 * whole && turned <= 1e-13;
        if self.is_closed {
            // The gap is one more error.
            self.errors[0] += gap + 1e-13 * whole;
        }
    }

    /// c, c′ and c″ at a place.
    pub(super) fn jet(&self, u: f64) -> Jet {
        self.jets(&[u], |jet, _| jet)
    }

    /// The same at several places, at most [`LANES`](fieldstone_field::LANES): `choose` goes through them from the first
    /// result on.
    pub(super) fn jets(&self, places: &[f64], mut choose: impl FnMut(Jet, (Jet, usize)) -> Jet) -> Jet {
        evaluate(&self.curve, places, |points| {
            let jet = |lane: usize| {
                let vector = |first: usize| [0, 1, 2].map(|k| points.output(first + k, 0)[lane]);
                Jet { at: vector(0), slope: vector(3), bend: vector(6) }
            };
            (1..places.len()).fold(jet(0), |best, lane| choose(best, (jet(lane), lane)))
        })
    }
}

fn evaluate<R>(tape: &Tape, places: &[f64], read: impl FnOnce(&Workspace<F64, Points>) -> R) -> R {
    POINTS.with_borrow_mut(|points| {
        points.input(0, 0)[..places.len()].copy_from_slice(places);
        points.run(tape, places.len());
        read(points)
    })
}

fn sized(box_: [Interval<f64>; 3]) -> Interval<f64> {
    let squares = box_.map(|side| {
        let (a, b) = (side.lo.abs(), side.hi.abs());
        let least = if side.lo <= 0.0 && side.hi >= 0.0 { 0.0 } else { a.min(b) };
        [least * least, a.max(b) * a.max(b)]
    });
    let sum = |k: usize| squares.iter().map(|s| s[k]).sum::<f64>();
    Interval::new(sum(0) * (1.0 - 1e-14), sum(1) * (1.0 + 1e-14))
}

/// The middle of a box and its half diagonal.
fn ball_of(sides: [Interval<f64>; 3]) -> (Vector, f64) {
    let middle = sides.map(|s| 0.5 * s.lo + 0.5 * s.hi);
    let reach = [0, 1, 2].map(|k| (sides[k].hi - middle[k]).max(middle[k] - sides[k].lo));
    (middle, length(reach) * (1.0 + 1e-14))
}

fn is_finite(sides: &[Interval<f64>; 3]) -> bool {
    sides.iter().all(|s| s.lo.is_finite() && s.hi.is_finite())
}

impl Surveyor<'_> {
    fn outputs(&mut self, tape: &Tape, range: [f64; 2], first: usize) -> [Interval<f64>; 3] {
        (self.boxes.input(0, 0)[0], self.boxes.input(0, 1)[0]) = (range[0], range[1]);
        self.boxes.run(tape, 1);
        [0, 1, 2]
            .map(|k| Interval::new(self.boxes.output(first + k, 0)[0], self.boxes.output(first + k, 1)[0]))
    }

    /// A box around a part of the curve.
    fn places(&mut self, range: [f64; 2]) -> Option<[Interval<f64>; 3]> {
        let places = self.outputs(self.curve, range, 0);
        is_finite(&places).then_some(places)
    }

    fn stretch(&mut self, range: [f64; 2]) -> Option<Stretch> {
        let places = self.places(range)?;
        let [slopes, bends] = [3, 6].map(|first| self.outputs(self.curve, range, first));
        let [from, to] = range;
        let centre = 0.5 * from + 0.5 * to;
        let half = (to - centre).max(centre - from) * (1.0 + 1e-15);
        let middle = evaluate(self.curve, &[centre], |points| {
            let vector = |first: usize| [0, 1, 2].map(|k| points.output(first + k, 0)[0]);
            Jet { at: vector(0), slope: vector(3), bend: vector(6) }
        });
        let (bend, spread) = ball_of(bends);
        let speed = if is_finite(&slopes) { sized(slopes) } else { Interval::new(0.0, f64::INFINITY) };
        let mut stretch = Stretch {
            from,
            to,
            middle,
            tangent: [0.0; 3],
            sag: 0.0,
            speed: [speed.lo, speed.hi],
            bend,
            spread,
            is_smooth: is_finite(&slopes) && is_finite(&bends),
            halves: None,
        };
        let (_, radius) = ball_of(places);
        // The middle may be anywhere in the box.
        let around = (2.0 * radius).min(speed.hi.sqrt() * half * (1.0 + 1e-14));
        if stretch.is_smooth {
            stretch.tangent = middle.slope.map(|s| s * half);
            stretch.sag = 0.5 * sized(bends).hi.sqrt() * half * half * (1.0 + 1e-12);
        }
        if !stretch.is_smooth || stretch.sag > around {
            (stretch.tangent, stretch.sag) = ([0.0; 3], around);
        }
        middle.at.iter().all(|x| x.is_finite()).then_some(stretch)
    }

    /// Whether a stretch needs not be cut.
    fn is_fine(&self, stretch: &Stretch) -> bool {
        let long = length(stretch.tangent);
        (stretch.sag <= BENT * long && long <= LONG * self.size && stretch.is_smooth)
            || stretch.radius() <= TINY * self.size
    }

    /// What rounding does to places and derivatives.
    fn rounding(&mut self, stretch: &Stretch) -> [f64; 2] {
        let range = [stretch.from, stretch.to];
        [0, 3].map(|first| {
            let errors = self.outputs(self.errors, range, first).map(|e| e.hi);
            let size = length(errors);
            if size.is_nan() { f64::INFINITY } else { size }
        })
    }
}
