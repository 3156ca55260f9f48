use super::*;
use crate::{Mode, Texel, Volume};

fn volume(strands: &[Strand], options: &StrandOptions, edge: u32) -> (Volume, Place) {
    let mut builder = Builder::new(edge).unwrap();
    let place = add_strands(&mut builder, strands, options).unwrap();
    (builder.build(Mode::Sggx).unwrap(), place)
}

fn cells(volume: &Volume) -> Vec<Texel> {
    let n = volume.edge();
    (0..n.pow(3)).filter_map(|i| volume.texel(0, [i % n, i / n % n, i / n / n])).collect()
}

/// The projected area along w, in squares of the volume's edge.
fn projected(volume: &Volume, w: DVec3) -> f64 {
    let cell = volume.cell_width(0).powi(3);
    cells(volume).iter().map(|t| f64::from(t.density) * t.flakes.projected_area(w) * cell).sum()
}

const UNIT: Option<[[f64; 3]; 2]> = Some([[0.0; 3], [1.0; 3]]);

fn options(roughness: f64) -> StrandOptions {
    StrandOptions { roughness, bounds: UNIT, ..StrandOptions::default() }
}

#[test]
fn a_thread_has_the_projected_area_of_a_cylinder() {
    let (a, b) = ([0.1, 0.2, 0.15], [0.8, 0.7, 0.9]);
    let radius = 0.002;
    let strand = Strand { points: vec![a, b], radii: vec![radius], albedo: vec![] };
    let (volume, place) = volume(&[strand], &options(0.0), 32);
    let axis = DVec3::from_array(b) - DVec3::from_array(a);
    for w in [DVec3::X, DVec3::Z, DVec3::new(0.5, -0.5, 1.0), axis] {
        let w = w.normalize();
        let exact = 2.0 * radius * axis.cross(w).length() * place.scale().powi(2);
        let found = projected(&volume, w);
        // What is stored has steps of 0.3 % in density and 0.004 in flakes.
        assert!((found - exact).abs() < 0.02 * 2.0 * radius * axis.length(), "{w}: {found} beside {exact}");
    }
}

#[test]
fn a_thick_strand_has_the_surface_of_a_rod_with_round_ends() {
    let (radius, length) = (0.15, 0.5);
    let points = vec![[0.25, 0.5, 0.5], [0.5, 0.5, 0.5], [0.75, 0.5, 0.5]];
    let strand = Strand { points, radii: vec![radius], albedo: vec![] };
    let (volume, place) = volume(&[strand], &options(0.0), 64);
    let end = std::f64::consts::PI * radius * radius;
    for (w, exact) in [(DVec3::X, end), (DVec3::Y, end + 2.0 * radius * length)] {
        let error = projected(&volume, w) / (exact * place.scale().powi(2)) - 1.0;
        assert!(error.abs() < 0.01, "{w}: {error}");
    }
}

#[test]
fn crossing_threads_in_a_cell_hide_independent_parts() {
    let mut strands = Vec::new();
    for points in [vec![[0.0, 0.5, 0.5], [1.0, 0.5, 0.5]], vec![[0.5, 0.0, 0.52], [0.5, 1.0, 0.52]]] {
        strands.push(Strand { points, radii: vec![0.05], albedo: vec![] });
    }
    let mut builder = Builder::new(4).unwrap();
    let place = add_strands(&mut builder, &strands, &options(0.0)).unwrap();
    let volume = builder.build(Mode::Sggx).unwrap();
    let width = volume.cell_width(0);
    let cell = [2, 2, 2];
    let texel = volume.texel(0, cell).unwrap();
    // Each goes through half of this cell, from the middle of the volume to its side.
    let share = 2.0 * 0.05 * place.scale() / width;
    let exact = 2.0 * -(1.0 - share).ln();
    assert!((f64::from(texel.depth[2]) - exact).abs() < 0.005 * exact, "{texel:?}, {exact}");
}

#[test]
fn texts_hold_strands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    let read = |text: &str| {
        std::fs::write(&path, text).unwrap();
        read_strands(&path).map_err(|e| e.to_string().rsplit('/').next().unwrap().to_owned())
    };
    let strands = read("# hair\n0 0 0\n0 0 1\n\n\n1,0,0,0.1\n1,0,1,0.05 # the tip\n").unwrap();
    assert_eq!(strands.len(), 2);
    assert_eq!((strands[0].points.len(), strands[1].radii.clone()), (2, vec![0.1, 0.05]));
    assert_eq!(
        read("0 0 0\n0 0 1 2\n").unwrap_err(),
        "a.txt:2: either all points of a strand have a radius or none has"
    );
    assert_eq!(read("0 0 0\n0 x 1\n").unwrap_err(), "a.txt:2: here is something else than a number");
    assert_eq!(read("0 0\n").unwrap_err(), "a.txt:1: a line has 3 or 4 numbers (x, y, z, radius), not 2");
}

/// Two strands of 2 and 3 points, with thickness.
fn hair_file() -> Vec<u8> {
    let mut bytes = b"HAIR".to_vec();
    for word in [2u32, 5, SEGMENTS | POINTS | THICKNESS, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for number in [1.0f32, 0.0, 0.5, 0.25, 0.125] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.resize(128, 0);
    for segments in [1u16, 2] {
        bytes.extend(segments.to_le_bytes());
    }
    for i in 0..15 {
        bytes.extend((i as f32).to_le_bytes());
    }
    for _ in 0..5 {
        bytes.extend(0.5f32.to_le_bytes());
    }
    bytes
}

#[test]
fn hair_files_hold_strands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hair");
    std::fs::write(&path, hair_file()).unwrap();
    let strands = read_strands(&path).unwrap();
    assert_eq!(strands[1].points, [[6.0, 7.0, 8.0], [9.0, 10.0, 11.0], [12.0, 13.0, 14.0]]);
    assert_eq!(
        (strands[0].radii.clone(), strands[0].albedo.clone()),
        (vec![0.25; 2], vec![[0.5, 0.25, 0.125]])
    );
}

#[test]
fn damaged_hair_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hair");
    let whole = hair_file();
    for length in 4..whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(read_strands(&path).is_err(), "{length}");
    }
    for place in 4..16 {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x80;
        std::fs::write(&path, bytes).unwrap();
        assert!(read_strands(&path).is_err(), "{place}");
    }
}
