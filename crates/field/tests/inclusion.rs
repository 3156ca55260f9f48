//! Inclusion is sacred: random programs × random boxes × random points, in every domain, in `f64` and `f32`, and for
//! shortened programs.
//!
//! The programs are always the same. `FIELDSTONE_FUZZ=N` makes it N times as many, and `FIELDSTONE_SEED=S` others.

use fearless_simd::{Level, dispatch};
use fieldstone_field::*;

/// A small deterministic generator (SplitMix64), so that every run tests the same programs.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// How many rounds a test has.
fn rounds(usual: usize) -> usize {
    usual * variable("FIELDSTONE_FUZZ").unwrap_or(1) as usize
}

/// The programs of a test.
fn random(test: u64) -> Random {
    Random(test + (variable("FIELDSTONE_SEED").unwrap_or(0) << 32))
}

fn variable(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().expect("the variables of these tests are whole numbers"))
}

/// Constants that hurt: not in f32, tiny, huge, negative, zero.
const CONSTANTS: [f64; 14] =
    [0.1, -0.3, 1.0, 2.0, -1.0, 0.5, 3.7, 1.0 / 3.0, 1e-30, 1e20, 0.0, -7.25, 1e4, 16_777_217.0];

fn random_field(r: &mut Random, operations: usize) -> Field {
    let mut g = Graph::new();
    let mut nodes: Vec<NodeId> = (0..3).map(|i| g.input(Input::Coordinate(i))).collect();
    random_operations(r, &mut g, &mut nodes, operations / 2);
    if r.unit() < 0.2 {
        random_loop(r, &mut g, &mut nodes);
    }
    random_operations(r, &mut g, &mut nodes, operations.div_ceil(2));
    let value = *nodes.last().expect("there are nodes");
    Field::new(g, value, Vec::new())
}

/// One of the last nodes, or any.
fn recent(r: &mut Random, nodes: &[NodeId]) -> NodeId {
    let reach = if r.unit() < 0.7 { 4.min(nodes.len()) } else { nodes.len() };
    nodes[nodes.len() - 1 - r.below(reach)]
}

/// A loop of a few turns, which may leave early.
fn random_loop(r: &mut Random, g: &mut Graph, nodes: &mut Vec<NodeId>) {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let turns = g.constant(1.0 + r.below(5) as f64);
    let initial = [zero, recent(r, nodes), recent(r, nodes)];
    let id = g.begin_loop(&initial, None);
    let [count, a, b] = [0, 1, 2].map(|i| g.loop_var(id, i));
    let mut inner = nodes.clone();
    inner.extend([a, b]);
    let count_inside = 1 + r.below(4);
    random_operations(r, g, &mut inner, count_inside);
    let mut condition = g.lt(count, turns);
    if r.unit() < 0.5 {
        let bound = g.constant(r.pick(&CONSTANTS));
        let goes_on = g.lt(recent(r, &inner), bound);
        condition = g.min(condition, goes_on);
    }
    let next = [g.add(count, one), recent(r, &inner), recent(r, &inner)];
    let outputs = g.end_loop(id, condition, &next);
    nodes.extend(outputs);
}

fn random_operations(r: &mut Random, g: &mut Graph, nodes: &mut Vec<NodeId>, operations: usize) {
    for _ in 0..operations {
        let (a, b, c) = (recent(r, nodes), recent(r, nodes), recent(r, nodes));
        let node = match r.below(10) {
            0 | 1 => g.unary(r.pick(Unary::ALL), a),
            2..=5 => g.binary(r.pick(Binary::ALL), a, b),
            6 => {
                let k = g.constant(r.pick(&CONSTANTS));
                let op =
                    r.pick(&[Binary::Add, Binary::Mul, Binary::Sub, Binary::Pow, Binary::Div, Binary::Rem]);
                g.binary(op, a, k)
            }
            7 => g.powi(a, r.pick(&[-3, -2, 3, 4, 5, 8, 11, 200, 500])),
            8 => g.select(c, a, b),
            _ => g.binary(r.pick(&[Binary::Add, Binary::Mul, Binary::Min, Binary::Max, Binary::RMin]), a, b),
        };
        nodes.push(node);
    }
}

/// A box: a centre near or far, half widths from nothing to large.
fn random_box(r: &mut Random) -> [Interval<f64>; 3] {
    let far = r.pick(&[0.0, 0.0, 0.0, 1e4, -1e4, 1e-3]);
    let size = r.pick(&[0.0, 1e-9, 1e-3, 0.1, 1.0, 10.0, 1e3]);
    [0; 3].map(|_| {
        let centre = far + (r.unit() - 0.5) * 4.0;
        let half = size * r.unit();
        Interval::new(centre - half, centre + half)
    })
}

fn point_in(r: &mut Random, b: &[Interval<f64>; 3]) -> [f64; 3] {
    b.map(|i| {
        let t = if r.unit() < 0.4 { r.pick(&[0.0, 1.0, 0.5]) } else { r.unit() };
        (i.lo + (i.hi - i.lo) * t).clamp(i.lo, i.hi)
    })
}

/// The operations of a field with their values at a point and over a set, as text, for messages.
fn explain<D: Domain + std::fmt::Debug>(field: &Field, sets: [D; 3], p: &[f64; 3]) -> String
where
    D::Real: Real<Token = ()>,
{
    let graph = field.graph();
    let mut nodes = graph.reachable(&[field.value()]);
    nodes.retain(|n| !matches!(graph.node(*n), Node::LoopVar(..)));
    nodes.sort();
    let axis = |input| match input {
        Input::Coordinate(k) => usize::from(k),
        _ => 0,
    };
    let sets = reference::evaluate(graph, &nodes, (), |i| sets[axis(i)], 1000);
    let values: Vec<f64> = reference::evaluate(graph, &nodes, (), |i| p[axis(i)], 1000);
    let lines = nodes.iter().zip(sets.iter().zip(&values));
    lines.map(|(n, (set, v))| format!("{n:?} {:?} = {v:e} in {set:?}\n", graph.node(*n))).collect()
}

fn options(reading: Reading) -> TapeOptions {
    TapeOptions { reading, ..TapeOptions::default() }
}

fn values_at(tape: &Tape, points: &[[f64; 3]]) -> Vec<f64> {
    let mut w = Workspace::<F64, Points>::new();
    points
        .chunks(LANES)
        .flat_map(|block| {
            for axis in 0..3 {
                for (to, p) in w.input(axis, 0).iter_mut().zip(block) {
                    *to = p[axis];
                }
            }
            w.run(tape, block.len());
            w.output(0, 0)[..block.len()].to_vec()
        })
        .collect()
}

/// The ranges over boxes, in either precision; f32 boxes are widened so as to hold the f64 ones.
fn ranges<P: Precision>(
    tape: &Tape,
    boxes: &[[Interval<f64>; 3]],
    w: &mut Workspace<P, Intervals>,
) -> Vec<Interval<f64>>
where
    Intervals: Engine<P>,
{
    let single = size_of::<P::Scalar>() == 4;
    for axis in 0..3 {
        for (lane, b) in boxes.iter().enumerate() {
            let (mut lo, mut hi) = (b[axis].lo, b[axis].hi);
            if single {
                lo -= lo.abs() * 1.2e-7 + 1e-37;
                hi += hi.abs() * 1.2e-7 + 1e-37;
            }
            w.input(axis, 0)[lane] = Scalar::from_f64(lo);
            w.input(axis, 1)[lane] = Scalar::from_f64(hi);
        }
    }
    w.run_traced(tape, boxes.len());
    let (lo, hi) = (w.output(0, 0), w.output(0, 1));
    (0..boxes.len()).map(|i| Interval::new(lo[i].to_f64(), hi[i].to_f64())).collect()
}

fn same_sign(a: f64, b: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a < 0.0) == (b < 0.0) && (a > 0.0) == (b > 0.0)
}

/// The value at a point by the reference evaluator over lanes, whose elementary functions are not those of single
/// numbers, with the least instructions that the processor has.
fn reference_over_lanes(field: &Field, p: &[f64; 3]) -> f64 {
    dispatch!(Level::baseline(), simd => {
        let input = |i| match i {
            Input::Coordinate(k) => Wide64::splat(simd, p[usize::from(k)]),
            _ => Wide64::splat(simd, 0.0),
        };
        reference::evaluate(field.graph(), &[field.value()], simd, input, field.fuel())[0].lane(0)
    })
}

#[test]
fn lanes_agree_with_the_reference() {
    let mut r = random(1);
    for _ in 0..rounds(600) {
        let field = random_field(&mut r, 12);
        let tape = Tape::new(&field, &options(Reading::Value));
        let b = random_box(&mut r);
        let points: Vec<_> = (0..20).map(|_| point_in(&mut r, &b)).collect();
        for (p, v) in points.iter().zip(values_at(&tape, &points)) {
            let expected = reference_over_lanes(&field, p);
            assert!(v == expected || (v.is_nan() && expected.is_nan()), "{v} is not {expected} at {p:?}");
        }
    }
}

#[test]
fn intervals_hold_every_value() {
    let mut r = random(2);
    let (mut wide, mut single) = (Workspace::<F64, Intervals>::new(), Workspace::<F32, Intervals>::new());
    let mut baseline = Workspace::<F64, Intervals>::baseline();
    let mut bounded = 0;
    for round in 0..rounds(4000) {
        let field = random_field(&mut r, 2 + round % 14);
        let tape = Tape::new(&field, &options(Reading::Value));
        let boxes: Vec<_> = (0..8).map(|_| random_box(&mut r)).collect();
        let double = ranges(&tape, &boxes, &mut wide);
        assert_eq!(format!("{double:?}"), format!("{:?}", ranges(&tape, &boxes, &mut baseline)));
        let float = ranges(&tape, &boxes, &mut single);
        for (i, b) in boxes.iter().enumerate() {
            let points: Vec<_> = (0..24).map(|_| point_in(&mut r, b)).collect();
            for (p, v) in points.iter().zip(values_at(&tape, &points)) {
                assert!(
                    double[i].contains(v),
                    "{v:e} escapes {:?} at {p:?} of {b:?}\n{}",
                    double[i],
                    explain(&field, *b, p)
                );
                assert!(
                    float[i].contains(v),
                    "{v:e} escapes f32 {:?} at {p:?} of {b:?}\n{}",
                    float[i],
                    explain(&field, *b, p)
                );
            }
            bounded += usize::from(double[i].lo.is_finite());
        }
    }
    assert!(bounded > 8000, "only {bounded} boxes have a finite bound: the test shows nothing");
}

#[test]
fn affine_forms_hold_every_value() {
    let mut r = random(3);
    affine_holds::<F64>(&mut r, 1e-13);
    affine_holds::<F32>(&mut r, 1e-6);
}

fn affine_holds<P: Precision>(r: &mut Random, least_span: f64)
where
    Affines: Engine<P>,
{
    let mut w = Workspace::<P, Affines>::new();
    let mut sloped = 0;
    for round in 0..rounds(3000) {
        let field = random_field(r, 2 + round % 12);
        let tape = Tape::new(&field, &options(Reading::Value));
        let far = r.pick(&[0.0, 0.0, 1e4]);
        let origin = [0; 3].map(|_| far + (r.unit() - 0.5) * 4.0);
        let direction = [0; 3].map(|_| r.unit() - 0.5);
        let start = r.unit() * 3.0;
        let end = start + r.pick(&[least_span, 1e-4, 0.1, 1.0, 5.0]);
        // f32 rounds the ray itself: its spans are compared with f64 values of the rounded ray.
        let (origin, direction) = if size_of::<P::Scalar>() == 4 {
            (origin.map(|o| f64::from(o as f32)), direction.map(|d| f64::from(d as f32)))
        } else {
            (origin, direction)
        };
        let mut lifted = [Affine::from_interval(Interval::new(0.0, 0.0)); 3];
        for axis in 0..3 {
            // The lifted coordinate in f64, widened to the precision under test.
            let form = Affine::along_ray(origin[axis], direction[axis], start, end);
            let extra = if size_of::<P::Scalar>() == 4 {
                (form.centre.abs() + form.slope.abs()) * 2.4e-7 + 1e-37
            } else {
                0.0
            };
            let lo = form.range.lo - extra;
            let hi = form.range.hi + extra;
            lifted[axis] = form;
            for (c, v) in
                [form.centre, form.slope, form.error + extra, lo - lo.abs() * 2e-7, hi + hi.abs() * 2e-7]
                    .into_iter()
                    .enumerate()
            {
                w.input(axis, c)[0] = Scalar::from_f64(v);
            }
        }
        w.run(&tape, 1);
        let [c, s, e, lo, hi] = [0, 1, 2, 3, 4].map(|i| w.output(0, i)[0].to_f64());
        let places: Vec<f64> = (0..24).map(|i| if i < 2 { f64::from(i) } else { r.unit() }).collect();
        let points: Vec<_> = places
            .iter()
            .map(|t| {
                let t = start + (end - start) * t;
                [0, 1, 2].map(|a| origin[a] + direction[a] * t)
            })
            .collect();
        for ((t, p), v) in places.iter().zip(&points).zip(values_at(&tape, &points)) {
            assert!(
                Interval::new(lo, hi).contains(v),
                "{v:e} escapes [{lo:e}, {hi:e}] at {p:?}\n{}",
                explain(&field, lifted, p)
            );
            assert!(
                !lo.is_nan() || e.is_nan(),
                "a line where the value may be undefined\n{:?}",
                field.graph()
            );
            if !e.is_finite() {
                continue;
            }
            let line = c + s * (2.0 * t - 1.0);
            // The place in the span is itself rounded when the point is made.
            let slack = e + s.abs() * 1e-9 * (1.0 + start / (end - start)) + e.abs() * 1e-6;
            assert!(
                (v - line).abs() <= slack || !v.is_finite(),
                "{v:e} lies off the line {line:e} ± {e:e} at {p:?}\n{}",
                explain(&field, lifted, p)
            );
        }
        sloped += usize::from(s != 0.0);
    }
    assert!(sloped > 600, "only {sloped} forms have a slope: the test shows nothing");
}

#[test]
fn shortened_programs_agree_inside_their_region() {
    let mut r = random(4);
    let mut w = Workspace::<F64, Intervals>::new();
    let mut shortened = 0;
    for round in 0..rounds(3000) {
        let field = random_field(&mut r, 4 + round % 24);
        let boxes: Vec<_> = (0..4).map(|_| random_box(&mut r)).collect();
        for reading in [Reading::Value, Reading::Sign] {
            let tape = Tape::new(&field, &options(reading));
            ranges(&tape, &boxes, &mut w);
            for (lane, b) in boxes.iter().enumerate() {
                let short = tape.specialise(|place| w.choice(place, lane));
                shortened += usize::from(short.len() < tape.len());
                let points: Vec<_> = (0..16).map(|_| point_in(&mut r, b)).collect();
                for ((p, full), v) in
                    points.iter().zip(values_at(&tape, &points)).zip(values_at(&short, &points))
                {
                    let agree = match reading {
                        Reading::Value => full == v || (full.is_nan() && v.is_nan()),
                        Reading::Sign => same_sign(full, v),
                    };
                    assert!(
                        agree,
                        "{v:e} instead of {full:e} at {p:?} of {b:?} ({reading:?})\n{}",
                        explain(&field, *b, p)
                    );
                }
            }
        }
    }
    assert!(shortened > 2000, "only {shortened} programs became shorter: the test shows nothing");
}
