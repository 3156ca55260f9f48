//! The pictures are those of the examples, as drawn by the example `handbook`.

use crate::blocks::{Example, SIZE, all, folder};
use fieldstone::{Dialect, RenderOptions, render, write_png};
use std::collections::BTreeSet;

/// A picture is small.
const MOST_BYTES: u64 = 64 << 10;

/// The difference of two pictures that is allowed: the mean of the differences of all numbers. Rounding differs between
/// machines; a wrong view or model differs by 10 and more.
const MOST_DIFFERENCE: f64 = 1.0;

fn difference(a: &[u8], b: &[u8]) -> f64 {
    if a.len() != b.len() || a.is_empty() {
        return f64::INFINITY;
    }
    let sum: u64 = a.iter().zip(b).map(|(x, y)| u64::from(x.abs_diff(*y))).sum();
    sum as f64 / a.len() as f64
}

fn stored(example: &Example) -> Vec<u8> {
    let path = folder().join("images/hyperfun").join(example.picture());
    let picture = image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    picture.to_rgb8().into_raw()
}

fn drawn(example: &Example) -> Vec<u8> {
    let model = example.load(Dialect::Lenient).unwrap().model;
    let scene = example.request(SIZE).unwrap().resolve(&model).unwrap().scene;
    let film = render(&scene, &RenderOptions::default()).unwrap().film;
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("picture.png");
    write_png(&film, &scene.lighting().background, &path).unwrap();
    image::open(&path).unwrap().to_rgb8().into_raw()
}

#[test]
fn every_picture_shows_its_example() {
    let differs = |example: &Example| {
        let difference = difference(&stored(example), &drawn(example));
        (difference > MOST_DIFFERENCE).then(|| format!("{}: {difference:.1}", example.name))
    };
    let wrong: Vec<String> = all().unwrap().iter().filter_map(differs).collect();
    let advice = "run `cargo run --release -p fieldstone --example handbook` and look at what it draws";
    assert!(wrong.is_empty(), "{}\n{advice}", wrong.join("\n"));
}

#[test]
fn another_picture_would_be_noticed() {
    let all = all().unwrap();
    let find = |name: &str| all.iter().find(|example| example.name == name).unwrap();
    let (ball, egg) = (stored(find("Ball")), stored(find("Egg")));
    assert!(difference(&ball, &egg) > 3.0 * MOST_DIFFERENCE, "{}", difference(&ball, &egg));
    assert!(difference(&ball, &ball) == 0.0 && difference(&ball, &ball[1..]).is_infinite());
    let view = Example { options: vec![("eye".to_owned(), "9,0,0".to_owned())], ..find("hfBlock").clone() };
    assert!(difference(&stored(&view), &drawn(&view)) > 3.0 * MOST_DIFFERENCE);
}

#[test]
fn there_is_a_small_picture_for_every_example_and_no_other() {
    let expected: BTreeSet<String> = all().unwrap().iter().map(Example::picture).collect();
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder().join("images/hyperfun")).unwrap() {
        let entry = entry.unwrap();
        assert!(entry.metadata().unwrap().len() <= MOST_BYTES, "{:?} is large", entry.file_name());
        found.insert(entry.file_name().into_string().unwrap());
    }
    assert_eq!(found, expected);
}

#[test]
fn every_example_shows_its_picture() {
    for example in all().unwrap() {
        let page = example.place.split(':').next().unwrap();
        let text = std::fs::read_to_string(folder().join(page)).unwrap();
        let image = format!("images/hyperfun/{})", example.picture());
        assert!(text.contains(&image), "{}: {image} is not on the page", example.place);
    }
}

#[test]
fn the_pictures_of_commands_are_small_and_have_a_command() {
    let page = std::fs::read_to_string(folder().join("commands.md")).unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(folder().join("images/commands")).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        assert!(entry.metadata().unwrap().len() <= MOST_BYTES, "{name} is large");
        assert!(page.contains(&format!("(images/commands/{name})")), "{name} is not on the page");
        assert!(page.contains(&format!(" -o {name}\n")), "no command draws {name}");
        count += 1;
    }
    assert!(count > 8, "only {count} pictures found");
}
