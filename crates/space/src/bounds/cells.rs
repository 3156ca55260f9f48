//! Boxes of a search.

use std::cmp::Ordering;

/// A box.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Cell {
    pub(super) lo: [f64; 3],
    pub(super) hi: [f64; 3],
}

/// A box around points, with a point on each of its sides: −x, +x, −y, +y, −z, +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    pub(super) cell: Cell,
    pub(super) outermost: [[f64; 3]; 6],
}

impl Cell {
    /// The axis of the longest side, and its length.
    pub(super) fn longest_side(&self) -> (usize, f64) {
        let length = |axis: usize| self.hi[axis] - self.lo[axis];
        (1..3).fold(
            (0, length(0)),
            |best, axis| if length(axis) > best.1 { (axis, length(axis)) } else { best },
        )
    }

    pub(super) fn centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * (self.lo[axis] + self.hi[axis]))
    }

    /// 64 points, the middles of equal parts.
    pub(super) fn samples(&self) -> [[f64; 3]; 64] {
        std::array::from_fn(|i| {
            [0, 1, 2].map(|axis| {
                let part = ((i >> (2 * axis)) & 3) as f64;
                self.lo[axis] + (self.hi[axis] - self.lo[axis]) * (part + 0.5) * 0.25
            })
        })
    }

    fn covers(&self, other: &Cell, axis: usize) -> bool {
        self.lo[axis] <= other.lo[axis] && other.hi[axis] <= self.hi[axis]
    }

    /// The smallest box around what `hull` does not cover; nothing if it covers everything.
    pub(super) fn outside(&self, hull: &Cell) -> Option<Cell> {
        let open: Vec<usize> = (0..3).filter(|&axis| !hull.covers(self, axis)).collect();
        let &[axis] = open.as_slice() else {
            return (!open.is_empty()).then_some(*self);
        };
        let mut left = *self;
        if hull.lo[axis] <= left.lo[axis] {
            left.lo[axis] = left.lo[axis].max(hull.hi[axis]);
        } else if hull.hi[axis] >= left.hi[axis] {
            left.hi[axis] = left.hi[axis].min(hull.lo[axis]);
        }
        Some(left)
    }

    /// Two parts: along a side of `hull` that cuts the cell well, otherwise in the middle of the longest side.
    pub(super) fn divided(&self, hull: Option<&Cell>) -> [Cell; 2] {
        let (longest, length) = self.longest_side();
        let cuts_well = |&(axis, at): &(usize, f64)| {
            let (lo, hi) = (self.lo[axis], self.hi[axis]);
            let room = 0.125 * (hi - lo);
            hi - lo > 0.25 * length && lo + room < at && at < hi - room
        };
        let sides =
            hull.into_iter().flat_map(|h| (0..3).flat_map(|axis| [(axis, h.lo[axis]), (axis, h.hi[axis])]));
        let (axis, at) = sides.into_iter().find(cuts_well).unwrap_or((longest, self.centre()[longest]));
        let (mut below, mut above) = (*self, *self);
        below.hi[axis] = at;
        above.lo[axis] = at;
        [below, above]
    }

    fn order(&self) -> impl Iterator<Item = f64> {
        self.lo.into_iter().chain(self.hi)
    }
}

// Any order will do among cells that stick out equally far, as long as it is always the same.
impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        let different = self.order().zip(other.order()).map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne());
        different.unwrap_or(Ordering::Equal)
    }
}

impl Hull {
    pub(super) fn at(point: [f64; 3]) -> Self {
        Self { cell: Cell { lo: point, hi: point }, outermost: [point; 6] }
    }

    pub(super) fn add(&mut self, point: [f64; 3]) {
        for axis in 0..3 {
            if point[axis] < self.cell.lo[axis] {
                self.cell.lo[axis] = point[axis];
                self.outermost[2 * axis] = point;
            }
            if point[axis] > self.cell.hi[axis] {
                self.cell.hi[axis] = point[axis];
                self.outermost[2 * axis + 1] = point;
            }
        }
    }

    /// How far the hull reaches on one side.
    pub(super) fn reach(&self, side: usize) -> f64 {
        if side.is_multiple_of(2) { -self.cell.lo[side / 2] } else { self.cell.hi[side / 2] }
    }

    /// How far a cell sticks out.
    pub(super) fn excess(&self, cell: &Cell) -> f64 {
        let past = |axis: usize| (self.cell.lo[axis] - cell.lo[axis]).max(cell.hi[axis] - self.cell.hi[axis]);
        past(0).max(past(1)).max(past(2))
    }

    /// The middle of the side of a cell that is opposite to the one which sticks out the farthest.
    pub(super) fn side_towards(&self, cell: &Cell) -> [f64; 3] {
        let past = |axis: usize| (self.cell.lo[axis] - cell.lo[axis], cell.hi[axis] - self.cell.hi[axis]);
        let most = |axis: usize| past(axis).0.max(past(axis).1);
        let axis = (1..3).fold(0, |best, axis| if most(axis) > most(best) { axis } else { best });
        let mut point = cell.centre();
        point[axis] = if past(axis).0 > past(axis).1 { cell.hi[axis] } else { cell.lo[axis] };
        point
    }

    /// How far a cell is from the hull along the axis on which that is farthest; negative if they overlap.
    pub(super) fn gap(&self, cell: &Cell) -> f64 {
        let between =
            |axis: usize| (self.cell.lo[axis] - cell.hi[axis]).max(cell.lo[axis] - self.cell.hi[axis]);
        between(0).max(between(1)).max(between(2))
    }
}
