//! Solids where they stand: rays are moved into their spaces, and what they meet there comes back.
//!
//! Few solids that are not moved are asked one after another, each for all rays. Otherwise a hierarchy of boxes says
//! which instances a ray may meet, and each ray asks them from the nearest on, until what is left begins behind the
//! surface that it has met. This happens in rounds: the rays that ask instances of one solid in the same round are traced
//! together, so that lanes are full however few rays meet each instance.

use crate::hierarchy::{Hierarchy, Passage};
use crate::object::{Found, Meeting, ObjectRay, Sought};
use crate::query::{Answer, Asker, Prepared, Question, Surface};
use fieldstone_field::LANES;
use fieldstone_scene::{Instance, Scene};
use fieldstone_trace::Certificate;
use glam::DVec3;

/// Up to so many instances need no hierarchy if none is moved.
const FEW: usize = 8;
/// About how many rays are on their way in a round at least, if there is work for so many.
const ROUND: usize = 4 * LANES;

/// The hierarchy of the instances of a scene; none where it would not help.
pub(crate) fn hierarchy_of(scene: &Scene) -> Option<Hierarchy> {
    let instances = scene.instances();
    if instances.len() <= FEW && instances.iter().all(Instance::is_unmoved) {
        return None;
    }
    let bounds = |i: &Instance| i.world_bounds(scene.solids()[i.solid()].bounds());
    Some(Hierarchy::new(&instances.iter().map(bounds).collect::<Vec<_>>()))
}

/// A ray that asks an instance.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
struct Visit {
    solid: usize,
    instance: usize,
    ray: usize,
}

/// A ray in the space of an instance.
#[derive(Clone, Copy, Debug)]
struct Moved {
    ray: ObjectRay,
    /// How much longer distances are than in the world.
    scale: f64,
    /// How far along the ray its origin was moved, in the instance's space.
    shift: f64,
}

impl Prepared<'_> {
    /// What rays meet; which parts own it is not known yet.
    pub(crate) fn trace(&self, asker: &mut Asker, question: &Question<'_>) -> Vec<Answer> {
        let nothing = Answer { surface: None, certificate: Certificate::Certified, cost: 0 };
        let mut answers = vec![nothing; question.rays.len()];
        match &self.hierarchy {
            None => {
                for instance in 0..self.scene.instances().len() {
                    self.visit_with_all(asker, question, instance, &mut answers);
                }
            }
            Some(hierarchy) => {
                let passage = |(i, &ray)| (i, hierarchy.passage(ray, question.furthest(i)));
                let mut passages: Vec<(usize, Passage)> =
                    question.rays.iter().enumerate().map(passage).collect();
                while !passages.is_empty() {
                    let visits = self.next_round(hierarchy, &mut passages, |i| reach(question, &answers, i));
                    for of_solid in visits.chunk_by(|a, b| a.solid == b.solid) {
                        self.visit(asker, question, of_solid, &mut answers);
                    }
                }
            }
        }
        answers
    }

    /// Asks an instance that is not moved for all rays.
    fn visit_with_all(
        &self,
        asker: &mut Asker,
        question: &Question<'_>,
        instance: usize,
        answers: &mut [Answer],
    ) {
        let object = &self.objects[self.scene.instances()[instance].solid()];
        let rays: Vec<ObjectRay> = (0..question.rays.len())
            .map(|i| Moved::new(None, question.rays[i], reach(question, answers, i)).ray)
            .collect();
        object.meetings(asker, &rays, question.sought, |ray, found| {
            answers[ray].take(&found, |meeting| Surface::unmoved(instance, object.first_part, meeting));
        });
    }

    /// The next instances that rays ask, sorted by solid, instance and ray; rays that have none left are dropped.
    fn next_round(
        &self,
        hierarchy: &Hierarchy,
        passages: &mut Vec<(usize, Passage)>,
        reach: impl Fn(usize) -> f64,
    ) -> Vec<Visit> {
        let each = (ROUND / passages.len().max(1)).max(1);
        let mut visits = Vec::with_capacity(passages.len() * each);
        passages.retain_mut(|(ray, passage)| {
            for _ in 0..each {
                let Some(instance) = hierarchy.next(passage, reach(*ray)) else { return false };
                visits.push(Visit { solid: self.scene.instances()[instance].solid(), instance, ray: *ray });
            }
            true
        });
        visits.sort_unstable();
        visits
    }

    /// Asks instances of one solid.
    fn visit(&self, asker: &mut Asker, question: &Question<'_>, visits: &[Visit], answers: &mut [Answer]) {
        let Some(first) = visits.first() else { return };
        let object = &self.objects[first.solid];
        let mut moved: Vec<Moved> = Vec::with_capacity(visits.len());
        for of_instance in visits.chunk_by(|a, b| a.instance == b.instance) {
            let instance = &self.scene.instances()[of_instance[0].instance];
            let start = moved.len();
            let frame = self.moved[of_instance[0].instance].then_some(instance);
            moved.extend(of_instance.iter().map(|visit| {
                Moved::new(frame, question.rays[visit.ray], reach(question, answers, visit.ray))
            }));
            if frame.is_some() {
                let enter = |m: &Moved| object.solid.ray_span(m.ray.origin, m.ray.direction).map(|s| s.enter);
                // All by the same distance, so that they stay side by side.
                let shift = moved[start..].iter().filter_map(enter).fold(f64::INFINITY, f64::min).max(0.0);
                moved[start..].iter_mut().filter(|_| shift.is_finite()).for_each(|m| m.advance(shift));
            }
        }
        let rays: Vec<ObjectRay> = moved.iter().map(|m| m.ray).collect();
        object.meetings(asker, &rays, question.sought, |i, found| {
            let (visit, moved) = (&visits[i], &moved[i]);
            let frame = self.moved[visit.instance].then(|| &self.scene.instances()[visit.instance]);
            answers[visit.ray].take(&found, |meeting| {
                let surface = Surface::unmoved(visit.instance, object.first_part, meeting);
                frame.map_or(surface, |instance| moved.back_to_world(instance, surface))
            });
        });
    }
}

impl Answer {
    /// Takes what was found into account.
    fn take(&mut self, found: &Found, surface: impl FnOnce(&Meeting) -> Surface) {
        self.cost += found.cost;
        self.certificate = self.certificate.max(found.certificate);
        let goes_before = |s: &Surface| self.surface.as_ref().is_none_or(|known| s.goes_before(known));
        let nearer = found.meeting.as_ref().map(surface).filter(goes_before);
        if nearer.is_some() {
            self.surface = nearer;
        }
    }
}

/// Behind which distance nothing more is asked of a ray.
fn reach(question: &Question<'_>, answers: &[Answer], ray: usize) -> f64 {
    let known = answers[ray].surface.as_ref();
    match question.sought {
        Sought::AnyBlocker if known.is_some() => f64::NEG_INFINITY,
        _ => known.map_or(f64::INFINITY, |s| s.far).min(question.furthest(ray)),
    }
}

impl Moved {
    /// The ray before it is moved, if there is an instance that moves it.
    fn new(instance: Option<&Instance>, (origin, direction): (DVec3, DVec3), furthest: f64) -> Self {
        let Some(instance) = instance else {
            let ray = ObjectRay { origin, direction, start: 0.0, furthest };
            return Self { ray, scale: 1.0, shift: 0.0 };
        };
        let from_world = instance.object_from_world();
        let (origin, moved) = (from_world.transform_point3(origin), from_world.transform_vector3(direction));
        let scale = moved.length();
        let ray = ObjectRay { origin, direction: moved / scale, start: 0.0, furthest: furthest * scale };
        Self { ray, scale, shift: 0.0 }
    }

    /// Moves the origin along the ray, close to where something may be.
    fn advance(&mut self, shift: f64) {
        self.ray.origin += shift * self.ray.direction;
        self.ray.start -= shift;
        self.ray.furthest -= shift;
        self.shift += shift;
    }

    /// A surface that the moved ray met, as the ray in the world meets it.
    fn back_to_world(&self, instance: &Instance, surface: Surface) -> Surface {
        let distance = |t: f64| (t + self.shift) / self.scale;
        let place = |p: DVec3| instance.world_from_object().transform_point3(p);
        Surface {
            t: distance(surface.t),
            near: distance(surface.near),
            far: distance(surface.far),
            before: place(surface.before),
            behind: place(surface.behind),
            ..surface
        }
    }
}

impl Surface {
    /// As it is met in the space of its solid.
    pub(crate) fn unmoved(instance: usize, part: usize, meeting: &Meeting) -> Self {
        Self {
            part,
            instance,
            t: meeting.t,
            near: meeting.near,
            far: meeting.far,
            before: meeting.before,
            behind: meeting.behind,
            from_inside: meeting.from_inside,
            cap: meeting.cap,
            jump: meeting.jump,
            gradient_place: meeting.gradient_place,
            gradient: meeting.gradient,
        }
    }

    /// Whether it is met before another one. Of two in the same place, that of the instance that stands first is.
    fn goes_before(&self, other: &Self) -> bool {
        let together = self.near <= other.far && other.near <= self.far;
        if together { self.instance < other.instance } else { self.t < other.t }
    }
}
