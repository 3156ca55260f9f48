//! The CPU integrator of Fieldstone.
//!
//! [`render`] draws a resolved [`Scene`](fieldstone_scene::Scene) tile by tile on all cores. Everything that light
//! does goes through two queries of the scene: the nearest surface along a ray, and the pieces of it in volumes
//! of texels before that. A first pass looks through the centre of every pixel; a second takes more samples where
//! neighbours differ.
//!
//! A [`Viewer`] draws distances and normals only, frame after frame, without preparing the scene again.
//! [`draw_slice`] draws a field on a plane instead.

mod bsdf;
mod conditions;
mod hierarchy;
mod instances;
mod integrator;
mod jump;
mod lamps;
mod media;
mod noise;
mod object;
mod owner;
mod query;
mod refine;
mod roots;
mod sampling;
mod shadows;
mod sight;
mod sky;
mod slice;
mod tile;
mod volumes;

pub use sight::{Sight, Viewer};
pub use slice::{
    FoundWindow, MAX_SLICE_PIXELS, Slice, SliceError, SlicePicture, SliceStats, SliceStyle, Window,
    WindowExtent, draw_slice, find_window,
};
pub use tile::{RenderError, RenderOptions, Rendered, Stats, render};
