//! The scene: solids, camera, light and settings.

use crate::ball::Ball;
use crate::bounds::{Bounds, RaySpan};
use crate::camera::Camera;
use crate::colour::{ColourSource, Material, Rgb, srgb_to_linear};
use crate::light::Lighting;
use crate::text::Number;
use fieldstone_field::{Bindings, Field};
use glam::DVec3;

/// The most pixels that an image may have: 2²⁶, 8192 × 8192.
pub const MAX_PIXELS: u64 = 1 << 26;

/// What a pixel takes in memory while an image is drawn and written, in bytes: its layers, and a little more.
const PIXEL_BYTES: u64 = 48;

/// The shortest step of [`Method::Sampled`], relative to the longest side of the bounds: rays have up to 1.7 million.
pub const MIN_STEP: f64 = 1e-6;

/// The longest step, accepted width or tolerance, relative to the longest side of the bounds.
pub const MAX_LENGTH: f64 = 0.5;

/// The most samples that a pixel may have.
pub const MAX_SAMPLES: u32 = 4096;

/// Why parts make no [`Scene`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum SceneError {
    /// Nothing to draw.
    #[error("a scene needs a solid")]
    NoSolid,
    /// A solid takes its colour from attributes that it does not have.
    #[error("a colour needs three attributes, the field has {0}")]
    Attributes(usize),
    /// The image has no pixel, or more than [`MAX_PIXELS`].
    #[error("an image of {0}x{1} pixels {fault}", fault = size_fault(*.0, *.1))]
    Size(u32, u32),
    /// No sample, or more than [`MAX_SAMPLES`].
    #[error("{0} samples a pixel are not between 1 and {MAX_SAMPLES}")]
    Samples(u32),
    /// A step or tolerance that is not finite and positive.
    #[error("the {name} is a positive number, not {}", Number(*value))]
    Length {
        /// Which it is: `step`, `accepted width` or `tolerance`.
        name: &'static str,
        /// What was asked for.
        value: f64,
    },
    /// A step or tolerance longer than [`MAX_LENGTH`].
    #[error("the {name} is at most {MAX_LENGTH} of the longest side of the bounds, not {}", Number(*value))]
    Long {
        /// Which it is, as above.
        name: &'static str,
        /// What was asked for.
        value: f64,
    },
    /// A step shorter than [`MIN_STEP`].
    #[error(
        "a step of {} of the longest side is too short: a ray has at most a million steps or so, \
         each at least {MIN_STEP:?}",
        Number(*.0)
    )]
    Step(f64),
}

fn size_fault(width: u32, height: u32) -> String {
    let pixels = u64::from(width) * u64::from(height);
    let gigabytes = |pixels: u64| pixels.saturating_mul(PIXEL_BYTES).div_ceil(1_000_000_000);
    match pixels {
        0 => "has none".to_owned(),
        _ => format!(
            "needs {} GB of memory: at most {MAX_PIXELS} pixels ({} GB) are drawn",
            gigabytes(pixels),
            gigabytes(MAX_PIXELS)
        ),
    }
}

/// A solid: where its field is negative, within its bounds; or a surface without an inside: where its field is 0.
#[derive(Clone, Debug)]
pub struct Solid {
    field: Field,
    bindings: Bindings,
    bounds: Bounds,
    clip_ball: Option<Ball>,
    capped: bool,
    surface: bool,
    material: Material,
    back: Option<Material>,
    colour_source: ColourSource,
}

impl Solid {
    /// The solid of a field, cut off at its bounds, of the default material.
    ///
    /// `bindings` hold the values of all inputs but the first three coordinates.
    pub fn new(field: Field, bindings: Bindings, bounds: Bounds) -> Self {
        let (material, colour_source) = (Material::default(), ColourSource::Material);
        Self {
            field,
            bindings,
            bounds,
            clip_ball: None,
            capped: true,
            surface: false,
            material,
            back: None,
            colour_source,
        }
    }

    /// Whether the bounds cut the solid (capped: what is inside ends there with a face) or a window on it (open: one
    /// looks into it where it is cut).
    pub fn with_caps(self, capped: bool) -> Self {
        Self { capped, ..self }
    }

    /// Whether it is a surface without an inside: the places where the field is 0, seen from both sides, those where it
    /// does not change its sign too. Bounds end it and close nothing.
    pub fn with_surface(self, surface: bool) -> Self {
        Self { surface, ..self }
    }

    /// A ball outside of which nothing is drawn: like the bounds it cuts the solid, or is a window on it.
    pub fn with_clip_ball(self, clip_ball: Option<Ball>) -> Self {
        Self { clip_ball, ..self }
    }

    /// Another material.
    pub fn with_material(self, material: Material) -> Self {
        Self { material, ..self }
    }

    /// Another material for the side from which the field is negative, which is seen of surfaces and of open solids.
    pub fn with_back_material(self, back: Material) -> Self {
        Self { back: Some(back), ..self }
    }

    /// Another source of the diffuse colour.
    ///
    /// # Errors
    /// [`ColourSource::Attributes`] for a field with fewer than three attributes.
    pub fn with_colour_source(self, colour_source: ColourSource) -> Result<Self, SceneError> {
        let attributes = self.field.attributes().len();
        if colour_source == ColourSource::Attributes && attributes < 3 {
            return Err(SceneError::Attributes(attributes));
        }
        Ok(Self { colour_source, ..self })
    }

    /// The field, negative inside.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The values of all inputs but the first three coordinates.
    pub fn bindings(&self) -> &Bindings {
        &self.bindings
    }

    /// Where the solid is.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The ball that it is clipped to, if there is one.
    pub fn clip_ball(&self) -> Option<&Ball> {
        self.clip_ball.as_ref()
    }

    /// The part of the line origin + t·direction on which it may be seen, over all t: inside the bounds and the ball.
    pub fn ray_span(&self, origin: DVec3, direction: DVec3) -> Option<RaySpan> {
        let span = self.bounds.ray_span(origin, direction)?;
        match &self.clip_ball {
            None => Some(span),
            Some(ball) => ball.ray_span(origin, direction)?.intersection(&span),
        }
    }

    /// Whether the bounds cut the solid; see [`with_caps`](Self::with_caps). They never cut a surface.
    pub fn is_capped(&self) -> bool {
        self.capped && !self.surface
    }

    /// Whether it is a surface without an inside; see [`with_surface`](Self::with_surface).
    pub fn is_surface(&self) -> bool {
        self.surface
    }

    /// What its surface is made of.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// What it is made of where it is seen from outside, or from inside.
    pub fn material_from(&self, inside: bool) -> &Material {
        self.back.as_ref().filter(|_| inside).unwrap_or(&self.material)
    }

    /// Where its diffuse colour comes from.
    pub fn colour_source(&self) -> ColourSource {
        self.colour_source
    }

    /// The diffuse colour where the field has these attributes, seen from outside or from inside.
    pub fn diffuse(&self, attributes: &[f64], from_inside: bool) -> Rgb {
        match (self.colour_source, attributes) {
            (ColourSource::Attributes, &[r, g, b, ..]) if !(r.is_nan() || g.is_nan() || b.is_nan()) => {
                DVec3::from([r, g, b].map(|s| srgb_to_linear(s.clamp(0.0, 1.0))))
            }
            _ => self.material_from(from_inside).diffuse(),
        }
    }
}

/// How surfaces are found. Lengths are relative to the longest side of the bounds.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum Method {
    /// With mixed affine forms along the ray: misses nothing, and is the fastest that does.
    #[default]
    Affine,
    /// With intervals: misses nothing.
    Interval {
        /// Accept a span of this length that cannot be excluded as a hit without a proof; `None`: never.
        accept_epsilon: Option<f64>,
    },
    /// By steps: misses what is thinner than a step.
    Sampled {
        /// The length of a step; `None`: a default.
        step: Option<f64>,
    },
}

/// How a scene is drawn.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settings {
    /// The width and height of the image in pixels.
    pub size: (u32, u32),
    /// How many samples a pixel gets where there are edges in it.
    pub samples: u32,
    /// How surfaces are found.
    pub method: Method,
    /// How closely surfaces are located, relative to the longest side of the bounds; `None`: a default.
    pub tolerance: Option<f64>,
}

impl Default for Settings {
    /// 512 × 512 pixels, 4 samples, the affine method.
    fn default() -> Self {
        Self { size: (512, 512), samples: 4, method: Method::Affine, tolerance: None }
    }
}

impl Settings {
    fn check(&self) -> Result<(), SceneError> {
        let (width, height) = self.size;
        let pixels = u64::from(width) * u64::from(height);
        if !(1..=MAX_PIXELS).contains(&pixels) {
            return Err(SceneError::Size(width, height));
        }
        if !(1..=MAX_SAMPLES).contains(&self.samples) {
            return Err(SceneError::Samples(self.samples));
        }
        let of_method = match self.method {
            Method::Affine => ("step", None),
            Method::Interval { accept_epsilon } => ("accepted width", accept_epsilon),
            Method::Sampled { step } => ("step", step),
        };
        for (name, length) in [of_method, ("tolerance", self.tolerance)] {
            match length {
                Some(value) if !(value > 0.0 && value.is_finite()) => {
                    return Err(SceneError::Length { name, value });
                }
                Some(value) if value > MAX_LENGTH => return Err(SceneError::Long { name, value }),
                _ => {}
            }
        }
        match self.method {
            Method::Sampled { step: Some(step) } if step < MIN_STEP => Err(SceneError::Step(step)),
            _ => Ok(()),
        }
    }
}

/// Everything that is drawn, and how. What may be relied upon stands at the top of the [crate](crate).
#[derive(Clone, Debug)]
pub struct Scene {
    solids: Vec<Solid>,
    camera: Camera,
    lighting: Lighting,
    settings: Settings,
}

impl Scene {
    /// A scene.
    ///
    /// # Errors
    /// No solid, or settings out of their range.
    pub fn new(
        solids: Vec<Solid>,
        camera: Camera,
        lighting: Lighting,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        if solids.is_empty() {
            return Err(SceneError::NoSolid);
        }
        settings.check()?;
        Ok(Self { solids, camera, lighting, settings })
    }

    /// The solids, at least one.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The light.
    pub fn lighting(&self) -> &Lighting {
        &self.lighting
    }

    /// How the scene is drawn.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The width of the image divided by its height.
    pub fn aspect(&self) -> f64 {
        let (width, height) = self.settings.size;
        f64::from(width) / f64::from(height)
    }

    /// The ray through the point (x, y) of the image in pixels; the centre of the first pixel is (½, ½).
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let (width, height) = self.settings.size;
        self.camera.ray(x / f64::from(width), y / f64::from(height), self.aspect())
    }

    /// The smallest box around the bounds of all solids.
    pub fn bounds(&self) -> Bounds {
        let first = *self.solids[0].bounds();
        self.solids[1..].iter().fold(first, |all, solid| all.union(solid.bounds()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Up;
    use fieldstone_field::{Graph, Input};

    fn unit_box() -> Bounds {
        Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap()
    }

    fn plane(attributes: usize) -> Field {
        let mut graph = Graph::new();
        let x = graph.input(Input::Coordinate(0));
        Field::new(graph, x, vec![x; attributes])
    }

    fn scene(settings: Settings) -> Result<Scene, SceneError> {
        let solid = Solid::new(plane(0), Bindings::new(), unit_box());
        let camera = Camera::fitted(&unit_box(), Up::Z, 1.0);
        Scene::new(vec![solid], camera, Lighting::for_camera(&camera), settings)
    }

    #[test]
    fn settings_are_checked() {
        let with = |change: fn(&mut Settings)| {
            let mut settings = Settings::default();
            change(&mut settings);
            scene(settings).map(|_| ())
        };
        assert_eq!(with(|_| {}), Ok(()));
        assert_eq!(with(|s| s.size = (0, 5)), Err(SceneError::Size(0, 5)));
        assert_eq!(with(|s| s.size = (8193, 8192)), Err(SceneError::Size(8193, 8192)));
        assert_eq!(with(|s| s.samples = 0), Err(SceneError::Samples(0)));
        let length = |name, value| Err(SceneError::Length { name, value });
        assert_eq!(with(|s| s.tolerance = Some(0.0)), length("tolerance", 0.0));
        let long = |value| Err(SceneError::Long { name: "tolerance", value });
        assert_eq!(with(|s| s.tolerance = Some(2.0)), long(2.0));
        assert_eq!(with(|s| s.method = Method::Sampled { step: Some(-1.0) }), length("step", -1.0));
        assert_eq!(with(|s| s.method = Method::Sampled { step: Some(1e-12) }), Err(SceneError::Step(1e-12)));
        let epsilon = Method::Interval { accept_epsilon: Some(f64::INFINITY) };
        let refused = scene(Settings { method: epsilon, ..Settings::default() }).map(|_| ());
        assert_eq!(refused, length("accepted width", f64::INFINITY));
    }

    #[test]
    fn sizes_name_their_need() {
        let message = |width, height| SceneError::Size(width, height).to_string();
        assert_eq!(message(0, 5), "an image of 0x5 pixels has none");
        let needs =
            "an image of 65536x65536 pixels needs 207 GB of memory: at most 67108864 pixels (4 GB) are drawn";
        assert_eq!(message(65536, 65536), needs);
        assert!(message(u32::MAX, u32::MAX).contains("GB"));
    }

    #[test]
    fn a_scene_is_not_empty() {
        let camera = Camera::fitted(&unit_box(), Up::Z, 1.0);
        let none = Scene::new(Vec::new(), camera, Lighting::default(), Settings::default());
        assert_eq!(none.map(|_| ()), Err(SceneError::NoSolid));
    }

    #[test]
    fn rays_go_through_pixel_centres() {
        let scene = scene(Settings { size: (4, 2), ..Settings::default() }).unwrap();
        assert_eq!(scene.aspect(), 2.0);
        assert_eq!(scene.ray(0.5, 1.5), scene.camera().ray(0.125, 0.75, 2.0));
        assert_eq!(scene.bounds(), unit_box());
    }

    #[test]
    fn attributes_are_srgb_and_cut_off() {
        let solid = |n| Solid::new(plane(n), Bindings::new(), unit_box());
        let refused = solid(2).with_colour_source(ColourSource::Attributes).map(|_| ());
        assert_eq!(refused, Err(SceneError::Attributes(2)));
        let coloured = solid(3).with_colour_source(ColourSource::Attributes).unwrap();
        let colour = coloured.diffuse(&[0.5, 7.0, -1.0], false);
        assert!((colour - DVec3::new(0.214_041_14, 1.0, 0.0)).length() < 1e-8);
        let own = coloured.material().diffuse();
        assert_eq!(coloured.diffuse(&[0.5, f64::NAN, 0.5], false), own);
        assert_eq!(solid(3).diffuse(&[0.5, 0.5, 0.5], false), own);
        let red = Material::new(DVec3::X, 0.0, 1.0).unwrap();
        let two_sided = solid(3).with_back_material(red);
        assert_eq!((two_sided.diffuse(&[], false), two_sided.diffuse(&[], true)), (own, DVec3::X));
    }
}
