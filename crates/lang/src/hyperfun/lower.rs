//! From the parsed program to a field program, by following it symbolically.
//!
//! Every variable and every element of an array holds a node of the graph; an assignment changes which. Objects are
//! written in where they are called. A condition that is known decides which branch is followed; otherwise both are,
//! and what they changed is joined by selects. Loops turn as long as their conditions are known and what they write out
//! stays small; other loops become loops of the graph (`loops`, `counted`).
//!
//! What the C interpreter stops at (in the strict dialect) is gathered in one more variable, [`POISON`]: 0, or
//! undefined after an error. It takes part in branches and loops like any other, and is added to the results.

use super::arrays::Place;
use super::ast::{A, Call, Callee, Code, OWN, Object, S, SlotId, Statement, Step, X};
use super::counted::MAX_OPERATIONS;
use super::library::{Argument, Context};
use super::loops::LoopLimits;
use super::report::{Report, Span};
use super::state::{Assigned, Cell, State};
use super::strict;
use crate::Dialect;
use crate::diagnostic::Diagnostic;
use fieldstone_field::{Graph, Input, LoopId, NodeId};
use std::collections::HashSet;

/// The cell that is undefined after an error of the strict dialect.
pub(super) const POISON: usize = 0;

/// Following ends: the report says why.
pub(super) struct Stop;
pub(super) type Followed<T> = Result<T, Stop>;

/// The program of an object: values in the sign of the file.
pub(super) struct Lowered {
    pub(super) graph: Graph,
    pub(super) value: NodeId,
    pub(super) attributes: Vec<NodeId>,
    /// The loops that became loops of the graph, in the order of the text.
    pub(super) loops: Vec<Span>,
}

/// Follows the object with number `chosen`.
pub(super) fn lower(
    objects: &[Object],
    chosen: usize,
    (dialect, limits): (Dialect, LoopLimits),
    report: &mut Report,
) -> Followed<Lowered> {
    let mut graph = Graph::new();
    let (zero, undefined) = (graph.constant(0.0), graph.constant(f64::NAN));
    let mut lowering = Lowering {
        objects,
        graph,
        dialect,
        state: State::default(),
        stack: Vec::new(),
        frame: Frame { object: &objects[chosen], base: 0, computed: 0 },
        computed: Vec::new(),
        guards: Vec::new(),
        parent: None,
        unrolling: None,
        calls: vec![chosen],
        depth: 0,
        steps: 0,
        operations: 0,
        limits,
        counting_budget: MAX_OPERATIONS,
        long_loops: HashSet::new(),
        loops: Vec::new(),
        zero,
        undefined,
        report,
    };
    lowering.state.push([Cell::value(zero)]);
    let (value, attributes) = lowering.top(chosen)?;
    let mut loops = lowering.loops;
    loops.sort_by_key(|span| span.range().start);
    loops.dedup();
    Ok(Lowered { graph: lowering.graph, value, attributes, loops })
}

/// The object that is being followed, and where its variables begin.
#[derive(Clone, Copy)]
pub(super) struct Frame<'p> {
    pub(super) object: &'p Object,
    pub(super) base: usize,
    /// Where the places of its arrays of computed length begin.
    pub(super) computed: usize,
}

/// A value on the stack.
#[derive(Clone, Copy)]
pub(super) struct Operand {
    pub(super) node: NodeId,
    /// Whether it can only be 0, 1 or undefined.
    pub(super) truth: bool,
}

pub(super) struct Lowering<'p, 'r> {
    pub(super) objects: &'p [Object],
    pub(super) graph: Graph,
    pub(super) dialect: Dialect,
    pub(super) state: State,
    pub(super) stack: Vec<Operand>,
    pub(super) frame: Frame<'p>,
    /// Where the arrays of computed length of the objects that are being followed lie, as far as they are declared.
    pub(super) computed: Vec<Option<Place>>,
    /// The open conditions since the innermost loop of the graph, and which way each went.
    pub(super) guards: Vec<(NodeId, bool)>,
    /// The innermost loop of the graph.
    pub(super) parent: Option<LoopId>,
    /// The innermost loop that is written out turn by turn.
    pub(super) unrolling: Option<Span>,
    /// The objects that are being followed, the outermost first.
    pub(super) calls: Vec<usize>,
    pub(super) depth: usize,
    pub(super) steps: usize,
    /// How many nodes were made that are not numbers.
    pub(super) operations: usize,
    pub(super) limits: LoopLimits,
    /// How many operations may still be spent on counting the turns of loops.
    pub(super) counting_budget: usize,
    /// Where the loops begin that were too long to be written out.
    pub(super) long_loops: HashSet<u32>,
    /// The loops that became loops of the graph.
    pub(super) loops: Vec<Span>,
    pub(super) zero: NodeId,
    pub(super) undefined: NodeId,
    pub(super) report: &'r mut Report,
}

impl<'p> Lowering<'p, '_> {
    fn top(&mut self, chosen: usize) -> Followed<(NodeId, Vec<NodeId>)> {
        let object = &self.objects[chosen];
        let input = |g: &mut Graph, count: usize, make: fn(u16) -> Input| {
            (0..count).map(|i| Cell::value(g.input(make(i as u16)))).collect::<Vec<_>>()
        };
        let x = input(&mut self.graph, object.coordinates, Input::Coordinate);
        let a = input(&mut self.graph, object.parameters, Input::Parameter);
        let s = vec![Cell::value(self.zero); object.attribute_count()];
        let (value, s) = self.run(object, [x, a, s], object.span)?;
        let poison = self.state.read(POISON).node;
        let value = self.graph.add(value, poison);
        let attributes = s[..object.attributes.unwrap_or(0)].iter();
        let attributes = attributes.map(|cell| self.graph.add(cell.node, poison)).collect();
        Ok((value, attributes))
    }

    /// Follows a whole object; returns its value and what s\[\] holds then.
    fn run(
        &mut self,
        object: &'p Object,
        inputs: [Vec<Cell>; 3],
        span: Span,
    ) -> Followed<(NodeId, Vec<Cell>)> {
        let (base, computed) = (self.state.len(), self.computed.len());
        let call = self.state.enter();
        self.state.push(inputs.into_iter().flatten());
        let unassigned = Cell { node: self.undefined, assigned: Assigned::No };
        let size = base + object.size();
        self.state.push(std::iter::repeat_n(unassigned, size - self.state.len()));
        self.computed.resize(computed + object.computed_count(), None);
        let outer = std::mem::replace(&mut self.frame, Frame { object, base, computed });
        self.block(&object.body, span)?;
        let value = self.read_scalar(OWN, object.span);
        let s = self.cells(self.range(S));
        self.frame = outer;
        self.computed.truncate(computed);
        self.state.leave(call);
        Ok((value, s))
    }

    pub(super) fn block(&mut self, statements: &'p [Statement], span: Span) -> Followed<()> {
        self.descend(span)?;
        for statement in statements {
            self.statement(statement)?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn statement(&mut self, statement: &'p Statement) -> Followed<()> {
        match statement {
            Statement::Assign { target, index, value, span } => {
                let value = self.evaluate(value)?;
                match index {
                    None => self.state.write(self.range(*target).start, Cell::value(value)),
                    Some(index) => {
                        let index = self.evaluate(index)?;
                        let before = self.graph.len();
                        self.write_element(*target, index, value, *span)?;
                        self.operations += self.graph.len() - before;
                    }
                }
            }
            Statement::Fill { target, items, span } => self.fill(*target, items, *span)?,
            Statement::Declare { target, length, span } => self.declare(*target, length, *span)?,
            Statement::If { condition, then, otherwise, span } => {
                self.charge(1, *span)?;
                self.branch(condition, [then, otherwise], *span)?;
            }
            Statement::While { condition, body, span } => self.repeat(condition, body, *span)?,
        }
        Ok(())
    }

    /// The value of a code.
    pub(super) fn evaluate(&mut self, code: &'p Code) -> Followed<NodeId> {
        self.run_code(code).map(|operand| operand.node)
    }

    /// A node that is not 0 where the condition holds.
    pub(super) fn condition(&mut self, code: &'p Code) -> Followed<NodeId> {
        let operand = self.run_code(code)?;
        Ok(match self.dialect {
            Dialect::Lenient => operand.node,
            Dialect::Strict => self.truth(operand),
        })
    }

    fn run_code(&mut self, code: &'p Code) -> Followed<Operand> {
        if let Some(last) = code.last() {
            self.charge(code.len(), last.span)?;
        }
        for step in code {
            self.step(step)?;
        }
        Ok(self.pop())
    }

    fn push(&mut self, node: NodeId) {
        self.stack.push(Operand { node, truth: false });
    }

    pub(super) fn pop(&mut self) -> Operand {
        self.stack.pop().unwrap_or(Operand { node: self.undefined, truth: false })
    }

    fn step(&mut self, step: &'p Step) -> Followed<()> {
        use super::ast::Action::*;
        let before = self.graph.len();
        match &step.action {
            Number(value) => {
                let node = self.graph.constant(*value);
                self.push(node);
            }
            Scalar(slot) => {
                let node = self.read_scalar(*slot, step.span);
                self.push(node);
            }
            Element(slot) => {
                let index = self.pop().node;
                let node = self.read_element(*slot, index, step.span)?;
                self.push(node);
            }
            Operator(operator) => self.operator(*operator),
            Call(call) => {
                let node = self.call(call, step.span)?;
                self.push(node);
                if matches!(call.callee, Callee::Object(_)) {
                    // Its own steps were counted.
                    return Ok(());
                }
            }
        }
        let result = self.stack.last().and_then(|operand| self.graph.constant_value(operand.node));
        if result.is_none() {
            self.operations += self.graph.len() - before;
        }
        Ok(())
    }

    fn read_scalar(&mut self, slot: SlotId, span: Span) -> NodeId {
        let cell = self.state.read(self.range(slot).start);
        self.check_assigned(cell, slot, None, span);
        cell.node
    }

    /// Warns where a value may be missing.
    pub(super) fn check_assigned(&mut self, cell: Cell, slot: SlotId, element: Option<usize>, span: Span) {
        if cell.assigned == Assigned::Yes {
            return;
        }
        self.require_value(cell.node);
        let slot = &self.frame.object.slots[slot];
        let name = element.map_or_else(|| slot.name.clone(), |i| format!("{}[{}]", slot.name, i + 1));
        let (message, label) = match cell.assigned {
            Assigned::Maybe => (format!("`{name}` may have no value"), "assigned on some ways only"),
            _ => (format!("`{name}` has no value"), "not assigned before"),
        };
        let warning = Diagnostic::warning(span.range(), message, label);
        self.report.add(warning.with_help("without a value the point is undefined, which counts as outside"));
    }

    fn call(&mut self, call: &'p Call, span: Span) -> Followed<NodeId> {
        match call.callee {
            Callee::Builtin(builtin) => {
                let arguments: Vec<NodeId> = call.arguments.iter().map(|_| self.pop().node).collect();
                let value = builtin.value(&mut self.graph, self.dialect, &arguments);
                if self.dialect == Dialect::Strict
                    && let Some(defined) = builtin.domain(&mut self.graph, &arguments)
                {
                    return Ok(self.checked(strict::Checked { value, defined }));
                }
                Ok(value)
            }
            Callee::Library(function) => self.call_library(function, &call.arguments, span),
            Callee::Object(object) => self.call_object(object, &call.arguments, span),
        }
    }

    fn call_library(
        &mut self,
        function: &'static super::library::Function,
        passed: &[Option<SlotId>],
        span: Span,
    ) -> Followed<NodeId> {
        let mut arguments: Vec<Argument> = Vec::new();
        for array in passed {
            arguments.push(match array {
                None => Argument::Real(self.pop().node),
                Some(slot) => Argument::Array(self.pass_array(*slot, span)?),
            });
        }
        let mut context = Context { graph: &mut self.graph, dialect: self.dialect };
        let value = (function.body)(&mut context, &mut arguments);
        for (array, argument) in passed.iter().zip(arguments) {
            if let (Some(slot), Argument::Array(values)) = (array, argument) {
                self.write_back(*slot, &values);
            }
        }
        Ok(match value {
            Ok(value) => {
                self.require_value(value);
                value
            }
            Err(message) => {
                self.report.error(span, format!("`{}`: {message}", function.name), "in this call");
                self.undefined
            }
        })
    }

    fn call_object(&mut self, callee: usize, passed: &[Option<SlotId>], span: Span) -> Followed<NodeId> {
        let object = &self.objects[callee];
        self.charge(object.size(), span)?;
        let array = |i: usize| passed.get(i).copied().flatten();
        let x = self.copied_array(array(X).unwrap_or(X), object.coordinates, span)?;
        let a = self.copied_array(array(A).unwrap_or(A), object.parameters, span)?;
        let s = match array(S) {
            Some(slot) => self.copied_array(slot, object.attribute_count(), span)?,
            None => vec![Cell::value(self.zero); object.attribute_count()],
        };
        self.begin_call(callee, span)?;
        let (value, s) = self.run(object, [x, a, s], span)?;
        self.calls.pop();
        if let Some(slot) = array(S) {
            let place = self.range(slot).start;
            for (i, cell) in s.into_iter().enumerate() {
                self.state.write(place + i, cell);
            }
        }
        Ok(value)
    }
}
