//! `fieldstone plot` as a program.

use crate::place::Place;

const BALL: &str = "x^2 + y^2 + z^2 - 1";

#[test]
fn a_ray_as_svg_and_as_png() {
    let place = Place::new();
    let ray = "--ray=-3,0.3,0.2,1,0,0";
    let run = place.run(&["plot", "-e", BALL, ray, "-o", "ball.svg"], "");
    assert_eq!((run.code, run.err.as_str(), run.out.as_str()), (0, "", ""));
    let svg = std::fs::read_to_string(place.path("ball.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains(BALL) && svg.contains("certified"));
    let run = place.run(&["plot", "-e", BALL, "--through", "256,250", "--spans", "9", "-o", "ball.png"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let png = image::open(place.path("ball.png")).unwrap();
    assert_eq!((png.width(), png.height()), (1560, 1044));
}

#[test]
fn what_cannot_be_plotted() {
    let place = Place::new();
    let cases: [(&[&str], i32, &str); 10] = [
        (&["-o", "a.svg"], 2, "--ray"),
        (&["--ray", "0,0,0,1,0,0", "-o", "a.gif"], 2, "the plot must be a .svg or .png file"),
        (&["--ray", "0,0,0,1,0", "-o", "a.svg"], 2, "6 numbers"),
        (&["--ray", "0,0,0,0,0,0", "-o", "a.svg"], 2, "the direction must be finite and not 0"),
        (&["--ray", "0,9,0,1,0,0", "-o", "a.svg"], 2, "--span t0,t1"),
        (&["--ray", "0,0,0,1,0,0", "--spans", "0", "-o", "a.svg"], 2, "from 1 to 4096 spans"),
        (&["--through", "900,1", "-o", "a.svg"], 2, "there is no pixel 900,1"),
        (&["--through", "-1,0", "-o", "a.svg"], 2, "`-1,0` is not a pixel: write 256,100, counted from 0,0"),
        (&["--ray", "0,0,0,1,0,0", "--span", "0,1e20", "-o", "a.svg"], 2, "t = 1e20 is too far away"),
        (&["--ray", "0,0,0,1,0,0", "-o", "none/a.svg"], 1, "there is no folder none"),
    ];
    for (arguments, code, message) in cases {
        let run = place.run(&[&["plot", "-e", BALL], arguments].concat(), "");
        assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(message), "{arguments:?}: {}", run.err);
        assert!(!place.path("a.svg").exists());
    }
}
