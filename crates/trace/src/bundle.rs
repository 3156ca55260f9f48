//! Bundles: rays that run close together share what intervals find out about the space that they cross.
//!
//! The stretch of a bundle is cut into slabs. The box of each slab is evaluated over intervals, all slabs at once:
//! where that excludes the surface, no ray of the bundle looks. A slab that stays open is asked again for the smaller
//! bundles of which the bundle is made, and where it is open for these it is marched ray by ray. At each step the
//! program is shortened to what can matter inside the box.

use crate::march::{Job, Marcher};
use crate::ray::{Certificate, Hit, Method, Outcome, Ray, Settings};
use crate::sampled;
use fieldstone_field::{F64, Intervals, LANES, Points, Tape, Workspace};

/// Into how many slabs the stretch of a bundle is cut, and into how many each of these for the smaller bundles.
const SLABS: [usize; 2] = [8, 1];
/// How many rays the smaller bundles have; callers that order their rays by blocks of 8 × 8 pixels gain most.
const SMALL_BUNDLE: usize = 64;
/// Programs of fewer instructions are not shortened a second time, for the smaller bundles.
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

/// A part of a ray that is to be marched.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The ray, from where nothing is known to where nothing is asked.
    pub ray: Ray,
    /// How many evaluations the ray has cost so far.
    pub spent: u32,
    /// Whether the field is negative where the part starts, if that is known.
    pub inside: Option<bool>,
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

/// A stretch of the rays of a bundle, which is cut into slabs.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: f64,
    to: f64,
    /// Place in [`SLABS`].
    level: usize,
}

impl Stretch {
    fn slab_count(self) -> usize {
        SLABS[self.level]
    }

    /// The two values of t between which slab `i` lies.
    fn slab(self, i: usize) -> (f64, f64) {
        let cut = |i: usize| self.from + (self.to - self.from) * i as f64 / self.slab_count() as f64;
        (cut(i), cut(i + 1))
    }
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

    /// Marches parts of rays by themselves, with the affine method or the dichotomy of `settings`; `take` is told the
    /// outcome of each, by its place, as it is found.
    pub fn march(
        &mut self,
        tape: &Tape,
        parts: &[Part],
        settings: &Settings,
        mut take: impl FnMut(usize, Outcome),
    ) {
        let jobs = parts.iter().enumerate().map(|(place, &Part { ray, spent, inside })| Job {
            ray,
            place,
            spent,
            inside,
        });
        self.marcher.run(tape, settings, jobs, |job, outcome| take(job.place, outcome));
    }

    /// The first crossing of every ray.
    ///
    /// `tape` takes x, y, z and may have been compiled for [`Reading::Sign`](fieldstone_field::Reading::Sign). Rays
    /// that run close together, a tile of pixels, say, should come together.
    pub fn first_hits(&mut self, tape: &Tape, rays: &[Ray], settings: &Settings) -> Vec<Outcome> {
        let mut outcomes = vec![Outcome::nothing(); rays.len()];
        if let Method::Sampled { step } = settings.method {
            let jobs =
                rays.iter().enumerate().map(|(place, &ray)| Job { ray, place, spent: 0, inside: None });
            let finish = |job: &Job, outcome| outcomes[job.place] = outcome;
            sampled::run(&mut self.points, tape, (settings, step), jobs, finish);
            return outcomes;
        }
        let (from, to) = rays
            .iter()
            .filter(|r| !r.is_empty())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |e, r| (e.0.min(r.start), e.1.max(r.end)));
        if from < to {
            let all = (0..rays.len()).map(|i| (i, None)).collect();
            let mut bundle = Bundle { rays, settings, outcomes: &mut outcomes };
            self.descend(tape, &mut bundle, all, Stretch { from, to, level: 0 });
        }
        outcomes
    }

    /// Traces some rays of a bundle along a stretch; returns those that are still on their way behind it.
    fn descend(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        mut under_way: Vec<UnderWay>,
        stretch: Stretch,
    ) -> Vec<UnderWay> {
        let level = stretch.level;
        let slabs = self.classify(tape, bundle.rays, &under_way, stretch);
        for (i, &slab) in slabs[..stretch.slab_count()].iter().enumerate() {
            let span = stretch.slab(i);
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
                        let (from, to) = span;
                        let inner = Stretch { from, to, level: level + 1 };
                        self.descend_in_parts(tape, bundle, &under_way, inner)
                    } else {
                        self.march_bundle(tape, bundle, &under_way, span)
                    };
                }
            }
        }
        under_way
    }

    /// The same for the smaller bundles of which the bundle is made.
    fn descend_in_parts(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        under_way: &[UnderWay],
        stretch: Stretch,
    ) -> Vec<UnderWay> {
        let parts = under_way.chunk_by(|a, b| a.0 / SMALL_BUNDLE == b.0 / SMALL_BUNDLE);
        parts.flat_map(|part| self.descend(tape, bundle, part.to_vec(), stretch)).collect()
    }

    /// What intervals say of the slabs, all at once.
    fn classify(
        &mut self,
        tape: &Tape,
        rays: &[Ray],
        under_way: &[UnderWay],
        stretch: Stretch,
    ) -> [Slab; SLABS[0]] {
        const { assert!(SLABS[0] <= LANES && SLABS[1] <= SLABS[0]) };
        let (boxes, count) = (&mut self.boxes[stretch.level], stretch.slab_count());
        let mut empty = [true; SLABS[0]];
        for (i, empty) in empty[..count].iter_mut().enumerate() {
            let bounds = slab_box(rays, under_way, stretch.slab(i));
            *empty = bounds.is_none();
            let (lo, hi) = bounds.unwrap_or_default();
            for (axis, (lo, hi)) in lo.into_iter().zip(hi).enumerate() {
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

    /// Marches some rays of a bundle one by one; returns those that are still on their way behind.
    fn march_bundle(
        &mut self,
        tape: &Tape,
        bundle: &mut Bundle<'_>,
        under_way: &[UnderWay],
        (a, b): (f64, f64),
    ) -> Vec<UnderWay> {
        let Bundle { rays, settings, outcomes } = bundle;
        let spent: Vec<u32> = under_way.iter().map(|&(ray, _)| outcomes[ray].cost).collect();
        let jobs = under_way.iter().enumerate().map(|(place, &(ray, inside))| Job {
            ray: rays[ray].between(a, b),
            place,
            spent: spent[place],
            inside,
        });
        let mut next = under_way.to_vec();
        self.marcher.run(tape, settings, jobs, |job, found| {
            let (ray, inside) = under_way[job.place];
            let outcome = &mut outcomes[ray];
            outcome.cost += found.cost;
            if job.ray.is_empty() {
                return;
            }
            outcome.certificate = outcome.certificate.max(found.certificate);
            if inside.is_none() {
                outcome.starts_inside = found.starts_inside;
            }
            outcome.ends_inside = found.ends_inside;
            outcome.hit = found.hit;
            next[job.place].1 = Some(found.ends_inside);
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
            let part = self.rays[*ray].between(a, b);
            if part.is_empty() {
                return true;
            }
            let outcome = &mut self.outcomes[*ray];
            match *known {
                None => outcome.starts_inside = inside,
                Some(before) if before != inside => {
                    let t = part.start;
                    outcome.hit =
                        Some(Hit { t, before: t, after: t, entering: inside, jump: false, touching: false });
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

/// The box of all rays between two values of t; none if nobody is there.
fn slab_box(rays: &[Ray], under_way: &[UnderWay], (a, b): (f64, f64)) -> Option<([f64; 3], [f64; 3])> {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for ray in under_way.iter().map(|&(ray, _)| rays[ray].between(a, b)).filter(|r| !r.is_empty()) {
        for t in [ray.start, ray.end] {
            for (axis, x) in ray.at(t).into_iter().enumerate() {
                (lo[axis], hi[axis]) = (lo[axis].min(x), hi[axis].max(x));
            }
        }
    }
    (lo[0] <= hi[0]).then_some((lo, hi))
}
