//! The values of `vectors.txt`, which the C interpreter delivers at the point (0.7, −0.4, 1.3).

use super::{Dialect, Given, Kind, Returned, call, lookup};

const POINT: [f64; 3] = [0.7, -0.4, 1.3];

/// The arrays that the rows call by name; `x` and `xt` are the point, `s` is zero.
const ARRAYS: &[(&str, &[f64])] = &[
    ("c", &[0.2, 0.1, -0.3]),
    ("d", &[0.5, 1.0, -2.0]),
    ("p0", &[0.0, 1.0]),
    ("p1", &[0.0, 0.5]),
    ("p2", &[0.2, 1.0]),
    ("w1", &[1.5, 2.0]),
    ("w2", &[0.8, 1.1]),
    ("b1", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
    ("b2", &[0.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
    ("sv", &[1.2, 0.9]),
    ("r1", &[1.5]),
    ("th", &[90.0]),
    ("ax", &[0.0, 0.0, 1.0]),
    ("an", &[30.0]),
    ("s1", &[0.8]),
    ("tri", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5]),
    ("ti", &[1.0, 2.0, 3.0]),
    ("cur", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
    ("bb", &[-1.0, -1.0, -1.0, 2.0, 2.0, 2.0]),
    ("cp", &[-1.0, 0.5, 1.0, 2.0, -0.5, 0.25, 1.5, 0.75]),
    ("cp12", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]),
    ("o1", &[0.2, 0.4, 0.6]),
    ("n3", &[0.0, 0.5, 1.0]),
    ("m9", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
    ("m5", &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 1.0, 0.0, 2.0, 2.0, 2.0, 5.0, 6.0, 7.0]),
    ("m6", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
    ("b3", &[2.0, 2.0, 2.0, 3.0, 3.0, 3.0]),
    ("d3", &[1.0, 1.0, 1.0]),
    ("c3", &[0.5, 0.5, 0.5]),
    ("m3", &[0.0, 0.0, 1.0]),
    ("hs", &[200.0, 0.5, 0.8]),
    ("s", &[0.0, 0.0, 0.0]),
];

/// One line: `dialect name(arguments) [= value] [-> array]`.
struct Row<'t> {
    dialects: &'static [Dialect],
    call: &'t str,
    value: Option<f64>,
    array: Option<Vec<f64>>,
}

impl<'t> Row<'t> {
    fn read(line: &'t str) -> Self {
        let (dialect, rest) = line.split_once(' ').expect("a dialect");
        let dialects: &[Dialect] = match dialect {
            "both" => &[Dialect::Lenient, Dialect::Strict],
            "strict" => &[Dialect::Strict],
            "lenient" => &[Dialect::Lenient],
            other => panic!("no dialect: {other}"),
        };
        let (rest, array) = match rest.split_once(" -> ") {
            Some((rest, array)) => (rest, Some(array.split_whitespace().map(number).collect())),
            None => (rest, None),
        };
        let (call, value) = match rest.split_once(" = ") {
            Some((call, value)) => (call, Some(number(value))),
            None => (rest, None),
        };
        Row { dialects, call: call.trim(), value, array }
    }

    fn check(&self, dialect: Dialect) {
        let (name, arguments) = self.call.trim_end_matches(')').split_once('(').expect("a call");
        let words: Vec<_> = arguments.split(',').collect();
        let given: Vec<_> = words.iter().map(|word| argument(word)).collect();
        let returned = call(dialect, name, &given, &POINT).unwrap_or_else(|e| panic!("{}: {e}", self.call));
        if let Some(expected) = self.value {
            // Twelve digits are printed.
            self.compare(dialect, &[returned.value], &[expected], 1e-9 + 6e-12);
        }
        if let Some(expected) = &self.array {
            // Nine digits.
            self.compare(dialect, &changed_array(name, &words, &returned), expected, 1e-8);
        }
    }

    fn compare(&self, dialect: Dialect, actual: &[f64], expected: &[f64], tolerance: f64) {
        assert_eq!(actual.len(), expected.len(), "{}", self.call);
        for (a, e) in actual.iter().zip(expected) {
            assert!(
                (a - e).abs() <= tolerance,
                "{} ({dialect:?}): {actual:?} instead of {expected:?}",
                self.call
            );
        }
    }
}

fn number(word: &str) -> f64 {
    word.trim().parse().unwrap_or_else(|_| panic!("no number: {word}"))
}

fn argument(word: &str) -> Given {
    if word == "x" || word == "xt" {
        return Given::Point;
    }
    match ARRAYS.iter().find(|(name, _)| *name == word) {
        Some((_, values)) => Given::Array(values.to_vec()),
        None => Given::Real(number(word)),
    }
}

/// The array `xt` or `s` after the call.
fn changed_array(function: &str, words: &[&str], returned: &Returned) -> Vec<f64> {
    let parameters = lookup(&function.to_lowercase(), Dialect::Lenient).expect("a function").parameters;
    let arrays = words.iter().zip(parameters).filter(|(_, (_, kind))| *kind == Kind::Array);
    let position = arrays.map(|(word, _)| *word).position(|word| word == "xt" || word == "s");
    returned.arrays[position.expect("an array that changes")].clone()
}

#[test]
fn the_values_of_the_c_interpreter() {
    let rows: Vec<_> = include_str!("vectors.txt").lines().map(Row::read).collect();
    assert_eq!(rows.len(), 107);
    for row in rows {
        assert!(row.value.is_some() || row.array.is_some());
        for &dialect in row.dialects {
            row.check(dialect);
        }
    }
}
