//! Evaluation of tapes over blocks of 64 lanes, with the widest instructions that the processor has.
//!
//! A [`Workspace`] holds the registers. Each register is a row of 64 numbers for each component of the domain (one
//! for values, two for intervals, five for affine forms, four for gradients); an instruction works through the rows in
//! chunks as wide as a SIMD register. Data-dependent loops run chunk by chunk with a mask of the lanes that still turn.

mod machine;
mod rows;
mod workspace;

use crate::affine::Affine;
use crate::dual::Dual;
use crate::interval::Interval;
use crate::real::{Real, Scalar, Wide32, Wide64};
use fearless_simd::Simd;

pub use rows::Rows;
pub use workspace::{Engine, Task, Workspace};

/// How many points, or sets, one evaluation works on at most.
pub const LANES: usize = 64;

/// The numbers that an evaluation works with.
pub trait Precision: 'static {
    /// One number.
    type Scalar: Scalar;
    /// Many side by side.
    type Real<S: Simd>: Real<Scalar = Self::Scalar, Token = S>;
}

/// Double precision.
#[derive(Clone, Copy, Debug)]
pub struct F64;

impl Precision for F64 {
    type Scalar = f64;
    type Real<S: Simd> = Wide64<S>;
}

/// Single precision.
#[derive(Clone, Copy, Debug)]
pub struct F32;

impl Precision for F32 {
    type Scalar = f32;
    type Real<S: Simd> = Wide32<S>;
}

/// What an evaluation computes.
pub trait Kind: 'static {
    /// The domain over a number type.
    type Domain<R: Real>: Rows<Real = R>;
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident $domain:ident;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $name;

            impl Kind for $name {
                type Domain<R: Real> = $domain<R>;
            }
        )*
    };
}

type Value<R> = R;
kinds! {
    /// Values at points. Component: the value.
    Points Value;
    /// Sets over boxes. Components: lower end, upper end.
    Intervals Interval;
    /// Sets over spans of rays. Components: centre, slope, error, lower end, upper end.
    Affines Affine;
    /// Values at points with gradients. Components: value, ∂x, ∂y, ∂z of the directions that the inputs carry.
    Gradients Dual;
}
