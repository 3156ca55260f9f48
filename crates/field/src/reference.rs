//! The reference evaluator: one point (or one set) at a time, straight from the graph.
//!
//! Slow and simple; every other evaluator is tested against it.

use crate::graph::{Graph, Input, LoopId, Node, NodeId};
use crate::{Domain, Real};

/// How many turns the data-dependent loops of a program may take at a point before its values count as undefined.
pub const DEFAULT_FUEL: u32 = 1_000_000;

/// Evaluates nodes of a graph; `input` gives the value of every input.
///
/// Over sets, a loop whose condition is open leaves undefined values, where a [`Workspace`](crate::Workspace) joins, and
/// no turns for loops that follow: some value of the set may have taken them all.
pub fn evaluate<D: Domain>(
    graph: &Graph,
    outputs: &[NodeId],
    token: <D::Real as Real>::Token,
    input: impl Fn(Input) -> D,
    fuel: u32,
) -> Vec<D> {
    let mut reference =
        Reference { graph, token, input, fuel, values: vec![None; graph.len()], carried: Vec::new() };
    outputs.iter().map(|&o| reference.value(o)).collect()
}

struct Reference<'g, D: Domain, I> {
    graph: &'g Graph,
    token: <D::Real as Real>::Token,
    input: I,
    /// How many turns are left to all loops together.
    fuel: u32,
    values: Vec<Option<D>>,
    carried: Vec<(LoopId, Vec<D>)>,
}

impl<D: Domain, I: Fn(Input) -> D> Reference<'_, D, I> {
    fn value(&mut self, id: NodeId) -> D {
        let mut stack = vec![id];
        while let Some(&n) = stack.last() {
            if self.values[n.0 as usize].is_some() {
                stack.pop();
                continue;
            }
            let missing: Vec<NodeId> =
                self.reads(n).into_iter().filter(|o| self.values[o.0 as usize].is_none()).collect();
            if missing.is_empty() {
                let value = self.compute(n);
                self.values[n.0 as usize] = Some(value);
                stack.pop();
            } else {
                stack.extend(missing);
            }
        }
        self.known(id)
    }

    fn reads(&self, n: NodeId) -> Vec<NodeId> {
        match self.graph.node(n) {
            Node::LoopOut(l, _) => self.graph.loop_free_nodes(*l),
            other => other.operands(),
        }
    }

    fn known(&self, n: NodeId) -> D {
        self.values[n.0 as usize].unwrap_or_else(|| D::undefined(self.token))
    }

    fn compute(&mut self, n: NodeId) -> D {
        match self.graph.node(n).clone() {
            Node::Constant(bits) => D::constant(self.token, f64::from_bits(bits)),
            Node::Input(i) => (self.input)(i),
            Node::Unary(op, a) => op.apply(self.known(a)),
            Node::Powi(a, n) => self.known(a).powi(n),
            Node::Binary(op, a, b) => op.apply(self.known(a), self.known(b)),
            Node::Select(c, a, b) => self.known(c).select(self.known(a), self.known(b), self.token),
            Node::Call(f, arguments) => {
                let arguments: Vec<D> = arguments.iter().map(|&a| self.known(a)).collect();
                D::call(&*self.graph.functions[f as usize], &arguments, self.token)
            }
            Node::LoopVar(l, i) => self.loop_variable(l, i),
            Node::LoopOut(l, i) => self.run_loop(l)[i as usize],
        }
    }

    fn loop_variable(&self, l: LoopId, i: u32) -> D {
        let carried = self.carried.iter().rev().find(|(id, _)| *id == l);
        carried.map_or_else(|| D::undefined(self.token), |(_, values)| values[i as usize])
    }

    fn run_loop(&mut self, l: LoopId) -> Vec<D> {
        let body = self.graph.loops[l.0 as usize].clone();
        let initial = body.initial.iter().map(|&n| self.known(n)).collect();
        self.carried.push((l, initial));
        loop {
            self.forget_body(l);
            let condition = self.value(body.condition);
            let (may_hold, may_fail) = condition.truth();
            if D::Real::any(condition.is_undefined()) || D::Real::any(may_hold & may_fail) {
                break;
            }
            if D::Real::any(may_fail) {
                self.forget_body(l);
                return self.carried.pop().map(|(_, values)| values).unwrap_or_default();
            }
            let Some(rest) = self.fuel.checked_sub(1) else { break };
            self.fuel = rest;
            let next: Vec<D> = body.next.iter().map(|&n| self.value(n)).collect();
            if let Some(last) = self.carried.last_mut() {
                last.1 = next;
            }
        }
        if D::IS_SET {
            self.fuel = 0;
        }
        self.carried.pop();
        self.forget_body(l);
        vec![D::undefined(self.token); body.next.len()]
    }

    fn forget_body(&mut self, l: LoopId) {
        for n in 0..self.graph.len() {
            if self.graph.is_within(self.graph.scopes[n], l) {
                self.values[n] = None;
            }
        }
    }
}
