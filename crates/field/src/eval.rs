//! Evaluation of tapes over blocks of 64 lanes, with the widest instructions that the processor has.
//!
//! A [`Workspace`] holds the registers. Each register is a row of 64 numbers for each component of the domain (one
//! for values, two for intervals, five for affine forms, four for gradients); an instruction works through the rows in
//! chunks as wide as a SIMD register. Data-dependent loops run chunk by chunk with a mask of the lanes that still turn.

use crate::affine::Affine;
use crate::domain::Domain;
use crate::dual::Dual;
use crate::interval::Interval;
use crate::op::{Binary, Unary};
use crate::real::{Real, Scalar, Wide32, Wide64};
use crate::tape::{Instruction, LoopCode, Op, Operand, Tape};
use fearless_simd::{Level, Simd};
use std::marker::PhantomData;
use std::ops::Range;

/// How many points, or sets, one evaluation works on at most.
pub const LANES: usize = 64;

/// After so many turns of a loop whose condition a set leaves open, its values count as undefined.
const OPEN_TURNS: u32 = 1024;

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

/// Rows behind the registers for the constants of one instruction.
const SCRATCH_ROWS: u32 = 3;

/// The numbers that an evaluation works with.
pub trait Precision: 'static {
    /// One number.
    type Scalar: Scalar;
    /// Many side by side.
    type Real<S: Simd>: Real<Scalar = Self::Scalar, Token = S>;
}

/// Double precision.
#[derive(Clone, Copy, Debug)]
pub struct F64;

impl Precision for F64 {
    type Scalar = f64;
    type Real<S: Simd> = Wide64<S>;
}

/// Single precision.
#[derive(Clone, Copy, Debug)]
pub struct F32;

impl Precision for F32 {
    type Scalar = f32;
    type Real<S: Simd> = Wide32<S>;
}

/// A domain whose values lie in rows, one for each component.
pub trait Rows: Domain {
    /// How many numbers make a value.
    const COMPONENTS: usize;
    /// Whether a value stands for many points, so that a condition may be open.
    const IS_SET: bool;

    /// Reads the lanes from `lane` on.
    fn load(token: Token<Self>, rows: &[ScalarOf<Self>], lane: usize) -> Self;
    /// Writes the lanes from `lane` on.
    fn store(self, rows: &mut [ScalarOf<Self>], lane: usize);
    /// The range, where the domain records choices.
    fn range(self) -> Option<Interval<Self::Real>> {
        None
    }
}

type Token<D> = <<D as Domain>::Real as Real>::Token;
type ScalarOf<D> = <<D as Domain>::Real as Real>::Scalar;

impl<R: Real> Rows for R {
    const COMPONENTS: usize = 1;
    const IS_SET: bool = false;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        <R as Real>::load(token, &rows[lane..])
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        Real::store(self, &mut rows[lane..]);
    }
}

#[inline(always)]
fn row<R: Real>(token: R::Token, rows: &[R::Scalar], start: usize) -> R {
    <R as Real>::load(token, &rows[start..])
}

impl<R: Real> Rows for Interval<R> {
    const COMPONENTS: usize = 2;
    const IS_SET: bool = true;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self { lo: row(token, rows, lane), hi: row(token, rows, lane + 1 * LANES) }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        Real::store(self.lo, &mut rows[lane..]);
        Real::store(self.hi, &mut rows[LANES + lane..]);
    }
    #[inline(always)]
    fn range(self) -> Option<Interval<R>> {
        Some(self)
    }
}

impl<R: Real> Rows for Affine<R> {
    const COMPONENTS: usize = 5;
    const IS_SET: bool = true;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self {
            centre: row(token, rows, lane),
            slope: row(token, rows, lane + 1 * LANES),
            error: row(token, rows, lane + 2 * LANES),
            range: Interval {
                lo: row(token, rows, lane + 3 * LANES),
                hi: row(token, rows, lane + 4 * LANES),
            },
        }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        // One by one: a loop over an array of them goes through memory.
        Real::store(self.centre, &mut rows[lane..]);
        Real::store(self.slope, &mut rows[LANES + lane..]);
        Real::store(self.error, &mut rows[2 * LANES + lane..]);
        Real::store(self.range.lo, &mut rows[3 * LANES + lane..]);
        Real::store(self.range.hi, &mut rows[4 * LANES + lane..]);
    }
}

impl<R: Real> Rows for Dual<R> {
    const COMPONENTS: usize = 4;
    const IS_SET: bool = false;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self {
            value: row(token, rows, lane),
            gradient: [
                row(token, rows, lane + 1 * LANES),
                row(token, rows, lane + 2 * LANES),
                row(token, rows, lane + 3 * LANES),
            ],
        }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        let [x, y, z] = self.gradient;
        Real::store(self.value, &mut rows[lane..]);
        Real::store(x, &mut rows[LANES + lane..]);
        Real::store(y, &mut rows[2 * LANES + lane..]);
        Real::store(z, &mut rows[3 * LANES + lane..]);
    }
}

/// What an evaluation computes.
pub trait Kind: 'static {
    /// The domain over a number type.
    type Domain<R: Real>: Rows<Real = R>;
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident $domain:ident;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $name;

            impl Kind for $name {
                type Domain<R: Real> = $domain<R>;
            }
        )*
    };
}

type Value<R> = R;
kinds! {
    /// Values at points. Component: the value.
    Points Value;
    /// Sets over boxes. Components: lower end, upper end.
    Intervals Interval;
    /// Sets over spans of rays. Components: centre, slope, error, lower end, upper end.
    Affines Affine;
    /// Values at points with gradients. Components: value, ∂x, ∂y, ∂z of the directions that the inputs carry.
    Gradients Dual;
}

/// One evaluation.
#[derive(Debug)]
pub struct Task<'t, P: Precision> {
    tape: &'t Tape,
    level: Level,
    memory: &'t mut [P::Scalar],
    outputs: &'t mut [P::Scalar],
    choices: &'t mut [u8],
    lanes: usize,
    trace: bool,
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
        Self { memory: Vec::new(), outputs: Vec::new(), choices: Vec::new(), level, kind: PhantomData }
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

    /// Evaluates `tape` in the first `lanes` lanes, at most [`LANES`].
    pub fn run(&mut self, tape: &Tape, lanes: usize) {
        self.execute(tape, lanes, false);
    }

    fn execute(&mut self, tape: &Tape, lanes: usize, trace: bool) {
        let lanes = lanes.min(LANES);
        self.reserve(tape, lanes);
        let Self { memory, outputs, choices, level, .. } = self;
        K::execute(Task { tape, level: *level, memory, outputs, choices, lanes, trace });
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

#[inline(always)]
fn evaluate<S: Simd, P: Precision, K: Kind>(simd: S, task: Task<'_, P>) {
    let Task { tape, memory, outputs, choices, lanes, trace, .. } = task;
    let chunks = lanes.div_ceil(P::Real::<S>::LANES);
    let mut machine = Machine::<S, P, K> { simd, tape, memory, choices, trace, kind: PhantomData };
    machine.block(&tape.run.instructions, 0..chunks, true);
    let row = K::Domain::<P::Real<S>>::COMPONENTS * LANES;
    for (o, &operand) in tape.run.outputs.iter().enumerate() {
        for chunk in 0..chunks {
            let value = machine.get(operand, chunk);
            Rows::store(value, &mut outputs[o * row..][..row], chunk * P::Real::<S>::LANES);
        }
    }
}

/// Where the chunks of an operand lie: a register's row, or one chunk of a constant that serves for all.
#[derive(Clone, Copy)]
struct Source {
    start: usize,
    /// Distance between chunks in lanes: 0 for constants.
    step: usize,
}

struct Machine<'m, S: Simd, P: Precision, K: Kind> {
    simd: S,
    tape: &'m Tape,
    memory: &'m mut [P::Scalar],
    choices: &'m mut [u8],
    trace: bool,
    kind: PhantomData<K>,
}

type DomainOf<S, P, K> = <K as Kind>::Domain<<P as Precision>::Real<S>>;

impl<S: Simd, P: Precision, K: Kind> Machine<'_, S, P, K> {
    /// Runs a block on some chunks of lanes; choices are recorded for the outermost block only.
    fn block(&mut self, code: &[Instruction], chunks: Range<usize>, outermost: bool) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                for (place, instruction) in code.iter().enumerate() {
                    if self.trace && outermost {
                        self.trace(place, instruction, chunks.clone());
                    }
                    self.instruction(instruction, chunks.clone());
                }
            },
        );
    }

    /// Looks up an operand; a constant is written to scratch row `slot`, so that the loops over chunks need not ask
    /// what their operands are.
    #[inline(always)]
    fn fetch(&mut self, operand: Operand, slot: u32) -> Source {
        match operand {
            Operand::Value(register) => {
                Source { start: Self::row_start(register), step: P::Real::<S>::LANES }
            }
            Operand::Constant(place) => {
                let scratch = self.tape.register_count + slot;
                let value = DomainOf::<S, P, K>::constant(self.simd, self.tape.constants[place as usize]);
                self.put(scratch, 0, value);
                Source { start: Self::row_start(scratch), step: 0 }
            }
        }
    }

    #[inline(always)]
    fn load(&self, source: Source, chunk: usize) -> DomainOf<S, P, K> {
        let row = &self.memory[source.start..][..DomainOf::<S, P, K>::COMPONENTS * LANES];
        Rows::load(self.simd, row, chunk * source.step)
    }

    #[inline(always)]
    fn row_start(register: u32) -> usize {
        register as usize * DomainOf::<S, P, K>::COMPONENTS * LANES
    }

    #[inline(always)]
    fn put(&mut self, register: u32, chunk: usize, value: DomainOf<S, P, K>) {
        let row = &mut self.memory[Self::row_start(register)..][..DomainOf::<S, P, K>::COMPONENTS * LANES];
        Rows::store(value, row, chunk * P::Real::<S>::LANES);
    }

    #[inline(always)]
    fn unary(
        &mut self,
        instruction: &Instruction,
        chunks: Range<usize>,
        f: impl Fn(DomainOf<S, P, K>) -> DomainOf<S, P, K>,
    ) {
        let a = self.fetch(instruction.operands[0], 0);
        for chunk in chunks {
            let value = f(self.load(a, chunk));
            self.put(instruction.result, chunk, value);
        }
    }

    #[inline(always)]
    fn binary(
        &mut self,
        instruction: &Instruction,
        chunks: Range<usize>,
        f: impl Fn(DomainOf<S, P, K>, DomainOf<S, P, K>) -> DomainOf<S, P, K>,
    ) {
        let (a, b) = (self.fetch(instruction.operands[0], 0), self.fetch(instruction.operands[1], 1));
        for chunk in chunks {
            let value = f(self.load(a, chunk), self.load(b, chunk));
            self.put(instruction.result, chunk, value);
        }
    }

    #[inline(always)]
    fn instruction(&mut self, instruction: &Instruction, chunks: Range<usize>) {
        macro_rules! unary_arms {
            ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
                match instruction.op {
                    $(Op::Unary(Unary::$variant) => self.unary(instruction, chunks, #[inline(always)] |a| Domain::$method(a)),)*
                    Op::Binary(op) => match self.constant_factor(instruction) {
                        Some((k, factor)) => self.unary(&factor, chunks, #[inline(always)] |a| a.scaled(k)),
                        None => self.binary_instruction(op, instruction, chunks),
                    },
                    Op::Powi(n) => self.unary(instruction, chunks, #[inline(always)] |a| a.powi(n)),
                    Op::Select => self.select(instruction, chunks),
                    Op::Call { function, arguments } => self.call(instruction, function, arguments, chunks),
                    Op::Loop(l) => {
                        for chunk in chunks {
                            self.run_loop(&self.tape.run.loops[l as usize], chunk);
                        }
                    }
                }
            };
        }
        crate::for_each_unary!(unary_arms);
    }

    /// A product with a constant that the numbers hold exactly, as the constant and an instruction on the other operand.
    #[inline(always)]
    fn constant_factor(&self, instruction: &Instruction) -> Option<(f64, Instruction)> {
        let Op::Binary(Binary::Mul) = instruction.op else { return None };
        let (place, other) = match instruction.operands {
            [Operand::Constant(place), other, _] | [other, Operand::Constant(place), _] => (place, other),
            _ => return None,
        };
        let k = self.tape.constants[place as usize];
        let exact = k.is_finite() && P::Scalar::from_f64(k).to_f64() == k;
        exact.then(|| (k, Instruction { operands: [other; 3], ..*instruction }))
    }

    #[inline(always)]
    fn binary_instruction(&mut self, op: Binary, instruction: &Instruction, chunks: Range<usize>) {
        macro_rules! binary_arms {
            ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
                match op {
                    $(Binary::$variant => self.binary(instruction, chunks, #[inline(always)] |a, b| Domain::$method(a, b)),)*
                }
            };
        }
        crate::for_each_binary!(binary_arms);
    }

    #[inline(always)]
    fn select(&mut self, instruction: &Instruction, chunks: Range<usize>) {
        let [c, a, b] = instruction.operands;
        let (c, a, b) = (self.fetch(c, 0), self.fetch(a, 1), self.fetch(b, 2));
        for chunk in chunks {
            let value = self.load(c, chunk).select(self.load(a, chunk), self.load(b, chunk), self.simd);
            self.put(instruction.result, chunk, value);
        }
    }

    fn call(&mut self, instruction: &Instruction, function: u32, arguments: u32, chunks: Range<usize>) {
        let function = &*self.tape.functions[function as usize];
        let operands = &self.tape.run.arguments[arguments as usize];
        for chunk in chunks {
            let values: Vec<_> = operands.iter().map(|&o| self.get(o, chunk)).collect();
            let value = Domain::call(function, &values, self.simd);
            self.put(instruction.result, chunk, value);
        }
    }

    /// An operand in one chunk of lanes.
    #[inline(always)]
    fn get(&self, operand: Operand, chunk: usize) -> DomainOf<S, P, K> {
        match operand {
            Operand::Value(register) => {
                self.load(Source { start: Self::row_start(register), step: P::Real::<S>::LANES }, chunk)
            }
            Operand::Constant(place) => Domain::constant(self.simd, self.tape.constants[place as usize]),
        }
    }

    /// Runs a loop on one chunk of lanes. Over sets, a lane may leave and go on at once: what it carries when it may
    /// leave is joined.
    fn run_loop(&mut self, code: &LoopCode, chunk: usize) {
        self.simd.vectorize(
            #[inline(always)]
            || self.turn(code, chunk),
        );
    }

    #[inline(always)]
    fn turn(&mut self, code: &LoopCode, chunk: usize) {
        let simd = self.simd;
        let undefined = <DomainOf<S, P, K> as Domain>::undefined(simd);
        let mut turning = P::Real::<S>::mask_from_lanes(simd, |_| true);
        let mut left = !turning;
        for (&register, &initial) in code.carried.iter().zip(&code.initial) {
            let value = self.get(initial, chunk);
            self.put(register, chunk, value);
        }
        let mut open_turns = 0;
        for _ in 0..=self.tape.fuel {
            self.block(&code.test, chunk..chunk + 1, false);
            let condition = self.get(code.condition, chunk);
            let (may_hold, may_fail) = condition.truth();
            let nothing = condition.is_undefined();
            let leaving = turning & (may_fail | nothing);
            for (&register, &result) in code.carried.iter().zip(&code.results) {
                let (now, before) =
                    (self.get(Operand::Value(register), chunk), self.get(Operand::Value(result), chunk));
                let value = Domain::choose(left, before.join(now), now);
                let value = Domain::choose(nothing, undefined, value);
                self.put(result, chunk, Domain::choose(leaving, value, before));
            }
            left = left | leaving;
            turning = turning & may_hold & !nothing;
            open_turns += u32::from(P::Real::<S>::any(turning & left));
            if !P::Real::<S>::any(turning) || open_turns > OPEN_TURNS {
                break;
            }
            self.block(&code.body, chunk..chunk + 1, false);
            for ((&waiting, &next), &register) in code.waiting.iter().zip(&code.next).zip(&code.carried) {
                let (next, now) = (self.get(next, chunk), self.get(Operand::Value(register), chunk));
                self.put(waiting, chunk, Domain::choose(turning, next, now));
            }
            for (&waiting, &register) in code.waiting.iter().zip(&code.carried) {
                let value = self.get(Operand::Value(waiting), chunk);
                self.put(register, chunk, value);
            }
        }
        for &result in &code.results {
            let value = self.get(Operand::Value(result), chunk);
            self.put(result, chunk, Domain::choose(turning, undefined, value));
        }
    }

    /// Records which operands may be taken; before the instruction runs, whose result may take an operand's place.
    #[inline(always)]
    fn trace(&mut self, place: usize, instruction: &Instruction, chunks: Range<usize>) {
        let records = matches!(
            instruction.op,
            Op::Select
                | Op::Unary(Unary::Abs)
                | Op::Binary(Binary::Min | Binary::Max | Binary::RMin | Binary::RMax)
        );
        for chunk in chunks {
            let start = place * LANES + chunk * P::Real::<S>::LANES;
            if !records {
                self.choices[start..][..P::Real::<S>::LANES].fill(3);
                continue;
            }
            let a = self.get(instruction.operands[0], chunk);
            let b = match instruction.op {
                Op::Binary(_) => self.get(instruction.operands[1], chunk),
                _ => a,
            };
            let (Some(a), Some(b)) = (a.range(), b.range()) else { continue };
            let (first, second) = taken(instruction.op, instruction.sign_only, a, b);
            let mask = |m, i| u8::from(P::Real::<S>::mask_lane(m, i));
            for (i, bits) in self.choices[start..][..P::Real::<S>::LANES].iter_mut().enumerate() {
                *bits = mask(first, i) | (mask(second, i) << 1);
            }
        }
    }
}

/// Where the first and where the second operand may be taken; both wherever anything is undefined.
#[inline(always)]
fn taken<R: Real>(op: Op, sign_only: bool, a: Interval<R>, b: Interval<R>) -> (R::Mask, R::Mask) {
    let defined = !(a.lo.is_nan_mask() | b.lo.is_nan_mask());
    let (a, b) = match op {
        Op::Binary(Binary::Max | Binary::RMax) => (-a, -b),
        _ => (a, b),
    };
    let nowhere = defined & !defined;
    let (only_first, only_second) = match op {
        Op::Select => {
            let (may_hold, may_fail) = a.truth();
            (!may_fail, !may_hold)
        }
        Op::Unary(_) => {
            let zero = R::splat(a.lo.token(), 0.0);
            (zero.is_le(a.lo), a.hi.is_le(zero))
        }
        Op::Binary(Binary::Min | Binary::Max) if !sign_only => (a.hi.is_le(b.lo), b.hi.is_le(a.lo)),
        Op::Binary(Binary::Min | Binary::Max) => (
            a.hi.is_le(b.lo) | b.is_positive() | a.is_negative(),
            b.hi.is_le(a.lo) | a.is_positive() | b.is_negative(),
        ),
        // The smaller of two in sign: a positive operand leaves the decision to the other, a negative one takes it.
        _ if sign_only => (b.is_positive() | a.is_negative(), a.is_positive() | b.is_negative()),
        _ => (nowhere, nowhere),
    };
    let only_first = only_first & defined;
    let only_second = only_second & defined & !only_first;
    (!only_second, !only_first)
}
