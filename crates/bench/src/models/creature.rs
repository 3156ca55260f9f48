//! A frog: round parts that flow into each other, −ln Σ exp(−k·dᵢ) / k.

use crate::program::{Program, Value};

/// How sharply parts meet: the larger, the sharper.
const SHARPNESS: f64 = 14.0;

type Point = [f64; 3];

/// A part of the frog.
enum Part {
    /// Centre and radii.
    Ellipsoid(Point, Point),
    /// From a point to a point, with a radius.
    Limb(Point, Point, f64),
}
use Part::{Ellipsoid, Limb};

/// What lies in the middle.
const MIDDLE: [Part; 3] = [
    Ellipsoid([0.0, 0.3, 0.5], [0.55, 0.85, 0.4]),
    Ellipsoid([0.0, -0.68, 0.72], [0.5, 0.45, 0.27]),
    Ellipsoid([0.0, -0.2, 0.52], [0.45, 0.5, 0.36]),
];

/// What is on the right; the left is its mirror image. The nose looks along −y.
const RIGHT: [Part; 13] = [
    Ellipsoid([0.3, -0.62, 0.95], [0.17, 0.17, 0.16]),
    Limb([0.45, 0.85, 0.42], [0.95, 0.15, 0.5], 0.2),
    Limb([0.95, 0.15, 0.45], [0.82, 0.95, 0.2], 0.12),
    Limb([0.82, 0.95, 0.12], [1.08, 0.3, 0.08], 0.08),
    Limb([1.08, 0.3, 0.06], [0.92, 0.02, 0.05], 0.05),
    Limb([1.08, 0.3, 0.06], [1.14, -0.06, 0.05], 0.05),
    Limb([1.08, 0.3, 0.06], [1.34, 0.04, 0.05], 0.05),
    Limb([0.4, -0.35, 0.45], [0.78, -0.28, 0.32], 0.12),
    Limb([0.78, -0.28, 0.32], [0.66, -0.72, 0.08], 0.085),
    Limb([0.66, -0.72, 0.06], [0.5, -0.94, 0.05], 0.05),
    Limb([0.66, -0.72, 0.06], [0.7, -1.0, 0.05], 0.05),
    Limb([0.66, -0.72, 0.06], [0.9, -0.92, 0.05], 0.05),
    Ellipsoid([0.2, 1.0, 0.45], [0.25, 0.2, 0.2]),
];

/// The frog sits on z = 0.
pub(super) fn frog(program: &Program) -> Option<Value<'_>> {
    let point = program.point();
    let parts = RIGHT.iter().flat_map(|part| [mirrored(part, 1.0), mirrored(part, -1.0)]);
    let parts = MIDDLE.iter().map(|part| mirrored(part, 1.0)).chain(parts);
    let weights: Vec<Value> =
        parts.map(|part| (distance(program, point, &part) * -SHARPNESS).exp()).collect();
    let skin = program.sum(&weights)?.ln() * (-1.0 / SHARPNESS);
    let [x, y, z] = point;
    let eye = |side: f64| ball([x - side * 0.36, y - -0.68, z - 0.99]) - 0.12;
    let pupil = |side: f64| ball([x - side * 0.43, y - -0.77, z - 1.0]) - 0.045;
    let lips = z.slab(0.66, 0.012).max(y - -0.72);
    let throat = ball([x, (y - -0.6) * 0.9, (z - 0.66) * 2.0]) - 0.42;
    let mouth = lips.without(throat);
    let head = skin.without(mouth);
    let eyes = eye(1.0).min(eye(-1.0)).without(pupil(1.0).min(pupil(-1.0)));
    Some(head.min(eyes))
}

fn mirrored(part: &Part, side: f64) -> Part {
    let place = |p: &Point| [side * p[0], p[1], p[2]];
    match part {
        Ellipsoid(centre, radii) => Ellipsoid(place(centre), *radii),
        Limb(from, to, radius) => Limb(place(from), place(to), *radius),
    }
}

/// About the distance from a part.
fn distance<'p>(program: &'p Program, [x, y, z]: [Value<'p>; 3], part: &Part) -> Value<'p> {
    match *part {
        Ellipsoid(centre, radii) => {
            let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
            let scaled = [(x, 0), (y, 1), (z, 2)].map(|(a, i)| (a - centre[i]) * (1.0 / radii[i]));
            (ball(scaled) - 1.0) * least
        }
        Limb(from, to, radius) => {
            let along = [0, 1, 2].map(|i| to[i] - from[i]);
            let length = along.iter().map(|d| d * d).sum::<f64>();
            let [u, v, w] = [(x, 0), (y, 1), (z, 2)].map(|(a, i)| a - from[i]);
            let share = u * (along[0] / length) + v * (along[1] / length) + w * (along[2] / length);
            let share = share.max(program.constant(0.0)).min(program.constant(1.0));
            ball([u - share * along[0], v - share * along[1], w - share * along[2]]) - radius
        }
    }
}

fn ball([x, y, z]: [Value<'_>; 3]) -> Value<'_> {
    (x.square() + y.square() + z.square()).sqrt()
}
