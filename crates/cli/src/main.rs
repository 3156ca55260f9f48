//! The program `fieldstone`.
fn main() {}
