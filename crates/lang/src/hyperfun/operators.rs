//! The operators of the language, in both dialects.

use super::ast::Operator;
use super::lower::{Lowering, Operand, POISON};
use super::state::Cell;
use super::strict;
use crate::Dialect;
use fieldstone_field::NodeId;

impl Lowering<'_, '_> {
    pub(super) fn operator(&mut self, operator: Operator) {
        use Operator::*;
        let first = self.pop();
        let operand = match operator {
            Negate => Operand { node: self.graph.neg(first.node), truth: false },
            Not => Operand { node: self.not(first), truth: true },
            And | Or => {
                let second = self.pop();
                Operand { node: self.logic(operator, first, second), truth: true }
            }
            Equal | Unequal | Less | LessEqual | Greater | GreaterEqual => {
                let second = self.pop().node;
                Operand { node: self.relation(operator, first.node, second), truth: true }
            }
            _ => {
                let second = self.pop().node;
                Operand { node: self.arithmetic(operator, first.node, second), truth: false }
            }
        };
        self.stack.push(operand);
    }

    fn not(&mut self, a: Operand) -> NodeId {
        match self.dialect {
            Dialect::Strict if !a.truth => strict::is_small(&mut self.graph, a.node),
            _ => self.graph.not(a.node),
        }
    }

    /// 1 where a value counts as true, 0 where it does not.
    pub(super) fn truth(&mut self, a: Operand) -> NodeId {
        if a.truth {
            return a.node;
        }
        match self.dialect {
            Dialect::Strict => strict::is_not_small(&mut self.graph, a.node),
            Dialect::Lenient => {
                let not = self.graph.not(a.node);
                self.graph.not(not)
            }
        }
    }

    /// Both sides count, even where one would decide: an undefined one makes the result undefined.
    fn logic(&mut self, operator: Operator, a: Operand, b: Operand) -> NodeId {
        let (a, b) = (self.truth(a), self.truth(b));
        // Truth values are 0 or 1: the smaller and the larger are exact over intervals too, and hand on what is undefined.
        match (operator, self.graph.constant_value(a), self.graph.constant_value(b)) {
            (Operator::And, ..) => self.graph.min(a, b),
            (_, Some(0.0), _) => b,
            (_, _, Some(0.0)) => a,
            _ => self.graph.max(a, b),
        }
    }

    fn relation(&mut self, operator: Operator, a: NodeId, b: NodeId) -> NodeId {
        match operator {
            Operator::Less => self.graph.lt(a, b),
            Operator::LessEqual => self.graph.le(a, b),
            Operator::Greater => self.graph.lt(b, a),
            Operator::GreaterEqual => self.graph.le(b, a),
            _ => {
                let equal = match self.dialect {
                    Dialect::Lenient => self.graph.eq(a, b),
                    Dialect::Strict => strict::equal(&mut self.graph, a, b),
                };
                if operator == Operator::Unequal { self.graph.not(equal) } else { equal }
            }
        }
    }

    fn arithmetic(&mut self, operator: Operator, a: NodeId, b: NodeId) -> NodeId {
        let graph = &mut self.graph;
        match (operator, self.dialect) {
            (Operator::Add, _) => graph.add(a, b),
            (Operator::Subtract, _) => graph.sub(a, b),
            (Operator::Multiply, _) => graph.mul(a, b),
            (Operator::Union, _) => graph.rmax(a, b),
            (Operator::Difference, _) => {
                let outside = graph.neg(b);
                graph.rmin(a, outside)
            }
            (Operator::Divide, Dialect::Lenient) => graph.div(a, b),
            (Operator::Divide, Dialect::Strict) => {
                let quotient = strict::divide(graph, a, b);
                self.checked(quotient)
            }
            (Operator::Power, Dialect::Lenient) => graph.pow(a, b),
            (Operator::Power, Dialect::Strict) => {
                let power = strict::power(graph, a, b);
                self.checked(power)
            }
            // The Cartesian product is the intersection of sets that depend on different coordinates.
            _ => graph.rmin(a, b),
        }
    }

    /// A value of the strict dialect: undefined, and an error of the whole point, where the interpreter stops.
    pub(super) fn checked(&mut self, checked: strict::Checked) -> NodeId {
        let poison = self.state.read(POISON).node;
        let after = self.graph.select(checked.defined, poison, self.undefined);
        if after != poison {
            self.state.write(POISON, Cell::value(after));
        }
        self.graph.select(checked.defined, checked.value, self.undefined)
    }

    /// In the strict dialect, an undefined value is an error of the whole point, even if nothing uses it.
    pub(super) fn require_value(&mut self, value: NodeId) {
        if self.dialect == Dialect::Strict {
            // 0, or undefined where the value is: over sets too.
            let negative = self.graph.min(value, self.zero);
            let nothing = self.graph.max(negative, self.zero);
            let poison = self.state.read(POISON).node;
            let after = self.graph.add(poison, nothing);
            if after != poison {
                self.state.write(POISON, Cell::value(after));
            }
        }
    }
}
