//! Fields as functions of POV-Ray.

use crate::error::BenchError;
use fieldstone::{Bindings, Field, Graph, Input, NodeId};
use fieldstone_field::{Binary, Node, Unary};
use std::collections::HashMap;

/// A function longer than this is none that POV-Ray is compared with, in bytes.
const LONGEST: usize = 1 << 16;

/// The value of a field as an expression of x, y and z, negative inside. Parameters are replaced by their values.
///
/// POV-Ray's functions have no variables: what several operations read is written out for each of them, as their users do.
///
/// # Errors
/// What functions of POV-Ray cannot say; a text that is too long.
pub(super) fn expression(field: &Field, bindings: &Bindings) -> Result<String, BenchError> {
    let mut printer = Printer { graph: field.graph(), bindings, known: HashMap::new() };
    let mut nodes = field.graph().reachable(&[field.value()]);
    // Operands are older than what they are operands of.
    nodes.sort_unstable();
    for node in nodes {
        let text = printer.node(node)?;
        if text.len() > LONGEST {
            return Err(BenchError::peer("POV-Ray", "the formula is too long when it is written out"));
        }
        printer.known.insert(node, text);
    }
    Ok(printer.known.remove(&field.value()).unwrap_or_default())
}

struct Printer<'g> {
    graph: &'g Graph,
    bindings: &'g Bindings,
    known: HashMap<NodeId, String>,
}

impl Printer<'_> {
    fn node(&self, id: NodeId) -> Result<String, BenchError> {
        let of = |id: &NodeId| self.known.get(id).map_or("0", String::as_str);
        let unknown = |what: &str| BenchError::peer("POV-Ray", format!("its functions have no `{what}`"));
        Ok(match self.graph.node(id) {
            Node::Constant(bits) => number(f64::from_bits(*bits)),
            Node::Input(Input::Coordinate(axis @ 0..=2)) => ["x", "y", "z"][usize::from(*axis)].to_owned(),
            Node::Input(input) => number(self.bindings.get(*input)),
            Node::Powi(a, n) => power(of(a), *n),
            Node::Unary(op, a) => unary(*op, of(a)).ok_or_else(|| unknown(op.name()))?,
            Node::Binary(op, a, b) => binary(*op, of(a), of(b)).ok_or_else(|| unknown(op.name()))?,
            _ => return Err(unknown("loops and conditions")),
        })
    }
}

fn number(value: f64) -> String {
    if value < 0.0 { format!("({value:?})") } else { format!("{value:?}") }
}

fn unary(op: Unary, a: &str) -> Option<String> {
    Some(match op {
        Unary::Neg => format!("(-{a})"),
        Unary::Square => power(a, 2),
        Unary::Recip => format!("(1/{a})"),
        Unary::Ln => format!("ln({a})"),
        Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Sin | Unary::Cos | Unary::Tan => {
            format!("{}({a})", op.name())
        }
        _ => return None,
    })
}

fn binary(op: Binary, a: &str, b: &str) -> Option<String> {
    Some(match op {
        Binary::Add => format!("({a}+{b})"),
        Binary::Sub => format!("({a}-{b})"),
        Binary::Mul => format!("({a}*{b})"),
        Binary::Div => format!("({a}/{b})"),
        Binary::Min => format!("min({a},{b})"),
        Binary::Max => format!("max({a},{b})"),
        Binary::Pow => format!("pow({a},{b})"),
        Binary::RMin => format!("({a}+{b}-sqrt({a}*{a}+{b}*{b}))"),
        Binary::RMax => format!("({a}+{b}+sqrt({a}*{a}+{b}*{b}))"),
        _ => return None,
    })
}

/// Squares and cubes of coordinates are products, which are faster.
fn power(a: &str, n: i32) -> String {
    match (a.len(), n) {
        (1, 2) => format!("({a}*{a})"),
        (1, 3) => format!("({a}*{a}*{a})"),
        _ => format!("pow({a},{n})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<String, BenchError> {
        let model = fieldstone::formula(text).unwrap().model;
        let bindings = fieldstone::Inputs::default().bindings(&model).unwrap();
        expression(&model.field, &bindings)
    }

    #[test]
    fn formulas_are_written_out() {
        assert_eq!(of("x^2 + y^3 - 1").unwrap(), "(((x*x)+(y*y*y))-1.0)");
        assert_eq!(of("r = 2; x^500 - sin(r*y)").unwrap(), "(pow(x,500)-sin((2.0*y)))");
        assert_eq!(of("min(x, -z)").unwrap(), "min(x,(-z))");
    }

    #[test]
    fn what_has_no_words_is_told() {
        let error = of("atan(x)").unwrap_err().to_string();
        assert_eq!(error, "POV-Ray: its functions have no `atan`");
    }
}
