//! Draws the pictures of the handbook from its examples:
//!
//!     cargo run --release -p fieldstone --example handbook            # all
//!     cargo run --release -p fieldstone --example handbook hfSphere   # one
#![allow(clippy::print_stderr, reason = "a program talks to its user")]

mod blocks;

use blocks::{Example, SIZE, all, folder};
use fieldstone::{Dialect, RenderOptions, render, write_png};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    match draw_all(&wanted) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn draw_all(wanted: &[String]) -> Result<(), Box<dyn Error>> {
    let images = folder().join("images/hyperfun");
    std::fs::create_dir_all(&images)?;
    let examples = all()?;
    if let Some(name) = wanted.iter().find(|name| examples.iter().all(|e| e.name != **name)) {
        return Err(format!("there is no example `{name}`").into());
    }
    for example in examples.iter().filter(|e| wanted.is_empty() || wanted.contains(&e.name)) {
        draw(example, &images)?;
    }
    Ok(())
}

fn draw(example: &Example, images: &Path) -> Result<(), Box<dyn Error>> {
    let loaded = example.load(Dialect::Lenient)?;
    let resolved = example.request(SIZE)?.resolve(&loaded.model)?;
    for warning in &resolved.warnings {
        eprintln!("{} {}: {warning}", example.place, example.name);
    }
    let rendered = render(&resolved.scene, &RenderOptions::default())?;
    let background = &resolved.scene.lighting().background;
    Ok(write_png(&rendered.film, background, &images.join(example.picture()))?)
}
