//! Scene files: what there is to draw, as a TOML text, and its meaning at a time.
//!
//! A text becomes a [tree](tree) in which everything knows its place, is checked against the [table of keys](keys) and
//! kept as a [`Document`]. [`Document::resolve`] gives its meaning at a time: [numbers](number) are evaluated, solids
//! [composed](compose) to one program for each object, [materials](material) become attributes of that program. The
//! parts of a document are read again for each time, so that everything in it may vary.

mod check;
mod colour;
mod compose;
mod copies;
mod expression;
mod fault;
mod files;
mod finish;
mod keys;
mod light;
mod map;
mod material;
mod motion;
mod number;
mod object;
mod operation;
mod primitive;
mod schema;
mod texels;
mod tree;
mod unused;
mod usage;
mod view;

pub use schema::scene_schema;
pub(crate) use tree::place_in_text;

use crate::access::{FileAccess, folder_of};
use crate::eye;
use crate::load::{LoadError, read_text};
use crate::request::{Resolved, Warning};
pub(crate) use colour::named as named_colour;
use fault::{Fault, Outcome};
use fieldstone_lang::{Diagnostic, Diagnostics, Source};
use fieldstone_scene::{Method, Scene, View};
use files::Files;
use number::Numbers;
use std::path::Path;
use tree::{Entry, Table, Value};

/// How many solids and parameters may stand inside of each other.
const MAX_DEPTH: usize = 64;
/// A larger text is no scene file: 4 MiB.
const MAX_BYTES: usize = 4 << 20;
/// How many solids and objects a scene may have, and how many solids an object may be composed of, each counted as often
/// as it is used.
const MAX_SOLIDS: usize = 10_000;
/// How many copies of an object there may be.
const MAX_INSTANCES: usize = 100_000;
/// How many copies there may be in all.
const MAX_ALL_INSTANCES: usize = 1_000_000;

/// A scene file that was read.
#[derive(Debug)]
pub struct Document {
    source: Source,
    root: Table,
    files: Files,
}

/// What goes before what a scene file says.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SceneRequest {
    /// The time in seconds.
    pub time: Option<f64>,
    /// Values of parameters of the scene.
    pub parameters: Vec<(String, f64)>,
    /// What is fixed of the camera.
    pub view: View,
    /// Width and height in pixels.
    pub size: Option<(u32, u32)>,
    /// Samples of a pixel.
    pub samples: Option<u32>,
    /// How surfaces are found.
    pub method: Option<Method>,
    /// How closely surfaces are located, relative to the longest side of their bounds.
    pub tolerance: Option<f64>,
}

/// A scene at a time.
#[derive(Clone, Debug)]
pub struct ResolvedDocument {
    /// The scene with its warnings.
    pub resolved: Resolved,
    /// The same warnings with the names of the objects that they are about, and those of the files that were read.
    pub messages: Vec<String>,
    /// The names of the objects, one for each solid of the scene.
    pub objects: Vec<String>,
    /// The names of the volumes of texels, one for each in the scene.
    pub volumes: Vec<String>,
}

impl Document {
    /// Reads a scene file. What it names is read when it is [resolved](Self::resolve).
    ///
    /// # Errors
    /// A file that cannot be read; a text that is no scene.
    pub fn load(path: &Path, access: &FileAccess) -> Result<Self, LoadError> {
        let source = Source::new(path.display().to_string(), read_text(path)?);
        Ok(Self::parse(source, folder_of(path), access)?)
    }

    /// Reads the text of a scene whose files are named relative to `folder`.
    ///
    /// # Errors
    /// A text that is no scene.
    pub fn parse(source: Source, folder: &Path, access: &FileAccess) -> Result<Self, Diagnostics> {
        let failed = |list| Diagnostics { source: source.clone(), list };
        if source.text.len() > MAX_BYTES {
            let message = format!("a scene file has at most {} MiB", MAX_BYTES >> 20);
            return Err(failed(vec![Diagnostic::error(0..0, message, "too large")]));
        }
        let root = tree::parse(&source.text).map_err(|error| failed(vec![error]))?;
        let mut errors = check::check(&root);
        errors.extend(check_count(&root));
        if errors.is_empty() {
            errors.extend(check_names(&root));
        }
        if !errors.is_empty() {
            return Err(failed(errors));
        }
        Ok(Self { files: Files::new(folder, access), source, root })
    }

    /// The text that it was read from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The names of its parameters.
    pub fn parameter_names(&self) -> impl Iterator<Item = &str> {
        self.root.entries_of("parameters").iter().map(|entry| entry.key.as_str())
    }

    /// The scene at a time.
    ///
    /// # Errors
    /// Names without a meaning, formulas and files that cannot be read, numbers out of their range.
    pub fn resolve(&self, request: &SceneRequest) -> Result<ResolvedDocument, LoadError> {
        self.scene(request).map_err(|fault| fault.into_error(&self.source))
    }

    fn scene(&self, request: &SceneRequest) -> Outcome<ResolvedDocument> {
        let untimed = Numbers::new(self, 0.0, &request.parameters);
        let time = match (request.time, self.root.table("render").and_then(|r| r.get("time"))) {
            (Some(time), _) => time,
            (None, Some(value)) => untimed.number(value)?,
            (None, None) => 0.0,
        };
        let numbers = Numbers::new(self, time, &request.parameters);
        let settings = view::settings(&numbers, request)?;
        let mut stage = object::Stage::new(&numbers);
        stage.fill()?;
        unused::check(&numbers)?;
        let (texels, volumes) = texels::volumes(&numbers)?;
        let up = if stage.is_y_up() { fieldstone_scene::Up::Y } else { fieldstone_scene::Up::Z };
        let camera = view::camera(&numbers, request, (&stage.bounds(&texels)?, up), settings.size)?;
        let lighting = light::lighting(&numbers, &camera)?;
        let object::Stage { solids, instances, objects, mut warnings, .. } = stage;
        let scene = match solids.is_empty() {
            true => Scene::of_texels(texels, camera, lighting, settings),
            false => Scene::with_instances(solids, instances, camera, lighting, settings)
                .map(|scene| scene.with_texels(texels)),
        };
        let scene = scene.map_err(|error| self.fault_of("render", error.to_string()))?;
        if let Some((solid, warning)) = eye::warning(&scene) {
            let name = solid.map_or("camera", |solid| &objects[solid]);
            warnings.push((name.to_owned(), warning));
        }
        let mut messages: Vec<String> =
            warnings.iter().map(|(name, warning)| format!("warning: {}", warning.of_object(name))).collect();
        messages.extend(self.files.warnings());
        let warnings: Vec<Warning> = warnings.into_iter().map(|(_, warning)| warning).collect();
        Ok(ResolvedDocument { resolved: Resolved { scene, warnings }, messages, objects, volumes })
    }

    /// A fault of a whole table.
    fn fault_of(&self, key: &str, message: String) -> Fault {
        let entry = self.root.entries.iter().find(|entry| entry.key == key);
        let span = entry.map_or(0..0, |entry| entry.key_span.clone());
        Diagnostic::error(span, message, "here").into()
    }

    fn entry(&self, table: &str, name: &str) -> Option<&Entry> {
        self.root.entries_of(table).iter().find(|entry| entry.key == name)
    }

    fn parameter(&self, name: &str) -> Option<&Entry> {
        self.entry("parameters", name)
    }

    fn field(&self, name: &str) -> Option<&Entry> {
        self.entry("fields", name)
    }

    /// What a name stands for in a table of the scene.
    fn named(&self, table: &str, name: &Value) -> Outcome<&Entry> {
        let word = name.text().unwrap_or_default();
        self.entry(table, word).ok_or_else(|| {
            let what = table.trim_end_matches('s');
            let known = self.root.entries_of(table).iter().map(|entry| entry.key.as_str());
            let help = check::advise(word, known, what);
            name.error(format!("there is no {what} `{word}`"), format!("unknown {what}"))
                .with_help(help)
                .into()
        })
    }
}

/// A scene of more solids or objects than there may be.
fn check_count(root: &Table) -> Option<Diagnostic> {
    let message = |what: &str, count: usize| format!("a scene has at most {MAX_SOLIDS} {what}, not {count}");
    let solids = root.entries_of("solids");
    if let Some(first) = solids.get(MAX_SOLIDS) {
        let message = message("solids", solids.len());
        return Some(Diagnostic::error(first.key_span.clone(), message, "one too many"));
    }
    let objects = root.get("objects").and_then(Value::list).unwrap_or_default();
    let first = objects.get(MAX_SOLIDS)?;
    let error = Diagnostic::error(
        first.span.start..first.span.start,
        message("objects", objects.len()),
        "one too many",
    );
    Some(error.with_help("copies of one solid are one object with `instances`, `scatter` or `grid`"))
}

/// Names of parameters and fields that formulas could not use.
fn check_names(root: &Table) -> Vec<Diagnostic> {
    let mut errors = Vec::new();
    for table in ["parameters", "fields"] {
        for entry in root.entries_of(table) {
            if let Err((message, help)) = expression::check_name(&entry.key) {
                let error = Diagnostic::error(entry.key_span.clone(), message, "choose another name");
                errors.push(help.map_or(error.clone(), |help| error.with_help(help)));
            } else if table == "fields" && root.entries_of("parameters").iter().any(|p| p.key == entry.key) {
                let message = format!("`{}` is a parameter too", entry.key);
                errors.push(Diagnostic::error(entry.key_span.clone(), message, "choose another name"));
            }
        }
    }
    errors
}
