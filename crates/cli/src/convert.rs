//! `fieldstone convert`.

use crate::arguments::{ModelArguments, OUTPUT};
use crate::failure::Failure;
use clap::Args;
use fieldstone::{ConvertError, Syntax, convert, write_beside};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The arguments of `convert`.
#[derive(Debug, Args)]
pub(crate) struct ConvertArguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The new file: .hf for HyperFun, .vm for a program, .txt for a formula.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    output: PathBuf,
    /// Print nothing but errors.
    #[arg(long, help_heading = OUTPUT)]
    quiet: bool,
}

/// Writes a model in another language.
pub(crate) fn run(arguments: &ConvertArguments) -> Result<(), Failure> {
    let syntax = syntax(&arguments.output)?;
    let loaded = arguments.model.load().map_err(|failure| failure.filtered(arguments.quiet))?;
    let printed = convert(&loaded.model, &arguments.model.inputs(), syntax).map_err(|error| match error {
        ConvertError::Input(error) => Failure::from(error),
        ConvertError::Print(error) => Failure::Material(error.to_string()),
    })?;
    if !arguments.quiet {
        loaded.rendered_warnings().for_each(|warning| eprintln!("{warning}"));
        printed.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    }
    write_beside(&arguments.output, |file| file.write_all(printed.text.as_bytes()))?;
    Ok(())
}

fn syntax(path: &Path) -> Result<Syntax, Failure> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("hf" | "hpf") => Ok(Syntax::HyperFun),
        Some("vm") => Ok(Syntax::Vm),
        Some("txt") => Ok(Syntax::Formula),
        _ => Err(Failure::Usage(format!(
            "{}: the new file must be .hf (HyperFun), .vm (a program) or .txt (a formula)",
            path.display()
        ))),
    }
}
