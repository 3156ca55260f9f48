//! Volumes of texels: what they are made of, their files, and pictures of what is in them.

mod cut;
mod mend;
mod recipe;
mod source;
mod text;
mod values;

pub use cut::{Cut, CutContent, CutPicture, MAX_CUT_PIXELS};
pub use recipe::{Recipe, recipe_schema};

use crate::load::{LoadError, open_regular};
use crate::output::{OutputError, write_beside};
use fieldstone_texel::paint::PaintError;
use fieldstone_texel::{BuildError, FileError, Volume};
use std::path::{Path, PathBuf};

/// Why there is no volume.
#[derive(Debug, thiserror::Error)]
pub enum TexelError {
    /// The recipe was not read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The shapes of a recipe fill too much.
    #[error(transparent)]
    Paint(#[from] PaintError),
    /// The cells make no volume.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A `.texel` file was not read.
    #[error("{}: {reason}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: FileError,
    },
    /// A picture that cannot be drawn.
    #[error("{0}")]
    Cut(String),
}

/// Reads a `.texel` file.
///
/// # Errors
/// The file cannot be read, or is damaged in whatever way.
pub fn load_volume(path: &Path) -> Result<Volume, TexelError> {
    let failed = |reason| TexelError::File { path: path.to_owned(), reason };
    // Pipes and devices may never end.
    open_regular(path).map_err(|reason| failed(reason.into()))?;
    Volume::read(path).map_err(failed)
}

/// Writes a `.texel` file, beside its place and then renamed.
///
/// # Errors
/// The file cannot be written; nothing is left of it then.
pub fn write_volume(volume: &Volume, path: &Path) -> Result<(), OutputError> {
    write_beside(path, |file| volume.write_to(file))
}
