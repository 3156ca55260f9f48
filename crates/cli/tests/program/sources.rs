//! `fieldstone texel build` of fields, meshes, strands, particles, scans and noise.

use crate::place::Place;

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const HYPERFUN: &str =
    "my_model(x[3], a[1], s[3]) { my_model = a[1] - x[1]^2 - x[2]^2 - x[3]^2; s = [1, 0, 0]; }";

/// A place with a file of each kind.
fn place() -> Place {
    let place = Place::new();
    place.file("ball.hf", HYPERFUN);
    place.file("body.obj", TETRAHEDRON);
    place.file("hair.txt", "0 0 0\n0 0 1\n\n0.5 0 0 0.1\n0.5 0 1 0.05\n");
    place.file("dust.csv", "x,y,z\n0,0,0\n1,1,1\n0.2,0.7,0.4,0.2\n");
    place.file("ramp.raw", "0123456789abcdefghijklmnopq");
    place.file(
        "ramp.nrrd",
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: raw\n\n0123456789abcdefghijklmnopq",
    );
    place
}

/// The filled cells of a recipe of 16 cells along an edge.
fn filled(place: &Place, table: &str) -> u64 {
    place.file("a.toml", &format!("edge = 16\n{table}\n"));
    let run = place.run(&["texel", "build", "a.toml", "-o", "a.texel", "-q"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{table}");
    let run = place.run(&["texel", "info", "a.texel", "--json"], "");
    let info: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    info["filled_cells"].as_u64().unwrap()
}

/// What is said of a recipe of which nothing is built.
fn refused(place: &Place, table: &str) -> String {
    place.file("a.toml", &format!("edge = 16\n{table}\n"));
    let run = place.run(&["texel", "build", "a.toml", "-o", "a.texel"], "");
    assert_eq!(run.code, 1, "{table}: {}", run.err);
    assert!(!place.path("a.texel").exists(), "{table}");
    run.err
}

#[test]
fn every_source_fills_cells() {
    let place = place();
    for (table, least, most) in [
        ("[[fields]]\nexpr = \"x^2 + y^2 + z^2 - 1\"", 500, 1500),
        ("[[fields]]\nexpr = \"x^2 + y^2 + z^2 - 1\"\nwithin = [0, 0, 0, 0.5, 0.5, 0.5]", 200, 400),
        ("[[fields]]\nfile = \"ball.hf\"\nparameters = { \"a[1]\" = 0.5 }\ninside = \"full\"", 1000, 2100),
        ("[[fields]]\nexpr = \"x^2 + y^2 + z^2 - 1\"\nhypertexture = { amplitude = 0.2 }", 1000, 2744),
        ("[[meshes]]\nfile = \"body.obj\"\ninside = \"empty\"", 300, 700),
        ("[[strands]]\nfile = \"hair.txt\"\nradius = 0.01", 30, 150),
        ("[[particles]]\nfile = \"dust.csv\"", 20, 200),
        ("[[scans]]\nfile = \"ramp.nrrd\"", 2000, 4096),
        ("[[scans]]\nfile = \"ramp.raw\"\nsize = [3, 3, 3]\ntype = \"u8\"\nthreshold = 80", 500, 2500),
        ("[[noise]]\nhypertexture = { density = 20 }", 500, 4096),
    ] {
        let cells = filled(&place, table);
        assert!((least..=most).contains(&cells), "{cells}: {table}");
    }
}

#[test]
fn sources_of_all_kinds_stand_beside_shapes() {
    let place = place();
    let left = "[[fields]]\nexpr = \"x^2 + y^2 + z^2 - 1\"\nwithin = [0, 0, 0, 0.5, 1, 1]\n";
    let right = "[[particles]]\nfile = \"dust.csv\"\nwithin = [0.5, 0, 0, 1, 1, 1]\n";
    let shape = "[[shapes]]\nbox = { size = [0.1, 0.1, 0.1] }\nat = [0.9, 0.9, 0.9]\n";
    let each: u64 = [left, right, shape].iter().map(|table| filled(&place, table)).sum();
    assert_eq!(filled(&place, &format!("{right}{shape}{left}")), each);
}

#[test]
fn mistakes_are_told_in_their_place_and_leave_no_file() {
    let place = place();
    place.file("bad.hf", "my_model(x[3], a[1]) { my_model = 1 - ; }");
    place.file("bad.obj", "v 0 0 nothing\n");
    place.file("bad.csv", "1,2\n");
    place.file("bad.txt", "0 0\n");
    place.file("bad.nrrd", "NRRD0004\ntype: uint8\n\n");
    place.file("bad.nii", "no head");
    for (table, position, message) in [
        ("[[fields]]\nexpr = \"x +\"", "a.toml:3:12", "error: "),
        ("[[fields]]\nfile = \"bad.hf\"", "a.toml:3:8", "bad.hf:1:39"),
        ("[[fields]]\ncolour = \"red\"", "a.toml:2:1", "a field has an `expr` or a `file`"),
        ("[[fields]]\nexpr = \"x\"", "a.toml:3:8", "write bounds = "),
        ("[[fields]]\nexpr = \"x\"\nbounds = [0, 0, 0, 0, 1, 1]", "a.toml:4:10", "empty"),
        ("[[fields]]\nfile = \"ball.hf\"\nparameters = { b = 1 }", "a.toml:3:8", "has no parameter `b`"),
        ("[[meshes]]\nfile = \"none.obj\"", "a.toml:3:8", "there is no file"),
        ("[[meshes]]\nfile = \"bad.obj\"", "a.toml:3:8", "this is no OBJ file"),
        ("[[strands]]\nfile = \"bad.txt\"", "a.toml:3:8", "bad.txt:1: a line has 3 or 4 numbers"),
        ("[[strands]]\nfile = \"hair.txt\"\nradius = 0", "a.toml:4:10", "a number above 0"),
        ("[[particles]]\nfile = \"bad.csv\"", "a.toml:3:8", "bad.csv:1: a line has 3, 4 or 7"),
        ("[[scans]]\nfile = \"bad.nrrd\"", "a.toml:3:8", "bad.nrrd"),
        ("[[scans]]\nfile = \"bad.nii\"", "a.toml:3:8", "this is no NIfTI file"),
        ("[[scans]]\nfile = \"ramp.raw\"", "a.toml:3:8", "raw numbers need"),
        ("[[scans]]\nfile = \"ramp.raw\"\nsize = [9, 9, 9]\ntype = \"u8\"", "a.toml:3:8", "there are 27"),
        ("[[scans]]\nfile = \"ramp.raw\"\nsize = [3, 3, 3]", "a.toml:2:1", "one of them is missing"),
        ("[[scans]]\nfile = \"ramp.nrrd\"\nskip = 9", "a.toml:2:1", "this file has a header"),
        ("[[scans]]\nfile = \"ramp.nrrd\"\ndensity = 9", "a.toml:2:1", "belong to a `threshold`"),
        (
            "[[scans]]\nfile = \"ramp.nrrd\"\ntransfer = [{ value = 9, density = 1 }, { value = 9, density = 2 }]",
            "a.toml:4:41",
            "the values of a transfer function rise",
        ),
        ("[[noise]]\nhypertexture = { octaves = 0 }", "a.toml:3:28", "a whole number from 1 to 16"),
        ("[[noise]]\nwithin = [0, 0, 0, 1, 1, 0]", "a.toml:3:10", "empty"),
    ] {
        let error = refused(&place, table);
        assert!(error.contains(position) && error.contains(message), "{table}\n{error}");
    }
}

#[test]
fn all_mistakes_are_told_at_once() {
    let error = refused(
        &place(),
        "[[shapes]]\nboll = 1\n[[meshes]]\nfile = \"none.obj\"\n[[fields]]\nexpr = \"x +\"\n[[noise]]\nsize = 1",
    );
    assert_eq!(error.matches("error: ").count(), 4, "{error}");
}

#[test]
fn recipes_read_their_folder_and_what_is_allowed() {
    let place = place();
    std::fs::create_dir(place.path("recipes")).unwrap();
    place.file("recipes/a.toml", "edge = 16\n[[meshes]]\nfile = \"../body.obj\"\n");
    let build = ["texel", "build", "recipes/a.toml", "-q", "-o", "a.texel"];
    let closed = place.run(&build, "");
    assert_eq!(closed.code, 1);
    assert!(closed.err.contains("lies outside of the folder of the recipe"), "{}", closed.err);
    assert!(
        closed.err.contains("recipes/a.toml:3:8") && closed.err.contains("--allow-read"),
        "{}",
        closed.err
    );
    for more in [&["--allow-read", "."][..], &["--allow-outside"]] {
        assert_eq!(place.run(&[&build, more].concat(), "").code, 0, "{more:?}");
    }
    // What a scene may read, its recipes may.
    place.file("scene.toml", "[[texels]]\nrecipe = \"recipes/a.toml\"\n");
    let run = place.run(&["check", "scene.toml"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
}
