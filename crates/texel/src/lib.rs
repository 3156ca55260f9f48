//! Volumetric textures: a volume whose cells hold how much stands in light's way, and which way its surfaces face.
//!
//! After F. Neyret, "A General and Multiscale Model for Volumetric Textures" (Graphics Interface 1995): an octree keeps
//! every level of a reference volume; a cell of any level stands for what is inside it. The distribution of normals
//! is an ellipsoid, here in the form of E. Heitz, J. Dupuy, C. Crassin and C. Dachsbacher, "The SGGX Microflake
//! Distribution" (SIGGRAPH 2015); [`Mode`] says by which of the two rules cells are joined.
//!
//! - [`Texel`] is what fills a cell; [`Sggx`] its flakes.
//! - [`Builder`] takes the cells of the finest level and filters them upward into a [`Volume`].
//! - [`paint`] and [`sources`] make cells of shapes, fields, meshes, strands, scans, noise and particles.
//!
//! Lengths are in units of the volume's edge: the volume is the unit cube, a cell of level l is 2ˡ / edge wide.

mod build;
mod chance;
mod file;
mod filter;
mod flake;
mod light;
mod morton;
mod pack;
pub mod paint;
mod phase;
mod sggx;
pub mod sources;
mod stats;
mod symmetric;
mod texel;
mod volume;
mod walk;

pub use build::{BuildError, Builder};
pub use file::FileError;
pub use filter::Mode;
pub use flake::{Flakes, VisibleNormals, disc_point};
pub use light::{Gathered, Lamp, lit_share};
pub use phase::{Model, NORMALS, Reflector, fibre_phase};
pub use sggx::Sggx;
pub use stats::{Fidelity, Size};
pub use texel::{MAX_DEPTH, Phong, Texel};
pub use volume::{Found, MAX_EDGE, Volume};
pub use walk::{Footprint, Layer, Ray, Segment, Segments};
