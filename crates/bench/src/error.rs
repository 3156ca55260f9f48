//! Why something could not be measured.

use std::io;
use std::path::PathBuf;

/// Why something could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// No model, part or job has this name.
    #[error("there is no {kind} `{name}`; there are {known}")]
    Unknown {
        /// What kind of thing was looked for.
        kind: &'static str,
        /// The name.
        name: String,
        /// The names that there are, with commas.
        known: String,
    },
    /// A model could not be read or drawn.
    #[error("{model}: {reason}")]
    Model {
        /// The model.
        model: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A peer did not do what it was asked to.
    #[error("{peer}: {reason}")]
    Peer {
        /// The peer.
        peer: &'static str,
        /// What it says.
        reason: String,
    },
    /// A folder of the gallery cannot be read.
    #[error("{}: {}; run it in the folder of the sources, or name the gallery with --gallery", folder.display(), without_code(reason))]
    Gallery {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// A file or a program of the system.
    #[error("{what}: {reason}")]
    System {
        /// The file or the program.
        what: String,
        /// What the system says.
        reason: io::Error,
    },
}

/// What the system says, without the number of the error.
fn without_code(reason: &io::Error) -> String {
    let text = reason.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

impl BenchError {
    pub(crate) fn model(model: &str, reason: impl ToString) -> Self {
        Self::Model { model: model.to_owned(), reason: reason.to_string() }
    }

    pub(crate) fn peer(peer: &'static str, reason: impl ToString) -> Self {
        Self::Peer { peer, reason: reason.to_string() }
    }

    pub(crate) fn system(what: impl ToString, reason: io::Error) -> Self {
        Self::System { what: what.to_string(), reason }
    }
}
