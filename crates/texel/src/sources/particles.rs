//! Particles: balls with colours, and their files.

use super::files::{content, read_file, read_ply, rows};
use super::rods::{Finishes, Rod, add_rods};
use super::{Paint, Place, SourceError, hull, placed};
use crate::Builder;
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;

/// A file may hold so many particles, or points of strands.
pub(super) const MAX_POINTS: usize = 20_000_000;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Its centre.
    pub centre: [f64; 3],
    /// Its radius, ≥ 0, if it has one of its own.
    pub radius: Option<f64>,
    /// Its colour, linear, 0 to 1, if it has one of its own.
    pub albedo: Option<[f32; 3]>,
}

/// How particles become cells.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParticleOptions {
    /// The radius of particles without one, > 0, in their units.
    pub radius: f64,
    /// How far the flakes spread around the normals of balls that are larger than a cell, 0 to 1.
    pub roughness: f64,
    /// What particles without a colour of their own are painted with; the gloss is that of all.
    pub paint: Paint,
    /// The box that fills the volume, two corners; by default the one around all particles.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The part of the volume that this box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

impl Default for ParticleOptions {
    /// Radius 0.01, light grey.
    fn default() -> Self {
        Self { radius: 0.01, roughness: 0.0, paint: Paint::default(), bounds: None, within: None }
    }
}

/// Adds particles. What lies in the same place is one body if it is larger than a cell, and independent otherwise.
///
/// # Errors
/// Options out of their ranges, places that are no numbers, and more than memory should be spent on.
pub fn add_particles(
    builder: &mut Builder,
    particles: &[Particle],
    options: &ParticleOptions,
) -> Result<Place, SourceError> {
    let finishes = Finishes::new(options.roughness)?;
    SourceError::check("radius", options.radius, options.radius > 0.0, "a number above 0")?;
    let radius = |particle: &Particle| particle.radius.unwrap_or(options.radius);
    for particle in particles {
        SourceError::check("radius", radius(particle), radius(particle) >= 0.0, "a number from 0 on")?;
    }
    let balls = particles.iter().map(|particle| (particle.centre, radius(particle)));
    let place = placed(builder, [options.bounds, options.within], || hull(balls))?;
    let rods: Vec<Rod> = particles
        .iter()
        .map(|particle| Rod {
            ends: [place.cube_from_model(DVec3::from_array(particle.centre)); 2],
            radii: [radius(particle) * place.scale(); 2],
            paint: Paint { albedo: particle.albedo.unwrap_or(options.paint.albedo), ..options.paint },
        })
        .collect();
    add_rods(builder, &rods, &finishes)?;
    Ok(place)
}

/// Reads particles: PLY with `x y z` and perhaps `radius` and `red green blue` (0 to 255, sRGB) from `.ply`; from any other
/// file a table whose lines are `x, y, z`, `x, y, z, radius` or `x, y, z, radius, red, green, blue` (linear, 0 to 1).
///
/// # Errors
/// Files that cannot be read, hold too much, or something else.
pub fn read_particles(path: &Path) -> Result<Vec<Particle>, SourceError> {
    let bytes = read_file(path)?;
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply")) {
        return particles_of_ply(path, &bytes);
    }
    let mut particles = Vec::new();
    for (line, numbers) in rows(path, &bytes)? {
        particles.push(match *numbers.as_slice() {
            [] => continue,
            [x, y, z] => Particle { centre: [x, y, z], radius: None, albedo: None },
            [x, y, z, r] => Particle { centre: [x, y, z], radius: Some(r), albedo: None },
            [x, y, z, r, red, green, blue] => Particle {
                centre: [x, y, z],
                radius: Some(r),
                albedo: Some([red, green, blue].map(|share| share as f32)),
            },
            ref other => {
                let message =
                    format!("a line has 3, 4 or 7 numbers (x, y, z, radius, colour), not {}", other.len());
                return Err(content(path, Some(line), message));
            }
        });
    }
    if particles.len() > MAX_POINTS {
        return Err(content(path, None, format!("more than {MAX_POINTS} particles")));
    }
    Ok(particles)
}

fn particles_of_ply(path: &Path, bytes: &[u8]) -> Result<Vec<Particle>, SourceError> {
    let ply = read_ply(path, bytes, MAX_POINTS)?;
    let particles = ply.vertices.iter().map(|row| Particle {
        centre: [row.numbers[0], row.numbers[1], row.numbers[2]],
        radius: ply.has_radius.then_some(row.numbers[3]),
        albedo: ply.colour(row),
    });
    Ok(particles.collect())
}

#[cfg(test)]
mod tests;
