//! The certified march: up to 64 rays at once, each at its own place, each taking the next ray as soon as it is done.
//!
//! Every ray keeps a front `t`: everything before it is proved free of surface. In each turn the spans of all rays are
//! evaluated together, over affine forms or intervals; then the points that some of them want. A span that cannot be
//! excluded is clipped by its slope and shortened; one that is short enough has the signs at its ends compared. Where
//! they differ, a bracketed solve finds a *candidate*, and the march goes on in what lies before it: only when that is
//! excluded too is the candidate the certified first hit, because a short bracket with a sign change may hide two more
//! roots. For surfaces without an inside, [`touch`] finds the places where the sign does not change.
//!
//! Sources: slope clipping from Gamito and Maddock 2007, the stackless dichotomy from Knoll et al. 2009 with whole
//! numbers in place of the floating-point modulus. Differences: outward rounding everywhere, candidates, certificates
//! for misses.

mod touch;

use crate::ray::{Certificate, Hit, Method, Outcome, Ray, Settings};
use crate::solver::Solver;
use fieldstone_field::{Affines, F64, Intervals, LANES, Points, Tape, Workspace};
pub(crate) use touch::rounding;
use touch::{Probe, Search, Searched};

/// A span at most this long, relative to the size, has the signs at its ends compared.
const ACCEPT: f64 = 1.0 / 256.0;
/// A span shorter than this, relative to the size, is passed over without proof: a tangent point, for example.
const FLOOR: f64 = 1.0 / (1u64 << 36) as f64;
/// The same of rays for which any hit will do, relative to the tolerance: as much as [`FLOOR`] is of the default.
const FLOOR_OF_TOLERANCE: f64 = 1.0 / 64.0;
/// The same where the field may be undefined, so that no inclusion can ever prove anything.
const UNDEFINED_FLOOR: f64 = 1.0 / 1024.0;
/// Loops that took so many turns, over a span where the field may be undefined, are treated like those that do not end.
const MANY_TURNS: f64 = 32.0;
/// The same where loops do not end.
const ENDLESS_FLOOR: f64 = 1.0 / 128.0;
/// After so many evaluations of one ray the floor rises by a factor of 4 every [`COARSER_EVERY`].
const FUEL: u32 = 1024;
const COARSER_EVERY: u32 = 64;
/// How much longer the next span may be after one that was excluded.
const GROWTH: f64 = 2.0;

/// A ray to be marched, and how its outcome may begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Job {
    /// The ray, from where nothing is known.
    pub(crate) ray: Ray,
    /// Where the outcome goes.
    pub(crate) place: usize,
    /// What the ray has cost so far.
    pub(crate) spent: u32,
    /// Whether the field is negative where the ray starts, if that is known.
    pub(crate) inside: Option<bool>,
}

/// What a field is over a span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    pub(crate) centre: f64,
    pub(crate) slope: f64,
    pub(crate) error: f64,
    /// Whether loops took many turns.
    endless: bool,
}

impl Span {
    fn excludes_zero(&self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }

    fn is_undefined(&self) -> bool {
        self.lo.is_nan()
    }

    /// Whether the field is 0 all along.
    fn is_zero(&self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    /// The part of \[a, b\] that zeros are confined to; empty if they are excluded.
    pub(crate) fn clip(&self, a: f64, b: f64) -> Option<(f64, f64)> {
        if self.excludes_zero() {
            return None;
        }
        // A range that is open to one side has its middle at infinity, and quotients of infinities exclude nothing.
        if !(self.centre.is_finite() && self.error.is_finite() && self.slope.is_finite()) {
            return Some((a, b));
        }
        let (p, q) = ((-self.centre - self.error) / self.slope, (-self.centre + self.error) / self.slope);
        let (p, q) = if p < q { (p, q) } else { (q, p) };
        // Comparisons with NaN are false: without a slope nothing is clipped.
        if p > 1.0 || q < -1.0 {
            return None;
        }
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        // A thousandth more on each side covers the rounding of the clip itself.
        let pad = 1e-3 * (q.min(1.0) - p.max(-1.0)).abs() + 1e-12;
        let from = if p > -1.0 { (middle + half * (p - pad)).max(a) } else { a };
        let to = if q < 1.0 { (middle + half * (q + pad)).min(b) } else { b };
        Some((from, to))
    }
}

/// How the next span is chosen.
#[derive(Clone, Copy, Debug)]
enum Walk {
    /// From the front on, as long as seems good.
    Front { length: f64 },
    /// Cell `index` of 2^`level` equal ones.
    Dyadic { level: u32, index: u64 },
}

/// What a ray wants next.
#[derive(Clone, Copy, Debug)]
enum Wish {
    /// The value where it starts.
    Start,
    /// The field over its next span.
    Span,
    /// The values at the ends of a short span that may hold a root.
    Ends { a: f64, b: f64 },
    /// A value for its solve.
    Solve(Solver),
    /// A value for its search of a touching point.
    Search(Search),
    /// The field over a single place.
    Probe(Probe),
    /// Nothing more.
    Done,
}

#[derive(Clone, Copy, Debug)]
struct Lane {
    job: Job,
    /// Everything before this is excluded, or was passed over.
    front: f64,
    /// Nothing behind this matters any more.
    end: f64,
    walk: Walk,
    wish: Wish,
    inside: bool,
    candidate: Option<Hit>,
    certificate: Certificate,
    /// What has been searched for touching points.
    searched: Searched,
    cost: u32,
    /// In how many spans loops did not end.
    endless: u32,
    /// Whether they did not in the last one.
    last_endless: bool,
}

/// Marches rays; keeps its memory between calls.
#[derive(Debug, Default)]
pub(crate) struct Marcher {
    affine: Workspace<F64, Affines>,
    interval: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
}

impl Marcher {
    /// Finds the first crossing of every job; `finish` takes each outcome with its job as it is found.
    pub(crate) fn run(
        &mut self,
        tape: &Tape,
        settings: &Settings,
        jobs: impl Iterator<Item = Job>,
        finish: impl FnMut(&Job, Outcome),
    ) {
        self.run_observed(tape, settings, jobs, finish, |_, _| {});
    }

    /// The same; `observe` is told of every span that a ray looks at, and what the field is there.
    pub(crate) fn run_observed(
        &mut self,
        tape: &Tape,
        settings: &Settings,
        jobs: impl Iterator<Item = Job>,
        mut finish: impl FnMut(&Job, Outcome),
        mut observe: impl FnMut((f64, f64), &Span),
    ) {
        let mut jobs = jobs.fuse();
        let mut lanes: Vec<Lane> = jobs.by_ref().take(LANES).map(|job| Lane::new(job, settings)).collect();
        let mut spans = Vec::with_capacity(LANES);
        let mut values = Vec::with_capacity(LANES);
        while !lanes.is_empty() {
            self.evaluate_spans(tape, settings, &lanes, &mut spans);
            for (lane, field) in lanes.iter_mut().filter(|l| l.wanted_span().is_some()).zip(&spans) {
                if let Some(span) = lane.wanted_span() {
                    observe(span, field);
                }
                lane.take_field(field, settings);
            }
            self.evaluate_points(tape, &lanes, &mut values);
            let mut given = values.iter().copied();
            lanes.iter_mut().for_each(|lane| lane.take_values(&mut given, settings));
            let mut i = 0;
            while i < lanes.len() {
                if matches!(lanes[i].wish, Wish::Done) {
                    finish(&lanes[i].job, lanes[i].outcome());
                    match jobs.next() {
                        Some(job) => lanes[i] = Lane::new(job, settings),
                        None => {
                            lanes.swap_remove(i);
                            continue;
                        }
                    }
                }
                i += 1;
            }
        }
    }

    /// The field over the span of every lane that wants one.
    fn evaluate_spans(&mut self, tape: &Tape, settings: &Settings, lanes: &[Lane], spans: &mut Vec<Span>) {
        spans.clear();
        let affine = matches!(settings.method, Method::Affine);
        let mut count = 0;
        for lane in lanes {
            if let Some(span) = lane.wanted_span() {
                self.fill_span(affine, &lane.job.ray, span, count);
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        if affine {
            self.affine.run(tape, count);
            let row = |component| self.affine.output(0, component);
            let (centre, slope, error, lo, hi) = (row(0), row(1), row(2), row(3), row(4));
            spans.extend((0..count).map(|i| Span {
                lo: lo[i],
                hi: hi[i],
                centre: centre[i],
                slope: slope[i],
                error: error[i],
                endless: self.affine.turns(i) >= MANY_TURNS,
            }));
        } else {
            self.interval.run(tape, count);
            let (lo, hi) = (self.interval.output(0, 0), self.interval.output(0, 1));
            let nothing = f64::NAN;
            spans.extend((0..count).map(|i| Span {
                lo: lo[i],
                hi: hi[i],
                centre: nothing,
                slope: nothing,
                error: nothing,
                endless: self.interval.turns(i) >= MANY_TURNS,
            }));
        }
    }

    /// Writes the coordinates along a span of a ray where the evaluation reads them.
    fn fill_span(&mut self, affine: bool, ray: &Ray, (a, b): (f64, f64), place: usize) {
        for axis in 0..3 {
            let form = coordinate(ray, axis, a, b);
            if affine {
                let parts = [form.centre, form.slope, form.error, form.lo, form.hi];
                for (component, part) in parts.into_iter().enumerate() {
                    self.affine.input(axis, component)[place] = part;
                }
            } else {
                self.interval.input(axis, 0)[place] = form.lo;
                self.interval.input(axis, 1)[place] = form.hi;
            }
        }
    }

    /// The values at all points that lanes want, in the order of the lanes.
    fn evaluate_points(&mut self, tape: &Tape, lanes: &[Lane], values: &mut Vec<f64>) {
        values.clear();
        let mut count = 0;
        for lane in lanes {
            let (list, n) = lane.wanted_points();
            for &t in &list[..n] {
                if count == LANES {
                    self.points.run(tape, count);
                    values.extend_from_slice(&self.points.output(0, 0)[..count]);
                    count = 0;
                }
                let point = lane.job.ray.at(t);
                for (axis, x) in point.into_iter().enumerate() {
                    self.points.input(axis, 0)[count] = x;
                }
                count += 1;
            }
        }
        if count > 0 {
            self.points.run(tape, count);
            values.extend_from_slice(&self.points.output(0, 0)[..count]);
        }
    }
}

/// One coordinate along a span, as centre ± slope ± error and as a range, rounding errors included.
fn coordinate(ray: &Ray, axis: usize, a: f64, b: f64) -> Span {
    let (o, d) = (ray.origin[axis], ray.direction[axis]);
    let (centre, slope) = (o + d * (0.5 * (a + b)), d * (0.5 * (b - a)));
    let error = 4.0 * f64::EPSILON * (o.abs() + d.abs() * a.abs().max(b.abs()));
    let reach = slope.abs() + error;
    Span { lo: centre - reach, hi: centre + reach, centre, slope, error, endless: false }
}

impl Lane {
    fn new(job: Job, settings: &Settings) -> Self {
        let Ray { start, end, .. } = job.ray;
        let walk = match settings.method {
            Method::Interval { .. } => Walk::Dyadic { level: 0, index: 0 },
            _ => Walk::Front { length: end - start },
        };
        let wish = match job.inside {
            _ if job.ray.is_empty() => Wish::Done,
            None => Wish::Start,
            Some(_) => Wish::Span,
        };
        Self {
            job,
            front: start,
            end,
            walk,
            wish,
            inside: job.inside.unwrap_or(false),
            candidate: None,
            certificate: Certificate::Certified,
            searched: Searched::NOTHING,
            cost: 0,
            endless: 0,
            last_endless: false,
        }
    }

    fn outcome(&self) -> Outcome {
        let starts_inside = self.inside;
        let touching = self.candidate.is_some_and(|hit| hit.touching);
        let least = if touching { Certificate::Tolerance } else { Certificate::Certified };
        Outcome {
            hit: self.candidate,
            certificate: self.certificate.max(least),
            cost: self.cost,
            starts_inside,
            ends_inside: starts_inside && self.candidate.is_none(),
        }
    }

    /// The next span, never behind `end`.
    fn span(&self) -> (f64, f64) {
        match self.walk {
            Walk::Front { length } => (self.front, (self.front + length).min(self.end)),
            Walk::Dyadic { level, index } => {
                let cell = (self.job.ray.end - self.job.ray.start) / (1u64 << level) as f64;
                let a = self.job.ray.start + cell * index as f64;
                (a.max(self.front), (a + cell).min(self.end))
            }
        }
    }

    /// Where the field is asked for next, over sets.
    fn wanted_span(&self) -> Option<(f64, f64)> {
        match self.wish {
            Wish::Span => Some(self.span()),
            Wish::Probe(ref probe) => Some(probe.wanted_span()),
            _ => None,
        }
    }

    fn doubt(&mut self, certificate: Certificate) {
        self.certificate = self.certificate.max(certificate);
    }

    /// Goes on behind `to`, which nothing more is expected before.
    fn advance(&mut self, to: f64, length: f64) {
        self.front = to;
        match &mut self.walk {
            Walk::Front { length: next } => *next = length,
            Walk::Dyadic { level, index } => {
                *index += 1;
                let up = index.trailing_zeros().min(*level);
                *index >>= up;
                *level -= up;
                if *level == 0 && *index == 1 {
                    self.front = self.end;
                }
            }
        }
        self.wish = if self.front < self.end { Wish::Span } else { Wish::Done };
    }

    /// Looks closer at \[a, b\], the part of the span from `start` to `stop` that zeros are confined to.
    fn refine(&mut self, (start, stop): (f64, f64), (a, b): (f64, f64)) {
        match &mut self.walk {
            Walk::Front { length } => {
                self.front = a;
                // Halve unless the clip did better.
                *length = if b - a < 0.5 * (stop - start) { b - a } else { 0.5 * (b - a) };
            }
            Walk::Dyadic { level, index } => {
                *level += 1;
                *index <<= 1;
                // The end may have moved before the second half, or the first may lie before the front.
            }
        }
        self.wish = if self.front < self.end { Wish::Span } else { Wish::Done };
    }

    /// The shortest span that is still looked at: it grows with what the ray has cost.
    fn floor(&self, settings: &Settings) -> f64 {
        let base = match settings.method {
            // Shadows may be coarser than what is seen.
            Method::Affine if settings.any_hit => FLOOR.max(settings.tolerance * FLOOR_OF_TOLERANCE),
            Method::Affine => FLOOR,
            _ => FLOOR.max(settings.tolerance / 16.0),
        };
        let cost = self.cost.saturating_add(self.job.spent);
        let coarser = 4f64.powi((cost.saturating_sub(FUEL) / COARSER_EVERY).min(64) as i32);
        // Far from its origin a ray cannot tell places closer than this from each other.
        (base * coarser * settings.size).max(8.0 * f64::EPSILON * self.front.abs())
    }

    fn take_field(&mut self, field: &Span, settings: &Settings) {
        match self.wish {
            Wish::Probe(probe) => self.take_probe(probe, field, settings),
            _ => self.take_span(field, settings),
        }
    }

    /// The shortest span that is still looked at where the field may be undefined, relative to the size. Loops that do
    /// not end cost all the turns that they may take: there it is long, and doubles with every fourth such span.
    fn undefined_floor(&self, endless: bool) -> f64 {
        if endless { ENDLESS_FLOOR * 2f64.powi((self.endless / 4).min(8) as i32) } else { UNDEFINED_FLOOR }
    }

    fn take_span(&mut self, span: &Span, settings: &Settings) {
        self.cost += 1;
        self.last_endless = span.endless && span.is_undefined();
        self.endless += u32::from(self.last_endless);
        let (start, stop) = self.span();
        if stop <= start {
            return self.advance(stop.max(self.front), settings.size);
        }
        if span.is_zero() && settings.surface {
            return self.touch(start, start);
        }
        if span.is_zero() && !self.inside {
            self.doubt(Certificate::Undecided);
            return self.advance(stop, GROWTH * (stop - start));
        }
        let Some((a, b)) = span.clip(start, stop) else {
            return self.advance(stop, GROWTH * (stop - start));
        };
        let width = b - a;
        if let Method::Interval { accept_epsilon: Some(epsilon) } = settings.method {
            if width <= epsilon.max(self.floor(settings)) {
                self.accept(a, b);
            } else {
                self.refine((start, stop), (a, b));
            }
            return;
        }
        let undefined = span.is_undefined();
        let shortest = if undefined { self.undefined_floor(span.endless) } else { ACCEPT } * settings.size;
        if width <= shortest {
            self.wish = Wish::Ends { a, b };
        } else {
            self.refine((start, stop), (a, b));
        }
    }

    /// Takes a span for a hit as it is.
    fn accept(&mut self, a: f64, b: f64) {
        let t = 0.5 * (a + b);
        let entering = !self.inside;
        self.candidate = Some(Hit { t, before: a, after: b, entering, jump: false, touching: false });
        self.doubt(Certificate::Tolerance);
        self.wish = Wish::Done;
    }

    fn wanted_points(&self) -> ([f64; 2], usize) {
        match self.wish {
            Wish::Start => ([self.job.ray.start, 0.0], 1),
            Wish::Ends { a, b } => ([a, b], 2),
            Wish::Solve(ref solver) => solver.wants().map_or(([0.0; 2], 0), |t| ([t, 0.0], 1)),
            Wish::Search(ref search) => search.wants().map_or(([0.0; 2], 0), |t| ([t, 0.0], 1)),
            Wish::Span | Wish::Probe(_) | Wish::Done => ([0.0; 2], 0),
        }
    }

    /// An undefined value counts as outside.
    fn defined(&mut self, value: f64) -> f64 {
        if value.is_nan() {
            self.doubt(Certificate::Undecided);
            return f64::MAX;
        }
        value
    }

    fn take_values(&mut self, values: &mut impl Iterator<Item = f64>, settings: &Settings) {
        let n = self.wanted_points().1;
        self.cost += n as u32;
        let mut next = || values.next().unwrap_or(f64::NAN);
        match self.wish {
            Wish::Start => {
                let value = next();
                self.inside = self.defined(value) < 0.0;
                self.wish = if self.inside && settings.caps { Wish::Done } else { Wish::Span };
            }
            Wish::Ends { a, b } => {
                let (fa, fb) = (next(), next());
                self.compare_ends((a, fa), (b, fb), settings);
            }
            Wish::Solve(mut solver) => {
                let value = next();
                solver.supply(self.defined(value));
                self.continue_solve(solver, settings);
            }
            Wish::Search(search) => self.take_minimum(search, next(), settings),
            Wish::Span | Wish::Probe(_) | Wish::Done => {}
        }
    }

    /// Whether a value lies on the other side of the surface than the front. 0 itself counts as outside of a solid; a
    /// surface has it on neither side.
    fn is_across(&self, value: f64, settings: &Settings) -> bool {
        (value < 0.0) != self.inside && !(settings.surface && value == 0.0)
    }

    fn compare_ends(&mut self, near: (f64, f64), far: (f64, f64), settings: &Settings) {
        // Finer spans would cost as many turns each, and tell as little.
        let undefined = near.1.is_nan() || far.1.is_nan() || self.last_endless;
        let (fa, fb) = (self.defined(near.1), self.defined(far.1));
        let (start, stop) = self.span();
        if self.is_across(fb, settings) && !self.is_across(fa, settings) {
            if settings.any_hit {
                return self.accept(near.0, far.0);
            }
            let solver = Solver::new((near.0, fa), (far.0, fb), settings.tolerance * settings.size);
            return self.continue_solve(solver, settings);
        }
        if self.is_across(fa, settings) {
            // The front itself lies on the surface, as far as values can tell.
            self.settle([(near.0, fa), (near.0, fa)], settings);
            return;
        }
        if fa == 0.0 && fb == 0.0 && !settings.surface {
            // All of it may well be 0, and no shorter span will tell.
            self.doubt(Certificate::Undecided);
            return self.pass(far.0, GROWTH * (stop - start));
        }
        if settings.surface && !undefined {
            return self.look_for_touch((near.0, fa), (far.0, fb), settings);
        }
        // A clipped part is looked at once more: it may well be excluded as a span of its own.
        if undefined {
            self.doubt(Certificate::Undecided);
            self.pass(far.0, far.0 - near.0);
        } else if stop - start <= self.floor(settings) {
            self.pass_over((near.0, far.0), settings);
        } else {
            self.refine((start, stop), (near.0, far.0));
        }
    }

    /// Goes on behind the part \[a, b\] of the shortest span, which could not be excluded.
    fn pass_over(&mut self, (a, b): (f64, f64), settings: &Settings) {
        let fuel_spent = self.cost.saturating_add(self.job.spent) > FUEL;
        self.doubt(if fuel_spent { Certificate::Undecided } else { Certificate::Tolerance });
        self.pass(b, (4.0 * (b - a)).max(self.floor(settings)));
    }

    /// Goes on behind `end`, where a part ends that could not be excluded, with a span of this length.
    fn pass(&mut self, end: f64, length: f64) {
        // A clipped span ends before its cell does.
        let to = if matches!(self.walk, Walk::Dyadic { .. }) { self.span().1 } else { end };
        self.advance(to.max(self.front + 4.0 * f64::EPSILON * self.front.abs()), length);
    }

    fn continue_solve(&mut self, solver: Solver, settings: &Settings) {
        match solver.wants() {
            Some(_) => self.wish = Wish::Solve(solver),
            None => self.settle(solver.bracket(), settings),
        }
    }

    /// Makes the end of a solve the candidate, and looks at what lies before it.
    fn settle(&mut self, [near, far]: [(f64, f64); 2], settings: &Settings) {
        let fraction = near.1 / (near.1 - far.1);
        let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.5 };
        let t = near.0 + fraction * (far.0 - near.0);
        // One bracket's width before the root, where the field is far enough from 0 to be told from it.
        let width = settings.tolerance * settings.size;
        let before = near.0.min(t - width);
        // Continuous fields are nearly 0 at both ends of so short a bracket.
        let jump = near.1.abs().min(far.1.abs()) > 1e-3 && far.0 - near.0 <= width;
        let entering = !self.inside;
        self.make_candidate(Hit { t, before, after: far.0, entering, jump, touching: false });
    }

    /// Takes a hit for the first, and looks at what lies before it.
    fn make_candidate(&mut self, hit: Hit) {
        self.candidate = Some(hit);
        self.end = hit.before;
        if let Walk::Front { length } = &mut self.walk {
            *length = self.end - self.front;
        }
        self.wish = if self.front < self.end { Wish::Span } else { Wish::Done };
    }
}
