//! Registers for the values of a tape.

use crate::tape::{Code, Instruction, Op, Operand};
use rustc_hash::{FxHashMap, FxHashSet};

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

    /// What an instruction reads that was made outside it.
    fn reads(&self, instruction: &Instruction) -> Vec<u32> {
        let mut reads = Vec::with_capacity(3);
        self.collect_reads(instruction, &mut reads);
        reads
    }

    fn collect_reads(&self, instruction: &Instruction, reads: &mut Vec<u32>) {
        let mut push = |o: &Operand| {
            if let Operand::Value(v) = o {
                reads.push(*v);
            }
        };
        match instruction.op {
            Op::Loop(l) => {
                let code = &self.code.loops[l as usize];
                code.for_each_operand(&mut push);
                for inner in code.test.iter().chain(&code.body) {
                    if matches!(inner.op, Op::Loop(_) | Op::Call { .. }) {
                        self.collect_reads(inner, reads);
                    }
                }
            }
            Op::Call { arguments, .. } => self.code.arguments[arguments as usize].iter().for_each(push),
            _ => instruction.operands.iter().for_each(push),
        }
    }

    /// Where each value is read for the last time, never for those that are `kept`.
    fn last_reads(&self, instructions: &[Instruction], kept: &[Operand]) -> FxHashMap<u32, usize> {
        let mut last_read = FxHashMap::default();
        for (i, instruction) in instructions.iter().enumerate() {
            last_read.extend(self.reads(instruction).into_iter().map(|v| (v, i)));
        }
        for o in kept {
            if let Operand::Value(v) = o {
                last_read.insert(*v, usize::MAX);
            }
        }
        last_read
    }

    /// Allocates a block; `kept` must survive it. Values made outside the block are not freed in it.
    pub(crate) fn block(&mut self, instructions: &[Instruction], kept: &[Operand]) {
        let last_read = self.last_reads(instructions, kept);
        let mut made: Vec<u32> = Vec::new();
        let mut own: FxHashSet<u32> = Default::default();
        for (i, instruction) in instructions.iter().enumerate() {
            let made_by_loop = match instruction.op {
                Op::Loop(l) => {
                    self.inner_loop(l);
                    Some(self.code.loops[l as usize].results.clone())
                }
                _ => None,
            };
            // What is read here for the last time may lend its register to the result.
            for v in self.reads(instruction) {
                if last_read.get(&v) == Some(&i) && own.remove(&v) {
                    self.free.push(self.register[v as usize]);
                }
            }
            let results = made_by_loop.unwrap_or_else(|| {
                self.give(instruction.result);
                vec![instruction.result]
            });
            for v in results {
                made.push(v);
                if last_read.contains_key(&v) {
                    own.insert(v);
                } else {
                    self.free.push(self.register[v as usize]);
                }
            }
        }
        // The block's values end with it, but for those kept, whose owner frees them.
        for v in made {
            if own.contains(&v) && last_read.get(&v) != Some(&usize::MAX) {
                self.free.push(self.register[v as usize]);
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
