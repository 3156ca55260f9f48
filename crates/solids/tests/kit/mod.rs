//! What every solid must keep: bounds of boxes and spans hold its values, and gradients are those of differences.

#![allow(dead_code, reason = "not every test uses every tool")]

use fieldstone_field::{
    Affine, Affines, F64, Field, Function, Gradients, Graph, Input, Interval, Intervals, LANES, NodeId,
    Points, Tape, TapeOptions, Workspace,
};
use std::sync::Arc;

/// The generator SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From −2.5 to 2.5, often a round number, where functions have their kinks and jumps.
    pub(crate) fn coordinate(&mut self) -> f64 {
        let x = 5.0 * self.unit() - 2.5;
        if self.unit() < 0.2 { (2.0 * x).round() / 2.0 } else { x }
    }

    fn size(&mut self) -> f64 {
        10f64.powf(-7.0 * self.unit()) * 3.0
    }
}

pub(crate) fn coordinates(graph: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|k| graph.input(Input::Coordinate(k)))
}

pub(crate) fn field(build: impl FnOnce(&mut Graph, [NodeId; 3]) -> NodeId) -> Field {
    let mut graph = Graph::new();
    let point = coordinates(&mut graph);
    let value = build(&mut graph, point);
    Field::new(graph, value, Vec::new())
}

pub(crate) fn function(function: impl Function + 'static) -> Field {
    let function: Arc<dyn Function> = Arc::new(function);
    field(|graph, point| graph.call(&function, &point))
}

pub(crate) fn ball(graph: &mut Graph, at: [NodeId; 3], centre: [f64; 3], radius: f64) -> NodeId {
    let squares = [0, 1, 2].map(|k| {
        let c = graph.constant(centre[k]);
        let d = graph.sub(at[k], c);
        graph.square(d)
    });
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let (length, radius) = (graph.sqrt(sum), graph.constant(radius));
    graph.sub(length, radius)
}

pub(crate) fn at(field: &Field, point: [f64; 3]) -> f64 {
    values(&Tape::new(field, &TapeOptions::default()), &[point])[0]
}

pub(crate) fn values(tape: &Tape, points: &[[f64; 3]]) -> Vec<f64> {
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

/// Checks a field in everything; `name` stands in messages. Returns how many boxes have finite bounds and how many spans
/// a line.
pub(crate) fn check(name: &str, field: &Field, rounds: usize) -> (usize, usize) {
    let mut random = Random(7);
    let tape = Tape::new(field, &TapeOptions::default());
    let (mut finite, mut lines) = (0, 0);
    for _ in 0..rounds {
        finite += check_boxes(name, &tape, &mut random);
        lines += check_spans(name, &tape, &mut random);
    }
    let wrong = wrong_gradients(field, &mut random);
    assert!(wrong <= 3, "{name}: {wrong} of {LANES} gradients are wrong");
    assert!(finite > rounds * LANES / 3, "{name}: only {finite} boxes have finite bounds");
    (finite, lines)
}

fn check_boxes(name: &str, tape: &Tape, random: &mut Random) -> usize {
    let mut w = Workspace::<F64, Intervals>::new();
    let boxes: Vec<[Interval<f64>; 3]> = (0..LANES)
        .map(|_| {
            let size = random.size();
            [0; 3].map(|_| {
                let lo = random.coordinate();
                Interval::new(lo, (lo + size * random.unit()).max(lo))
            })
        })
        .collect();
    for (lane, b) in boxes.iter().enumerate() {
        for (axis, side) in b.iter().enumerate() {
            (w.input(axis, 0)[lane], w.input(axis, 1)[lane]) = (side.lo, side.hi);
        }
    }
    w.run(tape, LANES);
    let mut finite = 0;
    for (lane, b) in boxes.iter().enumerate() {
        let points: Vec<[f64; 3]> =
            (0..12).map(|_| b.map(|i| (i.lo + (i.hi - i.lo) * random.unit()).min(i.hi))).collect();
        let bound = Interval::new(w.output(0, 0)[lane], w.output(0, 1)[lane]);
        finite += usize::from(bound.lo.is_finite() && bound.hi.is_finite());
        for (p, v) in points.iter().zip(values(tape, &points)) {
            assert!(bound.contains(v), "{name}: {v:e} escapes {bound:?} at {p:?} of {b:?}");
        }
    }
    finite
}

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
        let places: Vec<f64> = (0..12).map(|_| random.unit()).collect();
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
