//! The smallest box around a solid, by intervals.
//!
//! Two boxes approach each other. The *hull* holds places where the field is known to be negative; it grows. The rest of
//! the search box is cut into cells, and a cell is dropped as soon as an interval proves that nothing in it is negative,
//! or as soon as it lies within the hull (a margin included), where it can change nothing. Cells that stick out of the
//! hull the farthest come first. When no cell is left, all of the solid lies in the hull and its margin.
//!
//! So the cost does not grow with the surface of the solid but with its outermost parts, and a small solid far away is
//! bounded as closely, relative to its size, as a large one near by.

mod cells;

use cells::{Cell, Hull};
use fieldstone_field::{
    Bindings, F64, Field, Intervals, LANES, Points, Reading, Tape, TapeOptions, Workspace,
};
use std::collections::BinaryHeap;

/// The bounds of a solid for which none were found: lower and upper corner.
pub const DEFAULT_BOUNDS: ([f64; 3], [f64; 3]) = ([-10.0; 3], [10.0; 3]);

/// Half the sides of the cubes that are searched, one after the other, until one holds the solid.
const SEARCHES: [f64; 4] = [10.0, 1e3, 1e5, SEARCHED];

/// Nothing beyond ±10⁷ is searched.
pub const SEARCHED: f64 = 1e7;

/// A cube larger than this is searched only for what inclusion alone can tell.
const LARGEST_SAMPLED: f64 = 1e3;

/// The hull is complete when the solid exceeds it by less than this part of its longest side.
const MARGIN: f64 = 1.0 / 256.0;

/// What is added to the margin on each side, relative to the longest side.
const PADDING: f64 = 0.006;

/// A cell shorter than this part of the search box is not divided.
const SMALLEST: f64 = 1.0 / (1u64 << 26) as f64;

/// A cell in which the field may be undefined is given up if no sample in it is negative and it is shorter than this
/// part of the hull, or than a quarter of its distance from it.
const BARREN: f64 = 1.0 / 16.0;

/// A cell longer than this part of the search box is never given up for its samples.
const COARSEST: f64 = 1.0 / 16.0;

/// How many cells a search may give up after sampling them, at most and at any rate.
const MOST_SAMPLED: usize = 25_000;
const LEAST_SAMPLED: usize = 2;

/// How many operations on cells a search may take, over all cells, counted in additions.
const MOST_OPERATIONS: usize = 150_000_000;

/// How many cells a search may evaluate at most, and how many at any rate.
const MOST_CELLS: usize = 100_000;
const LEAST_CELLS: usize = 2 * LANES;

/// What is known about the extent of a solid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extent {
    /// The box holds it.
    Bounded,
    /// It reaches beyond ±[`SEARCHED`] along an axis, or at least beyond ±1000, and no end of it was proved.
    Unbounded,
    /// The field is nowhere negative within ±[`SEARCHED`], or at least within ±1000.
    Empty,
    /// No place was found where the field is negative, and no proof that there is none.
    NotFound,
    /// The field has no value anywhere.
    Undefined,
}

/// The box around a solid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FoundBounds {
    /// The corner with the smallest coordinates; it is always below `max`.
    pub min: [f64; 3],
    /// The corner with the largest coordinates.
    pub max: [f64; 3],
    /// Whether that is the solid's own box ([`Extent::Bounded`]), or [`DEFAULT_BOUNDS`] for want of one. Of a solid
    /// without an end, it is the first of the cubes ±10, ±10³, ±10⁵, ±10⁷ in which some of it was found.
    pub extent: Extent,
    /// Whether `extent` rests on inclusion alone. Where the field may be undefined, or the search was cut short, it
    /// rests on samples too.
    pub proved: bool,
}

/// Finds a box around the places where the field is negative, a little larger than needed.
///
/// The search starts in \[−10, 10\]³; a solid that touches the faces of that, or of which nothing is in it, is searched
/// in cubes a hundred times as large, up to ±[`SEARCHED`]. The box exceeds the solid by about 1 % of its longest side,
/// 7 % where that rests on samples, which it may within ±1000 only.
///
/// ```
/// use fieldstone_field::{Bindings, Field, Graph, Input};
/// use fieldstone_space::{Extent, solid_bounds};
///
/// let mut graph = Graph::new();
/// let squares = [0, 1, 2].map(|i| {
///     let x = graph.input(Input::Coordinate(i));
///     graph.square(x)
/// });
/// let sum = graph.add(squares[0], squares[1]);
/// let sum = graph.add(sum, squares[2]);
/// let four = graph.constant(4.0);
/// let ball = graph.sub(sum, four);
/// let found = solid_bounds(&Field::new(graph, ball, vec![]), &Bindings::new());
/// assert_eq!(found.extent, Extent::Bounded);
/// assert!(found.max.iter().all(|&x| x > 2.0 && x < 2.1));
/// ```
pub fn solid_bounds(field: &Field, bindings: &Bindings) -> FoundBounds {
    let options =
        TapeOptions { bindings: bindings.clone(), reading: Reading::Sign, ..TapeOptions::default() };
    let tape = Tape::new(field, &options);
    let (mut found, mut endless) = (Finding::default(), None);
    for half in SEARCHES {
        let search = Search::new(&tape, half).finish();
        let outcome = search.outcome();
        if let Some(bounds) = outcome.filter(|bounds| bounds.proved || half <= LARGEST_SAMPLED) {
            return bounds;
        }
        endless = endless.or(search.finding.touches.then_some(half));
        if half <= LARGEST_SAMPLED {
            found = search.finding;
        }
        // What is not proved here is not farther out either, and a dear program is not asked again.
        let is_vain = search.is_dear || !search.finding.touches && !search.finding.proved;
        if half >= LARGEST_SAMPLED && is_vain {
            break;
        }
    }
    if let Some(half) = endless {
        return FoundBounds {
            min: [-half; 3],
            max: [half; 3],
            extent: Extent::Unbounded,
            proved: found.proved,
        };
    }
    let extent = match found {
        Finding { any_value: false, .. } => Extent::Undefined,
        Finding { proved: true, .. } if has_no_value(field, bindings) => Extent::Undefined,
        Finding { proved: true, .. } => Extent::Empty,
        _ => Extent::NotFound,
    };
    nothing(extent, found.proved)
}

/// Whether a field that is nowhere negative is undefined at all of some points near and far.
fn has_no_value(field: &Field, bindings: &Bindings) -> bool {
    let tape = Tape::new(field, &TapeOptions { bindings: bindings.clone(), ..TapeOptions::default() });
    let mut points = Workspace::<F64, Points>::new();
    for axis in 0..3 {
        for (lane, x) in points.input(axis, 0).iter_mut().enumerate() {
            let side = if lane >> axis & 1 == 1 { 1.0 } else { -1.0 };
            // From 0.1 to 500, on no plane or diagonal.
            *x =
                side * (0.1 + 0.013 * axis as f64) * 3.0f64.powi(lane as i32 / 8) * (1.0 + 0.1 * axis as f64);
        }
    }
    points.run(&tape, LANES);
    points.output(0, 0).iter().all(|value| value.is_nan())
}

fn nothing(extent: Extent, proved: bool) -> FoundBounds {
    let (min, max) = DEFAULT_BOUNDS;
    FoundBounds { min, max, extent, proved }
}

/// What a search found out besides the hull.
#[derive(Clone, Copy, Debug)]
struct Finding {
    /// Nothing was dropped but by inclusion.
    proved: bool,
    /// Some sample had a value.
    any_value: bool,
    /// The solid reaches the faces of the search box.
    touches: bool,
}

impl Default for Finding {
    fn default() -> Self {
        Self { proved: true, any_value: false, touches: false }
    }
}

/// What is looked at first: cells with a defined interval before others, then by how far they stick out of the hull (the
/// others by size), as ordered bits.
type Urgency = (bool, u64);

/// A search in one cube.
struct Search<'t> {
    tape: &'t Tape,
    sets: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
    root: Cell,
    hull: Option<Hull>,
    /// Cells with what makes them urgent.
    queue: BinaryHeap<(Urgency, Cell)>,
    cells_left: usize,
    sampled_left: usize,
    /// How many lines may be followed outward.
    lines_left: usize,
    /// Whether the program is so long that few cells and samples can be afforded.
    is_dear: bool,
    finding: Finding,
}

impl<'t> Search<'t> {
    fn new(tape: &'t Tape, half: f64) -> Self {
        let root = Cell { lo: [-half; 3], hi: [half; 3] };
        let share = if half > LARGEST_SAMPLED { 8 } else { 1 };
        let affordable = MOST_OPERATIONS / share / tape.cost().max(1);
        let mut search = Self {
            tape,
            sets: Workspace::new(),
            points: Workspace::new(),
            root,
            hull: None,
            queue: BinaryHeap::new(),
            lines_left: 2 * affordable / LANES,
            is_dear: affordable < LEAST_CELLS,
            cells_left: affordable.clamp(LEAST_CELLS, MOST_CELLS),
            sampled_left: (4 * affordable / LANES).clamp(LEAST_SAMPLED, MOST_SAMPLED),
            finding: Finding::default(),
        };
        search.push(root, true);
        search
    }

    /// Searches until nothing is open, the solid touches the search box, or the cells are used up.
    fn finish(mut self) -> Self {
        loop {
            let batch = self.take_batch();
            if batch.is_empty() || self.finding.touches {
                return self;
            }
            if batch.len() > self.cells_left || self.sampled_left == 0 {
                self.give_up(&batch);
                return self;
            }
            self.cells_left -= batch.len();
            self.examine(&batch);
        }
    }

    /// The padded box, if there is a solid that is bounded.
    fn outcome(&self) -> Option<FoundBounds> {
        let hull = self.hull.filter(|_| !self.finding.touches)?;
        let (lo, hi) = (hull.cell.lo, hull.cell.hi);
        let longest = hull.cell.longest_side().1;
        // What is thinner than the distance of samples may stick out of what they found.
        let unseen = if self.finding.proved { 0.0 } else { BARREN };
        // So may cells that were too small to divide, by their own length.
        let undivided = 2.0 * self.root.longest_side().1 * SMALLEST;
        let pad = |x: f64| {
            longest * (MARGIN + PADDING + unseen) + x.abs() * 1e-9 + undivided + f64::MIN_POSITIVE.sqrt()
        };
        Some(FoundBounds {
            min: lo.map(|x| x - pad(x)),
            max: hi.map(|x| x + pad(x)),
            extent: Extent::Bounded,
            proved: self.finding.proved,
        })
    }

    fn push(&mut self, cell: Cell, defined: bool) {
        let size = cell.longest_side().1;
        let excess = self.hull.filter(|_| defined).map_or(size, |hull| hull.excess(&cell));
        self.queue.push(((defined, excess.max(0.0).to_bits()), cell));
    }

    /// Up to 64 cells that stick out the farthest, without what lies in the hull's margin.
    fn take_batch(&mut self) -> Vec<Cell> {
        let mut batch = Vec::with_capacity(LANES);
        while batch.len() < LANES {
            let Some((_, cell)) = self.queue.pop() else { break };
            let left = match self.hull {
                Some(hull) => cell.outside(&self.with_margin(&hull)),
                None => Some(cell),
            };
            batch.extend(left);
        }
        batch
    }

    /// The hull with its margin. Between the hull and the search box half of the way stays open, so that a solid which
    /// almost reaches the search box is told from one that does.
    fn with_margin(&self, hull: &Hull) -> Cell {
        let margin = (hull.cell.longest_side().1 * MARGIN).max(self.resolution());
        let mut wide = hull.cell;
        for axis in 0..3 {
            wide.lo[axis] -= margin.min(0.5 * (wide.lo[axis] - self.root.lo[axis]));
            wide.hi[axis] += margin.min(0.5 * (self.root.hi[axis] - wide.hi[axis]));
        }
        wide
    }

    fn resolution(&self) -> f64 {
        self.root.longest_side().1 * SMALLEST
    }

    /// Evaluates cells; drops them or divides them.
    fn examine(&mut self, batch: &[Cell]) {
        let ranges = self.ranges(batch);
        let centres: Vec<[f64; 3]> = batch.iter().map(Cell::centre).collect();
        let mut grown: Vec<[f64; 3]> = self.negative(&centres);
        if let Some(hull) = self.hull {
            // Of a cell that the solid only enters, the side towards the hull is in it before the middle is.
            let sides: Vec<[f64; 3]> = batch.iter().map(|cell| hull.side_towards(cell)).collect();
            grown.extend(self.negative(&sides));
        }
        for (cell, &(lo, hi)) in batch.iter().zip(&ranges) {
            if hi < 0.0 {
                self.finding.any_value = true;
                grown.extend([cell.lo, cell.hi]);
            }
            self.finding.any_value |= !lo.is_nan();
        }
        self.grow(&grown);
        for (cell, (lo, hi)) in batch.iter().zip(ranges) {
            if lo >= 0.0 || hi < 0.0 {
                continue;
            }
            if cell.longest_side().1 <= self.resolution() {
                self.grow(&[cell.lo, cell.hi]);
            } else if lo.is_nan() && self.is_barren(cell) {
                self.finding.proved = false;
            } else {
                let planes = self.hull.map(|hull| self.with_margin(&hull));
                cell.divided(planes.as_ref()).into_iter().for_each(|part| self.push(part, !lo.is_nan()));
            }
        }
    }

    /// The interval of the field over each of at most 64 cells.
    fn ranges(&mut self, batch: &[Cell]) -> Vec<(f64, f64)> {
        for axis in 0..3 {
            for (lane, cell) in batch.iter().enumerate() {
                self.sets.input(axis, 0)[lane] = cell.lo[axis];
                self.sets.input(axis, 1)[lane] = cell.hi[axis];
            }
        }
        self.sets.run(self.tape, batch.len());
        let ends = self.sets.output(0, 0).iter().zip(self.sets.output(0, 1));
        ends.take(batch.len()).map(|(&lo, &hi)| (lo, hi)).collect()
    }

    /// Those of at most 64 points where the field is negative.
    fn negative(&mut self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        for axis in 0..3 {
            let row = self.points.input(axis, 0);
            row.iter_mut().zip(points).for_each(|(x, point)| *x = point[axis]);
        }
        self.points.run(self.tape, points.len());
        let values = &self.points.output(0, 0)[..points.len()];
        self.finding.any_value |= values.iter().any(|v| !v.is_nan());
        values.iter().zip(points).filter(|(v, _)| **v < 0.0).map(|(_, p)| *p).collect()
    }

    /// Whether a cell whose interval is undefined may be given up: it is short, and nowhere in it a sample is negative.
    fn is_barren(&mut self, cell: &Cell) -> bool {
        let coarsest = self.root.longest_side().1 * COARSEST;
        let fine = |hull: Hull| (hull.cell.longest_side().1 * BARREN).max(0.25 * hull.gap(cell));
        if cell.longest_side().1 > self.hull.map_or(coarsest, |hull| fine(hull).min(coarsest)) {
            return false;
        }
        self.sampled_left = self.sampled_left.saturating_sub(1);
        let found = self.negative(&cell.samples());
        self.grow(&found);
        found.is_empty()
    }

    /// Widens the hull to hold these points, and follows the outermost of them outward.
    fn grow(&mut self, points: &[[f64; 3]]) {
        let Some(&first) = points.first() else { return };
        let before = self.hull;
        let mut hull = before.unwrap_or(Hull::at(first));
        points.iter().for_each(|&p| hull.add(p));
        self.hull = Some(hull);
        for side in 0..6 {
            let known = before.map_or(f64::NEG_INFINITY, |b| b.reach(side));
            let is_farther = hull.reach(side) > known + hull.cell.longest_side().1 * MARGIN;
            if is_farther && self.lines_left > 0 {
                self.lines_left -= 1;
                self.follow(side, hull.outermost[side]);
            }
        }
        self.note_touch();
    }

    fn note_touch(&mut self) {
        let near = self.root.longest_side().1 * 1e-9;
        let Some(Hull { cell, .. }) = self.hull else { return };
        let reaches = |axis: usize| {
            cell.lo[axis] - self.root.lo[axis] <= near || self.root.hi[axis] - cell.hi[axis] <= near
        };
        self.finding.touches = (0..3).any(reaches);
    }

    /// Looks for negative values on the line from `start` towards one side of the search box, twice: first far and
    /// wide, then closely where they end.
    fn follow(&mut self, side: usize, start: [f64; 3]) {
        let axis = side / 2;
        let face = if side.is_multiple_of(2) { self.root.lo[axis] } else { self.root.hi[axis] };
        let at = |s: f64| {
            let mut point = start;
            // At the end the face itself, not what rounding makes of it.
            point[axis] = if s == 1.0 { face } else { start[axis] + (face - start[axis]) * s };
            point
        };
        let fraction = |k: usize| k as f64 / LANES as f64;
        let far: Vec<[f64; 3]> = (1..=LANES).map(|k| at(fraction(k).powi(2))).collect();
        let found = self.negative(&far);
        let last = far.iter().rposition(|p| found.last() == Some(p)).map_or(0, |k| k + 1);
        let (low, high) = (fraction(last).powi(2), fraction(last + 1).powi(2));
        let mut all = found;
        if last < LANES {
            let close: Vec<[f64; 3]> = (1..LANES).map(|k| at(low + (high - low) * fraction(k))).collect();
            all.extend(self.negative(&close));
        }
        if let Some(hull) = &mut self.hull {
            all.into_iter().for_each(|p| hull.add(p));
        }
    }

    /// Takes what is left for part of the solid, except where the field may be undefined. The hull is larger than it
    /// would have to be then, but it still holds everything.
    fn give_up(&mut self, batch: &[Cell]) {
        let queued = std::mem::take(&mut self.queue).into_iter().map(|(_, cell)| cell);
        let left: Vec<Cell> = batch.iter().copied().chain(queued).collect();
        for some in left.chunks(LANES) {
            for (cell, (lo, _)) in some.iter().zip(self.ranges(some)) {
                if lo < 0.0 {
                    let hull = self.hull.get_or_insert(Hull::at(cell.lo));
                    [cell.lo, cell.hi].into_iter().for_each(|corner| hull.add(corner));
                } else if lo.is_nan() {
                    self.finding.proved = false;
                }
            }
        }
        self.note_touch();
        self.finding.proved &= !self.finding.touches;
    }
}

#[cfg(test)]
mod tests;
