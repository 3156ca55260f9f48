//! Where in space a field is: bounds of solids.

mod bounds;

pub use bounds::{DEFAULT_BOUNDS, Extent, FoundBounds, solid_bounds};
