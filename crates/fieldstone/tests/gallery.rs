//! The models of the gallery can be read, and are solid where they should be and nowhere else.

use fieldstone_field::Bindings;
use fieldstone_lang::{Model, Source, parse_formula, parse_hyperfun, parse_jsurf, parse_vm};
use std::path::{Path, PathBuf};

/// Each model, a point inside and a point outside: in a hole or a notch, where it has one. Of a surface, points on either
/// side.
const MODELS: [(&str, [f64; 3], [f64; 3]); 37] = [
    ("colours.hf", [0.0, 0.0, 0.0], [2.0, 1.7, 0.0]),
    ("fractal.hf", [0.0, 0.0, 0.0], [1.2, 1.2, 1.2]),
    ("jsurf/barth.jsurf", [0.0, 0.0, 0.0], [0.9, 0.0, 0.3]),
    ("jsurf/cayley.jsurf", [0.9, 0.0, 0.0], [1.1, 0.0, 0.0]),
    ("jug.hf", [4.6, 0.4, 0.0], [0.0, 0.0, 0.0]),
    ("noise.hf", [4.5, 0.0, 0.0], [0.0, 0.0, 2.5]),
    ("scenes/frep/bulb.hf", [0.0, 0.0, 0.0], [1.3, 1.0, 0.0]),
    ("scenes/frep/cup.hf", [0.0, 0.4, 0.0], [0.0, 3.0, 0.0]),
    ("scenes/frep/julia.hf", [0.0, 0.0, 0.0], [1.4, 1.4, 0.0]),
    ("scenes/frep/metamorphosis.hf", [0.0, 2.4, 0.0], [4.3, 1.0, 0.0]),
    ("scenes/frep/noise.hf", [0.0, 3.0, 0.0], [0.0, 0.0, 0.0]),
    ("scenes/frep/rabbit.hf", [0.0, 2.4, 0.0], [2.5, 1.0, 0.0]),
    ("scenes/frep/sandbox.hf", [4.3, 1.0, 0.0], [3.0, 2.0, 0.0]),
    ("scenes/frep/sponge.hf", [0.95, 0.95, 0.95], [0.0, 0.0, 0.0]),
    ("scenes/frep/stand.hf", [0.0, 3.0, 0.0], [2.0, 4.0, 0.0]),
    ("scenes/shikki/cup.hf", [2.0, 0.3, 0.0], [0.0, 3.0, 0.0]),
    ("scenes/shikki/pot.hf", [0.0, 4.0, 0.0], [0.0, 13.0, 0.0]),
    ("scenes/shikki/stand.hf", [0.0, 11.0, 0.0], [0.0, 5.0, 0.0]),
    ("scenes/shikki/tray.hf", [0.0, 0.7, 0.0], [0.0, 2.0, 0.0]),
    ("skeleton.hf", [0.0, 0.0, 1.0], [0.0, 1.5, 0.0]),
    ("soft.hf", [-2.5, 0.1, 1.0], [2.0, 2.2, 2.2]),
    ("table1/bretzel.txt", [1.1, 0.0, 0.0], [0.7, 0.0, 0.0]),
    ("table1/citrus.txt", [0.0, 1.0, 0.0], [0.0, -0.1, 0.0]),
    ("table1/cylinder.txt", [0.7, 0.7, 1.2], [0.0, 0.0, 1.3]),
    ("table1/decocube.txt", [0.8, 0.0, 1.0], [0.0, 0.0, 0.0]),
    ("table1/ellipsoid.txt", [1.9, 0.0, 0.0], [0.0, 0.0, 1.1]),
    ("table1/heart.txt", [0.0, 0.0, 0.0], [0.0, 0.0, 1.2]),
    ("table1/icos.txt", [0.0, 0.0, 4.6], [0.0, 0.0, 0.0]),
    ("table1/pseudo-cube.txt", [0.99, 0.99, 0.99], [1.01, 0.0, 0.0]),
    ("table1/sesc.txt", [0.9, 0.9, 0.9], [1.0, -0.9, 0.9]),
    ("table1/sphere.txt", [0.5, 0.5, 0.5], [0.6, 0.6, 0.6]),
    ("table1/superquadric.txt", [0.99, 0.0, 0.0], [0.0, 1.2, 1.2]),
    ("table1/tangle.txt", [1.58, 1.58, 1.58], [0.0, 0.0, 0.0]),
    ("table1/torus.txt", [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ("table1/trigonometric.txt", [1.0, 0.0, -1.0], [0.0, 0.0, 1.5]),
    ("table1/unions.txt", [0.0, 0.0, 0.0], [1.2, 1.2, -1.2]),
    ("text.vm", [0.0, 0.5, 0.0], [0.0, -1.0, 0.0]),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery")
}

fn read(name: &str) -> Model {
    let text = std::fs::read_to_string(folder().join(name)).expect("the model is there");
    let source = Source::new(name, text);
    let model = match name.rsplit_once('.') {
        Some((_, "hf")) => parse_hyperfun(&source, &Default::default()),
        Some((_, "vm")) => parse_vm(&source),
        Some((_, "jsurf")) => parse_jsurf(&source),
        _ => parse_formula(&source),
    };
    model.map_err(|errors| errors.to_string()).expect("the model can be read")
}

#[test]
fn every_model_is_solid_inside_and_not_outside() {
    for (name, inside, outside) in MODELS {
        let model = read(name);
        assert!(model.warnings.is_empty(), "{name}: {:?}", model.warnings);
        let mut bindings = Bindings::new();
        model.parameters.iter().for_each(|p| bindings.set(p.input, p.default));
        let at = |point: [f64; 3]| model.field.at(&point, &bindings)[0];
        assert!(at(inside) < 0.0, "{name} is {} at {inside:?}", at(inside));
        assert!(at(outside) > 0.0, "{name} is {} at {outside:?}", at(outside));
    }
}

#[test]
fn no_model_is_left_out() {
    let mut found = Vec::new();
    for prefix in ["", "jsurf/", "scenes/frep/", "scenes/shikki/", "table1/"] {
        let folder = folder().join(prefix);
        for entry in std::fs::read_dir(folder).expect("the gallery is a folder") {
            let name = entry.expect("its entries can be read").file_name().to_string_lossy().into_owned();
            if [".hf", ".vm", ".txt", ".jsurf"].iter().any(|end| name.ends_with(end)) {
                found.push(format!("{prefix}{name}"));
            }
        }
    }
    found.sort();
    assert_eq!(found, MODELS.map(|(name, ..)| name));
}

#[test]
fn the_inscription_is_a_large_program() {
    let count = read("text.vm").field.operation_count();
    assert!((6_000..8_000).contains(&count), "{count} operations");
}

#[test]
fn colours_come_from_the_parts() {
    let toadstool = read("colours.hf");
    let colour = |point: [f64; 3]| toadstool.field.at(&point, &Bindings::new())[1..].to_vec();
    // The flank of the cap between two dots, the stem, two squares of the board beside each other.
    assert_eq!(colour([0.0, 3.5, 2.6]), [0.80, 0.09, 0.07]);
    assert_eq!(colour([0.0, -1.0, 0.5]), [0.93, 0.87, 0.72]);
    assert_eq!(colour([2.5, -3.6, 3.5]), [0.92, 0.90, 0.82]);
    assert_eq!(colour([3.5, -3.6, 3.5]), [0.16, 0.20, 0.18]);
}
