//! The paper around a slice: axes with numbers, a title, and the scale of colours.

use super::paint::Scale;
use super::palette::{Colour, INK, PAPER, diverging, mix};
use super::window::Window;
use super::{Raster, Slice, SliceStyle, nice};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Pictures smaller than this have no axes.
const SMALLEST: (u32, u32) = (240, 200);

/// The height of letters, in pixels.
const LETTERS: RasterHeight = RasterHeight::Size16;
const LINE_HEIGHT: usize = 16;

/// About how far apart numbers at the axes are, in pixels.
const TICK_DISTANCE: f64 = 80.0;

/// The length of ticks, and what is left free between things, in pixels.
const TICK: usize = 5;
const GAP: usize = 5;

/// The width of the scale of colours, and of the numbers beside it.
const BAR: usize = 16;
const BAR_NUMBERS: usize = 8;

fn letter_width() -> usize {
    get_raster_width(FontWeight::Regular, LETTERS)
}

fn text_width(text: &str) -> usize {
    text.chars().count() * letter_width()
}

/// A picture that is drawn on.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Canvas {
    /// Paper.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        let paper = bytes(PAPER);
        let pixels = paper.into_iter().cycle().take(3 * width * height).collect();
        Self { width, height, pixels }
    }

    pub(super) fn set(&mut self, x: usize, y: usize, colour: Colour) {
        if x < self.width && y < self.height {
            let at = 3 * (y * self.width + x);
            self.pixels[at..at + 3].copy_from_slice(&bytes(colour));
        }
    }

    pub(super) fn into_pixels(self) -> Vec<u8> {
        self.pixels
    }

    fn fill(&mut self, [left, right]: [usize; 2], [top, bottom]: [usize; 2], colour: Colour) {
        for y in top..bottom {
            (left..right).for_each(|x| self.set(x, y, colour));
        }
    }

    /// Letters on paper, from their upper left corner.
    fn write(&mut self, text: &str, left: usize, top: usize) {
        for (place, letter) in text.chars().enumerate() {
            let Some(shape) = get_raster(letter, FontWeight::Regular, LETTERS) else { continue };
            for (y, row) in shape.rows().enumerate() {
                for (x, cover) in row.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                    let colour = mix(PAPER, INK, f32::from(*cover) / 255.0);
                    self.set(left + place * letter_width() + x, top + y, colour);
                }
            }
        }
    }
}

fn bytes(colour: Colour) -> [u8; 3] {
    colour.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Where the plot lies in the picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Layout {
    pub(super) left: usize,
    pub(super) top: usize,
    width: usize,
    height: usize,
    has_axes: bool,
}

impl Layout {
    pub(super) fn new(slice: &Slice) -> Self {
        let (width, height) = (slice.size.0 as usize, slice.size.1 as usize);
        if slice.size.0 < SMALLEST.0 || slice.size.1 < SMALLEST.1 {
            return Self { left: 0, top: 0, width, height, has_axes: false };
        }
        let (top, below) = (LINE_HEIGHT + 2 * GAP, TICK + LINE_HEIGHT + 2 * GAP);
        let right = match slice.style {
            SliceStyle::Heat => 3 * GAP + BAR + BAR_NUMBERS * letter_width(),
            _ => 3 * GAP,
        };
        let plot_height = height - top - below;
        // How much is shown upwards depends on the width in turn: two rounds are enough for the numbers' width.
        let mut left = 4 * letter_width();
        for _ in 0..2 {
            let raster = Raster::new(slice.window, (width.saturating_sub(left + right).max(1), plot_height));
            let numbers = ticks(&raster.window, 1, plot_height);
            let widest = numbers.iter().map(|(_, text)| text_width(text)).max().unwrap_or(0);
            left = (widest.max(letter_width()) + TICK + 2 * GAP).min(width / 3);
        }
        Self { left, top, width: width - left - right, height: plot_height, has_axes: true }
    }

    /// The width and the height of the plot, in pixels.
    pub(super) fn plot_size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Draws what is around the plot.
    pub(super) fn draw(&self, canvas: &mut Canvas, slice: &Slice, window: &Window, scale: Scale) {
        if !self.has_axes {
            return;
        }
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        for x in [self.left - 1, right] {
            canvas.fill([x, x + 1], [self.top - 1, bottom + 1], INK);
        }
        for y in [self.top - 1, bottom] {
            canvas.fill([self.left - 1, right + 1], [y, y + 1], INK);
        }
        canvas.write(&slice.title, self.left, GAP);
        self.draw_across(canvas, window, slice.axes[0]);
        self.draw_upwards(canvas, window, slice.axes[1]);
        if let Scale::Heat(end) = scale {
            self.draw_bar(canvas, end, slice.positive_inside);
        }
    }

    fn draw_across(&self, canvas: &mut Canvas, window: &Window, axis: u16) {
        let bottom = self.top + self.height;
        let name = axis_name(axis);
        let name_left = self.left + self.width - text_width(name);
        canvas.write(name, name_left, bottom + TICK + GAP);
        for (place, text) in ticks(window, 0, self.width) {
            let x = self.left + (place as usize).min(self.width - 1);
            canvas.fill([x, x + 1], [bottom, bottom + TICK], INK);
            let left = (x + 1).saturating_sub(text_width(&text) / 2);
            if left + text_width(&text) + GAP < name_left {
                canvas.write(&text, left, bottom + TICK + GAP);
            }
        }
    }

    fn draw_upwards(&self, canvas: &mut Canvas, window: &Window, axis: u16) {
        let name = axis_name(axis);
        canvas.write(name, self.left.saturating_sub(TICK + GAP + text_width(name)), self.top);
        for (place, text) in ticks(window, 1, self.height) {
            let y = self.top + (self.height - 1).saturating_sub(place as usize);
            canvas.fill([self.left - TICK, self.left], [y, y + 1], INK);
            if y > self.top + 3 * LINE_HEIGHT / 2 {
                let left = self.left.saturating_sub(TICK + GAP + text_width(&text));
                canvas.write(&text, left, y - LINE_HEIGHT / 2);
            }
        }
    }

    /// The scale of colours, with the largest value on top.
    fn draw_bar(&self, canvas: &mut Canvas, end: f64, positive_inside: bool) {
        let left = self.left + self.width + 2 * GAP;
        let sign = if positive_inside { -1.0 } else { 1.0 };
        for y in 0..self.height {
            let value = 1.0 - 2.0 * (y as f64 + 0.5) / self.height as f64;
            let colour = diverging((sign * value) as f32);
            canvas.fill([left, left + BAR], [self.top + y, self.top + y + 1], colour);
        }
        let step = nice::above(end * 2.0 * TICK_DISTANCE / self.height as f64 * 0.6);
        for value in nice::multiples(-end, end, step) {
            let part = 0.5 - 0.5 * value / end;
            let y = self.top + ((part * self.height as f64) as usize).min(self.height - 1);
            canvas.fill([left, left + BAR], [y, y + 1], INK);
            let lowest = self.top + self.height - LINE_HEIGHT;
            let top = y.saturating_sub(LINE_HEIGHT / 2).clamp(self.top, lowest);
            canvas.write(&nice::label(value, step), left + BAR + GAP, top);
        }
    }
}

fn axis_name(axis: u16) -> &'static str {
    ["x", "y", "z"].get(usize::from(axis)).copied().unwrap_or("")
}

/// The numbers along an axis of a window, with their distances from its lower end in pixels.
fn ticks(window: &Window, axis: usize, length: usize) -> Vec<(f64, String)> {
    let (low, high) = (window.min[axis], window.max[axis]);
    let step = nice::above((high - low) * TICK_DISTANCE / length as f64 * 0.75);
    let place = |value: f64| (value - low) / (high - low) * length as f64;
    nice::multiples(low, high, step).into_iter().map(|v| (place(v), nice::label(v, step))).collect()
}
