//! From a model and a few wishes to a slice.

use crate::inputs::{InputError, Inputs};
use crate::presentation;
use fieldstone_field::Input;
use fieldstone_lang::{FileSign, Model};
use fieldstone_render::{Slice, SliceStyle, Window, WindowExtent, find_window};
use fieldstone_scene::{BallError, Bounds};
use std::fmt;

/// A plane at right angles to an axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plane {
    /// The axis, counted from 0: x, y or z.
    pub axis: usize,
    /// Where the plane crosses it.
    pub at: f64,
}

/// What to draw of a model on a plane; what is not given is chosen so that the picture is good.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SliceRequest {
    /// Values of parameters, and of coordinates from the fourth on.
    pub inputs: Inputs,
    /// The plane; a model that does not depend on z needs none.
    pub plane: Option<Plane>,
    /// What to show, of which the part on the plane counts; `None`: found by intervals.
    pub bounds: Option<Bounds>,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// How to draw it.
    pub style: SliceStyle,
}

/// What may not be as expected of a slice.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SliceWarning {
    /// No end of the section was found.
    Unbounded,
    /// Nothing is inside.
    Empty,
}

impl fmt::Display for SliceWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unbounded => "the section has no end within ±1000: shown within ±10 (choose with --bounds)",
            Self::Empty => "nothing is inside on this plane within ±1000: shown within ±10",
        })
    }
}

/// Why there is no slice.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum SliceRequestError {
    /// Inputs that the model does not have.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The model depends on z, and no plane was chosen.
    #[error("{0} depends on x, y and z: say on which plane, like --slice z=0")]
    NoPlane(String),
    /// The plane is no plane of a model with two coordinates.
    #[error(
        "{object} has fewer than 3 coordinates ({coordinates}): its only plane is that of x and y, use --slice alone"
    )]
    Flat {
        /// The object.
        object: String,
        /// How many coordinates it has.
        coordinates: usize,
    },
    /// The place of the plane is not finite.
    #[error("the plane cannot lie at {0}")]
    NotFinite(f64),
    /// One of the first three coordinates was fixed.
    #[error("coordinate {0} is fixed by the plane, if at all: use --slice")]
    AxisFixed(usize),
    /// The model is to be shown in an impossible sphere.
    #[error(transparent)]
    Ball(#[from] BallError),
}

impl SliceRequest {
    /// Chooses what was left open, and checks what was not.
    ///
    /// # Errors
    /// Inputs and planes that the model does not have.
    pub fn resolve(&self, model: &Model) -> Result<(Slice, Option<SliceWarning>), SliceRequestError> {
        let fixed = self.inputs.coordinates.iter().find(|(number, _)| (1..=3).contains(number));
        if let Some((number, _)) = fixed {
            return Err(SliceRequestError::AxisFixed(*number));
        }
        let mut bindings = self.inputs.bindings(model)?;
        let plane = self.plane(model)?;
        let normal = plane.map_or(2, |plane| plane.axis);
        let axes = match normal {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        };
        let shown = presentation::clip_ball(&model.presentation)?.map(|ball| *ball.bounds());
        bindings.set(Input::Coordinate(normal), plane.map_or(0.0, |plane| plane.at));
        let (window, warning) = match self.bounds.or(shown) {
            Some(bounds) => (on_plane(&bounds, axes), None),
            None => {
                let found = find_window(&model.field, &bindings, axes);
                (found.window, warning(found.extent))
            }
        };
        let title = plane.map(|plane| format!("{} = {}", ["x", "y", "z"][usize::from(normal)], plane.at));
        let slice = Slice {
            field: model.field.clone(),
            bindings,
            axes,
            window,
            size: self.size,
            style: self.style,
            title: title.unwrap_or_default(),
            positive_inside: model.sign == FileSign::PositiveInside,
        };
        Ok((slice, warning))
    }

    /// The plane with its axis as the number of a coordinate; `None` where all planes of x and y are the same.
    fn plane(&self, model: &Model) -> Result<Option<NumberedPlane>, SliceRequestError> {
        let depends_on_z = model.field.inputs().contains(&Input::Coordinate(2));
        let Some(plane) = self.plane else {
            return match depends_on_z {
                true => Err(SliceRequestError::NoPlane(model.name.clone())),
                false => Ok(None),
            };
        };
        if !plane.at.is_finite() {
            return Err(SliceRequestError::NotFinite(plane.at));
        }
        if plane.axis < 2 && model.coordinates < 3 {
            let (object, coordinates) = (model.name.clone(), model.coordinates);
            return Err(SliceRequestError::Flat { object, coordinates });
        }
        let axis = u16::try_from(plane.axis.min(2)).unwrap_or(2);
        Ok((model.coordinates >= 3).then_some(NumberedPlane { axis, at: plane.at }))
    }
}

#[derive(Clone, Copy)]
struct NumberedPlane {
    axis: u16,
    at: f64,
}

fn on_plane(bounds: &Bounds, axes: [u16; 2]) -> Window {
    let (min, max) = (bounds.min().to_array(), bounds.max().to_array());
    Window { min: axes.map(|k| min[usize::from(k)]), max: axes.map(|k| max[usize::from(k)]) }
}

fn warning(extent: WindowExtent) -> Option<SliceWarning> {
    match extent {
        WindowExtent::Bounded => None,
        WindowExtent::Unbounded => Some(SliceWarning::Unbounded),
        WindowExtent::Empty => Some(SliceWarning::Empty),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula;
    use fieldstone_lang::{HyperFunOptions, Source, parse_hyperfun};

    fn flat() -> Model {
        let source = Source::new("flat.hf", "my_model(x[2], a[1]) { my_model = 1 - x[1]^2 - x[2]^2; }");
        parse_hyperfun(&source, &HyperFunOptions::default()).unwrap()
    }

    fn on(axis: usize, at: f64) -> SliceRequest {
        SliceRequest { plane: Some(Plane { axis, at }), size: (10, 10), ..SliceRequest::default() }
    }

    #[test]
    fn each_plane_has_its_axes() {
        let ball = formula("x^2 + 2y^2 + 3z^2 - 1").unwrap().model;
        for (axis, axes, title) in [(0, [1, 2], "x = 0.5"), (1, [0, 2], "y = 0.5"), (2, [0, 1], "z = 0.5")] {
            let (slice, warning) = on(axis, 0.5).resolve(&ball).unwrap();
            assert_eq!((slice.axes, slice.title.as_str(), warning), (axes, title, None));
            assert!(slice.window.max[0] < 1.5 && slice.window.max[0] > 0.3, "{:?}", slice.window);
        }
    }

    #[test]
    fn a_plane_is_needed_only_where_z_matters() {
        let ball = formula("x^2 + y^2 + z^2 - 1").unwrap().model;
        let none = SliceRequest { size: (10, 10), ..SliceRequest::default() };
        assert_eq!(none.resolve(&ball).map(|_| ()), Err(SliceRequestError::NoPlane("formula".to_owned())));
        for model in [formula("x^2 + y^2 - 1").unwrap().model, flat()] {
            assert_eq!(none.resolve(&model).unwrap().0.title, "");
        }
        assert!(on(2, 0.0).resolve(&flat()).is_ok());
        assert!(matches!(on(0, 0.0).resolve(&flat()), Err(SliceRequestError::Flat { coordinates: 2, .. })));
    }

    #[test]
    fn bounds_are_those_of_the_plane() {
        let bounds = Bounds::new([0.0, 1.0, 2.0].into(), [3.0, 5.0, 9.0].into()).unwrap();
        let request = SliceRequest { bounds: Some(bounds), ..on(1, 0.0) };
        let (slice, _) = request.resolve(&formula("x + z").unwrap().model).unwrap();
        assert_eq!(slice.window, Window { min: [0.0, 2.0], max: [3.0, 9.0] });
    }

    #[test]
    fn what_cannot_be() {
        let model = formula("x").unwrap().model;
        assert_eq!(
            on(2, f64::INFINITY).resolve(&model).map(|_| ()),
            Err(SliceRequestError::NotFinite(f64::INFINITY))
        );
        let inputs = Inputs { coordinates: vec![(3, 0.0)], ..Inputs::default() };
        let request = SliceRequest { inputs, ..on(2, 0.0) };
        assert_eq!(request.resolve(&model).map(|_| ()), Err(SliceRequestError::AxisFixed(3)));
    }

    #[test]
    fn the_sign_of_the_file_is_that_of_the_numbers() {
        let none = SliceRequest { size: (10, 10), ..SliceRequest::default() };
        assert!(none.resolve(&flat()).unwrap().0.positive_inside);
    }
}
