//! A hierarchy of boxes: which of many boxes does a ray cross?
//!
//! Boxes are halved at the median of their centres along the longest side (Kay and Kajiya 1986), so that the depth is
//! that of a balanced tree. They are widened by more than the rounding of the test, which takes rays within their faces
//! too: no box that a ray crosses is left out.

use fieldstone_scene::Bounds;
use glam::DVec3;

/// How many boxes a leaf holds at most.
const LEAF: usize = 4;
/// How much boxes are widened on every side, relative to how far the hierarchy reaches from the origin of space and from
/// the origins of rays; rounding is far below this.
const MARGIN: f64 = 1e-12;
/// A ray does not move along an axis if its slope is smaller.
const FLAT: f64 = 1e-300;

/// Boxes in a binary tree.
#[derive(Debug)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    /// The numbers of the boxes, leaf by leaf.
    items: Vec<u32>,
    /// The boxes, in the order of `items`.
    boxes: Vec<Region>,
}

#[derive(Clone, Copy, Debug)]
struct Region {
    min: DVec3,
    max: DVec3,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    region: Region,
    /// Of a leaf, its first item; otherwise its first child, which the other follows.
    first: u32,
    /// Of a leaf, how many items it has; otherwise 0.
    count: u32,
}

impl Region {
    const NOTHING: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Where the line origin + t·direction enters, if it crosses the box, widened, between `start` and `end`.
    fn enter(&self, origin: DVec3, direction: DVec3, (start, end): (f64, f64)) -> Option<f64> {
        let (mut near, mut far) = (start, end);
        for axis in 0..3 {
            let margin = MARGIN * (self.min[axis].abs().max(self.max[axis].abs()) + origin[axis].abs());
            let (min, max) = (self.min[axis] - margin - origin[axis], self.max[axis] + margin - origin[axis]);
            let slope = direction[axis];
            if slope.abs() < FLAT {
                if min > 0.0 || max < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (min / slope, max / slope);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        (near <= far).then_some(near)
    }
}

impl Hierarchy {
    /// A hierarchy of boxes, which are known by their place in the list.
    pub(crate) fn new(list: &[Bounds]) -> Self {
        let regions: Vec<Region> = list.iter().map(|b| Region { min: b.min(), max: b.max() }).collect();
        let mut items: Vec<u32> = (0..list.len() as u32).collect();
        let mut nodes = vec![Node { region: Region::NOTHING, first: 0, count: list.len() as u32 }];
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            let Node { first, count, .. } = nodes[node];
            let own = &mut items[first as usize..(first + count) as usize];
            let region = own.iter().fold(Region::NOTHING, |all, &i| all.union(regions[i as usize]));
            nodes[node].region = region;
            if own.len() > LEAF {
                let half = own.len() / 2;
                split(own, half, list, region.max - region.min);
                let child = nodes.len();
                let leaf = |first, count| Node { region, first, count };
                nodes.push(leaf(first, half as u32));
                nodes.push(leaf(first + half as u32, count - half as u32));
                (nodes[node].first, nodes[node].count) = (child as u32, 0);
                open.extend([child, child + 1]);
            }
        }
        let boxes = items.iter().map(|&i| regions[i as usize]).collect();
        Self { nodes, items, boxes }
    }

    /// Appends the boxes that a ray crosses between two values of t, with where it enters each, in no order.
    pub(crate) fn crossed(
        &self,
        (origin, direction): (DVec3, DVec3),
        span: (f64, f64),
        found: &mut Vec<(f64, u32)>,
    ) {
        // As deep as a balanced tree of 2³² boxes; more would only be slower.
        let mut open = Vec::with_capacity(32);
        open.push(0);
        while let Some(node) = open.pop() {
            let Node { region, first, count } = self.nodes[node as usize];
            if region.enter(origin, direction, span).is_none() {
                continue;
            }
            if count == 0 {
                open.extend([first, first + 1]);
            }
            let leaf = first as usize..(first + count) as usize;
            for (region, &item) in self.boxes[leaf.clone()].iter().zip(&self.items[leaf]) {
                if let Some(enter) = region.enter(origin, direction, span) {
                    found.push((enter, item));
                }
            }
        }
    }
}

/// Puts the first half, along the longest side, before the others.
fn split(items: &mut [u32], half: usize, list: &[Bounds], size: DVec3) {
    let axis = size.max_position();
    let key = |i: &u32| list[*i as usize].centre()[axis];
    items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between 0 and 1, evenly and without a pattern.
    fn chance(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(seed: &mut u64) -> DVec3 {
        DVec3::new(chance(seed), chance(seed), chance(seed))
    }

    fn boxes(count: usize) -> Vec<Bounds> {
        let mut seed = 1;
        let mut one = || {
            let min = 10.0 * point(&mut seed);
            Bounds::new(min, min + DVec3::splat(0.01) + point(&mut seed)).unwrap()
        };
        (0..count).map(|_| one()).collect()
    }

    fn crossed(hierarchy: &Hierarchy, ray: (DVec3, DVec3)) -> Vec<u32> {
        let mut found = Vec::new();
        hierarchy.crossed(ray, (0.0, f64::INFINITY), &mut found);
        let mut items: Vec<u32> = found.into_iter().map(|(_, item)| item).collect();
        items.sort_unstable();
        items
    }

    #[test]
    fn the_boxes_that_a_ray_crosses_are_found() {
        for count in [1, 2, 4, 5, 300] {
            let boxes = boxes(count);
            let hierarchy = Hierarchy::new(&boxes);
            let (mut seed, mut hits) = (2, 0);
            for _ in 0..200 {
                let origin = 30.0 * point(&mut seed) - DVec3::splat(10.0);
                let direction = (5.0 * point(&mut seed) + DVec3::splat(2.5) - origin).normalize();
                let meets = |b: &Bounds| b.ray_span(origin, direction).is_some_and(|s| s.exit >= 0.0);
                let expected: Vec<u32> =
                    (0..).zip(&boxes).filter(|(_, b)| meets(b)).map(|(i, _)| i).collect();
                hits += expected.len();
                assert_eq!(crossed(&hierarchy, (origin, direction)), expected);
            }
            assert!(hits > 0 || count < 5);
        }
    }

    #[test]
    fn rays_within_faces_cross() {
        let unit = Bounds::new(DVec3::ZERO, DVec3::ONE).unwrap();
        let hierarchy = Hierarchy::new(&[unit]);
        let along = |origin| crossed(&hierarchy, (origin, DVec3::X)).len();
        assert_eq!(along(DVec3::new(-1.0, 0.0, 1.0)), 1);
        assert_eq!(along(DVec3::new(-1.0, -0.001, 1.0)), 0);
        assert_eq!(along(DVec3::new(2.0, 0.5, 0.5)), 0);
        assert_eq!(crossed(&hierarchy, (DVec3::NEG_X, DVec3::new(1.0, 1e-310, 0.0))).len(), 1);
    }

    #[test]
    fn what_lies_beyond_the_end_is_left_out() {
        let hierarchy = Hierarchy::new(&boxes(3000));
        let ray = (DVec3::new(-1.0, 5.0, 5.0), DVec3::X);
        let mut found = Vec::new();
        hierarchy.crossed(ray, (0.0, 6.0), &mut found);
        assert!(!found.is_empty() && found.iter().all(|(enter, _)| *enter <= 6.0));
        assert!(found.len() < crossed(&hierarchy, ray).len());
    }
}
