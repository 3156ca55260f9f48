//! First hits of rays with fields, each with a certificate of what it rests on.
//!
//! [`Tracer::first_hits`] takes a [`Tape`](fieldstone_field::Tape) and a bundle of [`Ray`]s. Intervals first find out
//! for the bundle as a whole where there can be no surface. The default method then marches each ray from the front with
//! mixed affine forms and proves that nothing was missed; dichotomy with intervals and plain sampling are there for
//! comparison, and for black boxes.

mod bundle;
mod march;
mod minimiser;
mod ray;
mod sampled;
mod solver;
mod visit;

pub use bundle::{Part, Tracer};
pub use ray::{Certificate, Hit, Method, Outcome, Ray, Settings};
pub use visit::{Visit, visited_spans};
