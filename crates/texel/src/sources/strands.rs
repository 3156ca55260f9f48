//! Strands: hair, grass, threads; and their files.

use super::files::{content, read_file, rows};
use super::particles::MAX_POINTS;
use super::rods::{Finishes, Rod, add_rods};
use super::{Paint, Place, SourceError, hull, placed};
use crate::Builder;
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;

/// A line of points, each with a radius.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strand {
    /// The points, from the root to the tip.
    pub points: Vec<[f64; 3]>,
    /// As many radii, ≥ 0; or one for all points; or none.
    pub radii: Vec<f64>,
    /// As many colours, linear, 0 to 1; or one for all points; or none.
    pub albedo: Vec<[f32; 3]>,
}

/// How strands become cells.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StrandOptions {
    /// The radius of strands without one, > 0, in their units.
    pub radius: f64,
    /// How far the flakes spread along the strands, 0 to 1.
    pub roughness: f64,
    /// What strands without a colour of their own are painted with; the gloss is that of all.
    pub paint: Paint,
    /// The box that fills the volume, two corners; by default the one around all strands.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The part of the volume that this box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

impl Default for StrandOptions {
    /// Radius 0.001, brown.
    fn default() -> Self {
        let paint = Paint { albedo: [0.3, 0.15, 0.07], gloss: 0.5 };
        Self { radius: 0.001, roughness: 0.1, paint, bounds: None, within: None }
    }
}

/// Adds strands. Where they are thinner than a cell, their ends are not counted as surfaces.
///
/// # Errors
/// Options out of their ranges, places that are no numbers, and more than memory should be spent on.
pub fn add_strands(
    builder: &mut Builder,
    strands: &[Strand],
    options: &StrandOptions,
) -> Result<Place, SourceError> {
    let finishes = Finishes::new(options.roughness)?;
    SourceError::check("radius", options.radius, options.radius > 0.0, "a number above 0")?;
    for radius in strands.iter().flat_map(|strand| &strand.radii) {
        SourceError::check("radius", *radius, *radius >= 0.0, "a number from 0 on")?;
    }
    let radius = |strand: &Strand, i: usize| at(&strand.radii, i).unwrap_or(options.radius);
    let balls = strands
        .iter()
        .flat_map(|strand| strand.points.iter().enumerate().map(move |(i, p)| (*p, radius(strand, i))));
    let place = placed(builder, [options.bounds, options.within], || hull(balls))?;
    let rods: Vec<Rod> = strands
        .iter()
        .flat_map(|strand| (1..strand.points.len()).map(move |i| (strand, [i - 1, i])))
        .map(|(strand, ends)| Rod {
            ends: ends.map(|i| place.cube_from_model(DVec3::from_array(strand.points[i]))),
            radii: ends.map(|i| radius(strand, i) * place.scale()),
            paint: Paint {
                albedo: at(&strand.albedo, ends[0]).unwrap_or(options.paint.albedo),
                ..options.paint
            },
        })
        .filter(|rod| rod.ends[0] != rod.ends[1])
        .collect();
    add_rods(builder, &rods, &finishes)?;
    Ok(place)
}

/// The entry of a point, where there is one for each, or one for all.
fn at<T: Copy>(list: &[T], i: usize) -> Option<T> {
    list.get(i).or(list.last()).copied()
}

/// Reads strands: `.hair` files (C. Yuksel; their thickness is the diameter) or a text whose lines are `x y z` or
/// `x y z radius`; an empty line ends a strand, and what follows `#` is left out.
///
/// # Errors
/// Files that cannot be read, hold too much, or something else.
pub fn read_strands(path: &Path) -> Result<Vec<Strand>, SourceError> {
    let bytes = read_file(path)?;
    if bytes.starts_with(b"HAIR") {
        return hair(path, &bytes);
    }
    let mut strands = vec![Strand::default()];
    let mut count = 0;
    for (line, numbers) in rows(path, &bytes)? {
        let Some(strand) = strands.last_mut() else { break };
        match *numbers.as_slice() {
            [] if strand.points.is_empty() => continue,
            [] => strands.push(Strand::default()),
            [x, y, z] if strand.radii.is_empty() => strand.points.push([x, y, z]),
            [x, y, z, radius] if strand.radii.len() == strand.points.len() => {
                strand.points.push([x, y, z]);
                strand.radii.push(radius);
            }
            [_, _, _] | [_, _, _, _] => {
                let message = "either all points of a strand have a radius or none has";
                return Err(content(path, Some(line), message));
            }
            ref other => {
                let message = format!("a line has 3 or 4 numbers (x, y, z, radius), not {}", other.len());
                return Err(content(path, Some(line), message));
            }
        }
        count += 1;
        if count > MAX_POINTS {
            return Err(content(path, Some(line), format!("more than {MAX_POINTS} points")));
        }
    }
    strands.retain(|strand| !strand.points.is_empty());
    Ok(strands)
}

/// Takes numbers from the front of a `.hair` file.
struct Bytes<'b> {
    path: &'b Path,
    rest: &'b [u8],
}

impl<'b> Bytes<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8], SourceError> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(|| {
            content(self.path, None, "this .hair file ends before all its points: it was cut off, or is none")
        })?;
        self.rest = rest;
        Ok(taken)
    }

    fn words(&mut self, count: usize) -> Result<impl Iterator<Item = u32> + 'b, SourceError> {
        let bytes = self.take(count.saturating_mul(4))?;
        Ok(bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])))
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f32>, SourceError> {
        let numbers: Vec<f32> = self.words(count)?.map(f32::from_bits).collect();
        if numbers.iter().all(|x| x.is_finite()) {
            Ok(numbers)
        } else {
            Err(content(self.path, None, "a number in this .hair file is not finite"))
        }
    }
}

/// The bits of the header's field of arrays.
const SEGMENTS: u32 = 1;
const POINTS: u32 = 2;
const THICKNESS: u32 = 4;
const TRANSPARENCY: u32 = 8;
const COLOURS: u32 = 16;

/// A `.hair` file: 128 bytes of header, then arrays of segments, points, thickness, transparency and colours.
/// Transparency is left out.
fn hair(path: &Path, bytes: &[u8]) -> Result<Vec<Strand>, SourceError> {
    let mut bytes = Bytes { path, rest: bytes };
    bytes.take(4)?;
    let header: Vec<u32> = bytes.words(4)?.collect();
    let [strand_count, point_count, arrays, segments] = [0, 1, 2, 3].map(|i| header[i]);
    let defaults = bytes.numbers(5)?;
    bytes.take(88)?;
    let (strand_count, point_count) = (strand_count as usize, point_count as usize);
    if arrays & POINTS == 0 || strand_count > point_count.max(1) {
        return Err(content(path, None, "this .hair file has no points"));
    }
    if arrays > (COLOURS << 1) - 1 {
        return Err(content(path, None, "this .hair file has arrays that are not known"));
    }
    if point_count > MAX_POINTS {
        return Err(content(
            path,
            None,
            format!("it has {point_count} points, and at most {MAX_POINTS} are read"),
        ));
    }
    let segments: Vec<usize> = if arrays & SEGMENTS != 0 {
        let bytes = bytes.take(2 * strand_count)?;
        bytes.chunks_exact(2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))).collect()
    } else {
        vec![segments as usize; strand_count]
    };
    if segments.iter().try_fold(0usize, |sum, n| sum.checked_add(n + 1)) != Some(point_count) {
        return Err(content(path, None, "the segments of this .hair file do not add up to its points"));
    }
    let points = bytes.numbers(3 * point_count)?;
    let or = |array: u32, count: usize| if arrays & array != 0 { count } else { 0 };
    let thickness = bytes.numbers(or(THICKNESS, point_count))?;
    bytes.take(4 * or(TRANSPARENCY, point_count))?;
    let colours = bytes.numbers(or(COLOURS, 3 * point_count))?;
    let (mut strands, mut start) = (Vec::with_capacity(strand_count), 0);
    for count in segments.iter().map(|n| n + 1) {
        let all = start..start + count;
        start += count;
        let three = |list: &[f32], i: usize| [0, 1, 2].map(|k| list[3 * i + k]);
        let radius = |thickness: f32| 0.5 * f64::from(thickness.max(0.0));
        let mut strand = Strand {
            points: all.clone().map(|i| three(&points, i).map(f64::from)).collect(),
            radii: vec![radius(defaults[0])],
            albedo: vec![three(&defaults[2..], 0)],
        };
        if !thickness.is_empty() {
            strand.radii = thickness[all.clone()].iter().map(|t| radius(*t)).collect();
        }
        if !colours.is_empty() {
            strand.albedo = all.map(|i| three(&colours, i)).collect();
        }
        strands.push(strand);
    }
    Ok(strands)
}

#[cfg(test)]
mod tests;
