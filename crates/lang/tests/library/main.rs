//! Every function of the library in every domain: random boxes and spans of rays hold the values at their points, in
//! `f64` and `f32`, and gradients agree with differences.

mod cases;

use cases::{Case, Random, cases};
use fieldstone_field::{
    Affine, Affines, Engine, F32, F64, Field, Gradients, Interval, Intervals, LANES, Points, Precision,
    Scalar, Tape, TapeOptions, Workspace,
};
use fieldstone_lang::Dialect;

impl Random {
    /// From −2.5 to 2.5, often a round number, where functions have their kinks and jumps.
    fn coordinate(&mut self) -> f64 {
        let x = 5.0 * self.unit() - 2.5;
        if self.unit() < 0.2 { (2.0 * x).round() / 2.0 } else { x }
    }

    fn size(&mut self) -> f64 {
        10f64.powf(-7.0 * self.unit()) * 3.0
    }
}

/// Both dialects, where the function exists.
fn fields(case: &Case) -> impl Iterator<Item = Field> {
    let fields = [Dialect::Lenient, Dialect::Strict].map(|dialect| match case.field(dialect) {
        Ok(field) => Some(field),
        Err(message) => {
            let is_ours = ["hffmapblob", "hfcylx", "hfcyly", "hfcylz"].contains(&case.name);
            assert!(dialect == Dialect::Strict && is_ours, "{}: {message}", case.name);
            None
        }
    });
    fields.into_iter().flatten()
}

fn values(tape: &Tape, points: &[[f64; 3]]) -> Vec<f64> {
    let mut w = Workspace::<F64, Points>::new();
    let mut values = Vec::new();
    for block in points.chunks(LANES) {
        for axis in 0..3 {
            for (to, p) in w.input(axis, 0).iter_mut().zip(block) {
                *to = p[axis];
            }
        }
        w.run(tape, block.len());
        values.extend_from_slice(&w.output(0, 0)[..block.len()]);
    }
    values
}

/// Checks 64 boxes with 16 points each; returns how many have finite bounds.
fn check_boxes<P: Precision>(name: &str, tape: &Tape, random: &mut Random) -> usize
where
    Intervals: Engine<P>,
{
    let mut w = Workspace::<P, Intervals>::new();
    let boxes: Vec<[Interval<f64>; 3]> = (0..LANES)
        .map(|_| {
            let size = random.size();
            [0; 3].map(|_| {
                let lo = single(random.coordinate());
                Interval::new(lo, single(lo + size * random.unit()).max(lo))
            })
        })
        .collect();
    for (lane, b) in boxes.iter().enumerate() {
        for (axis, side) in b.iter().enumerate() {
            w.input(axis, 0)[lane] = Scalar::from_f64(side.lo);
            w.input(axis, 1)[lane] = Scalar::from_f64(side.hi);
        }
    }
    w.run(tape, LANES);
    let mut finite = 0;
    for (lane, b) in boxes.iter().enumerate() {
        let points: Vec<[f64; 3]> =
            (0..16).map(|_| b.map(|i| i.lo + (i.hi - i.lo) * random.unit())).collect();
        let bound = Interval::new(w.output(0, 0)[lane].to_f64(), w.output(0, 1)[lane].to_f64());
        finite += usize::from(bound.lo.is_finite() && bound.hi.is_finite());
        for (p, v) in points.iter().zip(values(tape, &points)) {
            assert!(bound.contains(v), "{name}: {v:e} escapes {bound:?} at {p:?} of {b:?}");
        }
    }
    finite
}

/// A number that `f32` holds, so that both precisions see the same boxes.
fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Checks 64 spans of rays with 16 points each; returns how many have a line.
fn check_spans(name: &str, tape: &Tape, random: &mut Random) -> usize {
    let mut w = Workspace::<F64, Affines>::new();
    let spans: Vec<_> = (0..LANES)
        .map(|_| {
            let origin = [0; 3].map(|_| random.coordinate());
            let direction = [0; 3].map(|_| random.unit() - 0.5);
            (origin, direction, random.size())
        })
        .collect();
    for (lane, (origin, direction, end)) in spans.iter().enumerate() {
        for axis in 0..3 {
            let form = Affine::along_ray(origin[axis], direction[axis], 0.0, *end);
            let components = [form.centre, form.slope, form.error, form.range.lo, form.range.hi];
            for (c, v) in components.into_iter().enumerate() {
                w.input(axis, c)[lane] = v;
            }
        }
    }
    w.run(tape, LANES);
    let mut lines = 0;
    for (lane, (origin, direction, end)) in spans.iter().enumerate() {
        let [centre, slope, error, lo, hi] = [0, 1, 2, 3, 4].map(|c| w.output(0, c)[lane]);
        let places: Vec<f64> = (0..16).map(|_| random.unit()).collect();
        let points: Vec<_> =
            places.iter().map(|t| [0, 1, 2].map(|k| origin[k] + direction[k] * (t * end))).collect();
        lines += usize::from(slope != 0.0 && error.is_finite());
        for ((t, p), v) in places.iter().zip(&points).zip(values(tape, &points)) {
            let range = Interval::new(lo, hi);
            assert!(range.contains(v), "{name}: {v:e} escapes {range:?} at {p:?}, span {end:e}");
            if error.is_finite() {
                let line = centre + slope * (2.0 * t - 1.0);
                // The place in the span is rounded when the point is made.
                let slack = error * (1.0 + 1e-6) + slope.abs() * 1e-14 * (1.0 + 4.0 / end);
                assert!((v - line).abs() <= slack, "{name}: {v:e} lies off {line:e} ± {error:e} at {p:?}");
            }
        }
    }
    lines
}

#[test]
fn bounds_hold_every_value() {
    let mut random = Random(1);
    for case in cases() {
        let (mut finite, mut lines) = (0, 0);
        for field in fields(&case) {
            let tape = Tape::new(&field, &TapeOptions::default());
            for _ in 0..6 {
                finite += check_boxes::<F64>(case.name, &tape, &mut random);
                check_boxes::<F32>(case.name, &tape, &mut random);
                lines += check_spans(case.name, &tape, &mut random);
            }
        }
        assert!(finite > 150, "{}: only {finite} boxes have finite bounds", case.name);
        let is_constant_in_pieces = ["set", "checker", "lookup", "circles", "crackles"];
        let needs_lines = !is_constant_in_pieces.iter().any(|part| case.name.contains(part));
        assert!(!needs_lines || lines > 100, "{}: only {lines} spans have a slope", case.name);
    }
}

#[test]
fn gradients_are_those_of_differences() {
    let mut random = Random(2);
    for case in cases() {
        for field in fields(&case) {
            let wrong = wrong_gradients(&field, &mut random);
            // Kinks and jumps are rare, but points are often placed on them.
            assert!(wrong <= 12, "{}: {wrong} of {LANES} gradients are wrong", case.name);
        }
    }
}

/// How many of 64 gradients differ from central differences where these agree with one another.
fn wrong_gradients(field: &Field, random: &mut Random) -> usize {
    let tape = Tape::new(field, &TapeOptions::default());
    let points: Vec<[f64; 3]> = (0..LANES).map(|_| [0; 3].map(|_| 5.0 * random.unit() - 2.5)).collect();
    let mut w = Workspace::<F64, Gradients>::new();
    for (lane, p) in points.iter().enumerate() {
        for (axis, &coordinate) in p.iter().enumerate() {
            for c in 0..4 {
                let seed = if c == 0 { coordinate } else { f64::from(u8::from(c == axis + 1)) };
                w.input(axis, c)[lane] = seed;
            }
        }
    }
    w.run(&tape, LANES);
    let is_wrong = |lane: usize, axis: usize| {
        let step = 1e-5;
        let near: Vec<[f64; 3]> = [-2.0, -1.0, 0.0, 1.0, 2.0]
            .map(|k| {
                let mut p = points[lane];
                p[axis] += k * step;
                p
            })
            .to_vec();
        let v = values(&tape, &near);
        let slope = (v[3] - v[1]) / (2.0 * step);
        let wide = (v[4] - v[0]) / (4.0 * step);
        let is_smooth = (slope - wide).abs() <= 1e-6 * slope.abs().max(1.0);
        let exact = w.output(0, axis + 1)[lane];
        is_smooth && (exact - slope).abs() > 1e-5 * slope.abs().max(1.0)
    };
    (0..LANES).filter(|&lane| (0..3).any(|axis| is_wrong(lane, axis))).count()
}
