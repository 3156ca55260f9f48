//! Every operation of the table, through every evaluator, on values that hurt, against its meaning on `f64`.

use fieldstone_field::*;

const VALUES: [f64; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -3.0,
    0.1,
    1.5,
    -2.5,
    7.25,
    1e-12,
    -1e-12,
    1e4,
    -1e4,
    123_456.789,
    1e30,
    -1e30,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// An operation as a field of x and y, with its meaning.
struct Case {
    name: String,
    field: Field,
    meaning: Box<dyn Fn(f64, f64) -> f64>,
}

fn cases() -> Vec<Case> {
    let case = |name: String, build: &dyn Fn(&mut Graph, NodeId, NodeId) -> NodeId, meaning| {
        let mut g = Graph::new();
        let (x, y) = (g.input(Input::Coordinate(0)), g.input(Input::Coordinate(1)));
        let value = build(&mut g, x, y);
        Case { name, field: Field::new(g, value, Vec::new()), meaning }
    };
    let unary = Unary::ALL
        .iter()
        .map(|&op| case(op.to_string(), &|g, x, _| g.unary(op, x), Box::new(move |x, _| op.apply(x))));
    let binary = Binary::ALL
        .iter()
        .map(|&op| case(op.to_string(), &|g, x, y| g.binary(op, x, y), Box::new(move |x, y| op.apply(x, y))));
    let powers = [-5, -2, 3, 6, 500].into_iter().map(|n| {
        let meaning = move |x: f64, _: f64| Domain::powi(x, n);
        case(format!("power {n}"), &|g, x, _| g.powi(x, n), Box::new(meaning))
    });
    let select = case(
        "select".to_string(),
        &|g, x, y| {
            let negative = g.neg(y);
            g.select(x, y, negative)
        },
        Box::new(|x, y| match x {
            _ if x.is_nan() => f64::NAN,
            0.0 => -y,
            _ => y,
        }),
    );
    unary.chain(binary).chain(powers).chain([select]).collect()
}

fn pairs() -> Vec<(f64, f64)> {
    VALUES.iter().flat_map(|&x| VALUES.iter().map(move |&y| (x, y))).collect()
}

fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// Operations that single numbers take from the standard library, while lanes have functions of their own.
const TWICE_MADE: [&str; 11] =
    ["exp", "ln", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "pow", "atan2"];

/// Whether a value over lanes is that of single numbers: up to the errors of both, one and two units in the last place.
fn agrees(name: &str, value: f64, expected: f64) -> bool {
    let room = if TWICE_MADE.contains(&name) { 3.0 * f64::EPSILON } else { 0.0 };
    same(value, expected) || expected.is_finite() && (value - expected).abs() <= room * expected.abs()
}

/// Runs a tape on pairs; `fill` gives the components of a coordinate, `take` what is wanted of a lane.
fn run<P: Precision, K: Engine<P>, T>(
    tape: &Tape,
    pairs: &[(f64, f64)],
    fill: impl Fn(f64, usize) -> Vec<f64>,
    take: impl Fn(&Workspace<P, K>, usize) -> T,
) -> Vec<T> {
    let mut w = Workspace::<P, K>::new();
    let mut results = Vec::new();
    for block in pairs.chunks(LANES) {
        for (lane, &(x, y)) in block.iter().enumerate() {
            for (axis, value) in [x, y, 0.0].into_iter().enumerate() {
                for (component, part) in fill(value, axis).into_iter().enumerate() {
                    w.input(axis, component)[lane] = Scalar::from_f64(part);
                }
            }
        }
        w.run(tape, block.len());
        results.extend((0..block.len()).map(|lane| take(&w, lane)));
    }
    results
}

#[test]
fn lanes_in_double_precision_agree_with_single_numbers() {
    for case in cases() {
        let tape = Tape::new(&case.field, &TapeOptions::default());
        let values = run::<F64, Points, _>(&tape, &pairs(), |v, _| vec![v], |w, lane| w.output(0, 0)[lane]);
        for ((x, y), value) in pairs().into_iter().zip(values) {
            let expected = (case.meaning)(x, y);
            assert!(
                agrees(&case.name, value, expected),
                "{}({x}, {y}) is {expected}, not {value}",
                case.name
            );
        }
    }
}

#[test]
fn what_differs_does_not_agree() {
    assert!(agrees("exp", 1.0, 1.0 + 3.0 * f64::EPSILON) && !agrees("exp", 1.0, 1.0 + 4.0 * f64::EPSILON));
    assert!(agrees("add", 1.0, 1.0) && !agrees("add", 1.0, 1.0 + f64::EPSILON));
    assert!(agrees("exp", f64::NAN, f64::NAN) && !agrees("exp", f64::NAN, 1.0));
    assert!(agrees("exp", f64::INFINITY, f64::INFINITY) && !agrees("exp", 1.0, f64::INFINITY));
}

#[test]
fn lanes_in_single_precision_are_close() {
    for case in cases() {
        let tape = Tape::new(&case.field, &TapeOptions::default());
        let single: Vec<(f64, f64)> =
            pairs().iter().map(|&(x, y)| (f64::from(x as f32), f64::from(y as f32))).collect();
        let values =
            run::<F32, Points, _>(&tape, &single, |v, _| vec![v], |w, lane| f64::from(w.output(0, 0)[lane]));
        for ((x, y), value) in single.into_iter().zip(values) {
            let expected = (case.meaning)(x, y);
            // What overflows or underflows in f32 on the way is another matter.
            if expected.abs() > 1e18 || expected.abs() < 1e-18 && expected != 0.0 || !expected.is_finite() {
                continue;
            }
            if value.is_nan() || value.is_infinite() || value == 0.0 {
                let large = x.abs().max(y.abs()) > 1e18
                    || x.abs().max(y.abs()) < 1e-10
                    || case.name.starts_with("power");
                assert!(large || value == expected, "{}({x}, {y}) is {expected}, not {value}", case.name);
                continue;
            }
            let error = (value - expected).abs();
            assert!(
                error <= 2e-6 * expected.abs().max(1e-6),
                "{}({x}, {y}) is {expected}, not {value}",
                case.name
            );
        }
    }
}

#[test]
fn sets_around_single_points_hold_the_meaning() {
    for case in cases() {
        let tape = Tape::new(&case.field, &TapeOptions::default());
        let range = |w: &Workspace<F64, Intervals>, lane: usize| {
            Interval::new(w.output(0, 0)[lane], w.output(0, 1)[lane])
        };
        // The lower end of an interval is never +∞, the upper never −∞.
        let ends = |v: f64| (v.min(f64::MAX), v.max(f64::MIN));
        let points = |v: f64, _: usize| if v.is_nan() { vec![v, v] } else { vec![ends(v).0, ends(v).1] };
        let ranges = run::<F64, Intervals, _>(&tape, &pairs(), points, range);
        let spans = run::<F64, Affines, _>(
            &tape,
            &pairs(),
            |v, axis| {
                let both = points(v, axis);
                let form = Affine::from_interval(Interval { lo: both[0], hi: both[1] });
                vec![form.centre, form.slope, form.error, form.range.lo, form.range.hi]
            },
            |w, lane| Interval::new(w.output(0, 3)[lane], w.output(0, 4)[lane]),
        );
        for (((x, y), range), span) in pairs().into_iter().zip(ranges).zip(spans) {
            let expected = (case.meaning)(x, y);
            assert!(range.contains(expected), "{}({x}, {y}) = {expected} escapes {range:?}", case.name);
            assert!(
                span.contains(expected),
                "{}({x}, {y}) = {expected} escapes the affine {span:?}",
                case.name
            );
            // Undefined operands are handed on by every operation that reads them.
            let reads_y = Binary::ALL.iter().any(|op| op.name() == case.name) || case.name == "select";
            if x.is_nan() || (reads_y && y.is_nan()) {
                assert!(
                    range.lo.is_nan() && span.lo.is_nan(),
                    "{}({x}, {y}) hides what is undefined",
                    case.name
                );
            }
        }
    }
}

#[test]
fn gradients_carry_the_value() {
    for case in cases() {
        let tape = Tape::new(&case.field, &TapeOptions::default());
        let values = run::<F64, Gradients, _>(
            &tape,
            &pairs(),
            |v, _| vec![v, 1.0, 0.0, 0.0],
            |w, lane| w.output(0, 0)[lane],
        );
        for ((x, y), value) in pairs().into_iter().zip(values) {
            let expected = (case.meaning)(x, y);
            assert!(
                agrees(&case.name, value, expected),
                "{}({x}, {y}) is {expected}, not {value}",
                case.name
            );
        }
    }
}
