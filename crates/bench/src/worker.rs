//! Jobs that run in a process of their own, so that their memory and their instructions can be told apart.

use crate::contest::Contestant;
use crate::error::BenchError;
use crate::growth;
use crate::models::MODELS;
use crate::ours::{Frames, Prepared};
use crate::report::{GrowthRow, vectors};
use crate::view::Lens;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;

/// Pixels along each side of a frame whose instructions are counted.
const COUNTED_SIZE: u32 = 96;

/// What a job found out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Work {
    /// A point of a curve.
    Growth(GrowthRow),
    /// Frames were drawn, whose instructions somebody counts.
    Frames {
        /// How many pixels of the last one are certified.
        certified: u64,
        /// The widest vectors that the processor has, or that the counter pretends to have.
        vectors: String,
    },
}

/// Does a job: `growth:WHAT:COUNT`, `setup:MODEL` (all that comes before the first frame) or `frame:MODEL` (that and a
/// frame).
///
/// # Errors
/// A job that there is not; what could not be measured.
pub fn work(job: &str) -> Result<Work, BenchError> {
    let unknown = || BenchError::Unknown {
        kind: "job",
        name: job.to_owned(),
        known: "growth:WHAT:COUNT, setup:MODEL and frame:MODEL".to_owned(),
    };
    match job.split(':').collect::<Vec<_>>()[..] {
        ["growth", what, count] => {
            Ok(Work::Growth(growth::point(what, count.parse().map_err(|_| unknown())?)?))
        }
        ["setup", name] => frames(name, 0),
        ["frame", name] => frames(name, 1),
        _ => Err(unknown()),
    }
}

/// Frames of a model on one thread.
fn frames(name: &str, count: u32) -> Result<Work, BenchError> {
    let Some(model) = MODELS.iter().find(|model| model.name == name && !model.is_flat) else {
        let known = MODELS.map(|model| model.name).join(", ");
        return Err(BenchError::Unknown { kind: "model", name: name.to_owned(), known });
    };
    let prepared = read(&model.text())?;
    let mut frames = Frames::new(&prepared, Lens::Perspective, COUNTED_SIZE, 1)?;
    (0..count).try_for_each(|frame| frames.draw(frame))?;
    Ok(Work::Frames { certified: frames.stats().certified, vectors: vectors().to_owned() })
}

/// A program, read from a file as users read it.
pub(crate) fn read(text: &str) -> Result<Prepared, BenchError> {
    let folder = tempfile::tempdir().map_err(|e| BenchError::system("a folder for the model", e))?;
    let file = folder.path().join("model.vm");
    std::fs::write(&file, text).map_err(|e| BenchError::system(file.display(), e))?;
    Prepared::read(&file)
}

/// The worker that does a job in a process of its own, perhaps inside of another program.
pub(crate) fn command(worker: &Path, inside: Option<&[String]>, job: &str) -> Command {
    let mut command = match inside {
        Some([program, options @ ..]) => {
            let mut command = Command::new(program);
            command.args(options).arg(worker);
            command
        }
        _ => Command::new(worker),
    };
    command.args(["bench", "--worker", job]);
    command
}

/// What a worker says, from its output.
pub(crate) fn run(mut command: Command, job: &str) -> Result<(Work, String), BenchError> {
    let output = command.output().map_err(|e| BenchError::system(job, e))?;
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        return Err(BenchError::model(job, messages));
    }
    let work = serde_json::from_slice(&output.stdout).map_err(|e| BenchError::model(job, e))?;
    Ok((work, messages))
}
