//! Writes the data of the gallery: arrays of voxels, tables of scattered points, a mesh, strands and particles.
//!
//! ```text
//! cargo run --release -p fieldstone --example gallery_data
//! ```

use flate2::Compression;
use flate2::write::GzEncoder;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::io::{self, Write};
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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/scenes/texels/data");
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("head.nrrd"), head()?)?;
    fs::write(folder.join("crystal.obj"), crystal())?;
    fs::write(folder.join("coil.txt"), coil())?;
    fs::write(folder.join("swarm.csv"), swarm())
}

/// Voxels of the head along each axis.
const HEAD: usize = 40;

/// The seven largest ellipsoids of the head of Shepp and Logan (1974) in space, with the contrasts of P. Toft (1996): value,
/// radii, middle, degrees about z.
const ELLIPSOIDS: [[f64; 8]; 7] = [
    [1.0, 0.69, 0.92, 0.81, 0.0, 0.0, 0.0, 0.0],
    [-0.8, 0.6624, 0.874, 0.78, 0.0, -0.0184, 0.0, 0.0],
    [-0.2, 0.11, 0.31, 0.22, 0.22, 0.0, 0.0, -18.0],
    [-0.2, 0.16, 0.41, 0.28, -0.22, 0.0, 0.0, 18.0],
    [0.1, 0.21, 0.25, 0.41, 0.0, 0.35, -0.15, 0.0],
    [0.1, 0.046, 0.046, 0.05, 0.0, 0.1, 0.25, 0.0],
    [0.1, 0.046, 0.046, 0.05, 0.0, -0.1, 0.25, 0.0],
];

/// The head, in means of 4 × 4 × 4 places of a voxel.
fn head() -> io::Result<Vec<u8>> {
    let part = |i: usize| (i as f64 + 0.5) / (2.0 * HEAD as f64) - 1.0;
    let mut voxels = Vec::with_capacity(HEAD.pow(3));
    for i in 0..HEAD.pow(3) {
        let corner = [i % HEAD, i / HEAD % HEAD, i / HEAD / HEAD].map(|c| 4 * c);
        let parts = (0..64).map(|k| [0, 1, 2].map(|axis| part(corner[axis] + (k >> (2 * axis) & 3))));
        let mean = parts.map(tissue).sum::<f64>() / 64.0;
        voxels.push((255.0 * mean.clamp(0.0, 1.0)).round() as u8);
    }
    let mut bytes = format!(
        "NRRD0004\n# Seven ellipsoids of the head of Shepp and Logan.\ntype: uint8\ndimension: 3\n\
         sizes: {HEAD} {HEAD} {HEAD}\nencoding: gzip\n\n"
    )
    .into_bytes();
    let mut packer = GzEncoder::new(&mut bytes, Compression::best());
    packer.write_all(&voxels)?;
    packer.finish()?;
    Ok(bytes)
}

/// What the head is at a point.
fn tissue([x, y, z]: [f64; 3]) -> f64 {
    let value = |[value, a, b, c, x0, y0, z0, degrees]: [f64; 8]| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (u, v) = (x - x0, y - y0);
        let [u, v, w] = [(cos * u + sin * v) / a, (cos * v - sin * u) / b, (z - z0) / c];
        if u * u + v * v + w * w <= 1.0 { value } else { 0.0 }
    };
    ELLIPSOIDS.into_iter().map(value).sum()
}

/// A prism of six sides with a point at either end.
fn crystal() -> String {
    let mut text = String::from("# A crystal.\nv 0 0 -1.6\nv 0 0 1.6\n");
    for i in 0..6 {
        let (y, x) = (TAU * i as f64 / 6.0).sin_cos();
        text += &format!("v {x:.4} {y:.4} -0.8\nv {x:.4} {y:.4} 0.8\n");
    }
    for i in 0..6 {
        let [a, b] = [i, (i + 1) % 6].map(|k| 3 + 2 * k);
        text += &format!("f 1 {b} {a}\nf {a} {b} {} {}\nf 2 {} {}\n", b + 1, a + 1, a + 1, b + 1);
    }
    text
}

/// Three threads around one another along a ring.
fn coil() -> String {
    let mut text = String::from("# x y z radius\n");
    for thread in 0..3 {
        for i in 0..=180 {
            let along = TAU * i as f64 / 180.0;
            let around = 12.0 * along + TAU * thread as f64 / 3.0;
            let across = 1.0 + 0.12 * around.cos();
            let [x, y, z] = [across * along.cos(), across * along.sin(), 0.12 * around.sin()];
            text += &format!("{x:.4} {y:.4} {z:.4} 0.05\n");
        }
        text += "\n";
    }
    text
}

/// Balls along two arms of a spiral, from yellow to blue.
fn swarm() -> String {
    let mut table = String::from("x,y,z,radius,red,green,blue\n");
    for i in 0..240 {
        let (share, arm) = (f64::from(i / 2) / 120.0, f64::from(i % 2));
        let wobble = (f64::from(i) * 0.754_877_666).fract() - 0.5;
        let (sin, cos) = (PI * (arm + 2.2 * share) + 0.5 * wobble).sin_cos();
        let out = 0.12 + 0.88 * share;
        let up = 0.12 * ((f64::from(i) * 0.569_840_29).fract() - 0.5);
        let radius = 0.045 * (1.0 - 0.6 * share);
        let [red, blue] = [0.9 - 0.7 * share, 0.2 + 0.7 * share];
        table += &format!("{:.3},{:.3},{up:.3},{radius:.3},{red:.2},0.5,{blue:.2}\n", out * cos, out * sin);
    }
    table
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
