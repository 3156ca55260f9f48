//! The memory of an evaluation, and the choice of the instructions that it runs with.

use super::machine::evaluate;
use super::{Affines, F32, F64, Gradients, Intervals, Kind, LANES, Points, Precision, Rows};
use crate::real::Scalar;
use crate::tape::Tape;
use fearless_simd::Level;
use std::marker::PhantomData;

/// Rows behind the registers for the constants of one instruction.
const SCRATCH_ROWS: u32 = 3;

/// Calls with the widest instructions of `level`; on x86 only with those of AVX-512, AVX2 and the baseline, because the
/// levels between are not worth the code that they would add.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
macro_rules! dispatch_favoured {
    ($level:expr, $simd:ident => $call:expr) => {
        if let Some($simd) = $level.as_avx512() {
            $call
        } else if let Some($simd) = $level.as_avx2() {
            $call
        } else if let Some($simd) = $level.as_sse2() {
            $call
        }
    };
}
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
macro_rules! dispatch_favoured {
    ($level:expr, $simd:ident => $call:expr) => {
        fearless_simd::dispatch!($level, $simd => $call)
    };
}

/// One evaluation.
#[derive(Debug)]
pub struct Task<'t, P: Precision> {
    pub(super) tape: &'t Tape,
    level: Level,
    pub(super) memory: &'t mut [P::Scalar],
    pub(super) outputs: &'t mut [P::Scalar],
    pub(super) choices: &'t mut [u8],
    /// How many turns the loops took in each lane; infinite where they were to take more than they may. Behind these,
    /// for sets, 1 where a loop stopped undecided, so that some value of the set may have taken more.
    pub(super) turns: &'t mut [P::Scalar],
    pub(super) lanes: usize,
    /// Whether to record choices.
    pub(super) trace: bool,
}

impl<P: Precision> Task<'_, P> {
    fn dispatch<K: Kind>(self) {
        let level = self.level;
        dispatch_favoured!(level, simd => evaluate::<_, P, K>(simd, self));
    }
}

/// A kind of evaluation at a precision, compiled once in this crate.
pub trait Engine<P: Precision>: Kind {
    /// Runs a tape.
    fn execute(task: Task<'_, P>);
}

macro_rules! engines {
    ($($kind:ident $precision:ident;)*) => {
        $(
            impl Engine<$precision> for $kind {
                fn execute(task: Task<'_, $precision>) {
                    task.dispatch::<$kind>();
                }
            }
        )*
    };
}
engines! {
    Points F64;
    Points F32;
    Affines F64;
    Affines F32;
    Gradients F64;
    Gradients F32;
    Intervals F64;
    Intervals F32;
}

/// Registers for evaluations of one kind; may be used with any tape.
#[derive(Debug)]
pub struct Workspace<P: Precision, K: Engine<P>> {
    memory: Vec<P::Scalar>,
    outputs: Vec<P::Scalar>,
    choices: Vec<u8>,
    turns: Vec<P::Scalar>,
    level: Level,
    kind: PhantomData<K>,
}

impl<P: Precision, K: Engine<P>> Default for Workspace<P, K> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Precision, K: Engine<P>> Workspace<P, K> {
    /// An empty workspace that uses the widest instructions of this processor.
    pub fn new() -> Self {
        Self::with_level(Level::new())
    }

    /// A workspace that uses the baseline instructions of the architecture only, for comparison.
    pub fn baseline() -> Self {
        Self::with_level(Level::baseline())
    }

    fn with_level(level: Level) -> Self {
        let turns = vec![P::Scalar::default(); 2 * LANES];
        Self { memory: Vec::new(), outputs: Vec::new(), choices: Vec::new(), turns, level, kind: PhantomData }
    }

    const fn row_count() -> usize {
        <K::Domain<f64> as Rows>::COMPONENTS
    }

    /// One component of an input, for [`LANES`] lanes, to be filled before [`run`](Self::run).
    ///
    /// `input` counts the varying inputs of the tape. What the last run left there is gone.
    pub fn input(&mut self, input: usize, component: usize) -> &mut [P::Scalar] {
        let start = (input * Self::row_count() + component) * LANES;
        if self.memory.len() < start + LANES {
            self.memory.resize(start + LANES, P::Scalar::default());
        }
        &mut self.memory[start..start + LANES]
    }

    /// One component of an output after [`run`](Self::run), for [`LANES`] lanes.
    pub fn output(&self, output: usize, component: usize) -> &[P::Scalar] {
        let start = (output * Self::row_count() + component) * LANES;
        &self.outputs[start..start + LANES]
    }

    /// How many turns the data-dependent loops took together in a lane of the last [`run`](Self::run); infinite where
    /// they did not end within [`Field::fuel`](crate::Field::fuel), so that what depends on them is undefined. Over sets,
    /// turns behind a loop whose condition was undefined are not counted: no loop that follows is trusted to end.
    pub fn turns(&self, lane: usize) -> f64 {
        self.turns[lane].to_f64()
    }

    /// Evaluates `tape` in the first `lanes` lanes, at most [`LANES`].
    pub fn run(&mut self, tape: &Tape, lanes: usize) {
        self.execute(tape, lanes, false);
    }

    fn execute(&mut self, tape: &Tape, lanes: usize, trace: bool) {
        let lanes = lanes.min(LANES);
        self.reserve(tape, lanes);
        self.turns.fill(P::Scalar::default());
        let Self { memory, outputs, choices, turns, level, .. } = self;
        K::execute(Task { tape, level: *level, memory, outputs, choices, turns, lanes, trace });
    }

    /// Makes room, and fills the lanes of the last chunk that nobody asked for with what stands in the last lane.
    fn reserve(&mut self, tape: &Tape, lanes: usize) {
        let row = Self::row_count() * LANES;
        let needed = (tape.register_count + SCRATCH_ROWS) as usize * row;
        if self.memory.len() < needed {
            self.memory.resize(needed, P::Scalar::default());
        }
        let outputs = tape.output_count() * row;
        if self.outputs.len() < outputs {
            self.outputs.resize(outputs, P::Scalar::default());
        }
        if lanes > 0 {
            let end = lanes.next_multiple_of(16).min(LANES);
            for start in (0..tape.input_count as usize * row).step_by(LANES) {
                let last = self.memory[start + lanes - 1];
                self.memory[start + lanes..start + end].fill(last);
            }
        }
    }
}

impl<P: Precision> Workspace<P, Intervals>
where
    Intervals: Engine<P>,
{
    /// Like [`run`](Self::run), and records for [`choice`](Self::choice) which operands of set operations, absolute
    /// values and selections may be taken in each lane.
    pub fn run_traced(&mut self, tape: &Tape, lanes: usize) {
        let places = tape.code.instructions.len() * LANES;
        if self.choices.len() < places {
            self.choices.resize(places, 3);
        }
        self.execute(tape, lanes, true);
    }

    /// Which operands of the instruction at `place` may be taken in `lane`, as [`Tape::specialise`] wants it.
    pub fn choice(&self, place: usize, lane: usize) -> u8 {
        self.choices[place * LANES + lane]
    }
}
