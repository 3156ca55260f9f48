//! How the program ends when it does not succeed.

use fieldstone::{
    BallError, BoundsError, Diagnostics, InputError, LoadError, OutputError, RenderError, RequestError,
};
use std::{fmt, io};

/// Why the program stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for what cannot be.
    Usage(String),
    /// A model or a file is not as it must be.
    Material(String),
    /// A text is no model: messages that begin with `error` or `warning` themselves, at their places.
    Text(String),
    /// Nobody reads the output any more.
    ClosedPipe,
}

impl Failure {
    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::ClosedPipe => 0,
            Self::Material(_) | Self::Text(_) => 1,
            Self::Usage(_) => 2,
        }
    }

    /// A failure to read or write a standard stream.
    pub(crate) fn of_stream(name: &str, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ClosedPipe,
            _ => Self::Material(format!("{name}: {error}")),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Material(message) => write!(f, "error: {message}"),
            Self::Text(messages) => f.write_str(messages),
            Self::ClosedPipe => f.write_str("the output was closed"),
        }
    }
}

macro_rules! failures {
    ($($kind:ident: $($error:ty),*;)*) => {
        $($(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::$kind(error.to_string())
            }
        })*)*
    };
}

failures! {
    Usage: InputError, BallError, BoundsError, RequestError;
    Material: OutputError, RenderError;
    Text: Diagnostics;
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        match error {
            LoadError::Model(diagnostics) => diagnostics.into(),
            other => Self::Material(other.to_string()),
        }
    }
}
