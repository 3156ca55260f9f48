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

    /// A point in the shape's own coordinates.
    fn inside(&self, p: DVec3) -> DVec3 {
        self.axes.transpose() * (p - self.origin) / (self.size() * self.size())
    }
}

/// A body, closed and opaque.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    Ellipsoid {
        frame: Frame,
        radii: DVec3,
    },
    /// A cone cut off: from z = 0, where its radius is `radii[0]`, to `height`.
    Frustum {
        frame: Frame,
        radii: [f64; 2],
        height: f64,
    },
    Box {
        frame: Frame,
        half: DVec3,
    },
    /// All points that are no farther from a line than a radius that goes evenly from one end to the other.
    Capsule {
        ends: [DVec3; 2],
        radii: [f64; 2],
    },
    /// All points that are no farther from a triangle than `half`.
    Plate {
        corners: [DVec3; 3],
        half: f64,
        axis: DVec3,
    },
}

/// The nearest surface: how far it is (below 0 inside), no more than it really is, and the direction away from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) distance: f64,
    pub(super) normal: DVec3,
}

/// What a stretch of a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) enum Meets {
    Nothing,
    /// A surface.
    Surface {
        normal: DVec3,
        /// How often the stretch goes through a surface: 1 if one of its ends is inside, else 2, there and back.
        crossings: f64,
    },
    /// The inside all along.
    Inside,
}

impl Piece {
    pub(super) fn nearest(&self, p: DVec3) -> Nearest {
        match self {
            Self::Ellipsoid { frame, radii } => placed(frame, ellipsoid(frame.inside(p), *radii)),
            Self::Frustum { frame, radii, height } => {
                placed(frame, frustum(frame.inside(p), *radii, *height))
            }
            Self::Box { frame, half } => placed(frame, cuboid(frame.inside(p), *half)),
            Self::Capsule { ends: [a, b], radii: [start, end] } => {
                let along = *b - *a;
                let s = ((p - *a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let away = p - (*a + s * along);
                // Where the radius changes, the surface is nearer than straight on.
                let slope = (end - start).abs() / along.length().max(f64::MIN_POSITIVE);
                let distance = (away.length() - (start + s * (end - start))) / (1.0 + slope * slope).sqrt();
                Nearest { distance, normal: away.normalize_or(DVec3::Z) }
            }
            Self::Plate { corners, half, .. } => {
                let away = p - closest(p, corners);
                let [a, b, c] = corners;
                let face = (*b - *a).cross(*c - *a).normalize_or(DVec3::Z);
                Nearest { distance: away.length() - half, normal: away.normalize_or(face) }
            }
        }
    }

    /// A distance at which the body is at least, closer to the truth than that of [`Piece::nearest`].
    pub(super) fn gap(&self, p: DVec3) -> f64 {
        match self {
            Self::Ellipsoid { frame, radii } => {
                // No point of a convex body is beyond the plane that touches it across a direction.
                let p = frame.inside(p);
                let across = (p / (*radii * *radii)).normalize_or_zero();
                (across.dot(p) - (across * *radii).length()) * frame.size()
            }
            other => other.nearest(p).distance,
        }
    }

    /// The direction along the body.
    pub(super) fn axis(&self) -> DVec3 {
        match self {
            Self::Ellipsoid { frame, .. } | Self::Frustum { frame, .. } | Self::Box { frame, .. } => {
                frame.axes.z_axis.normalize_or(DVec3::Z)
            }
            Self::Capsule { ends: [a, b], .. } => (*b - *a).normalize_or(DVec3::Z),
            Self::Plate { axis, .. } => *axis,
        }
    }

    /// A body at least as thick as can be sampled, and the share of its shadow that the real one throws.
    pub(super) fn widened(&self, least: f64) -> (Self, f64) {
        match self {
            Self::Capsule { ends, radii } if radii[0].max(radii[1]) < least => {
                let share = 0.5 * (radii[0] + radii[1]) / least;
                (Self::Capsule { ends: *ends, radii: [least; 2] }, share)
            }
            other => (other.clone(), 1.0),
        }
    }

    /// Two corners of a box that holds the body.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let around = |centre: DVec3, reach: DVec3| [centre - reach, centre + reach];
        let turned = |frame: &Frame, half: DVec3| {
            let [x, y, z] = [frame.axes.x_axis, frame.axes.y_axis, frame.axes.z_axis].map(DVec3::abs);
            x * half.x + y * half.y + z * half.z
        };
        match self {
            Self::Ellipsoid { frame, radii } => around(frame.origin, turned(frame, *radii)),
            Self::Box { frame, half } => around(frame.origin, turned(frame, *half)),
            Self::Frustum { frame, radii, height } => {
                let radius = radii[0].max(radii[1]);
                let centre = frame.point(DVec3::Z * (0.5 * height));
                around(centre, turned(frame, DVec3::new(radius, radius, 0.5 * height)))
            }
            Self::Capsule { ends: [a, b], radii } => {
                let radius = DVec3::splat(radii[0].max(radii[1]));
                [a.min(*b) - radius, a.max(*b) + radius]
            }
            Self::Plate { corners: [a, b, c], half, .. } => {
                let half = DVec3::splat(*half);
                [a.min(*b).min(*c) - half, a.max(*b).max(*c) + half]
            }
        }
    }
}

/// A stretch of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) start: DVec3,
    /// Its direction, unit.
    pub(super) w: DVec3,
    pub(super) length: f64,
}

/// What a stretch meets of the union of bodies, and the place of the body in the list.
pub(super) fn meets(pieces: &[(Piece, f64)], stretch: Stretch) -> (Meets, usize) {
    if let [(Piece::Ellipsoid { frame, radii }, _)] = pieces {
        return (meets_ellipsoid(frame, *radii, stretch), 0);
    }
    let Stretch { start, w, length } = stretch;
    let (at_start, first) = nearest_of(pieces, start);
    if at_start.distance > 0.0 {
        return march(pieces, stretch);
    }
    // From the inside, the surface is met from the other end.
    let end = Stretch { start: start + length * w, w: -w, length };
    if nearest_of(pieces, end.start).0.distance <= 0.0 { (Meets::Inside, first) } else { march(pieces, end) }
}

/// Steps as long as the way is free; what comes nearer than a thousandth of the way is touched, so that there are
/// a thousand steps at most.
fn march(pieces: &[(Piece, f64)], Stretch { start, w, length }: Stretch) -> (Meets, usize) {
    let least = 1e-3 * length;
    let mut t = 0.0;
    while t <= length {
        let (nearest, index) = nearest_of(pieces, start + t * w);
        if nearest.distance <= least {
            let leaves = nearest_of(pieces, start + length * w).0.distance > 0.0;
            let crossings = if leaves { 2.0 } else { 1.0 };
            return (Meets::Surface { normal: nearest.normal, crossings }, index);
        }
        t += nearest.distance;
    }
    (Meets::Nothing, 0)
}

/// The nearest of the bodies, and its place in the list.
fn nearest_of(pieces: &[(Piece, f64)], p: DVec3) -> (Nearest, usize) {
    let mut best = (Nearest { distance: f64::INFINITY, normal: DVec3::Z }, 0);
    for (index, (piece, _)) in pieces.iter().enumerate() {
        let nearest = piece.nearest(p);
        if nearest.distance < best.0.distance {
            best = (nearest, index);
        }
    }
    best
}

fn placed(frame: &Frame, nearest: Nearest) -> Nearest {
    let size = frame.size();
    Nearest { distance: nearest.distance * size, normal: frame.axes * nearest.normal / size }
}

/// The distance is that in the space in which the ellipsoid is a ball, times the shortest radius: never too large.
fn ellipsoid(p: DVec3, radii: DVec3) -> Nearest {
    let scaled = p / radii;
    let distance = (scaled.length() - 1.0) * radii.min_element();
    Nearest { distance, normal: (scaled / radii).normalize_or(DVec3::Z) }
}

fn meets_ellipsoid(frame: &Frame, radii: DVec3, Stretch { start, w, length }: Stretch) -> Meets {
    let (p, d) = (frame.inside(start) / radii, (frame.inside(start + w) - frame.inside(start)) / radii);
    let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - 1.0);
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        return Meets::Nothing;
    }
    let [near, far] = [-1.0, 1.0].map(|sign: f64| (-b + sign * discriminant.sqrt()) / a);
    if far <= 0.0 || near >= length {
        return Meets::Nothing;
    }
    let (t, crossings) = match (near > 0.0, far < length) {
        (true, true) => (near, 2.0),
        (true, false) => (near, 1.0),
        (false, true) => (far, 1.0),
        (false, false) => return Meets::Inside,
    };
    Meets::Surface { normal: (frame.axes * ((p + t * d) / radii)).normalize_or(DVec3::Z), crossings }
}

/// In the plane through the axis, the frustum is a polygon of three edges beside the axis.
fn frustum(p: DVec3, [low, high]: [f64; 2], height: f64) -> Nearest {
    let q = DVec2::new(p.x.hypot(p.y), p.z);
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

/// The point of a triangle that is nearest to p: on the plane if that is within all edges, else on the nearest edge.
fn closest(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    let is_within = edges.iter().all(|(from, to)| (*to - *from).cross(p - *from).dot(normal) >= 0.0);
    if is_within && normal != DVec3::ZERO {
        return p - normal * ((p - a).dot(normal) / normal.length_squared());
    }
    let on_edge = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let s = (p - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        from + s.clamp(0.0, 1.0) * along
    };
    let squared = |q: &DVec3| (p - *q).length_squared();
    let [first, second, third] = edges.map(on_edge);
    [second, third].into_iter().fold(first, |best, q| if squared(&q) < squared(&best) { q } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::unit;

    fn pieces() -> Vec<Piece> {
        let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4) * 0.5;
        let frame = Frame { origin: DVec3::new(0.1, 0.2, -0.1), axes: turn };
        let corners = [DVec3::ZERO, DVec3::new(0.5, 0.1, 0.0), DVec3::new(0.1, 0.4, 0.3)];
        vec![
            Piece::Ellipsoid { frame, radii: DVec3::new(0.3, 0.6, 0.9) },
            Piece::Frustum { frame, radii: [0.6, 0.2], height: 0.8 },
            Piece::Frustum { frame, radii: [0.5, 0.0], height: 0.7 },
            Piece::Box { frame, half: DVec3::new(0.2, 0.4, 0.7) },
            Piece::Capsule { ends: [DVec3::ZERO, DVec3::new(0.3, 0.4, 0.2)], radii: [0.1, 0.02] },
            Piece::Plate { corners, half: 0.05, axis: DVec3::X },
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
                let pieces = [(piece.clone(), 1.0)];
                let met = !matches!(meets(&pieces, Stretch { start, w, length }).0, Meets::Nothing);
                assert!(met || least > -1e-9, "{piece:?} from {start} along {w}: {least}");
                assert!(!met || least < 2e-3, "{piece:?} from {start} along {w}: {least}");
            }
        }
    }
}
