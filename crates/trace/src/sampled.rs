//! Fixed steps along a ray, with a bracketed solve where the sign changes: fast, and without proof.
//!
//! For surfaces without an inside, the least |f| is searched around a step where it is lower than at its neighbours.

use crate::march::{Job, rounding};
use crate::minimiser::Minimiser;
use crate::ray::{Certificate, Hit, Outcome, Settings};
use crate::solver::Solver;
use fieldstone_field::{F64, LANES, Points, Tape, Workspace};

/// A ray ends, undecided, after so many evaluations.
const MOST_STEPS: u32 = 1 << 21;
/// A minimum of |f| so far below the values a step before and behind counts as 0.
const TOUCH: f64 = 1.0 / (1u64 << 30) as f64;

#[derive(Clone, Copy, Debug)]
struct Walker {
    job: Job,
    t: f64,
    value: f64,
    /// The step before this one.
    last: (f64, f64),
    /// Whether the field was negative at the last step, and where the ray starts: the same, but for poles.
    inside: Option<bool>,
    started_inside: Option<bool>,
    solver: Option<Solver>,
    /// A search for a touching point, and below which |f| it is one.
    search: Option<(Minimiser, f64)>,
    hit: Option<Hit>,
    undefined: bool,
    cost: u32,
    done: bool,
}

impl Walker {
    fn new(job: Job) -> Self {
        let Job { ray, inside, .. } = job;
        Self {
            job,
            t: ray.start,
            value: 0.0,
            last: (ray.start, 0.0),
            inside,
            started_inside: inside,
            solver: None,
            search: None,
            hit: None,
            undefined: false,
            cost: 0,
            done: ray.is_empty(),
        }
    }

    fn next_t(&self, step: f64) -> f64 {
        match (&self.solver, &self.search, self.cost) {
            (Some(solver), ..) => solver.wants().unwrap_or(self.t),
            (None, Some((minimiser, _)), _) => minimiser.wants().unwrap_or(self.t),
            (None, None, 0) => self.t,
            (None, None, _) => (self.t + step).min(self.job.ray.end),
        }
    }

    fn take(&mut self, t: f64, value: f64, settings: &Settings) {
        self.cost += 1;
        self.undefined |= value.is_nan();
        // An undefined value counts as outside.
        let value = if value.is_nan() { f64::MAX } else { value };
        let inside = *self.inside.get_or_insert(value < 0.0);
        self.started_inside.get_or_insert(inside);
        let crossed = (value < 0.0) != inside && !(settings.surface && value == 0.0);
        if let Some(solver) = &mut self.solver {
            solver.supply(value);
        } else if let Some((minimiser, _)) = self.search.as_mut().filter(|_| !crossed) {
            minimiser.supply(value.abs());
            self.finish_search(settings);
        } else {
            if self.cost > 1 && crossed {
                let near = if self.search.is_some() { self.last } else { (self.t, self.value) };
                let tolerance = settings.tolerance * settings.size;
                self.solver = Some(Solver::new(near, (t, value), tolerance));
            } else if settings.surface {
                self.look_for_touch(t, value);
            }
            if self.search.is_none() {
                self.last = (self.t, self.value);
            }
            (self.t, self.value) = (t, value);
            let capped = inside && settings.caps;
            let at_end = capped || t >= self.job.ray.end;
            self.undefined |= self.cost >= MOST_STEPS;
            self.done = self.solver.is_none() && self.search.is_none() && (at_end || self.cost >= MOST_STEPS);
        }
        self.finish_solve(settings);
    }

    /// Begins a search between the last step but one and this one if |f| is least at the last.
    fn look_for_touch(&mut self, t: f64, value: f64) {
        let (before, here, behind) = (self.last.1.abs(), self.value.abs(), value.abs());
        if self.cost > 2 && here <= before && here <= behind && here < before.max(behind) {
            let tolerance = rounding(&self.job.ray, t);
            let minimiser = Minimiser::new((self.last.0, before), (t, behind), tolerance);
            self.search = Some((minimiser, TOUCH * before.max(behind)));
        }
    }

    fn finish_search(&mut self, settings: &Settings) {
        let Some((minimiser, zero)) = &self.search else { return };
        if minimiser.wants().is_some() {
            return;
        }
        if let Some((t, _)) = minimiser.minimum().filter(|(_, value)| value <= zero) {
            let entering = self.inside != Some(true);
            let before = t - settings.tolerance * settings.size;
            self.hit = Some(Hit { t, before, after: t, entering, jump: false, touching: true });
        }
        self.done = self.hit.is_some() || self.t >= self.job.ray.end;
        self.search = None;
    }

    fn finish_solve(&mut self, settings: &Settings) {
        let Some(solver) = &self.solver else { return };
        if solver.wants().is_some() {
            return;
        }
        if settings.surface && solver.is_at_pole() {
            // No part of a surface: on from the step behind it.
            self.inside = self.inside.map(|inside| !inside);
            (self.solver, self.search) = (None, None);
            (self.last, self.done) = ((self.t, self.value), self.t >= self.job.ray.end);
            return;
        }
        let [near, far] = solver.bracket();
        let entering = self.inside != Some(true);
        let jump = near.1.abs().min(far.1.abs()) > 1e-3;
        let t = 0.5 * (near.0 + far.0);
        self.hit = Some(Hit { t, before: near.0, after: far.0, entering, jump, touching: false });
        self.done = true;
    }

    fn outcome(&self, black_box: bool) -> Outcome {
        let certificate =
            if black_box || self.undefined { Certificate::Undecided } else { Certificate::Tolerance };
        let starts_inside = self.started_inside == Some(true);
        let ends_inside = self.inside == Some(true) && self.hit.is_none();
        Outcome { hit: self.hit, certificate, cost: self.cost, starts_inside, ends_inside }
    }
}

/// Samples every job; `finish` takes each outcome with its job as it is found.
pub(crate) fn run(
    points: &mut Workspace<F64, Points>,
    tape: &Tape,
    (settings, step): (&Settings, f64),
    jobs: impl Iterator<Item = Job>,
    mut finish: impl FnMut(&Job, Outcome),
) {
    let mut jobs = jobs.fuse();
    let mut walkers: Vec<Walker> = jobs.by_ref().take(LANES).map(Walker::new).collect();
    let mut places = [0.0; LANES];
    while !walkers.is_empty() {
        for (i, walker) in walkers.iter().enumerate() {
            places[i] = walker.next_t(step);
            for (axis, x) in walker.job.ray.at(places[i]).into_iter().enumerate() {
                points.input(axis, 0)[i] = x;
            }
        }
        points.run(tape, walkers.len());
        let values = points.output(0, 0);
        for (i, walker) in walkers.iter_mut().enumerate().filter(|(_, w)| !w.done) {
            walker.take(places[i], values[i], settings);
        }
        let mut i = 0;
        while i < walkers.len() {
            if walkers[i].done {
                finish(&walkers[i].job, walkers[i].outcome(tape.has_black_box()));
                match jobs.next() {
                    Some(job) => walkers[i] = Walker::new(job),
                    None => {
                        walkers.swap_remove(i);
                        continue;
                    }
                }
            }
            i += 1;
        }
    }
}
