//! What cannot be drawn ends soon, with a message and without a file; what can is drawn.

use crate::place::{Place, Run};

const BALL: &str = "x^2 + y^2 + z^2 - 1";

fn render(place: &Place, formula: &str, options: &[&str]) -> Run {
    let mut arguments = vec!["render", "-e", formula];
    arguments.extend(options);
    place.run(&arguments, "")
}

/// Options, the exit code, and what the message must hold.
type Case = (&'static [&'static str], i32, &'static str);

const REFUSED: [Case; 34] = [
    (&["-o", "b.png", "--stats", "b.png"], 2, "cannot be one file"),
    (&["-o", "b.png", "--eye", "1e20,0,0"], 2, "(1e20, 0, 0): from more than 10^12 times"),
    (&["-o", "b.png", "--eye", "1e308,0,0"], 2, "1e308"),
    (&["-o", "b.png", "--eye", "1e308,0,0", "--target", "-1e308,0,0"], 2, "1e308"),
    (&["-o", "b.png", "--eye", "inf,0,0"], 2, "inf"),
    (&["-o", "b.png", "--eye", "NaN,0,0"], 2, "NaN"),
    (&["-o", "b.png", "--eye", "1,2,3", "--target", "1,2,3"], 2, "the same point, (1, 2, 3)"),
    (&["-o", "b.png", "--up", "0,0,0"], 2, "must not be zero"),
    (&["-o", "b.png", "--fov", "-30"], 2, "not at -30\n"),
    (&["-o", "b.png", "--fov", "0"], 2, "not at 0\n"),
    (&["-o", "b.png", "--fov", "1e300"], 2, "not at 1e300\n"),
    (&["-o", "b.png", "--ortho", "-1e308"], 2, "-1e308"),
    (&["-o", "b.png", "--size", "0x0"], 2, "0x0 pixels has none"),
    (&["-o", "b.png", "--size", "65536x65536"], 2, "needs 207 GB"),
    (&["-o", "b.png", "--size", "99999999999x1"], 2, "not a size"),
    (&["-o", "b.png", "--bounds", "1,1,1,-1,-1,-1"], 2, "empty along x: from 1 to -1"),
    (&["-o", "b.png", "--bounds", "-1,-1,-1,1,-1,1"], 2, "empty along y"),
    (&["-o", "b.png", "--bounds", "-1e308,-1,-1,1e308,1,1"], 2, "from -1e308 to 1e308"),
    (&["-o", "b.png", "--bounds", "nan,-1,-1,1,1,1"], 2, "not finite along x"),
    (&["-o", "b.png", "--clip-sphere", "0,0,0"], 2, "4 numbers"),
    (&["-o", "b.png", "--clip-sphere", "0,0,0,-1"], 2, "positive number, not -1"),
    (&["-o", "b.png", "--clip-sphere", "1e300,0,0,1"], 2, "around (1e300, 0, 0)"),
    (&["-o", "b.png", "--method", "sampled", "--step", "1e-12"], 2, "a step of 1e-12"),
    (&["-o", "b.png", "--method", "sampled", "--step", "0"], 2, "positive"),
    (&["-o", "b.png", "--tolerance", "-1"], 2, "positive"),
    (&["-o", "b.png", "--time", "nan"], 2, "NaN"),
    (&["-o", "b.png", "--samples", "5000"], 2, "5000"),
    (&["-o", "b.jpg"], 2, ".png or .exr"),
    (&["-o", "b"], 2, ".png or .exr"),
    (&["-o", "no/folder/b.png"], 1, "there is no folder no/folder"),
    (&["-o", "/proc/b.png"], 1, "cannot write /proc/b.png"),
    (&["-o", "/sys/b.exr"], 1, "cannot write /sys/b.exr"),
    (&["-o", "b.png", "--stats", "/proc/s.json"], 1, "cannot write /proc/s.json"),
    (&["-o", "folder.png"], 1, "it is a folder"),
];

#[test]
fn what_cannot_be_is_refused() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder.png")).unwrap();
    for quiet in [false, true] {
        for (options, code, message) in REFUSED {
            let mut options = options.to_vec();
            options.extend(quiet.then_some("--quiet"));
            let run = render(&place, BALL, &options);
            assert_eq!(run.code, code, "{options:?}: {}", run.err);
            assert!(run.err.contains(message) && run.err.starts_with("error: "), "{options:?}: {}", run.err);
            // Nobody reads a number of 309 digits.
            assert!(run.err.len() < 500, "{options:?}: {}", run.err);
            assert_eq!(run.out, "");
            assert_eq!(place.files(), ["folder.png"], "{options:?}");
        }
    }
}

/// Formula, options, and how the warning begins, if there is one.
type Drawn = (&'static str, &'static [&'static str], Option<&'static str>);

const DRAWN: [Drawn; 20] = [
    (BALL, &["--size", "1x1"], None),
    (BALL, &["--size", "1x3001"], None),
    (BALL, &["--size", "3001x1"], None),
    (BALL, &["--size", "9x9", "--eye", "0,0.2,0"], Some("the eye is inside of the solid")),
    (BALL, &["--size", "9x9", "--eye", "1e5,0,0"], None),
    (BALL, &["--size", "9x9", "--eye", "1e9,0,0"], Some("the eye is so far away")),
    (BALL, &["--size", "9x9", "--eye", "3,0,0", "--target", "9,0,0"], Some("nothing is to be seen")),
    (BALL, &["--size", "9x9", "--bounds", "5,5,5,6,6,6"], Some("nothing is to be seen")),
    (BALL, &["--size", "9x9", "--clip-sphere", "5,5,5,1"], Some("nothing was found inside the sphere")),
    (BALL, &["--size", "9x9", "--clip-sphere", "1,0,0,0.5"], None),
    (BALL, &["--size", "9x9", "--surface"], None),
    (BALL, &["--size", "9x9", "--surface", "--open", "--clip-sphere", "1,0,0,0.5"], None),
    ("(x^2+y^2+z^2-1)^2", &["--size", "9x9", "--surface"], None),
    ("(x^2+y^2+z^2-1)^2", &["--size", "9x9"], Some("there is no solid")),
    ("z^2", &["--size", "9x9", "--surface"], Some("no end of the surface")),
    ("x^2+1", &["--size", "9x9", "--surface"], Some("there is no surface")),
    ("sqrt(-1-x^2)", &["--size", "9x9"], Some("the function has no value anywhere")),
    ("sqrt(-1-x^2)", &["--size", "9x9", "--bounds", "-1,-1,-1,1,1,1"], Some("nothing is to be seen")),
    ("x^2+y^2+z^2-t", &["--size", "9x9", "--time", "4"], None),
    (BALL, &["--size", "9x9", "--method", "interval", "--accept-epsilon", "1e-300"], None),
];

#[test]
fn what_can_be_is_drawn_with_at_most_one_warning() {
    let place = Place::new();
    for (formula, options, warning) in DRAWN {
        let mut all = vec!["-o", "b.png"];
        all.extend(options);
        let run = render(&place, formula, &all);
        assert_eq!(run.code, 0, "{formula} {options:?}: {}", run.err);
        let expected = warning.map_or(0, |_| 1);
        assert_eq!(run.err.lines().count(), expected, "{formula} {options:?}: {}", run.err);
        let start = format!("warning: {}", warning.unwrap_or_default());
        assert!(warning.is_none() || run.err.starts_with(&start), "{formula} {options:?}: {}", run.err);
        assert!(run.out.starts_with("certified "), "{}", run.out);
        assert_eq!(place.files(), ["b.png"]);
        std::fs::remove_file(place.path("b.png")).unwrap();
        all.push("--quiet");
        let run = render(&place, formula, &all);
        assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""), "{options:?}");
    }
}

/// What touches is called a tolerance, and the time and the sphere change the picture.
#[test]
fn the_closing_line_knows_what_touches() {
    let place = Place::new();
    let tolerance = |options: &[&str]| {
        let mut all = vec!["-o", "b.png", "--size", "32x32", "--surface"];
        all.extend(options);
        let run = render(&place, "(x^2+y^2+z^2-1-t)^2", &all);
        let text = run.out.split("tolerance ").nth(1).and_then(|rest| rest.split(' ').next());
        text.and_then(|number| number.parse::<u32>().ok()).unwrap()
    };
    let view = ["--eye", "0,-9,0", "--fov", "20"];
    let plain = tolerance(&view);
    let larger = tolerance(&[view.as_slice(), &["--time", "0.5"]].concat());
    let clipped = tolerance(&[view.as_slice(), &["--clip-sphere", "0,0,1,0.9"]].concat());
    assert!(plain > 200 && larger > plain && clipped < plain, "{plain}, {larger}, {clipped}");
}
