//! The simple bodies that shapes are made of.

use glam::{DMat3, DVec2, DVec3};

/// A place with axes and a size: what is at p in a shape is at origin + axes · p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where the shape's own origin is.
    pub origin: DVec3,
    /// The shape's x, y and z as columns: at right angles to each other, all as long as the shape is scaled.
    pub axes: DMat3,
}

impl Frame {
    pub(super) fn size(&self) -> f64 {
        self.axes.x_axis.length()
    }

    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        self.origin + self.axes * p
    }
}

/// A frame with what is asked of it for every cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat {
    frame: Frame,
    size: f64,
    /// The axes of unit length.
    turn: DMat3,
    /// From directions in the volume to those of the shape.
    pub(super) inverse: DMat3,
}

impl From<Frame> for Seat {
    fn from(frame: Frame) -> Self {
        let size = frame.size();
        let (turn, inverse) = (frame.axes * size.recip(), frame.axes.transpose() * (size * size).recip());
        Self { frame, size, turn, inverse }
    }
}

impl Seat {
    /// A point in the shape's own coordinates.
    pub(super) fn inside(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.frame.origin)
    }
}

/// A line from one ball to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    pub(super) ends: [DVec3; 2],
    pub(super) radii: [f64; 2],
    /// The way along it over its squared length.
    pub(super) share: DVec3,
    /// Where the radius changes, the surface is nearer than straight on: by this factor.
    nearer: f64,
}

impl Rod {
    pub(super) fn new(ends: [DVec3; 2], radii: [f64; 2]) -> Self {
        let along = ends[1] - ends[0];
        let share = along / along.length_squared().max(f64::MIN_POSITIVE);
        let slope = (radii[1] - radii[0]).abs() / along.length().max(f64::MIN_POSITIVE);
        Self { ends, radii, share, nearer: (1.0 + slope * slope).sqrt().recip() }
    }

    /// The distance, and the way from the line.
    fn away(&self, p: DVec3) -> (f64, DVec3) {
        let ([a, b], [start, end]) = (self.ends, self.radii);
        let s = (p - a).dot(self.share).clamp(0.0, 1.0);
        let away = p - (a + s * (b - a));
        ((away.length() - (start + s * (end - start))) * self.nearer, away)
    }
}

/// All points that are no farther from a triangle than `half`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plate {
    pub(super) edges: [Edge; 3],
    /// Unit; 0 for a triangle without an area.
    pub(super) normal: DVec3,
    pub(super) half: f64,
    axis: DVec3,
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) from: DVec3,
    pub(super) along: DVec3,
    /// The way along it over its squared length.
    share: DVec3,
    /// A direction in the plane of the triangle, to its inside.
    pub(super) inward: DVec3,
}

impl Plate {
    fn new([a, b, c]: [DVec3; 3], half: f64, axis: DVec3) -> Self {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let edge = |from: DVec3, to: DVec3| {
            let along = to - from;
            let share = along / along.length_squared().max(f64::MIN_POSITIVE);
            Edge { from, along, share, inward: normal.cross(along) }
        };
        Self { edges: [edge(a, b), edge(b, c), edge(c, a)], normal, half, axis }
    }

    /// Above the triangle the plane is nearest, beside it one of its edges.
    fn nearest(&self, p: DVec3) -> Nearest {
        let is_above = self.edges.iter().all(|edge| edge.inward.dot(p - edge.from) >= 0.0);
        let away = if is_above && self.normal != DVec3::ZERO {
            self.normal * (p - self.edges[0].from).dot(self.normal)
        } else {
            let [first, second, third] = self.edges.map(|edge| {
                let way = p - edge.from;
                way - edge.along * way.dot(edge.share).clamp(0.0, 1.0)
            });
            let nearer = |a: DVec3, b: DVec3| if b.length_squared() < a.length_squared() { b } else { a };
            nearer(nearer(first, second), third)
        };
        let length = away.length();
        let normal = if length > 0.0 { away / length } else { self.normal };
        Nearest { distance: length - self.half, normal }
    }
}

/// A body, closed and opaque.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    Ellipsoid {
        seat: Seat,
        radii: DVec3,
    },
    /// A cone cut off: from z = 0, where its radius is `radii[0]`, to `height`.
    Frustum {
        seat: Seat,
        radii: [f64; 2],
        height: f64,
    },
    Box {
        seat: Seat,
        half: DVec3,
    },
    /// All points that are no farther from a line than a radius that goes evenly from one end to the other.
    Capsule(Rod),
    Plate(Plate),
}

/// A body as it is, and as it is sampled: at least as thick as rays can find, with the share of its shadow that
/// the real one throws.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) piece: Piece,
    pub(super) sampled: (Piece, f64),
}

impl Body {
    /// `least` is the least radius that is sampled.
    pub(super) fn new(piece: &Piece, least: f64) -> Self {
        Self { piece: piece.clone(), sampled: piece.widened(least) }
    }
}

/// The nearest surface: how far it is (below 0 inside), no more than it really is, and the direction away from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) distance: f64,
    pub(super) normal: DVec3,
}

impl Piece {
    pub(super) fn capsule(ends: [DVec3; 2], radii: [f64; 2]) -> Self {
        Self::Capsule(Rod::new(ends, radii))
    }

    pub(super) fn plate(corners: [DVec3; 3], half: f64, axis: DVec3) -> Self {
        Self::Plate(Plate::new(corners, half, axis))
    }

    pub(super) fn nearest(&self, p: DVec3) -> Nearest {
        match self {
            Self::Ellipsoid { seat, radii } => placed(seat, ellipsoid(seat.inside(p), *radii)),
            Self::Frustum { seat, radii, height } => placed(seat, frustum(seat.inside(p), *radii, *height)),
            Self::Box { seat, half } => placed(seat, cuboid(seat.inside(p), *half)),
            Self::Capsule(rod) => {
                let (distance, away) = rod.away(p);
                Nearest { distance, normal: away.normalize_or(DVec3::Z) }
            }
            Self::Plate(plate) => plate.nearest(p),
        }
    }

    /// Whether nothing of the body is in a cube, from its centre and half its side, also if a rod is widened by `slack`. It may
    /// say no where it is so.
    pub(super) fn misses(&self, centre: DVec3, half: f64, slack: f64) -> bool {
        match self {
            Self::Ellipsoid { seat, radii } => {
                // No point of a convex body is beyond the plane that touches it across a direction.
                let p = seat.inside(centre);
                let across = (p / (*radii * *radii)).normalize_or_zero();
                let gap = (across.dot(p) - (across * *radii).length()) * seat.size;
                gap > half * (seat.turn * across).abs().element_sum() + 1e-3 * slack
            }
            other => {
                let away = other.nearest(centre).normal;
                let slack = if matches!(other, Self::Capsule(_)) { slack } else { 1e-3 * slack };
                away.dot(centre) - other.reach(away) > half * away.abs().element_sum() + slack
            }
        }
    }

    /// How far the body, or something around it, reaches in a unit direction.
    fn reach(&self, w: DVec3) -> f64 {
        let seated = |seat: &Seat, of: fn(DVec3, DVec3) -> f64, sizes: DVec3| {
            w.dot(seat.frame.origin) + seat.size * of(seat.turn.transpose() * w, sizes)
        };
        match self {
            Self::Ellipsoid { seat, radii } => seated(seat, |w, radii| (w * radii).length(), *radii),
            Self::Box { seat, half } => seated(seat, |w, half| w.abs().dot(half), *half),
            Self::Frustum { seat, radii, height } => {
                let rims = |w: DVec3, sizes: DVec3| {
                    let across = w.truncate().length();
                    (across * sizes.x).max(across * sizes.y + w.z * sizes.z)
                };
                seated(seat, rims, DVec3::new(radii[0], radii[1], *height))
            }
            Self::Capsule(Rod { ends: [a, b], radii: [start, end], .. }) => {
                (w.dot(*a) + start).max(w.dot(*b) + end)
            }
            Self::Plate(Plate { edges, half, .. }) => {
                edges.iter().map(|edge| w.dot(edge.from)).fold(f64::NEG_INFINITY, f64::max) + half
            }
        }
    }

    /// The direction along the body.
    pub(super) fn axis(&self) -> DVec3 {
        match self {
            Self::Ellipsoid { seat, .. } | Self::Frustum { seat, .. } | Self::Box { seat, .. } => {
                seat.frame.axes.z_axis.normalize_or(DVec3::Z)
            }
            Self::Capsule(Rod { ends: [a, b], .. }) => (*b - *a).normalize_or(DVec3::Z),
            Self::Plate(plate) => plate.axis,
        }
    }

    /// A body at least as thick as can be sampled, and the share of its shadow that the real one throws.
    fn widened(&self, least: f64) -> (Self, f64) {
        match self {
            Self::Capsule(Rod { ends, radii, .. }) if radii[0].max(radii[1]) < least => {
                let share = 0.5 * (radii[0] + radii[1]) / least;
                (Self::capsule(*ends, [least; 2]), share)
            }
            other => (other.clone(), 1.0),
        }
    }

    /// Two corners of a box that holds the body.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let around = |centre: DVec3, reach: DVec3| [centre - reach, centre + reach];
        let turned = |Seat { frame, .. }: &Seat, half: DVec3| {
            let [x, y, z] = [frame.axes.x_axis, frame.axes.y_axis, frame.axes.z_axis].map(DVec3::abs);
            x * half.x + y * half.y + z * half.z
        };
        match self {
            Self::Ellipsoid { seat, radii } => around(seat.frame.origin, turned(seat, *radii)),
            Self::Box { seat, half } => around(seat.frame.origin, turned(seat, *half)),
            Self::Frustum { seat, radii, height } => {
                let radius = radii[0].max(radii[1]);
                let centre = seat.frame.point(DVec3::Z * (0.5 * height));
                around(centre, turned(seat, DVec3::new(radius, radius, 0.5 * height)))
            }
            Self::Capsule(Rod { ends: [a, b], radii, .. }) => {
                let radius = DVec3::splat(radii[0].max(radii[1]));
                [a.min(*b) - radius, a.max(*b) + radius]
            }
            Self::Plate(Plate { edges, half, .. }) => {
                let [a, b, c] = edges.map(|edge| edge.from);
                [a.min(b).min(c) - *half, a.max(b).max(c) + *half]
            }
        }
    }
}

fn placed(seat: &Seat, nearest: Nearest) -> Nearest {
    Nearest { distance: nearest.distance * seat.size, normal: seat.turn * nearest.normal }
}

/// The distance is that in the space in which the ellipsoid is a ball, times the shortest radius, or that of the box around it:
/// never too large. Beside a flat ellipsoid the first is much too small.
fn ellipsoid(p: DVec3, radii: DVec3) -> Nearest {
    let scaled = p / radii;
    let of_ball = (scaled.length() - 1.0) * radii.min_element();
    let of_box = (p.abs() - radii).max(DVec3::ZERO);
    let distance = if of_box == DVec3::ZERO { of_ball } else { of_ball.max(of_box.length()) };
    Nearest { distance, normal: (scaled / radii).normalize_or(DVec3::Z) }
}

/// In the plane through the axis, the frustum is a polygon of three edges beside the axis.
fn frustum(p: DVec3, [low, high]: [f64; 2], height: f64) -> Nearest {
    let q = DVec2::new((p.x * p.x + p.y * p.y).sqrt(), p.z);
    let corners = [DVec2::ZERO, DVec2::new(low, 0.0), DVec2::new(high, height), DVec2::new(0.0, height)];
    let mut best = (f64::INFINITY, DVec2::Y);
    let mut inside = true;
    for pair in corners.windows(2) {
        let edge = pair[1] - pair[0];
        let length_squared = edge.length_squared();
        if length_squared == 0.0 {
            continue;
        }
        let outward = DVec2::new(edge.y, -edge.x) / length_squared.sqrt();
        inside &= (q - pair[0]).dot(outward) <= 0.0;
        let s = ((q - pair[0]).dot(edge) / length_squared).clamp(0.0, 1.0);
        let away = q - (pair[0] + s * edge);
        if away.length() < best.0 {
            best = (away.length(), if s > 0.0 && s < 1.0 { outward } else { away.normalize_or(outward) });
        }
    }
    let out = DVec3::new(p.x, p.y, 0.0).normalize_or(DVec3::X);
    let distance = if inside { -best.0 } else { best.0 };
    Nearest { distance, normal: best.1.x * out + best.1.y * DVec3::Z }
}

fn cuboid(p: DVec3, half: DVec3) -> Nearest {
    let q = p.abs() - half;
    let outside = q.max(DVec3::ZERO);
    let sign = DVec3::new(1f64.copysign(p.x), 1f64.copysign(p.y), 1f64.copysign(p.z));
    if outside != DVec3::ZERO {
        return Nearest { distance: outside.length(), normal: outside.normalize() * sign };
    }
    let largest = q.max_element();
    let face = if q.x == largest {
        DVec3::X
    } else if q.y == largest {
        DVec3::Y
    } else {
        DVec3::Z
    };
    Nearest { distance: largest, normal: face * sign }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::unit;
    use crate::paint::crossing::{Meets, Stretch, meets};

    fn pieces() -> Vec<Piece> {
        let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4) * 0.5;
        let seat = Seat::from(Frame { origin: DVec3::new(0.1, 0.2, -0.1), axes: turn });
        let corners = [DVec3::ZERO, DVec3::new(0.5, 0.1, 0.0), DVec3::new(0.1, 0.4, 0.3)];
        vec![
            Piece::Ellipsoid { seat, radii: DVec3::new(0.3, 0.6, 0.9) },
            Piece::Frustum { seat, radii: [0.6, 0.2], height: 0.8 },
            Piece::Frustum { seat, radii: [0.5, 0.0], height: 0.7 },
            Piece::Box { seat, half: DVec3::new(0.2, 0.4, 0.7) },
            Piece::capsule([DVec3::ZERO, DVec3::new(0.3, 0.4, 0.2)], [0.1, 0.02]),
            Piece::plate(corners, 0.05, DVec3::X),
        ]
    }

    fn point(i: u64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| 2.0 * unit(3, &[i, axis]) - 1.0))
    }

    #[test]
    fn no_distance_is_too_long() {
        for piece in pieces() {
            for i in 0..4000 {
                let (p, q) = (point(2 * i), point(2 * i) + 0.2 * point(2 * i + 1));
                let change = (piece.nearest(p).distance - piece.nearest(q).distance).abs();
                assert!(change <= (p - q).length() * (1.0 + 1e-9), "{piece:?} at {p} and {q}: {change}");
            }
        }
    }

    #[test]
    fn normals_are_the_slopes_of_distances() {
        let step = 1e-6;
        for piece in pieces().into_iter().skip(1) {
            let mut agree = 0;
            for i in 0..1000 {
                let p = point(i);
                let at = |axis: DVec3| {
                    piece.nearest(p + step * axis).distance - piece.nearest(p - step * axis).distance
                };
                let slope = DVec3::new(at(DVec3::X), at(DVec3::Y), at(DVec3::Z)).normalize_or(DVec3::Z);
                // Tapered capsules name the direction away from their axis.
                agree += u32::from(slope.dot(piece.nearest(p).normal) > 0.96);
            }
            assert!(agree > 980, "{piece:?}: {agree}");
        }
    }

    /// What is said to be missed holds no point of the body.
    #[test]
    fn cubes_that_are_missed_are_empty() {
        for piece in pieces() {
            let mut missed = 0;
            for i in 0..4000 {
                let (centre, half) = (point(2 * i), 0.02 + 0.1 * unit(4, &[i]));
                if piece.misses(centre, half, 0.01) {
                    missed += 1;
                    let is_empty =
                        (0..20).all(|k| piece.nearest(centre + half * point(100 * i + k)).distance > 0.0);
                    assert!(is_empty, "{piece:?}: {centre} {half}");
                }
            }
            assert!(missed > 2000, "{piece:?}: {missed}");
        }
    }

    #[test]
    fn bounds_hold_the_body() {
        for piece in pieces() {
            let [low, high] = piece.bounds();
            for i in 0..20_000 {
                let p = point(i);
                let is_inside = p.cmpge(low).all() && p.cmple(high).all();
                assert!(is_inside || piece.nearest(p).distance > 0.0, "{piece:?} at {p}");
            }
        }
    }

    #[test]
    fn a_ray_meets_what_is_in_its_way() {
        for piece in pieces() {
            for i in 0..2000 {
                let (start, w, length) = (point(2 * i), point(2 * i + 1).normalize(), 0.4);
                let least = (0..=400)
                    .map(|k| piece.nearest(start + w * (length * f64::from(k) / 400.0)).distance)
                    .fold(f64::INFINITY, f64::min);
                let body = Body::new(&piece, 0.0);
                let met = !matches!(meets(&[&body], Stretch { start, w, length }).0, Meets::Nothing);
                assert!(met || least > -1e-9, "{piece:?} from {start} along {w}: {least}");
                assert!(!met || least < 2e-3, "{piece:?} from {start} along {w}: {least}");
            }
        }
    }
}
