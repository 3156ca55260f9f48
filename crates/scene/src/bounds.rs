//! Boxes along the axes.

use crate::text::Number;
use glam::DVec3;

/// A box along the axes: finite, and longer than nothing along each of them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bounds {
    min: DVec3,
    max: DVec3,
}

/// Why two corners make no [`Bounds`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum BoundsError {
    /// A coordinate is infinite or not a number, or the extent between two is infinite.
    #[error("the bounds are not finite along {axis}: from {} to {}", Number(*min), Number(*max))]
    NotFinite {
        /// The first such axis: `x`, `y` or `z`.
        axis: char,
        /// The lower end.
        min: f64,
        /// The upper end.
        max: f64,
    },
    /// The lower end is not below the upper.
    #[error("the bounds are empty along {axis}: from {} to {}", Number(*min), Number(*max))]
    Empty {
        /// The first such axis: `x`, `y` or `z`.
        axis: char,
        /// The lower end.
        min: f64,
        /// The upper end.
        max: f64,
    },
}

/// The part of a line that lies in a box.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RaySpan {
    /// Where the line enters, in units of its direction; negative if that is behind its origin.
    pub enter: f64,
    /// Where it leaves.
    pub exit: f64,
    /// The outward normal of the face through which it enters.
    pub enter_normal: DVec3,
    /// The outward normal of the face through which it leaves.
    pub exit_normal: DVec3,
}

impl RaySpan {
    /// The part that lies in both; each end with the normal of whoever ends there. `None` if that is a point or less.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let (first, second) = (self.enter >= other.enter, self.exit <= other.exit);
        let span = Self {
            enter: if first { self.enter } else { other.enter },
            exit: if second { self.exit } else { other.exit },
            enter_normal: if first { self.enter_normal } else { other.enter_normal },
            exit_normal: if second { self.exit_normal } else { other.exit_normal },
        };
        (span.enter < span.exit).then_some(span)
    }
}

impl Bounds {
    /// The box between two corners.
    ///
    /// # Errors
    /// Corners that are not finite, or not in order along every axis.
    pub fn new(min: DVec3, max: DVec3) -> Result<Self, BoundsError> {
        for (i, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
            let (min, max) = (min[i], max[i]);
            if !(max - min).is_finite() {
                return Err(BoundsError::NotFinite { axis, min, max });
            }
            if min >= max {
                return Err(BoundsError::Empty { axis, min, max });
            }
        }
        Ok(Self { min, max })
    }

    /// The corner with the smallest coordinates.
    pub fn min(&self) -> DVec3 {
        self.min
    }

    /// The corner with the largest coordinates.
    pub fn max(&self) -> DVec3 {
        self.max
    }

    /// The extent along each axis.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The length of the longest side, to which tolerances are relative.
    pub fn longest_side(&self) -> f64 {
        self.size().max_element()
    }

    /// The point in the middle.
    pub fn centre(&self) -> DVec3 {
        self.min + self.size() * 0.5
    }

    /// The eight corners; x changes fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { self.max[axis] } else { self.min[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Whether a point is inside or on a face.
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The smallest box around two.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The part that lies in both; `None` if that has no extent along an axis.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        Self::new(self.min.max(other.min), self.max.min(other.max)).ok()
    }

    /// The part of the line origin + t·direction inside the box (faces included), over all t, negative ones too.
    ///
    /// `None` if the line misses the box or touches it in a single point. Components of `direction` may be 0.
    pub fn ray_span(&self, origin: DVec3, direction: DVec3) -> Option<RaySpan> {
        let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        let (mut enter_normal, mut exit_normal) = (DVec3::ZERO, DVec3::ZERO);
        for axis in 0..3 {
            let (start, slope) = (origin[axis], direction[axis]);
            if slope == 0.0 {
                if !(self.min[axis]..=self.max[axis]).contains(&start) {
                    return None;
                }
                continue;
            }
            // Divided, not multiplied by an inverse: the inverse of a tiny slope overflows where this does not.
            let at_min = (self.min[axis] - start) / slope;
            let at_max = (self.max[axis] - start) / slope;
            let (near, far) = if slope > 0.0 { (at_min, at_max) } else { (at_max, at_min) };
            let outward = DVec3::AXES[axis] * slope.signum();
            if near > enter {
                (enter, enter_normal) = (near, -outward);
            }
            if far < exit {
                (exit, exit_normal) = (far, outward);
            }
        }
        (enter < exit && enter.is_finite() && exit.is_finite()).then_some(RaySpan {
            enter,
            exit,
            enter_normal,
            exit_normal,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slab() -> Bounds {
        Bounds::new(DVec3::new(-1.0, -2.0, 0.5), DVec3::new(3.0, 2.0, 1.5)).unwrap()
    }

    #[test]
    fn refuses_what_is_no_box() {
        let one = DVec3::ONE;
        let empty = Bounds::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0));
        assert_eq!(empty, Err(BoundsError::Empty { axis: 'y', min: 0.0, max: 0.0 }));
        assert!(matches!(Bounds::new(one, -one), Err(BoundsError::Empty { axis: 'x', .. })));
        let nan = Bounds::new(DVec3::new(0.0, 0.0, f64::NAN), one);
        assert!(matches!(nan, Err(BoundsError::NotFinite { axis: 'z', .. })));
        let endless = Bounds::new(DVec3::NEG_INFINITY, one);
        assert!(matches!(endless, Err(BoundsError::NotFinite { axis: 'x', .. })));
        // Finite corners, but a size that overflows.
        assert!(Bounds::new(DVec3::splat(-1e308), DVec3::splat(1e308)).is_err());
    }

    #[test]
    fn measures() {
        let slab = slab();
        assert_eq!(slab.size(), DVec3::new(4.0, 4.0, 1.0));
        assert_eq!(slab.longest_side(), 4.0);
        assert_eq!(slab.centre(), DVec3::new(1.0, 0.0, 1.0));
        let corners = slab.corners();
        assert_eq!(corners[0], slab.min());
        assert_eq!(corners[1], DVec3::new(3.0, -2.0, 0.5));
        assert_eq!(corners[7], slab.max());
        assert!(corners.iter().all(|&c| slab.contains(c)));
        assert!(!slab.contains(DVec3::new(1.0, 0.0, 0.49)));
    }

    #[test]
    fn intersections() {
        let cube = Bounds::new(DVec3::ZERO, DVec3::splat(9.0)).unwrap();
        let both = slab().intersection(&cube).unwrap();
        assert_eq!((both.min(), both.max()), (DVec3::new(0.0, 0.0, 0.5), DVec3::new(3.0, 2.0, 1.5)));
        assert_eq!(slab().intersection(&Bounds::new(DVec3::splat(4.0), DVec3::splat(5.0)).unwrap()), None);
        let origin = DVec3::new(-4.0, 1.0, 1.0);
        let [a, b] = [slab(), cube].map(|b| b.ray_span(origin, DVec3::X).unwrap());
        let span = a.intersection(&b).unwrap();
        assert_eq!((span.enter, span.exit), (4.0, 7.0));
        assert_eq!(Some(span), both.ray_span(origin, DVec3::X));
        assert_eq!(a.intersection(&RaySpan { enter: 7.0, exit: 9.0, ..b }), None);
    }

    #[test]
    fn spans_of_rays_along_an_axis_are_exact() {
        let span = slab().ray_span(DVec3::new(-4.0, 0.0, 1.0), DVec3::X).unwrap();
        assert_eq!((span.enter, span.exit), (3.0, 7.0));
        assert_eq!((span.enter_normal, span.exit_normal), (-DVec3::X, DVec3::X));
        let backward = slab().ray_span(DVec3::new(0.0, 0.0, 1.0), -DVec3::Z).unwrap();
        assert_eq!((backward.enter, backward.exit), (-0.5, 0.5));
        assert_eq!((backward.enter_normal, backward.exit_normal), (DVec3::Z, -DVec3::Z));
    }

    #[test]
    fn rays_in_a_face_count_and_rays_beside_it_do_not() {
        let along_a_face = slab().ray_span(DVec3::new(-4.0, 2.0, 1.0), DVec3::X);
        assert!(along_a_face.is_some());
        let beside = slab().ray_span(DVec3::new(-4.0, 2.0 + 1e-12, 1.0), DVec3::X);
        assert_eq!(beside, None);
        assert_eq!(slab().ray_span(DVec3::new(-4.0, 0.0, 1.0), DVec3::Y), None);
        assert_eq!(slab().ray_span(DVec3::ZERO, DVec3::ZERO), None);
    }

    #[test]
    fn a_slope_that_is_almost_nothing_does_no_harm() {
        let direction = DVec3::new(1.0, 5e-324, -5e-324);
        // In the plane of the upper y face and leaving it before the box begins.
        assert_eq!(slab().ray_span(DVec3::new(-4.0, 2.0, 1.0), direction), None);
        let inside = slab().ray_span(DVec3::new(-4.0, 0.0, 1.0), direction).unwrap();
        assert_eq!((inside.enter, inside.exit), (3.0, 7.0));
    }

    #[test]
    fn entry_and_exit_lie_on_the_faces_they_name() {
        let bounds = slab();
        let mut hits = 0;
        for i in 0..2000 {
            // A spread of directions by the golden angle, and of origins around the box.
            let k = f64::from(i);
            let (z, a) = (1.0 - 2.0 * (k + 0.5) / 2000.0, k * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            let direction = DVec3::new(r * a.cos(), r * a.sin(), z);
            let origin = DVec3::new((k * 0.7).sin() * 5.0, (k * 1.3).cos() * 5.0, (k * 0.3).sin() * 3.0);
            let Some(span) = bounds.ray_span(origin, direction) else { continue };
            hits += 1;
            for (t, normal) in [(span.enter, span.enter_normal), (span.exit, span.exit_normal)] {
                let point = origin + direction * t;
                let axis = normal.abs().max_position();
                let face = if normal[axis] > 0.0 { bounds.max()[axis] } else { bounds.min()[axis] };
                assert!((point[axis] - face).abs() < 1e-12);
                assert!(point.cmpge(bounds.min() - 1e-9).all() && point.cmple(bounds.max() + 1e-9).all());
            }
            assert!(direction.dot(span.enter_normal) < 0.0 && direction.dot(span.exit_normal) > 0.0);
        }
        assert!(hits > 200, "{hits}");
    }
}
