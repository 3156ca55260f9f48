//! `fieldstone completions`.

use crate::arguments::{Arguments, CompletionsArguments};
use crate::failure::Failure;
use clap::CommandFactory;
use std::io::Write;

/// Prints the completions of a shell.
pub(crate) fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "fieldstone", &mut script);
    std::io::stdout().write_all(&script).map_err(|e| Failure::of_stream("standard output", &e))
}
