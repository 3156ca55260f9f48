//! How many frames a second scenes are drawn in, in memory, with a camera that walks around them.
//!
//! ```text
//! cargo run --release -p fieldstone --example rates -- 1024 gallery/scenes/icos.toml gallery/scenes/unions.toml
//! ```
//!
//! Two rates for each: first hits and normals with the octree kept from frame to frame, and whole pictures with one sample, light
//! and bounces, for which everything is prepared anew. Medians, with all cores.

#![allow(clippy::print_stdout, reason = "it prints a table")]

use fieldstone::glam::{DMat3, DVec3};
use fieldstone::{Camera, Document, FileAccess, RenderOptions, Scene, SceneRequest, Viewer, render};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const FRAMES: u32 = 9;
/// How far the camera walks with every frame, in radians.
const STEP: f64 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let size: u32 = arguments.next().ok_or("the size, then scene files")?.parse()?;
    println!("| scene | certified | hits and normals per second | pictures per second |\n|---|---|---|---|");
    for file in arguments {
        let document = Document::load(Path::new(&file), &FileAccess::default())?;
        let request = SceneRequest { size: Some((size, size)), samples: Some(1), ..SceneRequest::default() };
        let scene = document.resolve(&request)?.resolved.scene;
        let (seen, certified) = seen(&scene, size)?;
        println!("| {file} | {:.2} % | {seen:.1} | {:.1} |", 100.0 * certified, drawn(&scene)?);
    }
    Ok(())
}

/// Frames of first hits a second, and the part of the last one's pixels that is certified.
fn seen(scene: &Scene, size: u32) -> Result<(f64, f64), Box<dyn Error>> {
    let viewer = Viewer::new(scene);
    let (mut times, mut certified) = (Vec::new(), 0.0);
    for frame in 0..FRAMES {
        let camera = walked(scene, f64::from(frame) * STEP)?;
        let start = Instant::now();
        let sight = viewer.look(&camera, (size, size));
        times.push(start.elapsed().as_secs_f64());
        certified = sight.stats.certified as f64 / sight.stats.rays.max(1) as f64;
    }
    Ok((rate(times), certified))
}

/// Whole pictures a second.
fn drawn(scene: &Scene) -> Result<f64, Box<dyn Error>> {
    let mut times = Vec::new();
    for _ in 0..FRAMES / 3 {
        let start = Instant::now();
        render(scene, &RenderOptions::default())?;
        times.push(start.elapsed().as_secs_f64());
    }
    Ok(rate(times))
}

/// The camera of the scene, turned around what it looks at.
fn walked(scene: &Scene, angle: f64) -> Result<Camera, Box<dyn Error>> {
    let (camera, bounds) = (scene.camera(), scene.bounds());
    let centre = 0.5 * (bounds.min() + bounds.max());
    let up = camera.up();
    let distance = (centre - camera.eye()).dot(camera.forward());
    let target: DVec3 = camera.eye() + distance * camera.forward();
    let eye = target + DMat3::from_axis_angle(up, angle) * (camera.eye() - target);
    Ok(Camera::look_at(eye, target, up, camera.projection())?)
}

fn rate(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    1.0 / times[times.len() / 2]
}
