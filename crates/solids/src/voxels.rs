//! Arrays of numbers on a grid, interpolated to functions of space.
//!
//! In a cell of the grid the function is a polynomial, whose Bernstein coefficients bound it (the convex hull property); over many cells the least and greatest numbers do, kept in a pyramid of blocks of 2, 4, 8, …
//! numbers on a side, so that a box of any size costs a few look-ups.

use crate::bernstein::{Patch, gradient_room, slack};
use fieldstone_field::{Function, Interval};

/// No array is larger.
pub const MAX_VOXELS: usize = 1 << 26;

/// A box of at most so many cells is looked at cell by cell.
const FEW_CELLS: usize = 8;

/// How numbers become a function between them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Interpolation {
    /// Straight along each axis: through the numbers, with creases between cells.
    Linear,
    /// By the cubics of Catmull and Rom (1974): through the numbers, without creases; may overshoot.
    CatmullRom,
    /// By cubic B-splines: near the numbers, without creases, with continuous curvature; never overshoots.
    BSpline,
}

/// Numbers on a grid, as a function of x, y and z. Beyond the outermost numbers it is what it is at the nearest point of
/// their box.
#[derive(Clone, Debug)]
pub struct VoxelArray {
    counts: [usize; 3],
    values: Vec<f32>,
    /// Where the first number stands.
    origin: [f64; 3],
    /// How far apart neighbours are.
    steps: [f64; 3],
    interpolation: Interpolation,
    pyramid: Vec<Level>,
    /// A bound of the rounding errors of values and bounds.
    slack: f64,
}

/// Bounds of blocks.
#[derive(Clone, Debug)]
struct Level {
    counts: [usize; 3],
    ranges: Vec<[f32; 2]>,
}

/// Why numbers make no [`VoxelArray`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum VoxelError {
    /// Less than two numbers along an axis, or too many in all.
    #[error("an array has 2 or more numbers along each axis and at most {MAX_VOXELS} in all, not {} × {} × {}", .0[0], .0[1], .0[2])]
    Counts([usize; 3]),
    /// Not as many numbers as the counts say.
    #[error("the array needs {needed} numbers, and {found} are given")]
    Missing {
        /// How many it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A number that is not finite.
    #[error("the number {} of the array is not finite", .0 + 1)]
    NotFinite(usize),
    /// A placement that is none.
    #[error("the steps between numbers must be finite and above 0, the origin finite")]
    Placement,
}

impl VoxelArray {
    /// `values` are those along x first, then along y, then z; the first stands at `origin`, its neighbours `steps` away.
    ///
    /// # Errors
    /// Numbers that are missing or not finite, sizes and placements that are none.
    pub fn new(
        counts: [usize; 3],
        values: Vec<f32>,
        [origin, steps]: [[f64; 3]; 2],
        interpolation: Interpolation,
    ) -> Result<Self, VoxelError> {
        let needed = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        let needed = match needed {
            Some(needed) if needed <= MAX_VOXELS && counts.iter().all(|&n| n >= 2) => needed,
            _ => return Err(VoxelError::Counts(counts)),
        };
        if values.len() != needed {
            return Err(VoxelError::Missing { needed, found: values.len() });
        }
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            return Err(VoxelError::NotFinite(at));
        }
        let is_placed =
            steps.iter().all(|s| s.is_finite() && *s > 0.0) && origin.iter().all(|o| o.is_finite());
        if !is_placed {
            return Err(VoxelError::Placement);
        }
        let largest = values.iter().fold(0.0, |most: f64, v| most.max(f64::from(v.abs())));
        let pyramid = pyramid(counts, &values);
        // Coefficients of Catmull and Rom's cubics are up to (4/3)³ times as large as the numbers.
        let slack = slack(2.5 * largest, 4, counts);
        Ok(Self { counts, values, origin, steps, interpolation, pyramid, slack })
    }

    /// The box of the outermost numbers.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let end = [0, 1, 2].map(|k| self.origin[k] + self.steps[k] * (self.counts[k] - 1) as f64);
        [self.origin, end]
    }

    /// How many numbers there are along each axis.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// A coordinate in steps from the first number, kept in the box.
    fn place(&self, axis: usize, x: f64) -> f64 {
        ((x - self.origin[axis]) / self.steps[axis]).clamp(0.0, (self.counts[axis] - 1) as f64)
    }

    /// The cell of a place, and the position in it.
    fn cell_of(&self, axis: usize, place: f64) -> (usize, f64) {
        let cell = (place as usize).min(self.counts[axis] - 2);
        (cell, place - cell as f64)
    }

    /// The polynomial in a cell.
    fn patch(&self, cell: [usize; 3]) -> Patch {
        let value =
            |i: [usize; 3]| f64::from(self.values[i[0] + self.counts[0] * (i[1] + self.counts[1] * i[2])]);
        if self.interpolation == Interpolation::Linear {
            let corner = |c: usize| value([0, 1, 2].map(|k| cell[k] + (c >> k & 1)));
            return Patch::new([2; 3], (0..8).map(corner).collect());
        }
        // The neighbours beyond the box are those on its side.
        let index = |axis: usize, i: usize| (cell[axis] + i).saturating_sub(1).min(self.counts[axis] - 1);
        let neighbour = |c: usize| value([0, 1, 2].map(|k| index(k, c >> (2 * k) & 3)));
        let mut patch = Patch::new([4; 3], (0..64).map(neighbour).collect());
        let to_bernstein = if self.interpolation == Interpolation::BSpline { b_spline } else { catmull_rom };
        for axis in 0..3 {
            patch.map_rows(axis, to_bernstein);
        }
        patch
    }

    fn at(&self, arguments: &[f64]) -> Option<(Patch, [f64; 3])> {
        let &[x, y, z] = arguments else { return None };
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return None;
        }
        let cells = [(0, x), (1, y), (2, z)].map(|(axis, x)| self.cell_of(axis, self.place(axis, x)));
        Some((self.patch(cells.map(|c| c.0)), cells.map(|c| c.1)))
    }

    /// The cells that a box meets along each axis, first and last, and the places of its sides.
    fn cells(&self, sides: &[Interval<f64>]) -> [([usize; 2], Interval<f64>); 3] {
        [0, 1, 2].map(|axis| {
            let side = Interval::new(self.place(axis, sides[axis].lo), self.place(axis, sides[axis].hi));
            ([side.lo, side.hi].map(|place| self.cell_of(axis, place).0), side)
        })
    }

    /// The polynomials of the cells that a box meets, and the parts of them in the box; `None` where these are many.
    fn parts(&self, sides: &[Interval<f64>]) -> Option<Vec<(Patch, [Interval<f64>; 3])>> {
        let cells = self.cells(sides);
        let counts = cells.map(|([first, last], _)| last - first + 1);
        if counts.iter().product::<usize>() > FEW_CELLS {
            return None;
        }
        let mut parts = Vec::new();
        for c in 0..counts.iter().product() {
            let offset = [c % counts[0], c / counts[0] % counts[1], c / counts[0] / counts[1]];
            let cell = [0, 1, 2].map(|k| cells[k].0[0] + offset[k]);
            let part = [0, 1, 2].map(|k| {
                let [lo, hi] = [cells[k].1.lo, cells[k].1.hi].map(|p| (p - cell[k] as f64).clamp(0.0, 1.0));
                Interval::new(lo, hi)
            });
            parts.push((self.patch(cell), part));
        }
        Some(parts)
    }

    /// The least and the greatest number that matter in a box, from the level where it is a few blocks.
    fn range(&self, sides: &[Interval<f64>]) -> Interval<f64> {
        let margin = usize::from(self.interpolation != Interpolation::Linear);
        let spans = [0, 1, 2].map(|axis| {
            let ([first, last], _) = self.cells(sides)[axis];
            [first.saturating_sub(margin), (last + 1 + margin).min(self.counts[axis] - 1)]
        });
        let is_small = |level: usize| spans.iter().all(|[a, b]| (b >> (level + 1)) - (a >> (level + 1)) < 4);
        let level = (0..self.pyramid.len()).find(|&l| is_small(l)).unwrap_or(self.pyramid.len() - 1);
        let Level { counts, ranges } = &self.pyramid[level];
        let [x, y, z] = spans.map(|[a, b]| (a >> (level + 1))..=(b >> (level + 1)));
        let mut range = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
        for k in z {
            for j in y.clone() {
                for i in x.clone() {
                    let [lo, hi] = ranges[i + counts[0] * (j + counts[1] * k)].map(f64::from);
                    range = Interval::new(range.lo.min(lo), range.hi.max(hi));
                }
            }
        }
        if self.interpolation == Interpolation::CatmullRom {
            // The weights add up to 1, and their sizes to at most (5/4)³.
            let (middle, reach) = (0.5 * (range.lo + range.hi), 0.5 * 1.953125 * (range.hi - range.lo));
            range = Interval::new(middle - reach, middle + reach);
        }
        range
    }

    fn is_within(&self, sides: &[Interval<f64>]) -> bool {
        let [low, high] = self.bounds();
        sides.iter().zip(low.iter().zip(&high)).all(|(side, (low, high))| side.lo >= *low && side.hi <= *high)
    }
}

/// From four numbers to the Bernstein coefficients of Catmull and Rom's cubic between the second and the third.
fn catmull_rom(row: &mut [f64]) {
    let [p, q, r, s] = [row[0], row[1], row[2], row[3]];
    row.copy_from_slice(&[q, q + (r - p) / 6.0, r - (s - q) / 6.0, r]);
}

/// From four control values to the Bernstein coefficients of the B-spline's middle piece.
pub(crate) fn b_spline(row: &mut [f64]) {
    let [p, q, r, s] = [row[0], row[1], row[2], row[3]];
    row.copy_from_slice(&[
        (p + 4.0 * q + r) / 6.0,
        (2.0 * q + r) / 3.0,
        (q + 2.0 * r) / 3.0,
        (q + 4.0 * r + s) / 6.0,
    ]);
}

/// The bounds of blocks of 2, 4, 8, … numbers on a side, up to one block.
fn pyramid(counts: [usize; 3], values: &[f32]) -> Vec<Level> {
    let mut levels = vec![halved(counts, |i| [values[i]; 2])];
    while let Some(last) = levels.last().filter(|level| level.ranges.len() > 1) {
        let next = halved(last.counts, |i| last.ranges[i]);
        levels.push(next);
    }
    levels
}

fn halved(counts: [usize; 3], range: impl Fn(usize) -> [f32; 2]) -> Level {
    let halves = counts.map(|n| n.div_ceil(2));
    let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; halves.iter().product()];
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let [lo, hi] = range(i + counts[0] * (j + counts[1] * k));
                let block = &mut ranges[i / 2 + halves[0] * (j / 2 + halves[1] * (k / 2))];
                *block = [block[0].min(lo), block[1].max(hi)];
            }
        }
    }
    Level { counts: halves, ranges }
}

impl Function for VoxelArray {
    fn name(&self) -> &str {
        "a voxel array"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        self.at(arguments).map_or(f64::NAN, |(patch, at)| patch.value(at))
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        if arguments.len() != 3 || arguments.iter().any(|a| a.lo.is_nan() || a.hi.is_nan()) {
            return Interval::undefined();
        }
        if arguments.iter().all(|a| a.lo == a.hi) {
            let value = self.value(&[arguments[0].lo, arguments[1].lo, arguments[2].lo]);
            return Interval::new(value - self.slack, value + self.slack);
        }
        let range = match self.parts(arguments) {
            Some(parts) => {
                let hulls = parts.into_iter().map(|(patch, part)| patch.restricted(part).hull());
                hulls.reduce(join).unwrap_or(Interval::undefined())
            }
            None => self.range(arguments),
        };
        Interval::new(range.lo - self.slack, range.hi + self.slack)
    }

    /// Over a few cells the largest bound of theirs; straight interpolation has creases between cells.
    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        if arguments.len() != 3 || !self.is_within(arguments) {
            return f64::INFINITY;
        }
        let cells = self.cells(arguments);
        let count: usize = cells.iter().map(|([first, last], _)| last - first + 1).product();
        if count > FEW_CELLS || (count > 1 && self.interpolation == Interpolation::Linear) {
            return f64::INFINITY;
        }
        let scale = self.steps.map(|s| 1.0 / s);
        let bends = self.parts(arguments).into_iter().flatten().map(|(patch, _)| {
            let error = patch.gradient_error(scale, self.slack);
            patch.bend(scale, self.slack) + gradient_room(error, arguments)
        });
        bends.fold(0.0, f64::max)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let Some((patch, at)) = self.at(arguments) else {
            gradient.fill(f64::NAN);
            return;
        };
        let slopes = patch.gradient(at);
        let [low, high] = self.bounds();
        for (axis, slope) in gradient.iter_mut().enumerate() {
            let is_within = low[axis] <= arguments[axis] && arguments[axis] <= high[axis];
            *slope = if is_within { slopes[axis] / self.steps[axis] } else { 0.0 };
        }
    }
}

fn join(a: Interval<f64>, b: Interval<f64>) -> Interval<f64> {
    Interval::new(a.lo.min(b.lo), a.hi.max(b.hi))
}
