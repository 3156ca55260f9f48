//! Points with and without normals: PLY, and tables of numbers.

use super::{DataError, read};
use fieldstone_solids::{MAX_POINTS, PointCloud};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Header, PropertyAccess, PropertyAccessResult};
use std::path::Path;

/// Reads points and their normals, which point outside: PLY with `x y z nx ny nz` from `.ply`, and six columns x, y, z, nx, ny,
/// nz from any other file, separated by commas, semicolons, tabs or blanks, with or without a line of names. Of a PLY with
/// `x y z` alone, or three columns, normals are [estimated](PointCloud::without_normals).
///
/// # Errors
/// Files that cannot be read, have too many points, or hold something else; points of which no normals can be
/// estimated.
pub fn load_points(path: &Path) -> Result<PointCloud, DataError> {
    let bytes = read(path)?;
    let is_ply = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"));
    let cloud = if is_ply { ply(path, &bytes) } else { table(path, &bytes) }?;
    if !cloud.normals.is_empty() {
        return Ok(cloud);
    }
    PointCloud::without_normals(cloud.points)
        .map_err(|reason| DataError::Points { path: path.to_owned(), reason })
}

/// A point of a PLY file.
struct Vertex([f64; 6]);

const NAMES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 6])
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set_double(name, f64::from(value))
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match NAMES.iter().position(|known| *known == name) {
            Some(place) => {
                self.0[place] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

fn ply(path: &Path, bytes: &[u8]) -> Result<PointCloud, DataError> {
    let parser = Parser::<Vertex>::new();
    let mut reader = Reader::new(bytes);
    let failed =
        |e: &dyn std::fmt::Display| DataError::content(path, None, format!("this is no PLY file: {e}"));
    let header = parser.read_header(&mut reader).map_err(|e| failed(&e))?;
    let has_normals = check(&header).map_err(|message| DataError::content(path, None, message))?;
    let mut cloud = PointCloud::default();
    for (name, element) in &header.elements {
        let points =
            parser.read_payload_for_element(&mut reader, element, &header).map_err(|e| failed(&e))?;
        if name.as_str() == "vertex" {
            for Vertex([x, y, z, u, v, w]) in points {
                cloud.points.push([x, y, z]);
                if has_normals {
                    cloud.normals.push([u, v, w]);
                }
            }
            break;
        }
    }
    Ok(cloud)
}

/// Whether the points have normals, and whether they are points, not too many, nor too much before them.
fn check(header: &Header) -> Result<bool, String> {
    let Some(vertex) = header.elements.get("vertex") else {
        return Err("there is no element `vertex`".to_owned());
    };
    let has = |name: &&str| vertex.properties.contains_key(*name);
    let (places, normals) = NAMES.split_at(3);
    let has_normals = normals.iter().any(has);
    let needed = if has_normals { &NAMES } else { places };
    if let Some(name) = needed.iter().find(|name| !has(name)) {
        let what = if has_normals { "normals (nx, ny, nz)" } else { "coordinates (x, y, z)" };
        return Err(format!("the points have no `{name}`: {what} are needed"));
    }
    let most = header.elements.values().map(|element| element.count as u64).max().unwrap_or(0);
    if vertex.count as u64 > MAX_POINTS as u64 || most > 100 * MAX_POINTS as u64 {
        return Err(format!("there are {} points, and at most {MAX_POINTS} are read", vertex.count));
    }
    Ok(has_normals)
}

/// Lines of six numbers, or of three without normals.
fn table(path: &Path, bytes: &[u8]) -> Result<PointCloud, DataError> {
    let first = bytes.split(|&b| b == b'\n').find(|line| !line.is_empty()).unwrap_or_default();
    let delimiter = [b',', b';', b'\t'].into_iter().find(|d| first.contains(d)).unwrap_or(b' ');
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let mut cloud = PointCloud::default();
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|e| DataError::content(path, None, e.to_string()))?;
        let line = record.position().map(|p| p.line() as usize);
        let cells = record.iter().filter(|cell| delimiter != b' ' || !cell.is_empty());
        let numbers: Option<Vec<f64>> = cells.map(|cell| cell.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x, y, z, u, v, w]) if cloud.normals.len() == cloud.points.len() => {
                cloud.points.push([x, y, z]);
                cloud.normals.push([u, v, w]);
            }
            Some(&[x, y, z]) if cloud.normals.is_empty() => cloud.points.push([x, y, z]),
            // The line of names.
            None if number == 0 => {}
            Some(other) => {
                return Err(DataError::content(path, line, columns(&cloud, other.len())));
            }
            None => {
                let message = "here is something else than a number".to_owned();
                return Err(DataError::content(path, line, message));
            }
        }
        if cloud.points.len() > MAX_POINTS {
            return Err(DataError::content(path, line, format!("more than {MAX_POINTS} points")));
        }
    }
    Ok(cloud)
}

/// What is wrong with a line of `found` numbers.
fn columns(cloud: &PointCloud, found: usize) -> String {
    let most = match (cloud.points.len(), cloud.normals.len()) {
        (0, _) => "six numbers (x, y, z and the normal), or three",
        (_, 0) => "three numbers (x, y, z), as those above",
        _ => "six numbers (x, y, z and the normal), as those above",
    };
    format!("a line has {most}, not {found}")
}
