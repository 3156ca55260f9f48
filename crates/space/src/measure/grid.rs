//! Cells of the octree of a box, by level and place.

use super::plane::Range;

/// No cell is smaller than the box divided this often.
const DEEPEST: u8 = 30;

/// No cell is shorter than this part of its coordinates, so that rounding stays small within it.
const FINEST: f64 = 1.0 / (1u64 << 30) as f64;

/// Where the box is cut first, in parts of its sides.
const FIRST_CUT: f64 = 0.487_310_9;

/// The box that is divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    lo: [f64; 3],
    hi: [f64; 3],
}

/// A cell: the box of a [`Grid`] is divided `level` times along each axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Cell {
    pub(super) level: u8,
    pub(super) at: [u32; 3],
}

impl Grid {
    /// A box that is finite and longer than nothing along each axis; otherwise `None`.
    pub(super) fn new(lo: [f64; 3], hi: [f64; 3]) -> Option<Self> {
        let good = (0..3).all(|i| lo[i] < hi[i] && (hi[i] - lo[i]).is_finite());
        good.then_some(Self { lo, hi })
    }

    /// Where cells end: `count` of 2^`level` steps from the lower end. Neighbours get the same number.
    ///
    /// The first cut is off the middle. Planes of models stand at round numbers, boxes too, and a surface that lies in
    /// a face between cells is seen by neither.
    fn cut(&self, axis: usize, level: u8, count: u32) -> f64 {
        let (lo, hi) = (self.lo[axis], self.hi[axis]);
        let middle = lo + (hi - lo) * FIRST_CUT;
        let part = 2.0 * (f64::from(count) / (1u64 << level) as f64);
        match part {
            0.0 => lo,
            part if part < 1.0 => (lo + (middle - lo) * part).min(middle),
            part if part < 2.0 => (middle + (hi - middle) * (part - 1.0)).min(hi),
            _ => hi,
        }
    }

    /// The extent of a cell along each axis.
    pub(super) fn extent(&self, cell: Cell) -> [Range; 3] {
        [0, 1, 2].map(|axis| {
            let at = cell.at[axis];
            Range::new(self.cut(axis, cell.level, at), self.cut(axis, cell.level, at + 1))
        })
    }

    /// The middle of the box.
    pub(super) fn centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * self.lo[axis] + 0.5 * self.hi[axis])
    }

    /// Whether the cells of a level may be divided.
    pub(super) fn divides(&self, level: u8) -> bool {
        let long = |axis: usize| {
            let length = (self.hi[axis] - self.lo[axis]) / (1u64 << level) as f64;
            length > FINEST * self.lo[axis].abs().max(self.hi[axis].abs())
                && length > f64::MIN_POSITIVE.sqrt()
        };
        level < DEEPEST && (0..3).all(long)
    }
}

impl Cell {
    /// The whole box.
    pub(super) const ROOT: Self = Self { level: 0, at: [0; 3] };

    /// The eight parts.
    pub(super) fn parts(self) -> [Self; 8] {
        std::array::from_fn(|i| {
            let at = [0, 1, 2].map(|axis| 2 * self.at[axis] + (i as u32 >> axis & 1));
            Self { level: self.level + 1, at }
        })
    }

    /// The next cell of this level along an axis, which may lie outside of the box.
    pub(super) fn next(self, axis: usize) -> Self {
        let mut at = self.at;
        at[axis] += 1;
        Self { at, ..self }
    }

    /// The cell of this level before, along an axis.
    pub(super) fn previous(self, axis: usize) -> Option<Self> {
        let mut at = self.at;
        at[axis] = at[axis].checked_sub(1)?;
        Some(Self { at, ..self })
    }
}

/// The lengths of the sides.
pub(super) fn sides(extent: &[Range; 3]) -> [Range; 3] {
    extent.map(|side| Range::point(side.hi) - Range::point(side.lo))
}
