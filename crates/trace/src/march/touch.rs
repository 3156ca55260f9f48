//! Surfaces without an inside: places where a field touches 0 and keeps its sign.
//!
//! A double root has no change of sign to be found by. Where a short span cannot be excluded, the next minimum of |f| from
//! there on is searched (downhill with growing steps, then Brent 1973), and the field is evaluated over sets *at that one point*, as wide as the rounding of the ray's
//! points makes it. If that set holds 0, no arithmetic of this precision can tell the field from 0 there: the ray
//! touches the surface. If it does not, the surface is passed at a distance, and the march goes on to prove so. Hence
//! what is drawn besides the surface is what comes as close to it as rounding, whatever the size of pixels.
//!
//! Such a hit rests on a tolerance. So does what lies between it and a place before it where the field can well be told
//! from 0; everything before that is excluded as for other candidates.

use super::{Lane, Span, Wish};
use crate::minimiser::Minimiser;
use crate::ray::{Hit, Ray, Settings};
use crate::solver::Solver;

/// A minimum is searched again, before the last one, when the span has become shorter by this factor.
const SEARCH_AGAIN: f64 = 1.0 / 16.0;
/// By how much the steps downhill grow.
const DOWNHILL: f64 = 2.0;
/// By how much more the place before a touching point is moved back, as long as the field there may be 0.
const BACK: f64 = 4.0;
/// How far that goes at most, relative to the size.
const FARTHEST_BACK: f64 = 1.0 / 1024.0;

/// A place with its value.
type Valued = (f64, f64);

/// How far minima have been searched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Searched {
    /// Up to where.
    to: f64,
    /// How long the span was.
    length: f64,
}

impl Searched {
    pub(super) const NOTHING: Self = Self { to: f64::NEG_INFINITY, length: f64::INFINITY };
}

/// A search for a minimum of |f|. Values are those of the field, all of one sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    stage: Stage,
    /// The part of the span that could not be excluded.
    span: (f64, f64),
    /// A place before the minimum at which the field is not 0.
    near: Valued,
}

#[derive(Clone, Copy, Debug)]
enum Stage {
    /// From `near` to `here` |f| falls; what comes behind?
    Downhill { here: Valued, next: f64 },
    /// There is a minimum in a bracket.
    Bracketed(Minimiser),
    /// The field may be 0 at a place; does it change its sign right behind?
    Behind { probe: Probe, next: f64 },
}

impl Search {
    pub(super) fn wants(&self) -> Option<f64> {
        match self.stage {
            Stage::Downhill { next, .. } | Stage::Behind { next, .. } => Some(next),
            Stage::Bracketed(ref minimiser) => minimiser.wants(),
        }
    }

    /// Takes the value at the place that [`wants`](Self::wants) named. `end` and `tolerance` bound the search.
    fn supply(&mut self, t: f64, value: f64, end: f64, tolerance: f64) {
        match &mut self.stage {
            Stage::Bracketed(minimiser) => minimiser.supply(value.abs()),
            Stage::Behind { .. } => {}
            Stage::Downhill { here, .. } if value.abs() < here.1.abs() && t < end => {
                let next = (t + DOWNHILL * (t - self.near.0)).min(end);
                // A change of sign is solved from a place that has one.
                self.near = if here.1 == 0.0 { self.near } else { *here };
                self.stage = Stage::Downhill { here: (t, value), next };
            }
            Stage::Downhill { here, .. } => {
                let [near, here, far] = [self.near, *here, (t, value)].map(|(t, f)| (t, f.abs()));
                let minimiser = Minimiser::around(near, here, far, tolerance);
                self.stage = Stage::Bracketed(minimiser);
            }
        }
    }
}

/// A place where the field may be 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// The place.
    at: f64,
    /// How far before it the field is asked for next; 0 as long as the place itself is in question.
    back: f64,
    /// The span that it lies in.
    span: (f64, f64),
    /// A place before it at which the field is not 0.
    near: Valued,
}

impl Probe {
    /// Where the field is asked for.
    pub(super) fn wanted_span(&self) -> (f64, f64) {
        (self.at - self.back, self.at - self.back)
    }
}

/// How far two points of a ray at t are apart that rounding cannot tell from each other.
pub(crate) fn rounding(ray: &Ray, t: f64) -> f64 {
    2.0 * f64::EPSILON * ray.origin.iter().fold(t.abs(), |most, o| most.max(o.abs()))
}

impl Lane {
    /// Looks for a touching point in the part between `near` and `far` of a short span, at whose ends the field has the
    /// same sign.
    pub(super) fn look_for_touch(&mut self, near: Valued, far: Valued, settings: &Settings) {
        let (start, stop) = self.span();
        let span = (near.0, far.0);
        if near.1 == 0.0 || stop - start <= self.floor(settings) {
            let [low, high] = [near, far].map(|(t, f)| (t, f.abs()));
            let minimiser = Minimiser::with_ends(low, high, rounding(&self.job.ray, far.0));
            self.continue_search(Search { stage: Stage::Bracketed(minimiser), span, near });
        } else if stop > self.searched.to || stop - start <= SEARCH_AGAIN * self.searched.length {
            self.searched = Searched { to: far.0, length: stop - start };
            let next = far.0 + DOWNHILL * (far.0 - near.0);
            let stage = if far.1.abs() < near.1.abs() && next < self.end {
                Stage::Downhill { here: far, next }
            } else {
                let [near, far] = [near, far].map(|(t, f)| (t, f.abs()));
                Stage::Bracketed(Minimiser::new(near, far, rounding(&self.job.ray, far.0)))
            };
            self.continue_search(Search { stage, span, near });
        } else {
            self.refine((start, stop), span);
        }
    }

    /// Takes a value for a search. A change of sign on the way is worth more than a minimum.
    pub(super) fn take_minimum(&mut self, mut search: Search, value: f64, settings: &Settings) {
        let Some(t) = search.wants() else { return };
        let value = self.defined(value);
        if self.is_across(value, settings) {
            let solver = Solver::new(search.near, (t, value), settings.tolerance * settings.size);
            return self.continue_solve(solver, settings);
        }
        if let Stage::Behind { probe, .. } = search.stage {
            return self.probe_before(probe, settings);
        }
        self.searched.to = self.searched.to.max(t);
        search.supply(t, value, self.end, rounding(&self.job.ray, t));
        self.continue_search(search);
    }

    fn continue_search(&mut self, search: Search) {
        let minimum = match (search.wants(), search.stage) {
            (None, Stage::Bracketed(minimiser)) => minimiser.minimum(),
            _ => return self.wish = Wish::Search(search),
        };
        match minimum {
            Some((at, _)) => {
                self.wish = Wish::Probe(Probe { at, back: 0.0, span: search.span, near: search.near })
            }
            None => self.refine(self.span(), search.span),
        }
    }

    /// Takes the field over the one place that a probe is at, or over one before it.
    pub(super) fn take_probe(&mut self, probe: Probe, field: &Span, settings: &Settings) {
        self.cost += 1;
        let may_be_zero = field.lo <= 0.0 && field.hi >= 0.0;
        if probe.back == 0.0 {
            if !may_be_zero {
                return self.leave(probe, settings);
            }
            if settings.any_hit {
                return self.accept(probe.at, probe.at);
            }
            if probe.near.1 == 0.0 {
                return self.probe_before(probe, settings);
            }
            // A root at the very end of a span is a change of sign all the same.
            let next = probe.at + settings.tolerance * settings.size;
            let Probe { span, near, .. } = probe;
            return self.wish = Wish::Search(Search { stage: Stage::Behind { probe, next }, span, near });
        }
        if field.excludes_zero() || probe.back > FARTHEST_BACK * settings.size {
            // Once more, so that spans which end there can be told from 0 too.
            let before = probe.at - BACK * probe.back;
            return self.touch(probe.at, before.max(self.front));
        }
        self.probe_before(probe, settings);
    }

    /// Asks for the field over the next place before a touching point.
    fn probe_before(&mut self, mut probe: Probe, settings: &Settings) {
        probe.back = (BACK * probe.back).max(settings.tolerance * settings.size);
        if probe.at - probe.back > self.front {
            self.wish = Wish::Probe(probe);
        } else {
            self.touch(probe.at, self.front);
        }
    }

    /// Goes on after a place where the field is not 0 after all.
    fn leave(&mut self, probe: Probe, settings: &Settings) {
        let (start, stop) = self.span();
        if stop - start <= self.floor(settings) {
            self.pass_over(probe.span, settings);
        } else {
            self.refine((start, stop), probe.span);
        }
    }

    /// Makes a touching point the candidate, and looks at what lies before it.
    pub(super) fn touch(&mut self, at: f64, before: f64) {
        let entering = !self.inside;
        self.make_candidate(Hit { t: at, before, after: at, entering, jump: false, touching: true });
    }
}
