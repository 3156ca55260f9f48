//! Draws a `.texel` file on a floor, 444² pixels, and says how long it took: `cargo run --release -p fieldstone-texel
//! --example look -- IN.texel OUT.ppm [LEVEL] [TURN] [RISE]`. Without a level, or with `-`, it is that of the pixels'
//! footprint; TURN and RISE are where the eye is, in degrees.
#![allow(clippy::print_stdout, reason = "an example is a program")]

use fieldstone_texel::{Footprint, Lamp, Model, Ray, Volume};
use glam::DVec3;
use rayon::prelude::*;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const PIXELS: usize = 444;
const FLOOR: DVec3 = DVec3::new(0.55, 0.52, 0.48);
const SKY: DVec3 = DVec3::new(0.45, 0.58, 0.75);

/// What is behind the volume: a floor with its shadow, and sky.
fn behind(volume: &Volume, ray: &Ray, lamps: &[Lamp], level: f32) -> DVec3 {
    let t = -ray.origin.z / ray.direction.z;
    let place = ray.at(t);
    if !(t > 0.0 && t.is_finite()) || (place - 0.5).length() > 6.0 {
        return SKY;
    }
    let lit = |lamp: &Lamp| match lamp {
        Lamp::Directional { to_lamp, irradiance } => {
            let shadow = Ray { origin: place, direction: *to_lamp };
            let depth = volume.depth_along(&shadow, (1e-6, f64::INFINITY), |_| level);
            *irradiance * to_lamp.z.max(0.0) * (-depth).exp()
        }
        Lamp::Point { .. } => DVec3::ZERO,
    };
    FLOOR * lamps.iter().map(lit).sum::<DVec3>() / std::f64::consts::PI
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [source, target, rest @ ..] = arguments.as_slice() else { return Err("IN.texel OUT.ppm".into()) };
    let number = |index: usize| rest.get(index).and_then(|text| text.parse::<f64>().ok());
    let level = number(0).map(|level| level as f32);
    let (turn, rise) = (number(1).unwrap_or(-60.0).to_radians(), number(2).unwrap_or(22.0).to_radians());
    let volume = Volume::read(Path::new(source))?;
    let to_sun = DVec3::new(0.75, -0.45, 0.9).normalize();
    let lamps = [
        Lamp::Directional { to_lamp: to_sun, irradiance: DVec3::splat(4.0) },
        Lamp::Directional { to_lamp: DVec3::new(-0.7, -0.5, 0.5).normalize(), irradiance: DVec3::splat(0.7) },
        Lamp::Directional { to_lamp: DVec3::new(0.1, 0.1, 1.0).normalize(), irradiance: DVec3::splat(0.5) },
    ];
    let way = DVec3::new(turn.cos() * rise.cos(), turn.sin() * rise.cos(), rise.sin());
    let centre = DVec3::new(0.5, 0.5, 0.42);
    let eye = centre + 2.3 * way;
    let (forward, right) = (-way, (-way).cross(DVec3::Z).normalize());
    let up = right.cross(forward);
    let pixel = 0.62 / PIXELS as f64;
    let begin = Instant::now();
    let colours: Vec<[u8; 3]> = (0..PIXELS * PIXELS)
        .into_par_iter()
        .map(|i| {
            let along = |i: usize| (i as f64 + 0.5 - 0.5 * PIXELS as f64) * pixel;
            let direction = forward + right * along(i % PIXELS) - up * along(i / PIXELS);
            let ray = Ray { origin: eye, direction };
            let footprint = Footprint { width: 0.0, spread: pixel };
            let at = |t: f64| level.unwrap_or_else(|| footprint.level(&volume, t));
            let end = if direction.z < 0.0 { -eye.z / direction.z } else { f64::INFINITY };
            let lit = volume.single_scattering(&ray, (0.0, end), at, (&lamps, Model::Microflakes));
            let colour = lit.radiance + lit.transmittance * behind(&volume, &ray, &lamps, at(2.0));
            colour.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8)
        })
        .collect();
    println!("drawn in {:.2?}", begin.elapsed());
    let mut file = format!("P6\n{PIXELS} {PIXELS}\n255\n").into_bytes();
    file.extend(colours.as_flattened());
    std::fs::write(target, file)?;
    Ok(())
}
