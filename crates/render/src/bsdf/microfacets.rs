//! Metal and dielectrics of microfacets (Walter, Marschner, Li and Torrance 2007), with their smooth limit.
//!
//! Single scattering loses what facets throw at each other. Compensated, the light of metals is scaled as E. Turquin
//! proposes (2019, eq. 16), of glass by what is missing to 1, and what a dielectric does not mirror is scattered evenly
//! below it, so that white surfaces lose nothing. The directional albedos that this needs are means over visible normals,
//! taken at each hit: no tables.

use crate::bsdf::ggx::Ggx;
use crate::bsdf::{Chance, Meeting, Onward, fresnel, mirror_ray, through_ray, tint};
use fieldstone_scene::{Appearance, Rgb};
use glam::{DMat3, DVec3, DVec4};
use std::f64::consts::PI;

/// Below this roughness a surface is smooth: its highlights are narrower than pixels.
const SMOOTH: f64 = 0.03;

/// The surface at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facets {
    meeting: Meeting,
    pub(crate) diffuse: Rgb,
    colour: Rgb,
    metallic: f64,
    /// The refractive index that decides how much is mirrored.
    eta: f64,
    /// What of the light that is not mirrored goes through.
    through: Rgb,
    rough: Option<Rough>,
}

/// What only rough surfaces have.
#[derive(Clone, Copy, Debug)]
struct Rough {
    ggx: Ggx,
    /// From the frame of the surface, in which z is the normal.
    world_from_surface: DMat3,
    /// The direction to the eye, in the frame of the surface.
    to_eye: DVec3,
    /// What light that is mirrored by a dielectric is multiplied by, for what facets throw at each other.
    dielectric_scale: f64,
    /// The same for metal.
    metal_scale: Rgb,
    /// The same for light that goes through.
    through_scale: f64,
}

impl Facets {
    pub(crate) fn new(look: &Appearance, meeting: &Meeting, compensated: bool) -> Self {
        let clear = (1.0 - look.metallic) * look.transmission;
        // What is opaque is seen from outside only, even where a ray comes from inside.
        let eta = if look.transmission > 0.0 { meeting.eta } else { look.index };
        let mut facets = Self {
            meeting: *meeting,
            diffuse: look.colour * ((1.0 - look.metallic) * (1.0 - look.transmission)),
            colour: look.colour,
            metallic: look.metallic,
            eta,
            through: tint(look.colour) * clear,
            rough: None,
        };
        if look.roughness < SMOOTH {
            facets.diffuse *= 1.0 - fresnel::dielectric(meeting.cosine(), eta);
        } else {
            facets.roughen(look.roughness, compensated, clear > 0.0);
        }
        facets
    }

    /// What is mirrored where light meets a facet at this cosine.
    fn mirrored(&self, cosine: f64) -> Rgb {
        let scales = self.rough.map(|rough| (rough.dielectric_scale, rough.metal_scale));
        let (of_dielectric, of_metal) = scales.unwrap_or((1.0, DVec3::ONE));
        let dielectric = DVec3::splat(fresnel::dielectric(cosine, self.eta) * of_dielectric);
        if self.metallic > 0.0 {
            dielectric.lerp(fresnel::schlick(self.colour, cosine) * of_metal, self.metallic)
        } else {
            dielectric
        }
    }

    fn roughen(&mut self, roughness: f64, compensated: bool, clear: bool) {
        let normal = self.meeting.normal;
        let (across, along) = normal.any_orthonormal_pair();
        let world_from_surface = DMat3::from_cols(across, along, normal);
        let to_eye = world_from_surface.transpose() * -self.meeting.direction;
        let to_eye = DVec3::new(to_eye.x, to_eye.y, to_eye.z.max(1e-4)).normalize();
        let ggx = Ggx { alpha: roughness * roughness };
        let mut rough = Rough {
            ggx,
            world_from_surface,
            to_eye,
            dielectric_scale: 1.0,
            metal_scale: DVec3::ONE,
            through_scale: 1.0,
        };
        // Means over facets: what a dielectric mirrors, what of that gets out, what goes through and gets out, and what
        // of all gets out where all is mirrored.
        let means = ggx.mean_over_visible(to_eye, |facet| {
            let mirrored = fresnel::dielectric(to_eye.dot(facet), self.eta);
            let out = ggx.mirrored_share(to_eye, facet);
            let through = if clear { (1.0 - mirrored) * self.through_share(&rough, facet) } else { 0.0 };
            DVec4::new(mirrored, mirrored * out, through, out)
        });
        let mut kept = means.x;
        if compensated {
            let albedo = means.w.max(1e-3);
            let lost = (1.0 - albedo) / albedo;
            rough.metal_scale = DVec3::ONE + self.colour * lost;
            rough.dielectric_scale = 1.0 + fresnel::at_normal(self.eta) * lost;
            if clear {
                rough.through_scale = 1.0 / (means.y + means.z).max(1e-3);
                rough.dielectric_scale = rough.through_scale;
            }
            kept = means.y * rough.dielectric_scale;
        }
        self.diffuse *= (1.0 - kept).max(0.0);
        self.rough = Some(rough);
    }

    /// What reaches the other side of the light that a visible facet lets through.
    fn through_share(&self, rough: &Rough, facet: DVec3) -> f64 {
        let direction = Meeting { direction: -rough.to_eye, ..self.meeting }.beyond(facet);
        direction.filter(|to| to.z < 0.0).map_or(0.0, |to| rough.ggx.seen_from_too(rough.to_eye, to))
    }

    pub(crate) fn respond(&self, to_light: DVec3) -> Rgb {
        let diffuse = self.diffuse * to_light.dot(self.meeting.normal);
        let Some(rough) = &self.rough else { return diffuse };
        let to_light = rough.world_from_surface.transpose() * to_light;
        let half = (to_light + rough.to_eye).normalize_or(DVec3::Z);
        let facets = rough.ggx.distribution(half) * rough.ggx.seen_from_both(rough.to_eye, to_light);
        let mirrored = self.mirrored(rough.to_eye.dot(half));
        diffuse + mirrored * (PI * facets / (4.0 * rough.to_eye.z))
    }

    pub(crate) fn onward(&self, chance: Chance) -> [Option<Onward>; 2] {
        let Some(rough) = &self.rough else {
            let mirrored = self.mirrored(self.meeting.cosine());
            let not_mirrored = 1.0 - fresnel::dielectric(self.meeting.cosine(), self.eta);
            let through = self.through * not_mirrored;
            let refracted = (through.max_element() > 0.0).then(|| through_ray(&self.meeting, through));
            return [Some(mirror_ray(&self.meeting, mirrored)), refracted.flatten()];
        };
        // What goes through needs all facets.
        let (facet, part) = match self.through == DVec3::ZERO {
            true => rough.ggx.mirroring_normal(rough.to_eye, chance.facet),
            false => (rough.ggx.visible_normal(rough.to_eye, chance.facet), 1.0),
        };
        let cosine = rough.to_eye.dot(facet);
        let mirrored = self.mirrored(cosine) * part;
        let not_mirrored = 1.0 - fresnel::dielectric(cosine, self.eta);
        let through = self.through * (not_mirrored * rough.through_scale);
        let (a, b) = (mirrored.max_element(), through.max_element());
        let mirrors = a / (a + b).max(f64::MIN_POSITIVE);
        let chosen = if chance.kind < mirrors {
            let to = 2.0 * cosine * facet - rough.to_eye;
            Onward { direction: to, weight: mirrored / mirrors, through: false, rough: true }
        } else {
            let to = Meeting { direction: -rough.to_eye, ..self.meeting }.beyond(facet);
            let weight = through / (1.0 - mirrors).max(f64::MIN_POSITIVE);
            Onward { direction: to.unwrap_or(DVec3::Z), weight, through: true, rough: true }
        };
        [self.leave(rough, chosen), None]
    }

    /// Whether the ray onward is chosen by chance.
    pub(crate) fn is_rough(&self) -> bool {
        self.rough.is_some()
    }

    /// A ray from a facet into the world, unless another facet is in its way.
    fn leave(&self, rough: &Rough, chosen: Onward) -> Option<Onward> {
        let to = chosen.direction;
        let weight = chosen.weight * rough.ggx.seen_from_too(rough.to_eye, to);
        let direction = (rough.world_from_surface * to).try_normalize()?;
        ((to.z < 0.0) == chosen.through && to.z != 0.0).then_some(Onward { direction, weight, ..chosen })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{at_height, point};
    use fieldstone_scene::Shading;
    use std::f64::consts::TAU;

    fn look(roughness: f64, metallic: f64, transmission: f64) -> Appearance {
        let shading = Shading::Ggx { compensated: true };
        Appearance { shading, colour: DVec3::ONE, roughness, metallic, transmission, ..Appearance::default() }
    }

    fn meeting(cosine: f64, eta: f64) -> Meeting {
        Meeting { direction: -at_height(cosine, 0.3), normal: DVec3::Z, eta, thin: false }
    }

    /// All that comes back of a light of 1 from everywhere: by the rays that are followed, and scattered.
    fn albedo(facets: &Facets) -> f64 {
        const RAYS: u32 = 1 << 14;
        let chance = |i: u32| Chance { facet: point(i, 17), kind: point(i, 23).0 };
        let rays = (0..RAYS).flat_map(|i| facets.onward(chance(i))).flatten();
        rays.map(|ray| ray.weight.x).sum::<f64>() / f64::from(RAYS) + facets.diffuse.x
    }

    #[test]
    fn compensated_white_surfaces_send_back_all_light() {
        for roughness in [0.0, 0.2, 0.5, 0.8, 1.0] {
            for cosine in [1.0, 0.7, 0.3, 0.1] {
                for (metallic, transmission, eta) in [
                    (1.0, 0.0, 1.5),
                    (0.0, 0.0, 1.5),
                    (0.0, 1.0, 1.5),
                    (0.0, 1.0, 1.0 / 1.5),
                    (0.4, 0.3, 1.5),
                ] {
                    let bare = look(roughness, metallic, transmission);
                    let all = albedo(&Facets::new(&bare, &meeting(cosine, eta), true));
                    // A rule of 128 points stands behind the scale: 1 %, where total reflection begins abruptly more.
                    let error = if eta < 1.0 { 0.015 } else { 0.01 };
                    assert!(
                        (all - 1.0).abs() < error,
                        "{all}: {roughness} {metallic} {transmission} {eta} {cosine}"
                    );
                }
            }
        }
        let single = albedo(&Facets::new(&look(1.0, 1.0, 0.0), &meeting(0.7, 1.5), false));
        assert!(single < 0.8, "without compensation, rough metal is dark: {single}");
    }

    /// The light of lamps from everywhere is that of rays to everywhere: the density of the rays is the right one.
    #[test]
    fn lamps_and_rays_agree() {
        const SIDE: u32 = 500;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        for (roughness, metallic) in [(0.4, 1.0), (0.7, 0.0), (1.0, 0.5)] {
            for cosine in [0.9, 0.4] {
                let facets = Facets::new(&look(roughness, metallic, 0.0), &meeting(cosine, 1.5), true);
                let lamps = (0..SIDE * SIDE).map(|i| at_height(place(i / SIDE), place(i % SIDE)));
                let lit = lamps.map(|l| facets.respond(l).x).sum::<f64>();
                let lit = lit * TAU / f64::from(SIDE * SIDE) / PI;
                let followed = albedo(&facets);
                assert!(
                    (lit - followed).abs() < 5e-3,
                    "{roughness}, {metallic}, {cosine}: {lit}, {followed}"
                );
            }
        }
    }

    #[test]
    fn smooth_glass_branches_as_fresnel_says() {
        let glass = Facets::new(&look(0.0, 0.0, 1.0), &meeting(1.0, 1.5), true);
        let [Some(mirror), Some(through)] = glass.onward(Chance { facet: (0.0, 0.0), kind: 0.0 }) else {
            panic!("two rays");
        };
        assert!((mirror.weight.x - 0.04).abs() < 1e-12 && (through.weight.x - 0.96).abs() < 1e-12);
        assert!((mirror.direction - DVec3::Z).length() < 1e-12 && through.through && !mirror.through);
        let total = Facets::new(&look(0.0, 0.0, 1.0), &meeting(0.5, 1.0 / 1.5), true);
        assert!(matches!(total.onward(Chance { facet: (0.0, 0.0), kind: 0.9 }), [Some(_), None]));
    }

    #[test]
    fn metals_are_coloured_and_pale_at_grazing_angles() {
        let gold = Appearance { colour: DVec3::new(1.0, 0.7, 0.3), ..look(0.0, 1.0, 0.0) };
        let mirrored = |cosine: f64| {
            let [mirror, _] = Facets::new(&gold, &meeting(cosine, 1.5), true)
                .onward(Chance { facet: (0.0, 0.0), kind: 0.0 });
            mirror.expect("metal mirrors").weight
        };
        assert!((mirrored(1.0) - gold.colour).length() < 1e-12);
        assert!((mirrored(0.0) - DVec3::ONE).length() < 1e-12);
    }
}
