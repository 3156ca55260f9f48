//! The squared distance to a curve, as a [`Function`]: what a ball that moves along a curve is made of.
//!
//! # Theory
//! The curve is cut into stretches that hardly bend, in a tree (`tree`). A point finds its nearest place by a search of the
//! tree, and Newton's method for (c(u) − x)·c′(u) = 0 (`search`). Where q = |c′|² + (c − x)·c″ > 0 all over a stretch, the
//! squared distance is convex along it, and what Newton's method finds is the minimum.
//!
//! A box with the middle m and the half diagonal r has two kinds of bounds. Distances change by no more than one moves:
//! D(m) − r ≤ D ≤ D(m) + r. And since |x − c(u)|² − |x − c(v)|² is linear in x, the minimiser v of m stays ahead of u in
//! the whole box if |m − c(u)|² − D(m)² > 2r·|c(u) − c(v)|. If the stretches that are left follow one another, and the
//! squared distance is convex along all of them for all points of the box, there is one minimiser, the gradient of D² is
//! 2(x − c), which moves without jumps, and the second derivatives are 2 across the tangent and 2·((c − x)·c″)/q along it (2 at
//! an end of the curve).
//!
//! # Rounding
//! Every stretch is a polynomial, which leaves the exact curve by no more than the error of its Taylor model (`taylor`), rounding
//! included. What the search leaves of the derivative along the curve is bounded by when it ends. Both are added to
//! what is said of boxes, and where they may be more than a gradient allows there is no curvature.
//!
//! Evaluators ask for the middle of a box in more than one way, which rounding tells apart. So places are searched for the
//! points of a fine grid, and one search does for all of them: the place found is then as far from the nearest one
//! as the grid is fine, and its distance too large by the square of that.

mod search;
mod taylor;
mod tree;

use crate::minimum::MinimumError;
use fieldstone_field::{Function, Graph, Input, Interval, NodeId};
use search::Found;
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tree::Tree;

/// Second derivatives larger than this are of no use.
const STEEP: f64 = 100.0;
/// What [`Function::curvature`] asks of gradients, relative to their largest component, with room.
const GRADIENT_ERROR: f64 = 0.5e-10;
/// A box that more stretches may be nearest to has bounds from its middle only.
const MOST_STRETCHES: usize = 64;

/// min over u of |x − c(u)|², as a function of the three coordinates of x.
pub(crate) struct Nearest {
    tree: Tree,
    /// No other curve has it.
    number: u64,
}

/// What is known about a box.
#[derive(Clone, Copy, Debug)]
struct Study {
    range: Interval<f64>,
    curvature: f64,
}

/// The last results of this thread: evaluators ask for the same box and its middle several times in turn.
#[derive(Clone, Copy)]
struct Last {
    points: [(u64, [f64; 3], Found); 2],
    boxes: (u64, [Interval<f64>; 3], Study),
}

const NOTHING: Study = Study { range: Interval::undefined(), curvature: f64::INFINITY };

thread_local! {
    static LAST: Cell<Last> = const {
        Cell::new(Last {
            points: [(0, [0.0; 3], Found::NONE); 2],
            boxes: (0, [Interval::undefined(); 3], NOTHING),
        })
    };
}

impl Nearest {
    /// The curve whose coordinates are three nodes of a program of `over`, from `range[0]` to `range[1]`. `None` where
    /// too little is known of the program: calls, loops, places where it is undefined.
    ///
    /// # Errors
    /// An empty range.
    pub(crate) fn new(
        program: &Graph,
        coordinates: [NodeId; 3],
        over: Input,
        range: [f64; 2],
    ) -> Result<Option<Self>, MinimumError> {
        static COUNT: AtomicU64 = AtomicU64::new(1);
        if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
            return Err(MinimumError::Range(range[0], range[1]));
        }
        let tree = Tree::new(program, coordinates, (over, range));
        Ok(tree.map(|tree| Self { tree, number: COUNT.fetch_add(1, Ordering::Relaxed) }))
    }

    /// A call with the nodes of a point.
    pub(crate) fn call(self, graph: &mut Graph, point: [NodeId; 3]) -> NodeId {
        let function: Arc<dyn Function> = Arc::new(self);
        graph.call(&function, &point)
    }

    /// The nearest place of a point, as near as the grid tells, and its squared distance.
    fn found(&self, x: [f64; 3]) -> (Found, f64) {
        let found = self.found_on_grid(self.tree.on_grid(x));
        let away = [0, 1, 2].map(|k| x[k] - found.at[k]);
        (found, away.iter().map(|a| a * a).sum())
    }

    fn found_on_grid(&self, x: [f64; 3]) -> Found {
        let last = LAST.get();
        let known = last.points.iter().find(|(number, point, _)| *number == self.number && *point == x);
        if let Some((.., found)) = known {
            return *found;
        }
        let found = self.tree.search(x);
        let points = [(self.number, x, found), last.points[0]];
        LAST.set(Last { points, ..last });
        found
    }

    fn study(&self, sides: [Interval<f64>; 3]) -> Study {
        let (number, known, study) = LAST.get().boxes;
        if number == self.number && known == sides {
            return study;
        }
        let study = self.study_anew(sides);
        LAST.set(Last { boxes: (self.number, sides, study), ..LAST.get() });
        study
    }

    fn study_anew(&self, sides: [Interval<f64>; 3]) -> Study {
        let middle = sides.map(|s| (0.5 * s.lo + 0.5 * s.hi).max(s.lo).min(s.hi));
        let squares = [0, 1, 2].map(|k| (sides[k].hi - middle[k]).max(middle[k] - sides[k].lo).powi(2));
        let reach = squares.iter().sum::<f64>().sqrt() * (1.0 + 1e-12);
        let (found, squared) = self.found(middle);
        let near = self.tree.near((middle, reach), &found);
        let low = (self.tree.floor(middle, &found) - reach).max(0.0);
        let far = match near.convexity {
            // What the search finds is the minimum in the whole box.
            Some(_) => (squared.sqrt() + reach) * (1.0 + 1e-14) + near.error,
            // It looks at the middle of the stretch, too.
            None => self.tree.farthest(found.leaf, sides),
        };
        let range = Interval::new(low * low * (1.0 - 1e-14), far * far * (1.0 + 1e-14));
        let curvature = match near.convexity {
            Some(curvature) if near.is_single && near.drift <= GRADIENT_ERROR * low => curvature,
            _ => f64::INFINITY,
        };
        Study { range, curvature: if curvature <= STEEP { curvature } else { f64::INFINITY } }
    }
}

/// Three finite sides.
fn sides_of(arguments: &[Interval<f64>]) -> Option<[Interval<f64>; 3]> {
    let sides: [Interval<f64>; 3] = arguments.try_into().ok()?;
    // Squares of larger numbers are not finite.
    sides.iter().all(|s| s.lo.abs() < 1e150 && s.hi.abs() < 1e150).then_some(sides)
}

fn point_of(arguments: &[f64]) -> Option<[f64; 3]> {
    let point: [f64; 3] = arguments.try_into().ok()?;
    point.iter().all(|x| x.abs() < 1e150).then_some(point)
}

impl Function for Nearest {
    fn name(&self) -> &str {
        "the squared distance to a curve"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        point_of(arguments).map_or(f64::NAN, |x| self.found(x).1)
    }

    fn interval(&self, arguments: &[Interval<f64>]) -> Interval<f64> {
        let Some(sides) = sides_of(arguments) else { return Interval::undefined() };
        if sides.iter().all(|s| s.lo == s.hi) {
            let point = sides.map(|s| s.lo);
            let (found, squared) = self.found(point);
            let floor = self.tree.floor(point, &found).powi(2) * (1.0 - 1e-14);
            return Interval::new(floor.min(squared), squared);
        }
        self.study(sides).range
    }

    fn curvature(&self, arguments: &[Interval<f64>]) -> f64 {
        sides_of(arguments).map_or(f64::INFINITY, |sides| self.study(sides).curvature)
    }

    fn is_black_box(&self) -> bool {
        false
    }

    fn gradient(&self, arguments: &[f64], gradient: &mut [f64]) {
        let Some(x) = point_of(arguments) else {
            gradient.fill(f64::NAN);
            return;
        };
        let (found, _) = self.found(x);
        for (k, slope) in gradient.iter_mut().enumerate() {
            *slope = 2.0 * (x[k] - found.at[k]);
        }
    }
}
