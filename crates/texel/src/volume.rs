//! The volume: a sparse octree that keeps all of its levels.

use crate::pack::Packed;
use crate::texel::MAX_DEPTH;
use crate::{BuildError, Builder, Mode, Phong, Texel, morton};

/// The greatest edge of a volume, in cells.
pub const MAX_EDGE: u32 = 4096;

/// A reference volume: a cube of `edge`³ cells, edge = 2ⁿ, and the cells of all coarser levels up to the one that
/// is the whole cube.
///
/// Empty cells are not stored, nor what lies below a cell that is filled evenly. A stored cell takes 16 bytes, and 1 more
/// (5 in memory) above the finest level. Finding a cell takes n steps at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    pub(crate) levels: Vec<Level>,
    pub(crate) cyclic: [bool; 3],
    pub(crate) mode: Mode,
    pub(crate) phong: Phong,
}

/// The cells of one level that are filled, in Morton order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Level {
    pub(crate) texels: Vec<Packed>,
    /// Which of a cell's eight parts are stored. 0: the cell is evenly filled, and its texel is that of a cell of
    /// the finest level. Nothing at the finest level.
    pub(crate) parts: Vec<u8>,
    /// The place of a cell's first part in the level below.
    pub(crate) first: Vec<u32>,
}

impl Level {
    /// Finds the places of first parts.
    pub(crate) fn index(&mut self) {
        let mut sum = 0u32;
        let places = self.parts.iter().map(|parts| {
            let first = sum;
            sum = sum.wrapping_add(parts.count_ones());
            first
        });
        self.first = places.collect();
    }
}

/// What [`Volume::find`] came upon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The level of the greatest cell around the place asked for that is empty or evenly filled; the level asked for
    /// if there is none. All cells of the asked level inside that cell are found to be the same.
    pub level: u32,
    /// What fills the cell asked for, if it is not empty.
    pub texel: Option<Texel>,
}

impl Volume {
    /// Cells along an edge at the finest level, a power of two.
    pub fn edge(&self) -> u32 {
        1 << (self.levels.len() - 1)
    }

    /// The number of levels: 0 is the finest, `levels() − 1` the whole cube.
    pub fn levels(&self) -> u32 {
        self.levels.len() as u32
    }

    /// The width of a cell of a level, in units of the volume's edge.
    pub fn cell_width(&self, level: u32) -> f64 {
        f64::from(1u32 << level.min(31)) / f64::from(self.edge())
    }

    /// Whether the volume goes on with its other side, along x, y and z.
    pub fn cyclic(&self) -> [bool; 3] {
        self.cyclic
    }

    /// The rule by which the coarser levels were made.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The coefficients of reflection of the rules of 1995.
    pub fn phong(&self) -> Phong {
        self.phong
    }

    /// The number of stored cells of a level.
    pub fn stored(&self, level: u32) -> usize {
        self.levels.get(level as usize).map_or(0, |level| level.texels.len())
    }

    /// What fills a cell of a level; coordinates count cells of that level. Nothing if it is empty or outside.
    pub fn texel(&self, level: u32, cell: [u32; 3]) -> Option<Texel> {
        self.find(level, cell).texel
    }

    /// What fills a cell of a level, and how far around it the same holds. Outside of the volume all is empty.
    pub fn find(&self, level: u32, cell: [u32; 3]) -> Found {
        let top = self.levels() - 1;
        if level > top
            || cell.iter().any(|c| *c >> (top - level) != 0)
            || self.levels[top as usize].texels.is_empty()
        {
            return Found { level: level.max(top), texel: None };
        }
        let (mut at, mut index) = (top, 0);
        while at > level {
            let here = &self.levels[at as usize];
            let parts = here.parts[index];
            if parts == 0 {
                break;
            }
            at -= 1;
            let octant = (0..3).fold(0, |bits, axis| bits | (cell[axis] >> (at - level) & 1) << axis);
            if parts >> octant & 1 == 0 {
                return Found { level: at, texel: None };
            }
            let before = parts & ((1u32 << octant) - 1) as u8;
            index = here.first[index] as usize + before.count_ones() as usize;
        }
        Found { level: at, texel: Some(self.unpacked(at, index, level)) }
    }

    /// The same finest level, filtered by another rule.
    ///
    /// # Errors
    /// [`BuildError`] as of [`Builder::build`].
    pub fn filtered(&self, mode: Mode) -> Result<Self, BuildError> {
        let mut builder = Builder::new(self.edge())?.cyclic(self.cyclic).phong(self.phong);
        self.walk(0, |cell, at, index| builder.insert_packed(cell, self.levels[at as usize].texels[index]));
        builder.build(mode)
    }

    /// Calls `visit` with every filled cell of a level, in Morton order, and what fills it.
    pub fn for_each(&self, level: u32, mut visit: impl FnMut([u32; 3], &Texel)) {
        // Cells inside an evenly filled one come one after the other.
        let mut last = None;
        self.walk(level, |cell, at, index| {
            let texel = match last {
                Some((key, texel)) if key == (at, index) => texel,
                _ => self.unpacked(at, index, level),
            };
            last = Some(((at, index), texel));
            visit(cell, &texel);
        });
    }

    /// Calls `visit` with every filled cell of a level, and the level and index of the stored cell that says what fills it.
    fn walk(&self, level: u32, mut visit: impl FnMut([u32; 3], u32, usize)) {
        let top = self.levels() - 1;
        if level > top || self.levels[top as usize].texels.is_empty() {
            return;
        }
        // Cells wait in falling order: (level, place in it, cell).
        let mut waiting = vec![(top, 0usize, [0u32; 3])];
        while let Some((at, index, cell)) = waiting.pop() {
            let here = &self.levels[at as usize];
            let parts = here.parts.get(index).copied().unwrap_or(0);
            if at == level || parts == 0 {
                within(cell, at - level, |cell| visit(cell, at, index));
                continue;
            }
            let mut place = here.first[index] as usize + parts.count_ones() as usize;
            for octant in (0..8).rev().filter(|octant| parts >> octant & 1 != 0) {
                place -= 1;
                waiting.push((at - 1, place, child(cell, octant)));
            }
        }
    }

    /// A stored cell, seen at a level at or below its own.
    fn unpacked(&self, at: u32, index: usize, level: u32) -> Texel {
        let stored = &self.levels[at as usize];
        let mut texel = stored.texels[index].texel();
        if at > 0 && stored.parts[index] == 0 && level > 0 {
            let widths = f32::from(1u16 << level);
            texel.depth = texel.depth.map(|depth| (depth * widths).min(MAX_DEPTH));
        }
        texel
    }
}

/// The part of a cell in an octant.
fn child(cell: [u32; 3], octant: u32) -> [u32; 3] {
    std::array::from_fn(|axis| cell[axis] << 1 | octant >> axis & 1)
}

/// All cells `down` levels below `cell`, in Morton order.
fn within(cell: [u32; 3], down: u32, mut visit: impl FnMut([u32; 3])) {
    for key in 0..1u64 << (3 * down) {
        let inner = morton::decode(key);
        visit(std::array::from_fn(|axis| cell[axis] << down | inner[axis]));
    }
}
