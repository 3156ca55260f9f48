//! Reads texts made by chance, and tells those at which a front end panics, is slow, or delivers what does not hold
//! together.
//!
//!     cargo run --release -p fieldstone-lang --example fuzz -- SEED COUNT [hyperfun|formula|vm]
#![allow(clippy::print_stdout, reason = "a program")]

#[path = "../tests/texts/mod.rs"]
mod texts;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use texts::{Chance, Language};

/// A text of a few hundred bytes that takes longer is told.
const SLOW: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default| arguments.get(i).and_then(|a| a.parse().ok()).unwrap_or(default);
    let (seed, count) = (number(0, 1), number(1, 100_000));
    let chosen = |language: &Language| arguments.get(2).is_none_or(|name| name == language.name);
    let faults: u64 = Language::all().iter().filter(|l| chosen(l)).map(|l| run(l, seed, count)).sum();
    if faults == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Reads `count` texts of a language; how many of them showed a fault.
fn run(language: &Language, seed: u64, count: u64) -> u64 {
    let (mut models, mut faults) = (0, 0);
    for i in 0..count {
        // Each text has a seed of its own, so that it can be made again alone.
        let mut chance = Chance::new(seed.wrapping_mul(1 << 40).wrapping_add(i));
        let text = language.text(&mut chance);
        let read = |mut chance: Chance| {
            let start = Instant::now();
            let result = catch_unwind(AssertUnwindSafe(|| language.check(&mut chance, text.clone())));
            (result, start.elapsed())
        };
        let (result, mut time) = read(chance.clone());
        if result.is_ok() && time > SLOW {
            // Perhaps the machine was busy.
            time = time.min(read(chance).1);
        }
        models += u64::from(matches!(result, Ok(true)));
        if result.is_err() || time > SLOW {
            faults += 1;
            let what = if result.is_err() { "panics" } else { "is slow" };
            println!("{} {i} {what} after {time:?}:\n{text}\n----", language.name);
        }
    }
    println!("{}: {count} texts, {models} models, {faults} faults", language.name);
    faults
}
