//! Values and gradients at the centres of pixels.

use super::{Block, Raster};
use fieldstone_field::{F64, Gradients, Intervals, LANES, Tape, Workspace};
use rayon::prelude::*;

/// The field at the centre of a pixel; NaN where it is undefined, or was not asked for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Sample {
    pub(super) value: f32,
    /// |∇f| per pixel.
    pub(super) slope: f32,
    /// f/|∇f|: the distance from the boundary in pixels to first order, negative inside; infinite where f is level.
    pub(super) distance: f32,
}

impl Sample {
    const NONE: Self = Self { value: f32::NAN, slope: f32::NAN, distance: f32::NAN };

    fn new(value: f64, slope: f64) -> Self {
        let distance = match value {
            0.0 => 0.0,
            _ if slope > 0.0 => value / slope,
            _ => f64::INFINITY.copysign(value),
        };
        let distance = if value.is_nan() { f64::NAN } else { distance };
        // A value too small for 32 bits still has its sign.
        let tiny = f64::from(f32::MIN_POSITIVE);
        let value = if value != 0.0 && value.abs() < tiny { tiny.copysign(value) } else { value };
        Self { value: value as f32, slope: slope as f32, distance: distance as f32 }
    }
}

/// The samples of the pixels that are wanted, row by row, and how many there are.
pub(super) fn sample(
    tape: &Tape,
    raster: &Raster,
    wanted: impl Fn(usize) -> bool + Sync,
) -> (Vec<Sample>, u64) {
    let tiles = raster.tiles();
    let places_in = |tile: Block| tile.pixels().filter(|(x, y)| wanted(y * raster.width + x));
    let of_tiles: Vec<Vec<Sample>> = tiles
        .par_iter()
        .map_init(Workspaces::default, |spaces, tile| {
            let places: Vec<_> = places_in(*tile).collect();
            if places.is_empty() { Vec::new() } else { sample_tile(tape, raster, spaces, (*tile, &places)) }
        })
        .collect();
    let mut samples = vec![Sample::NONE; raster.width * raster.height];
    let mut count = 0;
    for (tile, of_tile) in tiles.iter().zip(of_tiles) {
        count += of_tile.len() as u64;
        for ((x, y), sample) in places_in(*tile).zip(of_tile) {
            samples[y * raster.width + x] = sample;
        }
    }
    (samples, count)
}

/// Whether the field has another sign at a neighbour of a pixel than at the pixel.
pub(super) fn sign_changes(raster: &Raster, samples: &[Sample], at: usize) -> bool {
    let (x, y, here) = (at % raster.width, at / raster.width, samples[at].value);
    let around = |at: usize, length: usize| at.saturating_sub(1)..(at + 2).min(length);
    !here.is_nan()
        && around(y, raster.height)
            .flat_map(|y| around(x, raster.width).map(move |x| (x, y)))
            .map(|(x, y)| samples[y * raster.width + x].value)
            .any(|there| !there.is_nan() && (there < 0.0) != (here < 0.0))
}

struct Workspaces {
    boxes: Workspace<F64, Intervals>,
    points: Workspace<F64, Gradients>,
}

impl Default for Workspaces {
    fn default() -> Self {
        Self { boxes: Workspace::new(), points: Workspace::new() }
    }
}

fn sample_tile(
    tape: &Tape,
    raster: &Raster,
    spaces: &mut Workspaces,
    (tile, places): (Block, &[(usize, usize)]),
) -> Vec<Sample> {
    let shortened = shortened(tape, raster, &mut spaces.boxes, tile);
    let tape = shortened.as_ref().unwrap_or(tape);
    let (points, pixel) = (&mut spaces.points, raster.pixel());
    let mut samples = Vec::with_capacity(places.len());
    for some in places.chunks(LANES) {
        for (lane, (x, y)) in some.iter().enumerate() {
            let u = [raster.across(*x as f64 + 0.5), pixel, 0.0, 0.0];
            let v = [raster.upwards(*y as f64 + 0.5), 0.0, pixel, 0.0];
            for (input, components) in [u, v].into_iter().enumerate() {
                for (component, number) in components.into_iter().enumerate() {
                    points.input(input, component)[lane] = number;
                }
            }
        }
        points.run(tape, some.len());
        for lane in 0..some.len() {
            let [value, du, dv] = [0, 1, 2].map(|component| points.output(0, component)[lane]);
            samples.push(Sample::new(value, du.hypot(dv)));
        }
    }
    samples
}

/// The tape without what cannot matter in a tile.
fn shortened(
    tape: &Tape,
    raster: &Raster,
    boxes: &mut Workspace<F64, Intervals>,
    tile: Block,
) -> Option<Tape> {
    let across = tile.x.map(|x| raster.across(x as f64));
    let upwards = tile.y.map(|y| raster.upwards(y as f64));
    for (input, [low, high]) in [across, [upwards[1], upwards[0]]].into_iter().enumerate() {
        boxes.input(input, 0)[0] = low;
        boxes.input(input, 1)[0] = high;
    }
    boxes.run_traced(tape, 1);
    tape.shortened(|place| boxes.choice(place, 0))
}
