//! Pictures that light is looked up in.

use crate::colour::Rgb;
use glam::DVec3;
use std::fmt;

/// The most pixels of an [`Image`]: 2²⁵, 8192 × 4096, which take 400 MB.
pub const MAX_IMAGE_PIXELS: u64 = 1 << 25;

/// A picture in linear RGB, 32 bits a component; rows from top to bottom. Every component is finite and not negative.
#[derive(Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

/// Why numbers make no [`Image`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum ImageError {
    /// No pixel, or more than [`MAX_IMAGE_PIXELS`].
    #[error("a picture of {0}x{1} pixels is empty, or has more than {MAX_IMAGE_PIXELS} of them")]
    Size(u32, u32),
    /// Not as many pixels as the size says.
    #[error("a picture of {width}x{height} has not {found} pixels")]
    Count {
        /// The number of columns.
        width: u32,
        /// The number of rows.
        height: u32,
        /// How many pixels there are.
        found: usize,
    },
}

/// What lies beyond the left and the right edge of a picture; beyond the others, the outermost row goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wrap {
    /// The picture again, as all around a horizon.
    Repeat,
    /// The outermost column.
    Clamp,
}

impl Image {
    /// A picture of these pixels. Components that are negative or not a number become 0, infinite ones the largest
    /// number.
    ///
    /// # Errors
    /// No pixel, too many, or not as many as the size says.
    pub fn new(width: u32, height: u32, mut pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        let count = u64::from(width) * u64::from(height);
        if !(1..=MAX_IMAGE_PIXELS).contains(&count) {
            return Err(ImageError::Size(width, height));
        }
        if pixels.len() as u64 != count {
            return Err(ImageError::Count { width, height, found: pixels.len() });
        }
        // Comparisons with NaN are false.
        pixels.iter_mut().flatten().for_each(|v| *v = if *v > 0.0 { v.min(f32::MAX) } else { 0.0 });
        Ok(Self { width, height, pixels })
    }

    /// The number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The colour at (u, v), bilinear between the centres of pixels; (0, 0) is the upper left corner of the picture and
    /// (1, 1) the lower right one. Black where u or v is not a number.
    pub fn at(&self, u: f64, v: f64, wrap: Wrap) -> Rgb {
        if !(u.is_finite() && v.is_finite()) {
            return DVec3::ZERO;
        }
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let (x, y) = (u * width - 0.5, v * height - 0.5);
        let (right, below) = (x - x.floor(), y - y.floor());
        let column = |i: f64| match wrap {
            Wrap::Repeat => i.rem_euclid(width),
            Wrap::Clamp => i.clamp(0.0, width - 1.0),
        };
        let row = |j: f64| j.clamp(0.0, height - 1.0);
        let pixel = |i: f64, j: f64| self.pixel(column(i), row(j));
        let upper = pixel(x.floor(), y.floor()).lerp(pixel(x.floor() + 1.0, y.floor()), right);
        let lower = pixel(x.floor(), y.floor() + 1.0).lerp(pixel(x.floor() + 1.0, y.floor() + 1.0), right);
        upper.lerp(lower, below)
    }

    fn pixel(&self, column: f64, row: f64) -> Rgb {
        let at = row as usize * self.width as usize + column as usize;
        self.pixels.get(at).map_or(DVec3::ZERO, |rgb| DVec3::from_array(rgb.map(f64::from)))
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({}x{})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Image {
        Image::new(2, 1, vec![[1.0, 0.0, 0.0], [0.0, 0.0, 3.0]]).unwrap()
    }

    #[test]
    fn sizes_are_checked_and_numbers_cut() {
        assert_eq!(Image::new(0, 1, Vec::new()), Err(ImageError::Size(0, 1)));
        assert_eq!(Image::new(1 << 20, 1 << 20, Vec::new()), Err(ImageError::Size(1 << 20, 1 << 20)));
        assert!(matches!(Image::new(2, 2, vec![[0.0; 3]]), Err(ImageError::Count { found: 1, .. })));
        let odd = Image::new(1, 1, vec![[f32::NAN, -1.0, f32::INFINITY]]).unwrap();
        assert_eq!(odd.at(0.5, 0.5, Wrap::Clamp), DVec3::new(0.0, 0.0, f64::from(f32::MAX)));
    }

    #[test]
    fn pixels_have_their_colour_in_their_centre_and_blend_between() {
        let image = two();
        assert_eq!(image.at(0.25, 0.5, Wrap::Clamp), DVec3::X);
        assert_eq!(image.at(0.75, 0.1, Wrap::Clamp), 3.0 * DVec3::Z);
        assert_eq!(image.at(0.5, 0.9, Wrap::Clamp), DVec3::new(0.5, 0.0, 1.5));
        assert_eq!(image.at(f64::NAN, 0.5, Wrap::Clamp), DVec3::ZERO);
    }

    #[test]
    fn edges_repeat_or_go_on() {
        let image = two();
        assert_eq!(image.at(0.0, 0.5, Wrap::Clamp), DVec3::X);
        assert_eq!(image.at(0.0, 0.5, Wrap::Repeat), DVec3::new(0.5, 0.0, 1.5));
        assert_eq!(image.at(-7.75, 0.5, Wrap::Repeat), DVec3::X);
        assert_eq!(image.at(1e300, 0.5, Wrap::Clamp), 3.0 * DVec3::Z);
    }
}
