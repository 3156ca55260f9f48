//! A slab of different flakes, and the mean light that it scatters once, as JSON: what `benches/mitsuba_slab.py` compares with
//! another renderer.
#![allow(clippy::print_stdout, reason = "an example is a program")]

use fieldstone_texel::{Builder, Lamp, Mode, Model, Ray, Sggx, Texel, Volume};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::error::Error;

/// Cells along an edge; the lower half is filled.
const EDGE: u32 = 16;

/// Rays along an edge of the square that is looked at, and half of its width.
const RAYS: u32 = 256;
const HALF_WIDTH: f64 = 0.25;

/// Flakes of mirrors whose axes are those of the cube, so that σ(w) is the extinction to the last bit of the depths.
fn slab() -> Result<Volume, Box<dyn Error>> {
    let mut builder = Builder::new(EDGE)?;
    let mut state = 1u64;
    let mut chance = || {
        // Knuth's linear congruential generator MMIX.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for place in 0..EDGE.pow(3) / 2 {
        let cell = [place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE];
        let areas = DVec3::new(0.2 + chance(), 0.2 + chance(), 0.2 + chance());
        let density = (12.0 * chance() * chance()) as f32;
        let flakes = Sggx::from_matrix(DMat3::from_diagonal(areas * areas));
        builder.insert(cell, &Texel::even(density, flakes, 1.0 / f64::from(EDGE)).coloured([0.8; 3], 1.0));
    }
    Ok(builder.build(Mode::Sggx)?)
}

/// The mean radiance of the square around the slab's middle that is seen from `view`.
fn mean_radiance(volume: &Volume, view: DVec3, light: DVec3) -> f64 {
    let (u, v) = view.any_orthonormal_pair();
    let lamps = [Lamp::Directional { to_lamp: light, irradiance: DVec3::ONE }];
    let along = |i: u32| HALF_WIDTH * (2.0 * (f64::from(i) + 0.5) / f64::from(RAYS) - 1.0);
    let sum: f64 = (0..RAYS * RAYS)
        .into_par_iter()
        .map(|i| {
            let place = DVec3::new(0.5, 0.5, 0.25) + u * along(i % RAYS) + v * along(i / RAYS);
            let ray = Ray { origin: place + 2.0 * view, direction: -view };
            let span = (0.0, f64::INFINITY);
            volume.single_scattering(&ray, span, |_| 0.0, (&lamps, Model::Microflakes)).radiance.x
        })
        .sum();
    sum / f64::from(RAYS * RAYS)
}

fn main() -> Result<(), Box<dyn Error>> {
    let volume = slab()?;
    let cells = (0..EDGE.pow(3)).map(|place| {
        let texel = volume.texel(0, [place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE]);
        let Texel { density, flakes: s, .. } = texel.unwrap_or_default();
        format!("[{density}, {}, {}, {}]", s.xx, s.yy, s.zz)
    });
    let cells: Vec<String> = cells.collect();
    let directions = [
        (DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.3, 0.2, 0.9)),
        (DVec3::new(0.5, -0.2, 0.8), DVec3::new(0.1, 0.6, 0.7)),
        (DVec3::new(-0.7, 0.1, 0.5), DVec3::new(0.8, 0.1, 0.4)),
        (DVec3::new(0.2, 0.3, 0.9), DVec3::new(0.1, -0.3, -0.9)),
    ];
    let list = |d: DVec3| format!("[{}, {}, {}]", d.x, d.y, d.z);
    let views = directions.map(|(view, light)| {
        let (view, light) = (view.normalize(), light.normalize());
        let mean = mean_radiance(&volume, view, light);
        format!("{{\"view\": {}, \"light\": {}, \"radiance\": {mean}}}", list(view), list(light))
    });
    println!("{{\"edge\": {EDGE}, \"half_width\": {HALF_WIDTH}, \"albedo\": 0.8,");
    println!("\"cells\": [{}],\n\"views\": [{}]}}", cells.join(", "), views.join(",\n"));
    Ok(())
}
