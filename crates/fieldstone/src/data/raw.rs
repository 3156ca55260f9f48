//! Numbers one after another.

use super::{DataError, Placement, placed, read};
use fieldstone_solids::{Interpolation, MAX_VOXELS, VoxelArray, VoxelError};
use std::path::Path;

/// How a number is written.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum NumberType {
    /// One byte, without a sign.
    U8,
    /// One byte.
    I8,
    /// Two bytes, without a sign.
    U16,
    /// Two bytes.
    I16,
    /// Four bytes, without a sign.
    U32,
    /// Four bytes.
    I32,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl NumberType {
    /// All types with their names in scene files.
    pub const NAMES: [(&str, Self); 8] = [
        ("u8", Self::U8),
        ("i8", Self::I8),
        ("u16", Self::U16),
        ("i16", Self::I16),
        ("u32", Self::U32),
        ("i32", Self::I32),
        ("f32", Self::F32),
        ("f64", Self::F64),
    ];

    /// The size in bytes.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// How numbers stand in a file.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct RawLayout {
    /// How many there are along x, y and z; those along x stand next to one another.
    pub counts: [usize; 3],
    /// How each is written.
    pub number: NumberType,
    /// Whether the byte of the highest value comes first.
    pub big_endian: bool,
    /// How many bytes stand before the first one.
    pub skip: usize,
}

/// The array of raw numbers in a file.
///
/// # Errors
/// Files that cannot be read or are too short; counts that make no array.
pub fn load_raw(
    path: &Path,
    layout: &RawLayout,
    placement: &Placement,
    interpolation: Interpolation,
) -> Result<VoxelArray, DataError> {
    let bytes = read(path)?;
    array(path, (&bytes, layout), placed(layout.counts, None, placement), interpolation)
}

/// The array of the numbers that begin the bytes.
pub(super) fn array(
    path: &Path,
    data: (&[u8], &RawLayout),
    place: [[f64; 3]; 2],
    interpolation: Interpolation,
) -> Result<VoxelArray, DataError> {
    let values = numbers(path, data)?;
    VoxelArray::new(data.1.counts, values, place, interpolation)
        .map_err(|reason| DataError::Voxels { path: path.to_owned(), reason })
}

/// The numbers that begin the bytes.
pub(super) fn numbers(path: &Path, (bytes, layout): (&[u8], &RawLayout)) -> Result<Vec<f32>, DataError> {
    let counts = layout.counts;
    let count = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    let too_many = || DataError::Voxels { path: path.to_owned(), reason: VoxelError::Counts(counts) };
    let count = count.filter(|n| *n <= MAX_VOXELS).ok_or_else(too_many)?;
    let bytes = bytes.get(layout.skip..).unwrap_or_default();
    let needed = count * layout.number.bytes();
    if bytes.len() < needed {
        let [x, y, z] = counts;
        let (size, found) = (layout.number.bytes(), bytes.len());
        let message = format!(
            "{x} × {y} × {z} numbers of {size} bytes are {needed} bytes, and there are {found}: is the size or the type another?"
        );
        return Err(DataError::content(path, None, message));
    }
    let numbers = bytes[..needed].chunks_exact(layout.number.bytes());
    Ok(numbers.map(|number| value(number, layout)).collect())
}

/// The value of one number; its bytes are as many as its type has.
fn value(bytes: &[u8], layout: &RawLayout) -> f32 {
    let mut ordered = [0u8; 8];
    for (to, i) in ordered.iter_mut().zip(0..bytes.len()) {
        *to = bytes[if layout.big_endian { bytes.len() - 1 - i } else { i }];
    }
    let bits = u64::from_le_bytes(ordered);
    match layout.number {
        NumberType::U8 => bits as u8 as f32,
        NumberType::I8 => bits as i8 as f32,
        NumberType::U16 => bits as u16 as f32,
        NumberType::I16 => bits as i16 as f32,
        NumberType::U32 => bits as u32 as f32,
        NumberType::I32 => bits as i32 as f32,
        NumberType::F32 => f32::from_bits(bits as u32),
        NumberType::F64 => f64::from_bits(bits) as f32,
    }
}
