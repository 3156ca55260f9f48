//! What a renderer delivers: colours and named layers.

use crate::colour::{Background, Rgb, linear_to_srgb};
use crate::tone::Tone;
use glam::DVec3;

/// The names of the layers of a [`Film`], in its order, as they stand in EXR files.
pub const CHANNELS: [&str; 11] =
    ["R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "part", "certificate", "cost"];

const WIDTH: usize = CHANNELS.len();

/// One pixel of a [`Film`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pixel {
    /// Linear RGB of what covers the pixel, multiplied by how much of it is covered.
    pub colour: [f32; 3],
    /// How much of the pixel is covered, from 0 to 1.
    pub alpha: f32,
    /// The distance from the eye (orthographic: from its plane) along the ray through the centre; +∞ on a miss.
    pub depth: f32,
    /// The outward unit normal where that ray hits; 0 on a miss.
    pub normal: [f32; 3],
    /// The part that it hits, counted from 0; −1 on a miss.
    pub part: f32,
    /// What that rests on, hit or miss: 1 certified, 2 tolerance, 3 undecided.
    pub certificate: f32,
    /// How many evaluations of the field that ray took.
    pub cost: f32,
}

impl Pixel {
    /// A certified miss that cost nothing.
    pub const MISS: Self = Self {
        colour: [0.0; 3],
        alpha: 0.0,
        depth: f32::INFINITY,
        normal: [0.0; 3],
        part: -1.0,
        certificate: 1.0,
        cost: 0.0,
    };

    fn channels(&self) -> [f32; WIDTH] {
        let ([r, g, b], [x, y, z]) = (self.colour, self.normal);
        [r, g, b, self.alpha, self.depth, x, y, z, self.part, self.certificate, self.cost]
    }

    fn from_channels(channels: [f32; WIDTH]) -> Self {
        let [r, g, b, alpha, depth, x, y, z, part, certificate, cost] = channels;
        Self { colour: [r, g, b], alpha, depth, normal: [x, y, z], part, certificate, cost }
    }
}

/// An image in linear light with layers: one plane of 32-bit numbers for each of the [`CHANNELS`].
#[derive(Clone, PartialEq, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    planes: [Vec<f32>; WIDTH],
}

impl Film {
    /// A film on which nothing is seen: [`Pixel::MISS`] everywhere.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, planes: Pixel::MISS.channels().map(|value| vec![value; pixels]) }
    }

    /// The number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The layers with their names; rows from top to bottom.
    pub fn layers(&self) -> impl Iterator<Item = (&'static str, &[f32])> {
        CHANNELS.into_iter().zip(self.planes.iter().map(Vec::as_slice))
    }

    /// The layer of that name, one of the [`CHANNELS`].
    pub fn layer(&self, name: &str) -> Option<&[f32]> {
        self.layers().find(|(known, _)| *known == name).map(|(_, plane)| plane)
    }

    fn index(&self, x: u32, y: u32) -> Option<usize> {
        (x < self.width && y < self.height).then(|| y as usize * self.width as usize + x as usize)
    }

    /// The pixel in column `x` of row `y`, if there is one.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Pixel> {
        let at = self.index(x, y)?;
        Some(Pixel::from_channels(std::array::from_fn(|i| self.planes[i][at])))
    }

    /// Sets the pixel in column `x` of row `y`; nothing happens outside of the film.
    pub fn set(&mut self, x: u32, y: u32, pixel: &Pixel) {
        if let Some(at) = self.index(x, y) {
            for (plane, value) in self.planes.iter_mut().zip(pixel.channels()) {
                plane[at] = value;
            }
        }
    }

    /// The picture in front of a background, as 8-bit sRGB: R, G, B, pixel by pixel, row by row.
    pub fn composite_over(&self, background: &Background) -> Vec<u8> {
        self.develop(background, &Tone::default())
    }

    /// The same with an exposure and a tone curve, which the background goes through too.
    pub fn develop(&self, background: &Background, tone: &Tone) -> Vec<u8> {
        let [red, green, blue, alpha, ..] = &self.planes;
        let columns = (self.width as usize).max(1);
        let encode = |linear: f64| (linear_to_srgb(linear) * 255.0).round() as u8;
        (0..alpha.len())
            .flat_map(|i| {
                let v = ((i / columns) as f64 + 0.5) / f64::from(self.height);
                let before: Rgb = DVec3::new(red[i].into(), green[i].into(), blue[i].into());
                let seen = before + background.at(v) * (1.0 - f64::from(alpha[i]));
                tone.apply(seen).to_array().map(encode)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some_pixel() -> Pixel {
        Pixel {
            colour: [0.1, 0.2, 0.3],
            alpha: 0.5,
            depth: 7.0,
            normal: [0.0, 0.6, 0.8],
            part: 2.0,
            certificate: 3.0,
            cost: 11.0,
        }
    }

    #[test]
    fn a_new_film_is_all_miss() {
        let film = Film::new(3, 2);
        assert_eq!(film.pixel(2, 1), Some(Pixel::MISS));
        assert_eq!(film.pixel(3, 0), None);
        assert_eq!(film.pixel(0, 2), None);
        assert!(film.layers().all(|(_, plane)| plane.len() == 6));
    }

    #[test]
    fn pixels_come_back_and_lie_in_the_layers_they_name() {
        let mut film = Film::new(3, 2);
        film.set(1, 1, &some_pixel());
        film.set(9, 9, &some_pixel());
        assert_eq!(film.pixel(1, 1), Some(some_pixel()));
        assert_eq!(film.pixel(0, 1), Some(Pixel::MISS));
        let at = |name: &str| film.layer(name).unwrap()[4];
        assert_eq!([at("R"), at("G"), at("B"), at("A")], [0.1, 0.2, 0.3, 0.5]);
        assert_eq!([at("Z"), at("N.X"), at("N.Y"), at("N.Z")], [7.0, 0.0, 0.6, 0.8]);
        assert_eq!([at("part"), at("certificate"), at("cost")], [2.0, 3.0, 11.0]);
        assert_eq!(film.layer("S"), None);
    }

    #[test]
    fn the_background_shows_where_nothing_covers_it() {
        let mut film = Film::new(1, 3);
        let covered = |colour, alpha| Pixel { colour, alpha, ..Pixel::MISS };
        film.set(0, 1, &covered([1.0, 0.0, 0.214_041_14], 1.0));
        film.set(0, 2, &covered([0.0, 0.0, 2.0], 0.5));
        let bytes = film.composite_over(&Background::plain(DVec3::new(0.0, 1.0, 1.0)));
        assert_eq!(bytes[..3], [0, 255, 255]);
        assert_eq!(bytes[3..6], [255, 0, 128]);
        // Half of the linear intensity 1 is 188 in sRGB; what is brighter than white is white.
        assert_eq!(bytes[6..], [0, 188, 255]);
    }

    #[test]
    fn the_gradient_runs_down_the_rows() {
        let sky = Background { top: DVec3::ZERO, bottom: DVec3::ONE };
        let bytes = Film::new(2, 64).composite_over(&sky);
        assert_eq!(bytes.len(), 2 * 64 * 3);
        assert!(bytes[0] < bytes[32 * 6] && bytes[32 * 6] < bytes[63 * 6]);
    }
}
