//! Volumes of texels in scene files.

use crate::{at, resolve};
use fieldstone::Mode;
use fieldstone::glam::DVec3;

#[test]
fn a_scene_may_hold_a_volume_alone() {
    let found = resolve("[[texels]]\nrecipe = \"tuft.toml\"");
    let scene = &found.resolved.scene;
    assert_eq!((found.volumes, found.messages), (vec!["tuft".to_owned()], Vec::new()));
    assert_eq!((scene.bounds().min(), scene.bounds().max()), (DVec3::ZERO, DVec3::ONE));
    assert_eq!(scene.texels()[0].volume().mode(), Mode::Sggx);
}

#[test]
fn keys_of_volumes_have_their_meaning() {
    let found = resolve(
        "[[texels]]
        name = \"hair\"
        recipe = \"tuft.toml\"
        edge = 32
        filter = \"1995\"
        transform = [{ scale = 2 }, { translate = [1, 0, 0] }]
        repeat = [3, 1, 1]
        density = 0.5
        level = 2
        [solids]
        ball = \"x^2 + y^2 + z^2 - 1\"",
    );
    let scene = &found.resolved.scene;
    let texels = &scene.texels()[0];
    assert_eq!(found.volumes, ["hair"]);
    assert_eq!((texels.volume().edge(), texels.volume().mode()), (32, Mode::Neyret1995));
    assert_eq!((texels.bounds().min(), texels.bounds().max()), (DVec3::X, DVec3::new(7.0, 2.0, 2.0)));
    assert_eq!((texels.density(), texels.finest_level()), (0.5, 2.0));
    assert_eq!((scene.bounds().max().x, scene.solids().len()), (7.0, 1));
}

#[test]
fn copies_of_a_volume_share_it() {
    let scene =
        resolve("[[texels]]\nrecipe = \"tuft.toml\"\ngrid = { count = [2, 2, 1], spacing = [2, 2, 2] }");
    let texels = scene.resolved.scene.texels();
    assert_eq!((texels.len(), scene.volumes.len()), (4, 4));
    assert!(texels.iter().all(|t| std::ptr::eq(t.volume(), texels[0].volume())));
    assert_eq!(texels[3].bounds().min(), DVec3::new(2.0, 2.0, 0.0));
}

const MISTAKES: [(&str, &str); 12] = [
    ("no volume", "[[texels]]\nname = \"grass\"\ndensity = 2"),
    ("two volumes", "[[texels]]\nfile = \"a.texel\"\nrecipe = \"tuft.toml\""),
    ("no such file", "[[texels]]\nfile = \"a.texel\""),
    ("no texels", "[[texels]]\nfile = \"tuft.toml\""),
    ("fault in a recipe", "[[texels]]\nrecipe = \"no-tuft.toml\""),
    ("unknown filter", "[[texels]]\nrecipe = \"tuft.toml\"\nfilter = \"box\""),
    ("edge of a file", "[[texels]]\nfile = \"a.texel\"\nedge = 64"),
    ("odd edge", "[[texels]]\nrecipe = \"tuft.toml\"\nedge = 100"),
    ("repeated where it does not fit", "[[texels]]\nrecipe = \"tuft.toml\"\nrepeat = [4, 4, 1]"),
    ("repeated along one axis", "[[texels]]\nrecipe = \"tuft.toml\"\nrepeat = [4]"),
    ("no density", "[[texels]]\nrecipe = \"tuft.toml\"\ndensity = 0"),
    ("mapped", "[[texels]]\nrecipe = \"tuft.toml\"\ntransform = [{ bend = { degrees = 9 } }]"),
];

#[test]
fn mistakes_in_volumes_are_shown_in_their_place() {
    let mut all = String::new();
    for (name, text) in MISTAKES {
        let error = match at(text, 0.0) {
            Ok(_) => panic!("{name}: no error"),
            Err(error) => error.replace(env!("CARGO_MANIFEST_DIR"), "."),
        };
        assert!(error.starts_with("error: ") && error.contains("--> "), "{name}: {error}");
        all += &format!("# {name}\n{error}\n\n");
    }
    insta::assert_snapshot!(all);
}

#[test]
fn there_are_not_too_many_volumes() {
    let error =
        at("[[texels]]\nrecipe = \"tuft.toml\"\ngrid = { count = [40, 40, 1], spacing = [1, 1, 1] }", 0.0);
    assert!(error.unwrap_err().contains("at most 1000 volumes"));
}
