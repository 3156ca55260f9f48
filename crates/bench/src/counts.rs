//! Instruction counts: a guard that does not depend on how quiet the machine is.
//!
//! Callgrind counts the instructions of two processes: one prepares a model, the other draws one small frame of it as well,
//! on one thread; the frame is the difference. It shows programs a processor with AVX2 and without AVX-512, so that the same evaluators are counted on every machine; where it does not, nothing is
//! counted.

use crate::error::BenchError;
use crate::plan::Plan;
use crate::report::{CountRow, Report};
use crate::worker::{self, Work};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// The models whose frames are counted: polynomials, sines, exponentials, set operations.
const COUNTED: [&str; 4] = ["tangle", "gyroid", "creature", "gear"];

/// The ratios to the committed counts that pass. More is a loss; less is a gain that wants to be committed.
pub const BAND: (f64, f64) = (0.90, 1.05);

/// Counts what the plan wants.
///
/// # Errors
/// A worker that fails. Where nothing can be counted, that is noted only.
pub(crate) fn measure(
    plan: &Plan,
    report: &mut Report,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let Some(worker) = &plan.worker else {
        report.skipped.push("instruction counts: no program is known that does jobs".to_owned());
        return Ok(());
    };
    if !has_valgrind() {
        let reason = "instruction counts: valgrind does not run here (apt-get install valgrind)";
        report.skipped.push(reason.to_owned());
        return Ok(());
    }
    let committed = committed(plan)?;
    for model in COUNTED.iter().filter(|model| plan.wants(model)) {
        progress(&format!("instructions of {model}"));
        let [setup, both] = ["setup", "frame"].map(|what| count(worker, &format!("{what}:{model}")));
        match (setup?, both?) {
            (Count::Avx2(setup), Count::Avx2(both)) => {
                for (what, instructions) in [("setup", setup), ("frame", both.saturating_sub(setup))] {
                    let job = format!("{model} {what}");
                    let committed = committed.get(&job).copied();
                    report.counts.push(CountRow { job, instructions, committed });
                }
            }
            (Count::Other(vectors), _) | (_, Count::Other(vectors)) => {
                let reason = format!("instructions of {model}: valgrind shows {vectors}, not AVX2");
                report.skipped.push(reason);
            }
        }
    }
    Ok(())
}

/// What was counted.
enum Count {
    /// Instructions, with the evaluators for AVX2.
    Avx2(u64),
    /// Nothing that can be compared: with other evaluators.
    Other(String),
}

fn count(worker: &Path, job: &str) -> Result<Count, BenchError> {
    let inside = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"].map(str::to_owned);
    let (work, messages) = worker::run(worker::command(worker, Some(&inside), job), job)?;
    match (work, collected(&messages)) {
        (Work::Frames { vectors, .. }, Some(instructions)) if vectors == "AVX2" => {
            Ok(Count::Avx2(instructions))
        }
        (Work::Frames { vectors, .. }, Some(_)) => Ok(Count::Other(vectors)),
        _ => Err(BenchError::peer("callgrind", format!("no count of {job}:\n{messages}"))),
    }
}

fn has_valgrind() -> bool {
    let mut command = Command::new("valgrind");
    let quiet = command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

/// From the line `==12== Collected : 123456`.
fn collected(messages: &str) -> Option<u64> {
    let line = messages.lines().find_map(|line| line.split_once("Collected : "))?;
    line.1.split_whitespace().next()?.parse().ok()
}

/// The committed counts; none if there is no such file yet.
fn committed(plan: &Plan) -> Result<BTreeMap<String, u64>, BenchError> {
    let file = &plan.committed;
    match std::fs::read_to_string(file) {
        Ok(text) => {
            serde_json::from_str(&text).map_err(|e| BenchError::model(&file.display().to_string(), e))
        }
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(BTreeMap::new()),
        Err(e) => Err(BenchError::system(file.display(), e)),
    }
}

/// The counts as the file that is committed.
pub fn to_commit(counts: &[CountRow]) -> String {
    let counts: BTreeMap<&str, u64> = counts.iter().map(|row| (row.job.as_str(), row.instructions)).collect();
    // A map of words and whole numbers is always JSON.
    let text = serde_json::to_string_pretty(&counts).unwrap_or_default();
    text + "\n"
}

/// Which counts are outside of the [`BAND`], and what to do.
pub fn outside_of_band(counts: &[CountRow]) -> Vec<String> {
    let (low, high) = BAND;
    let told = |row: &CountRow| {
        let ratio = row.ratio()?;
        let job = &row.job;
        if ratio > high {
            Some(format!("{job} takes {ratio:.3} times the committed instructions, more than {high}"))
        } else if ratio < low {
            Some(format!(
                "{job} takes {ratio:.3} times the committed instructions: commit the gain with --commit"
            ))
        } else {
            None
        }
    };
    counts.iter().filter_map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(instructions: u64, committed: Option<u64>) -> CountRow {
        CountRow { job: "gear".to_owned(), instructions, committed }
    }

    #[test]
    fn the_count_is_read() {
        assert_eq!(collected("==7== \n==7== Collected : 8123456789\n==7== \n"), Some(8_123_456_789));
        assert_eq!(collected("==7== I refs: 12"), None);
    }

    #[test]
    fn losses_and_gains_are_told() {
        assert!(outside_of_band(&[row(104, Some(100)), row(91, Some(100)), row(7, None)]).is_empty());
        let told = outside_of_band(&[row(106, Some(100)), row(80, Some(100))]);
        assert_eq!(told[0], "gear takes 1.060 times the committed instructions, more than 1.05");
        assert!(told[1].contains("commit the gain"), "{told:?}");
    }

    #[test]
    fn counts_are_committed_in_order() {
        let rows = [
            CountRow { job: "b".to_owned(), ..row(2, None) },
            CountRow { job: "a".to_owned(), ..row(1, None) },
        ];
        assert_eq!(to_commit(&rows), "{\n  \"a\": 1,\n  \"b\": 2\n}\n");
    }
}
