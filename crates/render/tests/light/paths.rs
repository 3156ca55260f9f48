//! Where light goes: refraction, total reflection, mirrors, transparent things in a row.

use crate::{ball, camera, colour, dark, draw, even, layer, look, pixels, settings};
use fieldstone_scene::{Appearance, Environment, Face, Image, Lighting, Surroundings};
use glam::DVec3;
use std::sync::Arc;

const SIDE: u32 = 256;

/// An environment whose colours are directions: on each face, red grows to the right, green downwards, and blue is the
/// number of the face and one.
fn compass() -> Lighting {
    let face = |number: u32| {
        let place = |i: u32| (i as f32 + 0.5) / SIDE as f32;
        let pixels = (0..SIDE * SIDE).map(|i| [place(i % SIDE), place(i / SIDE), number as f32 + 1.0]);
        Face::Picture(Arc::new(Image::new(SIDE, SIDE, pixels.collect()).expect("the size is right")))
    };
    let cube = Surroundings::Cube(Arc::new(std::array::from_fn(|i| face(i as u32))));
    Lighting { environment: Some(Environment::new(cube).expect("the light is sound")), ..dark() }
}

/// The direction that a colour of the compass stands for; none near the edges of faces, where pictures end.
fn direction(colour: DVec3) -> Option<DVec3> {
    let (right, down) = (2.0 * colour.x - 1.0, 2.0 * colour.y - 1.0);
    let limit = 1.0 - 2.0 / f64::from(SIDE);
    let direction = match colour.z.round() as u32 {
        1 => DVec3::new(1.0, -down, right),
        2 => DVec3::new(-1.0, -down, -right),
        3 => DVec3::new(right, 1.0, -down),
        4 => DVec3::new(right, -1.0, down),
        5 => DVec3::new(right, -down, -1.0),
        _ => DVec3::new(-right, -down, 1.0),
    };
    (right.abs() < limit && down.abs() < limit).then(|| direction.normalize())
}

/// Clear without a mirror: one ray goes through.
fn clear(index: f64) -> Appearance {
    Appearance { transmission: 1.0, index, ..look() }
}

fn refract(direction: DVec3, normal: DVec3, eta: f64) -> DVec3 {
    let across = (direction - direction.dot(normal) * normal) / eta;
    across - (1.0 - across.length_squared()).sqrt() * normal
}

#[test]
fn light_goes_through_a_ball_by_snells_law() {
    let drawn = draw(
        vec![ball(clear(1.5))],
        camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO),
        compass(),
        settings(48, 1, 4),
    );
    let mut compared = 0;
    for (x, y, pixel) in pixels(&drawn) {
        let (origin, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let nearest = -origin.dot(towards);
        let half = 1.0 - (origin + nearest * towards).length_squared();
        let expected = if half > 0.0 {
            let entry = origin + (nearest - half.sqrt()) * towards;
            let inside = refract(towards, entry, 1.5);
            let exit = entry - 2.0 * entry.dot(inside) * inside;
            refract(inside, -exit, 1.0 / 1.5)
        } else {
            towards
        };
        // At the rim the direction changes as fast as one likes.
        let Some(found) = direction(colour(&pixel)).filter(|_| half.abs() > 1e-2) else { continue };
        assert!((found - expected).length() < 1e-5, "{found} is not {expected} at {x}, {y}");
        compared += u32::from(half > 0.0);
    }
    assert!(compared > 900, "{compared}");
}

/// From an eye inside of a ball, at 0.8 of its radius: light arrives by Snell's law, or never.
#[test]
fn light_is_trapped_by_total_reflection() {
    let eye = DVec3::new(0.8, 0.0, 0.0);
    let (mut trapped, mut free) = (0, 0);
    for target in [DVec3::Y, DVec3::new(0.9, 0.5, 0.1), DVec3::new(0.0, 0.3, 0.2)] {
        let drawn = draw(vec![ball(clear(1.5))], camera(eye, target), compass(), settings(32, 1, 24));
        for (x, y, pixel) in pixels(&drawn) {
            let (origin, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let sine = origin.cross(towards).length() * 1.5;
            if (sine - 1.0).abs() < 1e-3 {
                continue;
            }
            if sine > 1.0 {
                assert_eq!(colour(&pixel), DVec3::ZERO, "a sine of {sine} beyond");
                trapped += 1;
                continue;
            }
            let nearest = -origin.dot(towards);
            let half = (1.0 - (origin + nearest * towards).length_squared()).sqrt();
            let expected = refract(towards, -(origin + (nearest + half) * towards), 1.0 / 1.5);
            let Some(found) = direction(colour(&pixel)) else { continue };
            assert!((found - expected).length() < 1e-5, "{found} is not {expected}");
            free += 1;
        }
    }
    assert!(trapped > 500 && free > 500, "{trapped} trapped, {free} free");
}

/// Two mirrors that shine a little, face to face: each bounce adds one image.
#[test]
fn bounces_are_counted_between_two_mirrors() {
    let mirror = Appearance { colour: DVec3::ZERO, reflection: 0.75, emission: DVec3::splat(0.1), ..look() };
    let mirrors = || vec![layer(40.0, 1.0, 1.2, mirror), layer(40.0, -1.2, -1.0, mirror)];
    for bounces in [0, 1, 2, 7, 16] {
        let eye = camera(DVec3::new(0.0, 0.0, -0.3), DVec3::new(0.05, 0.0, 1.0));
        let drawn = draw(mirrors(), eye, dark(), settings(16, 1, bounces));
        let expected: f64 = (0..=bounces).map(|k| 0.1 * 0.75f64.powi(k as i32)).sum();
        for (.., pixel) in pixels(&drawn) {
            assert!((f64::from(pixel.colour[0]) - expected).abs() < 1e-6, "{pixel:?} after {bounces}");
        }
    }
}

/// Two layers of which half is there, in ambient light: their four surfaces in the order of their depth.
#[test]
fn transparent_things_are_seen_in_the_order_of_their_depth() {
    let (red, green) = (DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.0, 0.6, 0.3));
    let half = |colour| Appearance { colour, opacity: 0.5, ..look() };
    let layers = || vec![layer(4.0, 0.5, 1.0, half(red)), layer(4.0, -1.0, -0.5, half(green))];
    let lighting = Lighting { ambient: DVec3::ONE, ..dark() };
    let [first, second, third, fourth] = [0.5, 0.25, 0.125, 0.0625];
    for (height, near, far) in [(9.0, red, green), (-9.0, green, red)] {
        let eye = camera(DVec3::new(0.5, 0.2, height), DVec3::ZERO);
        let drawn = draw(layers(), eye, lighting.clone(), settings(16, 1, 0));
        for (.., pixel) in pixels(&drawn) {
            let expected = near * (first + second) + far * (third + fourth);
            assert!((colour(&pixel) - expected).length() < 1e-6, "{pixel:?} from {height}");
            assert!((pixel.alpha - 0.9375).abs() < 1e-6);
        }
    }
}

#[test]
fn light_fades_by_the_length_of_its_way_inside() {
    let absorption = DVec3::new(0.0, 0.5, 2.0);
    let tinted = Appearance { absorption, ..clear(1.0) };
    let drawn = draw(
        vec![layer(8.0, -0.4, 0.3, tinted)],
        camera(DVec3::new(2.0, 1.0, 9.0), DVec3::ZERO),
        even(DVec3::splat(2.0)),
        settings(16, 1, 4),
    );
    for (x, y, pixel) in pixels(&drawn) {
        let (_, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let expected = 2.0 * (-absorption * 0.7 / -towards.z).exp();
        assert!((colour(&pixel) - expected).length() < 1e-5, "{pixel:?} is not {expected}");
    }
}

/// A liquid that reaches into its glass: the ray meets one boundary between them, without a gap.
#[test]
fn liquids_may_reach_into_their_glass() {
    let layers = vec![layer(8.0, -0.5, 0.0, clear(1.5)), layer(8.0, -0.1, 0.5, clear(1.33))];
    let drawn = draw(layers, camera(DVec3::new(4.0, 1.0, 6.0), DVec3::ZERO), compass(), settings(24, 1, 8));
    let mut compared = 0;
    for (x, y, pixel) in pixels(&drawn) {
        // Parallel boundaries: the direction stays, whatever is between.
        let (_, towards) = drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let Some(found) = direction(colour(&pixel)) else { continue };
        assert!((found - towards).length() < 1e-5, "{found} is not {towards}");
        compared += 1;
    }
    assert!(compared > 400, "{compared}");
}

#[test]
fn one_sees_gradients_and_what_shines_without_light() {
    let shading = fieldstone_scene::Shading::Gradient;
    let eye = camera(DVec3::new(4.0, 1.0, 2.0), DVec3::ZERO);
    let drawn = draw(vec![ball(Appearance { shading, ..look() })], eye, dark(), settings(24, 1, 0));
    for (.., pixel) in pixels(&drawn).into_iter().filter(|(.., p)| p.depth.is_finite()) {
        let normal = DVec3::from_array(pixel.normal.map(f64::from));
        assert!((colour(&pixel) - 0.5 * (normal + DVec3::ONE)).length() < 1e-6);
    }
    let ember = Appearance { emission: DVec3::new(3.0, 1.0, 0.0), ..look() };
    let drawn = draw(vec![ball(ember)], eye, dark(), settings(8, 1, 0));
    assert_eq!(colour(&drawn.1.film.pixel(4, 4).expect("the middle")), ember.emission);
}
