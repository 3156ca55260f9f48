//! What surrounds a scene: the light that comes from where nothing is hit.
//!
//! An environment has a frame of its own: right, up and front, with right × up = back. With `up` = y, right is +x and
//! front −z, as in most programs; with `up` = z, right is +x and front +y. For other directions of up, the frame of y is
//! turned along the shortest way. [`Environment::rotated`] turns it about up, counterclockwise seen from above.

use crate::bounds::Bounds;
use crate::colour::Rgb;
use crate::image::{Image, Wrap};
use crate::light::{DEFAULT_SAMPLES, MAX_LIGHT_SAMPLES};
use crate::text::Number;
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// What is seen on one face of a cube or one wall of a room.
#[derive(Clone, PartialEq, Debug)]
pub enum Face {
    /// One colour.
    Plain(Rgb),
    /// Squares of two colours, `count` along either side, the first in the upper left corner.
    Checker {
        /// The colours.
        colours: [Rgb; 2],
        /// How many squares there are along a side; 0 counts as 1.
        count: u32,
    },
    /// A picture, as wide and high as the face.
    Picture(Arc<Image>),
}

impl Face {
    /// The colour at (u, v) from the upper left (0, 0) to the lower right corner (1, 1).
    fn at(&self, u: f64, v: f64) -> Rgb {
        match self {
            Self::Plain(colour) => *colour,
            Self::Checker { colours, count } => {
                let count = f64::from((*count).max(1));
                let square = |x: f64| (x * count).floor().clamp(0.0, count - 1.0) as u64;
                colours[((square(u) + square(v)) % 2) as usize]
            }
            Self::Picture(image) => image.at(u, v, Wrap::Clamp),
        }
    }

    fn is_sound(&self) -> bool {
        match self {
            Self::Plain(colour) => is_light(*colour),
            Self::Checker { colours, .. } => colours.iter().all(|c| is_light(*c)),
            Self::Picture(_) => true,
        }
    }
}

/// What light comes from which direction.
#[derive(Clone, PartialEq, Debug)]
pub enum Surroundings {
    /// The same from everywhere.
    Uniform(Rgb),
    /// From the zenith over the horizon to the nadir, even in the sine of the elevation.
    Gradient {
        /// From straight above.
        zenith: Rgb,
        /// From the side.
        horizon: Rgb,
        /// From straight below.
        nadir: Rgb,
    },
    /// A picture of all directions: rows are latitudes, evenly from the zenith on top to the nadir; columns are
    /// longitudes, the front in the middle and the right a quarter of the width right of that.
    LatLong(Arc<Image>),
    /// Six faces of a cube around the scene, infinitely large, as one sees them from its middle: right, left, up, down,
    /// front, back. Up is on top of the four at the side; the lower edge of the face above and the upper edge of the one
    /// below meet the front.
    Cube(Arc<[Face; 6]>),
    /// The same six faces on the walls of a box of this size, the environment of early ray tracers: what is seen
    /// depends on where a ray starts. A ray that starts outside sees the inner side of the far wall, or black if it
    /// passes the box. Faces are those that the frame turns to the walls, so that its axes should be along the box.
    Room {
        /// The box, in the world.
        bounds: Bounds,
        /// What is on the walls.
        walls: Arc<[Face; 6]>,
    },
}

/// The light that comes from where nothing is hit.
#[derive(Clone, PartialEq, Debug)]
pub struct Environment {
    surroundings: Surroundings,
    strength: f64,
    up: DVec3,
    rotation_radians: f64,
    environment_from_world: DQuat,
    samples: u32,
    visible: bool,
}

/// Why numbers make no [`Environment`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// A component of a colour is negative or not finite.
    #[error("a colour of the environment is negative or not finite")]
    Colour,
    /// The strength is negative or not finite.
    #[error("the strength of an environment is a number from 0 on, not {}", Number(*.0))]
    Strength(f64),
    /// The up vector is zero or not finite, or the angle is not finite.
    #[error("an environment cannot be turned like that")]
    Frame,
    /// No sample, or more than [`MAX_LIGHT_SAMPLES`].
    #[error("the samples of an environment are a number from 1 to {MAX_LIGHT_SAMPLES}, not {0}")]
    Samples(u32),
}

fn is_light(colour: Rgb) -> bool {
    colour.is_finite() && colour.cmpge(DVec3::ZERO).all()
}

impl Environment {
    /// An environment of strength 1 with y up, seen by every ray.
    ///
    /// # Errors
    /// Colours that are negative or not finite.
    pub fn new(surroundings: Surroundings) -> Result<Self, EnvironmentError> {
        let sound = match &surroundings {
            Surroundings::Uniform(colour) => is_light(*colour),
            Surroundings::Gradient { zenith, horizon, nadir } => {
                [zenith, horizon, nadir].iter().all(|c| is_light(**c))
            }
            Surroundings::LatLong(_) => true,
            Surroundings::Cube(faces) | Surroundings::Room { walls: faces, .. } => {
                faces.iter().all(Face::is_sound)
            }
        };
        let made = Self {
            surroundings,
            strength: 1.0,
            up: DVec3::Y,
            rotation_radians: 0.0,
            environment_from_world: DQuat::IDENTITY,
            samples: DEFAULT_SAMPLES,
            visible: true,
        };
        if sound { Ok(made) } else { Err(EnvironmentError::Colour) }
    }

    /// With all its light multiplied by this.
    ///
    /// # Errors
    /// A strength that is negative or not finite.
    pub fn with_strength(self, strength: f64) -> Result<Self, EnvironmentError> {
        let sound = strength >= 0.0 && strength.is_finite();
        if sound { Ok(Self { strength, ..self }) } else { Err(EnvironmentError::Strength(strength)) }
    }

    /// With another direction up (of any length), and turned about it by an angle, counterclockwise seen from above.
    ///
    /// # Errors
    /// A direction without a length, an angle that is not finite.
    pub fn rotated(self, up: DVec3, radians: f64) -> Result<Self, EnvironmentError> {
        let up = up.try_normalize().filter(|_| radians.is_finite()).ok_or(EnvironmentError::Frame)?;
        let world_from_environment =
            DQuat::from_axis_angle(up, radians) * DQuat::from_rotation_arc(DVec3::Y, up);
        let environment_from_world = world_from_environment.normalize().inverse();
        Ok(Self { up, rotation_radians: radians, environment_from_world, ..self })
    }

    /// Whether rays from the eye see it; if not, they see the background of the picture.
    pub fn with_visible(self, visible: bool) -> Self {
        Self { visible, ..self }
    }

    /// With so many directions looked at from each matt point that it lights. The default is 4.
    ///
    /// # Errors
    /// No sample, or more than [`MAX_LIGHT_SAMPLES`].
    pub fn with_samples(self, samples: u32) -> Result<Self, EnvironmentError> {
        let sound = (1..=MAX_LIGHT_SAMPLES).contains(&samples);
        if sound { Ok(Self { samples, ..self }) } else { Err(EnvironmentError::Samples(samples)) }
    }

    /// What light comes from which direction.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// What its light is multiplied by.
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// The unit vector up.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// How far it is turned about up, in radians, counterclockwise seen from above.
    pub fn rotation_radians(&self) -> f64 {
        self.rotation_radians
    }

    /// How many directions are looked at from each matt point.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether rays from the eye see it.
    pub fn is_visible(&self) -> bool {
        self.visible
    }

    /// Whether the light depends on where a ray starts, not only on its direction.
    pub fn is_near(&self) -> bool {
        matches!(self.surroundings, Surroundings::Room { .. })
    }

    /// The colour of a white, matt surface with this unit normal, with nothing in the way, where there is a closed form:
    /// in even light and in gradients.
    ///
    /// A gradient is even light and two parts that grow with the sine of the elevation above and below the horizon; of
    /// those, a surface turned by θ from the axis gets 2/3π (sin θ + (π − θ) cos θ).
    pub fn on_matt(&self, normal: DVec3) -> Option<Rgb> {
        let light = match &self.surroundings {
            Surroundings::Uniform(colour) => *colour,
            Surroundings::Gradient { zenith, horizon, nadir } => {
                let cosine = normal.dot(self.up).clamp(-1.0, 1.0);
                let (angle, sine) = (cosine.acos(), (1.0 - cosine * cosine).sqrt());
                let above = 2.0 / (3.0 * PI) * (sine + (PI - angle) * cosine);
                let below = 2.0 / (3.0 * PI) * (sine - angle * cosine);
                *horizon + (*zenith - *horizon) * above + (*nadir - *horizon) * below
            }
            Surroundings::LatLong(_) | Surroundings::Cube(_) | Surroundings::Room { .. } => return None,
        };
        Some(light * self.strength)
    }

    /// The light that comes back along a ray that meets nothing: radiance, linear RGB.
    pub fn light(&self, origin: DVec3, direction: DVec3) -> Rgb {
        let towards = |d: DVec3| self.environment_from_world * d;
        let light = match &self.surroundings {
            Surroundings::Uniform(colour) => *colour,
            Surroundings::Gradient { zenith, horizon, nadir } => {
                let sine = direction.dot(self.up).clamp(-1.0, 1.0);
                horizon.lerp(if sine > 0.0 { *zenith } else { *nadir }, sine.abs())
            }
            Surroundings::LatLong(image) => {
                let (u, v) = lat_long(towards(direction));
                image.at(u, v, Wrap::Repeat)
            }
            Surroundings::Cube(faces) => on_cube(faces, towards(direction)),
            Surroundings::Room { bounds, walls } => match bounds.ray_span(origin, direction) {
                Some(span) if span.exit > 0.0 => {
                    let place = origin + span.exit * direction - bounds.centre();
                    on_cube(walls, towards(place / (0.5 * bounds.size())))
                }
                _ => DVec3::ZERO,
            },
        };
        light * self.strength
    }
}

/// Where a direction of the environment's frame is on a picture of all directions.
fn lat_long(direction: DVec3) -> (f64, f64) {
    let d = direction.normalize_or_zero();
    (0.5 + d.x.atan2(-d.z) / TAU, d.y.clamp(-1.0, 1.0).acos() / PI)
}

/// What is seen on the faces of a cube from its middle, in the environment's frame.
fn on_cube(faces: &[Face; 6], d: DVec3) -> Rgb {
    let size = d.abs();
    // To the right and downwards on the face, and the distance of the face.
    let (face, right, down, away) = if size.x >= size.y && size.x >= size.z {
        if d.x > 0.0 { (0, d.z, -d.y, size.x) } else { (1, -d.z, -d.y, size.x) }
    } else if size.y >= size.z {
        if d.y > 0.0 { (2, d.x, -d.z, size.y) } else { (3, d.x, d.z, size.y) }
    } else if d.z < 0.0 {
        (4, d.x, -d.y, size.z)
    } else {
        (5, -d.x, -d.y, size.z)
    };
    faces[face].at(0.5 + 0.5 * right / away, 0.5 + 0.5 * down / away)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-9
    }

    fn grey(faces: [f64; 6]) -> Arc<[Face; 6]> {
        Arc::new(faces.map(|f| Face::Plain(DVec3::splat(f))))
    }

    const SIX: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::NEG_Z, DVec3::Z];

    #[test]
    fn environments_are_checked() {
        assert_eq!(
            Environment::new(Surroundings::Uniform(-DVec3::X)).map(|_| ()),
            Err(EnvironmentError::Colour)
        );
        let grey = || Environment::new(Surroundings::Uniform(DVec3::ONE)).unwrap();
        assert!(grey().with_strength(-1.0).is_err() && grey().with_strength(f64::NAN).is_err());
        assert!(grey().rotated(DVec3::ZERO, 0.0).is_err() && grey().rotated(DVec3::Y, f64::NAN).is_err());
        assert_eq!(grey().with_strength(3.0).unwrap().light(DVec3::ZERO, DVec3::X), DVec3::splat(3.0));
    }

    #[test]
    fn gradients_run_over_the_horizon() {
        let sky = Surroundings::Gradient { zenith: DVec3::X, horizon: DVec3::Y, nadir: DVec3::Z };
        let sky = Environment::new(sky).unwrap().rotated(DVec3::Z, 1.0).unwrap();
        let light = |d: DVec3| sky.light(DVec3::ZERO, d);
        assert_eq!((light(DVec3::Z), light(DVec3::X), light(-DVec3::Z)), (DVec3::X, DVec3::Y, DVec3::Z));
        assert!(close(light(DVec3::new(0.8, 0.0, 0.6)), DVec3::new(0.6, 0.4, 0.0)));
    }

    /// By quadrature over all directions.
    #[test]
    fn matt_surfaces_in_gradients_have_the_colour_of_the_closed_form() {
        const SIDE: u32 = 400;
        let sky = Surroundings::Gradient { zenith: DVec3::X, horizon: DVec3::Y, nadir: DVec3::Z };
        let sky = Environment::new(sky).unwrap().rotated(DVec3::new(1.0, 2.0, -0.5), 0.3).unwrap();
        let sky = sky.with_strength(1.5).unwrap();
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        for normal in [sky.up(), -sky.up(), DVec3::X, DVec3::new(-0.6, 0.0, 0.8)] {
            let mut sum = DVec3::ZERO;
            for i in 0..SIDE * SIDE {
                let (z, turn) = (2.0 * place(i / SIDE) - 1.0, TAU * place(i % SIDE));
                let direction = DVec3::new(turn.cos(), turn.sin(), 0.0) * (1.0 - z * z).sqrt() + z * DVec3::Z;
                sum += sky.light(DVec3::ZERO, direction) * direction.dot(normal).max(0.0);
            }
            let expected = sum * 4.0 / f64::from(SIDE * SIDE);
            let found = sky.on_matt(normal).unwrap();
            assert!((found - expected).length() < 1e-4, "{found} is not {expected} at {normal}");
        }
        let picture = Image::new(1, 1, vec![[1.0; 3]]).unwrap();
        assert!(
            Environment::new(Surroundings::LatLong(Arc::new(picture))).unwrap().on_matt(DVec3::Z).is_none()
        );
    }

    #[test]
    fn latitudes_run_from_the_zenith_and_longitudes_from_behind() {
        // Four columns: between them lie left, front, right and back.
        let column = |i: u8| [[f32::from(i), 0.0, 0.0], [f32::from(i), 1.0, 0.0]];
        let [a, b, c, d] = [0, 1, 2, 3].map(column);
        let pixels = vec![a[0], b[0], c[0], d[0], a[1], b[1], c[1], d[1]];
        let image = Arc::new(Image::new(4, 2, pixels).unwrap());
        let around = Environment::new(Surroundings::LatLong(image)).unwrap();
        let light = |d: DVec3| around.light(DVec3::ZERO, d);
        assert!(close(light(-DVec3::Z), DVec3::new(1.5, 0.5, 0.0)));
        assert!(close(light(DVec3::X), DVec3::new(2.5, 0.5, 0.0)));
        assert!(close(light(-DVec3::X), DVec3::new(0.5, 0.5, 0.0)));
        assert!(close(light(DVec3::Z), DVec3::new(1.5, 0.5, 0.0)));
        assert_eq!((light(DVec3::Y).y, light(-DVec3::Y).y), (0.0, 1.0));
    }

    #[test]
    fn cubes_have_six_faces_and_frames_turn_them() {
        let cube = Environment::new(Surroundings::Cube(grey([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]))).unwrap();
        for (i, direction) in SIX.into_iter().enumerate() {
            assert_eq!(cube.light(DVec3::ZERO, direction).x, i as f64);
        }
        // With z up, the front is +y.
        let turned = cube.clone().rotated(DVec3::Z, 0.0).unwrap();
        let expected = [(DVec3::X, 0.0), (DVec3::Z, 2.0), (DVec3::Y, 4.0), (DVec3::NEG_Y, 5.0)];
        for (direction, face) in expected {
            assert_eq!(turned.light(DVec3::ZERO, direction).x, face);
        }
        // A quarter turn to the left brings the front, −z, to −x.
        let turned = cube.rotated(DVec3::Y, PI / 2.0).unwrap();
        assert_eq!(turned.light(DVec3::ZERO, DVec3::NEG_X).x, 4.0);
    }

    /// Faces with a different colour in each corner meet their neighbours as the convention says.
    #[test]
    fn faces_are_upright_and_above_and_below_meet_the_front() {
        let corners = Image::new(2, 2, vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]]).unwrap();
        let picture = Face::Picture(Arc::new(corners));
        let cube = Environment::new(Surroundings::Cube(Arc::new([(); 6].map(|()| picture.clone())))).unwrap();
        let light = |x: f64, y: f64, z: f64| cube.light(DVec3::ZERO, DVec3::new(x, y, z)).x;
        // Front: right is +x, up is +y; the upper left pixel is 0.
        assert_eq!([light(-0.9, 0.9, -1.0), light(0.9, 0.9, -1.0), light(-0.9, -0.9, -1.0)], [0.0, 1.0, 2.0]);
        // Right: seen from the middle, the front is on the left.
        assert_eq!([light(1.0, 0.9, -0.9), light(1.0, 0.9, 0.9), light(1.0, -0.9, -0.9)], [0.0, 1.0, 2.0]);
        // Above: its lower edge is in front. Below: its upper edge is.
        assert_eq!([light(-0.9, 1.0, -0.9), light(0.9, 1.0, 0.9)], [2.0, 1.0]);
        assert_eq!([light(-0.9, -1.0, -0.9), light(0.9, -1.0, 0.9)], [0.0, 3.0]);
    }

    #[test]
    fn what_is_seen_in_a_room_depends_on_the_place() {
        let bounds = Bounds::new(DVec3::new(-1.0, -1.0, -4.0), DVec3::new(1.0, 1.0, 4.0)).unwrap();
        let walls = grey([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let room = Environment::new(Surroundings::Room { bounds, walls }).unwrap();
        let slanting = DVec3::new(1.0, 0.0, -1.0).normalize();
        assert_eq!(room.light(DVec3::ZERO, slanting).x, 1.0);
        assert_eq!(room.light(DVec3::new(-0.5, 0.0, -3.5), slanting).x, 5.0);
        // From outside: the far wall; past it: nothing.
        assert_eq!(room.light(DVec3::new(0.0, 0.0, 9.0), -DVec3::Z).x, 5.0);
        assert_eq!(room.light(DVec3::new(0.0, 0.0, 9.0), DVec3::Z), DVec3::ZERO);
        let checker = Face::Checker { colours: [DVec3::X, DVec3::Y], count: 2 };
        assert_eq!(
            [checker.at(0.1, 0.1), checker.at(0.9, 0.1), checker.at(0.9, 1.0)],
            [DVec3::X, DVec3::Y, DVec3::X]
        );
    }
}
