//! Light that comes straight from lamps and from the sky, and what is in its way.
//!
//! Shadow rays start where the ray that looks was certainly still on its side, one bracket's width before the surface, so
//! that there is neither acne nor leaking light. Light arrives unless something is found to block it: a shadow ray that
//! meets nothing but places where the field is undefined, or that runs out of fuel, counts as free. Shadow rays pass
//! transparent things in a straight line: what a lens would gather is spread evenly (no caustics). Each surface on the
//! way lets through what is not there (opacity) and what is clear, with its colour, but for what it mirrors at a right
//! angle; inside, light is absorbed.

use crate::bsdf::{Scatter, tint};
use crate::query::{Asker, Prepared, Surface};
use crate::sampling::{derive, point};
use crate::sky::Sky;
use fieldstone_scene::{Appearance, Channel, Illumination, Light, Rgb, Scene, Shading};
use glam::DVec3;

/// How many surfaces let the light of a lamp through one after the other; it ends at the next.
const MOST_SURFACES: usize = 64;

/// Light fainter than this part of what the lamp sends is not followed further.
const FAINTEST: f64 = 1e-3;

/// About how many shadow rays are asked for together.
const TOGETHER: usize = 1 << 14;

/// The choices that points of a pixel's sequences stand for.
pub(crate) mod choice {
    pub(crate) const LENS: u32 = 1;
    pub(crate) const FACET: u32 = 2;
    pub(crate) const KIND: u32 = 3;
    pub(crate) const SKY: u32 = 4;
    /// And those after it, for further lamps.
    pub(crate) const LAMP: u32 = 16;
}

/// A surface that is seen, and how it scatters light.
pub(crate) struct Seen {
    pub(crate) surface: Surface,
    pub(crate) normal: DVec3,
    pub(crate) scatter: Scatter,
    /// What chance depends on here.
    pub(crate) seed: u32,
    /// Which sample of the pixel it is.
    pub(crate) index: u32,
    /// Whether one place on each lamp is enough, because chance led here already.
    pub(crate) by_chance: bool,
}

/// Light that surfaces get straight from where it is given off.
pub(crate) struct Lamps<'s, 'p> {
    prepared: &'p Prepared<'s>,
    sky: &'p Sky<'s>,
    lets_light_through: bool,
}

/// A shadow ray, and what it brings if nothing is in its way.
struct Wish {
    hit: usize,
    direction: DVec3,
    distance: f64,
    brings: Rgb,
}

/// What surfaces send back, and whether chance had a part in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sent {
    pub(crate) colour: Rgb,
    pub(crate) by_chance: bool,
}

impl<'s, 'p> Lamps<'s, 'p> {
    pub(crate) fn new(prepared: &'p Prepared<'s>, sky: &'p Sky<'s>) -> Self {
        Self { prepared, sky, lets_light_through: lets_light_through(prepared.scene) }
    }

    /// The lamps' and the sky's light that surfaces send back against their rays.
    pub(crate) fn light(&self, asker: &mut Asker, seen: &[Seen]) -> Vec<Sent> {
        let lighting = self.prepared.scene.lighting();
        let ambient = |s: &Seen| Sent { colour: s.scatter.diffuse() * lighting.ambient, by_chance: false };
        let mut sent: Vec<Sent> = seen.iter().map(ambient).collect();
        for (number, light) in (0..).zip(&lighting.lights) {
            self.add_lamp(asker, seen, (number, light), &mut sent);
        }
        self.add_sky(asker, seen, &mut sent);
        sent
    }

    fn add_lamp(&self, asker: &mut Asker, seen: &[Seen], (number, light): (u32, &Light), sent: &mut [Sent]) {
        let mut wishes = Vec::new();
        for (hit, s) in seen.iter().enumerate().filter(|(_, s)| s.scatter.is_lit()) {
            let samples = if s.by_chance { 1 } else { light.samples() };
            let seed = derive(s.seed, choice::LAMP + number);
            for k in 0..samples {
                let place = point(s.index.wrapping_mul(samples).wrapping_add(k), seed);
                let Some(arriving) = light.sample(s.surface.before, place) else { continue };
                let Illumination { to_light, distance, colour } = arriving;
                if to_light.dot(s.normal) <= 0.0 {
                    continue;
                }
                let brings = colour * s.scatter.respond(to_light) / f64::from(samples);
                if brings.max_element() > 0.0 {
                    wishes.push(Wish { hit, direction: to_light, distance, brings });
                    sent[hit].by_chance |= light.is_area();
                }
            }
        }
        for some in wishes.chunks(TOGETHER) {
            self.grant(asker, seen, some, light.casts_shadow(), sent);
        }
    }

    fn add_sky(&self, asker: &mut Asker, seen: &[Seen], sent: &mut [Sent]) {
        let Some(environment) = self.sky.environment() else { return };
        let mut wishes = Vec::new();
        for (hit, s) in seen.iter().enumerate().filter(|(_, s)| s.scatter.diffuse() != DVec3::ZERO) {
            let samples = if s.by_chance { 1 } else { environment.samples() };
            let seed = derive(s.seed, choice::SKY);
            for k in 0..samples {
                sent[hit].by_chance = true;
                let square = point(s.index.wrapping_mul(samples).wrapping_add(k), seed);
                let Some(look) = self.sky.look(s.normal, square) else { continue };
                let light = environment.light(s.surface.before, look.direction) * look.weight;
                let brings = light * s.scatter.diffuse() / f64::from(samples);
                wishes.push(Wish { hit, direction: look.direction, distance: f64::INFINITY, brings });
            }
        }
        for some in wishes.chunks(TOGETHER) {
            self.grant(asker, seen, some, true, sent);
        }
    }

    /// Adds what wishes bring, as far as nothing is in their way.
    fn grant(&self, asker: &mut Asker, seen: &[Seen], wishes: &[Wish], shadows: bool, sent: &mut [Sent]) {
        if !shadows {
            wishes.iter().for_each(|wish| sent[wish.hit].colour += wish.brings);
            return;
        }
        let rays: Vec<_> = wishes.iter().map(|w| (seen[w.hit].surface.before, w.direction)).collect();
        let distances: Vec<f64> = wishes.iter().map(|w| w.distance).collect();
        let blocked = self.prepared.blocked(asker, &rays, &distances);
        let free = wishes.iter().zip(&blocked).filter(|(_, blocked)| !**blocked);
        free.for_each(|(wish, _)| sent[wish.hit].colour += wish.brings);
        if self.lets_light_through {
            let dimmed: Vec<usize> = (0..wishes.len()).filter(|&i| blocked[i]).collect();
            let rays: Vec<_> = dimmed.iter().map(|&i| rays[i]).collect();
            let distances: Vec<f64> = dimmed.iter().map(|&i| distances[i]).collect();
            for (&i, left) in dimmed.iter().zip(self.left_after(asker, rays, distances)) {
                sent[wishes[i].hit].colour += wishes[i].brings * left;
            }
        }
    }

    /// What is left of the light that comes along rays, over these distances, through everything in their way.
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
            look.transmission * (1.0 - crate::bsdf::fresnel::at_normal(look.index))
        }
        Shading::BlinnPhong { .. } => look.transmission * (1.0 - look.reflection),
        Shading::Ggx { .. } => {
            let mirrored = crate::bsdf::fresnel::at_normal(look.index);
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
