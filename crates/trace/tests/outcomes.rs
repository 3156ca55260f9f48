//! What outcomes say: certificates, sides, jumps, undefined places, fuel.

use fieldstone_field::*;
use fieldstone_trace::*;

fn field(build: impl FnOnce(&mut Graph, [NodeId; 3]) -> NodeId) -> Field {
    let mut g = Graph::new();
    let point = [0, 1, 2].map(|i| g.input(Input::Coordinate(i)));
    let value = build(&mut g, point);
    Field::new(g, value, Vec::new())
}

/// |x|² − 1.
fn ball() -> Field {
    field(|g, [x, y, z]| {
        let squares = [x, y, z].map(|c| g.square(c));
        let sum = g.add(squares[0], squares[1]);
        let sum = g.add(sum, squares[2]);
        let one = g.constant(1.0);
        g.sub(sum, one)
    })
}

fn along_x(y: f64) -> Ray {
    Ray { origin: [-3.0, y, 0.0], direction: [1.0, 0.0, 0.0], start: 0.0, end: 6.0 }
}

fn first_hit(field: &Field, ray: Ray, settings: &Settings) -> Outcome {
    let field = field.clone().with_fuel(1000);
    let tape = Tape::new(&field, &TapeOptions { reading: Reading::Sign, ..TapeOptions::default() });
    Tracer::new().first_hits(&tape, &[ray], settings)[0]
}

fn methods() -> [Settings; 3] {
    let with = |method, tolerance| Settings { method, tolerance, ..Settings::new(6.0) };
    [
        Settings::new(6.0),
        with(Method::Interval { accept_epsilon: None }, 1e-6),
        with(Method::Sampled { step: 0.05 }, 1e-6),
    ]
}

/// A ray that touches the ball is decided by how closely one looks: a coarser tolerance is for shadows alone.
#[test]
fn coarse_shadows_cost_less_where_rays_graze() {
    let cost = |any_hit, tolerance| {
        let settings = Settings { any_hit, tolerance, ..Settings::new(6.0) };
        let outcome = first_hit(&ball(), along_x(1.0), &settings);
        assert!(outcome.hit.is_none() && outcome.certificate != Certificate::Certified);
        outcome.cost
    };
    let [fine, coarse] = [Settings::TOLERANCE, 1e-3].map(|tolerance| cost(true, tolerance));
    assert!(2 * coarse < fine, "{coarse} {fine}");
    assert_eq!(cost(false, Settings::TOLERANCE), fine);
    assert_eq!(cost(false, 1e-3), fine);
}

#[test]
fn every_method_finds_the_ball() {
    for settings in methods() {
        let outcome = first_hit(&ball(), along_x(0.5), &settings);
        let hit = outcome.hit.expect("the ray goes through the ball");
        let t = 3.0 - 0.75f64.sqrt();
        assert!((hit.t - t).abs() < 1e-5 && hit.before < t && t <= hit.after, "{hit:?}");
        assert!(hit.entering && !hit.jump && !outcome.starts_inside && !outcome.ends_inside);
        let miss = first_hit(&ball(), along_x(1.001), &settings);
        assert_eq!(miss.hit, None);
        let expected = match settings.method {
            Method::Sampled { .. } => Certificate::Tolerance,
            _ => Certificate::Certified,
        };
        assert_eq!((outcome.certificate, miss.certificate), (expected, expected));
        assert!(outcome.cost > 0);
    }
}

#[test]
fn from_inside_the_way_out_is_found() {
    for settings in methods() {
        let inside = Ray { start: 3.0, ..along_x(0.0) };
        let outcome = first_hit(&ball(), inside, &settings);
        assert!(outcome.starts_inside);
        let hit = outcome.hit.expect("the ray leaves the ball");
        assert!(!hit.entering && (hit.t - 4.0).abs() < 1e-5);
        let short = first_hit(&ball(), Ray { end: 3.5, ..inside }, &settings);
        assert!(short.hit.is_none() && short.ends_inside);
        // A cap needs no crossing.
        let capped = first_hit(&ball(), inside, &Settings { caps: true, ..settings });
        assert!(capped.starts_inside && capped.hit.is_none());
    }
}

#[test]
fn acceptance_at_epsilon_is_a_tolerance() {
    let method = Method::Interval { accept_epsilon: Some(0.01) };
    let settings = Settings { method, ..Settings::new(6.0) };
    let outcome = first_hit(&ball(), along_x(0.0), &settings);
    assert_eq!(outcome.certificate, Certificate::Tolerance);
    let t = outcome.hit.expect("the ray goes through the ball").t;
    assert!((t - 2.0).abs() < 0.02 && t != 2.0);
}

#[test]
fn a_tangent_is_no_crossing_and_is_not_certified() {
    // (x² + y² + z² − 1)² touches 0 without a change of sign.
    let sheet = field(|g, [x, y, z]| {
        let squares = [x, y, z].map(|c| g.square(c));
        let sum = g.add(squares[0], squares[1]);
        let sum = g.add(sum, squares[2]);
        let one = g.constant(1.0);
        let ball = g.sub(sum, one);
        g.square(ball)
    });
    for settings in &methods()[..2] {
        let outcome = first_hit(&sheet, along_x(0.3), settings);
        assert!(outcome.hit.is_none() && outcome.certificate > Certificate::Certified, "{outcome:?}");
        assert!(outcome.cost < 10_000);
    }
}

#[test]
fn jumps_and_poles_end_solids() {
    // floor(x) + ½ is negative for x < 0; 1/x likewise, with a pole.
    let step = field(|g, [x, ..]| {
        let (whole, half) = (g.floor(x), g.constant(0.5));
        g.add(whole, half)
    });
    let pole = field(|g, [x, ..]| g.recip(x));
    for f in [step, pole] {
        for settings in methods() {
            let back = Ray { origin: [3.0, 0.0, 0.0], direction: [-1.0, 0.0, 0.0], start: 0.0, end: 6.0 };
            let hit = first_hit(&f, back, &settings).hit.expect("x < 0 is inside");
            assert!(hit.entering && hit.jump && (hit.t - 3.0).abs() < 1e-5, "{hit:?}");
        }
    }
}

#[test]
fn undefined_is_outside_and_certified_where_that_is_certain() {
    // √x − 2 is undefined for x < 0 and negative up to 4.
    let root = field(|g, [x, ..]| {
        let (r, two) = (g.sqrt(x), g.constant(2.0));
        g.sub(r, two)
    });
    for settings in methods() {
        let outcome = first_hit(&root, along_x(0.0), &settings);
        let hit = outcome.hit.expect("the solid begins at 0");
        assert!(hit.entering && (hit.t - 3.0).abs() < 1e-4, "{hit:?}");
        assert_ne!(outcome.certificate, Certificate::Undecided);
        assert!(outcome.cost < 200, "{outcome:?}");
    }
}

#[test]
fn undefined_is_outside_and_undecided_where_nothing_is_certain() {
    // 0/0 for x < 0, and otherwise x/x·(x − 4): no domain says that there is no value.
    let quotient = field(|g, [x, ..]| {
        let (zero, four) = (g.constant(0.0), g.constant(4.0));
        let positive = g.max(x, zero);
        let (one, less) = (g.div(positive, positive), g.sub(x, four));
        g.mul(one, less)
    });
    for settings in methods() {
        let outcome = first_hit(&quotient, along_x(0.0), &settings);
        let hit = outcome.hit.expect("the solid begins at 0");
        assert!(hit.entering && (hit.t - 3.0).abs() < 1e-4, "{hit:?}");
        assert_eq!(outcome.certificate, Certificate::Undecided);
        assert!(outcome.cost < 3000);
    }
}

#[test]
fn flat_and_undefined_fields_are_empty_and_end() {
    let flat = field(|g, [x, ..]| {
        let (zero, half) = (g.constant(0.0), g.constant(0.5));
        let far = g.lt(half, x);
        let distance = g.sub(x, half);
        g.select(far, distance, zero)
    });
    let nothing = field(|g, [x, ..]| {
        let (minus, square) = (g.constant(-1.0), g.square(x));
        let negative = g.sub(minus, square);
        g.sqrt(negative)
    });
    for (f, certificate) in [(flat, Certificate::Undecided), (nothing, Certificate::Certified)] {
        for settings in &methods()[..2] {
            let outcome = first_hit(&f, along_x(0.2), settings);
            assert!(outcome.hit.is_none() && outcome.certificate == certificate, "{outcome:?}");
            assert!(outcome.cost < 20_000, "{outcome:?}");
        }
    }
}

/// Fields that are 0 all over, whether intervals know it (0, max(x, 0)) or not (x − x, 0·x).
#[test]
fn zeros_cost_little() {
    let fields = [
        field(|g, _| g.constant(0.0)),
        field(|g, [x, ..]| {
            let zero = g.constant(0.0);
            g.max(x, zero)
        }),
        field(|g, [x, y, _]| {
            let (sum, difference) = (g.add(x, y), g.sub(x, y));
            let (a, b) = (g.mul(sum, difference), g.mul(difference, sum));
            g.sub(a, b)
        }),
        field(|g, [x, ..]| {
            let zero = g.constant(0.0);
            g.mul(zero, x)
        }),
    ];
    for f in fields {
        for settings in &methods()[..2] {
            let back = Ray { origin: [3.0, 0.1, 0.2], direction: [-1.0, 0.0, 0.0], start: 0.0, end: 6.0 };
            let outcome = first_hit(&f, back, settings);
            assert!(outcome.hit.is_none() && outcome.certificate == Certificate::Undecided, "{outcome:?}");
            assert!(outcome.cost < 2500, "{outcome:?}");
        }
    }
}

/// Steps that do not even move a place in double precision: the ray ends all the same, and says so.
#[test]
fn tiny_steps_end_undecided() {
    let settings = Settings { method: Method::Sampled { step: 1e-17 }, ..Settings::new(6.0) };
    let outcome = first_hit(&ball(), along_x(0.0), &settings);
    assert!(outcome.hit.is_none() && outcome.certificate == Certificate::Undecided, "{outcome:?}");
}

/// Widths that no span of a ray can have: the smallest counts.
#[test]
fn tiny_accepted_widths_end() {
    let method = Method::Interval { accept_epsilon: Some(1e-300) };
    let outcome = first_hit(&ball(), along_x(0.0), &Settings { method, ..Settings::new(6.0) });
    assert!(outcome.hit.is_some_and(|hit| (hit.t - 2.0).abs() < 1e-6), "{outcome:?}");
}

#[test]
fn black_boxes_are_undecided() {
    let ball = Field::from_fn(|p| p.iter().map(|c| c * c).sum::<f64>() - 1.0);
    let settings = methods()[2];
    let hit = first_hit(&ball, along_x(0.0), &settings);
    assert!((hit.hit.expect("there is a ball").t - 2.0).abs() < 1e-5);
    assert_eq!(hit.certificate, Certificate::Undecided);
    assert_eq!(first_hit(&ball, along_x(2.0), &settings).certificate, Certificate::Undecided);
}

#[test]
fn a_bundle_is_its_rays() {
    let rays: Vec<Ray> = (0..200).map(|i| along_x(-1.3 + 0.013 * f64::from(i))).collect();
    let tape = Tape::new(&ball(), &TapeOptions { reading: Reading::Sign, ..TapeOptions::default() });
    for settings in methods() {
        let together = Tracer::new().first_hits(&tape, &rays, &settings);
        for (ray, outcome) in rays.iter().zip(&together) {
            let alone = Tracer::new().first_hits(&tape, &[*ray], &settings)[0];
            assert_eq!(alone.certificate, outcome.certificate, "{ray:?}");
            match (alone.hit, outcome.hit) {
                (Some(a), Some(b)) => assert!((a.t - b.t).abs() < 1e-5),
                (a, b) => assert_eq!(a.is_some(), b.is_some(), "{ray:?}"),
            }
        }
    }
}

#[test]
fn loops_that_do_not_end_cost_a_ray_little() {
    let mut g = Graph::new();
    let x = g.input(Input::Coordinate(0));
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let endless = g.begin_loop(&[one], None);
    let v = g.loop_var(endless, 0);
    let holds = g.lt(zero, x);
    let next = g.add(v, one);
    let out = g.end_loop(endless, holds, &[next]);
    let field = Field::new(g, out[0], Vec::new());
    for settings in methods() {
        let outcome = first_hit(&field, along_x(0.0), &settings);
        assert_eq!((outcome.hit, outcome.certificate), (None, Certificate::Undecided), "{settings:?}");
        assert!(outcome.cost < 300, "{} evaluations, {settings:?}", outcome.cost);
    }
}

/// Where 1/x is, the range of max(x, 1/x) is open to one side.
#[test]
fn ranges_open_to_one_side_exclude_nothing() {
    let peak = field(|g, [x, ..]| {
        let (reciprocal, limit) = (g.recip(x), g.constant(1.5));
        let larger = g.max(x, reciprocal);
        g.sub(larger, limit)
    });
    for settings in methods() {
        // From −3 on, 1/x is below 1.5 all the way to 0: the ray starts inside and leaves at the pole.
        let outcome = first_hit(&peak, along_x(0.0), &settings);
        let hit = outcome.hit.expect("the solid ends at the pole");
        assert!(outcome.starts_inside && !hit.entering && (hit.t - 3.0).abs() < 1e-4, "{outcome:?}");
        // Beyond the pole it begins again at 2/3.
        let behind = Ray { start: 3.01, ..along_x(0.0) };
        let hit = first_hit(&peak, behind, &settings).hit.expect("the solid begins again");
        assert!(hit.entering && (hit.t - 3.0 - 2.0 / 3.0).abs() < 1e-4, "{hit:?}");
        // Seen from the other side, in one span across everything.
        let across = Ray { origin: [2.0, 0.0, 0.0], direction: [-1.0, 0.0, 0.0], start: 0.0, end: 6.0 };
        let hit = first_hit(&peak, across, &settings).hit.expect("from 1.5 on it is solid");
        assert!(hit.entering && (hit.t - 0.5).abs() < 1e-4, "{hit:?}");
    }
}

#[test]
fn rays_from_very_far_end() {
    for settings in methods() {
        let far =
            Ray { origin: [-1e13, 0.1, 0.0], direction: [1.0, 0.0, 0.0], start: 1e13 - 3.0, end: 1e13 + 3.0 };
        let outcome = first_hit(&ball(), far, &settings);
        assert!(outcome.cost < 20_000, "{outcome:?}");
    }
}
