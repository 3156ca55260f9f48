//! `fieldstone eval`: a filter from points to values, line by line; empty lines stay empty.

use crate::arguments::EvalArguments;
use crate::failure::Failure;
use fieldstone::Evaluator;
use std::fmt;
use std::io::{self, BufRead, BufWriter, Write};

/// How many points are evaluated together.
const BLOCK: usize = 1024;

/// Reads points from standard input and prints their values.
pub(crate) fn run(arguments: &EvalArguments) -> Result<(), Failure> {
    let loaded = arguments.model.load()?;
    let mut evaluator = Evaluator::new(&loaded.model, &arguments.model.inputs())?;
    let mut output = BufWriter::new(io::stdout().lock());
    let filtered = filter(&mut evaluator, io::stdin().lock(), &mut output);
    // What was right before a wrong line is printed all the same.
    let flushed = output.flush().map_err(|e| Failure::of_stream("standard output", &e));
    filtered.and(flushed)
}

fn filter(
    evaluator: &mut Evaluator,
    mut input: impl BufRead,
    output: &mut impl Write,
) -> Result<(), Failure> {
    let mut line = String::new();
    let mut points = Vec::with_capacity(BLOCK * evaluator.columns());
    let mut number = 0;
    let mut waiting = 0;
    loop {
        line.clear();
        let read = input.read_line(&mut line).map_err(|e| Failure::of_stream("standard input", &e))?;
        number += 1;
        if read > 0 && line.trim().is_empty() && evaluator.columns() > 0 {
            print(evaluator, &points, waiting, output)?;
            (waiting, points) = (0, Vec::with_capacity(points.capacity()));
            writeln!(output).map_err(|e| Failure::of_stream("standard output", &e))?;
            continue;
        }
        let parsed = if read == 0 { Ok(()) } else { parse(&line, number, evaluator.columns(), &mut points) };
        waiting += usize::from(read > 0 && parsed.is_ok());
        if read == 0 || waiting == BLOCK || parsed.is_err() {
            print(evaluator, &points, waiting, output)?;
            (waiting, points) = (0, Vec::with_capacity(points.capacity()));
        }
        parsed?;
        if read == 0 {
            return Ok(());
        }
    }
}

/// Appends the numbers of a line; nothing of a line that is wrong.
fn parse(line: &str, number: u64, columns: usize, points: &mut Vec<f64>) -> Result<(), Failure> {
    let before = points.len();
    for word in line.split_ascii_whitespace() {
        match word.parse() {
            Ok(coordinate) => points.push(coordinate),
            Err(_) => {
                points.truncate(before);
                return Err(Failure::Material(format!(
                    "standard input, line {number}: `{word}` is not a number"
                )));
            }
        }
    }
    let found = points.len() - before;
    if found == columns {
        return Ok(());
    }
    points.truncate(before);
    Err(Failure::Material(format!(
        "standard input, line {number}: a point has {columns} coordinates here, not {found}"
    )))
}

fn print(
    evaluator: &mut Evaluator,
    points: &[f64],
    count: usize,
    output: &mut impl Write,
) -> Result<(), Failure> {
    let mut results = Vec::with_capacity(count * evaluator.outputs());
    match evaluator.columns() {
        // Every line is the same point.
        0 => (0..count).for_each(|_| evaluator.evaluate(&[], &mut results)),
        _ => evaluator.evaluate(points, &mut results),
    }
    for row in results.chunks(evaluator.outputs()) {
        let (first, rest) = row.split_at(1);
        first
            .iter()
            .try_for_each(|&value| write!(output, "{}", Shortest(value)))
            .and_then(|()| rest.iter().try_for_each(|&value| write!(output, "\t{}", Shortest(value))))
            .and_then(|()| writeln!(output))
            .map_err(|e| Failure::of_stream("standard output", &e))?;
    }
    Ok(())
}

/// A number in the shortest form that reads back exactly; `undefined` for what is none.
struct Shortest(f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value.is_nan() {
            return f.write_str("undefined");
        }
        // `{:?}` changes to exponents where they are shorter, but writes whole numbers with a point.
        let is_plain = value.fract() == 0.0 && value.abs() < 1e16;
        if is_plain { write!(f, "{value}") } else { write!(f, "{value:?}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        let cases = [
            (1.0, "1"),
            (-250.0, "-250"),
            (0.0, "0"),
            (0.1, "0.1"),
            (1e16, "1e16"),
            (1.5e-7, "1.5e-7"),
            (1.0 / 3.0, "0.3333333333333333"),
            (f64::MAX, "1.7976931348623157e308"),
            (5e-324, "5e-324"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (value, text) in cases {
            assert_eq!(Shortest(value).to_string(), text);
            assert_eq!(text.parse(), Ok(value));
        }
        assert_eq!(Shortest(f64::NAN).to_string(), "undefined");
    }
}
