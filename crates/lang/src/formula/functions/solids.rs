//! The functions of formulas that blend solids and make patterns.

use super::{Function, row};
use fieldstone_field::{Graph, NodeId};
use fieldstone_solids as solids;
use fieldstone_solids::{Blend, Joint};

/// One function for each joint, with the parameters of the blend behind the two solids.
macro_rules! blends {
    ($($union:literal $intersection:literal $difference:literal ($arguments:literal) $blend:expr;)*) => {
        &[$(
            row(&[$union], $arguments, |g, a| blended(g, Joint::Union, a, $blend)),
            row(&[$intersection], $arguments, |g, a| blended(g, Joint::Intersection, a, $blend)),
            row(&[$difference], $arguments, |g, a| blended(g, Joint::Difference, a, $blend)),
        )*]
    };
}

pub(super) static BLENDS: &[Function] = blends! {
    "union_product" "inter_product" "sub_product" ("f, g, c") |a| Blend::Product { c: a[0] };
    "union_hyperbolic" "inter_hyperbolic" "sub_hyperbolic" ("f, g, c") |a| Blend::Hyperbolic { c: a[0] };
    "union_elliptic" "inter_elliptic" "sub_elliptic" ("f, g, a, b, p")
        |a| Blend::SuperElliptic { a: a[0], b: a[1], p: a[2] };
    "union_pasko" "inter_pasko" "sub_pasko" ("f, g, a0, a1, a2")
        |a| Blend::Displacement { a0: a[0], a1: a[1], a2: a[2] };
    "union_bounded" "inter_bounded" "sub_bounded" ("f, g, h, a0, b")
        |a| Blend::Bounded { bound: a[0], a0: a[1], b: a[2] };
    "union_smooth" "inter_smooth" "sub_smooth" ("f, g, k") |a| Blend::Quadratic { k: a[0] };
    "union_cubic" "inter_cubic" "sub_cubic" ("f, g, k") |a| Blend::Cubic { k: a[0] };
};

pub(super) static PATTERNS: &[Function] = &[
    row(&["sigmoid"], "t, k", |g, a| solids::sigmoid(g, a[1], a[0])),
    row(&["gaussian"], "t, s", |g, a| solids::gaussian(g, a[1], a[0])),
    row(&["noise"], "x, y, z", |g, a| g.call(solids::gradient_noise(), a)),
    row(&["fbm"], "x, y, z, n", |g, a| fractal(g, a, solids::fractal_noise)),
    row(&["turbulence"], "x, y, z, n", |g, a| fractal(g, a, solids::turbulence)),
    row(&["marble"], "x, y, z, s", |g, a| solids::marble(g, point(a), a[3])),
    row(&["wood"], "x, y, z, s", |g, a| solids::wood(g, point(a), a[3])),
    row(&["checker"], "x, y, z", |g, a| solids::checker(g, point(a))),
];

fn blended(g: &mut Graph, joint: Joint, a: &[NodeId], blend: fn(&[NodeId]) -> Blend) -> NodeId {
    solids::join(g, joint, &blend(&a[2..]), a[0], a[1]).value
}

fn point(a: &[NodeId]) -> [NodeId; 3] {
    [a[0], a[1], a[2]]
}

/// Octaves of half the amplitude each.
fn fractal(
    g: &mut Graph,
    a: &[NodeId],
    sum: fn(&mut Graph, [NodeId; 3], NodeId, NodeId) -> NodeId,
) -> NodeId {
    let half = g.constant(0.5);
    sum(g, point(a), a[3], half)
}
