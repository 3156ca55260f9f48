//! Hypertexture: solids whose borders are a medium, stirred by noise.
//!
//! K. Perlin and E. M. Hoffert, "Hypertexture" (SIGGRAPH 1989): an object density D from 0 (outside) to 1 (inside), soft in
//! between, is modulated by noise, bias and gain. Here D = ½ − (f + a N) / s, kept between 0 and 1, with f a field (f < 0
//! inside), N the noise, a its amplitude and s the width of the soft region. Without a field f is 0: a block of noise.

use super::medium::{Look, Medium, Sample, add_medium};
use super::{Noise, Paint, Place, SourceError, placed};
use crate::Builder;
use fieldstone_field::{Bindings, F64, Field, Intervals, LANES, Points, Tape, TapeOptions, Workspace};
use glam::DVec3;
use serde::Deserialize;

/// How a hypertexture becomes cells.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HypertextureOptions {
    /// Extinction where D is 1, over the length of the volume's edge, ≥ 0.
    pub density: f64,
    /// The width of the soft region, s, in values of the field, > 0.
    pub softness: f64,
    /// By how much the noise moves the field's values, a, ≥ 0.
    pub amplitude: f64,
    /// The noise, in coordinates of the field.
    pub noise: Noise,
    /// Perlin's bias: what D = ½ becomes, above 0 and below 1.
    pub bias: f64,
    /// Perlin's gain: above ½ steepens the middle of the soft region, below flattens it; above 0 and below 1.
    pub gain: f64,
    /// What it is painted with.
    pub paint: Paint,
    /// Over how many cells a change of the density counts as a surface, ≥ 0.
    pub surface: f64,
    /// How far the flakes spread around the normals of such surfaces, 0 to 1.
    pub roughness: f64,
    /// The part of the volume that the box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

impl Default for HypertextureOptions {
    fn default() -> Self {
        Self {
            density: 50.0,
            softness: 0.5,
            amplitude: 0.5,
            noise: Noise::default(),
            bias: 0.5,
            gain: 0.5,
            paint: Paint::default(),
            surface: 2.0,
            roughness: 0.3,
            within: None,
        }
    }
}

impl HypertextureOptions {
    fn check(&self) -> Result<(), SourceError> {
        let inner = |x: f64| 0.0 < x && x < 1.0;
        let noise = &self.noise;
        let (zero_on, above) = ("a number from 0 on", "a number above 0");
        SourceError::check("density", self.density, self.density >= 0.0, zero_on)?;
        SourceError::check("softness", self.softness, self.softness > 0.0, above)?;
        SourceError::check("amplitude", self.amplitude, self.amplitude >= 0.0, zero_on)?;
        SourceError::check("bias", self.bias, inner(self.bias), "a number between 0 and 1")?;
        SourceError::check("gain", self.gain, inner(self.gain), "a number between 0 and 1")?;
        SourceError::check("noise.frequency", noise.frequency, noise.frequency > 0.0, above)?;
        let octaves = f64::from(noise.octaves);
        SourceError::check(
            "noise.octaves",
            octaves,
            (1.0..=16.0).contains(&octaves),
            "a number from 1 to 16",
        )?;
        SourceError::check("noise.lacunarity", noise.lacunarity, noise.lacunarity > 1.0, "a number above 1")?;
        SourceError::check(
            "noise.gain",
            noise.gain,
            (0.0..=1.0).contains(&noise.gain),
            "a number from 0 to 1",
        )
    }

    /// The density at a value of the field and of the noise.
    fn density(&self, value: f64, noise: f64) -> f64 {
        let soft = 0.5 - (value + self.amplitude * noise) / self.softness;
        if soft.is_nan() {
            0.0
        } else {
            self.density * gain(self.gain, bias(self.bias, soft.clamp(0.0, 1.0)))
        }
    }
}

/// Perlin's bias: a power of t that makes ½ to b.
fn bias(b: f64, t: f64) -> f64 {
    t.powf(b.ln() / 0.5f64.ln())
}

/// Perlin's gain: an S of two biases that keeps 0, ½ and 1.
fn gain(g: f64, t: f64) -> f64 {
    if t < 0.5 { 0.5 * bias(1.0 - g, 2.0 * t) } else { 1.0 - 0.5 * bias(1.0 - g, 2.0 - 2.0 * t) }
}

/// Adds a hypertexture in the box from `low` to `high`, in coordinates of the field; without a field all of the box is filled
/// with noise. Octaves finer than the samples are left out.
///
/// # Errors
/// Options out of their ranges, boxes that are none, and more filled cells than [`MAX_CELLS`](super::MAX_CELLS).
pub fn add_hypertexture(
    builder: &mut Builder,
    field: Option<(&Field, &Bindings)>,
    [low, high]: [[f64; 3]; 2],
    options: &HypertextureOptions,
) -> Result<Place, SourceError> {
    options.check()?;
    let place = placed(builder, [Some([low, high]), options.within], || [low, high])?;
    let cells = place.scale() * f64::from(builder.edge());
    let look = Look::new(2, options.surface, options.roughness)?;
    // Two samples to a cell cannot hold more than one wave, or two lattice points.
    let noise = options.noise.limited(2.0 * cells);
    let tape = field.map(|(field, bindings)| {
        Tape::new(field, &TapeOptions { bindings: bindings.clone(), ..TapeOptions::default() })
    });
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let medium = Stirred { tape, place, low, high, options: HypertextureOptions { noise, ..*options } };
    add_medium(builder, &medium, &look)?;
    Ok(place)
}

struct Stirred {
    tape: Option<Tape>,
    place: Place,
    low: DVec3,
    high: DVec3,
    options: HypertextureOptions,
}

#[derive(Default)]
struct Engines {
    points: Workspace<F64, Points>,
    intervals: Workspace<F64, Intervals>,
}

impl Medium for Stirred {
    type Memory = Engines;

    fn samples(&self, engines: &mut Engines, points: &[DVec3], samples: &mut Vec<Sample>) {
        for points in points.chunks(LANES) {
            let points: Vec<DVec3> = points.iter().map(|p| self.place.model_from_cube(*p)).collect();
            if let Some(tape) = &self.tape {
                for axis in 0..3 {
                    for (lane, point) in points.iter().enumerate() {
                        engines.points.input(axis, 0)[lane] = point[axis];
                    }
                }
                engines.points.run(tape, points.len());
            }
            for (lane, point) in points.iter().enumerate() {
                let value = if self.tape.is_some() { engines.points.output(0, 0)[lane] } else { 0.0 };
                let is_inside = point.cmpge(self.low).all() && point.cmple(self.high).all();
                // Where the noise cannot matter it is not asked.
                let reach = self.options.amplitude + 0.5 * self.options.softness;
                let density = if !is_inside || value >= reach {
                    0.0
                } else {
                    let noise = if value < -reach { 0.0 } else { self.options.noise.at(*point) };
                    self.options.density(value, noise)
                };
                samples.push(Sample { density, paint: self.options.paint });
            }
        }
    }

    fn may_fill(&self, engines: &mut Engines, low: DVec3, width: f64) -> bool {
        let Some(tape) = &self.tape else { return true };
        let corners = [low, low + width].map(|corner| self.place.model_from_cube(corner));
        for axis in 0..3 {
            for (end, corner) in corners.iter().enumerate() {
                engines.intervals.input(axis, end)[0] = corner[axis];
            }
        }
        engines.intervals.run(tape, 1);
        let least = engines.intervals.output(0, 0)[0];
        least.is_nan() || least < self.options.amplitude + 0.5 * self.options.softness
    }
}

#[cfg(test)]
mod tests;
