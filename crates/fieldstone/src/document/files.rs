//! What a scene may read: files in its folder, unless more is allowed.

use super::fault::{Fault, Outcome};
use super::tree::Value;
use crate::endless::{LoopError, settle_loops};
use crate::inputs::Inputs;
use crate::load::{LoadError, LoadOptions, Loaded, load};
use crate::texel::{Recipe, TexelError, load_volume};
use fieldstone_texel::{Mode, Volume};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// What a scene file may read beside what lies in its folder.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct FileAccess {
    /// More folders, with what lies below them.
    pub folders: Vec<PathBuf>,
    /// Whether it may read every file.
    pub outside: bool,
}

/// How a model is read.
pub(super) type ModelKey = (PathBuf, LoadOptions, Option<u32>);

/// What is asked for of the volume of a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct VolumeKey {
    /// Whether the file is a recipe.
    pub(super) is_recipe: bool,
    /// Cells along an edge, if the recipe does not decide.
    pub(super) edge: Option<u32>,
    /// The filter, if the file does not decide.
    pub(super) mode: Option<Mode>,
}

/// The files of a scene.
#[derive(Debug)]
pub(super) struct Files {
    folder: PathBuf,
    access: FileAccess,
    models: RefCell<Vec<(ModelKey, Rc<Loaded>)>>,
    volumes: RefCell<Vec<(PathBuf, VolumeKey, Arc<Volume>)>>,
    places: RefCell<HashMap<String, PathBuf>>,
}

impl Files {
    pub(super) fn new(folder: &Path, access: &FileAccess) -> Self {
        let (models, volumes, places) = Default::default();
        Self { folder: folder.to_owned(), access: access.clone(), models, volumes, places }
    }

    /// The place of a file that is named at `value`, if it may be read.
    pub(super) fn place(&self, value: &Value) -> Outcome<PathBuf> {
        let name = value.text().unwrap_or_default();
        if let Some(place) = self.places.borrow().get(name) {
            return Ok(place.clone());
        }
        let named = self.folder.join(name);
        let missing = || -> Fault {
            let help = format!("files are named relative to the scene file, here {}", self.folder.display());
            value.error(format!("there is no file {}", named.display()), "not found").with_help(help).into()
        };
        if name.is_empty() {
            return Err(missing());
        }
        let real = |path: &Path| path.canonicalize();
        let allowed = std::iter::once(&self.folder).chain(&self.access.folders);
        let is_below = |place: &Path| {
            self.access.outside || allowed.clone().filter_map(|f| real(f).ok()).any(|f| place.starts_with(f))
        };
        let refused = || -> Fault {
            let message = format!("{} lies outside of the folder of the scene", named.display());
            let help = "to let the scene read it, use --allow-read FOLDER, or --allow-outside for all files";
            value.error(message, "may not be read").with_help(help).into()
        };
        let place = match real(&named) {
            Ok(place) => place,
            // Nothing is said of what lies outside, not even whether it is there.
            Err(_) if !self.access.outside && leads_out(name) => return Err(refused()),
            Err(_) => return Err(missing()),
        };
        if !is_below(&place) {
            return Err(refused());
        }
        // Messages show the name as the scene has it.
        self.places.borrow_mut().insert(name.to_owned(), named.clone());
        Ok(named)
    }

    /// The model of a file, read once.
    pub(super) fn model(
        &self,
        value: &Value,
        (options, fuel): (LoadOptions, Option<u32>),
    ) -> Outcome<Rc<Loaded>> {
        let key = (self.place(value)?, options, fuel);
        if let Some((_, known)) = self.models.borrow().iter().find(|(k, _)| *k == key) {
            return Ok(Rc::clone(known));
        }
        let failed = |error: LoadError| match error {
            LoadError::Model(diagnostics) => Fault::Elsewhere(Box::new(diagnostics)),
            other => value.error(other.to_string(), "cannot be read").into(),
        };
        let mut loaded = load(&key.0, &key.1).map_err(failed)?;
        settle_loops(&mut loaded, &Inputs::default(), fuel).map_err(|error| match error {
            LoopError::Endless(diagnostics) => Fault::Elsewhere(Box::new(diagnostics)),
            LoopError::Input(error) => value.error(error.to_string(), "cannot be read").into(),
        })?;
        let loaded = Rc::new(loaded);
        self.models.borrow_mut().push((key, Rc::clone(&loaded)));
        Ok(loaded)
    }

    /// The volume of a file, read or made once.
    pub(super) fn volume(&self, value: &Value, wanted: VolumeKey) -> Outcome<Arc<Volume>> {
        let place = self.place(value)?;
        let known = |known: &&(PathBuf, VolumeKey, _)| (&known.0, known.1) == (&place, wanted);
        if let Some((.., volume)) = self.volumes.borrow().iter().find(known) {
            return Ok(Arc::clone(volume));
        }
        let volume = read_volume(&place, wanted).map_err(|error| match error {
            TexelError::Load(LoadError::Model(diagnostics)) => Fault::Elsewhere(Box::new(diagnostics)),
            other => value.error(other.to_string(), "this file").into(),
        })?;
        let volume = Arc::new(volume);
        self.volumes.borrow_mut().push((place, wanted, Arc::clone(&volume)));
        Ok(volume)
    }

    /// The warnings of all models that were read.
    pub(super) fn warnings(&self) -> Vec<String> {
        let models = self.models.borrow();
        models.iter().flat_map(|(_, loaded)| loaded.rendered_warnings().collect::<Vec<_>>()).collect()
    }
}

fn read_volume(place: &Path, wanted: VolumeKey) -> Result<Volume, TexelError> {
    let VolumeKey { is_recipe, edge, mode } = wanted;
    if is_recipe {
        let recipe = Recipe::load(place)?;
        // The edge is a power of two: that was checked where it stands.
        let recipe = match edge.and_then(|edge| recipe.clone().with_edge(edge).ok()) {
            Some(with_edge) => with_edge,
            None => recipe,
        };
        return mode.map_or(recipe.clone(), |mode| recipe.with_mode(mode)).build();
    }
    let volume = load_volume(place)?;
    match mode {
        Some(mode) if mode != volume.mode() => Ok(volume.filtered(mode)?),
        _ => Ok(volume),
    }
}

/// Whether a name leads out of the folder that it starts from.
fn leads_out(name: &str) -> bool {
    use std::path::Component;
    let mut depth = 0i32;
    for component in Path::new(name).components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::ParentDir => depth -= 1,
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return true,
        }
        if depth < 0 {
            return true;
        }
    }
    false
}
