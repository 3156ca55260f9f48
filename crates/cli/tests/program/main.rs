//! The program from outside: what goes in, what comes out.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops where it is surprised")]

mod eval;
mod measure;
mod place;
mod plot;
mod render;
