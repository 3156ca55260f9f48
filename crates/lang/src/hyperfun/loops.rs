//! Branches and loops of the program that is followed.

use super::ast::{Code, Statement};
use super::lower::{Followed, Lowering};
use super::report::Span;
use super::state::{Assigned, Cell, Change};
use fieldstone_field::NodeId;

impl<'p> Lowering<'p, '_> {
    /// Follows the branch that a condition decides for, or both.
    pub(super) fn branch(
        &mut self,
        condition: &'p Code,
        [then, otherwise]: [&'p [Statement]; 2],
        span: Span,
    ) -> Followed<()> {
        let condition = self.condition(condition)?;
        match self.graph.constant_value(condition) {
            Some(known) if !known.is_nan() => self.block(if known != 0.0 { then } else { otherwise }, span),
            _ => {
                let taken = self.side(condition, true, then, span)?;
                let passed = self.side(condition, false, otherwise, span)?;
                self.join(condition, &taken, &passed);
                Ok(())
            }
        }
    }

    /// What one side of a branch changes, by place.
    fn side(
        &mut self,
        condition: NodeId,
        side: bool,
        body: &'p [Statement],
        span: Span,
    ) -> Followed<Vec<Change>> {
        let mark = self.state.mark();
        self.guards.push((condition, side));
        self.block(body, span)?;
        self.guards.pop();
        Ok(self.state.rollback(mark))
    }

    fn join(&mut self, condition: NodeId, taken: &[Change], passed: &[Change]) {
        let mut places: Vec<usize> = taken.iter().chain(passed).map(|change| change.at).collect();
        places.sort_unstable();
        places.dedup();
        for at in places {
            let [yes, no] = [taken, passed].map(|changes| {
                let found = changes.binary_search_by_key(&at, |change| change.at);
                found.map_or(self.state.read(at), |i| changes[i].after)
            });
            let node = self.graph.select(condition, yes.node, no.node);
            self.state.write(at, Cell { node, assigned: yes.assigned.join(no.assigned) });
        }
    }

    /// Follows a loop turn by turn while its condition is known; the rest becomes a loop of the graph.
    pub(super) fn repeat(&mut self, condition: &'p Code, body: &'p [Statement], span: Span) -> Followed<()> {
        let outer = self.unrolling;
        loop {
            self.charge(1, span)?;
            let mark = self.state.mark();
            let holds = self.condition(condition)?;
            match self.graph.constant_value(holds) {
                Some(0.0) => {
                    self.state.keep(mark);
                    self.unrolling = outer;
                    return Ok(());
                }
                Some(known) if !known.is_nan() => {
                    self.state.keep(mark);
                    self.unrolling = Some(span);
                    self.block(body, span)?;
                }
                _ => {
                    self.state.rollback(mark);
                    self.unrolling = outer;
                    return self.graph_loop(condition, body, span);
                }
            }
        }
    }

    /// Makes a loop of the graph, which carries the values that its body changes, and no others.
    ///
    /// Which these are shows only when the body is followed: it begins with none, and every pass carries what the
    /// pass before changed, until a pass changes nothing more. What is not carried has the value from before the loop
    /// in that pass, and keeps it, so that the pass holds for every turn.
    fn graph_loop(&mut self, condition: &'p Code, body: &'p [Statement], span: Span) -> Followed<()> {
        let (parent, guards) = (self.parent, std::mem::take(&mut self.guards));
        let mut carried: Vec<usize> = Vec::new();
        loop {
            let before: Vec<Cell> = carried.iter().map(|&at| self.state.read(at)).collect();
            let initial: Vec<NodeId> = before.iter().map(|cell| cell.node).collect();
            let id = self.graph.begin_loop(&initial, parent);
            self.parent = Some(id);
            let mark = self.state.mark();
            for (k, (&at, cell)) in carried.iter().zip(&before).enumerate() {
                let node = self.graph.loop_var(id, k);
                self.state.write(at, Cell { node, assigned: cell.assigned });
            }
            let holds = self.condition(condition)?;
            self.block(body, span)?;
            let changes = self.state.rollback(mark);
            self.parent = parent;
            let after = |at: usize| {
                changes.binary_search_by_key(&at, |c| c.at).map_or(self.zero, |i| changes[i].after.node)
            };
            let grown: Vec<usize> = changes
                .iter()
                .filter(|c| c.before.node != c.after.node && carried.binary_search(&c.at).is_err())
                .map(|c| c.at)
                .collect();
            if grown.is_empty() {
                let next: Vec<NodeId> = carried.iter().map(|&at| after(at)).collect();
                let holds = self.guarded(holds, &guards);
                let outputs = self.graph.end_loop(id, holds, &next);
                self.finish(&changes, &carried, &outputs);
                self.guards = guards;
                return Ok(());
            }
            // Nothing reads this attempt; it is closed so that the graph has no open loop.
            self.graph.end_loop(id, self.zero, &initial);
            carried.extend(grown);
            carried.sort_unstable();
        }
    }

    /// A condition that fails where the program does not come by: a loop there need not end.
    fn guarded(&mut self, holds: NodeId, guards: &[(NodeId, bool)]) -> NodeId {
        guards.iter().rev().fold(holds, |holds, &(guard, side)| match side {
            true => self.graph.select(guard, holds, self.zero),
            false => self.graph.select(guard, self.zero, holds),
        })
    }

    fn finish(&mut self, changes: &[Change], carried: &[usize], outputs: &[NodeId]) {
        for change in changes {
            let assigned: Assigned = change.before.assigned.join(change.after.assigned);
            let node = match carried.binary_search(&change.at) {
                Ok(k) => outputs[k],
                Err(_) => change.before.node,
            };
            self.state.write(change.at, Cell { node, assigned });
        }
    }
}
