//! Where rays go into bodies and out of them, in closed form.

use super::piece::{Body, Piece, Plate, Rod, Seat};
use glam::DVec3;

/// A stretch of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) start: DVec3,
    /// Its direction, unit.
    pub(super) w: DVec3,
    pub(super) length: f64,
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

/// A surface so near to an end of a stretch, in parts of its length, is met by the stretch on its inner side alone: what lies in a
/// face between two cells belongs to the one that the body fills.
const SLACK: f64 = 1e-9;

/// What a stretch meets of the union of bodies, and the place of the body in the list: from the outside the first surface,
/// from the inside the last, as seen from the other end.
pub(super) fn meets(bodies: &[&Body], stretch: Stretch) -> (Meets, usize) {
    let (mut first, mut last) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
    let (mut starts, mut ends) = (None, false);
    let slack = SLACK * stretch.length;
    for (index, body) in bodies.iter().enumerate() {
        let Some((near, far)) = body.sampled.0.span(stretch) else { continue };
        if far <= slack || near >= stretch.length - slack {
            continue;
        }
        if near < -slack {
            starts.get_or_insert(index);
        }
        ends |= far > stretch.length + slack;
        if near < first.0 {
            first = (near, index);
        }
        if far > last.0 {
            last = (far, index);
        }
    }
    let ((t, index), crossings) = match (starts, ends) {
        (None, _) if first.0 == f64::INFINITY => return (Meets::Nothing, 0),
        (None, false) => (first, 2.0),
        (None, true) => (first, 1.0),
        (Some(_), false) => (last, 1.0),
        (Some(index), true) => return (Meets::Inside, index),
    };
    let normal = bodies[index].sampled.0.nearest(stretch.start + t * stretch.w).normal;
    (Meets::Surface { normal, crossings }, index)
}

/// From where to where a line is in something convex.
type Span = Option<(f64, f64)>;

impl Piece {
    /// From where to where the line of a stretch is inside of the body.
    fn span(&self, Stretch { start, w, .. }: Stretch) -> Span {
        let placed = |seat: &Seat| Line { p: seat.inside(start), d: seat.inverse * w };
        let line = Line { p: start, d: w };
        match self {
            Self::Ellipsoid { seat, radii } => {
                let Line { p, d } = placed(seat);
                Line { p: p / *radii, d: d / *radii }.in_ball(1.0)
            }
            Self::Box { seat, half } => placed(seat).in_box(*half),
            Self::Frustum { seat, radii, height } => {
                let Line { p, d } = placed(seat);
                let slope = (radii[1] - radii[0]) / height;
                let across = Line { p: p.with_z(0.0), d: d.with_z(0.0) };
                across.in_cone((radii[0] + slope * p.z, slope * d.z), slab(p.z, d.z, 0.0, *height)?)
            }
            Self::Capsule(rod) => rod.span(line),
            Self::Plate(plate) => plate.span(line),
        }
    }
}

/// All p + t d.
#[derive(Clone, Copy)]
struct Line {
    p: DVec3,
    d: DVec3,
}

impl Line {
    fn in_ball(self, radius: f64) -> Span {
        let (a, b) = (self.d.length_squared(), self.p.dot(self.d));
        let discriminant = b * b - a * (self.p.length_squared() - radius * radius);
        (discriminant > 0.0).then(|| {
            let root = discriminant.sqrt();
            ((-b - root) / a, (-b + root) / a)
        })
    }

    /// In the box around the origin.
    fn in_box(self, half: DVec3) -> Span {
        (0..3).try_fold(EVERYWHERE, |span, axis| {
            both(span, slab(self.p[axis], self.d[axis], -half[axis], half[axis])?)
        })
    }

    fn from(self, origin: DVec3) -> Self {
        Self { p: self.p - origin, ..self }
    }

    /// Where a line, seen along an axis, is no farther from it than a radius that changes evenly, and within a span in which
    /// that radius is not below 0.
    fn in_cone(self, (radius, change): (f64, f64), within: (f64, f64)) -> Span {
        // a t² + 2 b t + c ≤ 0
        let a = self.d.length_squared() - change * change;
        let b = self.p.dot(self.d) - radius * change;
        let c = self.p.length_squared() - radius * radius;
        let discriminant = b * b - a * c;
        if a == 0.0 {
            return match -0.5 * c / b {
                t if b > 0.0 => both(within, (f64::NEG_INFINITY, t)),
                t if b < 0.0 => both(within, (t, f64::INFINITY)),
                _ => (c <= 0.0).then_some(within),
            };
        }
        if discriminant <= 0.0 {
            // A line that is steeper than the cone stays in it.
            return (a < 0.0).then_some(within);
        }
        let root = discriminant.sqrt();
        let (near, far) = ((-b - root) / a, (-b + root) / a);
        if a > 0.0 {
            return both(within, (near, far));
        }
        hull(both(within, (f64::NEG_INFINITY, far)), both(within, (near, f64::INFINITY)))
    }
}

const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Where low ≤ p + t d ≤ high.
fn slab(p: f64, d: f64, low: f64, high: f64) -> Span {
    if d == 0.0 {
        return (low..=high).contains(&p).then_some(EVERYWHERE);
    }
    let (a, b) = ((low - p) / d, (high - p) / d);
    Some((a.min(b), a.max(b)))
}

fn both(a: (f64, f64), b: (f64, f64)) -> Span {
    let (near, far) = (a.0.max(b.0), a.1.min(b.1));
    (near <= far).then_some((near, far))
}

/// The least span that holds both.
fn hull(a: Span, b: Span) -> Span {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (one, None) | (None, one) => one,
    }
}

impl Rod {
    /// A cone cut off, and halves of balls at its ends.
    fn span(&self, line: Line) -> Span {
        let ([from, to], [start, end]) = (self.ends, self.radii);
        let line = line.from(from);
        let along = to - from;
        // The share of the way along the rod, and its change.
        let (s, ds) = (line.p.dot(self.share), line.d.dot(self.share));
        let within = |low: f64, high: f64| slab(s, ds, low, high);
        let across = Line { p: line.p - s * along, d: line.d - ds * along };
        let change = end - start;
        let middle =
            within(0.0, 1.0).and_then(|within| across.in_cone((start + s * change, ds * change), within));
        let cap = |line: Line, radius: f64, (low, high): (f64, f64)| {
            both(line.in_ball(radius)?, within(low, high)?)
        };
        let first = cap(line, start, (f64::NEG_INFINITY, 0.0));
        hull(hull(middle, first), cap(line.from(along), end, (1.0, f64::INFINITY)))
    }
}

impl Plate {
    /// What is above and below the triangle, and rods along its edges.
    fn span(&self, line: Line) -> Span {
        let origin = self.edges[0].from;
        let (away, climb) = ((line.p - origin).dot(self.normal), line.d.dot(self.normal));
        let prism = || {
            self.edges.iter().try_fold(slab(away, climb, -self.half, self.half)?, |span, edge| {
                let (p, d) = ((line.p - edge.from).dot(edge.inward), line.d.dot(edge.inward));
                both(span, slab(p, d, 0.0, f64::INFINITY)?)
            })
        };
        let above = if self.normal == DVec3::ZERO { None } else { prism() };
        self.edges.iter().fold(above, |span, edge| {
            hull(span, Rod::new([edge.from, edge.from + edge.along], [self.half; 2]).span(line))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Frame;
    use glam::DMat3;

    /// A face between two cells is met once, on the side of the body.
    #[test]
    fn a_face_between_cells_belongs_to_the_body() {
        let frame = Frame { origin: DVec3::ZERO, axes: DMat3::IDENTITY };
        let cube = Body::new(&Piece::Box { seat: frame.into(), half: DVec3::ONE }, 0.0);
        let met = |z: f64| meets(&[&cube], Stretch { start: DVec3::Z * z, w: DVec3::Z, length: 0.25 }).0;
        assert!(matches!(met(0.5), Meets::Inside));
        let Meets::Surface { normal, crossings } = met(0.75) else { panic!("the face is lost") };
        assert_eq!((normal, crossings), (DVec3::Z, 1.0));
        assert!(matches!(met(1.0), Meets::Nothing));
    }
}
