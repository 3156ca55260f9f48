//! From a model and a few wishes to a scene.

use crate::inputs::{InputError, Inputs};
use fieldstone_field::{Bindings, Input};
use fieldstone_lang::{Model, UpAxis};
use fieldstone_scene::{
    Bounds, BoundsError, Camera, CameraError, ColourSource, Lighting, Scene, SceneError, Settings, Solid, Up,
    View,
};
use fieldstone_space::{Extent, FoundBounds, solid_bounds};
use glam::DVec3;
use std::fmt;

/// What to draw of a model; what is not given is chosen so that the picture is good.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RenderRequest {
    /// Values of parameters, and of coordinates from the fourth on.
    pub inputs: Inputs,
    /// Where to look for the solid; `None`: found by intervals.
    pub bounds: Option<Bounds>,
    /// Whether one looks into the solid where the bounds cut it.
    pub open: bool,
    /// What is fixed of the camera.
    pub view: View,
    /// Size, samples and method.
    pub settings: Settings,
}

/// A scene, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// The scene.
    pub scene: Scene,
    /// What may not be as expected.
    pub warnings: Vec<Warning>,
}

/// What may not be as expected of a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Warning {
    /// No end of the solid was found.
    Unbounded,
    /// There is no solid.
    Empty,
    /// No solid was found.
    NotFound,
    /// The model has no value anywhere.
    Undefined,
    /// The bounds rest on samples.
    SampledBounds,
}

impl Warning {
    /// What found bounds give reason to say.
    pub fn of_bounds(found: &FoundBounds) -> Option<Self> {
        match found.extent {
            Extent::Unbounded => Some(Self::Unbounded),
            Extent::Empty => Some(Self::Empty),
            Extent::NotFound => Some(Self::NotFound),
            Extent::Undefined => Some(Self::Undefined),
            Extent::Bounded => (!found.proved).then_some(Self::SampledBounds),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unbounded => "the solid has no end within ±1000: cut off at ±10 (choose with --bounds)",
            Self::Empty => "there is no solid: the function is nowhere inside within ±1000",
            Self::NotFound => "no solid was found within ±1000, but there may be one: looking within ±10",
            Self::Undefined => "the function has no value anywhere",
            Self::SampledBounds => {
                "the bounds rest on samples, because nothing can be proved about the function in places \
                 (if something is cut off, use --bounds)"
            }
        })
    }
}

/// Why there is no scene.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum RequestError {
    /// Inputs that the model does not have.
    #[error(transparent)]
    Input(#[from] InputError),
    /// One of the first three coordinates was fixed.
    #[error("coordinate {0} is an axis of the picture and cannot be fixed")]
    AxisFixed(usize),
    /// An impossible camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Impossible bounds.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// Impossible settings.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl RenderRequest {
    /// Chooses what was left open, and checks what was not.
    ///
    /// # Errors
    /// Inputs that the model does not have; an impossible camera or settings.
    pub fn resolve(&self, model: &Model) -> Result<Resolved, RequestError> {
        if let Some(&(number, _)) =
            self.inputs.coordinates.iter().find(|(number, _)| (1..=3).contains(number))
        {
            return Err(RequestError::AxisFixed(number));
        }
        let bindings = self.inputs.bindings(model)?;
        let (bounds, warning) = match self.bounds {
            Some(bounds) => (bounds, None),
            None => find_bounds(model, &bindings)?,
        };
        let up = match model.up {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
        };
        let (width, height) = self.settings.size;
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        let camera = Camera::framing(&bounds, &self.view, up, aspect)?;
        let solid = Solid::new(model.field.clone(), bindings, bounds).with_caps(!self.open);
        let coloured = model.has_attributes && model.field.attributes().len() >= 3;
        let colours = if coloured { ColourSource::Attributes } else { ColourSource::Material };
        let solid = solid.with_colour_source(colours)?;
        let scene = Scene::new(vec![solid], camera, Lighting::for_camera(&camera), self.settings)?;
        Ok(Resolved { scene, warnings: warning.into_iter().collect() })
    }
}

/// The box of the solid of a model, and what is strange about it.
pub(crate) fn find_bounds(
    model: &Model,
    bindings: &Bindings,
) -> Result<(Bounds, Option<Warning>), BoundsError> {
    let mut varying_free = bindings.clone();
    (0..3).for_each(|k| varying_free.set(Input::Coordinate(k), 0.0));
    let found = solid_bounds(&model.field, &varying_free);
    let bounds = Bounds::new(DVec3::from(found.min), DVec3::from(found.max))?;
    Ok((bounds, Warning::of_bounds(&found)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Projection, formula};

    fn resolve(text: &str, request: &RenderRequest) -> Result<Resolved, RequestError> {
        request.resolve(&formula(text).unwrap().model)
    }

    #[test]
    fn with_nothing_given_the_solid_is_framed() {
        let resolved = resolve("x^2 + y^2 + z^2 - 9", &RenderRequest::default()).unwrap();
        assert_eq!(resolved.warnings, []);
        let bounds = resolved.scene.bounds();
        assert!(bounds.min().x > -3.2 && bounds.max().z < 3.2 && bounds.max().z >= 3.0);
        let camera = resolved.scene.camera();
        let corners = bounds.corners().map(|c| camera.project(c, 1.0).unwrap());
        assert!(corners.iter().all(|(u, v)| (0.0..1.0).contains(u) && (0.0..1.0).contains(v)));
        assert!(resolved.scene.solids()[0].is_capped());
    }

    #[test]
    fn wishes_are_kept() {
        let bounds = Bounds::new(DVec3::ZERO, DVec3::ONE).unwrap();
        let lens = Projection::Perspective { vertical_fov_radians: 0.5 };
        let request = RenderRequest {
            bounds: Some(bounds),
            open: true,
            view: View { eye: Some(DVec3::splat(4.0)), projection: Some(lens), ..View::default() },
            ..RenderRequest::default()
        };
        let scene = resolve("x - 0.5", &request).unwrap().scene;
        assert_eq!(scene.bounds(), bounds);
        assert_eq!((scene.camera().eye(), scene.camera().projection()), (DVec3::splat(4.0), lens));
        assert!(!scene.solids()[0].is_capped());
    }

    #[test]
    fn warnings_name_what_is_strange() {
        let warnings = |text: &str| resolve(text, &RenderRequest::default()).unwrap().warnings;
        assert_eq!(warnings("x"), [Warning::Unbounded]);
        assert_eq!(warnings("x^2 + 1"), [Warning::Empty]);
        assert_eq!(warnings("sqrt(-1 - x^2)"), [Warning::Undefined]);
        assert_eq!(warnings("max(x^2 + y^2 + z^2 - 1, 0 - log(x + 0.5)^2)"), [Warning::SampledBounds]);
    }

    #[test]
    fn axes_cannot_be_fixed() {
        let inputs = Inputs { coordinates: vec![(2, 1.0)], ..Inputs::default() };
        let request = RenderRequest { inputs, ..RenderRequest::default() };
        assert_eq!(resolve("x", &request).map(|_| ()), Err(RequestError::AxisFixed(2)));
    }

    #[test]
    fn the_size_gives_the_aspect_and_is_checked() {
        let size = |size| {
            let settings = Settings { size, ..Settings::default() };
            let request = RenderRequest { settings, ..RenderRequest::default() };
            resolve("x^2 + y^2 + z^2 - 1", &request).map(|r| r.scene.aspect())
        };
        assert_eq!(size((300, 100)), Ok(3.0));
        assert_eq!(size((0, 100)), Err(RequestError::Scene(SceneError::Size(0, 100))));
    }
}
