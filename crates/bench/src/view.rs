//! The camera that all contestants look through: it walks around the model.

use crate::error::BenchError;
use fieldstone::glam::{DQuat, DVec3};
use fieldstone::{Bounds, Camera, Projection, Up, View};
use serde::Serialize;

/// How far the camera walks from one frame to the next, in degrees.
const STEP: f64 = 3.0;

/// The angle of perspective views from the lower to the upper edge, in radians.
const FOV: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// How space is mapped to the image.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Lens {
    /// Rays start at the eye.
    Perspective,
    /// Rays are parallel.
    Parallel,
}

impl Lens {
    /// `perspective` or `parallel`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Parallel => "parallel",
        }
    }
}

/// A walk around the middle of a box, at one height, which begins where a camera is placed by default.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    first: Camera,
    bounds: Bounds,
}

impl Walk {
    /// A walk around a box that is seen in a square image.
    ///
    /// # Errors
    /// A box that no camera can look at.
    pub fn around(bounds: Bounds, lens: Lens) -> Result<Self, BenchError> {
        let diagonal = bounds.size().length();
        let projection = match lens {
            Lens::Perspective => Projection::Perspective { vertical_fov_radians: FOV },
            Lens::Parallel => Projection::Orthographic { height: 0.85 * diagonal },
        };
        let view = View { target: Some(bounds.centre()), projection: Some(projection), ..View::default() };
        let first = Camera::framing(&bounds, &view, Up::Z, 1.0);
        Ok(Self { first: first.map_err(|e| BenchError::model("camera", e))?, bounds })
    }

    /// The camera of a frame.
    ///
    /// # Errors
    /// None for a walk that there is, in principle.
    pub fn camera(&self, frame: u32) -> Result<Camera, BenchError> {
        let centre = self.bounds.centre();
        let turn = DQuat::from_rotation_z((STEP * f64::from(frame)).to_radians());
        let eye = centre + turn * (self.first.eye() - centre);
        let camera = Camera::look_at(eye, centre, DVec3::Z, self.first.projection());
        camera.map_err(|e| BenchError::model("camera", e))
    }

    /// Between which distances from the plane of the eye the ball around the box lies.
    pub fn depths(&self) -> (f64, f64) {
        let distance = (self.bounds.centre() - self.first.eye()).length();
        let radius = 0.5 * self.bounds.size().length();
        // An eye inside the ball looks from just before itself on.
        ((distance - radius).max(1e-3 * radius), distance + radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_stays_between_the_depths() {
        let bounds = Bounds::new(DVec3::new(-1.0, -2.0, 0.0), DVec3::new(3.0, 1.0, 1.0)).unwrap();
        for lens in [Lens::Perspective, Lens::Parallel] {
            let walk = Walk::around(bounds, lens).unwrap();
            let (near, far) = walk.depths();
            for frame in [0, 1, 17, 60] {
                let camera = walk.camera(frame).unwrap();
                for corner in bounds.corners() {
                    let depth = (corner - camera.eye()).dot(camera.forward());
                    assert!((near..=far).contains(&depth), "{lens:?} {frame}: {depth} of {near}..{far}");
                }
            }
        }
    }
}
