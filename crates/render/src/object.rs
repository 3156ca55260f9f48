//! Solids with their programs compiled, and rays in their own space.

use crate::conditions::Conditions;
use crate::jump::Probe;
use crate::owner::Owners;
use crate::query::Asker;
use crate::roots::Roots;
use fieldstone_field::{F64, Points, Tape, TapeOptions, Workspace};
use fieldstone_scene::{Method, NORMAL_INPUTS, RaySpan, Scene, Solid};
use fieldstone_space::OctreeMemory;
use fieldstone_trace::{Certificate, Outcome, Ray, Settings};
use glam::DVec3;
use std::sync::Arc;

/// The step of the sampled method, relative to the longest side of the bounds.
const DEFAULT_STEP: f64 = 1.0 / 256.0;
/// The width of final brackets of the methods that do not converge quadratically, relative to the longest side.
const COARSE_TOLERANCE: f64 = 1.0 / (1u64 << 20) as f64;

/// What is sought along rays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Sought {
    /// The nearest surface.
    Nearest,
    /// The nearest surface, as closely as shadows need it.
    NearestBlocker,
    /// Any surface, as closely as shadows need it.
    AnyBlocker,
}

/// A ray in the space of an object; a unit direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRay {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    /// Where it starts along its direction; may be behind its origin.
    pub(crate) start: f64,
    /// Nothing is sought behind this.
    pub(crate) furthest: f64,
}

/// A surface that a ray meets, in the space of its object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// Distance along the ray.
    pub(crate) t: f64,
    /// The bracket around it along the ray: surfaces within it are the same place.
    pub(crate) near: f64,
    pub(crate) far: f64,
    /// Seen from where the ray comes from: the last place that is certainly before the surface.
    pub(crate) before: DVec3,
    /// A place certainly behind it.
    pub(crate) behind: DVec3,
    /// The outward normal of a cap, where the bounds cut the solid.
    pub(crate) cap: Option<DVec3>,
    /// Whether it is seen from where the field is negative.
    pub(crate) from_inside: bool,
    /// Whether the sign changes there without a root: the gradient says nothing of the surface.
    pub(crate) jump: bool,
    /// Where the gradient of the field is the normal. At a double root there is none, but a hair before it there is.
    pub(crate) gradient_place: DVec3,
    /// The gradient, if it is known already.
    pub(crate) gradient: Option<DVec3>,
}

/// What was found along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) meeting: Option<Meeting>,
    pub(crate) certificate: Certificate,
    pub(crate) cost: u32,
}

/// A solid with its programs compiled.
pub(crate) struct Object<'s> {
    pub(crate) solid: &'s Solid,
    /// Where the value is 0.
    pub(crate) roots: Roots,
    /// The value with the attributes.
    pub(crate) attributes: Tape,
    /// Whether the attributes vary with the normal, whose components follow x, y and z then.
    pub(crate) reads_normals: bool,
    /// The number of its first part among the parts of all solids.
    pub(crate) first_part: usize,
    /// Who owns a place; none if there is but one part.
    pub(crate) owners: Option<Owners>,
    conditions: Option<Conditions>,
    settings: Settings,
    shadow_settings: Settings,
}

impl<'s> Object<'s> {
    /// The first part of the solid is the one of this number; trees share `memory`. What does not differ from a `former`
    /// solid, whose bindings were others, is taken over from it.
    pub(crate) fn new(
        (solid, first_part): (&'s Solid, usize),
        scene: &Scene,
        memory: &OctreeMemory,
        former: Option<&Object<'_>>,
    ) -> Self {
        let options = TapeOptions { bindings: solid.bindings().clone(), ..TapeOptions::default() };
        let (field, bindings) = (solid.field(), solid.bindings());
        let is_same = |former: &&Object<'_>| {
            let (solid, other) = (solid, former.solid);
            Arc::ptr_eq(field.graph(), other.field().graph())
                && field.value() == other.field().value()
                && solid.bounds() == other.bounds()
        };
        let roots = match former.filter(is_same) {
            Some(former) => former.roots.rebound(field, bindings),
            None => Roots::new(field, bindings, solid.bounds(), memory),
        };
        let reads_normals = solid.field().inputs().iter().any(|input| NORMAL_INPUTS.contains(input));
        let mut varying = options.varying.clone();
        if reads_normals {
            varying.extend(NORMAL_INPUTS);
        }
        let attributes = Tape::new(solid.field(), &TapeOptions { attributes: true, varying, ..options });
        let coarse = scene.settings().shadow_tolerance;
        let settings = |tolerance| trace_settings(scene, solid, tolerance, roots.sign.has_black_box());
        let (settings, shadow_settings) = (settings(None), settings(coarse));
        let conditions =
            (!solid.conditions().is_empty()).then(|| Conditions::new(solid, roots.sign.len(), memory));
        let owners =
            (solid.parts().len() > 1).then(|| Owners::new(solid, settings.tolerance * settings.size));
        Self {
            solid,
            roots,
            attributes,
            reads_normals,
            first_part,
            owners,
            conditions,
            settings,
            shadow_settings,
        }
    }

    /// Whether rays certainly meet nothing whose origins and directions, of any length, lie between the four given.
    pub(crate) fn is_clear(&self, asker: &mut Asker, hull: &[([f64; 3], [f64; 3]); 4]) -> bool {
        self.roots.is_clear(asker, hull, &self.settings)
    }

    /// The surfaces that rays meet: `take` is told what each of them finds, in their order.
    pub(crate) fn meetings(
        &self,
        asker: &mut Asker,
        rays: &[ObjectRay],
        sought: Sought,
        mut take: impl FnMut(usize, Found),
    ) {
        let spans: Vec<Option<RaySpan>> =
            rays.iter().map(|ray| self.solid.ray_span(ray.origin, ray.direction)).collect();
        let to_trace: Vec<Ray> = rays.iter().zip(&spans).map(|(ray, span)| limited(ray, span)).collect();
        let from_outside = rays.iter().zip(&spans).all(|(ray, s)| s.is_none_or(|s| s.enter > ray.start));
        let settings = if sought == Sought::Nearest { &self.settings } else { &self.shadow_settings };
        let settings = Settings {
            caps: self.solid.is_capped() && from_outside,
            any_hit: sought == Sought::AnyBlocker,
            ..*settings
        };
        let (outcomes, gradients) = match &self.conditions {
            None if sought == Sought::Nearest => {
                self.roots.first_hits_with_gradients(asker, &to_trace, &settings)
            }
            None => (self.roots.first_hits(asker, &to_trace, &settings), None),
            Some(conditions) => (conditions.first_hits(asker, &self.roots, &to_trace, &settings), None),
        };
        asker.evaluations += outcomes.iter().map(|o| u64::from(o.cost)).sum::<u64>();
        for (i, outcome) in outcomes.iter().enumerate() {
            let span = spans[i].as_ref();
            // Only what the ray enters from outside of the bounds begins on a cap.
            let entered = span.filter(|span| span.enter > rays[i].start);
            let mut found = self.found(outcome, &to_trace[i], (entered, span));
            if let (Some(meeting), Some(gradients)) = (&mut found.meeting, &gradients) {
                meeting.gradient = Some(DVec3::from_array(gradients[i]));
            }
            take(i, found);
        }
    }

    /// The nearest surfaces, and their gradients, of rays that are a unit direction from an origin outside of the solid's
    /// bounds or in them, without caps: `None` where there are conditions, or another method than the octree's.
    pub(crate) fn first_hits(
        &self,
        asker: &mut Asker,
        rays: &[(DVec3, DVec3)],
    ) -> Option<(Vec<Outcome>, Vec<[f64; 3]>)> {
        if self.conditions.is_some() || self.settings.method != fieldstone_trace::Method::Affine {
            return None;
        }
        let to_trace: Vec<Ray> = rays
            .iter()
            .map(|&(origin, direction)| {
                let span = self.solid.ray_span(origin, direction);
                let (start, end) = span.map_or((0.0, 0.0), |span| (span.enter.max(0.0), span.exit));
                Ray { origin: origin.to_array(), direction: direction.to_array(), start, end }
            })
            .collect();
        let settings = Settings { caps: self.solid.is_capped(), ..self.settings };
        let (outcomes, gradients) = self.roots.first_hits_with_gradients(asker, &to_trace, &settings);
        asker.evaluations += outcomes.iter().map(|o| u64::from(o.cost)).sum::<u64>();
        Some((outcomes, gradients?))
    }

    /// The outcome as a surface, caps included; `spans`: within the bounds, if the ray comes from outside of them, and
    /// in any case.
    fn found(&self, outcome: &Outcome, ray: &Ray, spans: (Option<&RaySpan>, Option<&RaySpan>)) -> Found {
        let capped = self.solid.is_capped();
        let meeting = match (outcome.hit, spans) {
            (_, (Some(span), _)) if outcome.starts_inside && capped => {
                Some(self.cap(ray, span.enter, span.enter_normal, false))
            }
            (Some(hit), _) => {
                let at = |t: f64| DVec3::from_array(ray.at(t));
                let hair = self.settings.tolerance * self.settings.size;
                let behind = at(hit.after + (hit.after - hit.before));
                let before = at(hit.before);
                let gradient_place = if hit.touching { at(hit.t - hair) } else { 0.5 * (before + behind) };
                Some(Meeting {
                    t: hit.t,
                    near: hit.before.max(hit.t - 2.0 * hair),
                    far: hit.after.min(hit.t + 2.0 * hair),
                    before,
                    behind,
                    cap: None,
                    from_inside: !hit.entering,
                    jump: hit.jump,
                    gradient_place,
                    gradient: None,
                })
            }
            (None, (_, Some(span))) if outcome.ends_inside && capped && ray.end >= span.exit => {
                Some(self.cap(ray, span.exit, span.exit_normal, true))
            }
            _ => None,
        };
        Found { meeting, certificate: outcome.certificate, cost: outcome.cost }
    }

    /// The face at t where the bounds cut the solid, with its outward normal.
    fn cap(&self, ray: &Ray, t: f64, normal: DVec3, from_inside: bool) -> Meeting {
        let place = DVec3::from_array(ray.at(t));
        // A hair to each side of the face, as far as brackets are wide.
        let hair = self.settings.tolerance * self.settings.size;
        let (outside, inside) = (place + hair * normal, place - hair * normal);
        let (before, behind) = if from_inside { (inside, outside) } else { (outside, inside) };
        Meeting {
            t,
            near: t - hair,
            far: t + hair,
            before,
            behind,
            cap: Some(normal),
            from_inside,
            jump: false,
            gradient_place: place,
            gradient: None,
        }
    }

    /// A normal where there is no gradient; towards the eye if there is none at all. Around an edge it may be that of a
    /// face on the other side: then it is mirrored, since its opposite would point into the solid.
    pub(crate) fn probe_normal(
        &self,
        points: &mut Workspace<F64, Points>,
        place: DVec3,
        direction: DVec3,
    ) -> DVec3 {
        let (tape, size) = (&self.roots.sign, self.settings.size);
        let normal = Probe { points, tape, place, size }.normal().unwrap_or(-direction);
        normal - 2.0 * normal.dot(direction).max(0.0) * direction
    }
}

/// The part of a ray on which there may be something.
fn limited(ray: &ObjectRay, span: &Option<RaySpan>) -> Ray {
    let (start, end) =
        span.map_or((ray.start, ray.start), |s| (s.enter.max(ray.start), s.exit.min(ray.furthest)));
    Ray { origin: ray.origin.to_array(), direction: ray.direction.to_array(), start, end }
}

/// How the rays of a solid are traced; `coarse` is a tolerance that goes before that of the scene and the solid.
fn trace_settings(scene: &Scene, solid: &Solid, coarse: Option<f64>, black_box: bool) -> Settings {
    let size = solid.bounds().longest_side();
    let mut settings = Settings { surface: solid.is_surface(), ..Settings::new(size) };
    let method = match solid.method().unwrap_or(scene.settings().method) {
        // Nothing can be proved of a black box.
        _ if black_box => Method::Sampled { step: None },
        method => method,
    };
    settings.method = match method {
        Method::Affine => fieldstone_trace::Method::Affine,
        Method::Interval { accept_epsilon } => {
            fieldstone_trace::Method::Interval { accept_epsilon: accept_epsilon.map(|e| e * size) }
        }
        Method::Sampled { step } => {
            fieldstone_trace::Method::Sampled { step: step.unwrap_or(DEFAULT_STEP) * size }
        }
    };
    if method != Method::Affine {
        settings.tolerance = COARSE_TOLERANCE;
    }
    let wanted = coarse.or(solid.tolerance()).or(scene.settings().tolerance);
    settings.tolerance = wanted.unwrap_or(settings.tolerance);
    settings
}
