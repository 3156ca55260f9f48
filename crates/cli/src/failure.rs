//! How the program ends when it does not succeed.

use fieldstone::{
    BallError, BoundsError, Diagnostics, FramesError, InputError, LoadError, MeasureError, OutputError,
    PictureError, PlotError, RenderError, RequestError, Severity, SliceError, SliceRequestError, TexelError,
};
use std::{fmt, io};

/// Why the program stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for what cannot be.
    Usage(String),
    /// A model or a file is not as it must be.
    Material(String),
    /// The text of a model cannot be read.
    Model(Box<Diagnostics>),
    /// Nobody reads the output any more.
    ClosedPipe,
    /// The user asked it to, before there was a file.
    Interrupted,
    /// The user asked it to, after so many files.
    InterruptedAfter(u32),
}

impl Failure {
    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::ClosedPipe => 0,
            Self::Material(_) | Self::Model(_) => 1,
            Self::Usage(_) => 2,
            // What shells say of a program that SIGINT ended.
            Self::Interrupted | Self::InterruptedAfter(_) => 130,
        }
    }

    /// The same, without the warnings that were found on the way if nothing but errors is to be printed.
    pub(crate) fn filtered(mut self, quiet: bool) -> Self {
        if let Self::Model(diagnostics) = &mut self {
            diagnostics.list.retain(|diagnostic| !quiet || diagnostic.severity == Severity::Error);
        }
        self
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
            // Diagnostics begin with the word "error" themselves.
            Self::Model(diagnostics) => diagnostics.fmt(f),
            Self::ClosedPipe => f.write_str("the output was closed"),
            Self::Interrupted | Self::InterruptedAfter(0) => f.write_str("interrupted: nothing was written"),
            Self::InterruptedAfter(1) => f.write_str("interrupted: one picture was written"),
            Self::InterruptedAfter(count) => write!(f, "interrupted: {count} pictures were written"),
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
    Usage: InputError, BallError, BoundsError, RequestError, SliceError, SliceRequestError, MeasureError, PlotError, FramesError;
    Material: OutputError, PictureError;
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Cancelled => Self::Interrupted,
            RenderError::Threads { .. } => Self::Material(error.to_string()),
        }
    }
}

impl From<Diagnostics> for Failure {
    fn from(diagnostics: Diagnostics) -> Self {
        Self::Model(Box::new(diagnostics))
    }
}

impl From<TexelError> for Failure {
    fn from(error: TexelError) -> Self {
        match error {
            TexelError::Load(error) => error.into(),
            TexelError::Cut(message) => Self::Usage(message),
            other => Self::Material(other.to_string()),
        }
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        match error {
            LoadError::Model(diagnostics) => diagnostics.into(),
            other => Self::Material(other.to_string()),
        }
    }
}
