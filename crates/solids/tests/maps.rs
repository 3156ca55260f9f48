//! Mappings of space: where points come from, bounds and gradients.

mod kit;

use fieldstone_field::{Field, Graph, NodeId};
use fieldstone_solids::{
    affine, bend, invert, mirror, mirror_across, moved, offset, polar_repeat, product, repeat, repeat_times,
    rotate, scale, shell, taper, translate, twist,
};
use kit::{Random, at, ball, check, coordinates, field};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

type Point = [NodeId; 3];

/// A lopsided solid: a ball away from the origin, and a half space, joined smoothly.
fn original() -> (Graph, NodeId) {
    let mut graph = Graph::new();
    let point = coordinates(&mut graph);
    let ball = ball(&mut graph, point, [0.6, 0.3, -0.2], 0.5);
    let floor = graph.add(point[0], point[2]);
    let value = graph.rmin(ball, floor);
    (graph, value)
}

fn of_original(map: impl FnOnce(&mut Graph, Point) -> Point) -> Field {
    let (program, value) = original();
    field(|g, point| {
        let place = map(g, point);
        moved(g, &program, &[value], place)[0]
    })
}

/// Checks that the mapped solid has at `image(p)` the value of the original at p.
fn check_image(
    name: &str,
    map: impl FnOnce(&mut Graph, Point) -> Point,
    image: impl Fn([f64; 3]) -> [f64; 3],
) -> Field {
    let (mapped, plain) = (of_original(map), of_original(|_, point| point));
    let mut random = Random(11);
    for _ in 0..200 {
        let p = [0; 3].map(|_| 2.0 * random.unit() - 1.0);
        let [a, b] = [at(&mapped, image(p)), at(&plain, p)];
        assert!((a - b).abs() < 1e-12, "{name} at {p:?}: {a} instead of {b}");
    }
    check(name, &mapped, 2);
    mapped
}

#[test]
fn rigid_motions_and_scalings_carry_points_along() {
    check_image(
        "translate",
        |g, p| {
            let by = [0.5, -1.0, 2.0].map(|k| g.constant(k));
            translate(g, p, by)
        },
        |[x, y, z]| [x + 0.5, y - 1.0, z + 2.0],
    );
    check_image(
        "scale",
        |g, p| {
            let by = [2.0, 0.5, -1.0].map(|k| g.constant(k));
            scale(g, p, by)
        },
        |[x, y, z]| [2.0 * x, 0.5 * y, -z],
    );
    for axis in 0..3 {
        check_image(
            "rotate",
            |g, p| {
                let angle = g.constant(FRAC_PI_2);
                rotate(g, p, axis, angle)
            },
            |p| {
                let mut q = p;
                (q[(axis + 1) % 3], q[(axis + 2) % 3]) = (-p[(axis + 2) % 3], p[(axis + 1) % 3]);
                q
            },
        );
    }
    // The inverse of p ↦ (2x + y, y, z − 1).
    let columns = [[0.5, 0.0, 0.0], [-0.5, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
    check_image("affine", |g, p| affine(g, p, columns), |[x, y, z]| [2.0 * x + y, y, z - 1.0]);
    check_image(
        "mirror across",
        |g, p| mirror_across(g, p, [0.6, 0.0, 0.8]),
        |[x, y, z]| {
            let height = 2.0 * (0.6 * x + 0.8 * z);
            [x - 0.6 * height, y, z - 0.8 * height]
        },
    );
}

#[test]
fn deformations_carry_points_along() {
    check_image(
        "twist",
        |g, p| {
            let rate = g.constant(0.7);
            twist(g, p, 2, rate)
        },
        |[x, y, z]| {
            let (sin, cos) = (0.7 * z).sin_cos();
            [x * cos - y * sin, x * sin + y * cos, z]
        },
    );
    check_image(
        "taper",
        |g, p| {
            let [from, to, first, last] = [-0.5, 0.5, 1.0, 2.0].map(|k| g.constant(k));
            taper(g, p, 2, [from, to], [first, last])
        },
        |[x, y, z]| {
            let factor = (z + 1.5).clamp(1.0, 2.0);
            [x * factor, y * factor, z]
        },
    );
    for curvature in [0.5, -0.25] {
        check_image(
            "bend",
            |g, p| {
                let curvature = g.constant(curvature);
                bend(g, p, curvature)
            },
            |[x, y, z]| {
                let (radius, angle) = (1.0 / curvature, x * curvature);
                [(radius - z) * angle.sin(), y, radius - (radius - z) * angle.cos()]
            },
        );
    }
    check_image(
        "invert",
        |g, p| {
            let radius = g.constant(1.5);
            invert(g, p, radius)
        },
        |p| {
            let factor = 2.25 / p.iter().map(|x| x * x).sum::<f64>();
            p.map(|x| x * factor)
        },
    );
}

#[test]
fn repetitions_have_the_same_value_everywhere_they_repeat() {
    let period = 1.25;
    let endless = of_original(|g, p| {
        let period = g.constant(period);
        repeat(g, p, 0, period)
    });
    let three = of_original(|g, p| {
        let [period, count] = [period, 1.0].map(|k| g.constant(k));
        repeat_times(g, p, 0, period, count)
    });
    let plain = of_original(|_, p| p);
    let p = [0.3, 0.2, -0.4];
    for k in -3i32..=3 {
        let q = [p[0] + period * f64::from(k), p[1], p[2]];
        assert!((at(&endless, q) - at(&plain, p)).abs() < 1e-12);
        let beyond = f64::from((k.abs() - 1).max(0) * k.signum());
        let expected = at(&plain, [p[0] + period * beyond, p[1], p[2]]);
        assert!((at(&three, q) - expected).abs() < 1e-12);
    }
    check("repeat", &endless, 2);
    check("repeat times", &three, 2);
    let mirrored = of_original(|g, p| mirror(g, p, 1));
    assert_eq!(at(&mirrored, [0.1, -0.7, 0.2]), at(&plain, [0.1, 0.7, 0.2]));
    check("mirror", &mirrored, 2);
}

#[test]
fn a_solid_stands_around_an_axis_as_often_as_asked() {
    let around = of_original(|g, p| {
        let count = g.constant(5.0);
        polar_repeat(g, p, 2, count)
    });
    let plain = of_original(|_, p| p);
    let (radius, start) = (0.8, 0.2);
    for k in 0..5 {
        let angle = start + TAU * f64::from(k) / 5.0;
        let q = [radius * angle.cos(), radius * angle.sin(), 0.1];
        let expected = at(&plain, [radius * start.cos(), radius * start.sin(), 0.1]);
        assert!((at(&around, q) - expected).abs() < 1e-12);
    }
    // Seam: as far from the middle of a sector as can be.
    assert!(at(&around, [-(PI / 5.0).cos(), 1e-3, 0.0]).is_finite());
    check("polar repeat", &around, 2);
}

#[test]
fn offsets_of_a_ball_are_balls_and_a_shell_is_as_thick_as_asked() {
    let solid = |make: fn(&mut Graph, NodeId, NodeId) -> NodeId, d: f64| {
        field(move |g, p| {
            let (ball, d) = (ball(g, p, [0.0; 3], 1.0), g.constant(d));
            make(g, ball, d)
        })
    };
    let grown = solid(offset, 0.25);
    assert_eq!([1.2, 1.25, 1.5].map(|x| at(&grown, [x, 0.0, 0.0]).signum()), [-1.0, 1.0, 1.0]);
    assert_eq!(at(&grown, [1.25, 0.0, 0.0]), 0.0);
    let wall = solid(shell, 0.2);
    for (x, value) in [(0.9, 0.0), (1.0, -0.1), (1.1, 0.0), (0.0, 0.9)] {
        assert!((at(&wall, [x, 0.0, 0.0]) - value).abs() < 1e-15);
    }
}

#[test]
fn a_product_is_inside_where_both_factors_are() {
    for sharp in [true, false] {
        let prism = field(|g, [x, y, z]| {
            let zero = g.constant(0.0);
            let disc = ball(g, [x, y, zero], [0.0; 3], 1.0);
            let slab = ball(g, [zero, zero, z], [0.0; 3], 0.5);
            product(g, disc, slab, sharp)
        });
        for (p, inside) in [([0.9, 0.0, 0.4], true), ([0.9, 0.0, 0.6], false), ([0.9, 0.9, 0.0], false)] {
            assert_eq!(at(&prism, p) < 0.0, inside);
        }
        check("product", &prism, 2);
    }
}
