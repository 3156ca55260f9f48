//! Bundles: rays that run close together share what intervals find out about the space that they cross.
//!
//! The stretch of a bundle is cut into slabs. The box of each slab is evaluated over intervals, all slabs at once: where
//! that excludes the surface, no ray of the bundle looks; elsewhere the rays march with the program shortened to what
//! can matter inside the box.

use crate::march::{Job, Marcher};
use crate::ray::{Certificate, Method, Outcome, Ray, Settings};
use crate::sampled;
use fieldstone_field::{F64, Intervals, LANES, Points, Tape, Workspace};

/// Into how many slabs a bundle is cut.
const SLABS: usize = 16;

/// Finds first hits; keeps its memory between calls, so that a thread needs only one.
#[derive(Debug, Default)]
pub struct Tracer {
    marcher: Marcher,
    boxes: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
    shared_cost: u64,
}

/// What intervals say of a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slab {
    /// Nobody crosses it.
    Empty,
    /// The field is positive all over.
    Outside,
    /// The field is negative all over.
    Inside,
    /// There may be surface.
    Open,
}

impl Tracer {
    /// A tracer.
    pub fn new() -> Self {
        Self::default()
    }

    /// Evaluations of sets that served whole bundles, since the tracer was made.
    pub fn shared_cost(&self) -> u64 {
        self.shared_cost
    }

    /// The first crossing of every ray.
    ///
    /// `tape` takes x, y, z and may have been compiled for [`Reading::Sign`](fieldstone_field::Reading::Sign). Rays
    /// that run close together, a tile of pixels, say, should come together.
    pub fn first_hits(&mut self, tape: &Tape, rays: &[Ray], settings: &Settings) -> Vec<Outcome> {
        let mut outcomes = vec![Outcome::nothing(); rays.len()];
        if let Method::Sampled { step } = settings.method {
            let jobs = rays.iter().enumerate().map(|(place, &ray)| Job { ray, place, inside: None });
            let finish = |job: &Job, outcome| outcomes[job.place] = outcome;
            sampled::run(&mut self.points, tape, (settings, step), jobs, finish);
            return outcomes;
        }
        let extent = rays
            .iter()
            .filter(|r| r.start < r.end)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |e, r| (e.0.min(r.start), e.1.max(r.end)));
        if extent.0 < extent.1 {
            self.march_slabs(tape, rays, settings, extent, &mut outcomes);
        }
        outcomes
    }

    fn march_slabs(
        &mut self,
        tape: &Tape,
        rays: &[Ray],
        settings: &Settings,
        (from, to): (f64, f64),
        outcomes: &mut [Outcome],
    ) {
        let cut = |i: usize| from + (to - from) * i as f64 / SLABS as f64;
        let slabs = self.classify(tape, rays, &cut);
        // The rays on their way, with what is known of the side that they are on.
        let mut under_way: Vec<(usize, Option<bool>)> = (0..rays.len()).map(|i| (i, None)).collect();
        for (i, &slab) in slabs.iter().enumerate() {
            if under_way.is_empty() {
                break;
            }
            match slab {
                Slab::Empty => {}
                Slab::Outside | Slab::Inside => {
                    pass(rays, (cut(i), cut(i + 1)), slab == Slab::Inside, &mut under_way, outcomes);
                }
                Slab::Open => {
                    let short = tape.specialise(|place| self.boxes.choice(place, i));
                    self.march_slab(&short, rays, settings, (cut(i), cut(i + 1)), &mut under_way, outcomes);
                }
            }
        }
    }

    /// What intervals say of the slabs, all at once.
    fn classify(&mut self, tape: &Tape, rays: &[Ray], cut: &impl Fn(usize) -> f64) -> [Slab; SLABS] {
        const { assert!(SLABS <= LANES) };
        let mut empty = [true; SLABS];
        for (i, empty) in empty.iter_mut().enumerate() {
            let (lo, hi) = slab_box(rays, cut(i), cut(i + 1));
            *empty = !(lo[0] <= hi[0]);
            for axis in 0..3 {
                let (lo, hi) = if *empty { (0.0, 0.0) } else { (lo[axis], hi[axis]) };
                // Rounding of the rays' points is far below this.
                let slack = 1e-12 * (lo.abs() + hi.abs());
                self.boxes.input(axis, 0)[i] = lo - slack;
                self.boxes.input(axis, 1)[i] = hi + slack;
            }
        }
        self.boxes.run_traced(tape, SLABS);
        self.shared_cost += SLABS as u64;
        let (lo, hi) = (self.boxes.output(0, 0), self.boxes.output(0, 1));
        std::array::from_fn(|i| match (empty[i], lo[i] > 0.0, hi[i] < 0.0) {
            (true, ..) => Slab::Empty,
            (_, true, _) => Slab::Outside,
            (_, _, true) => Slab::Inside,
            _ => Slab::Open,
        })
    }

    fn march_slab(
        &mut self,
        tape: &Tape,
        rays: &[Ray],
        settings: &Settings,
        (a, b): (f64, f64),
        under_way: &mut Vec<(usize, Option<bool>)>,
        outcomes: &mut [Outcome],
    ) {
        let jobs = under_way.iter().enumerate().map(|(place, &(ray, inside))| {
            let whole = rays[ray];
            Job { ray: Ray { start: whole.start.max(a), end: whole.end.min(b), ..whole }, place, inside }
        });
        let mut next = under_way.clone();
        self.marcher.run(tape, settings, jobs, |job, found| {
            let (ray, inside) = under_way[job.place];
            let outcome = &mut outcomes[ray];
            outcome.cost += found.cost;
            if !(job.ray.start < job.ray.end) {
                return;
            }
            outcome.certificate = outcome.certificate.max(found.certificate);
            if inside.is_none() {
                outcome.starts_inside = found.starts_inside;
            }
            outcome.ends_inside = found.ends_inside;
            outcome.hit = found.hit;
            next[job.place].1 = Some(found.starts_inside);
        });
        next.retain(|&(ray, _)| outcomes[ray].hit.is_none());
        *under_way = next;
    }
}

/// Lets the rays pass a slab whose sign is proved. One that comes with the other sign crossed the surface at its edge.
fn pass(
    rays: &[Ray],
    (a, b): (f64, f64),
    inside: bool,
    under_way: &mut Vec<(usize, Option<bool>)>,
    outcomes: &mut [Outcome],
) {
    under_way.retain_mut(|(ray, known)| {
        let (start, end) = (rays[*ray].start.max(a), rays[*ray].end.min(b));
        if !(start < end) {
            return true;
        }
        let outcome = &mut outcomes[*ray];
        match *known {
            None => outcome.starts_inside = inside,
            Some(before) if before != inside => {
                let hit = crate::Hit { t: start, before: start, after: start, entering: inside, jump: false };
                outcome.hit = Some(hit);
                outcome.ends_inside = false;
                outcome.certificate = outcome.certificate.max(Certificate::Tolerance);
                return false;
            }
            Some(_) => {}
        }
        *known = Some(inside);
        outcome.ends_inside = inside;
        true
    });
}

/// The box of all rays between two values of t; empty if none is there.
fn slab_box(rays: &[Ray], a: f64, b: f64) -> ([f64; 3], [f64; 3]) {
    let mut bounds = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for ray in rays {
        let (start, end) = (ray.start.max(a), ray.end.min(b));
        if !(start < end) {
            continue;
        }
        for t in [start, end] {
            let point = ray.at(t);
            for axis in 0..3 {
                bounds.0[axis] = bounds.0[axis].min(point[axis]);
                bounds.1[axis] = bounds.1[axis].max(point[axis]);
            }
        }
    }
    bounds
}
