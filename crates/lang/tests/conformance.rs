//! What `docs/conformance.md` says about texts, in both dialects.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use fieldstone_field::Bindings;
use fieldstone_lang::{Dialect, HyperFunOptions, Severity, Source, parse_hyperfun};

const BOTH: [Dialect; 2] = [Dialect::Lenient, Dialect::Strict];

/// The value of a text at (0.7, −0.4, 1.3), or its first error.
fn value(text: &str, dialect: Dialect) -> Result<f64, String> {
    let options = HyperFunOptions { object: None, dialect };
    match parse_hyperfun(&Source::new("test.hf", text), &options) {
        Ok(model) => Ok(0.0 - model.field.at(&[0.7, -0.4, 1.3], &Bindings::new())[0]),
        Err(diagnostics) => {
            let error = diagnostics.list.iter().find(|d| d.severity == Severity::Error).unwrap();
            Err(error.message.clone())
        }
    }
}

fn of_body(body: &str, dialect: Dialect) -> Result<f64, String> {
    value(&format!("my_model(x[3], a[1], s[3])\n{{\n{body}\n}}\n"), dialect)
}

#[test]
fn comments_of_any_length_are_read() {
    let body = format!("-- {}\nmy_model = 3;", "n".repeat(1000));
    BOTH.into_iter().for_each(|dialect| assert_eq!(of_body(&body, dialect), Ok(3.0)));
}

#[test]
fn names_have_at_most_255_letters() {
    let body = |length| format!("{0} = 3; my_model = {0};", "n".repeat(length));
    for dialect in BOTH {
        assert_eq!(of_body(&body(255), dialect), Ok(3.0));
        assert!(of_body(&body(256), dialect).unwrap_err().contains("more than 255 letters"));
    }
}

#[test]
fn numbers_mean_what_they_say() {
    for (text, expected) in [("1e5", 1e5), ("1E+5", 1e5), ("1e-12", 1e-12), (".5", 0.5), ("5.", 5.0)] {
        BOTH.into_iter()
            .for_each(|dialect| assert_eq!(of_body(&format!("my_model = {text};"), dialect), Ok(expected)));
    }
}

#[test]
fn strings_are_refused() {
    BOTH.into_iter().for_each(|dialect| assert!(of_body("my_model = sin(\"x\");", dialect).is_err()));
}

#[test]
fn what_the_strict_dialect_refuses_is_read_leniently() {
    for (body, expected) in [
        ("my_model = 01;", 1.0),
        ("my_model = 1e05;", 1e5),
        ("my_model =\r\n2;", 2.0),
        ("if (x[1] + 1)*2 > 3 then f = 3; else f = 1; endif; my_model = f;", 3.0),
        ("n = 2; array q[2*n + 1]; q[5] = 4; my_model = q[5];", 4.0),
        ("t = 1; array q[1]; q[1] = 2; my_model = q[1];", 2.0),
        ("array q[2]; t = 4; q = [t, 2]; my_model = q[1];", 4.0),
        ("t = 1;; my_model = t;", 1.0),
        ("x[1] = 5; my_model = x[1];", 5.0),
        ("a[1] = 6; my_model = a[1];", 6.0),
        ("if 1 > 0 then my_model = 7; endif;", 7.0),
        ("my_model = 8; t = 1;", 8.0),
        ("my_model = 1; my_model = 9;", 9.0),
    ] {
        assert_eq!(of_body(body, Dialect::Lenient), Ok(expected), "{body}");
        assert!(of_body(body, Dialect::Strict).is_err(), "{body}");
    }
}

#[test]
fn what_the_reference_calls_the_same_is_read_in_both_dialects() {
    for body in [
        "array q[2], p[1]; q = [-1, +2]; p[1] = 1; my_model = q[2];",
        "s[1] = 2; s = [1, 2, 3]; my_model = s[2];",
        "if x[1] > 0 then f = 2; else f = 1; endif; my_model = f;",
        "i = 0; while i < 2 loop i = i + 1; endloop; my_model = i;",
        "t = (x[1] + 1)*2; if 1*(t + 0) > 3 then f = 2; else f = 1; endif; my_model = f;",
    ] {
        BOTH.into_iter().for_each(|dialect| assert_eq!(of_body(body, dialect), Ok(2.0), "{body}"));
    }
}

#[test]
fn attributes_that_are_not_handed_over_start_at_zero() {
    let text = "paint(x[3], a[1], s[2]) { s[1] = s[1] + 1; paint = s[1]; }
        my_model(x[3], a[1], s[2]) { s[1] = 5; my_model = paint(x, a)*10 + s[1]; }";
    assert_eq!(value(text, Dialect::Lenient), Ok(15.0));
}

#[test]
fn an_index_outside_is_an_error_where_it_is_known_and_undefined_where_not() {
    for dialect in BOTH {
        assert!(
            of_body("array q[2]; q = [1, 2]; my_model = q[3];", dialect)
                .unwrap_err()
                .contains("lies outside")
        );
        assert!(of_body("array q[2]; q = [1, 2]; my_model = q[x[1]*9];", dialect).unwrap().is_nan());
    }
}

#[test]
fn cylinders_have_a_second_name_in_the_lenient_dialect() {
    for axis in ["X", "Y", "Z"] {
        let body = |name: &str| format!("array c[3]; c = [0, 0, 0]; my_model = {name}{axis}(x, c, 2);");
        let expected = of_body(&body("hfCylinder"), Dialect::Strict).unwrap();
        assert_eq!(of_body(&body("hfCyl"), Dialect::Lenient), Ok(expected));
        assert!(of_body(&body("hfCyl"), Dialect::Strict).unwrap_err().contains("no function"));
    }
}
