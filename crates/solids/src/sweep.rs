//! Solids that move along curves, and shadows of solids of four dimensions.

use crate::expression::{Expr, Vector, write};
use crate::least::{Course, least, line_distance};
use crate::map::{moved, translate};
use crate::minimum::MinimumError;
use fieldstone_field::{Graph, Input, NodeId};

/// The input that stands for the parameter u of curves; no model has as many coordinates.
pub const CURVE_PARAMETER: Input = Input::Coordinate(u16::MAX);

/// The parts in which the minimum of a projection is searched.
const PROJECTION_PARTS: usize = 2;

/// The most points of a curve.
const MOST_POINTS: usize = 256;

/// A curve c(u), u from 0 to 1.
#[derive(Clone, Debug)]
pub enum Curve {
    /// Straight from point to point, each stretch in the same time; at least two points.
    Polyline(Vec<[f64; 3]>),
    /// The Bézier curve of two to 16 control points.
    Bezier(Vec<[f64; 3]>),
    /// Around the z axis, from (radius, 0, 0) on.
    Helix {
        /// The distance from the axis.
        radius: f64,
        /// The rise in one turn.
        pitch: f64,
        /// How many turns.
        turns: f64,
    },
    /// Any program of [`CURVE_PARAMETER`], with the nodes of the three coordinates.
    Program(Box<Graph>, [NodeId; 3]),
}

/// Why there is no sweep.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum CurveError {
    /// Too few or too many points.
    #[error("a {kind} has 2 to {most} points, not {found}")]
    Points {
        /// Which curve.
        kind: &'static str,
        /// The most that it may have.
        most: usize,
        /// How many were given.
        found: usize,
    },
    /// A number that is not finite.
    #[error("a number of the curve is not finite")]
    NotFinite,
    /// What is swept has no minimum.
    #[error(transparent)]
    Minimum(#[from] MinimumError),
}

impl Curve {
    /// Checks the points.
    fn check(&self) -> Result<(), CurveError> {
        let (kind, points, most) = match self {
            Self::Polyline(points) => ("polyline", points, MOST_POINTS),
            Self::Bezier(points) => ("Bézier curve", points, 16),
            Self::Helix { radius, pitch, turns } => {
                let is_finite = radius.is_finite() && pitch.is_finite() && turns.is_finite();
                return if is_finite { Ok(()) } else { Err(CurveError::NotFinite) };
            }
            Self::Program(..) => return Ok(()),
        };
        if !(2..=most).contains(&points.len()) {
            return Err(CurveError::Points { kind, most, found: points.len() });
        }
        let is_finite = points.iter().flatten().all(|x| x.is_finite());
        if is_finite { Ok(()) } else { Err(CurveError::NotFinite) }
    }

    /// The point p − c(u), with [`CURVE_PARAMETER`] for u: where a solid that stands at c(u) is asked for its value at p.
    ///
    /// # Errors
    /// Points that make no curve.
    pub fn moved_back(&self, graph: &mut Graph, point: [NodeId; 3]) -> Result<[NodeId; 3], CurveError> {
        self.check()?;
        let u = graph.input(CURVE_PARAMETER);
        let place = self.at(graph, u);
        Ok(translate(graph, point, place))
    }

    /// Where u runs, for [`least`].
    pub fn course(&self) -> Course {
        let corners = match self {
            Self::Polyline(points) if points.len() >= 2 => {
                (0..points.len()).map(|i| i as f64 / (points.len() - 1) as f64).collect()
            }
            _ => Vec::new(),
        };
        Course { over: CURVE_PARAMETER, range: [0.0, 1.0], parts: self.parts(), corners }
    }

    /// In how many parts of the curve the minimum is best searched: few, and none that comes back to where it was.
    fn parts(&self) -> usize {
        let parts = match self {
            Self::Polyline(points) => points.len() / 4,
            Self::Bezier(_) => 2,
            Self::Helix { turns, .. } => turns.abs().ceil() as usize,
            Self::Program(..) => 4,
        };
        parts.clamp(2, 16)
    }

    /// The coordinates of c(u), for the node of u.
    fn at(&self, graph: &mut Graph, u: NodeId) -> [NodeId; 3] {
        if let Self::Program(program, coordinates) = self {
            let copies = graph.import(program, coordinates, |graph, input| match input {
                CURVE_PARAMETER => u,
                other => graph.input(other),
            });
            return [copies[0], copies[1], copies[2]];
        }
        write(graph, |cell| {
            let u = Expr::new(cell, u);
            match self {
                Self::Polyline(points) => polyline(points, u),
                Self::Bezier(points) => bezier(points, u),
                Self::Helix { radius, pitch, turns } => {
                    let angle = std::f64::consts::TAU * *turns * u;
                    Vector([*radius * angle.cos(), *radius * angle.sin(), *pitch * *turns * u])
                }
                Self::Program(..) => Vector([u; 3]),
            }
            .0
            .map(Expr::id)
        })
    }
}

/// p₀ + Σ clamp(n u − i, 0, 1) (pᵢ₊₁ − pᵢ).
fn polyline<'g>(points: &[[f64; 3]], u: Expr<'g>) -> Vector<'g> {
    let count = (points.len() - 1) as f64;
    let mut at = Vector(points[0].map(|x| u.number(x)));
    for (i, pair) in points.windows(2).enumerate() {
        let part = (count * u - i as f64).clamp(0.0, 1.0);
        at = at + Vector([0, 1, 2].map(|k| (pair[1][k] - pair[0][k]) * part));
    }
    at
}

/// In powers of u by Horner's rule, which takes the fewest operations; of higher degree, where powers lose digits,
/// by de Casteljau's construction.
fn bezier<'g>(points: &[[f64; 3]], u: Expr<'g>) -> Vector<'g> {
    if points.len() <= 8 {
        return Vector([0, 1, 2].map(|k| {
            let coefficients = powers(points.iter().map(|p| p[k]).collect());
            let mut rest = coefficients.into_iter().rev();
            let last = u.number(rest.next().unwrap_or(0.0));
            rest.fold(last, |sum, c| sum * u + c)
        }));
    }
    let mut row: Vec<Vector<'g>> = points.iter().map(|p| Vector(p.map(|x| u.number(x)))).collect();
    while row.len() > 1 {
        row = row.windows(2).map(|pair| pair[0] + (pair[1] - pair[0]) * u).collect();
    }
    row[0]
}

/// The coefficients of 1, u, u², … of a polynomial with these Bernstein coefficients: binomials times differences.
fn powers(mut row: Vec<f64>) -> Vec<f64> {
    let degree = row.len() - 1;
    let mut binomial = 1.0;
    (0..=degree)
        .map(|k| {
            let coefficient = binomial * row[0];
            binomial *= (degree - k) as f64 / (k + 1) as f64;
            for i in 0..row.len().saturating_sub(1) {
                row[i] = row[i + 1] - row[i];
            }
            row.pop();
            coefficient
        })
        .collect()
}

/// Sweeps a solid along a curve without turning it: the union of its copies moved by c(u), min over u of f(p − c(u)).
///
/// The solid's program may have any inputs but [`CURVE_PARAMETER`]; x, y and z are its coordinates.
///
/// # Errors
/// Points that make no curve; a solid with a black box.
pub fn sweep(
    graph: &mut Graph,
    program: &Graph,
    output: NodeId,
    curve: &Curve,
) -> Result<NodeId, CurveError> {
    let mut copy = Graph::new();
    let point = [0, 1, 2].map(|k| copy.input(Input::Coordinate(k)));
    let at = curve.moved_back(&mut copy, point)?;
    let value = moved(&mut copy, program, &[output], at)[0];
    Ok(least(graph, (&copy, value), &curve.course(), Graph::input)?)
}

/// Projects a solid along one of its coordinates (usually the fourth, counted 3): the union of its sections,
/// min over w in `range` of f(x, y, z, w).
///
/// # Errors
/// An empty range; a solid with a black box.
pub fn project(
    graph: &mut Graph,
    program: &Graph,
    output: NodeId,
    over: Input,
    range: [f64; 2],
) -> Result<NodeId, MinimumError> {
    least(graph, (program, output), &projection(over, range), Graph::input)
}

/// Where the coordinate of a projection runs, for [`least`].
pub fn projection(over: Input, range: [f64; 2]) -> Course {
    Course { over, range, parts: PROJECTION_PARTS, corners: Vec::new() }
}

/// A ball that moves from point to point: the distance to the nearest stretch less the radius, in closed form.
///
/// # Errors
/// Less than two points; numbers that are not finite.
pub fn tube(
    graph: &mut Graph,
    at: [NodeId; 3],
    points: &[[f64; 3]],
    radius: NodeId,
) -> Result<NodeId, CurveError> {
    Curve::Polyline(points.to_vec()).check()?;
    let nearest = line_distance(graph, at, points);
    let distance = graph.sqrt(nearest);
    Ok(graph.sub(distance, radius))
}
