use super::*;
use crate::{Mode, Volume};
use std::path::PathBuf;

fn volume(mesh: &Mesh, edge: u32, options: &MeshOptions) -> (Volume, Place) {
    let mut builder = Builder::new(edge).unwrap();
    let place = add_mesh(&mut builder, mesh, options).unwrap();
    (builder.build(Mode::Sggx).unwrap(), place)
}

fn cells(volume: &Volume) -> Vec<Texel> {
    let n = volume.edge();
    (0..n.pow(3)).filter_map(|i| volume.texel(0, [i % n, i / n % n, i / n / n])).collect()
}

fn amount(volume: &Volume) -> f64 {
    let cell = volume.cell_width(0).powi(3);
    cells(volume).iter().map(|t| f64::from(t.density) * cell).sum()
}

/// The areas of a mesh's triangles.
fn area(mesh: &Mesh) -> f64 {
    let point = |i: u32| DVec3::from_array(mesh.points[i as usize]);
    let areas = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(point);
        0.5 * (b - a).cross(c - a).length()
    });
    areas.sum()
}

/// Triangles all over a box, by a rule of whole numbers.
fn scattered() -> Mesh {
    let mut seed = 1u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let points: Vec<[f64; 3]> = (0..90).map(|_| [next(), next(), next()]).collect();
    let triangles = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

/// A ball of triangles with its corners at radius 1.
fn ball(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let angle = |i: u32, whole: f64| f64::from(i) / f64::from(n) * whole;
    for i in 0..=n {
        for j in 0..n {
            let (theta, phi) = (angle(i, std::f64::consts::PI), angle(j, std::f64::consts::TAU));
            mesh.points.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
            if i < n {
                let next = (j + 1) % n;
                let [a, b, c, d] = [i * n + j, i * n + next, (i + 1) * n + j, (i + 1) * n + next];
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
    }
    mesh
}

#[test]
fn the_area_of_triangles_is_kept() {
    for mesh in [scattered(), ball(24)] {
        for edge in [1, 8, 32] {
            let (volume, place) = volume(&mesh, edge, &MeshOptions::default());
            let share = if Joints::of(&mesh).is_closed { 0.25 } else { 0.5 };
            let exact = share * area(&mesh) * place.scale().powi(2);
            let error = amount(&volume) / exact - 1.0;
            // Densities are stored in steps of 0.6 %.
            assert!(error.abs() < 0.003, "{edge}: {error}");
        }
    }
}

#[test]
fn a_closed_ball_has_the_projected_area_of_a_disc() {
    let (volume, place) = volume(&ball(64), 32, &MeshOptions::default());
    let cell = volume.cell_width(0).powi(3);
    let exact = std::f64::consts::PI * place.scale().powi(2);
    for w in [DVec3::X, DVec3::Z, DVec3::ONE.normalize(), DVec3::new(0.3, -0.9, 0.2).normalize()] {
        let seen: f64 =
            cells(&volume).iter().map(|t| f64::from(t.density) * t.flakes.projected_area(w) * cell).sum();
        assert!((seen / exact - 1.0).abs() < 0.015, "{w}: {}", seen / exact - 1.0);
    }
}

/// The ball with every other triangle turned around.
fn mixed_ball() -> Mesh {
    let mut mesh = ball(24);
    mesh.triangles.iter_mut().step_by(2).for_each(|corners| corners.swap(0, 1));
    mesh
}

/// Both meshes as one.
fn joined(mut a: Mesh, b: &Mesh) -> Mesh {
    let start = a.points.len() as u32;
    a.points.extend(&b.points);
    a.triangles.extend(b.triangles.iter().map(|corners| corners.map(|i| start + i)));
    a
}

fn moved(mut mesh: Mesh, scale: f64, by: [f64; 3]) -> Mesh {
    mesh.points.iter_mut().for_each(|p| *p = [0, 1, 2].map(|k| p[k] * scale + by[k]));
    mesh
}

#[test]
fn joints_tell_what_is_closed_and_what_is_turned() {
    let joints = |is_closed, is_oriented| Joints { is_closed, is_oriented };
    assert_eq!(Joints::of(&ball(24)), joints(true, true));
    assert_eq!(Joints::of(&mixed_ball()), joints(true, false));
    assert!(!Joints::of(&scattered()).is_closed && !Joints::of(&Mesh::default()).is_closed);
    let mut open = ball(24);
    // The first triangles lie at the pole and have no area.
    open.triangles.remove(300);
    assert!(!Joints::of(&open).is_closed);
    // Points of their own for each triangle: what is at the same place is the same.
    let whole = ball(24);
    let points = whole.triangles.iter().flatten().map(|i| whole.points[*i as usize]).collect();
    let triangles = (0..whole.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    assert!(Joints::of(&Mesh { points, triangles, ..Mesh::default() }).is_closed);
}

/// Filled cells over those that a ball of the radius would fill.
fn share_of_ball(volume: &Volume, radius: f64) -> f64 {
    let cells = cells(volume).len() as f64 * volume.cell_width(0).powi(3);
    cells / (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3))
}

#[test]
fn what_is_inside_is_filled() {
    let full = MeshOptions { inside: Inside::Full, ..MeshOptions::default() };
    let mut open = ball(24);
    open.triangles.remove(300);
    let solid = MeshOptions { body: Body::Solid, ..full };
    for (mesh, options) in [(ball(24), full), (mixed_ball(), full), (open, solid)] {
        let (volume, place) = volume(&mesh, 32, &options);
        let share = share_of_ball(&volume, place.scale());
        // Cells at the border count whole.
        assert!((1.0..1.2).contains(&share), "{share}");
    }
    let (shell, place) = volume(&ball(24), 32, &MeshOptions { inside: Inside::Empty, ..full });
    assert!(share_of_ball(&shell, place.scale()) < 0.5);
}

/// A ball in a ball: hollow if it is turned inside out, else inside and part of it. Balls through each other are one body.
#[test]
fn windings_tell_hollows_from_parts() {
    let full = MeshOptions { inside: Inside::Full, ..MeshOptions::default() };
    let mut hollow = moved(ball(24), 0.6, [0.0; 3]);
    hollow.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    let middle = |mesh: &Mesh| volume(mesh, 32, &full).0.texel(0, [16; 3]).is_some();
    assert!(!middle(&joined(ball(24), &hollow)));
    assert!(middle(&joined(ball(24), &moved(ball(24), 0.6, [0.0; 3]))));
    assert!(middle(&joined(moved(ball(24), 1.0, [-0.4, 0.0, 0.0]), &moved(ball(24), 1.0, [0.4, 0.0, 0.0]))));
}

/// A lamp on one side of a closed ball: nothing comes through, whatever cells the rays graze; through sheets some does.
#[test]
fn no_light_passes_a_closed_mesh() {
    let passed = |options: &MeshOptions| {
        let (volume, place) = volume(&ball(48), 32, options);
        let radius = place.scale();
        let mut most: f64 = 0.0;
        for i in 0..400u32 {
            // Directions on a spiral, each with a place in its disc.
            let (z, turn) = ((2.0 * f64::from(i) + 1.0) / 400.0 - 1.0, 2.4 * f64::from(i));
            let w = DVec3::new((1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z);
            let (u, v) = w.any_orthonormal_pair();
            let away = radius * 0.85 * (f64::from(i * 7 % 400) / 400.0).sqrt();
            let middle = 0.5 + away * ((3.0 * turn).cos() * u + (3.0 * turn).sin() * v);
            most = most.max(volume.transmittance(middle - w, middle + w, 0.0));
        }
        most
    };
    assert!(passed(&MeshOptions::default()) < 1e-6, "{}", passed(&MeshOptions::default()));
    let sheets = passed(&MeshOptions { body: Body::Sheets, ..MeshOptions::default() });
    assert!(sheets > 1e-4, "{sheets}");
}

#[test]
fn a_sheet_across_the_volume_stops_all_light() {
    let points = vec![[0.0, 0.0, 0.4], [1.0, 0.0, 0.4], [1.0, 1.0, 0.4], [0.0, 1.0, 0.4]];
    let mesh = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let bounds = Some([[0.0; 3], [1.0; 3]]);
    let (volume, _) = volume(&mesh, 16, &MeshOptions { bounds, ..MeshOptions::default() });
    let found = cells(&volume);
    assert_eq!(found.len(), 14 * 14);
    for texel in found {
        assert_eq!(texel.depth, [0.0, 0.0, crate::MAX_DEPTH]);
        assert_eq!(texel.flakes.entries(), [0.0, 0.0, 4.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn colours_of_points_blend() {
    let points = vec![[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];
    let colours = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = Mesh { points, triangles: vec![[0, 1, 2]], colours, ..Mesh::default() };
    let bounds = Some([[0.0; 3], [1.0; 3]]);
    let (volume, place) = volume(&mesh, 16, &MeshOptions { bounds, ..MeshOptions::default() });
    let cell = place.cube_from_model(DVec3::new(0.5, 0.25, 0.5)) * 16.0;
    let texel = volume.texel(0, cell.to_array().map(|c| c as u32)).unwrap();
    for (share, exact) in texel.albedo.iter().zip([0.25, 0.5, 0.25]) {
        assert!((share - exact).abs() < 0.06, "{texel:?}");
    }
}

fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn refused(name: &str, bytes: &[u8]) -> String {
    let (_folder, path) = file(name, bytes);
    read_mesh(&path).unwrap_err().to_string().rsplit('/').next().unwrap().to_owned()
}

#[test]
fn obj_files_with_materials() {
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\n";
    let (folder, path) = file("a.obj", text.as_bytes());
    std::fs::write(folder.path().join("a.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
    let mesh = read_mesh(&path).unwrap();
    assert_eq!((mesh.points.len(), mesh.triangles.len()), (4, 2));
    assert_eq!(mesh.materials[mesh.material[1] as usize], Paint { albedo: [1.0, 0.0, 0.0], gloss: 0.0 });
    assert!(refused("a.obj", b"f 1 2 3\n").contains("a.obj"));
    assert_eq!(refused("a.obj", b"v 0 0 0\n"), "a.obj: there is no triangle in it");
    let outside = refused("a.obj", b"mtllib ../b.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    assert!(outside.contains("its materials are not read"), "{outside}");
}

#[test]
fn ply_files_with_colours() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let points = "0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0 255 0 0\n0 1 0 255 0 0\n";
    let (_folder, path) = file("a.ply", format!("{header}{points}4 0 1 2 3\n").as_bytes());
    let mesh = read_mesh(&path).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.colours[3]), (2, [1.0, 0.0, 0.0]));
    let message = refused("a.ply", format!("{header}{points}4 0 1 2 -3\n").as_bytes());
    assert!(message.contains("a face names point"), "{message}");
}

/// A triangle in a glTF file with its numbers inside; the node is moved by 2 along x.
fn gltf_text(length: usize, count: usize) -> String {
    use base64::Engine;
    let numbers = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0, "translation": [2, 0, 0]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 0, 1], "metallicFactor": 0.5}}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {count}, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {length}}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{data}"}}]}}"#
    )
}

#[test]
fn gltf_files_with_materials() {
    let (_folder, path) = file("a.gltf", gltf_text(36, 3).as_bytes());
    let mesh = read_mesh(&path).unwrap();
    assert_eq!(mesh.points, [[2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    assert_eq!(mesh.materials[mesh.material[0] as usize], Paint { albedo: [0.5, 0.25, 0.0], gloss: 0.5 });
}

#[test]
fn damaged_gltf_files_are_refused() {
    assert_eq!(
        refused("a.gltf", gltf_text(36, 4).as_bytes()),
        "a.gltf: accessor 0 reaches beyond its buffer"
    );
    assert_eq!(
        refused("a.gltf", gltf_text(48, 4).as_bytes()),
        "a.gltf: accessor 0 reaches beyond its buffer"
    );
    assert!(refused("a.glb", b"glTF\x02\0\0\0").contains("this is no glTF file"));
    let whole = gltf_text(36, 3);
    for end in (0..whole.len()).step_by(7) {
        refused("a.gltf", &whole.as_bytes()[..end]);
    }
}

#[test]
fn other_files_are_named() {
    assert_eq!(refused("a.stl", b""), "a.stl: meshes are read from .obj, .ply, .gltf and .glb files");
}
