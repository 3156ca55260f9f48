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
    pub fn build(mut self, mode: Mode) -> Result<Volume, BuildError> {
        self.cells.par_sort_by_key(|(key, _)| *key);
        self.add_doubles();
        if u32::try_from(self.cells.len()).is_err() {
            return Err(BuildError::Cells { cells: self.cells.len() });
        }
        let top = self.edge.trailing_zeros();
        let mut levels = vec![Level::default()];
        let mut nodes = self.first_nodes(mode, &mut levels);
        for level in 1..=top {
            levels.push(Level::default());
            if level == top {
                emit(&nodes, &mut levels[top as usize]);
            } else {
                let width = f64::from(2u32 << level) / f64::from(self.edge);
                nodes = next_nodes(nodes, mode, width, &mut levels[level as usize]);
            }
        }
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

    /// The nodes above the finest level, whose cells are written to `levels[0]` unless they are all the same.
    fn first_nodes(&mut self, mode: Mode, levels: &mut [Level]) -> Vec<Node> {
        let cells = std::mem::take(&mut self.cells);
        let finest = &mut levels[0];
        if self.edge == 1 {
            finest.texels.extend(cells.iter().map(|(_, packed)| *packed));
            return Vec::new();
        }
        let width = 2.0 / f64::from(self.edge);
        let mut nodes: Vec<Node> = cells
            .par_chunk_by(|a, b| a.0 >> 3 == b.0 >> 3)
            .map(|parts| {
                let even = parts.len() == 8 && parts.iter().all(|part| part.1 == parts[0].1);
                let leaf = |packed: &Packed| Joined::leaf(packed.texel(), mode);
                let joined = if even {
                    leaf(&parts[0].1).doubled()
                } else {
                    let parts: Vec<_> =
                        parts.iter().map(|(key, packed)| ((key & 7) as usize, leaf(packed))).collect();
                    join(&parts, mode, width)
                };
                Node::new(parts.iter().map(|part| part.0), joined, even.then_some(parts[0].1))
            })
            .collect();
        let mut rest = cells.as_slice();
        for node in &mut nodes {
            let (parts, after) = rest.split_at(node.parts.count_ones() as usize);
            rest = after;
            if node.even.is_none() {
                node.first = finest.texels.len() as u32;
                finest.texels.extend(parts.iter().map(|part| part.1));
            } else {
                node.parts = 0;
            }
        }
        nodes
    }
}

/// A cell above the finest level, on its way up.
#[derive(Clone, Copy, Debug)]
struct Node {
    key: u64,
    joined: Joined,
    /// The texel of the finest level that fills all of the cell.
    even: Option<Packed>,
    parts: u8,
    first: u32,
}

impl Node {
    fn new(parts: impl Iterator<Item = u64>, joined: Joined, even: Option<Packed>) -> Self {
        let (key, parts) = parts.fold((0, 0u8), |(_, bits), key| (key >> 3, bits | 1 << (key & 7)));
        Self { key, joined, even, parts, first: 0 }
    }
}

/// Writes nodes to their level.
fn emit(nodes: &[Node], level: &mut Level) {
    level
        .texels
        .extend(nodes.iter().map(|node| node.even.unwrap_or_else(|| Packed::new(&node.joined.texel))));
    level.parts.extend(nodes.iter().map(|node| node.parts));
    level.first.extend(nodes.iter().map(|node| node.first));
}

/// The nodes of the level above, of the given cell width; those below are written to their level.
fn next_nodes(nodes: Vec<Node>, mode: Mode, width: f64, level: &mut Level) -> Vec<Node> {
    let mut above: Vec<Node> = nodes
        .par_chunk_by(|a, b| a.key >> 3 == b.key >> 3)
        .map(|parts| {
            let first = parts[0].even;
            let even = first.filter(|_| parts.len() == 8 && parts.iter().all(|part| part.even == first));
            let joined = if even.is_some() {
                parts[0].joined.doubled()
            } else {
                let parts: Vec<_> = parts.iter().map(|part| ((part.key & 7) as usize, part.joined)).collect();
                join(&parts, mode, width)
            };
            Node::new(parts.iter().map(|part| part.key), joined, even)
        })
        .collect();
    let mut rest = nodes.as_slice();
    for node in &mut above {
        let (parts, after) = rest.split_at(node.parts.count_ones() as usize);
        rest = after;
        if node.even.is_none() {
            node.first = level.texels.len() as u32;
            emit(parts, level);
        } else {
            node.parts = 0;
        }
    }
    above
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
