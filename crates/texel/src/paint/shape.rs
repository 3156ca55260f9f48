//! Shapes, and how they become bodies in the volume.

use super::piece::{Frame, Piece};
use glam::{DMat3, DVec3};

/// What a shape is, in its own coordinates: it stands on the origin and grows along z, unless said otherwise. Lengths
/// and radii are above 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// An ellipsoid around the origin.
    Ellipsoid {
        /// Half axes along x, y and z.
        radii: DVec3,
    },
    /// A cylinder, a cone, or a cone cut off.
    Cone {
        /// Radius at the base.
        radius: f64,
        /// Radius at the top; may be 0.
        top: f64,
        /// Height.
        height: f64,
    },
    /// A flat disc around the origin, across z.
    Disc {
        /// Its radius.
        radius: f64,
        /// Its thickness.
        thickness: f64,
    },
    /// A box around the origin.
    Box {
        /// Whole lengths of its edges.
        size: DVec3,
    },
    /// A blade of grass: a strip folded along its middle like a V, as wide as said at its base and pointed at its tip. It bends in
    /// the plane of x and z.
    Blade {
        /// Length along its middle.
        height: f64,
        /// Width at its base, before it is folded.
        width: f64,
        /// Angle by which each half is turned up from the flat, radians, below π/2.
        fold: f64,
        /// Thickness of the sheet.
        thickness: f64,
        /// Angle by which its tip is turned toward x, radians.
        curl: f64,
    },
    /// A hair: a round rod that bends in the plane of x and z.
    Hair {
        /// Length.
        height: f64,
        /// Radius at its root.
        radius: f64,
        /// Radius at its tip; may be 0.
        tip: f64,
        /// Angle by which its tip is turned toward x, radians.
        curl: f64,
    },
    /// A tube along a curve through points (Catmull and Rom 1974), around which nothing is moved to the origin.
    Tube {
        /// Points of the curve, at least two.
        points: Vec<DVec3>,
        /// Radius at its first and its last point.
        radii: [f64; 2],
    },
}

/// Parts into which what is bent is divided.
const BENDS: u32 = 8;

impl Form {
    /// The bodies of the form at a place, its curl turned further by `curl` radians.
    pub(super) fn pieces(&self, frame: &Frame, curl: f64) -> Vec<Piece> {
        let frame_of = |origin: DVec3| Frame { origin: frame.point(origin), ..*frame };
        let frustum =
            |radii, height, base| Piece::Frustum { seat: frame_of(DVec3::Z * base).into(), radii, height };
        match self {
            Self::Ellipsoid { radii } => vec![Piece::Ellipsoid { seat: (*frame).into(), radii: *radii }],
            Self::Box { size } => vec![Piece::Box { seat: (*frame).into(), half: 0.5 * *size }],
            Self::Cone { radius, top, height } => vec![frustum([*radius, *top], *height, 0.0)],
            Self::Disc { radius, thickness } => vec![frustum([*radius; 2], *thickness, -0.5 * thickness)],
            Self::Blade { height, width, fold, thickness, curl: own } => {
                let section = [*width, *fold, *thickness];
                blade(frame, &spine(*height, own + curl), section)
            }
            Self::Hair { height, radius, tip, curl: own } => {
                // What is straight is one piece.
                let spine = match own + curl {
                    0.0 => vec![(DVec3::ZERO, DVec3::Z), (DVec3::Z * *height, DVec3::Z)],
                    turn => spine(*height, turn),
                };
                rod(spine.iter().map(|(p, _)| frame.point(*p)), [radius, tip].map(|r| r * frame.size()))
            }
            Self::Tube { points, radii } => {
                rod(curve(points).into_iter().map(|p| frame.point(p)), radii.map(|r| r * frame.size()))
            }
        }
    }
}

/// Points of an arc of circle of the given length that starts along z and turns toward x, each with its direction.
fn spine(height: f64, curl: f64) -> Vec<(DVec3, DVec3)> {
    let step = height / f64::from(BENDS);
    let heading = |turn: f64| DVec3::new(turn.sin(), 0.0, turn.cos());
    let mut at = DVec3::ZERO;
    let mut points = vec![(at, DVec3::Z)];
    for i in 0..BENDS {
        at += step * heading(curl * (f64::from(i) + 0.5) / f64::from(BENDS));
        points.push((at, heading(curl * f64::from(i + 1) / f64::from(BENDS))));
    }
    points
}

/// Round pieces from point to point.
fn rod(points: impl Iterator<Item = DVec3>, [start, end]: [f64; 2]) -> Vec<Piece> {
    let points: Vec<DVec3> = points.collect();
    let last = points.len().saturating_sub(1).max(1) as f64;
    let radius = |i: usize| start + (end - start) * i as f64 / last;
    let piece = |(i, ends): (usize, &[DVec3])| Piece::capsule([ends[0], ends[1]], [radius(i), radius(i + 1)]);
    points.windows(2).enumerate().map(piece).collect()
}

/// Two rows of plates that meet along the spine, each turned up by the fold.
fn blade(frame: &Frame, spine: &[(DVec3, DVec3)], [width, fold, thickness]: [f64; 3]) -> Vec<Piece> {
    let last = (spine.len() - 1) as f64;
    let mut pieces = Vec::new();
    for side in [-1.0, 1.0] {
        let rim = |i: usize| {
            let (at, heading) = spine[i];
            // The fold opens toward the outer side of the bend.
            let up = heading.cross(DVec3::Y);
            let half = 0.5 * width * (1.0 - i as f64 / last);
            at + half * (side * fold.cos() * DVec3::Y - fold.sin() * up)
        };
        for i in 1..spine.len() {
            let axis = (frame.axes * spine[i].1).normalize_or(DVec3::Z);
            let mut plate = |corners: [DVec3; 3]| {
                let corners = corners.map(|p| frame.point(p));
                pieces.push(Piece::plate(corners, 0.5 * thickness * frame.size(), axis));
            };
            plate([spine[i - 1].0, rim(i - 1), spine[i].0]);
            if i + 1 < spine.len() {
                plate([spine[i].0, rim(i - 1), rim(i)]);
            }
        }
    }
    pieces
}

/// Points of the curve through all points.
fn curve(points: &[DVec3]) -> Vec<DVec3> {
    let last = points.len() - 1;
    let mut curve = vec![points[0]];
    for i in 0..last {
        let (a, b) = (points[i], points[i + 1]);
        let (before, after) = (points[i.saturating_sub(1)], points[(i + 2).min(last)]);
        let (from, to) = (0.5 * (b - before), 0.5 * (after - a));
        for k in 1..=BENDS {
            let s = f64::from(k) / f64::from(BENDS);
            let (s2, s3) = (s * s, s * s * s);
            curve.push(
                (2.0 * s3 - 3.0 * s2 + 1.0) * a
                    + (s3 - 2.0 * s2 + s) * from
                    + (3.0 * s2 - 2.0 * s3) * b
                    + (s3 - s2) * to,
            );
        }
    }
    curve
}

/// Axes whose z is `up` and whose x is as near to `toward` as can be, scaled.
pub(super) fn axes(up: DVec3, toward: DVec3, size: f64) -> DMat3 {
    let z = up.normalize_or(DVec3::Z);
    let x = (toward - toward.dot(z) * z).try_normalize().unwrap_or_else(|| z.any_orthonormal_vector());
    DMat3::from_cols(x, z.cross(x), z) * size
}
