//! Draws a bush in one volume, 444² pixels, and says how long it took: `cargo run --release -p fieldstone-texel
//! --example bush -- OUT.ppm [EDGE] [LEVEL]`. Without a level, it is that of the pixels' footprint.
#![allow(clippy::print_stdout, reason = "an example is a program")]

use fieldstone_texel::{Builder, Footprint, Lamp, Mode, Model, Ray, Sggx, Texel, Volume};
use glam::DVec3;
use rayon::prelude::*;
use std::error::Error;
use std::time::Instant;

const PIXELS: usize = 444;

/// Numbers from 0 to 1 by SplitMix64.
struct Chance(u64);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    }
}

/// The cells of an opaque ball whose flakes are those of its surface, or face all ways.
fn paint(builder: &mut Builder, centre: DVec3, radius: f64, albedo: [f32; 3], roughness: f64) {
    let edge = f64::from(builder.edge());
    let low = ((centre - radius) * edge).floor().max(DVec3::ZERO).as_uvec3();
    let high = ((centre + radius) * edge).ceil().min(DVec3::splat(edge)).as_uvec3();
    for z in low.z..high.z {
        for y in low.y..high.y {
            for x in low.x..high.x {
                let way = (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5) / edge - centre;
                let covered = (0.5 + (radius - way.length()) * edge).clamp(0.0, 1.0);
                let flakes = Sggx::surface(way.normalize_or(DVec3::Z), roughness);
                let texel = Texel::even((3.0 * covered * edge) as f32, flakes, 1.0 / edge);
                if covered > 0.0 {
                    builder.insert([x, y, z], &texel.coloured(albedo, 0.2));
                }
            }
        }
    }
}

fn bush(edge: u32) -> Result<Volume, Box<dyn Error>> {
    let mut builder = Builder::new(edge)?;
    let mut chance = Chance(7);
    for _ in 0..2000 {
        let height = chance.unit();
        let middle = DVec3::new(0.5, 0.5, 0.25 + 0.4 * height);
        let place = middle + chance.direction() * 0.3 * (1.0 - 0.5 * height) * chance.unit().sqrt();
        let green = 0.25 + 0.5 * chance.unit() as f32;
        paint(&mut builder, place, 0.008 + 0.012 * chance.unit(), [0.5 * green, green, 0.08], 0.4);
    }
    for i in 0..60 {
        paint(&mut builder, DVec3::new(0.5, 0.5, f64::from(i) / 100.0), 0.03, [0.3, 0.2, 0.1], 0.3);
    }
    for x in 0..edge {
        for y in 0..edge {
            let floor = Texel::even(20.0 * edge as f32, Sggx::surface(DVec3::Z, 0.5), 1.0 / f64::from(edge));
            builder.insert([x, y, 0], &floor.coloured([0.6, 0.55, 0.5], 0.0));
        }
    }
    Ok(builder.build(Mode::Sggx)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().ok_or("the name of a picture is missing")?;
    let edge = arguments.get(1).map_or(Ok(128), |edge| edge.parse())?;
    let level: Option<f32> = arguments.get(2).map(|level| level.parse()).transpose()?;
    let begin = Instant::now();
    let volume = bush(edge)?;
    println!("built in {:.2?}, {} cells at the finest level", begin.elapsed(), volume.stored(0));
    let lamps = [
        Lamp::Directional { to_lamp: DVec3::new(0.5, -0.6, 0.8).normalize(), irradiance: DVec3::splat(5.0) },
        Lamp::Directional { to_lamp: DVec3::new(-0.7, -0.3, 0.4).normalize(), irradiance: DVec3::splat(0.8) },
    ];
    let eye = DVec3::new(0.5, -1.6, 1.1);
    let forward = (DVec3::new(0.5, 0.5, 0.36) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
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
            let lit = volume.single_scattering(&ray, (0.0, f64::INFINITY), at, (&lamps, Model::Microflakes));
            let colour = lit.radiance + lit.transmittance * DVec3::new(0.35, 0.45, 0.6);
            colour.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8)
        })
        .collect();
    println!("drawn in {:.2?}", begin.elapsed());
    let mut file = format!("P6\n{PIXELS} {PIXELS}\n255\n").into_bytes();
    file.extend(colours.as_flattened());
    std::fs::write(path, file)?;
    Ok(())
}
