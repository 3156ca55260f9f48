//! What there is to draw, resolved; cameras, lights, film.
//!
//! A [`Scene`] is plain data about which nothing needs to be checked again:
//! - there is at least one [`Solid`] or [`TexelBox`]; its [`Bounds`] are finite and have a positive extent along every axis;
//! - where there is a solid, there is an [`Instance`]; each is of a solid of the scene and can be moved back;
//! - a [`Ball`] that a solid is clipped to has a finite centre and a positive radius;
//! - attributes that parts, shares, textures and conditions refer to exist; trees name parts that exist;
//! - the numbers of a [`Material`] are in their ranges;
//! - the [`Camera`]'s axes are orthonormal, its field of view lies between 0 and π, its height is positive;
//! - directions to [`Light`]s are unit vectors, colours are finite and not negative;
//! - a [`TexelBox`] can be moved back, its density is positive, and it is repeated along cyclic axes alone;
//! - the image has at least one pixel and at most [`MAX_PIXELS`], and at least one sample a pixel;
//! - steps and tolerances are positive and at most [`MAX_LENGTH`], and steps at least [`MIN_STEP`].
//!
//! Colours are linear RGB throughout; [`srgb_to_linear`] and [`linear_to_srgb`] stand at the border. Space is
//! right-handed, angles are radians, and image coordinates run from the upper left corner. The result is a [`Film`].

mod ball;
mod bounds;
mod camera;
mod colour;
mod environment;
mod film;
mod image;
mod light;
mod material;
mod scene;
mod solid;
mod texels;
mod text;
mod tone;

pub use ball::{Ball, BallError};
pub use bounds::{Bounds, BoundsError, RaySpan};
pub use camera::{Aperture, Camera, CameraError, Projection, Rays, Up, View};
pub use colour::{Background, Rgb, linear_to_srgb, srgb_to_linear};
pub use environment::{Environment, EnvironmentError, Face, Surroundings};
pub use film::{CHANNELS, Film, Pixel};
pub use image::{Image, ImageError, MAX_IMAGE_PIXELS, Wrap};
pub use light::{Illumination, Light, LightError, LightSource, Lighting, MAX_LIGHT_SAMPLES};
pub use material::{Appearance, Channel, Material, MaterialError, Shading, Texture};
pub use scene::{
    MAX_BOUNCES, MAX_LENGTH, MAX_PIXELS, MAX_SAMPLES, MIN_STEP, Method, Scene, SceneError, Settings,
};
pub use solid::{Blended, Condition, Instance, NORMAL_INPUTS, Part, Solid, Tree};
pub use texels::{MAX_REPEATS, TexelBox};
pub use tone::{ExposureError, Tone, ToneCurve};
