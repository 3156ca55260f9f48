//! `.jsurf` files: what SURFER (IMAGINARY, <https://www.imaginary.org/program/surfer>) writes.
//!
//! A file is a list of Java [`properties`]: an equation with the values of its parameters, and how to show it. The
//! equation goes to the reader of formulas; [`show`] makes a [`Presentation`](crate::Presentation) of the rest.

mod properties;
mod reader;
mod show;

#[cfg(test)]
mod tests;

use crate::diagnostic::{Diagnostic, Diagnostics, Source};
use crate::formula::{Setting, parse_in};
use crate::model::{Model, Parameter, UpAxis};
use crate::presentation::Presentation;
use fieldstone_field::{Field, Input};
use reader::Reader;

/// The largest file: SURFER's have about 2 KiB.
const MAX_BYTES: usize = 1 << 20;

const EQUATION: &str = "surface_equation";
const PARAMETER: &str = "surface_parameter_";

/// Reads a `.jsurf` file, in which SURFER and the program jsurf keep an algebraic surface.
///
/// | key | meaning |
/// |---|---|
/// | `surface_equation` | f in the syntax of [`parse_formula`](crate::parse_formula); the surface is f = 0 |
/// | `surface_parameter_a` | the value of the parameter `a`; any name but x, y, z |
/// | `scale_factor` | log₁₀ of the radius of the ball that is shown |
/// | `transform_matrix`, `rotation_matrix` | turn the surface with its ball before the camera |
/// | `surface_transform_matrix` | takes the unit ball to the ball that is shown, before the scale |
/// | `camera_type`, `camera_fov_y`, `camera_height`, `camera_transform` | the camera; 4 × 4 matrices row by row |
/// | `front_material_…`, `back_material_…` | `color`, `ambient_intensity`, `diffuse_intensity`, `specular_intensity`, `shininess` of either side |
/// | `light_…_0` to `light_…_7` | `status`, `position` in the space of the camera, `color`, `intensity` |
/// | `background_color` | sRGB |
///
/// The model has three coordinates, y up, the sign f < 0 inside and a [`Presentation`](crate::Presentation) with
/// [`surface`](crate::Presentation::surface) set. Lights are taken as infinitely far away. Keys without a meaning are
/// warnings.
///
/// ```
/// use fieldstone_lang::{Source, parse_jsurf};
///
/// let text = "surface_equation=x^2+y^2+z^2-a\nsurface_parameter_a=0.5\nscale_factor=0.0";
/// let model = parse_jsurf(&Source::new("ball.jsurf", text))?;
/// assert_eq!(model.parameters[0].default, 0.5);
/// assert_eq!(model.presentation.clip_sphere, Some(([0.0; 3], 1.0)));
/// # Ok::<(), fieldstone_lang::Diagnostics>(())
/// ```
///
/// # Errors
/// An equation that is missing or no formula, values that are not what their key needs, a text above 1 MiB.
pub fn parse_jsurf(source: &Source) -> Result<Model, Diagnostics> {
    if source.text.len() > MAX_BYTES {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let error = Diagnostic::error(0..0, message, "too large for a surface");
        // The text itself would only be in the way.
        let source = Source::new(source.name.clone(), String::new());
        return Err(Diagnostics::in_order(&source, vec![error]));
    }
    let (properties, mut errors) = properties::read(&source.text);
    let mut reader = Reader::new(&properties);
    let formula = surface(&mut reader, &source.text);
    let presentation = show::presentation(&mut reader);
    let (more_errors, warnings) = reader.finish();
    errors.extend(more_errors);
    match formula {
        Ok((field, parameters)) if errors.is_empty() => {
            let plain = Model::plain("surface", field, parameters, warnings);
            Ok(Model { up: UpAxis::Y, presentation: Presentation { surface: true, ..presentation }, ..plain })
        }
        Ok(_) => Err(Diagnostics::in_order(source, [errors, warnings].concat())),
        Err(equation) => Err(Diagnostics::in_order(source, [errors, equation, warnings].concat())),
    }
}

/// The function whose zeros are the surface.
fn surface(reader: &mut Reader<'_>, text: &str) -> Result<(Field, Vec<Parameter>), Vec<Diagnostic>> {
    let parameters = parameters(reader);
    let Some(equation) = reader.take(EQUATION) else {
        let end = text.trim_end().len();
        let error =
            Diagnostic::error(end..end, format!("there is no `{EQUATION}`"), "expected a line with it");
        return Err(vec![error.with_help(format!("the surface is written `{EQUATION}=x^2+y^2+z^2-1`"))]);
    };
    let how_to_define = |name: &str| format!("give it a value on a line of its own: `{PARAMETER}{name}=1`");
    let setting = Setting { parameters: &parameters, how_to_define };
    let in_file = |error| equation.diagnostic(error);
    let (field, parameters) = parse_in(&equation.text, &setting)
        .map_err(|errors| errors.into_iter().map(in_file).collect::<Vec<_>>())?;
    if !field.inputs().iter().any(|input| matches!(input, Input::Coordinate(_))) {
        let warning = Diagnostic::warning(
            equation.span(),
            "the equation is the same everywhere",
            "depends on no coordinate",
        );
        reader.warn(warning.with_help("a surface needs an equation of x, y and z"));
    }
    Ok((field, parameters))
}

/// The parameters with their values, by name.
fn parameters(reader: &mut Reader<'_>) -> Vec<(String, f64)> {
    let mut parameters = Vec::new();
    for (name, property) in reader.with_prefix(PARAMETER) {
        let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !is_name || ["x", "y", "z"].contains(&name) {
            let message = format!("`{name}` cannot be the name of a parameter");
            let error = Diagnostic::error(property.key.span(), message, "expected another name");
            reader.fail(error.with_help("a name is made of letters, digits and `_`, and is not x, y or z"));
            continue;
        }
        if let Some([value]) = reader.numbers_of(&property.value) {
            parameters.push((name.to_owned(), value));
        }
    }
    parameters.sort_by(|a, b| a.0.cmp(&b.0));
    parameters
}
