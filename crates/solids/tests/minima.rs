//! Sweeps and projections against closed forms.

mod kit;

use fieldstone_field::{
    F64, Field, Function, Gradients, Graph, Input, Interval, Intervals, NodeId, Tape, TapeOptions, Workspace,
};
use fieldstone_solids::{Curve, CurveError, Minimum, MinimumError, dilate, project, sweep, tube};
use kit::{Random, at, ball, check, coordinates, field};

fn swept_ball(curve: &Curve, radius: f64) -> Field {
    let mut inner = Graph::new();
    let point = coordinates(&mut inner);
    let value = ball(&mut inner, point, [0.0; 3], radius);
    let mut graph = Graph::new();
    let value = sweep(&mut graph, &inner, value, curve).expect("a curve");
    Field::new(graph, value, Vec::new())
}

#[test]
fn a_ball_along_a_polyline_is_a_tube() {
    let points = [[-1.0, 0.0, 0.2], [0.5, 0.8, 0.0], [1.2, -0.6, -0.4]];
    let swept = swept_ball(&Curve::Polyline(points.to_vec()), 0.3);
    let closed = field(|g, p| {
        let radius = g.constant(0.3);
        tube(g, p, &points, radius).expect("two stretches")
    });
    let mut random = Random(1);
    for _ in 0..300 {
        let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
        let [a, b] = [at(&swept, p), at(&closed, p)];
        assert!((a - b).abs() < 1e-11, "{a} {b} at {p:?}");
    }
    check("polyline", &swept, 1);
    check("tube", &closed, 2);
}

#[test]
fn a_ball_around_a_circle_is_a_torus() {
    let swept = swept_ball(&Curve::Helix { radius: 1.0, pitch: 0.0, turns: 1.0 }, 0.25);
    let mut random = Random(2);
    for _ in 0..300 {
        let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
        let torus = (f64::hypot(p[0], p[1]) - 1.0).hypot(p[2]) - 0.25;
        assert!((at(&swept, p) - torus).abs() < 1e-11);
    }
    check("circle", &swept, 1);
}

#[test]
fn on_the_axis_all_places_of_a_circle_are_equally_near() {
    let swept = swept_ball(&Curve::Helix { radius: 1.0, pitch: 0.0, turns: 1.0 }, 0.25);
    for z in [0.0, 0.5, -2.0] {
        assert!((at(&swept, [0.0, 0.0, z]) - (f64::hypot(1.0, z) - 0.25)).abs() < 1e-12);
    }
}

#[test]
fn a_bezier_curve_and_its_program_sweep_the_same() {
    let controls = vec![[-1.0, 0.0, 0.0], [0.0, 2.0, 0.5], [1.0, -1.0, 0.0], [1.5, 0.5, -0.5]];
    let bezier = swept_ball(&Curve::Bezier(controls.clone()), 0.2);
    let mut program = Graph::new();
    let u = program.input(fieldstone_solids::CURVE_PARAMETER);
    let one = program.constant(1.0);
    let rest = program.sub(one, u);
    let place = [0, 1, 2].map(|k| {
        let terms = [1.0, 3.0, 3.0, 1.0].into_iter().enumerate().map(|(i, binomial)| {
            let (a, b) = (program.powi(rest, 3 - i as i32), program.powi(u, i as i32));
            let (basis, weight) = (program.mul(a, b), program.constant(binomial * controls[i][k]));
            program.mul(basis, weight)
        });
        let terms: Vec<NodeId> = terms.collect();
        terms.into_iter().reduce(|a, b| program.add(a, b)).expect("four terms")
    });
    let written = swept_ball(&Curve::Program(Box::new(program), place), 0.2);
    let mut random = Random(3);
    for _ in 0..100 {
        let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
        assert!((at(&bezier, p) - at(&written, p)).abs() < 1e-11);
    }
    check("bezier", &bezier, 1);
}

fn swept_cube(points: &[[f64; 3]]) -> Field {
    let mut inner = Graph::new();
    let point = coordinates(&mut inner);
    let half = inner.constant(0.4);
    let sides = point.map(|x| inner.abs(x));
    let largest = sides.into_iter().reduce(|a, b| inner.max(a, b)).expect("three sides");
    let value = inner.sub(largest, half);
    let mut graph = Graph::new();
    let value = sweep(&mut graph, &inner, value, &Curve::Polyline(points.to_vec())).expect("a line");
    Field::new(graph, value, Vec::new())
}

/// max(|x|, |y|, |z|) − 0.2 is no distance beside edges and corners, which balls round nevertheless.
#[test]
fn a_cube_dilated_by_a_ball_is_a_rounded_cube() {
    let mut inner = Graph::new();
    let point = coordinates(&mut inner);
    let half = inner.constant(0.2);
    let sides = point.map(|x| inner.abs(x));
    let largest = sides.into_iter().reduce(|a, b| inner.max(a, b)).expect("three sides");
    let value = inner.sub(largest, half);
    let mut graph = Graph::new();
    let dilated = dilate(&mut graph, (&inner, value), 0.3).expect("a radius");
    let dilated = Field::new(graph, dilated, Vec::new());
    let tape = Tape::new(&dilated, &TapeOptions::default());
    let mut boxes = Workspace::<F64, Intervals>::new();
    // Places of the surface on a face, an edge and a corner.
    let corner = 0.2 + 0.3 / 3f64.sqrt();
    for place in [[0.5, 0.1, 0.05], [0.44, 0.38, -0.1], [corner; 3]] {
        for step in [-1e-3, 1e-3] {
            let p = place.map(|x| if x > 0.2 { x + step } else { x });
            let value = at(&dilated, p);
            assert!(value * step > 0.0, "{value:e} at {p:?}");
            for (k, x) in p.into_iter().enumerate() {
                (boxes.input(k, 0)[0], boxes.input(k, 1)[0]) = (x - 1e-4, x + 1e-4);
            }
            boxes.run(&tape, 1);
            let bound = Interval::new(boxes.output(0, 0)[0], boxes.output(0, 1)[0]);
            assert!(bound.contains(value), "{value:e} escapes {bound:?} at {p:?}");
        }
    }
    let refused = dilate(&mut Graph::new(), (&inner, value), 0.0).err();
    assert!(matches!(refused, Some(MinimumError::Range(..))), "{refused:?}");
}

/// The difference of a gradient to the expected one at random points near the surface.
fn gradients_differ(field: &Field, expected: impl Fn([f64; 3]) -> Option<[f64; 3]>) -> f64 {
    let tape = Tape::new(field, &TapeOptions::default());
    let mut slopes = Workspace::<F64, Gradients>::new();
    let (mut random, mut compared, mut largest) = (Random(9), 0, 0.0f64);
    for _ in 0..2000 {
        let p = [0; 3].map(|_| 2.4 * random.unit() - 1.2);
        let Some(gradient) = expected(p) else { continue };
        for (k, &x) in p.iter().enumerate() {
            slopes.input(k, 0)[0] = x;
            for seed in 0..3 {
                slopes.input(k, seed + 1)[0] = f64::from(u8::from(k == seed));
            }
        }
        slopes.run(&tape, 1);
        compared += 1;
        largest = (0..3).map(|k| (slopes.output(0, k + 1)[0] - gradient[k]).abs()).fold(largest, f64::max);
    }
    assert!(compared > 500, "{compared}");
    largest
}

/// Which of a few numbers is the largest, if it is by more than a little.
fn largest(of: [f64; 3]) -> Option<usize> {
    let at = (0..3).max_by(|&a, &b| of[a].total_cmp(&of[b]))?;
    (0..3).all(|k| k == at || of[k] < of[at] - 1e-3).then_some(at)
}

#[test]
fn a_cube_along_a_line_has_the_normals_of_a_box() {
    let swept = swept_cube(&[[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    let wrong = gradients_differ(&swept, |[x, y, z]| {
        let at = largest([x.abs() - 0.5, y.abs(), z.abs()])?;
        Some([0, 1, 2].map(|k| if k == at { [x, y, z][k].signum() } else { 0.0 }))
    });
    assert!(wrong < 1e-9, "{wrong:e}");
}

/// Along a diagonal two faces meet at the minimiser: max(|x − u|, |y − u|) is least at (x + y)/2, where it is |x − y|/2.
#[test]
fn a_cube_along_a_diagonal_has_the_normals_of_a_prism() {
    let swept = swept_cube(&[[-2.0, -2.0, 0.0], [2.0, 2.0, 0.0]]);
    let wrong = gradients_differ(&swept, |[x, y, z]| {
        let side = 0.5 * (x - y).signum();
        match largest([0.5 * (x - y).abs(), z.abs(), 0.0])? {
            0 => Some([side, -side, 0.0]),
            1 => Some([0.0, 0.0, z.signum()]),
            _ => None,
        }
    });
    assert!(wrong < 1e-9, "{wrong:e}");
}

/// Bounds from below close in on the value where the minimiser lies on a kink, near an end of the curve too.
#[test]
fn bounds_close_in_near_the_end_of_a_curve() {
    let swept = swept_cube(&[[-1.6, 0.8, 0.0], [1.6, -0.8, 0.0], [0.6, 0.8, 2.4]]);
    let tape = Tape::new(&swept, &TapeOptions::default());
    let mut boxes = Workspace::<F64, Intervals>::new();
    // The faces in y and z meet where the curve is 0.009 from its end, and farther away.
    for p in [[0.62, 0.373, 2.759], [0.62, 0.1, 2.5]] {
        let size = 1e-6;
        for (k, x) in p.into_iter().enumerate() {
            (boxes.input(k, 0)[0], boxes.input(k, 1)[0]) = (x - size, x + size);
        }
        boxes.run(&tape, 1);
        let below = at(&swept, p) - boxes.output(0, 0)[0];
        assert!((0.0..8.0 * size).contains(&below), "{below:e} at {p:?}");
    }
}

/// A box with kinks, swept along a straight line: where faces are parallel to the line, many places are least.
#[test]
fn a_cube_along_a_line_is_a_longer_box() {
    let swept = swept_cube(&[[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    let mut random = Random(4);
    for _ in 0..300 {
        let [x, y, z] = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
        let expected = ((x.abs() - 0.5).max(0.0)).max(y.abs()).max(z.abs()) - 0.4;
        assert!((at(&swept, [x, y, z]) - expected).abs() < 1e-11);
    }
    check("cube", &swept, 1);
}

#[test]
fn the_shadow_of_a_ball_of_four_dimensions_is_a_ball() {
    let mut inner = Graph::new();
    let terms: Vec<NodeId> = (0..4)
        .map(|k| {
            let x = inner.input(Input::Coordinate(k));
            let shift = inner.constant(if k == 3 { 0.3 } else { 0.0 });
            let moved = inner.sub(x, shift);
            inner.square(moved)
        })
        .collect();
    let sum = terms.into_iter().reduce(|a, b| inner.add(a, b)).expect("four terms");
    let one = inner.constant(1.0);
    let value = inner.sub(sum, one);
    let shadow = |range: [f64; 2]| {
        let mut graph = Graph::new();
        let value = project(&mut graph, &inner, value, Input::Coordinate(3), range).expect("a range");
        Field::new(graph, value, Vec::new())
    };
    let (whole, cut) = (shadow([-2.0, 2.0]), shadow([0.5, 2.0]));
    for p in [[0.0; 3], [0.7, -0.2, 0.1], [1.0, 1.0, 1.0]] {
        let squared = p.iter().map(|x| x * x).sum::<f64>();
        assert!((at(&whole, p) - (squared - 1.0)).abs() < 1e-12);
        // The least value is at the end of the range.
        assert!((at(&cut, p) - (squared - 0.96)).abs() < 1e-12);
    }
    check("shadow", &whole, 1);
    check("cut shadow", &cut, 1);
}

#[test]
fn minima_stand_inside_minima() {
    // The Minkowski sum of a ball and a square.
    let mut inner = Graph::new();
    let point = coordinates(&mut inner);
    let value = ball(&mut inner, point, [0.0; 3], 0.2);
    let mut bar = Graph::new();
    let along_x = Curve::Polyline(vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    let value = sweep(&mut bar, &inner, value, &along_x).expect("a line");
    let mut graph = Graph::new();
    let along_y = Curve::Polyline(vec![[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]]);
    let value = sweep(&mut graph, &bar, value, &along_y).expect("a line");
    let plate = Field::new(graph, value, Vec::new());
    for [x, y, z] in [[0.3, -0.2, 0.1], [1.0, 0.2, 0.5], [0.9, -1.3, 0.3]] {
        let [dx, dy] = [x, y].map(|c: f64| (c.abs() - 0.5).max(0.0));
        let expected = f64::hypot(dx, dy).hypot(z) - 0.2;
        assert!((at(&plate, [x, y, z]) - expected).abs() < 1e-10);
    }
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let mut inner = Graph::new();
    let value = inner.input(Input::Coordinate(0));
    let mut graph = Graph::new();
    let error = |curve: Curve, graph: &mut Graph| sweep(graph, &inner, value, &curve).unwrap_err();
    let one = error(Curve::Polyline(vec![[0.0; 3]]), &mut graph);
    assert_eq!(one.to_string(), "a polyline has 2 to 256 points, not 1");
    assert_eq!(error(Curve::Bezier(vec![[0.0; 3], [f64::NAN; 3]]), &mut graph), CurveError::NotFinite);
    let w = Input::Coordinate(3);
    let empty = Minimum::new(&inner, value, w, [1.0, 1.0]).err();
    assert_eq!(empty, Some(MinimumError::Range(1.0, 1.0)));
    let black = Field::from_fn(|p| p[0]);
    let refused = Minimum::new(black.graph(), black.value(), w, [0.0, 1.0]).err();
    assert_eq!(refused, Some(MinimumError::BlackBox));
}

#[test]
fn a_place_where_the_solid_is_undefined_does_not_hide_the_others() {
    // √(u − 0.5) − 0.1 over u in [0, 1]: the least value is −0.1, at 0.5.
    let mut inner = Graph::new();
    let (x, u) = (inner.input(Input::Coordinate(0)), inner.input(Input::Coordinate(3)));
    let half = inner.constant(0.5);
    let radicand = inner.sub(u, half);
    let (root, tenth) = (inner.sqrt(radicand), inner.constant(0.1));
    let wave = inner.sub(root, tenth);
    let value = inner.add(wave, x);
    let minimum = Minimum::new(&inner, value, Input::Coordinate(3), [0.0, 1.0]).expect("a range");
    assert_eq!(minimum.arguments(), [Input::Coordinate(0)]);
    let mut graph = Graph::new();
    let value = minimum.call(&mut graph);
    let field = Field::new(graph, value, Vec::new());
    // Nothing is proved there, and the search stays coarse.
    assert!((at(&field, [0.25, 0.0, 0.0]) - 0.15).abs() < 0.05);
}

/// Valleys that are flat, narrow, double or between the places of a search: what `value` finds must lie in every interval.
#[test]
fn intervals_hold_what_values_are_whatever_the_valley() {
    use fieldstone_solids::expression::{Expr, write};
    type Valley = for<'g> fn(Expr<'g>, Expr<'g>) -> Expr<'g>;
    let valleys: [(&str, Valley); 7] = [
        ("flat", |x, u| ((u - x).abs() - 0.3).max(0.0) - 0.1),
        ("constant", |x, u| x + 0.0 * u),
        ("almost flat", |x, u| 1e-14 * (u - x).square() + x),
        ("needle", |x, u| ((u - 0.3 * x).abs() * 1e4).min(1.0) - 0.5),
        ("double", |x, u| ((u - 0.37).square() - 0.0625).square() + 0.01 * x * u),
        ("waves", |x, u| (u * 300.0 + x).sin() + (u - x).square()),
        ("kinks", |x, u| (u - x).abs().min((u + 0.5 * x - 0.2).abs() + 1e-3) + 0.1 * u),
    ];
    for (name, valley) in valleys {
        let mut inner = Graph::new();
        let [x, u] = [0, 3].map(|k| inner.input(Input::Coordinate(k)));
        let value = write(&mut inner, |cell| valley(Expr::new(cell, x), Expr::new(cell, u)).id());
        let minimum = Minimum::new(&inner, value, Input::Coordinate(3), [-1.0, 1.0]).expect("a range");
        let mut random = Random(5);
        for round in 0..400 {
            let size = 10f64.powi(-(round % 9));
            let low = 3.0 * random.unit() - 1.5;
            let side = Interval::new(low, low + size);
            let bound = minimum.interval(&[side]);
            let curvature = minimum.curvature(&[side]);
            let (middle, mut slope) = (low + 0.5 * size, [0.0]);
            let at_middle = minimum.value(&[middle]);
            minimum.gradient(&[middle], &mut slope);
            for _ in 0..20 {
                let p = (low + size * random.unit()).min(side.hi);
                let found = minimum.value(&[p]);
                assert!(bound.contains(found), "{name}: {found:e} escapes {bound:?} at {p} of {side:?}");
                let bend = (found - at_middle - slope[0] * (p - middle)).abs();
                assert!(
                    bend <= 0.125 * curvature * size * size * 1.000001 + 1e-15,
                    "{name}: {bend:e} in {side:?}"
                );
            }
        }
    }
}
