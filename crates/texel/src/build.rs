//! From the cells of the finest level to a volume.

use crate::filter::{Joined, join};
use crate::pack::Packed;
use crate::volume::Level;
use crate::{MAX_EDGE, Mode, Phong, Texel, Volume, morton};
use rayon::prelude::*;

/// Why no volume was made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// The edge is not allowed.
    #[error("the edge of a volume is a power of two from 1 to {MAX_EDGE} cells, not {edge}")]
    Edge {
        /// The edge asked for.
        edge: u32,
    },
    /// There are more cells than can be numbered.
    #[error("{cells} filled cells are too many, the greatest number is {}", u32::MAX)]
    Cells {
        /// The number of cells.
        cells: usize,
    },
}

/// Collects the cells of the finest level, then makes all others from them.
///
/// Cells may come in any order, and from any number of builders ([`Builder::append`]). Where one cell is filled
/// several times, its contents are added in the order in which they came. A cell takes 24 bytes.
#[derive(Clone, Debug)]
pub struct Builder {
    edge: u32,
    cyclic: [bool; 3],
    phong: Phong,
    cells: Vec<(u64, Packed)>,
}

impl Builder {
    /// A builder of a volume of `edge`³ cells, a power of two up to [`MAX_EDGE`].
    pub fn new(edge: u32) -> Result<Self, BuildError> {
        if !edge.is_power_of_two() || edge > MAX_EDGE {
            return Err(BuildError::Edge { edge });
        }
        Ok(Self { edge, cyclic: [false; 3], phong: Phong::default(), cells: Vec::new() })
    }

    /// Along which axes the volume goes on with its other side.
    pub fn cyclic(mut self, cyclic: [bool; 3]) -> Self {
        self.cyclic = cyclic;
        self
    }

    /// The coefficients of reflection of the rules of 1995.
    pub fn phong(mut self, phong: Phong) -> Self {
        self.phong = phong;
        self
    }

    /// Along which axes the volume will be cyclic.
    pub fn is_cyclic(&self) -> [bool; 3] {
        self.cyclic
    }

    /// Cells along an edge.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// The number of cells taken so far.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether no cell was taken.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Adds to what fills a cell. Cells outside of the volume and contents that stop no light are left out.
    pub fn insert(&mut self, cell: [u32; 3], texel: &Texel) {
        self.cells.extend(self.packed(cell, texel));
    }

    /// Adds a cell that is packed.
    pub(crate) fn insert_packed(&mut self, cell: [u32; 3], packed: Packed) {
        self.cells.push((morton::encode(cell), packed));
    }

    /// Adds many cells, made on all cores.
    pub fn extend(&mut self, cells: impl IntoParallelIterator<Item = ([u32; 3], Texel)>) {
        let packed: Vec<_> =
            cells.into_par_iter().filter_map(|(cell, texel)| self.packed(cell, &texel)).collect();
        if self.cells.is_empty() {
            self.cells = packed;
        } else {
            self.cells.extend(packed);
        }
    }

    /// Adds the cells of another builder, behind its own. Its edge has to be the same: other cells are left out.
    pub fn append(&mut self, other: Self) {
        if other.edge == self.edge {
            self.cells.extend(other.cells);
        }
    }

    fn packed(&self, cell: [u32; 3], texel: &Texel) -> Option<(u64, Packed)> {
        let stops = texel.density > 0.0 || texel.depth.iter().any(|depth| *depth > 0.0);
        let inside = cell.iter().all(|c| *c < self.edge);
        (stops && inside).then(|| (morton::encode(cell), Packed::new(texel)))
    }

    /// The volume, with all levels.
    ///
    /// # Errors
    /// [`BuildError::Cells`] if there are more cells than can be numbered.
    pub fn build(mut self, mode: Mode) -> Result<Volume, BuildError> {
        self.cells.par_sort_by_key(|(key, _)| *key);
        self.add_doubles();
        if u32::try_from(self.cells.len()).is_err() {
            return Err(BuildError::Cells { cells: self.cells.len() });
        }
        let top = self.edge.trailing_zeros();
        let low = top.min(BLOCK_LEVELS);
        let rise = Rise { mode, edge: self.edge };
        let blocks: Vec<_> = self
            .cells
            .par_chunk_by(|a, b| a.0 >> (3 * low) == b.0 >> (3 * low))
            .map(|cells| rise.block(cells, low))
            .collect();
        drop(self.cells);
        let mut levels = vec![Level::default(); top as usize + 1];
        let mut nodes = Vec::with_capacity(blocks.len());
        for (block, node) in blocks {
            nodes.push(node);
            for (part, level) in block.into_iter().zip(&mut levels) {
                level.texels.extend(part.texels);
                level.parts.extend(part.parts);
            }
        }
        for level in low..top {
            nodes = rise.next(&nodes, level, &mut levels[level as usize]);
        }
        rise.emit(&nodes, top, &mut levels[top as usize]);
        levels.iter_mut().for_each(Level::index);
        Ok(Volume { levels, cyclic: self.cyclic, mode, phong: self.phong })
    }

    /// Adds up what fills the same cell.
    fn add_doubles(&mut self) {
        self.cells.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 = Packed::new(&added(&kept.1.texel(), &next.1.texel()));
            }
            same
        });
    }
}

/// Levels that are made at once for a part of the volume, so that what is needed on the way up does not grow with the
/// volume: 64³ cells.
const BLOCK_LEVELS: u32 = 6;

/// A cell on its way up.
#[derive(Clone, Debug)]
struct Node {
    key: u64,
    joined: Joined,
    /// The texel of the finest level that fills all of the cell.
    even: Option<Packed>,
    parts: u8,
}

/// The way from the finest level up.
#[derive(Clone, Copy)]
struct Rise {
    mode: Mode,
    edge: u32,
}

impl Rise {
    /// All levels below `top` of the cells of one block, and the node that joins them.
    fn block(self, cells: &[(u64, Packed)], top: u32) -> (Vec<Level>, Node) {
        let width = f64::from(self.edge).recip();
        let leaf = |&(key, packed): &(u64, Packed)| {
            let joined = Joined::leaf(&packed.texel(), self.mode, width);
            Node { key, joined, even: Some(packed), parts: 0 }
        };
        let mut nodes: Vec<Node> = cells.iter().map(leaf).collect();
        let mut levels = vec![Level::default(); top as usize];
        for level in 0..top {
            nodes = self.next(&nodes, level, &mut levels[level as usize]);
        }
        (levels, nodes.swap_remove(0))
    }

    /// The nodes above those of a `level`, which are written unless they are the same in all of a node.
    fn next(self, nodes: &[Node], level: u32, target: &mut Level) -> Vec<Node> {
        let mut above = Vec::new();
        for parts in nodes.chunk_by(|a, b| a.key >> 3 == b.key >> 3) {
            let even =
                parts[0].even.filter(|_| parts.len() == 8 && parts.iter().all(|p| p.even == parts[0].even));
            let key = parts[0].key >> 3;
            if even.is_some() {
                above.push(Node { key, joined: parts[0].joined.doubled(), even, parts: 0 });
                continue;
            }
            let cells: Vec<_> = parts.iter().map(|part| ((part.key & 7) as usize, &part.joined)).collect();
            let joined = join(&cells, self.mode, 1 << level);
            let stored = parts.iter().fold(0, |bits, part| bits | 1 << (part.key & 7));
            above.push(Node { key, joined, even, parts: stored });
            self.emit(parts, level, target);
        }
        above
    }

    /// Writes nodes to their level.
    fn emit(self, nodes: &[Node], level: u32, target: &mut Level) {
        let width = f64::from(1u32 << level) / f64::from(self.edge);
        let packed =
            |node: &Node| node.even.unwrap_or_else(|| Packed::new(&node.joined.texel(self.mode, width)));
        target.texels.extend(nodes.iter().map(packed));
        if level > 0 {
            target.parts.extend(nodes.iter().map(|node| node.parts));
        }
    }
}

/// Both contents in one cell: amounts and depths are added, the rest is the mean by density.
fn added(a: &Texel, b: &Texel) -> Texel {
    let density = a.density + b.density;
    let share = if density > 0.0 { b.density / density } else { 0.5 };
    let mean = |a: f32, b: f32| a + share * (b - a);
    let (s, t) = (a.flakes.entries(), b.flakes.entries());
    Texel {
        density,
        depth: std::array::from_fn(|axis| a.depth[axis] + b.depth[axis]),
        flakes: crate::Sggx::from_entries(std::array::from_fn(|entry| mean(s[entry], t[entry]))),
        albedo: std::array::from_fn(|channel| mean(a.albedo[channel], b.albedo[channel])),
        gloss: mean(a.gloss, b.gloss),
    }
}
