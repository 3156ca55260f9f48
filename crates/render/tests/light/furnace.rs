//! In light that is the same everywhere, what neither absorbs nor loses light cannot be seen.

use crate::{ball, camera, colour, draw, even, layer, look, mean, pixels, settings};
use fieldstone_render::{RenderOptions, render};
use fieldstone_scene::{Appearance, Shading};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

fn microfacets(roughness: f64, metallic: f64, compensated: bool) -> Appearance {
    Appearance { shading: Shading::Ggx { compensated }, roughness, metallic, ..look() }
}

/// What the boundary mirrors of light that meets it at this cosine, for an index of η (Fresnel).
fn fresnel(cosine: f64, eta: f64) -> f64 {
    let beyond = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
    let (a, b) = (
        (eta * cosine - beyond) / (eta * cosine + beyond),
        (cosine - eta * beyond) / (cosine + eta * beyond),
    );
    0.5 * (a * a + b * b)
}

/// But for light that is still inside after the last bounce: what entered at the first, and was mirrored at all others.
#[test]
fn a_glass_ball_cannot_be_seen() {
    let glass = Appearance { transmission: 1.0, ..microfacets(0.0, 0.0, true) };
    let blinn = Appearance { transmission: 1.0, fresnel: true, ..look() };
    let seen_from = camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO);
    for (look, bounces) in [(glass, 64), (blinn, 32), (Appearance { index: 2.4, ..glass }, 64), (glass, 2)] {
        let drawn = draw(vec![ball(look)], seen_from, even(DVec3::ONE), settings(40, 1, bounces));
        assert!(drawn.1.stats.hits > 700);
        let mut whole = 0;
        for (x, y, pixel) in pixels(&drawn) {
            let (_, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let cosine = -DVec3::from_array(pixel.normal.map(f64::from)).dot(towards);
            let mirrored = fresnel(cosine, look.index);
            let inside = (1.0 - mirrored) * mirrored.powi(bounces as i32 - 1);
            let expected = if pixel.depth.is_finite() { 1.0 - inside } else { 1.0 };
            let error = (colour(&pixel) - DVec3::splat(expected)).abs().max_element();
            // Of rays fainter than 1/8192 some are followed for all, by chance.
            assert!(error < 2e-3 && pixel.alpha == 1.0, "{pixel:?} at {x}, {y} is not {expected}");
            whole += u32::from(expected > 0.9995);
        }
        assert!(whole > 1550 || bounces == 2, "{whole} of 1600");
    }
}

#[test]
fn a_white_matt_ball_cannot_be_seen() {
    let seen_from = camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO);
    for shading in [Shading::BlinnPhong { normalised: false }, Shading::BlinnPhong { normalised: true }] {
        let drawn = draw(
            vec![ball(Appearance { shading, ..look() })],
            seen_from,
            even(DVec3::ONE),
            settings(40, 1, 2),
        );
        for (.., pixel) in pixels(&drawn) {
            assert!((colour(&pixel) - DVec3::ONE).abs().max_element() < 1e-6, "{pixel:?}");
        }
    }
}

/// The directional albedo of metal that mirrors everything, by quadrature over the directions of light, from Smith's
/// formulas as Walter et al. (2007) and Heitz (2014) give them.
fn albedo(alpha: f64, cosine: f64) -> f64 {
    const SIDE: u32 = 1000;
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let lambda = |c: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 - c * c) / (c * c)).sqrt() - 1.0);
    let to_eye = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let mut sum = 0.0;
    for i in 0..SIDE * SIDE {
        let (z, turn) = (place(i / SIDE), TAU * place(i % SIDE));
        let radius = (1.0 - z * z).sqrt();
        let to_light = DVec3::new(radius * turn.cos(), radius * turn.sin(), z);
        let half = (to_light + to_eye).normalize();
        let spread = half.z * half.z * (alpha * alpha - 1.0) + 1.0;
        let facets = alpha * alpha / (PI * spread * spread);
        sum += facets / (4.0 * cosine * (1.0 + lambda(z) + lambda(cosine)));
    }
    sum * TAU / f64::from(SIDE * SIDE)
}

/// What a white surface with a normalised highlight sends back, by quadrature: the highlight takes its share of the light.
fn highlight_albedo(specular: f64, shininess: f64, cosine: f64) -> f64 {
    const SIDE: u32 = 600;
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let to_eye = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let scale = 1.0 / (1.0 + 1.08 * specular);
    let mut sum = 0.0;
    for i in 0..SIDE * SIDE {
        let (z, turn) = (place(i / SIDE), TAU * place(i % SIDE));
        let radius = (1.0 - z * z).sqrt();
        let to_light = DVec3::new(radius * turn.cos(), radius * turn.sin(), z);
        sum += (to_light + to_eye).normalize().z.powf(shininess) * z;
    }
    let highlight = (shininess + 8.0) / (8.0 * PI) * sum * TAU / f64::from(SIDE * SIDE);
    scale * (1.0 + specular * highlight)
}

#[test]
fn normalised_highlights_have_their_directional_albedo() {
    let shading = Shading::BlinnPhong { normalised: true };
    for (specular, shininess, cosine) in
        [(1.0, 5.0, 0.8), (3.0, 20.0, 0.5), (1.0, 80.0, 0.9), (0.5, 80.0, 0.3)]
    {
        let expected = highlight_albedo(specular, shininess, cosine);
        let found = floor(Appearance { shading, specular, shininess, ..look() }, cosine);
        assert!((found - expected).abs() < 5e-3, "{found} is not {expected} at {shininess}, {cosine}");
        assert!(expected <= 1.0, "no more light than there is: {expected}");
    }
    assert!(highlight_albedo(1.0, 9.0, 1.0) > 0.95, "the highlight has its share");
}

/// A floor, seen at this cosine against its normal.
fn floor(look: Appearance, cosine: f64) -> f64 {
    let to_eye = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let lens = fieldstone_scene::Projection::Orthographic { height: 0.5 };
    let seen_from = fieldstone_scene::Camera::look_at(20.0 * to_eye, DVec3::ZERO, DVec3::Y, lens);
    let floor = layer(4.0, -1.0, 0.0, look);
    mean(&draw(vec![floor], seen_from.expect("the camera is sound"), even(DVec3::ONE), settings(24, 16, 4)))
}

#[test]
fn rough_metal_has_its_directional_albedo() {
    for (roughness, cosine) in [(0.4f64, 0.9), (0.7, 0.5), (1.0, 0.7), (1.0, 0.3)] {
        let expected = albedo(roughness * roughness, cosine);
        let found = floor(microfacets(roughness, 1.0, false), cosine);
        // 9216 samples, evenly spread in each pixel.
        assert!((found - expected).abs() < 0.01, "{found} is not {expected} at {roughness}, {cosine}");
        let compensated = floor(microfacets(roughness, 1.0, true), cosine);
        assert!((compensated - 1.0).abs() < 0.01, "{compensated} at {roughness}, {cosine}");
    }
    assert!(albedo(1.0, 0.7) < 0.8, "without compensation light is lost");
}

#[test]
fn rough_white_plastic_and_glass_lose_little() {
    for roughness in [0.3, 0.8] {
        let plastic = floor(microfacets(roughness, 0.0, true), 0.6);
        assert!((plastic - 1.0).abs() < 0.01, "{plastic}");
        // What leaves the facets of glass sideways meets the layer's sides, which are far away.
        let frosted = Appearance { transmission: 1.0, ..microfacets(roughness, 0.0, true) };
        let seen_from = camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO);
        let drawn = draw(vec![ball(frosted)], seen_from, even(DVec3::ONE), settings(24, 16, 64));
        assert!((mean(&drawn) - 1.0).abs() < 0.01, "{}", mean(&drawn));
    }
}

#[test]
fn chance_does_not_depend_on_threads() {
    let (rough, seen_from) = (microfacets(0.5, 0.5, true), camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO));
    let (scene, _) = draw(vec![ball(rough)], seen_from, even(DVec3::ONE), settings(40, 4, 3));
    let with = |threads| {
        let options = RenderOptions { threads: Some(threads), ..RenderOptions::default() };
        render(&scene, &options).expect("threads start").film
    };
    assert!(with(1) == with(3));
}
