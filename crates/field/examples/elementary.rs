//! What elementary functions cost over lanes and in the standard library: nanoseconds for one number.
//!
//! `cargo run --release -p fieldstone-field --example elementary` prints a table. Every time is the least of several runs over
//! the same 64 arguments; loading and storing them is part of it.

#![allow(clippy::print_stdout, reason = "it prints a table")]

use fieldstone_field::*;
use std::hint::black_box;
use std::time::Instant;

/// Blocks of 64 arguments in a run, and runs.
const BLOCKS: usize = 2_000;
const RUNS: usize = 15;

type Meaning = fn(f64, f64) -> f64;

fn main() {
    let functions: [(&str, Meaning, f64); 15] = [
        ("add", |x, y| x + y, 2.0),
        ("exp", |x, _| x.exp(), 20.0),
        ("ln", |x, _| x.abs().ln(), 20.0),
        ("pow", |x, y| x.abs().powf(y), 8.0),
        ("sin", |x, _| x.sin(), 20.0),
        ("cos", |x, _| x.cos(), 20.0),
        ("tan", |x, _| x.tan(), 20.0),
        ("asin", |x, _| x.asin(), 1.0),
        ("acos", |x, _| x.acos(), 1.0),
        ("atan", |x, _| x.atan(), 5.0),
        ("atan2", f64::atan2, 5.0),
        ("sinh", |x, _| x.sinh(), 3.0),
        ("cosh", |x, _| x.cosh(), 3.0),
        ("tanh", |x, _| x.tanh(), 2.0),
        ("atanh", |x, _| x.atanh(), 1.0),
    ];
    println!("ns for one     lanes f64  baseline f64     lanes f32       library      intervals f64");
    for (name, library, reach) in functions {
        let arguments: Vec<(f64, f64)> = (0..LANES).map(|i| argument(name, i, reach)).collect();
        let tape = tape(name);
        println!(
            "{name:10} {:12.2} {:13.2} {:13.2} {:13.2} {:13.2}",
            lanes::<F64, Points>(Workspace::new(), 1, &tape, &arguments),
            lanes::<F64, Points>(Workspace::baseline(), 1, &tape, &arguments),
            lanes::<F32, Points>(Workspace::new(), 1, &tape, &arguments),
            one_by_one(library, &arguments),
            lanes::<F64, Intervals>(Workspace::new(), 2, &tape, &arguments),
        );
    }
}

/// Arguments between ±`reach`; positive ones for the functions that want them.
fn argument(name: &str, i: usize, reach: f64) -> (f64, f64) {
    let [x, y] = [0.754_877_666, 0.569_840_291].map(|s| (((i as f64 + 0.7) * s).fract() - 0.5) * 2.0 * reach);
    if matches!(name, "ln" | "pow") { (x.abs(), y) } else { (x, y) }
}

fn tape(name: &str) -> Tape {
    let mut g = Graph::new();
    let (x, y) = (g.input(Input::Coordinate(0)), g.input(Input::Coordinate(1)));
    let unary = Unary::ALL.iter().find(|op| op.name() == name).map(|&op| g.unary(op, x));
    let binary = Binary::ALL.iter().find(|op| op.name() == name).map(|&op| g.binary(op, x, y));
    let value = unary.or(binary).unwrap_or(x);
    Tape::new(&Field::new(g, value, Vec::new()), &TapeOptions::default())
}

/// The least time of a run, divided by its numbers.
fn least(mut block: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        (0..BLOCKS).for_each(|_| block());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / (BLOCKS * LANES) as f64
}

/// Evaluation over 64 lanes; a point fills every one of the components.
fn lanes<P: Precision, K: Engine<P>>(
    mut w: Workspace<P, K>,
    components: usize,
    tape: &Tape,
    arguments: &[(f64, f64)],
) -> f64 {
    for (lane, &(x, y)) in arguments.iter().enumerate() {
        for component in 0..components {
            w.input(0, component)[lane] = Scalar::from_f64(x);
            w.input(1, component)[lane] = Scalar::from_f64(y);
        }
    }
    least(|| {
        w.run(tape, LANES);
        black_box(w.output(0, 0));
    })
}

fn one_by_one(function: Meaning, arguments: &[(f64, f64)]) -> f64 {
    let mut results = [0.0; LANES];
    least(|| {
        for (result, &(x, y)) in results.iter_mut().zip(black_box(arguments)) {
            *result = function(x, y);
        }
        black_box(&results);
    })
}
