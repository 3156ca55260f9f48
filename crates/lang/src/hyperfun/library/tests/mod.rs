//! Values of the C interpreter, and properties of the formulas.

mod convolution;
mod distances;
mod formulas;
mod noise;
mod vectors;

use super::{Argument, Context, Kind, lookup};
use crate::Dialect;
use fieldstone_field::{Bindings, Field, Function, Graph, Input, Interval, NodeId};

/// A call with numbers, of which `x` may stand for the point.
#[derive(Clone, Debug)]
enum Given {
    Real(f64),
    Array(Vec<f64>),
    /// The coordinates of the point, as inputs of the program.
    Point,
}

/// What a call returned, and its arrays after it.
#[derive(Debug)]
struct Returned {
    value: f64,
    arrays: Vec<Vec<f64>>,
}

/// Calls a function by the name as models spell it, at `point`.
fn call(dialect: Dialect, name: &str, given: &[Given], point: &[f64]) -> Result<Returned, String> {
    let function =
        lookup(&name.to_lowercase(), Dialect::Lenient).unwrap_or_else(|| panic!("there is no {name}"));
    let mut graph = Graph::new();
    let mut arguments: Vec<Argument> = given.iter().map(|g| argument(&mut graph, g, point.len())).collect();
    let mut context = Context { graph: &mut graph, dialect };
    let value = (function.body)(&mut context, &mut arguments)?;
    let arrays: Vec<Vec<NodeId>> = arguments
        .into_iter()
        .filter_map(|a| match a {
            Argument::Array(ids) => Some(ids),
            Argument::Real(_) => None,
        })
        .collect();
    let field = Field::new(graph, value, arrays.concat());
    let values = field.at(point, &Bindings::new());
    let mut rest = &values[1..];
    let arrays = arrays.iter().map(|ids| rest.split_off(..ids.len()).expect("one value for each").to_vec());
    Ok(Returned { value: values[0], arrays: arrays.collect() })
}

fn argument(graph: &mut Graph, given: &Given, dimension: usize) -> Argument {
    match given {
        Given::Real(value) => Argument::Real(graph.constant(*value)),
        Given::Array(values) => Argument::Array(values.iter().map(|&v| graph.constant(v)).collect()),
        Given::Point => {
            Argument::Array((0..dimension).map(|i| graph.input(Input::Coordinate(i as u16))).collect())
        }
    }
}

/// The value of a call in the lenient dialect.
fn value(name: &str, given: &[Given], point: &[f64]) -> f64 {
    call(Dialect::Lenient, name, given, point).expect("the call is right").value
}

/// A reproducible stream of numbers.
struct Random(u64);

impl Random {
    fn below_one(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below_one()
    }

    fn point<const N: usize>(&mut self, range: [(f64, f64); N]) -> [f64; N] {
        range.map(|(low, high)| self.between(low, high))
    }

    /// A box inside a range, often a small or a flat one.
    fn cell<const N: usize>(&mut self, range: [(f64, f64); N]) -> [Interval<f64>; N] {
        range.map(|(low, high)| {
            let lo = self.between(low, high);
            let reach = if self.below_one() < 0.2 { 0.0 } else { 10f64.powf(self.between(-16.0, 0.0)) };
            Interval { lo, hi: lo + reach * (high - lo) }
        })
    }

    /// A point of a box, often a corner.
    fn inside<const N: usize>(&mut self, cell: [Interval<f64>; N]) -> [f64; N] {
        cell.map(|side| match self.below_one() {
            chance if chance < 0.25 => side.lo,
            chance if chance < 0.5 => side.hi,
            _ => self.between(side.lo, side.hi).clamp(side.lo, side.hi),
        })
    }
}

/// Checks that the interval of each of many boxes is known and holds the values at points of the box.
fn check_inclusion<const N: usize>(function: &dyn Function, range: [(f64, f64); N]) {
    let mut random = Random(1);
    for _ in 0..8000 {
        let cell = random.cell(range);
        let interval = function.interval(&cell);
        for _ in 0..20 {
            let point = random.inside(cell);
            let value = function.value(&point);
            assert!(
                interval.lo <= value && value <= interval.hi,
                "{} at {point:?} is {value}, outside {interval:?} of {cell:?}",
                function.name()
            );
        }
    }
    let nothing = [Interval::undefined(); N];
    assert!(function.interval(&nothing).lo.is_nan());
}

/// Checks the gradient against central differences at points of a range, except the few near a crease.
fn check_gradient<const N: usize>(function: &dyn Function, range: [(f64, f64); N]) {
    let mut random = Random(2);
    let mut wrong = 0;
    for _ in 0..2000 {
        let point = random.point(range);
        let mut gradient = [0.0; N];
        function.gradient(&point, &mut gradient);
        let is_right = (0..N).all(|k| {
            let (mut above, mut below) = (point, point);
            above[k] += 1e-6;
            below[k] -= 1e-6;
            let slope = (function.value(&above) - function.value(&below)) / (above[k] - below[k]);
            (slope - gradient[k]).abs() < 1e-6 * slope.abs().max(1.0)
        });
        wrong += usize::from(!is_right);
    }
    assert!(wrong <= 10, "{wrong} of 2000 gradients of {} are wrong", function.name());
}

#[test]
fn every_name_is_known_once_and_is_lower_case() {
    let names: Vec<_> = super::names().collect();
    for (i, name) in names.iter().enumerate() {
        assert_eq!(lookup(name, Dialect::Lenient).map(|f| f.name), Some(*name));
        assert_eq!(*name, name.to_lowercase());
        assert!(!names[..i].contains(name), "{name} is there twice");
    }
}

#[test]
fn every_function_has_a_case_in_the_inclusion_test() {
    let cases = include_str!("../../../../tests/library/cases.txt");
    let named: Vec<&str> =
        cases.lines().filter_map(|line| line.split_once(": ")).map(|(name, _)| name).collect();
    let missing: Vec<_> = super::names().filter(|name| !named.contains(name)).collect();
    assert!(missing.is_empty(), "no case for {missing:?}");
    let unknown: Vec<_> = named.iter().filter(|name| lookup(name, Dialect::Lenient).is_none()).collect();
    // The comment line names what a row looks like.
    assert_eq!(unknown, [&"# One call of every function of the library"]);
}
