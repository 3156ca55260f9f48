use super::*;
use fieldstone_lang::{Source, parse_formula};
use std::f64::consts::PI;

fn field(text: &str) -> Field {
    parse_formula(&Source::new("formula", text)).unwrap().field
}

fn options(tolerance: f64, operations: u64) -> MeasureOptions {
    MeasureOptions { tolerance, operations }
}

fn measured(text: &str, bounds: Corners, tolerance: f64) -> Measures {
    measure(&field(text), &Bindings::new(), bounds, &options(tolerance, 400_000_000)).unwrap()
}

fn cube(half: f64) -> Corners {
    ([-half; 3], [half; 3])
}

fn holds(enclosure: &Enclosure, value: f64) -> bool {
    enclosure.lower <= value && value <= enclosure.upper
}

/// Holds the value, and no more than a part `within` of it besides.
fn is_tight(enclosure: &Enclosure, value: f64, within: f64) -> bool {
    holds(enclosure, value) && enclosure.width() <= within * value
}

/// Random numbers from 0 to 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

#[test]
fn comparers_reject_what_is_wrong() {
    let ball = measured("x^2 + y^2 + z^2 - 1", cube(1.5), 0.01);
    assert!(!holds(&ball.volume, 4.0) && !holds(&ball.area, 12.0));
    assert!(!is_tight(&ball.volume, 4.0 / 3.0 * PI, 1e-6));
}

#[test]
fn a_ball() {
    let ball = measured("(x - 0.3)^2 + y^2 + z^2 - 1", cube(1.5), 2e-3);
    assert!(ball.reached);
    assert!(is_tight(&ball.volume, 4.0 / 3.0 * PI, 2e-3), "{ball:?}");
    assert!(is_tight(&ball.area, 4.0 * PI, 2e-3), "{ball:?}");
    let centroid = ball.centroid.unwrap();
    assert!(holds(&centroid[0], 0.3) && centroid[0].width() < 2e-3, "{ball:?}");
    assert!(holds(&centroid[1], 0.0) && holds(&centroid[2], 0.0));
    let ((outer_lo, outer_hi), (inner_lo, inner_hi)) = (ball.outer.unwrap(), ball.inner.unwrap());
    for (axis, centre) in [0.3, 0.0, 0.0].into_iter().enumerate() {
        let (lo, hi) = (centre - 1.0, centre + 1.0);
        assert!(outer_lo[axis] <= lo && lo - outer_lo[axis] < 1e-3);
        assert!(outer_hi[axis] >= hi && outer_hi[axis] - hi < 1e-3);
        assert!(inner_lo[axis] >= lo && inner_lo[axis] - lo < 1e-3);
        assert!(inner_hi[axis] <= hi && hi - inner_hi[axis] < 1e-3);
    }
}

#[test]
fn what_has_no_value_is_not_measured() {
    let nothing = measured("sqrt(-1 - x^2)", cube(10.0), 1e-3);
    assert_eq!((nothing.volume, nothing.undefined), (Enclosure { lower: 0.0, upper: 0.0 }, 0.0));
    // Half of a ball.
    let half = measured("x^2 + y^2 + z^2 - 1 + 0*sqrt(x)", cube(1.5), 1e-2);
    assert!(is_tight(&half.volume, 2.0 / 3.0 * PI, 2e-2), "{half:?}");
    assert_eq!(half.undefined, 0.0);
}

/// The bounds hold however little work went into them, and close with the square of the cells' size.
#[test]
fn bounds_hold_at_every_effort() {
    let solids = [
        ("x^2 + y^2 + z^2 - 1", 4.0 / 3.0 * PI, 4.0 * PI),
        ("(1 - sqrt(x^2 + y^2))^2 + z^2 - 0.125", 2.0 * PI * PI * 0.125, 4.0 * PI * PI * 0.125f64.sqrt()),
        ("max(abs(x) - 1, max(abs(y) - 0.5, abs(z) - 0.7))", 8.0 * 0.35, 8.0 * (0.5 + 0.7 + 0.35)),
        ("max(x^2 + y^2 - 1, abs(z) - 0.5)", PI, 4.0 * PI),
        ("rinter(x^2 + y^2 - 1, z^2 - 0.25)", PI, 4.0 * PI),
        ("0 - min(1 - x^2 - y^2, 0.5 - abs(z))", PI, 4.0 * PI),
    ];
    for (text, volume, area) in solids {
        let field = field(text);
        let mut widths = Vec::new();
        for operations in [0, 100_000, 1_000_000, 10_000_000, 100_000_000] {
            let found = measure(&field, &Bindings::new(), cube(1.6), &options(1e-9, operations)).unwrap();
            assert!(holds(&found.volume, volume) && holds(&found.area, area), "{text}: {found:?}");
            assert!(found.centroid.is_none_or(|c| c.iter().all(|c| holds(c, 0.0))), "{text}: {found:?}");
            widths.push(found.volume.width() / volume);
        }
        assert!(widths.windows(2).all(|w| w[1] <= w[0]), "{text}: {widths:?}");
        assert!(widths[4] < 0.02, "{text}: {widths:?}");
    }
}

#[test]
fn an_ellipsoid() {
    // The area of an oblate spheroid with half axes 2, 2, 1.
    let e = (1.0f64 - 0.25).sqrt();
    let area = 2.0 * PI * 4.0 * (1.0 + (1.0 - e * e) / e * e.atanh());
    let found = measured("0.25*x^2 + 0.25*y^2 + z^2 - 1", cube(2.5), 3e-3);
    assert!(is_tight(&found.volume, 16.0 / 3.0 * PI, 3e-3), "{found:?}");
    assert!(is_tight(&found.area, area, 3e-3), "{found:?}");
}

/// x²/9 + y²/4 + z² = 1 as an integral over the angles, by the midpoint rule, which is as good as exact here.
#[test]
fn an_ellipsoid_of_three_axes() {
    let [a, b, c] = [3.0, 2.0, 1.0f64];
    let n = 400;
    let mut area = 0.0;
    for i in 0..n {
        let theta = PI * (f64::from(i) + 0.5) / f64::from(n);
        for j in 0..n {
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(n);
            let (s, t) = (theta.sin(), theta.cos());
            let across = (s * phi.cos() / a).powi(2) + (s * phi.sin() / b).powi(2) + (t / c).powi(2);
            area += a * b * c * across.sqrt() * s * 2.0 * PI * PI / f64::from(n * n);
        }
    }
    let found = measured("x^2/9 + y^2/4 + z^2 - 1", cube(3.2), 5e-3);
    assert!(is_tight(&found.volume, 4.0 / 3.0 * PI * a * b * c, 5e-3), "{found:?}");
    assert!(is_tight(&found.area, area, 5e-3), "{found:?}");
}

#[test]
fn a_lens_and_what_is_around_it() {
    // Two unit balls whose centres are 1 apart: caps of height 1/2.
    let cap = PI * 0.25 / 3.0 * 2.5;
    let (ball, half) = (4.0 / 3.0 * PI, "(x - 0.5)^2 + y^2 + z^2 - 1, (x + 0.5)^2 + y^2 + z^2 - 1");
    let lens = measured(&format!("max({half})"), cube(1.7), 5e-3);
    assert!(is_tight(&lens.volume, 2.0 * cap, 5e-3), "{lens:?}");
    // The caps have the area 2π·1/2 each.
    assert!(is_tight(&lens.area, 2.0 * PI, 1e-2), "{lens:?}");
    for name in ["min", "runion"] {
        let both = measured(&format!("{name}({half})"), cube(1.7), 5e-3);
        assert!(is_tight(&both.volume, 2.0 * ball - 2.0 * cap, 5e-3), "{both:?}");
        assert!(is_tight(&both.area, 8.0 * PI - 2.0 * PI, 1e-2), "{both:?}");
    }
}

#[test]
fn faces_of_the_box_are_volume_but_no_area() {
    let found = measured("x^2 + y^2 - 1", ([-2.0, -2.0, 0.25], [2.0, 2.0, 1.0]), 3e-3);
    assert!(is_tight(&found.volume, 0.75 * PI, 3e-3), "{found:?}");
    assert!(is_tight(&found.area, 1.5 * PI, 2e-2), "{found:?}");
    assert!(holds(&found.centroid.unwrap()[2], 0.625));
    let all = measured("x - 5", cube(1.0), 1e-3);
    assert!(is_tight(&all.volume, 8.0, 1e-12) && all.area == Enclosure { lower: 0.0, upper: 0.0 });
    assert_eq!((all.outer, all.inner), (Some(cube(1.0)), Some(cube(1.0))));
}

#[test]
fn surfaces_that_lie_in_faces_of_cells_count_once() {
    let found = measured("max(abs(x) - 1, max(abs(y) - 1, abs(z) - 1))", cube(2.0), 1e-3);
    assert!(is_tight(&found.volume, 8.0, 1e-3), "{found:?}");
    assert!(is_tight(&found.area, 24.0, 1e-3), "{found:?}");
    let half = measured("x", cube(1.0), 1e-3);
    assert!(is_tight(&half.area, 4.0, 1e-3) && is_tight(&half.volume, 4.0, 1e-3), "{half:?}");
}

#[test]
fn a_piece_of_a_gyroid_against_random_points() {
    let text = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) - 0.3";
    let found = measured(text, ([0.0; 3], [3.0, 4.0, 5.0]), 5e-3);
    let (mut state, mut inside, count) = (3, 0u32, 400_000u32);
    for _ in 0..count {
        let [x, y, z] = [3.0, 4.0, 5.0].map(|side| side * random(&mut state));
        let value: f64 = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos() - 0.3;
        inside += u32::from(value < 0.0);
    }
    let share = f64::from(inside) / f64::from(count);
    let five_deviations = 5.0 * (share * (1.0 - share) / f64::from(count)).sqrt();
    let (lo, hi) = (60.0 * (share - five_deviations), 60.0 * (share + five_deviations));
    assert!(found.volume.lower < hi && found.volume.upper > lo, "{found:?} {lo} {hi}");
    assert!(found.volume.width() < 5e-3 * found.volume.lower && found.area.upper.is_finite());
}

/// Steps have slope 0 almost everywhere; the mean-value theorem must not be applied to them.
#[test]
fn steps_are_not_smooth() {
    // Negative for x < 0.3.
    let step = measured("floor(x + 0.7) - 0.5", cube(1.0), 1e-3);
    assert!(is_tight(&step.volume, 4.0 * 1.3, 4e-3), "{step:?}");
    assert_eq!(step.area.upper, f64::INFINITY);
    let choice = measured("if(x < 0.3, 0 - 1 - x, 1 + y/10)", cube(0.9), 2e-3);
    assert!(is_tight(&choice.volume, 1.8 * 1.8 * 1.2, 5e-3), "{choice:?}");
    let sawtooth = measured("mod(x, 0.5) - 0.25", ([0.0; 3], [1.0; 3]), 1e-3);
    assert!(is_tight(&sawtooth.volume, 0.5, 3e-2), "{sawtooth:?}");
    // Negative below the x axis; the angle jumps at negative x.
    let angle = measured("atan2(y, x)", cube(1.0), 2e-2);
    assert!(is_tight(&angle.volume, 4.0, 2e-2), "{angle:?}");
}

#[test]
fn a_cone_with_its_tip() {
    let cone = measured("max(sqrt(x^2 + y^2) - z, z - 1)", cube(1.2), 3e-3);
    assert!(is_tight(&cone.volume, PI / 3.0, 5e-3), "{cone:?}");
    let area = PI * 2f64.sqrt() + PI;
    assert!(is_tight(&cone.area, area, 3e-2), "{cone:?}");
}

#[test]
fn what_is_undefined_may_be_inside() {
    // Defined for x > 0, where it is negative below x = 0.25; a quotient has no domain that is known.
    let found = measured("x - 0.25 + 0*max(x, 0)/max(x, 0)", ([-0.5, 0.0, 0.0], [0.5, 1.0, 1.0]), 1e-2);
    assert!(found.volume.lower < 0.25 && 0.24 < found.volume.lower, "{found:?}");
    assert!(found.volume.upper > 0.75 && found.undefined > 0.5, "{found:?}");
    assert!(!found.reached && found.area.upper.is_infinite());
}

#[test]
fn nothing_is_certain_to_be_nothing() {
    let found = measured("x^2 + y^2 + z^2 + 1", cube(1.0), 1e-3);
    assert_eq!(found.volume, Enclosure { lower: 0.0, upper: 0.0 });
    assert_eq!((found.outer, found.inner, found.centroid), (None, None, None));
    assert!(found.reached);
}

#[test]
fn only_boxes_can_be_measured() {
    let field = field("x");
    let of = |lo, hi| measure(&field, &Bindings::new(), (lo, hi), &MeasureOptions::default());
    assert_eq!(of([0.0; 3], [0.0; 3]), None);
    assert_eq!(of([f64::NAN; 3], [1.0; 3]), None);
    assert_eq!(of([-f64::MAX; 3], [f64::MAX; 3]), None);
}

#[test]
fn far_away_and_tiny() {
    let found =
        measured("(x - 1000)^2 + y^2 + z^2 - 0.0001", ([999.9, -0.1, -0.1], [1000.1, 0.1, 0.1]), 1e-2);
    assert!(is_tight(&found.volume, 4.0 / 3.0 * PI * 1e-6, 1e-2), "{found:?}");
    assert!(is_tight(&found.area, 4.0 * PI * 1e-4, 1e-2), "{found:?}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let field = field("(1 - sqrt(x^2 + y^2))^2 + z^2 - 0.125");
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| measure(&field, &Bindings::new(), cube(1.6), &options(1e-2, 50_000_000)))
    };
    assert_eq!(with(1), with(3));
}
