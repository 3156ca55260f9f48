//! Colours, and what is seen where nothing is hit.

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
    fn the_background_runs_from_top_to_bottom() {
        let sky = Background { top: DVec3::X, bottom: DVec3::Y };
        assert_eq!(sky.at(0.0), DVec3::X);
        assert_eq!(sky.at(1.0), DVec3::Y);
        assert_eq!(sky.at(0.5), DVec3::new(0.5, 0.5, 0.0));
        assert_eq!(Background::plain(DVec3::Z).at(0.3), DVec3::Z);
    }
}
