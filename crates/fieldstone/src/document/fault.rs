//! Why a scene cannot be drawn.

use crate::load::LoadError;
use fieldstone_lang::{Diagnostic, Diagnostics, Source};

/// What is wrong: with the scene file, or with a file that it names.
#[derive(Debug)]
pub(super) enum Fault {
    /// Places of the scene file.
    Here(Vec<Diagnostic>),
    /// Places of another file.
    Elsewhere(Box<Diagnostics>),
}

pub(super) type Outcome<T> = Result<T, Fault>;

impl From<Diagnostic> for Fault {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Here(vec![diagnostic])
    }
}

impl Fault {
    /// As an error of the scene file.
    pub(super) fn into_error(self, source: &Source) -> LoadError {
        match self {
            Self::Here(list) => LoadError::Model(Diagnostics { source: source.clone(), list }),
            Self::Elsewhere(diagnostics) => LoadError::Model(*diagnostics),
        }
    }
}
