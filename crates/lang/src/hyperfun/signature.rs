//! The functions of the language, for whoever explains them: documents, editors.

use super::builtins;
use super::library::{self, Kind};
use crate::Dialect;

/// A function that HyperFun texts may call.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Signature {
    /// Its name in lower case; letter case means nothing.
    pub name: &'static str,
    /// The names of its parameters in order, and whether each is an array.
    pub parameters: Vec<(&'static str, bool)>,
    /// Whether it belongs to the library (`hf…`) or to the language itself.
    pub is_library: bool,
}

/// All functions: those of the language, then those of the library, each in the order of its table.
pub fn hyperfun_functions() -> Vec<Signature> {
    let builtin = |name| {
        let function = builtins::lookup(name)?;
        let parameters = function.parameters.iter().map(|&name| (name, false)).collect();
        Some(Signature { name, parameters, is_library: false })
    };
    let library = |name| {
        let function = library::lookup(name, Dialect::Lenient)?;
        let parameters = function.parameters.iter().map(|&(name, kind)| (name, kind == Kind::Array));
        Some(Signature { name, parameters: parameters.collect(), is_library: true })
    };
    builtins::names().filter_map(builtin).chain(library::names().filter_map(library)).collect()
}
