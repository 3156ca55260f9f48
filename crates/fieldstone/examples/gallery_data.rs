//! Writes the data of the gallery: an array of voxels and two tables of scattered points.
//!
//! ```text
//! cargo run --release -p fieldstone --example gallery_data
//! ```

use std::f64::consts::{PI, TAU};
use std::fs;
use std::io;
use std::path::Path;

/// How many voxels there are along each axis.
const VOXELS: usize = 20;

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/scenes/data");
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("gyroid.nrrd"), nrrd(gyroid))?;
    for count in [60, 160] {
        fs::write(folder.join(format!("points-{count}.csv")), points(count))?;
    }
    Ok(())
}

/// A coarse array of bytes: 0 to 255 for densities from −1 to 1 over −1 to 1 in space, x next to one another.
fn nrrd(density: impl Fn([f64; 3]) -> f64) -> Vec<u8> {
    let header = format!(
        "NRRD0004\n# Samples of a gyroid in a ball.\ntype: uint8\ndimension: 3\nsizes: {VOXELS} {VOXELS} {VOXELS}\n\
         encoding: raw\n\n"
    );
    let place = |i: usize| 2.0 * i as f64 / (VOXELS - 1) as f64 - 1.0;
    let mut bytes = header.into_bytes();
    for k in 0..VOXELS {
        for j in 0..VOXELS {
            for i in 0..VOXELS {
                let value = density([place(i), place(j), place(k)]);
                bytes.push((127.5 + 127.5 * value.clamp(-1.0, 1.0)).round() as u8);
            }
        }
    }
    bytes
}

/// A gyroid of a period and a half within a ball, above 0 inside.
fn gyroid([x, y, z]: [f64; 3]) -> f64 {
    let [a, b, c] = [x, y, z].map(|x| 1.5 * PI * x);
    let gyroid = a.sin() * b.cos() + b.sin() * c.cos() + c.sin() * a.cos() + 0.35;
    let ball = 4.0 * (0.9 - (x * x + y * y + z * z).sqrt());
    gyroid.min(ball)
}

/// Points with normals on a body with bumps, along a spiral from pole to pole.
fn points(count: usize) -> String {
    let mut table = String::from("x,y,z,nx,ny,nz\n");
    for i in 0..count {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let turn = TAU * (i as f64 * 0.618_033_988_749_895).fract();
        let across = (1.0 - z * z).sqrt();
        let direction = [across * turn.cos(), across * turn.sin(), z];
        let point = direction.map(|d| d * radius(direction));
        let cells = [point, normal(point)].concat();
        let cells: Vec<String> = cells.iter().map(|number| format!("{number:.4}")).collect();
        table += &(cells.join(",") + "\n");
    }
    table
}

/// How far the body reaches in a direction.
fn radius([x, y, z]: [f64; 3]) -> f64 {
    1.0 + 0.35 * (x * x * x * x + y * y * y * y + z * z * z * z - 0.6) + 0.3 * x * y * z
}

/// The unit normal of |p| − radius(p / |p|) by differences.
fn normal(point: [f64; 3]) -> [f64; 3] {
    let value = |p: [f64; 3]| {
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        length - radius(p.map(|x| x / length))
    };
    let slope = |axis: usize| {
        let [mut ahead, mut behind] = [point; 2];
        ahead[axis] += 1e-5;
        behind[axis] -= 1e-5;
        value(ahead) - value(behind)
    };
    let gradient = [0, 1, 2].map(slope);
    let length = gradient.iter().map(|x| x * x).sum::<f64>().sqrt();
    gradient.map(|x| x / length)
}
