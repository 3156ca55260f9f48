//! The examples of the handbook: the fenced blocks of its pages.
//!
//! A block starts with three backticks, `hyperfun`, a name, and options as `key=value`: `eye`, `target`, `fov` and
//! `bounds` as on the command line, `param` as `a[1]:2` and `coord` as `4:0.5`. Its picture is called like it, in lower
//! case.

use fieldstone::glam::DVec3;
use fieldstone::{Bounds, Dialect, LoadOptions, Loaded, Projection, RenderRequest, Settings, View, load};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The side of a picture, in pixels.
pub(crate) const SIZE: u32 = 240;

/// A model in the handbook.
#[derive(Clone, Debug)]
pub(crate) struct Example {
    /// `page.md:12`, the line of its fence.
    pub(crate) place: String,
    /// Its name.
    pub(crate) name: String,
    /// What stands behind the name.
    pub(crate) options: Vec<(String, String)>,
    /// The HyperFun text.
    pub(crate) text: String,
}

/// The folder of the handbook.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// The pages that hold examples, as paths from the folder.
pub(crate) const PAGES: [&str; 9] = [
    "hyperfun.md",
    "hyperfun/tutorial.md",
    "hyperfun/primitives.md",
    "hyperfun/soft.md",
    "hyperfun/space.md",
    "hyperfun/blends.md",
    "hyperfun/convolution.md",
    "hyperfun/distances.md",
    "hyperfun/attributes.md",
];

/// All examples of the handbook.
///
/// # Errors
/// A page that cannot be read, a block that is not as it must be.
pub(crate) fn all() -> Result<Vec<Example>, String> {
    let mut found = Vec::new();
    for page in PAGES {
        let text = std::fs::read_to_string(folder().join(page)).map_err(|e| format!("{page}: {e}"))?;
        found.extend(examples(page, &text)?);
    }
    Ok(found)
}

/// Reads a HyperFun text through a file, as the program does.
///
/// # Errors
/// The text is no model.
pub(crate) fn read(text: &str, dialect: Dialect) -> Result<Loaded, String> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("fieldstone-{}-{count}.hf", std::process::id()));
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    let loaded = load(&path, &LoadOptions { object: None, dialect });
    let _ = std::fs::remove_file(&path);
    loaded.map_err(|e| e.to_string())
}

/// The examples of a page.
///
/// # Errors
/// A block without a name or an end, an option without a value.
pub(crate) fn examples(page: &str, text: &str) -> Result<Vec<Example>, String> {
    let mut found = Vec::new();
    let mut open: Option<Example> = None;
    let mut in_other = false;
    for (i, line) in text.lines().enumerate() {
        let place = format!("{page}:{}", i + 1);
        match (line.strip_prefix("```"), &mut open) {
            (Some(""), Some(_)) => found.extend(open.take()),
            (Some(_), Some(example)) => return Err(format!("{}: the block does not end", example.place)),
            (Some(_), None) if in_other => in_other = false,
            (Some(info), None) => match info.strip_prefix("hyperfun") {
                Some(rest) => open = Some(header(place, rest)?),
                None => in_other = true,
            },
            (None, Some(example)) => {
                example.text.push_str(line);
                example.text.push('\n');
            }
            (None, None) => {}
        }
    }
    match open {
        Some(example) => Err(format!("{}: the block does not end", example.place)),
        None => Ok(found),
    }
}

fn header(place: String, rest: &str) -> Result<Example, String> {
    let mut words = rest.split_whitespace();
    let name = words.next().ok_or_else(|| format!("{place}: the block has no name"))?.to_owned();
    let option = |word: &str| {
        let (key, value) = word.split_once('=').ok_or_else(|| format!("{place}: `{word}` has no value"))?;
        Ok((key.to_owned(), value.to_owned()))
    };
    let options = words.map(option).collect::<Result<_, String>>()?;
    Ok(Example { place, name, options, text: String::new() })
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |word: &str| word.parse().map_err(|_| format!("`{word}` is not a number"));
    text.split(',').map(number).collect()
}

fn vector(text: &str) -> Result<DVec3, String> {
    let numbers: [f64; 3] = numbers(text)?.try_into().map_err(|_| format!("`{text}` is no point"))?;
    Ok(DVec3::from_array(numbers))
}

impl Example {
    /// The name of its picture.
    pub(crate) fn picture(&self) -> String {
        format!("{}.png", self.name.to_lowercase())
    }

    /// Reads the model.
    ///
    /// # Errors
    /// The text is no model, or it has warnings.
    pub(crate) fn load(&self, dialect: Dialect) -> Result<Loaded, String> {
        let loaded = read(&self.text, dialect).map_err(|e| format!("{}: {e}", self.place))?;
        let warning = loaded.rendered_warnings().next();
        match warning {
            Some(warning) => Err(format!("{}: {warning}", self.place)),
            None => Ok(loaded),
        }
    }

    /// What to draw.
    ///
    /// # Errors
    /// An option that does not exist or has no meaning.
    pub(crate) fn request(&self, size: u32) -> Result<RenderRequest, String> {
        let mut request = RenderRequest {
            settings: Settings { size: (size, size), ..Settings::default() },
            ..RenderRequest::default()
        };
        for (key, value) in &self.options {
            set(&mut request, key, value).map_err(|e| format!("{}: {key}: {e}", self.place))?;
        }
        Ok(request)
    }
}

fn set(request: &mut RenderRequest, key: &str, value: &str) -> Result<(), String> {
    let pair = |value: &str| {
        let (name, number) = value.split_once(':').ok_or_else(|| format!("`{value}` has no colon"))?;
        let number: f64 = number.parse().map_err(|_| format!("`{number}` is not a number"))?;
        Ok::<_, String>((name.to_owned(), number))
    };
    match key {
        "eye" => request.view = View { eye: Some(vector(value)?), ..request.view },
        "target" => request.view = View { target: Some(vector(value)?), ..request.view },
        "fov" => {
            let degrees = numbers(value)?.first().copied().ok_or("there is no angle")?;
            let lens = Projection::Perspective { vertical_fov_radians: degrees.to_radians() };
            request.view = View { projection: Some(lens), ..request.view };
        }
        "bounds" => {
            let [a, b, c, d, e, f] = numbers(value)?.try_into().map_err(|_| "six numbers are needed")?;
            let bounds = Bounds::new(DVec3::new(a, b, c), DVec3::new(d, e, f));
            request.bounds = Some(bounds.map_err(|e| e.to_string())?);
        }
        "param" => request.inputs.parameters.push(pair(value)?),
        "coord" => {
            let (number, value) = pair(value)?;
            let number =
                number.parse().map_err(|_| format!("`{number}` is not the number of a coordinate"))?;
            request.inputs.coordinates.push((number, value));
        }
        _ => return Err("there is no such option".to_owned()),
    }
    Ok(())
}
