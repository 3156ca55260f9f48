//! `fieldstone eval` and `fieldstone check` as programs.

use crate::place::Place;

const ATTRIBUTES: &str = "my_model(x[3], a[1], s[3])
{
  my_model = 4 + a[1] - x[1]^2 - x[2]^2 - x[3]^2;
  s[1] = x[1]; s[2] = 0.5; s[3] = sqrt(x[2]);
}
";

#[test]
fn a_formula_at_points() {
    let run =
        Place::new().run(&["eval", "-e", "x^2 + y^2 + z^2 - 1"], "0 0 0\n1\t1 1\n  .5 0 -1e-1 \n1e9 0 0");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert_eq!(run.out, "-1\n2\n-0.74\n1e18\n");
}

#[test]
fn hyperfun_keeps_its_sign_and_shows_attributes() {
    let place = Place::new();
    place.file("ball.hf", ATTRIBUTES);
    let run = place.run(&["eval", "ball.hf", "--param", "a[1]=-1"], "0 0.25 0\n2 -1 0\n");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert_eq!(run.out, "2.9375\t0\t0.5\t0.5\n-2\t2\t0.5\tundefined\n");
}

/// Tables of HyperFun models with attributes: three coordinates, the value in the file's sign, s[1] to s[3].
#[test]
fn golden_rows() {
    let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/../lang/tests/golden");
    for name in ["attr_checker", "attr_color", "attr_hsv2rgb"] {
        let table = std::fs::read_to_string(format!("{golden}/{name}.tsv")).unwrap();
        let numbers = |line: &str| -> Vec<f64> { line.split('\t').map(|n| n.parse().unwrap()).collect() };
        let rows: Vec<Vec<f64>> = table.lines().skip(1).map(numbers).collect();
        let points: String = rows.iter().map(|r| format!("{} {} {}\n", r[0], r[1], r[2])).collect();
        let run = Place::new().run(&["eval", &format!("{golden}/{name}.hf")], &points);
        assert_eq!((run.code, run.out.lines().count()), (0, rows.len()), "{}", run.err);
        for (row, line) in rows.iter().zip(run.out.lines()) {
            let values = numbers(line);
            assert_eq!(values.len(), 4);
            let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs().max(1.0);
            assert!(row[3..].iter().zip(&values).all(close), "{name}: {row:?} {values:?}");
        }
    }
}

#[test]
fn fixed_coordinates_leave_the_table() {
    let formula = "x + 10*y + 100*z + 1000*w";
    let run = Place::new().run(&["eval", "-e", formula, "--coord", "4=-2"], "1 2 3\n");
    assert_eq!(run.out, "-1679\n");
    let run = Place::new().run(&["eval", "-e", formula, "--coord=2=0", "--coord=4=1"], "1 1\n2 1\n");
    assert_eq!(run.out, "1101\n1102\n");
}

#[test]
fn empty_lines_stay_empty() {
    let run = Place::new().run(&["eval", "-e", "x"], "\n1 0 0\n2 0 0\n \t\n\n3 0 0\n");
    assert_eq!((run.code, run.out.as_str()), (0, "\n1\n2\n\n\n3\n"));
    // Without coordinates every line is the same point.
    let run = Place::new().run(&["eval", "-e", "x", "--coord=1=7", "--coord=2=0", "--coord=3=0"], "\n\n");
    assert_eq!((run.code, run.out.as_str()), (0, "7\n7\n"));
}

#[test]
fn time_is_an_option() {
    for (time, value) in [("2.5", "5\n"), ("-.5", "-1\n")] {
        let run = Place::new().run(&["eval", "-e", "2*t + x", "--time", time], "0 0 0\n");
        assert_eq!((run.code, run.out.as_str()), (0, value), "{}", run.err);
    }
    let run = Place::new().run(&["eval", "-e", "2*t + x", "--time", "inf"], "0 0 0\n");
    assert_eq!(run.code, 2, "{}", run.err);
}

#[test]
fn parameters_in_any_case_and_short_numbers() {
    let place = Place::new();
    place.file("ball.hf", ATTRIBUTES);
    let run = place.run(&["eval", "ball.hf", "--param", "A[1]=-.5"], "0 0 0\n");
    assert_eq!(run.code, 0, "{}", run.err);
    let same = place.run(&["eval", "ball.hf", "--param", "a[1]=-0.5"], "0 0 0\n");
    assert_eq!(run.out, same.out);
}

#[test]
fn messages_of_models_say_what_they_are_once() {
    let place = Place::new();
    // A warning stands before the error in the text.
    place.file("both.vm", "_0 var-x\n_0 var-y\n_1 nothing _0\n");
    let run = place.run(&["check", "both.vm"], "");
    assert_eq!(run.code, 1);
    let heads: Vec<&str> =
        run.err.lines().filter(|l| l.starts_with("error") || l.starts_with("warning")).collect();
    assert_eq!(heads.len(), 2, "{}", run.err);
    assert!(heads[0].starts_with("warning: ") && heads[1].starts_with("error: "), "{}", run.err);
    assert!(!run.err.contains("error: warning") && !run.err.contains("error: error"), "{}", run.err);
}

#[test]
fn undefined_is_a_word() {
    let run = Place::new().run(&["eval", "-e", "sqrt(x)"], "-1 0 0\n4 0 0\n");
    assert_eq!(run.out, "undefined\n2\n");
}

#[test]
fn formulas_that_begin_with_a_sign() {
    for arguments in [["eval", "-e", "-x"].as_slice(), &["eval", "-e=-x"], &["eval", "--expression=-x"]] {
        let run = Place::new().run(arguments, "3 0 0\n");
        assert_eq!((run.code, run.out.as_str()), (0, "-3\n"), "{arguments:?}: {}", run.err);
    }
}

#[test]
fn a_bad_line_is_named() {
    let cases = [
        ("0 0 0\n1 2\n", "line 2: a point has 3 coordinates here, not 2"),
        ("0 0 0\n1 2 3 4\n", "line 2: a point has 3 coordinates here, not 4"),
        ("0 0 zero\n", "line 1: `zero` is not a number"),
    ];
    for (input, message) in cases {
        let run = Place::new().run(&["eval", "-e", "x"], input);
        assert_eq!(run.code, 1);
        assert_eq!(run.err, format!("error: standard input, {message}\n"));
        assert_eq!(run.out.lines().count(), input.lines().count() - 1);
    }
}

#[test]
fn many_points_come_in_order() {
    let input: String = (0..5000).map(|i| format!("{i} 0 0\n")).collect();
    let run = Place::new().run(&["eval", "-e", "2*x"], &input);
    let expected: String = (0..5000).map(|i| format!("{}\n", 2 * i)).collect();
    assert!(run.out == expected);
}

#[test]
fn what_a_command_line_cannot_ask_for() {
    let place = Place::new();
    place.file("ball.hf", ATTRIBUTES);
    let cases: [(&[&str], i32, &str); 9] = [
        (&["eval"], 2, "MODEL"),
        (&["eval", "ball.hf", "-e", "x"], 2, "cannot be used with"),
        (&["eval", "-e", "x", "--param", "r=1"], 2, "has no parameter `r`"),
        (&["eval", "-e", "x", "--coord", "7=1"], 2, "no coordinate 7"),
        (&["eval", "-e", "x", "--object", "a"], 2, "no objects"),
        (&["eval", "ball.hf", "--param", "b[1]=1"], 2, "it has a[1]"),
        (&["eval", "none.hf"], 1, "there is no file none.hf"),
        (&["eval", "-e", "x +"], 1, "formula:1:"),
        (&["check", "ball.hf", "--object", "other"], 1, "other"),
    ];
    for (arguments, code, message) in cases {
        let run = place.run(arguments, "");
        assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(message), "{arguments:?}: {}", run.err);
        assert_eq!(run.err.matches("error").count(), 1, "{arguments:?}: {}", run.err);
        assert_eq!(run.out, "");
    }
}

#[test]
fn check_tells_what_there_is() {
    let place = Place::new();
    place.file("ball.hf", ATTRIBUTES);
    let run = place.run(&["check", "ball.hf"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let has = |line: &str| assert!(run.out.lines().any(|l| l == line), "{line}\n{}", run.out);
    has("object     my_model: 3 coordinates, 1 parameters, 3 attributes");
    has("chosen     my_model");
    has("sign       F >= 0 inside, y up");
    has("parameter  a[1] = 0");
    let bounds = run.out.lines().find_map(|l| l.strip_prefix("bounds")).unwrap();
    let bounds: Vec<f64> = bounds.trim().split(',').map(|x| x.parse().unwrap()).collect();
    assert!(bounds[..3].iter().all(|x| (-2.1..=-2.0).contains(x)), "{bounds:?}");
    assert!(bounds[3..].iter().all(|x| (2.0..=2.1).contains(x)), "{bounds:?}");
}

#[test]
fn check_warns() {
    let run = Place::new().run(&["check", "-e", "x^2 + 1"], "");
    assert_eq!(run.code, 0);
    assert!(
        run.out.contains("bounds     none") && run.out.contains("warning: there is no solid"),
        "{}",
        run.out
    );
}
