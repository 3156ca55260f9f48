//! `fieldstone render --slice` as a program.

use crate::place::Place;

const FLAT: &str = "my_model(x[2], a[1]) { my_model = 1 - x[1]^2 - x[2]^2; }";

#[test]
fn a_plane_through_a_ball() {
    let place = Place::new();
    for style in ["plain", "contours", "heat"] {
        let arguments =
            ["render", "-e", "x^2+y^2+z^2-1", "--slice", "z=0.6", "-o", "a.png", "--slice-style", style];
        let run = place.run(&arguments, "");
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        assert_eq!(run.out.lines().count(), 1);
        assert!(
            run.out.starts_with("certified inside ") && run.out.contains("undefined 0 (0 %)"),
            "{}",
            run.out
        );
        assert_eq!(image::image_dimensions(place.path("a.png")).unwrap(), (512, 512));
    }
    assert_eq!(place.files(), ["a.png"]);
}

#[test]
fn what_is_inside_is_counted() {
    let place = Place::new();
    let bounds = ["--bounds", "-2,-2,-1,2,2,1", "--size", "100x100", "--stats", "s.json"];
    let run =
        place.run(&[&["render", "-e", "x^2+y^2-1", "-o", "a.png"], &bounds[..], &["--slice"]].concat(), "");
    assert_eq!(run.code, 0, "{}", run.err);
    let stats = std::fs::read(place.path("s.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
    let count = |name: &str| stats[name].as_f64().unwrap();
    let area = 10_000.0 * std::f64::consts::PI / 16.0;
    assert!(count("certified_inside") < area && count("certified_inside") + count("boundary") > area);
    assert_eq!(count("certified_inside") + count("boundary") + count("certified_outside"), 10_000.0);
}

#[test]
fn flat_models_are_drawn_flat() {
    let place = Place::new();
    place.file("flat.hf", FLAT);
    let run = place.run(&["render", "flat.hf", "-o", "a.png"], "");
    assert_eq!(
        (run.code, run.err.as_str()),
        (0, "warning: the model has fewer than 3 coordinates: drawn flat, as by --slice\n")
    );
    for slice in [&["--slice"][..], &["--slice", "z=0"]] {
        let run = place.run(&[&["render", "flat.hf", "-o", "b.png"], slice].concat(), "");
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        let [a, b] = ["a.png", "b.png"].map(|name| std::fs::read(place.path(name)).unwrap());
        assert!(a == b);
    }
}

#[test]
fn what_cannot_be_asked_for() {
    let place = Place::new();
    place.file("flat.hf", FLAT);
    let cases: [(&[&str], &str); 8] = [
        (&["-e", "x+y+z", "-o", "a.png", "--slice"], "say on which plane"),
        (&["-e", "x", "-o", "a.png", "--slice", "w=1"], "is not a plane"),
        (&["-e", "x", "-o", "a.exr", "--slice", "z=1"], "must be a .png"),
        (&["-e", "x", "-o", "a.png", "--slice", "z=1", "--eye", "1,2,3"], "cannot be used with"),
        (&["-e", "x", "-o", "a.png", "--slice", "z=inf"], "cannot lie at inf"),
        (&["-e", "x", "-o", "a.png", "--slice-style", "heat"], "with --slice only"),
        (&["flat.hf", "-o", "a.png", "--slice", "x=0"], "use --slice alone"),
        (&["flat.hf", "-o", "a.png", "--fov", "30"], "--fov has no meaning"),
    ];
    for (arguments, message) in cases {
        let run = place.run(&[&["render"], arguments].concat(), "");
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(message), "{arguments:?}: {}", run.err);
    }
    assert_eq!(place.files(), ["flat.hf"]);
}

#[test]
fn a_surface_of_surfer_is_drawn_in_its_own_view() {
    let place = Place::new();
    let text = "surface_equation=x^2+y^2+z^2-a\nsurface_parameter_a=0.25\nscale_factor=0\n\
                background_color=0 0 1\nunheard_of=1\n";
    place.file("ball.jsurf", text);
    let run = place.run(&["render", "ball.jsurf", "-o", "a.png", "--size", "40x40"], "");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(
        run.err.contains("ball.jsurf:5:1") && run.err.contains("`unheard_of` has no meaning"),
        "{}",
        run.err
    );
    // The picture is two units high: the ball fills half of it.
    let picture = image::open(place.path("a.png")).unwrap().to_rgb8();
    let is_sky = |x, y| picture.get_pixel(x, y).0 == [0, 0, 255];
    assert!(is_sky(20, 8) && !is_sky(20, 12) && !is_sky(20, 27) && is_sky(20, 31));
}
