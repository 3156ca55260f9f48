//! What was measured, as JSON and as Markdown.

use crate::timing::Spread;
use crate::view::Lens;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// What was measured in one run of the program.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// On what.
    pub machine: Machine,
    /// Frames of our models, ours and fidget's.
    pub models: Vec<ModelRow>,
    /// Pictures of the gallery, from the file to the picture.
    pub gallery: Vec<GalleryRow>,
    /// Pictures of the solids of Hijazi et al. 2008, Table 1, ours and POV-Ray's.
    pub povray: Vec<PovRow>,
    /// How cost grows.
    pub growth: Vec<GrowthRow>,
    /// Instruction counts.
    pub counts: Vec<CountRow>,
    /// What was not measured, and why.
    pub skipped: Vec<String>,
}

/// The machine.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Machine {
    /// What the processor calls itself.
    pub processor: String,
    /// How many threads it runs at a time.
    pub threads: usize,
    /// The widest vectors that our evaluators use on it.
    pub vectors: &'static str,
    /// The version of this program.
    pub version: &'static str,
}

/// One contestant.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// Who.
    pub name: &'static str,
    /// From the text of the model to where frames can be drawn, in seconds.
    pub setup_seconds: f64,
    /// A frame, in seconds.
    pub seconds: Spread,
    /// In which part of the pixels its silhouette differs from ours.
    pub different: Option<f64>,
}

/// A model, a lens, a number of threads.
#[derive(Clone, Debug, Serialize)]
pub struct ModelRow {
    /// The name of the model.
    pub model: &'static str,
    /// How many operations it has.
    pub operations: usize,
    /// The lens; none for shapes of the plane.
    pub lens: Option<Lens>,
    /// How many threads everybody had.
    pub threads: usize,
    /// Pixels along each side.
    pub size: u32,
    /// How many frames.
    pub runs: u32,
    /// We.
    pub ours: Figure,
    /// Evaluations of fields for each pixel, and the part of the pixels that is certified.
    pub evaluations_per_pixel: Option<f64>,
    /// See above.
    pub certified: Option<f64>,
    /// The others.
    pub peers: Vec<Figure>,
    /// How many times as long as we the fastest of them takes for a frame, pair by pair.
    pub ratio: Option<Spread>,
    /// The same with everything that comes before the first frame, of medians.
    pub first_frame_ratio: Option<f64>,
}

/// A picture of the gallery.
#[derive(Clone, Debug, Serialize)]
pub struct GalleryRow {
    /// The file.
    pub file: String,
    /// Threads, pixels along each side, runs.
    pub threads: usize,
    /// See above.
    pub size: u32,
    /// See above.
    pub runs: u32,
    /// Reading, finding bounds, drawing.
    pub seconds: Spread,
    /// The part of the pixels that is certified.
    pub certified: f64,
    /// Evaluations for each ray.
    pub evaluations_per_ray: f64,
}

/// A solid of Table 1.
#[derive(Clone, Debug, Serialize)]
pub struct PovRow {
    /// The file.
    pub file: String,
    /// Whether the light casts a shadow.
    pub shadow: bool,
    /// Threads, pixels along each side, runs.
    pub threads: usize,
    /// See above.
    pub size: u32,
    /// See above.
    pub runs: u32,
    /// The bound of the gradient that POV-Ray was given: the least power of two that draws the solid whole.
    pub max_gradient: f64,
    /// We: from the scene to the picture, and with reading and bounds.
    pub ours: Spread,
    /// See above.
    pub ours_whole: Spread,
    /// POV-Ray: what it says it took to trace, and its whole process.
    pub trace: Spread,
    /// See above.
    pub process: Spread,
    /// How many times as long as we it takes to trace, pair by pair.
    pub ratio: Spread,
    /// In which part of the pixels the pictures differ.
    pub different: f64,
}

/// A point of a curve.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GrowthRow {
    /// What grows: `operations`, `pixels`, `instances`.
    pub what: String,
    /// How many of them there are.
    pub count: u64,
    /// Pixels of the frame.
    pub pixels: u64,
    /// Reading, bounds and preparation, in seconds.
    pub setup_seconds: f64,
    /// A frame, in seconds.
    pub seconds: f64,
    /// Evaluations for each pixel.
    pub evaluations_per_pixel: f64,
    /// The most memory that the process had, in MiB; none where the system does not say.
    pub peak_mib: Option<f64>,
}

/// An instruction count.
#[derive(Clone, Debug, Serialize)]
pub struct CountRow {
    /// The name of the job.
    pub job: String,
    /// How many instructions it took.
    pub instructions: u64,
    /// How many it took when the figure was committed.
    pub committed: Option<u64>,
}

impl CountRow {
    /// The count in units of the committed one.
    pub fn ratio(&self) -> Option<f64> {
        self.committed.filter(|&count| count > 0).map(|count| self.instructions as f64 / count as f64)
    }
}

impl Machine {
    /// This machine.
    pub fn this() -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let processor = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        Self {
            processor: processor.map_or("unknown processor", |(_, name)| name).to_owned(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            vectors: vectors(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// The widest vectors that the evaluators find on this processor.
pub(crate) fn vectors() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            return "AVX-512";
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return "AVX2";
        }
    }
    "the baseline of the architecture"
}

fn milliseconds(spread: Spread) -> String {
    format!("{:.1}", 1e3 * spread.median)
}

fn times(spread: Spread) -> String {
    format!("{:.2} ({:.2}–{:.2})", spread.median, spread.low, spread.high)
}

fn percent(part: f64) -> String {
    format!("{:.2} %", 100.0 * part)
}

impl Report {
    /// The report as tables. Times are medians in milliseconds unless they say otherwise; ratios are medians of pairs, with
    /// their quartiles.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let Machine { processor, threads, vectors, version } = &self.machine;
        // Writing to a string does not fail.
        let _ = writeln!(text, "Fieldstone {version}; {processor}, {threads} threads, {vectors}.");
        self.write_models(&mut text);
        self.write_gallery(&mut text);
        self.write_povray(&mut text);
        self.write_growth(&mut text);
        self.write_counts(&mut text);
        for skipped in &self.skipped {
            let _ = writeln!(text, "\nNot measured: {skipped}");
        }
        text
    }

    fn write_models(&self, text: &mut String) {
        if self.models.is_empty() {
            return;
        }
        head(
            text,
            "Frames of models: first hits with normals, fidget's depth with normals (ms)",
            &[
                "model",
                "operations",
                "view",
                "size",
                "threads",
                "setup",
                "frame",
                "evaluations per pixel",
                "certified",
                "fidget JIT",
                "fidget VM",
                "its setup",
                "differs",
                "frame ratio",
                "first frame ratio",
            ],
        );
        for row in &self.models {
            let peer =
                |i: usize| row.peers.get(i).map_or("–".to_owned(), |peer| milliseconds(peer.seconds));
            let first = row.peers.first();
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
            cells(
                text,
                &[
                    row.model.to_owned(),
                    row.operations.to_string(),
                    row.lens.map_or("plane", Lens::name).to_owned(),
                    format!("{}²", row.size),
                    row.threads.to_string(),
                    format!("{:.1}", 1e3 * row.ours.setup_seconds),
                    milliseconds(row.ours.seconds),
                    or_dash(row.evaluations_per_pixel.map(|e| format!("{e:.1}"))),
                    or_dash(row.certified.map(percent)),
                    peer(0),
                    peer(1),
                    or_dash(first.map(|peer| format!("{:.1}", 1e3 * peer.setup_seconds))),
                    or_dash(first.and_then(|peer| peer.different).map(percent)),
                    or_dash(row.ratio.map(times)),
                    or_dash(row.first_frame_ratio.map(|ratio| format!("{ratio:.2}"))),
                ],
            );
        }
    }

    fn write_gallery(&self, text: &mut String) {
        if self.gallery.is_empty() {
            return;
        }
        head(
            text,
            "The gallery, from the file to the picture (ms)",
            &["file", "size", "threads", "runs", "picture", "certified", "evaluations per ray"],
        );
        for row in &self.gallery {
            cells(
                text,
                &[
                    row.file.clone(),
                    format!("{}²", row.size),
                    row.threads.to_string(),
                    row.runs.to_string(),
                    milliseconds(row.seconds),
                    percent(row.certified),
                    format!("{:.1}", row.evaluations_per_ray),
                ],
            );
        }
    }

    fn write_povray(&self, text: &mut String) {
        if self.povray.is_empty() {
            return;
        }
        head(
            text,
            "Pictures with one light, and POV-Ray's isosurfaces (ms)",
            &[
                "file",
                "shadow",
                "size",
                "threads",
                "runs",
                "picture",
                "with reading and bounds",
                "POV-Ray traces",
                "POV-Ray's process",
                "max_gradient",
                "differs",
                "ratio",
            ],
        );
        for row in &self.povray {
            cells(
                text,
                &[
                    row.file.clone(),
                    if row.shadow { "yes" } else { "no" }.to_owned(),
                    format!("{}²", row.size),
                    row.threads.to_string(),
                    row.runs.to_string(),
                    milliseconds(row.ours),
                    milliseconds(row.ours_whole),
                    milliseconds(row.trace),
                    milliseconds(row.process),
                    row.max_gradient.to_string(),
                    percent(row.different),
                    times(row.ratio),
                ],
            );
        }
    }

    fn write_growth(&self, text: &mut String) {
        if self.growth.is_empty() {
            return;
        }
        head(
            text,
            "Growth",
            &[
                "what",
                "count",
                "pixels",
                "setup (ms)",
                "frame (ms)",
                "ns per pixel",
                "evaluations per pixel",
                "memory (MiB)",
            ],
        );
        for row in &self.growth {
            cells(
                text,
                &[
                    row.what.clone(),
                    row.count.to_string(),
                    row.pixels.to_string(),
                    format!("{:.1}", 1e3 * row.setup_seconds),
                    format!("{:.1}", 1e3 * row.seconds),
                    format!("{:.0}", 1e9 * row.seconds / row.pixels.max(1) as f64),
                    format!("{:.2}", row.evaluations_per_pixel),
                    row.peak_mib.map_or("–".to_owned(), |mib| format!("{mib:.0}")),
                ],
            );
        }
    }

    fn write_counts(&self, text: &mut String) {
        if self.counts.is_empty() {
            return;
        }
        head(text, "Instructions (millions)", &["job", "now", "committed", "ratio"]);
        for row in &self.counts {
            let millions = |count: u64| format!("{:.1}", count as f64 * 1e-6);
            cells(
                text,
                &[
                    row.job.clone(),
                    millions(row.instructions),
                    row.committed.map_or("–".to_owned(), millions),
                    row.ratio().map_or("–".to_owned(), |ratio| format!("{ratio:.3}")),
                ],
            );
        }
    }
}

fn head(text: &mut String, title: &str, columns: &[&str]) {
    let _ = writeln!(text, "\n### {title}\n");
    cells(text, &columns.iter().map(|&c| c.to_owned()).collect::<Vec<_>>());
    cells(text, &vec!["---".to_owned(); columns.len()]);
}

fn cells(text: &mut String, cells: &[String]) {
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}
