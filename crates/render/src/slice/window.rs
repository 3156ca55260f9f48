//! Which part of a plane to show.

use super::SliceError;
use fieldstone_field::{Bindings, F64, Field, Input, Intervals, LANES, Points, Tape, TapeOptions, Workspace};

/// A rectangle on a plane.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Window {
    /// The lower left corner.
    pub min: [f64; 2],
    /// The upper right corner.
    pub max: [f64; 2],
}

impl Window {
    /// From minus to plus `half` along both axes.
    pub const fn centred(half: f64) -> Self {
        Self { min: [-half; 2], max: [half; 2] }
    }

    pub(super) fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    pub(super) fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    pub(super) fn check(&self) -> Result<(), SliceError> {
        let is_good = |k: usize| {
            let (size, far) = (self.max[k] - self.min[k], self.min[k].abs().max(self.max[k].abs()));
            size.is_finite() && size > far * 1e-11 && size > 1e-290
        };
        if is_good(0) && is_good(1) {
            return Ok(());
        }
        Err(SliceError::Window { min: self.min, max: self.max })
    }

    /// Longer by this part of the longer side on every side.
    fn padded(&self, part: f64) -> Self {
        let margin = part * self.width().max(self.height());
        Self { min: self.min.map(|x| x - margin), max: self.max.map(|x| x + margin) }
    }
}

/// What is known about the extent of a section.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum WindowExtent {
    /// The window holds it, as far as intervals and samples show.
    Bounded,
    /// It reaches beyond ±1000.
    Unbounded,
    /// No place inside was found.
    Empty,
}

/// A window around a section.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FoundWindow {
    /// The window, a little larger than the section; from −10 to 10 unless the section is bounded.
    pub window: Window,
    /// Whether it is that.
    pub extent: WindowExtent,
}

/// Half the sides of the windows that are searched.
const SEARCHES: [f64; 2] = [10.0, 1000.0];

/// The number of cells along each side of a search.
const CELLS: usize = 64;

/// How often the window is searched again as closely as its cells can.
const REFINEMENTS: usize = 3;

/// What is left free on every side of a section, as a part of its longer side.
const MARGIN: f64 = 0.12;

/// The smallest window around the places of a plane where a field is inside.
///
/// `axes` are the coordinates of the plane, counted from 0; `bindings` hold all others. A grid of boxes is evaluated over
/// intervals, then a closer one around those that may be inside.
pub fn find_window(field: &Field, bindings: &Bindings, axes: [u16; 2]) -> FoundWindow {
    let options = TapeOptions {
        varying: axes.map(Input::Coordinate).to_vec(),
        bindings: bindings.clone(),
        ..TapeOptions::default()
    };
    let tape = Tape::new(field, &options);
    let mut search = Search { tape: &tape, boxes: Workspace::new(), points: Workspace::new() };
    let fallback = |extent| FoundWindow { window: Window::centred(SEARCHES[0]), extent };
    for half in SEARCHES {
        let around = Window::centred(half);
        let Some(mut found) = search.run(&around) else { continue };
        if found.touches {
            continue;
        }
        for _ in 0..REFINEMENTS {
            let closer = found.hull.padded(2.0 / CELLS as f64);
            match search.run(&closer) {
                Some(next) => found = next,
                None => break,
            }
        }
        return match found.any_inside {
            true => FoundWindow { window: found.hull.padded(MARGIN), extent: WindowExtent::Bounded },
            false => fallback(WindowExtent::Empty),
        };
    }
    let last = search.run(&Window::centred(SEARCHES[1]));
    fallback(if last.is_some() { WindowExtent::Unbounded } else { WindowExtent::Empty })
}

struct Search<'t> {
    tape: &'t Tape,
    boxes: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
}

/// The cells that may be inside.
struct Cells {
    hull: Window,
    /// Whether one of them lies at the edge.
    touches: bool,
    /// Whether there is a place that is inside.
    any_inside: bool,
}

impl Search<'_> {
    /// `None` if nothing is inside.
    fn run(&mut self, around: &Window) -> Option<Cells> {
        let nothing = Window { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        let mut cells = Cells { hull: nothing, touches: false, any_inside: false };
        for j in 0..CELLS {
            self.row(around, j, &mut cells);
        }
        (cells.hull.min[0] < cells.hull.max[0]).then_some(cells)
    }

    /// A row of cells, which are as many as there are lanes.
    fn row(&mut self, around: &Window, j: usize, cells: &mut Cells) {
        const { assert!(CELLS == LANES) };
        let end = |k: usize, number: f64| {
            let part = number / CELLS as f64;
            around.min[k] + (around.max[k] - around.min[k]) * part
        };
        for i in 0..CELLS {
            for (axis, number) in [i, j].into_iter().enumerate() {
                self.boxes.input(axis, 0)[i] = end(axis, number as f64);
                self.boxes.input(axis, 1)[i] = end(axis, number as f64 + 1.0);
                self.points.input(axis, 0)[i] = end(axis, number as f64 + 0.5);
            }
        }
        self.boxes.run(self.tape, CELLS);
        self.points.run(self.tape, CELLS);
        for i in 0..CELLS {
            let (low, high) = (self.boxes.output(0, 0)[i], self.boxes.output(0, 1)[i]);
            let inside = self.points.output(0, 0)[i] < 0.0;
            // Where nothing is known about the values of a cell, its middle decides.
            if !(inside || low <= 0.0) {
                continue;
            }
            cells.any_inside |= inside || high < 0.0;
            cells.touches |= [i, j].iter().any(|&n| n == 0 || n + 1 == CELLS);
            for (axis, number) in [i, j].into_iter().enumerate() {
                cells.hull.min[axis] = cells.hull.min[axis].min(end(axis, number as f64));
                cells.hull.max[axis] = cells.hull.max[axis].max(end(axis, number as f64 + 1.0));
            }
        }
    }
}
