//! Light: what comes back along a ray.
//!
//! Blinn-Phong with hard shadows. A shadow ray starts where the view ray was certainly still outside, one bracket's
//! width before the surface, so that there is neither acne nor leaking light. Light arrives unless something is found to
//! block it: a shadow ray that meets nothing but places where the field is undefined, or that runs out of fuel, counts as
//! free. Certificates of pixels are about their own rays, not about shadows.

use crate::query::{Answer, Asker, Prepared, Surface};
use glam::DVec3;

/// What a ray brings back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) answer: Answer,
    /// Towards the eye; 0 on a miss.
    pub(crate) normal: DVec3,
    /// Linear RGB; 0 on a miss.
    pub(crate) colour: DVec3,
}

/// What comes back along each ray of a bundle.
pub(crate) fn radiance(prepared: &Prepared<'_>, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Sample> {
    let answers = prepared.surfaces(asker, rays);
    let seen: Vec<usize> = (0..rays.len()).filter(|&i| answers[i].surface.is_some()).collect();
    let hits: Vec<(Surface, DVec3)> =
        seen.iter().filter_map(|&i| answers[i].surface.map(|s| (s, rays[i].1))).collect();
    let normals = prepared.normals(asker, &hits);
    let colours = shade(prepared, asker, &hits, &normals);
    let mut samples: Vec<Sample> = answers
        .into_iter()
        .zip(rays)
        .map(|(answer, ray)| {
            // Volume segments will go before the surface, front to back.
            let _none = prepared.segments(ray, answer.surface.map_or(f64::INFINITY, |s| s.t));
            Sample { answer, normal: DVec3::ZERO, colour: DVec3::ZERO }
        })
        .collect();
    for ((&i, normal), colour) in seen.iter().zip(normals).zip(colours) {
        (samples[i].normal, samples[i].colour) = (normal, colour);
    }
    samples
}

/// The light that surfaces send back against their rays.
fn shade(
    prepared: &Prepared<'_>,
    asker: &mut Asker,
    hits: &[(Surface, DVec3)],
    normals: &[DVec3],
) -> Vec<DVec3> {
    let lighting = prepared.scene.lighting();
    let looks = prepared.appearances(asker, hits);
    let mut colours: Vec<DVec3> = looks.iter().map(|look| look.colour * lighting.ambient).collect();
    for light in &lighting.lights {
        let lit: Vec<usize> = (0..hits.len())
            .filter(|&i| light.at(hits[i].0.before).is_some_and(|l| l.to_light.dot(normals[i]) > 0.0))
            .collect();
        let arriving: Vec<_> = lit.iter().filter_map(|&i| light.at(hits[i].0.before)).collect();
        let rays: Vec<(DVec3, DVec3)> =
            lit.iter().zip(&arriving).map(|(&i, l)| (hits[i].0.before, l.to_light)).collect();
        let blocked = if light.casts_shadow() {
            let distances: Vec<f64> = arriving.iter().map(|l| l.distance).collect();
            prepared.blocked(asker, &rays, &distances)
        } else {
            vec![false; rays.len()]
        };
        for ((&i, l), _) in lit.iter().zip(&arriving).zip(&blocked).filter(|(_, blocked)| !**blocked) {
            let (look, (_, direction)) = (&looks[i], hits[i]);
            let cosine = l.to_light.dot(normals[i]);
            let half = (l.to_light - direction).normalize_or_zero();
            let highlight = look.specular * half.dot(normals[i]).max(0.0).powf(look.shininess);
            colours[i] += l.colour * (look.colour * cosine + DVec3::splat(highlight * cosine.min(1.0)));
        }
    }
    colours
}
