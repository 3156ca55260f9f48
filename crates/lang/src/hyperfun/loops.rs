//! Branches and loops of the program that is followed.

use super::ast::{Code, Statement};
use super::counted::{self, Count, Parts};
use super::lower::{Followed, Lowering, Stop};
use super::report::Span;
use super::state::{Assigned, Cell, Change};
use crate::diagnostic::Diagnostic;
use fieldstone_field::NodeId;
use fieldstone_field::reference::DEFAULT_FUEL;

/// How many turns of a loop are followed one by one.
const MAX_TURNS: usize = 100_000;

/// How much of a loop is written out. Loops of the graph are evaluated turn by turn at every place, while what is written
/// out is shortened to what matters there: it renders 50 times faster for 100 balls, and more for more. The limits keep
/// reading below a second.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoopLimits {
    /// Operations of the program that is made.
    pub(super) operations: usize,
    /// Numbers that are computed on the way.
    pub(super) constants: usize,
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self { operations: 200_000, constants: 400_000 }
    }
}

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
        let before = self.graph.len();
        for at in places {
            let [yes, no] = [taken, passed].map(|changes| {
                let found = changes.binary_search_by_key(&at, |change| change.at);
                found.map_or(self.state.read(at), |i| changes[i].after)
            });
            let node = self.graph.select(condition, yes.node, no.node);
            self.state.write(at, Cell { node, assigned: yes.assigned.join(no.assigned) });
        }
        self.operations += self.graph.len() - before;
    }

    /// Follows a loop turn by turn while its condition is known and what that writes out stays small; the rest, or the
    /// whole of a long one, becomes a loop of the graph.
    pub(super) fn repeat(&mut self, condition: &'p Code, body: &'p [Statement], span: Span) -> Followed<()> {
        if self.long_loops.contains(&span.start) {
            return self.graph_loop(condition, body, span);
        }
        let outer = self.unrolling;
        let (operations, nodes) = (self.operations, self.graph.len());
        let beginning = self.state.mark();
        for turn in 0.. {
            self.charge(1, span)?;
            let written = self.operations - operations;
            let constants = (self.graph.len() - nodes).saturating_sub(written);
            if written > self.limits.operations || constants > self.limits.constants || turn > MAX_TURNS {
                self.state.rollback(beginning);
                self.unrolling = outer;
                self.long_loops.insert(span.start);
                return self.graph_loop(condition, body, span);
            }
            let mark = self.state.mark();
            let holds = self.condition(condition)?;
            match self.graph.constant_value(holds) {
                Some(0.0) => {
                    self.state.keep(mark);
                    break;
                }
                Some(known) if !known.is_nan() => {
                    self.state.keep(mark);
                    self.unrolling = Some(span);
                    self.block(body, span)?;
                }
                _ => {
                    self.state.rollback(mark);
                    self.state.keep(beginning);
                    self.unrolling = outer;
                    return self.graph_loop(condition, body, span);
                }
            }
        }
        self.state.keep(beginning);
        self.unrolling = outer;
        Ok(())
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
                self.loops.push(span);
                let next: Vec<NodeId> = carried.iter().map(|&at| after(at)).collect();
                let parts = Parts { id, initial: &initial, condition: holds, next: &next };
                let known = self.known_values(&parts, span)?;
                let holds = self.guarded(holds, &guards);
                let mut outputs = self.graph.end_loop(id, holds, &next);
                for (output, value) in outputs.iter_mut().zip(known) {
                    *output = value.map_or(*output, |value| self.graph.constant(value));
                }
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

    /// The carried values after a loop, as far as they depend on numbers alone.
    fn known_values(&mut self, parts: &Parts<'_>, span: Span) -> Followed<Vec<Option<f64>>> {
        match counted::count(&self.graph, parts, &mut self.counting_budget) {
            Count::Unknown => Ok(Vec::new()),
            Count::Known { turns, values } => {
                if turns > DEFAULT_FUEL as usize && values.contains(&None) {
                    let message = format!("this loop turns {turns} times at every point");
                    let label = format!("more than {DEFAULT_FUEL} are not followed");
                    let warning = Diagnostic::warning(span.range(), message, label);
                    self.report.add(warning.with_help("what it computes counts as undefined"));
                }
                Ok(values)
            }
            Count::TooMany(turns) => {
                let message = format!("this loop turns more than {turns} times");
                let error = Diagnostic::error(span.range(), message, "while its turns are counted");
                self.report.add(error.with_help("its condition depends on numbers alone: does it end?"));
                Err(Stop)
            }
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

#[cfg(test)]
mod tests {
    use super::LoopLimits;
    use crate::hyperfun::{HyperFunOptions, read, report::Report};
    use crate::{Dialect, Model};
    use fieldstone_field::{Bindings, Node};

    const NEVER: LoopLimits = LoopLimits { operations: 0, constants: 0 };

    fn model(body: &str, limits: LoopLimits, dialect: Dialect) -> Model {
        let text = format!("my_model(x[3], a[1], s[3]) {{ {body} }}");
        let mut report = Report::default();
        let options = HyperFunOptions { object: None, dialect };
        let model = read(&text, &options, limits, &mut report);
        let warnings = report.into_list();
        model
            .map(|model| Model { warnings: warnings.clone(), ..model })
            .unwrap_or_else(|| panic!("{warnings:?}"))
    }

    fn loop_count(model: &Model) -> usize {
        let nodes = model.field.graph().reachable(&[model.field.value()]);
        let loops = nodes.iter().filter_map(|n| match model.field.graph().node(*n) {
            Node::LoopOut(id, _) => Some(*id),
            _ => None,
        });
        loops.collect::<std::collections::HashSet<_>>().len()
    }

    const BODIES: [&str; 9] = [
        "f = 0; i = 1; while i <= 50 loop f = f + sin(i*x[1])/i; i = i + 1; endloop; my_model = f + i;",
        "array q[20]; i = 1; while i <= 20 loop q[i] = x[1]^i; i = i + 1; endloop; my_model = q[3] + q[20];",
        "array q[9]; i = 1; while i <= 9 loop q[i] = i*i; i = i + 1; endloop; my_model = q[x[3]*4] + q[i - 1];",
        "f = -1; i = 0; while i < 8 loop j = 0; while j < i loop
            f = f | (0.1 - (x[1] - i)^2 - (x[2] - j)^2); j = j + 1; endloop; i = i + 1; endloop; my_model = f;",
        "f = 0; i = 0; while i < 30 loop if i > 20 then f = f + x[2]; else f = f*2 - x[1]; endif; i = i + 1;
            endloop; my_model = f;",
        "f = x[1]; i = 0; if x[2] < 0 then while i < 12 loop f = f*f - 0.5; i = i + 1; endloop; endif;
            my_model = f + i;",
        "array p[3]; p[1] = x[1]; p[2] = x[2]; p[3] = x[3]; i = 0; while i < 40 loop t = hfRotate3DY(p, 0.1*i);
            t = hfShift3D(p, 0.1, 0, 0); i = i + t; endloop; my_model = p[1] + 2*p[2] + 3*p[3] + i;",
        "i = 0; n = 1; while i < 100 loop n = n*1.5 - i; i = i + 1; endloop; my_model = n*x[1];",
        "i = 1; f = 0; while 1/i > 0.01 loop f = f + x[1]/i; i = i + 1; endloop; my_model = f;",
    ];

    #[test]
    fn loops_written_out_or_not_have_the_same_values() {
        let points = [[0.7, -0.4, 1.3], [1.1, 0.2, 0.3], [-0.5, -1.0, 2.0]];
        for dialect in [Dialect::Lenient, Dialect::Strict] {
            for body in BODIES {
                let [short, long] = [LoopLimits::default(), NEVER].map(|limits| model(body, limits, dialect));
                assert_eq!(loop_count(&short), 0, "{body}");
                for point in points {
                    let [a, b] = [&short, &long].map(|model| model.field.at(&point, &Bindings::new())[0]);
                    assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{body}: {a}, {b} at {point:?}");
                }
            }
            let loops = BODIES.map(|body| loop_count(&model(body, NEVER, dialect)));
            assert!(loops.iter().filter(|&&count| count > 0).count() >= 6, "{loops:?}");
        }
    }

    #[test]
    fn what_depends_on_numbers_alone_is_known_after_a_loop() {
        let body = "i = 0; n = 1; f = 0; while i < 100 loop n = n*1.5 - i; f = f + x[1]; i = i + 1; endloop;";
        let known = model(&format!("{body} my_model = n + i;"), NEVER, Dialect::Lenient);
        assert!(known.field.graph().constant_value(known.field.value()).is_some());
        let open = model(&format!("{body} my_model = n + f;"), NEVER, Dialect::Lenient);
        assert_eq!(loop_count(&open), 1);
        let length =
            model(&format!("{body} array q[i]; q[i] = 7; my_model = q[100];"), NEVER, Dialect::Lenient);
        assert_eq!(length.field.at(&[0.0; 3], &Bindings::new()), [-7.0, 0.0, 0.0, 0.0]);
        let parameter = "i = 0; while i < a[1] loop i = i + 1; endloop; my_model = i;";
        assert_eq!(loop_count(&model(parameter, NEVER, Dialect::Lenient)), 1);
    }

    #[test]
    fn long_loops_are_not_written_out() {
        let sum = |turns: &str| {
            format!(
                "f = 0; i = 0; while i < {turns} loop f = f + x[1]*i - f/2; i = i + 1; endloop; my_model = f + i;"
            )
        };
        let long = model(&sum("100000"), LoopLimits::default(), Dialect::Lenient);
        assert_eq!(loop_count(&long), 1);
        assert!(long.field.operation_count() < 20 && long.warnings.is_empty());
        let nested =
            "f = 0; i = 0; while i < 1000 loop j = 0; while j < 1000 loop f = f + x[1]*j - f/i; j = j + 1;
            endloop; i = i + 1; endloop; my_model = f;";
        let nested = model(nested, LoopLimits::default(), Dialect::Lenient);
        assert!((1..=2).contains(&loop_count(&nested)));
        let numbers =
            "n = 0; i = 0; while i < 1000000 loop n = n + i*2 - 1; i = i + 1; endloop; my_model = n + i;";
        let numbers = model(numbers, LoopLimits::default(), Dialect::Lenient);
        assert_eq!(numbers.field.graph().constant_value(numbers.field.value()), Some(-999_999_000_000.0));
        let fuel = model(&sum("1500000"), LoopLimits::default(), Dialect::Lenient);
        assert!(fuel.warnings[0].message.contains("turns 1500000 times at every point"));
    }
}
