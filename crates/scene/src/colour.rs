//! Colours, and what surfaces and the sky have of them.

use glam::DVec3;

/// A colour in linear RGB with the primaries of sRGB.
pub type Rgb = DVec3;

/// The linear intensity of an sRGB component, both from 0 to 1 (IEC 61966-2-1).
pub fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB component of a linear intensity, both from 0 to 1 (IEC 61966-2-1).
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// How a surface answers to light, after Blinn (1977): diffuse·cos θ + specular·(n·h)^shininess.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Material {
    diffuse: Rgb,
    specular: f64,
    shininess: f64,
}

/// Why numbers make no [`Material`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum MaterialError {
    /// A component of the diffuse colour is outside [0, 1].
    #[error("a diffuse colour lies between 0 and 1, not at {0}")]
    Diffuse(Rgb),
    /// The strength of highlights is negative or not finite.
    #[error("the strength of highlights is a number from 0 on, not {0}")]
    Specular(f64),
    /// The sharpness of highlights is below 1 or not finite.
    #[error("the sharpness of highlights is a number from 1 on, not {0}")]
    Shininess(f64),
}

impl Material {
    /// A material: diffuse colour, strength of its white highlights, and their sharpness.
    ///
    /// # Errors
    /// Numbers outside the ranges that [`MaterialError`] names.
    pub fn new(diffuse: Rgb, specular: f64, shininess: f64) -> Result<Self, MaterialError> {
        if !(diffuse.cmpge(DVec3::ZERO).all() && diffuse.cmple(DVec3::ONE).all()) {
            return Err(MaterialError::Diffuse(diffuse));
        }
        if !(specular.is_finite() && specular >= 0.0) {
            return Err(MaterialError::Specular(specular));
        }
        if !(shininess.is_finite() && shininess >= 1.0) {
            return Err(MaterialError::Shininess(shininess));
        }
        Ok(Self { diffuse, specular, shininess })
    }

    /// The colour of light that is scattered evenly.
    pub fn diffuse(&self) -> Rgb {
        self.diffuse
    }

    /// The strength of highlights.
    pub fn specular(&self) -> f64 {
        self.specular
    }

    /// The exponent of highlights.
    pub fn shininess(&self) -> f64 {
        self.shininess
    }
}

impl Default for Material {
    /// Light, warm clay with a soft highlight.
    fn default() -> Self {
        Self { diffuse: DVec3::new(0.60, 0.42, 0.27), specular: 0.18, shininess: 40.0 }
    }
}

/// Where the diffuse colour of a solid comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ColourSource {
    /// From its material: the same all over.
    #[default]
    Material,
    /// From the first three attributes of its field: sRGB, cut to [0, 1]; the material's where they are undefined.
    Attributes,
}

/// What is seen where nothing is hit: two colours that blend from top to bottom.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Background {
    /// At the upper edge.
    pub top: Rgb,
    /// At the lower edge.
    pub bottom: Rgb,
}

impl Background {
    /// One colour.
    pub fn plain(colour: Rgb) -> Self {
        Self { top: colour, bottom: colour }
    }

    /// The colour at the height `v`, 0 on top and 1 at the bottom.
    pub fn at(&self, v: f64) -> Rgb {
        self.top.lerp(self.bottom, v)
    }
}

impl Default for Background {
    /// A pale sky above a paler horizon.
    fn default() -> Self {
        Self { top: DVec3::new(0.36, 0.46, 0.60), bottom: DVec3::new(0.86, 0.88, 0.90) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_the_values_of_the_standard_and_an_inverse() {
        assert_eq!(srgb_to_linear(0.0), 0.0);
        assert!((srgb_to_linear(1.0) - 1.0).abs() < 1e-15);
        assert!((linear_to_srgb(0.214_041_14) - 0.5).abs() < 1e-8);
        assert!((linear_to_srgb(0.001) - 0.012_92).abs() < 1e-15);
        for i in 0..=255 {
            let encoded = f64::from(i) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(encoded)) - encoded).abs() < 1e-7, "{i}");
        }
    }

    #[test]
    fn materials_are_checked() {
        assert!(Material::new(DVec3::ONE, 0.0, 1.0).is_ok());
        assert!(matches!(Material::new(DVec3::splat(1.5), 0.0, 1.0), Err(MaterialError::Diffuse(_))));
        assert!(matches!(Material::new(DVec3::NAN, 0.0, 1.0), Err(MaterialError::Diffuse(_))));
        assert_eq!(Material::new(DVec3::ONE, -0.1, 1.0), Err(MaterialError::Specular(-0.1)));
        assert_eq!(Material::new(DVec3::ONE, 0.1, 0.5), Err(MaterialError::Shininess(0.5)));
        let default = Material::default();
        assert!(Material::new(default.diffuse(), default.specular(), default.shininess()).is_ok());
    }

    #[test]
    fn the_background_runs_from_top_to_bottom() {
        let sky = Background { top: DVec3::X, bottom: DVec3::Y };
        assert_eq!(sky.at(0.0), DVec3::X);
        assert_eq!(sky.at(1.0), DVec3::Y);
        assert_eq!(sky.at(0.5), DVec3::new(0.5, 0.5, 0.0));
        assert_eq!(Background::plain(DVec3::Z).at(0.3), DVec3::Z);
    }
}
