//! Draws pictures of light: glass, mirrors, soft shadows, rough metal, and measures what rays of each kind cost.
//!
//! ```text
//! cargo run --release -p fieldstone --example light -- FOLDER    # the pictures
//! cargo run --release -p fieldstone --example light              # the costs, as a table
//! ```

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to its user")]

mod costs;
mod scenes;

use fieldstone::{RenderOptions, Scene, render, write_png_toned};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match std::env::args_os().nth(1) {
        Some(folder) => pictures(Path::new(&folder)),
        None => costs::table(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn pictures(folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    for (name, scene) in scenes::all()? {
        let start = std::time::Instant::now();
        let rendered = render(&scene, &RenderOptions::default())?;
        println!("{name}: {:.1} s, {} rays", start.elapsed().as_secs_f64(), rendered.stats.rays);
        save(&scene, &rendered.film, &folder.join(format!("{name}.png")))?;
    }
    Ok(())
}

fn save(scene: &Scene, film: &fieldstone::Film, path: &Path) -> Result<(), Box<dyn Error>> {
    Ok(write_png_toned(film, &scene.lighting().background, &scene.settings().tone, path)?)
}
