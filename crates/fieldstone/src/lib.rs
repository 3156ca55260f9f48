//! See solids that are defined by functions.
