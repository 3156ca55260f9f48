//! How the program ends when it does not succeed.

use fieldstone::{
    BoundsError, Diagnostics, InputError, LoadError, MeasureError, OutputError, PictureError, PlotError,
    RenderError, RequestError,
};
use std::{fmt, io};

/// Why the program stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for what cannot be.
    Usage(String),
    /// A model or a file is not as it must be.
    Material(String),
    /// Nobody reads the output any more.
    ClosedPipe,
}

impl Failure {
    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::ClosedPipe => 0,
            Self::Material(_) => 1,
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
            Self::Usage(message) | Self::Material(message) => {
                // Diagnostics of models begin with that word themselves.
                let prefix = if message.starts_with("error") { "" } else { "error: " };
                write!(f, "{prefix}{message}")
            }
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
    Usage: InputError, BoundsError, RequestError, MeasureError, PlotError;
    Material: Diagnostics, LoadError, OutputError, PictureError, RenderError;
}
