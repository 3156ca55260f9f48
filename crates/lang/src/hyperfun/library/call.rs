//! A call of a library function: its arguments, by position, and what may be wrong with them.

use super::expression::{Expr, Operand, Vector};
use super::{Argument, Context, Kind};
use crate::Dialect;
use fieldstone_field::{Graph, NodeId};
use std::cell::RefCell;

/// What a function returns for arguments that describe nothing, such as an ellipsoid with a zero half-axis.
pub(super) const INVALID: f64 = -1111111111111.0;

/// Why a call has no formula.
pub(super) enum Failure {
    /// The call returns [`INVALID`].
    Invalid,
    /// The call is an error, with a message about its arguments.
    Message(String),
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Failure::Message(message)
    }
}

/// The value of a call.
pub(super) type Outcome<'g> = Result<Expr<'g>, Failure>;

/// The names and kinds of a function's parameters.
pub(super) type Parameters = &'static [(&'static str, Kind)];

/// One call, with arguments of the right kinds.
pub(super) struct Call<'g> {
    graph: &'g RefCell<Graph>,
    pub(super) dialect: Dialect,
    parameters: Parameters,
    arguments: &'g mut [Argument],
}

/// Checks the kinds of the arguments and calls `body`.
pub(super) fn run(
    context: &mut Context<'_>,
    parameters: Parameters,
    arguments: &mut [Argument],
    body: impl for<'g> Fn(&mut Call<'g>) -> Outcome<'g>,
) -> Result<NodeId, String> {
    check_kinds(parameters, arguments)?;
    let graph = RefCell::new(std::mem::take(context.graph));
    let mut call = Call { graph: &graph, dialect: context.dialect, parameters, arguments };
    let outcome = match body(&mut call) {
        Ok(value) => Ok(value.id()),
        Err(Failure::Invalid) => Ok(INVALID.node_in(&graph)),
        Err(Failure::Message(message)) => Err(message),
    };
    *context.graph = graph.into_inner();
    outcome
}

fn check_kinds(parameters: Parameters, arguments: &[Argument]) -> Result<(), String> {
    if arguments.len() != parameters.len() {
        return Err(format!("{} arguments are needed, not {}", parameters.len(), arguments.len()));
    }
    for ((name, kind), argument) in parameters.iter().zip(arguments) {
        match (kind, argument) {
            (Kind::Real, Argument::Array(_)) => {
                return Err(format!("`{name}` must be a number, not an array"));
            }
            (Kind::Array, Argument::Real(_)) => {
                return Err(format!("`{name}` must be an array, not a number"));
            }
            _ => {}
        }
    }
    Ok(())
}

impl<'g> Call<'g> {
    pub(super) fn number(&self, value: f64) -> Expr<'g> {
        Expr::new(self.graph, value.node_in(self.graph))
    }

    /// The sum; 0 for none.
    pub(super) fn sum(&self, terms: impl IntoIterator<Item = Expr<'g>>) -> Expr<'g> {
        terms.into_iter().fold(self.number(0.0), |sum, term| sum + term)
    }

    /// The value of an argument that is a number.
    pub(super) fn real(&self, index: usize) -> Expr<'g> {
        match &self.arguments[index] {
            Argument::Real(id) => Expr::new(self.graph, *id),
            Argument::Array(_) => self.number(f64::NAN),
        }
    }

    /// The values of consecutive arguments that are numbers.
    pub(super) fn reals<const N: usize>(&self, first: usize) -> [Expr<'g>; N] {
        std::array::from_fn(|k| self.real(first + k))
    }

    /// The elements of an argument that is an array.
    pub(super) fn array(&self, index: usize) -> Vec<Expr<'g>> {
        match &self.arguments[index] {
            Argument::Array(ids) => ids.iter().map(|&id| Expr::new(self.graph, id)).collect(),
            Argument::Real(_) => Vec::new(),
        }
    }

    /// The elements of an array that must have `size` of them.
    pub(super) fn array_of(&self, index: usize, size: usize) -> Result<Vec<Expr<'g>>, String> {
        let array = self.array(index);
        if array.len() == size {
            return Ok(array);
        }
        Err(format!("`{}` must have {size} elements, not {}", self.name(index), array.len()))
    }

    /// The elements of an array that must have at least `size` of them.
    pub(super) fn array_from(&self, index: usize, size: usize) -> Result<Vec<Expr<'g>>, String> {
        let array = self.array(index);
        if array.len() >= size {
            return Ok(array);
        }
        Err(format!("`{}` must have {size} elements or more, not {}", self.name(index), array.len()))
    }

    /// A point or a direction.
    pub(super) fn vector(&self, index: usize) -> Result<Vector<'g>, String> {
        let array = self.array_of(index, 3)?;
        Ok(Vector([array[0], array[1], array[2]]))
    }

    /// The point at which the function is asked for; in another number of dimensions the call is invalid.
    pub(super) fn point(&self, index: usize) -> Result<Vector<'g>, Failure> {
        self.vector(index).map_err(|_| Failure::Invalid)
    }

    /// An array that holds `count` points.
    pub(super) fn vectors_of(&self, index: usize, count: usize) -> Result<Vec<Vector<'g>>, String> {
        self.array_of(index, 3 * count)?;
        self.vectors(index)
    }

    /// An array that holds points.
    pub(super) fn vectors(&self, index: usize) -> Result<Vec<Vector<'g>>, String> {
        let array = self.array(index);
        if !array.len().is_multiple_of(3) {
            return Err(format!(
                "`{}` must have 3 elements for each point, not {} in all",
                self.name(index),
                array.len()
            ));
        }
        Ok(array.chunks_exact(3).map(|p| Vector([p[0], p[1], p[2]])).collect())
    }

    /// Points whose coordinates are given by three consecutive arrays of one length.
    pub(super) fn centers(&self, first: usize) -> Result<Vec<Vector<'g>>, String> {
        let xs = self.array(first);
        let (ys, zs) = (self.array_of(first + 1, xs.len())?, self.array_of(first + 2, xs.len())?);
        Ok((0..xs.len()).map(|i| Vector([xs[i], ys[i], zs[i]])).collect())
    }

    /// A number that decides how the formula looks, so that it must be known beforehand.
    pub(super) fn constant(&self, index: usize) -> Result<f64, String> {
        let value = self.real(index).constant_value();
        value.ok_or_else(|| format!("`{}` must be a constant", self.name(index)))
    }

    /// Changes the first elements of an array.
    pub(super) fn write(&mut self, index: usize, values: impl IntoIterator<Item = Expr<'g>>) {
        if let Argument::Array(ids) = &mut self.arguments[index] {
            for (id, value) in ids.iter_mut().zip(values) {
                *id = value.id();
            }
        }
    }

    /// Changes the first elements of an array where a condition holds.
    pub(super) fn write_where(&mut self, index: usize, condition: Expr<'g>, values: &[Expr<'g>]) {
        let old = self.array(index);
        let chosen: Vec<_> = old.iter().zip(values).map(|(&o, &v)| condition.select(v, o)).collect();
        self.write(index, chosen);
    }

    /// The name of a parameter.
    pub(super) fn name(&self, index: usize) -> &'static str {
        self.parameters[index].0
    }
}

/// The value, or [`INVALID`] where any of `divisors` is 0.
pub(super) fn unless_zero<'g>(divisors: &[Expr<'g>], value: Expr<'g>) -> Expr<'g> {
    divisors.iter().fold(value, |value, &d| d.eq(0.0).select(INVALID, value))
}
