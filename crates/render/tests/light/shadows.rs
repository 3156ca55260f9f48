//! Soft and coloured shadows, visible lamps, and what a lens makes unsharp.

use crate::{ball, camera, colour, dark, draw, layer, look, pixels, settings, solid};
use fieldstone_scene::{Aperture, Appearance, Light, Lighting};
use glam::DVec3;

const LAMP: DVec3 = DVec3::new(0.0, 0.0, 3.0);
const RADIUS: f64 = 0.4;

fn lamp() -> Light {
    Light::sphere(LAMP, RADIUS, DVec3::splat(9.0)).expect("the light is sound")
}

/// A half-plane at the height 1, as thick as a hair, above a floor at 0, under a lamp at the height 3.
#[test]
fn the_penumbra_of_an_edge_is_as_wide_as_geometry_says() {
    let screen = solid(5.0, look(), |g| {
        let [x, _, z] = crate::point(g);
        let (one, hair) = (g.constant(1.0), g.constant(1e-3));
        let from_one = g.sub(z, one);
        let apart = g.abs(from_one);
        let thin = g.sub(apart, hair);
        g.max(x, thin)
    });
    let floor = layer(5.0, -0.1, 0.0, look());
    let lighting = Lighting { lights: vec![lamp().with_samples(16).expect("16 is sound")], ..dark() };
    // From the side, so that pixels are narrow across the edge.
    let eye = camera(DVec3::new(0.3, -7.0, 0.9), DVec3::new(0.0, 0.0, 0.0));
    let drawn = draw(vec![screen, floor], eye, lighting, settings(96, 4, 0));
    let (mut umbra, mut light, mut between) = (0, 0, 0);
    for (x, y, pixel) in pixels(&drawn).into_iter().filter(|(.., p)| p.part == 1.0 && p.normal[2] > 0.99) {
        let (origin, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let place = origin + f64::from(pixel.depth) * towards;
        if place.x.abs() > 2.0 || place.y.abs() > 1.0 {
            continue;
        }
        // The plane through the place and the edge, and how far the lamp's centre is on its lit side.
        let normal = DVec3::new(1.0, 0.0, place.x).normalize();
        let side = (LAMP - place).dot(normal) / RADIUS;
        let to_lamp = LAMP - place;
        let all = 9.0 * to_lamp.normalize().z / to_lamp.length_squared();
        let part = f64::from(pixel.colour[0]) / all;
        match side {
            // A little beyond, since pixels have a size.
            s if s < -1.3 => {
                assert_eq!(part, 0.0, "at {place}");
                umbra += 1;
            }
            s if s > 1.3 => {
                assert!((part - 1.0).abs() < 0.03, "{part} at {place}");
                light += 1;
            }
            s if s.abs() < 0.9 => {
                // The part of a disc on one side of a chord.
                let expected = 1.0 - (s.acos() - s * (1.0 - s * s).sqrt()) / std::f64::consts::PI;
                assert!((part - expected).abs() < 0.12, "{part} is not {expected} at {place}");
                between += 1;
            }
            _ => {}
        }
    }
    assert!(umbra > 100 && light > 100 && between > 50, "{umbra} {light} {between}");
}

#[test]
fn shadows_of_clear_and_half_transparent_things_are_coloured() {
    let tinted = DVec3::new(0.25, 1.0, 0.0);
    let filter = Appearance { colour: tinted, transmission: 1.0, index: 1.0, ..look() };
    let veil = Appearance { opacity: 0.25, ..look() };
    let grey = Appearance { absorption: DVec3::splat(3.0), ..Appearance { colour: DVec3::ONE, ..filter } };
    // Each body has two surfaces; a colour counts once for both.
    let cases = [
        (filter, tinted),
        (veil, DVec3::splat(0.75 * 0.75)),
        (grey, DVec3::splat((-0.3f64).exp())),
        (look(), DVec3::ZERO),
    ];
    let sun = Light::directional(DVec3::Z, DVec3::ONE).expect("the light is sound");
    for (look_above, expected) in cases {
        let solids = vec![layer(5.0, 0.8, 0.9, look_above), layer(5.0, -0.1, 0.0, look())];
        let lighting = Lighting { lights: vec![sun], ..dark() };
        let eye = camera(DVec3::new(4.0, 0.0, 0.4), DVec3::new(0.0, 0.0, 0.0));
        let drawn = draw(solids, eye, lighting, settings(24, 1, 4));
        let floor = pixels(&drawn).into_iter().filter(|(.., p)| p.part == 1.0 && p.normal[2] > 0.99);
        let found: Vec<DVec3> = floor.map(|(.., p)| colour(&p)).collect();
        assert!(found.len() > 100 && found.iter().all(|c| (*c - expected).length() < 1e-5), "{expected}");
    }
}

#[test]
fn lamps_are_seen_if_they_are_visible() {
    let mirror = Appearance { colour: DVec3::ZERO, reflection: 0.5, ..look() };
    for visible in [false, true] {
        let lighting = Lighting { lights: vec![lamp().with_visible(visible)], ..dark() };
        let eye = camera(DVec3::new(0.0, -6.0, 3.0), LAMP);
        let drawn = draw(vec![layer(5.0, -0.1, 0.0, mirror)], eye, lighting.clone(), settings(33, 1, 2));
        let middle = drawn.1.film.pixel(16, 16).expect("the middle");
        let radiance = 9.0 / (RADIUS * RADIUS);
        let expected = if visible { (radiance, 1.0) } else { (0.0, 0.0) };
        assert!(
            (f64::from(middle.colour[0]) - expected.0).abs() < 1e-4 && f64::from(middle.alpha) == expected.1
        );
        // Its image in the floor, from where angles are equal.
        let eye = camera(DVec3::new(0.0, -4.0, 3.0), DVec3::new(0.0, -2.0, 0.0));
        let drawn = draw(vec![layer(5.0, -0.1, 0.0, mirror)], eye, lighting, settings(33, 1, 2));
        let middle = drawn.1.film.pixel(16, 16).expect("the middle");
        assert!((f64::from(middle.colour[0]) - 0.5 * expected.0).abs() < 1e-4, "{middle:?}");
    }
}

#[test]
fn a_lens_is_sharp_where_it_is_focused() {
    let lighting = || Lighting { ambient: DVec3::ONE, ..dark() };
    let partly = |focus_distance: f64| {
        let eye = camera(DVec3::new(0.0, -8.0, 0.0), DVec3::ZERO);
        let eye = eye.with_aperture(Aperture { radius: 0.2, focus_distance }).expect("the lens is sound");
        let drawn = draw(vec![ball(look())], eye, lighting(), settings(64, 16, 0));
        let alphas = pixels(&drawn).into_iter().map(|(.., p)| p.alpha).filter(|a| *a > 0.0 && *a < 1.0);
        let hits = drawn.1.stats.hits;
        assert!(hits > 500, "the layers are those of a pinhole: {hits}");
        alphas.count()
    };
    let (sharp, before) = (partly(8.0), partly(4.0));
    // The circle of confusion at 8 of a lens that is focused at 4 is 0.4 wide, a sixth of the picture's half.
    assert!(sharp < 250 && before > 2 * sharp, "{sharp} sharp, {before} not");
}
