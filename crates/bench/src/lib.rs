//! Measures Fieldstone, side by side with its peers.

mod font;
mod models;
mod program;

pub use font::{CAP, LINE_PITCH, Page};
pub use models::{BenchModel, MODELS};
pub use program::{Program, Value};
