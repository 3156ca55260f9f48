//! Blends: bounds, gradients, limits, and whose material a joint is.

mod kit;

use fieldstone_field::{Field, Graph, NodeId};
use fieldstone_solids::{Blend, Blended, Joint, gaussian, join, linear, sigmoid};
use kit::{at, ball, check, field};

const JOINTS: [Joint; 3] = [Joint::Union, Joint::Intersection, Joint::Difference];

type Make = fn(&mut Graph, [NodeId; 3]) -> Blend;

/// All blends, with parameters that change something between two balls that meet.
const BLENDS: [(&str, Make); 9] = [
    ("sharp", |_, _| Blend::Sharp),
    ("rvachev", |_, _| Blend::Rvachev),
    ("product", |g, _| Blend::Product { c: g.constant(0.05) }),
    ("hyperbolic", |g, _| Blend::Hyperbolic { c: g.constant(0.02) }),
    ("super-elliptic", |g, _| {
        let [a, b, p] = [0.6, 0.4, 2.0].map(|k| g.constant(k));
        Blend::SuperElliptic { a, b, p }
    }),
    ("displacement", |g, _| {
        let [a0, a1, a2] = [0.2, 0.5, 0.7].map(|k| g.constant(k));
        Blend::Displacement { a0, a1, a2 }
    }),
    ("bounded", |g, point| {
        let bound = ball(g, point, [0.0, 0.0, 0.6], 0.9);
        let [a0, b] = [0.2, 0.5].map(|k| g.constant(k));
        Blend::Bounded { a0, b, bound }
    }),
    ("quadratic", |g, _| Blend::Quadratic { k: g.constant(0.4) }),
    ("cubic", |g, _| Blend::Cubic { k: g.constant(0.4) }),
];

/// Two balls of radius 1 that meet.
fn balls(g: &mut Graph, point: [NodeId; 3]) -> [NodeId; 2] {
    [ball(g, point, [-0.6, 0.0, 0.0], 1.0), ball(g, point, [0.7, 0.1, 0.0], 1.0)]
}

fn blended(joint: Joint, make: Make, part: fn(Blended) -> NodeId) -> Field {
    field(|g, point| {
        let [f, h] = balls(g, point);
        let blend = make(g, point);
        part(join(g, joint, &blend, f, h))
    })
}

/// The values and shares of a blend where the fields have these values.
fn of_values(joint: Joint, make: impl Fn(&mut Graph) -> Blend, f: f64, g: f64) -> (f64, f64) {
    let mut graph = Graph::new();
    let [first, second] = [f, g].map(|k| graph.constant(k));
    let blend = make(&mut graph);
    let Blended { value, share } = join(&mut graph, joint, &blend, first, second);
    let known = |id| graph.constant_value(id).expect("all operands are constants");
    (known(value), known(share))
}

#[test]
fn bounds_hold_and_gradients_are_exact() {
    for (name, make) in BLENDS {
        for joint in JOINTS {
            check(&format!("{name} {joint:?}"), &blended(joint, make, |b| b.value), 2);
        }
    }
}

#[test]
fn added_material_lies_around_the_sharp_joint() {
    for (name, make) in BLENDS {
        for joint in JOINTS {
            let blend = blended(joint, make, |b| b.value);
            let sharp = blended(joint, |_, _| Blend::Sharp, |b| b.value);
            let mut random = kit::Random(3);
            let mut more = [0, 0];
            for _ in 0..2000 {
                let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
                let inside = [at(&blend, p) < 0.0, at(&sharp, p) < 0.0];
                more[0] += usize::from(inside[0] && !inside[1]);
                more[1] += usize::from(inside[1] && !inside[0]);
            }
            let is_sharp = ["sharp", "rvachev"].contains(&name);
            let grows = joint == Joint::Union || ["displacement", "bounded"].contains(&name);
            // What a union gains, its complements lose.
            let expected = [!is_sharp && grows, !is_sharp && !grows];
            assert_eq!(more.map(|n| n > 0), expected, "{name} {joint:?}: {more:?}");
        }
    }
}

#[test]
fn without_a_reach_blends_are_the_sharp_joint() {
    let pairs = [(0.3, 0.5), (-0.2, 0.1), (-0.7, -0.4), (0.25, 0.25), (0.0, 0.0), (1.0, -2.0)];
    for (f, g) in pairs {
        let sharp = |joint| of_values(joint, |_| Blend::Sharp, f, g).0;
        for joint in JOINTS {
            let zero = |g: &mut Graph| g.constant(0.0);
            for blend in [
                of_values(joint, |g| Blend::Hyperbolic { c: zero(g) }, f, g),
                of_values(joint, |g| Blend::Quadratic { k: zero(g) }, f, g),
                of_values(joint, |g| Blend::Cubic { k: zero(g) }, f, g),
            ] {
                assert!((blend.0 - sharp(joint)).abs() < 1e-15, "{joint:?} {f} {g}: {blend:?}");
            }
            // A product has another size, and the same sign.
            let product = of_values(joint, |g| Blend::Product { c: zero(g) }, f, g).0;
            assert!(product * sharp(joint) >= 0.0 && (product == 0.0) == (f == 0.0 || g == 0.0));
        }
    }
}

#[test]
fn beyond_their_reach_smooth_minima_are_minima() {
    for (f, g) in [(0.3, 0.9), (0.9, 0.3), (-1.0, 0.0), (0.4, 0.0)] {
        let k = |g: &mut Graph| g.constant(0.4);
        let quadratic = of_values(Joint::Union, |g| Blend::Quadratic { k: k(g) }, f, g);
        let cubic = of_values(Joint::Union, |g| Blend::Cubic { k: k(g) }, f, g);
        let share = f64::from(u8::from(g < f));
        assert_eq!([quadratic, cubic], [(f64::min(f, g), share); 2]);
    }
    let middle = of_values(Joint::Union, |g| Blend::Quadratic { k: g.constant(0.4) }, 0.1, 0.1);
    assert_eq!(middle, (0.1 - 0.1, 0.5));
    let middle = of_values(Joint::Union, |g| Blend::Cubic { k: g.constant(0.6) }, 0.1, 0.1);
    assert!(middle.0.abs() < 1e-15);
}

#[test]
fn bounded_blends_change_nothing_outside_of_their_bound() {
    let make = |bound: f64| {
        move |g: &mut Graph| {
            let [a0, b, bound] = [0.3, 0.5, bound].map(|k| g.constant(k));
            Blend::Bounded { a0, b, bound }
        }
    };
    for (f, g) in [(0.2, 0.3), (0.0, 0.0), (-0.1, 0.4)] {
        let plain = of_values(Joint::Union, |_| Blend::Rvachev, f, g).0;
        assert!((of_values(Joint::Union, make(0.2), f, g).0 - plain).abs() < 1e-14);
        let (w1, w2) = (f * f + g * g, 0.16);
        let expected = plain - 0.3 * 0.5 * w2 / (w1 + 0.5 * w2);
        assert!((of_values(Joint::Union, make(-0.4), f, g).0 - expected).abs() < 1e-12);
    }
}

#[test]
fn shares_go_from_the_first_material_to_the_second() {
    for (name, make) in BLENDS {
        for joint in JOINTS {
            let share = blended(joint, make, |b| b.share);
            let mut random = kit::Random(5);
            for _ in 0..500 {
                let p = [0; 3].map(|_| 3.0 * random.unit() - 1.5);
                assert!((0.0..=1.0).contains(&at(&share, p)), "{name} {joint:?} at {p:?}");
            }
        }
        // On the far side of either ball.
        let share = blended(Joint::Union, make, |b| b.share);
        let ends = [at(&share, [-1.59, 0.0, 0.0]), at(&share, [1.69, 0.1, 0.0])];
        assert!(ends[0] < 0.02 && ends[1] > 0.98, "{name}: {ends:?}");
    }
}

#[test]
fn a_metamorphosis_begins_with_the_first_solid_and_ends_with_the_second() {
    let solid = |weight: f64| {
        field(move |g, point| {
            let [f, h] = balls(g, point);
            let w = g.constant(weight);
            linear(g, f, h, w).value
        })
    };
    let p = [0.4, -0.9, 0.2];
    let first = at(&field(|g, point| balls(g, point)[0]), p);
    let second = at(&field(|g, point| balls(g, point)[1]), p);
    assert_eq!([at(&solid(0.0), p), at(&solid(1.0), p)], [first, second]);
    assert!((at(&solid(0.25), p) - (0.75 * first + 0.25 * second)).abs() < 1e-15);
}

#[test]
fn weights_are_exact_at_their_ends() {
    let weight = |make: fn(&mut Graph, NodeId, NodeId) -> NodeId, k: f64, t: f64| {
        let mut g = Graph::new();
        let [k, t] = [k, t].map(|c| g.constant(c));
        let id = make(&mut g, k, t);
        g.constant_value(id).expect("a constant")
    };
    for k in [0.5, 1.0, 3.7, 12.0, 80.0] {
        assert_eq!([0.0, 1.0, -3.0, 7.0].map(|t| weight(sigmoid, k, t)), [0.0, 1.0, 0.0, 1.0]);
        let logistic = |u: f64| 1.0 / (1.0 + (-u).exp());
        let t = 0.3;
        let written =
            (logistic(k * (t - 0.5)) - logistic(-k / 2.0)) / (logistic(k / 2.0) - logistic(-k / 2.0));
        assert!((weight(sigmoid, k, t) - written).abs() < 1e-14);
    }
    assert_eq!(weight(gaussian, 0.3, 0.0), 1.0);
    assert!((weight(gaussian, 0.5, 0.5) - (-0.5f64).exp()).abs() < 1e-15);
    check(
        "sigmoid",
        &field(|g, [x, _, _]| {
            let k = g.constant(5.0);
            sigmoid(g, k, x)
        }),
        2,
    );
    check(
        "gaussian",
        &field(|g, [x, _, _]| {
            let s = g.constant(0.5);
            gaussian(g, s, x)
        }),
        2,
    );
}
