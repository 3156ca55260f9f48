use super::*;
use crate::{Mode, Texel, Volume};
use std::f64::consts::PI;

fn cells(volume: &Volume) -> Vec<Texel> {
    let n = volume.edge();
    (0..n.pow(3)).filter_map(|i| volume.texel(0, [i % n, i / n % n, i / n / n])).collect()
}

fn amount(particles: &[Particle], edge: u32) -> (f64, Place) {
    let bounds = Some([[0.0; 3], [1.0; 3]]);
    let options = ParticleOptions { bounds, ..ParticleOptions::default() };
    let mut builder = Builder::new(edge).unwrap();
    let place = add_particles(&mut builder, particles, &options).unwrap();
    let volume = builder.build(Mode::Sggx).unwrap();
    let cell = volume.cell_width(0).powi(3);
    (cells(&volume).iter().map(|t| f64::from(t.density) * cell).sum(), place)
}

fn ball(centre: [f64; 3], radius: f64) -> Particle {
    Particle { centre, radius: Some(radius), albedo: None }
}

#[test]
fn balls_of_all_sizes_have_the_area_of_their_discs() {
    for radius in [0.001, 0.01, 0.02, 0.05, 0.3] {
        let (found, place) = amount(&[ball([0.52, 0.47, 0.5], radius)], 32);
        let error = found / (PI * (radius * place.scale()).powi(2)) - 1.0;
        assert!(error.abs() < 0.03, "{radius}: {error}");
    }
}

#[test]
fn balls_in_the_same_place_are_one_body() {
    let one = ball([0.5; 3], 0.3);
    let inner = ball([0.45, 0.5, 0.5], 0.1);
    let (alone, _) = amount(&[one], 32);
    assert_eq!(amount(&[one, one], 32).0, alone);
    assert_eq!(amount(&[one, inner], 32).0, alone);
}

#[test]
fn many_small_balls_hide_what_chance_says() {
    // 300 balls of 0.02 in a cell of 1: of independent discs, the share (1 − πr²)³⁰⁰ stays free.
    let balls: Vec<Particle> = (0..300).map(|i| ball([f64::from(i) / 300.0, 0.5, 0.5], 0.02)).collect();
    let options = ParticleOptions { bounds: Some([[0.0; 3], [1.0; 3]]), ..ParticleOptions::default() };
    let mut builder = Builder::new(1).unwrap();
    let place = add_particles(&mut builder, &balls, &options).unwrap();
    let texel = builder.build(Mode::Sggx).unwrap().texel(0, [0; 3]).unwrap();
    let exact = -300.0 * (1.0 - PI * (0.02 * place.scale()).powi(2)).ln();
    assert!((f64::from(texel.depth[0]) / exact - 1.0).abs() < 0.003);
}

#[test]
fn tables_and_ply_files_hold_particles() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        read_particles(&path).map_err(|e| e.to_string().rsplit('/').next().unwrap().to_owned())
    };
    let found = read("a.csv", "x,y,z,r,red,green,blue\n1,2,3,0.5,1,0,0.25\n4 5 6\n").unwrap();
    assert_eq!(
        found[0],
        Particle { centre: [1.0, 2.0, 3.0], radius: Some(0.5), albedo: Some([1.0, 0.0, 0.25]) }
    );
    assert_eq!(found[1].radius, None);
    assert_eq!(
        read("a.csv", "1,2\n").unwrap_err(),
        "a.csv:1: a line has 3, 4 or 7 numbers (x, y, z, radius, colour), not 2"
    );
    let header = |count: &str| {
        let colours = ["red", "green", "blue"].map(|c| format!("property uchar {c}\n")).concat();
        format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n{colours}end_header\n"
        )
    };
    let found = read("a.ply", &format!("{}1 2 3 0.5 255 0 0\n", header("1"))).unwrap();
    assert_eq!(
        found,
        [Particle { centre: [1.0, 2.0, 3.0], radius: Some(0.5), albedo: Some([1.0, 0.0, 0.0]) }]
    );
    let many = read("a.ply", &header("4000000000")).unwrap_err();
    assert!(many.contains("announces 4000000000 rows"), "{many}");
    assert!(read("b.ply", "no").unwrap_err().contains("this is no PLY file"));
}

#[test]
fn options_out_of_range_are_refused() {
    let mut builder = Builder::new(4).unwrap();
    let mut message = |particles: &[Particle], options: ParticleOptions| {
        add_particles(&mut builder, particles, &options).unwrap_err().to_string()
    };
    let default = ParticleOptions::default();
    assert_eq!(
        message(&[], ParticleOptions { radius: 0.0, ..default }),
        "`radius` is a number above 0, not 0"
    );
    assert!(message(&[], default).ends_with("is empty or not finite"));
    assert_eq!(message(&[ball([0.0; 3], -1.0)], default), "`radius` is a number from 0 on, not -1");
}
