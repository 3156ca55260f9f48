//! Models with constants in the place of inputs.

use super::{PrintError, Syntax};
use crate::hyperfun::library::whole_function;
use crate::model::Model;
use fieldstone_field::{Field, Graph, Input, Node, NodeId};
use std::collections::HashMap;

/// The model in which inputs have these values; parameters that do are none any more.
///
/// # Errors
/// Loops, and functions without a name, for which `syntax` has no words either.
pub(super) fn substitute(
    model: &Model,
    syntax: Syntax,
    values: &[(Input, f64)],
) -> Result<Model, PrintError> {
    let old = model.field.graph();
    let outputs = [&[model.field.value()], model.field.attributes()].concat();
    let mut order = old.reachable(&outputs);
    // A node is made after those that it reads.
    order.sort_unstable();
    let mut graph = Graph::new();
    let mut new: HashMap<NodeId, NodeId> = HashMap::new();
    let mut scratch: Option<Graph> = None;
    for id in order {
        let node = match *old.node(id) {
            Node::Constant(bits) => graph.constant(f64::from_bits(bits)),
            Node::Input(input) => match values.iter().find(|(known, _)| *known == input) {
                Some((_, value)) => graph.constant(*value),
                None => graph.input(input),
            },
            Node::Unary(op, a) => graph.unary(op, new[&a]),
            Node::Powi(a, n) => graph.powi(new[&a], n),
            Node::Binary(op, a, b) => graph.binary(op, new[&a], new[&b]),
            Node::Select(c, a, b) => graph.select(new[&c], new[&a], new[&b]),
            Node::Call(_, ref arguments) => {
                let copy = scratch.get_or_insert_with(|| (**old).clone());
                let called = whole_function(copy, id, arguments);
                let called = called.ok_or(PrintError::Function { name: "a function", syntax })?;
                let arguments: Vec<NodeId> = arguments.iter().map(|a| new[a]).collect();
                graph.call(called.function(), &arguments)
            }
            Node::LoopVar(..) | Node::LoopOut(..) => return Err(PrintError::Loop(syntax)),
        };
        new.insert(id, node);
    }
    let value = new[&outputs[0]];
    let attributes = outputs[1..].iter().map(|id| new[id]).collect();
    let is_open = |input: Input| !values.iter().any(|(known, _)| *known == input);
    let parameters = model.parameters.iter().filter(|p| is_open(p.input)).cloned().collect();
    Ok(Model { field: Field::new(graph, value, attributes), parameters, ..model.clone() })
}
