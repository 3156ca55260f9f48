//! The CPU integrator of Fieldstone.
