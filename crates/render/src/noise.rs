//! When a pixel has samples enough: when what chance may still change of it cannot be seen.
//!
//! What counts is the colour that is shown, behind exposure and encoding: the eye sees noise in shadows that would be
//! nothing in the light. A pixel's error is estimated from the variance of its samples as if they were unrelated;
//! since they are evenly spread, that says rather too much. Whether to go on depends on the samples there are, so that
//! the mean is not free of bias, but what is left of it is below the error that is tolerated.

use crate::sampling::luminance;
use fieldstone_scene::{Rgb, Tone, linear_to_srgb};
use glam::DVec3;

/// The standard error of a pixel, of its largest encoded component from 0 to 1, that need not become less.
pub(crate) const VISIBLE: f64 = 1.0 / 96.0;

/// How many samples a pixel that needs more gets at least before its error is looked at.
pub(crate) const AT_FIRST: u32 = 4;

/// How much the colour that is shown of light changes if its luminance does by `error`: its largest component, after
/// exposure and encoding. The curve goes on beyond white, where files in linear light do too.
pub(crate) fn shown_error(tone: &Tone, light: Rgb, error: f64) -> f64 {
    // Noise that is coloured is mostly so as the light is.
    let bright = luminance(light);
    let hue = if bright > 0.0 { light / bright } else { DVec3::ONE };
    let exposed = tone.exposure().exp2() * hue.max_element();
    let shown = |bright: f64| linear_to_srgb((exposed * bright).max(0.0));
    0.5 * (shown(bright + error) - shown(bright - error))
}

/// The samples of a pixel so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    count: u32,
    colour: Rgb,
    alpha: f64,
    /// Sums of squares, of the luminance and of the cover.
    squares: (f64, f64),
}

impl Tally {
    /// Adds a sample.
    pub(crate) fn add(&mut self, colour: Rgb, alpha: f64) {
        self.count += 1;
        self.colour += colour;
        self.alpha += alpha;
        self.squares.0 += luminance(colour) * luminance(colour);
        self.squares.1 += alpha * alpha;
    }

    /// The means, of the colour and of the cover; there is a sample at least.
    pub(crate) fn mean(&self) -> (Rgb, f64) {
        let weight = 1.0 / f64::from(self.count.max(1));
        (self.colour * weight, self.alpha * weight)
    }

    /// The variance of a sample, of its luminance and its cover: what is behind the picture may be white.
    pub(crate) fn variance(&self) -> f64 {
        let n = f64::from(self.count);
        let (colour, alpha) = self.mean();
        let bright = luminance(colour);
        let squares = (self.squares.0 - n * bright * bright) + (self.squares.1 - n * alpha * alpha);
        squares.max(0.0) / (n - 1.0).max(1.0)
    }

    /// Whether the error of the mean can be seen, if samples have their own variance or that of samples around them.
    pub(crate) fn is_noisy(&self, tone: &Tone, around: f64) -> bool {
        let variance = self.variance().max(around);
        let error = (variance / f64::from(self.count.max(1))).sqrt();
        self.count < 2 || shown_error(tone, self.mean().0, error) > VISIBLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_that_of_what_is_shown() {
        let tone = Tone::default();
        // The slope of the curve of sRGB at 0.2 is 1.055/2.4 0.2^(1/2.4 − 1).
        let slope = 1.055 / 2.4 * 0.2f64.powf(1.0 / 2.4 - 1.0);
        assert!((shown_error(&tone, DVec3::splat(0.2), 1e-4) - 1e-4 * slope).abs() < 1e-7);
        // What is dark has more of it than what is bright, what is coloured more than what is grey.
        let of = |light| shown_error(&tone, light, 1e-3);
        assert!(of(DVec3::splat(0.01)) > 3.0 * of(DVec3::splat(0.2)) && of(DVec3::splat(3.0)) > 0.0);
        assert!(of(DVec3::new(0.2, 0.0, 0.0)) > of(DVec3::splat(0.2)));
    }

    #[test]
    fn pixels_are_noisy_until_their_mean_is_known() {
        let tone = Tone::default();
        let of = |n: u32, contrast: f64| {
            let mut tally = Tally::default();
            (0..n).for_each(|i| tally.add(DVec3::splat(0.5 + contrast * f64::from(i % 2)), 1.0));
            tally
        };
        assert!(!of(4, 0.0).is_noisy(&tone, 0.0) && of(1, 0.0).is_noisy(&tone, 0.0));
        assert!(of(4, 0.2).is_noisy(&tone, 0.0) && !of(400, 0.2).is_noisy(&tone, 0.0));
        let mut edge = of(3, 0.0);
        edge.add(DVec3::splat(0.5), 0.0);
        assert!(edge.is_noisy(&tone, 0.0) && of(4, 0.0).is_noisy(&tone, 0.01));
        assert_eq!(edge.mean(), (DVec3::splat(0.5), 0.75));
    }
}
