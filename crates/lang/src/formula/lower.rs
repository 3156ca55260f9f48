//! Formulas become field programs.

use super::functions::power;
use super::tree::{Expr, ExprId, Formula, Infix, Prefix};
use crate::model::Parameter;
use fieldstone_field::{Binary, Field, Graph, Input, NodeId};

/// The field of a formula, and its parameters: the definitions with a constant value, as far as there are numbers
/// for them. Their values are inputs, so that they can be set without reading the formula again.
pub(super) fn lower(formula: &Formula) -> (Field, Vec<Parameter>) {
    let mut lowering = Lowering { formula, graph: Graph::new(), nodes: Vec::new(), defined: Vec::new() };
    let mut parameters = Vec::new();
    for definition in &formula.definitions {
        let mut node = lowering.node(definition.value);
        let number = u16::try_from(parameters.len()).ok();
        if let (Some(default), Some(number)) = (lowering.graph.constant_value(node), number) {
            let input = Input::Parameter(number);
            parameters.push(Parameter { name: definition.name.clone(), input, default });
            node = lowering.graph.input(input);
        }
        lowering.defined.push(node);
    }
    let value = lowering.node(formula.value);
    (Field::new(lowering.graph, value, Vec::new()), parameters)
}

struct Lowering<'a> {
    formula: &'a Formula,
    graph: Graph,
    /// The nodes of the first expressions.
    nodes: Vec<NodeId>,
    /// The nodes of the first definitions.
    defined: Vec<NodeId>,
}

impl Lowering<'_> {
    /// The node of an expression that needs no definitions but those already lowered.
    fn node(&mut self, id: ExprId) -> NodeId {
        while self.nodes.len() <= id.0 {
            let node = self.expr(&self.formula.exprs[self.nodes.len()]);
            self.nodes.push(node);
        }
        self.nodes[id.0]
    }

    fn expr(&mut self, expr: &Expr) -> NodeId {
        match expr {
            Expr::Number(value) => self.graph.constant(*value),
            Expr::Input(input) => self.graph.input(*input),
            Expr::Defined(number) => self.defined[*number],
            Expr::Prefix(Prefix::Neg, a) => self.graph.neg(self.nodes[a.0]),
            Expr::Prefix(Prefix::Not, a) => self.graph.not(self.nodes[a.0]),
            Expr::Infix(infix, a, b) => self.infix(*infix, *a, *b),
            Expr::Call(function, arguments) => {
                let arguments: Vec<NodeId> = arguments.iter().map(|a| self.nodes[a.0]).collect();
                (function.lower)(&mut self.graph, &arguments)
            }
        }
    }

    fn infix(&mut self, infix: Infix, a: ExprId, b: ExprId) -> NodeId {
        let (left, right) = (self.nodes[a.0], self.nodes[b.0]);
        match infix {
            Infix::Plain(Binary::Pow) => power(&mut self.graph, left, right),
            Infix::Plain(op) => self.graph.binary(op, left, right),
            Infix::Greater => self.graph.lt(right, left),
            Infix::GreaterEqual => self.graph.le(right, left),
            Infix::NotEqual => {
                let equal = self.graph.eq(left, right);
                self.graph.not(equal)
            }
            // The right side counts only where the left does not decide, so that it may be undefined there.
            Infix::And => {
                let (right, no) = (self.truth(b), self.graph.constant(0.0));
                self.graph.select(left, right, no)
            }
            Infix::Or => {
                let (right, yes) = (self.truth(b), self.graph.constant(1.0));
                self.graph.select(left, yes, right)
            }
        }
    }

    /// 1 where the expression is not 0, otherwise 0.
    fn truth(&mut self, id: ExprId) -> NodeId {
        let node = self.nodes[id.0];
        if self.formula.exprs[id.0].is_condition() {
            return node;
        }
        let untrue = self.graph.not(node);
        self.graph.not(untrue)
    }
}
