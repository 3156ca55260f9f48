//! The least value of a field over one of its inputs: sweeps and projections.
//!
//! min over u of F(X, u) is the union of the solids F(·, u). At a point it is searched for: values at [`CELLS`] places,
//! and ever denser ones around the least of them. Two places whose basins lie between the same places of the first
//! search are not told apart. With a box in the place of X, what that search can find is enclosed (`enclosure`). The
//! gradient is that of F at the minimiser (the envelope theorem).

mod enclosure;
mod search;

use crate::rounding::rounding;
use crate::slope::slope;
use enclosure::Enclosure;
use fieldstone_field::{
    F64, Field, Function, Gradients, Graph, Input, Interval, Intervals, NodeId, Points, Tape, TapeOptions,
    Workspace,
};
use search::Found;
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The cells that the range is cut into; every search looks in the middle of each.
const CELLS: usize = 16;

/// Second derivatives of more operations are not made.
const MOST_OPERATIONS: usize = 4000;

/// The minimum of a field over one of its inputs, as a [`Function`] of the others.
///
/// Its value is the least of those that a fixed search finds, at least as small as F in the middle of each 16th of the
/// range, and to 10⁻¹³ (relative to its size or 1) that of a local minimum. Its intervals hold these values.
pub struct Minimum {
    /// F, with u behind the arguments.
    tape: Tape,
    /// F and ∂F/∂u.
    along: Tape,
    /// F, ∂F/∂u and the derivatives along the arguments.
    slopes: Tape,
    /// F, ∂F/∂u and ∂²F/∂u².
    newton: Tape,
    /// Bounds of the rounding errors of F, ∂F/∂u and the derivatives along the arguments.
    errors: Tape,
    /// ∂²F/∂u², those along u and an argument, and those along two arguments (each pair once); none where these are
    /// too many operations.
    bends: Option<Tape>,
    arguments: Vec<Input>,
    range: [f64; 2],
    /// Tells minima apart where their last results are kept.
    number: u64,
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

/// Registers for evaluations of the inner field, and the last results.
#[derive(Default)]
struct Scratch {
    values: Workspace<F64, Points>,
    boxes: Workspace<F64, Intervals>,
    gradients: Workspace<F64, Gradients>,
    found: Option<(u64, Vec<f64>, Found)>,
    enclosed: Option<(u64, Vec<Interval<f64>>, Enclosure)>,
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
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let field = Field::new(program.clone(), output, Vec::new());
        if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
            return Err(MinimumError::Range(range[0], range[1]));
        }
        if field.has_black_box() {
            return Err(MinimumError::BlackBox);
        }
        let arguments: Vec<Input> = field.inputs().into_iter().filter(|input| *input != over).collect();
        let varying: Vec<Input> = arguments.iter().copied().chain([over]).collect();
        let mut graph = program.clone();
        let derivatives: Vec<NodeId> =
            [over].iter().chain(&arguments).map(|&input| slope(&mut graph, output, input)).collect();
        let outputs: Vec<NodeId> = [output].iter().chain(&derivatives).copied().collect();
        let errors = rounding(&mut graph, &outputs);
        let mut bends = vec![slope(&mut graph, derivatives[0], over)];
        bends.extend(arguments.iter().map(|&input| slope(&mut graph, derivatives[0], input)));
        for (k, first) in derivatives[1..].iter().enumerate() {
            bends.extend(arguments[k..].iter().map(|&input| slope(&mut graph, *first, input)));
        }
        let is_long = graph.reachable(&bends).len() > MOST_OPERATIONS;
        let graph = Arc::new(graph);
        let tape = |outputs: &[NodeId]| {
            let field = Field::new(Arc::clone(&graph), outputs[0], outputs[1..].to_vec());
            let varying = varying.clone();
            Tape::new(&field, &TapeOptions { varying, attributes: true, ..TapeOptions::default() })
        };
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        Ok(Self {
            tape: tape(&outputs[..1]),
            along: tape(&outputs[..2]),
            slopes: tape(&outputs),
            newton: tape(&[output, derivatives[0], bends[0]]),
            errors: tape(&errors),
            bends: (!is_long).then(|| tape(&bends)),
            arguments,
            range,
            number,
        })
    }

    /// The minima over equal parts of a range, whose least is that over the whole range. Boxes of space need few of
    /// them, and in each there is more often one minimiser only.
    ///
    /// # Errors
    /// An empty range; black boxes.
    pub fn in_parts(
        (program, output): (&Graph, NodeId),
        over: Input,
        [from, to]: [f64; 2],
        parts: usize,
    ) -> Result<Vec<Self>, MinimumError> {
        let parts = parts.max(1);
        let place = |i: usize| if i == parts { to } else { from + (to - from) * (i as f64 / parts as f64) };
        (0..parts).map(|i| Self::new(program, output, over, [place(i), place(i + 1)])).collect()
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

    /// The minimum at a point, as the last search found it if that was for the same point.
    fn found(&self, scratch: &mut Scratch, arguments: &[f64]) -> Found {
        match &scratch.found {
            Some((number, known, found)) if *number == self.number && known == arguments => *found,
            _ => {
                let found = self.search(scratch, arguments);
                scratch.found = Some((self.number, arguments.to_vec(), found));
                found
            }
        }
    }

    /// What encloses the minimum in a box, likewise.
    fn enclosed(&self, scratch: &mut Scratch, boxes: &[Interval<f64>]) -> Enclosure {
        match &scratch.enclosed {
            Some((number, known, enclosed)) if *number == self.number && known == boxes => *enclosed,
            _ => {
                let enclosed = self.enclose(scratch, boxes);
                scratch.enclosed = Some((self.number, boxes.to_vec(), enclosed));
                enclosed
            }
        }
    }
}

/// The point that a box is, if it is one.
fn point(boxes: &[Interval<f64>]) -> Option<Vec<f64>> {
    boxes.iter().all(|b| b.lo == b.hi).then(|| boxes.iter().map(|b| b.lo).collect())
}

fn is_finite(boxes: &[Interval<f64>]) -> bool {
    boxes.iter().all(|b| b.lo.is_finite() && b.hi.is_finite())
}

impl Function for Minimum {
    fn name(&self) -> &str {
        "a minimum over a range"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        if arguments.iter().any(|a| !a.is_finite()) {
            return f64::NAN;
        }
        with_scratch(|scratch| self.found(scratch, arguments)).value
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        if !is_finite(arguments) {
            return Interval::undefined();
        }
        match point(arguments) {
            Some(point) => {
                let value = self.value(&point);
                Interval::new(value, value)
            }
            None => with_scratch(|scratch| self.enclosed(scratch, arguments)).range,
        }
    }

    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        if !is_finite(arguments) || point(arguments).is_some() {
            return f64::INFINITY;
        }
        with_scratch(|scratch| self.enclosed(scratch, arguments)).curvature
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        with_scratch(|scratch| {
            let place = self.found(scratch, arguments).place;
            let place = self.refined(scratch, arguments, place);
            let slopes = &mut scratch.gradients;
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
