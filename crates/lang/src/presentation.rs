//! How a file wants its model shown, apart from what the model is.

/// How a file wants its model shown. What it does not say is `None`, or empty.
///
/// All points, directions and lengths are in the space of the model, and everything is finite.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Presentation {
    /// Whether the set f = 0 itself is meant: a surface without an inside, of which both sides are seen.
    pub surface: bool,
    /// Only what lies in this ball is shown: its centre, and its radius, which is positive.
    pub clip_sphere: Option<([f64; 3], f64)>,
    /// The side of the surface from which f > 0 is seen: the outside of a solid.
    pub front: Option<Finish>,
    /// The side from which f < 0 is seen.
    pub back: Option<Finish>,
    /// What is seen where there is nothing: sRGB, from 0 to 1.
    pub background: Option<[f64; 3]>,
    /// Where it is seen from.
    pub view: Option<Viewpoint>,
    /// The lights; `None` if the file says nothing of light.
    pub lamps: Option<Vec<Lamp>>,
}

/// How a side of a surface answers to light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Finish {
    /// sRGB, from 0 to 1.
    pub colour: [f64; 3],
    /// The part of the light from everywhere that is scattered, from 0 on.
    pub ambient: f64,
    /// The part of the light of lamps that is scattered, from 0 on.
    pub diffuse: f64,
    /// The strength of highlights, from 0 on.
    pub specular: f64,
    /// The exponent of highlights, from 1 on.
    pub shininess: f64,
}

/// A light from infinitely far that casts no shadow.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lamp {
    /// The unit vector towards the light.
    pub to_light: [f64; 3],
    /// sRGB, from 0 to 1.
    pub colour: [f64; 3],
    /// The factor of its strength, from 0 on.
    pub intensity: f64,
}

/// Where a model is seen from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Viewpoint {
    /// Where the camera stands.
    pub eye: [f64; 3],
    /// A point in the middle of the image, not the eye.
    pub target: [f64; 3],
    /// The unit vector that points up in the image, at right angles to the view.
    pub up: [f64; 3],
    /// How space is mapped to the image.
    pub lens: Lens,
}

/// How space is mapped to an image.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Lens {
    /// Rays start at the eye.
    Perspective {
        /// The angle between the upper and the lower edge of the image, between 0 and π.
        vertical_fov_radians: f64,
    },
    /// Rays are parallel.
    Parallel {
        /// The distance between the upper and the lower edge of the image, positive.
        height: f64,
    },
}
