//! Solids from data files, control values, curves and sections: their values, and what is said of mistakes.

use crate::resolve;
use fieldstone::{Document, FileAccess, Scene, SceneRequest};
use std::fs;
use std::path::Path;

fn value(scene: &Scene, point: [f64; 3]) -> f64 {
    let solid = &scene.solids()[0];
    solid.field().at(&point, solid.bindings())[0]
}

/// The scene of a solid in a folder, or what is said of it.
fn solid_in(folder: &Path, solid: &str) -> Result<Scene, String> {
    let scene = folder.join("scene.toml");
    fs::write(&scene, format!("[solids.a]\nbounds = [-2, -2, -2, 2, 2, 2]\n{solid}\n")).unwrap();
    let document = Document::load(&scene, &FileAccess::default()).map_err(|error| error.to_string())?;
    let resolved = document.resolve(&SceneRequest::default()).map_err(|error| error.to_string())?;
    Ok(resolved.resolved.scene)
}

#[test]
fn voxels_are_read_from_raw_numbers() {
    let folder = tempfile::tempdir().unwrap();
    // 0 at x = −1 and 200 at x = 1.
    fs::write(folder.path().join("ramp.raw"), [0u8, 200, 0, 200, 0, 200, 0, 200]).unwrap();
    let solid = "voxels = { file = \"ramp.raw\", size = [2, 2, 2], type = \"u8\", level = 50, box = [-1, -1, -1, 1, 1, 1] }";
    let scene = solid_in(folder.path(), solid).unwrap();
    // At level 50 from x = −0.5 on, and inside where the numbers are larger.
    assert!(value(&scene, [-0.5, 0.0, 0.0]).abs() < 1e-9);
    assert!(value(&scene, [0.0; 3]) < 0.0 && value(&scene, [-0.6, 0.0, 0.0]) > 0.0);
    assert!(value(&scene, [1.1, 0.0, 0.0]) > 0.0);
}

#[test]
fn voxels_are_read_from_nrrd_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n".to_vec();
    bytes.extend([0u8, 0, 0, 0, 8, 8, 8, 8]);
    fs::write(folder.path().join("ramp.nrrd"), bytes).unwrap();
    let scene =
        solid_in(folder.path(), "voxels = { file = \"ramp.nrrd\", level = 4, inside = \"below\" }").unwrap();
    assert!(value(&scene, [0.0, 0.0, -0.5]) < 0.0 && value(&scene, [0.0, 0.0, 0.5]) > 0.0);
}

#[test]
fn points_make_a_solid_through_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = String::from("x,y,z,nx,ny,nz\n");
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut p = [0.0; 3];
            p[axis] = sign;
            table += &format!("{0},{1},{2},{0},{1},{2}\n", p[0], p[1], p[2]);
        }
    }
    fs::write(folder.path().join("six.csv"), table).unwrap();
    let scene = solid_in(folder.path(), "points = { file = \"six.csv\" }").unwrap();
    assert!(value(&scene, [1.0, 0.0, 0.0]).abs() < 1e-6);
    assert!(value(&scene, [0.0; 3]) < 0.0 && value(&scene, [1.5, 0.0, 0.0]) > 0.0);
}

#[test]
fn splines_are_polynomials_of_their_control_values() {
    let solid = "[solids.a]\nspline = { size = [2, 2, 2], controls = [-1, 1, -1, 1, -1, 1, -1, 1] }";
    let scene = resolve(solid).resolved.scene;
    assert!((value(&scene, [0.25, 0.3, -0.2]) - 0.25).abs() < 1e-12);
}

#[test]
fn sweeps_are_the_least_over_their_curve() {
    let ball = "solid = { formula = \"length(x, y, z) - 0.2\" }";
    for curve in ["polyline = [[-1, 0, 0], [1, 0, 0]]", "bezier = [[-1, 0, 0], [0, 0, 0], [1, 0, 0]]"] {
        let scene = resolve(&format!("[solids.a]\nsweep = {{ {ball}, {curve} }}")).resolved.scene;
        assert!((value(&scene, [0.3, 0.5, 0.0]) - 0.3).abs() < 1e-9, "{curve}");
        assert!((value(&scene, [2.0, 0.0, 0.0]) - 0.8).abs() < 1e-9, "{curve}");
    }
    let scene = resolve(&format!("[solids.a]\nsweep = {{ {ball}, helix = [1, 0, 1] }}")).resolved.scene;
    assert!((value(&scene, [2.0, 0.0, 0.0]) - 0.8).abs() < 1e-9);
}

#[test]
fn curves_are_formulas_of_u() {
    let scene = resolve(
        "[parameters]\nr = 2\n[solids.a]\nsweep = { solid = { formula = \"length(x, y, z) - 0.2\" }, \
         curve = { x = \"r*cos(u)\", y = \"k = 2; k*sin(u)\", z = 1, from = 0, to = 6.3 } }",
    );
    let scene = scene.resolved.scene;
    assert!((value(&scene, [3.0, 0.0, 1.0]) - 0.8).abs() < 1e-12);
    assert!((value(&scene, [0.0, 0.0, 1.0]) - 1.8).abs() < 1e-12);
}

#[test]
fn projections_are_the_least_over_the_fourth_coordinate() {
    let scene = resolve(
        "[solids.a]\nprojection = { solid = { formula = \"x^2 + y^2 + z^2 + (w - 0.3)^2 - 1\" }, from = 0, to = 1 }",
    );
    let scene = scene.resolved.scene;
    assert!((value(&scene, [1.0, 1.0, 0.0]) - 1.0).abs() < 1e-12);
}

#[test]
fn mistakes_are_told_in_their_place() {
    for (solid, said) in [
        ("voxels = { level = 1 }", "`file` is missing"),
        ("voxels = { file = \"none.nrrd\" }", "there is no file"),
        ("voxels = { file = \"../secret.nrrd\" }", "lies outside of the folder"),
        ("points = { file = \"/etc/hostname\" }", "lies outside of the folder"),
        ("points = { file = \"few.csv\" }", "few.csv:2: a line has six numbers"),
        ("voxels = { file = \"few.csv\" }", "raw numbers need their counts and type"),
        ("spline = { size = [2, 2, 2], controls = [1] }", "control"),
        ("sweep = { solid = { formula = \"x\" } }", "exactly one of polyline, bezier, helix and curve"),
        ("sweep = { solid = { formula = \"x\" }, curve = { x = \"u\", y = \"u\" } }", "`z` is missing"),
        (
            "sweep = { solid = { formula = \"x\" }, curve = { x = \"u\", y = \"x\", z = 0 } }",
            "a curve is a formula of u alone",
        ),
        (
            "sweep = { solid = { formula = \"x\" }, curve = { x = \"u\", y = 0, z = 0, from = 1 } }",
            "the first must be the smaller",
        ),
        (
            "sweep = { solid = { formula = \"x\" }, polyline = [[0, 0, 0]] }",
            "a polyline has 2 to 256 points, not 1",
        ),
        ("projection = { solid = { formula = \"w\" }, from = 1, to = 1 }", "must be finite and not empty"),
        ("projection = { from = 1 }", "`solid` is missing"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("few.csv"), "x y z\n1 2 3\n").unwrap();
        let error = solid_in(folder.path(), solid).unwrap_err();
        assert!(error.contains(said), "{solid}: {error}");
        assert!(error.contains("scene.toml:3:") || error.contains("few.csv:"), "no place: {error}");
    }
}
