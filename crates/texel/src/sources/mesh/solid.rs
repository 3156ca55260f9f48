//! What is inside of a mesh.
//!
//! Parallel lines along each axis, four abreast in a cell, are cut by the triangles. Two triangles that share a side
//! compute where it is from the same numbers in the same order, so that a line passes through one of them, and never between: every
//! line enters a watertight mesh as often as it leaves it. A place is inside where the way to it along a line crosses
//! the surface inward more or less often than outward (the winding number is not 0) or, where triangles are not all turned the same
//! way, an odd number of times; the majority of the three axes decides.

use super::{MAX_CELLS, Mesh, SourceError, hull};
use glam::DVec3;
use rayon::prelude::*;

/// How the triangles of a mesh hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Joints {
    /// At every side an even number of triangles meets.
    pub(super) is_closed: bool,
    /// At every side as many triangles are turned one way as the other.
    pub(super) is_oriented: bool,
}

impl Joints {
    /// Points at the same place are the same point, whatever their numbers: within a ten-millionth of the longest side of the box
    /// around all, since files round.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let number = welded(&mesh.points);
        let corner = |i: u32| number.get(i as usize).copied();
        let mut sides: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * mesh.triangles.len());
        for [a, b, c] in &mesh.triangles {
            let (Some(a), Some(b), Some(c)) = (corner(*a), corner(*b), corner(*c)) else { continue };
            if a != b && b != c && c != a {
                sides.extend([(a, b), (b, c), (c, a)].map(|(p, q)| (p.min(q), p.max(q), p < q)));
            }
        }
        sides.par_sort_unstable();
        let mut joints = Self { is_closed: !sides.is_empty(), is_oriented: true };
        for side in sides.chunk_by(|s, t| (s.0, s.1) == (t.0, t.1)) {
            joints.is_closed &= side.len() % 2 == 0;
            joints.is_oriented &= 2 * side.iter().filter(|(_, _, forward)| *forward).count() == side.len();
        }
        joints
    }
}

/// For each point the number of the first one at its place.
fn welded(points: &[[f64; 3]]) -> Vec<u32> {
    let [low, high] = hull(points.iter().map(|point| (*point, 0.0)));
    let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let place = |i: u32| points[i as usize].map(|x| (x / longest * 1e7).round() as i64);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.par_sort_unstable_by_key(|i| (place(*i), *i));
    let mut number = vec![0; points.len()];
    for same in order.chunk_by(|i, j| place(*i) == place(*j)) {
        for i in same {
            number[*i as usize] = same[0];
        }
    }
    number
}

/// Where a line crosses the surface, in cells along it, and whether inward (1) or outward (−1).
#[derive(Clone, Copy, Debug)]
struct Crossing {
    at: f32,
    turn: i8,
}

/// All lines along an axis.
struct Lines {
    /// Crossings in the order of lines, and along each.
    crossings: Vec<Crossing>,
    /// The first crossing of each line, and the end.
    first: Vec<u32>,
}

impl Lines {
    fn new(triangles: &[[DVec3; 3]], axis: usize, side: u32, abreast: u32) -> Self {
        let cut = triangles.par_iter().flat_map_iter(|corners| crossings(corners, axis, side, abreast));
        let mut found: Vec<(u32, Crossing)> = cut.collect();
        found.par_sort_unstable_by(|a, b| {
            a.0.cmp(&b.0).then(a.1.at.total_cmp(&b.1.at)).then(a.1.turn.cmp(&b.1.turn))
        });
        let mut first = vec![0; side as usize * side as usize + 1];
        found.iter().for_each(|(line, _)| first[*line as usize + 1] += 1);
        let mut sum = 0;
        for place in &mut first {
            sum += *place;
            *place = sum;
        }
        Self { crossings: found.into_iter().map(|(_, crossing)| crossing).collect(), first }
    }

    fn line(&self, line: usize) -> &[Crossing] {
        &self.crossings[self.first[line] as usize..self.first[line + 1] as usize]
    }
}

/// Where the lines along an axis cross a triangle: lines (j, i) at the places (i + ½, j + ½) / abreast.
fn crossings(
    corners: &[DVec3; 3],
    axis: usize,
    side: u32,
    abreast: u32,
) -> impl Iterator<Item = (u32, Crossing)> + use<> {
    let corners = *corners;
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let abreast = f64::from(abreast);
    // Lines stand at whole numbers.
    let flat = corners.map(|p| [p[u] * abreast - 0.5, p[v] * abreast - 0.5]);
    let (a, normal) = (corners[0], (corners[1] - corners[0]).cross(corners[2] - corners[0]));
    let [low, high] = [
        corners.map(|p| p[axis]).into_iter().fold(f64::INFINITY, f64::min),
        corners.map(|p| p[axis]).into_iter().fold(f64::NEG_INFINITY, f64::max),
    ];
    let turn = if normal[axis] < 0.0 { 1 } else { -1 };
    let whole = move |x: f64| x.ceil().clamp(0.0, f64::from(side)) as u32;
    let rows = [flat[0][1], flat[1][1], flat[2][1]];
    let (from, to) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    (whole(from)..whole(to)).flat_map(move |j| {
        let row = f64::from(j);
        let (left, right) = span(&flat, row);
        (whole(left)..whole(right)).map(move |i| {
            let (x, y) = ((f64::from(i) + 0.5) / abreast, (row + 0.5) / abreast);
            let rise = (normal[u] * (x - a[u]) + normal[v] * (y - a[v])) / normal[axis];
            let at = if rise.is_finite() { (a[axis] - rise).clamp(low, high) } else { low };
            (j * side + i, Crossing { at: at as f32, turn })
        })
    })
}

/// From where to where a row is in a triangle. Both triangles at a side find the same end.
fn span(flat: &[[f64; 2]; 3], row: f64) -> (f64, f64) {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (mut p, mut q) = (flat[k], flat[(k + 1) % 3]);
        if (p[1] < row) != (q[1] < row) {
            if p > q {
                (p, q) = (q, p);
            }
            let x = p[0] + (row - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
            (left, right) = (left.min(x), right.max(x));
        }
    }
    (left, right)
}

/// The inside of a mesh.
pub(super) struct Interior {
    lines: [Lines; 3],
    abreast: u32,
    edge: u32,
    is_oriented: bool,
}

impl Interior {
    /// That of triangles by their corners, counted in cells.
    pub(super) fn new(triangles: &[[DVec3; 3]], edge: u32, is_oriented: bool) -> Result<Self, SourceError> {
        let abreast = if edge > 512 { 2 } else { 4 };
        let area = |[a, b, c]: &[DVec3; 3]| 0.5 * (*b - *a).cross(*c - *a).abs().element_sum();
        let expected = triangles.iter().map(area).sum::<f64>() * f64::from(abreast * abreast);
        if expected > 4.0 * MAX_CELLS as f64 {
            return Err(SourceError::TooMany { what: "the lines that cross a mesh", most: 4 * MAX_CELLS });
        }
        let lines = [0, 1, 2].map(|axis| Lines::new(triangles, axis, abreast * edge, abreast));
        Ok(Self { lines, abreast, edge, is_oriented })
    }

    /// Whether what is behind these crossings is inside.
    fn is_inside(&self, crossings: &[Crossing]) -> bool {
        if self.is_oriented {
            crossings.iter().map(|crossing| i32::from(crossing.turn)).sum::<i32>() != 0
        } else {
            crossings.len() % 2 == 1
        }
    }

    /// The crossings of a line through a cell; lines are counted along the two other axes.
    fn line(&self, axis: usize, cell: [u32; 3], [i, j]: [u32; 2]) -> &[Crossing] {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let (i, j) = (cell[u] * self.abreast + i, cell[v] * self.abreast + j);
        self.lines[axis].line((j * self.abreast * self.edge + i) as usize)
    }

    /// Whether a cell that no triangle goes through is inside.
    pub(super) fn holds(&self, cell: [u32; 3]) -> bool {
        let votes = (0..3).filter(|axis| {
            let line = self.line(*axis, cell, [self.abreast / 2; 2]);
            let before = line.partition_point(|crossing| crossing.at < cell[*axis] as f32 + 0.5);
            self.is_inside(&line[..before])
        });
        votes.count() >= 2
    }

    /// The shares of a cell's faces across x, y and z behind which the whole way through the cell is inside.
    pub(super) fn filled(&self, cell: [u32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let from = cell[axis] as f32;
            let is_filled = |k: &u32| {
                let line = self.line(axis, cell, [k % self.abreast, k / self.abreast]);
                let before = line.partition_point(|crossing| crossing.at < from);
                let within = line[before..].first().is_some_and(|crossing| crossing.at <= from + 1.0);
                !within && self.is_inside(&line[..before])
            };
            let count = self.abreast * self.abreast;
            (0..count).filter(is_filled).count() as f64 / f64::from(count)
        })
    }
}
