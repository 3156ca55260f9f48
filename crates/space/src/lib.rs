//! Where in space a field is: bounds of solids, and their sizes.

mod bounds;
mod measure;

pub use bounds::{DEFAULT_BOUNDS, Extent, FoundBounds, SEARCHED, solid_bounds};
pub use measure::{Corners, Enclosure, MeasureOptions, Measures, measure};
