//! Tapes: programs as linear code over registers.
//!
//! A [`Graph`](crate::Graph) is scheduled so that few values are alive at a time, constants and inputs that do not vary
//! over a block are kept in a table, and registers are given out by a linear scan. The code before register
//! allocation, in which every value is assigned once, is kept for [`Tape::specialise`].

use crate::allocate::Allocator;
use crate::compile::compile;
use crate::defined::outside_where_undefined;
use crate::field::{Bindings, Field};
use crate::function::Function;
use crate::graph::Input;
use crate::op::{Binary, Unary};
use std::sync::Arc;

/// Where an operand comes from.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Operand {
    /// A value; after allocation, a register.
    Value(u32),
    /// A place in the table of constants.
    Constant(u32),
}

/// What an instruction does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Op {
    Unary(Unary),
    Powi(i32),
    Binary(Binary),
    Select,
    /// A call of the function with this number; its arguments stand in the table of arguments.
    Call {
        function: u32,
        arguments: u32,
    },
    Loop(u32),
}

impl Op {
    /// About how much it costs over intervals, in additions: elementary functions go through the standard library, lane
    /// by lane.
    fn cost(self) -> usize {
        match self {
            Self::Unary(Unary::Sin | Unary::Cos) => 2,
            Self::Unary(op) if !op.is_cheap() => 4,
            Self::Binary(Binary::Pow) => 64,
            Self::Call { .. } => 16,
            Self::Binary(Binary::Atan2) => 8,
            _ => 1,
        }
    }
}

/// One instruction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instruction {
    pub(crate) op: Op,
    pub(crate) operands: [Operand; 3],
    pub(crate) result: u32,
    /// Whether nothing but the sign of the result is ever read.
    pub(crate) sign_only: bool,
}

/// A data-dependent loop.
#[derive(Clone, Debug)]
pub(crate) struct LoopCode {
    pub(crate) carried: Vec<u32>,
    pub(crate) results: Vec<u32>,
    /// Where the next carried values wait until all are known.
    pub(crate) waiting: Vec<u32>,
    pub(crate) initial: Vec<Operand>,
    pub(crate) test: Vec<Instruction>,
    pub(crate) condition: Operand,
    pub(crate) body: Vec<Instruction>,
    pub(crate) next: Vec<Operand>,
}

/// Code with its loops and argument lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct Code {
    pub(crate) instructions: Vec<Instruction>,
    pub(crate) loops: Vec<LoopCode>,
    pub(crate) arguments: Vec<Vec<Operand>>,
    pub(crate) outputs: Vec<Operand>,
}

/// What the first output is used for.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Reading {
    /// The value itself.
    #[default]
    Value,
    /// Only where it is negative, zero or positive. R-operations may then be replaced by the operand that decides, and
    /// where a partial operation is certainly outside of its domain (√a for a < 0), the value is 1: there is no solid.
    Sign,
}

/// What to compile.
#[derive(Clone, Debug)]
pub struct TapeOptions {
    /// The inputs that differ from lane to lane, in the order in which evaluators take them; usually x, y, z.
    pub varying: Vec<Input>,
    /// The values of all other inputs.
    pub bindings: Bindings,
    /// Whether to compute the attributes too; they follow the value.
    pub attributes: bool,
    /// What the value is used for.
    pub reading: Reading,
}

impl Default for TapeOptions {
    fn default() -> Self {
        Self {
            varying: (0..3).map(Input::Coordinate).collect(),
            bindings: Bindings::default(),
            attributes: false,
            reading: Reading::Value,
        }
    }
}

/// A program as linear code, ready to be evaluated over any domain.
#[derive(Clone, Debug)]
pub struct Tape {
    pub(crate) code: Code,
    /// The same code over registers.
    pub(crate) run: Code,
    pub(crate) register_count: u32,
    pub(crate) value_count: u32,
    pub(crate) input_count: u32,
    pub(crate) constants: Arc<Vec<f64>>,
    pub(crate) uniforms: Arc<Vec<(Input, u32)>>,
    pub(crate) functions: Arc<Vec<Arc<dyn Function>>>,
    pub(crate) fuel: u32,
}

impl Tape {
    /// Compiles a field.
    pub fn new(field: &Field, options: &TapeOptions) -> Self {
        let guarded = (options.reading == Reading::Sign).then(|| outside_where_undefined(field));
        let field = guarded.as_ref().unwrap_or(field);
        let compiled = compile(field, options);
        let mut tape = Self {
            run: Code::default(),
            code: compiled.code,
            register_count: 0,
            value_count: compiled.value_count,
            input_count: options.varying.len() as u32,
            constants: Arc::new(compiled.constants),
            uniforms: Arc::new(compiled.uniforms),
            functions: Arc::new(field.graph().functions.clone()),
            fuel: field.fuel(),
        };
        if options.reading == Reading::Sign {
            tape.mark_sign_only();
        }
        tape.allocate();
        tape
    }

    /// The number of instructions, those inside loops counted once.
    pub fn len(&self) -> usize {
        let in_loops: usize = self.code.loops.iter().map(|l| l.test.len() + l.body.len()).sum();
        self.code.instructions.len() + in_loops
    }

    /// About how much an evaluation costs, in additions; what is inside loops is counted once.
    pub fn cost(&self) -> usize {
        let in_loops = self.code.loops.iter().flat_map(|l| l.test.iter().chain(&l.body));
        self.code.instructions.iter().chain(in_loops).map(|instruction| instruction.op.cost()).sum()
    }

    /// Whether there is nothing to compute: the outputs are constants or inputs.
    pub fn is_empty(&self) -> bool {
        self.code.instructions.is_empty()
    }

    /// Whether the tape calls a function of which nothing but values is known.
    pub fn has_black_box(&self) -> bool {
        self.functions.iter().any(|f| f.is_black_box())
    }

    /// The number of outputs.
    pub fn output_count(&self) -> usize {
        self.code.outputs.len()
    }

    /// Changes the value of an input that does not vary; nothing is compiled anew.
    pub fn bind(&mut self, input: Input, value: f64) {
        for &(known, place) in self.uniforms.iter() {
            if known == input {
                Arc::make_mut(&mut self.constants)[place as usize] = value;
            }
        }
    }

    /// Finds the values of which only the sign is read: the first output, and what set operations hand on.
    fn mark_sign_only(&mut self) {
        // For every value: read as a whole by someone.
        let mut whole = vec![false; self.value_count as usize];
        let mark = |operand: &Operand, whole: &mut Vec<bool>| {
            if let Operand::Value(v) = operand {
                whole[*v as usize] = true;
            }
        };
        for output in &self.code.outputs[1..] {
            mark(output, &mut whole);
        }
        for l in &self.code.loops {
            l.for_each_operand(&mut |o| mark(o, &mut whole));
        }
        self.code.arguments.iter().flatten().for_each(|o| mark(o, &mut whole));
        for instruction in self.code.instructions.iter_mut().rev() {
            instruction.sign_only = !whole[instruction.result as usize];
            let hands_on = match instruction.op {
                Op::Unary(Unary::Neg) => 0,
                Op::Binary(Binary::Min | Binary::Max | Binary::RMin | Binary::RMax) => 0,
                // The condition is read as a whole, the branches are handed on.
                Op::Select => 1,
                _ => 3,
            };
            let read_whole = if instruction.sign_only { hands_on } else { 3 };
            for operand in &instruction.operands[..read_whole] {
                mark(operand, &mut whole);
            }
        }
    }

    /// The places of the instructions that [`specialise`](Self::specialise) may decide.
    pub fn choices(&self) -> impl Iterator<Item = usize> {
        let decides = |instruction: &Instruction| {
            use Binary::{Max, Min, RMax, RMin};
            matches!(instruction.op, Op::Select | Op::Unary(Unary::Abs) | Op::Binary(Min | Max | RMin | RMax))
        };
        self.code.instructions.iter().enumerate().filter(move |(_, i)| decides(i)).map(|(place, _)| place)
    }

    /// Like [`specialise`](Self::specialise), but nothing if no choice is decided.
    pub fn shortened(&self, choice: impl Fn(usize) -> u8) -> Option<Tape> {
        (0..self.code.instructions.len()).any(|i| choice(i) != 3).then(|| self.specialise(choice))
    }

    /// The tape that is left where only some operands can matter.
    ///
    /// `choice` gives, for the place of an instruction, which of its operands may be taken: bit 0 the first, bit 1
    /// the second, as [`Workspace::run_traced`](crate::Workspace::run_traced) records them. The result agrees with
    /// this tape wherever these choices are right; under [`Reading::Sign`] in sign.
    pub fn specialise(&self, choice: impl Fn(usize) -> u8) -> Tape {
        let mut alias: Vec<Operand> = (0..self.value_count).map(Operand::Value).collect();
        let resolve = |alias: &[Operand], o: Operand| match o {
            Operand::Value(v) => alias[v as usize],
            constant => constant,
        };
        let mut kept = Vec::with_capacity(self.code.instructions.len());
        for (i, instruction) in self.code.instructions.iter().enumerate() {
            let mut instruction = *instruction;
            instruction.operands = instruction.operands.map(|o| resolve(&alias, o));
            let [a, b, c] = instruction.operands;
            let taken = match (instruction.op, choice(i)) {
                (Op::Binary(_), 1) => Some(a),
                (Op::Binary(_), 2) => Some(b),
                (Op::Select, 1) => Some(b),
                (Op::Select, 2) => Some(c),
                (Op::Unary(Unary::Abs), 1) => Some(a),
                (Op::Unary(Unary::Abs), 2) => {
                    instruction.op = Op::Unary(Unary::Neg);
                    None
                }
                _ => None,
            };
            match taken {
                Some(operand) => alias[instruction.result as usize] = operand,
                None => kept.push(instruction),
            }
        }
        self.rebuilt(kept, |o| resolve(&alias, o))
    }

    /// A tape of the live ones among `instructions`, all other operands read through `resolve`.
    pub(crate) fn rebuilt(
        &self,
        mut instructions: Vec<Instruction>,
        resolve: impl Fn(Operand) -> Operand,
    ) -> Tape {
        let outputs: Vec<Operand> = self.code.outputs.iter().map(|&o| resolve(o)).collect();
        let mut live = vec![false; self.value_count as usize];
        let mark = |o: Operand, live: &mut Vec<bool>| {
            if let Operand::Value(v) = o {
                live[v as usize] = true;
            }
        };
        outputs.iter().for_each(|&o| mark(o, &mut live));
        let mut keep = vec![false; instructions.len()];
        for (i, instruction) in instructions.iter().enumerate().rev() {
            keep[i] = match instruction.op {
                Op::Loop(l) => self.code.loops[l as usize].results.iter().any(|&r| live[r as usize]),
                _ => live[instruction.result as usize],
            };
            if !keep[i] {
                continue;
            }
            instruction.operands.iter().for_each(|&o| mark(o, &mut live));
            match instruction.op {
                Op::Loop(l) => self.mark_loop(l, &mut |o| mark(resolve(o), &mut live)),
                Op::Call { arguments, .. } => {
                    self.code.arguments[arguments as usize].iter().for_each(|&o| mark(resolve(o), &mut live));
                }
                _ => {}
            }
        }
        let mut index = 0;
        instructions.retain(|_| {
            index += 1;
            keep[index - 1]
        });
        let mut loops = self.code.loops.clone();
        loops.iter_mut().for_each(|l| l.map_operands(&resolve));
        let mut arguments: Vec<Vec<Operand>> = vec![Vec::new(); self.code.arguments.len()];
        // Calls inside of loops have theirs too.
        let inner = loops.iter().flat_map(|l| l.test.iter().chain(&l.body));
        for instruction in instructions.iter().chain(inner) {
            if let Op::Call { arguments: list, .. } = instruction.op {
                let list = list as usize;
                arguments[list] = self.code.arguments[list].iter().map(|&o| resolve(o)).collect();
            }
        }
        let code = Code { instructions, loops, arguments, outputs };
        let mut tape = Tape { code, ..self.clone_shared() };
        tape.renumber();
        tape.allocate();
        tape
    }

    /// Numbers the values anew, without gaps, so that what is done for each costs no more than the program is long.
    fn renumber(&mut self) {
        // Loops keep lists of values, and are rarely shortened.
        if !self.code.loops.is_empty() {
            return;
        }
        let mut number = vec![u32::MAX; self.value_count as usize];
        (0..self.input_count).for_each(|i| number[i as usize] = i);
        let mut count = self.input_count;
        for instruction in &self.code.instructions {
            number[instruction.result as usize] = count;
            count += 1;
        }
        let operand = |o: Operand| match o {
            // What unread operands of an instruction name may be gone.
            Operand::Value(v) => Operand::Value(number[v as usize].min(count.saturating_sub(1))),
            constant => constant,
        };
        self.code.map_registers(&operand, &|v| number[v as usize]);
        self.value_count = count;
    }

    pub(crate) fn clone_shared(&self) -> Tape {
        Tape {
            code: Code::default(),
            run: Code::default(),
            register_count: 0,
            value_count: self.value_count,
            input_count: self.input_count,
            constants: self.constants.clone(),
            uniforms: self.uniforms.clone(),
            functions: self.functions.clone(),
            fuel: self.fuel,
        }
    }

    /// Everything that a loop, and the loops inside it, read.
    fn mark_loop(&self, l: u32, mark: &mut impl FnMut(Operand)) {
        let code = &self.code.loops[l as usize];
        code.for_each_operand(&mut |&o| mark(o));
        for instruction in code.test.iter().chain(&code.body) {
            match instruction.op {
                Op::Loop(inner) => self.mark_loop(inner, mark),
                Op::Call { arguments, .. } => {
                    self.code.arguments[arguments as usize].iter().for_each(|&o| mark(o));
                }
                _ => {}
            }
        }
    }

    /// Gives every value a register.
    fn allocate(&mut self) {
        let mut allocator = Allocator::new(&self.code, self.value_count, self.input_count);
        let kept: Vec<Operand> = self.code.outputs.clone();
        allocator.block(&self.code.instructions, &kept);
        let (register, count) = (allocator.register, allocator.count);
        let to_register = |o: Operand| match o {
            Operand::Value(v) => Operand::Value(register[v as usize]),
            constant => constant,
        };
        let mut run = self.code.clone();
        run.map_registers(&to_register, &|v| register[v as usize]);
        self.register_count = count;
        self.run = run;
    }
}

impl LoopCode {
    pub(crate) fn for_each_operand(&self, f: &mut impl FnMut(&Operand)) {
        self.initial.iter().chain(&self.next).chain([&self.condition]).for_each(&mut *f);
        self.test.iter().chain(&self.body).flat_map(|i| &i.operands).for_each(f);
    }

    fn map_operands(&mut self, f: &impl Fn(Operand) -> Operand) {
        let lists = self.initial.iter_mut().chain(&mut self.next).chain([&mut self.condition]);
        let code = self.test.iter_mut().chain(&mut self.body).flat_map(|i| &mut i.operands);
        lists.chain(code).for_each(|o| *o = f(*o));
    }
}

impl Code {
    fn map_registers(&mut self, operand: &impl Fn(Operand) -> Operand, value: &impl Fn(u32) -> u32) {
        for instruction in &mut self.instructions {
            instruction.operands = instruction.operands.map(operand);
            instruction.result = value(instruction.result);
        }
        self.outputs.iter_mut().for_each(|o| *o = operand(*o));
        self.arguments.iter_mut().flatten().for_each(|o| *o = operand(*o));
        for l in &mut self.loops {
            l.map_operands(operand);
            let results = l.test.iter_mut().chain(&mut l.body).map(|i| &mut i.result);
            let values = l.carried.iter_mut().chain(&mut l.results).chain(&mut l.waiting);
            results.chain(values).for_each(|v| *v = value(*v));
        }
    }
}
