//! The ellipsoid's distance and the SARDF intersection.

use super::super::ellipsoid::ELLIPSOID;
use super::super::sardf::{EXACT, SNAPPING};
use super::{Given, Random, check_gradient, check_inclusion, value};
use fieldstone_field::{Function, Interval};

const ELLIPSOIDS: [(f64, f64); 6] =
    [(-3.0, 3.0), (-3.0, 3.0), (-3.0, 3.0), (0.2, 3.0), (0.2, 3.0), (0.2, 3.0)];

fn ellipsoid(p: [f64; 3], e: [f64; 3]) -> f64 {
    ELLIPSOID.value(&[p, e].concat())
}

fn point_on(e: [f64; 3], random: &mut Random) -> ([f64; 3], [f64; 3]) {
    let (height, turn) = (random.between(-1.0, 1.0), random.between(0.0, std::f64::consts::TAU));
    let ring = (1.0 - height * height).sqrt();
    let sphere = [ring * turn.cos(), ring * turn.sin(), height];
    let gradient = [0, 1, 2].map(|k| sphere[k] / e[k]);
    let length = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    ([0, 1, 2].map(|k| sphere[k] * e[k]), gradient.map(|g| g / length))
}

#[test]
fn a_point_moved_along_the_normal_lies_at_that_distance_from_the_ellipsoid() {
    let mut random = Random(3);
    for _ in 0..3000 {
        let e = random.point([(0.05, 4.0); 3]);
        let (p, n) = point_on(e, &mut random);
        // No closer to the inside than the smallest radius of curvature.
        let smallest = e.iter().copied().fold(f64::MAX, f64::min);
        let largest = e.iter().copied().fold(0.0, f64::max);
        for distance in [10.0, 0.3, 1e-9, 0.0, -1e-9, -0.99 * smallest * smallest / largest] {
            let moved = [0, 1, 2].map(|k| p[k] + distance * n[k]);
            let found = ellipsoid(moved, e);
            assert!((found + distance).abs() < 3e-14 * (largest + 10.0), "{found} at {distance} from {e:?}");
        }
    }
}

#[test]
fn no_point_of_the_ellipsoid_is_closer_than_the_distance_inside() {
    let mut random = Random(4);
    for _ in 0..40 {
        let e = random.point([(0.05, 4.0); 3]);
        let inside = random.point([(-0.5, 0.5); 3]);
        let p = [0, 1, 2].map(|k| inside[k] * e[k]);
        let distance = ellipsoid(p, e);
        let nearest = (0..20_000).map(|_| {
            let (q, _) = point_on(e, &mut random);
            (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        });
        let nearest = nearest.fold(f64::MAX, f64::min);
        assert!(distance <= nearest && nearest < distance + 0.1, "{distance}, but {nearest} was found");
    }
}

#[test]
fn the_distance_stands_where_closest_points_are_not_unique() {
    assert_eq!(ellipsoid([0.0; 3], [2.0, 3.0, 4.0]), 2.0);
    assert_eq!(ellipsoid([0.0; 3], [2.0, 2.0, 2.0]), 2.0);
    assert_eq!(ellipsoid([0.0, 0.0, 1.0], [2.0, 2.0, 2.0]), 1.0);
    assert_eq!(ellipsoid([0.0, 5.0, 0.0], [2.0, 3.0, 4.0]), -2.0);
    // On the long axis of a spheroid the closest points are a circle up to 4 − 1/4 from the middle.
    let on_axis = |x: f64| ellipsoid([x, 0.0, 0.0], [4.0, 1.0, 1.0]);
    assert!((on_axis(3.0) - (1.0f64 - 9.0 / 15.0).sqrt()).abs() < 1e-15);
    assert!((on_axis(3.9) - 0.1).abs() < 1e-15);
    for tiny in [1e-300, 1e-200, 1e-30, 1e-12] {
        let near_axis = ellipsoid([3.0, tiny, tiny], [4.0, 1.0, 1.0]);
        assert!((near_axis - on_axis(3.0)).abs() < 1e-11, "{near_axis}");
        let near_cusp = ellipsoid([3.75, tiny, tiny], [4.0, 1.0, 1.0]);
        assert!((near_cusp - 0.25).abs() < 1e-11, "{near_cusp}");
    }
    assert!(ellipsoid([1.0, 1.0, 1.0], [0.0, 1.0, 1.0]).is_nan());
}

#[test]
fn intervals_of_the_ellipsoid_hold_its_values_and_are_no_wider_than_the_box() {
    check_inclusion(&**ELLIPSOID, ELLIPSOIDS);
    check_inclusion(
        &**ELLIPSOID,
        [(-1e-3, 1e-3), (-1e-9, 1e-9), (-3.0, 3.0), (1.0, 1.1), (1.0, 1.0), (2.0, 2.0)],
    );
    let mut random = Random(5);
    for _ in 0..1000 {
        let mut cell = random.cell(ELLIPSOIDS);
        for axis in &mut cell[3..] {
            axis.hi = axis.lo;
        }
        let diagonal = cell[..3].iter().map(|side| (side.hi - side.lo).powi(2)).sum::<f64>().sqrt();
        let interval = ELLIPSOID.interval(&cell);
        assert!(interval.hi - interval.lo <= diagonal + 1e-12);
    }
}

#[test]
fn gradients_are_exact() {
    check_gradient(&**ELLIPSOID, ELLIPSOIDS);
    check_gradient(&**EXACT, [(0.001, 3.0), (0.001, 3.0), (0.3, 1.0), (0.1, 0.6)]);
    check_gradient(&**EXACT, [(-3.0, -0.01), (-3.0, -0.01), (0.3, 1.0), (0.1, 0.6)]);
    check_gradient(&**EXACT, [(-3.0, 3.0), (-3.0, 3.0), (0.3, 1.0), (0.1, 0.6)]);
}

#[test]
fn intervals_of_the_sardf_intersection_hold_its_values() {
    for function in [&*EXACT, &*SNAPPING] {
        for (r, alpha) in [(0.5, 0.3), (0.5, 0.0), (2.0, 0.7), (1.0, std::f64::consts::FRAC_PI_4), (0.0, 0.1)]
        {
            check_inclusion(&**function, [(-3.0, 3.0), (-3.0, 3.0), (r, r), (alpha, alpha)]);
            check_inclusion(&**function, [(-3e-7, 3e-7), (-3e-7, 3e-7), (r, r), (alpha, alpha)]);
        }
        check_inclusion(&**function, [(-3.0, 3.0), (-3.0, 3.0), (0.1, 1.0), (0.0, 0.7)]);
        check_inclusion(&**function, [(-3.0, 3.0), (-3.0, 3.0), (-1.0, 1.0), (-2.0, 2.0)]);
    }
}

/// How far a point is from the arc that its value tells.
fn arc_error(x: f64, y: f64, r: f64, alpha: f64, d: f64) -> f64 {
    let (center, radius) = if d >= r {
        (d + r, r)
    } else if d > 0.0 {
        (2.0 * (r * d).sqrt(), 2.0 * (r * d).sqrt() - d)
    } else {
        (alpha.tan() * d, (alpha.tan() - 1.0) * d)
    };
    (x - center).hypot(y - center) - radius
}

#[test]
fn level_lines_of_the_sardf_intersection_are_arcs() {
    let (mut random, mut on_arcs) = (Random(6), 0);
    for _ in 0..5000 {
        let [r, alpha] = random.point([(0.2, 1.0), (0.0, 0.7)]);
        let (x, y) = (random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        let d = EXACT.value(&[x, y, r, alpha]);
        assert!(d <= x.min(y));
        let mirrored = EXACT.value(&[y, x, r, alpha]);
        assert!((d - mirrored).abs() < 1e-15, "{d} and {mirrored} at ({x}, {y})");
        if d < x.min(y) {
            on_arcs += 1;
            let error = arc_error(x, y, r, alpha, d);
            assert!(error.abs() < 1e-14, "{error} off at ({x}, {y}), R = {r}, alpha = {alpha}: {d}");
        }
    }
    assert!(on_arcs > 1000);
}

#[test]
fn the_sardf_intersection_is_continuous() {
    let mut random = Random(7);
    for _ in 0..20_000 {
        let [x, y, r, alpha] = random.point([(-2.0, 2.0), (-2.0, 2.0), (0.3, 0.6), (0.0, 0.7)]);
        let (here, there) = (EXACT.value(&[x, y, r, alpha]), EXACT.value(&[x + 1e-9, y, r, alpha]));
        assert!((0.0..1e-7).contains(&(there - here + 1e-15)), "a jump at ({x}, {y}): {here}, {there}");
    }
}

#[test]
fn only_c_takes_tiny_operands_as_zero() {
    let at = |function: &dyn Function| function.value(&[5e-8, 1.0, 0.1, 0.2]);
    assert_eq!(at(&**EXACT), 5e-8);
    assert_eq!(at(&**SNAPPING), 0.0);
}

#[test]
fn a_blend_is_a_rounded_corner() {
    let blend = |f: f64, g: f64, r: f64| value("hfDBlendUni", &[f, g, r].map(Given::Real), &[]);
    // The smaller root of 2d² − (2f + 2g + 4r)d + f² + g² + r² + 2r(f + g) = 0.
    let root = |f: f64, g: f64, r: f64| {
        let (b, c) = (-(2.0 * f + 2.0 * g + 4.0 * r), f * f + g * g + r * r + 2.0 * r * (f + g));
        (-b - (b * b - 8.0 * c).sqrt()) / 4.0
    };
    let mut random = Random(8);
    for _ in 0..1000 {
        let [f, g, r] = random.point([(-1.0, 1.0), (-1.0, 1.0), (0.1, 2.0)]);
        let expected = if (f - g).abs() <= r { root(f, g, r) } else { f.max(g) };
        // The root cancels where the two pieces meet.
        assert!((blend(f, g, r) - expected).abs() < 1e-7, "{f} {g} {r}");
        let other = value("hfDBlendInt", &[-f, -g, r].map(Given::Real), &[]);
        assert_eq!(other, -blend(f, g, r));
    }
    assert_eq!(blend(1.0, 2.0, 0.5), 2.0);
    assert_eq!(blend(1.0, 2.0, 0.0), 2.0);
    assert_eq!(blend(1.0, 1.0, -0.5), 1.0);
}

#[test]
fn an_unbounded_box_leaves_a_bounded_end() {
    let beyond = Interval { lo: 5.0, hi: f64::INFINITY };
    let [middle, axis] = [0.0, 2.0].map(|v| Interval { lo: v, hi: v });
    let interval = ELLIPSOID.interval(&[beyond, middle, middle, axis, axis, axis]);
    assert!(interval.lo == f64::NEG_INFINITY && (interval.hi + 3.0).abs() < 1e-11);

    let below = Interval { lo: f64::NEG_INFINITY, hi: -1.0 };
    let [r, alpha] = [0.1, 0.0].map(|v| Interval { lo: v, hi: v });
    let interval = EXACT.interval(&[below, below, r, alpha]);
    assert!(interval.lo == f64::NEG_INFINITY && (interval.hi + 2f64.sqrt()).abs() < 1e-9);

    let half = Interval { lo: 1.0, hi: f64::INFINITY };
    let [other, r, alpha] = [0.5, 0.1, 0.2].map(|v| Interval { lo: v, hi: v });
    let interval = EXACT.interval(&[half, other, r, alpha]);
    assert!((interval.hi - 0.5).abs() < 1e-9 && interval.lo > 0.4);
}
