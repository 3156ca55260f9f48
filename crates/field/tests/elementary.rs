//! The elementary functions over lanes: against exact results, the standard library, and themselves on other processors.

use fieldstone_field::*;

/// Name, and how far the standard library's results may be from those over lanes: the bound of these, one unit in the
/// last place, and the other's error.
const FUNCTIONS: [(&str, u64); 14] = [
    ("exp", 2),
    ("ln", 2),
    ("sin", 2),
    ("cos", 2),
    ("tan", 2),
    ("asin", 2),
    ("acos", 2),
    ("atan", 2),
    ("pow", 2),
    ("atan2", 2),
    ("sinh", 3),
    ("cosh", 3),
    ("tanh", 3),
    ("atanh", 3),
];

type Meaning = fn(f64, f64) -> f64;

/// The standard library's function.
fn library(name: &str) -> Meaning {
    match name {
        "exp" => |x, _| x.exp(),
        "ln" => |x, _| x.ln(),
        "sin" => |x, _| x.sin(),
        "cos" => |x, _| x.cos(),
        "tan" => |x, _| x.tan(),
        "asin" => |x, _| x.asin(),
        "acos" => |x, _| x.acos(),
        "atan" => |x, _| x.atan(),
        "sinh" => |x, _| x.sinh(),
        "cosh" => |x, _| x.cosh(),
        "tanh" => |x, _| x.tanh(),
        // Below 0 it loses the digits that 1 − |x| has less than x.
        "atanh" => |x, _| x.abs().atanh().copysign(x),
        "pow" => f64::powf,
        "atan2" => f64::atan2,
        _ => panic!("no function {name}"),
    }
}

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

/// Function, arguments, and the number nearest to the exact result.
fn table() -> Vec<(&'static str, (f64, f64), f64)> {
    let number = |word: &str| word.parse::<f64>().expect("a number");
    let line = |line: &'static str| match line.split(' ').collect::<Vec<_>>()[..] {
        [name, x, value] => (name, (number(x), 0.0), number(value)),
        [name, x, y, value] => (name, (number(x), number(y)), number(value)),
        _ => panic!("{line}: a name, one or two arguments, and a result"),
    };
    include_str!("elementary/table.txt").lines().map(line).collect()
}

#[test]
fn hard_arguments_have_exact_results_but_for_one_unit() {
    let table = table();
    assert!(table.len() > 600);
    for (name, _) in FUNCTIONS {
        let cases: Vec<_> = table.iter().filter(|case| case.0 == name).collect();
        assert!(cases.len() > 20, "{name} has {} cases", cases.len());
        let arguments: Vec<_> = cases.iter().map(|case| case.1).collect();
        let found = values::<F64>(Workspace::new(), name, &arguments);
        for (&&(_, (x, y), expected), value) in cases.iter().zip(found) {
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
    for (name, most) in FUNCTIONS {
        let (arguments, library) = (arguments(name, 1_000_000), library(name));
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
    for (name, _) in FUNCTIONS {
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
    for (name, _) in FUNCTIONS {
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
