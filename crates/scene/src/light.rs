//! Lights.

use crate::camera::Camera;
use crate::colour::{Background, Rgb};
use glam::DVec3;

/// Where light comes from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum LightSource {
    /// From infinitely far.
    Directional {
        /// The unit vector towards the light.
        to_light: DVec3,
    },
    /// From a point; the light falls off with the square of the distance.
    Point {
        /// Where it stands.
        position: DVec3,
    },
}

/// A light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Light {
    source: LightSource,
    colour: Rgb,
    casts_shadow: bool,
}

/// Why numbers make no [`Light`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum LightError {
    /// The direction is zero or not finite.
    #[error("light cannot come from the direction {0}")]
    Direction(DVec3),
    /// The position is not finite.
    #[error("a light cannot stand at {0}")]
    Position(DVec3),
    /// A component of the colour is negative or not finite.
    #[error("the colour of a light is not negative and finite: {0}")]
    Colour(Rgb),
}

/// The light that arrives at a point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Illumination {
    /// The unit vector towards the light.
    pub to_light: DVec3,
    /// How far it is; infinite for directional lights.
    pub distance: f64,
    /// The colour of a white, matt surface that faces the light.
    pub colour: Rgb,
}

fn checked_colour(colour: Rgb) -> Result<Rgb, LightError> {
    let valid = colour.is_finite() && colour.cmpge(DVec3::ZERO).all();
    if valid { Ok(colour) } else { Err(LightError::Colour(colour)) }
}

impl Light {
    /// A light from infinitely far, in the direction `to_light` (of any length), that casts shadows. A white, matt
    /// surface that faces it has the colour `colour`.
    ///
    /// # Errors
    /// A direction without a length, a colour that is negative or not finite.
    pub fn directional(to_light: DVec3, colour: Rgb) -> Result<Self, LightError> {
        let to_light = to_light.try_normalize().ok_or(LightError::Direction(to_light))?;
        let source = LightSource::Directional { to_light };
        Ok(Self { source, colour: checked_colour(colour)?, casts_shadow: true })
    }

    /// A light at a point, that casts shadows. A white, matt surface that faces it at distance 1 has the colour
    /// `colour`.
    ///
    /// # Errors
    /// A position that is not finite, a colour that is negative or not finite.
    pub fn point(position: DVec3, colour: Rgb) -> Result<Self, LightError> {
        if !position.is_finite() {
            return Err(LightError::Position(position));
        }
        let source = LightSource::Point { position };
        Ok(Self { source, colour: checked_colour(colour)?, casts_shadow: true })
    }

    /// The same light, which nothing blocks.
    pub fn without_shadow(self) -> Self {
        Self { casts_shadow: false, ..self }
    }

    /// Where the light comes from.
    pub fn source(&self) -> LightSource {
        self.source
    }

    /// Its colour: see the constructors.
    pub fn colour(&self) -> Rgb {
        self.colour
    }

    /// Whether solids block it.
    pub fn casts_shadow(&self) -> bool {
        self.casts_shadow
    }

    /// What arrives at a point if nothing blocks it; nothing at the very place of a point light.
    pub fn at(&self, point: DVec3) -> Option<Illumination> {
        match self.source {
            LightSource::Directional { to_light } => {
                Some(Illumination { to_light, distance: f64::INFINITY, colour: self.colour })
            }
            LightSource::Point { position } => {
                let distance = point.distance(position);
                let to_light = (position - point).try_normalize()?;
                Some(Illumination { to_light, distance, colour: self.colour / (distance * distance) })
            }
        }
    }
}

/// All light of a scene.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Lighting {
    /// The lights.
    pub lights: Vec<Light>,
    /// The light that comes evenly from everywhere: the colour of a white, matt surface that no light reaches.
    pub ambient: Rgb,
    /// What is seen where nothing is hit.
    pub background: Background,
}

impl Lighting {
    /// A good default that moves with the camera: a strong, warm light with shadows from the upper left behind the
    /// viewer, a weak, cool one without from the right, and a little from everywhere.
    pub fn for_camera(camera: &Camera) -> Self {
        let (right, up, back) = (camera.right(), camera.up(), -camera.forward());
        let light = |towards: DVec3, colour, casts_shadow| Light {
            source: LightSource::Directional { to_light: towards.normalize() },
            colour,
            casts_shadow,
        };
        let key = light(-0.55 * right + 0.85 * up + 0.75 * back, DVec3::new(1.02, 0.98, 0.90), true);
        let fill = light(0.80 * right + 0.10 * up + 0.60 * back, DVec3::new(0.17, 0.20, 0.25), false);
        Self {
            lights: vec![key, fill],
            ambient: DVec3::new(0.10, 0.11, 0.13),
            background: Background::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bounds, Up};

    #[test]
    fn lights_are_checked() {
        assert_eq!(Light::directional(DVec3::ZERO, DVec3::ONE), Err(LightError::Direction(DVec3::ZERO)));
        assert!(matches!(Light::directional(DVec3::Z, -DVec3::ONE), Err(LightError::Colour(_))));
        assert!(matches!(Light::point(DVec3::NAN, DVec3::ONE), Err(LightError::Position(_))));
        assert!(matches!(Light::point(DVec3::ONE, DVec3::INFINITY), Err(LightError::Colour(_))));
    }

    #[test]
    fn point_lights_fall_off_with_the_square() {
        let light = Light::point(DVec3::new(0.0, 0.0, 3.0), DVec3::splat(9.0)).unwrap();
        let arriving = light.at(DVec3::ZERO).unwrap();
        assert_eq!(arriving.to_light, DVec3::Z);
        assert_eq!((arriving.distance, arriving.colour), (3.0, DVec3::ONE));
        assert_eq!(light.at(DVec3::new(0.0, 0.0, 3.0)), None);
    }

    #[test]
    fn directional_lights_are_the_same_everywhere_and_unit() {
        let light = Light::directional(DVec3::new(0.0, 5.0, 0.0), DVec3::ONE).unwrap();
        for point in [DVec3::ZERO, DVec3::splat(1e6)] {
            let arriving = light.at(point).unwrap();
            assert_eq!((arriving.to_light, arriving.colour), (DVec3::Y, DVec3::ONE));
            assert_eq!(arriving.distance, f64::INFINITY);
        }
        assert!(light.casts_shadow() && !light.without_shadow().casts_shadow());
    }

    #[test]
    fn the_default_key_comes_from_the_upper_left_behind_the_viewer() {
        let bounds = Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap();
        for up in [Up::Y, Up::Z] {
            let camera = Camera::fitted(&bounds, up, 1.0);
            let lighting = Lighting::for_camera(&camera);
            let key = lighting.lights[0];
            let LightSource::Directional { to_light } = key.source() else { panic!("the key is far away") };
            assert!(key.casts_shadow() && to_light.is_normalized());
            assert!(to_light.dot(camera.right()) < -0.2);
            assert!(to_light.dot(camera.up()) > 0.2);
            assert!(to_light.dot(camera.forward()) < -0.2);
            assert!(!lighting.lights[1].casts_shadow());
        }
    }
}
