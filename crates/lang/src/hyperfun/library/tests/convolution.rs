//! The closed forms of the convolutions against integrals of the kernel.

use super::{Given, Random, value};

type Point = [f64; 3];

fn kernel(p: Point, q: Point, s: f64) -> f64 {
    let squared: f64 = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum();
    1.0 / (1.0 + s * s * squared).powi(2)
}

/// The integral of a function from 0 to 1, by Gauss–Legendre quadrature with three points in each of 200 parts.
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    let (offset, parts) = (0.6f64.sqrt() / 2.0, 200);
    let part = |i: usize| {
        let at = |t: f64| f((i as f64 + t) / parts as f64);
        (5.0 * at(0.5 - offset) + 8.0 * at(0.5) + 5.0 * at(0.5 + offset)) / 18.0
    };
    (0..parts).map(part).sum::<f64>() / parts as f64
}

fn between(a: Point, b: Point, t: f64) -> Point {
    [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn array(values: &[f64]) -> Given {
    Given::Array(values.to_vec())
}

const SPACE: [(f64, f64); 3] = [(-2.0, 2.0); 3];

#[test]
fn a_segment_is_the_integral_of_the_kernel() {
    let mut random = Random(10);
    for _ in 0..50 {
        let [p, a, b] = [0; 3].map(|_| random.point(SPACE));
        let s = random.between(0.3, 3.0);
        let given = [Given::Point, array(&a), array(&b), array(&[s]), Given::Real(0.25)];
        let expected = distance(a, b) * integral(|t| kernel(p, between(a, b, t), s)) - 0.25;
        assert!((value("hfConvLine", &given, &p) - expected).abs() < 1e-8);
    }
}

#[test]
fn a_triangle_is_the_integral_of_the_kernel_times_the_cube_of_its_width() {
    let mut random = Random(11);
    for _ in 0..10 {
        let [p, a, b, c] = [0; 4].map(|_| random.point(SPACE));
        let s = random.between(0.3, 2.0);
        let given = [Given::Point, array(&[a, b, c].concat()), array(&[s]), Given::Real(0.25)];
        let [ab, bc, ca] = [distance(a, b), distance(b, c), distance(c, a)];
        let half = (ab + bc + ca) / 2.0;
        let area = (half * (half - ab) * (half - bc) * (half - ca)).sqrt();
        // Segments parallel to BC, at the fraction u of the height from A.
        let row = |u: f64| u * integral(|t| kernel(p, between(a, between(b, c, t), u), s));
        let expected = s.powi(3) * 2.0 * area * integral(row) - 0.25;
        assert!((value("hfConvTriangle", &given, &p) - expected).abs() < 1e-8);
    }
}

#[test]
fn an_arc_is_the_integral_of_the_kernel_over_the_angle() {
    let mut random = Random(12);
    for degrees in [30.0, 90.0, 179.0, 180.0, 200.0, 300.0, 360.0, 400.0] {
        for _ in 0..5 {
            let (p, r, s) = (random.point(SPACE), random.between(0.3, 2.0), random.between(0.3, 2.0));
            let given = [
                Given::Point,
                array(&[0.0, 0.0, 0.0]),
                array(&[r]),
                array(&[degrees]),
                array(&[0.0, 0.0, 1.0]),
                array(&[0.0]),
                array(&[s]),
                Given::Real(0.25),
            ];
            let span = f64::to_radians(degrees).min(std::f64::consts::TAU);
            let on_arc = |t: f64| [r * (t * span).cos(), r * (t * span).sin(), 0.0];
            let expected = span * integral(|t| kernel(p, on_arc(t), s)) - 0.25;
            // The library's π has seven digits, and it nudges axes and angles by 10⁻⁶.
            let found = value("hfConvArc", &given, &p);
            assert!((found - expected).abs() < 2e-5, "{found} instead of {expected} for {degrees} degrees");
        }
    }
}

#[test]
fn an_arc_is_smooth_across_the_plane_of_its_start() {
    let at = |x: f64| {
        let given = [
            Given::Point,
            array(&[0.0; 3]),
            array(&[1.0]),
            array(&[90.0]),
            array(&[0.0, 0.0, 1.0]),
            array(&[0.0]),
            array(&[1.0]),
            Given::Real(0.0),
        ];
        value("hfConvArc", &given, &[x, 0.5, 0.3])
    };
    let values = [-1e-9, 0.0, 1e-9, 1.745e-8].map(at);
    assert!(values.iter().all(|v| (v - values[0]).abs() < 1e-7), "{values:?}");
}

#[test]
fn skeletons_without_extent_add_nothing() {
    let p = [0.3, 0.4, 0.5];
    let point = array(&[1.0, 2.0, 3.0]);
    let line = [Given::Point, point.clone(), point, array(&[1.0]), Given::Real(0.25)];
    assert_eq!(value("hfConvLine", &line, &p), -0.25);
    let flat = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let triangle = [Given::Point, array(&flat), array(&[1.0]), Given::Real(0.25)];
    assert_eq!(value("hfConvTriangle", &triangle, &p), -0.25);
}

#[test]
fn segments_of_a_radius_count_up_to_one() {
    let p = [0.5, 0.0, 0.0];
    let segments = |n: usize| {
        let (begins, ends) = ([0.0, 0.0, 0.0].repeat(n), [1.0, 0.0, 0.0].repeat(n));
        value("hfConvLineR", &[Given::Point, array(&begins), array(&ends), Given::Real(0.9)], &p)
    };
    assert!(segments(2) > segments(1));
    assert_eq!(segments(2), segments(9));
}
