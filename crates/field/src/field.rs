//! Fields: a program with the outputs that make it a solid.

use crate::defined::clamped_to_domain;
use crate::function::{Closure, Function};
use crate::graph::{Graph, Input, Node, NodeId};
use crate::reference::{self, DEFAULT_FUEL};
use std::sync::Arc;

/// A field: a program whose first output is the value (f < 0 inside) and whose others are attributes.
///
/// Cheap to clone; programs are shared.
#[derive(Clone, Debug)]
pub struct Field {
    graph: Arc<Graph>,
    value: NodeId,
    attributes: Vec<NodeId>,
    fuel: u32,
}

/// Values for the inputs of a field that do not vary over space. What is not set is 0.
#[derive(Clone, Default, Debug, PartialEq)]
pub struct Bindings {
    values: Vec<(Input, f64)>,
}

impl Bindings {
    /// All zero.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets an input.
    pub fn set(&mut self, input: Input, value: f64) {
        match self.values.iter_mut().find(|(i, _)| *i == input) {
            Some(known) => known.1 = value,
            None => self.values.push((input, value)),
        }
    }

    /// The value of an input.
    pub fn get(&self, input: Input) -> f64 {
        self.values.iter().find(|(i, _)| *i == input).map_or(0.0, |(_, v)| *v)
    }
}

impl Field {
    /// A field of a program: `value` is negative inside; `attributes` are what the surface carries (colours first).
    pub fn new(graph: impl Into<Arc<Graph>>, value: NodeId, attributes: Vec<NodeId>) -> Self {
        Self { graph: graph.into(), value, attributes, fuel: DEFAULT_FUEL }
    }

    /// The same field with another number of turns that its data-dependent loops, all together, may take at a point.
    /// Where they would take more, the value is undefined.
    pub fn with_fuel(self, fuel: u32) -> Self {
        Self { fuel, ..self }
    }

    /// How many turns data-dependent loops may take at a point.
    pub fn fuel(&self) -> u32 {
        self.fuel
    }

    /// Whether the value or an attribute comes out of a data-dependent loop.
    pub fn has_loops(&self) -> bool {
        let outputs: Vec<NodeId> =
            std::iter::once(self.value).chain(self.attributes.iter().copied()).collect();
        let nodes = self.graph.reachable(&outputs);
        nodes.into_iter().any(|n| matches!(self.graph.node(n), Node::LoopOut(..)))
    }

    /// A black box: any function of x, y, z that is negative inside.
    ///
    /// Nothing can be proved about it: rays find it by sampling, and their hits are *undecided*.
    pub fn from_fn(value: impl Fn(&[f64]) -> f64 + Send + Sync + 'static) -> Self {
        let mut graph = Graph::new();
        let point = [0, 1, 2].map(|i| graph.input(Input::Coordinate(i)));
        let function: Arc<dyn Function> = Arc::new(Closure { value });
        let value = graph.call(&function, &point);
        Self::new(graph, value, Vec::new())
    }

    /// The program.
    pub fn graph(&self) -> &Arc<Graph> {
        &self.graph
    }

    /// The output that is negative inside.
    pub fn value(&self) -> NodeId {
        self.value
    }

    /// The outputs that the surface carries.
    pub fn attributes(&self) -> &[NodeId] {
        &self.attributes
    }

    /// The value and the attributes at a point by the reference evaluator; NaN where undefined.
    ///
    /// `coordinates` are those of the field's space, as many as it has; the rest comes from `bindings`.
    pub fn at(&self, coordinates: &[f64], bindings: &Bindings) -> Vec<f64> {
        let outputs: Vec<NodeId> =
            std::iter::once(self.value).chain(self.attributes.iter().copied()).collect();
        let input = |i| match i {
            Input::Coordinate(k) if usize::from(k) < coordinates.len() => coordinates[usize::from(k)],
            other => bindings.get(other),
        };
        reference::evaluate(&self.graph, &outputs, (), input, self.fuel)
    }

    /// This field with the operands of partial operations (roots, logarithms, …) clamped to their domains, and a node
    /// of its graph that is 0 where one of them that the value cannot do without lies outside, so that this field is
    /// undefined there, and 1 elsewhere, where both fields are the same. `None`: no such operation.
    pub fn clamped_to_domain(&self) -> Option<(Self, NodeId)> {
        clamped_to_domain(self)
    }

    /// Whether the value calls a function of which nothing but values is known.
    pub fn has_black_box(&self) -> bool {
        self.graph.reachable(&[self.value]).into_iter().any(|n| match self.graph.node(n) {
            Node::Call(f, _) => self.graph.functions[*f as usize].is_black_box(),
            _ => false,
        })
    }

    /// The inputs that the outputs depend on.
    pub fn inputs(&self) -> Vec<Input> {
        let outputs: Vec<NodeId> =
            std::iter::once(self.value).chain(self.attributes.iter().copied()).collect();
        let reachable = self.graph.reachable(&outputs).into_iter();
        let mut inputs: Vec<Input> = reachable
            .filter_map(|n| match self.graph.node(n) {
                Node::Input(i) => Some(*i),
                _ => None,
            })
            .collect();
        inputs.sort();
        inputs
    }

    /// The number of operations that the value needs.
    pub fn operation_count(&self) -> usize {
        let is_operation = |n: &NodeId| !matches!(self.graph.node(*n), Node::Constant(_) | Node::Input(_));
        self.graph.reachable(&[self.value]).iter().filter(|n| is_operation(n)).count()
    }
}
