//! Every model in `tests/golden` has the values that the C interpreter computes for it.
//!
//! A table has a header line and the columns x y z f, and s1 s2 s3 where the model has attributes; f is in the sign
//! of the file.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use fieldstone_field::Bindings;
use fieldstone_lang::{Dialect, HyperFunOptions, Source, parse_hyperfun};
use std::path::Path;

/// Models whose values are those of the strict dialect only.
const STRICT: &[&str] = &[];

/// Relative above 1, absolute below. The distance to an ellipsoid comes from an iteration that stops early.
fn tolerance(name: &str) -> f64 {
    if name.starts_with("dellipsoid") { 1e-8 } else { 1e-9 }
}

fn matches(expected: f64, actual: f64, tolerance: f64) -> bool {
    if expected.is_nan() || expected.is_infinite() {
        return expected.to_bits() == actual.to_bits() || (expected.is_nan() && actual.is_nan());
    }
    (expected - actual).abs() <= tolerance * expected.abs().max(1.0)
}

/// The differences of a model from its table, and how many values were compared.
fn compare(path: &Path) -> (Vec<String>, usize) {
    let name = path.file_stem().unwrap().to_string_lossy().into_owned();
    let source = Source::new(&*name, std::fs::read_to_string(path).unwrap());
    let dialect = if STRICT.contains(&&*name) { Dialect::Strict } else { Dialect::Lenient };
    let model = match parse_hyperfun(&source, &HyperFunOptions { object: None, dialect }) {
        Ok(model) => model,
        Err(diagnostics) => return (vec![format!("{diagnostics}")], 0),
    };
    let table = std::fs::read_to_string(path.with_extension("tsv")).unwrap();
    let (mut differences, mut compared) = (Vec::new(), 0);
    for line in table.lines().skip(1).filter(|line| !line.trim().is_empty()) {
        let columns: Vec<f64> = line.split('\t').map(|c| c.trim().parse().unwrap()).collect();
        let mut actual = model.field.at(&columns[..3], &Bindings::new());
        actual[0] = -actual[0];
        for (i, expected) in columns[3..].iter().enumerate() {
            compared += 1;
            if !matches(*expected, actual[i], tolerance(&name)) {
                differences.push(format!(
                    "{name} at {:?}, column {}: {expected} is {}",
                    &columns[..3],
                    i + 4,
                    actual[i]
                ));
            }
        }
    }
    (differences, compared)
}

#[test]
fn golden_tables_match() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let mut models: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    models.retain(|path| path.extension().is_some_and(|e| e == "hf"));
    models.sort();
    assert!(models.len() >= 10, "only {} models found", models.len());
    let mut all = Vec::new();
    for path in &models {
        let (differences, compared) = compare(path);
        assert!(compared > 0 || !differences.is_empty(), "{} compares nothing", path.display());
        all.extend(differences.into_iter().take(3));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn the_comparison_rejects_what_is_wrong() {
    assert!(
        matches(1.0, 1.0 + 1e-10, 1e-9)
            && matches(1e6, 1e6 + 1e-4, 1e-9)
            && matches(f64::NAN, f64::NAN, 1e-9)
    );
    assert!(!matches(1.0, 1.0 + 2e-9, 1e-9) && !matches(1.0, f64::NAN, 1e-9) && !matches(0.0, 2e-9, 1e-9));
}
