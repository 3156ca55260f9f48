//! Roots of monotone stretches, 64 at a time.

use fieldstone_field::{F64, Gradients, LANES, Points, Tape, Workspace};
use fieldstone_trace::{Certificate, Hit, Outcome, Ray};
use std::sync::Arc;

/// After so many values of one solve its bracket is halved.
const PATIENCE: u32 = 6;
/// After so many it ends: the bracket is as short as numbers can make it.
const MOST: u32 = 96;

/// A ray that hits, and the program that is right there.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub(super) ray: Ray,
    /// Where the outcome goes.
    pub(super) place: usize,
    pub(super) program: Arc<Tape>,
}

/// A stretch of a ray in which there is exactly one root, and the slopes of the field there.
#[derive(Clone, Debug)]
pub(super) struct Solve {
    pub(super) target: Target,
    /// The root is here.
    pub(super) bracket: (f64, f64),
    /// Slopes along the ray: `slope` ± `spread`, without 0.
    pub(super) slope: f64,
    pub(super) spread: f64,
    pub(super) guess: f64,
}

/// A solve under way.
#[derive(Clone, Copy, Debug)]
struct Lane {
    place: usize,
    origin: [f64; 3],
    direction: [f64; 3],
    near: f64,
    far: f64,
    /// Bounds of the slope after `sign` made it positive.
    least: f64,
    most: f64,
    sign: f64,
    trial: f64,
    last: Option<(f64, f64)>,
    turns: u32,
}

/// Solves; keeps its memory between calls.
#[derive(Debug, Default)]
pub(super) struct Solver {
    points: Workspace<F64, Points>,
    gradients: Workspace<F64, Gradients>,
    lanes: Vec<Lane>,
    /// Evaluations of gradients so far.
    pub(super) evaluations: u64,
}

impl Solver {
    /// Finds all roots, each in a bracket at most `width` wide, and writes them to the outcomes.
    pub(super) fn run(&mut self, solves: &mut [Solve], width: f64, outcomes: &mut [Outcome]) {
        // Solves of one program share their evaluations; each result depends on its own lane alone.
        solves.sort_by_key(|solve| Arc::as_ptr(&solve.target.program) as usize);
        for same in solves.chunk_by(|a, b| Arc::ptr_eq(&a.target.program, &b.target.program)) {
            self.lanes.clear();
            self.lanes.extend(same.iter().map(Lane::new));
            self.run_lanes(&same[0].target.program, width, outcomes);
        }
    }

    /// Finds the gradients at hits: where they touch, `hair` before them.
    pub(super) fn run_gradients<'t>(
        &mut self,
        targets: impl Iterator<Item = &'t Target>,
        hair: f64,
        outcomes: &[Outcome],
        found: &mut [[f64; 3]],
    ) {
        let mut targets: Vec<&Target> = targets.collect();
        targets.sort_by_key(|target| Arc::as_ptr(&target.program) as usize);
        for same in targets.chunk_by(|a, b| Arc::ptr_eq(&a.program, &b.program)) {
            for block in same.chunks(LANES) {
                for (lane, target) in block.iter().enumerate() {
                    let Some(hit) = outcomes[target.place].hit else { continue };
                    let point = target.ray.at(if hit.touching { hit.t - hair } else { hit.t });
                    for axis in 0..3 {
                        self.gradients.input(axis, 0)[lane] = point[axis];
                    }
                }
                for axis in 0..3 {
                    for along in 0..3 {
                        let slope = if along == axis { 1.0 } else { 0.0 };
                        self.gradients.input(axis, 1 + along)[..block.len()].fill(slope);
                    }
                }
                self.gradients.run(&same[0].program, block.len());
                self.evaluations += block.len() as u64;
                for (lane, target) in block.iter().enumerate() {
                    found[target.place] = [1, 2, 3].map(|c| self.gradients.output(0, c)[lane]);
                }
            }
        }
    }

    fn run_lanes(&mut self, program: &Tape, width: f64, outcomes: &mut [Outcome]) {
        let Self { points, lanes, .. } = self;
        while !lanes.is_empty() {
            for block in lanes.chunks_mut(LANES) {
                for axis in 0..3 {
                    let row = points.input(axis, 0);
                    for (x, lane) in row.iter_mut().zip(&*block) {
                        *x = lane.origin[axis] + lane.direction[axis] * lane.trial;
                    }
                }
                points.run(program, block.len());
                for (lane, &value) in block.iter_mut().zip(points.output(0, 0)) {
                    lane.take(value);
                }
            }
            lanes.retain_mut(|lane| {
                let is_done = lane.is_done(width);
                if is_done {
                    lane.finish(width, &mut outcomes[lane.place]);
                } else {
                    lane.choose(width);
                }
                !is_done
            });
        }
    }
}

impl Lane {
    fn new(solve: &Solve) -> Self {
        let (near, far) = solve.bracket;
        Self {
            place: solve.target.place,
            origin: solve.target.ray.origin,
            direction: solve.target.ray.direction,
            near,
            far,
            least: solve.slope.abs() - solve.spread,
            most: solve.slope.abs() + solve.spread,
            sign: solve.slope.signum(),
            trial: solve.guess.clamp(near, far),
            last: None,
            turns: 0,
        }
    }

    /// Takes the value at the trial: the root lies where slopes between the bounds lead from there.
    fn take(&mut self, value: f64) {
        self.turns += 1;
        let value = value * self.sign;
        let (t, slow, fast) = (self.trial, value / self.least, value / self.most);
        if value > 0.0 {
            self.far = self.far.min(t - fast);
            self.near = self.near.max(t - slow);
        } else if value < 0.0 {
            self.near = self.near.max(t - fast);
            self.far = self.far.min(t - slow);
        } else if value == 0.0 {
            (self.near, self.far) = (t, t);
        }
        let slope = self.last.map_or(0.5 * (self.least + self.most), |(t0, v0)| {
            ((value - v0) / (t - t0)).clamp(self.least, self.most)
        });
        self.last = Some((t, value));
        self.trial = t - value / slope;
    }

    fn is_done(&self, width: f64) -> bool {
        // Also where rounding made the bounds cross.
        !(self.far - self.near > width) || self.turns >= MOST
    }

    /// Where to look next.
    fn choose(&mut self, width: f64) {
        let middle = 0.5 * (self.near + self.far);
        let inside = self.trial > self.near && self.trial < self.far;
        if !inside || (self.turns > PATIENCE && self.turns % 2 == 0) {
            self.trial = middle;
        }
        // Not closer to an end than a bracket is wide, so that it shrinks from both sides.
        let hair = 0.5 * width;
        if self.far - self.near > 4.0 * hair {
            self.trial = self.trial.clamp(self.near + hair, self.far - hair);
        }
    }

    fn finish(&self, width: f64, outcome: &mut Outcome) {
        let (near, far) = if self.near <= self.far { (self.near, self.far) } else { (self.far, self.near) };
        let t = if self.trial.is_nan() { 0.5 * (near + far) } else { self.trial.clamp(near, far) };
        outcome.cost += self.turns;
        outcome.hit = Some(Hit {
            t,
            before: near.min(t - width),
            after: far,
            entering: self.sign < 0.0,
            jump: false,
            touching: false,
        });
        outcome.certificate = outcome.certificate.max(Certificate::Certified);
    }
}
