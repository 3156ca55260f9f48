//! Values of the C interpreter, and properties of the formulas.

mod vectors;

use super::{Argument, Context, Kind, lookup};
use crate::Dialect;
use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};

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
    let function = lookup(&name.to_lowercase()).unwrap_or_else(|| panic!("there is no {name}"));
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

#[test]
fn every_name_is_known_once_and_is_lower_case() {
    let names: Vec<_> = super::names().collect();
    for (i, name) in names.iter().enumerate() {
        assert_eq!(lookup(name).map(|f| f.name), Some(*name));
        assert_eq!(*name, name.to_lowercase());
        assert!(!names[..i].contains(name), "{name} is there twice");
    }
}
