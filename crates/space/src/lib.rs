//! Where in space a field is: bounds of solids, their sizes, and an octree of shortened programs that rays walk.

mod bounds;
mod gradient;
mod measure;
mod octree;

pub use bounds::{DEFAULT_BOUNDS, Extent, FoundBounds, SEARCHED, solid_bounds};
pub use measure::{Corners, Enclosure, MeasureOptions, Measures, measure};
pub use octree::{Census, Lattice, Octree, OctreeOptions, Walker};
