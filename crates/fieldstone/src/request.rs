//! From a model and a few wishes to a scene.

use crate::extent::{Wanted, find_bounds};
use crate::eye;
use crate::inputs::{InputError, Inputs};
use crate::presentation;
use fieldstone_lang::{Model, UpAxis};
use fieldstone_render::Stats;
use fieldstone_scene::{
    Ball, BallError, Bounds, BoundsError, Camera, CameraError, Scene, SceneError, Settings, Solid, Up, View,
};
use fieldstone_space::{Extent, FoundBounds, SEARCHED};
use std::fmt;

/// From so many times the longest side of the bounds, points of rays are rounded by more than brackets are wide.
const FAR: f64 = (1 << 18) as f64;

/// What to draw of a model; what is not given is chosen so that the picture is good.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RenderRequest {
    /// Values of parameters, and of coordinates from the fourth on.
    pub inputs: Inputs,
    /// Where to look for the solid; `None`: found by intervals.
    pub bounds: Option<Bounds>,
    /// Whether one looks into the solid where the bounds cut it.
    pub open: bool,
    /// Whether to draw the surface where the field is 0, from both sides, instead of the solid where it is negative.
    pub surface: bool,
    /// A sphere outside of which nothing is drawn; it cuts solids like the bounds do.
    pub clip_sphere: Option<Ball>,
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
    /// No end of the solid was found; it is cut off at so much on each side of the origin.
    Unbounded(u32),
    /// There is no solid.
    Empty,
    /// No solid was found.
    NotFound,
    /// The model has no value anywhere.
    Undefined,
    /// The bounds rest on samples.
    SampledBounds,
    /// No end of the surface was found; it is cut off likewise.
    UnboundedSurface(u32),
    /// There is no surface.
    EmptySurface,
    /// There is nothing inside the sphere that clips.
    NothingInSphere,
    /// The eye is so far away that rounding hides where rays meet the solid.
    FarEye,
    /// The eye is inside of a solid that one cannot see through.
    EyeInside,
    /// The eye is outside of the room that is around the scene.
    EyeOutsideRoom,
    /// No ray through the centre of a pixel hits anything.
    NothingSeen,
}

impl Warning {
    /// What found bounds give reason to say.
    pub fn of_bounds(found: &FoundBounds) -> Option<Self> {
        match found.extent {
            // The corners are whole numbers up to ten millions.
            Extent::Unbounded => Some(Self::Unbounded(found.max[0] as u32)),
            Extent::Empty => Some(Self::Empty),
            Extent::NotFound => Some(Self::NotFound),
            Extent::Undefined => Some(Self::Undefined),
            Extent::Bounded => (!found.proved).then_some(Self::SampledBounds),
        }
    }

    /// What it says of an object of a scene file, where keys have the place of options.
    pub(crate) fn of_object(&self, name: &str) -> String {
        let keys = [
            ("--bounds", "`bounds`"),
            ("--clip-sphere", "`clip_sphere`"),
            ("--surface", "`surface`"),
            ("--eye", "`eye`"),
        ];
        let text = keys.iter().fold(self.to_string(), |text, (option, key)| text.replace(option, key));
        format!("{name}: {text}")
    }

    /// What a picture gives reason to say; nothing if a warning about its scene says why, or thin volumes may be seen.
    pub fn of_picture(stats: &Stats, resolved: &Resolved) -> Option<Self> {
        use Warning::{Empty, EmptySurface, NotFound, NothingInSphere, Undefined};
        let explained = [Empty, EmptySurface, NotFound, NothingInSphere, Undefined];
        let is_explained = resolved.warnings.iter().any(|warning| explained.contains(warning));
        let is_sure = stats.hits == 0 && resolved.scene.texels().is_empty();
        (is_sure && !is_explained).then_some(Self::NothingSeen)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unbounded(cut) => {
                return write!(
                    f,
                    "no end of the solid was found within ±{SEARCHED}: cut off at ±{cut} (choose with --bounds)"
                );
            }
            Self::Empty => {
                "there is no solid: the function is nowhere inside within ±1000 (--surface shows where it is 0; \
                 farther out, say where with --bounds)"
            }
            Self::NotFound => "no solid was found within ±1000, but there may be one: looking within ±10",
            Self::Undefined => "the function has no value anywhere",
            Self::SampledBounds => {
                "the bounds rest on samples, because nothing can be proved about the function in places \
                 (if something is cut off, use --bounds)"
            }
            Self::UnboundedSurface(cut) => {
                return write!(
                    f,
                    "no end of the surface was found within ±{SEARCHED}: cut off at ±{cut} (choose with --bounds or \
                     --clip-sphere)"
                );
            }
            Self::EmptySurface => "there is no surface: the function is nowhere 0 within ±1000",
            Self::NothingInSphere => "nothing was found inside the sphere of --clip-sphere",
            Self::FarEye => {
                "the eye is so far away that rounding hides where rays meet the solid: much rests on a tolerance \
                 (choose --eye nearer, or a parallel view with --ortho)"
            }
            Self::EyeInside => "the eye is inside of the solid, which is seen from within (choose --eye)",
            Self::EyeOutsideRoom => {
                "the eye is outside of the room: it looks through the near walls at the far ones (choose --eye)"
            }
            Self::NothingSeen => {
                "nothing is to be seen: no ray of the picture hits anything (look at --eye, --target, --bounds)"
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
    /// An impossible sphere.
    #[error(transparent)]
    Ball(#[from] BallError),
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
        let surface = self.surface || model.presentation.surface;
        let clip_ball = match self.clip_sphere {
            Some(ball) => Some(ball),
            None => presentation::clip_ball(&model.presentation)?,
        };
        let (bounds, warning) = match self.bounds {
            Some(bounds) => (bounds, None),
            None => find_bounds(&Wanted {
                field: &model.field,
                bindings: &bindings,
                surface,
                clip: clip_ball.as_ref(),
            })?,
        };
        let up = match model.up {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
        };
        let (width, height) = self.settings.size;
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        let view = presentation::view(&self.view, &model.presentation);
        let camera = Camera::framing(&bounds, &view, up, aspect)?;
        let distance = (camera.eye() - bounds.centre()).length();
        let far = (distance > FAR * bounds.longest_side()).then_some(Warning::FarEye);
        let solid = Solid::new(model.field.clone(), bindings, bounds)
            .with_caps(!self.open)
            .with_surface(surface)
            .with_clip_ball(clip_ball);
        let coloured = model.has_attributes && model.field.attributes().len() >= 3;
        let solid = presentation::with_materials(solid, &model.presentation, coloured)?;
        let lighting = presentation::lighting(&model.presentation, &camera);
        let scene = Scene::new(vec![solid], camera, lighting, self.settings)?;
        let inside = eye::warning(&scene).map(|(_, warning)| warning);
        Ok(Resolved { scene, warnings: warning.into_iter().chain(far).chain(inside).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Projection, formula};
    use glam::DVec3;

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
        assert_eq!(warnings("x"), [Warning::Unbounded(10)]);
        assert_eq!(warnings("x^2 + 1"), [Warning::Empty]);
        assert_eq!(warnings("sqrt(-1 - x^2)"), [Warning::Undefined]);
        // A logarithm has a domain, where it is proved that nothing is; 0/0 has none that is known.
        assert_eq!(warnings("max(x^2 + y^2 + z^2 - 1, 0 - log(x + 0.5)^2)"), []);
        let quotient = "x^2 + y^2 + z^2 - 1 + max(x + 0.5, 0)/max(x + 0.5, 0)*0.001";
        assert_eq!(warnings(quotient), [Warning::SampledBounds]);
    }

    #[test]
    fn eyes_inside_are_told() {
        let seen_from = |eye: DVec3| {
            let view = View { eye: Some(eye), target: Some(DVec3::X * 9.0), ..View::default() };
            let request = RenderRequest { view, ..RenderRequest::default() };
            resolve("x^2 + y^2 + z^2 - 1", &request).unwrap().warnings
        };
        assert_eq!(seen_from(DVec3::splat(0.5)), [Warning::EyeInside]);
        assert_eq!(seen_from(DVec3::splat(0.99)), []);
    }

    #[test]
    fn far_eyes_are_told() {
        let from = |x: f64| {
            let view = View { eye: Some(DVec3::new(x, 0.0, 0.0)), ..View::default() };
            resolve("x^2 + y^2 + z^2 - 1", &RenderRequest { view, ..RenderRequest::default() })
                .unwrap()
                .warnings
        };
        assert_eq!((from(1e4), from(1e9)), (vec![], vec![Warning::FarEye]));
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
