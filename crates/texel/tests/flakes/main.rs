//! Flakes, their light, and rays through volumes, by mathematics.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod chance;
mod light;
mod normals;
mod phase;
mod table;
mod walk;
