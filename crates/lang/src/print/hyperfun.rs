//! Models as HyperFun: one object with the sign of the language, F = −f.
//!
//! Comparisons and conditions are no values in HyperFun, so that selections and truth values become `if` statements.

use super::expression::{Expr, Level, call, common, infix, negative, relation};
use super::plan::Plan;
use super::{PrintError, Printed, Printing, Syntax, shortest};
use crate::hyperfun::library::WholeFunction;
use fieldstone_field::{Binary, Input, Node, NodeId, Unary};
use std::collections::HashMap;
use std::fmt::Write;

pub(super) fn print(printing: &Printing<'_>) -> Result<Printed, PrintError> {
    let repeats = |node: &Node| {
        matches!(node, Node::Unary(Unary::Atanh | Unary::Round, _) | Node::Binary(Binary::Compare, ..))
    };
    let plan = Plan::new(printing, repeats)?;
    let mut writer = Writer {
        printing,
        exprs: HashMap::new(),
        body: String::new(),
        variables: 0,
        point: false,
        centre: false,
    };
    for &id in &plan.order {
        let expr = writer.expr(&plan, id)?;
        let has_name = printing.graph().node(id).operands().is_empty() || writer.is_variable(&expr);
        let last = id == printing.model.field.value() && !plan.is_shared(id);
        let is_value = !plan.is_condition_only(id);
        let shared = plan.is_shared(id) || expr.is_long();
        let expr = if !has_name && !last && is_value && shared { writer.variable(&expr) } else { expr };
        writer.exprs.insert(id, expr);
    }
    writer.results();
    let warnings = warnings(printing);
    Ok(Printed { text: writer.finish(), warnings })
}

fn warnings(printing: &Printing<'_>) -> Vec<String> {
    let mut warnings = Vec::new();
    for (number, parameter) in printing.model.parameters.iter().enumerate() {
        if parameter.default != 0.0 {
            let (name, number, value) = (&parameter.name, number + 1, parameter.default);
            warnings.push(format!(
                "HyperFun has no default values: {name} = {value} is a[{number}], to be set with \
                 --param 'a[{number}]={value}'"
            ));
        }
    }
    warnings
}

struct Writer<'p, 'm> {
    printing: &'p Printing<'m>,
    exprs: HashMap<NodeId, Expr>,
    body: String,
    variables: usize,
    /// Whether the arrays of calls are used: a point, and the origin.
    point: bool,
    centre: bool,
}

impl Writer<'_, '_> {
    fn statement(&mut self, statement: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "  {statement}");
    }

    fn new_name(&mut self) -> String {
        self.variables += 1;
        format!("v{}", self.variables)
    }

    fn variable(&mut self, expr: &Expr) -> Expr {
        let name = self.new_name();
        self.statement(&format!("{name} = {};", expr.text));
        Expr::atom(name)
    }

    /// Whether it is the variable that was made last.
    fn is_variable(&self, expr: &Expr) -> bool {
        expr.text == format!("v{}", self.variables)
    }

    /// A variable that is one value or another.
    fn choice(&mut self, condition: &str, if_true: &str, if_false: &str) -> Expr {
        let name = self.new_name();
        self.statement(&format!("if {condition} then {name} = {if_true}; else {name} = {if_false}; endif;"));
        Expr::atom(name)
    }

    /// A condition as a value, unless nothing but an `if` reads it.
    fn truth(&mut self, plan: &Plan, id: NodeId, condition: String) -> Expr {
        if plan.is_condition_only(id) {
            return Expr::at(Level::Sum, condition);
        }
        self.choice(&condition, "1", "0")
    }

    fn expr(&mut self, plan: &Plan, id: NodeId) -> Result<Expr, PrintError> {
        let node = self.printing.graph().node(id);
        if let Some(expr) = common(node, |id| &self.exprs[&id]) {
            return Ok(expr);
        }
        let operand = |id: NodeId| self.exprs[&id].clone();
        Ok(match node {
            Node::Input(input) => self.input(*input),
            Node::Select(c, a, b) => {
                let (c, a, b) = (operand(*c), operand(*a), operand(*b));
                self.choice(&c.text, &a.text, &b.text)
            }
            Node::Unary(Unary::Not, a) => {
                let condition = format!("not {}", operand(*a).within(Level::Atom));
                self.truth(plan, id, condition)
            }
            Node::Unary(op, a) => unary(*op, &operand(*a)),
            Node::Binary(Binary::Compare, a, b) => {
                let (a, b) = (operand(*a).text, operand(*b).text);
                let above = self.choice(&format!("{b} < {a}"), "1", "0");
                self.choice(&format!("{a} < {b}"), "-1", &above.text)
            }
            Node::Binary(op, a, b) => match arithmetic(*op, &operand(*a), &operand(*b)) {
                Some(expr) => expr,
                None => {
                    let sign = relation(*op).unwrap_or(" = ");
                    let condition = format!("{}{sign}{}", operand(*a).text, operand(*b).text);
                    self.truth(plan, id, condition)
                }
            },
            Node::Call(_, arguments) => {
                let arguments: Vec<Expr> = arguments.iter().map(|&a| operand(a)).collect();
                self.call(plan.called(id), &arguments)?
            }
            _ => return Err(PrintError::Loop(Syntax::HyperFun)),
        })
    }

    fn input(&self, input: Input) -> Expr {
        match input {
            Input::Coordinate(k) => Expr::atom(format!("x[{}]", k + 1)),
            // Time was given a value before.
            Input::Time => Expr::number(0.0),
            Input::Parameter(_) => {
                let number = self.printing.model.parameters.iter().position(|p| p.input == input);
                number.map_or(Expr::number(0.0), |number| Expr::atom(format!("a[{}]", number + 1)))
            }
        }
    }

    fn call(&mut self, called: Option<WholeFunction>, arguments: &[Expr]) -> Result<Expr, PrintError> {
        let unknown = |name| PrintError::Function { name, syntax: Syntax::HyperFun };
        let Some(called) = called else { return Err(unknown("a function")) };
        match called {
            WholeFunction::PerlinNoise | WholeFunction::EllipsoidDistance => {
                self.point = true;
                for (k, coordinate) in arguments[..3].iter().enumerate() {
                    self.statement(&format!("p[{}] = {};", k + 1, coordinate.text));
                }
                let point = Expr::atom("p");
                let origin = Expr::atom("o");
                let value = match called {
                    WholeFunction::PerlinNoise => call("hfA_NoiseP", &[&point]),
                    _ => {
                        self.centre = true;
                        let all: Vec<&Expr> = [&point, &origin].into_iter().chain(&arguments[3..]).collect();
                        call("hfDEllipsoid", &all)
                    }
                };
                // The array holds the point of the next call afterwards.
                Ok(self.variable(&value))
            }
            WholeFunction::RoundedIntersection => Ok(call("hfDInt", &arguments.iter().collect::<Vec<_>>())),
            WholeFunction::SnappingIntersection => Err(unknown(called.name())),
        }
    }

    /// The attributes, and the value with the sign of the language.
    fn results(&mut self) {
        let outputs = self.printing.outputs();
        for (k, attribute) in outputs[1..].iter().enumerate() {
            self.statement(&format!("s[{}] = {};", k + 1, self.exprs[attribute].text));
        }
        let value = &self.exprs[&outputs[0]];
        let value = match *self.printing.graph().node(outputs[0]) {
            Node::Unary(Unary::Neg, a) => self.exprs[&a].clone(),
            Node::Binary(Binary::Sub, a, b) => infix(&self.exprs[&b], " - ", &self.exprs[&a], Level::Sum),
            Node::Constant(bits) => Expr::number(-f64::from_bits(bits)),
            _ => negative(value),
        };
        self.statement(&format!("my_model = {};", value.text));
    }

    fn finish(self) -> String {
        let model = self.printing.model;
        let mut text = String::from("-- F >= 0 inside.\n");
        for (number, parameter) in model.parameters.iter().enumerate() {
            let (number, value) = (number + 1, shortest(parameter.default));
            let _ = match parameter.name == format!("a[{number}]") {
                true if parameter.default == 0.0 => Ok(()),
                true => writeln!(text, "-- a[{number}] = {value}"),
                false => writeln!(text, "-- a[{number}] is {} = {value}", parameter.name),
            };
        }
        let attributes = match self.printing.outputs().len() - 1 {
            0 => String::new(),
            count => format!(", s[{count}]"),
        };
        let (coordinates, parameters) = (model.coordinates.max(1), model.parameters.len().max(1));
        let _ = writeln!(text, "my_model(x[{coordinates}], a[{parameters}]{attributes})\n{{");
        if self.point {
            text.push_str("  array p[3];\n");
        }
        if self.centre {
            text.push_str("  array o[3];\n  o = [0, 0, 0];\n");
        }
        text + &self.body + "}\n"
    }
}

/// What HyperFun spells in its own way.
fn unary(op: Unary, a: &Expr) -> Expr {
    match op {
        Unary::Trunc => call("int", &[a]),
        Unary::Round => {
            let above = Expr::at(Level::Sum, format!("abs({}) + 0.5", a.text));
            Expr::at(Level::Product, format!("sign({})*{}", a.text, call("floor", &[&above]).text))
        }
        // Atanh; there is no other.
        _ => {
            let (one, half) = (Expr::number(1.0), Expr::number(0.5));
            let (above, below) = (infix(&one, " + ", a, Level::Sum), infix(&one, " - ", a, Level::Sum));
            let ratio = infix(&above, "/", &below, Level::Product);
            infix(&half, "*", &call("log", &[&ratio]), Level::Product)
        }
    }
}

/// Operations whose result is a number; `None` for comparisons.
fn arithmetic(op: Binary, a: &Expr, b: &Expr) -> Option<Expr> {
    // Set operators share a level with sums; in parentheses nobody has to know that.
    let set = |sign: &str| {
        Expr::at(Level::Set, format!("{} {sign} {}", a.within(Level::Product), b.within(Level::Product)))
    };
    match op {
        Binary::RMin => Some(set("&")),
        Binary::RMax => Some(set("|")),
        Binary::Rem => Some(call("mod", &[a, b])),
        Binary::Modulo => Some(call("hfA_Modulo", &[a, &call("abs", &[b])])),
        _ => None,
    }
}
