//! Numbers of a scene at a time: constants, formulas of parameters, and keys.

use super::expression::{self, Names};
use super::fault::{Fault, Outcome};
use super::tree::{Entry, Kind, Table, Value};
use super::{Document, MAX_DEPTH};
use fieldstone_field::{Bindings, Field, Graph, Input};
use fieldstone_lang::Diagnostic;
use std::cell::RefCell;
use std::collections::HashMap;

/// How values between keys are found.
pub(super) const INTERPOLATIONS: [&str; 4] = ["linear", "smooth", "step", "cubic"];

/// The numbers of a document at a time.
#[derive(Debug)]
pub(super) struct Numbers<'d> {
    document: &'d Document,
    time: f64,
    /// Values that were given from outside.
    given: &'d [(String, f64)],
    known: RefCell<HashMap<String, f64>>,
    /// The parameters that are being computed.
    open: RefCell<Vec<String>>,
}

impl<'d> Numbers<'d> {
    pub(super) fn new(document: &'d Document, time: f64, given: &'d [(String, f64)]) -> Self {
        Self { document, time, given, known: RefCell::default(), open: RefCell::default() }
    }

    pub(super) fn document(&self) -> &'d Document {
        self.document
    }

    pub(super) fn time(&self) -> f64 {
        self.time
    }

    /// The value of a parameter of the scene; `None` if there is none of this name.
    pub(super) fn parameter(&self, name: &str, used_at: &Value) -> Outcome<Option<f64>> {
        let Some(entry) = self.document.parameter(name) else { return Ok(None) };
        if let Some((_, value)) = self.given.iter().rev().find(|(given, _)| given == name) {
            return Ok(Some(*value));
        }
        if let Some(&value) = self.known.borrow().get(name) {
            return Ok(Some(value));
        }
        let mut path = self.open.borrow().clone();
        if path.iter().any(|open| open == name) {
            path.push(name.to_owned());
            let message = format!("the parameter `{name}` depends on itself: {}", path.join(" → "));
            return Err(used_at.error(message, "a circle").into());
        }
        if path.len() >= MAX_DEPTH {
            return Err(used_at
                .error(format!("parameters depend on more than {MAX_DEPTH} others"), "here")
                .into());
        }
        self.open.borrow_mut().push(name.to_owned());
        let value = self.number(&entry.value);
        self.open.borrow_mut().pop();
        let value = value?;
        self.known.borrow_mut().insert(name.to_owned(), value);
        Ok(Some(value))
    }

    /// A number at this time.
    pub(super) fn number(&self, value: &Value) -> Outcome<f64> {
        let found = match &value.kind {
            Kind::Number(number) => *number,
            Kind::Text(text) => self.formula(value, text)?,
            Kind::Table(table) => self.keyed(table, |v| Ok(vec![self.number(v)?]))?[0],
            _ => return Err(value.error("a number is needed", "expected a number").into()),
        };
        if found.is_finite() {
            return Ok(found);
        }
        let message = format!("this is {found} at t = {}, not a finite number", self.time);
        Err(value.error(message, "not finite").into())
    }

    /// A number in a range, which is also told in words.
    pub(super) fn ranged(&self, value: &Value, (least, most, words): (f64, f64, &str)) -> Outcome<f64> {
        let found = self.number(value)?;
        if (least..=most).contains(&found) {
            return Ok(found);
        }
        Err(value
            .error(format!("this is a number {words}, not {found}"), format!("expected a number {words}"))
            .into())
    }

    /// So many numbers at this time, as one list or keyed lists.
    pub(super) fn numbers<const N: usize>(&self, value: &Value) -> Outcome<[f64; N]> {
        let found = match &value.kind {
            Kind::List(list) => list.iter().map(|v| self.number(v)).collect::<Outcome<Vec<f64>>>()?,
            Kind::Table(table) => self.keyed(table, |v| Ok(self.numbers::<N>(v)?.to_vec()))?,
            _ => Vec::new(),
        };
        let wrong = || value.error(format!("{N} numbers are needed"), format!("expected {N} numbers")).into();
        found.try_into().map_err(|_| wrong())
    }

    fn formula(&self, value: &Value, text: &str) -> Outcome<f64> {
        let names = Names { parameters: true, fields: false, normal: false };
        let read = expression::read(self.document, value, text, names)?;
        let mut graph = Graph::new();
        let mut values = HashMap::new();
        for name in &read.names {
            if let Some(number) = self.parameter(name, value)? {
                values.insert(name.clone(), number);
            }
        }
        let mut wrong = None;
        let output =
            graph.import(read.model.field.graph(), &[read.model.field.value()], |g, input| match input {
                Input::Time => g.constant(self.time),
                Input::Coordinate(k) => {
                    wrong = Some(["x", "y", "z", "w"][usize::from(k).min(3)]);
                    g.constant(0.0)
                }
                Input::Parameter(_) => {
                    let number = read
                        .parameter(input)
                        .map_or(0.0, |p| values.get(&p.name).copied().unwrap_or(p.default));
                    g.constant(number)
                }
            });
        if let Some(coordinate) = wrong {
            let message = format!("a number cannot depend on {coordinate}");
            let error = value.error(message, "a formula of t and parameters is needed");
            return Err(error.with_help("functions of space stand in [fields], solids and materials").into());
        }
        let field = Field::new(graph, output[0], Vec::new());
        Ok(field.at(&[], &Bindings::new())[0])
    }

    /// The value at this time between keys; each key has as many numbers as the others.
    pub(super) fn keyed(
        &self,
        table: &Table,
        read: impl Fn(&Value) -> Outcome<Vec<f64>>,
    ) -> Outcome<Vec<f64>> {
        let mut keys: Vec<(f64, &Entry)> =
            table.entries.iter().filter_map(|e| Some((e.key.parse::<f64>().ok()?, e))).collect();
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(twice) = keys.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
            let message = format!("there are two keys at the time {}", twice[1].0);
            return Err(Diagnostic::error(twice[1].1.key_span.clone(), message, "the second").into());
        }
        let next = keys.partition_point(|(time, _)| *time <= self.time);
        let at = |i: usize| read(&keys[i].1.value);
        if keys.is_empty() {
            return Err(Fault::from(Diagnostic::error(
                table.span.clone(),
                "there is no key",
                "expected keys",
            )));
        }
        if next == 0 || next == keys.len() {
            return at(next.saturating_sub(1));
        }
        let (start, end) = (keys[next - 1].0, keys[next].0);
        let share = (self.time - start) / (end - start);
        let interpolation = table.get("interpolation").and_then(Value::text).unwrap_or("linear");
        let (from, to) = (at(next - 1)?, at(next)?);
        let blend = |share: f64| from.iter().zip(&to).map(|(a, b)| a + (b - a) * share).collect();
        Ok(match interpolation {
            "step" => from,
            "smooth" => blend(share * share * (3.0 - 2.0 * share)),
            "cubic" => {
                let before = if next >= 2 { Some((keys[next - 2].0, at(next - 2)?)) } else { None };
                let after =
                    if next + 1 < keys.len() { Some((keys[next + 1].0, at(next + 1)?)) } else { None };
                cubic([(start, from), (end, to)], [before, after], share)
            }
            _ => blend(share),
        })
    }
}

type Timed = (f64, Vec<f64>);

/// Cubic Hermite interpolation with the slopes of Catmull and Rom (1974) for keys that need not be evenly apart; the
/// slope at the first and the last key is that to their neighbour.
fn cubic([start, end]: [Timed; 2], [before, after]: [Option<Timed>; 2], share: f64) -> Vec<f64> {
    let length = end.0 - start.0;
    let (s2, s3) = (share * share, share * share * share);
    let slope = |a: &Timed, b: &Timed, i: usize| (b.1[i] - a.1[i]) / (b.0 - a.0);
    let value = |i: usize| {
        let from = slope(before.as_ref().unwrap_or(&start), &end, i) * length;
        let to = slope(&start, after.as_ref().unwrap_or(&end), i) * length;
        (2.0 * s3 - 3.0 * s2 + 1.0) * start.1[i]
            + (s3 - 2.0 * s2 + share) * from
            + (3.0 * s2 - 2.0 * s3) * end.1[i]
            + (s3 - s2) * to
    };
    (0..start.1.len()).map(value).collect()
}
