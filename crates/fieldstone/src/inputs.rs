//! Values for what a model leaves open.

use fieldstone_field::{Bindings, Input};
use fieldstone_lang::{Model, Parameter};

/// Values for the inputs of a model; the rest has its defaults.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Inputs {
    /// Parameters by name: `a[1]` in HyperFun, the name in a formula. The last of a name counts. Letter case matters
    /// only where names differ in nothing else.
    pub parameters: Vec<(String, f64)>,
    /// Coordinates by number, counted from 1.
    pub coordinates: Vec<(usize, f64)>,
    /// The time.
    pub time: f64,
}

/// Why values do not fit a model.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum InputError {
    /// There is no such parameter.
    #[error("{object} has no parameter `{name}`; {}", known_parameters(known))]
    UnknownParameter {
        /// The object.
        object: String,
        /// What was asked for.
        name: String,
        /// The parameters that there are.
        known: Vec<String>,
    },
    /// There is no such coordinate.
    #[error("{object} has no coordinate {number}: they count from 1 to {count}")]
    UnknownCoordinate {
        /// The object.
        object: String,
        /// What was asked for.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A value is not finite.
    #[error("the value of {name} is {value}, not a finite number")]
    NotFinite {
        /// Of what.
        name: String,
        /// The value.
        value: f64,
    },
}

fn known_parameters(known: &[String]) -> String {
    const MANY: usize = 20;
    match known {
        [] => "it has none".to_owned(),
        _ if known.len() > MANY => format!("it has {}, … ({} in all)", known[..MANY].join(", "), known.len()),
        _ => format!("it has {}", known.join(", ")),
    }
}

impl Inputs {
    /// The values of all inputs of `model`, defaults included; coordinates that are not fixed are 0.
    ///
    /// # Errors
    /// A name or number that the model does not have, a value that is not finite.
    pub fn bindings(&self, model: &Model) -> Result<Bindings, InputError> {
        let mut bindings = Bindings::new();
        for parameter in &model.parameters {
            bindings.set(parameter.input, parameter.default);
        }
        for (name, value) in &self.parameters {
            let wanted: String = name.split_whitespace().collect();
            let parameter =
                find_parameter(&model.parameters, &wanted).ok_or_else(|| InputError::UnknownParameter {
                    object: model.name.clone(),
                    name: name.clone(),
                    known: model.parameters.iter().map(|p| p.name.clone()).collect(),
                })?;
            bindings.set(parameter.input, finite(name, *value)?);
        }
        for &(number, value) in &self.coordinates {
            let index = number.checked_sub(1).filter(|_| number <= model.coordinates);
            let index = index.and_then(|i| u16::try_from(i).ok()).ok_or_else(|| {
                InputError::UnknownCoordinate { object: model.name.clone(), number, count: model.coordinates }
            })?;
            bindings.set(Input::Coordinate(index), finite(&format!("coordinate {number}"), value)?);
        }
        bindings.set(Input::Time, finite("the time", self.time)?);
        Ok(bindings)
    }
}

/// The parameter of that name, or the only one that differs from it in letter case alone.
fn find_parameter<'p>(parameters: &'p [Parameter], name: &str) -> Option<&'p Parameter> {
    let alike: Vec<&Parameter> = parameters.iter().filter(|p| p.name.eq_ignore_ascii_case(name)).collect();
    match alike.as_slice() {
        [only] => Some(only),
        _ => alike.into_iter().find(|p| p.name == name),
    }
}

fn finite(name: &str, value: f64) -> Result<f64, InputError> {
    if value.is_finite() { Ok(value) } else { Err(InputError::NotFinite { name: name.to_owned(), value }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula;

    #[test]
    fn defaults_and_values() {
        let model = formula("r = 2; s = 3; x*r + s + w").unwrap().model;
        let inputs = Inputs {
            parameters: vec![("s".into(), 4.0), ("s".into(), 5.0)],
            coordinates: vec![(4, 7.0)],
            ..Inputs::default()
        };
        let bindings = inputs.bindings(&model).unwrap();
        let value = |name: &str| {
            let parameter = model.parameters.iter().find(|p| p.name == name).unwrap();
            bindings.get(parameter.input)
        };
        assert_eq!((value("r"), value("s")), (2.0, 5.0));
        assert_eq!(bindings.get(Input::Coordinate(3)), 7.0);
    }

    #[test]
    fn letter_case_matters_only_where_it_must() {
        let model = formula("r = 2; s = 3; S = 4; x*r*s*S").unwrap().model;
        let set = |name: &str| {
            let inputs = Inputs { parameters: vec![(name.into(), 9.0)], ..Inputs::default() };
            let bindings = inputs.bindings(&model).ok()?;
            Some(model.parameters.iter().map(|p| bindings.get(p.input)).collect::<Vec<f64>>())
        };
        assert_eq!(set("R"), Some(vec![9.0, 3.0, 4.0]));
        assert_eq!(set("S"), Some(vec![2.0, 3.0, 9.0]));
        assert_eq!(set("s"), Some(vec![2.0, 9.0, 4.0]));
        assert_eq!(set("q"), None);
    }

    #[test]
    fn what_does_not_fit() {
        let model = formula("r = 2; x*r").unwrap().model;
        let message = |inputs: Inputs| inputs.bindings(&model).unwrap_err().to_string();
        let parameter =
            |name: &str, value| Inputs { parameters: vec![(name.into(), value)], ..Inputs::default() };
        let coordinate = |number| Inputs { coordinates: vec![(number, 1.0)], ..Inputs::default() };
        assert_eq!(message(parameter("q", 1.0)), "formula has no parameter `q`; it has r");
        assert_eq!(message(parameter("r", f64::NAN)), "the value of r is NaN, not a finite number");
        for number in [0, 4, usize::MAX] {
            assert!(message(coordinate(number)).ends_with("they count from 1 to 3"));
        }
    }
}
