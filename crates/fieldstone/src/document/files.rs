//! What a scene may read: files in its folder, unless more is allowed.

use super::fault::{Fault, Outcome};
use super::tree::Value;
use crate::access::{FileAccess, NoFile, Reach};
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

/// What lets more files be read.
const ALLOW: &str = "to let the scene read it, use --allow-read FOLDER, or --allow-outside for all files";

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
    reach: Reach,
    models: RefCell<Vec<(ModelKey, Rc<Loaded>)>>,
    volumes: RefCell<Vec<(PathBuf, VolumeKey, Arc<Volume>)>>,
    places: RefCell<HashMap<String, PathBuf>>,
    /// What recipes gave reason to say.
    warnings: RefCell<Vec<String>>,
}

impl Files {
    pub(super) fn new(folder: &Path, access: &FileAccess) -> Self {
        let (models, volumes, places, warnings) = Default::default();
        Self { reach: Reach::new(folder, access), models, volumes, places, warnings }
    }

    /// The place of a file that is named at `value`, if it may be read.
    pub(super) fn place(&self, value: &Value) -> Outcome<PathBuf> {
        let name = value.text().unwrap_or_default();
        if let Some(place) = self.places.borrow().get(name) {
            return Ok(place.clone());
        }
        let named = self.reach.find(name).map_err(|why| -> Fault {
            match why {
                NoFile::Missing(named) => {
                    let folder = self.reach.folder().display();
                    let help = format!("files are named relative to the scene file, here {folder}");
                    value
                        .error(format!("there is no file {}", named.display()), "not found")
                        .with_help(help)
                        .into()
                }
                NoFile::Outside(named) => {
                    let message = format!("{} lies outside of the folder of the scene", named.display());
                    value.error(message, "may not be read").with_help(ALLOW).into()
                }
            }
        })?;
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
        let volume = self.read_volume(&place, wanted).map_err(|error| match error {
            TexelError::Load(LoadError::Model(diagnostics)) => Fault::Elsewhere(Box::new(diagnostics)),
            other => value.error(other.to_string(), "this file").into(),
        })?;
        let volume = Arc::new(volume);
        self.volumes.borrow_mut().push((place, wanted, Arc::clone(&volume)));
        Ok(volume)
    }

    fn read_volume(&self, place: &Path, wanted: VolumeKey) -> Result<Volume, TexelError> {
        let VolumeKey { is_recipe, edge, mode } = wanted;
        if is_recipe {
            let mut recipe = Recipe::load(place, &self.reach.access())?;
            self.warnings.borrow_mut().extend_from_slice(recipe.warnings());
            // The edge is a power of two: that was checked where it stands.
            if let Some(with_edge) = edge.and_then(|edge| recipe.clone().with_edge(edge).ok()) {
                recipe = with_edge;
            }
            return mode.map_or(recipe.clone(), |mode| recipe.with_mode(mode)).build();
        }
        let volume = load_volume(place)?;
        match mode {
            Some(mode) if mode != volume.mode() => Ok(volume.filtered(mode)?),
            _ => Ok(volume),
        }
    }

    /// The warnings of all models and recipes that were read.
    pub(super) fn warnings(&self) -> Vec<String> {
        let models = self.models.borrow();
        let of_models = models.iter().flat_map(|(_, loaded)| loaded.rendered_warnings().collect::<Vec<_>>());
        of_models.chain(self.warnings.borrow().iter().cloned()).collect()
    }
}
