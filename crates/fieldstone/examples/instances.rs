//! Draws thousands of tori, thrown about by chance, and says how long it took.
//!
//!     cargo run --release -p fieldstone --example instances -- 10000 tori.png

#![allow(clippy::print_stdout, reason = "the program reports what it measured")]

use fieldstone::glam::{DAffine3, DQuat, DVec3};
use fieldstone::{
    Bindings, Bounds, Camera, Instance, Lighting, Method, Projection, RenderOptions, Scene, Settings, Solid,
    formula, render, write_png,
};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Numbers between 0 and 1, evenly and without a pattern.
fn chance(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// Tori in a cube of side 10 that fill a twentieth of it.
fn tori(count: usize) -> Vec<Instance> {
    let mut seed = 11;
    let mut next = || chance(&mut seed);
    let radius = (50.0 / count as f64 / 2.5).cbrt();
    let mut one = || {
        let place = 10.0 * (DVec3::new(next(), next(), next()) - DVec3::splat(0.5));
        let axis = DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5).normalize_or(DVec3::X);
        let turn = DQuat::from_axis_angle(axis, 6.0 * next());
        let motion = DAffine3::from_scale_rotation_translation(DVec3::splat(radius), turn, place);
        Instance::new(0, motion)
    };
    (0..count).filter_map(|_| one()).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(10_000), |n| n.parse())?;
    let file = arguments.next().unwrap_or_else(|| "tori.png".to_owned());
    let model = formula("(1-sqrt(x^2+y^2))^2+z^2-.125")?.model;
    let half = DVec3::new(1.36, 1.36, 0.36);
    let solid = Solid::new(model.field, Bindings::new(), Bounds::new(-half, half)?);
    let projection = Projection::Perspective { vertical_fov_radians: 0.7 };
    let camera = Camera::look_at(DVec3::new(8.0, -16.0, 7.0), DVec3::ZERO, DVec3::Z, projection)?;
    let settings = Settings { size: (512, 512), samples: 4, method: Method::Affine, ..Settings::default() };
    let scene =
        Scene::with_instances(vec![solid], tori(count), camera, Lighting::for_camera(&camera), settings)?;
    let start = Instant::now();
    let rendered = render(&scene, &RenderOptions::default())?;
    let (stats, pixels) = (rendered.stats, 512.0 * 512.0);
    println!(
        "{count} tori: {:.2} s, {:.2} % certified, {} hits, {:.1} evaluations per pixel",
        start.elapsed().as_secs_f64(),
        100.0 * stats.certified as f64 / pixels,
        stats.hits,
        stats.evaluations as f64 / pixels
    );
    write_png(&rendered.film, &scene.lighting().background, Path::new(&file))?;
    Ok(())
}
