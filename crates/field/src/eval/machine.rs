//! The machine that runs the instructions of a tape, compiled for each kind, precision and set of instructions.

use super::workspace::Task;
use super::{Kind, LANES, Precision, Rows};
use crate::domain::Domain;
use crate::interval::Interval;
use crate::op::{Binary, Unary};
use crate::real::{Real, Scalar};
use crate::tape::{Instruction, LoopCode, Op, Operand, Tape};
use fearless_simd::Simd;
use std::marker::PhantomData;
use std::ops::Range;

/// After so many turns of a loop whose condition a set leaves open, its values count as undefined.
const OPEN_TURNS: f64 = 1024.0;

/// Runs a task with the instructions that `simd` stands for.
#[inline(always)]
pub(super) fn evaluate<S: Simd, P: Precision, K: Kind>(simd: S, task: Task<'_, P>) {
    let Task { tape, memory, outputs, choices, turns, lanes, trace, .. } = task;
    let chunks = lanes.div_ceil(P::Real::<S>::LANES);
    let active = P::Real::<S>::mask_from_lanes(simd, |_| true);
    let mut machine =
        Machine::<S, P, K> { simd, tape, memory, choices, turns, active, trace, kind: PhantomData };
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

/// A task under way.
struct Machine<'m, S: Simd, P: Precision, K: Kind> {
    simd: S,
    tape: &'m Tape,
    memory: &'m mut [P::Scalar],
    choices: &'m mut [u8],
    turns: &'m mut [P::Scalar],
    /// The lanes of the chunk at work that turn in the loop at work.
    active: MaskOf<S, P>,
    trace: bool,
    kind: PhantomData<K>,
}

type MaskOf<S, P> = <<P as Precision>::Real<S> as Real>::Mask;
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

    /// A product with a constant that the numbers hold exactly: the constant, and an instruction on the other operand.
    #[inline(always)]
    fn constant_factor(&self, instruction: &Instruction) -> Option<(f64, Instruction)> {
        let Op::Binary(Binary::Mul) = instruction.op else { return None };
        let (place, other) = match instruction.operands {
            [Operand::Constant(place), other, _] | [other, Operand::Constant(place), _] => (place, other),
            _ => return None,
        };
        let k = self.tape.constants[place as usize];
        P::Scalar::holds(k).then_some((k, Instruction { operands: [other; 3], ..*instruction }))
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
        let outer = self.active;
        let fuel = P::Real::<S>::splat(simd, f64::from(self.tape.fuel));
        let (zero, one) = (P::Real::<S>::splat(simd, 0.0), P::Real::<S>::splat(simd, 1.0));
        let most_open = P::Real::<S>::splat(simd, OPEN_TURNS);
        let mut turning = outer;
        let mut left = outer & !outer;
        for (&register, &initial) in code.carried.iter().zip(&code.initial) {
            let value = self.get(initial, chunk);
            self.put(register, chunk, value);
        }
        let mut open_turns = zero;
        loop {
            self.block(&code.test, chunk..chunk + 1, false);
            let condition = self.get(code.condition, chunk);
            let (may_hold, may_fail) = condition.truth();
            let spent = self.spent(chunk);
            let exhausted = turning & may_hold & (fuel.is_le(spent) | most_open.is_lt(open_turns));
            let untold = self.untold(turning, may_hold, condition.is_undefined(), chunk);
            let nothing = untold | exhausted;
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
            let infinity = P::Real::<S>::splat(simd, f64::INFINITY);
            let spent = P::Real::<S>::pick(exhausted, infinity, spent);
            self.spend(P::Real::<S>::pick(turning, spent + one, spent), chunk);
            if !P::Real::<S>::any(turning) {
                break;
            }
            open_turns = P::Real::<S>::pick(turning & left, open_turns + one, open_turns);
            self.active = turning;
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
        self.active = outer;
    }

    /// Where a loop stops because nothing is known of its condition, or of how many turns an earlier loop has left. Over
    /// sets, this holds for all loops that follow, because some value of the set may have spent everything.
    #[inline(always)]
    fn untold(
        &mut self,
        turning: MaskOf<S, P>,
        may_hold: MaskOf<S, P>,
        undefined: MaskOf<S, P>,
        chunk: usize,
    ) -> MaskOf<S, P> {
        if !DomainOf::<S, P, K>::IS_SET {
            return undefined;
        }
        let place = LANES + chunk * P::Real::<S>::LANES;
        let (zero, one) = (P::Real::<S>::splat(self.simd, 0.0), P::Real::<S>::splat(self.simd, 1.0));
        let untold: P::Real<S> = Real::load(self.simd, &self.turns[place..]);
        let untold = P::Real::<S>::pick(turning & undefined, one, untold);
        Real::store(untold, &mut self.turns[place..]);
        undefined | (may_hold & zero.is_lt(untold))
    }

    /// How many turns the lanes of a chunk have taken.
    #[inline(always)]
    fn spent(&self, chunk: usize) -> P::Real<S> {
        Real::load(self.simd, &self.turns[chunk * P::Real::<S>::LANES..])
    }

    #[inline(always)]
    fn spend(&mut self, spent: P::Real<S>, chunk: usize) {
        Real::store(spent, &mut self.turns[chunk * P::Real::<S>::LANES..]);
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
