//! The scene: solids, camera, light and settings.

use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::light::Lighting;
use crate::solid::{Instance, Solid};
use crate::texels::TexelBox;
use crate::text::Number;
use crate::tone::Tone;
use glam::DVec3;

/// The most pixels that an image may have: 2²⁶, 8192 × 8192.
pub const MAX_PIXELS: u64 = 1 << 26;

/// What a pixel takes in memory while an image is drawn and written, in bytes: its layers, and a little more.
const PIXEL_BYTES: u64 = 48;

/// The shortest step of [`Method::Sampled`], relative to the longest side of the bounds: rays have up to 1.7 million.
pub const MIN_STEP: f64 = 1e-6;

/// The most bounces of a ray.
pub const MAX_BOUNCES: u32 = 64;

/// The longest step, accepted width or tolerance, relative to the longest side of the bounds.
pub const MAX_LENGTH: f64 = 0.5;

/// The most samples that a pixel may have.
pub const MAX_SAMPLES: u32 = 4096;

/// Why parts make no [`Scene`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum SceneError {
    /// Nothing to draw.
    #[error("a scene needs a solid or a volume of texels")]
    NoSolid,
    /// A solid refers to attributes that its field does not have.
    #[error("{what} needs {needed} attributes, the field has {found}")]
    Attributes {
        /// What refers to them: `a texture`, `a part`, `a share` or `a condition`.
        what: &'static str,
        /// How many attributes it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A tree of set operations names a part that the solid does not have.
    #[error("the set operations name part {0}, the solid has {1}")]
    Part(usize, usize),
    /// An instance is of a solid that is not there, or is moved by a matrix that cannot be inverted.
    #[error("instance {0} {1}")]
    Instance(usize, &'static str),
    /// More bounces than [`MAX_BOUNCES`].
    #[error("a ray bounces at most {MAX_BOUNCES} times, not {0}")]
    Bounces(u32),
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

impl Method {
    /// That its lengths are positive, and steps not too short.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        match *self {
            Self::Affine => Ok(()),
            Self::Interval { accept_epsilon } => check_lengths(&[("accepted width", accept_epsilon)]),
            Self::Sampled { step } => {
                check_lengths(&[("step", step)])?;
                step.filter(|&step| step < MIN_STEP).map_or(Ok(()), |step| Err(SceneError::Step(step)))
            }
        }
    }
}

/// That lengths, where they are given, are positive and at most [`MAX_LENGTH`].
pub(crate) fn check_lengths(lengths: &[(&'static str, Option<f64>)]) -> Result<(), SceneError> {
    for &(name, length) in lengths {
        match length {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                return Err(SceneError::Length { name, value });
            }
            Some(value) if value > MAX_LENGTH => return Err(SceneError::Long { name, value }),
            _ => {}
        }
    }
    Ok(())
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
    /// The same for shadow rays, which may be coarser; `None`: as for other rays.
    pub shadow_tolerance: Option<f64>,
    /// How often light is followed on from surfaces that mirror it or let it through, at most [`MAX_BOUNCES`].
    pub bounces: u32,
    /// How light becomes the colours of a picture for the screen.
    pub tone: Tone,
}

impl Default for Settings {
    /// 512 × 512 pixels, 4 samples, the affine method, 8 bounces.
    fn default() -> Self {
        Self {
            size: (512, 512),
            samples: 4,
            method: Method::Affine,
            tolerance: None,
            shadow_tolerance: None,
            bounces: 8,
            tone: Tone::default(),
        }
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
        let lengths = [("tolerance", self.tolerance), ("shadow tolerance", self.shadow_tolerance)];
        check_lengths(&lengths)?;
        if self.bounces > MAX_BOUNCES {
            return Err(SceneError::Bounces(self.bounces));
        }
        self.method.check()
    }
}

/// Everything that is drawn, and how. What may be relied upon stands at the top of the [crate](crate).
#[derive(Clone, Debug)]
pub struct Scene {
    solids: Vec<Solid>,
    instances: Vec<Instance>,
    texels: Vec<TexelBox>,
    camera: Camera,
    lighting: Lighting,
    settings: Settings,
}

impl Scene {
    /// A scene in which every solid stands once, where its field puts it.
    ///
    /// # Errors
    /// No solid, or settings out of their range.
    pub fn new(
        solids: Vec<Solid>,
        camera: Camera,
        lighting: Lighting,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        let instances = (0..solids.len()).map(Instance::unmoved).collect();
        Self::with_instances(solids, instances, camera, lighting, settings)
    }

    /// A scene in which solids stand where instances say, any number of times each.
    ///
    /// # Errors
    /// No solid or instance, an instance of a solid that is not there, or settings out of their range.
    pub fn with_instances(
        solids: Vec<Solid>,
        instances: Vec<Instance>,
        camera: Camera,
        lighting: Lighting,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        if solids.is_empty() || instances.is_empty() {
            return Err(SceneError::NoSolid);
        }
        if let Some(i) = instances.iter().position(|instance| instance.solid() >= solids.len()) {
            return Err(SceneError::Instance(i, "is of a solid that is not there"));
        }
        settings.check()?;
        Ok(Self { solids, instances, texels: Vec::new(), camera, lighting, settings })
    }

    /// A scene of volumes of texels alone.
    ///
    /// # Errors
    /// No volume, or settings out of their range.
    pub fn of_texels(
        texels: Vec<TexelBox>,
        camera: Camera,
        lighting: Lighting,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        if texels.is_empty() {
            return Err(SceneError::NoSolid);
        }
        settings.check()?;
        Ok(Self { solids: Vec::new(), instances: Vec::new(), texels, camera, lighting, settings })
    }

    /// The same with volumes of texels in it, instead of those that it has; without any, a scene of volumes alone stays as it is.
    pub fn with_texels(self, texels: Vec<TexelBox>) -> Self {
        if texels.is_empty() && self.solids.is_empty() { self } else { Self { texels, ..self } }
    }

    /// The solids.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Where the solids stand.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The volumes of texels.
    pub fn texels(&self) -> &[TexelBox] {
        &self.texels
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

    /// The ray through the same point from a place on the lens; see [`Camera::lens_ray`].
    pub fn lens_ray(&self, (x, y): (f64, f64), lens: (f64, f64)) -> (DVec3, DVec3) {
        let (width, height) = self.settings.size;
        self.camera.lens_ray((x / f64::from(width), y / f64::from(height)), self.aspect(), lens)
    }

    /// The smallest box around the bounds of all instances and volumes, in world space.
    pub fn bounds(&self) -> Bounds {
        let of_instance = |i: &Instance| i.world_bounds(self.solids[i.solid()].bounds());
        let boxes = self.instances.iter().map(of_instance).chain(self.texels.iter().map(TexelBox::bounds));
        boxes.reduce(|all, bounds| all.union(&bounds)).expect("a scene holds a solid or a volume of texels")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Up;
    use fieldstone_field::{Bindings, Field, Graph, Input};

    fn unit_box() -> Bounds {
        Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap()
    }

    fn plane() -> Field {
        let mut graph = Graph::new();
        let x = graph.input(Input::Coordinate(0));
        Field::new(graph, x, Vec::new())
    }

    fn scene(settings: Settings) -> Result<Scene, SceneError> {
        let solid = Solid::new(plane(), Bindings::new(), unit_box());
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
}
