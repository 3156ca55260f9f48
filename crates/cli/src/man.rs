//! `fieldstone man`.

use crate::arguments::{Arguments, ManArguments};
use crate::failure::Failure;
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use fieldstone::write_beside;

/// Writes a manual page for the program and one for each of its commands, and theirs.
pub(crate) fn run(arguments: &ManArguments) -> Result<(), Failure> {
    let folder = &arguments.folder;
    if !folder.is_dir() {
        return Err(Failure::Material(format!("there is no folder {}", folder.display())));
    }
    for (name, page) in pages() {
        write_beside(&folder.join(format!("{name}.1")), |file| page.render(file))?;
    }
    Ok(())
}

/// The names of the pages, and the pages.
fn pages() -> Vec<(String, Man)> {
    let mut program = Arguments::command();
    // Hands what holds for all commands on to them.
    program.build();
    let page = |command: &Command| {
        let source = concat!("fieldstone ", env!("CARGO_PKG_VERSION"));
        Man::new(command.clone()).source(source).manual("Fieldstone")
    };
    with_parts(&program).into_iter().map(|command| (name(command), page(command))).collect()
}

/// A command, its commands, and theirs.
fn with_parts(command: &Command) -> Vec<&Command> {
    let parts = command.get_subcommands().filter(|part| part.get_name() != "help");
    std::iter::once(command).chain(parts.flat_map(with_parts)).collect()
}

/// `fieldstone-render` for `fieldstone render`.
fn name(command: &Command) -> String {
    command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned()
}
