//! Mappings of space: where points come from, bounds and gradients.

mod kit;

use fieldstone_field::{Field, Graph, NodeId};
use fieldstone_solids::{
    affine, bend, bend_normal, invert, invert_normal, mirror, mirror_across, mirror_normal, moved, offset,
    polar_repeat, polar_repeat_normal, product, repeat, repeat_onward, repeat_times, rotate, scale, shell,
    taper, taper_normal, translate, twist, twist_normal,
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
    let from_the_first = of_original(|g, p| {
        let [period, count] = [period, 3.0].map(|k| g.constant(k));
        repeat_onward(g, p, 0, period, count)
    });
    let p = [0.3, 0.2, -0.4];
    for k in -3i32..=3 {
        let q = [p[0] + period * f64::from(k), p[1], p[2]];
        assert!((at(&endless, q) - at(&plain, p)).abs() < 1e-12);
        let beyond = f64::from((k.abs() - 1).max(0) * k.signum());
        let expected = at(&plain, [p[0] + period * beyond, p[1], p[2]]);
        assert!((at(&three, q) - expected).abs() < 1e-12);
        let beyond = f64::from(k - k.clamp(0, 2));
        let expected = at(&plain, [p[0] + period * beyond, p[1], p[2]]);
        assert!((at(&from_the_first, q) - expected).abs() < 1e-12);
    }
    check("repeat", &endless, 2);
    check("repeat onward", &from_the_first, 2);
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

/// The gradient of a field by central differences.
fn gradient(field: &Field, p: [f64; 3]) -> [f64; 3] {
    const STEP: f64 = 1e-5;
    [0, 1, 2].map(|axis| {
        let [ahead, behind] = [STEP, -STEP].map(|step| {
            let mut q = p;
            q[axis] += step;
            at(field, q)
        });
        (ahead - behind) / (2.0 * STEP)
    })
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

type Place = (Point, Point);

/// How far the normals of the original, computed from those of the mapped solid, are from its own.
fn error_of_normals(
    map: impl Fn(&mut Graph, Point) -> Point,
    back: impl Fn(&mut Graph, Place) -> Point,
) -> f64 {
    let (mapped, plain) = (of_original(&map), of_original(|_, point| point));
    let mut random = Random(5);
    let mut worst = 0.0f64;
    for _ in 0..100 {
        let p = [0; 3].map(|_| random.coordinate() + 0.003);
        let n = unit(gradient(&mapped, p));
        let numbers = |component: usize, of_normal: bool| {
            at(
                &field(|g, point| {
                    let n = n.map(|k| g.constant(k));
                    if of_normal { back(g, (point, n))[component] } else { map(g, point)[component] }
                }),
                p,
            )
        };
        let place = [0, 1, 2].map(|k| numbers(k, false));
        let found = unit([0, 1, 2].map(|k| numbers(k, true)));
        let expected = unit(gradient(&plain, place));
        let error = [0, 1, 2].map(|k| (found[k] - expected[k]).abs());
        worst = error.into_iter().fold(worst, f64::max);
    }
    worst
}

#[test]
fn normals_of_the_original_come_from_those_of_the_mapped_solid() {
    let twisted = |g: &mut Graph, p: Point| {
        let rate = g.constant(0.7);
        twist(g, p, 2, rate)
    };
    let close = |error: f64| assert!(error < 1e-6, "{error}");
    close(error_of_normals(twisted, |g, place| {
        let rate = g.constant(0.7);
        twist_normal(g, place, rate)
    }));
    let numbers = |g: &mut Graph| [-0.5, 0.5, 1.0, 2.0].map(|k| g.constant(k));
    close(error_of_normals(
        |g, p| {
            let [from, to, first, last] = numbers(g);
            taper(g, p, 2, [from, to], [first, last])
        },
        |g, place| {
            let [from, to, first, last] = numbers(g);
            taper_normal(g, place, [from, to], [first, last])
        },
    ));
    for curvature in [0.4, -0.3] {
        close(error_of_normals(
            |g, p| {
                let curvature = g.constant(curvature);
                bend(g, p, curvature)
            },
            |g, place| {
                let curvature = g.constant(curvature);
                bend_normal(g, place, curvature)
            },
        ));
    }
    close(error_of_normals(|g, p| mirror(g, p, 2), mirror_normal));
    close(error_of_normals(
        |g, p| {
            let count = g.constant(5.0);
            polar_repeat(g, p, 2, count)
        },
        |g, place| {
            let count = g.constant(5.0);
            polar_repeat_normal(g, place, count)
        },
    ));
    close(error_of_normals(
        |g, p| {
            let radius = g.constant(1.5);
            invert(g, p, radius)
        },
        invert_normal,
    ));
    // A normal that is left as it is, is wrong.
    assert!(error_of_normals(twisted, |_, (_, n)| n) > 0.1);
}
