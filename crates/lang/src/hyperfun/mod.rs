//! HyperFun.

mod library;
