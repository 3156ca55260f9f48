//! The handbook is true: every example is a solid, has its picture, and what is stated of it holds; every function of
//! the language is described, and every link leads somewhere.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../../examples/handbook/blocks.rs"]
mod blocks;
mod conformance;
mod examples;
mod links;
mod pictures;
mod statements;
