//! The program from outside: what goes in, what comes out.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops where it is surprised")]

mod bench;
mod check;
mod convert;
mod eval;
mod interrupt;
mod manual;
mod measure;
mod place;
mod plot;
mod render;
mod robust;
mod scene;
mod slice;
mod sources;
mod texel;
