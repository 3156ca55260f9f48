//! The second pass: more samples for pixels that need them.
//!
//! Pixels differ from a neighbour, where an edge runs, or have visible noise. Each gets a few samples first, then twice
//! as many, until its error cannot be seen or it has all that it may have. Where a surface sends back rare, very dark or
//! bright light, the few samples of one pixel may see nothing of it; of pixels with noise, therefore, the mean variance
//! of those of the same part in a block is asked too.

use crate::integrator::{EyeRay, Integrator, Worker};
use crate::lamps::choice;
use crate::noise::{AT_FIRST, Tally};
use crate::sampling::{Draw, disc};
use crate::tile::{BLOCK, Placed, colour};
use fieldstone_scene::{Film, Pixel, Scene};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// About how many samples are taken before they are summed up.
const SAMPLES_TOGETHER: usize = 4096;

/// Why a pixel needs more samples.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Need {
    /// It does not.
    None,
    /// Chance may have changed it visibly, or a neighbour: where a shadow begins, some pixels see nothing of it.
    Noise,
    /// It differs from one of its eight neighbours.
    Edge,
}

/// What pixels need, row by row.
pub(crate) fn needs(film: &Film, noisy: &[bool]) -> Vec<Need> {
    let (width, height) = (film.width(), film.height());
    let mut needs = vec![Need::None; noisy.len()];
    needs.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
        for (need, x) in row.iter_mut().zip(0..width) {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let Some(here) = film.pixel(x, y) else { continue };
            let around = || (above..=below).flat_map(|v| (left..=right).map(move |u| (u, v)));
            let differs = |(u, v)| film.pixel(u, v).is_some_and(|there| differ(&here, &there));
            let is_noisy = |(u, v): (u32, u32)| noisy[v as usize * width as usize + u as usize];
            if around().any(differs) {
                *need = Need::Edge;
            } else if around().any(is_noisy) {
                *need = Need::Noise;
            }
        }
    });
    needs
}

/// The contrast of an edge inside of a volume, whose cells are filtered: a pixel is nearer to its mean with one sample.
const VOLUME_CONTRAST: f64 = 0.3;

/// Whether an edge runs between two neighbours: of a solid, a part, a crease, or light, mirrored and refracted light too.
fn differ(a: &Pixel, b: &Pixel) -> bool {
    if a.part != b.part {
        return true;
    }
    if a.part < 0.0 && a.alpha == 0.0 && b.alpha == 0.0 {
        return false;
    }
    // There is no normal where an environment, a lamp or a volume is seen.
    let has_normal = [a, b].iter().any(|pixel| pixel.normal != [0.0; 3]);
    let normals: f32 = a.normal.iter().zip(b.normal).map(|(p, q)| p * q).sum();
    let crease = a.part >= 0.0 && has_normal && normals < 0.9;
    let cover = (a.alpha - b.alpha).abs() > 0.15;
    let contrast = if a.part >= 0.0 && !has_normal { VOLUME_CONTRAST } else { 0.15 };
    let (a, b) = (colour(a), colour(b));
    let brightest = a.max(b) + glam::DVec3::splat(0.02);
    crease || cover || ((a - b).abs() / brightest).max_element() > contrast
}

/// Takes more samples of pixels.
pub(crate) struct Refiner<'r, 's, 'p> {
    pub(crate) scene: &'s Scene,
    pub(crate) integrator: &'r Integrator<'s, 'p>,
    /// The picture. Pixels of later bands are as seen through their centres.
    pub(crate) film: &'r Film,
    /// What its pixels need, row by row.
    pub(crate) needs: &'r [Need],
}

/// A pixel on its way to all the samples it needs.
struct Refined {
    place: (u32, u32),
    centre: Pixel,
    need: Need,
    tally: Tally,
    is_noisy: bool,
}

impl Refiner<'_, '_, '_> {
    /// The pixels among these that need more samples, with them.
    pub(crate) fn refine(
        &self,
        worker: &mut Worker,
        pixels: impl Iterator<Item = (u32, u32)>,
    ) -> Vec<Placed> {
        let mut pixels: Vec<Refined> = pixels.filter_map(|place| self.start(place)).collect();
        let all = self.scene.settings().samples;
        let (mut from, mut to) = (self.known_samples(), AT_FIRST.min(all));
        while from < to && !pixels.is_empty() {
            let mut noisy: Vec<&mut Refined> = pixels.iter_mut().filter(|p| p.is_noisy).collect();
            let some = (SAMPLES_TOGETHER / (to - from) as usize).max(1);
            noisy.chunks_mut(some).for_each(|some| self.sample(worker, some, from..to));
            self.judge(&mut pixels);
            (from, to) = (to, to.saturating_mul(2).min(all));
        }
        pixels.iter().map(Refined::placed).collect()
    }

    /// How many samples of a pixel are known: the one through its centre, unless there is a lens, when that one went
    /// through the middle of it.
    fn known_samples(&self) -> u32 {
        u32::from(self.scene.camera().aperture().is_none())
    }

    fn start(&self, place: (u32, u32)) -> Option<Refined> {
        let need = self.needs[place.1 as usize * self.film.width() as usize + place.0 as usize];
        let centre = self.film.pixel(place.0, place.1).filter(|_| need != Need::None)?;
        let mut tally = Tally::default();
        if self.known_samples() > 0 {
            tally.add(colour(&centre), f64::from(centre.alpha));
        }
        Some(Refined { place, centre, need, tally, is_noisy: true })
    }

    /// Adds samples to each pixel.
    fn sample(&self, worker: &mut Worker, pixels: &mut [&mut Refined], samples: Range<u32>) {
        let ray = |(x, y): (u32, u32), index: u32| {
            let (u, v) = place_in_pixel(index as usize);
            let place = (f64::from(x) + u, f64::from(y) + v);
            let draw = Draw::new((x, y), index);
            let lens = disc(draw.point(choice::LENS));
            let (origin, direction) = self.scene.lens_ray(place, lens);
            EyeRay { origin, direction, draw }
        };
        let rays = pixels.iter().flat_map(|p| samples.clone().map(move |index| ray(p.place, index)));
        let found = self.integrator.radiance(worker, &rays.collect::<Vec<EyeRay>>());
        for (pixel, samples) in pixels.iter_mut().zip(found.chunks(samples.len().max(1))) {
            samples.iter().for_each(|sample| pixel.tally.add(sample.colour, sample.alpha));
        }
    }

    /// Finds out which pixels still have visible noise.
    fn judge(&self, pixels: &mut [Refined]) {
        let tone = &self.scene.settings().tone;
        let mut pools: HashMap<_, (f64, f64)> = HashMap::new();
        for pixel in pixels.iter().filter(|p| p.need == Need::Noise) {
            let (sum, count) = pools.entry(pixel.pool()).or_default();
            *sum += pixel.tally.variance();
            *count += 1.0;
        }
        for pixel in pixels.iter_mut().filter(|p| p.is_noisy) {
            let pool = pools.get(&pixel.pool()).filter(|_| pixel.need == Need::Noise);
            pixel.is_noisy = pixel.tally.is_noisy(tone, pool.map_or(0.0, |(sum, count)| sum / count));
        }
    }
}

impl Refined {
    /// Which pixels have noise of the same kind: those of a part in a block.
    fn pool(&self) -> (u32, u32, u32) {
        (self.place.0 / BLOCK, self.place.1 / BLOCK, self.centre.part.to_bits())
    }

    fn placed(&self) -> Placed {
        let (colour, alpha) = self.tally.mean();
        let pixel = Pixel { colour: colour.as_vec3().to_array(), alpha: alpha as f32, ..self.centre };
        Placed { x: self.place.0, y: self.place.1, pixel, is_noisy: self.is_noisy }
    }
}

/// The place of sample `i` in a pixel: the first in its centre, the others evenly around it (Roberts 2018).
fn place_in_pixel(i: usize) -> (f64, f64) {
    // 1/ρ and 1/ρ² for the root ρ of x³ = x + 1.
    const STEPS: (f64, f64) = (0.754_877_666_246_692_8, 0.569_840_290_998_053_2);
    ((0.5 + STEPS.0 * i as f64).fract(), (0.5 + STEPS.1 * i as f64).fract())
}
