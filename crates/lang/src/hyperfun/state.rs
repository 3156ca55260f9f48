//! The values of all variables while a program is followed, with the means to take changes back.
//!
//! Both branches of a condition start from the same state, and the body of a loop is followed until it is known what
//! it changes: between [`State::mark`] and [`State::rollback`] every write leaves the old value in a log, so that
//! the cost is that of the changes, however many variables there are.

use fieldstone_field::NodeId;

/// Whether a variable got a value on the way to a place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Assigned {
    No,
    /// On some ways.
    Maybe,
    Yes,
}

impl Assigned {
    /// After two ways that meet.
    pub(super) fn join(self, other: Assigned) -> Assigned {
        if self == other { self } else { Assigned::Maybe }
    }
}

/// The value of a variable or of an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) node: NodeId,
    pub(super) assigned: Assigned,
}

impl Cell {
    pub(super) fn value(node: NodeId) -> Self {
        Self { node, assigned: Assigned::Yes }
    }
}

/// What became of a cell between a mark and its rollback.
#[derive(Clone, Copy)]
pub(super) struct Change {
    pub(super) at: usize,
    pub(super) before: Cell,
    pub(super) after: Cell,
}

/// A place in the log.
#[must_use]
pub(super) struct Mark(usize);

/// Where a call began.
#[must_use]
pub(super) struct Call {
    cells: usize,
    log: usize,
}

#[derive(Default)]
pub(super) struct State {
    cells: Vec<Cell>,
    log: Vec<(usize, Cell)>,
    marks: usize,
}

impl State {
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    pub(super) fn read(&self, at: usize) -> Cell {
        self.cells[at]
    }

    pub(super) fn write(&mut self, at: usize, cell: Cell) {
        let old = std::mem::replace(&mut self.cells[at], cell);
        if self.marks > 0 {
            self.log.push((at, old));
        }
    }

    /// Adds cells behind the others: the variables of an object that is called, or an array of computed length.
    pub(super) fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.cells.extend(cells);
    }

    /// Begins a call: what is pushed from now on goes with it.
    pub(super) fn enter(&self) -> Call {
        Call { cells: self.cells.len(), log: self.log.len() }
    }

    /// Ends a call: its cells are gone, with their history.
    pub(super) fn leave(&mut self, call: Call) {
        self.cells.truncate(call.cells);
        let mut kept = call.log;
        for i in call.log..self.log.len() {
            if self.log[i].0 < call.cells {
                self.log.swap(kept, i);
                kept += 1;
            }
        }
        self.log.truncate(kept);
    }

    pub(super) fn mark(&mut self) -> Mark {
        self.marks += 1;
        Mark(self.log.len())
    }

    /// Keeps what happened since the mark.
    pub(super) fn keep(&mut self, _mark: Mark) {
        self.marks -= 1;
        if self.marks == 0 {
            self.log.clear();
        }
    }

    /// Takes back what happened since the mark, and tells it, by place.
    pub(super) fn rollback(&mut self, mark: Mark) -> Vec<Change> {
        self.marks -= 1;
        let entries = self.log.split_off(mark.0);
        let mut places: Vec<usize> = entries.iter().map(|(at, _)| *at).collect();
        places.sort_unstable();
        places.dedup();
        let after: Vec<Cell> = places.iter().map(|&at| self.cells[at]).collect();
        for (at, old) in entries.into_iter().rev() {
            self.cells[at] = old;
        }
        let changes = places.into_iter().zip(after);
        changes.map(|(at, after)| Change { at, before: self.cells[at], after }).collect()
    }
}
