//! Data that solids are made of: voxel arrays and points, from files.

mod nrrd;
mod points;
mod raw;

use crate::load::open_regular;
use fieldstone_solids::{PointError, VoxelArray, VoxelError};
use fieldstone_texel::sources::{Scan, SourceError};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

pub use nrrd::load_nrrd;
pub use points::load_points;
pub use raw::{NumberType, RawLayout, load_raw};

/// A data file larger than this is not read: 512 MiB.
pub const MAX_DATA_BYTES: u64 = 512 << 20;

/// Where the numbers of an array stand, if not where its file says.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Placement {
    /// The corners of the box of the outermost numbers. By default the longest side of the array is from −1 to 1 and all
    /// steps are those of the file, or the same, with the middle at the origin.
    pub place: Option<[[f64; 3]; 2]>,
}

/// Why a data file is not read.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The file cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// The file, or what is packed in it, is larger than [`MAX_DATA_BYTES`].
    #[error("{} holds more than {} MiB: too much for an array or points", .0.display(), MAX_DATA_BYTES >> 20)]
    TooLarge(PathBuf),
    /// The contents are not what they should be.
    #[error("{}{}: {message}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Content {
        /// The file.
        path: PathBuf,
        /// The line, from 1, where there are lines.
        line: Option<usize>,
        /// What is wrong, and what to do.
        message: String,
    },
    /// The numbers make no array.
    #[error("{}: {reason}", path.display())]
    Voxels {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: VoxelError,
    },
    /// The points make no solid.
    #[error("{}: {reason}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: PointError,
    },
    /// A source of volumetric textures is not read.
    #[error(transparent)]
    Source(#[from] SourceError),
}

impl DataError {
    fn content(path: &Path, line: Option<usize>, message: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), line, message: message.into() }
    }
}

/// The bytes of a file.
fn read(path: &Path) -> Result<Vec<u8>, DataError> {
    let unreadable = |reason| DataError::Unreadable { path: path.to_owned(), reason };
    let file = open_regular(path).map_err(unreadable)?;
    read_limited(path, file)
}

/// All bytes of a stream, as long as they are few enough.
fn read_limited(path: &Path, stream: impl Read) -> Result<Vec<u8>, DataError> {
    let mut bytes = Vec::new();
    let unreadable = |reason| DataError::Unreadable { path: path.to_owned(), reason };
    stream.take(MAX_DATA_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_DATA_BYTES { Err(DataError::TooLarge(path.to_owned())) } else { Ok(bytes) }
}

/// Origin and steps of an array with these steps in the file, or none.
fn placed(counts: [usize; 3], steps: Option<[f64; 3]>, placement: &Placement) -> [[f64; 3]; 2] {
    let intervals = counts.map(|n| n.saturating_sub(1).max(1) as f64);
    if let Some([low, high]) = placement.place {
        return [low, [0, 1, 2].map(|k| (high[k] - low[k]) / intervals[k])];
    }
    let steps = steps.unwrap_or([1.0; 3]);
    let longest = (0..3).map(|k| steps[k] * intervals[k]).fold(0.0, f64::max);
    let steps = steps.map(|s| 2.0 * s / longest);
    [[0, 1, 2].map(|k| -0.5 * steps[k] * intervals[k]), steps]
}

/// Reads a voxel array: NRRD from `.nrrd` and `.nhdr`, raw numbers from any other file, which `raw` must describe.
///
/// # Errors
/// Files that cannot be read, are too large, or hold something else.
pub fn load_voxels(
    path: &Path,
    raw: Option<&RawLayout>,
    placement: &Placement,
    interpolation: fieldstone_solids::Interpolation,
) -> Result<VoxelArray, DataError> {
    let kind = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match (kind.as_deref(), raw) {
        (Some("nrrd" | "nhdr"), _) => load_nrrd(path, placement, interpolation),
        (_, Some(layout)) => load_raw(path, layout, placement, interpolation),
        _ => Err(needs_layout(path)),
    }
}

/// Reads a scan for a volumetric texture: NIfTI from `.nii` and `.gz`, NRRD from `.nrrd` and `.nhdr`, at their own distances;
/// raw numbers, at distances of 1, from any other file, which `raw` must describe.
///
/// # Errors
/// Files that cannot be read, are too large, or hold something else.
pub fn load_scan(path: &Path, raw: Option<&RawLayout>) -> Result<Scan, DataError> {
    let kind = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match (kind.as_deref(), raw) {
        (Some("nii" | "gz"), None) => Ok(fieldstone_texel::sources::read_nifti(path)?),
        (Some("nrrd" | "nhdr"), _) => nrrd::scan(path),
        (_, Some(layout)) => {
            let values = raw::numbers(path, (&read(path)?, layout))?;
            Scan::new(layout.counts, [1.0; 3], values)
                .map_err(|error| DataError::content(path, None, error.to_string()))
        }
        _ => Err(needs_layout(path)),
    }
}

fn needs_layout(path: &Path) -> DataError {
    let message = "raw numbers need their counts and type, such as size = [64, 64, 64], type = \"u8\"";
    DataError::content(path, None, message)
}

#[cfg(test)]
mod tests;
