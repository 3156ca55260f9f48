//! Scene files and films.

use crate::place::Place;

const SCENE: &str = "[parameters]\nr = { 0 = 1.0, 1 = 1.5 }\n[render]\nsize = [24, 16]\nsamples = 1\n
[materials.red]\ncolour = \"red\"\n[solids.both]
union = [{ formula = \"x^2 + y^2 + z^2 - r^2\", material = \"red\" }, { formula = \"length(x, y) - 0.4\" }]
bounds = [-2, -2, -2, 2, 2, 2]\n";

fn place() -> Place {
    let place = Place::new();
    std::fs::write(place.path("scene.toml"), SCENE).unwrap();
    place
}

#[test]
fn scenes_are_drawn_with_options_before_the_file() {
    let place = place();
    let run = place.run(&["render", "scene.toml", "-o", "a.png", "--stats", "a.json"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let stats = std::fs::read_to_string(place.path("a.json")).unwrap();
    assert!(stats.contains("\"width\": 24") && stats.contains("\"undecided\": 0"), "{stats}");
    let run = place.run(&["render", "scene.toml", "-o", "b.png", "--size", "8x8", "--param", "r=0.7"], "");
    assert!(run.code == 0 && run.out.contains("of 64 pixels"), "{}", run.out);
}

#[test]
fn options_of_models_are_refused_for_scenes() {
    let place = place();
    for option in [
        &["--open"] as &[&str],
        &["--surface"],
        &["--object", "a"],
        &["--coord", "4=1"],
        &["--param", "q=1"],
        &["--bounds", "0,0,0,1,1,1"],
        &["--slice"],
    ] {
        let run = place.run(&[&["render", "scene.toml", "-o", "a.png"], option].concat(), "");
        assert_eq!(run.code, 2, "{option:?} {}", run.err);
        assert!(!place.path("a.png").exists());
    }
    for command in [&["eval", "scene.toml"] as &[&str], &["measure", "scene.toml"]] {
        let run = place.run(command, "");
        assert!(run.code == 2 && run.err.contains("is a scene"), "{}", run.err);
    }
}

#[test]
fn faults_of_scenes_have_their_place_and_leave_no_file() {
    let place = place();
    std::fs::write(place.path("bad.toml"), "[solids]\na = \"x +\"\n").unwrap();
    let run = place.run(&["render", "bad.toml", "-o", "a.png"], "");
    assert!(run.code == 1 && run.err.contains("bad.toml:2:"), "{}", run.err);
    assert!(!place.path("a.png").exists());
}

#[test]
fn films_are_numbered_pictures() {
    let place = place();
    let film = |arguments: &[&str]| place.run(&[&["render"], arguments].concat(), "");
    let run = film(&["scene.toml", "-o", "out_##.png", "--frames", "9..11", "--fps", "10"]);
    assert_eq!((run.code, run.out.lines().count()), (0, 3), "{}", run.err);
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_ne!(bytes("out_09.png"), bytes("out_10.png"));
    // The last key stands at 1 s.
    assert_eq!(bytes("out_10.png"), bytes("out_11.png"));
    let run = film(&["scene.toml", "-o", "one.png", "--time", "0.9"]);
    assert!(run.code == 0 && bytes("one.png") == bytes("out_09.png"));
    let run = film(&["-e", "x^2 + y^2 + z^2 - 1 - t", "-o", "m#.png", "--frames", "0..1", "--size", "8x8"]);
    assert!(run.code == 0 && place.path("m1.png").exists(), "{}", run.err);
    for (options, message) in [
        (&["-o", "out.png", "--frames", "0..1"] as &[&str], "one group of #"),
        (&["-o", "o#.png", "--frames", "2..1"], "from the first to the last"),
        (&["-o", "o#.png", "--frames", "0..1", "--fps", "0"], "positive"),
        (&["-o", "o#.png", "--fps", "5"], "--frames"),
        (&["-o", "o#.png", "--frames", "0..1", "--time", "1"], "cannot be used with"),
    ] {
        let run = film(&[&["scene.toml"], options].concat());
        assert!(run.code == 2 && run.err.contains(message), "{options:?}: {}", run.err);
    }
}

#[test]
fn check_says_what_is_in_a_scene_and_schema_is_json() {
    let place = place();
    let run = place.run(&["check", "scene.toml"], "");
    assert_eq!(run.code, 0, "{}", run.err);
    for line in [
        "parameter  r",
        "object     both: ",
        "2 parts (part, part)",
        "lights     2",
        "picture    24x16, 1 samples",
    ] {
        assert!(run.out.contains(line), "{line}: {}", run.out);
    }
    let schema = place.run(&["schema"], "");
    let schema: serde_json::Value = serde_json::from_str(&schema.out).unwrap();
    assert_eq!(schema["title"], "Fieldstone scene");
}
