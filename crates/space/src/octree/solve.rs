//! Roots of monotone stretches, 64 at a time.
//!
//! The slopes along a stretch are bounded by its facet, so that each value confines the root to where these slopes lead
//! from there (interval Newton with one enclosure of the slope for all steps: Moore 1966). The secant chooses the places.

use super::packet::{CHUNK, Lanes, wide};
use fearless_simd::Level;
use fieldstone_field::{F64, Gradients, LANES, Points, Tape, Workspace};
use fieldstone_trace::{Hit, Outcome, Ray};

/// After so many values of one solve its bracket is halved every other time.
const PATIENCE: f64 = 6.0;
/// After so many it ends: the bracket is as short as numbers can make it.
const MOST: f64 = 96.0;

/// A ray that hits, and the program that is right there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target<'t> {
    /// Which ray.
    pub(super) place: usize,
    pub(super) program: &'t Tape,
}

impl Target<'_> {
    /// Targets of one program have the same.
    pub(super) fn key(&self) -> usize {
        std::ptr::from_ref(self.program) as usize
    }
}

/// A stretch of a ray in which there is exactly one root, and the slopes of the field there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solve<'t> {
    pub(super) target: Target<'t>,
    /// The root is here.
    pub(super) bracket: (f64, f64),
    /// Slopes along the ray: `slope` ± `spread`, without 0.
    pub(super) slope: f64,
    pub(super) spread: f64,
    pub(super) guess: f64,
}

/// Solves; keeps its memory between calls.
#[derive(Debug)]
pub(super) struct Solver {
    points: Workspace<F64, Points>,
    gradients: Workspace<F64, Gradients>,
    block: Box<Block>,
    level: Level,
    /// Evaluations of gradients so far.
    pub(super) evaluations: u64,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            points: Workspace::new(),
            gradients: Workspace::new(),
            block: Box::new(Block::new()),
            level: Level::new(),
            evaluations: 0,
        }
    }
}

/// Solves under way, side by side.
#[derive(Debug)]
struct Block {
    places: [usize; LANES],
    origin: [Lanes; 3],
    direction: [Lanes; 3],
    /// The root lies between these.
    near: Lanes,
    far: Lanes,
    /// 1 where the field rises along the ray, −1 where it falls; bounds of how much.
    sign: Lanes,
    least: Lanes,
    most: Lanes,
    /// Where the next value is wanted, and the last one with its place.
    trial: Lanes,
    place: Lanes,
    value: Lanes,
    turns: Lanes,
}

impl Solver {
    /// Finds all roots, each in a bracket at most `width` wide, and writes them to the outcomes.
    pub(super) fn run(
        &mut self,
        solves: &mut [Solve<'_>],
        rays: &[Ray],
        width: f64,
        outcomes: &mut [Outcome],
    ) {
        // Solves of one program share their evaluations; each result depends on its own lane alone.
        if !solves.is_sorted_by_key(|solve| solve.target.key()) {
            solves.sort_unstable_by_key(|solve| (solve.target.key(), solve.target.place));
        }
        for same in solves.chunk_by(|a, b| a.target.key() == b.target.key()) {
            for some in same.chunks(LANES) {
                self.run_block(some, rays, width, outcomes);
            }
        }
    }

    fn run_block(&mut self, solves: &[Solve<'_>], rays: &[Ray], width: f64, outcomes: &mut [Outcome]) {
        let Self { points, block, .. } = self;
        for (lane, solve) in solves.iter().enumerate() {
            block.load(lane, solve, &rays[solve.target.place]);
        }
        let mut count = solves.len();
        while count > 0 {
            for axis in 0..3 {
                let row = points.input(axis, 0);
                for lane in 0..count {
                    row[lane] = block.origin[axis][lane] + block.direction[axis][lane] * block.trial[lane];
                }
            }
            points.run(solves[0].target.program, count);
            block.take(self.level, points.output(0, 0), width, count);
            let mut lane = 0;
            while lane < count {
                if block.is_done(lane, width) {
                    block.finish(lane, width, &mut outcomes[block.places[lane]]);
                    count -= 1;
                    block.copy(count, lane);
                } else {
                    lane += 1;
                }
            }
        }
    }

    /// Finds the gradients at hits: where they touch, `hair` before them.
    pub(super) fn run_gradients<'t>(
        &mut self,
        targets: impl Iterator<Item = Target<'t>>,
        rays: &[Ray],
        hair: f64,
        outcomes: &[Outcome],
        found: &mut [[f64; 3]],
    ) {
        let mut targets: Vec<Target<'_>> = targets.collect();
        if !targets.is_sorted_by_key(Target::key) {
            targets.sort_unstable_by_key(|target| (target.key(), target.place));
        }
        for same in targets.chunk_by(|a, b| a.key() == b.key()) {
            for block in same.chunks(LANES) {
                for (lane, target) in block.iter().enumerate() {
                    let Some(hit) = outcomes[target.place].hit else { continue };
                    let point = rays[target.place].at(if hit.touching { hit.t - hair } else { hit.t });
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
                self.gradients.run(same[0].program, block.len());
                self.evaluations += block.len() as u64;
                for (lane, target) in block.iter().enumerate() {
                    found[target.place] = [1, 2, 3].map(|c| self.gradients.output(0, c)[lane]);
                }
            }
        }
    }
}

impl Block {
    fn new() -> Self {
        let zero = [0.0; LANES];
        Self {
            places: [0; LANES],
            origin: [zero; 3],
            direction: [zero; 3],
            near: zero,
            far: zero,
            sign: zero,
            least: zero,
            most: zero,
            trial: zero,
            place: zero,
            value: zero,
            turns: zero,
        }
    }

    fn load(&mut self, lane: usize, solve: &Solve<'_>, ray: &Ray) {
        self.places[lane] = solve.target.place;
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        let (near, far) = solve.bracket;
        (self.near[lane], self.far[lane]) = (near, far);
        self.sign[lane] = solve.slope.signum();
        self.least[lane] = solve.slope.abs() - solve.spread;
        self.most[lane] = solve.slope.abs() + solve.spread;
        self.trial[lane] =
            if solve.guess > near && solve.guess < far { solve.guess } else { 0.5 * (near + far) };
        // No slope can be told from this.
        self.place[lane] = f64::NAN;
        self.turns[lane] = 0.0;
    }

    fn copy(&mut self, from: usize, to: usize) {
        self.places[to] = self.places[from];
        let Self { origin: [ox, oy, oz], direction: [dx, dy, dz], near, far, sign, .. } = self;
        [ox, oy, oz, dx, dy, dz, near, far, sign].into_iter().for_each(|row| row[to] = row[from]);
        let Self { least, most, trial, place, value, turns, .. } = self;
        [least, most, trial, place, value, turns].into_iter().for_each(|row| row[to] = row[from]);
    }

    /// Takes the values at the trials, and chooses where to look next.
    fn take(&mut self, level: Level, values: &[f64], width: f64, count: usize) {
        wide(
            level,
            #[inline(always)]
            || {
                for chunk in 0..count.div_ceil(CHUNK) {
                    self.take_chunk(chunk, values, width);
                }
            },
        );
    }

    #[inline(always)]
    fn take_chunk(&mut self, chunk: usize, values: &[f64], width: f64) {
        let lanes = CHUNK * chunk..CHUNK * (chunk + 1);
        let hair = 0.5 * width;
        for i in lanes {
            self.turns[i] += 1.0;
            let (t, value) = (self.trial[i], values[i] * self.sign[i]);
            // The root lies where slopes between the bounds lead from here; comparisons with NaN are false.
            let (a, b) = (t - value / self.least[i], t - value / self.most[i]);
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            let near = if low > self.near[i] { low } else { self.near[i] };
            let far = if high < self.far[i] { high } else { self.far[i] };
            let secant = (value - self.value[i]) / (t - self.place[i]);
            let is_slope = secant >= self.least[i] && secant <= self.most[i];
            let slope = if is_slope { secant } else { 0.5 * (self.least[i] + self.most[i]) };
            let (step, middle) = (t - value / slope, 0.5 * (near + far));
            let halve = self.turns[i] > PATIENCE && self.turns[i] % 2.0 == 0.0;
            let next = if step > near && step < far && !halve { step } else { middle };
            // Not closer to an end than a bracket is wide, so that it shrinks from both sides.
            let (first, last) = (near + hair, far - hair);
            let next = if next < first { first } else { next };
            let next = if next > last { last } else { next };
            (self.near[i], self.far[i], self.place[i], self.value[i]) = (near, far, t, value);
            self.trial[i] = if far - near > 4.0 * hair { next } else { step };
        }
    }

    fn is_done(&self, lane: usize, width: f64) -> bool {
        // Also where rounding made the bounds cross.
        !(self.far[lane] - self.near[lane] > width) || self.turns[lane] >= MOST
    }

    fn finish(&self, lane: usize, width: f64, outcome: &mut Outcome) {
        let (a, b) = (self.near[lane], self.far[lane]);
        let (near, far) = if a <= b { (a, b) } else { (b, a) };
        let t = self.trial[lane];
        let t = if t.is_nan() { 0.5 * (near + far) } else { t.clamp(near, far) };
        outcome.cost += self.turns[lane] as u32;
        outcome.hit = Some(Hit {
            t,
            before: near.min(t - width),
            after: far,
            entering: self.sign[lane] < 0.0,
            jump: false,
            touching: false,
        });
    }
}
