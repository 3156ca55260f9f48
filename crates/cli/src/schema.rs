//! `fieldstone schema`.

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use std::io::Write;

/// The arguments of `schema`.
#[derive(Debug, Args)]
pub(crate) struct SchemaArguments {
    /// Of which files.
    #[arg(value_enum, default_value_t = Files::Scene)]
    files: Files,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Files {
    /// Scenes.
    Scene,
    /// Recipes of volumes, for `texel build`.
    Recipe,
}

/// Prints a JSON Schema.
pub(crate) fn run(arguments: &SchemaArguments) -> Result<(), Failure> {
    let schema = match arguments.files {
        Files::Scene => fieldstone::scene_schema(),
        Files::Recipe => fieldstone::recipe_schema(),
    };
    writeln!(std::io::stdout(), "{schema:#}").map_err(|e| Failure::of_stream("standard output", &e))
}
