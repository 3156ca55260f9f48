//! Solids from scattered points of their surface, by radial basis functions.
//!
//! Each point with its normal gives two conditions: 0 at the point and d a little outside (Carr et al. 2001). Up to 600 points a triharmonic spline Σ wᵢ |p − cᵢ|³ + a + b·p meets them all: a dense system,
//! solved once. More conditions are met in two levels (after Ohtake et al. 2003): the triharmonic spline of some of the
//! points, farthest-first, gives the shape everywhere, and Wendland's functions (1995), which vanish beyond a support, the
//! rest by conjugate gradients on a sparse system.

mod kernel;
mod neighbours;
mod normals;
mod solve;
mod sum;

use fieldstone_field::{Function, Interval};
pub use kernel::Kernel;
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};
use sum::{Study, Sum};

/// No cloud has more points.
pub const MAX_POINTS: usize = 50_000;
/// A dense system has no more conditions.
const MAX_DENSE: usize = 1200;
/// The coarse level of a large cloud has so many points.
const COARSE_POINTS: usize = 300;

/// Points of a surface with normals, which point outside.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PointCloud {
    /// The points.
    pub points: Vec<[f64; 3]>,
    /// Their normals, of any length but 0; as many as points.
    pub normals: Vec<[f64; 3]>,
}

/// How points become a solid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reconstruction {
    /// What is added to the diagonal of the system, from 0 on: 0 passes through all points, more smooths noise away.
    pub smoothing: f64,
    /// The distance of the conditions beside the surface, as a part of the diagonal of the points' box; above 0.
    pub offset: f64,
}

impl Default for Reconstruction {
    fn default() -> Self {
        Self { smoothing: 0.0, offset: 0.01 }
    }
}

/// Why points make no solid.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum PointError {
    /// Too few or too many points.
    #[error("a solid needs 4 to {MAX_POINTS} points, not {0}")]
    Count(usize),
    /// Not one normal for each point.
    #[error("{points} points need as many normals, and {normals} are given")]
    Normals {
        /// How many points there are.
        points: usize,
        /// How many normals.
        normals: usize,
    },
    /// A point that is not finite, or a normal without a direction.
    #[error("point {} is not finite or its normal has no direction", .0 + 1)]
    Point(usize),
    /// Options out of range.
    #[error("smoothing must be from 0 on and the offset above 0 and at most 0.2")]
    Options,
    /// The system has no solution: points that coincide, or lie on one plane.
    #[error("the points make no solid: they coincide, or all lie on one plane")]
    Singular,
}

/// The solid of a cloud of points, as a function of x, y and z; negative inside.
#[derive(Debug)]
pub struct Points {
    levels: Vec<Sum>,
    /// No other solid has it.
    number: u64,
}

impl PointCloud {
    /// A cloud of points without normals, which are estimated (Hoppe et al. 1992): good where the points lie closer together
    /// than the surface bends or comes near to itself. A surface inside of another that is no neighbour of it is oriented as if
    /// it stood alone. Takes time in proportion to n log n.
    ///
    /// # Errors
    /// Too few or too many points; points that are not finite.
    pub fn without_normals(points: Vec<[f64; 3]>) -> Result<Self, PointError> {
        check_places(&points)?;
        let normals = normals::estimated(&points);
        Ok(Self { points, normals })
    }

    fn check(&self, options: &Reconstruction) -> Result<(), PointError> {
        check_places(&self.points)?;
        if self.points.len() != self.normals.len() {
            return Err(PointError::Normals { points: self.points.len(), normals: self.normals.len() });
        }
        let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let has_direction = |v| length(v) > 0.0 && length(v).is_finite();
        if let Some(at) = self.normals.iter().position(|normal| !has_direction(normal)) {
            return Err(PointError::Point(at));
        }
        let is_fine = options.smoothing >= 0.0
            && options.smoothing.is_finite()
            && options.offset > 0.0
            && options.offset <= 0.2;
        if is_fine { Ok(()) } else { Err(PointError::Options) }
    }

    /// The corners of the box of the points.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.points.iter().fold(start, |[low, high], p| {
            [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))]
        })
    }

    /// Places and values of the conditions of some of the points.
    fn conditions(&self, chosen: &[usize], distance: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for &i in chosen {
            let (point, normal) = (self.points[i], self.normals[i]);
            let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            for side in [0.0, 1.0] {
                let step = side * distance;
                places.push([0, 1, 2].map(|k| point[k] + step * (normal[k] / length)));
                values.push(step);
            }
        }
        (places, values)
    }

    /// Finds the solid.
    ///
    /// # Errors
    /// Too few or too many points, numbers out of range, points that make no solid.
    pub fn reconstruct(&self, options: &Reconstruction) -> Result<Points, PointError> {
        self.check(options)?;
        let [low, high] = self.bounds();
        let diagonal = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
        let distance = options.offset * diagonal;
        let is_small = 2 * self.points.len() <= MAX_DENSE;
        let all: Vec<usize> = (0..self.points.len()).collect();
        let coarse = if is_small { all.clone() } else { farthest_first(&self.points, COARSE_POINTS) };
        let (places, values) = self.conditions(&coarse, distance);
        let base = solve::dense(&places, &values, options.smoothing).ok_or(PointError::Singular)?;
        if is_small {
            return Ok(Points::new(vec![base]));
        }
        let (places, values) = self.conditions(&all, distance);
        let rest: Vec<f64> = places.iter().zip(&values).map(|(p, v)| v - base.value(*p)).collect();
        // About forty neighbours in the support of a point on the surface.
        let spacing = diagonal * diagonal / all.len() as f64;
        let support = (3.0 * distance).max((40.0 / std::f64::consts::PI * spacing).sqrt());
        let fine = solve::sparse(&places, &rest, support, options.smoothing);
        Ok(Points::new(vec![base, fine]))
    }
}

/// Whether there are as many points as a solid may have, and all are finite.
fn check_places(points: &[[f64; 3]]) -> Result<(), PointError> {
    if !(4..=MAX_POINTS).contains(&points.len()) {
        return Err(PointError::Count(points.len()));
    }
    // NaN is no less.
    let is_fine = |p: &[f64; 3]| p.iter().all(|x| x.abs() <= 1e9);
    points.iter().position(|p| !is_fine(p)).map_or(Ok(()), |at| Err(PointError::Point(at)))
}

/// Points that lie far apart: each is the one farthest from those before it.
fn farthest_first(points: &[[f64; 3]], count: usize) -> Vec<usize> {
    let squared = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let mut chosen = vec![0];
    let mut distances: Vec<f64> = points.iter().map(|p| squared(p, &points[0])).collect();
    while chosen.len() < count.min(points.len()) {
        let farthest = (0..points.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        let Some(next) = farthest else { break };
        chosen.push(next);
        for (distance, p) in distances.iter_mut().zip(points) {
            *distance = distance.min(squared(p, &points[next]));
        }
    }
    chosen
}

impl Function for Points {
    fn name(&self) -> &str {
        "a solid from points"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        let &[x, y, z] = arguments else { return f64::NAN };
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return f64::NAN;
        }
        self.levels.iter().map(|level| level.value([x, y, z])).sum()
    }

    /// At a point, the value with its error. Over a box nothing: what follows from the value, the gradient and the
    /// [`curvature`](Function::curvature) in its middle, which evaluators work out themselves, is as tight as can be had.
    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        let &[x, y, z] = arguments else { return Interval::undefined() };
        let sides = [x, y, z];
        if sides.iter().any(|s| !(s.lo.is_finite() && s.hi.is_finite())) {
            return Interval::undefined();
        }
        if sides.iter().any(|s| s.lo < s.hi) {
            return Interval::new(f64::NEG_INFINITY, f64::INFINITY);
        }
        let study = self.study(sides.map(|s| s.lo), 0.0);
        Interval::new(study.value - study.error, study.value + study.error)
    }

    /// The norm of the second derivatives in the middle, and what they change on the way to a corner.
    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        let &[x, y, z] = arguments else { return f64::INFINITY };
        let sides = [x, y, z];
        let middle = sides.map(|s| (0.5 * s.lo + 0.5 * s.hi).max(s.lo).min(s.hi));
        if middle.iter().any(|m| !m.is_finite()) {
            return f64::INFINITY;
        }
        let squares = [0, 1, 2].map(|k| (sides[k].hi - middle[k]).max(middle[k] - sides[k].lo).powi(2));
        let reach = squares.iter().sum::<f64>().sqrt() * (1.0 + 1e-12);
        let study = self.study(middle, reach);
        (study.bend + study.twist * reach) * (1.0 + 1e-12)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        match *arguments {
            [x, y, z] if x.is_finite() && y.is_finite() && z.is_finite() => {
                gradient.copy_from_slice(&self.study([x, y, z], 0.0).gradient);
            }
            _ => gradient.fill(f64::NAN),
        }
    }
}

thread_local! {
    /// The last study of this thread, with the cloud and the point: evaluators ask for the curvature, the value and the
    /// gradient of one place, one after another.
    static LAST: Cell<(u64, [f64; 3], Study)> = Cell::new((0, [0.0; 3], Study::default()));
}

impl Points {
    fn new(levels: Vec<Sum>) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(1);
        Self { levels, number: COUNT.fetch_add(1, Ordering::Relaxed) }
    }

    /// What is known about the function near a point; a study within a larger distance will do for value and gradient.
    fn study(&self, p: [f64; 3], distance: f64) -> Study {
        let (number, point, known) = LAST.get();
        if number == self.number && point == p && distance == 0.0 {
            return known;
        }
        let studies = self.levels.iter().map(|level| level.study(p, distance));
        let study = studies.reduce(Study::and).unwrap_or_default();
        LAST.set((self.number, p, study));
        study
    }
}
