//! Registers for the values of a tape.

use crate::tape::{Code, Instruction, Op, Operand};
use rustc_hash::FxHashSet;

/// Instead of the place of the instruction that reads a value last: nobody reads it; it is kept.
const NEVER: u32 = u32::MAX;
const KEPT: u32 = u32::MAX - 1;

/// Registers by linear scan; a loop is one instruction that holds all it needs until it ends.
pub(crate) struct Allocator<'c> {
    code: &'c Code,
    /// The register of every value that has one.
    pub(crate) register: Vec<u32>,
    free: Vec<u32>,
    /// How many registers there are.
    pub(crate) count: u32,
}

impl<'c> Allocator<'c> {
    /// An allocator that has given the first registers to the inputs.
    pub(crate) fn new(code: &'c Code, value_count: u32, input_count: u32) -> Self {
        let mut register = vec![u32::MAX; value_count as usize];
        for i in 0..input_count {
            register[i as usize] = i;
        }
        Self { code, register, free: Vec::new(), count: input_count }
    }

    fn give(&mut self, value: u32) {
        let register = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.register[value as usize] = register;
    }

    /// Calls with every value that an instruction reads and that was made outside it.
    fn for_each_read(code: &Code, instruction: &Instruction, f: &mut dyn FnMut(u32)) {
        let mut read = |o: &Operand| {
            if let Operand::Value(v) = o {
                f(*v);
            }
        };
        match instruction.op {
            Op::Loop(l) => {
                let body = &code.loops[l as usize];
                body.for_each_operand(&mut read);
                for inner in body.test.iter().chain(&body.body) {
                    if matches!(inner.op, Op::Loop(_) | Op::Call { .. }) {
                        Self::for_each_read(code, inner, f);
                    }
                }
            }
            Op::Call { arguments, .. } => code.arguments[arguments as usize].iter().for_each(read),
            _ => instruction.operands.iter().for_each(read),
        }
    }

    /// Where each value is read for the last time: [`KEPT`] for those that are `kept`, [`NEVER`] for others.
    fn last_reads(&self, instructions: &[Instruction], kept: &[Operand]) -> Vec<u32> {
        let mut last_read = vec![NEVER; self.register.len()];
        for (i, instruction) in instructions.iter().enumerate() {
            Self::for_each_read(self.code, instruction, &mut |v| last_read[v as usize] = i as u32);
        }
        for o in kept {
            if let Operand::Value(v) = o {
                last_read[*v as usize] = KEPT;
            }
        }
        last_read
    }

    /// Allocates a block; `kept` must survive it. Values made outside the block are not freed in it.
    pub(crate) fn block(&mut self, instructions: &[Instruction], kept: &[Operand]) {
        let last_read = self.last_reads(instructions, kept);
        // Values made in this block whose registers are taken.
        let mut own = vec![false; self.register.len()];
        for (i, instruction) in instructions.iter().enumerate() {
            if let Op::Loop(l) = instruction.op {
                self.inner_loop(l);
            }
            // What is read here for the last time may lend its register to the result.
            let Self { code, register, free, .. } = self;
            Self::for_each_read(code, instruction, &mut |v| {
                if last_read[v as usize] == i as u32 && std::mem::take(&mut own[v as usize]) {
                    free.push(register[v as usize]);
                }
            });
            let mut made = |this: &mut Self, v: u32| {
                if last_read[v as usize] == NEVER {
                    this.free.push(this.register[v as usize]);
                } else {
                    own[v as usize] = true;
                }
            };
            match instruction.op {
                Op::Loop(l) => self.code.loops[l as usize].results.iter().for_each(|&v| made(self, v)),
                _ => {
                    self.give(instruction.result);
                    made(self, instruction.result);
                }
            }
        }
        // The block's values end with it, but for those kept, whose owner frees them.
        for (v, own) in own.into_iter().enumerate() {
            if own && last_read[v] != KEPT {
                self.free.push(self.register[v]);
            }
        }
    }

    fn inner_loop(&mut self, l: u32) {
        let code = &self.code.loops[l as usize];
        let (carried, waiting, results) = (code.carried.clone(), code.waiting.clone(), code.results.clone());
        carried.iter().chain(&waiting).chain(&results).for_each(|&v| self.give(v));
        let all: Vec<Instruction> = code.test.iter().chain(&code.body).copied().collect();
        let kept: Vec<Operand> = code.next.iter().copied().chain([code.condition]).collect();
        self.block(&all, &kept);
        let inside: FxHashSet<u32> = all.iter().map(|i| i.result).collect();
        let mut freed: FxHashSet<u32> = Default::default();
        for o in kept {
            if let Operand::Value(v) = o
                && inside.contains(&v)
                && freed.insert(v)
            {
                self.free.push(self.register[v as usize]);
            }
        }
        carried.iter().chain(&waiting).for_each(|&v| self.free.push(self.register[v as usize]));
    }
}
