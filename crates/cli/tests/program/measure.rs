//! `fieldstone measure` as a program.

use crate::place::Place;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_ball_in_words_and_in_json() {
    let place = Place::new();
    let ball = ["measure", "-e", "r = 1; x^2 + y^2 + z^2 - r^2", "--param", "r=2", "--tolerance", "0.01"];
    let run = place.run(&ball, "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    for word in ["volume", "area", "centroid", "model units³", "All bounds are proved"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    let run = place.run(&[ball.as_slice(), &["--json"]].concat(), "");
    let json: Value = serde_json::from_str(&run.out).unwrap();
    let exact = 32.0 / 3.0 * std::f64::consts::PI;
    assert!(number(&json["volume"][0]) <= exact && exact <= number(&json["volume"][1]), "{json}");
    assert!(number(&json["volume"][1]) < 1.01 * exact && json["reached"] == true, "{json}");
    let area = 16.0 * std::f64::consts::PI;
    assert!(number(&json["area"][0]) <= area && area <= number(&json["area"][1]), "{json}");
    assert!(number(&json["outer_box"][3]) >= 2.0 && number(&json["inner_box"][3]) <= 2.0, "{json}");
}

#[test]
fn what_has_no_bounds_is_said() {
    let plane = Place::new().run(&["measure", "-e", "x"], "");
    assert_eq!(plane.code, 0);
    assert!(plane.err.contains("cut off at ±10"), "{}", plane.err);
    let step = "max(floor(x + 0.7) - 0.5, x^2 + y^2 + z^2 - 1)";
    let step = ["measure", "-e", step, "--tolerance", "0.05", "--json"];
    let json: Value = serde_json::from_str(&Place::new().run(&step, "").out).unwrap();
    assert!(json["area"][1].is_null() && number(&json["area"][0]) > 0.0, "{json}");
}

#[test]
fn what_cannot_be_measured() {
    let place = Place::new();
    place.file("flat.hf", "my_model(x[2], a[1]) { my_model = 1 - x[1]^2 - x[2]^2; }");
    let cases: [(&[&str], i32, &str); 5] = [
        (&["measure", "flat.hf"], 2, "2 coordinates, and a figure in the plane has no volume"),
        (&["measure", "-e", "x", "--coord", "3=1"], 2, "coordinate 3 is an axis of space"),
        (&["measure", "-e", "x", "--tolerance", "0"], 2, "the tolerance is 0"),
        (&["measure", "-e", "x", "--bounds", "0,0,0,0,1,1"], 2, "the bounds are empty along x"),
        (&["measure", "none.hf"], 1, "there is no file none.hf"),
    ];
    for (arguments, code, message) in cases {
        let run = place.run(arguments, "");
        assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(message), "{arguments:?}: {}", run.err);
        assert_eq!(run.out, "");
    }
}
