//! Volumes: what is put in is found, coarser levels say what is below them, files give back what was written.

mod build;
mod compare;
mod files;
mod filter;

use fieldstone_texel::{Builder, Mode, Sggx, Texel, Volume};
use glam::DVec3;

/// Numbers by chance, the same on all machines (PCG-XSH-RR, O'Neill 2014).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (((old >> 18 ^ old) >> 27) as u32).rotate_right((old >> 59) as u32)
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.next()) / 4_294_967_296.0
    }

    fn below(&mut self, end: u32) -> u32 {
        self.next() % end
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
    }

    fn texel(&mut self, width: f64) -> Texel {
        let flakes = Sggx::surface(self.direction(), self.unit());
        let albedo = std::array::from_fn(|_| self.unit() as f32);
        Texel::even((4.0 / width * self.unit()) as f32, flakes, width).coloured(albedo, self.unit() as f32)
    }
}

/// A volume with about `filled` cells at random places, and those cells.
fn scattered(edge: u32, filled: u32, mode: Mode) -> (Volume, Vec<([u32; 3], Texel)>) {
    let mut chance = Chance(u64::from(edge) << 32 | u64::from(filled));
    let mut cells = std::collections::BTreeMap::new();
    for _ in 0..filled {
        let cell = std::array::from_fn(|_| chance.below(edge));
        cells.insert(cell, chance.texel(1.0 / f64::from(edge)));
    }
    let cells: Vec<_> = cells.into_iter().collect();
    let mut builder = Builder::new(edge).expect("a power of two");
    builder.extend(cells.clone());
    (builder.build(mode).expect("few cells"), cells)
}
