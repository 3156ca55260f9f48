//! Pictures as files, written beside their place and then renamed, so that there is a whole file or none.

use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder,
    SmallVec, WritableImage,
};
use fieldstone_scene::{Background, Film, Tone};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {reason}", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// What went wrong.
    pub reason: io::Error,
}

/// Writes the picture in front of a background as an 8-bit sRGB PNG.
///
/// # Errors
/// The file cannot be written; nothing is left of it then.
pub fn write_png(film: &Film, background: &Background, path: &Path) -> Result<(), OutputError> {
    write_rgb((film.width(), film.height()), &film.composite_over(background), path)
}

/// The same, with an exposure and a tone curve.
///
/// # Errors
/// The file cannot be written; nothing is left of it then.
pub fn write_png_toned(
    film: &Film,
    background: &Background,
    tone: &Tone,
    path: &Path,
) -> Result<(), OutputError> {
    write_rgb((film.width(), film.height()), &film.develop(background, tone), path)
}

/// Writes pixels, red, green and blue in sRGB, row by row from the top, as a PNG.
///
/// # Errors
/// The file cannot be written, or there are not as many pixels as the size says; nothing is left of it then.
pub fn write_rgb((width, height): (u32, u32), pixels: &[u8], path: &Path) -> Result<(), OutputError> {
    let needed = u64::from(width) * u64::from(height) * 3;
    write_beside(path, |file| {
        if pixels.len() as u64 != needed {
            let found = pixels.len();
            return Err(io::Error::other(format!(
                "a picture of {width}x{height} has {needed} bytes, not {found}"
            )));
        }
        let encoder = PngEncoder::new(file);
        encoder.write_image(pixels, width, height, ExtendedColorType::Rgb8).map_err(io::Error::other)
    })
}

/// Writes all layers as an EXR file of one part with 32-bit floats, named as in [`CHANNELS`](crate::CHANNELS).
///
/// # Errors
/// The file cannot be written; nothing is left of it then.
pub fn write_exr(film: &Film, path: &Path) -> Result<(), OutputError> {
    let width = film.width() as usize;
    let channel = |(name, samples)| AnyChannel::new(name, Plane { samples, width });
    let channels: SmallVec<[AnyChannel<Plane<'_>>; 4]> = film.layers().map(channel).collect();
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (width, film.height() as usize);
    let layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    let image = Image::from_layer(layer);
    write_beside(path, |file| image.write().to_buffered(file).map_err(io::Error::other))
}

/// A layer of a film as a channel of a file, without a copy: large films fill the memory as it is.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Plane<'f> {
    samples: &'f [f32],
    width: usize,
}

impl WritableSamples<'_> for Plane<'_> {
    type Writer = Self;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&self, _: &Header) -> Self {
        *self
    }
}

impl SamplesWriter for Plane<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let at = line.location;
        let start = at.position.y() * self.width + at.position.x();
        // A line that is not in the picture stays 0; the encoder asks for none.
        if let Some(samples) = self.samples.get(start..start + at.sample_count) {
            let bytes = line.value.chunks_exact_mut(size_of::<f32>());
            bytes.zip(samples).for_each(|(bytes, sample)| bytes.copy_from_slice(&sample.to_ne_bytes()));
        }
    }
}

/// Writes a file through `write`, beside its place and then renamed.
///
/// # Errors
/// The file cannot be written; nothing is left of it then.
pub fn write_beside(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let failed = |reason| OutputError { path: path.to_owned(), reason };
    let beside = place_beside(path)?;
    let written = File::create(&beside)
        .and_then(|file| {
            let mut file = BufWriter::new(file);
            write(&mut file)?;
            file.flush()
        })
        .and_then(|()| fs::rename(&beside, path));
    written.map_err(|reason| {
        // It may never have come to be; the error that matters is the first.
        let _ = fs::remove_file(&beside);
        failed(reason)
    })
}

/// Finds out whether a file could be written, so that nobody works for nothing; nothing is left behind.
///
/// # Errors
/// The file cannot be written.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    let failed = |reason| OutputError { path: path.to_owned(), reason };
    if path.is_dir() {
        return Err(failed(io::Error::other("it is a folder")));
    }
    let beside = place_beside(path)?;
    File::create(&beside).and_then(|_| fs::remove_file(&beside)).map_err(failed)
}

/// The place of a file while it is being written.
fn place_beside(path: &Path) -> Result<PathBuf, OutputError> {
    let Some(name) = path.file_name() else {
        let reason = io::Error::other("that is not the name of a file");
        return Err(OutputError { path: path.to_owned(), reason });
    };
    let mut beside = name.to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    Ok(path.with_file_name(beside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
    use fieldstone_scene::{CHANNELS, Pixel};

    fn film() -> Film {
        let mut film = Film::new(3, 2);
        let pixel = Pixel { colour: [0.25, 0.5, 1.0], alpha: 1.0, depth: 4.5, part: 0.0, ..Pixel::MISS };
        film.set(2, 1, &pixel);
        film
    }

    #[test]
    fn an_exr_has_every_layer_and_every_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.exr");
        write_exr(&film(), &path).unwrap();
        let image =
            read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = image.from_file(&path).unwrap();
        let [layer] = image.layer_data.as_slice() else { panic!("one part") };
        assert_eq!((layer.size.0, layer.size.1), (3, 2));
        let mut names: Vec<String> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        let mut expected = CHANNELS.map(str::to_owned).to_vec();
        names.sort();
        expected.sort();
        assert_eq!(names, expected);
        for channel in &layer.channel_data.list {
            let FlatSamples::F32(samples) = &channel.sample_data else { panic!("32-bit floats") };
            assert_eq!(samples.as_slice(), film().layer(&channel.name.to_string()).unwrap());
        }
    }

    #[test]
    fn a_png_is_what_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.png");
        let background = Background::default();
        write_png(&film(), &background, &path).unwrap();
        let read = image::open(&path).unwrap().to_rgb8();
        assert_eq!(read.dimensions(), (3, 2));
        assert_eq!(read.into_raw(), film().composite_over(&background));
    }

    #[test]
    fn pixels_must_be_as_many_as_the_size_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(write_rgb((2, 2), &[0; 11], &path).is_err());
        assert!(!path.exists());
        write_rgb((2, 2), &[9; 12], &path).unwrap();
        assert_eq!(image::open(&path).unwrap().to_rgb8().into_raw(), [9; 12]);
    }

    #[test]
    fn a_failure_leaves_nothing_and_keeps_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.txt");
        fs::write(&path, "old").unwrap();
        let failure = write_beside(&path, |file| {
            file.write_all(b"new")?;
            Err(io::Error::other("no more"))
        });
        assert_eq!(failure.unwrap_err().reason.to_string(), "no more");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_png(&film(), &Background::default(), &folder.path().join("no/film.png")).is_err());
        write_beside(&path, |file| file.write_all(b"new")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn what_can_be_written_is_known_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.txt");
        assert!(check_writable(&path).is_ok());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        for wrong in [folder.path().join("no/new.txt"), folder.path().to_owned(), PathBuf::from("..")] {
            assert!(check_writable(&wrong).is_err(), "{}", wrong.display());
        }
    }
}
