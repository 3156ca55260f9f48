//! Where volumes come from: fields, meshes, strands, scans, noise, particles.
//!
//! Each source is one function that adds cells to a [`Builder`], with one structure of options. Several
//! may fill one volume; what they put in the same cell is added. The result depends neither on the number of threads nor on
//! the machine.
//!
//! What a source gathers in a cell is
//! - the **amount**: the projected area of its surfaces in the mean over all directions. That is half the area of
//!   a sheet, which is seen from both sides, a quarter of the area of a body's surface (Cauchy 1841), π/4 of length × width
//!   of a thread and π r² of a ball. Divided by the volume of the cell it is the density.
//! - the **flakes**: the mean by amount of the normals' matrices.
//! - the **depths**: by how much of the cell's face is covered, seen along each axis, whatever covers it; what
//!   lies at places unknown is taken to be independent of the rest.
//!
//! [`Place`] says how the coordinates of a source become those of the volume.

mod cell;
mod field;
mod files;
mod hypertexture;
mod mask;
mod medium;
mod mesh;
mod noise;
mod particles;
mod rods;
mod scan;
mod slice;
mod strands;

pub use field::{BakeOptions, Inside, Painter, bake};
pub use files::MAX_FILE_BYTES;
pub use hypertexture::{HypertextureOptions, add_hypertexture};
pub use mesh::{Body, Mesh, MeshOptions, add_mesh, read_mesh};
pub use noise::{Noise, gradient_noise};
pub use particles::{Particle, ParticleOptions, add_particles, read_particles};
pub use scan::{Knot, MAX_NUMBERS, Scan, ScanError, ScanOptions, add_scan, read_nifti};
pub use strands::{Strand, StrandOptions, add_strands, read_strands};

use crate::Builder;
use glam::DVec3;
use serde::Deserialize;
use std::io;
use std::path::PathBuf;

/// A source adds no more cells than these to a volume: 2²⁵, which take 0.8 GB.
pub const MAX_CELLS: usize = 1 << 25;

/// Why a source makes nothing.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The file cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
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
    /// A box is no box.
    #[error("the box from {low:?} to {high:?} is empty or not finite")]
    Bounds {
        /// The lower corner.
        low: [f64; 3],
        /// The upper corner.
        high: [f64; 3],
    },
    /// An option is out of its range.
    #[error("`{name}` is {allowed}, not {value}")]
    Option {
        /// The option.
        name: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// There is more than memory should be spent on.
    #[error("{what} would take more than {most} entries: choose a smaller edge, or less of it")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The greatest number.
        most: usize,
    },
}

impl SourceError {
    /// Refuses an option out of its range, and what is no number.
    fn check(name: &'static str, value: f64, good: bool, allowed: &'static str) -> Result<(), Self> {
        if good && value.is_finite() { Ok(()) } else { Err(Self::Option { name, value, allowed }) }
    }
}

/// What light does at a surface, apart from the directions.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Paint {
    /// The share of light that is scattered, red, green, blue, linear, 0 to 1.
    pub albedo: [f32; 3],
    /// The share of scattered light that is mirrored, 0 to 1.
    pub gloss: f32,
}

impl Default for Paint {
    /// Light grey, matt.
    fn default() -> Self {
        Self { albedo: [0.8; 3], gloss: 0.0 }
    }
}

/// How coordinates of a source become those of the volume, which is the unit cube: one scale, no rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The point of the source that becomes the volume's corner 0, 0, 0.
    corner: DVec3,
    /// Lengths in the volume over those in the source.
    scale: f64,
}

impl Place {
    /// Coordinates are those of the volume.
    pub const UNIT: Self = Self { corner: DVec3::ZERO, scale: 1.0 };

    /// The box from `low` to `high` in the middle of the volume, as large as it can be with `margin` left at either
    /// end of its longest side (0 to 0.4, in units of the volume's edge).
    ///
    /// # Errors
    /// Boxes that are not finite or have no side longer than 0; margins out of their range.
    pub fn fit(low: [f64; 3], high: [f64; 3], margin: f64) -> Result<Self, SourceError> {
        SourceError::check("margin", margin, (0.0..=0.4).contains(&margin), "a number from 0 to 0.4")?;
        let (from, to) = (DVec3::from_array(low), DVec3::from_array(high));
        let size = to - from;
        let longest = size.max_element();
        if !(size.is_finite() && size.min_element() >= 0.0 && longest > 0.0) {
            return Err(SourceError::Bounds { low, high });
        }
        let scale = (1.0 - 2.0 * margin) / longest;
        Ok(Self { corner: 0.5 * (from + to) - DVec3::splat(0.5 / scale), scale })
    }

    /// The box from `low` to `high` in the middle of a box of the volume, as large as it can be.
    ///
    /// # Errors
    /// Boxes that are not finite, or have no side longer than 0; a box of the volume with a side that is not longer than 0.
    pub fn inside(low: [f64; 3], high: [f64; 3], room: [[f64; 3]; 2]) -> Result<Self, SourceError> {
        let (from, to) = (DVec3::from_array(low), DVec3::from_array(high));
        let [room_from, room_to] = room.map(DVec3::from_array);
        let (size, room_size) = (to - from, room_to - room_from);
        if !(size.is_finite() && size.min_element() >= 0.0 && size.max_element() > 0.0) {
            return Err(SourceError::Bounds { low, high });
        }
        if !(room_size.is_finite() && room_size.min_element() > 0.0) {
            return Err(SourceError::Bounds { low: room[0], high: room[1] });
        }
        // A side of length 0 fits with any scale.
        let scale = (room_size / size).min_element();
        Ok(Self { corner: 0.5 * (from + to) - 0.5 * (room_from + room_to) / scale, scale })
    }

    /// A point of the source in the volume.
    pub fn cube_from_model(&self, p: DVec3) -> DVec3 {
        (p - self.corner) * self.scale
    }

    /// A point of the volume in the source.
    pub fn model_from_cube(&self, p: DVec3) -> DVec3 {
        self.corner + p / self.scale
    }

    /// Lengths in the volume over those in the source.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}

/// The place of a source whose box is given, or found, in a part of the volume that is given, or all.
fn placed(
    builder: &Builder,
    [bounds, within]: [Option<[[f64; 3]; 2]>; 2],
    hull: impl FnOnce() -> [[f64; 3]; 2],
) -> Result<Place, SourceError> {
    let [low, high] = bounds.unwrap_or_else(hull);
    if let Some(room) = within {
        return Place::inside(low, high, room);
    }
    Place::fit(low, high, f64::from(builder.edge()).recip().min(0.25))
}

/// The box around balls; empty if there is none.
fn hull(balls: impl Iterator<Item = ([f64; 3], f64)>) -> [[f64; 3]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (centre, radius) in balls {
        for axis in 0..3 {
            low[axis] = low[axis].min(centre[axis] - radius);
            high[axis] = high[axis].max(centre[axis] + radius);
        }
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_from_toml() {
        let bake: BakeOptions = toml::from_str("roughness = 0.3\ninside = \"full\"").unwrap();
        assert_eq!(bake, BakeOptions { roughness: 0.3, inside: Inside::Full, ..BakeOptions::default() });
        let mesh: MeshOptions = toml::from_str("body = \"sheets\"\npaint = { albedo = [1, 0, 0] }").unwrap();
        assert_eq!((mesh.body, mesh.paint.albedo), (Body::Sheets, [1.0, 0.0, 0.0]));
        let strands: StrandOptions = toml::from_str("bounds = [[0, 0, 0], [1, 1, 1]]").unwrap();
        assert_eq!(strands.bounds, Some([[0.0; 3], [1.0; 3]]));
        let scan: ScanOptions = toml::from_str("transfer = [{ value = 1, density = 2 }]").unwrap();
        assert_eq!(scan.transfer.len(), 1);
        let smoke: HypertextureOptions = toml::from_str("noise = { octaves = 2, seed = 7 }").unwrap();
        assert_eq!((smoke.noise.octaves, smoke.noise.seed), (2, 7));
        let balls: ParticleOptions = toml::from_str("radius = 2").unwrap();
        assert_eq!(balls.radius, 2.0);
    }

    #[test]
    fn keys_that_are_not_known_are_refused() {
        for text in ["rough = 1", "paint = { colour = 1 }", "noise = { size = 1 }"] {
            assert!(toml::from_str::<HypertextureOptions>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn boxes_fit_with_their_longest_side() {
        let place = Place::fit([-1.0, 0.0, 0.0], [3.0, 1.0, 2.0], 0.1).unwrap();
        let (low, high) = (
            place.cube_from_model(DVec3::new(-1.0, 0.0, 0.0)),
            place.cube_from_model(DVec3::new(3.0, 1.0, 2.0)),
        );
        assert!(
            (low - DVec3::new(0.1, 0.4, 0.3)).length() < 1e-12
                && (high - DVec3::new(0.9, 0.6, 0.7)).length() < 1e-12
        );
        assert!((place.model_from_cube(high) - DVec3::new(3.0, 1.0, 2.0)).length() < 1e-12);
        let room = [[0.0, 0.0, 0.5], [1.0, 1.0, 1.0]];
        let flat = Place::inside([-1.0, 0.0, 3.0], [3.0, 1.0, 3.0], room).unwrap();
        assert_eq!(flat.cube_from_model(DVec3::new(-1.0, 0.5, 3.0)).to_array(), [0.0, 0.5, 0.75]);
        let tall = Place::inside([0.0; 3], [1.0, 1.0, 2.0], room).unwrap();
        assert_eq!(tall.cube_from_model(DVec3::new(0.0, 0.0, 2.0)).to_array(), [0.375, 0.375, 1.0]);
        assert!(Place::inside([0.0; 3], [1.0; 3], [[0.0; 3], [1.0, 0.0, 1.0]]).is_err());
        assert!(Place::fit([0.0; 3], [0.0; 3], 0.0).is_err());
        assert!(Place::fit([0.0; 3], [1.0; 3], 0.5).is_err());
    }
}
