//! What holds the minimum all over a box.
//!
//! # Theory
//! Let V be the places where F can be as small as the bound from above that the values at the first places of searches
//! give. The search at a point of the box stays in V. If V is one stretch, left of some part U of it F falls and right of it F
//! rises, then the search cannot lose U: of two neighbouring places left of U the right one is lower. So it ends within
//! two steps of U. It finds F(X, u) for a u near U, and misses the minimum by no more than δ, what F can change in U.
//! Elsewhere, near places with two minimisers, there are bounds but no slopes.
//!
//! If ∂²F/∂u² > 0 in U, all over the box, there is one minimiser, and the second derivatives of the minimum are those of F along the
//! arguments, less ∂²F/∂X∂u · ∂²F/∂u∂X / ∂²F/∂u² while it is no end of the range (the implicit function theorem).
//! Derivatives of derivatives are undefined where the box holds a kink of F.
//!
//! What rounding does to F and its derivatives is bounded by programs (`rounding`).

use super::search::STAGES;
use super::{CELLS, Minimum, Scratch};
use fieldstone_field::Interval;

/// As many cells are left alone as they are, and cells are cut into about as many.
const MOST_CELLS: usize = 20;
/// A box where the minimum is positive and known to be above this part of its bound is far outside.
const FAR: f64 = 0.25;
/// What gradients may be wrong by, relative to their largest component, as [`Function`](fieldstone_field::Function) has it.
const GRADIENT_ERROR: f64 = 1e-10;
/// How often cells are cut at most.
const ROUNDS: usize = 8;

/// What holds a minimum in a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Enclosure {
    /// Its values.
    pub(super) range: Interval<f64>,
    /// As [`Function::curvature`](fieldstone_field::Function::curvature) has it.
    pub(super) curvature: f64,
}

/// A part of the range of u and what F does there.
#[derive(Clone, Copy, Debug)]
struct Segment {
    from: f64,
    to: f64,
    /// Below F.
    floor: f64,
    /// Above F at a place.
    ceiling: f64,
    /// ∂F/∂u.
    slope: Interval<f64>,
}

impl Segment {
    fn new(from: f64, to: f64, floor: f64) -> Self {
        Self { from, to, floor, ceiling: f64::INFINITY, slope: Interval::undefined() }
    }

    fn middle(&self) -> f64 {
        0.5 * self.from + 0.5 * self.to
    }
}

/// V, in cells.
struct Stretch {
    cells: Vec<Segment>,
    /// Above every value of the minimum: the least of those at the first places of searches.
    ceiling: f64,
    /// What rounding may do to values.
    noise: f64,
    /// Whether V was one stretch with slopes, and what rises or falls in it is left out.
    is_single: bool,
}

impl Stretch {
    /// Leaves out what is too high for the minimum, and then what rises or falls by more than `flat`.
    fn narrow(&mut self, flat: f64) {
        let ceiling = self.ceiling;
        // What may be undefined stays.
        self.cells.retain(|cell| cell.floor <= ceiling || cell.floor.is_nan());
        let is_one = self.cells.windows(2).all(|pair| pair[0].to == pair[1].from);
        let is_smooth = |cell: &Segment| cell.slope.lo.is_finite() && cell.slope.hi.is_finite();
        self.is_single = self.is_single || is_one && self.cells.iter().all(is_smooth);
        if self.is_single {
            self.cells = without_slopes(&self.cells, flat);
        }
    }

    /// Below the minimum.
    fn floor(&self) -> f64 {
        self.cells.iter().fold(self.ceiling, |least, cell| least.min(cell.floor))
    }

    /// From the first cell to the end of the last.
    fn length(&self) -> f64 {
        self.cells.first().zip(self.cells.last()).map_or(0.0, |(first, last)| last.to - first.from)
    }
}

impl Minimum {
    /// Encloses the minimum in a box that is more than a point.
    pub(super) fn enclose(&self, scratch: &mut Scratch, boxes: &[Interval<f64>]) -> Enclosure {
        let mut stretch = self.start(scratch, boxes);
        let is_unknown = stretch.cells.iter().any(|cell| cell.floor.is_nan());
        if is_unknown || !stretch.ceiling.is_finite() {
            return Enclosure { range: Interval::undefined(), curvature: f64::INFINITY };
        }
        // Slopes flatter than this may be lost in rounding.
        let flat = stretch.noise / self.spacing(STAGES[0]);
        stretch.narrow(flat);
        // Far outside, that is all that anyone asks.
        let lowest = stretch.floor();
        if lowest > 0.0 && lowest > FAR * stretch.ceiling {
            return Enclosure { range: Interval::new(lowest, stretch.ceiling), curvature: f64::INFINITY };
        }
        for _ in 0..ROUNDS {
            let (before, was_single) = (stretch.length(), stretch.is_single);
            let Some(cells) = split(&stretch.cells) else { break };
            stretch.cells = cells;
            self.bound(scratch, boxes, (&mut stretch.cells, stretch.noise));
            stretch.narrow(flat);
            if was_single && stretch.length() > 0.5 * before {
                break;
            }
        }
        let range = Interval::new(stretch.floor(), stretch.ceiling);
        let mut enclosure = Enclosure { range, curvature: f64::INFINITY };
        if stretch.is_single {
            self.follow(scratch, boxes, &stretch, &mut enclosure);
        }
        enclosure
    }

    /// Bounds F in the cells of the range.
    fn start(&self, scratch: &mut Scratch, boxes: &[Interval<f64>]) -> Stretch {
        let (from, step) = (self.range[0], self.spacing(0));
        let end = |i: usize| if i == CELLS { self.range[1] } else { from + i as f64 * step };
        let mut cells: Vec<Segment> =
            (0..CELLS).map(|i| Segment::new(end(i), end(i + 1), f64::NEG_INFINITY)).collect();
        // Places where searches look, to the bit: what is above the values there is above the minimum.
        let places: Vec<f64> = self.middles().collect();
        let noise = self.noise(scratch, boxes);
        self.bound_at(scratch, boxes, (&mut cells, &places, noise));
        let ceiling = cells.iter().fold(f64::INFINITY, |least, cell| least.min(cell.ceiling));
        Stretch { cells, ceiling, noise, is_single: false }
    }

    /// By how much computed values of F may be wrong, and differ from one another by rounding; infinite where that is not known.
    fn noise(&self, scratch: &mut Scratch, boxes: &[Interval<f64>]) -> f64 {
        let whole = Interval::new(self.range[0], self.range[1]);
        self.run(scratch, &self.errors, (boxes, &[whole]));
        let error = scratch.boxes.output(0, 1)[0];
        if error.is_nan() { f64::INFINITY } else { 2.0 * error }
    }

    /// Evaluates a tape over the box and ranges of u.
    fn run(
        &self,
        scratch: &mut Scratch,
        tape: &fieldstone_field::Tape,
        (boxes, ranges): (&[Interval<f64>], &[Interval<f64>]),
    ) {
        let sets = &mut scratch.boxes;
        let count = ranges.len();
        for (k, side) in boxes.iter().enumerate() {
            sets.input(k, 0)[..count].fill(side.lo);
            sets.input(k, 1)[..count].fill(side.hi);
        }
        for (lane, range) in ranges.iter().enumerate() {
            sets.input(boxes.len(), 0)[lane] = range.lo;
            sets.input(boxes.len(), 1)[lane] = range.hi;
        }
        sets.run(tape, count);
    }

    fn bound(&self, scratch: &mut Scratch, boxes: &[Interval<f64>], (cells, noise): (&mut [Segment], f64)) {
        let places: Vec<f64> = cells.iter().map(Segment::middle).collect();
        self.bound_at(scratch, boxes, (cells, &places, noise));
    }

    /// Bounds F in cells, at most [`LANES`](fieldstone_field::LANES), from its values at places in them and its slopes.
    fn bound_at(
        &self,
        scratch: &mut Scratch,
        boxes: &[Interval<f64>],
        (cells, places, noise): (&mut [Segment], &[f64], f64),
    ) {
        let at: Vec<Interval<f64>> = places.iter().map(|&u| Interval::new(u, u)).collect();
        self.run(scratch, &self.tape, (boxes, &at));
        let lows: Vec<f64> = scratch.boxes.output(0, 0)[..cells.len()].to_vec();
        for (cell, &high) in cells.iter_mut().zip(scratch.boxes.output(0, 1)) {
            cell.ceiling = high;
        }
        let ranges: Vec<Interval<f64>> = cells.iter().map(|c| Interval::new(c.from, c.to)).collect();
        self.run(scratch, &self.along, (boxes, &ranges));
        let output = |o: usize, c: usize| scratch.boxes.output(o, c);
        for (lane, cell) in cells.iter_mut().enumerate() {
            cell.slope = Interval::new(output(1, 0)[lane], output(1, 1)[lane]);
            let image = output(0, 0)[lane];
            let reach = (places[lane] - cell.from).max(cell.to - places[lane]);
            let fall = steepest(cell.slope) * reach * (1.0 + 1e-9);
            let line = lows[lane] - fall - noise - 1e-15 * (lows[lane].abs() + fall);
            let floor = if line > image { line } else { image };
            // Bounds of cells hold in their parts.
            cell.floor = if cell.floor > floor { cell.floor } else { floor };
        }
    }

    /// The slopes of the minimum along the arguments, where it has one minimiser that moves little.
    fn follow(
        &self,
        scratch: &mut Scratch,
        boxes: &[Interval<f64>],
        stretch: &Stretch,
        enclosure: &mut Enclosure,
    ) {
        let (Some(first), Some(last)) = (stretch.cells.first(), stretch.cells.last()) else { return };
        let margin = 2.0 * self.spacing(STAGES[0]);
        let near =
            Interval::new((first.from - margin).max(self.range[0]), (last.to + margin).min(self.range[1]));
        let middle = first.from + 0.5 * (last.to - first.from);
        self.run(scratch, &self.tape, (boxes, &[Interval::new(middle, middle)]));
        let at_middle = scratch.boxes.output(0, 1)[0];
        self.run(scratch, &self.slopes, (boxes, &[near]));
        let output = |o: usize| Interval::new(scratch.boxes.output(o, 0)[0], scratch.boxes.output(o, 1)[0]);
        let lost = steepest(output(1)) * near.width() * (1.0 + 1e-9) + 2.0 * stretch.noise;
        let high = at_middle + lost;
        if high < enclosure.range.hi {
            enclosure.range.hi = high.max(enclosure.range.lo);
        }
        let slopes: Vec<Interval<f64>> = (0..boxes.len()).map(|k| output(2 + k)).collect();
        enclosure.curvature = self.curved(scratch, (boxes, near), &slopes);
    }

    /// A bound of the second derivatives of the minimum, if F curves upward along u.
    fn curved(
        &self,
        scratch: &mut Scratch,
        (boxes, near): (&[Interval<f64>], Interval<f64>),
        slopes: &[Interval<f64>],
    ) -> f64 {
        let Some(bends) = &self.bends else { return f64::INFINITY };
        self.run(scratch, bends, (boxes, &[near]));
        let output = |o: usize| Interval::new(scratch.boxes.output(o, 0)[0], scratch.boxes.output(o, 1)[0]);
        let (along, count) = (output(0), boxes.len());
        if !(along.lo > 0.0 && along.hi.is_finite()) {
            return f64::INFINITY;
        }
        let mixed: Vec<f64> = (0..count).map(|k| steepest(output(1 + k))).collect();
        let (mut squares, mut at) = (0.0, 1 + count);
        for k in 0..count {
            for j in k..count {
                let size = steepest(output(at));
                squares += if j == k { size * size } else { 2.0 * size * size };
                at += 1;
            }
        }
        let moved: f64 = mixed.iter().map(|m| m * m).sum::<f64>() / along.lo;
        // What rounding leaves of the derivative along u moves the minimiser, and so the gradient.
        self.run(scratch, &self.errors, (boxes, &[near]));
        let error = |o: usize| scratch.boxes.output(o, 1)[0];
        let drift = 2.0 * error(1) / along.lo;
        let wrong = (0..count).map(|k| mixed[k] * drift + error(2 + k)).fold(0.0, f64::max);
        let least = |s: &Interval<f64>| if s.lo > 0.0 { s.lo } else { (-s.hi).max(0.0) };
        let steep = slopes.iter().map(least).fold(0.0, f64::max);
        let curvature = (squares.sqrt() + moved) * (1.0 + 1e-9);
        // Comparisons with what is not known are false.
        if wrong <= GRADIENT_ERROR * steep && curvature.is_finite() { curvature } else { f64::INFINITY }
    }
}

/// The largest size of a slope; infinite where it is not known.
fn steepest(slope: Interval<f64>) -> f64 {
    let size = slope.lo.abs().max(slope.hi.abs());
    if slope.lo.is_nan() || size.is_nan() { f64::INFINITY } else { size }
}

/// Leaves out cells in which F rises or falls: the minimum is at their end, which belongs to a neighbour, or is kept as a
/// cell of one point.
fn without_slopes(cells: &[Segment], flat: f64) -> Vec<Segment> {
    let (falls, rises) = (|c: &Segment| c.slope.hi < -flat, |c: &Segment| c.slope.lo > flat);
    let mut kept: Vec<Segment> = Vec::with_capacity(cells.len());
    for (i, cell) in cells.iter().enumerate() {
        if cell.from == cell.to {
            kept.push(*cell);
        } else if falls(cell) {
            let next = cells.get(i + 1).filter(|next| next.from == cell.to);
            if next.is_none_or(rises) {
                kept.push(Segment { from: cell.to, ..*cell });
            }
        } else if rises(cell) {
            let before = i.checked_sub(1).map(|b| &cells[b]).filter(|before| before.to == cell.from);
            if before.is_none() {
                kept.push(Segment { to: cell.from, ..*cell });
            }
        } else {
            kept.push(*cell);
        }
    }
    kept
}

/// The cells cut into parts, if there are few enough and any is more than a point.
fn split(cells: &[Segment]) -> Option<Vec<Segment>> {
    let wide = cells.iter().filter(|cell| cell.from < cell.to).count();
    let parts = MOST_CELLS / wide.max(1);
    if wide == 0 || parts < 2 {
        return None;
    }
    let part = |cell: &Segment, i: usize| {
        let place = |i: usize| {
            if i == parts { cell.to } else { cell.from + (cell.to - cell.from) * (i as f64 / parts as f64) }
        };
        Segment::new(place(i), place(i + 1), cell.floor)
    };
    let cut = |cell: &Segment| {
        let count = if cell.from < cell.to { parts } else { 1 };
        let cell = *cell;
        (0..count).map(move |i| if count == 1 { cell } else { part(&cell, i) })
    };
    Some(cells.iter().flat_map(cut).collect())
}
