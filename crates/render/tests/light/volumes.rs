//! Volumes of texels among solids: a cube of side 4 above a floor, evenly filled with flakes that face all ways.

use crate::{camera, colour, dark, even, layer, look, pixels, settings};
use fieldstone_render::{RenderOptions, Rendered, render};
use fieldstone_scene::{Appearance, Camera, Light, Lighting, Pixel, Scene, Solid, TexelBox};
use fieldstone_texel::{Builder, Mode, Model, Ray, Reflector, Sggx, Texel};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

const EDGE: u32 = 8;
const LOW: DVec3 = DVec3::new(-2.0, -2.0, 1.0);
const SIDE: f64 = 4.0;

/// What the cube is made of.
fn texel(albedo: f32) -> Texel {
    Texel::even(1.0, Sggx::ISOTROPIC, 1.0 / f64::from(EDGE)).coloured([albedo; 3], 0.0)
}

fn cube(albedo: f32) -> TexelBox {
    let mut builder = Builder::new(EDGE).expect("the edge is sound");
    for place in 0..EDGE.pow(3) {
        builder.insert([place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE], &texel(albedo));
    }
    let volume = Arc::new(builder.build(Mode::Sggx).expect("the cells are few"));
    let place = DAffine3::from_translation(LOW) * DAffine3::from_scale(DVec3::splat(SIDE));
    TexelBox::new(volume, place).expect("the place is sound")
}

fn sun(to_light: DVec3) -> Lighting {
    Lighting { lights: vec![Light::directional(to_light, DVec3::ONE).expect("the light is sound")], ..dark() }
}

fn floor(look: Appearance) -> Solid {
    layer(12.0, -0.1, 0.0, look)
}

fn draw(solids: Vec<Solid>, albedo: f32, camera: Camera, lighting: Lighting) -> (Scene, Rendered) {
    draw_with(solids, cube(albedo), camera, lighting)
}

fn draw_with(solids: Vec<Solid>, texels: TexelBox, camera: Camera, lighting: Lighting) -> (Scene, Rendered) {
    let scene = Scene::new(solids, camera, lighting, settings(24, 1, 3)).expect("the scene is sound");
    let scene = scene.with_texels(vec![texels]);
    let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
    (scene, rendered)
}

/// The optical depth of the cube along a ray: 1 along its edges.
fn depth(origin: DVec3, direction: DVec3) -> f64 {
    let ray = Ray { origin: (origin - LOW) / SIDE, direction: direction / SIDE };
    ray.span().map_or(0.0, |(near, far)| (far - near.max(0.0)).max(0.0) / SIDE)
}

/// Every pixel with its ray.
fn rays(drawn: &(Scene, Rendered)) -> Vec<((DVec3, DVec3), Pixel)> {
    let ray = |x: u32, y: u32| drawn.0.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
    pixels(drawn).into_iter().map(|(x, y, pixel)| (ray(x, y), pixel)).collect()
}

fn assert_all(drawn: &(Scene, Rendered), expected: impl Fn(DVec3, DVec3, &Pixel) -> f64) {
    let (mut least, mut most) = (f64::INFINITY, 0.0f64);
    for ((origin, direction), pixel) in rays(drawn) {
        let (found, expected) = (colour(&pixel).x, expected(origin, direction, &pixel));
        // Depths are stored with an error of 0.2 %.
        assert!((found - expected).abs() < 0.003, "{found} is not {expected} along {direction}");
        (least, most) = (least.min(found), most.max(found));
    }
    assert!(most > least + 0.02, "all is alike: {least} to {most}");
}

fn from_above() -> Camera {
    camera(DVec3::new(0.3, 0.4, 16.0), DVec3::new(0.0, 0.0, 0.0))
}

#[test]
fn a_volume_hides_what_is_behind_it() {
    let ambient = Lighting { ambient: DVec3::ONE, ..dark() };
    let drawn = draw(vec![floor(look())], 0.0, from_above(), ambient);
    assert_all(&drawn, |origin, direction, _| (-depth(origin, direction)).exp());
}

/// But that it is nowhere in its own shadow there.
#[test]
fn a_white_volume_in_ambient_light_cannot_be_seen() {
    let ambient = Lighting { ambient: DVec3::ONE, ..dark() };
    let drawn = draw(vec![floor(look())], 1.0, from_above(), ambient);
    for (_, pixel) in rays(&drawn) {
        assert!((colour(&pixel).x - 1.0).abs() < 0.005 && pixel.alpha == 1.0, "{pixel:?}");
    }
}

#[test]
fn a_volume_covers_the_background_as_far_as_it_is_there() {
    let aside = layer(0.1, -0.1, 0.0, look());
    let seen_from = camera(DVec3::new(0.3, 16.0, 3.0), DVec3::new(0.0, 0.0, 3.0));
    let drawn = draw(vec![aside], 0.0, seen_from, dark());
    for ((origin, direction), pixel) in rays(&drawn) {
        let covered = 1.0 - (-depth(origin, direction)).exp();
        assert!((f64::from(pixel.alpha) - covered).abs() < 0.003, "{pixel:?}: {covered}");
    }
}

#[test]
fn a_volume_throws_a_shadow_on_a_solid() {
    let to_light = DVec3::new(0.2, 0.3, 0.9).normalize();
    // From below the volume.
    let eye = camera(DVec3::new(0.3, -9.0, 0.9), DVec3::new(0.0, 0.0, -0.5));
    let drawn = draw(vec![floor(look())], 0.0, eye, sun(to_light));
    assert_all(&drawn, |origin, direction, pixel| {
        if pixel.part != 0.0 || pixel.normal[2] < 0.99 {
            return colour(pixel).x;
        }
        let place = origin + f64::from(pixel.depth) * direction;
        to_light.z * (-depth(place, to_light) - depth(origin, direction)).exp()
    });
}

#[test]
fn a_solid_throws_a_shadow_on_a_volume() {
    let screen = layer(6.0, 5.5, 5.6, look());
    let eye = camera(DVec3::new(0.3, -16.0, 3.0), DVec3::new(0.0, 0.0, 3.0));
    let drawn =
        draw(vec![screen, floor(Appearance { colour: DVec3::ZERO, ..look() })], 1.0, eye, sun(DVec3::Z));
    let in_volume = rays(&drawn).into_iter().filter(|((origin, direction), _)| {
        depth(*origin, *direction) > 0.5 && (origin.z + 16.0 * direction.z) < 4.5
    });
    let dark = in_volume.map(|(_, pixel)| colour(&pixel).x);
    let (count, most) = dark.fold((0, 0.0f64), |(count, most), x| (count + 1, most.max(x)));
    assert!(count > 50 && most == 0.0, "{count} {most}");
}

/// L = albedo p E a / (a + b) (1 − e^{−(a + b) s}), with a and b the extinctions towards the eye and the lamp by the way.
fn scattered(origin: DVec3, direction: DVec3) -> f64 {
    let ray = Ray { origin: (origin - LOW) / SIDE, direction: direction / SIDE };
    let Some((near, far)) = ray.span() else { return 0.0 };
    // In from the top alone.
    let entry = ray.at(near);
    let shadow = 1.0 - entry.z;
    let phase = Reflector::new(&texel(1.0), Model::Microflakes, -direction).phase(DVec3::Z);
    let (out, back) = (1.0 / SIDE, -direction.z / SIDE);
    phase * PI * (-shadow).exp() * out / (out + back) * (1.0 - (-(out + back) * (far - near)).exp())
}

#[test]
fn a_volume_scatters_the_light_of_a_lamp() {
    let black = Appearance { colour: DVec3::ZERO, ..look() };
    let drawn = draw(vec![floor(black)], 1.0, from_above(), sun(DVec3::Z));
    assert_all(&drawn, |origin, direction, _| scattered(origin, direction));
}

#[test]
fn a_volume_is_seen_in_a_mirror() {
    let mirror = Appearance { colour: DVec3::ONE, reflection: 1.0, ..look() };
    // A mirror above the volume, seen from beside the volume.
    let above = layer(12.0, 8.0, 8.1, mirror);
    let eye = DVec3::new(0.3, -6.0, 3.5);
    let drawn = draw(vec![above], 1.0, camera(eye, DVec3::new(0.0, -3.0, 8.0)), sun(DVec3::Y));
    let mut bright = 0;
    for ((origin, direction), pixel) in rays(&drawn) {
        if pixel.part == 0.0 && pixel.normal[2] < -0.99 && depth(origin, direction) == 0.0 {
            let place = origin + f64::from(pixel.depth) * direction;
            let turned = DVec3::new(direction.x, direction.y, -direction.z);
            let hidden = 1.0 - (-depth(place, turned)).exp();
            let seen = colour(&pixel).x;
            assert!(seen <= hidden && (seen > 0.0) == (hidden > 0.0), "{seen} {hidden}");
            bright += u32::from(seen > 0.01);
        }
    }
    assert!(bright > 30, "{bright}");
}

#[test]
fn a_volume_is_seen_through_glass() {
    let clear = Appearance { transmission: 1.0, index: 1.0, ..look() };
    let black = Appearance { colour: DVec3::ZERO, ..look() };
    let drawn = draw(vec![layer(12.0, 7.0, 7.5, clear), floor(black)], 1.0, from_above(), sun(DVec3::Z));
    assert_all(&drawn, |origin, direction, _| scattered(origin, direction));
}

/// The light of the sky comes by chance, and is that of ambient light less what the volume shades of itself.
#[test]
fn a_volume_scatters_the_light_of_the_sky() {
    let black = layer(0.1, -0.1, 0.0, Appearance { colour: DVec3::ZERO, ..look() });
    let drawn = draw(vec![black], 1.0, from_above(), even(DVec3::ONE));
    let through =
        rays(&drawn).into_iter().filter(|((origin, direction), _)| depth(*origin, *direction) > 0.9);
    let (mut sum, mut hidden, mut count) = (0.0, 0.0, 0);
    for ((origin, direction), pixel) in through {
        let passes = (-depth(origin, direction)).exp();
        sum += colour(&pixel).x - passes;
        hidden += 1.0 - passes;
        count += 1;
    }
    let share = sum / hidden;
    assert!(count > 20 && share > 0.5 && share < 0.9, "{count} {share}");
}

#[test]
fn a_denser_volume_hides_more() {
    let ambient = Lighting { ambient: DVec3::ONE, ..dark() };
    let dense = cube(0.0).with_density(2.5).expect("the density is sound");
    let drawn = draw_with(vec![floor(look())], dense, from_above(), ambient);
    assert_all(&drawn, |origin, direction, _| (-2.5 * depth(origin, direction)).exp());
}

#[test]
fn a_volume_has_a_depth_where_it_hides_half_and_counts_after_the_parts() {
    let dense = cube(0.0).with_density(3.0).expect("the density is sound");
    let drawn = draw_with(vec![floor(look())], dense, from_above(), dark());
    let (mut in_volume, mut behind) = (0, 0);
    for ((origin, direction), pixel) in rays(&drawn) {
        let half = 2f64.ln() / 3.0;
        let ray = Ray { origin: (origin - LOW) / SIDE, direction: direction / SIDE };
        if 3.0 * depth(origin, direction) < 0.69 {
            assert_eq!(pixel.part.max(0.0), 0.0, "{pixel:?}");
            behind += 1;
        } else if 3.0 * depth(origin, direction) > 0.7 {
            let near = ray.span().map_or(f64::NAN, |(near, _)| near);
            assert!((f64::from(pixel.depth) - near - half * SIDE).abs() < 0.01, "{pixel:?}: {near}");
            assert_eq!((pixel.part, pixel.normal), (1.0, [0.0; 3]));
            in_volume += 1;
        }
    }
    assert!(in_volume > 20 && behind > 20, "{in_volume} {behind}");
}

#[test]
fn a_repeated_volume_goes_on() {
    let mut builder = Builder::new(2).expect("the edge is sound").cyclic([true, false, false]);
    for place in 0..8 {
        let even = Texel::even(1.0, Sggx::ISOTROPIC, 0.5).coloured([0.0; 3], 0.0);
        builder.insert([place % 2, place / 2 % 2, place / 4], &even);
    }
    let volume = Arc::new(builder.build(Mode::Sggx).expect("the cells are few"));
    let scale = DAffine3::from_scale(DVec3::new(1.0, 4.0, 4.0));
    let place = DAffine3::from_translation(LOW) * scale;
    let row = TexelBox::new(volume, place).and_then(|single| single.with_repeats([4, 1, 1]));
    let ambient = Lighting { ambient: DVec3::ONE, ..dark() };
    let drawn = draw_with(vec![floor(look())], row.expect("the place is sound"), from_above(), ambient);
    // Four cubes that are a quarter as long let as much through across, but four times as much is in the way along x.
    assert_all(&drawn, |origin, direction, _| {
        let way = depth(origin, direction);
        (-way * (DVec3::new(4.0, 1.0, 1.0) * direction).length()).exp()
    });
}

#[test]
fn what_is_behind_an_opaque_volume_is_not_asked_for() {
    let opaque = || cube(0.0).with_density(1e3).expect("the density is sound");
    let lit = |texels| draw_with(vec![floor(look())], texels, from_above(), sun(DVec3::new(0.0, 0.6, 0.8)));
    let (thick, thin) = (lit(opaque()), lit(cube(0.0)));
    assert!(thick.1.stats.rays < thin.1.stats.rays, "{:?} {:?}", thick.1.stats, thin.1.stats);
}

#[test]
fn a_scene_may_hold_a_volume_alone() {
    let ambient = Lighting { ambient: DVec3::ONE, ..dark() };
    let scene = Scene::of_texels(vec![cube(1.0)], from_above(), ambient, settings(24, 1, 3));
    let scene = scene.expect("the scene is sound");
    let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
    for ((origin, direction), pixel) in rays(&(scene, rendered)) {
        let covered = 1.0 - (-depth(origin, direction)).exp();
        assert!((f64::from(pixel.alpha) - covered).abs() < 0.003, "{pixel:?}: {covered}");
        assert!((colour(&pixel).x - covered).abs() < 0.005, "{pixel:?}: {covered}");
    }
}

/// A volume in many pieces is what it is in one.
#[test]
fn many_volumes_are_asked_from_the_nearest_on() {
    let single = || Texel::even(1.0, Sggx::ISOTROPIC, 1.0).coloured([0.0; 3], 0.0);
    let mut builder = Builder::new(1).expect("the edge is sound");
    builder.insert([0; 3], &single());
    let volume = Arc::new(builder.build(Mode::Sggx).expect("the cells are few"));
    let part = |i: u32| {
        let corner = LOW + DVec3::from([i % 4, i / 4 % 4, i / 16].map(f64::from)) * (SIDE / 4.0);
        let place = DAffine3::from_translation(corner) * DAffine3::from_scale(DVec3::splat(SIDE / 4.0));
        let texels = TexelBox::new(volume.clone(), place).and_then(|texels| texels.with_density(0.25));
        texels.expect("the place is sound")
    };
    let lighting = Lighting { ambient: DVec3::splat(0.2), ..sun(DVec3::new(0.2, 0.3, 0.9).normalize()) };
    let draw = |texels: Vec<TexelBox>| {
        let scene = Scene::new(vec![floor(look())], from_above(), lighting.clone(), settings(24, 1, 3));
        let scene = scene.expect("the scene is sound").with_texels(texels);
        let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
        (scene, rendered)
    };
    let (whole, parts) = (draw(vec![cube(0.0)]), draw((0..64).map(part).collect()));
    let pairs = rays(&whole).into_iter().zip(rays(&parts));
    let worst =
        pairs.map(|((_, a), (_, b))| (colour(&a) - colour(&b)).abs().max_element()).fold(0.0, f64::max);
    assert!(worst < 0.005, "{worst}");
}
