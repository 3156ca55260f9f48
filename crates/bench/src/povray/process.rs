//! Running POV-Ray.

use crate::error::BenchError;
use fieldstone::{Wrap, read_picture};
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How often a running process is looked at.
const LOOK: Duration = Duration::from_millis(1);

/// An installed POV-Ray.
pub(super) struct Pov;

/// What it is to draw.
pub(super) struct Job {
    /// The scene in its language.
    pub(super) text: String,
    /// Pixels along each side.
    pub(super) size: u32,
    pub(super) threads: usize,
    /// After this it is stopped.
    pub(super) limit_seconds: f64,
}

/// What it drew.
pub(super) struct Drawn {
    /// Linear colours, row by row from the top.
    pub(super) picture: Vec<[f32; 3]>,
    /// How long it says that it traced.
    pub(super) trace_seconds: f64,
    /// From the start of its process to the end.
    pub(super) process_seconds: f64,
}

impl Pov {
    /// None if it is not installed.
    pub(super) fn find() -> Option<Self> {
        let mut command = Command::new("povray");
        let found = command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        found.is_ok_and(|status| status.success()).then_some(Self)
    }

    /// Draws a scene; `None` if that takes too long.
    pub(super) fn draw(&self, job: &Job) -> Result<Option<Drawn>, BenchError> {
        let folder = tempfile::tempdir().map_err(|e| BenchError::system("a folder for POV-Ray", e))?;
        let path = |name: &str| folder.path().join(name);
        let system = |e| BenchError::system("povray", e);
        std::fs::write(path("scene.pov"), &job.text).map_err(system)?;
        let size = job.size;
        let options = [
            "+Iscene.pov".to_owned(),
            "+Oscene.png".to_owned(),
            format!("+W{size}"),
            format!("+H{size}"),
            format!("+WT{}", job.threads),
        ];
        let start = Instant::now();
        let mut child = Command::new("povray")
            .args(options)
            // No window, no anti-aliasing, 16 bits for each colour.
            .args(["-D", "-A", "+FN16", "File_Gamma=sRGB"])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(File::create(path("messages")).map_err(system)?)
            .spawn()
            .map_err(system)?;
        let status = loop {
            if let Some(status) = child.try_wait().map_err(system)? {
                break status;
            }
            if start.elapsed().as_secs_f64() > job.limit_seconds {
                child.kill().and_then(|()| child.wait()).map_err(system)?;
                return Ok(None);
            }
            std::thread::sleep(LOOK);
        };
        let process_seconds = start.elapsed().as_secs_f64();
        let messages = std::fs::read_to_string(path("messages")).map_err(system)?;
        if !status.success() {
            let tail: Vec<&str> = messages.lines().rev().take(12).collect();
            let tail = tail.into_iter().rev().collect::<Vec<_>>().join("\n");
            return Err(BenchError::peer("POV-Ray", format!("it failed:\n{tail}")));
        }
        let trace_seconds = trace_seconds(&messages)
            .ok_or_else(|| BenchError::peer("POV-Ray", "it does not say how long it traced"))?;
        let picture = picture(&path("scene.png"), size)?;
        Ok(Some(Drawn { picture, trace_seconds, process_seconds }))
    }
}

/// From the line `Trace Time: 0 hours 0 minutes 1 seconds (1.234 seconds)`.
fn trace_seconds(messages: &str) -> Option<f64> {
    let line = messages.lines().find(|line| line.trim_start().starts_with("Trace Time:"))?;
    line.split_once('(')?.1.split_whitespace().next()?.parse().ok()
}

fn picture(path: &Path, size: u32) -> Result<Vec<[f32; 3]>, BenchError> {
    let image = read_picture(path).map_err(|e| BenchError::peer("POV-Ray", e))?;
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(size);
    let places = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
    // At the centre of a pixel, nothing of its neighbours is mixed in.
    let colour = |(x, y)| image.at(place(x), place(y), Wrap::Clamp).as_vec3().to_array();
    Ok(places.map(colour).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trace_time_is_read() {
        let text =
            "Parse\n  Trace Time:       0 hours  1 minutes  4 seconds (64.250 seconds)\n  using 2 threads";
        assert_eq!(trace_seconds(text), Some(64.25));
        assert_eq!(trace_seconds("Photon Time: (1.0 seconds)"), None);
    }
}
