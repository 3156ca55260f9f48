//! A hierarchy of boxes: which of many boxes does a ray cross?
//!
//! Boxes are halved at the median of their centres along the longest side (Kay and Kajiya 1986), so that the depth is
//! that of a balanced tree. They are widened by more than the rounding of the test, which takes rays within their faces
//! too: no box that a ray crosses is left out. Boxes come from the nearest on, and only as far as they are asked for.

use fieldstone_scene::Bounds;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

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

    /// The largest coordinate.
    fn reach(&self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}

/// A ray on its way through a hierarchy.
#[derive(Debug)]
pub(crate) struct Passage {
    origin: DVec3,
    /// 1 / direction; 0 along axes along which the ray does not move.
    inverse: DVec3,
    /// How much boxes are widened.
    margin: DVec3,
    end: f64,
    /// What is still to be looked at.
    open: BinaryHeap<Crossed>,
}

/// A node or box that a ray crosses. The greatest is the one that it enters first.
#[derive(Clone, Copy, Debug)]
struct Crossed {
    enter: f64,
    what: What,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum What {
    Node(u32),
    Item(u32),
}

impl Ord for Crossed {
    fn cmp(&self, other: &Self) -> Ordering {
        other.enter.total_cmp(&self.enter).then(other.what.cmp(&self.what))
    }
}

impl PartialOrd for Crossed {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Crossed {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Crossed {}

impl Passage {
    /// Notes a node or box down, if the ray crosses it.
    fn meet(&mut self, region: &Region, what: What) {
        let low = (region.min - self.margin - self.origin) * self.inverse;
        let high = (region.max + self.margin - self.origin) * self.inverse;
        let (mut near, mut far) = (0.0f64, self.end);
        for axis in 0..3 {
            if self.inverse[axis] == 0.0 {
                let place = self.origin[axis];
                let (min, max) = (region.min[axis] - self.margin[axis], region.max[axis] + self.margin[axis]);
                if place < min || place > max {
                    return;
                }
                continue;
            }
            near = near.max(low[axis].min(high[axis]));
            far = far.min(low[axis].max(high[axis]));
        }
        if near <= far {
            self.open.push(Crossed { enter: near, what });
        }
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

    /// The way of a ray, origin + t·direction with t from 0 to `end`.
    pub(crate) fn passage(&self, (origin, direction): (DVec3, DVec3), end: f64) -> Passage {
        let flat = direction.abs().cmplt(DVec3::splat(FLAT));
        let inverse = DVec3::select(flat, DVec3::ZERO, direction.recip());
        let root = &self.nodes[0].region;
        let margin = MARGIN * (origin.abs() + DVec3::splat(root.reach()));
        let mut passage = Passage { origin, inverse, margin, end, open: BinaryHeap::new() };
        passage.meet(root, What::Node(0));
        passage
    }

    /// The next box that a ray enters, unless it does so behind `reach`: then nothing more is to be expected.
    pub(crate) fn next(&self, passage: &mut Passage, reach: f64) -> Option<usize> {
        while let Some(Crossed { what, .. }) = passage.open.pop().filter(|next| next.enter <= reach) {
            let node = match what {
                What::Item(item) => return Some(item as usize),
                What::Node(node) => self.nodes[node as usize],
            };
            if node.count == 0 {
                for child in [node.first, node.first + 1] {
                    passage.meet(&self.nodes[child as usize].region, What::Node(child));
                }
            }
            for place in node.first as usize..(node.first + node.count) as usize {
                passage.meet(&self.boxes[place], What::Item(self.items[place]));
            }
        }
        passage.open.clear();
        None
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

    fn until(hierarchy: &Hierarchy, ray: (DVec3, DVec3), end: f64) -> Vec<usize> {
        let mut passage = hierarchy.passage(ray, end);
        std::iter::from_fn(|| hierarchy.next(&mut passage, f64::INFINITY)).collect()
    }

    fn crossed(hierarchy: &Hierarchy, ray: (DVec3, DVec3)) -> Vec<usize> {
        let mut items = until(hierarchy, ray, f64::INFINITY);
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
                let expected: Vec<usize> =
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
    fn boxes_come_from_the_nearest_on_as_far_as_they_are_asked_for() {
        let boxes = boxes(3000);
        let hierarchy = Hierarchy::new(&boxes);
        let ray = (DVec3::new(-1.0, 5.0, 5.0), DVec3::X);
        let enter = |item: usize| boxes[item].ray_span(ray.0, ray.1).unwrap().enter;
        let all = until(&hierarchy, ray, f64::INFINITY);
        assert!(all.len() > 5 && all.is_sorted_by(|&a, &b| enter(a) <= enter(b)));
        let expected: Vec<usize> = all.iter().copied().filter(|&item| enter(item) <= 6.0).collect();
        assert!(expected.len() < all.len());
        assert_eq!(until(&hierarchy, ray, 6.0), expected);
        let mut passage = hierarchy.passage(ray, f64::INFINITY);
        let reached: Vec<usize> = std::iter::from_fn(|| hierarchy.next(&mut passage, 6.0)).collect();
        assert_eq!(reached, expected);
        assert_eq!(hierarchy.next(&mut passage, f64::INFINITY), None);
    }
}
