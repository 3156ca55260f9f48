//! The set operations that a tape ends with, and the programs that they combine.

use crate::field::Field;
use crate::graph::{Graph, Input, NodeId};
use crate::op::{Binary, Unary};
use crate::tape::{Code, Instruction, Op, Operand, Tape};
use std::collections::HashMap;

/// A combination of programs by minima and maxima, as an expression in postfix order.
#[derive(Clone, Debug)]
pub struct Combination {
    /// The programs that are combined.
    pub operands: Vec<Tape>,
    /// The expression.
    pub steps: Vec<SetStep>,
}

/// A step of a [`Combination`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SetStep {
    /// Puts the operand of this number on the stack.
    Operand(usize),
    /// Replaces the two numbers on top by the smaller one: the union of solids.
    Min,
    /// Replaces them by the larger one: the intersection.
    Max,
}

/// The instructions of a tape, for comparisons with tapes that were made from the same one.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct CodeKey(Vec<(Op, [Operand; 3], u32)>, Vec<Vec<Operand>>, Vec<Operand>);

/// Expressions with shared operands may be written out to so many steps for each operand.
const SHARED: usize = 4;

impl Tape {
    /// The set operations with which a tape under [`Reading::Sign`](crate::Reading::Sign) ends, with at most `most`
    /// operands, each of which is no set operation itself; `None` if there are more, or loops. The combination has the
    /// sign of the tape.
    pub fn combination(&self, most: usize) -> Option<Combination> {
        if !self.code.loops.is_empty() {
            return None;
        }
        let by_value: HashMap<u32, &Instruction> =
            self.code.instructions.iter().map(|instruction| (instruction.result, instruction)).collect();
        let mut operands: Vec<(Operand, bool)> = Vec::new();
        let mut steps = Vec::new();
        enum Task {
            Visit(Operand, bool),
            Then(SetStep),
        }
        let mut tasks = vec![Task::Visit(*self.code.outputs.first()?, false)];
        while let Some(task) = tasks.pop() {
            let (operand, negated) = match task {
                Task::Visit(operand, negated) => (operand, negated),
                Task::Then(step) => {
                    steps.push(step);
                    continue;
                }
            };
            let instruction = match operand {
                Operand::Value(v) => by_value.get(&v).filter(|instruction| instruction.sign_only),
                Operand::Constant(_) => None,
            };
            match instruction.map(|i| (i.op, i.operands)) {
                Some((Op::Unary(Unary::Neg), [a, ..])) => tasks.push(Task::Visit(a, !negated)),
                Some((
                    Op::Binary(op @ (Binary::Min | Binary::Max | Binary::RMin | Binary::RMax)),
                    [a, b, _],
                )) => {
                    // −min(a, b) = max(−a, −b).
                    let is_min = matches!(op, Binary::Min | Binary::RMin) != negated;
                    tasks.push(Task::Then(if is_min { SetStep::Min } else { SetStep::Max }));
                    tasks.extend([Task::Visit(b, negated), Task::Visit(a, negated)]);
                }
                _ => {
                    let known = operands.iter().position(|&o| o == (operand, negated));
                    let number = known.unwrap_or(operands.len());
                    if known.is_none() {
                        operands.push((operand, negated));
                    }
                    steps.push(SetStep::Operand(number));
                }
            }
            if operands.len() > most || steps.len() > SHARED * most {
                return None;
            }
        }
        let operands = operands.into_iter().map(|(operand, negated)| self.part(operand, negated)).collect();
        Some(Combination { operands, steps })
    }

    /// A tape of one of its values, or of the negative one.
    fn part(&self, operand: Operand, negated: bool) -> Tape {
        let mut instructions = self.code.instructions.clone();
        let mut output = operand;
        let mut tape = self.clone_shared();
        if negated {
            let result = tape.value_count;
            tape.value_count += 1;
            output = Operand::Value(result);
            let op = Op::Unary(Unary::Neg);
            instructions.push(Instruction { op, operands: [operand; 3], result, sign_only: true });
        }
        tape.code.arguments.clone_from(&self.code.arguments);
        tape.code.outputs = vec![output];
        tape.rebuilt(instructions, |operand| operand)
    }

    /// The instructions: tapes that were made from one tape do the same if theirs are equal. `None` for tapes with loops.
    pub fn code_key(&self) -> Option<CodeKey> {
        let Code { instructions, loops, arguments, outputs } = &self.code;
        let key = |i: &Instruction| (i.op, i.operands, i.result);
        loops
            .is_empty()
            .then(|| CodeKey(instructions.iter().map(key).collect(), arguments.clone(), outputs.clone()))
    }

    /// Whether two tapes without loops, made from one tape or from two that differ in their bindings only, have the same
    /// instructions.
    pub fn has_code_of(&self, other: &Tape) -> bool {
        let (a, b) = (&self.code, &other.code);
        let is_same = |(i, j): (&Instruction, &Instruction)| {
            (i.op, i.operands, i.result) == (j.op, j.operands, j.result)
        };
        a.loops.is_empty()
            && b.loops.is_empty()
            && a.instructions.len() == b.instructions.len()
            && a.outputs == b.outputs
            && a.arguments == b.arguments
            && a.instructions.iter().zip(&b.instructions).all(is_same)
    }

    /// The inputs that do not vary, with their values; parts of a tape know all those of the whole.
    pub fn uniforms(&self) -> impl Iterator<Item = (Input, f64)> {
        self.uniforms.iter().map(|&(input, place)| (input, self.constants[place as usize]))
    }

    /// Whether a tape without loops reads any of some inputs that do not vary; with loops it may.
    pub fn reads(&self, inputs: &[Input]) -> bool {
        let is_read = |operand: &Operand| {
            let Operand::Constant(place) = *operand else { return false };
            self.uniforms.iter().any(|&(input, at)| at == place && inputs.contains(&input))
        };
        let Code { instructions, loops, arguments, outputs } = &self.code;
        !loops.is_empty()
            || outputs.iter().any(is_read)
            || arguments.iter().flatten().any(is_read)
            || instructions.iter().flat_map(|i| &i.operands).any(is_read)
    }

    /// The first output as a field of the inputs that vary, in the order of
    /// [`TapeOptions::varying`](crate::TapeOptions::varying); all others have the values that are bound. `None` for tapes
    /// with loops.
    pub fn to_field(&self, varying: &[Input]) -> Option<Field> {
        if !self.code.loops.is_empty() || varying.len() < self.input_count as usize {
            return None;
        }
        let mut graph = Graph::new();
        let mut values: HashMap<u32, NodeId> =
            (0..self.input_count).map(|i| (i, graph.input(varying[i as usize]))).collect();
        for instruction in &self.code.instructions {
            let node = self.node(&mut graph, &values, instruction)?;
            values.insert(instruction.result, node);
        }
        let value = self.read(&mut graph, &values, *self.code.outputs.first()?)?;
        Some(Field::new(graph, value, Vec::new()).with_fuel(self.fuel))
    }

    fn read(&self, graph: &mut Graph, values: &HashMap<u32, NodeId>, operand: Operand) -> Option<NodeId> {
        match operand {
            Operand::Value(v) => values.get(&v).copied(),
            Operand::Constant(place) => Some(graph.constant(self.constants[place as usize])),
        }
    }

    fn node(
        &self,
        graph: &mut Graph,
        values: &HashMap<u32, NodeId>,
        instruction: &Instruction,
    ) -> Option<NodeId> {
        let [a, b, c] = instruction.operands;
        let read = |graph: &mut Graph, operand| self.read(graph, values, operand);
        Some(match instruction.op {
            Op::Unary(op) => {
                let a = read(graph, a)?;
                graph.unary(op, a)
            }
            Op::Powi(n) => {
                let a = read(graph, a)?;
                graph.powi(a, n)
            }
            Op::Binary(op) => {
                let (a, b) = (read(graph, a)?, read(graph, b)?);
                graph.binary(op, a, b)
            }
            Op::Select => {
                let (c, a, b) = (read(graph, a)?, read(graph, b)?, read(graph, c)?);
                graph.select(c, a, b)
            }
            Op::Call { function, arguments } => {
                let list = &self.code.arguments[arguments as usize];
                let list: Option<Vec<NodeId>> = list.iter().map(|&o| read(graph, o)).collect();
                graph.call(&self.functions[function as usize], &list?)
            }
            Op::Loop(_) => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{F64, Points, Reading, TapeOptions, Workspace};

    /// max(min(x, y² − 1), −max(z, x + 0.5)), read for its sign.
    fn tape() -> Tape {
        let mut graph = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Coordinate(k)));
        let (one, half) = (graph.constant(1.0), graph.constant(0.5));
        let square = graph.square(y);
        let disc = graph.sub(square, one);
        let first = graph.min(x, disc);
        let moved = graph.add(x, half);
        let second = graph.max(z, moved);
        let second = graph.neg(second);
        let value = graph.max(first, second);
        let options = TapeOptions { reading: Reading::Sign, ..TapeOptions::default() };
        Tape::new(&Field::new(graph, value, Vec::new()), &options)
    }

    fn value(tape: &Tape, point: [f64; 3]) -> f64 {
        let mut workspace = Workspace::<F64, Points>::new();
        (0..3).for_each(|axis| workspace.input(axis, 0)[0] = point[axis]);
        workspace.run(tape, 1);
        workspace.output(0, 0)[0]
    }

    fn points() -> impl Iterator<Item = [f64; 3]> {
        (0..125).map(|i| [i % 5, i / 5 % 5, i / 25].map(|k| 0.83 * f64::from(k) - 1.7))
    }

    #[test]
    fn a_combination_has_the_value_of_the_tape() {
        let tape = tape();
        let Combination { operands, steps } = tape.combination(4).unwrap();
        assert_eq!(operands.len(), 4);
        for point in points() {
            let mut stack = Vec::new();
            for step in &steps {
                let combined = match step {
                    SetStep::Operand(number) => value(&operands[*number], point),
                    SetStep::Min => f64::min(stack.pop().unwrap(), stack.pop().unwrap()),
                    SetStep::Max => f64::max(stack.pop().unwrap(), stack.pop().unwrap()),
                };
                stack.push(combined);
            }
            assert_eq!(stack, [value(&tape, point)], "{point:?}");
        }
    }

    #[test]
    fn too_many_operands_are_not_taken_apart() {
        assert!(tape().combination(3).is_none());
    }

    #[test]
    fn equal_parts_of_one_tape_have_equal_keys() {
        let tape = tape();
        let keys = |t: &Tape| -> Vec<CodeKey> {
            t.combination(4).unwrap().operands.iter().map(|o| o.code_key().unwrap()).collect()
        };
        let whole = keys(&tape);
        // Without the first operand of the outer maximum.
        let last = tape.choices().last().unwrap();
        let second = keys(&tape.specialise(|place| if place == last { 2 } else { 3 }));
        assert_eq!(second, whole[2..]);
        assert!(whole[0] != whole[1] && whole[2] != whole[3]);
    }

    #[test]
    fn a_tape_as_a_field_has_the_same_values() {
        let tape = tape();
        let varying: Vec<Input> = (0..3).map(Input::Coordinate).collect();
        let field = tape.to_field(&varying).unwrap();
        let again = Tape::new(&field, &TapeOptions::default());
        for point in points() {
            assert_eq!(value(&again, point), value(&tape, point), "{point:?}");
        }
        assert!(tape.to_field(&varying[..2]).is_none());
    }
}
