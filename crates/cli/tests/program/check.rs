//! `fieldstone check --json`.

use crate::place::Place;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const MODEL: &str = "\
ball(x[3], a[2])
{
  array c[3];
  c = [0, 0, 0];
  ball = hfSphere(x, c, 2);
}
tick(x[4], a[1], s[3])
{
  π = 1;
}
";

const GOOD: &str = "\
ball(x[3], a[2]) { array c[3]; c = [0, 0, 0]; ball = hfSphere(x, c, 2); }
tick(x[4], a[1], s[3])
{
  t = -x[1]^2;
  tick = 1 + a[1] - t - x[2]^2 - x[3]^2;
}
";

fn json(place: &Place, arguments: &[&str], code: i32) -> Value {
    let run = place.run(arguments, "");
    assert_eq!(run.code, code, "{}", run.err);
    serde_json::from_str(&run.out).unwrap()
}

#[test]
fn a_model_in_full() {
    let place = Place::new();
    place.file("model.hf", GOOD);
    let found =
        json(&place, &["check", "model.hf", "--json", "--object=tick", "--param=a[1]=3", "--coord=4=.5"], 0);
    assert_eq!(found["schema"], 1);
    assert_eq!(found["source"], "model.hf");
    assert_eq!(found["chosen"], "tick");
    assert_eq!((&found["sign"], &found["up"]), (&"positive-inside".into(), &"y".into()));
    assert_eq!(found["objects"][0]["attributes"], Value::Null);
    assert_eq!(found["objects"][1]["attributes"], 3);
    assert_eq!(found["parameters"], serde_json::json!([{"name": "a[1]", "default": 0.0, "value": 3.0}]));
    assert_eq!(found["coordinates"][2], serde_json::json!({"number": 3, "value": null}));
    assert_eq!(found["coordinates"][3], serde_json::json!({"number": 4, "value": 0.5}));
    let bounds = &found["bounds"];
    assert_eq!((&bounds["found"], &bounds["proved"]), (&"bounded".into(), &true.into()));
    assert!(bounds["max"][1].as_f64().unwrap() >= 2.0);
    let warning = &found["warnings"][0];
    assert_eq!((warning["line"].as_u64(), warning["column"].as_u64()), (Some(4), Some(7)));
    assert!(warning["message"].as_str().unwrap().contains("sign"), "{warning}");
}

#[test]
fn a_surface_is_shown_in_its_ball_without_a_word_of_solids() {
    let place = Place::new();
    place.file("plane.jsurf", "surface_equation=x\nscale_factor=1\n");
    let run = place.run(&["check", "plane.jsurf"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert!(run.out.contains("the ball of radius 10 around 0,0,0"), "{}", run.out);
    assert!(!run.out.contains("bounds") && !run.out.contains("warning"), "{}", run.out);
    assert_eq!(json(&place, &["check", "plane.jsurf", "--json"], 0)["warnings"], serde_json::json!([]));
    place.file("plane.txt", "x");
    assert!(place.run(&["check", "plane.txt"], "").out.contains("warning: no end of the solid"));
}

#[test]
fn warnings_about_the_bounds_have_no_place() {
    let place = Place::new();
    let found = json(&place, &["check", "-e", "x", "--json"], 0);
    assert_eq!(
        found["bounds"],
        serde_json::json!({"found": "unbounded", "min": null, "max": null, "proved": true})
    );
    assert_eq!(found["warnings"][0]["line"], Value::Null);
}

#[test]
fn errors_are_told_twice() {
    let place = Place::new();
    place.file("model.hf", MODEL);
    let run = place.run(&["check", "model.hf", "--json"], "");
    assert_eq!(run.code, 1);
    assert!(run.err.starts_with("error: ") && run.err.contains("model.hf:9:3"), "{}", run.err);
    let found: Value = serde_json::from_str(&run.out).unwrap();
    let error = &found["errors"][0];
    assert_eq!((error["line"].as_u64(), error["column"].as_u64()), (Some(9), Some(3)), "{error}");
}

/// Every field of a value, as `bounds.min` and `objects[].name`.
fn fields(value: &Value, prefix: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(name, value)| {
            let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
            found.insert(path.clone());
            fields(value, &path, found);
        }),
        Value::Array(list) => list.iter().for_each(|value| fields(value, &format!("{prefix}[]"), found)),
        _ => {}
    }
}

#[test]
fn every_field_is_documented_and_every_documented_field_is_there() {
    let place = Place::new();
    place.file("good.hf", GOOD);
    place.file("bad.hf", MODEL);
    let mut found = BTreeSet::new();
    fields(&json(&place, &["check", "good.hf", "--json", "--object=tick"], 0), "", &mut found);
    fields(&json(&place, &["check", "bad.hf", "--json"], 1), "", &mut found);
    place.file("tuft.toml", "edge = 8\n[[shapes]]\nhair = { height = 0.8, radius = 0.1 }\n");
    let scene = "[solids]\nball = \"x^2 + y^2 + z^2 - 1\"\n[[texels]]\nrecipe = \"tuft.toml\"\n";
    place.file("scene.toml", scene);
    fields(&json(&place, &["check", "scene.toml", "--json"], 0), "", &mut found);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/check-json.md");
    let page = std::fs::read_to_string(page).unwrap();
    let rows =
        page.lines().filter_map(|line| line.strip_prefix("| `")).filter_map(|row| row.split('`').next());
    let documented: BTreeSet<String> = rows.map(str::to_owned).collect();
    assert_eq!(found, documented);
}
