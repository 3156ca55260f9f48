//! Which points of a lattice in a plane are inside.

use super::build::Builder;
use super::{Cell, FINEST, Node, Octree, Place};
use fieldstone_field::{F64, LANES, Points, Tape, Workspace};
use rayon::prelude::*;
use typed_arena::Arena;

/// Points in a plane that stands upright on an axis, in rows and columns along the two others.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lattice {
    /// The axes along a row and along a column, 0 to 2, and not the same.
    pub axes: [usize; 2],
    /// Where the plane stands on the third axis.
    pub at: f64,
    /// The first point.
    pub first: [f64; 2],
    /// From one point to the next; more than 0.
    pub step: [f64; 2],
    /// How many columns and rows there are.
    pub size: [u32; 2],
}

/// Cells with at most so many points are not divided for them.
const FEW: u32 = 32;
/// How many rows a thread looks at together.
const BAND: u32 = 32;

/// Points of a lattice: columns and rows.
#[derive(Clone, Copy, Debug)]
struct Rect {
    from: [u32; 2],
    to: [u32; 2],
}

impl Rect {
    fn count(self) -> u32 {
        (self.to[0] - self.from[0]) * (self.to[1] - self.from[1])
    }
}

impl Lattice {
    /// The axis on which the plane stands.
    fn normal(&self) -> usize {
        3 - self.axes[0] - self.axes[1]
    }

    fn point(&self, column: u32, row: u32) -> [f64; 3] {
        let mut point = [self.at; 3];
        point[self.axes[0]] = self.first[0] + self.step[0] * f64::from(column);
        point[self.axes[1]] = self.first[1] + self.step[1] * f64::from(row);
        point
    }

    /// The first column (0) or row (1) at or behind a coordinate.
    fn index(&self, which: usize, x: f64) -> u32 {
        // Numbers outside of the range are its ends.
        ((x - self.first[which]) / self.step[which]).ceil().max(0.0).min(f64::from(self.size[which])) as u32
    }
}

/// What looks at a band of rows.
struct Look<'w> {
    tree: &'w Octree,
    arena: &'w Arena<Node>,
    lattice: &'w Lattice,
    /// The rows from `first` on.
    inside: &'w mut [bool],
    first: u32,
}

/// What a thread needs.
#[derive(Debug, Default)]
struct Looker {
    builder: Builder,
    points: Workspace<F64, Points>,
    /// The places in the band of the points to be evaluated, and their coordinates.
    open: Vec<(usize, [f64; 3])>,
}

impl Octree {
    /// Whether the field is negative at each point, row by row; beyond the bounds there is nothing.
    ///
    /// Cells and facets prove it for whole parts of the plane; what they leave open is decided by values. Rows are worked
    /// on by the current `rayon` pool.
    pub fn inside(&self, lattice: &Lattice) -> Vec<bool> {
        let width = lattice.size[0];
        let mut inside = vec![false; width as usize * lattice.size[1] as usize];
        inside.par_chunks_mut((width * BAND).max(1) as usize).enumerate().for_each_init(
            Looker::default,
            |looker, (band, inside)| {
                let first = band as u32 * BAND;
                let rows = inside.len() as u32 / width;
                let arena = Arena::new();
                let mut look = Look { tree: self, arena: &arena, lattice, inside, first };
                let all = Rect { from: [0, first], to: [width, first + rows] };
                looker.divide(&mut look, &self.root, Place::ROOT, all);
            },
        );
        inside
    }
}

impl Looker {
    fn divide<'w>(&mut self, look: &mut Look<'w>, cell: &'w Cell, place: Place, rect: Rect) {
        let (tree, lattice) = (look.tree, look.lattice);
        let (unit, normal) = (place.unit(), lattice.normal());
        let slab = ((lattice.at - tree.face(normal, place.corner[normal])) / tree.step[normal]).floor();
        if slab < 0.0 || slab >= f64::from(4 * unit).min(f64::from(FINEST)) {
            return;
        }
        let slab = slab as u32 / unit;
        let node = tree.node(&mut self.builder, look.arena, cell, place);
        let cuts = [0, 1].map(|which| {
            let axis = lattice.axes[which];
            let cut = |i: usize| lattice.index(which, tree.face(axis, place.corner[axis] + unit * i as u32));
            let cuts: [u32; 5] = std::array::from_fn(cut);
            cuts.map(|cut| cut.clamp(rect.from[which], rect.to[which]))
        });
        for j in 0..4 {
            for i in 0..4 {
                let part = Rect { from: [cuts[0][i], cuts[1][j]], to: [cuts[0][i + 1], cuts[1][j + 1]] };
                if part.count() == 0 {
                    continue;
                }
                let shift = |axis: usize| 2 * axis as u32;
                let number = (i as u32) << shift(lattice.axes[0])
                    | (j as u32) << shift(lattice.axes[1])
                    | slab << shift(normal);
                if node.inside >> number & 1 == 1 {
                    look.fill(part);
                } else if node.outside >> number & 1 == 0 {
                    let cell = node.cell(number);
                    if cell.is_leaf || part.count() <= FEW {
                        self.decide(look, cell, part);
                    } else {
                        self.divide(look, cell, place.child(number), part);
                    }
                }
            }
        }
    }

    /// Decides points of an open cell, by its facet where that can.
    fn decide(&mut self, look: &mut Look<'_>, cell: &Cell, rect: Rect) {
        self.open.clear();
        for row in rect.from[1]..rect.to[1] {
            for column in rect.from[0]..rect.to[0] {
                let (point, place) = (look.lattice.point(column, row), look.place(column, row));
                match cell.facet.and_then(|facet| facet.side(point)) {
                    Some(inside) => look.inside[place] = inside,
                    None => self.open.push((place, point)),
                }
            }
        }
        self.evaluate(look, &cell.programs.value);
    }

    fn evaluate(&mut self, look: &mut Look<'_>, program: &Tape) {
        for block in self.open.chunks(LANES) {
            for (lane, (_, point)) in block.iter().enumerate() {
                for axis in 0..3 {
                    self.points.input(axis, 0)[lane] = point[axis];
                }
            }
            self.points.run(program, block.len());
            for (&(place, _), &value) in block.iter().zip(self.points.output(0, 0)) {
                look.inside[place] = value < 0.0;
            }
        }
    }
}

impl Look<'_> {
    /// Where a point stands in the band.
    fn place(&self, column: u32, row: u32) -> usize {
        (row - self.first) as usize * self.lattice.size[0] as usize + column as usize
    }

    fn fill(&mut self, rect: Rect) {
        for row in rect.from[1]..rect.to[1] {
            let (from, to) = (self.place(rect.from[0], row), self.place(rect.to[0], row));
            self.inside[from..to].fill(true);
        }
    }
}
