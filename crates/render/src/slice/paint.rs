//! From what is known about pixels to their colours.

use super::nice;
use super::palette::{
    CONTOUR_INSIDE, CONTOUR_OUTSIDE, Colour, HATCH, INSIDE, LINE, OUTSIDE, UNDEFINED, diverging, mix,
};
use super::sample::Sample;
use super::{Raster, SliceStyle, Verdict};

/// Half the width of the boundary's line, in pixels.
const HALF_LINE: f32 = 0.8;

/// About how many steps the values of a slice are divided into.
const CONTOURS: f64 = 14.0;

/// Lines of equal values closer than this, in pixels, fade away.
const CLOSEST: f32 = 3.0;

/// All that is known about the pixels of a slice, row by row.
pub(super) struct Plot<'a> {
    pub(super) raster: Raster,
    pub(super) verdicts: &'a [Verdict],
    /// Where the line of the boundary may be.
    pub(super) near: &'a [bool],
    pub(super) samples: &'a [Sample],
}

/// How values are shown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Scale {
    /// Not at all.
    None,
    /// By lines this far apart.
    Contours(f64),
    /// By colours, from minus this to this.
    Heat(f64),
}

impl Scale {
    /// What suits most of the values; extremes are cut off.
    pub(super) fn new(style: SliceStyle, samples: &[Sample]) -> Self {
        const MOST_SAMPLES: usize = 100_000;
        let every = samples.len() / MOST_SAMPLES + 1;
        let mut values: Vec<f64> =
            samples.iter().step_by(every).map(|s| f64::from(s.value)).filter(|v| v.is_finite()).collect();
        if style == SliceStyle::Heat {
            values.iter_mut().for_each(|v| *v = v.abs());
        }
        values.sort_by(f64::total_cmp);
        let quantile = |part: f64| values.get((part * values.len() as f64) as usize).copied().unwrap_or(0.0);
        let usable = |size: f64| if size > 1e-30 && size < 1e30 { size } else { 1.0 };
        match style {
            SliceStyle::Plain => Self::None,
            SliceStyle::Contours => {
                Self::Contours(nice::above(usable(quantile(0.92) - quantile(0.08)) / CONTOURS))
            }
            SliceStyle::Heat => Self::Heat(nice::above(usable(quantile(0.8)))),
        }
    }
}

/// Calls `set` with the place and the colour of every pixel.
pub(super) fn paint(plot: &Plot<'_>, scale: Scale, mut set: impl FnMut(usize, usize, Colour)) {
    for y in 0..plot.raster.height {
        for x in 0..plot.raster.width {
            set(x, y, colour(plot, scale, x, y));
        }
    }
}

fn colour(plot: &Plot<'_>, scale: Scale, x: usize, y: usize) -> Colour {
    let at = y * plot.raster.width + x;
    let (verdict, sample) = (plot.verdicts[at], plot.samples[at]);
    if !verdict.is_proof() && sample.value.is_nan() {
        return if (x + y) % 8 < 2 { HATCH } else { UNDEFINED };
    }
    let inside = match verdict {
        Verdict::Inside => 1.0,
        Verdict::Outside => 0.0,
        Verdict::Open => (0.5 - sample.distance).clamp(0.0, 1.0),
        // The slope may be that of an edge or a pole.
        Verdict::Unknown => f32::from(u8::from(sample.value < 0.0)),
    };
    let tint = match scale {
        Scale::Heat(end) => diverging((sample.value / end as f32).clamp(-1.0, 1.0)),
        _ => mix(OUTSIDE, INSIDE, inside),
    };
    let tint = match scale {
        Scale::Contours(step) => {
            let line = if inside > 0.5 { CONTOUR_INSIDE } else { CONTOUR_OUTSIDE };
            mix(tint, line, contour(sample, step as f32))
        }
        _ => tint,
    };
    if !plot.near[at] {
        return tint;
    }
    let line = (HALF_LINE + 0.5 - sample.distance.abs()).clamp(0.0, 1.0);
    // Where the field jumps over 0, its slope knows nothing of the boundary.
    let line = if line < 0.5 && jumps(plot, x, y) { 1.0 } else { line };
    mix(tint, LINE, line)
}

/// How much of a pixel a line of equal values covers; every fifth line is stronger.
fn contour(sample: Sample, step: f32) -> f32 {
    let number = (sample.value / step).round();
    let apart = step / sample.slope;
    if number == 0.0 || !number.is_finite() || !apart.is_finite() {
        return 0.0;
    }
    let distance = (sample.value - number * step).abs() / sample.slope;
    let strength = if number % 5.0 == 0.0 { 0.75 } else { 0.4 };
    strength * (1.0 - distance).clamp(0.0, 1.0) * ((apart - CLOSEST) / CLOSEST).clamp(0.0, 1.0)
}

/// Whether the field is inside on one side of a pixel's right or lower edge and outside on the other, with no zero in
/// sight of either.
fn jumps(plot: &Plot<'_>, x: usize, y: usize) -> bool {
    let here = plot.samples[y * plot.raster.width + x];
    let other = |x: usize, y: usize| {
        let inside = x < plot.raster.width && y < plot.raster.height;
        inside.then(|| plot.samples[y * plot.raster.width + x]).filter(|s| !s.value.is_nan())
    };
    [other(x + 1, y), other(x, y + 1)].into_iter().flatten().any(|there| {
        let crosses = (here.value < 0.0) != (there.value < 0.0);
        crosses && here.distance.abs().min(there.distance.abs()) > 2.0
    })
}
