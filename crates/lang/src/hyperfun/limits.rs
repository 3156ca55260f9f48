//! Limits of following: how much is written out, and how deep.

use super::lower::{Followed, Lowering, Stop};
use super::report::Span;
use crate::diagnostic::Diagnostic;
use fieldstone_field::{Input, Node, NodeId};

/// How many nodes a program may have.
const MAX_NODES: usize = 4_000_000;
/// How many steps may be followed.
const MAX_STEPS: usize = 10_000_000;
/// How deep blocks and calls may lie in each other.
const MAX_DEPTH: usize = 500;
/// How deep calls may lie in each other.
const MAX_CALLS: usize = 200;

impl Lowering<'_, '_> {
    /// Counts work; at its limit following ends.
    pub(super) fn charge(&mut self, steps: usize, span: Span) -> Followed<()> {
        self.steps += steps;
        let (what, limit) = if self.graph.len() > MAX_NODES {
            ("operations", MAX_NODES)
        } else if self.steps > MAX_STEPS {
            ("steps when it is written out", MAX_STEPS)
        } else {
            return Ok(());
        };
        let (label, help) = match self.unrolling {
            Some(_) => (
                "while this loop is written out",
                "a loop whose condition does not depend on the point is written out turn by turn: does this one end?",
            ),
            None => ("here the limit is reached", "objects are written out at each of their calls"),
        };
        let help =
            if self.calls.len() > 1 { format!("{help}; {}", self.chain_of_calls()) } else { help.to_owned() };
        let span = self.unrolling.unwrap_or(span);
        let message = format!("the model has more than {} million {what}", limit / 1_000_000);
        let error = Diagnostic::error(span.range(), message, label);
        self.report.add(error.with_help(help));
        Err(Stop)
    }

    /// Goes into a block.
    pub(super) fn descend(&mut self, span: Span) -> Followed<()> {
        if self.depth >= MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} blocks and calls inside each other");
            self.report.error(span, message, "nested too deep");
            return Err(Stop);
        }
        self.depth += 1;
        Ok(())
    }

    /// Goes into a call.
    pub(super) fn begin_call(&mut self, callee: usize, span: Span) -> Followed<()> {
        if self.calls.len() > MAX_CALLS {
            self.report_depth(callee, span);
            return Err(Stop);
        }
        self.calls.push(callee);
        Ok(())
    }

    /// Reports calls that lie too deep in each other.
    fn report_depth(&mut self, callee: usize, span: Span) {
        let name = &self.objects[callee].name;
        let recursive = self.calls.contains(&callee);
        let message = match recursive {
            true => format!("`{name}` calls itself again and again: {MAX_CALLS} calls inside each other"),
            false => format!("more than {MAX_CALLS} calls inside each other"),
        };
        let chain = self.chain_of_calls();
        let help = match self.guards.last() {
            Some((condition, _)) => format!(
                "{chain}; whether it ends depends on {}, but calls are written out when the file is read: \
                 let a known number end them, or write a loop",
                self.dependence(*condition)
            ),
            None if recursive => format!("{chain}; no condition ends it: count down to a last call"),
            None => chain,
        };
        let error = Diagnostic::error(span.range(), message, "nested too deep");
        self.report.add(error.with_help(help));
    }

    /// Who calls whom, the outermost first, as far as it is told.
    fn chain_of_calls(&self) -> String {
        let names: Vec<String> =
            self.calls.iter().take(4).map(|&object| format!("`{}`", self.objects[object].name)).collect();
        let more = if self.calls.len() > names.len() { " → …" } else { "" };
        format!("the calls are {}{more}", names.join(" → "))
    }

    /// What a node depends on, in words.
    pub(super) fn dependence(&self, node: NodeId) -> String {
        let reachable = self.graph.reachable(&[node]);
        let mut inputs: Vec<Input> = reachable
            .iter()
            .filter_map(|n| match self.graph.node(*n) {
                Node::Input(input) => Some(*input),
                _ => None,
            })
            .collect();
        inputs.sort_unstable();
        let names: Vec<String> = inputs
            .iter()
            .take(4)
            .map(|input| match input {
                Input::Coordinate(i) => format!("`x[{}]`", i + 1),
                Input::Parameter(i) => format!("`a[{}]`", i + 1),
                Input::Time => "the time".to_owned(),
            })
            .collect();
        match names.as_slice() {
            [] => "the turn of a loop".to_owned(),
            [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
            _ => names.concat(),
        }
    }
}
