//! `fieldstone bench`.

use crate::arguments::{METHOD, OUTPUT, VIEW};
use crate::failure::Failure;
use clap::{Args, ValueEnum};
use fieldstone::{check_writable, write_beside};
use fieldstone_bench::{BenchError, Lens, Part, Plan, Report, outside_of_band, to_commit, work};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The arguments of `bench`.
#[derive(Debug, Args)]
pub(crate) struct BenchArguments {
    /// What to measure [default: models gallery povray].
    #[arg(value_enum, value_name = "PART")]
    parts: Vec<PartName>,
    /// Only the model, the file of the gallery or the curve of this name; may be repeated.
    #[arg(long, help_heading = METHOD, value_name = "NAME")]
    only: Vec<String>,
    /// Pixels along each side of the pictures.
    #[arg(long, help_heading = VIEW, value_name = "N", allow_hyphen_values = true, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,
    /// Frames of one kind of view only.
    #[arg(long, help_heading = VIEW, value_enum)]
    view: Option<LensName>,
    /// How many runs of each.
    #[arg(long, help_heading = METHOD, value_name = "N", allow_hyphen_values = true, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Numbers of threads, with commas.
    #[arg(long, help_heading = METHOD, value_name = "N,...", allow_hyphen_values = true, value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,
    /// The folder of the gallery.
    #[arg(long, help_heading = METHOD, value_name = "DIR", default_value = "gallery")]
    gallery: PathBuf,
    /// Where to write the report too: .json or .md; may be repeated.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Leave the pictures that are compared with POV-Ray's in this folder.
    #[arg(long, help_heading = OUTPUT, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Write the instruction counts as those that later ones are compared with.
    #[arg(long, help_heading = OUTPUT)]
    commit: bool,
    /// Do one job in this process and print what it found as JSON.
    #[arg(long, hide = true, help_heading = METHOD, value_name = "JOB")]
    worker: Option<String>,
}

/// The parts by their names on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum PartName {
    /// Frames of models, side by side with fidget.
    Models,
    /// Pictures of the gallery.
    Gallery,
    /// Pictures of simple solids, side by side with POV-Ray.
    Povray,
    /// How cost grows with operations, pixels and instances.
    Growth,
    /// Instruction counts, compared with the committed ones.
    Counts,
}

/// The views by their names on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum LensName {
    /// From an eye.
    Perspective,
    /// Along parallel rays.
    Parallel,
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Unknown { .. } => Self::Usage(error.to_string()),
            _ => Self::Material(error.to_string()),
        }
    }
}

/// Measures what is asked for and prints tables.
pub(crate) fn run(arguments: &BenchArguments) -> Result<(), Failure> {
    if let Some(job) = &arguments.worker {
        return print(&(json(&work(job)?)? + "\n"));
    }
    let formats: Vec<Format> =
        arguments.output.iter().map(|path| Format::of(path)).collect::<Result<_, _>>()?;
    for path in &arguments.output {
        check_writable(path)?;
    }
    let plan = plan(arguments);
    let report = plan.run(&mut |what| eprintln!("{what}"))?;
    let text = report.markdown();
    for (path, format) in arguments.output.iter().zip(formats) {
        let text = format.text(&report, &text)?;
        write_beside(path, |file| file.write_all(text.as_bytes()))?;
    }
    print(&text)?;
    if arguments.commit && !report.counts.is_empty() {
        let text = to_commit(&report.counts);
        write_beside(&plan.committed, |file| file.write_all(text.as_bytes()))?;
        return Ok(());
    }
    match outside_of_band(&report.counts)[..] {
        [] => Ok(()),
        ref told => Err(Failure::Material(told.join("\n"))),
    }
}

fn plan(arguments: &BenchArguments) -> Plan {
    let usual = Plan::default();
    let part = |name: &PartName| match name {
        PartName::Models => Part::Models,
        PartName::Gallery => Part::Gallery,
        PartName::Povray => Part::Povray,
        PartName::Growth => Part::Growth,
        PartName::Counts => Part::Counts,
    };
    let lens = |name: LensName| match name {
        LensName::Perspective => Lens::Perspective,
        LensName::Parallel => Lens::Parallel,
    };
    let parts: Vec<Part> = arguments.parts.iter().map(part).collect();
    Plan {
        parts: if parts.is_empty() { usual.parts } else { parts },
        only: arguments.only.clone(),
        size: arguments.size,
        runs: arguments.runs,
        threads: arguments.threads.iter().map(|&n| usize::from(n)).collect(),
        lenses: arguments.view.map_or(usual.lenses, |name| vec![lens(name)]),
        committed: arguments.gallery.join("bench/instructions.json"),
        gallery: arguments.gallery.clone(),
        pictures: arguments.pictures.clone(),
        worker: std::env::current_exe().ok(),
    }
}

/// How a report is written to a file.
#[derive(Clone, Copy)]
enum Format {
    Json,
    Markdown,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Failure> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("json") => Ok(Self::Json),
            Some("md") => Ok(Self::Markdown),
            _ => {
                let path = path.display();
                Err(Failure::Usage(format!("{path}: a report is written to .json or .md (Markdown)")))
            }
        }
    }

    fn text(self, report: &Report, markdown: &str) -> Result<String, Failure> {
        match self {
            Self::Json => Ok(json(report)? + "\n"),
            Self::Markdown => Ok(markdown.to_owned()),
        }
    }
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|e| Failure::Material(e.to_string()))
}

fn print(text: &str) -> Result<(), Failure> {
    write!(std::io::stdout(), "{text}").map_err(|e| Failure::of_stream("standard output", &e))
}
