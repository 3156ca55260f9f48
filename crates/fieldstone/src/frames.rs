//! The pictures of a film: which there are, at which times, and how their files are called.

use std::path::{Path, PathBuf};

/// A film has at most so many pictures.
pub const MAX_FRAMES: u32 = 1_000_000;

/// Pictures with numbers, some for each second.
#[derive(Clone, PartialEq, Debug)]
pub struct Frames {
    first: u32,
    last: u32,
    per_second: f64,
    /// What stands before and behind the number, and how many digits it has.
    name: (PathBuf, String, usize, String),
}

/// Why there are no [`Frames`].
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum FramesError {
    /// The last one is before the first, or there are too many.
    #[error("frames run from the first to the last, such as 0..47, at most {MAX_FRAMES}; not {0}..{1}")]
    Range(u32, u32),
    /// Not a positive number of pictures a second.
    #[error("the number of frames a second is positive and finite, not {0}")]
    Rate(f64),
    /// The name has no place for the number, or several.
    #[error("{}: the name needs one group of # for the number, such as out_####.png", .0.display())]
    Name(PathBuf),
}

impl Frames {
    /// The pictures from `first` to `last`; picture n shows the time n / `per_second` in seconds. The `#` in the name of
    /// `pattern` stand for the number, with zeros before it.
    ///
    /// # Errors
    /// A range that is empty or too long, a rate that is not positive, a name without one group of `#`.
    pub fn new((first, last): (u32, u32), per_second: f64, pattern: &Path) -> Result<Self, FramesError> {
        if last < first || last - first >= MAX_FRAMES {
            return Err(FramesError::Range(first, last));
        }
        if !(per_second > 0.0 && per_second.is_finite()) {
            return Err(FramesError::Rate(per_second));
        }
        let wrong = || FramesError::Name(pattern.to_owned());
        let name = pattern.file_name().and_then(|name| name.to_str()).ok_or_else(wrong)?;
        let start = name.find('#').ok_or_else(wrong)?;
        let digits = name[start..].len() - name[start..].trim_start_matches('#').len();
        let (before, behind) = (&name[..start], &name[start + digits..]);
        if behind.contains('#') {
            return Err(wrong());
        }
        let folder = pattern.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { first, last, per_second, name: (folder, before.to_owned(), digits, behind.to_owned()) })
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.last - self.first + 1
    }

    /// The file and the time in seconds of each.
    pub fn iter(&self) -> impl Iterator<Item = (PathBuf, f64)> {
        let (folder, before, digits, behind) = &self.name;
        (self.first..=self.last).map(move |n| {
            let path = folder.join(format!("{before}{n:0digits$}{behind}", digits = *digits));
            (path, f64::from(n) / self.per_second)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_padded_and_times_counted_from_zero() {
        let frames = Frames::new((8, 11), 4.0, Path::new("a#b/out_##.png")).unwrap();
        let all: Vec<(PathBuf, f64)> = frames.iter().collect();
        assert_eq!(frames.count(), 4);
        assert_eq!(all[0], (PathBuf::from("a#b/out_08.png"), 2.0));
        assert_eq!(all[3], (PathBuf::from("a#b/out_11.png"), 2.75));
        let long = Frames::new((1000, 1000), 1.0, Path::new("#.png")).unwrap();
        assert_eq!(long.iter().next().unwrap().0, PathBuf::from("1000.png"));
    }

    #[test]
    fn what_is_no_film() {
        let new = |range, rate, name: &str| Frames::new(range, rate, Path::new(name)).map(|_| ());
        assert_eq!(new((3, 2), 1.0, "#.png"), Err(FramesError::Range(3, 2)));
        assert!(new((0, MAX_FRAMES), 1.0, "#.png").is_err());
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(new((0, 1), rate, "#.png"), Err(FramesError::Rate(_))));
        }
        for name in ["out.png", "a#b#.png", "..", ""] {
            assert!(matches!(new((0, 1), 1.0, name), Err(FramesError::Name(_))), "{name}");
        }
    }
}
