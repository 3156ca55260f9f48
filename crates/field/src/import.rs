//! Copies of programs inside others, with something else in the place of their inputs.

use crate::graph::{Graph, Input, LoopId, Node, NodeId};
use rustc_hash::FxHashMap;

impl Graph {
    /// Copies a program into this one; `input` says what stands in the place of each input that it reads.
    ///
    /// This is how solids are composed and moved: a rotated solid is its program with rotated coordinates in the place
    /// of x, y and z. Returns the copies of `outputs`, in their order. What becomes constant is folded, and what exists
    /// is not made again.
    pub fn import(
        &mut self,
        program: &Graph,
        outputs: &[NodeId],
        input: impl FnMut(&mut Graph, Input) -> NodeId,
    ) -> Vec<NodeId> {
        let mut order = program.reachable(outputs);
        // A node is made after those that it reads.
        order.sort_unstable();
        let mut import =
            Import { program, into: self, input, nodes: FxHashMap::default(), loops: FxHashMap::default() };
        for id in order {
            let copy = import.copy(id);
            import.nodes.insert(id, copy);
        }
        outputs.iter().map(|id| import.nodes[id]).collect()
    }
}

/// A program on its way into another.
struct Import<'g, F> {
    program: &'g Graph,
    into: &'g mut Graph,
    input: F,
    nodes: FxHashMap<NodeId, NodeId>,
    loops: FxHashMap<LoopId, OpenLoop>,
}

/// A loop of the program that has begun in the other one.
struct OpenLoop {
    id: LoopId,
    /// The copies of the carried values after the loop, once it is closed.
    results: Vec<NodeId>,
}

impl<F: FnMut(&mut Graph, Input) -> NodeId> Import<'_, F> {
    fn copy(&mut self, id: NodeId) -> NodeId {
        let new = |n: &NodeId| self.nodes[n];
        match self.program.node(id) {
            Node::Constant(bits) => self.into.constant(f64::from_bits(*bits)),
            Node::Input(input) => (self.input)(self.into, *input),
            Node::Unary(op, a) => self.into.unary(*op, new(a)),
            Node::Powi(a, n) => self.into.powi(new(a), *n),
            Node::Binary(op, a, b) => self.into.binary(*op, new(a), new(b)),
            Node::Select(c, a, b) => self.into.select(new(c), new(a), new(b)),
            Node::Call(function, arguments) => {
                let arguments: Vec<NodeId> = arguments.iter().map(new).collect();
                self.into.call(&self.program.functions[*function as usize], &arguments)
            }
            Node::LoopVar(l, index) => {
                let id = self.open(*l);
                self.into.loop_var(id, *index as usize)
            }
            Node::LoopOut(l, index) => {
                let id = self.open(*l);
                let turn = &self.program.loops[l.0 as usize];
                if self.loops[l].results.is_empty() {
                    let next: Vec<NodeId> = turn.next.iter().map(|n| self.nodes[n]).collect();
                    let results = self.into.end_loop(id, self.nodes[&turn.condition], &next);
                    self.loops.insert(*l, OpenLoop { id, results });
                }
                self.loops[l].results[*index as usize]
            }
        }
    }

    /// The copy of a loop, which begins now if it has not begun; the values that it starts from are there.
    fn open(&mut self, l: LoopId) -> LoopId {
        if let Some(open) = self.loops.get(&l) {
            return open.id;
        }
        let known = &self.program.loops[l.0 as usize];
        let initial: Vec<NodeId> = known.initial.iter().map(|n| self.nodes[n]).collect();
        // A loop around this one on which nothing in it depends may not be part of what is copied.
        let reached = |parent: &LoopId| {
            let around = &self.program.loops[parent.0 as usize];
            around.initial.iter().all(|n| self.nodes.contains_key(n))
        };
        let parent = known.parent.filter(reached).map(|parent| self.open(parent));
        let id = self.into.begin_loop(&initial, parent);
        self.loops.insert(l, OpenLoop { id, results: Vec::new() });
        id
    }
}

#[cfg(test)]
mod tests {
    use crate::{Bindings, Field, Graph, Input, NodeId};

    /// Newton's iteration for √x inside a loop that adds them up for x, x + 1, …, x + 3, times a parameter.
    fn nested() -> (Graph, NodeId) {
        let mut g = Graph::new();
        let [x, p] = [Input::Coordinate(0), Input::Parameter(0)].map(|i| g.input(i));
        let [zero, one, half, four, small] = [0.0, 1.0, 0.5, 4.0, 1e-9].map(|c| g.constant(c));
        let outer = g.begin_loop(&[zero, zero], None);
        let [k, sum] = [0, 1].map(|i| g.loop_var(outer, i));
        let radicand = g.add(x, k);
        let inner = g.begin_loop(&[radicand], Some(outer));
        let guess = g.loop_var(inner, 0);
        let square = g.mul(guess, guess);
        let error = g.sub(square, radicand);
        let size = g.abs(error);
        let go_on = g.lt(small, size);
        let quotient = g.div(radicand, guess);
        let both = g.add(guess, quotient);
        let better = g.mul(half, both);
        let root = g.end_loop(inner, go_on, &[better])[0];
        let (next_k, next_sum) = (g.add(k, one), g.add(sum, root));
        let more = g.lt(k, four);
        let total = g.end_loop(outer, more, &[next_k, next_sum])[1];
        let result = g.mul(total, p);
        (g, result)
    }

    #[test]
    fn copies_have_the_values_of_the_original_at_what_replaces_the_inputs() {
        let (program, output) = nested();
        let mut bindings = Bindings::new();
        bindings.set(Input::Parameter(0), 3.0);
        let original = Field::new(program.clone(), output, Vec::new());
        let mut graph = Graph::new();
        let y = graph.input(Input::Coordinate(1));
        let two = graph.constant(2.0);
        let copy = graph.import(&program, &[output, output], |g, input| match input {
            Input::Coordinate(_) => g.add(y, two),
            _ => g.constant(3.0),
        });
        assert_eq!(copy[0], copy[1]);
        let copy = Field::new(graph, copy[0], Vec::new());
        for y in [0.25, 1.0, 7.5] {
            let expected = 3.0 * (0..4).map(|k| (y + 2.0 + f64::from(k)).sqrt()).sum::<f64>();
            let [a, b] = [copy.at(&[0.0, y], &Bindings::new())[0], original.at(&[y + 2.0], &bindings)[0]];
            assert_eq!(a, b);
            assert!((a - expected).abs() < 1e-8, "{a} {expected}");
        }
        assert_eq!(copy.inputs(), [Input::Coordinate(1)]);
    }

    #[test]
    fn a_copy_with_the_same_inputs_makes_nothing_new() {
        let mut program = Graph::new();
        let [x, y] = [0, 1].map(|i| program.input(Input::Coordinate(i)));
        let sum = program.add(x, y);
        let root = program.sqrt(sum);
        let mut graph = program.clone();
        assert_eq!(graph.import(&program, &[root], |g, i| g.input(i)), [root]);
        assert_eq!(graph.len(), program.len());
    }

    #[test]
    fn what_becomes_known_is_folded() {
        let mut program = Graph::new();
        let x = program.input(Input::Coordinate(0));
        let root = program.sqrt(x);
        let mut graph = Graph::new();
        let copy = graph.import(&program, &[root], |g, _| g.constant(9.0))[0];
        assert_eq!(graph.constant_value(copy), Some(3.0));
    }
}
