//! Normals of points that have none (Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992).
//!
//! # Theory
//! The plane that fits the nearest points best goes through their centre, and its normal is the eigenvector of their
//! covariance with the smallest eigenvalue. Which of its two sides is outside spreads from point to point over the graph of
//! neighbours, along a minimum spanning tree in which steps between planes that are almost parallel come first.
//!
//! # What differs from the paper
//! The paper joins all points into one graph by a Euclidean spanning tree and begins at the highest one. Here pieces
//! that are no neighbours, the surfaces of bodies that stand apart, each begin at a point of their own that is outermost
//! along an axis. Of a hollow in a body the inside is taken for the body, therefore.

use super::neighbours::Neighbours;
use nalgebra::{Matrix3, Vector3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Planes are fitted to so many points, and so many are neighbours.
const NEIGHBOURS: usize = 12;

/// The unit normals, outside, of points of which all numbers are finite.
pub(super) fn estimated(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let tree = Neighbours::new(points);
    let mut normals: Vec<Vector3<f64>> = Vec::with_capacity(points.len());
    let mut edges: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for (i, point) in points.iter().enumerate() {
        let near = tree.nearest(*point, NEIGHBOURS + 1);
        normals.push(plane(points, &near));
        for j in near.into_iter().filter(|&j| j != i) {
            edges[i].push(j);
            edges[j].push(i);
        }
    }
    for piece in pieces(&edges) {
        orient(points, &edges, &mut normals, &piece);
    }
    normals.into_iter().map(Into::into).collect()
}

/// The normal of the plane through points.
fn plane(points: &[[f64; 3]], near: &[usize]) -> Vector3<f64> {
    let at = |i: &usize| Vector3::from(points[*i]);
    let centre = near.iter().map(at).sum::<Vector3<f64>>() / near.len() as f64;
    let covariance: Matrix3<f64> = near
        .iter()
        .map(|i| {
            let from_centre = at(i) - centre;
            from_centre * from_centre.transpose()
        })
        .sum();
    let eigen = covariance.symmetric_eigen();
    eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned()
}

/// The points of each piece of the graph.
fn pieces(edges: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut is_known = vec![false; edges.len()];
    let mut pieces = Vec::new();
    for start in 0..edges.len() {
        if is_known[start] {
            continue;
        }
        is_known[start] = true;
        let (mut piece, mut at) = (vec![start], 0);
        while let Some(&i) = piece.get(at) {
            at += 1;
            for &j in &edges[i] {
                if !std::mem::replace(&mut is_known[j], true) {
                    piece.push(j);
                }
            }
        }
        pieces.push(piece);
    }
    pieces
}

/// A step to a point whose normal follows that of another.
struct Step {
    /// How far from parallel the planes are, from 0 to 1.
    weight: f64,
    from: usize,
    to: usize,
}

impl Ord for Step {
    /// The largest is the step to be taken first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.weight.total_cmp(&self.weight).then((other.to, other.from).cmp(&(self.to, self.from)))
    }
}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Step {}

/// Turns the normals of a piece, by Prim's algorithm.
fn orient(points: &[[f64; 3]], edges: &[Vec<usize>], normals: &mut [Vector3<f64>], piece: &[usize]) {
    let Some((start, outwards)) = outermost(points, normals, piece) else { return };
    if normals[start].dot(&outwards) < 0.0 {
        normals[start] = -normals[start];
    }
    let mut is_turned: Vec<bool> = vec![false; points.len()];
    let mut steps = BinaryHeap::from([Step { weight: 0.0, from: start, to: start }]);
    while let Some(Step { from, to, .. }) = steps.pop() {
        if std::mem::replace(&mut is_turned[to], true) {
            continue;
        }
        if normals[to].dot(&normals[from]) < 0.0 {
            normals[to] = -normals[to];
        }
        for &next in edges[to].iter().filter(|&&next| !is_turned[next]) {
            let weight = 1.0 - normals[to].dot(&normals[next]).abs();
            steps.push(Step { weight, from: to, to: next });
        }
    }
}

/// Of the points of a piece that are outermost along an axis, the one with the surest normal, and the direction outwards.
fn outermost(
    points: &[[f64; 3]],
    normals: &[Vector3<f64>],
    piece: &[usize],
) -> Option<(usize, Vector3<f64>)> {
    let directions = (0..6).map(|k| {
        let mut direction = Vector3::zeros();
        direction[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
        direction
    });
    let along = |i: usize, direction: &Vector3<f64>| Vector3::from(points[i]).dot(direction);
    let ends = directions.filter_map(|direction| {
        let end = piece.iter().max_by(|&&a, &&b| along(a, &direction).total_cmp(&along(b, &direction)))?;
        Some((*end, direction))
    });
    let sure = |(i, direction): &(usize, Vector3<f64>)| normals[*i].dot(direction).abs();
    ends.max_by(|a, b| sure(a).total_cmp(&sure(b)))
}
