//! The least value of a program over one of its inputs, taken apart as far as it can be.
//!
//! What does not depend on the input, and what never falls when its operand rises, may be taken after the minimum as well
//! as before it: min over u of √(s(x, u)) − r is √(min over u of s(x, u)) − r. Where a squared distance |M(x) − b(u)|² is left, M
//! a motion and a change of size, the minimum is the distance to a curve, which [`Nearest`] finds, or for straight lines a formula;
//! anything else is searched by [`Minimum`].

use crate::expression::{Expr, Vector, write};
use crate::minimum::{Minimum, MinimumError};
use crate::nearest::Nearest;
use fieldstone_field::{Binary, Graph, Input, Node, NodeId, Unary};
use std::collections::HashSet;

/// Programs are not taken apart deeper than this.
const DEEPEST: usize = 64;

/// An input and where it runs.
#[derive(Clone, PartialEq, Debug)]
pub struct Course {
    /// The input.
    pub over: Input,
    /// From the first to the second.
    pub range: [f64; 2],
    /// In how many parts the minimum is searched where it has no closed form.
    pub parts: usize,
    /// Places between which squared distances belong to straight lines, the ends of the range among them; or none.
    pub corners: Vec<f64>,
}

/// Writes the least value of an output of a program along a course into a graph. `place` says what stands in the place of
/// each input but that of the course.
///
/// Its value is exact to rounding where a ball moves along a curve, and within what [`Minimum`] states elsewhere.
///
/// # Errors
/// An empty range; black boxes.
pub fn least(
    graph: &mut Graph,
    (program, output): (&Graph, NodeId),
    course: &Course,
    place: impl Fn(&mut Graph, Input) -> NodeId,
) -> Result<NodeId, MinimumError> {
    let [from, to] = course.range;
    if !(from < to && (to - from).is_finite()) {
        return Err(MinimumError::Range(from, to));
    }
    let mut moving = HashSet::new();
    let mut nodes = program.reachable(&[output]);
    nodes.sort_unstable();
    for n in nodes {
        let node = program.node(n);
        let depends = match node {
            Node::Input(input) => *input == course.over,
            // Loops are not looked into.
            Node::LoopVar(..) | Node::LoopOut(..) => true,
            _ => node.operands().iter().any(|operand| moving.contains(operand)),
        };
        if depends {
            moving.insert(n);
        }
    }
    let mut search = Search { graph, program, course, place, moving };
    match search.closed(output, DEEPEST)? {
        Some(least) => Ok(least),
        None => search.search(output),
    }
}

struct Search<'a, F> {
    graph: &'a mut Graph,
    program: &'a Graph,
    course: &'a Course,
    place: F,
    /// The nodes that depend on the input.
    moving: HashSet<NodeId>,
}

impl<F: Fn(&mut Graph, Input) -> NodeId> Search<'_, F> {
    /// The minimum of a node in closed form, if it has one.
    fn closed(&mut self, n: NodeId, depth: usize) -> Result<Option<NodeId>, MinimumError> {
        let Some(depth) = depth.checked_sub(1) else { return Ok(None) };
        if !self.moving.contains(&n) {
            return Ok(Some(self.copy(n)));
        }
        if let Some(distance) = self.distance(n) {
            return self.nearest(distance);
        }
        let is_fixed = |node: NodeId| !self.moving.contains(&node);
        match *self.program.node(n) {
            // A root of a squared distance, which is never undefined.
            Node::Unary(Unary::Sqrt, a) if self.distance(a).is_some() => {
                let inner = self.closed(a, depth)?;
                Ok(inner.map(|inner| self.graph.sqrt(inner)))
            }
            Node::Binary(op @ (Binary::Add | Binary::Min | Binary::Max), a, b)
                if is_fixed(a) || is_fixed(b) =>
            {
                self.both(op, [a, b], depth)
            }
            Node::Binary(Binary::Sub, a, b) if is_fixed(b) => self.both(Binary::Sub, [a, b], depth),
            Node::Binary(Binary::Div, a, b) if self.is_positive(b) => self.both(Binary::Div, [a, b], depth),
            Node::Binary(Binary::Mul, a, b) if self.is_positive(a) || self.is_positive(b) => {
                self.both(Binary::Mul, [a, b], depth)
            }
            // The least of the smaller is the smaller of the least.
            Node::Binary(Binary::Min, a, b) => self.both(Binary::Min, [a, b], depth),
            _ => Ok(None),
        }
    }

    /// An operation on the minima of its operands.
    fn both(
        &mut self,
        op: Binary,
        [a, b]: [NodeId; 2],
        depth: usize,
    ) -> Result<Option<NodeId>, MinimumError> {
        let Some(a) = self.closed(a, depth)? else { return Ok(None) };
        let b = self.closed(b, depth)?;
        Ok(b.map(|b| self.graph.binary(op, a, b)))
    }

    fn is_positive(&self, n: NodeId) -> bool {
        self.program.constant_value(n).is_some_and(|k| k > 0.0 && k.is_finite())
    }

    fn copy(&mut self, n: NodeId) -> NodeId {
        self.graph.import(self.program, &[n], &self.place)[0]
    }

    fn search(&mut self, n: NodeId) -> Result<NodeId, MinimumError> {
        let Course { over, range, parts, .. } = *self.course;
        let minima = Minimum::in_parts((self.program, n), over, range, parts)?;
        let calls: Vec<NodeId> =
            minima.into_iter().map(|minimum| minimum.call_with(self.graph, &self.place)).collect();
        let least = calls.into_iter().reduce(|a, b| self.graph.min(a, b));
        Ok(least.unwrap_or_else(|| self.graph.constant(f64::INFINITY)))
    }

    /// The minimum of a squared distance k²·|x − c(u)|².
    fn nearest(&mut self, distance: Distance) -> Result<Option<NodeId>, MinimumError> {
        let Course { over, range, ref corners, .. } = *self.course;
        let point = [0, 1, 2].map(|k| (self.place)(self.graph, Input::Coordinate(k)));
        let Distance { curve, centre, factor } = distance;
        let squared = if corners.len() >= 2 {
            let points = along(&curve, centre, (over, corners));
            line_distance(self.graph, point, &points)
        } else {
            match Nearest::new(&curve, centre, over, range)? {
                Some(nearest) => nearest.call(self.graph, point),
                None => return Ok(None),
            }
        };
        let factor = self.graph.constant(factor);
        Ok(Some(self.graph.mul(squared, factor)))
    }

    /// Recognises a sum of three squares of orthogonal linear forms of x, y and z, each with something of u.
    fn distance(&self, n: NodeId) -> Option<Distance> {
        let mut squares = Vec::new();
        self.squares((n, 4), &mut squares)?;
        let forms: Vec<Linear> = squares.iter().map(|&s| self.linear(s, DEEPEST)).collect::<Option<_>>()?;
        let forms: [Linear; 3] = forms.try_into().ok()?;
        let dot = |a: &Linear, b: &Linear| (0..3).map(|k| a.coefficients[k] * b.coefficients[k]).sum::<f64>();
        let factor = dot(&forms[0], &forms[0]);
        let is_equal = |a: f64, b: f64| (a - b).abs() <= 1e-14 * factor;
        let is_motion = factor > 0.0
            && factor.is_finite()
            && is_equal(dot(&forms[1], &forms[1]), factor)
            && is_equal(dot(&forms[2], &forms[2]), factor)
            && [(0, 1), (0, 2), (1, 2)].iter().all(|&(i, j)| is_equal(dot(&forms[i], &forms[j]), 0.0));
        if !is_motion {
            return None;
        }
        // With orthogonal rows mᵢ of length √k²: |Mx + b|² = k²·|x − c|² for c = −Mᵀb/k².
        let mut curve = Graph::new();
        let rests = forms.each_ref().map(|form| {
            let terms: Vec<NodeId> = form.rest.iter().map(|(_, node)| *node).collect();
            let copies = curve.import(self.program, &terms, Graph::input);
            form.rest.iter().zip(copies).fold(curve.constant(0.0), |sum, ((sign, _), copy)| {
                let sign = curve.constant(*sign);
                let term = curve.mul(sign, copy);
                curve.add(sum, term)
            })
        });
        let centre = [0, 1, 2].map(|k| {
            (0..3).fold(curve.constant(0.0), |sum, i| {
                let weight = forms[i].coefficients[k] / -factor;
                if weight == 0.0 {
                    return sum;
                }
                let weight = curve.constant(weight);
                let term = curve.mul(weight, rests[i]);
                curve.add(sum, term)
            })
        });
        Some(Distance { curve, centre, factor })
    }

    /// The operands of at most three squares in a sum.
    fn squares(&self, (n, depth): (NodeId, usize), found: &mut Vec<NodeId>) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        match *self.program.node(n) {
            Node::Unary(Unary::Square, a) if found.len() < 3 => found.push(a),
            Node::Binary(Binary::Add, a, b) => {
                self.squares((a, depth), found)?;
                self.squares((b, depth), found)?;
            }
            _ => return None,
        }
        Some(())
    }

    /// A linear form of x, y and z and something that depends on nothing but u.
    fn linear(&self, n: NodeId, depth: usize) -> Option<Linear> {
        let depth = depth.checked_sub(1)?;
        let inputs = || {
            let nodes = self.program.reachable(&[n]);
            nodes.into_iter().filter_map(|n| match self.program.node(n) {
                Node::Input(input) => Some(*input),
                _ => None,
            })
        };
        if inputs().all(|input| input == self.course.over) {
            return Some(Linear { coefficients: [0.0; 3], rest: vec![(1.0, n)] });
        }
        let constant = |n: NodeId| self.program.constant_value(n);
        match *self.program.node(n) {
            Node::Input(Input::Coordinate(k)) if k < 3 => {
                let coefficients = [0, 1, 2].map(|i| f64::from(u8::from(i == k)));
                Some(Linear { coefficients, rest: Vec::new() })
            }
            Node::Unary(Unary::Neg, a) => Some(self.linear(a, depth)?.scaled(-1.0)),
            Node::Binary(Binary::Add, a, b) => Some(self.linear(a, depth)?.plus(self.linear(b, depth)?)),
            Node::Binary(Binary::Sub, a, b) => {
                Some(self.linear(a, depth)?.plus(self.linear(b, depth)?.scaled(-1.0)))
            }
            Node::Binary(Binary::Mul, a, b) => match (constant(a), constant(b)) {
                (Some(k), _) => Some(self.linear(b, depth)?.scaled(k)),
                (_, Some(k)) => Some(self.linear(a, depth)?.scaled(k)),
                _ => None,
            },
            Node::Binary(Binary::Div, a, b) => Some(self.linear(a, depth)?.scaled(1.0 / constant(b)?)),
            _ => None,
        }
    }
}

/// k²·|x − c(u)|².
struct Distance {
    /// A program of u with the coordinates of c.
    curve: Graph,
    centre: [NodeId; 3],
    /// k².
    factor: f64,
}

/// Coefficients of x, y and z, and nodes that depend on u with theirs.
struct Linear {
    coefficients: [f64; 3],
    rest: Vec<(f64, NodeId)>,
}

impl Linear {
    fn scaled(self, by: f64) -> Self {
        let rest = self.rest.into_iter().map(|(k, node)| (k * by, node)).collect();
        Self { coefficients: self.coefficients.map(|k| k * by), rest }
    }

    fn plus(mut self, other: Self) -> Self {
        self.rest.extend(other.rest);
        let coefficients = [0, 1, 2].map(|k| self.coefficients[k] + other.coefficients[k]);
        Self { coefficients, rest: self.rest }
    }
}

/// Points of a curve.
fn along(curve: &Graph, centre: [NodeId; 3], (over, places): (Input, &[f64])) -> Vec<[f64; 3]> {
    let at =
        |u: f64| {
            let mut point = Graph::new();
            let nodes = point.import(curve, &centre, |graph, input| {
                if input == over { graph.constant(u) } else { graph.input(input) }
            });
            [0, 1, 2].map(|k| point.constant_value(nodes[k]).unwrap_or(f64::NAN))
        };
    places.iter().map(|&u| at(u)).collect()
}

/// The squared distance to the nearest of the straight lines from point to point.
pub(crate) fn line_distance(graph: &mut Graph, at: [NodeId; 3], points: &[[f64; 3]]) -> NodeId {
    write(graph, |cell| {
        let p = Vector(at.map(|id| Expr::new(cell, id)));
        let distances = points.windows(2).map(|pair| {
            let along: [f64; 3] = std::array::from_fn(|k| pair[1][k] - pair[0][k]);
            let squared: f64 = along.iter().map(|d| d * d).sum();
            let (start, along) = (Vector(pair[0].map(|x| p.0[0].number(x))), along.map(|x| p.0[0].number(x)));
            let from_start = p - start;
            let part = from_start.dot(Vector(along)) / squared.max(f64::MIN_POSITIVE);
            (from_start - Vector(along) * part.clamp(0.0, 1.0)).squared()
        });
        distances.reduce(|a, b| a.min(b)).unwrap_or_else(|| p.squared()).id()
    })
}
