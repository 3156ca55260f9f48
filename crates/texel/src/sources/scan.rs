//! Scans: numbers on a grid, as tomographs make them, and what they are to look like.

use super::files::{content, read_file, read_limited};
use super::medium::{Look, Medium, Sample, add_medium};
use super::{Paint, Place, SourceError, placed};
use crate::Builder;
use flate2::read::MultiGzDecoder;
use glam::DVec3;
use nifti::{InMemNiftiVolume, NiftiHeader, NiftiType};
use serde::Deserialize;
use std::path::Path;

/// A scan has at most so many numbers: 512³.
pub const MAX_NUMBERS: usize = 1 << 27;

/// Numbers on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    counts: [usize; 3],
    steps: [f64; 3],
    values: Vec<f32>,
}

/// Why numbers are no scan.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// Fewer than two along an axis, too many in all, or not as many as there are values.
    #[error("{} × {} × {} numbers are no grid of {values}: two along each axis at least, {MAX_NUMBERS} in all at most",
        counts[0], counts[1], counts[2])]
    Counts {
        /// Along x, y and z.
        counts: [usize; 3],
        /// How many values there are.
        values: usize,
    },
    /// A distance is not above 0.
    #[error("the distances {0:?} between numbers are not all above 0")]
    Steps([f64; 3]),
}

impl Scan {
    /// `counts` numbers along x, y and z, at distances of `steps`; those along x stand next to one another.
    ///
    /// # Errors
    /// Counts and distances that make no grid.
    pub fn new(counts: [usize; 3], steps: [f64; 3], values: Vec<f32>) -> Result<Self, ScanError> {
        let count = counts.iter().try_fold(1usize, |product, n| product.checked_mul(*n));
        if count != Some(values.len()) || values.len() > MAX_NUMBERS || counts.iter().any(|n| *n < 2) {
            return Err(ScanError::Counts { counts, values: values.len() });
        }
        if !steps.iter().all(|step| step.is_finite() && *step > 0.0) {
            return Err(ScanError::Steps(steps));
        }
        Ok(Self { counts, steps, values })
    }

    /// The smallest and the greatest number; none if all are NaN.
    pub fn range(&self) -> Option<[f32; 2]> {
        let numbers = self.values.iter().copied().filter(|value| !value.is_nan());
        numbers.fold(None, |range, x| {
            Some(range.map_or([x; 2], |[low, high]: [f32; 2]| [low.min(x), high.max(x)]))
        })
    }

    /// The box of the outermost numbers; the first is at the origin.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        [[0.0; 3], [0, 1, 2].map(|axis| self.steps[axis] * (self.counts[axis] - 1) as f64)]
    }

    /// The number at a point, linear in between; none outside of the box.
    pub fn at(&self, p: [f64; 3]) -> Option<f64> {
        let (mut first, mut share) = ([0; 3], [0.0; 3]);
        for axis in 0..3 {
            let place = p[axis] / self.steps[axis];
            let last = self.counts[axis] - 1;
            if !(-1e-9..=last as f64 + 1e-9).contains(&place) {
                return None;
            }
            first[axis] = (place.max(0.0) as usize).min(last - 1);
            share[axis] = (place - first[axis] as f64).clamp(0.0, 1.0);
        }
        let mut sum = 0.0;
        for corner in 0..8 {
            let bit = |axis: usize| corner >> axis & 1;
            let weight: f64 =
                (0..3).map(|axis| if bit(axis) == 1 { share[axis] } else { 1.0 - share[axis] }).product();
            let [x, y, z] = [0, 1, 2].map(|axis| first[axis] + bit(axis));
            if weight > 0.0 {
                sum += weight * f64::from(self.values[x + self.counts[0] * (y + self.counts[1] * z)]);
            }
        }
        Some(sum)
    }
}

/// What a number of a scan looks like.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Knot {
    /// The number.
    pub value: f64,
    /// Extinction over the length of the volume's edge, ≥ 0.
    pub density: f64,
    /// The share of light that is scattered, linear, 0 to 1.
    #[serde(default = "grey")]
    pub albedo: [f32; 3],
    /// The share of scattered light that is mirrored, 0 to 1.
    #[serde(default)]
    pub gloss: f32,
}

fn grey() -> [f32; 3] {
    Paint::default().albedo
}

/// How a scan becomes cells.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanOptions {
    /// The transfer function: what numbers look like, by rising numbers; in between all is linear, beyond the ends constant.
    /// If there is none: from nothing at the smallest number to a density of 100 at the greatest.
    pub transfer: Vec<Knot>,
    /// Over how many cells a change of the density counts as a surface, ≥ 0.
    pub surface: f64,
    /// How far the flakes spread around the normals of such surfaces, 0 to 1.
    pub roughness: f64,
    /// The box that fills the volume, two corners; the first number is at the origin. By default the whole scan.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The part of the volume that this box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

impl Default for ScanOptions {
    /// Surfaces over four cells, slightly rough.
    fn default() -> Self {
        Self { transfer: Vec::new(), surface: 4.0, roughness: 0.2, bounds: None, within: None }
    }
}

/// Adds a scan. Numbers that are NaN are empty.
///
/// # Errors
/// Options out of their ranges, and more filled cells than [`MAX_CELLS`](super::MAX_CELLS).
pub fn add_scan(builder: &mut Builder, scan: &Scan, options: &ScanOptions) -> Result<Place, SourceError> {
    let transfer = transfer(scan, options)?;
    let place = placed(builder, [options.bounds, options.within], || scan.bounds())?;
    let cell = (place.scale() * f64::from(builder.edge())).recip();
    let step = scan.steps.iter().copied().fold(f64::INFINITY, f64::min);
    let look = Look::new((cell / step).ceil() as usize, options.surface, options.roughness)?;
    add_medium(builder, &ScanMedium { scan, place, transfer }, &look)?;
    Ok(place)
}

/// The knots of the transfer function, checked.
fn transfer(scan: &Scan, options: &ScanOptions) -> Result<Vec<Knot>, SourceError> {
    for knot in &options.transfer {
        SourceError::check("value", knot.value, true, "a number")?;
        SourceError::check("density", knot.density, knot.density >= 0.0, "a number from 0 on")?;
    }
    if let Some(pair) = options.transfer.windows(2).find(|pair| pair[0].value >= pair[1].value) {
        return Err(SourceError::Option {
            name: "value",
            value: pair[1].value,
            allowed: "greater than the one before it in the transfer function",
        });
    }
    if !options.transfer.is_empty() {
        return Ok(options.transfer.clone());
    }
    let [low, high] = scan.range().unwrap_or([0.0, 1.0]);
    let knot = |value: f32, density| Knot { value: f64::from(value), density, albedo: grey(), gloss: 0.0 };
    Ok(vec![knot(low, 0.0), knot(high, 100.0)])
}

struct ScanMedium<'s> {
    scan: &'s Scan,
    place: Place,
    transfer: Vec<Knot>,
}

impl ScanMedium<'_> {
    fn sample(&self, value: f64) -> Sample {
        let after = self.transfer.partition_point(|knot| knot.value <= value);
        let knot = |i: usize| self.transfer.get(i);
        let (a, b, share) = match (after.checked_sub(1).and_then(knot), knot(after)) {
            (Some(a), Some(b)) => (a, b, (value - a.value) / (b.value - a.value)),
            (Some(end), None) | (None, Some(end)) => (end, end, 0.0),
            (None, None) => return Sample::default(),
        };
        let mean = |a: f32, b: f32| a + share as f32 * (b - a);
        Sample {
            density: a.density + share * (b.density - a.density),
            paint: Paint {
                albedo: [0, 1, 2].map(|k| mean(a.albedo[k], b.albedo[k])),
                gloss: mean(a.gloss, b.gloss),
            },
        }
    }
}

impl Medium for ScanMedium<'_> {
    type Memory = ();

    fn samples(&self, (): &mut (), points: &[DVec3], samples: &mut Vec<Sample>) {
        samples.extend(points.iter().map(|point| {
            let value = self.scan.at(self.place.model_from_cube(*point).to_array());
            value.filter(|value| !value.is_nan()).map_or(Sample::default(), |value| self.sample(value))
        }));
    }

    fn may_fill(&self, (): &mut (), low: DVec3, width: f64) -> bool {
        let [from, to] = self.scan.bounds().map(DVec3::from_array);
        let (low, high) = (self.place.model_from_cube(low), self.place.model_from_cube(low + width));
        low.cmple(to).all() && high.cmpge(from).all()
    }
}

/// Reads a NIfTI-1 file of three dimensions, or the first volume of one of more: `.nii`, packed by gzip or not. Numbers are
/// scaled as the header says; the distances are its own, its rotation is left out.
///
/// # Errors
/// Files that cannot be read, are too large, or hold something else.
pub fn read_nifti(path: &Path) -> Result<Scan, SourceError> {
    let mut bytes = read_file(path)?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        bytes = read_limited(path, MultiGzDecoder::new(bytes.as_slice()))?;
    }
    let failed =
        |error: &dyn std::fmt::Display| content(path, None, format!("this is no NIfTI file: {error}"));
    let mut header = NiftiHeader::from_reader(bytes.as_slice()).map_err(|e| failed(&e))?;
    let dim = header.dim().map_err(|e| failed(&e))?.to_vec();
    let [x, y, z, ..] = *dim.as_slice() else {
        return Err(content(path, None, format!("it has {} dimensions, and three are needed", dim.len())));
    };
    let counts = [x, y, z].map(usize::from);
    let size = header.data_type().map_err(|e| failed(&e))?.size_of();
    let length = counts.iter().product::<usize>() * size;
    let start = header.vox_offset.max(0.0) as usize;
    let Some(numbers) = start.checked_add(length).and_then(|end| bytes.get(start..end)) else {
        let message =
            format!("{x} × {y} × {z} numbers of {size} bytes are announced, and the file is shorter");
        return Err(content(path, None, message));
    };
    // The first volume alone.
    header.dim = [3, x, y, z, 1, 1, 1, 1];
    let volume = InMemNiftiVolume::from_raw_data(&header, numbers.to_vec()).map_err(|e| failed(&e))?;
    let mut values = nifti_values(volume, &header).map_err(|e| failed(&e))?;
    let (slope, start) = (header.scl_slope, header.scl_inter);
    if slope != 0.0 {
        values.iter_mut().for_each(|value| *value = *value * slope + start);
    }
    let steps = [1, 2, 3].map(|i| f64::from(header.pixdim[i].abs()));
    Scan::new(counts, steps, values).map_err(|error| content(path, None, error.to_string()))
}

/// The numbers of a volume as they are written.
fn nifti_values(volume: InMemNiftiVolume, header: &NiftiHeader) -> nifti::Result<Vec<f32>> {
    fn all<T: nifti::DataElement>(
        volume: InMemNiftiVolume,
        number: impl Fn(T) -> f32,
    ) -> nifti::Result<Vec<f32>> {
        Ok(volume.into_nifti_typed_data::<T>()?.into_iter().map(number).collect())
    }
    let kind = header.data_type()?;
    match kind {
        NiftiType::Uint8 => all(volume, |x: u8| f32::from(x)),
        NiftiType::Int8 => all(volume, |x: i8| f32::from(x)),
        NiftiType::Uint16 => all(volume, |x: u16| f32::from(x)),
        NiftiType::Int16 => all(volume, |x: i16| f32::from(x)),
        NiftiType::Uint32 => all(volume, |x: u32| x as f32),
        NiftiType::Int32 => all(volume, |x: i32| x as f32),
        NiftiType::Uint64 => all(volume, |x: u64| x as f32),
        NiftiType::Int64 => all(volume, |x: i64| x as f32),
        NiftiType::Float32 => all(volume, |x: f32| x),
        NiftiType::Float64 => all(volume, |x: f64| x as f32),
        _ => Err(nifti::NiftiError::UnsupportedDataType(kind)),
    }
}

#[cfg(test)]
mod tests;
