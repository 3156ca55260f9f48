//! `.texel` files.
//!
//! Little-endian, in this order:
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `FSTEXEL` and a zero |
//! | 4 | version: 1 |
//! | 1 | n, where 2ⁿ is the edge |
//! | 1 | axes along which the volume is cyclic: 1 for x, 2 for y, 4 for z |
//! | 1 | filter: 0 sggx, 1 1995 |
//! | 1 | 0 |
//! | 3 × 4 | Phong's diffuse, specular, exponent (f32) |
//! | (n + 1) × 4 | stored cells of each level, the finest first |
//! | | of each level, the whole cube first: 16 bytes a cell; then, above the finest level, which parts are stored, 1 byte a cell |
//! | 4 | CRC-32 of everything before |
//!
//! Cells of a level stand in Morton order. A file is read as a whole; its size is checked against its header
//! before memory is taken. It is not mapped into memory: a file that another process changes or cuts short while it is mapped is
//! undefined behaviour, which only `unsafe` code may risk, and a checksum reads every byte in any case.

use crate::pack::Packed;
use crate::volume::Level;
use crate::{MAX_EDGE, Mode, Phong, Volume};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

const MAGIC: &[u8; 8] = b"FSTEXEL\0";
const VERSION: u32 = 1;
const CHUNK: usize = 1 << 16;

/// Why a `.texel` file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system says so.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It begins with other bytes.
    #[error("not a .texel file: it does not begin with FSTEXEL")]
    Foreign,
    /// It is of another time.
    #[error("version {found} of .texel files cannot be read, only {VERSION}")]
    Version {
        /// The version of the file.
        found: u32,
    },
    /// The header says what cannot be.
    #[error("the header is damaged: {what}")]
    Header {
        /// What is wrong.
        what: String,
    },
    /// It is longer or shorter than its header says.
    #[error("the file is damaged: it has {found} bytes, and by its header should have {expected}")]
    Length {
        /// Bytes by the header.
        expected: u64,
        /// Bytes there are.
        found: u64,
    },
    /// Bytes changed.
    #[error("the file is damaged: its checksum is {found:08x}, and should be {expected:08x}")]
    Checksum {
        /// The sum that the file names.
        expected: u32,
        /// The sum of the bytes.
        found: u32,
    },
    /// Levels that do not fit together.
    #[error(
        "the file is damaged: level {level} has {found} cells, and by the level above should have {expected}"
    )]
    Levels {
        /// The level, 0 is the finest.
        level: u32,
        /// Cells by the level above.
        expected: u64,
        /// Cells by the header.
        found: u64,
    },
}

/// What stands before the levels.
struct Header {
    cyclic: [bool; 3],
    mode: Mode,
    phong: Phong,
    counts: Vec<u32>,
}

impl Header {
    /// The length of a file with this header.
    fn file_bytes(&self) -> u64 {
        let cells: u64 = self.counts.iter().map(|count| u64::from(*count)).sum();
        let parts = cells - u64::from(self.counts[0]);
        let header = 8 + 4 + 4 + 12 + 4 * self.counts.len() as u64;
        header + 16 * cells + parts + 4
    }

    fn read(source: &mut impl Read) -> Result<Self, FileError> {
        if read_array::<8>(source).map_err(|_| FileError::Foreign)? != *MAGIC {
            return Err(FileError::Foreign);
        }
        let found = u32::from_le_bytes(read_array(source)?);
        if found != VERSION {
            return Err(FileError::Version { found });
        }
        let [top, axes, mode, reserved] = read_array(source)?;
        let broken = |what: String| Err(FileError::Header { what });
        if u32::from(top) > MAX_EDGE.trailing_zeros() {
            return broken(format!("an edge of 2 to the {top} cells"));
        }
        let mode = match mode {
            0 => Mode::Sggx,
            1 => Mode::Neyret1995,
            _ => return broken(format!("filter {mode}")),
        };
        if axes > 7 || reserved != 0 {
            return broken(format!("axes {axes}, reserved byte {reserved}"));
        }
        let mut number = || Ok::<_, FileError>(f32::from_le_bytes(read_array(source)?));
        let phong = Phong { diffuse: number()?, specular: number()?, exponent: number()? };
        if ![phong.diffuse, phong.specular, phong.exponent].iter().all(|value| value.is_finite()) {
            return broken("coefficients of reflection that are no numbers".to_owned());
        }
        let counts: Result<Vec<u32>, FileError> =
            (0..=top).map(|_| Ok(u32::from_le_bytes(read_array(source)?))).collect();
        let cyclic = [axes & 1 != 0, axes & 2 != 0, axes & 4 != 0];
        Ok(Self { cyclic, mode, phong, counts: counts? })
    }
}

impl Volume {
    /// Reads a `.texel` file.
    ///
    /// # Errors
    /// [`FileError`] if the file cannot be read, is of another kind or version, or is damaged in whatever way.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Self::read_from(BufReader::new(file), length)
    }

    /// Reads a volume from its bytes; see [`Volume::read`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        Self::read_from(bytes, bytes.len() as u64)
    }

    fn read_from(source: impl Read, length: u64) -> Result<Self, FileError> {
        let mut source = Summed { inner: source, sum: crc32fast::Hasher::new() };
        let header = Header::read(&mut source)?;
        let expected = header.file_bytes();
        if expected != length {
            return Err(FileError::Length { expected, found: length });
        }
        let mut levels: Vec<Level> = Vec::with_capacity(header.counts.len());
        for (level, count) in header.counts.iter().enumerate().rev() {
            let expected = match levels.last() {
                Some(above) => above.parts.iter().map(|parts| u64::from(parts.count_ones())).sum(),
                None => u64::from(*count).min(1),
            };
            let found = u64::from(*count);
            if found != expected {
                return Err(FileError::Levels { level: level as u32, expected, found });
            }
            levels.push(read_level(&mut source, *count as usize, level > 0)?);
        }
        let found = source.sum.clone().finalize();
        let expected = u32::from_le_bytes(read_array(&mut source)?);
        if found != expected {
            return Err(FileError::Checksum { expected, found });
        }
        levels.reverse();
        Ok(Self { levels, cyclic: header.cyclic, mode: header.mode, phong: header.phong })
    }

    /// The length of the volume's file, in bytes.
    pub fn file_bytes(&self) -> u64 {
        self.header().file_bytes()
    }

    /// Writes a `.texel` file; on an error what is there under that name may be cut short.
    ///
    /// # Errors
    /// [`FileError::Io`] if the system refuses.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        let mut file = BufWriter::new(File::create(path)?);
        self.write_to(&mut file)?;
        Ok(file.flush()?)
    }

    /// Writes the bytes of a `.texel` file.
    ///
    /// # Errors
    /// What `target` says.
    pub fn write_to(&self, target: impl Write) -> io::Result<()> {
        let mut target = Summed { inner: target, sum: crc32fast::Hasher::new() };
        let header = self.header();
        target.write_all(MAGIC)?;
        target.write_all(&VERSION.to_le_bytes())?;
        let axes = (0..3).fold(0, |bits, axis| bits | u8::from(self.cyclic[axis]) << axis);
        target.write_all(&[
            (self.levels.len() - 1) as u8,
            axes,
            u8::from(self.mode == Mode::Neyret1995),
            0,
        ])?;
        for value in [self.phong.diffuse, self.phong.specular, self.phong.exponent] {
            target.write_all(&value.to_le_bytes())?;
        }
        for count in &header.counts {
            target.write_all(&count.to_le_bytes())?;
        }
        for (level, content) in self.levels.iter().enumerate().rev() {
            for texel in &content.texels {
                target.write_all(&texel.0[0].to_le_bytes())?;
                target.write_all(&texel.0[1].to_le_bytes())?;
            }
            if level > 0 {
                target.write_all(&content.parts)?;
            }
        }
        let sum = target.sum.clone().finalize();
        target.write_all(&sum.to_le_bytes())
    }

    fn header(&self) -> Header {
        let counts = self.levels.iter().map(|level| level.texels.len() as u32).collect();
        Header { cyclic: self.cyclic, mode: self.mode, phong: self.phong, counts }
    }
}

fn read_level(source: &mut impl Read, count: usize, has_parts: bool) -> io::Result<Level> {
    let mut texels = Vec::with_capacity(count);
    let mut bytes = vec![0; 16 * count.min(CHUNK)];
    while texels.len() < count {
        let chunk = &mut bytes[..16 * (count - texels.len()).min(CHUNK)];
        source.read_exact(chunk)?;
        let (words, _) = chunk.as_chunks::<8>();
        texels.extend(
            words
                .chunks_exact(2)
                .map(|pair| Packed([u64::from_le_bytes(pair[0]), u64::from_le_bytes(pair[1])])),
        );
    }
    let mut parts = vec![0; if has_parts { count } else { 0 }];
    source.read_exact(&mut parts)?;
    let mut level = Level { texels, parts, first: Vec::new() };
    level.index();
    Ok(level)
}

fn read_array<const N: usize>(source: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// A stream and the sum of what went through it.
struct Summed<T> {
    inner: T,
    sum: crc32fast::Hasher,
}

impl<T: Read> Read for Summed<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }
}

impl<T: Write> Write for Summed<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
