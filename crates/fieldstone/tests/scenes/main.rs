//! Scene files: what they mean, and what is said of those that mean nothing.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops where it is surprised")]

mod access;
mod data;
mod errors;
mod meaning;
mod schema;
mod solids;
mod space;
mod texels;

use fieldstone::{Document, FileAccess, ResolvedDocument, SceneRequest, Source};
use std::path::Path;

/// A scene that is read from a text, in the folder of these tests.
fn document(text: &str) -> Result<Document, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes");
    let source = Source::new("scene.toml", text);
    Document::parse(source, &folder, &FileAccess::default()).map_err(|error| error.to_string())
}

/// The scene of a text at a time.
fn at(text: &str, time: f64) -> Result<ResolvedDocument, String> {
    let request = SceneRequest { time: Some(time), ..SceneRequest::default() };
    document(text)?.resolve(&request).map_err(|error| error.to_string())
}

/// The scene of a text at its own time.
fn resolve(text: &str) -> ResolvedDocument {
    let scene = document(text).and_then(|d| d.resolve(&SceneRequest::default()).map_err(|e| e.to_string()));
    scene.unwrap_or_else(|error| panic!("{error}"))
}
