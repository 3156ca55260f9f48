//! Sums over cells, rounded outward.

use super::examine::{Open, Surface, face_area, local_area};
use super::grid::{Cell, Grid, sides};
use super::plane::{Plane, Range};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

const NOTHING: Range = Range::new(0.0, 0.0);

/// Volume and first moments of cells that are inside all over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    pub(super) volume: Range,
    /// ∫ (x − middle of the grid) dV.
    moment: [Range; 3],
    /// The smallest box around the cells.
    pub(super) hull: Option<[Range; 3]>,
}

impl Default for Inside {
    fn default() -> Self {
        Self { volume: NOTHING, moment: [NOTHING; 3], hull: None }
    }
}

impl Inside {
    pub(super) fn add(&mut self, grid: &Grid, cell: Cell) {
        let extent = grid.extent(cell);
        let volume = volume(&extent);
        self.volume = self.volume + volume;
        let (half, centre) = (Range::point(0.5), grid.centre());
        for axis in 0..3 {
            let ends = Range::point(extent[axis].lo) + Range::point(extent[axis].hi);
            let arm = ends * half - Range::point(centre[axis]);
            self.moment[axis] = self.moment[axis] + arm * volume;
        }
        self.hull = Some(self.hull.map_or(extent, |hull| super::examine::hull(&hull, &extent)));
    }

    /// Bounds of the centroid along each axis of a solid with the volume `total`, if some of it is certain.
    ///
    /// Moments are taken about a point close to the centroid, so that what is uncertain of the volume moves it little.
    pub(super) fn centroid<'o>(
        &self,
        grid: &Grid,
        total: Range,
        open: impl Iterator<Item = &'o Open> + Clone,
    ) -> Option<[Range; 3]> {
        if total.lo <= 0.0 {
            return None;
        }
        let (middle, centre) = (0.5 * (total.lo + total.hi), grid.centre());
        let mut about = centre;
        for cell in open.clone() {
            let extent = grid.extent(cell.cell);
            let weight = volume(&extent).lo * (0.5 * (cell.fraction.lo + cell.fraction.hi)) / middle;
            (0..3).for_each(|i| about[i] += weight * (0.5 * (extent[i].lo + extent[i].hi) - centre[i]));
        }
        for (x, moment) in about.iter_mut().zip(&self.moment) {
            *x += 0.5 * (moment.lo + moment.hi) / middle;
        }
        let mut moments = [0, 1, 2].map(|i| {
            let arm = Range::point(about[i]) - Range::point(centre[i]);
            self.moment[i] - arm * self.volume
        });
        for cell in open {
            let extent = grid.extent(cell.cell);
            let volume = volume(&extent);
            for (i, moment) in moments.iter_mut().enumerate() {
                *moment = *moment + moment_of(cell, extent[i], i, about[i]) * volume;
            }
        }
        Some([0, 1, 2].map(|i| moments[i] / total + Range::point(about[i])))
    }
}

/// ∫ (x − about) dV over the part of an open cell that is inside, along one axis and in units of the cell's volume.
fn moment_of(open: &Open, side: Range, axis: usize, about: f64) -> Range {
    let about = Range::point(about);
    match &open.surface {
        Surface::Plane(plane) => {
            let half = Range::point(0.5);
            let middle = (Range::point(side.lo) + Range::point(side.hi)) * half;
            let reach = (Range::point(side.hi) - Range::point(side.lo)) * half;
            (middle - about) * open.fraction + reach * plane.moment(axis)
        }
        _ => (side - about) * open.fraction,
    }
}

/// The volume of a box.
pub(super) fn volume(extent: &[Range; 3]) -> Range {
    let [x, y, z] = sides(extent);
    x * y * z
}

/// Bounds of the area of the surface in open cells; the upper one is infinite if there is none.
///
/// For each cell that one piece crosses, [`local_area`] gives Φ ≤ area ≤ Φ·secant with Φ = −Σ d·ν T over its faces. In
/// the sum of all Φ a face between two cells appears twice with the same T and opposite ν, so that T counts with the
/// difference of two directions d only, which falls with the size of the cells. The secant differs from 1 by the square
/// of the angle. So the bounds close with the square of the size of the cells, although each T is known to the first
/// order only.
pub(super) fn area<'o>(grid: &Grid, open: impl Iterator<Item = &'o Open>) -> Range {
    let (mut planes, mut edges, mut is_bounded) = (Vec::new(), NOTHING, true);
    for open in open {
        match &open.surface {
            Surface::Plane(plane) => planes.push((open.cell, plane)),
            Surface::Edges { area } => edges = edges + Range::new(0.0, *area),
            Surface::Rough | Surface::Undefined => is_bounded = false,
        }
    }
    let index: FxHashMap<Cell, &Plane> = planes.iter().copied().collect();
    // Parts of a fixed size, so that the sum does not depend on the number of threads.
    let parts: Vec<Range> = planes.par_chunks(4096).map(|part| smooth_area(grid, &index, part)).collect();
    let sum = parts.into_iter().fold(edges, |sum, part| sum + part);
    Range::new(sum.lo.max(0.0), if is_bounded { sum.hi.max(0.0) } else { f64::INFINITY })
}

/// What some cells that one piece crosses add to the area.
fn smooth_area(grid: &Grid, index: &FxHashMap<Cell, &Plane>, planes: &[(Cell, &Plane)]) -> Range {
    planes.iter().fold(NOTHING, |sum, &(cell, plane)| {
        let sides = sides(&grid.extent(cell));
        let flux = (0..3).fold(NOTHING, |flux, axis| {
            flux + shared_flux(index, (cell, plane), axis) * face_area(&sides, axis)
        });
        let excess = Range::point(local_area(plane, &sides).hi) * Range::new(0.0, 1.0 - 1.0 / plane.secant);
        sum + flux + Range::new(0.0, excess.hi * (1.0 + 1e-12) + f64::EPSILON * excess.hi)
    })
}

/// What flows through the faces of a cell across an axis, in units of their area: the upper face with what the next cell
/// says of it, the lower one only if there is no such cell.
fn shared_flux(index: &FxHashMap<Cell, &Plane>, (cell, plane): (Cell, &Plane), axis: usize) -> Range {
    let own = Range::point(plane.direction[axis]);
    let above = plane.face_fraction(axis, true);
    let upper = match index.get(&cell.next(axis)) {
        Some(next) => {
            let below = next.face_fraction(axis, false);
            // Both hold; which one is narrower does not matter if they contradict each other in rounding.
            let both = Range::new(above.lo.max(below.lo), above.hi.min(below.hi));
            let part = if both.lo <= both.hi { both } else { above };
            (Range::point(next.direction[axis]) - own) * part
        }
        None => -(own * above),
    };
    let is_shared = cell.previous(axis).is_some_and(|previous| index.contains_key(&previous));
    if is_shared { upper } else { upper + own * plane.face_fraction(axis, false) }
}
