//! What a front end delivers.

use crate::diagnostic::Diagnostic;
use crate::presentation::Presentation;
use fieldstone_field::{Field, Input};
use std::ops::Range;

/// Which values a file calls inside.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FileSign {
    /// f < 0 inside: formulas and `.vm`.
    NegativeInside,
    /// F ≥ 0 inside: HyperFun.
    PositiveInside,
}

/// The axis that points up by the habit of the file's kind.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UpAxis {
    /// y: HyperFun.
    Y,
    /// z: formulas and `.vm`.
    Z,
}

/// A number that the user may set.
#[derive(Clone, PartialEq, Debug)]
pub struct Parameter {
    /// `a[1]`, or the name in a formula.
    pub name: String,
    /// The input of the program that it is.
    pub input: Input,
    /// Its value if the user sets none.
    pub default: f64,
}

/// The header of an object of the file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// The size of x[].
    pub coordinates: usize,
    /// The size of a[].
    pub parameters: usize,
    /// The size of s[], if declared.
    pub attributes: Option<usize>,
}

/// A model that was read: a field in core sign (f < 0 inside) and what the file says of it.
#[derive(Clone, Debug)]
pub struct Model {
    /// The field of the chosen object, f < 0 inside; its attributes are s\[1\], s\[2\], … if declared.
    pub field: Field,
    /// The name of the chosen object.
    pub name: String,
    /// All objects of the file, in its order.
    pub objects: Vec<Object>,
    /// The number of coordinates of the chosen object. Coordinates are [`Input::Coordinate`] 0, 1, ….
    pub coordinates: usize,
    /// Whether the chosen object declares attributes.
    pub has_attributes: bool,
    /// The parameters of the chosen object.
    pub parameters: Vec<Parameter>,
    /// The sign of the file's own values: they are `-field` if positive inside.
    pub sign: FileSign,
    /// The axis that points up.
    pub up: UpAxis,
    /// Where the text has loops whose number of turns depends on the point, in the order of the text.
    pub loops: Vec<Range<usize>>,
    /// How the file wants the model shown; nothing where the language has no words for it.
    pub presentation: Presentation,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
}

impl Model {
    /// The model of a text that is one function: f < 0 inside, z up, no attributes; coordinate 4 where it is read.
    pub(crate) fn plain(
        name: &str,
        field: Field,
        parameters: Vec<Parameter>,
        warnings: Vec<Diagnostic>,
    ) -> Self {
        let used = field.inputs().into_iter().map(|input| match input {
            Input::Coordinate(k) => usize::from(k) + 1,
            _ => 0,
        });
        let coordinates = used.fold(3, usize::max);
        let object =
            Object { name: name.to_owned(), coordinates, parameters: parameters.len(), attributes: None };
        Self {
            field,
            name: name.to_owned(),
            objects: vec![object],
            coordinates,
            has_attributes: false,
            parameters,
            sign: FileSign::NegativeInside,
            up: UpAxis::Z,
            loops: Vec::new(),
            presentation: Presentation::default(),
            warnings,
        }
    }
}
