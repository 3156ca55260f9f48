//! In which order the operations of a model are written, and which of them get a name.

use super::{PrintError, Printing};
use crate::hyperfun::library::{WholeFunction, whole_function};
use fieldstone_field::{Graph, Node, NodeId};
use std::collections::HashMap;

/// The operations of a model.
pub(super) struct Plan {
    /// Every node that the outputs need, operands before what reads them.
    pub(super) order: Vec<NodeId>,
    /// How often a node is read; the outputs count as one reading.
    uses: HashMap<NodeId, usize>,
    /// How often a node is read as the condition of a selection.
    conditions: HashMap<NodeId, usize>,
    /// The functions that are called as a whole.
    calls: HashMap<NodeId, WholeFunction>,
}

impl Plan {
    /// `repeats` says whether the language writes the operands of a node more than once.
    ///
    /// # Errors
    /// Loops, and functions without a name.
    pub(super) fn new(printing: &Printing<'_>, repeats: impl Fn(&Node) -> bool) -> Result<Self, PrintError> {
        let graph = printing.graph();
        let outputs = printing.outputs();
        let mut order = graph.reachable(&outputs);
        // A node is made after those that it reads.
        order.sort_unstable();
        let mut plan =
            Self { order, uses: HashMap::new(), conditions: HashMap::new(), calls: HashMap::new() };
        outputs.iter().for_each(|output| plan.count(*output, 1));
        let mut scratch: Option<Graph> = None;
        for at in 0..plan.order.len() {
            let id = plan.order[at];
            let node = graph.node(id);
            match node {
                Node::LoopVar(..) | Node::LoopOut(..) => return Err(PrintError::Loop(printing.syntax)),
                Node::Select(condition, ..) => *plan.conditions.entry(*condition).or_default() += 1,
                Node::Call(_, arguments) => {
                    let copy = scratch.get_or_insert_with(|| graph.clone());
                    let unknown = PrintError::Function { name: "a function", syntax: printing.syntax };
                    let called = whole_function(copy, id, arguments).ok_or(unknown)?;
                    plan.calls.insert(id, called);
                }
                _ => {}
            }
            let times = if repeats(node) { 2 } else { 1 };
            node.operands().into_iter().for_each(|operand| plan.count(operand, times));
        }
        Ok(plan)
    }

    fn count(&mut self, id: NodeId, times: usize) {
        *self.uses.entry(id).or_default() += times;
    }

    /// Whether a node is read more than once.
    pub(super) fn is_shared(&self, id: NodeId) -> bool {
        self.uses.get(&id).is_some_and(|uses| *uses > 1)
    }

    /// Whether a node is read once, as a condition.
    pub(super) fn is_condition_only(&self, id: NodeId) -> bool {
        !self.is_shared(id) && self.conditions.get(&id) == Some(&1)
    }

    /// The function that a node calls.
    pub(super) fn called(&self, id: NodeId) -> Option<WholeFunction> {
        self.calls.get(&id).copied()
    }
}
