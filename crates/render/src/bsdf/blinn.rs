//! Blinn-Phong (Blinn 1977) with a mirror and a boundary that lets light through.

use crate::bsdf::{Meeting, Onward, fresnel, mirror_ray, through_ray, tint};
use crate::sampling::at_height;
use fieldstone_scene::{Appearance, Rgb};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A little more than what highlights of the form (n + 8)/8π (n·h)ⁿ send back at most of the light from one direction,
/// over all angles and exponents from 1 on: 1.075, at a right angle with n ≈ 9.
const BRIGHTEST_HIGHLIGHT: f64 = 1.08;

/// The surface at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blinn {
    meeting: Meeting,
    pub(crate) diffuse: Rgb,
    specular: f64,
    shininess: f64,
    mirrored: f64,
    through: Rgb,
    normalised: bool,
}

/// A normalised highlight: what of it reflects the light from all around.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Highlight {
    normal: DVec3,
    to_eye: DVec3,
    shininess: f64,
    /// The brightest that it makes a lamp.
    brightest: f64,
    /// How many directions of all it is given.
    share: f64,
}

impl Blinn {
    /// Of the light, the share `transmission` meets a clear boundary: it is mirrored there or goes through. The rest meets
    /// an opaque one: it is mirrored or scattered. Mirrored is `reflection`; where `fresnel` is set, Schlick's formula from
    /// there on the opaque share and Fresnel's own on the clear one. Under total reflection, nothing goes through.
    /// Highlights come on top, as they do in the original; normalised, they and what is scattered are scaled so that no
    /// more is sent back than arrives.
    pub(crate) fn new(look: &Appearance, meeting: &Meeting, normalised: bool) -> Self {
        let cosine = meeting.cosine();
        let opaque = match look.fresnel {
            true => fresnel::schlick(DVec3::splat(look.reflection), cosine).x,
            false => look.reflection,
        };
        let exact = fresnel::dielectric(cosine, meeting.eta);
        let clear = if look.fresnel || exact == 1.0 { exact } else { look.reflection };
        let mirrored = (1.0 - look.transmission) * opaque + look.transmission * clear;
        let through = look.transmission * (1.0 - clear);
        let scattered = (1.0 - look.transmission) * (1.0 - opaque);
        let (mut diffuse, mut specular) = (look.colour * scattered, look.specular);
        if normalised {
            let most = diffuse.max_element() + specular * BRIGHTEST_HIGHLIGHT;
            let room = (1.0 - mirrored - through).max(0.0);
            let scale = if most > room { room / most } else { 1.0 };
            diffuse *= scale;
            // A white, matt surface sends 1/π of the light of a lamp into each direction: relative to that, 1/8π is 1/8.
            specular *= scale * (look.shininess + 8.0) / 8.0;
        }
        let through = tint(look.colour) * through;
        Self {
            meeting: *meeting,
            diffuse,
            specular,
            shininess: look.shininess,
            mirrored,
            through,
            normalised,
        }
    }

    pub(crate) fn respond(&self, to_light: DVec3) -> Rgb {
        let normal = self.meeting.normal;
        let cosine = to_light.dot(normal);
        let half = (to_light - self.meeting.direction).normalize_or_zero();
        let highlight = self.specular * half.dot(normal).max(0.0).powf(self.shininess);
        self.diffuse * cosine + DVec3::splat(highlight * cosine.min(1.0))
    }

    /// The highlight that reflects environments. Those of the original, which are lamps alone, do not.
    pub(crate) fn highlight(&self) -> Option<Highlight> {
        let made = Highlight {
            normal: self.meeting.normal,
            to_eye: -self.meeting.direction,
            shininess: self.shininess,
            brightest: self.specular,
            share: 0.0,
        };
        let albedo = made.albedo();
        let share = albedo / (albedo + self.diffuse.max_element());
        (self.normalised && albedo > 0.0).then_some(Highlight { share, ..made })
    }

    pub(crate) fn onward(&self) -> [Option<Onward>; 2] {
        let mirror = (self.mirrored > 0.0).then(|| mirror_ray(&self.meeting, DVec3::splat(self.mirrored)));
        let through = self.through.max_element() > 0.0;
        [mirror, through.then(|| through_ray(&self.meeting, self.through)).flatten()]
    }
}

impl Highlight {
    /// About what it sends back of light that comes evenly from everywhere.
    pub(crate) fn albedo(&self) -> f64 {
        self.brightest * 8.0 / (self.shininess + 8.0)
    }

    /// How many directions of all are best chosen by its shape, from 0 to 1.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// What is seen if the light of a lamp comes from `to_light`, as [`Blinn::respond`] has it.
    pub(crate) fn respond(&self, to_light: DVec3) -> f64 {
        let half = (to_light + self.to_eye).normalize_or_zero();
        let bright = half.dot(self.normal).max(0.0).powf(self.shininess);
        self.brightest * bright * to_light.dot(self.normal).clamp(0.0, 1.0)
    }

    /// A direction by its shape: that in which a facet mirrors whose normal h has the density (n + 1)/2π (n·h)ⁿ. None
    /// where the facet is turned away from the eye.
    pub(crate) fn direction(&self, u: f64, v: f64) -> Option<DVec3> {
        let facet = at_height(u.powf(1.0 / (self.shininess + 1.0)), v);
        let (across, along) = self.normal.any_orthonormal_pair();
        let half = DMat3::from_cols(across, along, self.normal) * facet;
        let cosine = half.dot(self.to_eye);
        (cosine > 0.0).then(|| (2.0 * cosine * half - self.to_eye).try_normalize())?
    }

    /// The density of [`direction`](Self::direction) per solid angle.
    pub(crate) fn density(&self, direction: DVec3) -> f64 {
        let half = (direction + self.to_eye).normalize_or_zero();
        let facets =
            half.dot(self.normal).max(0.0).powf(self.shininess) * (self.shininess + 1.0) / (2.0 * PI);
        facets / (4.0 * half.dot(self.to_eye)).max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::point;
    use fieldstone_scene::Shading;
    use std::f64::consts::TAU;

    fn look(specular: f64, shininess: f64) -> Appearance {
        Appearance { colour: DVec3::ONE, specular, shininess, ..Appearance::default() }
    }

    fn meeting(cosine: f64, eta: f64) -> Meeting {
        Meeting { direction: -at_height(cosine, 0.0), normal: DVec3::Z, eta, thin: false }
    }

    /// All that is sent back of light from one direction, by quadrature: reciprocity lets it be summed over lamps.
    fn albedo(surface: &Blinn) -> f64 {
        const SIDE: u32 = 300;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        let lamps = (0..SIDE * SIDE).map(|i| at_height(place(i / SIDE), place(i % SIDE)));
        let scattered = lamps.map(|l| surface.respond(l).x).sum::<f64>() * TAU / f64::from(SIDE * SIDE) / PI;
        scattered + surface.mirrored + surface.through.x
    }

    #[test]
    fn normalised_surfaces_never_send_back_more_than_arrives() {
        for shininess in [1.0, 3.0, 9.0, 30.0, 200.0] {
            for cosine in [1.0, 0.97, 0.8, 0.5, 0.1] {
                for (specular, reflection, transmission) in
                    [(1.0, 0.0, 0.0), (5.0, 0.0, 0.0), (0.3, 0.4, 0.0), (1.0, 0.1, 0.5), (0.0, 0.0, 0.0)]
                {
                    let bare = look(specular, shininess);
                    let bare = Appearance { reflection, transmission, fresnel: true, ..bare };
                    let all = albedo(&Blinn::new(&bare, &meeting(cosine, 1.5), true));
                    assert!(all <= 1.0 + 1e-3, "{all}: {bare:?} at {cosine}");
                    // Without highlights, and with white matt surfaces, nothing is lost either.
                    assert!(specular > 0.0 || (all - 1.0).abs() < 1e-3, "{all}");
                }
            }
        }
        // The quadrature can see too much: the original does send back more.
        let original = Blinn::new(&look(1.0, 9.0), &meeting(1.0, 1.5), false);
        assert!(albedo(&original) > 1.2);
    }

    #[test]
    fn highlights_keep_their_light_whatever_their_sharpness() {
        let dark = |shininess| Appearance { colour: DVec3::ZERO, ..look(0.5, shininess) };
        for shininess in [10.0, 50.0, 300.0] {
            // In closed form at a right angle: (n + 8) (2/(n + 4) − 1/(n + 2)), but for 2^(−n/2).
            let n: f64 = shininess;
            let tail = |k: f64| 1.0 - 0.5f64.powf(0.5 * (n + k));
            let expected = 0.5 * (n + 8.0) * (2.0 * tail(4.0) / (n + 4.0) - tail(2.0) / (n + 2.0));
            let found = albedo(&Blinn::new(&dark(n), &meeting(1.0, 1.5), true));
            assert!((found - expected).abs() < 2e-3, "{found} is not {expected}");
        }
    }

    /// The mean of light that is 1 all around, weighted by the density, is that of quadrature; and the density is one.
    #[test]
    fn highlights_are_sampled_by_their_density() {
        const SAMPLES: u32 = 1 << 14;
        const SIDE: u32 = 600;
        for (shininess, cosine) in [(1.0, 0.9), (12.0, 0.4), (60.0, 0.8), (60.0, 0.4)] {
            let dark = Appearance { colour: DVec3::ZERO, ..look(0.7, shininess) };
            let surface = Blinn::new(&dark, &meeting(cosine, 1.5), true);
            let highlight = surface.highlight().expect("normalised and bright");
            let seen = (0..SAMPLES).filter_map(|i| highlight.direction(point(i, 5).0, point(i, 5).1));
            let above = seen.filter(|to| to.z > 0.0).map(|to| highlight.respond(to) / highlight.density(to));
            let found = above.sum::<f64>() / (PI * f64::from(SAMPLES));
            let expected = albedo(&surface);
            assert!((found - expected).abs() < 5e-3, "{found} is not {expected}: {shininess}, {cosine}");
            // Facets that are turned away from the eye mirror nothing: all others are in the density.
            let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
            let sphere = (0..SIDE * SIDE).map(|i| at_height(2.0 * place(i / SIDE) - 1.0, place(i % SIDE)));
            let whole =
                sphere.map(|d| highlight.density(d)).sum::<f64>() * 2.0 * TAU / f64::from(SIDE * SIDE);
            let visible =
                (0..SAMPLES).filter(|&i| highlight.direction(point(i, 5).0, point(i, 5).1).is_some());
            let visible = visible.count() as f64 / f64::from(SAMPLES);
            assert!((whole - visible).abs() < 0.01, "{whole} is not {visible}: {shininess}, {cosine}");
        }
        assert!(Blinn::new(&look(1.0, 9.0), &meeting(1.0, 1.5), false).highlight().is_none());
    }

    #[test]
    fn what_is_mirrored_follows_its_formulas() {
        let mirror = Appearance { reflection: 0.3, fresnel: true, ..look(0.0, 1.0) };
        let at = |look: &Appearance, cosine: f64, eta: f64| Blinn::new(look, &meeting(cosine, eta), false);
        assert!((at(&mirror, 1.0, 1.5).mirrored - 0.3).abs() < 1e-12);
        assert!((at(&mirror, 0.0, 1.5).mirrored - 1.0).abs() < 1e-12);
        assert!((at(&mirror, 0.5, 1.5).mirrored - (0.3 + 0.7 / 32.0)).abs() < 1e-12);
        let glass = Appearance { transmission: 1.0, ..mirror };
        assert!((at(&glass, 1.0, 1.5).mirrored - 0.04).abs() < 1e-12);
        let plain = Appearance { transmission: 1.0, fresnel: false, reflection: 0.1, ..mirror };
        assert!((at(&plain, 0.5, 1.5).through.x - 0.9).abs() < 1e-12);
        // From inside, beyond the critical angle.
        let total = at(&plain, 0.5, 1.0 / 1.5);
        assert_eq!((total.mirrored, total.through), (1.0, DVec3::ZERO));
        assert!(matches!(total.onward(), [Some(_), None]));
        assert_eq!(look(0.0, 1.0).shading, Shading::BlinnPhong { normalised: false });
    }
}
