//! What `.vm` programs mean.

use crate::{FileSign, Model, Source, UpAxis, parse_vm};
use fieldstone_field::{Bindings, Input};

type Unary = fn(f64) -> f64;
type Binary = fn(f64, f64) -> f64;

fn read(text: &str) -> Model {
    match parse_vm(&Source::new("model.vm", text)) {
        Ok(model) => model,
        Err(errors) => panic!("{text}\n{errors}"),
    }
}

fn messages(text: &str) -> String {
    match parse_vm(&Source::new("model.vm", text)) {
        Ok(model) => panic!("{text} is read: {model:?}"),
        Err(errors) => errors.to_string(),
    }
}

/// The value of an operation on x and y.
fn operation(operation: &str, x: f64, y: f64) -> f64 {
    let text = format!("a var-x\nb var-y\nc {operation}");
    read(&text).field.at(&[x, y, 0.0], &Bindings::new())[0]
}

#[test]
fn a_program_is_its_last_line() {
    let text = "\u{feff}# a circle\n_0 var-x\r\n_1 square _0\n\n_2 var-y  # the other axis\n_3 square _2\n\
                _4 add _1 _3\n_5 const 4\ndead sqrt _4\n_6 sub _4 _5";
    let model = read(text);
    let at = |x, y| model.field.at(&[x, y, 0.0], &Bindings::new())[0];
    assert_eq!((at(0.0, 0.0), at(2.0, 0.0), at(3.0, -4.0)), (-4.0, 0.0, 21.0));
    assert_eq!((model.name.as_str(), model.sign, model.up), ("program", FileSign::NegativeInside, UpAxis::Z));
    assert_eq!((model.coordinates, model.parameters.len(), model.warnings.len()), (3, 0, 0));
}

#[test]
fn operations_of_one_operand() {
    let cases: [(&str, Unary); 17] = [
        ("neg", |a| -a),
        ("abs", f64::abs),
        ("square", |a| a * a),
        ("sqrt", f64::sqrt),
        ("recip", f64::recip),
        ("sin", f64::sin),
        ("cos", f64::cos),
        ("tan", f64::tan),
        ("asin", f64::asin),
        ("acos", f64::acos),
        ("atan", f64::atan),
        ("exp", f64::exp),
        ("ln", f64::ln),
        ("floor", f64::floor),
        ("ceil", f64::ceil),
        ("round", f64::round),
        ("not", |a| if a == 0.0 { 1.0 } else { 0.0 }),
    ];
    for (name, expected) in cases {
        for a in [-2.5, -0.5, 0.0, 0.5, 1.5, 3.0] {
            let (found, expected) = (operation(&format!("{name} a"), a, 0.0), expected(a));
            let close = (found - expected).abs() <= 1e-14 * expected.abs().max(1.0);
            assert!(close || found == expected || found.is_nan() && expected.is_nan(), "{name} {a}: {found}");
        }
    }
}

#[test]
fn operations_of_two_operands() {
    let cases: [(&str, Binary); 11] = [
        ("add", |a, b| a + b),
        ("sub", |a, b| a - b),
        ("mul", |a, b| a * b),
        ("div", |a, b| a / b),
        ("min", f64::min),
        ("max", f64::max),
        ("atan2", f64::atan2),
        ("mod", f64::rem_euclid),
        ("compare", |a, b| f64::from(i8::from(a > b) - i8::from(a < b))),
        ("and", |a, b| if a == 0.0 { a } else { b }),
        ("or", |a, b| if a == 0.0 { b } else { a }),
    ];
    for (name, expected) in cases {
        for (a, b) in [(3.0, 2.0), (-3.5, 2.0), (3.5, -2.0), (-1.0, -3.0), (0.0, 5.0), (4.0, 4.0)] {
            assert_eq!(operation(&format!("{name} a b"), a, b), expected(a, b), "{name} {a} {b}");
        }
    }
}

#[test]
fn constants_are_any_numbers() {
    for (word, value) in
        [("1.5", 1.5), ("-1e-3", -1e-3), ("inf", f64::INFINITY), ("-inf", -f64::INFINITY), (".5", 0.5)]
    {
        assert_eq!(operation(&format!("const {word}"), 0.0, 0.0), value);
    }
    assert!(operation("const nan", 0.0, 0.0).is_nan());
}

#[test]
fn the_fourth_coordinate_and_the_time_are_inputs() {
    let model = read("z var-z\nw var-w\nt var-t\na sub z w\nb sub a t");
    assert_eq!(model.coordinates, 4);
    let mut bindings = Bindings::new();
    bindings.set(Input::Time, 0.5);
    assert_eq!(model.field.at(&[0.0, 0.0, 7.0, 2.0], &bindings), [4.5]);
}

#[test]
fn a_name_given_again_means_the_later_line_and_warns() {
    let source = Source::new("model.vm", "a var-x\na neg a\nb add a a");
    let model = parse_vm(&source).unwrap();
    assert_eq!(model.field.at(&[1.0, 0.0, 0.0], &Bindings::new()), [-2.0]);
    let warnings: Vec<String> = model.warnings.iter().map(|warning| warning.render(&source)).collect();
    insta::assert_snapshot!(warnings.join("\n"), @r#"
    warning: `a` is given again
     --> model.vm:2:1
      |
    2 | a neg a
      | ^ replaces the earlier line of this name
      |
      = help: lines below read this one; give it another name to keep both
    "#);
}

#[test]
fn unknown_operations_are_errors() {
    insta::assert_snapshot!(messages("_0 var-x\n_1 sqare _0"), @r#"
    error: unknown operation `sqare`
     --> model.vm:2:4
      |
    2 | _1 sqare _0
      |    ^^^^^ not an operation
      |
      = help: did you mean `square`?
    "#);
    insta::assert_snapshot!(messages("_0 var-x\n_1 frobnicate _0"), @r#"
    error: unknown operation `frobnicate`
     --> model.vm:2:4
      |
    2 | _1 frobnicate _0
      |    ^^^^^^^^^^ not an operation
      |
      = help: known are const, var-x, var-y, var-z, var-w, var-t, and, or, neg, abs, sqrt, square, recip, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, atanh, floor, ceil, round, trunc, sign, not, add, sub, mul, div, min, max, rmin, rmax, pow, atan2, rem, mod, compare, lt, le, eq
    "#);
    insta::assert_snapshot!(messages("sin"), @r#"
    error: `sin` stands alone
     --> model.vm:1:4
      |
    1 | sin
      |    ^ expected an operation
      |
      = help: a line begins with the name of its result: `_0 sin …`
    "#);
    insta::assert_snapshot!(messages("_0 var-x\n_1"), @r#"
    error: `_1` stands alone
     --> model.vm:2:3
      |
    2 | _1
      |   ^ expected an operation
      |
      = help: a line is `name operation operands`: `_2 add _0 _1`
    "#);
}

#[test]
fn wrong_operands_are_errors() {
    insta::assert_snapshot!(messages("_0 var-x\n_1 add _0 # one is missing"), @r#"
    error: `add` takes 2 operands, not 1
     --> model.vm:2:10
      |
    2 | _1 add _0 # one is missing
      |          ^ expected 2 operands
    "#);
    insta::assert_snapshot!(messages("_0 var-x\n_1 neg _0 _0"), @r#"
    error: `neg` takes 1 operand, not 2
     --> model.vm:2:11
      |
    2 | _1 neg _0 _0
      |           ^^ one too many
    "#);
    insta::assert_snapshot!(messages("_0 var-x 1 2"), @r#"
    error: `var-x` takes no operands, not 2
     --> model.vm:1:10
      |
    1 | _0 var-x 1 2
      |          ^^^ too many
    "#);
    insta::assert_snapshot!(messages("_0 const"), @r#"
    error: `const` takes 1 number, not 0
     --> model.vm:1:9
      |
    1 | _0 const
      |         ^ expected 1 number
    "#);
    insta::assert_snapshot!(messages("_0 const 1,5"), @r#"
    error: `1,5` is not a number
     --> model.vm:1:10
      |
    1 | _0 const 1,5
      |          ^^^ expected a number
      |
      = help: write it like `1.5`, `-2e-3`, `inf` or `nan`
    "#);
}

#[test]
fn names_that_no_line_above_gives_are_errors() {
    insta::assert_snapshot!(messages("_0 var-x\n_1 add _0 _2\n_2 var-y"), @r#"
    error: unknown name `_2`
     --> model.vm:2:11
      |
    2 | _1 add _0 _2
      |           ^^ no line above gives it
      |
      = help: the line that gives `_2` must stand above this one
    "#);
    insta::assert_snapshot!(messages("_0 var-x\n_1 add _0 2.5"), @r#"
    error: unknown name `2.5`
     --> model.vm:2:11
      |
    2 | _1 add _0 2.5
      |           ^^^ no line above gives it
      |
      = help: an operand is a name; add a line `c const 2.5` above and write `c`
    "#);
    insta::assert_snapshot!(messages("_0 neg _0"), @r#"
    error: unknown name `_0`
     --> model.vm:1:8
      |
    1 | _0 neg _0
      |        ^^ no line above gives it
      |
      = help: a line above must give it: `_0 operation operands`
    "#);
}

#[test]
fn a_text_without_operations_is_an_error() {
    insta::assert_snapshot!(messages(""), @r#"
    error: the program has no operations
     --> model.vm:1:1
      |
    1 |
      | ^ expected `name operation operands`
      |
      = help: the smallest program is one line: `_0 var-x`
    "#);
    insta::assert_snapshot!(messages("# nothing\n\n"), @r#"
    error: the program has no operations
     --> model.vm:1:10
      |
    1 | # nothing
      |          ^ expected `name operation operands`
      |
      = help: the smallest program is one line: `_0 var-x`
    "#);
}

#[test]
fn several_lines_in_error_are_reported_once_each() {
    insta::assert_snapshot!(messages("a const one\nb sine a\nc add a b\nd mul c"), @r#"
    error: `one` is not a number
     --> model.vm:1:9
      |
    1 | a const one
      |         ^^^ expected a number
      |
      = help: write it like `1.5`, `-2e-3`, `inf` or `nan`

    error: unknown operation `sine`
     --> model.vm:2:3
      |
    2 | b sine a
      |   ^^^^ not an operation
      |
      = help: did you mean `sin`?

    error: `mul` takes 2 operands, not 1
     --> model.vm:4:8
      |
    4 | d mul c
      |        ^ expected 2 operands
    "#);
    let many = parse_vm(&Source::new("model.vm", "a foo\n".repeat(1_000))).unwrap_err();
    let errors = many.list.iter().filter(|d| d.severity == crate::Severity::Error).count();
    assert_eq!(errors, crate::diagnostic::MAX_ERRORS);
}

#[test]
fn a_hundred_thousand_lines_are_read() {
    let program = |lines: usize| {
        let mut text = "_0 var-x\n".to_owned();
        (1..lines).for_each(|i| text.push_str(&format!("_{i} add _{} _0\n", i - 1)));
        text
    };
    assert_eq!(read(&program(100_000)).field.at(&[0.5, 0.0, 0.0], &Bindings::new()), [50_000.0]);
}
