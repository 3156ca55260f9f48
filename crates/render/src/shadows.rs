//! What is in the way of light on its way from lamps and the sky.
//!
//! Light arrives unless something is found to block it: a shadow ray that meets nothing but places where the field is
//! undefined, or that runs out of fuel, counts as free. Shadow rays pass transparent things in a straight line: what a
//! lens would gather is spread evenly (no caustics). Each surface on the way lets through what is not there (opacity) and
//! what is clear, with its colour, but for what it mirrors at a right angle; inside, light is absorbed.

use crate::bsdf::{fresnel, tint};
use crate::query::{Asker, Prepared, Surface};
use fieldstone_scene::{Appearance, Channel, Rgb, Scene, Shading};
use glam::DVec3;

/// How many surfaces let the light of a lamp through one after the other; it ends at the next.
const MOST_SURFACES: usize = 64;

/// Light fainter than this part of what the lamp sends is not followed further.
const FAINTEST: f64 = 1e-3;

/// A ray towards where light comes from, and how far that is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRay {
    pub(crate) origin: DVec3,
    /// A unit vector.
    pub(crate) direction: DVec3,
    pub(crate) distance: f64,
}

/// Knows what is in the way of light.
pub(crate) struct Shadows<'s, 'p> {
    prepared: &'p Prepared<'s>,
    lets_light_through: bool,
}

impl<'s, 'p> Shadows<'s, 'p> {
    pub(crate) fn new(prepared: &'p Prepared<'s>) -> Self {
        Self { prepared, lets_light_through: lets_light_through(prepared.scene) }
    }

    /// What is left of the light that comes along each ray.
    pub(crate) fn left(&self, asker: &mut Asker, rays: impl Iterator<Item = ShadowRay>) -> Vec<Rgb> {
        let (rays, distances): (Vec<_>, Vec<_>) =
            rays.map(|ray| ((ray.origin, ray.direction), ray.distance)).unzip();
        if self.lets_light_through {
            return self.left_after(asker, rays, distances);
        }
        let blocked = self.prepared.blocked(asker, &rays, &distances);
        blocked.into_iter().map(|blocked| if blocked { DVec3::ZERO } else { DVec3::ONE }).collect()
    }

    /// The same through everything in the way, surface by surface.
    fn left_after(
        &self,
        asker: &mut Asker,
        mut rays: Vec<(DVec3, DVec3)>,
        mut distances: Vec<f64>,
    ) -> Vec<Rgb> {
        let mut left = vec![DVec3::ONE; rays.len()];
        let mut on_the_way: Vec<usize> = (0..rays.len()).collect();
        for _ in 0..MOST_SURFACES {
            let answers = self.prepared.blockers(asker, &rays, &distances);
            let met: Vec<(usize, Surface)> =
                (0..rays.len()).filter_map(|i| answers[i].surface.map(|s| (i, s))).collect();
            let hits: Vec<_> = met.iter().map(|&(i, s)| (s, rays[i].1)).collect();
            let looks = self.prepared.appearances(asker, &hits);
            let (mut next_rays, mut next_distances, mut next) = (Vec::new(), Vec::new(), Vec::new());
            for (&(i, surface), look) in met.iter().zip(&looks) {
                let light = &mut left[on_the_way[i]];
                *light *= passes(look, surface.from_inside, surface.t);
                if light.max_element() < FAINTEST {
                    *light = DVec3::ZERO;
                    continue;
                }
                next_rays.push((surface.behind, rays[i].1));
                next_distances.push(distances[i] - surface.t);
                next.push(on_the_way[i]);
            }
            (rays, distances, on_the_way) = (next_rays, next_distances, next);
            if rays.is_empty() {
                return left;
            }
        }
        on_the_way.into_iter().for_each(|i| left[i] = DVec3::ZERO);
        left
    }
}

/// What of a lamp's light passes a surface after a length of the way, which it went inside of the body if it leaves it.
fn passes(look: &Appearance, from_inside: bool, length: f64) -> Rgb {
    let clear = match look.shading {
        Shading::BlinnPhong { .. } if look.fresnel => {
            look.transmission * (1.0 - fresnel::at_normal(look.index))
        }
        Shading::BlinnPhong { .. } => look.transmission * (1.0 - look.reflection),
        Shading::Ggx { .. } => {
            let mirrored = fresnel::at_normal(look.index);
            look.transmission * (1.0 - look.metallic) * (1.0 - mirrored)
        }
        Shading::Gradient => 0.0,
    };
    let absorbs = from_inside && look.absorption != DVec3::ZERO;
    let inside = if absorbs { (-look.absorption * length).exp() } else { DVec3::ONE };
    inside * (DVec3::splat(1.0 - look.opacity) + tint(look.colour) * (clear * look.opacity))
}

/// Whether light gets through anything in a scene.
fn lets_light_through(scene: &Scene) -> bool {
    let parts = scene.solids().iter().flat_map(|solid| solid.parts());
    let mut materials = parts.flat_map(|p| p.materials.iter().map(|m| &m.material).chain(&p.back));
    materials.any(|material| {
        let base = material.base();
        let by_texture = |c: Channel| matches!(c, Channel::Opacity | Channel::Transmission);
        let textured = material.textures().iter().any(|texture| by_texture(texture.channel));
        textured || base.opacity < 1.0 || base.transmission > 0.0
    })
}
