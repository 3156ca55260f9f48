//! Rays on their way through the tree.
//!
//! Up to 64 rays walk together, from the near cells to the far ones: rays whose directions have the same signs cross cells
//! in one common order. Where a cell lies is asked for the bundle as a whole first, and for each ray only at cells that
//! are not outside.

use super::build::Builder;
use super::packet::{Common, Crossing, Face, ORDER, Packet, flip, lanes_of};
use super::pieces::MOST;
use super::settle::{Doubtful, End};
use super::solve::{Solve, Solver, Target};
use super::{Cell, LEVELS, Node, Octree, Place};
use fearless_simd::Level;
use fieldstone_field::{F64, LANES, Points, Tape, Workspace};
use fieldstone_trace::{Certificate, Hit, Outcome, Part, Ray, Settings, Tracer};
use typed_arena::Arena;

/// Rays that start further away than so many times the size begin anew where they start, so that numbers stay small.
const FAR: f64 = 64.0;

/// The rays of a packet that want an open cell at each level to be divided, times the instructions of its program, are
/// at least so many; fewer are marched through it. It does not matter whether it has been divided before, since what
/// rays find must not depend on others.
const WORTH_DIVIDING: [usize; LEVELS] = [0, 100, 200, 0];
/// Each ray costs as much as so many instructions besides.
const RAY_INSTRUCTIONS: usize = 16;
/// Programs of more instructions than this are dear to divide for, too: so many rays must want it.
const LONG: usize = 128;
const WORTH_DIVIDING_LONG: [usize; LEVELS] = [0, 6, 4, 0];

/// Whether a cell at a level is worth dividing for so many rays.
fn is_worth_dividing(level: usize, instructions: usize, rays: usize) -> bool {
    if instructions > LONG {
        return rays >= WORTH_DIVIDING_LONG[level];
    }
    rays * (instructions + RAY_INSTRUCTIONS) >= WORTH_DIVIDING[level]
}

/// What a thread needs to walk; keeps its memory between calls.
#[derive(Debug)]
pub struct Walker {
    builder: Builder,
    solver: Solver,
    tracer: Tracer,
    pub(super) points: Workspace<F64, Points>,
    pub(super) packet: Box<Packet>,
    pub(super) crossing: Box<Crossing>,
    /// What each piece of a cell says.
    pub(super) faces: Box<[Face; MOST]>,
    parts: Vec<Part>,
    pub(super) lanes: Vec<usize>,
    pub(super) ends: Vec<End>,
    pub(super) level: Level,
}

impl Default for Walker {
    fn default() -> Self {
        Self {
            builder: Builder::default(),
            solver: Solver::default(),
            tracer: Tracer::new(),
            points: Workspace::new(),
            packet: Box::new(Packet::new()),
            crossing: Box::new(Crossing::new()),
            faces: Box::new(std::array::from_fn(|_| Face::new())),
            parts: Vec::new(),
            lanes: Vec::new(),
            ends: Vec::new(),
            level: Level::new(),
        }
    }
}

/// What a call walks with.
pub(super) struct Walk<'w> {
    tree: &'w Octree,
    /// Nodes that the tree has no room for.
    arena: &'w Arena<Node>,
    pub(super) settings: &'w Settings,
    pub(super) outcomes: Vec<Outcome>,
    /// The gradients at hits, if they are wanted.
    pub(super) gradients: Option<&'w mut [[f64; 3]]>,
    /// Rays with a root in a bracket.
    pub(super) solves: Vec<Solve<'w>>,
    /// Rays whose hits have been found, but not their gradients.
    pub(super) hits: Vec<Target<'w>>,
    /// Rays that are to be marched through a cell before they walk on.
    pub(super) pending: Vec<Pending<'w>>,
    /// Rays of which the value where they leave a cell says whether they have a root in it.
    pub(super) doubtful: Vec<Doubtful<'w>>,
    /// Which rays the lanes of the packet are.
    pub(super) places: [usize; LANES],
    octant: usize,
}

/// A ray that sets out, or that walks on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub(super) place: usize,
    /// Where.
    pub(super) t: f64,
    /// Whether that is inside, if it is known.
    pub(super) inside: Option<bool>,
}

/// A part of a ray that is to be marched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pending<'w> {
    pub(super) target: Target<'w>,
    /// From where to where, and where the cell ends.
    pub(super) part: (f64, f64),
    pub(super) exit: f64,
    pub(super) inside: Option<bool>,
}

/// The rays of a packet that are on their way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flock {
    /// Those that have found nothing yet.
    pub(super) active: u64,
    /// Those of which it is known on which side of the surface they are. A ray of which it is not known has crossed but
    /// cells that are outside.
    pub(super) known: u64,
    /// Those that are inside.
    pub(super) inside: u64,
}

impl Walker {
    /// A walker.
    pub fn new() -> Self {
        Self::default()
    }

    /// Evaluations that built the tree or found gradients since the walker was made; all others are counted by the ray.
    pub fn shared_cost(&self) -> u64 {
        self.builder.evaluations + self.solver.evaluations
    }
}

impl Octree {
    /// The first crossing of every ray, by the affine method of `settings`.
    ///
    /// Rays must stay within the bounds of the tree. Those that run close together should stand close together.
    pub fn first_hits(&self, walker: &mut Walker, rays: &[Ray], settings: &Settings) -> Vec<Outcome> {
        self.walk_near(walker, rays, settings, None)
    }

    /// The same with the gradient at each hit, of the field or another one of its sign; NaN where nothing is hit.
    pub fn first_hits_with_gradients(
        &self,
        walker: &mut Walker,
        rays: &[Ray],
        settings: &Settings,
    ) -> (Vec<Outcome>, Vec<[f64; 3]>) {
        let mut gradients = vec![[f64::NAN; 3]; rays.len()];
        let outcomes = self.walk_near(walker, rays, settings, Some(&mut gradients));
        (outcomes, gradients)
    }

    /// Whether rays certainly meet nothing whose origins and directions, of any length, lie between the four given.
    pub fn is_clear(&self, walker: &mut Walker, hull: &[([f64; 3], [f64; 3]); 4]) -> bool {
        let size = self.slack * 1e9;
        let is_near = |x: &f64| x.abs() < 1e5 * size;
        let (common, octant) = Common::of_hull(hull);
        hull.iter().all(|(origin, _)| origin.iter().all(is_near))
            && walker.is_clear((self, &Arena::new()), &self.root, Place::ROOT, (&common, octant))
    }

    /// Walks with rays that begin not too far away.
    fn walk_near(
        &self,
        walker: &mut Walker,
        rays: &[Ray],
        settings: &Settings,
        gradients: Option<&mut [[f64; 3]]>,
    ) -> Vec<Outcome> {
        let far = FAR * settings.size;
        if rays.iter().all(|ray| ray.is_empty() || ray.start.abs() < far) {
            return self.walk(walker, rays, settings, gradients);
        }
        let near: Vec<Ray> = rays
            .iter()
            .map(|ray| Ray { origin: ray.at(ray.start), start: 0.0, end: ray.end - ray.start, ..*ray })
            .collect();
        let mut outcomes = self.walk(walker, &near, settings, gradients);
        for (ray, outcome) in rays.iter().zip(&mut outcomes) {
            if let Some(Hit { t, before, after, .. }) = &mut outcome.hit {
                [t, before, after].into_iter().for_each(|t| *t += ray.start);
            }
        }
        outcomes
    }

    fn walk(
        &self,
        walker: &mut Walker,
        rays: &[Ray],
        settings: &Settings,
        gradients: Option<&mut [[f64; 3]]>,
    ) -> Vec<Outcome> {
        let arena = Arena::new();
        let mut walk = Walk {
            tree: self,
            arena: &arena,
            settings,
            outcomes: vec![Outcome::nothing(); rays.len()],
            gradients,
            solves: Vec::with_capacity(rays.len()),
            hits: Vec::new(),
            pending: Vec::new(),
            doubtful: Vec::new(),
            places: [0; LANES],
            octant: 0,
        };
        let start = |(place, ray): (usize, &Ray)| Start { place, t: ray.start, inside: None };
        let mut starts: Vec<Start> =
            rays.iter().enumerate().filter(|(_, ray)| !ray.is_empty()).map(start).collect();
        while !starts.is_empty() {
            for starts in starts.chunks(LANES) {
                walker.walk_packet(&mut walk, rays, starts);
            }
            starts = walker.march_pending(&mut walk, rays);
            walker.settle_doubtful(&mut walk, rays, &mut starts);
            // Neighbours stay together, in whatever order they came.
            starts.sort_unstable_by_key(|start| start.place);
        }
        let Walk { mut outcomes, gradients, mut solves, hits, .. } = walk;
        let width = settings.tolerance * settings.size;
        walker.solver.run(&mut solves, rays, width, &mut outcomes);
        if let Some(gradients) = gradients {
            let targets = solves.iter().map(|solve| solve.target).chain(hits);
            walker.solver.run_gradients(targets, rays, width, &outcomes, gradients);
        }
        outcomes
    }
}

impl Walk<'_> {
    pub(super) fn outcome(&mut self, lane: usize) -> &mut Outcome {
        &mut self.outcomes[self.places[lane]]
    }
}

impl Walker {
    /// Walks with at most 64 rays until they have found something, want to be marched, or are through.
    fn walk_packet(&mut self, walk: &mut Walk<'_>, rays: &[Ray], starts: &[Start]) {
        let (mut known, mut inside) = (0, 0);
        for (lane, start) in starts.iter().enumerate() {
            walk.places[lane] = start.place;
            known |= u64::from(start.inside.is_some()) << lane;
            inside |= u64::from(start.inside == Some(true)) << lane;
        }
        let rays = starts.iter().map(|start| Ray { start: start.t, ..rays[start.place] });
        let set = self.packet.load(self.level, rays);
        for (octant, set) in self.packet.octants(set).into_iter().enumerate().filter(|(_, s)| *s != 0) {
            walk.octant = octant;
            let mut flock = Flock { active: set, known, inside };
            let common = self.packet.common(self.level, set);
            let tree = walk.tree;
            self.divide(walk, &tree.root, Place::ROOT, &common, &mut flock);
            for lane in lanes_of(flock.active) {
                walk.outcome(lane).ends_inside = flock.inside >> lane & 1 == 1;
            }
        }
    }

    /// Marches the rays that wait for it, those with one program together; those that go on behind their cells.
    fn march_pending(&mut self, walk: &mut Walk<'_>, rays: &[Ray]) -> Vec<Start> {
        let mut pending = std::mem::take(&mut walk.pending);
        pending.sort_by_key(|pending| pending.target.key());
        let mut starts = Vec::new();
        for same in pending.chunk_by(|a, b| a.target.key() == b.target.key()) {
            self.parts.clear();
            self.parts.extend(same.iter().map(|pending| Part {
                ray: Ray { start: pending.part.0, end: pending.part.1, ..rays[pending.target.place] },
                spent: walk.outcomes[pending.target.place].cost,
                inside: pending.inside,
            }));
            let Walk { outcomes, hits, settings, .. } = walk;
            self.tracer.march(same[0].target.program, &self.parts, settings, |i, found| {
                let Pending { target, exit, inside, .. } = same[i];
                let outcome = &mut outcomes[target.place];
                outcome.cost += found.cost;
                outcome.certificate = outcome.certificate.max(found.certificate);
                if inside.is_none() {
                    outcome.starts_inside = found.starts_inside;
                }
                outcome.hit = found.hit;
                outcome.ends_inside = found.ends_inside;
                if found.hit.is_some() {
                    hits.push(target);
                } else if !(settings.caps && outcome.starts_inside) && exit < rays[target.place].end {
                    starts.push(Start { place: target.place, t: exit, inside: Some(found.ends_inside) });
                }
            });
        }
        pending.clear();
        walk.pending = pending;
        starts
    }

    /// Walks through the cells of a cell that is divided.
    fn divide<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        cell: &'w Cell,
        place: Place,
        common: &Common,
        flock: &mut Flock,
    ) {
        let node = walk.tree.node(&mut self.builder, walk.arena, cell, place);
        self.cells(walk, (node, &cell.programs.value), place, common, flock);
    }

    /// Whether rays certainly meet nothing in a cell that is divided.
    fn is_clear<'w>(
        &mut self,
        (tree, arena): (&'w Octree, &'w Arena<Node>),
        cell: &'w Cell,
        place: Place,
        (common, octant): (&Common, usize),
    ) -> bool {
        let node = tree.node(&mut self.builder, arena, cell, place);
        let mut crossed = common.crossed(octant, &tree.faces(place));
        let flip = flip(octant);
        while crossed != 0 {
            let number = ORDER[crossed.trailing_zeros() as usize] ^ flip;
            crossed &= crossed - 1;
            if node.outside >> number & 1 == 1 {
                continue;
            }
            if node.inside >> number & 1 == 1 || node.cell(number).is_leaf {
                return false;
            }
            if !self.is_clear((tree, arena), node.cell(number), place.child(number), (common, octant)) {
                return false;
            }
        }
        true
    }

    /// Walks through the cells of a node, whose program is given.
    fn cells<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        (node, program): (&'w Node, &'w Tape),
        place: Place,
        common: &Common,
        flock: &mut Flock,
    ) {
        let tree = walk.tree;
        let faces = tree.faces(place);
        let mut crossed = common.crossed(walk.octant, &faces);
        let flip = flip(walk.octant);
        while crossed != 0 && flock.active != 0 {
            let number = ORDER[crossed.trailing_zeros() as usize] ^ flip;
            crossed &= crossed - 1;
            let bit = 1u64 << number;
            let is_outside = node.outside & bit != 0;
            if is_outside && flock.inside & flock.active == 0 {
                continue;
            }
            let index = |axis: usize| (number >> (2 * axis) & 3) as usize;
            let corner = |up: usize| [0, 1, 2].map(|axis| faces[axis][index(axis) + up]);
            let faces = (corner(0), corner(1));
            let set = self.packet.cross(self.level, flock.active, faces, &mut self.crossing);
            if set == 0 {
                continue;
            }
            if is_outside || node.inside & bit != 0 {
                self.pass(walk, program, (set, !is_outside), flock);
                continue;
            }
            let cell = node.cell(number);
            let set = match &cell.pieces {
                Some(pieces) => self.settle(walk, (cell, pieces), set, flock),
                None => set,
            };
            if set == 0 {
                continue;
            }
            let (length, count) = (cell.programs.value.len(), set.count_ones() as usize);
            if cell.is_leaf || !is_worth_dividing(place.level, length, count) {
                self.postpone(walk, (cell, program), set, flock);
            } else if 4 * set.count_ones() <= 3 * flock.active.count_ones() {
                let mut some = Flock { active: set, ..*flock };
                let common = self.packet.common(self.level, set);
                self.divide(walk, cell, place.child(number), &common, &mut some);
                flock.merge(set, some);
            } else {
                let mut some = Flock { active: set, ..*flock };
                self.divide(walk, cell, place.child(number), common, &mut some);
                flock.merge(set, some);
            }
        }
    }

    /// Lets rays pass the part of a cell, from where they enter it, in which the sign is proved.
    pub(super) fn pass<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        program: &'w Tape,
        (set, inside): (u64, bool),
        flock: &mut Flock,
    ) {
        for lane in lanes_of(set) {
            let bit = 1 << lane;
            let enter = self.crossing.enter[lane];
            self.meet_start(lane, enter, flock);
            if flock.known & bit == 0 {
                flock.start(lane, inside, walk);
            } else if (flock.inside & bit != 0) != inside {
                // The surface runs along the edge of the cell.
                let width = walk.settings.tolerance * walk.settings.size;
                let outcome = walk.outcome(lane);
                outcome.hit = Some(Hit {
                    t: enter,
                    before: enter - width,
                    after: enter,
                    entering: inside,
                    jump: false,
                    touching: false,
                });
                outcome.certificate = outcome.certificate.max(Certificate::Tolerance);
                walk.hits.push(Target { place: walk.places[lane], program });
                flock.active &= !bit;
            }
        }
    }

    /// A ray of which nothing is known, and which does not start in this cell, comes from outside.
    pub(super) fn meet_start(&self, lane: usize, enter: f64, flock: &mut Flock) {
        if flock.known >> lane & 1 == 0 && enter > self.packet.start[lane] {
            flock.known |= 1 << lane;
        }
    }
}

impl Flock {
    /// Takes note of the side on which a ray starts.
    pub(super) fn start(&mut self, lane: usize, inside: bool, walk: &mut Walk<'_>) {
        let bit = 1 << lane;
        self.known |= bit;
        self.inside |= if inside { bit } else { 0 };
        walk.outcome(lane).starts_inside = inside;
        if inside && walk.settings.caps {
            walk.outcome(lane).ends_inside = true;
            self.active &= !bit;
        }
    }

    /// Takes over what some of the rays went through.
    fn merge(&mut self, set: u64, some: Self) {
        self.active = (self.active & !set) | some.active;
        self.known = (self.known & !set) | (some.known & set);
        self.inside = (self.inside & !set) | (some.inside & set);
    }
}
