//! What is in the way of light on its way from lamps and the sky.
//!
//! Light arrives unless something is found to block it: a shadow ray that meets nothing but places where the field is
//! undefined, or that runs out of fuel, counts as free. Shadow rays pass transparent things in a straight line: what a
//! lens would gather is spread evenly (no caustics). Each surface on the way lets through what is not there (opacity) and
//! what is clear, with its colour, but for what it mirrors at a right angle; inside, light is absorbed.

use crate::bsdf::{fresnel, tint};
use crate::query::{Asker, Prepared, Surface};
use crate::sampling::derive;
use fieldstone_scene::{Appearance, Channel, Rgb, Scene, Shading};
use glam::DVec3;

/// How many surfaces let the light of a lamp through one after the other; it ends at the next.
const MOST_SURFACES: u32 = 64;

/// Of light that counts less than this in the picture only some is followed, by chance, for all of it.
const FAINTEST: f64 = 1.0 / 2048.0;

/// A ray towards where light comes from, and how far that is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRay {
    pub(crate) origin: DVec3,
    /// A unit vector.
    pub(crate) direction: DVec3,
    pub(crate) distance: f64,
    /// How much its light counts in the picture if nothing is in the way.
    pub(crate) worth: f64,
    /// What chance depends on.
    pub(crate) seed: u32,
}

impl ShadowRay {
    /// What is followed of light of which this is left after so many surfaces.
    fn followed(&self, left: Rgb, surfaces: u32) -> Rgb {
        let share = self.worth * left.max_element() / FAINTEST;
        if share >= 1.0 {
            return left;
        }
        let chance = f64::from(derive(self.seed, surfaces)) / (1u64 << 32) as f64;
        if chance < share { left / share } else { DVec3::ZERO }
    }
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
        if self.lets_light_through {
            return self.left_after(asker, rays.collect());
        }
        let (rays, distances): (Vec<_>, Vec<_>) =
            rays.map(|ray| ((ray.origin, ray.direction), ray.distance)).unzip();
        let blocked = self.prepared.blocked(asker, &rays, &distances);
        blocked.into_iter().map(|blocked| if blocked { DVec3::ZERO } else { DVec3::ONE }).collect()
    }

    /// The same through everything in the way, surface by surface.
    fn left_after(&self, asker: &mut Asker, rays: Vec<ShadowRay>) -> Vec<Rgb> {
        let mut left = vec![DVec3::ONE; rays.len()];
        let mut on_the_way: Vec<(usize, ShadowRay)> = rays.into_iter().enumerate().collect();
        for surfaces in 0..MOST_SURFACES {
            if on_the_way.is_empty() {
                return left;
            }
            let (rays, distances): (Vec<_>, Vec<_>) =
                on_the_way.iter().map(|(_, ray)| ((ray.origin, ray.direction), ray.distance)).unzip();
            let answers = self.prepared.blockers(asker, &rays, &distances);
            let mut met: Vec<((usize, ShadowRay), Surface)> =
                on_the_way.iter().zip(answers).filter_map(|(&ray, a)| a.surface.map(|s| (ray, s))).collect();
            let hits: Vec<_> = met.iter().map(|((_, ray), surface)| (*surface, ray.direction)).collect();
            let looks = self.prepared.appearances(asker, &hits);
            for (((i, ray), surface), look) in met.iter_mut().zip(&looks) {
                left[*i] = ray.followed(left[*i] * passes(look, surface.from_inside, surface.t), surfaces);
                *ray = ShadowRay { origin: surface.behind, distance: ray.distance - surface.t, ..*ray };
            }
            on_the_way =
                met.into_iter().map(|(ray, _)| ray).filter(|&(i, _)| left[i] != DVec3::ZERO).collect();
        }
        on_the_way.into_iter().for_each(|(i, _)| left[i] = DVec3::ZERO);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faint_light_is_followed_by_chance_and_right_on_average() {
        let light = DVec3::new(0.5, 1.0, 0.25) * 0.1 * FAINTEST;
        let ray =
            |seed| ShadowRay { origin: DVec3::ZERO, direction: DVec3::Z, distance: 1.0, worth: 2.0, seed };
        let followed: Vec<Rgb> = (0..20_000).map(|seed| ray(seed).followed(light, 3)).collect();
        let mean = followed.iter().sum::<DVec3>() / 20_000.0;
        assert!((mean / light - DVec3::ONE).abs().max_element() < 0.05, "{mean} is not {light}");
        let kept = followed.iter().filter(|light| **light != DVec3::ZERO).count();
        assert!((3600..4400).contains(&kept), "a fifth of 20,000, not {kept}");
        assert_eq!(ray(1).followed(DVec3::ONE, 3), DVec3::ONE);
        assert_eq!(ray(1).followed(DVec3::ZERO, 3), DVec3::ZERO);
    }
}
