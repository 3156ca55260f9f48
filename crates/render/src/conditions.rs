//! Level-set conditions: surfaces that are there only where other fields have a given sign (Hijazi et al. 2008, §4.4).
//!
//! The conditions of a solid are one field, negative where all of them hold. A ray is traced in turns: to the first place
//! where the conditions hold, from there to the first root of the solid, and if they do not hold there, on to the next
//! place where they do. Both are certified first hits, so that nothing between is missed. Whether conditions hold at a
//! root is decided over its final bracket; where that leaves it open, by the value at the root, without a certificate.

use crate::query::Asker;
use crate::roots::Roots;
use fieldstone_field::{F64, Field, Intervals, LANES, Points, Workspace};
use fieldstone_scene::Solid;
use fieldstone_trace::{Certificate, Hit, Method, Outcome, Ray, Settings};
use glam::DVec3;

/// A ray meets at most so many roots at which conditions do not hold before it is given up, undecided.
const MOST_TURNS: u32 = 4096;

/// The conditions of a solid.
pub(crate) struct Conditions {
    /// Negative where all hold.
    field: Roots,
    /// Whether to ask them before the solid: they cost less.
    first: bool,
}

/// What a thread needs to ask conditions at roots.
#[derive(Default)]
pub(crate) struct Memory {
    boxes: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
}

/// What a ray looks for next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    /// A place where the conditions hold.
    Conditions,
    /// A root of the solid.
    Root,
    Done,
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
struct Lane {
    /// What is left of it.
    ray: Ray,
    stage: Stage,
    outcome: Outcome,
    turns: u32,
}

impl Conditions {
    /// Those of a solid whose own program has so many instructions.
    pub(crate) fn new(solid: &Solid, instructions: usize) -> Self {
        let field = solid.field();
        let mut graph = (**field.graph()).clone();
        let mut all = None;
        for condition in solid.conditions() {
            let value = field.attributes()[condition.attribute];
            let holds = if condition.positive { graph.neg(value) } else { value };
            all = Some(all.map_or(holds, |all| graph.max(all, holds)));
        }
        let all = all.unwrap_or_else(|| graph.constant(-1.0));
        let field = Field::new(graph, all, Vec::new()).with_fuel(field.fuel());
        let field = Roots::new(&field, solid.bindings(), solid.bounds());
        let first = field.sign.len() < instructions;
        Self { field, first }
    }

    /// The first crossing of every ray where the conditions hold.
    pub(crate) fn first_hits(
        &self,
        asker: &mut Asker,
        solid: &Roots,
        rays: &[Ray],
        settings: &Settings,
    ) -> Vec<Outcome> {
        let stage = if self.first { Stage::Conditions } else { Stage::Root };
        let mut lanes: Vec<Lane> = rays.iter().map(|&ray| Lane::new(ray, stage)).collect();
        let of_solid = Settings { any_hit: false, caps: false, ..*settings };
        let method = match settings.method {
            Method::Sampled { .. } => settings.method,
            // Nothing can be proved of a black box.
            _ if self.field.sign.has_black_box() => Method::Sampled { step: settings.size / 256.0 },
            method => method,
        };
        let of_conditions = Settings { method, surface: false, caps: true, ..of_solid };
        while lanes.iter().any(|lane| lane.stage != Stage::Done) {
            let (places, found) = ask(asker, &self.field, (&lanes, Stage::Conditions), &of_conditions);
            for (&i, found) in places.iter().zip(&found) {
                lanes[i].reach_conditions(found);
            }
            let (places, found) = ask(asker, solid, (&lanes, Stage::Root), &of_solid);
            let hits: Vec<(Ray, Hit)> = places
                .iter()
                .zip(&found)
                .filter_map(|(&i, found)| found.hit.map(|hit| (lanes[i].ray, hit)))
                .collect();
            let mut holding = self.hold(&mut asker.conditions, &hits).into_iter();
            for (&i, found) in places.iter().zip(&found) {
                let holds = found.hit.and_then(|_| holding.next());
                lanes[i].reach_root(found, holds.unwrap_or((false, true)));
            }
        }
        lanes.into_iter().map(|lane| lane.outcome).collect()
    }

    /// Whether the conditions hold at hits, and whether that is certain.
    fn hold(&self, memory: &mut Memory, hits: &[(Ray, Hit)]) -> Vec<(bool, bool)> {
        let mut all = Vec::with_capacity(hits.len());
        for block in hits.chunks(LANES) {
            for (lane, (ray, hit)) in block.iter().enumerate() {
                let at = |t: f64| DVec3::from_array(ray.at(t));
                let (place, a, b) = (at(hit.t), at(hit.before), at(hit.after));
                let (lo, hi) = (a.min(b).min(place), a.max(b).max(place));
                for axis in 0..3 {
                    memory.boxes.input(axis, 0)[lane] = lo[axis];
                    memory.boxes.input(axis, 1)[lane] = hi[axis];
                    memory.points.input(axis, 0)[lane] = place[axis];
                }
            }
            memory.boxes.run(&self.field.sign, block.len());
            memory.points.run(&self.field.sign, block.len());
            let (lo, hi) = (memory.boxes.output(0, 0), memory.boxes.output(0, 1));
            let value = memory.points.output(0, 0);
            all.extend((0..block.len()).map(|lane| match (hi[lane] < 0.0, lo[lane] > 0.0) {
                (true, _) => (true, true),
                (_, true) => (false, true),
                _ => (value[lane] < 0.0, false),
            }));
        }
        all
    }
}

/// Traces the rays of one stage; their places, and what they found.
fn ask(
    asker: &mut Asker,
    field: &Roots,
    (lanes, stage): (&[Lane], Stage),
    settings: &Settings,
) -> (Vec<usize>, Vec<Outcome>) {
    let places: Vec<usize> = (0..lanes.len()).filter(|&i| lanes[i].stage == stage).collect();
    let rays: Vec<Ray> = places.iter().map(|&i| lanes[i].ray).collect();
    let found = if rays.is_empty() { Vec::new() } else { field.first_hits(asker, &rays, settings) };
    (places, found)
}

impl Lane {
    fn new(ray: Ray, stage: Stage) -> Self {
        let outcome = Outcome {
            hit: None,
            certificate: Certificate::Certified,
            cost: 0,
            starts_inside: false,
            ends_inside: false,
        };
        Self { ray, stage, outcome, turns: 0 }
    }

    fn count(&mut self, found: &Outcome) {
        self.outcome.cost = self.outcome.cost.saturating_add(found.cost);
        self.doubt(found.certificate);
    }

    fn doubt(&mut self, certificate: Certificate) {
        self.outcome.certificate = self.outcome.certificate.max(certificate);
    }

    /// Goes on from where the conditions hold, if they do anywhere.
    fn reach_conditions(&mut self, found: &Outcome) {
        self.count(found);
        self.stage = match found.hit {
            _ if found.starts_inside => Stage::Root,
            Some(hit) => {
                self.ray.start = self.ray.start.max(hit.before);
                Stage::Root
            }
            None => Stage::Done,
        };
    }

    /// Takes a root at which the conditions hold, certainly or not; goes on behind one where they do not.
    fn reach_root(&mut self, found: &Outcome, (holds, certainly): (bool, bool)) {
        self.count(found);
        self.turns += 1;
        if !certainly {
            self.doubt(Certificate::Tolerance);
        }
        let Some(hit) = found.hit else {
            self.stage = Stage::Done;
            return;
        };
        if holds {
            self.outcome.hit = Some(hit);
            self.stage = Stage::Done;
        } else if self.turns >= MOST_TURNS {
            self.doubt(Certificate::Undecided);
            self.stage = Stage::Done;
        } else {
            // A touching root has no far end, but it is not to be found again.
            let behind = if hit.touching { hit.t + 2.0 * (hit.t - hit.before) } else { hit.after };
            self.ray.start = behind.max(self.ray.start + 4.0 * f64::EPSILON * self.ray.start.abs());
            self.stage = Stage::Conditions;
        }
    }
}
