//! Reading files of sources.

use super::SourceError;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};
use std::io::{self, Read};
use std::path::Path;

/// A file larger than this is not read: 512 MiB.
pub const MAX_FILE_BYTES: u64 = 512 << 20;

pub(super) fn content(path: &Path, line: Option<usize>, message: impl Into<String>) -> SourceError {
    SourceError::Content { path: path.to_owned(), line, message: message.into() }
}

/// The bytes of a regular file that is not too large.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, SourceError> {
    let unreadable = |reason| SourceError::Unreadable { path: path.to_owned(), reason };
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(unreadable(io::Error::other("it is no regular file")));
    }
    let file = std::fs::File::open(path).map_err(unreadable)?;
    read_limited(path, file)
}

/// All bytes of a stream, as long as they are few enough.
pub(super) fn read_limited(path: &Path, stream: impl Read) -> Result<Vec<u8>, SourceError> {
    let unreadable = |reason| SourceError::Unreadable { path: path.to_owned(), reason };
    let mut bytes = Vec::new();
    stream.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(content(path, None, format!("it holds more than {} MiB", MAX_FILE_BYTES >> 20)));
    }
    Ok(bytes)
}

/// The lines of a table of numbers, each with its number from 1: empty ones hold nothing, and what follows `#` is left
/// out. Numbers stand between commas, semicolons and blanks. A first line of names counts as empty.
pub(super) fn rows(path: &Path, bytes: &[u8]) -> Result<Vec<(usize, Vec<f64>)>, SourceError> {
    let text = std::str::from_utf8(bytes).map_err(|_| content(path, None, "this is no text"))?;
    let mut rows = Vec::new();
    let mut is_first = true;
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let cells = line.split([',', ';', '\t', ' ', '\r']).filter(|cell| !cell.is_empty());
        let numbers: Option<Vec<f64>> =
            cells.map(|cell| cell.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match numbers {
            Some(numbers) => {
                is_first &= numbers.is_empty();
                rows.push((number + 1, numbers));
            }
            None if is_first => {
                is_first = false;
                rows.push((number + 1, Vec::new()));
            }
            None => return Err(content(path, Some(number + 1), "here is something else than a number")),
        }
    }
    Ok(rows)
}

/// Properties of vertices that are read.
const NAMES: [&str; 7] = ["x", "y", "z", "radius", "red", "green", "blue"];

/// A vertex or a face of a PLY file.
#[derive(Clone, Debug, Default)]
pub(super) struct PlyRow {
    /// x, y, z, radius, red, green, blue; what is not there is 0.
    pub(super) numbers: [f64; 7],
    /// Vertices of a face.
    pub(super) corners: Vec<u32>,
}

impl PropertyAccess for PlyRow {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if name == "vertex_indices" || name == "vertex_index" {
            return self.set_corners(value);
        }
        let Some(place) = NAMES.iter().position(|known| *known == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.numbers[place] = match value {
            Property::Char(x) => f64::from(x),
            Property::UChar(x) => f64::from(x),
            Property::Short(x) => f64::from(x),
            Property::UShort(x) => f64::from(x),
            Property::Int(x) => f64::from(x),
            Property::UInt(x) => f64::from(x),
            Property::Float(x) => f64::from(x),
            Property::Double(x) => x,
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

impl PlyRow {
    fn set_corners(&mut self, value: Property) -> PropertyAccessResult {
        // A negative number becomes one that no vertex has.
        self.corners = match value {
            Property::ListChar(list) => list.into_iter().map(|i| i as u32).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| i as u32).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            Property::ListInt(list) => list.into_iter().map(|i| i as u32).collect(),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// What a PLY file holds.
#[derive(Debug, Default)]
pub(super) struct Ply {
    pub(super) vertices: Vec<PlyRow>,
    pub(super) faces: Vec<PlyRow>,
    /// Whether vertices have a radius.
    pub(super) has_radius: bool,
    /// Whether vertices have a colour, and what its numbers go up to.
    pub(super) colour_scale: Option<f64>,
}

/// Reads a PLY file; at most `most` rows of each element.
pub(super) fn read_ply(path: &Path, bytes: &[u8], most: usize) -> Result<Ply, SourceError> {
    let parser = Parser::<PlyRow>::new();
    let mut reader = Reader::new(bytes);
    let failed = |error: &dyn std::fmt::Display| content(path, None, format!("this is no PLY file: {error}"));
    let header = parser.read_header(&mut reader).map_err(|e| failed(&e))?;
    let Some(vertex) = header.elements.get("vertex") else {
        return Err(content(path, None, "there is no element `vertex`"));
    };
    if ["x", "y", "z"].iter().any(|name| !vertex.properties.contains_key(*name)) {
        return Err(content(path, None, "the vertices have no coordinates `x`, `y`, `z`"));
    }
    // A row takes a byte at least, so that a header alone cannot ask for much memory.
    if let Some(many) = header.elements.values().map(|e| e.count).find(|n| *n > most || *n > bytes.len()) {
        let message =
            format!("its header announces {many} rows, more than it holds or than the {most} that are read");
        return Err(content(path, None, message));
    }
    let mut ply = Ply { has_radius: vertex.properties.contains_key("radius"), ..Ply::default() };
    if ["red", "green", "blue"].iter().all(|name| vertex.properties.contains_key(*name)) {
        let is_byte = format!("{:?}", vertex.properties["red"].data_type).contains("Char");
        ply.colour_scale = Some(if is_byte { 255.0 } else { 1.0 });
    }
    for (name, element) in &header.elements {
        let rows = parser.read_payload_for_element(&mut reader, element, &header).map_err(|e| failed(&e))?;
        match name.as_str() {
            "vertex" => ply.vertices = rows,
            "face" => ply.faces = rows,
            _ => {}
        }
    }
    let is_finite = |row: &PlyRow| row.numbers.iter().all(|x| x.is_finite());
    if let Some(bad) = ply.vertices.iter().position(|row| !is_finite(row)) {
        return Err(content(path, None, format!("vertex {bad} is no point: a number is not finite")));
    }
    Ok(ply)
}

impl Ply {
    /// The colour of a vertex, linear; numbers of the file are sRGB.
    pub(super) fn colour(&self, row: &PlyRow) -> Option<[f32; 3]> {
        self.colour_scale.map(|scale| [4, 5, 6].map(|i| linear(row.numbers[i] / scale)))
    }
}

/// A linear share of light from an sRGB number, 0 to 1 (IEC 61966-2-1).
pub(super) fn linear(srgb: f64) -> f32 {
    let c = srgb.clamp(0.0, 1.0);
    (if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }) as f32
}
