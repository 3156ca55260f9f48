//! `fieldstone render` as a program.

use crate::place::Place;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};

const BALL: &str = "x^2 + y^2 + z^2 - 1";

/// One channel of an EXR file.
fn channel(path: &std::path::Path, name: &str) -> Vec<f32> {
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.from_file(path).unwrap();
    assert_eq!(image.layer_data.len(), 1);
    let channel = image.layer_data[0].channel_data.list.iter().find(|c| c.name.to_string() == name).unwrap();
    let FlatSamples::F32(samples) = &channel.sample_data else { panic!("32-bit floats") };
    samples.clone()
}

#[test]
fn a_png_with_one_closing_line() {
    let place = Place::new();
    let run = place.run(&["render", "-e", BALL, "-o", "ball.png", "--size", "40x30"], "");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    assert_eq!(run.out.lines().count(), 1);
    assert!(run.out.starts_with("certified ") && run.out.contains("of 1200 pixels"), "{}", run.out);
    let picture = image::open(place.path("ball.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (40, 30));
    assert_ne!(picture.get_pixel(20, 15), picture.get_pixel(0, 15));
    assert_eq!(place.files(), ["ball.png"]);
}

#[test]
fn an_exr_with_the_layers_it_promises() {
    let place = Place::new();
    let arguments = ["render", "-e", BALL, "-o", "b.exr", "--size=33x33", "--eye", "-5,0,0", "--quiet"];
    let run = place.run(&arguments, "");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.from_file(place.path("b.exr")).unwrap();
    let mut names: Vec<String> =
        image.layer_data[0].channel_data.list.iter().map(|c| c.name.to_string()).collect();
    names.sort();
    assert_eq!(names, ["A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "certificate", "cost", "part"]);
    // The middle pixel looks along x and meets the ball at (−1, 0, 0); the corner misses.
    let at = |name: &str, pixel: usize| channel(&place.path("b.exr"), name)[pixel];
    let middle = 16 * 33 + 16;
    assert!((at("Z", middle) - 4.0).abs() < 1e-6);
    assert!((at("N.X", middle) + 1.0).abs() < 1e-6);
    assert_eq!([at("part", middle), at("A", middle), at("certificate", middle)], [0.0, 1.0, 1.0]);
    assert_eq!([at("Z", 0), at("N.X", 0), at("part", 0), at("A", 0)], [f32::INFINITY, 0.0, -1.0, 0.0]);
}

#[test]
fn stats_are_readable() {
    let place = Place::new();
    let run = place.run(&["render", "-e", BALL, "-o", "b.png", "--size", "8x8", "--stats", "s.json"], "");
    assert_eq!(run.code, 0, "{}", run.err);
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("s.json")).unwrap()).unwrap();
    let count = |name: &str| stats[name].as_u64().unwrap();
    assert_eq!(count("certified") + count("tolerance") + count("undecided"), 64);
    assert!(count("rays") >= 64 && count("evaluations") > 0 && count("hits") > 10);
    assert!(stats["bounds"][0].as_f64().unwrap() < -1.0);
}

#[test]
fn values_may_begin_with_a_minus() {
    let place = Place::new();
    let bounds = "-0.5,-0.5,-0.5,0.5,0.5,0.5";
    let spaced = ["--eye", "-3,-2,-1", "--target", "-.1,0,0", "--up", "-1,0,1", "--bounds", bounds];
    let joined = ["--eye=-3,-2,-1", "--target=-.1,0,0", "--up=-1,0,1", "--bounds=-0.5,-0.5,-0.5,0.5,0.5,0.5"];
    let mut pictures = Vec::new();
    for (name, options) in [("a.exr", spaced.as_slice()), ("b.exr", &joined)] {
        let mut arguments = vec!["render", "-e", "-x*0 + x^2 + y^2 + z^2 - 1", "-o", name, "--size", "9x9"];
        arguments.extend(options);
        let run = place.run(&arguments, "");
        assert_eq!(run.code, 0, "{}", run.err);
        pictures.push(channel(&place.path(name), "Z"));
    }
    assert!(pictures[0][40].is_finite());
    assert_eq!(pictures[0], pictures[1]);
}

#[test]
fn every_method_sees_the_ball() {
    let place = Place::new();
    let methods: [(&[&str], bool); 4] = [
        (&["--method", "affine"], true),
        (&["--method", "interval"], true),
        (&["--method=interval", "--accept-epsilon=0.01"], false),
        (&["--method", "sampled", "--step", "0.01"], false),
    ];
    for (options, certified) in methods {
        let mut arguments = vec!["render", "-e", BALL, "-o", "b.exr", "--size", "5x5", "--eye", "1,-5,2"];
        arguments.extend(options);
        let run = place.run(&arguments, "");
        assert_eq!(run.code, 0, "{}", run.err);
        let depth = channel(&place.path("b.exr"), "Z")[12];
        assert!((depth - (30_f32.sqrt() - 1.0)).abs() < 0.03, "{options:?}: {depth}");
        let certificate = channel(&place.path("b.exr"), "certificate")[12];
        assert_eq!(certificate == 1.0, certified, "{options:?}: {certificate}");
    }
}

#[test]
fn warnings_go_to_standard_error_and_are_silenced() {
    let place = Place::new();
    let run = place.run(&["render", "-e", "x", "-o", "x.png", "--size", "4x4"], "");
    assert_eq!(run.code, 0);
    assert!(run.err.starts_with("warning: no end of the solid"), "{}", run.err);
    let run = place.run(&["render", "-e", "x", "-o", "x.png", "--size", "4x4", "--quiet"], "");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
    // Those that an error follows, too.
    place.file("both.vm", "_0 var-x\n_0 var-y\n_1 nothing _0\n");
    let loud = place.run(&["render", "both.vm", "-o", "b.png"], "");
    assert!(loud.err.contains("warning: ") && loud.err.contains("error: "), "{}", loud.err);
    let quiet = place.run(&["render", "both.vm", "-o", "b.png", "--quiet"], "");
    assert_eq!(quiet.code, 1);
    assert!(!quiet.err.contains("warning: ") && quiet.err.contains("error: "), "{}", quiet.err);
}

#[test]
fn errors_leave_no_file() {
    let place = Place::new();
    let cases: [(&[&str], i32, &str); 19] = [
        (&["-o", "b.jpg"], 2, ".png or .exr"),
        (&["-o", "b.png", "--threads", "-1"], 2, "-1 is not in 1..=65535"),
        (&["-o", "b.png", "--fuel", "-1"], 2, "-1 is not in 1..=4294967295"),
        (&["-o", "b.png", "--tolerance", "2"], 2, "the tolerance is at most 0.5 of the longest side"),
        (&["-o", "no/b.png"], 1, "there is no folder no"),
        (&["-o", "b.png", "--stats", "no/s.json"], 1, "there is no folder no"),
        (&["-o", "b.png", "--size", "0x5"], 2, "0x5"),
        (&["-o", "b.png", "--size", "100000x100000"], 2, "100000x100000"),
        (&["-o", "b.png", "--size", "-5x5"], 2, "size"),
        (&["-o", "b.png", "--eye", "1,2"], 2, "3 numbers"),
        (&["-o", "b.png", "--fov", "180"], 2, "between 0 and 180"),
        (&["-o", "b.png", "--fov", "-20"], 2, "between 0 and 180"),
        (&["-o", "b.png", "--ortho", "0"], 2, "positive"),
        (&["-o", "b.png", "--fov", "20", "--ortho", "2"], 2, "cannot be used with"),
        (&["-o", "b.png", "--eye", "0,0,5", "--up", "0,0,1"], 2, "along the view"),
        (&["-o", "b.png", "--bounds", "1,0,0,0,1,1"], 2, "empty along x"),
        (&["-o", "b.png", "--samples", "0"], 2, "samples"),
        (&["-o", "b.png", "--step", "0.1"], 2, "--method sampled"),
        (&["-o", "b.png", "--coord", "1=0"], 2, "axis of the picture"),
    ];
    for (options, code, message) in cases {
        let mut arguments = vec!["render", "-e", BALL];
        arguments.extend(options);
        let run = place.run(&arguments, "");
        assert_eq!(run.code, code, "{options:?}: {}", run.err);
        assert!(run.err.contains(message), "{options:?}: {}", run.err);
        assert_eq!(run.out, "");
        assert!(place.files().is_empty(), "{options:?}: {:?}", place.files());
    }
    place.file("bad.txt", "x +* y");
    let run = place.run(&["render", "bad.txt", "-o", "b.png"], "");
    assert_eq!(run.code, 1);
    assert!(run.err.contains("bad.txt:1:4"), "{}", run.err);
    assert_eq!(place.files(), ["bad.txt"]);
}
