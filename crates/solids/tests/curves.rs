//! Balls that move along curves, against dense sampling of the curve.

mod kit;

use fieldstone_field::{
    F64, Field, Function, Graph, Input, Interval, Node, NodeId, Points, Tape, TapeOptions, Workspace,
};
use fieldstone_solids::expression::{Expr, write};
use fieldstone_solids::{CURVE_PARAMETER, Curve, sweep};
use kit::{Random, at, ball, check, coordinates};
use std::sync::Arc;

fn program(of: impl for<'g> Fn(Expr<'g>) -> [Expr<'g>; 3]) -> Curve {
    let mut graph = Graph::new();
    let u = graph.input(CURVE_PARAMETER);
    let at = write(&mut graph, |cell| of(Expr::new(cell, u)).map(Expr::id));
    Curve::Program(Box::new(graph), at)
}

/// Open and closed curves, with corners at their ends, with a cusp, a point where they stand still, and a tight turn.
fn curves() -> Vec<(&'static str, Curve)> {
    let tau = std::f64::consts::TAU;
    vec![
        ("helix", Curve::Helix { radius: 1.0, pitch: 0.5, turns: 3.0 }),
        ("circle", Curve::Helix { radius: 1.0, pitch: 0.0, turns: 1.0 }),
        ("twice a circle", Curve::Helix { radius: 1.0, pitch: 0.0, turns: 2.0 }),
        (
            "loop",
            Curve::Bezier(vec![
                [-1.0, 0.0, 0.0],
                [0.0, 0.0, 2.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, -1.0],
                [-1.0, 1.0, -2.0],
                [-1.0, 0.0, 0.0],
            ]),
        ),
        ("cusp", Curve::Bezier(vec![[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])),
        ("line", program(|u| [2.0 * u - 1.0, 0.5 * u, 0.0 * u])),
        ("still", program(|u| [(u - 0.5).powi(3) * 8.0, (u - 0.5).powi(3), 0.0 * u])),
        (
            "knot",
            program(move |u| {
                let (a, b) = (2.0 * tau * u, 3.0 * tau * u);
                [(a.cos() * (b.cos() * 0.5 + 1.5)), (a.sin() * (b.cos() * 0.5 + 1.5)), b.sin() * 0.5]
            }),
        ),
        (
            "spiral",
            program(|u| {
                let (a, r) = (12.0 * u, (0.0 - 1.5 * u).exp());
                [r * a.cos(), r * a.sin(), u / (u + 1.0)]
            }),
        ),
    ]
}

fn swept(curve: &Curve, radius: f64) -> Field {
    let mut inner = Graph::new();
    let point = coordinates(&mut inner);
    let value = ball(&mut inner, point, [0.1, -0.2, 0.3], radius);
    let mut graph = Graph::new();
    let value = sweep(&mut graph, &inner, value, curve).expect("a curve");
    Field::new(graph, value, Vec::new())
}

/// The squared distance that a swept ball is made of.
fn function(field: &Field) -> Arc<dyn Function> {
    /// Keeps the function that a program calls.
    fn calls(field: &Field) -> usize {
        let graph = field.graph();
        let nodes = graph.reachable(&[field.value()]);
        nodes.into_iter().filter(|n| matches!(graph.node(*n), Node::Call(..))).count()
    }
    assert_eq!(calls(field), 1, "one function for the whole curve");
    Arc::new(Called(Tape::new(field, &TapeOptions::default())))
}

/// A field as a function of points, for values only.
struct Called(Tape);

impl Function for Called {
    fn name(&self) -> &str {
        "called"
    }

    fn value(&self, arguments: &[f64]) -> f64 {
        kit::values(&self.0, &[[arguments[0], arguments[1], arguments[2]]])[0]
    }
}

/// Many places of a curve.
fn samples(curve: &Curve, count: usize) -> Vec<[f64; 3]> {
    let mut graph = Graph::new();
    let origin = [0; 3].map(|_| graph.constant(0.0));
    let back: [NodeId; 3] = curve.moved_back(&mut graph, origin).expect("a curve");
    let field = Field::new(graph, back[0], back[1..].to_vec());
    let options = TapeOptions { varying: vec![CURVE_PARAMETER], attributes: true, ..TapeOptions::default() };
    let tape = Tape::new(&field, &options);
    let mut w = Workspace::<F64, Points>::new();
    (0..=count)
        .map(|i| {
            w.input(0, 0)[0] = i as f64 / count as f64;
            w.run(&tape, 1);
            let place = [0, 1, 2].map(|k| -w.output(k, 0)[0]);
            [place[0] + 0.1, place[1] - 0.2, place[2] + 0.3]
        })
        .collect()
}

#[test]
fn values_are_those_of_dense_sampling() {
    for (name, curve) in curves() {
        let field = swept(&curve, 0.2);
        let places = samples(&curve, 40_000);
        let mut random = Random(11);
        for _ in 0..100 {
            let p = [0; 3].map(|_| 5.0 * random.unit() - 2.5);
            let distance = |c: &[f64; 3]| (0..3).map(|k| (p[k] - c[k]).powi(2)).sum::<f64>().sqrt();
            let nearest = places.iter().map(distance).fold(f64::INFINITY, f64::min);
            let value = at(&field, p) + 0.2;
            // Between the samples it may be a little nearer.
            assert!(value <= nearest + 1e-12 && value > nearest - 2e-6, "{name}: {value} {nearest} at {p:?}");
        }
    }
}

#[test]
fn bounds_hold_and_gradients_are_exact() {
    for (name, curve) in curves() {
        let field = swept(&curve, 0.2);
        function(&field);
        check(name, &field, 4);
    }
}

/// Where there are slopes at all, near the surface they are there almost everywhere.
#[test]
fn spans_near_a_thin_wire_are_lines() {
    let field = swept(&Curve::Helix { radius: 1.0, pitch: 0.5, turns: 3.0 }, 0.2);
    let (_, lines) = check("helix", &field, 2);
    assert!(lines > 64, "{lines} of 128");
}

#[test]
fn distances_from_the_middle_of_a_circle_are_its_radius() {
    let field = swept(&Curve::Helix { radius: 1.0, pitch: 0.0, turns: 1.0 }, 0.25);
    for z in [0.0, 0.5, -2.0] {
        let value = at(&field, [0.1, -0.2, 0.3 + z]);
        assert!((value - (f64::hypot(1.0, z) - 0.25)).abs() < 1e-12, "{value}");
    }
}

/// Solids that are no balls at first sight: turned, scaled, moved, joined, cut.
#[test]
fn balls_are_recognised_in_motion() {
    let curve = Curve::Helix { radius: 1.0, pitch: 0.5, turns: 1.0 };
    let [x, y, z] = [0, 1, 2].map(Input::Coordinate);
    let mut inner = Graph::new();
    let [x, y, z] = [x, y, z].map(|input| inner.input(input));
    let value = write(&mut inner, |cell| {
        let [x, y, z] = [x, y, z].map(|id| Expr::new(cell, id));
        let (c, s) = (0.3f64.cos(), 0.3f64.sin());
        let turned = [x * c + y * s, y * c - x * s, z].map(|v| v / 2.0);
        let ball = (turned[0].square() + turned[1].square() + turned[2].square()).sqrt() * 2.0 - 0.3;
        let other = (x - 0.5).square() + y.square() + z.square() - 0.01;
        ball.min(other).id()
    });
    let mut graph = Graph::new();
    let swept = sweep(&mut graph, &inner, value, &curve).expect("a curve");
    let field = Field::new(graph, swept, Vec::new());
    let calls = field.graph().reachable(&[field.value()]);
    let count = calls.iter().filter(|n| matches!(field.graph().node(**n), Node::Call(..))).count();
    assert_eq!(count, 2);
    check("two balls", &field, 1);
    let p = [0.4, 1.3, 0.6];
    let least = samples(&curve, 20_000)
        .iter()
        .map(|c| {
            let d = [p[0] - c[0] + 0.1, p[1] - c[1] - 0.2, p[2] - c[2] + 0.3];
            let first = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt() - 0.3;
            first.min((d[0] - 0.5).powi(2) + d[1] * d[1] + d[2] * d[2] - 0.01)
        })
        .fold(f64::INFINITY, f64::min);
    assert!((at(&field, p) - least).abs() < 1e-7);
}

/// Inclusion at places that rays ask for: boxes of all sizes around the surface, against the values inside.
#[test]
fn intervals_hold_around_the_surface() {
    let mut random = Random(3);
    for (name, curve) in curves() {
        let field = swept(&curve, 0.2);
        let tape = Tape::new(&field, &TapeOptions::default());
        let mut w = Workspace::<F64, fieldstone_field::Intervals>::new();
        let places = samples(&curve, 100);
        for round in 0..200 {
            let c = places[round % 101];
            let size = 10f64.powi(-(round as i32 % 12));
            let low = c.map(|x| x + 0.5 * (random.unit() - 0.5));
            let sides = low.map(|x| Interval::new(x, x + size * random.unit()));
            for (axis, side) in sides.iter().enumerate() {
                (w.input(axis, 0)[0], w.input(axis, 1)[0]) = (side.lo, side.hi);
            }
            w.run(&tape, 1);
            let bound = Interval::new(w.output(0, 0)[0], w.output(0, 1)[0]);
            let points: Vec<[f64; 3]> =
                (0..20).map(|_| sides.map(|s| (s.lo + s.width() * random.unit()).min(s.hi))).collect();
            for (p, v) in points.iter().zip(kit::values(&tape, &points)) {
                assert!(bound.contains(v), "{name}: {v:e} escapes {bound:?} at {p:?} of {sides:?}");
            }
            // No wider than the box by much, but where a curve stands still.
            let is_regular = name != "still" && name != "cusp";
            assert!(
                !is_regular || size > 1e-3 || bound.width() < 4.0 * size + 1e-9,
                "{name}: {bound:?} of {size}"
            );
        }
    }
}
