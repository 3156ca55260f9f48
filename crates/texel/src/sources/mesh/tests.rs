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
            let exact = 0.5 * area(&mesh) * place.scale().powi(2);
            let error = amount(&volume) / exact - 1.0;
            // Densities are stored in steps of 0.6 %.
            assert!(error.abs() < 0.003, "{edge}: {error}");
        }
    }
}

#[test]
fn a_closed_ball_has_the_projected_area_of_a_disc() {
    let options = MeshOptions { closed: true, ..MeshOptions::default() };
    let (volume, place) = volume(&ball(64), 32, &options);
    let cell = volume.cell_width(0).powi(3);
    let exact = std::f64::consts::PI * place.scale().powi(2);
    for w in [DVec3::X, DVec3::Z, DVec3::ONE.normalize(), DVec3::new(0.3, -0.9, 0.2).normalize()] {
        let seen: f64 =
            cells(&volume).iter().map(|t| f64::from(t.density) * t.flakes.projected_area(w) * cell).sum();
        assert!((seen / exact - 1.0).abs() < 0.015, "{w}: {}", seen / exact - 1.0);
    }
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
