//! An octree over a solid, which holds in each cell the shortest program that is right there, and which all rays walk.
//!
//! Cells depend on the field alone, never on rays or a view, so that a tree serves primary rays, shadows, reflections and
//! every later picture. It is built where rays come by, by whichever thread is there first. A node is divided two levels
//! at a time, into 4³ cells, which fill one block of lanes: intervals say which are *outside* (the field is positive all
//! over), *inside* (negative all over) or *open*, and for these the program is shortened to what the cell leaves
//! undecided (Duff 1992; Keeter 2020).
//!
//! In open cells the set operations with which the program ends are taken apart into their operands, its [`pieces`]. The
//! slopes of each are bounded, too ([`Gradients`]). Together with the value at the centre they enclose it between two planes
//! (the mean-value form, Moore 1966): a [`Facet`]. Where the slopes of every piece lie close together a cell is not divided
//! any further. For most rays through such a cell the facets alone decide ([`settle`]): they pass it, or a single piece
//! changes its sign and is monotone along them, so that there is exactly one root, between two places that are known before
//! anything has been evaluated. Only rays that graze a facet, meet an edge or cross cells without facets are marched.
//!
//! With a changed parameter a tree takes over the nodes below cells whose programs do not read it and came out the same
//! ([`Octree::rebound`]).

mod build;
mod facet;
mod packet;
mod pieces;
mod plane;
mod settle;
mod sign;
mod solve;
mod walk;

use crate::gradient::Gradients;
use facet::Facet;
use fieldstone_field::{Bindings, Field, Input, Reading, Tape, TapeOptions};
use pieces::{Pieces, Shared};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

pub use plane::Lattice;
pub use walk::Walker;

/// How often a node may be divided into 4³ cells: the smallest are 1/256 of the bounds along each axis.
const LEVELS: usize = 4;
/// How many of the smallest cells there are along an axis.
const FINEST: u32 = 1 << (2 * LEVELS);

/// How far the tree reaches beyond the bounds to both sides of each axis, relative to their extent: so that rays that start
/// on a face are inside, and faces of cells are not at the simple fractions of the bounds at which models have theirs.
const ROOM: [f64; 2] = [0.007_31, 0.004_17];

/// What octrees may take together, and what they do. Clones share it.
#[derive(Clone, Debug)]
pub struct OctreeMemory {
    used: Arc<AtomicUsize>,
    limit: usize,
}

impl OctreeMemory {
    /// About how many bytes cells and their programs may take. Nodes beyond are made anew whenever a ray comes by, which
    /// is slow but finds the same.
    pub fn new(limit: usize) -> Self {
        Self { used: Arc::default(), limit }
    }

    /// About how many bytes are taken.
    pub fn used(&self) -> usize {
        self.used.load(Ordering::Relaxed)
    }

    fn add(&self, bytes: usize) {
        self.used.fetch_add(bytes, Ordering::Relaxed);
    }

    fn is_full(&self) -> bool {
        self.used() >= self.limit
    }
}

impl Default for OctreeMemory {
    /// One gibibyte.
    fn default() -> Self {
        Self::new(1 << 30)
    }
}

/// An octree over a solid: each cell holds the shortest program that is right there, and bounds of the field and of its
/// slopes. All rays walk it, whatever the view; it is built where they come by.
#[derive(Debug)]
pub struct Octree {
    /// The corner with the smallest coordinates.
    corner: [f64; 3],
    /// The size of the smallest cells.
    step: [f64; 3],
    /// How far cells reach beyond their faces, so that the rounding of rays does not matter.
    slack: f64,
    root: Cell,
    /// Whether the field is a set operation, so that its cells are taken apart.
    is_composite: bool,
    /// The programs of cells that are taken apart, and the operands that they are taken apart into: equal ones are shared.
    shared: Shared,
    /// The inputs whose values differ from those of the tree that this one was made from.
    changed: Vec<Input>,
    memory: OctreeMemory,
    /// How much of it this tree takes.
    bytes: AtomicUsize,
}

/// What has been built of a tree so far.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub struct Census {
    /// Nodes, of 64 cells each.
    pub nodes: usize,
    /// Cells that are open and not divided any further.
    pub leaves: usize,
    /// Those of them in which the field is enclosed between two planes.
    pub facets: usize,
    /// The instructions of the programs of all leaves.
    pub instructions: usize,
    /// About how many bytes nodes and programs take, but for those that were taken over from another tree.
    pub bytes: usize,
}

/// The programs of a cell.
#[derive(Clone, Debug)]
struct Programs {
    /// The field, for its sign.
    value: Arc<Tape>,
    /// Its slopes along x, y and z; none where nothing can be known of them, and where operands have their own.
    slopes: Option<Arc<Tape>>,
}

/// An open cell.
#[derive(Debug)]
struct Cell {
    programs: Programs,
    pieces: Option<Box<Pieces>>,
    /// Whether it is not to be divided.
    is_leaf: bool,
    below: OnceLock<Arc<Node>>,
    /// What the same cell was divided into in the tree that this one was made from, until it is divided itself.
    donor: Mutex<Option<Arc<Node>>>,
}

/// A cell divided into 4³, numbered with x changing fastest.
#[derive(Debug)]
struct Node {
    /// Cells in which the field is positive.
    outside: u64,
    /// Cells in which it is negative.
    inside: u64,
    /// The others, in their order.
    open: Vec<Cell>,
}

impl Node {
    /// The cell with this number, if it is open.
    fn open_cell(&self, number: u32) -> Option<&Cell> {
        ((self.outside | self.inside) >> number & 1 == 0).then(|| self.cell(number))
    }

    /// The cell with this number, which is open.
    fn cell(&self, number: u32) -> &Cell {
        let before = !(self.outside | self.inside) & ((1u64 << number) - 1);
        &self.open[before.count_ones() as usize]
    }
}

/// Where a node lies: how often the bounds were divided, and its corner, in smallest cells.
#[derive(Clone, Copy, Debug)]
struct Place {
    level: usize,
    corner: [u32; 3],
}

impl Place {
    const ROOT: Self = Self { level: 0, corner: [0; 3] };

    /// The side of the cells that it is divided into, in smallest cells.
    fn unit(self) -> u32 {
        FINEST >> (2 * (self.level + 1))
    }

    /// The place of one of its cells.
    fn child(self, number: u32) -> Self {
        let of_axis = |axis: usize| self.corner[axis] + self.unit() * (number >> (2 * axis) & 3);
        Self { level: self.level + 1, corner: [of_axis(0), of_axis(1), of_axis(2)] }
    }
}

impl Octree {
    /// A tree of the field between two corners; nothing is divided yet.
    ///
    /// Inputs other than the first three coordinates have the values in `bindings`.
    pub fn new(
        field: &Field,
        bindings: &Bindings,
        (min, max): ([f64; 3], [f64; 3]),
        memory: OctreeMemory,
    ) -> Self {
        let size = [0, 1, 2].map(|axis| max[axis] - min[axis]);
        let field = sign::sign_form(field);
        let programs = Programs::new(&field, bindings);
        let is_composite = sign::is_set_operation(&field) && !field.has_loops();
        let longest = size.into_iter().fold(0.0, f64::max);
        Self {
            corner: [0, 1, 2].map(|axis| min[axis] - ROOM[0] * size[axis]),
            step: size.map(|s| s * (1.0 + ROOM[0] + ROOM[1]) / f64::from(FINEST)),
            slack: 1e-9 * longest,
            root: Cell {
                programs: if is_composite { programs } else { programs.with_slopes(&field, bindings) },
                pieces: None,
                is_leaf: false,
                below: OnceLock::new(),
                donor: Mutex::default(),
            },
            is_composite,
            shared: Shared::default(),
            changed: Vec::new(),
            memory,
            bytes: AtomicUsize::new(0),
        }
    }

    /// The tree of the same field with other values of its inputs. Cells whose programs do not read what has changed, and
    /// are shortened to the same as before, are shared with this tree, with all that is below them; what is found is the
    /// same as in a tree that is built from nothing.
    pub fn rebound(&self, bindings: &Bindings) -> Self {
        let programs = &self.root.programs;
        let changed: Vec<Input> = programs
            .value
            .uniforms()
            .chain(programs.slopes.iter().flat_map(|tape| tape.uniforms()))
            .filter(|&(input, value)| bindings.get(input).to_bits() != value.to_bits())
            .map(|(input, _)| input)
            .collect();
        let bound = |tape: &Arc<Tape>| {
            let mut tape = Tape::clone(tape);
            changed.iter().for_each(|&input| tape.bind(input, bindings.get(input)));
            Arc::new(tape)
        };
        let root = Cell {
            programs: Programs { value: bound(&programs.value), slopes: programs.slopes.as_ref().map(bound) },
            pieces: None,
            is_leaf: false,
            below: OnceLock::new(),
            donor: Mutex::new(self.root.below.get().cloned()),
        };
        Self {
            corner: self.corner,
            step: self.step,
            slack: self.slack,
            root,
            is_composite: self.is_composite,
            shared: Shared::default(),
            changed,
            memory: self.memory.clone(),
            bytes: AtomicUsize::new(0),
        }
    }

    /// Takes note of memory that is taken.
    fn take(&self, bytes: usize) {
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        self.memory.add(bytes);
    }

    /// The number of instructions of the whole program.
    pub fn program_len(&self) -> usize {
        self.root.programs.value.len()
    }

    /// What has been built so far.
    pub fn census(&self) -> Census {
        let mut census = Census { bytes: self.bytes.load(Ordering::Relaxed), ..Census::default() };
        self.root.count(&mut census);
        census
    }

    /// The coordinates of the faces between the cells of a node, axis by axis.
    fn faces(&self, place: Place) -> [[f64; 5]; 3] {
        let unit = place.unit();
        std::array::from_fn(|axis| {
            std::array::from_fn(|i| self.face(axis, place.corner[axis] + unit * i as u32))
        })
    }

    /// The coordinate of a face between smallest cells.
    fn face(&self, axis: usize, index: u32) -> f64 {
        self.corner[axis] + self.step[axis] * f64::from(index)
    }
}

impl Drop for Octree {
    fn drop(&mut self) {
        self.memory.used.fetch_sub(self.bytes.load(Ordering::Relaxed), Ordering::Relaxed);
    }
}

impl Cell {
    fn count(&self, census: &mut Census) {
        if self.is_leaf {
            census.leaves += 1;
            census.facets += usize::from(self.pieces.is_some());
            census.instructions += self.programs.value.len();
        }
        if let Some(node) = self.below.get() {
            census.nodes += 1;
            node.open.iter().for_each(|cell| cell.count(census));
        }
    }
}

impl Programs {
    fn new(field: &Field, bindings: &Bindings) -> Self {
        let options =
            TapeOptions { bindings: bindings.clone(), reading: Reading::Sign, ..TapeOptions::default() };
        Self { value: Arc::new(Tape::new(field, &options)), slopes: None }
    }

    fn with_slopes(mut self, field: &Field, bindings: &Bindings) -> Self {
        // Loops have no slopes that are known, and are dear.
        if !field.has_loops() {
            let options =
                TapeOptions { bindings: bindings.clone(), attributes: true, ..TapeOptions::default() };
            self.slopes = Some(Arc::new(Tape::new(&slopes_of(field), &options)));
        }
        self
    }
}

/// A field without loops, as its slope along x, with those along y and z for attributes.
fn slopes_of(field: &Field) -> Field {
    let mut graph = (**field.graph()).clone();
    let [x, y, z] = Gradients::default().of(&mut graph, field.value());
    Field::new(graph, x, vec![y, z]).with_fuel(field.fuel())
}

#[cfg(test)]
mod tests;
