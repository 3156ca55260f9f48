//! Loops, calls and gradients in every domain, against the reference evaluator and against finite differences.

use fieldstone_field::*;
use std::sync::Arc;

fn coordinate(g: &mut Graph, i: u16) -> NodeId {
    g.input(Input::Coordinate(i))
}

/// z ← z² + c in the plane, until |z|² ≥ 4 or 20 turns: 4 − |z|² and the turns as an attribute.
fn escape_time() -> Field {
    let mut g = Graph::new();
    let (x, y) = (coordinate(&mut g, 0), coordinate(&mut g, 1));
    let zero = g.constant(0.0);
    let turning = g.begin_loop(&[x, y, zero], None);
    let [u, v, i] = [0, 1, 2].map(|k| g.loop_var(turning, k));
    let (uu, vv) = (g.square(u), g.square(v));
    let r = g.add(uu, vv);
    let (four, twenty, one, two) = (g.constant(4.0), g.constant(20.0), g.constant(1.0), g.constant(2.0));
    let (small, few) = (g.lt(r, four), g.lt(i, twenty));
    let condition = g.mul(small, few);
    let re = g.sub(uu, vv);
    let re = g.add(re, x);
    let im = g.mul(u, v);
    let im = g.mul(two, im);
    let im = g.add(im, y);
    let next = g.add(i, one);
    let out = g.end_loop(turning, condition, &[re, im, next]);
    let (uu, vv) = (g.square(out[0]), g.square(out[1]));
    let r = g.add(uu, vv);
    let value = g.sub(r, four);
    Field::new(g, value, vec![out[2]])
}

/// Σ over i < round(|z|·3) + 1 of Σ over j ≤ i of sin(x·i + y·j): nested loops with data-dependent bounds.
fn nested() -> Field {
    let mut g = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| coordinate(&mut g, i));
    let (zero, one, three) = (g.constant(0.0), g.constant(1.0), g.constant(3.0));
    let bound = g.abs(z);
    let bound = g.mul(bound, three);
    let bound = g.round(bound);
    let outer = g.begin_loop(&[zero, zero], None);
    let (i, sum) = (g.loop_var(outer, 0), g.loop_var(outer, 1));
    let go_on = g.le(i, bound);
    let inner = g.begin_loop(&[zero, sum], Some(outer));
    let (j, part) = (g.loop_var(inner, 0), g.loop_var(inner, 1));
    let inner_on = g.le(j, i);
    let (xi, yj) = (g.mul(x, i), g.mul(y, j));
    let angle = g.add(xi, yj);
    let sine = g.sin(angle);
    let (j_next, part_next) = (g.add(j, one), g.add(part, sine));
    let inner_out = g.end_loop(inner, inner_on, &[j_next, part_next]);
    let i_next = g.add(i, one);
    let out = g.end_loop(outer, go_on, &[i_next, inner_out[1]]);
    // A value of the loop and one around it, so that registers must not be mixed up.
    let value = g.add(out[1], bound);
    Field::new(g, value, vec![out[0]])
}

fn points(count: usize, reach: f64) -> Vec<[f64; 3]> {
    (0..count)
        .map(|i| {
            [0.754_877_666, 0.569_840_291, 0.430_159_709]
                .map(|s| ((i as f64 * s).fract() - 0.5) * 2.0 * reach)
        })
        .collect()
}

fn run<K: Engine<F64>>(
    tape: &Tape,
    fill: impl Fn(usize, usize) -> Vec<f64>,
    lanes: usize,
) -> Workspace<F64, K> {
    let mut w = Workspace::<F64, K>::new();
    for lane in 0..lanes {
        for axis in 0..3 {
            for (component, value) in fill(lane, axis).into_iter().enumerate() {
                w.input(axis, component)[lane] = value;
            }
        }
    }
    w.run(tape, lanes);
    w
}

#[test]
fn loops_agree_with_the_reference() {
    for field in [escape_time(), nested()] {
        let tape = Tape::new(&field, &TapeOptions { attributes: true, ..TapeOptions::default() });
        for block in points(640, 1.8).chunks(LANES) {
            let w = run::<Points>(&tape, |lane, axis| vec![block[lane][axis]], block.len());
            for (lane, p) in block.iter().enumerate() {
                let expected = field.at(p, &Bindings::new());
                assert_eq!([w.output(0, 0)[lane], w.output(1, 0)[lane]], expected[..], "at {p:?}");
            }
        }
    }
}

#[test]
fn the_escape_time_is_the_one_that_a_plain_loop_counts() {
    let field = escape_time();
    for p in points(200, 1.5) {
        let (mut u, mut v, mut turns) = (p[0], p[1], 0.0);
        while u * u + v * v < 4.0 && turns < 20.0 {
            (u, v) = (u * u - v * v + p[0], 2.0 * (u * v) + p[1]);
            turns += 1.0;
        }
        assert_eq!(field.at(&p, &Bindings::new()), [u * u + v * v - 4.0, turns]);
    }
}

#[test]
fn sets_over_loops_hold_every_value() {
    let mut decided = 0;
    for field in [escape_time(), nested()] {
        let tape = Tape::new(&field, &TapeOptions { attributes: true, ..TapeOptions::default() });
        for (round, centre) in points(400, 1.8).into_iter().enumerate() {
            let half = [1e-6, 1e-3, 0.02, 0.2][round % 4];
            let boxes = run::<Intervals>(&tape, |_, axis| vec![centre[axis] - half, centre[axis] + half], 1);
            let spans = run::<Affines>(
                &tape,
                |_, axis| {
                    let form = Affine::along_ray(centre[axis], 0.5 - axis as f64 * 0.3, -half, half);
                    vec![form.centre, form.slope, form.error, form.range.lo, form.range.hi]
                },
                1,
            );
            for offset in points(30, half) {
                let p = [0, 1, 2].map(|i| centre[i] + offset[i]);
                let on_ray = [0, 1, 2].map(|i| centre[i] + (0.5 - i as f64 * 0.3) * offset[0]);
                let (value, along) = (field.at(&p, &Bindings::new()), field.at(&on_ray, &Bindings::new()));
                for o in 0..2 {
                    let range = Interval::new(boxes.output(o, 0)[0], boxes.output(o, 1)[0]);
                    assert!(range.contains(value[o]), "{} escapes {range:?} at {p:?}", value[o]);
                    let range = Interval::new(spans.output(o, 3)[0], spans.output(o, 4)[0]);
                    assert!(range.contains(along[o]), "{} escapes {range:?} at {on_ray:?}", along[o]);
                }
            }
            decided += usize::from(boxes.output(1, 0)[0] == boxes.output(1, 1)[0]);
        }
    }
    assert!(decided > 250, "the turns were known in {decided} boxes only");
}

#[test]
fn loops_that_do_not_end_are_undefined_and_end() {
    let mut g = Graph::new();
    let x = coordinate(&mut g, 0);
    let one = g.constant(1.0);
    let endless = g.begin_loop(&[x], None);
    let v = g.loop_var(endless, 0);
    let condition = g.lt(x, one);
    let next = g.add(v, one);
    let out = g.end_loop(endless, condition, &[next]);
    let field = Field::new(g, out[0], Vec::new()).with_fuel(1000);
    let tape = Tape::new(&field, &TapeOptions::default());
    let w = run::<Points>(&tape, |lane, _| vec![lane as f64], 8);
    assert!(w.output(0, 0)[0].is_nan());
    assert_eq!(w.turns(0), f64::INFINITY);
    assert_eq!(w.turns(1), 0.0);
    assert_eq!(w.output(0, 0)[1..8], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let w = run::<Intervals>(&tape, |_, _| vec![0.5, 1.5], 1);
    assert!(w.output(0, 0)[0].is_nan());
}

/// Σ over i < x of the turns of a loop to y: a loop in a loop.
fn products_by_counting(fuel: u32) -> Field {
    let mut g = Graph::new();
    let (x, y) = (coordinate(&mut g, 0), coordinate(&mut g, 1));
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let outer = g.begin_loop(&[zero, zero], None);
    let (i, sum) = (g.loop_var(outer, 0), g.loop_var(outer, 1));
    let more = g.lt(i, x);
    // 0, but the inner loop cannot be taken out of the outer one.
    let start = g.min(i, zero);
    let inner = g.begin_loop(&[start], Some(outer));
    let j = g.loop_var(inner, 0);
    let inner_more = g.lt(j, y);
    let next_j = g.add(j, one);
    let turned = g.end_loop(inner, inner_more, &[next_j]);
    let (next_i, next_sum) = (g.add(i, one), g.add(sum, turned[0]));
    let out = g.end_loop(outer, more, &[next_i, next_sum]);
    Field::new(g, out[1], Vec::new()).with_fuel(fuel)
}

#[test]
fn all_loops_of_a_point_share_its_fuel_and_no_lane_spends_that_of_another() {
    let place = |lane: usize| [lane as f64, (lane * lane % 11) as f64];
    let fuel = 40;
    let field = products_by_counting(fuel);
    let tape = Tape::new(&field, &TapeOptions::default());
    let w = run::<Points>(&tape, |lane, axis| vec![place(lane).get(axis).copied().unwrap_or(0.0)], LANES);
    for lane in 0..LANES {
        let [x, y] = place(lane);
        let turns = x + x * y;
        let expected = if turns <= f64::from(fuel) { (x * y, turns) } else { (f64::NAN, f64::INFINITY) };
        let found = (w.output(0, 0)[lane], w.turns(lane));
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "lane {lane}");
        let reference = field.at(&[x, y, 0.0], &Bindings::new())[0];
        assert!(reference == found.0 || (reference.is_nan() && found.0.is_nan()), "lane {lane}: {reference}");
    }
}

/// A loop to 10·√(2 − x)², and the turns of one to 15 behind it.
fn counting_twice() -> Field {
    let mut g = Graph::new();
    let (x, zero, one, two) = (coordinate(&mut g, 0), g.constant(0.0), g.constant(1.0), g.constant(2.0));
    let (nine, ten, fifteen) = (g.constant(9.0), g.constant(10.0), g.constant(15.0));
    let difference = g.sub(two, x);
    let root = g.sqrt(difference);
    let square = g.square(root);
    let first_end = g.mul(ten, square);
    let mut turned = zero;
    for end in [first_end, fifteen] {
        // 0, but known only when the loop before has ended.
        let small = g.lt(x, nine);
        let start = g.select(small, zero, turned);
        let count = g.begin_loop(&[start], None);
        let i = g.loop_var(count, 0);
        let more = g.lt(i, end);
        let next = g.add(i, one);
        turned = g.end_loop(count, more, &[next])[0];
    }
    Field::new(g, turned, Vec::new()).with_fuel(20)
}

#[test]
fn what_a_point_of_a_set_may_have_spent_is_not_there_for_the_loops_that_follow() {
    let field = counting_twice();
    let tape = Tape::new(&field, &TapeOptions::default());
    let w = run::<Points>(&tape, |lane, _| vec![[0.5, 1.75, 3.0][lane]], 3);
    assert!(w.output(0, 0)[0].is_nan(), "15 turns, and 15 of 20 to come");
    assert_eq!(w.output(0, 0)[1..3], [15.0, 15.0], "3 turns, and a condition without a value");
    let boxes = [[0.5, 2.5], [1.75, 1.8]];
    let w =
        run::<Intervals>(&tape, |lane, axis| if axis == 0 { boxes[lane].to_vec() } else { vec![0.0; 2] }, 2);
    assert!(w.output(0, 0)[0].is_nan(), "whose first point spends all");
    assert_eq!(w.turns(0), 0.0, "which does not look endless");
    assert_eq!((w.output(0, 0)[1], w.output(0, 1)[1]), (15.0, 15.0));
    let reference = |lo: f64, hi: f64| {
        reference::evaluate(field.graph(), &[field.value()], (), |_| Interval { lo, hi }, field.fuel())[0]
    };
    assert!(reference(0.5, 2.5).lo.is_nan());
    assert_eq!(reference(1.75, 1.75).lo, 15.0);
}

/// A function that is known as a whole.
struct Cube;

impl Function for Cube {
    fn name(&self) -> &str {
        "cube"
    }
    fn value(&self, a: &[f64]) -> f64 {
        a[0].powi(3) + a[1]
    }
    fn interval(&self, a: &[Interval<f64>]) -> Interval<f64> {
        let slack = 1e-12;
        Interval::new(a[0].lo.powi(3) + a[1].lo - slack, a[0].hi.powi(3) + a[1].hi + slack)
    }
    fn is_black_box(&self) -> bool {
        false
    }
}

#[test]
fn functions_are_called_in_every_domain() {
    let mut g = Graph::new();
    let (x, y) = (coordinate(&mut g, 0), coordinate(&mut g, 1));
    let cube: Arc<dyn Function> = Arc::new(Cube);
    let (twice, z) = (g.add(x, x), coordinate(&mut g, 2));
    let value = g.call(&cube, &[twice, y]);
    let value = g.sub(value, z);
    let field = Field::new(g, value, Vec::new());
    assert!(!field.has_black_box());
    let tape = Tape::new(&field, &TapeOptions::default());
    let p = [0.3, -0.2, 0.7];
    let expected = 0.6f64.powi(3) - 0.2 - 0.7;
    let at = run::<Points>(&tape, |_, axis| vec![p[axis]], 1);
    assert!((at.output(0, 0)[0] - expected).abs() < 1e-15);
    let over = run::<Intervals>(&tape, |_, axis| vec![p[axis] - 0.1, p[axis] + 0.1], 1);
    assert!(over.output(0, 0)[0] < expected && expected < over.output(0, 1)[0] && over.output(0, 1)[0] < 1.0);
    let slope = run::<Gradients>(&tape, gradient_input(&p), 1);
    for (axis, expected) in [6.0 * 0.36, 1.0, -1.0].into_iter().enumerate() {
        assert!((slope.output(0, 1 + axis)[0] - expected).abs() < 1e-8);
    }
}

#[test]
fn black_boxes_are_undefined_over_sets_and_have_gradients() {
    let field = Field::from_fn(|p| p[0] * p[1] - p[2]);
    assert!(field.has_black_box());
    let tape = Tape::new(&field, &TapeOptions::default());
    assert!(tape.has_black_box());
    let over = run::<Intervals>(&tape, |_, _| vec![1.0, 2.0], 1);
    assert!(over.output(0, 0)[0].is_nan());
    let slope = run::<Gradients>(&tape, gradient_input(&[2.0, 3.0, 1.0]), 1);
    for (axis, expected) in [3.0, 2.0, -1.0].into_iter().enumerate() {
        assert!((slope.output(0, 1 + axis)[0] - expected).abs() < 1e-8);
    }
}

fn gradient_input(p: &[f64; 3]) -> impl Fn(usize, usize) -> Vec<f64> + '_ {
    move |_, axis| {
        let mut parts = vec![p[axis], 0.0, 0.0, 0.0];
        parts[1 + axis] = 1.0;
        parts
    }
}

#[test]
fn gradients_agree_with_finite_differences() {
    let mut compared = 0;
    for &op in Unary::ALL {
        compared += compare_gradient(&op.to_string(), |g, a, _| g.unary(op, a));
    }
    for &op in Binary::ALL {
        compared += compare_gradient(&op.to_string(), |g, a, b| g.binary(op, a, b));
    }
    for n in [-3, -2, 3, 4, 7] {
        compared += compare_gradient(&format!("power {n}"), |g, a, _| g.powi(a, n));
    }
    compared += compare_gradient("select", |g, a, b| {
        let c = g.lt(a, b);
        let s = g.sin(b);
        g.select(c, a, s)
    });
    assert!(compared > 1500, "only {compared} gradients were compared");
}

/// Compares op(a, b) of two smooth operands wherever it is defined and smooth; returns at how many points.
fn compare_gradient(name: &str, build: impl Fn(&mut Graph, NodeId, NodeId) -> NodeId) -> usize {
    let mut g = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| coordinate(&mut g, i));
    let xy = g.mul(x, y);
    let a = g.sub(xy, z);
    let zz = g.square(z);
    let b = g.add(y, zz);
    let value = build(&mut g, a, b);
    let field = Field::new(g, value, Vec::new());
    let tape = Tape::new(&field, &TapeOptions::default());
    let mut compared = 0;
    for p in points(60, 0.9) {
        let w = run::<Gradients>(&tape, gradient_input(&p), 1);
        let difference = |axis: usize, h: f64| {
            let at = |d: f64| {
                let mut q = p;
                q[axis] += d;
                field.at(&q, &Bindings::new())[0]
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        for axis in 0..3 {
            let (coarse, fine) = (difference(axis, 1e-4), difference(axis, 1e-5));
            // A jump, a kink or a pole between the points, or nothing there at all.
            if !(coarse - fine).is_finite() || (coarse - fine).abs() > 1e-4 * fine.abs().max(1e-2) {
                continue;
            }
            let exact = w.output(0, 1 + axis)[0];
            let error = (exact - fine).abs();
            assert!(
                error <= 1e-4 * fine.abs().max(1e-2),
                "{name}: {exact} is not {fine} along {axis} at {p:?}"
            );
            compared += 1;
        }
    }
    compared
}

#[test]
fn inputs_that_do_not_vary_are_bound_without_compiling_anew() {
    let mut g = Graph::new();
    let (x, r, t) = (coordinate(&mut g, 0), g.input(Input::Parameter(0)), g.input(Input::Time));
    // The constant 2 stands beside the parameter, and must not change with it.
    let two = g.constant(2.0);
    let (product, twice) = (g.mul(x, r), g.mul(two, t));
    let value = g.sub(product, twice);
    let field = Field::new(g, value, Vec::new());
    assert_eq!(field.inputs(), [Input::Coordinate(0), Input::Parameter(0), Input::Time]);
    let mut bindings = Bindings::new();
    bindings.set(Input::Parameter(0), 2.0);
    let mut tape = Tape::new(&field, &TapeOptions { bindings, ..TapeOptions::default() });
    let at_three = |tape: &Tape| run::<Points>(tape, |_, _| vec![3.0], 1).output(0, 0)[0];
    assert_eq!(at_three(&tape), 6.0);
    let before = tape.clone();
    tape.bind(Input::Parameter(0), 5.0);
    tape.bind(Input::Time, 1.5);
    assert_eq!((at_three(&tape), at_three(&before)), (12.0, 6.0));
}

/// Written out, an R-function becomes one operation, whose interval is exact at the corners.
#[test]
fn written_out_r_functions_are_recognised() {
    for (union, op) in [(true, Binary::RMin), (false, Binary::RMax)] {
        let mut g = Graph::new();
        let (x, y) = (coordinate(&mut g, 0), coordinate(&mut g, 1));
        let (xx, yy) = (g.mul(x, x), g.powi(y, 2));
        let squares = g.add(xx, yy);
        let (sum, root) = (g.add(x, y), g.sqrt(squares));
        let written = if union { g.sub(sum, root) } else { g.add(sum, root) };
        assert_eq!(written, g.binary(op, x, y));
        let difference = g.sub(x, y);
        let subtraction = if union { g.sub(difference, root) } else { g.add(difference, root) };
        let minus = g.neg(y);
        assert_eq!(subtraction, g.binary(op, x, minus));
    }
}
