//! Making solids: blends, mappings of space, sweeps and projections, voxels, scattered points, splines and noise.
//!
//! What has a closed form is built from the operations of a [`Graph`](fieldstone_field::Graph), so that it is
//! evaluated in vectors and shortened by boxes; what has none, or rests on data, is a
//! [`Function`](fieldstone_field::Function) with intervals that hold its values. Negative is inside, everywhere.

mod bernstein;
mod blend;
mod combine;
pub mod expression;
mod least;
mod map;
mod minimum;
mod nearest;
mod noise;
mod normal;
mod points;
mod rounding;
mod slope;
mod spline;
mod sweep;
mod texture;
mod voxels;
mod weight;

pub use blend::{Blend, Blended, Joint, join, linear};
pub use combine::{offset, product, shell};
pub use least::{Course, least};
pub use map::{
    affine, bend, invert, mirror, mirror_across, moved, polar_repeat, repeat, repeat_onward, repeat_times,
    rotate, scale, taper, translate, twist,
};
pub use minimum::{Minimum, MinimumError};
pub use noise::gradient_noise;
pub use normal::{
    bend_normal, invert_normal, mirror_normal, polar_repeat_normal, taper_normal, twist_normal,
};
pub use points::{Kernel, MAX_POINTS, PointCloud, PointError, Points, Reconstruction};
pub use spline::{Basis, SplineError, SplineVolume};
pub use sweep::{CURVE_PARAMETER, Curve, CurveError, project, projection, sweep, tube};
pub use texture::{checker, fractal_noise, marble, turbulence, wood};
pub use voxels::{Interpolation, MAX_VOXELS, VoxelArray, VoxelError};
pub use weight::{gaussian, sigmoid};
