//! NRRD: "nearly raw raster data" (Kindlmann 2000), with the numbers in the file of the header or beside it, raw or
//! packed by gzip.

use super::raw::{NumberType, RawLayout, array, numbers};
use super::{DataError, Placement, placed, read, read_limited};
use fieldstone_solids::{Interpolation, VoxelArray};
use fieldstone_texel::sources::Scan;
use flate2::read::MultiGzDecoder;
use std::path::{Path, PathBuf};

/// No header is longer.
const MAX_HEADER: usize = 1 << 20;

/// What a header says.
#[derive(Default)]
struct Header {
    counts: Option<[usize; 3]>,
    steps: Option<[f64; 3]>,
    number: Option<NumberType>,
    big_endian: bool,
    is_packed: bool,
    skip: usize,
    /// The file with the numbers, if that is another.
    data_file: Option<String>,
}

/// The array of an NRRD file of three dimensions. Steps come from `spacings` or from the lengths of `space directions`.
///
/// # Errors
/// Files that cannot be read, kinds and encodings that are not known, headers with mistakes.
pub fn load_nrrd(
    path: &Path,
    placement: &Placement,
    interpolation: Interpolation,
) -> Result<VoxelArray, DataError> {
    let contents = contents(path)?;
    let place = placed(contents.layout.counts, contents.steps, placement);
    array(&contents.path, (&contents.bytes, &contents.layout), place, interpolation)
}

/// The numbers of an NRRD file as a scan, at the distances that it says.
pub(super) fn scan(path: &Path) -> Result<Scan, DataError> {
    let contents = contents(path)?;
    let values = numbers(&contents.path, (&contents.bytes, &contents.layout))?;
    let steps = contents.steps.unwrap_or([1.0; 3]);
    Scan::new(contents.layout.counts, steps, values)
        .map_err(|error| DataError::content(path, None, error.to_string()))
}

/// What an NRRD file holds.
struct Contents {
    /// The file with the numbers.
    path: PathBuf,
    bytes: Vec<u8>,
    layout: RawLayout,
    steps: Option<[f64; 3]>,
}

/// Reads the header and the bytes of the numbers, unpacked.
fn contents(path: &Path) -> Result<Contents, DataError> {
    let bytes = read(path)?;
    let (header, rest) = header(path, &bytes)?;
    let missing = |what: &str| DataError::content(path, None, format!("the header has no `{what}`"));
    let counts = header.counts.ok_or_else(|| missing("sizes"))?;
    let number = header.number.ok_or_else(|| missing("type"))?;
    let (data_path, data) = match &header.data_file {
        None => (path.to_owned(), rest.to_vec()),
        Some(name) => {
            let place = path.with_file_name(name);
            let detached = read(&place)?;
            (place, detached)
        }
    };
    let layout = RawLayout { counts, number, big_endian: header.big_endian, skip: header.skip };
    let bytes =
        if header.is_packed { read_limited(&data_path, MultiGzDecoder::new(&data[..]))? } else { data };
    Ok(Contents { path: data_path, bytes, layout, steps: header.steps })
}

/// The header, and the bytes after the empty line that ends it.
fn header<'b>(path: &Path, bytes: &'b [u8]) -> Result<(Header, &'b [u8]), DataError> {
    let mut header = Header::default();
    let mut rest = bytes;
    for number in 1.. {
        let end = rest.iter().take(MAX_HEADER).position(|&b| b == b'\n');
        let line = &rest[..end.unwrap_or(rest.len().min(MAX_HEADER))];
        let at_end = end.is_none();
        rest = &rest[end.map_or(rest.len(), |end| end + 1)..];
        let error = |message: String| DataError::content(path, Some(number), message);
        let line =
            std::str::from_utf8(line).map_err(|_| error("this line is no text".to_owned()))?.trim_end();
        if number == 1 {
            if !line.starts_with("NRRD000") {
                return Err(error("an NRRD file begins with NRRD0004 or the like".to_owned()));
            }
        } else if line.is_empty() {
            return Ok((header, rest));
        } else if !line.starts_with('#') {
            field(&mut header, line).map_err(error)?;
        }
        if at_end {
            break;
        }
    }
    Ok((header, &[]))
}

/// One line `key: value`; other keys, and pairs `key:=value`, are left alone.
fn field(header: &mut Header, line: &str) -> Result<(), String> {
    if line.contains(":=") {
        return Ok(());
    }
    let (key, value) = line.split_once(": ").ok_or("a line of the header is `key: value`")?;
    let value = value.trim();
    match key.to_ascii_lowercase().as_str() {
        "dimension" if value != "3" => {
            return Err(format!("an array of three dimensions is needed, not of {value}"));
        }
        "sizes" => header.counts = Some(three(value).ok_or("`sizes` are three whole numbers")?),
        "spacings" => header.steps = Some(three(value).ok_or("`spacings` are three numbers")?),
        "space directions" => {
            header.steps = Some(directions(value).ok_or("`space directions` are three vectors")?)
        }
        "type" => {
            header.number =
                Some(number_type(value).ok_or_else(|| format!("the type `{value}` is not known"))?)
        }
        "endian" => header.big_endian = value == "big",
        "encoding" => match value {
            "raw" => {}
            "gzip" | "gz" => header.is_packed = true,
            _ => return Err(format!("the encoding `{value}` is not read: write it as `raw` or `gzip`")),
        },
        "line skip" | "lineskip" if value != "0" => return Err("`line skip` is not read".to_owned()),
        "byte skip" | "byteskip" => {
            header.skip = value.parse().map_err(|_| "`byte skip` is a whole number from 0 on")?;
        }
        "data file" | "datafile" => header.data_file = Some(data_file(value)?),
        _ => {}
    }
    Ok(())
}

/// The name of a file beside the header: no other folder, no list of slices.
fn data_file(value: &str) -> Result<String, String> {
    let name = Path::new(value).file_name().and_then(|name| name.to_str());
    let is_plain = name.is_some_and(|name| value == name || value.strip_prefix("./") == Some(name));
    if !is_plain || value.starts_with("LIST") || value.contains('%') {
        return Err("`data file` names one file in the folder of the header".to_owned());
    }
    Ok(value.to_owned())
}

fn three<T: std::str::FromStr>(value: &str) -> Option<[T; 3]> {
    let numbers: Vec<T> = value.split_whitespace().map(|n| n.parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

/// The lengths of three vectors `(x,y,z)`.
fn directions(value: &str) -> Option<[f64; 3]> {
    let vectors = value.split(')').filter(|v| !v.trim().is_empty());
    let lengths: Vec<f64> = vectors
        .map(|vector| {
            let numbers = vector.trim().strip_prefix('(')?.split(',').map(|n| n.trim().parse::<f64>().ok());
            let squares: f64 = numbers.map(|n| n.map(|n| n * n)).sum::<Option<f64>>()?;
            Some(squares.sqrt())
        })
        .collect::<Option<_>>()?;
    lengths.try_into().ok()
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "unsigned char" | "uchar" | "uint8" | "uint8_t" => NumberType::U8,
        "signed char" | "int8" | "int8_t" => NumberType::I8,
        "unsigned short" | "unsigned short int" | "ushort" | "uint16" | "uint16_t" => NumberType::U16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => NumberType::I16,
        "unsigned int" | "uint" | "uint32" | "uint32_t" => NumberType::U32,
        "int" | "signed int" | "int32" | "int32_t" => NumberType::I32,
        "float" => NumberType::F32,
        "double" => NumberType::F64,
        _ => return None,
    })
}
