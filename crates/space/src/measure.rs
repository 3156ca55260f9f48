//! How large a solid is: certified bounds of its volume, centroid, extent and surface.
//!
//! The box is divided like an octree. A cell is *inside* or *outside* where an interval proves it, otherwise *open*. All
//! that is left to know is in the open cells, and there a plane tells it: the mean-value form puts the surface of a cell
//! between two parallel planes whose distance falls with the square of the cell's size (module `plane`). The part of
//! the cell on one side of a plane has a closed form. So the bounds of the volume close with the square of the size of the
//! cells, where counting cells would leave the first power, and the bounds of the area do too (module `totals`).
//! Set operations at the top of a program are taken apart first, because each operand has a plane where their edge
//! has none (module `pieces`).
//!
//! Cells that an edge, a vanishing gradient or an undefined value goes through keep their whole range of possibilities.
//! In each round that class of open cells (by kind and level) is divided which owes the most uncertainty per cell.
//!
//! Sources: mean-value form and inclusion: Moore 1966; gradients at kinks: Clarke 1983; parts of a cell under a plane:
//! the volume-of-fluid method (Scardovelli and Zaleski 2000), in a form that does not cancel. The sum of fluxes is ours.

mod examine;
mod grid;
pub(crate) mod pieces;
mod plane;
mod totals;

use examine::{Examiner, Found, Open, Surface};
use fieldstone_field::{Bindings, Field, LANES};
use grid::{Cell, Grid};
use pieces::Pieces;
use plane::Range;
use rayon::prelude::*;
use std::collections::BTreeMap;
use totals::Inside;

/// How many open cells may be kept at a time.
const MOST_CELLS: usize = 1_200_000;

/// How closely to measure, and for how long.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeasureOptions {
    /// The width that the bounds of volume and area may have, relative to their values.
    pub tolerance: f64,
    /// How many operations may be spent, over all cells; then the bounds are just wider.
    pub operations: u64,
}

impl Default for MeasureOptions {
    /// 10⁻³, and some seconds at most.
    fn default() -> Self {
        Self { tolerance: 1e-3, operations: 6_000_000_000 }
    }
}

/// A number between two bounds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Enclosure {
    /// It is not below this.
    pub lower: f64,
    /// It is not above this.
    pub upper: f64,
}

impl Enclosure {
    /// The distance between the bounds.
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// Whether the width is at most `tolerance` times the lower bound.
    fn is_within(&self, tolerance: f64) -> bool {
        self.width() <= tolerance * self.lower
    }
}

impl From<Range> for Enclosure {
    fn from(range: Range) -> Self {
        Self { lower: range.lo, upper: range.hi }
    }
}

/// A box: lower and upper corner.
pub type Corners = ([f64; 3], [f64; 3]);

/// Certified sizes of the part of a solid that lies in a box.
///
/// The solid is where the field is negative. Where the field may be undefined, upper bounds count it as inside, lower
/// bounds as outside. All lengths are in units of the model.
#[derive(Clone, PartialEq, Debug)]
pub struct Measures {
    /// The volume; where the box cuts the solid, it ends at the box.
    pub volume: Enclosure,
    /// The area of the surface, where the field passes through 0: the faces that the box cuts are not counted. The
    /// upper bound is infinite where the gradient cannot be told from 0, at the tip of a cone, say.
    pub area: Enclosure,
    /// The centre of mass along each axis; `None` if no volume is certain.
    pub centroid: Option<[Enclosure; 3]>,
    /// A box that holds the solid; `None` if there is certainly none.
    pub outer: Option<Corners>,
    /// A box to each face of which the solid comes; `None` if no part of it is certain.
    pub inner: Option<Corners>,
    /// The volume of cells in which the field may be undefined.
    pub undefined: f64,
    /// Whether volume and area are as close as was asked.
    pub reached: bool,
    /// Whether no more cells could be kept, so that more operations would change nothing.
    pub full: bool,
    /// How many cells were looked at.
    pub cells: u64,
}

/// Measures the part of a solid that lies in a box; `None` if the box is not finite, or empty.
///
/// The number of threads does not change the result.
///
/// ```
/// use fieldstone_field::{Bindings, Field, Graph, Input};
/// use fieldstone_space::{MeasureOptions, measure};
///
/// let mut graph = Graph::new();
/// let squares = [0, 1, 2].map(|i| {
///     let x = graph.input(Input::Coordinate(i));
///     graph.square(x)
/// });
/// let sum = graph.add(squares[0], squares[1]);
/// let sum = graph.add(sum, squares[2]);
/// let one = graph.constant(1.0);
/// let ball = graph.sub(sum, one);
/// let field = Field::new(graph, ball, vec![]);
///
/// let options = MeasureOptions { tolerance: 0.01, ..MeasureOptions::default() };
/// let measures = measure(&field, &Bindings::new(), ([-1.5; 3], [1.5; 3]), &options).unwrap();
/// let volume = 4.0 / 3.0 * std::f64::consts::PI;
/// assert!(measures.volume.lower <= volume && volume <= measures.volume.upper);
/// assert!(measures.volume.width() < 0.01 * volume);
/// ```
pub fn measure(
    field: &Field,
    bindings: &Bindings,
    (min, max): Corners,
    options: &MeasureOptions,
) -> Option<Measures> {
    let grid = Grid::new(min, max)?;
    let pieces = Pieces::new(field, bindings);
    let mut octree = Octree::new(&pieces, grid);
    octree.examine(&[Cell::ROOT]);
    while !octree.is_close(options.tolerance) {
        let left = options.operations.saturating_sub(octree.operations);
        let (affordable, class) = (octree.affordable(left), octree.most_doubtful(options.tolerance));
        let Some(class) = class.filter(|_| affordable > 0) else { break };
        octree.refine(class, affordable);
    }
    Some(octree.measures(options.tolerance))
}

/// A kind of open cells (0: one plane, 1: edges, 2: anything) and their level.
type Class = (u8, u8);

/// Open cells of one class, and sums over them.
struct Cells {
    open: Vec<Open>,
    /// Bounds of the volume that is inside.
    volume: Range,
    /// About the area.
    area: f64,
    /// About how much of that is in doubt.
    doubt: f64,
}

impl Default for Cells {
    fn default() -> Self {
        Self { open: Vec::new(), volume: Range::point(0.0), area: 0.0, doubt: 0.0 }
    }
}

/// The cells found so far.
struct Octree<'p> {
    pieces: &'p Pieces,
    grid: Grid,
    inside: Inside,
    classes: BTreeMap<Class, Cells>,
    operations: u64,
    cells: u64,
    /// How many times the doubt about the area exceeded what the cells say.
    doubt_scale: f64,
}

impl<'p> Octree<'p> {
    fn new(pieces: &'p Pieces, grid: Grid) -> Self {
        let classes = BTreeMap::new();
        Self { pieces, grid, inside: Inside::default(), classes, operations: 0, cells: 0, doubt_scale: 1.0 }
    }

    fn open_cells(&self) -> impl Iterator<Item = &Open> + Clone {
        self.classes.values().flat_map(|class| &class.open)
    }

    /// Looks at cells that nobody has looked at.
    fn examine(&mut self, cells: &[Cell]) {
        let (pieces, grid) = (self.pieces, self.grid);
        let look = |examiner: &mut Examiner<'p>, some: &[Cell]| {
            let before = examiner.operations;
            let found = examiner.examine(some);
            (found, examiner.operations - before)
        };
        let examined: Vec<(Vec<Found>, u64)> =
            cells.par_chunks(LANES).map_init(|| Examiner::new(pieces, grid), look).collect();
        self.cells += cells.len() as u64;
        for (found, operations) in examined {
            self.operations += operations;
            found.into_iter().for_each(|found| self.sort_in(found));
        }
    }

    fn sort_in(&mut self, found: Found) {
        match found {
            Found::Outside => {}
            Found::Inside(cell) => self.inside.add(&self.grid, cell),
            Found::Open(open) => {
                let kind = match open.surface {
                    Surface::Plane(_) => 0,
                    Surface::Edges { .. } => 1,
                    Surface::Rough | Surface::Undefined => 2,
                };
                let class = self.classes.entry((kind, open.cell.level)).or_default();
                let volume = totals::volume(&self.grid.extent(open.cell));
                class.volume = class.volume + volume * open.fraction;
                class.area += open.area;
                class.doubt += open.doubt;
                class.open.push(open);
            }
        }
    }

    fn volume(&self) -> Range {
        self.classes.values().fold(self.inside.volume, |sum, class| sum + class.volume)
    }

    fn area(&self) -> Range {
        totals::area(&self.grid, self.open_cells())
    }

    fn about_area(&self) -> f64 {
        self.classes.values().map(|class| class.area).sum()
    }

    /// Whether no more is to be gained: the bounds are close, or there is no upper one for the area and what
    /// could be had is.
    fn is_close(&mut self, tolerance: f64) -> bool {
        if !Enclosure::from(self.volume()).is_within(tolerance) {
            return false;
        }
        let doubt: f64 = self.classes.values().map(|class| class.doubt).sum();
        if doubt * self.doubt_scale > tolerance * self.about_area() {
            return false;
        }
        // The sum proper takes longer: it is asked again when the doubt has fallen as far as seems necessary.
        let area = Enclosure::from(self.area());
        let is_close = area.is_within(tolerance) || area.upper.is_infinite();
        self.doubt_scale = (1.1 * area.width() / doubt).max(self.doubt_scale);
        is_close
    }

    /// The class that owes the most for each of its cells.
    fn most_doubtful(&self, tolerance: f64) -> Option<Class> {
        let volume = self.volume();
        let is_close = Enclosure::from(volume).is_within(tolerance);
        let (volume, area) = (0.5 * (volume.lo + volume.hi), self.about_area());
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { part };
        let doubt = |class: &Cells| {
            let in_volume = if is_close { 0.0 } else { share(class.volume.width(), volume) };
            (in_volume + share(class.doubt, area)) / class.open.len() as f64
        };
        let divisible = self.classes.iter().filter(|((_, level), _)| self.grid.divides(*level));
        let rated = divisible.map(|(&class, cells)| (class, doubt(cells)));
        rated.filter(|(_, doubt)| *doubt > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(class, _)| class)
    }

    /// How many cells may be divided with so many operations, and before there are too many.
    fn affordable(&self, operations: u64) -> usize {
        // About half of the parts of an open cell are open themselves, and are looked at more closely.
        let each = 8 * (2 * self.pieces.values.len() + self.pieces.gradients.len() / 2)
            + 4 * examine::PLANE_OPERATIONS;
        let in_time = usize::try_from(operations / each as u64).unwrap_or(usize::MAX);
        in_time.min(self.room())
    }

    /// How many cells may be divided before there are too many.
    fn room(&self) -> usize {
        MOST_CELLS.saturating_sub(self.open_cells().count()) / 4
    }

    /// Divides the cells of a class, `most` of them at most. They stand in the order of the octree, so that the first
    /// of them lie together.
    fn refine(&mut self, class: Class, most: usize) {
        let Some(mut cells) = self.classes.remove(&class) else { return };
        let kept = cells.open.split_off(most.min(cells.open.len()));
        let parts: Vec<Cell> = cells.open.into_iter().flat_map(|open| open.cell.parts()).collect();
        kept.into_iter().for_each(|open| self.sort_in(Found::Open(open)));
        self.examine(&parts);
    }

    /// The boxes around the solid: one that holds it, one that it reaches.
    fn boxes(&self) -> (Option<[Range; 3]>, Option<[Range; 3]>) {
        let join = |a: Option<[Range; 3]>, b: Option<[Range; 3]>| match (a, b) {
            (Some(a), Some(b)) => Some(examine::hull(&a, &b)),
            (one, other) => one.or(other),
        };
        let certain = self.inside.hull;
        let sticks_out = |open: &&Open| {
            let extent = self.grid.extent(open.cell);
            certain.is_none_or(|hull| (0..3).any(|i| extent[i].lo < hull[i].lo || extent[i].hi > hull[i].hi))
        };
        let cells: Vec<Cell> = self.open_cells().filter(sticks_out).map(|open| open.cell).collect();
        let look = |examiner: &mut Examiner<'p>, some: &[Cell]| examiner.reaches(some);
        let reaches: Vec<_> =
            cells.par_chunks(LANES).map_init(|| Examiner::new(self.pieces, self.grid), look).collect();
        let (mut outer, mut inner) = (certain, certain);
        for reach in reaches.into_iter().flatten() {
            (outer, inner) = (join(outer, reach.outer), join(inner, reach.inner));
        }
        (outer, inner)
    }

    fn measures(&self, tolerance: f64) -> Measures {
        let corners = |sides: [Range; 3]| (sides.map(|side| side.lo), sides.map(|side| side.hi));
        let (volume, area) = (Enclosure::from(self.volume()), Enclosure::from(self.area()));
        let (outer, inner) = self.boxes();
        let undefined = self.open_cells().filter(|open| matches!(open.surface, Surface::Undefined));
        Measures {
            volume,
            area,
            centroid: self.centroid(outer),
            outer: outer.map(corners),
            inner: inner.map(corners),
            undefined: undefined.fold(0.0, |sum, open| sum + totals::volume(&self.grid.extent(open.cell)).hi),
            reached: volume.is_within(tolerance) && area.is_within(tolerance),
            full: self.room() == 0,
            cells: self.cells,
        }
    }

    /// The bounds of the centroid, which lies in the outer box too.
    fn centroid(&self, outer: Option<[Range; 3]>) -> Option<[Enclosure; 3]> {
        let (centroid, outer) = (self.inside.centroid(&self.grid, self.volume(), self.open_cells())?, outer?);
        Some([0, 1, 2].map(|i| Enclosure {
            lower: centroid[i].lo.max(outer[i].lo),
            upper: centroid[i].hi.min(outer[i].hi),
        }))
    }
}

#[cfg(test)]
mod tests;
