//! How large the solid of a model is.

use crate::extent::find_solid;
use crate::inputs::{InputError, Inputs};
use crate::request::Warning;
use fieldstone_lang::Model;
use fieldstone_scene::{Bounds, BoundsError};
use fieldstone_space::{MeasureOptions, Measures, measure};

/// What to measure of a model.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MeasureRequest {
    /// Values of parameters, and of coordinates from the fourth on.
    pub inputs: Inputs,
    /// The box to which the solid is cut; `None`: found by intervals.
    pub bounds: Option<Bounds>,
    /// How closely to measure, and for how long.
    pub options: MeasureOptions,
}

/// What was measured.
#[derive(Clone, PartialEq, Debug)]
pub struct Measured {
    /// The sizes of the part of the solid in `bounds`.
    pub measures: Measures,
    /// The box that was looked at.
    pub bounds: Bounds,
    /// What may not be as expected.
    pub warnings: Vec<Warning>,
}

/// Why nothing can be measured.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum MeasureError {
    /// Inputs that the model does not have.
    #[error(transparent)]
    Input(#[from] InputError),
    /// One of the first three coordinates was fixed.
    #[error("coordinate {0} is an axis of space and cannot be fixed: a section has no volume")]
    AxisFixed(usize),
    /// The model is flat.
    #[error(
        "{object} has {coordinates} coordinates, and a figure in the plane has no volume: declare x[3] and bound \
         it in the third, with `& (1 - x[3]^2)` for example"
    )]
    Flat {
        /// The object.
        object: String,
        /// How many coordinates it has.
        coordinates: usize,
    },
    /// Impossible bounds.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// A tolerance that is none.
    #[error("the tolerance is {0}: it must be above 0 and below 1")]
    Tolerance(f64),
}

impl MeasureRequest {
    /// Measures the solid of a model, at most some seconds long.
    ///
    /// # Errors
    /// Inputs that the model does not have, a model in the plane, a tolerance out of range.
    pub fn measure(&self, model: &Model) -> Result<Measured, MeasureError> {
        let tolerance = self.options.tolerance;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(MeasureError::Tolerance(tolerance));
        }
        if model.coordinates < 3 {
            let (object, coordinates) = (model.name.clone(), model.coordinates);
            return Err(MeasureError::Flat { object, coordinates });
        }
        if let Some(&(number, _)) =
            self.inputs.coordinates.iter().find(|(number, _)| (1..=3).contains(number))
        {
            return Err(MeasureError::AxisFixed(number));
        }
        let bindings = self.inputs.bindings(model)?;
        let (bounds, warning) = match self.bounds {
            Some(bounds) => (bounds, None),
            None => find_solid(&model.field, &bindings)?,
        };
        let corners = (bounds.min().to_array(), bounds.max().to_array());
        let measures = measure(&model.field, &bindings, corners, &self.options);
        // Bounds are never empty, so that this is an error of ours if anybody's.
        let empty = || BoundsError::Empty { axis: 'x', min: bounds.min().x, max: bounds.max().x };
        let measures = measures.ok_or_else(empty)?;
        Ok(Measured { measures, bounds, warnings: warning.into_iter().collect() })
    }
}
