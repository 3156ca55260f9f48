//! A field on a plane: where it is inside, its boundary, and its values.
//!
//! First intervals decide what they can ([`certify`]): tiles of 64 × 64 pixels, then blocks of 8 × 8, then single
//! pixels are *inside* or *outside* as a whole, proved for every point of them. What is left *may hold the boundary*, and
//! a line is drawn nowhere else; where the field may be undefined, only if its sign changes there. There, and wherever values are shown, the field is evaluated with its exact gradient at
//! the centres of pixels ([`sample`]): |f|/|∇f| is the distance from the boundary in pixels to first order, from which
//! lines get their smooth edges ([`paint`]). [`frame`] draws the axes around it.

mod certify;
mod frame;
mod nice;
mod paint;
mod palette;
mod sample;
mod window;

#[cfg(test)]
mod tests;

use fieldstone_field::{Bindings, Field, Input, Tape, TapeOptions};
use rayon::prelude::*;

pub use window::{FoundWindow, Window, WindowExtent, find_window};

/// The most pixels that a slice may have: 2²⁴, about 500 MB while it is drawn.
pub const MAX_SLICE_PIXELS: u64 = 1 << 24;

/// The side of the tiles that are worked on at a time, in pixels.
const TILE: usize = 64;

/// How a slice is drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SliceStyle {
    /// The inside and the outside in two tints, and the boundary.
    Plain,
    /// The same with lines of equal values.
    #[default]
    Contours,
    /// The values as colours, with their scale, and the boundary.
    Heat,
}

/// What to draw of a field on a plane.
#[derive(Clone, Debug)]
pub struct Slice {
    /// The field.
    pub field: Field,
    /// The values of all inputs but the two axes: parameters, time, and the coordinates that fix the plane.
    pub bindings: Bindings,
    /// The coordinates along the picture, counted from 0: to the right, and upwards.
    pub axes: [u16; 2],
    /// What must be seen; where the picture is longer, more is.
    pub window: Window,
    /// The size of the picture in pixels, axes included.
    pub size: (u32, u32),
    /// How it is drawn.
    pub style: SliceStyle,
    /// What stands above the picture: `z = 0.3`.
    pub title: String,
    /// Whether numbers at the scale have the other sign: HyperFun's F = −f.
    pub positive_inside: bool,
}

/// Why there is no picture.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum SliceError {
    /// No pixel, or more than [`MAX_SLICE_PIXELS`].
    #[error("a slice of {0}x{1} pixels is not between 1 and {MAX_SLICE_PIXELS} pixels")]
    Size(u32, u32),
    /// The window has no area, is not finite, or is too small for its place to be told apart by numbers.
    #[error("a slice from {min:?} to {max:?} shows nothing: the ends must be finite, ordered and apart")]
    Window {
        /// The lower left corner.
        min: [f64; 2],
        /// The upper right corner.
        max: [f64; 2],
    },
    /// The threads could not be started.
    #[error("could not start {0} threads")]
    Threads(usize),
}

/// What the pixels of a slice rest on; the axes do not count.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SliceStats {
    /// All pixels.
    pub pixels: u64,
    /// Proved to be inside as a whole.
    pub inside: u64,
    /// Proved to be outside as a whole.
    pub outside: u64,
    /// Neither: the boundary may pass through them.
    pub boundary: u64,
    /// Neither, and the field is undefined at their centres.
    pub undefined: u64,
    /// How often the field was evaluated, at points and over boxes.
    pub evaluations: u64,
}

/// A drawn slice.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SlicePicture {
    /// The width in pixels.
    pub width: u32,
    /// The height in pixels.
    pub height: u32,
    /// Red, green and blue of every pixel in sRGB, row by row from the top.
    pub pixels: Vec<u8>,
    /// What it rests on.
    pub stats: SliceStats,
}

/// What is known about a pixel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Verdict {
    /// All of it is inside.
    Inside,
    /// All of it is outside.
    Outside,
    /// The field may be 0 in it.
    Open,
    /// The field may be undefined in it; nothing is known.
    Unknown,
}

impl Verdict {
    fn is_proof(self) -> bool {
        matches!(self, Verdict::Inside | Verdict::Outside)
    }
}

/// Draws a slice on so many threads; `None`: one for each core. The picture does not depend on their number.
///
/// # Errors
/// An impossible size or window; threads that could not be started.
pub fn draw_slice(slice: &Slice, threads: Option<usize>) -> Result<SlicePicture, SliceError> {
    let threads = threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|_| SliceError::Threads(threads))?.install(|| draw(slice))
}

fn draw(slice: &Slice) -> Result<SlicePicture, SliceError> {
    let (width, height) = slice.size;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MAX_SLICE_PIXELS {
        return Err(SliceError::Size(width, height));
    }
    slice.window.check()?;
    let layout = frame::Layout::new(slice);
    let raster = Raster::new(slice.window, layout.plot_size());
    raster.window.check()?;
    let options = TapeOptions {
        varying: slice.axes.map(Input::Coordinate).to_vec(),
        bindings: slice.bindings.clone(),
        ..TapeOptions::default()
    };
    let tape = Tape::new(&slice.field, &options);
    let (verdicts, boxes) = certify::certify(&tape, &raster);
    let close = spread(&raster, |at| !verdicts[at].is_proof());
    let wanted = |at: usize| slice.style != SliceStyle::Plain || close[at];
    let (samples, points) = sample::sample(&tape, &raster, wanted);
    // Where nothing is known, a change of the sign is what a line needs: slopes mislead close to poles and edges.
    let near = spread(&raster, |at| match verdicts[at] {
        Verdict::Open => true,
        Verdict::Unknown => sample::sign_changes(&raster, &samples, at),
        Verdict::Inside | Verdict::Outside => false,
    });
    let plot = paint::Plot { raster, verdicts: &verdicts, near: &near, samples: &samples };
    let scale = paint::Scale::new(slice.style, &samples);
    let mut canvas = frame::Canvas::new(width, height);
    paint::paint(&plot, scale, |x, y, colour| canvas.set(layout.left + x, layout.top + y, colour));
    layout.draw(&mut canvas, slice, &plot.raster.window, scale);
    let stats = SliceStats { evaluations: boxes + points, ..stats(&plot) };
    Ok(SlicePicture { width, height, pixels: canvas.into_pixels(), stats })
}

fn stats(plot: &paint::Plot<'_>) -> SliceStats {
    let count = |verdict| plot.verdicts.iter().filter(|v| **v == verdict).count() as u64;
    let is_undefined = |at: usize| !plot.verdicts[at].is_proof() && plot.samples[at].value.is_nan();
    let undefined = (0..plot.verdicts.len()).filter(|&at| is_undefined(at)).count() as u64;
    SliceStats {
        pixels: plot.verdicts.len() as u64,
        inside: count(Verdict::Inside),
        outside: count(Verdict::Outside),
        boundary: count(Verdict::Open) + count(Verdict::Unknown) - undefined,
        undefined,
        evaluations: 0,
    }
}

/// Pixels that are seeds or close to one: the line of a boundary in a pixel reaches so far.
fn spread(raster: &Raster, is_seed: impl Fn(usize) -> bool + Sync) -> Vec<bool> {
    const REACH: usize = 2;
    let (width, height) = (raster.width, raster.height);
    let around = |at: usize, length: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(length);
    let across: Vec<bool> = (0..width * height)
        .into_par_iter()
        .map(|at| around(at % width, width).any(|x| is_seed(at - at % width + x)))
        .collect();
    let upwards = |at: usize| around(at / width, height).any(|y| across[y * width + at % width]);
    (0..width * height).into_par_iter().map(upwards).collect()
}

/// Pixels and their places on the plane.
#[derive(Clone, Copy, Debug)]
struct Raster {
    width: usize,
    height: usize,
    /// What exactly these pixels show.
    window: Window,
}

impl Raster {
    /// The pixels are squares: of the longer side of the picture, more is shown than is asked for.
    fn new(wanted: Window, (width, height): (usize, usize)) -> Self {
        let pixel = (wanted.width() / width as f64).max(wanted.height() / height as f64);
        let half = [0.5 * pixel * width as f64, 0.5 * pixel * height as f64];
        let centre = [0, 1].map(|k| 0.5 * wanted.min[k] + 0.5 * wanted.max[k]);
        let window = Window {
            min: [centre[0] - half[0], centre[1] - half[1]],
            max: [centre[0] + half[0], centre[1] + half[1]],
        };
        Self { width, height, window }
    }

    /// The side of a pixel.
    fn pixel(&self) -> f64 {
        self.window.width() / self.width as f64
    }

    /// The horizontal coordinate at `x` pixels from the left edge.
    fn across(&self, x: f64) -> f64 {
        self.window.min[0] + self.window.width() * (x / self.width as f64)
    }

    /// The vertical coordinate at `y` pixels from the upper edge.
    fn upwards(&self, y: f64) -> f64 {
        self.window.max[1] - self.window.height() * (y / self.height as f64)
    }

    /// The tiles, as ranges of pixels.
    fn tiles(&self) -> Vec<Block> {
        Block { x: [0, self.width], y: [0, self.height] }.divided(TILE)
    }
}

/// A rectangle of pixels: from the first to before the second.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Block {
    x: [usize; 2],
    y: [usize; 2],
}

impl Block {
    /// Its parts of this side, row by row; those at the end may be shorter.
    fn divided(self, side: usize) -> Vec<Self> {
        let cuts = move |[from, to]: [usize; 2]| {
            (from..to).step_by(side).map(move |start| [start, (start + side).min(to)])
        };
        cuts(self.y).flat_map(|y| cuts(self.x).map(move |x| Self { x, y })).collect()
    }

    /// Its pixels, row by row.
    fn pixels(self) -> impl Iterator<Item = (usize, usize)> {
        (self.y[0]..self.y[1]).flat_map(move |y| (self.x[0]..self.x[1]).map(move |x| (x, y)))
    }

    fn len(self) -> usize {
        (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])
    }
}
