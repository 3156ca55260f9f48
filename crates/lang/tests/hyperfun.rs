//! What HyperFun texts mean.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use fieldstone_field::Bindings;
use fieldstone_lang::{Dialect, HyperFunOptions, Model, Source, parse_hyperfun};

fn options(dialect: Dialect) -> HyperFunOptions {
    HyperFunOptions { object: None, dialect }
}

fn read_as(text: &str, dialect: Dialect) -> Model {
    match parse_hyperfun(&Source::new("test.hf", text), &options(dialect)) {
        Ok(model) => model,
        Err(diagnostics) => panic!("{diagnostics}"),
    }
}

fn read(text: &str) -> Model {
    read_as(text, Dialect::Lenient)
}

fn errors(text: &str) -> Vec<String> {
    match parse_hyperfun(&Source::new("test.hf", text), &options(Dialect::Lenient)) {
        Ok(_) => Vec::new(),
        Err(diagnostics) => diagnostics.list.into_iter().map(|d| d.message).collect(),
    }
}

fn warnings(body: &str) -> Vec<String> {
    read(&object(body)).warnings.into_iter().map(|d| d.message).collect()
}

fn object(body: &str) -> String {
    format!("my_model(x[3], a[1], s[3]) {{ {body} }}")
}

/// The value in the file's own sign.
fn at(model: &Model, point: [f64; 3]) -> f64 {
    -model.field.at(&point, &Bindings::new())[0]
}

const POINT: [f64; 3] = [0.7, -0.4, 1.3];

fn run_as(body: &str, dialect: Dialect) -> f64 {
    at(&read_as(&object(body), dialect), POINT)
}

fn run(body: &str) -> f64 {
    run_as(body, Dialect::Lenient)
}

/// The value of an expression, once folded and once computed from coordinates that the graph does not know.
fn value_as(expression: &str, dialect: Dialect) -> f64 {
    let folded = run_as(&format!("my_model = {expression};"), dialect);
    let opaque = format!("zero = x[1] - x[1]*1; my_model = zero + ({expression});");
    let computed = run_as(&opaque, dialect);
    assert!(
        folded == computed || (folded.is_nan() && computed.is_nan()),
        "{expression}: {folded}, {computed}"
    );
    folded
}

fn value(expression: &str) -> f64 {
    value_as(expression, Dialect::Lenient)
}

fn strict(expression: &str) -> f64 {
    value_as(expression, Dialect::Strict)
}

#[track_caller]
fn assert_close(actual: f64, expected: f64) {
    assert!((actual - expected).abs() <= 5e-5 * expected.abs().max(1.0), "{actual} is not {expected}");
}

#[track_caller]
fn assert_holds(condition: &str, expected: bool) {
    for dialect in [Dialect::Lenient, Dialect::Strict] {
        let actual = run_as(&format!("if {condition} then f = 1; else f = 2; endif; my_model = f;"), dialect);
        assert_eq!(actual, if expected { 1.0 } else { 2.0 }, "{condition} in {dialect:?}");
    }
}

#[test]
fn set_operators_are_r_functions() {
    for (expression, expected) in [("3|4", 12.0), ("3&4", 2.0), ("3@4", 2.0), ("3\\4", -6.0), ("~3", -3.0)] {
        assert_close(value(expression), expected);
    }
    assert_close(run("my_model = x[1] | x[2];"), 0.7 - 0.4 + 0.65_f64.sqrt());
}

#[test]
fn operators_have_the_levels_of_the_c_interpreter() {
    for (expression, expected) in [
        ("2^3^2", 64.0),
        ("1+2|3", 10.2426),
        ("3|1+2", 9.1623),
        ("4-1\\2", -2.6056),
        ("1|2&3", 2.2015),
        ("2*3&4+1", 3.7889),
        ("~2^2", 4.0),
        ("-2^2", 4.0),
        ("2-3-4", -5.0),
        ("24/4/2", 3.0),
        ("2*3^2", 18.0),
        ("2--1\n", 2.0),
        ("2 - -1", 3.0),
        ("2^-1", 0.5),
        ("-+-2", 2.0),
    ] {
        assert_close(value(expression), expected);
    }
    assert_eq!(run("my_model = -x[1]^2;"), 0.7 * 0.7);
}

#[test]
fn conditions_are_read_from_the_left() {
    assert_holds("1=1 or 1=2 and 1=2", false);
    assert_holds("1=2 and 1=2 or 1=1", true);
    assert_holds("3 > 2 > 1", false);
    assert_holds("1 < 2 < 3", true);
    assert_holds("not 2 < 1", true);
    assert_holds("not 2 > 1", false);
    assert_holds("not (2 > 1)", false);
    assert_holds("not not 5", true);
    assert_holds("x[1]", true);
    assert_holds("x[1] >= 0.7 and x[1] <= 0.7", true);
    assert_holds("x[2] /= 0 and not x[2] = 1", false);
    assert_holds("x[2] /= 0 and not x[2] = 0", true);
}

#[test]
fn parentheses_in_conditions_are_ordinary() {
    assert_holds("(x[1]+1) > 2", false);
    for condition in ["(x[1]+1)*2 > 3", "((x[1]+1)*2) > 3"] {
        assert_eq!(run(&format!("if {condition} then f = 1; else f = 2; endif; my_model = f;")), 1.0);
    }
    assert_holds("2*(x[1]+1) > 3", true);
    assert_holds("((x[1] > 0) and (x[2] > 0))", false);
}

#[test]
fn numbers_and_names_in_all_their_forms() {
    for (text, expected) in [
        ("5.", 5.0),
        (".5", 0.5),
        ("1e3", 1000.0),
        ("1E-3", 0.001),
        ("2.5e+1", 25.0),
        ("1e-12*1e12", 1.0),
        ("01", 1.0),
        ("1e05", 1e5),
    ] {
        assert_close(value(text), expected);
    }
    assert_eq!(run("RaDiUs = 2; MY_Model = radius*X[1];"), 1.4);
    assert_eq!(run("hfThing_2 = 3; my_model = HFTHING_2;"), 3.0);
    assert_eq!(run("-- comment\r\na1 = 2; -- more\rmy_model = a1;\r\n"), 2.0);
}

#[test]
fn indices_round_half_up() {
    let body = |index: &str| run(&format!("array q[3]; q = [10, 20, 30]; my_model = q[{index}];"));
    for (index, expected) in [("1.4", 10.0), ("1.5", 20.0), ("1.6", 20.0), ("0.5", 10.0), ("x[1]*2", 10.0)] {
        assert_eq!(body(index), expected, "{index}");
    }
    assert_eq!(body("x[1]+x[3]"), 20.0);
    assert!(body("x[1]*10").is_nan() && body("x[2]").is_nan());
    assert_eq!(run("array q[3]; q = [1, 2, 3]; q[x[1]*3] = 7; my_model = q[1]*100 + q[2]*10 + q[3];"), 173.0);
    assert!(run_as("array q[2]; q = [1, 2]; q[x[1]*9] = 7; my_model = q[1];", Dialect::Strict).is_nan());
}

#[test]
fn mathematical_functions() {
    for (expression, expected) in [
        ("sqrt(9)", 3.0),
        ("logd(1000)", 3.0),
        ("log(exp(2))", 2.0),
        ("atan2(1, 0)", std::f64::consts::FRAC_PI_2),
        ("ceil(-2.7)", -2.0),
        ("floor(-2.7)", -3.0),
        ("int(-2.7)", -2.0),
        ("frac(-2.7)", -0.7),
        ("sign(-3)", -1.0),
        ("mod(7.6, 3)", 1.6),
        ("mod(-7, 3)", -1.0),
        ("max(1, 2)", 2.0),
        ("min(1, 2)", 1.0),
        ("abs(-2)", 2.0),
        ("sin(1)", 0.841471),
        ("cos(1)", 0.540302),
        ("tan(1)", 1.557408),
        ("asin(0.4)", 0.411517),
        ("acos(0.4)", 1.159279),
        ("atan(0.5)", 0.463648),
        ("sinh(1)", 1.175201),
        ("cosh(1)", 1.543081),
        ("tanh(1)", 0.761594),
    ] {
        assert_close(value(expression), expected);
    }
    assert_close(run("my_model = logd(x[1]);"), 0.7_f64.log10());
}

#[test]
fn the_strict_dialect_has_the_values_of_the_c_interpreter() {
    for (expression, expected) in [
        ("sign(-3)", 1.0),
        ("mod(7.6, 3)", 2.0),
        ("mod(-7, 3)", -1.0),
        ("mod(8.5, 3)", 0.0),
        ("1/0.000001", 1e6),
        ("0.0000005^0.5", 0.0),
        ("(-2)^2.0000001", 4.0),
        ("2^(-1)", 0.5),
        ("(-2)^3", -8.0),
    ] {
        assert_close(strict(expression), expected);
    }
    for error in
        ["1/0.0000009", "0^0", "0^(-1)", "(-2)^1.9999999", "sqrt(-1)", "log(0)", "asin(1.1)", "mod(7, 0)"]
    {
        assert!(strict(error).is_nan(), "{error}");
    }
    assert_eq!(value("1/0.0000005"), 1.0 / 0.0000005);
    assert_eq!(value("0^0"), 1.0);
    let near = "if x[1] = 0.7000005 then f = 1; else f = 2; endif; my_model = f;";
    assert_eq!((run(near), run_as(near, Dialect::Strict)), (2.0, 1.0));
    let small = "if 0.0000005 then f = 1; else f = 2; endif; my_model = f;";
    assert_eq!((run(small), run_as(small, Dialect::Strict)), (1.0, 2.0));
}

#[test]
fn an_error_in_unused_code_counts_in_the_strict_dialect_only() {
    let unused = "t = sqrt(x[2]); my_model = 1;";
    assert_eq!(run(unused), 1.0);
    assert!(run_as(unused, Dialect::Strict).is_nan());
    let untaken = "if x[2] > 0 then t = sqrt(x[2]); endif; my_model = 1;";
    assert_eq!(run_as(untaken, Dialect::Strict), 1.0);
    let in_loop = "i = 0; while i < x[3]*3 loop t = sqrt(1 - i); i = i + 1; endloop; my_model = 1;";
    assert_eq!(run(in_loop), 1.0);
    assert!(run_as(in_loop, Dialect::Strict).is_nan());
}

#[test]
fn branches_join() {
    assert_eq!(run("if x[1] > 0 then f = 1; else f = 2; endif; my_model = f;"), 1.0);
    assert_eq!(run("f = 5; if x[1] < 0 then f = 1; endif; my_model = f;"), 5.0);
    let nested = "f = 0; if x[1] > 0 then if x[2] > 0 then f = 1; else f = 2; g = 3; endif; f = f + 10; endif; my_model = f;";
    assert_eq!(run(nested), 12.0);
    assert!(run("if x[1] < 0 then f = 1; endif; my_model = f;").is_nan());
    assert_eq!(run("if sqrt(x[2]) > 0 then f = 1; else f = 1; endif; my_model = f;"), 1.0);
    assert!(run("if sqrt(x[2]) > 0 then f = 1; else f = 2; endif; my_model = f;").is_nan());
}

#[test]
fn loops_with_known_conditions_are_written_out() {
    assert_eq!(run("n = 0; i = 1; while i <= 10 loop n = n + i; i = i + 1; endloop; my_model = n;"), 55.0);
    assert_eq!(run("n = 1; while 0 loop n = 2; endloop; my_model = n;"), 1.0);
}

#[test]
fn loops_that_depend_on_the_point_stay_loops() {
    let halvings = "v = x[3]; n = 0; while v > 0.1 loop v = v/2; n = n + 1; endloop; my_model = n;";
    assert_eq!(run(halvings), 4.0);
    let nested = "n = 0; i = 0; while i < x[3]*3 loop
        j = 0; while j < i loop k = 0; while k < 2 loop n = n + 1; k = k + 1; endloop; j = j + 1; endloop;
        i = i + 1; endloop; my_model = n;";
    assert_eq!(run(nested), 12.0);
    let chained =
        "p = 0; q = 0; r = 0; while r < x[3]*10 loop r = r + q; q = q + p; p = p + 1; endloop; my_model = r;";
    assert_eq!(run(chained), 20.0);
    let peeled =
        "i = 0; t = 0; while t < 3 loop i = i + 1; if i > 2 then t = t + x[3]; endif; endloop; my_model = i;";
    assert_eq!(run(peeled), 5.0);
    let array = "array q[3]; q = [1, 2, 3]; i = 1; while i < x[3]*2 loop q[i] = q[i+1]; i = i + 1; endloop;
        my_model = q[1]*100 + q[2]*10 + q[3];";
    assert_eq!(run(array), 233.0);
}

#[test]
fn a_loop_in_a_branch_that_is_not_taken_does_not_turn() {
    let body = "f = 1; if x[2] > 0 then while x[2] < 100 loop f = f + 1; endloop; endif; my_model = f;";
    assert_eq!(run(body), 1.0);
}

#[test]
fn loops_carry_only_what_changes() {
    let body = "array c[3]; c = [1, 2, 3]; v = x[3]; unused = x[1];
        while v > 0.1 loop v = v*0.5; w = hfSphere(x, c, 1); endloop; my_model = v + w;";
    let model = read(&object(body));
    let loops = model.field.graph().reachable(&[model.field.value()]);
    let carried =
        loops.iter().filter(|n| matches!(model.field.graph().node(**n), fieldstone_field::Node::LoopOut(..)));
    assert_eq!(carried.count(), 2);
}

#[test]
fn a_long_loop_over_numbers() {
    let body =
        "n = 0; i = 0; while i < 100000 loop n = n + i*2 - 1; i = i + 1; endloop; my_model = n - x[1];";
    assert_close(run(body), 99_999.0 * 100_000.0 - 100_000.0 - 0.7);
}

#[test]
fn objects_call_objects() {
    let text = "ball(x[3], a[1]) { x[1] = 100; ball = a[1] - x[2]; }
        paint(x[2], a[1], s[3]) { s[2] = s[1] + 1; s[3] = 7; paint = x[1] + x[2]; }
        my_model(x[3], a[1], s[3]) { array p[2], c[3]; p = [3, 4]; c = [5, 0, 0];
        ball = ball(x, a); my_model = ball + x[1] + paint(p, a, c)*10 + c[2]*100 + c[3]*1000 + paint(p, a); }";
    assert_close(at(&read(text), POINT), 0.4 + 0.7 + 70.0 + 0.0 + 0.0 + 7.0);
    let after = text
        .replace("my_model = ball", "t = paint(p, a, c); my_model = 0*ball")
        .replace("paint(p, a, c)*10", "0");
    assert_close(at(&read(&after), POINT), 0.7 + 600.0 + 7000.0 + 7.0);
}

#[test]
fn the_right_operand_is_evaluated_first() {
    let text = "one(x[3], a[1], s[1]) { s[1] = 1; one = 0; } two(x[3], a[1], s[1]) { s[1] = 2; two = 0; }
        my_model(x[3], a[1], s[1]) { my_model = one(x, a, s) + two(x, a, s); }";
    let model = read(text);
    assert_eq!(model.field.at(&POINT, &Bindings::new())[1], 1.0);
    assert_close(run("my_model = x[1]*10 + hfShift3D(x, 0.5, 0, 0)*(1 + 1);"), 4.0);
    assert_eq!(value("max(7 - 2, 8/4) - atan2(0, 1)"), 5.0);
}

#[test]
fn library_functions_change_arrays_in_place() {
    let body = "array xt[3]; xt[1] = x[1]; xt[2] = x[2]; xt[3] = x[3]; t = hfShift3D(xt, 1, 2, 3);
        my_model = xt[1]*100 + xt[2]*10 + xt[3] + t;";
    assert_close(run(body), -30.0 - 24.0 - 1.7 + 1.0);
}

#[test]
fn the_lenient_superset() {
    assert_eq!(
        run("t = 1;; array q[2]; q = [t, t + 1]; x[2] = 5; my_model = 9; my_model = q[2] + x[2];"),
        7.0
    );
    assert_eq!(run("a[1] = 4; s[1] = a[1]; my_model = a[1] + s[1];"), 8.0);
    let two = "f = 1; my_model = f; if x[1] > 0 then my_model = 2*my_model; endif;";
    assert_eq!(run(two), 2.0);
    let strict =
        parse_hyperfun(&Source::new("t", object(two)), &options(Dialect::Strict)).map(|_| ()).unwrap_err();
    assert!(strict.list[0].message.contains("after the object got its value"), "{strict}");
}

/// What is wrong with a text in the strict dialect; nothing if it is read.
fn strict_errors(text: &str) -> Vec<String> {
    match parse_hyperfun(&Source::new("test.hf", text), &options(Dialect::Strict)) {
        Ok(_) => Vec::new(),
        Err(diagnostics) => diagnostics.list.into_iter().map(|d| d.message).collect(),
    }
}

#[test]
fn what_only_the_lenient_dialect_reads() {
    let condition = |c: &str| object(&format!("if {c} then f = 1; else f = 2; endif; my_model = f;"));
    let texts = [
        (condition("(x[1]+1)*2 > 3"), "arithmetic behind a parenthesis"),
        (condition("((x[1]+1)*2) > 3"), "arithmetic behind a parenthesis"),
        (condition("x[1] > 0 and (x[1])^2 > 3"), "arithmetic behind a parenthesis"),
        (condition("not (x[1]) | x[2]"), "arithmetic behind a parenthesis"),
        (condition("2*(x[1] > 0) > 1"), "stands only in conditions"),
        (condition("-(x[1] > 0) < 0"), "stands only in conditions"),
        (object("my_model = 01;"), "a number that begins with 0"),
        (object("my_model = 00.5;"), "a number that begins with 0"),
        (object("my_model = 1e05;"), "an exponent that begins with 0"),
        (object("my_model = 1.5E-05;"), "an exponent that begins with 0"),
        (object("array q[02]; my_model = 1;"), "a number that begins with 0"),
        (object("my_model = 1;\r\n"), "a carriage return"),
        (object("t = 2; array q[1]; q = [1]; my_model = 1;"), "an array declared after"),
        (object("array q[1]; q = [x[1]]; my_model = 1;"), "an array literal with more"),
        (object("array q[1]; q = [(1)]; my_model = 1;"), "an array literal with more"),
        (object("array q[1]; q = [- -1]; my_model = 1;"), "an array literal with more"),
        (object("t = 2;; my_model = 1;"), "an empty statement"),
        (object("my_model = 1;;"), "an empty statement"),
        (object("x[1] = 2; my_model = 1;"), "an assignment to coordinates"),
        (object("a = [2]; my_model = 1;"), "an assignment to coordinates"),
        (object("my_model = 1; my_model = 2;"), "after the object got its value"),
        (object("my_model = 1; t = 2;"), "after the object got its value"),
        (object("if x[1] > 0 then my_model = 1; endif;"), "inside `if` or `while`"),
        (object("my_model = hfCylX(x, x, 1);"), "no function `hfcylx`"),
        (
            object("array q[1]; q = [1]; my_model = hfFMapBlob(x, 1, q, q, q, q, q);"),
            "no function `hffmapblob`",
        ),
    ];
    for (text, message) in texts {
        assert_eq!(errors(&text), Vec::<String>::new(), "{text}");
        let found = strict_errors(&text);
        assert!(found.len() == 1 && found[0].contains(message), "{text}: {found:?}");
    }
}

#[test]
fn what_the_strict_dialect_reads() {
    for condition in [
        "(x[1]+1) > 2",
        "2*(x[1]+1) > 3",
        "-(x[1]+1)*2 > 3",
        "+(x[1]+1)*2 > 3",
        "x[1]+(x[1]+1)*2 > 3",
        "x[1] > (x[2]) and ((x[2] > 0) or not (x[1] > 0))",
        "max((x[1]+1)*2, 1) > x[(1)*2]",
    ] {
        let text = object(&format!("if {condition} then f = 1; else f = 2; endif; my_model = f;"));
        assert_eq!(strict_errors(&text), Vec::<String>::new(), "{condition}");
    }
    for body in [
        "my_model = 0 + 0.5 + 10.0 + .5 + 5. + 1e5 + 1E+5 + 1e-12;",
        "array q[2]; q = [-1, +1]; my_model = q[1];",
        "s = [1, 2, 3]; s[1] = 2; my_model = s[1];",
        "hfCylX = 1; hfFMapBlob = 2; my_model = hfCylX + hfFMapBlob;",
    ] {
        assert_eq!(strict_errors(&object(body)), Vec::<String>::new(), "{body}");
    }
    assert_eq!(strict("1e-12*1e12"), 1.0);
}

#[test]
fn not_stands_only_before_a_condition() {
    for dialect in [Dialect::Lenient, Dialect::Strict] {
        for condition in ["2 + not x[1] > 0", "-not x[1]"] {
            let text = object(&format!("if {condition} then f = 1; endif; my_model = 1;"));
            let read = parse_hyperfun(&Source::new("test.hf", text.clone()), &options(dialect));
            assert!(read.is_err_and(|e| e.list[0].message.contains("`not` stands only")), "{condition}");
        }
    }
}

/// The bounds of the value, in the file's own sign, over a box around [`POINT`].
fn over_box(body: &str, dialect: Dialect, half: f64) -> [f64; 2] {
    use fieldstone_field::{Input, Interval, reference};
    let model = read_as(&object(body), dialect);
    let side = |input| match input {
        Input::Coordinate(k) => {
            Interval { lo: POINT[usize::from(k)] - half, hi: POINT[usize::from(k)] + half }
        }
        _ => Interval { lo: 0.0, hi: 0.0 },
    };
    let value = reference::evaluate(model.field.graph(), &[model.field.value()], (), side, 1000)[0];
    [-value.hi, -value.lo]
}

#[test]
fn an_index_inside_is_defined_over_boxes() {
    let list = "array q[5]; q = [10, 20, 30, 40, 50]; my_model = ";
    for dialect in [Dialect::Lenient, Dialect::Strict] {
        let read = |index: &str, half| over_box(&format!("{list}q[{index}];"), dialect, half);
        assert_eq!(read("x[3]*3", 0.01), [40.0, 40.0]);
        assert_eq!(read("x[3]*3", 0.3), [30.0, 50.0]);
        assert_eq!(read("x[1]*2", 0.1), [10.0, 20.0]);
        assert!(read("x[2]", 0.05)[0].is_nan() && read("x[3]*10", 0.05)[0].is_nan());
        assert!(read("x[3]*3", 1.0)[0].is_nan());
        let write = "array q[3]; q = [10, 20, 30]; q[x[1]*3] = 70; my_model = q[2] + q[1];";
        assert_eq!(over_box(write, dialect, 0.01), [80.0, 80.0]);
        assert_eq!(over_box(write, dialect, 0.2), [30.0, 140.0]);
    }
}

#[test]
fn an_infinite_radius_is_undefined_over_boxes_too() {
    for call in ["hfDUni(x[1], x[2], 1e300^2, 0.1)", "hfDInt(x[1], x[3], 0.4, 1e300^2)"] {
        assert!(over_box(&format!("my_model = {call};"), Dialect::Lenient, 0.01)[0].is_nan(), "{call}");
    }
}

#[test]
fn an_index_finds_every_element() {
    for length in [1, 2, 3, 4, 5, 7, 8, 13] {
        let items = (1..=length).map(|i| (i * i).to_string()).collect::<Vec<_>>().join(", ");
        let body = format!("array q[{length}]; q = [{items}]; my_model = q[x[1]];");
        let model = read(&object(&body));
        for i in 1..=length {
            assert_eq!(at(&model, [f64::from(i) + 0.4, 0.0, 0.0]), f64::from(i * i), "{i} of {length}");
        }
        assert!(at(&model, [0.4, 0.0, 0.0]).is_nan());
        assert!(at(&model, [f64::from(length) + 0.5, 0.0, 0.0]).is_nan());
        assert!(at(&model, [f64::NAN, 0.0, 0.0]).is_nan());
    }
}

#[test]
fn an_undefined_value_of_an_unused_call_counts_in_the_strict_dialect_only() {
    let unused = "t = hfA_Modulo(x[1], 0*x[2]); my_model = 1;";
    assert_eq!(run(unused), 1.0);
    assert!(run_as(unused, Dialect::Strict).is_nan());
    let changed = "array p[3]; p = [1, 1, 1]; t = hfScale3D(p, 0*x[1], 1, 1) + p[1]*0; my_model = 1;";
    assert_eq!(run(changed), 1.0);
    assert_eq!(over_box("t = hfNoiseG(x, 1, 2, 3); my_model = 1;", Dialect::Strict, 0.3), [1.0, 1.0]);
}

#[test]
fn the_object_to_draw() {
    let text = "first(x[3], a[1]) { first = 1; } Second(x[2], a[2]) { second = 2; }";
    assert_eq!(read(text).name, "first");
    let choose = |name: &str| {
        let options = HyperFunOptions { object: Some(name.to_owned()), dialect: Dialect::Lenient };
        parse_hyperfun(&Source::new("t", text), &options)
    };
    let second = choose("SECOND").unwrap();
    assert_eq!((second.name.as_str(), second.coordinates, second.parameters.len()), ("second", 2, 2));
    assert_eq!(second.objects.len(), 2);
    let error = choose("secnd").unwrap_err().to_string();
    assert!(error.contains("`first`, `second`") && error.contains("did you mean `second`?"), "{error}");
    assert_eq!(read(&format!("{text} my_model(x[3], a[1]) {{ my_model = 3; }}")).name, "my_model");
}

#[test]
fn what_a_model_tells() {
    let model = read("my_model(x[4], a[2], s[3]) { s = [0.1, 0.2, 0.3]; my_model = a[2]*x[4] + 1; }");
    assert!(model.has_attributes && model.coordinates == 4);
    assert_eq!(model.parameters[1].name, "a[2]");
    let mut bindings = Bindings::new();
    bindings.set(model.parameters[1].input, 3.0);
    assert_eq!(model.field.at(&[0.0, 0.0, 0.0, 2.0], &bindings), [-7.0, 0.1, 0.2, 0.3]);
    let plain = read("my_model(x[3], a[1]) { my_model = x[1]; }");
    assert!(!plain.has_attributes && plain.field.attributes().is_empty() && plain.warnings.is_empty());
}

#[test]
fn warnings_where_a_text_may_be_misread() {
    for (body, part) in [
        ("my_model = x[1] | x[2] + x[3];", "set operators"),
        ("my_model = 1 - x[1]^2^x[2];", "powers are read from the left"),
        ("my_model = -x[1]^2;", "a sign binds tighter"),
        ("if 1 < x[1] < 3 then t = 1; endif; my_model = 1;", "chain of comparisons"),
        ("if not x[1] < 0 then t = 1; endif; my_model = 1;", "`not` binds tighter"),
        ("if x[1] < 0 or x[2] < 0 and x[3] < 0 then t = 1; endif; my_model = 1;", "`and` and `or`"),
        ("if x[1] > 0 then f = 1; endif; my_model = f;", "`f` may have no value"),
        ("array q[2]; q[1] = 1; my_model = q[2] + x[1];", "`q[2]` has no value"),
        ("my_model = 0;", "0 everywhere"),
    ] {
        let found = warnings(body);
        assert!(found.iter().any(|w| w.contains(part)), "{body}: {found:?}");
    }
    for quiet in [
        "my_model = x[1] + x[2] | x[3];",
        "my_model = -x[1]^3 + (-x[2])^2;",
        "if x[1] > 0 then f = 1; else f = 2; endif; my_model = f;",
        "f = 0; i = 0; while i < 3 loop if i = 1 then f = x[1]; endif; i = i + 1; endloop; my_model = f;",
    ] {
        assert_eq!(warnings(quiet), Vec::<String>::new(), "{quiet}");
    }
}

#[test]
fn long_chains_do_not_recurse() {
    let chain = vec!["x[1]"; 100_000].join("+");
    let model = read(&object(&format!("my_model = {chain};")));
    assert!(model.field.operation_count() >= 99_999);
    assert_eq!(run(&format!("my_model = {}x[1];", "- ".repeat(100_000))), 0.7);
}

#[test]
fn depth_has_limits() {
    let deep = |n: usize| object(&format!("my_model = {}x[1]{};", "(".repeat(n), ")".repeat(n)));
    assert_eq!(at(&read(&deep(1000)), POINT), 0.7);
    assert!(errors(&deep(1001))[0].contains("more than 1000 parentheses"));
    let blocks = |n: usize| {
        object(&format!(
            "f = 1; {} f = 2; {} my_model = f;",
            "if x[1] > 0 then ".repeat(n),
            "endif; ".repeat(n)
        ))
    };
    assert_eq!(at(&read(&blocks(250)), POINT), 2.0);
    assert!(errors(&blocks(100_000))[0].contains("inside each other"));
}

#[test]
fn what_does_not_end_is_an_error() {
    let body = object("i = 0; while i < 1 loop i = i*1; endloop; my_model = i;");
    assert!(errors(&body)[0].contains("more than"), "{:?}", errors(&body));
    let mut doubling = String::from("f0(x[3], a[1]) { f0 = x[1]; }");
    for i in 1..60 {
        let before = i - 1;
        doubling += &format!(" f{i}(x[3], a[1]) {{ f{i} = f{before}(x, a) + f{before}(x, a); }}");
    }
    doubling += " my_model(x[3], a[1]) { my_model = f59(x, a); }";
    assert!(errors(&doubling)[0].contains("more than"), "{:?}", errors(&doubling));
}

/// xorshift*: the same texts in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n
    }
}

#[test]
fn objects_call_objects_further_down() {
    let text = "my_model(x[3], a[1]) { my_model = twice(x, a); }
        twice(x[3], a[1]) { twice = 2*once(x, a); }
        once(x[3], a[1]) { once = x[1]; }";
    assert_eq!(at(&read(text), POINT), 1.4);
    assert!(strict_errors(text)[0].contains("`twice` is defined further down"));
    let wrong = text.replace("once(x, a)", "once(x, x)");
    assert!(errors(&wrong)[0].contains("`a` of `once` has 1 element"), "{:?}", errors(&wrong));
}

/// An object that calls itself `a[1]` times, and a model that lets it.
fn recursion(statements: &str, times: usize) -> String {
    format!(
        "my_model(x[3], a[1]) {{ array n[1]; n[1] = {times}; my_model = f(x, n); }}
         f(x[3], a[1]) {{ array n[1]; n[1] = a[1] - 1; v = 1; {statements} f = v; }}"
    )
}

#[test]
fn objects_call_themselves_a_known_number_of_times() {
    let power = |times| recursion("if a[1] > 0 then v = x[1]*f(x, n); endif;", times);
    assert_close(at(&read(&power(5)), POINT), 0.7_f64.powi(5));
    assert_close(at(&read(&power(150)), [0.99, 0.0, 0.0]), 0.99_f64.powi(150));
    assert!(strict_errors(&power(5)).iter().any(|e| e.contains("`f` calls itself")));
    // Fibonacci's numbers, by two calls each.
    let two = "if a[1] > 1 then v = f(x, n); n[1] = n[1] - 1; v = v + f(x, n); endif;";
    assert_eq!(at(&read(&recursion(two, 15)), POINT), 987.0);
}

#[test]
fn objects_call_each_other() {
    let text = "my_model(x[3], a[1]) { array n[1]; n = [7]; my_model = even(x, n); }
        even(x[3], a[1]) { v = 1; if a[1] > 0 then a[1] = a[1] - 1; v = odd(x, a); endif; even = v; }
        odd(x[3], a[1]) { v = 0; if a[1] > 0 then a[1] = a[1] - 1; v = even(x, a); endif; odd = v; }";
    assert_eq!(at(&read(text), POINT), 0.0);
    assert_eq!(at(&read(&text.replace('7', "8")), POINT), 1.0);
}

#[test]
fn mengers_sponge_by_recursion() {
    let text = "my_model(x[3], a[1]) { array n[1]; n = [5]; my_model = sponge(x, n); }
        sponge(x[3], a[1]) {
          array p[3], n[1];
          i = 1;
          while i <= 3 loop q = x[i] + 1; p[i] = q - 2*floor(q/2) - 1; i = i + 1; endloop;
          u = abs(p[1])*3 - 1; v = abs(p[2])*3 - 1; w = abs(p[3])*3 - 1;
          f = min(max(u, v), min(max(v, w), max(w, u)));
          if a[1] > 1 then
            n[1] = a[1] - 1; p[1] = p[1]*3; p[2] = p[2]*3; p[3] = p[3]*3;
            f = min(f, sponge(p, n)/3);
          endif;
          sponge = f;
        }";
    let model = read(text);
    // A point lies in the sponge unless two of its coordinates have the ternary digit 1 at one place.
    let is_inside = |point: [f64; 3]| {
        let mut digits = point.map(|p| (p + 1.0) / 2.0);
        (0..5).all(|_| {
            digits = digits.map(|d| (d - d.floor()) * 3.0);
            digits.iter().filter(|d| d.floor() == 1.0).count() < 2
        })
    };
    let mut random = Random(1);
    let mut inside = 0;
    for _ in 0..2000 {
        let point = [(); 3].map(|()| random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0);
        assert_eq!(at(&model, point) > 0.0, is_inside(point), "{point:?}");
        inside += usize::from(is_inside(point));
    }
    assert!((400..500).contains(&inside), "{inside}");
}

#[test]
fn recursion_without_a_known_end_is_an_error() {
    let depends = "if x[1] > a[1] then v = f(x, n); endif;";
    let message = |text: &str| {
        parse_hyperfun(&Source::new("t", text), &options(Dialect::Lenient))
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    let told = message(&recursion(depends, 3));
    assert!(told.contains("calls itself again and again") && told.contains("depends on `x[1]`"), "{told}");
    let told = message(&recursion("v = f(x, n) + f(x, n);", 3));
    assert!(told.contains("no condition ends it") && told.contains("`my_model` → `f` → `f`"), "{told}");
    let told = message(&recursion("if a[1] > 0 then v = f(x, n) + f(x, n); endif;", 100));
    assert!(told.contains("more than") && told.contains("`my_model` → `f` → `f`"), "{told}");
}

#[test]
fn lengths_of_arrays_are_computed() {
    assert_eq!(run("n = 3; array q[2*n + 1]; q[7] = 5; my_model = q[7];"), 5.0);
    let body = "n = 2; array p[n], q[n*n]; q = [1, 2, 3, 4]; p = [5, 6]; my_model = p[2]*10 + q[4];";
    assert_eq!(run(body), 64.0);
    let filled = "n = 1; while n < 6 loop n = n + 2; endloop; array q[n]; i = 1;
        while i <= n loop q[i] = x[1]*i; i = i + 1; endloop; my_model = q[7] + q[x[3]];";
    assert_close(run(filled), 0.7 * 8.0);
    assert!(
        warnings(
            "n = 2; array q[n]; q[1] = 1; if x[1] > 9 then f = q[2]; else f = x[1]; endif; my_model = f;"
        )[0]
        .contains("`q[2]` has no value")
    );
    let known = "if 1 > 0 then n = 2; array q[n]; q = [1, 2]; endif; my_model = q[2];";
    assert_eq!(run(known), 2.0);
}

#[test]
fn arrays_of_computed_length_are_passed() {
    let text = "ball(x[3], a[1], s[2]) { s[2] = s[1] + 1; ball = x[3]; }
        my_model(x[3], a[1], s[3]) { n = 1; array p[n + 2], c[n + 1]; p = [1, 2, 3]; c = [4, 0];
        my_model = ball(p, a, c)*0 + c[2]*0 + hfSphere(p, p, 2); }";
    assert_eq!(at(&read(text), POINT), 4.0);
    let wrong = text.replace("p[n + 2]", "p[n + 3]").replace("p = [1, 2, 3]", "p = [1, 2, 3, 4]");
    assert!(errors(&wrong)[0].contains("`p` has 4 elements here, not 3"), "{:?}", errors(&wrong));
}

#[test]
fn each_call_has_its_own_arrays() {
    let text = "my_model(x[3], a[1]) { array n[1]; n = [4]; my_model = sum(x, n); }
        sum(x[3], a[1]) { n = a[1]; array q[n], b[1]; i = 1;
        while i <= n loop q[i] = i*x[1]; i = i + 1; endloop;
        f = 0; if n > 1 then b[1] = n - 1; f = sum(x, b); endif; sum = f + q[n]; }";
    assert_close(at(&read(text), POINT), 0.7 * 10.0);
    // The cells of the call must not be taken for those of the array that is declared where they were.
    let branches = "my_model(x[3], a[1]) { f = 0; n = 2;
        if x[1] > 0 then f = one(x, a); array q[n]; q = [3, 4]; f = f + q[1]; endif; my_model = f; }
        one(x[3], a[1]) { t = 5; u = 6; one = t + u; }";
    assert_eq!(at(&read(branches), POINT), 14.0);
    let warned = branches.replace("endif;", "endif; f = f + q[2];");
    let messages: Vec<String> = read(&warned).warnings.into_iter().map(|w| w.message).collect();
    assert_eq!(messages, ["`q[2]` may have no value"]);
}

#[test]
fn lengths_that_are_not_known_are_errors() {
    for (body, part) in [
        ("array q[x[1]];", "the length of `q` is not known"),
        ("array q[a[1] + 1];", "the length of `q` is not known"),
        ("i = 0; while i < x[1] loop i = i + 1; endloop; array q[i];", "the length of `q` is not known"),
        ("n = 2.5; array q[n];", "`q` cannot have 2.5 elements"),
        ("array q[65536];", "an array has at most 65535 elements, not 65536"),
        ("n = 1e400;", "the number is too large"),
        ("array q[70000 + 0];", "`q` has at most 65535 elements, not 70000"),
        ("array q[0/0];", "`q` cannot have NaN elements"),
        ("array q[2*];", "unexpected `]`"),
        ("array q[n];", "`n` has no value here"),
        ("if 1 > 2 then n = 2; array q[n]; endif; q[1] = 1;", "`q` has no length here"),
        ("n = 2; if x[1] > 0 then array q[n]; n = 3; endif; array r[n];", "the length of `r` is not known"),
        ("n = 2; array q[n]; q = [1, 2, 3];", "`q` has 2 elements, not 3"),
    ] {
        let found = errors(&object(&format!("{body} my_model = 1;")));
        assert!(found.len() == 1 && found[0].contains(part), "{body}: {found:?}");
    }
    let text = object("my_model = x[1]*0 + 1; n = 2; array q[n];");
    assert!(strict_errors(&text).iter().any(|e| e.contains("unexpected `n`")));
}
