//! Measures Fieldstone, side by side with its peers.
//!
//! A [`contest`] lets [`Contestant`]s draw the same [`MODELS`] in turn; what counts is how their times compare pair by pair,
//! since machines are never quiet. A [`Plan`] measures that and more, and makes a [`Report`].
//!
//! fidget is compiled in with the feature `fidget` only; POV-Ray and valgrind are programs that may be missing.

mod contest;
mod counts;
mod error;
#[cfg(feature = "fidget")]
mod fidget;
mod font;
mod frames;
mod gallery;
mod growth;
mod models;
mod ours;
mod plan;
mod povray;
mod program;
mod report;
mod timing;
mod view;
mod worker;

pub use contest::{Contestant, Standing, contest};
pub use counts::{BAND, outside_of_band, to_commit};
pub use error::BenchError;
pub use font::{CAP, LINE_PITCH, Page};
pub use frames::HAS_FIDGET;
pub use models::{BenchModel, MODELS};
pub use ours::{Frames, Prepared, Slices};
pub use plan::{Part, Plan};
pub use program::{Program, Value};
pub use report::{CountRow, Figure, GalleryRow, GrowthRow, Machine, ModelRow, PovRow, Report};
pub use timing::{Spread, Times};
pub use view::{Lens, Walk};
pub use worker::{Work, work};
