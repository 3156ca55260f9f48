//! What is to be measured, and the order in which it is.

use crate::error::BenchError;
use crate::report::{Machine, Report};
use crate::view::Lens;
use crate::{counts, frames, gallery, growth, models, povray};
use std::path::PathBuf;

/// A kind of measurement.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// Frames of models, side by side with fidget.
    Models,
    /// Pictures of the gallery.
    Gallery,
    /// Pictures of Table 1, side by side with POV-Ray.
    Povray,
    /// How cost grows.
    Growth,
    /// Instruction counts.
    Counts,
}

/// What is to be measured, and how.
#[derive(Clone, Debug)]
pub struct Plan {
    /// In which order.
    pub parts: Vec<Part>,
    /// Names of models and files; none: all.
    pub only: Vec<String>,
    /// Pixels along each side.
    pub size: u32,
    /// How many runs of each; what takes longer than five seconds is run three times at most.
    pub runs: u32,
    /// Numbers of threads.
    pub threads: Vec<usize>,
    /// Kinds of views.
    pub lenses: Vec<Lens>,
    /// The folder of the gallery.
    pub gallery: PathBuf,
    /// Where pictures that are compared are left.
    pub pictures: Option<PathBuf>,
    /// The program that runs a job in a process of its own; see [`work`](crate::work).
    pub worker: Option<PathBuf>,
    /// The committed instruction counts.
    pub committed: PathBuf,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            parts: vec![Part::Models, Part::Gallery, Part::Povray],
            only: Vec::new(),
            size: 512,
            runs: 7,
            threads: vec![1, 2],
            lenses: vec![Lens::Perspective, Lens::Parallel],
            gallery: PathBuf::from("gallery"),
            pictures: None,
            worker: None,
            committed: PathBuf::from("gallery/bench/instructions.json"),
        }
    }
}

impl Plan {
    /// Measures; `progress` is told what comes next.
    ///
    /// What this machine lacks is not measured and named in [`Report::skipped`].
    ///
    /// # Errors
    /// A name that nothing has; the first thing that could not be measured.
    pub fn run(&self, progress: &mut dyn FnMut(&str)) -> Result<Report, BenchError> {
        if let Some(name) = self.only.iter().find(|name| !self.is_known(name)) {
            return Err(self.unknown(name));
        }
        let mut report = Report { machine: Machine::this(), ..Report::default() };
        for part in &self.parts {
            match part {
                Part::Models => self.run_models(&mut report, progress)?,
                Part::Gallery => gallery::measure(self, &mut report, progress)?,
                Part::Povray => povray::measure(self, &mut report, progress)?,
                Part::Growth => growth::measure(self, &mut report, progress)?,
                Part::Counts => counts::measure(self, &mut report, progress)?,
            }
        }
        if report.is_empty() && report.skipped.is_empty() {
            return Err(self.unknown(&self.only.join(", ")));
        }
        Ok(report)
    }

    /// Whether there is anything of this name, for one part or another.
    fn is_known(&self, name: &str) -> bool {
        models::MODELS.iter().any(|model| model.name == name)
            || growth::CURVES.iter().any(|(curve, _)| *curve == name)
            || self.gallery.join(name).is_file()
    }

    fn unknown(&self, name: &str) -> BenchError {
        let known = models::MODELS.map(|model| model.name).join(", ");
        let curves = growth::CURVES.map(|(curve, _)| curve).join(", ");
        let known = format!("{known}; {curves}; files of the gallery such as table1/torus.txt");
        BenchError::Unknown { kind: "model", name: name.to_owned(), known }
    }

    /// Whether something of this name is wanted.
    pub(crate) fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == name)
    }

    fn run_models(&self, report: &mut Report, progress: &mut dyn FnMut(&str)) -> Result<(), BenchError> {
        for model in models::MODELS.iter().filter(|model| self.wants(model.name)) {
            progress(model.name);
            report.models.extend(frames::measure(self, model)?);
        }
        if !frames::HAS_FIDGET && !report.models.is_empty() {
            report.skipped.push("fidget: build with `--features peers` (Rust 1.95)".to_owned());
        }
        Ok(())
    }
}

impl Report {
    fn is_empty(&self) -> bool {
        self.models.is_empty()
            && self.gallery.is_empty()
            && self.povray.is_empty()
            && self.growth.is_empty()
            && self.counts.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_name_among_right_ones_is_told() {
        let only = vec!["tangle".to_owned(), "tangel".to_owned()];
        let plan = Plan { only, parts: Vec::new(), ..Plan::default() };
        let told = plan.run(&mut |_| {}).unwrap_err().to_string();
        assert!(told.contains("tangel") && !told.contains("tangle, tangel"), "{told}");
    }
}
