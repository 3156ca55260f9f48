//! Balls, to which solids may be clipped.

use crate::bounds::{Bounds, RaySpan};
use crate::text::{Number, Point};
use glam::DVec3;

/// A ball: its centre is finite, its radius positive, and it is longer than nothing along every axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ball {
    centre: DVec3,
    radius: f64,
    bounds: Bounds,
}

/// Why a centre and a radius make no [`Ball`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum BallError {
    /// The radius is not positive and finite.
    #[error("the radius of a sphere is a positive number, not {}", Number(*.0))]
    Radius(f64),
    /// The centre is not finite, or so large that the radius is lost in it, or the ball overflows.
    #[error("there is no sphere of radius {} around {}", Number(*radius), Point(*centre))]
    Centre {
        /// The centre.
        centre: DVec3,
        /// The radius.
        radius: f64,
    },
}

impl Ball {
    /// The ball around a centre.
    ///
    /// # Errors
    /// A radius that is not positive and finite; a centre that is not finite, or from which the radius leads nowhere in
    /// double precision.
    pub fn new(centre: DVec3, radius: f64) -> Result<Self, BallError> {
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(BallError::Radius(radius));
        }
        match Bounds::new(centre - radius, centre + radius) {
            Ok(bounds) => Ok(Self { centre, radius, bounds }),
            Err(_) => Err(BallError::Centre { centre, radius }),
        }
    }

    /// The centre.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The smallest box around it.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The part of the line origin + t·direction inside the ball, over all t, negative ones too.
    ///
    /// `None` if the line misses the ball or touches it in a single point.
    pub fn ray_span(&self, origin: DVec3, direction: DVec3) -> Option<RaySpan> {
        let to_centre = self.centre - origin;
        let scale = direction.length_squared();
        // From the place nearest to the centre: b² − 4ac would lose the digits of a ball that is far away.
        let nearest = to_centre.dot(direction) / scale;
        let apart = to_centre - nearest * direction;
        let half = ((self.radius * self.radius - apart.length_squared()) / scale).sqrt();
        let (enter, exit) = (nearest - half, nearest + half);
        let normal = |side: f64| (side * half * direction - apart).normalize_or_zero();
        // Comparisons with NaN are false: the line misses.
        (enter < exit && enter.is_finite() && exit.is_finite()).then(|| RaySpan {
            enter,
            exit,
            enter_normal: normal(-1.0),
            exit_normal: normal(1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball() -> Ball {
        Ball::new(DVec3::new(1.0, -2.0, 0.5), 2.0).unwrap()
    }

    #[test]
    fn refuses_what_is_no_ball() {
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Ball::new(DVec3::ZERO, radius), Err(BallError::Radius(_))), "{radius}");
        }
        for centre in [f64::NAN, f64::INFINITY, 1e300, 1e20] {
            let refused = Ball::new(DVec3::splat(centre), 1.0);
            assert!(matches!(refused, Err(BallError::Centre { .. })), "{centre}");
        }
        assert_eq!(ball().bounds().min(), DVec3::new(-1.0, -4.0, -1.5));
    }

    #[test]
    fn spans_through_the_centre_are_exact() {
        let span = ball().ray_span(DVec3::new(-9.0, -2.0, 0.5), 2.0 * DVec3::X).unwrap();
        assert_eq!((span.enter, span.exit), (4.0, 6.0));
        assert_eq!((span.enter_normal, span.exit_normal), (-DVec3::X, DVec3::X));
    }

    #[test]
    fn ends_lie_on_the_sphere_and_normals_point_outward() {
        let mut hits = 0;
        for i in 0..2000 {
            let k = f64::from(i);
            let (z, a) = (1.0 - 2.0 * (k + 0.5) / 2000.0, k * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            let direction = DVec3::new(r * a.cos(), r * a.sin(), z);
            let origin = DVec3::new((k * 0.7).sin() * 5.0, (k * 1.3).cos() * 5.0, (k * 0.3).sin() * 3.0);
            let to_centre = ball().centre() - origin;
            let apart = to_centre.cross(direction).length();
            let Some(span) = ball().ray_span(origin, direction) else {
                assert!(apart >= 2.0 - 1e-12, "{apart}");
                continue;
            };
            hits += 1;
            assert!(apart < 2.0 + 1e-12, "{apart}");
            for (t, normal) in [(span.enter, span.enter_normal), (span.exit, span.exit_normal)] {
                let from_centre = origin + t * direction - ball().centre();
                assert!((from_centre - 2.0 * normal).length() < 1e-12);
            }
        }
        assert!((200..1800).contains(&hits), "{hits}");
    }

    #[test]
    fn lines_beside_it_and_no_lines_miss() {
        assert_eq!(ball().ray_span(DVec3::new(-9.0, 0.1, 0.5), DVec3::X), None);
        assert_eq!(ball().ray_span(DVec3::ZERO, DVec3::ZERO), None);
        assert_eq!(ball().ray_span(DVec3::splat(f64::NAN), DVec3::X), None);
    }
}
