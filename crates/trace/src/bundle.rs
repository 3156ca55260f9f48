//! Bundles: rays that run close together share what intervals find out about the space that they cross.
//!
//! The stretch of a bundle is cut into slabs. The box of each slab is evaluated over intervals, all slabs at once: where
//! that excludes the surface, no ray of the bundle looks. Elsewhere the bundle is split into smaller ones and the slab is
//! cut again; what stays open is marched ray by ray. At each step the program is shortened to what can matter inside
//! the box.

use crate::march::{Job, Marcher};
use crate::ray::{Certificate, Hit, Method, Outcome, Ray, Settings};
use crate::sampled;
use fieldstone_field::{F64, Intervals, LANES, Points, Tape, Workspace};

/// Into how many slabs a bundle is cut, and each slab of a smaller bundle again.
const SLABS: [usize; 2] = [8, 1];
/// How many rays the smaller bundles have; callers that order their rays by blocks of 8 × 8 pixels gain most.
const SMALL_BUNDLE: usize = 64;
/// Programs of fewer instructions are not shortened a second time.
const WORTH_SHORTENING: usize = 24;

/// Finds first hits; keeps its memory between calls, so that a thread needs only one.
#[derive(Debug, Default)]
pub struct Tracer {
    marcher: Marcher,
    /// One for each level of [`SLABS`].
    boxes: [Workspace<F64, Intervals>; 2],
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

/// A ray on its way: its number, and whether it is inside as far as that is known.
type UnderWay = (usize, Option<bool>);

/// What stays the same while a bundle is traced.
struct Bundle<'b> {
    rays: &'b [Ray],
    settings: &'b Settings,
    outcomes: &'b mut [Outcome],
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
            let all = (0..rays.len()).map(|i| (i, None)).collect();
            self.descend(tape, &mut Bundle { rays, settings, outcomes: &mut outcomes }, all, extent, 0);
        }
        outcomes
    }

    /// Traces some rays of a bundle between two values of t; returns those that are still on their way behind.
    fn descend(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        mut under_way: Vec<UnderWay>,
        (from, to): (f64, f64),
        level: usize,
    ) -> Vec<UnderWay> {
        let count = SLABS[level];
        let cut = |i: usize| from + (to - from) * i as f64 / count as f64;
        let slabs = self.classify(tape, bundle.rays, &under_way, count, &cut, level);
        for (i, &slab) in slabs[..count].iter().enumerate() {
            let span = (cut(i), cut(i + 1));
            match slab {
                _ if under_way.is_empty() => break,
                Slab::Empty => {}
                Slab::Outside | Slab::Inside => bundle.pass(span, slab == Slab::Inside, &mut under_way),
                Slab::Open => {
                    let boxes = &self.boxes[level];
                    let shorter = (level == 0 || tape.len() >= WORTH_SHORTENING)
                        .then(|| tape.shortened(|place| boxes.choice(place, i)))
                        .flatten();
                    let tape = shorter.as_ref().unwrap_or(tape);
                    under_way = if level + 1 < SLABS.len() {
                        self.descend_in_parts(tape, bundle, &under_way, span, level + 1)
                    } else {
                        self.march(tape, bundle, &under_way, span)
                    };
                }
            }
        }
        under_way
    }

    fn descend_in_parts(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        under_way: &[UnderWay],
        span: (f64, f64),
        level: usize,
    ) -> Vec<UnderWay> {
        let parts = under_way.chunk_by(|a, b| a.0 / SMALL_BUNDLE == b.0 / SMALL_BUNDLE);
        parts.flat_map(|part| self.descend(tape, bundle, part.to_vec(), span, level)).collect()
    }

    /// What intervals say of the slabs, all at once.
    fn classify(
        &mut self,
        tape: &Tape,
        rays: &[Ray],
        under_way: &[UnderWay],
        count: usize,
        cut: &impl Fn(usize) -> f64,
        level: usize,
    ) -> [Slab; SLABS[0]] {
        const { assert!(SLABS[0] <= LANES && SLABS[1] <= SLABS[0]) };
        let boxes = &mut self.boxes[level];
        let mut empty = [true; SLABS[0]];
        for (i, empty) in empty[..count].iter_mut().enumerate() {
            let (lo, hi) = slab_box(rays, under_way, cut(i), cut(i + 1));
            *empty = !(lo[0] <= hi[0]);
            for axis in 0..3 {
                let (lo, hi) = if *empty { (0.0, 0.0) } else { (lo[axis], hi[axis]) };
                // Rounding of the rays' points is far below this.
                let slack = 1e-12 * (lo.abs() + hi.abs());
                boxes.input(axis, 0)[i] = lo - slack;
                boxes.input(axis, 1)[i] = hi + slack;
            }
        }
        boxes.run_traced(tape, count);
        self.shared_cost += count as u64;
        let (lo, hi) = (boxes.output(0, 0), boxes.output(0, 1));
        std::array::from_fn(|i| match (empty[i], lo[i] > 0.0, hi[i] < 0.0) {
            (true, ..) => Slab::Empty,
            (_, true, _) => Slab::Outside,
            (_, _, true) => Slab::Inside,
            _ => Slab::Open,
        })
    }

    fn march(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        under_way: &[UnderWay],
        (a, b): (f64, f64),
    ) -> Vec<UnderWay> {
        let Bundle { rays, settings, outcomes } = bundle;
        let jobs = under_way.iter().enumerate().map(|(place, &(ray, inside))| {
            let whole = rays[ray];
            Job { ray: Ray { start: whole.start.max(a), end: whole.end.min(b), ..whole }, place, inside }
        });
        let mut next = under_way.to_vec();
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
        next.retain(|&(ray, _)| !bundle.is_done(ray));
        next
    }
}

impl Bundle<'_> {
    fn is_done(&self, ray: usize) -> bool {
        let outcome = &self.outcomes[ray];
        outcome.hit.is_some() || (self.settings.caps && outcome.starts_inside)
    }

    /// Lets rays pass a slab whose sign is proved. One that comes with the other sign crossed the surface at its edge.
    fn pass(&mut self, (a, b): (f64, f64), inside: bool, under_way: &mut Vec<UnderWay>) {
        under_way.retain_mut(|(ray, known)| {
            let (start, end) = (self.rays[*ray].start.max(a), self.rays[*ray].end.min(b));
            if !(start < end) {
                return true;
            }
            let outcome = &mut self.outcomes[*ray];
            match *known {
                None => outcome.starts_inside = inside,
                Some(before) if before != inside => {
                    let (before, after) = (start, start);
                    outcome.hit = Some(Hit { t: start, before, after, entering: inside, jump: false });
                    outcome.ends_inside = false;
                    outcome.certificate = outcome.certificate.max(Certificate::Tolerance);
                    return false;
                }
                Some(_) => {}
            }
            *known = Some(inside);
            outcome.ends_inside = inside;
            !self.is_done(*ray)
        });
    }
}

/// The box of all rays between two values of t; empty if none is there.
fn slab_box(rays: &[Ray], under_way: &[UnderWay], a: f64, b: f64) -> ([f64; 3], [f64; 3]) {
    let mut bounds = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for ray in under_way.iter().map(|&(ray, _)| &rays[ray]) {
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
