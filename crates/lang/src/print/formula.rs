//! Models as formulas: parameters, then variables, then the function.

use super::expression::{Expr, Level, call, common, relation};
use super::plan::Plan;
use super::{PrintError, Printed, Printing, Syntax};
use crate::formula::is_definable;
use crate::hyperfun::library::WholeFunction;
use fieldstone_field::{Binary, Input, Node, NodeId, Unary};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;

pub(super) fn print(printing: &Printing<'_>) -> Result<Printed, PrintError> {
    let repeats = |node: &Node| matches!(node, Node::Binary(Binary::Rem | Binary::Compare, ..));
    let plan = Plan::new(printing, repeats)?;
    let mut writer = Writer {
        printing,
        exprs: HashMap::new(),
        names: HashMap::new(),
        text: String::new(),
        warnings: Vec::new(),
    };
    let prefix = writer.parameters();
    let mut variables = 0;
    for &id in &plan.order {
        let expr = writer.expr(&plan, id)?;
        let is_leaf = printing.graph().node(id).operands().is_empty();
        let last = id == printing.model.field.value();
        let expr = if !is_leaf && !last && (plan.is_shared(id) || expr.is_long()) {
            variables += 1;
            let name = format!("{prefix}{variables}");
            // Writing to a string cannot fail.
            let _ = writeln!(writer.text, "{name} = {};", expr.text);
            Expr::atom(name)
        } else {
            expr
        };
        writer.exprs.insert(id, expr);
    }
    let Writer { exprs, mut text, warnings, .. } = writer;
    let value = printing.model.field.value();
    let is_condition = matches!(
        printing.graph().node(value),
        Node::Binary(Binary::Lt | Binary::Le | Binary::Eq, ..) | Node::Unary(Unary::Not, _)
    );
    let value = &exprs[&value].text;
    // A formula is a function, and not a condition.
    let _ = if is_condition { writeln!(text, "if({value}, 1, 0)") } else { writeln!(text, "{value}") };
    Ok(Printed { text, warnings })
}

struct Writer<'p, 'm> {
    printing: &'p Printing<'m>,
    exprs: HashMap<NodeId, Expr>,
    /// The names of parameters.
    names: HashMap<Input, String>,
    text: String,
    warnings: Vec<String>,
}

impl Writer<'_, '_> {
    /// Defines the parameters; returns how the names of variables begin.
    fn parameters(&mut self) -> String {
        let mut taken = HashSet::new();
        for parameter in &self.printing.model.parameters {
            let plain: String = parameter.name.chars().filter(|c| !matches!(c, '[' | ']')).collect();
            let mut name = plain.clone();
            while !is_definable(&name) || taken.contains(&name) {
                name.push('_');
            }
            if name != plain {
                let message =
                    format!("the parameter {} is called {name}: its own name is taken", parameter.name);
                self.warnings.push(message);
            }
            let _ = writeln!(self.text, "{name} = {};", Expr::number(parameter.default).text);
            taken.insert(name.clone());
            self.names.insert(parameter.input, name);
        }
        let mut prefix = "v".to_owned();
        while taken.iter().any(|name| name.starts_with(&prefix)) {
            prefix.push('_');
        }
        prefix
    }

    fn expr(&self, plan: &Plan, id: NodeId) -> Result<Expr, PrintError> {
        let node = self.printing.graph().node(id);
        let operand = |id: NodeId| &self.exprs[&id];
        if let Some(expr) = common(node, operand) {
            return Ok(expr);
        }
        Ok(match *node {
            Node::Input(input) => self.input(input)?,
            Node::Select(c, a, b) => call("if", &[operand(c), operand(a), operand(b)]),
            Node::Unary(Unary::Not, a) => Expr::atom(format!("(not {})", operand(a).within(Level::Atom))),
            Node::Unary(op, a) => call(op.name(), &[operand(a)]),
            Node::Binary(op, a, b) => binary(op, operand(a), operand(b)),
            Node::Call(_, ref arguments) if plan.called(id) == Some(WholeFunction::PerlinNoise) => {
                let arguments: Vec<&Expr> = arguments.iter().map(|&a| operand(a)).collect();
                call("noise", &arguments)
            }
            _ => {
                let name = plan.called(id).map_or("a function", WholeFunction::name);
                return Err(PrintError::Function { name, syntax: Syntax::Formula });
            }
        })
    }

    fn input(&self, input: Input) -> Result<Expr, PrintError> {
        match input {
            Input::Coordinate(k) => match ["x", "y", "z", "w"].get(usize::from(k)) {
                Some(name) => Ok(Expr::atom(*name)),
                None => Err(self.printing.unknown_coordinate(k)),
            },
            Input::Time => Ok(Expr::atom("t")),
            // Every parameter of a field is one of its model's; one that is not has the value 0.
            Input::Parameter(_) => Ok(self.names.get(&input).map_or(Expr::number(0.0), Expr::atom)),
        }
    }
}

fn binary(op: Binary, a: &Expr, b: &Expr) -> Expr {
    let sum = |expr: &Expr| expr.within(Level::Sum);
    match op {
        Binary::RMin => call("runion", &[a, b]),
        Binary::RMax => call("rinter", &[a, b]),
        // `mod` is never negative, so that the sign is given back afterwards.
        Binary::Rem => {
            let magnitude = call("mod", &[&call("abs", &[a]), b]);
            Expr::at(Level::Product, format!("sign({})*{}", a.text, magnitude.text))
        }
        Binary::Modulo => call("mod", &[a, b]),
        Binary::Compare => {
            let (a, b) = (sum(a), sum(b));
            Expr::at(Level::Sum, format!("({b} < {a}) - ({a} < {b})"))
        }
        Binary::Eq => Expr::atom(format!("({} == {})", sum(a), sum(b))),
        _ => Expr::atom(format!("({}{}{})", sum(a), relation(op).unwrap_or(" < "), sum(b))),
    }
}
