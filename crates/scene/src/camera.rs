//! Cameras, and how they are placed where the user left that open.
//!
//! Right-handed: forward points from the eye to the target, right = forward × up, and the camera's own up is
//! right × forward. Image coordinates (u, v) run from (0, 0) at the upper left to (1, 1) at the lower right corner.

use crate::bounds::Bounds;
use crate::text::{Number, Point, degrees};
use glam::DVec3;
use std::f64::consts::PI;

/// How space is mapped to the image.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Projection {
    /// Rays start at the eye.
    Perspective {
        /// The angle between the upper and the lower edge of the image.
        vertical_fov_radians: f64,
    },
    /// Rays are parallel and start in the plane through the eye.
    Orthographic {
        /// The distance between the upper and the lower edge of the image.
        height: f64,
    },
}

/// The axis that points up by habit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Up {
    /// y; the front looks along +z.
    Y,
    /// z; the front looks along −y.
    Z,
}

/// Why a camera cannot be placed.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum CameraError {
    /// The eye or the target is not finite.
    #[error("the camera cannot look from {} to {}: the coordinates are too large, or no numbers", Point(*eye), Point(*target))]
    NotFinite {
        /// The eye.
        eye: DVec3,
        /// The target.
        target: DVec3,
    },
    /// The eye is at the target.
    #[error("the eye and the target are the same point, {}", Point(*.0))]
    NoDirection(DVec3),
    /// The eye is so far away that rays cannot be told from each other.
    #[error(
        "the camera cannot look from {}: from more than 10^12 times the size of the box ({}), rays through \
         different pixels are the same in double precision",
        Point(*eye),
        Number(*size)
    )]
    TooFar {
        /// The eye.
        eye: DVec3,
        /// The longest side of the box.
        size: f64,
    },
    /// The up vector is zero, not finite, or points along the view.
    #[error("up {} must not be zero or point along the view {}", Point(*up), Point(*forward))]
    Up {
        /// The up vector that was asked for.
        up: DVec3,
        /// The direction of the view.
        forward: DVec3,
    },
    /// The field of view is not between 0 and π.
    #[error("a field of view lies between 0 and 180 degrees, not at {}", degrees(*.0))]
    FieldOfView(f64),
    /// The height of an orthographic image is not positive and finite.
    #[error("the height of an orthographic image is a positive number, not {}", Number(*.0))]
    Height(f64),
    /// The radius of the aperture or the distance of the focus is not positive and finite.
    #[error(
        "the radius of an aperture and the distance of its focus are positive numbers, not {} and {}",
        Number(*radius),
        Number(*focus_distance)
    )]
    Aperture {
        /// The radius.
        radius: f64,
        /// The distance.
        focus_distance: f64,
    },
}

/// What the user fixed of a camera; the rest is chosen so that the solid is seen well.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct View {
    /// Where the camera stands.
    pub eye: Option<DVec3>,
    /// What is in the middle of the image.
    pub target: Option<DVec3>,
    /// What points up in the image.
    pub up: Option<DVec3>,
    /// How space is mapped to the image.
    pub projection: Option<Projection>,
}

/// A camera.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    projection: Projection,
    lens: Option<Aperture>,
}

/// The opening of a lens: only what is at one distance is sharp.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Aperture {
    /// The radius of the opening, in units of the scene.
    pub radius: f64,
    /// How far the plane is in which things are sharp, along the view.
    pub focus_distance: f64,
}

/// The field of view where nothing else decides.
const DEFAULT_FOV: f64 = 30.0 / 180.0 * PI;

/// How far a fixed eye may be from a box, in units of the longest side: pixels are some 10⁻³ of that, and directions are
/// rounded to 10⁻¹⁶.
const FARTHEST: f64 = 1e12;

/// The largest field of view that is chosen to fit a box; an eye that would need more stands too close.
const WIDEST_FITTED_FOV: f64 = 100.0 / 180.0 * PI;

/// The part of the image, on each side, that a fitted box leaves free.
const MARGIN: f64 = 0.04;

/// How far a fitted box may be from the middle, as a part of half the image.
const FILL: f64 = 1.0 - 2.0 * MARGIN;

impl Up {
    /// The axis.
    pub fn axis(self) -> DVec3 {
        match self {
            Up::Y => DVec3::Y,
            Up::Z => DVec3::Z,
        }
    }

    /// What points up in the image if the view runs along the axis: the side that is away from the front.
    fn away(self) -> DVec3 {
        match self {
            Up::Y => -DVec3::Z,
            Up::Z => DVec3::Y,
        }
    }

    /// The unit vector from a solid towards an eye that sees it from the front, from the right and from above.
    pub fn three_quarter(self) -> DVec3 {
        let (azimuth, elevation) = (32.0_f64.to_radians(), 24.0_f64.to_radians());
        let level = DVec3::X * azimuth.sin() - self.away() * azimuth.cos();
        level * elevation.cos() + self.axis() * elevation.sin()
    }
}

impl Projection {
    fn checked(self) -> Result<Self, CameraError> {
        match self {
            Self::Perspective { vertical_fov_radians: fov } if !(fov > 0.0 && fov < PI) => {
                Err(CameraError::FieldOfView(fov))
            }
            Self::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                Err(CameraError::Height(height))
            }
            valid => Ok(valid),
        }
    }
}

impl Camera {
    /// A camera at `eye` that looks at `target`, with `up` upwards in the image.
    ///
    /// # Errors
    /// An eye at the target, an up vector along the view, a projection without an image.
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
    ) -> Result<Self, CameraError> {
        if !(eye.is_finite() && target.is_finite()) {
            return Err(CameraError::NotFinite { eye, target });
        }
        let forward = (target - eye).try_normalize().ok_or(CameraError::NoDirection(eye))?;
        Self::along(eye, forward, up, projection.checked()?)
    }

    /// The camera at `eye` that looks along the unit vector `forward`.
    fn along(eye: DVec3, forward: DVec3, up: DVec3, projection: Projection) -> Result<Self, CameraError> {
        let parallel = CameraError::Up { up, forward };
        let across = forward.cross(up.try_normalize().ok_or(parallel)?);
        if across.length() < 1e-9 {
            return Err(parallel);
        }
        let right = across.normalize();
        Ok(Self { eye, forward, right, up: right.cross(forward).normalize(), projection, lens: None })
    }

    /// The default camera: a three-quarter view from the front, the right and above, as close as it can be with every
    /// corner of the box in the image and 4 % of it free on each side. `aspect` is width / height.
    pub fn fitted(bounds: &Bounds, up: Up, aspect: f64) -> Self {
        let lens = Projection::Perspective { vertical_fov_radians: DEFAULT_FOV };
        Self::facing(bounds.centre(), -up.three_quarter(), up, lens).fit_position(bounds, aspect)
    }

    /// A camera that shows the box, with what `view` fixes. `aspect` is width / height.
    ///
    /// The target is the middle of the box and the eye in front of it as in [`fitted`](Self::fitted), unless fixed.
    /// From a fixed eye, the field of view is chosen so that the box fits.
    ///
    /// # Errors
    /// See [`look_at`](Self::look_at); an eye very far from the box. An up vector that `view` does not fix is never an error.
    pub fn framing(bounds: &Bounds, view: &View, up: Up, aspect: f64) -> Result<Self, CameraError> {
        let default_lens = Projection::Perspective { vertical_fov_radians: DEFAULT_FOV };
        let lens = view.projection.unwrap_or(default_lens).checked()?;
        let target = view.target.unwrap_or(bounds.centre());
        let Some(eye) = view.eye else {
            if !target.is_finite() {
                return Err(CameraError::NotFinite { eye: target, target });
            }
            let forward = -up.three_quarter();
            let camera = match view.up {
                Some(up) => Self::along(target, forward, up, lens)?,
                None => Self::facing(target, forward, up, lens),
            };
            let centred = view.target.is_some();
            let fit = if centred { Self::fit_distance } else { Self::fit_position };
            return Ok(fit(camera, bounds, aspect));
        };
        let size = bounds.longest_side();
        if (eye - bounds.centre()).length() > FARTHEST * size {
            return Err(CameraError::TooFar { eye, size });
        }
        let camera = match view.up {
            Some(up) => Self::look_at(eye, target, up, lens)?,
            None => match Self::look_at(eye, target, up.axis(), lens) {
                Err(CameraError::Up { .. }) => Self::look_at(eye, target, up.away(), lens)?,
                other => other?,
            },
        };
        Ok(if view.projection.is_none() { camera.fit_angle(bounds, aspect) } else { camera })
    }

    /// A camera with a view that the two directions of `up` cannot both be parallel to.
    fn facing(eye: DVec3, forward: DVec3, up: Up, projection: Projection) -> Self {
        let across = forward.cross(up.axis());
        let across = if across.length() < 1e-9 { forward.cross(up.away()) } else { across };
        let right = across.normalize();
        Self { eye, forward, right, up: right.cross(forward).normalize(), projection, lens: None }
    }

    /// The corners of a box along right, up and forward, seen from the eye.
    fn corners_in_view(&self, bounds: &Bounds) -> [DVec3; 8] {
        bounds.corners().map(|corner| {
            let d = corner - self.eye;
            DVec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.forward))
        })
    }

    /// Moves the eye as near as it can be with the box inside the image, and sideways to where the box is in the
    /// middle; the direction stays.
    fn fit_position(self, bounds: &Bounds, aspect: f64) -> Self {
        let corners = self.corners_in_view(bounds);
        let least = |f: &dyn Fn(DVec3) -> f64| corners.iter().map(|&c| f(c)).fold(f64::INFINITY, f64::min);
        let greatest = |f: &dyn Fn(DVec3) -> f64| -least(&|c| -f(c));
        let Projection::Perspective { vertical_fov_radians } = self.projection else {
            let middle = |i: usize| 0.5 * (least(&|c| c[i]) + greatest(&|c| c[i]));
            return self.moved(DVec3::new(middle(0), middle(1), self.in_front(bounds)));
        };
        let slope_y = (0.5 * vertical_fov_radians).tan() * FILL;
        let slopes = [slope_y * aspect, slope_y];
        // A corner c is between the left and the right plane through an eye at (x, ., z) if
        // |c.x − x| ≤ k·(c.z − z), that is c.x − k·c.z + k·z ≤ x ≤ c.x + k·c.z − k·z. There is such an x for all
        // corners as long as z does not exceed `reach`.
        let left = |i: usize| greatest(&|c| c[i] - slopes[i] * c.z);
        let right = |i: usize| least(&|c| c[i] + slopes[i] * c.z);
        let reach = |i: usize| (right(i) - left(i)) / (2.0 * slopes[i]);
        let z = reach(0).min(reach(1));
        let middle = |i: usize| middle(&corners, i, z, (left(i) + slopes[i] * z, right(i) - slopes[i] * z));
        self.moved(DVec3::new(middle(0), middle(1), z))
    }

    /// Moves the eye back from where it is, the target, to where the box is inside the image.
    fn fit_distance(self, bounds: &Bounds, aspect: f64) -> Self {
        let Projection::Perspective { vertical_fov_radians } = self.projection else {
            return self.moved(DVec3::new(0.0, 0.0, self.in_front(bounds)));
        };
        let slope = (0.5 * vertical_fov_radians).tan() * FILL;
        let needed = |c: DVec3| (c.x.abs() / (slope * aspect)).max(c.y.abs() / slope) - c.z;
        let corners = self.corners_in_view(bounds).into_iter();
        let back = corners.map(needed).fold(f64::NEG_INFINITY, f64::max);
        // A target far from the box may have all of it ahead; the eye stays apart from the target all the same.
        self.moved(DVec3::new(0.0, 0.0, -back.max(bounds.longest_side() * 1e-3)))
    }

    /// Chooses the field of view from where the camera stands.
    fn fit_angle(self, bounds: &Bounds, aspect: f64) -> Self {
        let slope =
            |c: DVec3| if c.z > 0.0 { (c.x.abs() / aspect).max(c.y.abs()) / c.z } else { f64::INFINITY };
        let steepest = self.corners_in_view(bounds).into_iter().map(slope).fold(0.0, f64::max);
        let fov = (2.0 * (steepest / FILL).atan()).min(WIDEST_FITTED_FOV);
        Self { projection: Projection::Perspective { vertical_fov_radians: fov }, ..self }
    }

    /// Where a parallel view has the whole box before it: a place along the view, seen from the eye.
    fn in_front(&self, bounds: &Bounds) -> f64 {
        let nearest = self.corners_in_view(bounds).into_iter().map(|c| c.z).fold(f64::INFINITY, f64::min);
        nearest - bounds.longest_side()
    }

    fn moved(self, by: DVec3) -> Self {
        Self { eye: self.eye + by.x * self.right + by.y * self.up + by.z * self.forward, ..self }
    }

    /// Where the camera stands.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The unit vector of the view.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The unit vector to the right of the image.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit vector to the top of the image.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// How space is mapped to the image.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// With a lens that is not a pinhole: see [`lens_ray`](Self::lens_ray).
    ///
    /// # Errors
    /// A radius or a distance that is not positive and finite.
    pub fn with_aperture(self, aperture: Aperture) -> Result<Self, CameraError> {
        let Aperture { radius, focus_distance } = aperture;
        let sound = |length: f64| length > 0.0 && length.is_finite();
        if sound(radius) && sound(focus_distance) {
            Ok(Self { lens: Some(aperture), ..self })
        } else {
            Err(CameraError::Aperture { radius, focus_distance })
        }
    }

    /// The opening of the lens, unless it is a pinhole.
    pub fn aperture(&self) -> Option<Aperture> {
        self.lens
    }

    /// The ray through the same point of the sharp plane as [`ray`](Self::ray), from the place (a, b) of the lens, both
    /// from −1 to 1 in units of the radius of the aperture, to the right and upwards. Without an aperture, the same ray.
    pub fn lens_ray(&self, (u, v): (f64, f64), aspect: f64, (a, b): (f64, f64)) -> (DVec3, DVec3) {
        let (origin, direction) = self.ray(u, v, aspect);
        let Some(Aperture { radius, focus_distance }) = self.lens else { return (origin, direction) };
        let sharp = direction * (focus_distance / direction.dot(self.forward));
        let aside = radius * (a * self.right + b * self.up);
        (origin + aside, (sharp - aside).normalize())
    }

    /// The ray through the point (u, v) of an image whose width is `aspect` times its height: origin and unit
    /// direction.
    pub fn ray(&self, u: f64, v: f64, aspect: f64) -> (DVec3, DVec3) {
        self.rays(aspect).at(u, v)
    }

    /// The rays through all points of an image whose width is `aspect` times its height.
    pub fn rays(&self, aspect: f64) -> Rays {
        let (is_perspective, half) = match self.projection {
            Projection::Perspective { vertical_fov_radians } => (true, (0.5 * vertical_fov_radians).tan()),
            Projection::Orthographic { height } => (false, 0.5 * height),
        };
        let (right, up) = (half * aspect * self.right, half * self.up);
        Rays { is_perspective, eye: self.eye, forward: self.forward, right, up }
    }

    /// Where a point appears in the image, as (u, v); `None` behind a perspective eye.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<(f64, f64)> {
        let d = point - self.eye;
        let half = match self.projection {
            Projection::Perspective { vertical_fov_radians } => {
                (0.5 * vertical_fov_radians).tan() * d.dot(self.forward)
            }
            Projection::Orthographic { height } => 0.5 * height,
        };
        let (x, y) = (d.dot(self.right) / half, d.dot(self.up) / half);
        (half > 0.0).then_some((0.5 + 0.5 * x / aspect, 0.5 - 0.5 * y))
    }
}

/// The rays through the points of an image.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    is_perspective: bool,
    eye: DVec3,
    forward: DVec3,
    /// From the middle of the image to its right edge, and to its upper edge.
    right: DVec3,
    up: DVec3,
}

impl Rays {
    /// The ray through the point (u, v): origin and unit direction.
    pub fn at(&self, u: f64, v: f64) -> (DVec3, DVec3) {
        let aside = (2.0 * u - 1.0) * self.right + (1.0 - 2.0 * v) * self.up;
        if self.is_perspective {
            (self.eye, (self.forward + aside).normalize())
        } else {
            (self.eye + aside, self.forward)
        }
    }
}

/// Where between `low` and `high` on axis `i` an eye at depth `z` stands so that the outermost of `corners` on either
/// side appear equally far from the middle of its image.
fn middle(corners: &[DVec3; 8], i: usize, z: f64, (mut low, mut high): (f64, f64)) -> f64 {
    const HALVINGS: u32 = 60;
    for _ in 0..HALVINGS {
        let eye = 0.5 * (low + high);
        let places = corners.map(|c| (c[i] - eye) / (c.z - z));
        let least = places.into_iter().fold(f64::INFINITY, f64::min);
        let greatest = places.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if least + greatest > 0.0 { low = eye } else { high = eye }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests;
