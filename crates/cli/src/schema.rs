//! `fieldstone schema`.

use crate::failure::Failure;
use std::io::Write;

/// Prints the JSON Schema of scene files.
pub(crate) fn run() -> Result<(), Failure> {
    let schema = fieldstone::scene_schema();
    writeln!(std::io::stdout(), "{schema:#}").map_err(|e| Failure::of_stream("standard output", &e))
}
