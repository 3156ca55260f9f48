//! Fields as data: programs over reals, intervals, affine forms and duals.
//!
//! A model is a *field program*: a function of space, kept as data. Everything else is a way of reading that program:
//! over reals it gives values, over [`Interval`]s proofs that there is no surface in a box, over affine forms the same
//! with a slope along a ray, over duals exact gradients.

mod affine;
mod allocate;
mod compile;
mod defined;
mod domain;
mod dual;
mod elementary;
mod eval;
mod field;
mod function;
mod graph;
mod import;
mod interval;
mod op;
mod real;
pub mod reference;
mod tape;

pub use affine::Affine;
pub use domain::Domain;
pub use dual::Dual;
pub use eval::{
    Affines, Engine, F32, F64, Gradients, Intervals, Kind, LANES, Points, Precision, Rows, Task, Workspace,
};
pub use field::{Bindings, Field};
pub use function::Function;
pub use graph::{Graph, Input, LoopId, Node, NodeId};
pub use interval::Interval;
pub use op::{Binary, Unary};
pub use real::{Real, Scalar, Wide32, Wide64};
pub use tape::{Reading, Tape, TapeOptions};
