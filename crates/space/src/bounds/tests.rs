use super::*;
use fieldstone_field::{Graph, Input, NodeId};

/// A program in the making, with its coordinates.
struct Maker {
    graph: Graph,
    x: [NodeId; 3],
}

impl Maker {
    fn new() -> Self {
        let mut graph = Graph::new();
        let x = [0, 1, 2].map(|i| graph.input(Input::Coordinate(i)));
        Self { graph, x }
    }

    fn number(&mut self, k: f64) -> NodeId {
        self.graph.constant(k)
    }

    /// |point − centre| over the axes whose weight is not 0.
    fn distance(&mut self, centre: [f64; 3], weights: [f64; 3]) -> NodeId {
        let mut sum = self.number(0.0);
        for axis in 0..3 {
            let (c, w) = (self.number(centre[axis]), self.number(weights[axis]));
            let d = self.graph.sub(self.x[axis], c);
            let square = self.graph.square(d);
            let weighted = self.graph.mul(square, w);
            sum = self.graph.add(sum, weighted);
        }
        self.graph.sqrt(sum)
    }

    fn ball(&mut self, centre: [f64; 3], radius: f64) -> NodeId {
        let distance = self.distance(centre, [1.0; 3]);
        let r = self.number(radius);
        self.graph.sub(distance, r)
    }

    fn field(self, value: NodeId) -> Field {
        Field::new(self.graph, value, Vec::new())
    }
}

fn bounds(field: &Field) -> FoundBounds {
    solid_bounds(field, &Bindings::new())
}

/// The box holds the given one and exceeds it by at most 2 % of its longest side (8 % if
/// that is not proved).
fn assert_tight(found: &FoundBounds, lo: [f64; 3], hi: [f64; 3]) {
    assert_eq!(found.extent, Extent::Bounded);
    let slack = if found.proved { 0.021 } else { 0.08 } * Cell { lo, hi }.longest_side().1;
    for axis in 0..3 {
        assert!(found.min[axis] <= lo[axis] && found.min[axis] >= lo[axis] - slack, "{found:?}");
        assert!(found.max[axis] >= hi[axis] && found.max[axis] <= hi[axis] + slack, "{found:?}");
    }
}

/// No point with a negative value lies outside: samples in the cube of that half side.
fn assert_holds_all(field: &Field, found: &FoundBounds, half: f64) {
    let mut state = 0x9e37_79b9_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut inside = 0;
    for _ in 0..20_000 {
        let p = [0, 1, 2].map(|_| half * (2.0 * random() - 1.0));
        if field.at(&p, &Bindings::new())[0] < 0.0 {
            inside += 1;
            assert!((0..3).all(|a| found.min[a] <= p[a] && p[a] <= found.max[a]), "{p:?} {found:?}");
        }
    }
    assert!(inside > 20, "{inside}");
}

#[test]
fn balls_near_and_far_large_and_small() {
    let cases = [
        ([0.0; 3], 1.0),
        ([3.0, -2.0, 1.0], 0.001),
        ([0.0; 3], 9.99),
        ([0.0; 3], 12.0),
        ([300.0, -200.0, 500.0], 0.05),
        ([0.0, 0.0, 100.0], 850.0),
        ([9.0, 9.0, 9.0], 1.0),
    ];
    for (centre, radius) in cases {
        let mut maker = Maker::new();
        let ball = maker.ball(centre, radius);
        let found = bounds(&maker.field(ball));
        assert!(found.proved, "{centre:?} {radius}");
        assert_tight(&found, centre.map(|c| c - radius), centre.map(|c| c + radius));
    }
}

#[test]
fn torus() {
    let mut maker = Maker::new();
    // (1 − √(x²+y²))² + z² − 0.125: the tube is √0.125 thick.
    let ring = maker.distance([0.0; 3], [1.0, 1.0, 0.0]);
    let one = maker.number(1.0);
    let across = maker.graph.sub(one, ring);
    let (a, b) = (maker.graph.square(across), maker.graph.square(maker.x[2]));
    let sum = maker.graph.add(a, b);
    let c = maker.number(0.125);
    let torus = maker.graph.sub(sum, c);
    let field = maker.field(torus);
    let found = bounds(&field);
    let (r, t) = (1.0 + 0.125_f64.sqrt(), 0.125_f64.sqrt());
    assert!(found.proved);
    assert_tight(&found, [-r, -r, -t], [r, r, t]);
    assert_holds_all(&field, &found, 2.0);
}

#[test]
fn flat_faces_and_thin_shells_cost_no_more() {
    // A shell 0.001 thin, cut open by a half space.
    let mut maker = Maker::new();
    let outer = maker.ball([0.5, 0.0, 0.0], 2.0);
    let inner = maker.ball([0.5, 0.0, 0.0], 1.999);
    let hole = maker.graph.neg(inner);
    let shell = maker.graph.max(outer, hole);
    let cut = maker.graph.max(shell, maker.x[2]);
    let found = bounds(&maker.field(cut));
    assert!(found.proved);
    assert_tight(&found, [-1.5, -2.0, -2.0], [2.5, 2.0, 0.0]);

    // A plate.
    let mut maker = Maker::new();
    let sides = [3.0, 2.0, 0.005];
    let distances: Vec<NodeId> = (0..3)
        .map(|axis| {
            let magnitude = maker.graph.abs(maker.x[axis]);
            let side = maker.number(sides[axis]);
            maker.graph.sub(magnitude, side)
        })
        .collect();
    let plate = maker.graph.max(distances[0], distances[1]);
    let plate = maker.graph.max(plate, distances[2]);
    let found = bounds(&maker.field(plate));
    assert!(found.proved);
    assert_tight(&found, sides.map(|s| -s), sides);
}

#[test]
fn solids_in_several_pieces() {
    let mut maker = Maker::new();
    let (a, b) = (maker.ball([-4.0, 0.0, 0.0], 0.5), maker.ball([5.0, 6.0, -7.0], 0.02));
    let both = maker.graph.min(a, b);
    let found = bounds(&maker.field(both));
    assert!(found.proved);
    assert_tight(&found, [-4.5, -0.5, -7.02], [5.02, 6.02, 0.5]);
}

#[test]
fn loose_intervals_loosen_the_box_but_hold_everything() {
    // The tangle, whose intervals are so wide that the search is cut short.
    let mut maker = Maker::new();
    let mut sum = maker.number(11.8);
    for axis in 0..3 {
        let fourth = maker.graph.powi(maker.x[axis], 4);
        let square = maker.graph.square(maker.x[axis]);
        let five = maker.number(5.0);
        let five_squares = maker.graph.mul(square, five);
        let term = maker.graph.sub(fourth, five_squares);
        sum = maker.graph.add(sum, term);
    }
    let field = maker.field(sum);
    let found = bounds(&field);
    // x⁴ − 5x² is −6.25 at least, so that its largest x solves x⁴ − 5x² = 0.7.
    let reach = (2.5 + (6.25_f64 + 0.7).sqrt()).sqrt();
    assert!(found.proved);
    // Allowed to be as loose as boxes that are not proved.
    assert_tight(&FoundBounds { proved: false, ..found }, [-reach; 3], [reach; 3]);
    assert_holds_all(&field, &found, 3.0);
}

#[test]
fn without_an_end() {
    let mut maker = Maker::new();
    let half_space = maker.graph.neg(maker.x[1]);
    let plane = maker.field(half_space);
    let mut maker = Maker::new();
    let (ring, one) = (maker.distance([0.0; 3], [1.0, 1.0, 0.0]), maker.number(1.0));
    let cylinder = maker.graph.sub(ring, one);
    for field in [plane, maker.field(cylinder)] {
        let found = bounds(&field);
        assert_eq!((found.extent, found.min, found.max), (Extent::Unbounded, [-10.0; 3], [10.0; 3]));
    }
}

#[test]
fn far_out() {
    let solid = |centre: [f64; 3], radius: f64| {
        let mut maker = Maker::new();
        let ball = maker.ball(centre, radius);
        bounds(&maker.field(ball))
    };
    for (x, radius) in [(1500.0, 1200.0), (0.0, 2000.0), (5000.0, 4500.0), (-2e6, 100.0), (3e6, 2.9e6)] {
        let found = solid([x, 0.0, 0.0], radius);
        assert_eq!((found.extent, found.proved), (Extent::Bounded, true), "{x}");
        assert_tight(&found, [x - radius, -radius, -radius], [x + radius, radius, radius]);
    }
    let found = solid([0.0; 3], 1e8);
    assert_eq!((found.extent, found.max), (Extent::Unbounded, [10.0; 3]));
    // x > 50: none of it is within ±10.
    let mut maker = Maker::new();
    let fifty = maker.number(50.0);
    let half_space = maker.graph.sub(fifty, maker.x[0]);
    let found = bounds(&maker.field(half_space));
    assert_eq!((found.extent, found.min), (Extent::Unbounded, [-1000.0; 3]));
}

#[test]
fn without_an_inside() {
    let mut maker = Maker::new();
    let outside = maker.ball([0.0; 3], -1.0);
    let found = bounds(&maker.field(outside));
    assert_eq!((found.extent, found.proved), (Extent::Empty, true));
    assert_eq!((found.min, found.max), DEFAULT_BOUNDS);

    let mut maker = Maker::new();
    let zero = maker.number(0.0);
    assert_eq!(bounds(&maker.field(zero)).extent, Extent::Empty);
}

#[test]
fn without_a_value() {
    let mut maker = Maker::new();
    let (square, one) = (maker.graph.square(maker.x[0]), maker.number(1.0));
    let above = maker.graph.add(square, one);
    let below = maker.graph.neg(above);
    let undefined = maker.graph.sqrt(below);
    let found = bounds(&maker.field(undefined));
    assert_eq!((found.extent, found.proved), (Extent::Undefined, true));
}

#[test]
fn undefined_regions_do_not_count() {
    // ln(x) has no value for x ≤ 0: what is left of the ball is x > 0, and (ln x)² < 1 keeps 1/e < x.
    let mut maker = Maker::new();
    let ball = maker.ball([0.0; 3], 2.0);
    let log = maker.graph.ln(maker.x[0]);
    let square = maker.graph.square(log);
    let one = maker.number(1.0);
    let band = maker.graph.sub(square, one);
    let solid = maker.graph.max(ball, band);
    let field = maker.field(solid);
    let found = bounds(&field);
    let low = (-1.0_f64).exp();
    assert!(found.proved);
    assert_tight(
        &found,
        [low, -(4.0 - low * low).sqrt(), -(4.0 - low * low).sqrt()],
        [2.0, (4.0 - low * low).sqrt(), (4.0 - low * low).sqrt()],
    );
    assert_holds_all(&field, &found, 2.0);
}

#[test]
fn black_boxes_are_found_by_samples() {
    let field = Field::from_fn(|p| p[0] * p[0] + p[1] * p[1] + (p[2] - 2.0).powi(2) - 4.0);
    let found = bounds(&field);
    assert_eq!((found.extent, found.proved), (Extent::Bounded, false));
    assert_holds_all(&field, &found, 4.5);
    assert!(found.max[0] < 3.0 && found.min[0] > -3.0, "{found:?}");
}

#[test]
fn bindings_count() {
    let mut maker = Maker::new();
    let distance = maker.distance([0.0; 3], [1.0; 3]);
    let radius = maker.graph.input(Input::Parameter(0));
    let ball = maker.graph.sub(distance, radius);
    let field = maker.field(ball);
    for radius in [0.5, 3.0] {
        let mut bindings = Bindings::new();
        bindings.set(Input::Parameter(0), radius);
        assert_tight(&solid_bounds(&field, &bindings), [-radius; 3], [radius; 3]);
    }
}

#[test]
fn loops_that_intervals_cannot_follow() {
    // |z| after at most 8 turns of z² + c is below 2: about the Mandelbrot set, as a plate.
    let mut maker = Maker::new();
    let [cx, cy, cz] = maker.x;
    let g = &mut maker.graph;
    let zero = g.constant(0.0);
    let (limit, four, one, two) = (g.constant(8.0), g.constant(4.0), g.constant(1.0), g.constant(2.0));
    let l = g.begin_loop(&[zero, zero, zero], None);
    let [x, y, n] = [0, 1, 2].map(|i| g.loop_var(l, i));
    let (xx, yy, xy) = (g.square(x), g.square(y), g.mul(x, y));
    let r = g.add(xx, yy);
    let (small, early) = (g.lt(r, four), g.lt(n, limit));
    let go_on = g.mul(small, early);
    let (difference, double) = (g.sub(xx, yy), g.mul(two, xy));
    let next = [g.add(difference, cx), g.add(double, cy), g.add(n, one)];
    let out = g.end_loop(l, go_on, &next);
    let squares = [g.square(out[0]), g.square(out[1])];
    let size = g.add(squares[0], squares[1]);
    let escaped = g.sub(size, four);
    let height = g.square(cz);
    let thin = g.constant(0.09);
    let slab = g.sub(height, thin);
    let value = g.max(escaped, slab);
    let field = maker.field(value);
    let found = bounds(&field);
    assert_eq!(found.extent, Extent::Bounded);
    assert_holds_all(&field, &found, 2.2);
    assert!(found.min[0] < -1.9 && found.min[0] > -2.3, "{found:?}");
    assert!(found.max[2] < 0.52, "{found:?}");
}
