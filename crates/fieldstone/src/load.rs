//! Reading models from files and texts.

use fieldstone_lang::{
    Diagnostic, Diagnostics, Dialect, HyperFunOptions, Model, Source, parse_formula, parse_hyperfun,
    parse_jsurf, parse_vm,
};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A file larger than this is no model: 64 MiB.
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// A model with more operations than this would take hours to draw, and is refused: a million.
pub const MAX_OPERATIONS: usize = 1_000_000;

/// How to read a file.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadOptions {
    /// The object of a HyperFun file; `None`: `my_model`, or the first.
    pub object: Option<String>,
    /// Which meaning a HyperFun text has where mathematics and the C interpreter differ.
    pub dialect: Dialect,
}

/// A model with the text that it was read from, to which its warnings refer.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// The text.
    pub source: Source,
}

impl Loaded {
    /// The model's warnings, with their places in the text.
    pub fn rendered_warnings(&self) -> impl Iterator<Item = String> {
        self.model.warnings.iter().map(|warning| warning.render(&self.source))
    }
}

/// Why there is no model.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// There is no such file.
    #[error("there is no file {}", .0.display())]
    NotFound(PathBuf),
    /// The file cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// The file is larger than [`MAX_FILE_BYTES`].
    #[error("{} is larger than {} MiB, too large for a model", .0.display(), MAX_FILE_BYTES >> 20)]
    TooLarge(PathBuf),
    /// The file is not a text.
    #[error("{} is not a text: {found} at byte {at}", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// What no text holds.
        found: &'static str,
        /// Where that is, counted from 0.
        at: usize,
    },
    /// An object was chosen in a file of a kind that has none.
    #[error("{} has no objects: only HyperFun files do; leave `{object}` out", path.display())]
    NoObjects {
        /// The file.
        path: PathBuf,
        /// The object that was asked for.
        object: String,
    },
    /// The text is no model.
    #[error(transparent)]
    Model(#[from] Diagnostics),
}

/// Reads a model from a file: HyperFun from `.hf` and `.hpf`, programs from `.vm`, surfaces from `.jsurf`, and formulas
/// from any other.
///
/// # Errors
/// A file that cannot be read, is not a text in UTF-8 or is too large; a text that is no model.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let source = Source::new(path.display().to_string(), read_text(path)?);
    let kind = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let is_hyperfun = matches!(kind.as_deref(), Some("hf" | "hpf"));
    if let (Some(object), false) = (&options.object, is_hyperfun) {
        return Err(LoadError::NoObjects { path: path.to_owned(), object: object.clone() });
    }
    let model = match kind.as_deref() {
        _ if is_hyperfun => {
            let options = HyperFunOptions { object: options.object.clone(), dialect: options.dialect };
            parse_hyperfun(&source, &options)?
        }
        Some("vm") => parse_vm(&source)?,
        Some("jsurf") => parse_jsurf(&source)?,
        _ => parse_formula(&source)?,
    };
    Ok(of_bearable_size(Loaded { model, source })?)
}

/// Reads a formula, negative inside: `x^2 + y^2 + z^2 - 1`.
///
/// # Errors
/// Every place where the text is no formula.
pub fn formula(text: &str) -> Result<Loaded, Diagnostics> {
    let source = Source::new("formula", text);
    of_bearable_size(Loaded { model: parse_formula(&source)?, source })
}

/// The model, or what is said of one with too many operations.
fn of_bearable_size(loaded: Loaded) -> Result<Loaded, Diagnostics> {
    let count = loaded.model.field.operation_count();
    if count <= MAX_OPERATIONS {
        return Ok(loaded);
    }
    let message = format!("the model has {count} operations, and at most {MAX_OPERATIONS} are drawn");
    let error = Diagnostic::error(0..0, message, "this model");
    let help = "every ray evaluates them many times: leave parts out, or write what repeats itself as a loop of HyperFun";
    Err(Diagnostics { source: loaded.source, list: vec![error.with_help(help)] })
}

/// Opens a regular file. A pipe or a device may never end, or never begin: it is refused before it is opened.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    if std::fs::metadata(path)?.is_file() {
        return File::open(path);
    }
    Err(io::Error::other("it is a folder, a pipe or a device, not a file"))
}

pub(crate) fn read_text(path: &Path) -> Result<String, LoadError> {
    let unreadable = |reason: io::Error| match reason.kind() {
        io::ErrorKind::NotFound => LoadError::NotFound(path.to_owned()),
        _ => LoadError::Unreadable { path: path.to_owned(), reason },
    };
    let mut bytes = Vec::new();
    let file = open_regular(path).map_err(unreadable)?;
    // One byte more than allowed, and not the length that the file system names: it may change.
    file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(LoadError::TooLarge(path.to_owned()));
    }
    let not_text = |found, at| LoadError::NotText { path: path.to_owned(), found, at };
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        return Err(not_text("a zero byte", at));
    }
    String::from_utf8(bytes).map_err(|e| not_text("bytes that are not UTF-8", e.utf8_error().valid_up_to()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_lang::FileSign;

    fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        (folder, path)
    }

    fn kind_of(name: &str, text: &str) -> Result<Loaded, LoadError> {
        let (_folder, path) = file(name, text.as_bytes());
        load(&path, &LoadOptions::default())
    }

    #[test]
    fn the_extension_decides_the_language() {
        let hyperfun = "my_model(x[3], a[1]) { my_model = 1 - x[1]; }";
        for name in ["a.hf", "a.HPF"] {
            assert_eq!(kind_of(name, hyperfun).unwrap().model.sign, FileSign::PositiveInside);
        }
        assert_eq!(kind_of("a.vm", "_0 var-x").unwrap().model.name, "program");
        assert_eq!(kind_of("a.jsurf", "surface_equation=x").unwrap().model.name, "surface");
        for name in ["a.txt", "a.frep", "a"] {
            assert_eq!(kind_of(name, "x - 1").unwrap().model.name, "formula");
        }
        assert!(matches!(kind_of("a.hf", "x - 1"), Err(LoadError::Model(_))));
    }

    #[test]
    fn files_that_are_no_texts() {
        let missing = load(Path::new("no/such.hf"), &LoadOptions::default()).unwrap_err();
        assert_eq!(missing.to_string(), "there is no file no/such.hf");
        let (_folder, path) = file("a.txt", b"x + \0");
        let binary = load(&path, &LoadOptions::default()).unwrap_err().to_string();
        assert!(binary.ends_with("is not a text: a zero byte at byte 4"), "{binary}");
        let (_folder, path) = file("a.txt", b"x \xff");
        let latin = load(&path, &LoadOptions::default()).unwrap_err().to_string();
        assert!(latin.ends_with("bytes that are not UTF-8 at byte 2"), "{latin}");
        let folder = tempfile::tempdir().unwrap();
        let directory = load(folder.path(), &LoadOptions::default());
        assert!(matches!(directory, Err(LoadError::Unreadable { .. })));
    }

    #[test]
    fn huge_files_are_refused() {
        let (_folder, path) = file("a.txt", b"x");
        File::options().write(true).open(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        assert!(matches!(load(&path, &LoadOptions::default()), Err(LoadError::TooLarge(_))));
    }

    #[test]
    fn programs_that_nobody_would_wait_for_are_refused() {
        let chain = |count: usize| {
            let lines = (0..count).map(|i| format!("_{} sin _{i}\n", i + 1));
            kind_of("a.vm", &format!("_0 var-x\n{}", lines.collect::<String>()))
        };
        assert!(chain(100_000).is_ok());
        let error = chain(MAX_OPERATIONS + 1).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("the model has 1000001 operations, and at most 1000000 are drawn"), "{error}");
    }

    #[test]
    fn only_hyperfun_has_objects() {
        let two = b"one(x[3], a[1]) { one = x[1]; } two(x[3], a[1]) { two = x[2]; }";
        let options = LoadOptions { object: Some("two".to_owned()), ..LoadOptions::default() };
        let (_folder, path) = file("two.hf", two);
        assert_eq!(load(&path, &options).unwrap().model.name, "two");
        let (_folder, path) = file("one.txt", b"x");
        assert!(matches!(load(&path, &options), Err(LoadError::NoObjects { .. })));
    }
}
