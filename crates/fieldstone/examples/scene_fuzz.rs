//! Changes scene files by chance, and tells those at which reading or resolving panics or is slow.
//!
//!     cargo run --release -p fieldstone --example scene_fuzz -- SEED COUNT
#![allow(clippy::print_stdout, reason = "a program")]

use fieldstone::{Document, FileAccess, SceneRequest, Source};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// A scene that takes longer is told.
const SLOW: Duration = Duration::from_secs(2);
/// One of so many scenes is resolved too, which takes longer than reading it.
const RESOLVED: u64 = 16;

const EVERYTHING: &str = include_str!("../tests/scenes/everything.toml");
const DOCUMENTS: &str = include_str!("../../../docs/scenes.md");

/// What is put into a text.
const PIECES: [&str; 28] = [
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\n",
    "-",
    "1e400",
    "nan",
    "inf",
    "0",
    "-1",
    "1e-300",
    "\"x\"",
    "\"r\"",
    "\"t\"",
    "\"1/0\"",
    "\"nx\"",
    "\"die\"",
    "\"cube\"",
    "{ 0 = 1, 1 = 2 }",
    "[[objects]]\n",
    "[solids.a]\n",
    "é",
    "\u{0}",
    "99999999999999999999",
    "union = [\"die\"]\n",
];

/// SplitMix64.
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (bits ^ (bits >> 31)) as usize % end.max(1)
    }

    /// A text with a few changes.
    fn change(&mut self, text: &str) -> String {
        let mut text: Vec<char> = text.chars().collect();
        for _ in 0..1 + self.below(4) {
            let at = self.below(text.len() + 1);
            let length = self.below(12).min(text.len() - at);
            match self.below(5) {
                0 => drop(text.drain(at..at + length)),
                1 => {
                    let piece: Vec<char> = text[at..at + length].to_vec();
                    let to = self.below(text.len() + 1);
                    text.splice(to..to, piece);
                }
                2 => {
                    let piece = PIECES[self.below(PIECES.len())];
                    text.splice(at..at + length, piece.chars());
                }
                3 => self.swap_lines(&mut text),
                _ => {
                    let piece = PIECES[self.below(PIECES.len())];
                    // In the place of a value.
                    let equals = (at..text.len()).find(|&i| text[i] == '=').unwrap_or(at);
                    let end =
                        (equals..text.len()).find(|&i| matches!(text[i], '\n' | ',')).unwrap_or(text.len());
                    text.splice((equals + 1).min(end)..end, piece.chars());
                }
            }
        }
        text.into_iter().collect()
    }

    fn swap_lines(&mut self, text: &mut Vec<char>) {
        let all: String = text.iter().collect();
        let mut lines: Vec<&str> = all.lines().collect();
        if !lines.is_empty() {
            let (a, b) = (self.below(lines.len()), self.below(lines.len()));
            lines.swap(a, b);
        }
        *text = lines.join("\n").chars().collect();
    }
}

fn main() -> ExitCode {
    let arguments: Vec<u64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let (seed, count) =
        (arguments.first().copied().unwrap_or(1), arguments.get(1).copied().unwrap_or(100_000));
    let examples = DOCUMENTS.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
    let seeds: Vec<&str> = examples.chain([EVERYTHING]).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes");
    let (mut read, mut resolved, mut faults) = (0, 0, 0);
    for i in 0..count {
        let mut chance = Chance(seed.wrapping_mul(1 << 40).wrapping_add(i));
        let start = chance.below(seeds.len());
        let text = chance.change(seeds[start]);
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let source = Source::new("scene.toml", text.clone());
            match Document::parse(source, &folder, &FileAccess::default()) {
                Err(error) => (error.to_string().is_empty(), false),
                Ok(_) if i % RESOLVED != 0 => (true, false),
                Ok(document) => (true, document.resolve(&SceneRequest::default()).is_ok()),
            }
        }));
        if let Ok((is_read, is_resolved)) = outcome {
            read += u64::from(is_read);
            resolved += u64::from(is_resolved);
        }
        if outcome.is_err() || begin.elapsed() > SLOW {
            faults += 1;
            let what = if outcome.is_err() { "panics" } else { "is slow" };
            println!("{i} {what} after {:?}:\n{text}\n----", begin.elapsed());
        }
    }
    println!("{count} texts, {read} scenes, {resolved} resolved, {faults} faults");
    if faults == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
