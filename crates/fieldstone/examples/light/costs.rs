//! What light of each kind costs, relative to what is seen directly.

use crate::scenes::{ball, camera, clear, floor, lighting, metal, sun};
use fieldstone::glam::DVec3;
use fieldstone::{Appearance, Lighting, RenderOptions, Scene, Settings, Solid, render};
use std::error::Error;
use std::time::Instant;

/// Each time is the least of so many runs: others are slowed down by what else the machine does.
const RUNS: u32 = 5;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Prints the table: time and rays, divided by those of primary rays alone.
pub(crate) fn table() -> Result<()> {
    let dark = Lighting { ambient: DVec3::ONE, ..lighting(Vec::new(), None) };
    let shone = lighting(vec![sun()?], None);
    let matt = Appearance { specular: 0.0, ..Appearance::default() };
    let mirror = metal(DVec3::splat(0.9), 0.0);
    let veil = Appearance { opacity: 0.5, ..matt };
    let glass = clear(1.5, DVec3::ZERO);
    let rows = [
        ("primary rays", matt, &dark, 0),
        ("shadow of one lamp", matt, &shone, 0),
        ("one reflection", mirror, &dark, 1),
        ("six reflections", mirror, &dark, 6),
        ("transparency, straight", veil, &dark, 0),
        ("glass, six bounces", glass, &dark, 6),
    ];
    let mut base = None;
    println!("| light | time | rays |\n|---|---|---|");
    for (name, look, light, bounces) in rows {
        let (seconds, rays) = cost(&scene(look, light, bounces)?)?;
        let (base_seconds, base_rays) = *base.get_or_insert((seconds, rays));
        println!("| {name} | {:.2} | {:.2} |", seconds / base_seconds, rays / base_rays);
    }
    Ok(())
}

/// Nine balls on a floor.
fn scene(look: Appearance, light: &Lighting, bounces: u32) -> Result<Scene> {
    let place = |i: i32| DVec3::new(f64::from(i % 3 - 1), f64::from(i / 3 - 1), 0.45);
    let balls: Result<Vec<Solid>> = (0..9).map(|i| ball(place(i), 0.45, look)).collect();
    let solids = std::iter::once(floor(0.2, 0.8)?).chain(balls?).collect();
    let camera = camera(DVec3::new(1.5, -6.0, 3.0), DVec3::new(0.0, 0.0, 0.3), 32.0)?;
    let settings = Settings { size: (384, 384), samples: 1, bounces, ..Settings::default() };
    Ok(Scene::new(solids, camera, light.clone(), settings)?)
}

fn cost(scene: &Scene) -> Result<(f64, f64)> {
    let (mut least, mut rays) = (f64::INFINITY, 0);
    for _ in 0..RUNS {
        let start = Instant::now();
        let rendered = render(scene, &RenderOptions { threads: Some(1), ..RenderOptions::default() })?;
        least = least.min(start.elapsed().as_secs_f64());
        rays = rendered.stats.rays;
    }
    Ok((least, rays as f64))
}
