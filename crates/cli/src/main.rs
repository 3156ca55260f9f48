//! The program `fieldstone`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to its user")]

mod arguments;
mod bench;
mod check;
mod completions;
mod convert;
mod eval;
mod examples;
mod failure;
mod interrupt;
mod man;
mod measure;
mod plot;
mod progress;
mod render;
mod schema;
mod slice;
mod texel;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let start = Instant::now();
    let outcome = match Arguments::parse().command {
        Command::Render(arguments) => render::run(&arguments, start),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => man::run(&arguments),
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Plot(arguments) => plot::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Texel(command) => texel::run(&command, start),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read the output has seen enough.
        Err(Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::from(failure.code())
        }
    }
}
