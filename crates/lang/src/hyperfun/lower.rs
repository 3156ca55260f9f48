//! From the parsed program to a field program, by following it symbolically.
//!
//! Every variable and every element of an array holds a node of the graph; an assignment changes which. Objects are
//! written in where they are called. A condition that is known decides which branch is followed; otherwise both are,
//! and what they changed is joined by selects (`branches`). Loops turn as long as their conditions are known, the
//! rest becomes a loop of the graph (`loops`).
//!
//! What the C interpreter stops at (in the strict dialect) is gathered in one more variable, [`POISON`]: 0, or
//! undefined after an error. It takes part in branches and loops like any other, and is added to the results.

use super::ast::{A, Call, Callee, Code, OWN, Object, Operator, S, SlotId, Statement, Step, X};
use super::library::{Argument, Context};
use super::report::{Report, Span};
use super::state::{Assigned, Cell, State};
use super::strict;
use crate::Dialect;
use crate::diagnostic::Diagnostic;
use fieldstone_field::{Graph, Input, LoopId, NodeId};

/// How many nodes a program may have.
const MAX_NODES: usize = 4_000_000;
/// How many steps may be followed.
const MAX_STEPS: usize = 30_000_000;
/// How deep blocks and calls may lie in each other.
const MAX_DEPTH: usize = 400;
/// The cell that is undefined after an error of the strict dialect.
const POISON: usize = 0;

/// Following ends: the report says why.
pub(super) struct Stop;
pub(super) type Followed<T> = Result<T, Stop>;

/// The program of an object: values in the sign of the file.
pub(super) struct Lowered {
    pub(super) graph: Graph,
    pub(super) value: NodeId,
    pub(super) attributes: Vec<NodeId>,
}

/// Follows the object with number `chosen`.
pub(super) fn lower(
    objects: &[Object],
    chosen: usize,
    dialect: Dialect,
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
        frame: Frame { object: &objects[chosen], base: 0 },
        guards: Vec::new(),
        parent: None,
        unrolling: None,
        depth: 0,
        steps: 0,
        zero,
        undefined,
        report,
    };
    lowering.state.push([Cell::value(zero)]);
    let (value, attributes) = lowering.top(chosen)?;
    Ok(Lowered { graph: lowering.graph, value, attributes })
}

/// The object that is being followed, and where its variables begin.
#[derive(Clone, Copy)]
pub(super) struct Frame<'p> {
    pub(super) object: &'p Object,
    base: usize,
}

/// A value on the stack.
#[derive(Clone, Copy)]
struct Operand {
    node: NodeId,
    /// Whether it can only be 0, 1 or undefined.
    truth: bool,
}

pub(super) struct Lowering<'p, 'r> {
    objects: &'p [Object],
    pub(super) graph: Graph,
    dialect: Dialect,
    pub(super) state: State,
    stack: Vec<Operand>,
    frame: Frame<'p>,
    /// The open conditions since the innermost loop of the graph, and which way each went.
    pub(super) guards: Vec<(NodeId, bool)>,
    /// The innermost loop of the graph.
    pub(super) parent: Option<LoopId>,
    /// The innermost loop that is written out turn by turn.
    pub(super) unrolling: Option<Span>,
    depth: usize,
    steps: usize,
    pub(super) zero: NodeId,
    undefined: NodeId,
    report: &'r mut Report,
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
        let base = self.state.len();
        self.state.push(inputs.into_iter().flatten());
        let unassigned = Cell { node: self.undefined, assigned: Assigned::No };
        let size = base + object.size();
        self.state.push(std::iter::repeat_n(unassigned, size - self.state.len()));
        let outer = std::mem::replace(&mut self.frame, Frame { object, base });
        self.block(&object.body, span)?;
        let value = self.read_scalar(OWN, object.span);
        let s = self.cells(S);
        self.frame = outer;
        self.state.truncate(base);
        Ok((value, s))
    }

    pub(super) fn block(&mut self, statements: &'p [Statement], span: Span) -> Followed<()> {
        if self.depth >= MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} blocks and calls inside each other");
            self.report.error(span, message, "nested too deep");
            return Err(Stop);
        }
        self.depth += 1;
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
                    None => self.state.write(self.place(*target), Cell::value(value)),
                    Some(index) => {
                        let index = self.evaluate(index)?;
                        self.write_element(*target, index, value, *span)?;
                    }
                }
            }
            Statement::Fill { target, items } => {
                for (i, item) in items.iter().enumerate() {
                    let value = self.evaluate(item)?;
                    self.state.write(self.place(*target) + i, Cell::value(value));
                }
            }
            Statement::If { condition, then, otherwise, span } => {
                self.charge(1, *span)?;
                self.branch(condition, [then, otherwise], *span)?;
            }
            Statement::While { condition, body, span } => self.repeat(condition, body, *span)?,
        }
        Ok(())
    }

    /// Counts work; at its limit following ends.
    pub(super) fn charge(&mut self, steps: usize, span: Span) -> Followed<()> {
        self.steps += steps;
        let (what, limit) = if self.graph.len() > MAX_NODES {
            ("operations", MAX_NODES)
        } else if self.steps > MAX_STEPS {
            ("steps", MAX_STEPS)
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
        let span = self.unrolling.unwrap_or(span);
        let error = Diagnostic::error(span.range(), format!("the model has more than {limit} {what}"), label);
        self.report.add(error.with_help(help));
        Err(Stop)
    }

    /// Where the values of a variable begin.
    fn place(&self, slot: SlotId) -> usize {
        self.frame.base + self.frame.object.slots[slot].offset
    }

    fn length(&self, slot: SlotId) -> usize {
        self.frame.object.slots[slot].length.unwrap_or(1)
    }

    fn cells(&self, slot: SlotId) -> Vec<Cell> {
        let place = self.place(slot);
        (place..place + self.length(slot)).map(|at| self.state.read(at)).collect()
    }

    /// The value of a code.
    fn evaluate(&mut self, code: &'p Code) -> Followed<NodeId> {
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

    fn pop(&mut self) -> Operand {
        self.stack.pop().unwrap_or(Operand { node: self.undefined, truth: false })
    }

    fn step(&mut self, step: &'p Step) -> Followed<()> {
        use super::ast::Action::*;
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
            }
        }
        Ok(())
    }

    fn read_scalar(&mut self, slot: SlotId, span: Span) -> NodeId {
        let cell = self.state.read(self.place(slot));
        self.check_assigned(cell, slot, None, span);
        cell.node
    }

    /// Warns where a value may be missing.
    fn check_assigned(&mut self, cell: Cell, slot: SlotId, element: Option<usize>, span: Span) {
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
            Callee::Library(function) => Ok(self.call_library(function, &call.arguments, span)),
            Callee::Object(object) => self.call_object(object, &call.arguments, span),
        }
    }

    fn call_library(
        &mut self,
        function: &'static super::library::Function,
        passed: &[Option<SlotId>],
        span: Span,
    ) -> NodeId {
        let mut arguments: Vec<Argument> = Vec::new();
        for array in passed {
            arguments.push(match array {
                None => Argument::Real(self.pop().node),
                Some(slot) => Argument::Array(self.pass_array(*slot, span)),
            });
        }
        let mut context = Context { graph: &mut self.graph, dialect: self.dialect };
        let value = (function.body)(&mut context, &mut arguments);
        for (array, argument) in passed.iter().zip(arguments) {
            if let (Some(slot), Argument::Array(values)) = (array, argument) {
                self.write_back(*slot, &values);
            }
        }
        match value {
            Ok(value) => {
                self.require_value(value);
                value
            }
            Err(message) => {
                self.report.error(span, format!("`{}`: {message}", function.name), "in this call");
                self.undefined
            }
        }
    }

    fn pass_array(&mut self, slot: SlotId, span: Span) -> Vec<NodeId> {
        let cells = self.cells(slot);
        if let Some(missing) = cells.iter().position(|cell| cell.assigned != Assigned::Yes) {
            self.check_assigned(cells[missing], slot, Some(missing), span);
        }
        cells.into_iter().map(|cell| cell.node).collect()
    }

    /// Writes the elements that a call changed.
    fn write_back(&mut self, slot: SlotId, values: &[NodeId]) {
        let place = self.place(slot);
        for (i, &value) in values.iter().take(self.length(slot)).enumerate() {
            if self.state.read(place + i).node != value {
                self.require_value(value);
                self.state.write(place + i, Cell::value(value));
            }
        }
    }

    fn call_object(&mut self, callee: usize, passed: &[Option<SlotId>], span: Span) -> Followed<NodeId> {
        let object = &self.objects[callee];
        self.charge(object.size(), span)?;
        let array = |i: usize| passed.get(i).copied().flatten();
        let x = self.cells(array(X).unwrap_or(X));
        let a = self.cells(array(A).unwrap_or(A));
        let s = match array(S) {
            Some(slot) => self.cells(slot),
            None => vec![Cell::value(self.zero); object.attribute_count()],
        };
        let (value, s) = self.run(object, [x, a, s], span)?;
        if let Some(slot) = array(S) {
            for (i, cell) in s.into_iter().enumerate() {
                self.state.write(self.place(slot) + i, cell);
            }
        }
        Ok(value)
    }

    /// Where an index points.
    fn index(&mut self, slot: SlotId, index: NodeId, span: Span) -> Followed<Index> {
        let length = self.length(slot);
        let rounded = super::builtins::round_half_up(&mut self.graph, index);
        let Some(value) = self.graph.constant_value(rounded) else {
            self.charge(length, span)?;
            return Ok(Index::Computed(rounded));
        };
        if (1.0..=length as f64).contains(&value) {
            return Ok(Index::Known(value as usize - 1));
        }
        if !value.is_nan() {
            let name = &self.frame.object.slots[slot].name;
            let message = format!("the index {value} lies outside of `{name}`");
            self.report.error(span, message, format!("expected an index from 1 to {length}"));
            if self.report.is_full() {
                return Err(Stop);
            }
        }
        self.require_value(self.undefined);
        Ok(Index::Outside)
    }

    fn read_element(&mut self, slot: SlotId, index: NodeId, span: Span) -> Followed<NodeId> {
        match self.index(slot, index, span)? {
            Index::Outside => Ok(self.undefined),
            Index::Known(i) => {
                let cell = self.state.read(self.place(slot) + i);
                self.check_assigned(cell, slot, Some(i), span);
                Ok(cell.node)
            }
            Index::Computed(index) => {
                let elements: Vec<NodeId> = self.cells(slot).into_iter().map(|cell| cell.node).collect();
                let value = self.element_at(index, &elements);
                let value = self.within(index, elements.len(), value);
                self.require_value(value);
                Ok(value)
            }
        }
    }

    /// The element with the number `index`, a whole number that lies inside, by bisection: over sets only elements
    /// that the index may reach are joined.
    fn element_at(&mut self, index: NodeId, elements: &[NodeId]) -> NodeId {
        let mut level = elements.to_vec();
        // Halves of size 1, 2, 4, … are joined; `width` is the number of elements behind each node of a level.
        let mut width = 1;
        while level.len() > 1 {
            let pairs = level.chunks(2).enumerate();
            level = pairs
                .map(|(k, pair)| match *pair {
                    [low, high] => {
                        let is_low = self.is_below(index, (2 * k + 1) * width);
                        self.graph.select(is_low, low, high)
                    }
                    _ => pair[0],
                })
                .collect();
            width *= 2;
        }
        level.first().copied().unwrap_or(self.undefined)
    }

    /// Whether an index, counted from 1, is one of the first `count`.
    fn is_below(&mut self, index: NodeId, count: usize) -> NodeId {
        let limit = self.graph.constant(count as f64 + 0.5);
        self.graph.lt(index, limit)
    }

    /// `value` where an index, counted from 1, is one of the first `length`, undefined elsewhere.
    fn within(&mut self, index: NodeId, length: usize, value: NodeId) -> NodeId {
        let (below, inside) = (self.is_below(index, 0), self.is_below(index, length));
        let value = self.graph.select(inside, value, self.undefined);
        self.graph.select(below, self.undefined, value)
    }

    fn is_index(&mut self, index: NodeId, element: usize) -> NodeId {
        let number = self.graph.constant((element + 1) as f64);
        self.graph.eq(index, number)
    }

    /// Writes an element. An index that lies outside at some point changes nothing there (strict: is an error).
    fn write_element(&mut self, slot: SlotId, index: NodeId, value: NodeId, span: Span) -> Followed<()> {
        let place = self.place(slot);
        match self.index(slot, index, span)? {
            Index::Outside => {}
            Index::Known(i) => self.state.write(place + i, Cell::value(value)),
            Index::Computed(index) => {
                let length = self.length(slot);
                for i in 0..length {
                    let hit = self.is_index(index, i);
                    let old = self.state.read(place + i);
                    let new = self.graph.select(hit, value, old.node);
                    self.state.write(place + i, Cell::value(new));
                }
                let inside = self.within(index, length, self.zero);
                self.require_value(inside);
            }
        }
        Ok(())
    }

    fn operator(&mut self, operator: Operator) {
        use Operator::*;
        let first = self.pop();
        let operand = match operator {
            Negate => Operand { node: self.graph.neg(first.node), truth: false },
            Not => Operand { node: self.not(first), truth: true },
            And | Or => {
                let second = self.pop();
                Operand { node: self.logic(operator, first, second), truth: true }
            }
            Equal | Unequal | Less | LessEqual | Greater | GreaterEqual => {
                let second = self.pop().node;
                Operand { node: self.relation(operator, first.node, second), truth: true }
            }
            _ => {
                let second = self.pop().node;
                Operand { node: self.arithmetic(operator, first.node, second), truth: false }
            }
        };
        self.stack.push(operand);
    }

    fn not(&mut self, a: Operand) -> NodeId {
        match self.dialect {
            Dialect::Strict if !a.truth => strict::is_small(&mut self.graph, a.node),
            _ => self.graph.not(a.node),
        }
    }

    /// 1 where a value counts as true, 0 where it does not.
    fn truth(&mut self, a: Operand) -> NodeId {
        if a.truth {
            return a.node;
        }
        match self.dialect {
            Dialect::Strict => strict::is_not_small(&mut self.graph, a.node),
            Dialect::Lenient => {
                let not = self.graph.not(a.node);
                self.graph.not(not)
            }
        }
    }

    /// Both sides count, even where one would decide: an undefined one makes the result undefined.
    fn logic(&mut self, operator: Operator, a: Operand, b: Operand) -> NodeId {
        let (a, b) = (self.truth(a), self.truth(b));
        // Truth values are 0 or 1: the smaller and the larger are exact over intervals too, and hand on what is undefined.
        match (operator, self.graph.constant_value(a), self.graph.constant_value(b)) {
            (Operator::And, ..) => self.graph.min(a, b),
            (_, Some(0.0), _) => b,
            (_, _, Some(0.0)) => a,
            _ => self.graph.max(a, b),
        }
    }

    fn relation(&mut self, operator: Operator, a: NodeId, b: NodeId) -> NodeId {
        match operator {
            Operator::Less => self.graph.lt(a, b),
            Operator::LessEqual => self.graph.le(a, b),
            Operator::Greater => self.graph.lt(b, a),
            Operator::GreaterEqual => self.graph.le(b, a),
            _ => {
                let equal = match self.dialect {
                    Dialect::Lenient => self.graph.eq(a, b),
                    Dialect::Strict => strict::equal(&mut self.graph, a, b),
                };
                if operator == Operator::Unequal { self.graph.not(equal) } else { equal }
            }
        }
    }

    fn arithmetic(&mut self, operator: Operator, a: NodeId, b: NodeId) -> NodeId {
        let graph = &mut self.graph;
        match (operator, self.dialect) {
            (Operator::Add, _) => graph.add(a, b),
            (Operator::Subtract, _) => graph.sub(a, b),
            (Operator::Multiply, _) => graph.mul(a, b),
            (Operator::Union, _) => graph.rmax(a, b),
            (Operator::Difference, _) => {
                let outside = graph.neg(b);
                graph.rmin(a, outside)
            }
            (Operator::Divide, Dialect::Lenient) => graph.div(a, b),
            (Operator::Divide, Dialect::Strict) => {
                let quotient = strict::divide(graph, a, b);
                self.checked(quotient)
            }
            (Operator::Power, Dialect::Lenient) => graph.pow(a, b),
            (Operator::Power, Dialect::Strict) => {
                let power = strict::power(graph, a, b);
                self.checked(power)
            }
            // The Cartesian product is the intersection of sets that depend on different coordinates.
            _ => graph.rmin(a, b),
        }
    }

    /// A value of the strict dialect: undefined, and an error of the whole point, where the interpreter stops.
    fn checked(&mut self, checked: strict::Checked) -> NodeId {
        let poison = self.state.read(POISON).node;
        let after = self.graph.select(checked.defined, poison, self.undefined);
        if after != poison {
            self.state.write(POISON, Cell::value(after));
        }
        self.graph.select(checked.defined, checked.value, self.undefined)
    }

    /// In the strict dialect, an undefined value is an error of the whole point, even if nothing uses it.
    fn require_value(&mut self, value: NodeId) {
        if self.dialect == Dialect::Strict {
            // 0, or undefined where the value is: over sets too.
            let negative = self.graph.min(value, self.zero);
            let nothing = self.graph.max(negative, self.zero);
            let poison = self.state.read(POISON).node;
            let after = self.graph.add(poison, nothing);
            if after != poison {
                self.state.write(POISON, Cell::value(after));
            }
        }
    }
}

enum Index {
    /// The element with this number, counted from 0.
    Known(usize),
    /// The element with the number that this node has, counted from 1.
    Computed(NodeId),
    Outside,
}
