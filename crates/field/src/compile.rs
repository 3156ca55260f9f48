//! From graphs to code.

use crate::field::Field;
use crate::graph::{Graph, Input, LoopId, Node, NodeId};
use crate::tape::{Code, Instruction, LoopCode, Op, Operand, TapeOptions};
use rustc_hash::{FxHashMap, FxHashSet};

/// Code and the tables that it refers to.
pub(crate) struct Compiled {
    pub(crate) code: Code,
    pub(crate) constants: Vec<f64>,
    /// The inputs that do not vary, with their places among the constants.
    pub(crate) uniforms: Vec<(Input, u32)>,
    pub(crate) value_count: u32,
}

/// Schedules the outputs of a field.
pub(crate) fn compile(field: &Field, options: &TapeOptions) -> Compiled {
    let mut outputs = vec![field.value()];
    if options.attributes {
        outputs.extend(field.attributes());
    }
    let mut compiler = Compiler::new(field.graph(), options);
    compiler.find_needed(&outputs);
    let instructions = compiler.block(&outputs);
    let outputs = outputs.iter().map(|&o| compiler.operand(o)).collect();
    let Compiler { loops, arguments, constants, uniforms, value_count, .. } = compiler;
    Compiled { code: Code { instructions, loops, arguments, outputs }, constants, uniforms, value_count }
}

/// Turns a graph into code.
struct Compiler<'g> {
    graph: &'g Graph,
    /// The operand of every node that has one by now.
    operands: Vec<Option<Operand>>,
    /// How many registers a node's tree needs, roughly (Sethi and Ullman 1970).
    needs: Vec<u16>,
    constants: Vec<f64>,
    constant_places: FxHashMap<u64, u32>,
    uniforms: Vec<(Input, u32)>,
    options: &'g TapeOptions,
    /// The carried values that matter to the outputs, loop by loop.
    needed: FxHashSet<(LoopId, u32)>,
    loops: Vec<LoopCode>,
    arguments: Vec<Vec<Operand>>,
    value_count: u32,
}

impl<'g> Compiler<'g> {
    fn new(graph: &'g Graph, options: &'g TapeOptions) -> Self {
        let mut needs = vec![1u16; graph.len()];
        for n in 0..graph.len() {
            let mut of: Vec<u16> = graph.nodes[n].operands().iter().map(|o| needs[o.0 as usize]).collect();
            of.sort_unstable_by(|a, b| b.cmp(a));
            needs[n] =
                of.iter().enumerate().map(|(i, need)| need.saturating_add(i as u16)).max().unwrap_or(1);
        }
        Self {
            graph,
            operands: vec![None; graph.len()],
            needs,
            constants: Vec::new(),
            constant_places: FxHashMap::default(),
            uniforms: Vec::new(),
            options,
            needed: FxHashSet::default(),
            loops: Vec::new(),
            arguments: Vec::new(),
            value_count: options.varying.len() as u32,
        }
    }

    /// Finds the carried values that the outputs depend on, through other carried values and conditions too.
    fn find_needed(&mut self, outputs: &[NodeId]) {
        let mut seen = vec![false; self.graph.len()];
        let mut stack = outputs.to_vec();
        while let Some(n) = stack.pop() {
            if std::mem::replace(&mut seen[n.0 as usize], true) {
                continue;
            }
            match self.graph.node(n) {
                Node::LoopOut(l, i) | Node::LoopVar(l, i) => {
                    let body = &self.graph.loops[l.0 as usize];
                    self.needed.insert((*l, *i));
                    stack.extend([body.initial[*i as usize], body.next[*i as usize], body.condition]);
                }
                other => stack.extend(other.operands()),
            }
        }
    }

    /// The places of the carried values of a loop that are needed.
    fn carried(&self, l: LoopId) -> Vec<usize> {
        let count = self.graph.loops[l.0 as usize].initial.len() as u32;
        (0..count).filter(|&i| self.needed.contains(&(l, i))).map(|i| i as usize).collect()
    }

    /// The nodes outside a loop that it reads for the sake of those of its carried values that are needed.
    fn free_nodes(&self, l: LoopId) -> Vec<NodeId> {
        let body = &self.graph.loops[l.0 as usize];
        let carried = self.carried(l);
        let mut free: Vec<NodeId> = carried.iter().map(|&i| body.initial[i]).collect();
        let mut stack: Vec<NodeId> = carried.iter().map(|&i| body.next[i]).chain([body.condition]).collect();
        let mut seen = FxHashSet::default();
        while let Some(n) = stack.pop() {
            if !seen.insert(n) {
                continue;
            }
            if !self.graph.is_within(self.graph.scopes[n.0 as usize], l) {
                free.push(n);
                continue;
            }
            match self.graph.node(n) {
                Node::LoopVar(..) => {}
                Node::LoopOut(inner, _) => stack.extend(self.free_nodes(*inner)),
                other => stack.extend(other.operands()),
            }
        }
        free
    }

    fn new_value(&mut self) -> u32 {
        self.value_count += 1;
        self.value_count - 1
    }

    fn constant(&mut self, value: f64) -> Operand {
        let next = self.constants.len() as u32;
        let place = *self.constant_places.entry(value.to_bits()).or_insert(next);
        if place == next {
            self.constants.push(value);
        }
        Operand::Constant(place)
    }

    fn input(&mut self, input: Input) -> Operand {
        if let Some(place) = self.options.varying.iter().position(|v| *v == input) {
            return Operand::Value(place as u32);
        }
        // A place of its own, so that binding the input changes nothing else.
        let place = self.constants.len() as u32;
        self.constants.push(self.options.bindings.get(input));
        self.uniforms.push((input, place));
        Operand::Constant(place)
    }

    fn operand(&self, n: NodeId) -> Operand {
        self.operands[n.0 as usize].unwrap_or(Operand::Constant(0))
    }

    /// The code for `roots`, in an order that keeps few values alive.
    fn block(&mut self, roots: &[NodeId]) -> Vec<Instruction> {
        let mut code = Vec::new();
        let mut stack: Vec<NodeId> = roots.iter().rev().copied().collect();
        while let Some(&n) = stack.last() {
            if self.operands[n.0 as usize].is_some() {
                stack.pop();
                continue;
            }
            let mut missing = match self.graph.node(n) {
                Node::LoopOut(l, _) => self.free_nodes(*l),
                other => other.operands(),
            };
            missing.retain(|o| self.operands[o.0 as usize].is_none());
            if missing.is_empty() {
                stack.pop();
                self.emit(n, &mut code);
            } else {
                // The last one pushed comes first: the neediest.
                missing.sort_by_key(|o| self.needs[o.0 as usize]);
                stack.extend(missing);
            }
        }
        code
    }

    fn emit(&mut self, n: NodeId, code: &mut Vec<Instruction>) {
        let none = Operand::Constant(0);
        let (op, operands) = match self.graph.node(n).clone() {
            Node::Constant(bits) => {
                let operand = self.constant(f64::from_bits(bits));
                self.operands[n.0 as usize] = Some(operand);
                return;
            }
            Node::Input(input) => {
                let operand = self.input(input);
                self.operands[n.0 as usize] = Some(operand);
                return;
            }
            Node::LoopVar(..) => return,
            Node::LoopOut(l, _) => return self.emit_loop(l, code),
            Node::Unary(op, a) => (Op::Unary(op), [self.operand(a), none, none]),
            Node::Powi(a, k) => (Op::Powi(k), [self.operand(a), none, none]),
            Node::Binary(op, a, b) => (Op::Binary(op), [self.operand(a), self.operand(b), none]),
            Node::Select(c, a, b) => (Op::Select, [self.operand(c), self.operand(a), self.operand(b)]),
            Node::Call(function, list) => {
                let list = list.iter().map(|&a| self.operand(a)).collect();
                self.arguments.push(list);
                (Op::Call { function, arguments: self.arguments.len() as u32 - 1 }, [none; 3])
            }
        };
        let result = self.new_value();
        self.operands[n.0 as usize] = Some(Operand::Value(result));
        code.push(Instruction { op, operands, result, sign_only: false });
    }

    fn emit_loop(&mut self, l: LoopId, code: &mut Vec<Instruction>) {
        let source = self.graph.loops[l.0 as usize].clone();
        let kept = self.carried(l);
        let mut fresh = || kept.iter().map(|_| self.new_value()).collect::<Vec<u32>>();
        let (carried, results, waiting) = (fresh(), fresh(), fresh());
        for (n, node) in self.graph.nodes.iter().enumerate() {
            let (id, i, values) = match node {
                Node::LoopVar(id, i) => (id, i, &carried),
                Node::LoopOut(id, i) => (id, i, &results),
                _ => continue,
            };
            let place = kept.iter().position(|k| *k == *i as usize);
            if let Some(place) = place.filter(|_| *id == l) {
                self.operands[n] = Some(Operand::Value(values[place]));
            }
        }
        let initial = kept.iter().map(|&i| self.operand(source.initial[i])).collect();
        let test = self.block(&[source.condition]);
        let next: Vec<NodeId> = kept.iter().map(|&i| source.next[i]).collect();
        let body = self.block(&next);
        let condition = self.operand(source.condition);
        let next = next.iter().map(|&n| self.operand(n)).collect();
        self.loops.push(LoopCode { carried, results, waiting, initial, test, condition, body, next });
        let number = self.loops.len() as u32 - 1;
        let result = self.new_value();
        let none = Operand::Constant(0);
        code.push(Instruction { op: Op::Loop(number), operands: [none; 3], result, sign_only: false });
    }
}
