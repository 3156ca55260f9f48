//! Triangles cut by the unit cell, and what they hide of its faces.

use glam::DVec3;

/// A triangle cut by six planes has at most nine corners.
const MOST: usize = 9;
/// Places along a side of a face.
const SIDE: usize = 16;

/// A flat convex polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [DVec3; MOST],
    count: usize,
}

impl Polygon {
    pub(super) fn new(triangle: [DVec3; 3]) -> Self {
        let mut corners = [DVec3::ZERO; MOST];
        corners[..3].copy_from_slice(&triangle);
        Self { corners, count: 3 }
    }

    /// The part in the unit cube from 0 to 1 (Sutherland and Hodgman 1974).
    pub(super) fn clipped(self) -> Self {
        let mut left = self;
        for axis in 0..3 {
            left = left.cut(|p| p[axis]).cut(|p| 1.0 - p[axis]);
        }
        left
    }

    /// The part where `side` is not negative.
    fn cut(self, side: impl Fn(DVec3) -> f64) -> Self {
        let mut left = Self { corners: [DVec3::ZERO; MOST], count: 0 };
        for i in 0..self.count {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (a, b) = (side(p), side(q));
            if a >= 0.0 {
                left.push(p);
            }
            if (a < 0.0) != (b < 0.0) {
                left.push(p.lerp(q, a / (a - b)));
            }
        }
        left
    }

    /// One more corner; what rounding adds beyond nine is left out.
    fn push(&mut self, corner: DVec3) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The area as a vector along the normal: its parts are the areas seen along the axes.
    pub(super) fn area(&self) -> DVec3 {
        let Some((first, rest)) = self.corners().split_first() else { return DVec3::ZERO };
        0.5 * rest.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum::<DVec3>()
    }

    /// The mean of the corners, a point inside.
    pub(super) fn middle(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count.max(1) as f64
    }

    /// The places of a row of the face across `axis` that are hidden; the row is that of the places with this coordinate.
    fn row(&self, axis: usize, row: usize) -> u16 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = (row as f64 + 0.5) / SIDE as f64;
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..self.count {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % self.count]);
            if (p[v] < at) != (q[v] < at) {
                let x = p[u] + (at - p[v]) / (q[v] - p[v]) * (q[u] - p[u]);
                (from, to) = (from.min(x), to.max(x));
            }
        }
        // Places from `from` up to, but not at, `to`, so that neighbours share none.
        let place = |x: f64| (x * SIDE as f64 + 0.5).floor().clamp(0.0, SIDE as f64) as u32;
        if from < to { (((1u32 << place(to)) - 1) & !((1u32 << place(from)) - 1)) as u16 } else { 0 }
    }
}

/// What polygons hide of a cell's three faces.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadow {
    places: [[u16; SIDE]; 3],
    /// Places counted once for each polygon.
    counted: [u32; 3],
    /// Areas added up, in units of a face.
    areas: [f64; 3],
}

impl Shadow {
    pub(super) fn add(&mut self, polygon: &Polygon) {
        let area = polygon.area();
        for axis in 0..3 {
            self.areas[axis] += area[axis].abs();
            for (row, places) in self.places[axis].iter_mut().enumerate() {
                let hidden = polygon.row(axis, row);
                self.counted[axis] += hidden.count_ones();
                *places |= hidden;
            }
        }
    }

    /// The hidden shares of the faces across x, y and z.
    pub(super) fn cover(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let hidden: u32 = self.places[axis].iter().map(|row| row.count_ones()).sum();
            let apart = if hidden < self.counted[axis] {
                f64::from(hidden) / f64::from(self.counted[axis])
            } else {
                1.0
            };
            (self.areas[axis] * apart).min(1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> Polygon {
        Polygon::new([a, b, c].map(DVec3::from_array)).clipped()
    }

    #[test]
    fn what_lies_outside_of_the_cell_is_cut_off() {
        // x + y + z = 1.5 cuts the cube in a regular hexagon.
        let big = triangle([4.5, -1.5, -1.5], [-1.5, 4.5, -1.5], [-1.5, -1.5, 4.5]);
        assert_eq!(big.count, 6);
        assert!((big.area().length() - 0.75 * 3f64.sqrt()).abs() < 1e-12);
        assert_eq!(triangle([2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0]).area(), DVec3::ZERO);
    }

    #[test]
    fn neighbours_hide_no_place_twice() {
        let mut shadow = Shadow::default();
        shadow.add(&triangle([0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5]));
        shadow.add(&triangle([0.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.0, 1.0, 0.5]));
        assert_eq!(shadow.counted[2], 256);
        assert_eq!(shadow.cover(), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn what_stands_behind_another_hides_nothing_more() {
        let mut shadow = Shadow::default();
        for z in [0.2, 0.4, 0.9] {
            shadow.add(&triangle([0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]));
        }
        assert!((shadow.cover()[2] - 0.5).abs() < 1e-12, "{:?}", shadow.cover());
    }
}
