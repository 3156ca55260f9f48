//! What rays may ask of a scene.

use crate::jump::Probe;
use fieldstone_field::{F64, Gradients, LANES, Points, Reading, Tape, TapeOptions, Workspace};
use fieldstone_scene::{Appearance, Method, RaySpan, Scene, Solid};
use fieldstone_trace::{Certificate, Hit, Outcome, Ray, Settings, Tracer};
use glam::DVec3;

/// The step of the sampled method, relative to the longest side of the bounds.
const DEFAULT_STEP: f64 = 1.0 / 256.0;
/// The width of final brackets of the methods that do not converge quadratically, relative to the longest side.
const COARSE_TOLERANCE: f64 = 1.0 / (1u64 << 20) as f64;

/// A scene with its programs compiled.
pub(crate) struct Prepared<'s> {
    pub(crate) scene: &'s Scene,
    solids: Vec<PreparedSolid<'s>>,
}

struct PreparedSolid<'s> {
    solid: &'s Solid,
    /// The value, for its sign.
    sign: Tape,
    /// The value with the attributes.
    attributes: Tape,
    settings: Settings,
}

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Which solid, counted from 0.
    pub(crate) part: usize,
    /// Distance along the ray.
    pub(crate) t: f64,
    /// The surface, seen from where the ray comes from: the last place that is certainly before it.
    pub(crate) before: DVec3,
    /// A place certainly behind it.
    pub(crate) behind: DVec3,
    /// The normal of a cap, where the bounds cut the solid.
    cap: Option<DVec3>,
    /// Whether the sign changes there without a root: the gradient says nothing of the surface.
    jump: bool,
    /// Whether it is seen from where the field is negative.
    pub(crate) from_inside: bool,
    /// Where the gradient of the field is the normal. At a double root there is none, but a hair before it there is.
    gradient_place: DVec3,
}

/// The answer to a surface query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) surface: Option<Surface>,
    pub(crate) certificate: Certificate,
    pub(crate) cost: u32,
}

/// The volume segments before the nearest surface: texels will fill them.
pub(crate) struct Segments;

/// What a thread needs to ask.
#[derive(Default)]
pub(crate) struct Asker {
    tracer: Tracer,
    gradients: Workspace<F64, Gradients>,
    points: Workspace<F64, Points>,
    /// Evaluations of fields so far, over points and sets.
    pub(crate) evaluations: u64,
    /// Rays so far.
    pub(crate) rays: u64,
}

impl<'s> Prepared<'s> {
    pub(crate) fn new(scene: &'s Scene) -> Self {
        let solids = scene.solids().iter().map(|solid| PreparedSolid::new(solid, scene)).collect();
        Self { scene, solids }
    }

    /// The nearest surface along each ray; rays are a unit direction from an origin.
    pub(crate) fn surfaces(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Answer> {
        asker.rays += rays.len() as u64;
        let mut answers =
            vec![Answer { surface: None, certificate: Certificate::Certified, cost: 0 }; rays.len()];
        for (part, solid) in self.solids.iter().enumerate() {
            for (answer, found) in answers.iter_mut().zip(solid.hits(asker, rays, None)) {
                answer.cost += found.cost;
                answer.certificate = answer.certificate.max(found.certificate);
                let nearer = |s: &Surface| answer.surface.is_none_or(|known| s.t < known.t);
                if let Some(surface) = found.surface.filter(nearer) {
                    answer.surface = Some(Surface { part, ..surface });
                }
            }
        }
        answers
    }

    /// The volume segments along a ray before `_t`.
    pub(crate) fn segments(&self, _ray: &(DVec3, DVec3), _t: f64) -> Segments {
        Segments
    }

    /// Which rays meet anything before their distances; they start outside of all solids. Undecided rays without a
    /// crossing meet nothing.
    pub(crate) fn blocked(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)], distances: &[f64]) -> Vec<bool> {
        asker.rays += rays.len() as u64;
        let mut blocked = vec![false; rays.len()];
        for solid in &self.solids {
            for (blocked, found) in blocked.iter_mut().zip(solid.hits(asker, rays, Some(distances))) {
                *blocked |= found.surface.is_some();
            }
        }
        blocked
    }

    /// Unit normals at surfaces, turned against their rays.
    pub(crate) fn normals(&self, asker: &mut Asker, hits: &[(Surface, DVec3)]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; hits.len()];
        for (part, solid) in self.solids.iter().enumerate() {
            let of_part: Vec<usize> = (0..hits.len()).filter(|&i| hits[i].0.part == part).collect();
            for block in of_part.chunks(LANES) {
                for (lane, &i) in block.iter().enumerate() {
                    let point = hits[i].0.gradient_place;
                    for axis in 0..3 {
                        asker.gradients.input(axis, 0)[lane] = point[axis];
                        for direction in 0..3 {
                            let slope = f64::from(u8::from(axis == direction));
                            asker.gradients.input(axis, 1 + direction)[lane] = slope;
                        }
                    }
                }
                asker.gradients.run(&solid.sign, block.len());
                asker.evaluations += block.len() as u64;
                for (lane, &i) in block.iter().enumerate() {
                    let slope = |axis: usize| asker.gradients.output(0, 1 + axis)[lane];
                    let (surface, direction) = &hits[i];
                    let gradient = DVec3::new(slope(0), slope(1), slope(2));
                    let smooth = || gradient.try_normalize().filter(|n| n.is_finite() && !surface.jump);
                    let normal = surface.cap.or_else(smooth);
                    let normal =
                        normal.unwrap_or_else(|| solid.probe_normal(&mut asker.points, surface, *direction));
                    normals[i] = if normal.dot(*direction) > 0.0 { -normal } else { normal };
                }
            }
        }
        normals
    }

    /// How surfaces look.
    pub(crate) fn appearances(&self, asker: &mut Asker, hits: &[(Surface, DVec3)]) -> Vec<Appearance> {
        let mut looks = vec![Appearance::default(); hits.len()];
        for (part, solid) in self.solids.iter().enumerate() {
            let count = solid.attributes.output_count() - 1;
            let of_part: Vec<usize> = (0..hits.len()).filter(|&i| hits[i].0.part == part).collect();
            for block in of_part.chunks(LANES) {
                if count > 0 {
                    // Attributes are those of the solid, and may be unset a hair outside of it.
                    fill_points(&mut asker.points, block.iter().map(|&i| hits[i].0.behind));
                    asker.points.run(&solid.attributes, block.len());
                    asker.evaluations += block.len() as u64;
                }
                for (lane, &i) in block.iter().enumerate() {
                    let attributes: Vec<f64> = (1..=count).map(|a| asker.points.output(a, 0)[lane]).collect();
                    looks[i] = solid.solid.parts()[0].appearance(&attributes, hits[i].0.from_inside);
                }
            }
        }
        looks
    }
}

fn fill_points(points: &mut Workspace<F64, Points>, list: impl Iterator<Item = DVec3>) {
    for (lane, point) in list.enumerate() {
        for axis in 0..3 {
            points.input(axis, 0)[lane] = point[axis];
        }
    }
}

impl Surface {
    fn middle(&self) -> DVec3 {
        0.5 * (self.before + self.behind)
    }
}

impl<'s> PreparedSolid<'s> {
    fn new(solid: &'s Solid, scene: &Scene) -> Self {
        let options = TapeOptions { bindings: solid.bindings().clone(), ..TapeOptions::default() };
        let sign = Tape::new(solid.field(), &TapeOptions { reading: Reading::Sign, ..options.clone() });
        let attributes = Tape::new(solid.field(), &TapeOptions { attributes: true, ..options });
        let settings = trace_settings(scene, solid, sign.has_black_box());
        Self { solid, sign, attributes, settings }
    }

    /// The surfaces that rays meet; any that lies before their distances, if there are distances.
    fn hits(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)], distances: Option<&[f64]>) -> Vec<Answer> {
        let spans: Vec<Option<RaySpan>> = rays.iter().map(|&(o, d)| self.solid.ray_span(o, d)).collect();
        let to_trace: Vec<Ray> = rays
            .iter()
            .zip(&spans)
            .enumerate()
            .map(|(i, (&(origin, direction), span))| {
                let furthest = distances.map_or(f64::INFINITY, |d| d[i]);
                let (start, end) = span.map_or((0.0, 0.0), |s| (s.enter.max(0.0), s.exit.min(furthest)));
                Ray { origin: origin.to_array(), direction: direction.to_array(), start, end }
            })
            .collect();
        let any_hit = distances.is_some();
        let from_outside = spans.iter().flatten().all(|s| s.enter > 0.0);
        let settings = Settings { caps: self.solid.is_capped() && from_outside, any_hit, ..self.settings };
        let shared = asker.tracer.shared_cost();
        let outcomes = asker.tracer.first_hits(&self.sign, &to_trace, &settings);
        asker.evaluations += asker.tracer.shared_cost() - shared;
        asker.evaluations += outcomes.iter().map(|o| u64::from(o.cost)).sum::<u64>();
        let found = outcomes.iter().zip(&to_trace).zip(&spans);
        found.map(|((outcome, ray), span)| self.answer(outcome, ray, span.as_ref())).collect()
    }

    /// The outcome as a surface, caps included.
    fn answer(&self, outcome: &Outcome, ray: &Ray, span: Option<&RaySpan>) -> Answer {
        let at = |t: f64| DVec3::from_array(ray.at(t));
        let capped = self.solid.is_capped();
        let cap = |t: f64, normal: DVec3, side: f64| {
            // A hair outside of the face, as far as brackets are wide.
            let hair = self.settings.tolerance * self.settings.size;
            let (before, behind) = (at(t) + side * hair * normal, at(t) - side * hair * normal);
            Surface {
                part: 0,
                t,
                before,
                behind,
                cap: Some(normal),
                jump: false,
                from_inside: false,
                gradient_place: at(t),
            }
        };
        let surface = match (outcome.hit, span) {
            (_, Some(span)) if outcome.starts_inside && capped && span.enter > 0.0 => {
                Some(cap(span.enter, span.enter_normal, 1.0))
            }
            (Some(hit), _) => {
                let behind = at(hit.after + (hit.after - hit.before));
                let before = at(hit.before);
                let hair = self.settings.tolerance * self.settings.size;
                let gradient_place = if hit.touching { at(hit.t - hair) } else { 0.5 * (before + behind) };
                let from_inside = !hit.entering;
                let Hit { t, jump, .. } = hit;
                Some(Surface { part: 0, t, before, behind, cap: None, jump, from_inside, gradient_place })
            }
            (None, Some(span)) if outcome.ends_inside && capped && ray.end >= span.exit => {
                Some(cap(span.exit, span.exit_normal, -1.0))
            }
            _ => None,
        };
        Answer { surface, certificate: outcome.certificate, cost: outcome.cost }
    }

    /// A normal where there is no gradient; towards the eye if there is none at all. Around an edge it may be that of a
    /// face on the other side: then it is mirrored, since its opposite would point into the solid.
    fn probe_normal(
        &self,
        points: &mut Workspace<F64, Points>,
        surface: &Surface,
        direction: DVec3,
    ) -> DVec3 {
        let (tape, size) = (&self.sign, self.settings.size);
        let normal = Probe { points, tape, place: surface.middle(), size }.normal().unwrap_or(-direction);
        normal - 2.0 * normal.dot(direction).max(0.0) * direction
    }
}

fn trace_settings(scene: &Scene, solid: &Solid, black_box: bool) -> Settings {
    let size = solid.bounds().longest_side();
    let mut settings = Settings { surface: solid.is_surface(), ..Settings::new(size) };
    let method = match scene.settings().method {
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
    settings.tolerance = scene.settings().tolerance.unwrap_or(settings.tolerance);
    settings
}
