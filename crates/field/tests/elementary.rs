//! The elementary functions over lanes: against exact results, the standard library, and themselves on other processors.

use fieldstone_field::*;

type Meaning = fn(f64, f64) -> f64;

/// Name, the standard library's function, and how far its results may be from those over lanes: the bound of these, one
/// unit in the last place, and the other's error.
const FUNCTIONS: [(&str, Meaning, u64); 14] = [
    ("exp", |x, _| x.exp(), 2),
    ("ln", |x, _| x.ln(), 2),
    ("sin", |x, _| x.sin(), 2),
    ("cos", |x, _| x.cos(), 2),
    ("tan", |x, _| x.tan(), 2),
    ("asin", |x, _| x.asin(), 2),
    ("acos", |x, _| x.acos(), 2),
    ("atan", |x, _| x.atan(), 2),
    ("pow", f64::powf, 2),
    ("atan2", f64::atan2, 2),
    ("sinh", |x, _| x.sinh(), 3),
    ("cosh", |x, _| x.cosh(), 3),
    ("tanh", |x, _| x.tanh(), 3),
    // Below 0 the library loses the digits that 1 − |x| has less than x.
    ("atanh", |x, _| x.abs().atanh().copysign(x), 3),
];

/// A program of one operation on x and y.
fn tape(name: &str) -> Tape {
    let mut g = Graph::new();
    let (x, y) = (g.input(Input::Coordinate(0)), g.input(Input::Coordinate(1)));
    let unary = Unary::ALL.iter().find(|op| op.name() == name).map(|&op| g.unary(op, x));
    let binary = Binary::ALL.iter().find(|op| op.name() == name).map(|&op| g.binary(op, x, y));
    let value = unary.or(binary).expect("the operation is in the table");
    Tape::new(&Field::new(g, value, Vec::new()), &TapeOptions::default())
}

/// The values of a function over lanes.
fn values<P: Precision>(mut w: Workspace<P, Points>, name: &str, arguments: &[(f64, f64)]) -> Vec<f64>
where
    Points: Engine<P>,
{
    let tape = tape(name);
    let mut values = Vec::with_capacity(arguments.len());
    for block in arguments.chunks(LANES) {
        for (lane, &(x, y)) in block.iter().enumerate() {
            w.input(0, 0)[lane] = Scalar::from_f64(x);
            w.input(1, 0)[lane] = Scalar::from_f64(y);
        }
        w.run(&tape, block.len());
        values.extend(w.output(0, 0)[..block.len()].iter().map(|v| v.to_f64()));
    }
    values
}

/// How many numbers lie from one to the other; none between what is undefined, and all between that and a number.
fn units(a: f64, b: f64) -> u64 {
    // Bits that rise with the number, −0 at 0.
    let place = |v: f64| {
        let size = (v.to_bits() & !(1 << 63)) as i64;
        if v.is_sign_negative() { -size } else { size }
    };
    match (a.is_nan(), b.is_nan()) {
        (true, true) => 0,
        (false, false) => place(a).abs_diff(place(b)),
        _ => u64::MAX,
    }
}

#[test]
fn units_count_the_numbers_between() {
    assert_eq!(units(1.0, 1.0 + f64::EPSILON), 1);
    assert_eq!(units(-5e-324, 5e-324), 2);
    assert_eq!(units(0.0, -0.0), 0);
    assert_eq!(units(f64::MAX, f64::INFINITY), 1);
    assert_eq!((units(f64::NAN, f64::NAN), units(f64::NAN, 0.0)), (0, u64::MAX));
}

/// The lines of the table for a function: arguments, and the number nearest to the exact result.
fn table(name: &str) -> Vec<((f64, f64), f64)> {
    let number = |word: &&str| word.parse::<f64>().expect("a number");
    let lines = include_str!("elementary/table.txt").lines().map(|line| line.split(' ').collect::<Vec<_>>());
    let case = |words: Vec<&str>| {
        let (last, arguments) = words[1..].split_last().expect("arguments and a result");
        ((number(&arguments[0]), arguments.get(1).map_or(0.0, number)), number(last))
    };
    lines.filter(|words| words[0] == name).map(case).collect()
}

#[test]
fn hard_arguments_have_exact_results_but_for_one_unit() {
    for (name, ..) in FUNCTIONS {
        let cases = table(name);
        assert!(cases.len() > 20, "{name} has {} cases", cases.len());
        let arguments: Vec<_> = cases.iter().map(|case| case.0).collect();
        let found = values::<F64>(Workspace::new(), name, &arguments);
        for (((x, y), expected), value) in cases.into_iter().zip(found) {
            assert!(units(value, expected) <= 1, "{name}({x:e}, {y:e}) is {expected:e}, not {value:e}");
        }
    }
}

/// Numbers that are the same in every run (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    /// ±2ᵘ with u between two ends.
    fn spread(&mut self, low: f64, high: f64) -> f64 {
        let size = self.between(low, high).exp2();
        if self.unit() < 0.5 { size } else { -size }
    }
}

/// Arguments of which most have finite results, some large and some small.
fn arguments(name: &str, count: usize) -> Vec<(f64, f64)> {
    let mut r = Random(1);
    let mut one = |i: usize| match (name, i % 3) {
        ("exp", 0) => (r.between(-746.0, 711.0), 0.0),
        ("ln", 0) => (r.spread(-1074.0, 1024.0).abs(), 0.0),
        ("ln", _) => (r.between(0.0, 4.0), 0.0),
        ("sin" | "cos" | "tan", 0) => (r.between(-1.1e6, 1.1e6), 0.0),
        ("asin" | "acos" | "atanh", 0) => (r.between(-1.01, 1.01), 0.0),
        ("asin" | "acos" | "atanh", _) => (r.spread(-30.0, 0.01), 0.0),
        ("pow", 0) => (r.spread(-1074.0, 1024.0).abs(), r.spread(-30.0, 1.0)),
        ("pow", 1) => (r.between(0.5, 2.0), r.between(-1100.0, 1100.0)),
        ("pow", _) => (r.spread(-4.0, 4.0), r.between(-200.0, 200.0).round()),
        ("atan2", 0) => (r.spread(-1000.0, 1000.0), r.spread(-1000.0, 1000.0)),
        (_, 1) => (r.between(-10.0, 10.0), r.between(-10.0, 10.0)),
        _ => (r.spread(-40.0, 10.0), r.spread(-40.0, 10.0)),
    };
    (0..count).map(&mut one).collect()
}

#[test]
fn random_arguments_have_the_results_of_the_standard_library() {
    for (name, library, most) in FUNCTIONS {
        let arguments = arguments(name, 1_000_000);
        let found = values::<F64>(Workspace::new(), name, &arguments);
        let mut finite = 0;
        for (&(x, y), value) in arguments.iter().zip(found) {
            let expected = library(x, y);
            assert!(units(value, expected) <= most, "{name}({x:e}, {y:e}) is {expected:e}, not {value:e}");
            finite += usize::from(value.is_finite());
        }
        assert!(finite > 600_000, "only {finite} results of {name} are finite");
    }
}

#[test]
fn every_processor_gives_the_same_results() {
    for (name, ..) in FUNCTIONS {
        let arguments = arguments(name, 100_000);
        let wide = values::<F64>(Workspace::new(), name, &arguments);
        let baseline = values::<F64>(Workspace::baseline(), name, &arguments);
        for ((a, b), (x, y)) in wide.into_iter().zip(baseline).zip(arguments) {
            assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(), "{name}({x:e}, {y:e})");
        }
    }
}

#[test]
fn single_precision_is_rounded_from_double() {
    for (name, ..) in FUNCTIONS {
        let mut arguments = arguments(name, 100_000);
        for (x, y) in &mut arguments {
            (*x, *y) = (f64::from(*x as f32), f64::from(*y as f32));
        }
        let double = values::<F64>(Workspace::new(), name, &arguments);
        let single = values::<F32>(Workspace::new(), name, &arguments);
        for ((d, s), (x, y)) in double.into_iter().zip(single).zip(arguments) {
            let rounded = f64::from(d as f32);
            assert!(
                rounded == s || d.is_nan() && s.is_nan(),
                "{name}({x:e}, {y:e}) is {rounded:e}, not {s:e}"
            );
        }
    }
}
