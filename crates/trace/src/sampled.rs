//! Fixed steps along a ray, with a bracketed solve where the sign changes: fast, and without proof.

use crate::march::Job;
use crate::ray::{Certificate, Hit, Outcome, Settings};
use crate::solver::Solver;
use fieldstone_field::{F64, LANES, Points, Tape, Workspace};

#[derive(Clone, Copy, Debug)]
struct Walker {
    job: Job,
    t: f64,
    value: f64,
    inside: Option<bool>,
    solver: Option<Solver>,
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
            inside,
            solver: None,
            hit: None,
            undefined: false,
            cost: 0,
            done: ray.is_empty(),
        }
    }

    fn next_t(&self, step: f64) -> f64 {
        match (&self.solver, self.cost) {
            (Some(solver), _) => solver.wants().unwrap_or(self.t),
            (None, 0) => self.t,
            (None, _) => (self.t + step).min(self.job.ray.end),
        }
    }

    fn take(&mut self, t: f64, value: f64, settings: &Settings) {
        self.cost += 1;
        self.undefined |= value.is_nan();
        // An undefined value counts as outside.
        let value = if value.is_nan() { f64::MAX } else { value };
        if let Some(solver) = &mut self.solver {
            solver.supply(value);
        } else {
            let inside = *self.inside.get_or_insert(value < 0.0);
            if self.cost > 1 && (value < 0.0) != inside {
                let tolerance = settings.tolerance * settings.size;
                self.solver = Some(Solver::new((self.t, self.value), (t, value), tolerance));
            }
            (self.t, self.value) = (t, value);
            let capped = inside && settings.caps;
            self.done = self.solver.is_none() && (capped || t >= self.job.ray.end);
        }
        self.finish_solve();
    }

    fn finish_solve(&mut self) {
        let Some(solver) = &self.solver else { return };
        if solver.wants().is_some() {
            return;
        }
        let [near, far] = solver.bracket();
        let entering = self.inside != Some(true);
        let jump = near.1.abs().min(far.1.abs()) > 1e-3;
        let t = 0.5 * (near.0 + far.0);
        self.hit = Some(Hit { t, before: near.0, after: far.0, entering, jump });
        self.done = true;
    }

    fn outcome(&self, black_box: bool) -> Outcome {
        let certificate =
            if black_box || self.undefined { Certificate::Undecided } else { Certificate::Tolerance };
        let starts_inside = self.inside == Some(true);
        let ends_inside = starts_inside && self.hit.is_none();
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
