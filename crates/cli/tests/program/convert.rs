//! `fieldstone convert` as a program.

use crate::place::Place;

#[test]
fn a_formula_becomes_hyperfun_and_a_program() {
    let place = Place::new();
    for name in ["ball.hf", "ball.vm", "ball.txt"] {
        let run = place.run(&["convert", "-e", "x^2 + y^2 + z^2 - 1", "-o", name], "");
        assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
        let value = place.run(&["eval", name], "2 0 0\n").out;
        assert_eq!(value, if name == "ball.hf" { "-3\n" } else { "3\n" });
    }
    assert_eq!(place.files(), ["ball.hf", "ball.txt", "ball.vm"]);
}

#[test]
fn what_is_lost_is_said() {
    let place = Place::new();
    let run = place.run(&["convert", "-e", "r = 2; x - r", "-o", "a.vm", "--param", "r=3"], "");
    assert_eq!((run.code, run.err.as_str()), (0, "warning: the parameter r is the constant 3 now\n"));
    assert_eq!(place.run(&["eval", "a.vm"], "5 0 0\n").out, "2\n");
}

#[test]
fn what_cannot_be_said_leaves_no_file() {
    let place = Place::new();
    let text = "my_model(x[3], a[1]) { i = 0; while i < x[1] loop i = i + 1; endloop; my_model = i; }";
    let model = place.file("loop.hf", text);
    let run = place.run(&["convert", model.to_str().unwrap(), "-o", "loop.vm"], "");
    assert_eq!(run.code, 1);
    assert!(run.err.starts_with("error: a .vm program cannot say it: the model has a loop"), "{}", run.err);
    let run = place.run(&["convert", model.to_str().unwrap(), "-o", "loop.jsurf"], "");
    assert_eq!(run.code, 2);
    assert_eq!(place.files(), ["loop.hf"]);
}
