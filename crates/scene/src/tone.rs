//! From light to what a screen shows: exposure and tone curves. Only pictures for the screen go through them; files in
//! linear light do not.

use crate::colour::Rgb;
use crate::text::Number;
use glam::{DMat3, DVec3};

/// How bright light becomes colours from 0 to 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ToneCurve {
    /// What is brighter than 1 is cut off, each component for itself.
    #[default]
    Clip,
    /// The PBR Neutral tone mapper of the Khronos Group (2024): colours up to about 0.76 stay as they are but for a small
    /// offset, brighter ones are compressed and lose their saturation.
    KhronosNeutral,
    /// The fit of Stephen Hill (2017) to the reference and output transforms of ACES 1.0: a film-like curve that darkens
    /// shadows and makes bright colours pale.
    Aces,
}

/// What is done to light before it is shown.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Tone {
    exposure: f64,
    curve: ToneCurve,
}

/// An exposure that is not a number from −64 to 64.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[error("an exposure is a number of stops from -64 to 64, not {}", Number(*.0))]
pub struct ExposureError(f64);

impl Tone {
    /// Light multiplied by 2^`stops`, then put through a curve.
    ///
    /// # Errors
    /// Stops that are not from −64 to 64.
    pub fn new(stops: f64, curve: ToneCurve) -> Result<Self, ExposureError> {
        let sound = (-64.0..=64.0).contains(&stops);
        if sound { Ok(Self { exposure: stops, curve }) } else { Err(ExposureError(stops)) }
    }

    /// The exposure in stops: light is multiplied by 2 to this power.
    pub fn exposure(&self) -> f64 {
        self.exposure
    }

    /// The curve.
    pub fn curve(&self) -> ToneCurve {
        self.curve
    }

    /// The colour that is shown of light, from 0 to 1, still linear.
    pub fn apply(&self, light: Rgb) -> Rgb {
        let exposed = light * self.exposure.exp2();
        let shown = match self.curve {
            ToneCurve::Clip => exposed,
            ToneCurve::KhronosNeutral => khronos_neutral(exposed),
            ToneCurve::Aces => aces(exposed),
        };
        shown.clamp(DVec3::ZERO, DVec3::ONE)
    }
}

/// Khronos PBR Neutral Tone Mapper, specification 1.0 (2024), for not negative components.
fn khronos_neutral(light: Rgb) -> Rgb {
    /// The reflectance of dielectrics at normal incidence, which the curve takes off.
    const F90: f64 = 0.04;
    const START_COMPRESSION: f64 = 0.8 - F90;
    const DESATURATION: f64 = 0.15;
    let least = light.min_element();
    let offset = if least < 0.08 { least - 6.25 * least * least } else { F90 };
    let colour = light - DVec3::splat(offset);
    let peak = colour.max_element();
    if peak < START_COMPRESSION {
        return colour;
    }
    let room = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - room * room / (peak + room - START_COMPRESSION);
    let grey = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (colour * (new_peak / peak)).lerp(DVec3::splat(new_peak), grey)
}

/// S. Hill's fit: into a space between the primaries of ACES, a rational curve, and back.
fn aces(light: Rgb) -> Rgb {
    let input = DMat3::from_cols(
        DVec3::new(0.597_19, 0.076_00, 0.028_40),
        DVec3::new(0.354_58, 0.908_34, 0.133_83),
        DVec3::new(0.048_23, 0.015_66, 0.837_77),
    );
    let output = DMat3::from_cols(
        DVec3::new(1.604_75, -0.102_08, -0.003_27),
        DVec3::new(-0.531_08, 1.108_13, -0.072_76),
        DVec3::new(-0.073_67, -0.006_05, 1.076_02),
    );
    // Beyond this the curve is flat; its squares would overflow much later.
    let c = (input * light).min(DVec3::splat(1e9));
    let curve = (c * (c + 0.024_578_6) - 0.000_090_537) / (c * (0.983_729 * c + 0.432_951) + 0.238_081);
    output * curve
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [ToneCurve; 3] = [ToneCurve::Clip, ToneCurve::KhronosNeutral, ToneCurve::Aces];

    fn shown(stops: f64, curve: ToneCurve, light: f64) -> DVec3 {
        Tone::new(stops, curve).unwrap().apply(DVec3::splat(light))
    }

    #[test]
    fn exposures_are_stops() {
        assert_eq!(shown(-2.0, ToneCurve::Clip, 2.0), DVec3::splat(0.5));
        assert_eq!(shown(3.0, ToneCurve::Clip, 0.0625), DVec3::splat(0.5));
        assert_eq!(Tone::default().apply(DVec3::new(0.3, 7.0, 0.1)), DVec3::new(0.3, 1.0, 0.1));
        for stops in [65.0, f64::NAN, f64::NEG_INFINITY] {
            assert!(Tone::new(stops, ToneCurve::Clip).is_err());
        }
    }

    #[test]
    fn curves_rise_and_stay_between_black_and_white() {
        for curve in CURVES {
            let mut last = -1.0;
            for i in 0..400 {
                let colour = shown(0.0, curve, 1e-4 * 1.06f64.powi(i));
                assert!(colour.min_element() >= 0.0 && colour.max_element() <= 1.0);
                assert!(colour.y >= last - 1e-12, "{curve:?} falls at {i}");
                last = colour.y;
            }
            assert!(last > 0.99, "{curve:?} ends at {last}");
        }
    }

    #[test]
    fn neutral_keeps_colours_of_diffuse_surfaces() {
        // Above 0.08 the offset is 0.04, and below the compression that is all.
        let tone = Tone::new(0.0, ToneCurve::KhronosNeutral).unwrap();
        let seen = tone.apply(DVec3::new(0.5, 0.3, 0.1));
        assert!((seen - DVec3::new(0.46, 0.26, 0.06)).length() < 1e-12);
        // 0.5 of grey is 0.46; the peak of very bright light is 1, and grey.
        let bright = tone.apply(DVec3::new(1e4, 10.0, 10.0));
        assert!(bright.min_element() > 0.95, "{bright}");
    }

    #[test]
    fn aces_has_the_middle_grey_of_its_fit() {
        // The rows of the matrices sum to 1: greys stay grey, and the value is that of the rational curve.
        let curve = |c: f64| (c * (c + 0.0245786) - 0.000090537) / (c * (0.983729 * c + 0.432951) + 0.238081);
        for light in [0.05, 0.18, 1.0, 5.0] {
            assert!((shown(0.0, ToneCurve::Aces, light) - DVec3::splat(curve(light))).length() < 1e-4);
        }
    }
}
