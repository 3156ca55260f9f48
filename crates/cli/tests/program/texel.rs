//! `fieldstone texel` as a program.

use crate::place::Place;

const LAWN: &str = r##"
edge = 32
cyclic = ["x", "y"]

[[scatters]]
shape = { blade = { height = 0.6, width = 0.08, fold = 25, curl = 30 }, colour = "#4a8f2f" }
count = 16
seed = 7
lean = 8
comb = [0.3, 0, 0]
size = [0.8, 1.2]
"##;

#[test]
fn a_lawn_is_built_told_of_compared_and_cut() {
    let place = Place::new();
    place.file("lawn.toml", LAWN);
    let run = place.run(&["texel", "build", "lawn.toml", "-o", "lawn.texel"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert!(run.out.contains("32 cells, 6 levels") && run.out.contains("along x, y"), "{}", run.out);
    let run = place.run(&["texel", "info", "lawn.texel", "--json"], "");
    let info: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let bytes = std::fs::metadata(place.path("lawn.texel")).unwrap().len();
    assert_eq!((info["edge"].as_u64(), info["stored_bytes"].as_u64()), (Some(32), Some(bytes)));
    let run = place.run(&["texel", "compare", "lawn.texel"], "");
    assert_eq!((run.code, run.out.lines().filter(|line| line.starts_with("1995")).count()), (0, 5));
    let run = place.run(&["texel", "compare", "lawn.texel", "--csv", "--sun", "1,0,0.5"], "");
    let widths: Vec<usize> = run.out.lines().map(|line| line.split(',').count()).collect();
    assert_eq!((run.code, widths), (0, vec![9; 11]), "{}", run.out);
    assert_eq!(place.run(&["texel", "compare", "lawn.texel", "--sun", "0,0,0"], "").code, 2);
    let run = place.run(&["texel", "slice", "lawn.texel", "-o", "lawn.png", "--axis", "x"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert_eq!(image::open(place.path("lawn.png")).unwrap().width(), 512);
}

#[test]
fn a_volume_is_drawn_in_a_scene_by_every_method() {
    let place = Place::new();
    place.file("lawn.toml", LAWN);
    assert_eq!(place.run(&["texel", "build", "lawn.toml", "-o", "lawn.texel", "-q"], "").code, 0);
    let scene = |source: &str| {
        format!(
            "[[texels]]\n{source}\nrepeat = [2, 2, 1]\n[solids.ball]\nformula = \"(x - 1)^2 + (y - 1)^2 + (z - 0.5)^2 - 0.1\"\n"
        )
    };
    place.file("file.toml", &scene("file = \"lawn.texel\""));
    place.file("recipe.toml", &scene("recipe = \"lawn.toml\""));
    let check = place.run(&["check", "file.toml"], "");
    assert!(check.out.contains("texels     lawn: 32 cells along an edge"), "{}", check.out);
    for (scene, method) in [
        ("file.toml", "affine"),
        ("recipe.toml", "affine"),
        ("file.toml", "interval"),
        ("file.toml", "sampled"),
    ] {
        let output = format!("{method}-{scene}.png");
        let run = place.run(&["render", scene, "--method", method, "--size", "32x32", "-o", &output], "");
        assert_eq!(run.code, 0, "{}", run.err);
    }
    let picture = |name: &str| image::open(place.path(name)).unwrap().to_rgb8();
    assert!(picture("affine-file.toml.png") == picture("affine-recipe.toml.png"));
    // The background is the same all along a row; the ball alone covers some fifty pixels.
    let covered = |picture: &image::RgbImage| {
        picture.enumerate_pixels().filter(|(_, y, pixel)| *pixel != picture.get_pixel(0, *y)).count()
    };
    for method in ["affine", "interval", "sampled"] {
        let count = covered(&picture(&format!("{method}-file.toml.png")));
        assert!(count > 150, "{method}: {count}");
    }
}

#[test]
fn a_thin_volume_alone_is_no_empty_picture() {
    let place = Place::new();
    place.file("mist.toml", "edge = 8\n[[shapes]]\nellipsoid = { radii = [0.3, 0.3, 0.3] }\nat = [0.5, 0.5, 0.5]\ndensity = 0.5\n");
    place.file("scene.toml", "[[texels]]\nrecipe = \"mist.toml\"\n");
    let run = place.run(&["render", "scene.toml", "--size", "16x16", "-o", "mist.png"], "");
    assert_eq!((run.code, run.err.contains("warning")), (0, false), "{}", run.err);
}

#[test]
fn the_same_recipe_gives_the_same_bytes() {
    let place = Place::new();
    place.file("lawn.toml", LAWN);
    for name in ["a.texel", "b.texel"] {
        assert_eq!(place.run(&["texel", "build", "lawn.toml", "-o", name, "-q"], "").code, 0);
    }
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(read("a.texel") == read("b.texel"));
}

#[test]
fn what_cannot_be_built_or_read() {
    let place = Place::new();
    place.file("lawn.toml", LAWN);
    place.file("odd.toml", "edge = 32\n[[shapes]]\nboll = { radius = 1 }\n");
    place.file("full.toml", "edge = 1024\n[[shapes]]\nbox = { size = [2, 2, 2] }\n");
    place.file("text.texel", "not a volume");
    let cases: [(&[&str], i32, &str); 9] = [
        (&["build", "lawn.toml", "-o", "a.png"], 2, "a.png: a volume must be a .texel file"),
        (
            &["build", "lawn.toml", "-o", "a.texel", "--edge", "48"],
            2,
            "a power of two from 1 to 1024, not 48",
        ),
        (&["build", "odd.toml", "-o", "a.texel"], 1, "odd.toml:3:1"),
        (&["build", "none.toml", "-o", "a.texel"], 1, "none.toml"),
        (&["info", "text.texel"], 1, "text.texel: not a .texel file"),
        (&["info", "."], 1, "it is a folder"),
        (&["compare", "none.texel"], 1, "none.texel: No such file"),
        (&["slice", "text.texel", "-o", "a.gif"], 2, "a picture must be a .png file"),
        (&["build", "full.toml", "-o", "a.texel"], 1, "the shapes fill more than 16777216 cells"),
    ];
    for (arguments, code, message) in cases {
        let run = place.run(&[&["texel"], arguments].concat(), "");
        assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(message), "{arguments:?}: {}", run.err);
        assert!(!place.path("a.texel").exists());
    }
}
