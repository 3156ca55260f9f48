//! Models as texts of another language.

use crate::inputs::{InputError, Inputs};
use fieldstone_field::Input;
use fieldstone_lang::{Model, PrintError, Printed, Syntax, print_model};

/// Why a model cannot be converted.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ConvertError {
    /// Inputs that the model does not have.
    #[error(transparent)]
    Input(#[from] InputError),
    /// What the language has no words for.
    #[error(transparent)]
    Print(#[from] PrintError),
}

/// Writes a model in a language, see [`print_model`].
///
/// The coordinates of `inputs` become constants. Its parameters stay parameters where the language has them; their
/// values are their new defaults.
///
/// # Errors
/// Inputs that the model does not have; what the language has no words for.
pub fn convert(model: &Model, inputs: &Inputs, syntax: Syntax) -> Result<Printed, ConvertError> {
    let bindings = inputs.bindings(model)?;
    let mut model = model.clone();
    for parameter in &mut model.parameters {
        parameter.default = bindings.get(parameter.input);
    }
    let index = |number: usize| u16::try_from(number.saturating_sub(1)).ok();
    let fixed: Vec<(Input, f64)> = inputs
        .coordinates
        .iter()
        .rev()
        .filter_map(|&(number, value)| Some((Input::Coordinate(index(number)?), value)))
        .collect();
    Ok(print_model(&model, syntax, &fixed)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula;

    #[test]
    fn values_are_new_defaults_and_coordinates_are_fixed() {
        let model = formula("r = 2; x^2 + w - r").unwrap().model;
        let parameters = vec![("r".to_owned(), 3.0)];
        let inputs = Inputs { parameters, coordinates: vec![(4, 1.0), (4, 0.5)], ..Inputs::default() };
        assert_eq!(convert(&model, &inputs, Syntax::Formula).unwrap().text, "r = 3;\nx^2 + 0.5 - r\n");
    }

    #[test]
    fn wrong_inputs_are_errors() {
        let model = formula("x").unwrap().model;
        let inputs = Inputs { coordinates: vec![(9, 1.0)], ..Inputs::default() };
        assert!(matches!(convert(&model, &inputs, Syntax::Vm), Err(ConvertError::Input(_))));
    }
}
