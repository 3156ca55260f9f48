//! Frames of our models, side by side with fidget's.

use crate::contest::{Contestant, Standing, contest};
use crate::error::BenchError;
use crate::models::BenchModel;
use crate::ours::{Frames, Prepared, Slices};
use crate::plan::Plan;
use crate::report::{Figure, ModelRow};
use crate::timing::Spread;
use crate::view::Lens;
use std::path::{Path, PathBuf};

/// Whether the peer that is a library was compiled in.
pub const HAS_FIDGET: bool = cfg!(feature = "fidget");

/// Measures a model with every lens and number of threads of the plan.
///
/// # Errors
/// The first thing that could not be measured.
pub(crate) fn measure(plan: &Plan, model: &BenchModel) -> Result<Vec<ModelRow>, BenchError> {
    let folder = tempfile::tempdir().map_err(|e| BenchError::system("a folder for the model", e))?;
    let file = folder.path().join(format!("{}.vm", model.name));
    let text = model.text();
    std::fs::write(&file, &text).map_err(|e| BenchError::system(file.display(), e))?;
    let subject = Subject { plan, model, file, text };
    let mut rows = Vec::new();
    for &threads in &plan.threads {
        if model.is_flat {
            rows.push(subject.in_the_plane(threads)?);
            continue;
        }
        let prepared = Prepared::read(&subject.file)?;
        for &lens in &plan.lenses {
            rows.push(subject.in_space(&prepared, lens, threads)?);
        }
    }
    Ok(rows)
}

struct Subject<'p> {
    plan: &'p Plan,
    model: &'p BenchModel,
    file: PathBuf,
    text: String,
}

impl Subject<'_> {
    fn in_space(&self, prepared: &Prepared, lens: Lens, threads: usize) -> Result<ModelRow, BenchError> {
        let ours = || Frames::new(prepared, lens, self.plan.size, threads);
        let mut all: Vec<Box<dyn Contestant + '_>> = vec![Box::new(ours()?)];
        all.extend(solid_peers(&self.text, prepared, (lens, self.plan.size, threads))?);
        let standings = contest(&mut all, self.plan.runs)?;
        let mut counter = ours()?;
        counter.draw(0)?;
        let stats = counter.stats();
        let pixels = stats.rays.max(1) as f64;
        let operations = prepared.scene().solids()[0].field().operation_count();
        let row = self.row(operations, Some(lens), threads, &standings);
        Ok(ModelRow {
            evaluations_per_pixel: Some(stats.evaluations as f64 / pixels),
            certified: Some(stats.certified as f64 / pixels),
            ..row
        })
    }

    fn in_the_plane(&self, threads: usize) -> Result<ModelRow, BenchError> {
        let ours = Slices::read(&self.file, self.plan.size, threads)?;
        let operations = ours.operation_count();
        let mut all: Vec<Box<dyn Contestant>> = vec![Box::new(ours)];
        all.extend(plane_peers(&self.text, self.plan.size, threads)?);
        Ok(self.row(operations, None, threads, &contest(&mut all, self.plan.runs)?))
    }

    fn row(&self, operations: usize, lens: Option<Lens>, threads: usize, all: &[Standing]) -> ModelRow {
        let (ours, peers) = (&all[0], &all[1..]);
        let median = |standing: &Standing| standing.times.spread().median;
        let fastest = peers.iter().min_by(|a, b| median(a).total_cmp(&median(b)));
        let first = |standing: &Standing| standing.setup_seconds + median(standing);
        ModelRow {
            model: self.model.name,
            operations,
            lens,
            threads,
            size: self.plan.size,
            runs: self.plan.runs,
            ours: figure(ours),
            evaluations_per_pixel: None,
            certified: None,
            peers: peers.iter().map(figure).collect(),
            ratio: fastest.map(|peer| -> Spread { ours.times.ratio(&peer.times) }),
            first_frame_ratio: fastest.map(|peer| first(peer) / first(ours)),
        }
    }
}

fn figure(standing: &Standing) -> Figure {
    let Standing { name, setup_seconds, times, different } = standing;
    Figure { name, setup_seconds: *setup_seconds, seconds: times.spread(), different: *different }
}

#[cfg(feature = "fidget")]
fn solid_peers(
    text: &str,
    prepared: &Prepared,
    (lens, size, threads): (Lens, u32, usize),
) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    crate::fidget::of_solid(text, prepared.walk(lens)?, size, threads)
}

#[cfg(not(feature = "fidget"))]
fn solid_peers(_: &str, _: &Prepared, _: (Lens, u32, usize)) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    Ok(Vec::new())
}

#[cfg(feature = "fidget")]
fn plane_peers(text: &str, size: u32, threads: usize) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    crate::fidget::of_plane(text, size, threads)
}

#[cfg(not(feature = "fidget"))]
fn plane_peers(_: &str, _: u32, _: usize) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    Ok(Vec::new())
}

/// The files of a folder of the gallery with these extensions, in order.
pub(crate) fn files_in(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>, BenchError> {
    let failed = |e| BenchError::Gallery { folder: folder.to_owned(), reason: e };
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        if path.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
