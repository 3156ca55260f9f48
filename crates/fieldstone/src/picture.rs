//! Pictures from files: environments, and what hangs on walls.

use crate::load::open_regular;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read};
use fieldstone_scene::{Image, ImageError, MAX_IMAGE_PIXELS, srgb_to_linear};
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

/// How EXR files begin.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What a decoder may take in memory, in bytes.
const MOST_MEMORY: u64 = 1 << 29;

/// Why a picture could not be read.
#[derive(Debug, thiserror::Error)]
pub enum PictureFileError {
    /// The file cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// The file is no PNG, HDR or EXR picture, or a broken one.
    #[error("{} is not a picture that can be read (PNG, HDR and EXR are): {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The picture is empty or too large.
    #[error("{}: {reason}", path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// What is wrong with its size.
        reason: ImageError,
    },
}

/// Reads a picture: PNG (8 or 16 bits, taken as sRGB), Radiance HDR, or the first layer of an EXR with R, G and B (both in
/// linear light). What kind it is, its first bytes say. Transparency is left out.
///
/// # Errors
/// A file that cannot be read, that is no such picture, or that has more than [`MAX_IMAGE_PIXELS`] pixels; that is found
/// out before they are read.
pub fn read_picture(path: &Path) -> Result<Image, PictureFileError> {
    let failed = |reason| PictureFileError::File { path: path.to_owned(), reason };
    let content = |reason: String| PictureFileError::Content { path: path.to_owned(), reason };
    let mut file = BufReader::new(open_regular(path).map_err(failed)?);
    let mut start = [0; 4];
    let is_exr = file.read_exact(&mut start).is_ok() && start == EXR;
    file.rewind().map_err(failed)?;
    let found = if is_exr { read_exr(path, file) } else { read_other(file) };
    found.map_err(|fault| match fault {
        Fault::Content(reason) => content(reason),
        Fault::Size(reason) => PictureFileError::Size { path: path.to_owned(), reason },
    })
}

enum Fault {
    Content(String),
    Size(ImageError),
}

impl From<image::ImageError> for Fault {
    fn from(error: image::ImageError) -> Self {
        Self::Content(error.to_string())
    }
}

impl From<exr::error::Error> for Fault {
    fn from(error: exr::error::Error) -> Self {
        Self::Content(error.to_string())
    }
}

/// That there are not too many pixels.
fn check_size(width: u64, height: u64) -> Result<(u32, u32), Fault> {
    let short = |length: u64| u32::try_from(length).unwrap_or(u32::MAX);
    let (width, height) = (short(width), short(height));
    let sound = (1..=MAX_IMAGE_PIXELS).contains(&(u64::from(width) * u64::from(height)));
    if sound { Ok((width, height)) } else { Err(Fault::Size(ImageError::Size(width, height))) }
}

fn read_exr(path: &Path, file: BufReader<File>) -> Result<Image, Fault> {
    let headers = MetaData::read_from_buffered(file, false)?.headers;
    for header in &headers {
        check_size(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
    }
    type Pixels = (usize, Vec<[f32; 3]>);
    let layers = read().no_deep_data().largest_resolution_level();
    let rgb = layers.rgb_channels(
        |size, _| -> Pixels { (size.width(), vec![[0.0; 3]; size.area()]) },
        |(width, pixels), place, (r, g, b): (f32, f32, f32)| {
            if let Some(pixel) = pixels.get_mut(place.y() * *width + place.x()) {
                *pixel = [r, g, b];
            }
        },
    );
    let image = rgb.first_valid_layer().all_attributes().from_file(path)?;
    let size = image.layer_data.size;
    let (width, height) = check_size(size.width() as u64, size.height() as u64)?;
    Image::new(width, height, image.layer_data.channel_data.pixels.1).map_err(Fault::Size)
}

fn read_other(file: BufReader<File>) -> Result<Image, Fault> {
    let mut reader =
        ImageReader::new(file).with_guessed_format().map_err(|e| Fault::Content(e.to_string()))?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Hdr)) {
        return Err(Fault::Content("its first bytes are those of none of them".to_owned()));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = image::ImageDecoder::dimensions(&decoder);
    check_size(width.into(), height.into())?;
    let pixels = match DynamicImage::from_decoder(decoder)? {
        DynamicImage::ImageRgb32F(pixels) => pixels.pixels().map(|pixel| pixel.0).collect(),
        eight if eight.color().bytes_per_pixel() == eight.color().channel_count() => {
            let linear: Vec<f32> = (0..=255).map(|v| srgb_to_linear(f64::from(v) / 255.0) as f32).collect();
            eight.to_rgb8().pixels().map(|pixel| pixel.0.map(|v| linear[usize::from(v)])).collect()
        }
        sixteen => {
            let linear = |v: u16| srgb_to_linear(f64::from(v) / f64::from(u16::MAX)) as f32;
            sixteen.to_rgb16().pixels().map(|pixel| pixel.0.map(linear)).collect()
        }
    };
    Image::new(width, height, pixels).map_err(Fault::Size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write_rgb;
    use exr::prelude::write_rgb_file;
    use fieldstone_scene::Wrap;
    use glam::DVec3;

    fn pixel(image: &Image, x: u32, y: u32) -> DVec3 {
        let place = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
        image.at(place(x, image.width()), place(y, image.height()), Wrap::Clamp)
    }

    #[test]
    fn png_is_srgb_with_8_or_16_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_rgb((2, 1), &[255, 0, 0, 0, 128, 255], &path).unwrap();
        let image = read_picture(&path).unwrap();
        assert_eq!(pixel(&image, 0, 0), DVec3::X);
        let expected = DVec3::new(0.0, srgb_to_linear(128.0 / 255.0), 1.0);
        assert!((pixel(&image, 1, 0) - expected).length() < 1e-6);
        let sixteen = image::ImageBuffer::from_raw(1, 1, vec![65535u16, 32768, 0]).unwrap();
        DynamicImage::ImageRgb16(sixteen).save_with_format(&path, ImageFormat::Png).unwrap();
        let expected = DVec3::new(1.0, srgb_to_linear(32768.0 / 65535.0), 0.0);
        assert!((pixel(&read_picture(&path).unwrap(), 0, 0) - expected).length() < 1e-6);
    }

    #[test]
    fn hdr_and_exr_are_linear_whatever_they_are_called() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("light");
        write_rgb_file(&path, 2, 2, |x, y| (x as f32 * 100.0, y as f32, 0.25f32)).unwrap();
        let image = read_picture(&path).unwrap();
        assert_eq!((image.width(), image.height()), (2, 2));
        assert_eq!(pixel(&image, 1, 0), DVec3::new(100.0, 0.0, 0.25));
        assert_eq!(pixel(&image, 0, 1), DVec3::new(0.0, 1.0, 0.25));
        let colours = vec![image::Rgb([64.0f32, 1.0, 0.5]); 16];
        let encoder = image::codecs::hdr::HdrEncoder::new(File::create(&path).unwrap());
        encoder.encode(&colours, 8, 2).unwrap();
        let image = read_picture(&path).unwrap();
        assert!((pixel(&image, 7, 1) - DVec3::new(64.0, 1.0, 0.5)).length() < 0.51);
    }

    #[test]
    fn what_is_no_picture_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(matches!(read_picture(&path), Err(PictureFileError::File { .. })));
        assert!(read_picture(folder.path()).is_err());
        for bytes in [&b""[..], b"a text", &EXR, b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"#?RADIANCE\nx"] {
            std::fs::write(&path, bytes).unwrap();
            let error = read_picture(&path).map(|_| ()).unwrap_err();
            assert!(matches!(error, PictureFileError::Content { .. }), "{error}");
        }
    }

    #[test]
    fn huge_pictures_are_refused_before_they_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n").unwrap();
        let error = read_picture(&path).map(|_| ()).unwrap_err();
        assert!(matches!(error, PictureFileError::Size { .. }), "{error}");
    }
}
