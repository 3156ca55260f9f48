//! Loops that do not end.
//!
//! Whether a data-dependent loop ends cannot be known, only tried: eight points are evaluated with more and more turns,
//! for a second at most. A model most of whose points do not end is an error; where a few do not, they count as
//! undefined, and loops get fewer turns, because each such point costs all of them.

use crate::inputs::{InputError, Inputs};
use crate::load::Loaded;
use fieldstone_field::{Bindings, F64, Field, Points, Tape, TapeOptions, Workspace};
use fieldstone_lang::{Diagnostic, Diagnostics};
use std::time::{Duration, Instant};

/// How many points are tried.
const PROBES: usize = 8;
/// How long they are tried.
const PATIENCE: Duration = Duration::from_secs(1);
/// Loops get at least so many turns.
const LEAST_FUEL: u32 = 1000;
/// Loops get so many times the turns of the longest that ended.
const MARGIN: u32 = 64;

/// Why the loops of a model cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum LoopError {
    /// The loops hardly ever end.
    #[error(transparent)]
    Endless(#[from] Diagnostics),
    /// Inputs that the model does not have.
    #[error(transparent)]
    Input(#[from] InputError),
}

/// Sets how many turns the loops of a model may take at a point: `fuel`, or what a few points show to be enough.
///
/// Models without data-dependent loops are left as they are. Where a few of the tried points do not end, a warning
/// is added to the model's.
///
/// # Errors
/// A model whose loops did not end at most of the tried points, unless `fuel` says how long to wait; inputs that
/// the model does not have.
pub fn settle_loops(loaded: &mut Loaded, inputs: &Inputs, fuel: Option<u32>) -> Result<(), LoopError> {
    let field = &loaded.model.field;
    if let Some(fuel) = fuel {
        loaded.model.field = field.clone().with_fuel(fuel);
        return Ok(());
    }
    if !field.has_loops() {
        return Ok(());
    }
    let trial = Trial::new(field, &inputs.bindings(&loaded.model)?);
    let Some(place) = trial.endless else { return Ok(()) };
    let [x, y, z] = place;
    let message = format!(
        "a loop does not end at {} of {PROBES} points, one of them ({x}, {y}, {z}), within {} turns",
        trial.unfinished, trial.turns
    );
    let place = loaded.model.loops.first().cloned().unwrap_or_default();
    let label = if loaded.model.loops.len() > 1 { "the first loop" } else { "this loop" };
    if trial.unfinished > PROBES / 2 {
        let help = "let its condition fail everywhere, or choose with --fuel after how many turns a point is undefined";
        let error = Diagnostic::error(place, message, label).with_help(help);
        return Err(Diagnostics { source: loaded.source.clone(), list: vec![error] }.into());
    }
    let fuel = trial.longest.saturating_mul(MARGIN).clamp(LEAST_FUEL, field.fuel());
    let help = format!("such points are undefined after {fuel} turns; choose another number with --fuel");
    loaded.model.warnings.push(Diagnostic::warning(place, message, label).with_help(help));
    loaded.model.field = field.clone().with_fuel(fuel);
    Ok(())
}

/// What a few points show.
struct Trial {
    /// How many points did not end.
    unfinished: usize,
    /// One of them.
    endless: Option<[f64; 3]>,
    /// How many turns they were given.
    turns: u32,
    /// The most turns of those that ended.
    longest: u32,
}

impl Trial {
    /// Evaluates with ten times more turns as long as points do not end and time is left.
    fn new(field: &Field, bindings: &Bindings) -> Self {
        let start = Instant::now();
        let mut fuel = LEAST_FUEL.min(field.fuel());
        loop {
            let round = Instant::now();
            let trial = Self::with_fuel(field, bindings, fuel);
            let next = fuel.saturating_mul(10).min(field.fuel());
            let is_late = start.elapsed() + round.elapsed() * (next / fuel.max(1)) > PATIENCE;
            if trial.endless.is_none() || next == fuel || is_late {
                return trial;
            }
            fuel = next;
        }
    }

    fn with_fuel(field: &Field, bindings: &Bindings, fuel: u32) -> Self {
        let options = TapeOptions { bindings: bindings.clone(), attributes: true, ..TapeOptions::default() };
        let tape = Tape::new(&field.clone().with_fuel(fuel), &options);
        let mut workspace = Workspace::<F64, Points>::new();
        for axis in 0..3 {
            for (lane, x) in workspace.input(axis, 0).iter_mut().take(PROBES).enumerate() {
                *x = probe(lane)[axis];
            }
        }
        workspace.run(&tape, PROBES);
        let turns: Vec<f64> = (0..PROBES).map(|lane| workspace.turns(lane)).collect();
        let endless = turns.iter().position(|turns| turns.is_infinite());
        Self {
            unfinished: turns.iter().filter(|turns| turns.is_infinite()).count(),
            endless: endless.map(probe),
            turns: fuel,
            longest: turns.iter().filter(|t| t.is_finite()).fold(0.0, |most: f64, t| most.max(*t)) as u32,
        }
    }
}

/// A point in each octant, no two at the same distance from anything.
fn probe(number: usize) -> [f64; 3] {
    let side = |axis: usize| if number >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let reach = 0.25 * (number + 1) as f64;
    [0.72 * side(0) * reach, 0.56 * side(1) * reach, 0.41 * side(2) * reach]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_lang::{HyperFunOptions, Source, parse_hyperfun};

    fn loaded(body: &str) -> Loaded {
        let source = Source::new("a.hf", format!("my_model(x[3], a[1]) {{ {body} }}"));
        Loaded { model: parse_hyperfun(&source, &HyperFunOptions::default()).unwrap(), source }
    }

    fn settle(body: &str, fuel: Option<u32>) -> Result<Loaded, LoopError> {
        let mut loaded = loaded(body);
        settle_loops(&mut loaded, &Inputs::default(), fuel).map(|()| loaded)
    }

    #[test]
    fn loops_that_end_are_left_alone() {
        let settled =
            settle("r = abs(x[1]); while r > 0.01 loop r = r/2; endloop; my_model = r;", None).unwrap();
        assert_eq!(settled.model.field.fuel(), loaded("my_model = x[1];").model.field.fuel());
        assert!(settled.model.warnings.is_empty());
    }

    #[test]
    fn a_model_that_never_ends_is_an_error_unless_its_turns_are_chosen() {
        let endless = "r = x[1]; while r*r >= 0 loop r = r + 1; endloop; my_model = r;";
        let error = settle(endless, None).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.contains("a.hf:1:34")
                && error.contains("does not end at 8 of 8 points")
                && error.contains("--fuel"),
            "{error}"
        );
        assert_eq!(settle(endless, Some(50)).unwrap().model.field.fuel(), 50);
    }

    #[test]
    fn places_that_do_not_end_are_a_warning_and_cost_little() {
        let partly = "r = x[1]; while (r > 0.1) and (x[2] > 0) loop r = r + 1; endloop; my_model = r;";
        let settled = settle(partly, None).unwrap();
        assert_eq!(settled.model.field.fuel(), LEAST_FUEL);
        let warning = settled.rendered_warnings().next().unwrap();
        assert!(warning.contains("at 2 of 8 points") && warning.contains("after 1000 turns"), "{warning}");
    }
}
