//! Surfaces without an inside: double roots, and what only comes close to one.

use fieldstone_field::*;
use fieldstone_trace::*;

fn tape(build: impl FnOnce(&mut Graph, [NodeId; 3]) -> NodeId) -> Tape {
    let mut g = Graph::new();
    let point = [0, 1, 2].map(|i| g.input(Input::Coordinate(i)));
    let value = build(&mut g, point);
    let options = TapeOptions { reading: Reading::Sign, ..TapeOptions::default() };
    Tape::new(&Field::new(g, value, Vec::new()), &options)
}

/// |x|² − 1.
fn ball(g: &mut Graph, point: [NodeId; 3]) -> NodeId {
    let squares = point.map(|c| g.square(c));
    let sum = g.add(squares[0], squares[1]);
    let sum = g.add(sum, squares[2]);
    let one = g.constant(1.0);
    g.sub(sum, one)
}

/// (|x|² − 1)².
fn squared_ball() -> Tape {
    tape(|g, p| {
        let ball = ball(g, p);
        g.square(ball)
    })
}

/// The same below 0.
fn negative_ball() -> Tape {
    tape(|g, p| {
        let ball = ball(g, p);
        let square = g.square(ball);
        g.neg(square)
    })
}

/// The same, multiplied out: s² − 2s + 1 with s = |x|², which loses half of the digits near 0.
fn expanded_ball() -> Tape {
    tape(|g, p| {
        let (ball, one, two) = (ball(g, p), g.constant(1.0), g.constant(2.0));
        let s = g.add(ball, one);
        let (square, double) = (g.mul(s, s), g.mul(two, s));
        let difference = g.sub(square, double);
        g.add(difference, one)
    })
}

/// Steiner's surface x²y² + y²z² + z²x² + xyz, with three double lines along the axes.
fn steiner() -> Tape {
    tape(|g, [x, y, z]| {
        let mut sum = g.mul(x, y);
        sum = g.mul(sum, z);
        for (a, b) in [(x, y), (y, z), (z, x)] {
            let product = g.mul(a, b);
            let square = g.square(product);
            sum = g.add(sum, square);
        }
        sum
    })
}

fn settings(method: Method, tolerance: f64) -> Settings {
    Settings { method, tolerance, surface: true, ..Settings::new(6.0) }
}

fn methods() -> [Settings; 3] {
    [
        settings(Method::Affine, Settings::TOLERANCE),
        settings(Method::Interval { accept_epsilon: None }, 1e-6),
        settings(Method::Sampled { step: 0.02 }, 1e-6),
    ]
}

fn along_x(y: f64) -> Ray {
    Ray { origin: [-3.0, y, 0.0], direction: [1.0, 0.0, 0.0], start: 0.0, end: 6.0 }
}

fn trace(tape: &Tape, ray: Ray, settings: &Settings) -> Outcome {
    Tracer::new().first_hits(tape, &[ray], settings)[0]
}

#[test]
fn double_roots_are_hit_where_they_are() {
    for (i, settings) in methods().iter().enumerate() {
        for (tape, error) in [(squared_ball(), 1e-11), (negative_ball(), 1e-11), (expanded_ball(), 1e-6)] {
            for y in [0.0, 0.3, 0.6, 0.99] {
                let outcome = trace(&tape, along_x(y), settings);
                let hit = outcome.hit.expect("the ray goes through the sphere");
                let t = 3.0 - (1.0 - y * y).sqrt();
                assert!((hit.t - t).abs() < error / (1.0 - y), "method {i}, y = {y}: {} is not {t}", hit.t);
                assert!(hit.touching && hit.before < t && hit.after >= hit.t, "{hit:?}");
                // Plain intervals run out of fuel where the field is multiplied out.
                let fuel_lasts = i != 1 || error < 1e-9;
                assert!(outcome.certificate > Certificate::Certified, "{outcome:?}");
                assert!(!fuel_lasts || outcome.certificate == Certificate::Tolerance, "{outcome:?}");
                assert!(!fuel_lasts || outcome.cost < 400, "method {i}, y = {y}: {}", outcome.cost);
            }
        }
    }
}

#[test]
fn what_passes_a_double_root_by_more_than_rounding_misses() {
    for settings in &methods()[..2] {
        for above in [1e-12, 1e-9, 1e-6, 1e-3] {
            let outcome = trace(&squared_ball(), along_x(1.0 + above), settings);
            assert_eq!(outcome.hit, None, "{above} above the sphere");
        }
        // Multiplied out, values near 0 are rounded to 10⁻¹⁶: to 10⁻⁸ of the distance.
        assert_eq!(trace(&expanded_ball(), along_x(1.0 + 1e-6), settings).hit, None);
    }
}

#[test]
fn changes_of_sign_stay_certified() {
    let ball = tape(ball);
    for surface in [false, true] {
        let settings = Settings { surface, ..Settings::new(6.0) };
        let outcome = trace(&ball, along_x(0.5), &settings);
        let hit = outcome.hit.expect("the ray goes through the ball");
        assert!((hit.t - (3.0 - 0.75f64.sqrt())).abs() < 1e-8 && !hit.touching);
        assert_eq!(outcome.certificate, Certificate::Certified);
        assert_eq!(trace(&ball, along_x(1.001), &settings).certificate, Certificate::Certified);
    }
}

#[test]
fn a_solid_has_no_double_roots() {
    for settings in &methods() {
        let outcome = trace(&squared_ball(), along_x(0.3), &Settings { surface: false, ..*settings });
        assert_eq!(outcome.hit, None);
    }
}

/// The lines of Steiner's surface are double where sheets cross, for |x| < ½, and stand alone beyond: only a ray that
/// meets them meets anything there.
#[test]
fn lines_that_stand_alone_are_not_thickened() {
    let down =
        |x: f64, y: f64| Ray { origin: [x, y, 3.0], direction: [0.0, 0.0, -1.0], start: 0.0, end: 6.0 };
    let steiner = steiner();
    for settings in &methods()[..2] {
        for x in [0.6, 0.8, 1.0] {
            let through = trace(&steiner, down(x, 0.0), settings).hit.expect("it meets the line");
            assert!((through.t - 3.0).abs() < 1e-6 && through.touching);
            for beside in [1e-9, 1e-6, 1e-3, 0.05] {
                assert_eq!(trace(&steiner, down(x, beside), settings).hit, None, "{beside} beside x = {x}");
            }
        }
        // x²y² + y²z² + z²x² + xyz = 0 for z; the roots are real and simple.
        let (x, y): (f64, f64) = (0.3, 0.1);
        let (a, b, c) = (x * x + y * y, x * y, x * x * y * y);
        let z = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
        let outcome = trace(&steiner, down(x, y), settings);
        let hit = outcome.hit.expect("there are two sheets");
        assert!((hit.t - (3.0 - z)).abs() < 1e-5 && !hit.touching, "{hit:?}");
        assert_eq!(outcome.certificate, Certificate::Certified);
    }
}

#[test]
fn double_planes_are_hit_from_both_sides() {
    let plane = tape(|g, [_, _, z]| g.square(z));
    for (z, direction) in [(2.0, -1.0), (-2.0, 1.0)] {
        for settings in methods() {
            let slope = [0.6, 0.0, 0.8 * direction];
            let ray = Ray { origin: [0.1, 0.2, z], direction: slope, start: 0.0, end: 4.0 };
            let hit = trace(&plane, ray, &settings).hit.expect("it crosses the plane");
            assert!((hit.t - 2.5).abs() < 1e-9 && hit.touching, "{hit:?}");
            let away = Ray { direction: slope.map(|d| -d), ..ray };
            assert_eq!(trace(&plane, away, &settings).hit, None);
        }
    }
}

/// Where a stretch ends at a double root, or as close to it as rounding, one of its two neighbours has the root.
#[test]
fn no_double_root_is_lost_between_two_stretches() {
    let d: [f64; 3] = [-0.247_482_532_533_820_05, 0.639_041_972_999_950_9, -0.728_270_384_428_048];
    let whole = Ray { origin: [1.92, -2.4, 2.56], direction: d, start: 3.0, end: 4.5 };
    for (tape, error) in [(squared_ball(), 1e-11), (expanded_ball(), 1e-6)] {
        for settings in &methods()[..2] {
            let settings = Settings { size: 2.2, ..*settings };
            let t = trace(&tape, whole, &settings).hit.expect("it goes through the sphere").t;
            for k in -60_i32..=60 {
                let apart = f64::from(k) * 10f64.powi(k.abs() / 6 - 17);
                let cut = t + apart;
                let parts = [Ray { end: cut, ..whole }, Ray { start: cut, ..whole }];
                let hits = parts.map(|ray| trace(&tape, ray, &settings).hit.map(|h| h.t));
                let first = hits[0].or(hits[1]).expect("one of them has the root");
                assert!((first - t).abs() < error, "{settings:?} cut {apart:e} behind: {first} is not {t}");
            }
        }
    }
}

/// A root that a span ends at exactly.
#[test]
fn simple_roots_at_the_ends_of_spans_are_certified() {
    let plane = tape(|_, [x, ..]| x);
    for settings in &methods()[..2] {
        for direction in [1.0, -1.0] {
            let origin = [-4.0 * direction, 0.0, 0.0];
            for end in [8.0, 16.0, 4.5] {
                let ray = Ray { origin, direction: [direction, 0.0, 0.0], start: 0.0, end };
                let outcome = trace(&plane, ray, settings);
                assert_eq!(outcome.hit.map(|h| (h.t - 4.0).abs() < 1e-6), Some(true), "{outcome:?}");
                assert_eq!(outcome.certificate, Certificate::Certified, "{outcome:?}");
            }
        }
    }
}

#[test]
fn a_region_of_zeros_begins_where_it_is_entered() {
    // max(x, 0)² is 0 for x ≤ 0.
    let half = tape(|g, [x, ..]| {
        let zero = g.constant(0.0);
        let positive = g.max(x, zero);
        g.square(positive)
    });
    let back = Ray { origin: [3.0, 0.0, 0.0], direction: [-1.0, 0.0, 0.0], start: 0.0, end: 6.0 };
    for settings in &methods()[..2] {
        let hit = trace(&half, back, settings).hit.expect("it enters the region");
        assert!((hit.t - 3.0).abs() < 1e-6, "{hit:?}");
        let inside = trace(&half, Ray { start: 4.0, ..back }, settings);
        assert_eq!(inside.hit.map(|h| h.t), Some(4.0));
        assert!(inside.cost < 200, "{}", inside.cost);
    }
}

#[test]
fn shadow_rays_leave_a_touched_surface_and_stop_at_the_next() {
    let sphere = squared_ball();
    for settings in &methods()[..2] {
        let hit = trace(&sphere, along_x(0.3), settings).hit.expect("the ray goes through the sphere");
        let any = Settings { any_hit: true, ..*settings };
        let origin = along_x(0.3).at(hit.before);
        let towards = |direction| Ray { origin, direction, start: 0.0, end: 6.0 };
        assert_eq!(trace(&sphere, towards([-1.0, 0.0, 0.0]), &any).hit, None);
        assert_eq!(trace(&sphere, towards([-0.6, 0.8, 0.0]), &any).hit, None);
        assert!(trace(&sphere, towards([1.0, 0.0, 0.0]), &any).hit.is_some());
    }
}

#[test]
fn poles_are_no_part_of_a_surface() {
    // 1/x − 1: a pole at 0, a root at 1; the ray starts at −3. And 1/x alone.
    let with = |shift: f64| {
        let mut g = Graph::new();
        let x = g.input(Input::Coordinate(0));
        let (inverse, shift) = (g.recip(x), g.constant(shift));
        let value = g.sub(inverse, shift);
        Field::new(g, value, Vec::new())
    };
    let methods = [
        Settings::new(6.0),
        Settings { method: Method::Interval { accept_epsilon: None }, tolerance: 1e-6, ..Settings::new(6.0) },
        Settings { method: Method::Sampled { step: 0.05 }, tolerance: 1e-6, ..Settings::new(6.0) },
    ];
    let ray = Ray { origin: [-3.0, 0.1, 0.2], direction: [1.0, 0.0, 0.0], start: 0.0, end: 6.01 };
    for settings in methods.map(|settings| Settings { surface: true, ..settings }) {
        for any_hit in [false, true] {
            let settings = Settings { any_hit, ..settings };
            let outcome = |field: &Field| {
                let options = TapeOptions { reading: Reading::Sign, ..TapeOptions::default() };
                Tracer::new().first_hits(&Tape::new(field, &options), &[ray], &settings)[0]
            };
            let nothing = outcome(&with(0.0));
            assert!(nothing.hit.is_none() && nothing.starts_inside && !nothing.ends_inside, "{nothing:?}");
            assert!(nothing.certificate > Certificate::Certified && nothing.cost < 1000, "{nothing:?}");
            let behind = outcome(&with(1.0)).hit.expect("the root behind the pole");
            assert!((behind.t - 4.0).abs() < 1e-4 && behind.entering, "{behind:?}");
            let before = outcome(&with(-1.0)).hit.expect("the root before the pole");
            assert!((before.t - 2.0).abs() < 1e-4 && before.entering, "{before:?}");
        }
    }
}
