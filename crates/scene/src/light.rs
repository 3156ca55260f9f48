//! Lights.

use crate::camera::Camera;
use crate::colour::{Background, Rgb};
use crate::environment::Environment;
use crate::text::Number;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The most places on an area light that are looked at from a point.
pub const MAX_LIGHT_SAMPLES: u32 = 1024;

/// How many places on an area light are looked at from a point, unless said otherwise.
pub(crate) const DEFAULT_SAMPLES: u32 = 4;

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
    /// From a sphere that shines evenly, with the radiance colour / radius²; it lights nothing inside of it.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// From both sides of a parallelogram that shines evenly, with the radiance π·colour / area.
    Rectangle {
        /// One of its corners.
        corner: DVec3,
        /// From there along its sides.
        edges: [DVec3; 2],
    },
}

/// A light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Light {
    source: LightSource,
    colour: Rgb,
    casts_shadow: bool,
    samples: u32,
    visible: bool,
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
    /// The radius of a sphere is not positive and finite.
    #[error("the radius of a light is a positive number, not {}", Number(*.0))]
    Radius(f64),
    /// The edges of a rectangle span no area, or too large a one.
    #[error("a light of the sides {0} and {1} has no area")]
    Edges(DVec3, DVec3),
    /// No sample, or more than [`MAX_LIGHT_SAMPLES`].
    #[error("the samples of a light are a number from 1 to {MAX_LIGHT_SAMPLES}, not {0}")]
    Samples(u32),
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
        Self::from_source(source, colour)
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
        Self::from_source(LightSource::Point { position }, colour)
    }

    /// A sphere that shines evenly, that casts soft shadows. Seen as a whole, it lights a surface that faces its centre as
    /// a point light of this colour there does, from near and from far; its radiance is colour / radius².
    ///
    /// # Errors
    /// A centre that is not finite, a radius that is not positive and finite, a colour that is negative or not finite.
    pub fn sphere(centre: DVec3, radius: f64, colour: Rgb) -> Result<Self, LightError> {
        if !centre.is_finite() {
            return Err(LightError::Position(centre));
        }
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(LightError::Radius(radius));
        }
        Self::from_source(LightSource::Sphere { centre, radius }, colour)
    }

    /// A parallelogram that shines evenly to both sides, that casts soft shadows. From far away, on its axis, it is a point
    /// light of this colour, before and behind it, and to its side weaker by the cosine; its radiance is π·colour / area.
    ///
    /// # Errors
    /// A corner that is not finite, edges that span no area, a colour that is negative or not finite.
    pub fn rectangle(corner: DVec3, edges: [DVec3; 2], colour: Rgb) -> Result<Self, LightError> {
        if !corner.is_finite() {
            return Err(LightError::Position(corner));
        }
        let area = edges[0].cross(edges[1]).length();
        if !(area > 0.0 && area.is_finite()) {
            return Err(LightError::Edges(edges[0], edges[1]));
        }
        Self::from_source(LightSource::Rectangle { corner, edges }, colour)
    }

    fn from_source(source: LightSource, colour: Rgb) -> Result<Self, LightError> {
        let colour = checked_colour(colour)?;
        Ok(Self { source, colour, casts_shadow: true, samples: DEFAULT_SAMPLES, visible: false })
    }

    /// The same light, which nothing blocks.
    pub fn without_shadow(self) -> Self {
        Self { casts_shadow: false, ..self }
    }

    /// With so many places on an area light looked at from each point; others have one. The default is 4.
    ///
    /// # Errors
    /// No sample, or more than [`MAX_LIGHT_SAMPLES`].
    pub fn with_samples(self, samples: u32) -> Result<Self, LightError> {
        let sound = (1..=MAX_LIGHT_SAMPLES).contains(&samples);
        if sound { Ok(Self { samples, ..self }) } else { Err(LightError::Samples(samples)) }
    }

    /// Whether rays from the eye, those that are mirrored, and those that are refracted see an area light as a shining
    /// body. Lamps are not seen unless this says so.
    pub fn with_visible(self, visible: bool) -> Self {
        Self { visible, ..self }
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

    /// Whether light comes from more than one direction at a point.
    pub fn is_area(&self) -> bool {
        matches!(self.source, LightSource::Sphere { .. } | LightSource::Rectangle { .. })
    }

    /// How many places on it are looked at from a point: 1 unless it is an area light.
    pub fn samples(&self) -> u32 {
        if self.is_area() { self.samples } else { 1 }
    }

    /// Whether rays may see it; see [`with_visible`](Self::with_visible).
    pub fn is_visible(&self) -> bool {
        self.visible && self.is_area()
    }

    /// What arrives at a point from one place on the light if nothing blocks it. `u` and `v`, both from 0 to 1, choose the
    /// place of area lights; the mean over both is all that arrives, each from its own direction. Nothing at the very
    /// place of a point light, inside of a sphere, and in the plane of a rectangle.
    pub fn sample(&self, point: DVec3, (u, v): (f64, f64)) -> Option<Illumination> {
        match self.source {
            LightSource::Directional { .. } | LightSource::Point { .. } => self.at(point),
            LightSource::Sphere { centre, radius } => self.on_sphere(point, (centre, radius), (u, v)),
            LightSource::Rectangle { corner, edges } => {
                let place = corner + u * edges[0] + v * edges[1];
                let (to_light, distance) = ((place - point).try_normalize()?, point.distance(place));
                let cosine = to_light.dot(edges[0].cross(edges[1]).normalize()).abs();
                let colour = self.colour * (cosine / (distance * distance));
                (cosine > 0.0).then_some(Illumination { to_light, distance, colour })
            }
        }
    }

    /// From a place on a sphere, even in solid angle (Shirley, Wang and Zimmerman 1996, §3.1).
    fn on_sphere(
        &self,
        point: DVec3,
        (centre, radius): (DVec3, f64),
        (u, v): (f64, f64),
    ) -> Option<Illumination> {
        let (axis, apart) = ((centre - point).try_normalize()?, point.distance(centre));
        let sine_squared = (radius / apart) * (radius / apart);
        if sine_squared >= 1.0 {
            return None;
        }
        // 1 − cos of the half angle, without the cancellation of small lights.
        let opening = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
        let cosine = 1.0 - u * opening;
        let sine = (u * opening * (2.0 - u * opening)).sqrt();
        let (across, along) = axis.any_orthonormal_pair();
        let (b, a) = (TAU * v).sin_cos();
        let to_light = (sine * (a * across + b * along) + cosine * axis).normalize();
        // At the rim, rounding may put the ray beside the sphere: then the nearest place to its centre stands for it.
        let half = (radius * radius - (apart * sine) * (apart * sine)).max(0.0).sqrt();
        // Solid angle times radiance, over π: the colour of a white surface that faces it.
        let colour = self.colour * (TAU * opening / (PI * radius * radius));
        Some(Illumination { to_light, distance: apart * cosine - half, colour })
    }

    /// The first place where a ray meets an area light from outside, and the light that it sends back along
    /// the ray: distance and radiance.
    pub fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, Rgb)> {
        let (t, per_radiance) = match self.source {
            LightSource::Directional { .. } | LightSource::Point { .. } => return None,
            LightSource::Sphere { centre, radius } => {
                let to_centre = centre - origin;
                let nearest = to_centre.dot(direction);
                let apart = to_centre - nearest * direction;
                let half = (radius * radius - apart.length_squared()).sqrt();
                (nearest - half, radius * radius)
            }
            LightSource::Rectangle { corner, edges: [a, b] } => {
                let normal = a.cross(b);
                let facing = -normal.dot(direction);
                let t = (origin - corner).dot(normal) / facing;
                let place = origin + t * direction - corner;
                let area_squared = normal.length_squared();
                let (u, v) =
                    (place.cross(b).dot(normal) / area_squared, a.cross(place).dot(normal) / area_squared);
                let inside = facing != 0.0 && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                (if inside { t } else { f64::NAN }, area_squared.sqrt() / PI)
            }
        };
        (t > 0.0 && t.is_finite()).then(|| (t, self.colour / per_radiance))
    }

    /// What arrives at a point if nothing blocks it; of an area light, what a point light in its middle sends. Nothing at
    /// the very place of a light.
    pub fn at(&self, point: DVec3) -> Option<Illumination> {
        match self.source {
            LightSource::Directional { to_light } => {
                Some(Illumination { to_light, distance: f64::INFINITY, colour: self.colour })
            }
            LightSource::Point { position } => self.towards(point, position),
            LightSource::Sphere { centre, .. } => self.towards(point, centre),
            LightSource::Rectangle { corner, edges } => {
                self.towards(point, corner + 0.5 * (edges[0] + edges[1]))
            }
        }
    }

    fn towards(&self, point: DVec3, position: DVec3) -> Option<Illumination> {
        let distance = point.distance(position);
        let to_light = (position - point).try_normalize()?;
        Some(Illumination { to_light, distance, colour: self.colour / (distance * distance) })
    }
}

/// All light of a scene.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Lighting {
    /// The lights.
    pub lights: Vec<Light>,
    /// The light that comes evenly from everywhere: the colour of a white, matt surface that no light reaches.
    pub ambient: Rgb,
    /// What is seen where nothing is hit. Without an environment, mirrored and refracted rays that hit nothing see it by
    /// their elevation above the camera's horizon: the upper colour straight up, the lower straight down.
    pub background: Background,
    /// The light that comes from where nothing is hit, in addition to the lights.
    pub environment: Option<Environment>,
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
            samples: DEFAULT_SAMPLES,
            visible: false,
        };
        let key = light(-0.55 * right + 0.85 * up + 0.75 * back, DVec3::new(1.02, 0.98, 0.90), true);
        let fill = light(0.80 * right + 0.10 * up + 0.60 * back, DVec3::new(0.17, 0.20, 0.25), false);
        Self {
            lights: vec![key, fill],
            ambient: DVec3::new(0.10, 0.11, 0.13),
            background: Background::default(),
            environment: None,
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

    /// The mean over both numbers of what arrives at a surface that faces `normal`.
    fn arriving(light: &Light, point: DVec3, normal: DVec3) -> DVec3 {
        const SIDE: u32 = 200;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        let samples =
            (0..SIDE * SIDE).filter_map(|i| light.sample(point, (place(i % SIDE), place(i / SIDE))));
        let sum: DVec3 = samples.map(|l| l.colour * l.to_light.dot(normal).max(0.0)).sum();
        sum / f64::from(SIDE * SIDE)
    }

    #[test]
    fn spheres_light_like_point_lights_in_their_centre() {
        let light = Light::sphere(DVec3::new(0.0, 0.0, 3.0), 2.5, DVec3::splat(9.0)).unwrap();
        assert!((arriving(&light, DVec3::ZERO, DVec3::Z) - DVec3::ONE).length() < 1e-4);
        assert!(
            (arriving(&light, DVec3::new(0.0, 0.0, -297.0), DVec3::Z) - DVec3::splat(1e-4)).length() < 1e-8
        );
        assert_eq!(light.sample(DVec3::new(0.0, 0.0, 1.0), (0.5, 0.5)), None);
        for (u, v) in [(0.0, 0.0), (0.3, 0.9), (0.999_999, 0.2)] {
            let seen = light.sample(DVec3::X, (u, v)).unwrap();
            let place = DVec3::X + seen.distance * seen.to_light - DVec3::new(0.0, 0.0, 3.0);
            assert!((place.length() - 2.5).abs() < 1e-6 && seen.to_light.is_normalized());
        }
    }

    /// A square straight above: its form factor in closed form, for the colour of a white surface below its centre.
    #[test]
    fn rectangles_light_by_their_form_factor() {
        let edges = [DVec3::new(0.0, 2.0, 0.0), DVec3::new(2.0, 0.0, 0.0)];
        let light = Light::rectangle(DVec3::new(-1.0, -1.0, 1.0), edges, DVec3::splat(4.0)).unwrap();
        // Four squares with a corner above the place; the radiance is π.
        let form_factor = 4.0 / PI / 2f64.sqrt() * (1.0 / 2f64.sqrt()).atan();
        let expected = PI * form_factor;
        assert!((arriving(&light, DVec3::ZERO, DVec3::Z).x - expected).abs() < 1e-4);
        // The other side is as bright; seen edge on, it is nothing.
        let behind = arriving(&light, DVec3::new(0.0, 0.0, 2.0), -DVec3::Z);
        assert!((behind.x - expected).abs() < 1e-4);
        assert_eq!(light.sample(DVec3::new(3.0, 0.0, 1.0), (0.5, 0.5)), None);
    }

    #[test]
    fn area_lights_are_hit_where_they_shine() {
        let sphere = Light::sphere(DVec3::ZERO, 0.5, DVec3::ONE).unwrap();
        assert_eq!(sphere.hit(DVec3::X * 3.0, -DVec3::X), Some((2.5, DVec3::splat(4.0))));
        assert_eq!(sphere.hit(DVec3::X * 3.0, DVec3::X), None);
        assert_eq!(sphere.hit(DVec3::new(3.0, 0.6, 0.0), -DVec3::X), None);
        let sheet = Light::rectangle(DVec3::ZERO, [DVec3::X, 2.0 * DVec3::Y], DVec3::ONE).unwrap();
        assert_eq!(sheet.hit(DVec3::new(0.5, 1.9, 1.0), -DVec3::Z), Some((1.0, DVec3::splat(PI / 2.0))));
        assert_eq!(sheet.hit(DVec3::new(0.5, 2.1, 1.0), -DVec3::Z), None);
        assert_eq!(sheet.hit(DVec3::new(0.5, 1.9, -1.0), DVec3::Z), Some((1.0, DVec3::splat(PI / 2.0))));
        assert_eq!(sheet.hit(DVec3::new(0.5, 1.9, -1.0), DVec3::X), None);
        assert!(!sheet.is_visible() && sheet.with_visible(true).is_visible());
        assert!(sheet.with_samples(0).is_err() && sheet.with_samples(16).unwrap().samples() == 16);
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
