//! Loops whose turns can be counted when the file is read.
//!
//! Of the values that a loop carries, some depend on nothing but numbers: its counter, often, and what is computed from
//! it. If the condition is among what depends on numbers alone, the loop is run for these values here, once; after it they
//! are known again, as if it had been written out.

use fieldstone_field::{Binary, Domain, Graph, LoopId, Node, NodeId, Unary};
use std::collections::HashMap;

/// How many operations may be spent on running the loops of a text.
pub(super) const MAX_OPERATIONS: usize = 20_000_000;

/// A loop of a graph, whose carried values are counted from 0.
pub(super) struct Parts<'a> {
    pub(super) id: LoopId,
    pub(super) initial: &'a [NodeId],
    pub(super) condition: NodeId,
    pub(super) next: &'a [NodeId],
}

/// What is known of a loop.
pub(super) enum Count {
    /// Its turns depend on the point or on parameters.
    Unknown,
    /// It ends after so many turns; the carried values after it, as far as they are known.
    Known { turns: usize, values: Vec<Option<f64>> },
    /// It turns more often than this.
    TooMany(usize),
}

/// Runs a loop for the values that depend on numbers alone; `budget` is the number of operations that are left for it.
pub(super) fn count(graph: &Graph, parts: &Parts<'_>, budget: &mut usize) -> Count {
    let open = open_values(graph, parts);
    if depends(graph, parts.id, &open, parts.condition, &mut HashMap::new()) {
        return Count::Unknown;
    }
    let known: Vec<usize> = (0..open.len()).filter(|&k| !open[k]).collect();
    Program::new(graph, parts, &known).run(open.len(), &known, budget)
}

/// For each carried value whether it depends on more than numbers.
fn open_values(graph: &Graph, parts: &Parts<'_>) -> Vec<bool> {
    let mut open: Vec<bool> = parts.initial.iter().map(|&n| graph.constant_value(n).is_none()).collect();
    loop {
        let mut known = HashMap::new();
        let found: Vec<usize> = (0..open.len())
            .filter(|&k| !open[k] && depends(graph, parts.id, &open, parts.next[k], &mut known))
            .collect();
        if found.is_empty() {
            return open;
        }
        found.into_iter().for_each(|k| open[k] = true);
    }
}

/// Whether a node depends on more than numbers and the carried values that are not `open`; `known` keeps the answers.
fn depends(
    graph: &Graph,
    id: LoopId,
    open: &[bool],
    node: NodeId,
    known: &mut HashMap<NodeId, bool>,
) -> bool {
    let mut stack = vec![(node, false)];
    while let Some((n, operands_done)) = stack.pop() {
        if known.contains_key(&n) {
            continue;
        }
        let answer = match graph.node(n) {
            Node::Constant(_) => false,
            Node::LoopVar(l, k) => *l != id || open[*k as usize],
            Node::Input(_) | Node::LoopOut(..) | Node::Call(..) => true,
            other if operands_done => other.operands().iter().any(|o| known[o]),
            other => {
                stack.push((n, true));
                stack.extend(other.operands().into_iter().map(|o| (o, false)));
                continue;
            }
        };
        known.insert(n, answer);
    }
    known[&node]
}

/// An operation on registers.
enum Step {
    Unary(Unary, usize),
    Powi(usize, i32),
    Binary(Binary, usize, usize),
    Select(usize, usize, usize),
}

/// The condition and the known values of a loop as code: each step fills the register of its number behind those of the
/// constants and of the carried values.
#[derive(Default)]
struct Program {
    registers: Vec<f64>,
    /// The steps with the registers that they fill.
    steps: Vec<(Step, usize)>,
    /// How many steps the condition needs.
    test: usize,
    condition: usize,
    /// For each known value its register, and that of its next value.
    carried: Vec<(usize, usize)>,
    places: HashMap<NodeId, usize>,
}

impl Program {
    fn new(graph: &Graph, parts: &Parts<'_>, known: &[usize]) -> Self {
        let mut program = Self::default();
        // A carried value that nothing reads has no node; its register is made by the way.
        let registers: Vec<usize> =
            known.iter().map(|&k| program.register(graph.constant_value(parts.initial[k]))).collect();
        let at = |k: u32| known.binary_search(&(k as usize)).map_or(0, |place| registers[place]);
        program.condition = program.add(graph, parts.condition, at);
        program.test = program.steps.len();
        for (place, &k) in known.iter().enumerate() {
            let next = program.add(graph, parts.next[k], at);
            program.carried.push((registers[place], next));
        }
        program
    }

    fn register(&mut self, value: Option<f64>) -> usize {
        self.registers.push(value.unwrap_or(f64::NAN));
        self.registers.len() - 1
    }

    /// The register of a node's value; `carried` gives those of the carried values.
    fn add(&mut self, graph: &Graph, node: NodeId, carried: impl Fn(u32) -> usize) -> usize {
        let mut stack = vec![node];
        while let Some(&n) = stack.last() {
            let missing: Vec<NodeId> =
                graph.node(n).operands().into_iter().filter(|o| !self.places.contains_key(o)).collect();
            if self.places.contains_key(&n) {
                stack.pop();
            } else if missing.is_empty() {
                stack.pop();
                let place = self.place(graph, n, &carried);
                self.places.insert(n, place);
            } else {
                stack.extend(missing);
            }
        }
        self.places[&node]
    }

    /// The register of a node whose operands have registers.
    fn place(&mut self, graph: &Graph, node: NodeId, carried: &impl Fn(u32) -> usize) -> usize {
        let at = |o: &NodeId| self.places[o];
        let step = match graph.node(node) {
            Node::LoopVar(_, k) => return carried(*k),
            Node::Unary(op, a) => Step::Unary(*op, at(a)),
            Node::Powi(a, n) => Step::Powi(at(a), *n),
            Node::Binary(op, a, b) => Step::Binary(*op, at(a), at(b)),
            Node::Select(c, a, b) => Step::Select(at(c), at(a), at(b)),
            _ => return self.register(graph.constant_value(node)),
        };
        let result = self.register(None);
        self.steps.push((step, result));
        result
    }

    fn execute(&mut self, steps: std::ops::Range<usize>) {
        let registers = &mut self.registers;
        for (step, result) in &self.steps[steps] {
            registers[*result] = match *step {
                Step::Unary(op, a) => op.apply(registers[a]),
                Step::Powi(a, n) => Domain::powi(registers[a], n),
                Step::Binary(op, a, b) => op.apply(registers[a], registers[b]),
                Step::Select(c, a, b) => registers[c].select(registers[a], registers[b], ()),
            };
        }
    }

    /// Runs the loop to its end; the values of those carried values that are `known`, of `count` in all.
    fn run(mut self, count: usize, known: &[usize], budget: &mut usize) -> Count {
        let cost = self.steps.len() + self.carried.len() + 1;
        let limit = *budget / cost;
        for turns in 0..=limit {
            self.execute(0..self.test);
            let holds = self.registers[self.condition];
            if holds.is_nan() || holds == 0.0 {
                let mut values = vec![None; count];
                for (&k, (register, _)) in known.iter().zip(&self.carried) {
                    // A loop whose condition is undefined leaves undefined values.
                    values[k] = Some(if holds.is_nan() { f64::NAN } else { self.registers[*register] });
                }
                *budget -= (turns * cost).min(*budget);
                return Count::Known { turns, values };
            }
            self.execute(self.test..self.steps.len());
            let next: Vec<f64> = self.carried.iter().map(|(_, next)| self.registers[*next]).collect();
            for ((register, _), value) in self.carried.iter().zip(next) {
                self.registers[*register] = value;
            }
        }
        Count::TooMany(limit)
    }
}
