//! Which files a text may name: those in its folder, unless more is allowed.

use std::path::{Component, Path, PathBuf};

/// What a scene or a recipe may read beside what lies in its folder.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct FileAccess {
    /// More folders, with what lies below them.
    pub folders: Vec<PathBuf>,
    /// Whether it may read every file.
    pub outside: bool,
}

impl FileAccess {
    /// The same with one more folder.
    pub(crate) fn and(&self, folder: &Path) -> Self {
        let mut more = self.clone();
        more.folders.push(folder.to_owned());
        more
    }
}

/// The files that a text in a folder can name.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    folder: PathBuf,
    access: FileAccess,
}

/// Why a name is no file that may be read.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum NoFile {
    /// There is none at this place.
    Missing(PathBuf),
    /// This place is out of reach.
    Outside(PathBuf),
}

impl Reach {
    pub(crate) fn new(folder: &Path, access: &FileAccess) -> Self {
        Self { folder: folder.to_owned(), access: access.clone() }
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// What a text in another folder may read that this one names: all that this one may read, from there.
    pub(crate) fn access(&self) -> FileAccess {
        self.access.and(&self.folder)
    }

    /// The place of a file of this name, as the text has it.
    pub(crate) fn find(&self, name: &str) -> Result<PathBuf, NoFile> {
        let named = self.folder.join(name);
        if name.is_empty() {
            return Err(NoFile::Missing(named));
        }
        let real = |path: &Path| path.canonicalize();
        let allowed = std::iter::once(&self.folder).chain(&self.access.folders);
        let is_below = |place: &Path| {
            self.access.outside || allowed.clone().filter_map(|f| real(f).ok()).any(|f| place.starts_with(f))
        };
        match real(&named) {
            Ok(place) if is_below(&place) => Ok(named),
            Ok(_) => Err(NoFile::Outside(named)),
            // Nothing is said of what lies outside, not even whether it is there.
            Err(_) if !self.access.outside && leads_out(name) => Err(NoFile::Outside(named)),
            Err(_) => Err(NoFile::Missing(named)),
        }
    }
}

/// The folder of a file.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether a name leads out of the folder that it starts from.
fn leads_out(name: &str) -> bool {
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
