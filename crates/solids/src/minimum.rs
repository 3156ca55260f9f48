//! The least value of a field over one of its inputs: sweeps and projections.
//!
//! min over u of F(X, u) is the union of the solids F(·, u). It is found by branch and bound: the range of u is cut into
//! cells, affine forms along u bound F from below in each (their error falls with the square of the cell), values in the
//! cells bound the minimum from above, and cells that cannot hold it are dropped. With a box in the place of X the same
//! search gives an interval. The gradient is that of F at the minimiser (the envelope theorem).

use fieldstone_field::{
    Affine, Affines, F64, Field, Function, Gradients, Graph, Input, Interval, Intervals, LANES, NodeId,
    Points, Tape, TapeOptions, Workspace,
};
use std::cell::Cell;
use std::sync::Arc;

/// The cells that a search begins with. Values are taken in the middle of each, wherever the search goes.
const FIRST_CELLS: usize = 32;
/// A search with more open cells than this ends.
const MOST_CELLS: usize = 256;
/// The rounds of a search at a point, and in a box.
const ROUNDS: [usize; 2] = [14, 2];
/// What a minimum may be above the exact one, relative to its size or 1.
const TOLERANCE: f64 = 1e-13;

/// The minimum of a field over one of its inputs, as a [`Function`] of the others.
pub struct Minimum {
    tape: Tape,
    arguments: Vec<Input>,
    range: [f64; 2],
}

/// Why there is no [`Minimum`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum MinimumError {
    /// The range is empty or not finite.
    #[error("the range from {0} to {1} must be finite and not empty")]
    Range(f64, f64),
    /// The field calls a function of which only values are known.
    #[error("the field calls a black box, of which no minimum can be found")]
    BlackBox,
}

/// A place in a search: a cell of the range with a lower bound of the field in it.
#[derive(Clone, Copy)]
struct Segment {
    from: f64,
    to: f64,
    floor: f64,
}

/// What a search found: the minimum lies between `floor` and `ceiling`, and is nearly taken at `place`.
#[derive(Clone, Copy, Debug)]
struct Found {
    floor: f64,
    ceiling: f64,
    place: f64,
    /// Whether cells were left open because there were too many.
    is_flat: bool,
}

/// Registers for evaluations of the inner field.
#[derive(Default)]
struct Scratch {
    forms: Workspace<F64, Affines>,
    values: Workspace<F64, Points>,
    boxes: Workspace<F64, Intervals>,
    slopes: Workspace<F64, Gradients>,
}

thread_local! {
    /// Taken while a search runs, so that a minimum inside a minimum finds none and makes its own.
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

fn with_scratch<R>(work: impl FnOnce(&mut Scratch) -> R) -> R {
    let mut scratch = SCRATCH.take().unwrap_or_default();
    let result = work(&mut scratch);
    SCRATCH.set(Some(scratch));
    result
}

impl Minimum {
    /// The minimum of the output of a program over `over` from `range[0]` to `range[1]`.
    ///
    /// # Errors
    /// An empty range; black boxes.
    pub fn new(program: &Graph, output: NodeId, over: Input, range: [f64; 2]) -> Result<Self, MinimumError> {
        let field = Field::new(program.clone(), output, Vec::new());
        if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
            return Err(MinimumError::Range(range[0], range[1]));
        }
        if field.has_black_box() {
            return Err(MinimumError::BlackBox);
        }
        let arguments: Vec<Input> = field.inputs().into_iter().filter(|input| *input != over).collect();
        let varying = arguments.iter().copied().chain([over]).collect();
        let tape = Tape::new(&field, &TapeOptions { varying, ..TapeOptions::default() });
        Ok(Self { tape, arguments, range })
    }

    /// The inputs that the minimum depends on: the arguments of the function, in this order.
    pub fn arguments(&self) -> &[Input] {
        &self.arguments
    }

    /// A call of the minimum with the inputs of a graph.
    pub fn call(self, graph: &mut Graph) -> NodeId {
        self.call_with(graph, Graph::input)
    }

    /// A call of the minimum; `input` says what stands in the place of each argument.
    pub fn call_with(self, graph: &mut Graph, input: impl Fn(&mut Graph, Input) -> NodeId) -> NodeId {
        let arguments: Vec<NodeId> = self.arguments.iter().map(|&argument| input(graph, argument)).collect();
        let function: Arc<dyn Function> = Arc::new(self);
        graph.call(&function, &arguments)
    }

    /// Finds the minimum for arguments in a box, or at a point.
    fn search(&self, scratch: &mut Scratch, boxes: &[Interval<f64>]) -> Found {
        let is_point = boxes.iter().all(|b| b.lo == b.hi);
        let [start, end] = self.range;
        let place = |i: usize| start + (end - start) * (i as f64 / FIRST_CELLS as f64);
        let mut open: Vec<Segment> = (0..FIRST_CELLS)
            .map(|i| Segment { from: place(i), to: place(i + 1), floor: f64::NEG_INFINITY })
            .collect();
        let mut found = Found { floor: f64::INFINITY, ceiling: f64::INFINITY, place: start, is_flat: false };
        for round in 0..ROUNDS[usize::from(!is_point)] {
            self.bound_below(scratch, boxes, &mut open);
            self.bound_above(scratch, boxes, &open, round == 0, &mut found);
            let enough = found.ceiling - TOLERANCE * found.ceiling.abs().max(1.0);
            open.retain(|cell| {
                // What may be undefined stays open, and everything as long as there is no value.
                let is_open = cell.floor < enough || cell.floor.is_nan() || enough.is_nan();
                if !is_open {
                    found.floor = found.floor.min(cell.floor);
                }
                is_open
            });
            if open.is_empty() || open.len() > MOST_CELLS {
                break;
            }
            open = split(&open);
        }
        found.is_flat = open.len() > MOST_CELLS;
        for cell in open {
            // The smaller of NaN and a number is the number, but what is undefined must stay so.
            found.floor =
                if cell.floor < found.floor || cell.floor.is_nan() { cell.floor } else { found.floor };
        }
        found
    }

    /// Bounds the field from below in every cell; NaN where it may be undefined.
    fn bound_below(&self, scratch: &mut Scratch, boxes: &[Interval<f64>], cells: &mut [Segment]) {
        let forms = &mut scratch.forms;
        for block in cells.chunks_mut(LANES) {
            for (k, side) in boxes.iter().enumerate() {
                let (centre, radius) = (0.5 * side.lo + 0.5 * side.hi, 0.5 * side.hi - 0.5 * side.lo);
                let radius = if radius == 0.0 { 0.0 } else { radius * (1.0 + 1e-15) + centre.abs() * 1e-15 };
                for (c, component) in [centre, 0.0, radius, side.lo, side.hi].into_iter().enumerate() {
                    forms.input(k, c)[..block.len()].fill(component);
                }
            }
            for (lane, cell) in block.iter().enumerate() {
                let form = Affine::along_ray(0.0, 1.0, cell.from, cell.to);
                let components = [form.centre, form.slope, form.error, form.range.lo, form.range.hi];
                for (c, component) in components.into_iter().enumerate() {
                    forms.input(boxes.len(), c)[lane] = component;
                }
            }
            forms.run(&self.tape, block.len());
            for (lane, cell) in block.iter_mut().enumerate() {
                let [centre, slope, error, floor] = [0, 1, 2, 3].map(|c| forms.output(0, c)[lane]);
                let line = (centre - slope.abs() - error) - 1e-15 * (centre.abs() + slope.abs() + error);
                // Bounds of parts hold in the parts.
                let floor = if line > floor { line } else { floor };
                cell.floor = if cell.floor > floor { cell.floor } else { floor };
            }
        }
    }

    /// Bounds the minimum from above by the values in the middle of the cells and at the ends of the one that reaches
    /// lowest.
    fn bound_above(
        &self,
        scratch: &mut Scratch,
        boxes: &[Interval<f64>],
        cells: &[Segment],
        is_first: bool,
        found: &mut Found,
    ) {
        let middle = |cell: &Segment| 0.5 * cell.from + 0.5 * cell.to;
        let mut places: Vec<f64> = cells.iter().map(middle).collect();
        if is_first {
            places.extend(self.range);
        }
        for block in places.chunks(LANES) {
            let ceilings = self.ceilings(scratch, boxes, block);
            for (&place, ceiling) in block.iter().zip(ceilings) {
                if ceiling < found.ceiling {
                    (found.ceiling, found.place) = (ceiling, place);
                }
            }
        }
    }

    /// The largest values for arguments in the boxes and the parameter at each place, at most [`LANES`]; NaN where
    /// undefined.
    fn ceilings(&self, scratch: &mut Scratch, boxes: &[Interval<f64>], places: &[f64]) -> [f64; LANES] {
        let mut ceilings = [f64::NAN; LANES];
        let is_point = boxes.iter().all(|b| b.lo == b.hi);
        let count = places.len();
        if is_point {
            let values = &mut scratch.values;
            for (k, side) in boxes.iter().enumerate() {
                values.input(k, 0)[..count].fill(side.lo);
            }
            values.input(boxes.len(), 0)[..count].copy_from_slice(places);
            values.run(&self.tape, count);
            ceilings[..count].copy_from_slice(&values.output(0, 0)[..count]);
        } else {
            let sets = &mut scratch.boxes;
            for (k, side) in boxes.iter().enumerate() {
                sets.input(k, 0)[..count].fill(side.lo);
                sets.input(k, 1)[..count].fill(side.hi);
            }
            sets.input(boxes.len(), 0)[..count].copy_from_slice(places);
            sets.input(boxes.len(), 1)[..count].copy_from_slice(places);
            sets.run(&self.tape, count);
            ceilings[..count].copy_from_slice(&sets.output(0, 1)[..count]);
        }
        ceilings
    }

    fn at(&self, scratch: &mut Scratch, arguments: &[f64]) -> Found {
        let point: Vec<Interval<f64>> = arguments.iter().map(|&a| Interval::new(a, a)).collect();
        self.search(scratch, &point)
    }
}

/// The cells cut into as many parts as an evaluation has room for.
fn split(cells: &[Segment]) -> Vec<Segment> {
    let parts = (LANES / cells.len()).clamp(2, 16);
    let part = |cell: &Segment, i: usize| {
        let place = |i: usize| {
            if i == parts { cell.to } else { cell.from + (cell.to - cell.from) * (i as f64 / parts as f64) }
        };
        Segment { from: place(i), to: place(i + 1), floor: cell.floor }
    };
    cells.iter().flat_map(|cell| (0..parts).map(move |i| part(cell, i))).collect()
}

impl Function for Minimum {
    fn name(&self) -> &str {
        "a minimum over a range"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        if arguments.iter().any(|a| !a.is_finite()) {
            return f64::NAN;
        }
        let found = with_scratch(|scratch| self.at(scratch, arguments));
        // No value anywhere.
        if found.ceiling == f64::INFINITY { f64::NAN } else { found.ceiling }
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        if arguments.iter().any(|a| !(a.lo.is_finite() && a.hi.is_finite())) {
            return Interval::undefined();
        }
        let found = with_scratch(|scratch| self.search(scratch, arguments));
        let is_point = arguments.iter().all(|a| a.lo == a.hi);
        if found.floor.is_nan() || found.ceiling == f64::INFINITY {
            return Interval::undefined();
        }
        // The value at a point is as much above the exact minimum as the tolerance allows.
        let slack = if is_point { 0.0 } else { 2.0 * TOLERANCE * found.ceiling.abs().max(1.0) };
        Interval::new(found.floor.min(found.ceiling), found.ceiling + slack)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        with_scratch(|scratch| {
            let place = self.at(scratch, arguments).place;
            let slopes = &mut scratch.slopes;
            for first in (0..arguments.len()).step_by(3) {
                for (k, value) in arguments.iter().chain([&place]).enumerate() {
                    for c in 0..4 {
                        let is_seed = k < arguments.len() && c > 0 && k == first + c - 1;
                        slopes.input(k, c)[0] = if c == 0 { *value } else { f64::from(u8::from(is_seed)) };
                    }
                }
                slopes.run(&self.tape, 1);
                for (c, slope) in gradient[first..].iter_mut().take(3).enumerate() {
                    *slope = slopes.output(0, c + 1)[0];
                }
            }
        });
    }
}
