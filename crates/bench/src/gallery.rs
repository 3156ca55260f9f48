//! Pictures of the gallery, from the file to the picture, as users draw them.

use crate::error::BenchError;
use crate::frames::files_in;
use crate::plan::Plan;
use crate::report::{GalleryRow, Report};
use crate::timing::Times;
use fieldstone::{Inputs, LoadOptions, RenderOptions, RenderRequest, Settings, Stats, render, settle_loops};
use std::path::Path;
use std::time::Instant;

/// What takes longer is run [`FEW`] times at most, in seconds.
pub(crate) const LONG: f64 = 5.0;
/// See [`LONG`].
pub(crate) const FEW: u32 = 3;

/// Measures the models of the gallery that the plan wants.
///
/// # Errors
/// A file that cannot be read or drawn.
pub(crate) fn measure(
    plan: &Plan,
    report: &mut Report,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut files = files_in(&plan.gallery.join("table1"), &["txt"])?;
    files.extend(files_in(&plan.gallery, &["hf", "vm"])?);
    for file in files {
        let name = file.strip_prefix(&plan.gallery).unwrap_or(&file).display().to_string();
        if plan.wants(&name) {
            progress(&name);
            for &threads in &plan.threads {
                report.gallery.push(row(plan, &name, &file, threads)?);
            }
        }
    }
    Ok(())
}

fn row(plan: &Plan, name: &str, file: &Path, threads: usize) -> Result<GalleryRow, BenchError> {
    let mut seconds = Vec::new();
    let mut stats = Stats::default();
    while seconds.len() < plan.runs as usize {
        let start = Instant::now();
        stats = picture(file, plan.size, threads)?;
        seconds.push(start.elapsed().as_secs_f64());
        if seconds[0] > LONG && seconds.len() >= FEW as usize {
            break;
        }
    }
    let pixels = (stats.certified + stats.tolerance + stats.undecided).max(1) as f64;
    Ok(GalleryRow {
        file: name.to_owned(),
        threads,
        size: plan.size,
        runs: seconds.len() as u32,
        seconds: Times::new(seconds).spread(),
        certified: stats.certified as f64 / pixels,
        evaluations_per_ray: stats.evaluations as f64 / stats.rays.max(1) as f64,
    })
}

fn picture(file: &Path, size: u32, threads: usize) -> Result<Stats, BenchError> {
    let failed = |reason: String| BenchError::model(&file.display().to_string(), reason);
    let mut loaded = fieldstone::load(file, &LoadOptions::default()).map_err(|e| failed(e.to_string()))?;
    settle_loops(&mut loaded, &Inputs::default(), None).map_err(|e| failed(e.to_string()))?;
    let settings = Settings { size: (size, size), ..Settings::default() };
    let request = RenderRequest { settings, ..RenderRequest::default() };
    let scene = request.resolve(&loaded.model).map_err(|e| failed(e.to_string()))?.scene;
    let options = RenderOptions { threads: Some(threads), ..RenderOptions::default() };
    Ok(render(&scene, &options).map_err(|e| failed(e.to_string()))?.stats)
}
