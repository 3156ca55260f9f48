//! Poles, which surfaces without an inside have no part in: the sign changes there, and there is no root.

use super::{Lane, Walk, Wish};
use crate::ray::Certificate;
use crate::solver::Solver;

/// How long the next span is behind a pole, compared with the bracket around it.
const POLE_LENGTH: f64 = 16.0;

impl Lane {
    /// Whether a solve found a pole, or came back to the last one from too near for values to tell.
    pub(super) fn is_at_pole(&self, solver: &Solver) -> bool {
        let [near, far] = solver.bracket();
        solver.is_at_pole() || self.pole.is_some_and(|(from, to)| near.0 <= to && from <= far.0)
    }

    /// Goes on behind a pole, which is no part of a surface, as soon as everything before it is excluded.
    pub(super) fn pass_pole(&mut self, [near, far]: [(f64, f64); 2]) {
        self.pole = Some((near.0, far.0));
        let (start, stop) = self.span();
        let (before, width) = (near.0 - self.front, far.0 - near.0);
        match self.walk {
            Walk::Front { .. } if before > width && before < stop - start => {
                self.walk = Walk::Front { length: before };
                self.wish = Wish::Span;
            }
            Walk::Dyadic { .. } if stop - start > width => self.refine((start, stop), (start, stop)),
            _ => {
                // A root in so short a bracket cannot be told from the pole.
                self.doubt(Certificate::Tolerance);
                self.inside = !self.inside;
                self.pass(far.0, POLE_LENGTH * width);
            }
        }
    }
}
