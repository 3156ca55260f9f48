//! Arrays while a program is followed: where they lie, and their elements by numbers that are known or not.
//!
//! An index that is known picks an element. One that depends on the point becomes a choice among all elements, made by
//! bisection: over sets only the elements that the index may reach are joined, and where it provably lies inside,
//! nothing undefined takes part.

use super::ast::{Code, Extent, SlotId};
use super::builtins::round_half_up;
use super::lower::{Followed, Lowering, Stop};
use super::parser::{MAX_ELEMENTS, wrong_number_of_values};
use super::report::Span;
use super::state::{Assigned, Cell};
use crate::diagnostic::Diagnostic;
use fieldstone_field::NodeId;
use std::ops::Range;

/// Where the elements of an array of computed length lie.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Place {
    start: usize,
    length: usize,
}

enum Index {
    /// The element with this number, counted from 0.
    Known(usize),
    /// The element with the number that this node has, counted from 1.
    Computed(NodeId),
    Outside,
}

impl<'p> Lowering<'p, '_> {
    /// Where the values of a variable lie; nowhere for an array that was not declared on the way.
    pub(super) fn range(&self, slot: SlotId) -> Range<usize> {
        let slot = &self.frame.object.slots[slot];
        let start = self.frame.base + slot.offset;
        match slot.extent {
            Extent::Computed(number) => {
                let place = self.computed.get(self.frame.computed + number).copied().flatten();
                place.map_or(0..0, |place| place.start..place.start + place.length)
            }
            _ => start..self.frame.base + slot.end(),
        }
    }

    /// Where the elements of an array lie, which must have been declared on the way.
    fn elements(&mut self, slot: SlotId, span: Span) -> Followed<Range<usize>> {
        let range = self.range(slot);
        if range.is_empty() {
            let name = &self.frame.object.slots[slot].name;
            let message = format!("`{name}` has no length here");
            let error = Diagnostic::error(span.range(), message, "its declaration was not come by");
            self.report.add(error.with_help("declare it before the `if` or `while`"));
            return Err(Stop);
        }
        Ok(range)
    }

    pub(super) fn cells(&self, range: Range<usize>) -> Vec<Cell> {
        range.map(|at| self.state.read(at)).collect()
    }

    /// Gives an array its length, and new elements unless it has that length already.
    pub(super) fn declare(&mut self, slot: SlotId, length: &'p Code, span: Span) -> Followed<()> {
        let node = self.evaluate(length)?;
        let length = self.known_length(slot, node, span)?;
        let Extent::Computed(number) = self.frame.object.slots[slot].extent else { return Ok(()) };
        let before = self.range(slot);
        if before.len() == length {
            return Ok(());
        }
        // The place is not taken back with a branch: two lengths of one array would need a choice between them.
        if !before.is_empty() && (!self.guards.is_empty() || self.parent.is_some()) {
            let name = &self.frame.object.slots[slot].name;
            let message = format!("the length of `{name}` changes under a condition");
            let error = Diagnostic::error(span.range(), message, format!("it was {} before", before.len()));
            self.report.add(error.with_help("declare it once, with the greater length"));
            return Err(Stop);
        }
        self.charge(length, span)?;
        let place = Place { start: self.state.len(), length };
        let unassigned = Cell { node: self.undefined, assigned: Assigned::No };
        self.state.push(std::iter::repeat_n(unassigned, length));
        let entry = self.frame.computed + number;
        self.computed[entry] = Some(place);
        Ok(())
    }

    fn known_length(&mut self, slot: SlotId, length: NodeId, span: Span) -> Followed<usize> {
        let name = &self.frame.object.slots[slot].name;
        let (message, label, help) = match self.graph.constant_value(length) {
            Some(n) if n.fract() == 0.0 && (1.0..=MAX_ELEMENTS).contains(&n) => return Ok(n as usize),
            Some(n) => (
                match n > MAX_ELEMENTS {
                    true => format!("`{name}` has at most {MAX_ELEMENTS} elements, not {n}"),
                    false => format!("`{name}` cannot have {n} elements"),
                },
                format!("expected a whole number from 1 to {MAX_ELEMENTS}"),
                "lengths are rounded by `floor(…)`",
            ),
            None => (
                format!("the length of `{name}` is not known when the file is read"),
                format!("depends on {}", self.dependence(length)),
                "write a number, or compute it from numbers",
            ),
        };
        self.report.add(Diagnostic::error(span.range(), message, label).with_help(help));
        Err(Stop)
    }

    /// All elements get values.
    pub(super) fn fill(&mut self, slot: SlotId, items: &'p [Code], span: Span) -> Followed<()> {
        let range = self.elements(slot, span)?;
        if range.len() != items.len() {
            let slot = &self.frame.object.slots[slot];
            self.report.add(wrong_number_of_values(slot, range.len(), items.len(), span));
            return Err(Stop);
        }
        for (at, item) in range.zip(items) {
            let value = self.evaluate(item)?;
            self.state.write(at, Cell::value(value));
        }
        Ok(())
    }

    /// The elements that a function of the library receives.
    pub(super) fn pass_array(&mut self, slot: SlotId, span: Span) -> Followed<Vec<NodeId>> {
        let cells = self.elements(slot, span)?;
        let cells = self.cells(cells);
        if let Some(missing) = cells.iter().position(|cell| cell.assigned != Assigned::Yes) {
            self.check_assigned(cells[missing], slot, Some(missing), span);
        }
        Ok(cells.into_iter().map(|cell| cell.node).collect())
    }

    /// Writes the elements that a function of the library changed.
    pub(super) fn write_back(&mut self, slot: SlotId, values: &[NodeId]) {
        for (at, &value) in self.range(slot).zip(values) {
            if self.state.read(at).node != value {
                self.require_value(value);
                self.state.write(at, Cell::value(value));
            }
        }
    }

    /// The elements that an object receives, which must be `length` in number.
    pub(super) fn copied_array(&mut self, slot: SlotId, length: usize, span: Span) -> Followed<Vec<Cell>> {
        let range = self.elements(slot, span)?;
        if range.len() != length {
            let name = &self.frame.object.slots[slot].name;
            let message = format!("`{name}` has {} elements here, not {length}", range.len());
            let error = Diagnostic::error(span.range(), message, format!("expected {length} elements"));
            self.report.add(error.with_help("objects take arrays of exactly the sizes in their headers"));
            return Err(Stop);
        }
        Ok(self.cells(range))
    }

    /// Where an index points.
    fn index(&mut self, slot: SlotId, index: NodeId, span: Span) -> Followed<Index> {
        let length = self.elements(slot, span)?.len();
        let rounded = round_half_up(&mut self.graph, index);
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

    pub(super) fn read_element(&mut self, slot: SlotId, index: NodeId, span: Span) -> Followed<NodeId> {
        let range = self.range(slot);
        match self.index(slot, index, span)? {
            Index::Outside => Ok(self.undefined),
            Index::Known(i) => {
                let cell = self.state.read(range.start + i);
                self.check_assigned(cell, slot, Some(i), span);
                Ok(cell.node)
            }
            Index::Computed(index) => {
                let elements: Vec<NodeId> = self.cells(range).into_iter().map(|cell| cell.node).collect();
                let value = self.element_at(index, &elements);
                let value = self.within(index, elements.len(), value);
                self.require_value(value);
                Ok(value)
            }
        }
    }

    /// The element with the number `index`, a whole number from 1 that lies inside.
    fn element_at(&mut self, index: NodeId, elements: &[NodeId]) -> NodeId {
        let mut level = elements.to_vec();
        // Neighbours are joined, then pairs, and so on; `width` elements lie behind each node of a level.
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

    /// Whether an index, counted from 1, is at most `count`.
    fn is_below(&mut self, index: NodeId, count: usize) -> NodeId {
        let limit = self.graph.constant(count as f64 + 0.5);
        self.graph.lt(index, limit)
    }

    /// `value` where an index, counted from 1, is at most `length`, undefined elsewhere.
    fn within(&mut self, index: NodeId, length: usize, value: NodeId) -> NodeId {
        let (below, inside) = (self.is_below(index, 0), self.is_below(index, length));
        let value = self.graph.select(inside, value, self.undefined);
        self.graph.select(below, self.undefined, value)
    }

    /// Writes an element. An index that lies outside at some point changes nothing there (strict: is an error).
    pub(super) fn write_element(
        &mut self,
        slot: SlotId,
        index: NodeId,
        value: NodeId,
        span: Span,
    ) -> Followed<()> {
        let range = self.range(slot);
        match self.index(slot, index, span)? {
            Index::Outside => {}
            Index::Known(i) => self.state.write(range.start + i, Cell::value(value)),
            Index::Computed(index) => {
                for (i, at) in range.clone().enumerate() {
                    let number = self.graph.constant((i + 1) as f64);
                    let hit = self.graph.eq(index, number);
                    let old = self.state.read(at);
                    let new = self.graph.select(hit, value, old.node);
                    self.state.write(at, Cell::value(new));
                }
                let inside = self.within(index, range.len(), self.zero);
                self.require_value(inside);
            }
        }
        Ok(())
    }
}
