//! What is found out about cells.

use super::grid::{Cell, Grid, sides};
use super::pieces::{Part, Pieces};
use super::plane::{Plane, Range};
use fieldstone_field::{F64, Intervals, LANES, Tape, Workspace};

/// What putting a plane to a piece in a cell costs besides evaluation, in operations on lanes.
pub(super) const PLANE_OPERATIONS: usize = 1000;

/// What is known of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// The field is negative all over this cell.
    Inside(Cell),
    /// It is nowhere negative.
    Outside,
    /// Neither is known.
    Open(Open),
}

/// A cell through which the surface may go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) cell: Cell,
    /// Bounds of the part of the cell that is inside.
    pub(super) fraction: Range,
    pub(super) surface: Surface,
    /// About the area of the surface in the cell.
    pub(super) area: f64,
    /// About how much of the area dividing the cell may clear up.
    pub(super) doubt: f64,
}

/// What is known of the surface in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Surface {
    /// It is one piece with a direction that its normal is never across.
    Plane(Plane),
    /// It is made of several such pieces, at most of this area together.
    Edges {
        /// An upper bound of the area.
        area: f64,
    },
    /// The gradient may vanish, or have no bounds.
    Rough,
    /// The field may be undefined.
    Undefined,
}

/// Where a part of the solid lies in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Everything lies in it; `None`: there is nothing.
    pub(super) outer: Option<[Range; 3]>,
    /// Some of it lies near each of its faces; `None`: nothing is certain.
    pub(super) inner: Option<[Range; 3]>,
    /// Whether all of the cell is inside.
    full: bool,
}

impl Reach {
    fn unknown(extent: [Range; 3]) -> Self {
        Self { outer: Some(extent), inner: None, full: false }
    }
}

/// What is known of a piece in a cell.
#[derive(Clone, Copy, Debug)]
enum Knowledge {
    Negative,
    /// Nowhere negative.
    Positive,
    Plane(Plane),
    /// Anything.
    Open,
    Undefined,
}

/// Examines up to 64 cells at a time; keeps its memory between calls.
#[derive(Debug)]
pub(super) struct Examiner<'p> {
    pieces: &'p Pieces,
    grid: Grid,
    workspace: Workspace<F64, Intervals>,
    /// For each piece of each lane.
    knowledge: Vec<Knowledge>,
    /// Operations on lanes so far.
    pub(super) operations: u64,
}

impl<'p> Examiner<'p> {
    pub(super) fn new(pieces: &'p Pieces, grid: Grid) -> Self {
        Self { pieces, grid, workspace: Workspace::new(), knowledge: Vec::new(), operations: 0 }
    }

    /// What is known of each of some cells, in their order.
    pub(super) fn examine(&mut self, cells: &[Cell]) -> Vec<Found> {
        let mut all = Vec::with_capacity(cells.len());
        for some in cells.chunks(LANES) {
            self.learn(some);
            let known = self.knowledge.chunks(self.pieces.count);
            all.extend(some.iter().zip(known).map(|(&cell, known)| self.found(cell, known)));
        }
        all
    }

    /// Where in each of some cells the solid is, in their order.
    pub(super) fn reaches(&mut self, cells: &[Cell]) -> Vec<Reach> {
        let mut all = Vec::with_capacity(cells.len());
        for some in cells.chunks(LANES) {
            self.learn(some);
            let known = self.knowledge.chunks(self.pieces.count);
            all.extend(some.iter().zip(known).map(|(&cell, known)| self.reach(cell, known)));
        }
        all
    }

    /// Learns what there is to know of at most 64 cells.
    fn learn(&mut self, cells: &[Cell]) {
        let pieces = self.pieces;
        let extents: Vec<[Range; 3]> = cells.iter().map(|&cell| self.grid.extent(cell)).collect();
        self.run(&pieces.values, &extents);
        self.knowledge.clear();
        for lane in 0..cells.len() {
            for piece in 0..pieces.count {
                self.knowledge.push(match self.output(piece, lane) {
                    range if range.lo.is_nan() || range.hi.is_nan() => Knowledge::Undefined,
                    range if range.lo >= 0.0 => Knowledge::Positive,
                    range if range.hi < 0.0 => Knowledge::Negative,
                    _ => Knowledge::Open,
                });
            }
        }
        let known = self.knowledge.chunks(pieces.count);
        let is_open =
            |known: &[Knowledge]| !is_undefined(pieces, known) && status(pieces, known) == Status::Open;
        let open: Vec<usize> = known.enumerate().filter(|(_, k)| is_open(k)).map(|(lane, _)| lane).collect();
        if !open.is_empty() {
            self.fit_planes(&open, &extents);
        }
    }

    /// Puts planes to the open pieces of the cells in some lanes.
    fn fit_planes(&mut self, open: &[usize], extents: &[[Range; 3]]) {
        let pieces = self.pieces;
        let boxes: Vec<[Range; 3]> = open.iter().map(|&lane| extents[lane]).collect();
        let centres: Vec<[Range; 3]> =
            boxes.iter().map(|cell| cell.map(|side| Range::point(0.5 * side.lo + 0.5 * side.hi))).collect();
        self.run(&pieces.values, &centres);
        let values: Vec<Range> =
            (0..open.len() * pieces.count).map(|i| self.output(i % pieces.count, i / pieces.count)).collect();
        self.run(&pieces.gradients, &boxes);
        for (place, &lane) in open.iter().enumerate() {
            for piece in 0..pieces.count {
                let known = lane * pieces.count + piece;
                if !matches!(self.knowledge[known], Knowledge::Open) {
                    continue;
                }
                self.operations += PLANE_OPERATIONS as u64;
                let slopes = [0, 1, 2].map(|axis| self.output(3 * piece + axis, place));
                let value = values[place * pieces.count + piece];
                if let Some(plane) = Plane::new(&boxes[place], value, &slopes) {
                    let fraction = plane.fraction();
                    self.knowledge[known] = match (fraction.lo >= 1.0, fraction.hi <= 0.0) {
                        (true, _) => Knowledge::Negative,
                        (_, true) => Knowledge::Positive,
                        _ => Knowledge::Plane(plane),
                    };
                }
            }
        }
    }

    fn run(&mut self, tape: &Tape, boxes: &[[Range; 3]]) {
        for axis in 0..3 {
            for (lane, cell) in boxes.iter().enumerate() {
                self.workspace.input(axis, 0)[lane] = cell[axis].lo;
                self.workspace.input(axis, 1)[lane] = cell[axis].hi;
            }
        }
        self.workspace.run(tape, boxes.len());
        self.operations += (tape.len().max(1) * boxes.len()) as u64;
    }

    fn output(&self, output: usize, lane: usize) -> Range {
        Range::new(self.workspace.output(output, 0)[lane], self.workspace.output(output, 1)[lane])
    }

    fn found(&self, cell: Cell, known: &[Knowledge]) -> Found {
        let sides = sides(&self.grid.extent(cell));
        let faces = [0, 1, 2].map(|axis| face_area(&sides, axis).hi);
        let open = |fraction, surface| {
            let doubt = faces.iter().sum();
            Found::Open(Open { cell, fraction, surface, area: 0.0, doubt })
        };
        if is_undefined(self.pieces, known) {
            return open(Range::new(0.0, 1.0), Surface::Undefined);
        }
        match status(self.pieces, known) {
            Status::Inside => return Found::Inside(cell),
            Status::Outside => return Found::Outside,
            Status::Open => {}
        }
        let fraction = fraction(self.pieces, known);
        let Some(planes) = self.planes(known) else { return open(fraction, Surface::Rough) };
        let areas = planes.iter().map(|plane| local_area(plane, &sides));
        let area = areas.fold(Range::point(0.0), |sum, area| sum + area);
        let surface = match planes.as_slice() {
            &[plane] => Surface::Plane(plane),
            _ => Surface::Edges { area: area.hi },
        };
        // The flux of a plane is shared with its neighbours, and not in doubt but for its direction.
        let doubt = match &surface {
            Surface::Plane(plane) => 2.0 * area.hi * (1.0 - 1.0 / plane.secant),
            _ => area.hi,
        };
        Found::Open(Open { cell, fraction, surface, area: 0.5 * (area.lo + area.hi), doubt })
    }

    /// The planes of all pieces that matter in an open cell, if each has one that its normal is never across.
    fn planes(&self, known: &[Knowledge]) -> Option<Vec<Plane>> {
        let relevant = relevant_pieces(self.pieces, known).into_iter();
        let plane = |piece: usize| match known[piece] {
            Knowledge::Plane(plane) if plane.secant.is_finite() => Some(plane),
            _ => None,
        };
        relevant.map(plane).collect()
    }

    fn reach(&self, cell: Cell, known: &[Knowledge]) -> Reach {
        let extent = self.grid.extent(cell);
        if is_undefined(self.pieces, known) {
            return Reach::unknown(extent);
        }
        let mut all: Vec<Reach> = Vec::with_capacity(self.pieces.parts.len());
        for part in &self.pieces.parts {
            let reach = match *part {
                Part::Piece(piece) => reach_of(&extent, &known[piece]),
                Part::Union(a, b) => Reach {
                    outer: both(all[a].outer, all[b].outer, hull),
                    inner: both(all[a].inner, all[b].inner, hull),
                    full: all[a].full || all[b].full,
                },
                Part::Intersection(a, b) => Reach {
                    outer: all[a].outer.zip(all[b].outer).and_then(|(a, b)| common(&a, &b)),
                    // What one of the two reaches where the other is everywhere.
                    inner: match (all[a].full, all[b].full) {
                        (true, _) => all[b].inner,
                        (_, true) => all[a].inner,
                        _ => None,
                    },
                    full: all[a].full && all[b].full,
                },
            };
            all.push(reach);
        }
        all.pop().unwrap_or(Reach::unknown(extent))
    }
}

/// Bounds of the area of the surface that crosses a cell close to one plane.
///
/// With d a direction and n the unit normal ∇f/|∇f|, the part S of the surface in the cell has
/// Φ = ∫ n·d dS ≤ area(S) ≤ Φ·secant. And Φ, the area of the projection of S along d, is what flows in through the faces:
/// the constant field d has no sources, so by Gauss it is −Σ d·ν T, where ν are the outer normals of the faces and T
/// the areas of their parts where the field is negative.
pub(super) fn local_area(plane: &Plane, sides: &[Range; 3]) -> Range {
    let flux = (0..3).fold(Range::point(0.0), |sum, axis| {
        let parts = plane.face_fraction(axis, false) - plane.face_fraction(axis, true);
        sum + Range::point(plane.direction[axis]) * face_area(sides, axis) * parts
    });
    let most = (Range::point(flux.hi) * Range::point(plane.secant)).hi;
    Range::new(flux.lo.max(0.0), most.max(0.0))
}

/// The area of a face across an axis.
pub(super) fn face_area(sides: &[Range; 3], axis: usize) -> Range {
    sides[(axis + 1) % 3] * sides[(axis + 2) % 3]
}

/// Whether a piece may be undefined, and with it the field, unless that is certainly undefined, which is outside.
fn is_undefined(pieces: &Pieces, known: &[Knowledge]) -> bool {
    let is_outside = pieces.domain.is_some_and(|piece| matches!(known[piece], Knowledge::Positive));
    !is_outside && known.iter().any(|k| matches!(k, Knowledge::Undefined))
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Status {
    Inside,
    Outside,
    Open,
}

fn status(pieces: &Pieces, known: &[Knowledge]) -> Status {
    statuses(pieces, known).last().copied().unwrap_or(Status::Open)
}

/// The status of every part.
fn statuses(pieces: &Pieces, known: &[Knowledge]) -> Vec<Status> {
    use Status::{Inside, Open, Outside};
    let mut all: Vec<Status> = Vec::with_capacity(pieces.parts.len());
    for part in &pieces.parts {
        all.push(match *part {
            Part::Piece(piece) => match known[piece] {
                Knowledge::Negative => Inside,
                Knowledge::Positive => Outside,
                _ => Open,
            },
            Part::Union(a, b) => match (all[a], all[b]) {
                (Inside, _) | (_, Inside) => Inside,
                (Outside, Outside) => Outside,
                _ => Open,
            },
            Part::Intersection(a, b) => match (all[a], all[b]) {
                (Outside, _) | (_, Outside) => Outside,
                (Inside, Inside) => Inside,
                _ => Open,
            },
        });
    }
    all
}

/// The open pieces on which it depends whether points of an open cell are inside.
fn relevant_pieces(pieces: &Pieces, known: &[Knowledge]) -> Vec<usize> {
    let statuses = statuses(pieces, known);
    let mut relevant = vec![false; pieces.parts.len()];
    let mut found = Vec::new();
    if let Some(whole) = relevant.last_mut() {
        *whole = true;
    }
    for (place, part) in pieces.parts.iter().enumerate().rev() {
        if !relevant[place] || statuses[place] != Status::Open {
            continue;
        }
        match *part {
            Part::Piece(piece) => found.push(piece),
            Part::Union(a, b) | Part::Intersection(a, b) => (relevant[a], relevant[b]) = (true, true),
        }
    }
    found
}

/// Bounds of the part of a cell that is inside (Fréchet 1935 for the set operations).
fn fraction(pieces: &Pieces, known: &[Knowledge]) -> Range {
    let mut all: Vec<Range> = Vec::with_capacity(pieces.parts.len());
    for part in &pieces.parts {
        all.push(match *part {
            Part::Piece(piece) => match &known[piece] {
                Knowledge::Negative => Range::point(1.0),
                Knowledge::Positive => Range::point(0.0),
                Knowledge::Plane(plane) => plane.fraction(),
                Knowledge::Open | Knowledge::Undefined => Range::new(0.0, 1.0),
            },
            Part::Union(a, b) => {
                let (a, b) = (all[a], all[b]);
                Range::new(a.lo.max(b.lo), (Range::point(a.hi) + Range::point(b.hi)).hi.min(1.0))
            }
            Part::Intersection(a, b) => {
                let (a, b) = (all[a], all[b]);
                let both = Range::point(a.lo) + Range::point(b.lo) - Range::point(1.0);
                Range::new(both.lo.max(0.0), a.hi.min(b.hi))
            }
        });
    }
    all.pop().unwrap_or(Range::new(0.0, 1.0))
}

fn reach_of(extent: &[Range; 3], known: &Knowledge) -> Reach {
    match known {
        Knowledge::Negative => Reach { outer: Some(*extent), inner: Some(*extent), full: true },
        Knowledge::Positive => Reach { outer: None, inner: None, full: false },
        Knowledge::Open | Knowledge::Undefined => Reach::unknown(*extent),
        Knowledge::Plane(plane) => Reach {
            outer: placed(extent, 1.0, |axis| plane.outer_reach(axis)),
            inner: placed(extent, -1.0, |axis| plane.inner_reach(axis)),
            full: false,
        },
    }
}

/// Places −1 … 1 in a cell as coordinates, moved outward by rounding errors if `outward` is 1, inward if it is −1.
fn placed(extent: &[Range; 3], outward: f64, reach: impl Fn(usize) -> Option<Range>) -> Option<[Range; 3]> {
    let mut all = *extent;
    for (axis, side) in all.iter_mut().enumerate() {
        let places = reach(axis)?;
        let (middle, half) = (0.5 * side.lo + 0.5 * side.hi, 0.5 * (side.hi - side.lo));
        let slack = 8.0 * f64::EPSILON * (middle.abs() + half) * outward;
        let lo = if places.lo <= -1.0 { side.lo } else { middle + half * places.lo - slack };
        let hi = if places.hi >= 1.0 { side.hi } else { middle + half * places.hi + slack };
        *side = Range::new(lo.clamp(side.lo, side.hi), hi.clamp(side.lo, side.hi));
        if side.lo > side.hi {
            return None;
        }
    }
    Some(all)
}

fn both<T>(a: Option<T>, b: Option<T>, join: impl Fn(&T, &T) -> T) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(join(&a, &b)),
        (one, other) => one.or(other),
    }
}

/// The smallest box around two.
pub(super) fn hull(a: &[Range; 3], b: &[Range; 3]) -> [Range; 3] {
    [0, 1, 2].map(|i| Range::new(a[i].lo.min(b[i].lo), a[i].hi.max(b[i].hi)))
}

fn common(a: &[Range; 3], b: &[Range; 3]) -> Option<[Range; 3]> {
    let both = [0, 1, 2].map(|i| Range::new(a[i].lo.max(b[i].lo), a[i].hi.min(b[i].hi)));
    both.iter().all(|side| side.lo <= side.hi).then_some(both)
}
