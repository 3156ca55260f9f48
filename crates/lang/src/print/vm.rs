//! Models as `.vm` programs, in the operations that libfive and Fidget know as far as possible.

use super::plan::Plan;
use super::{PrintError, Printed, Printing, Syntax, shortest};
use crate::hyperfun::library::WholeFunction;
use fieldstone_field::{Binary, Graph, Input, Node, NodeId, Unary};
use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

/// The operations of Fidget's text format besides `const` and the coordinates.
const PORTABLE: [&str; 26] = [
    "abs", "neg", "sqrt", "square", "floor", "ceil", "round", "sin", "cos", "tan", "asin", "acos", "atan",
    "ln", "not", "exp", "add", "sub", "mul", "div", "min", "max", "compare", "mod", "and", "or",
];

pub(super) fn print(printing: &Printing<'_>) -> Result<Printed, PrintError> {
    let plan = Plan::new(printing, |_| false)?;
    let scratch = printing.graph().clone();
    let mut writer = Writer { printing, names: HashMap::new(), lines: Lines::default(), scratch };
    let mut last = None;
    for &id in &plan.order {
        let name = writer.node(&plan, id)?;
        writer.names.insert(id, name);
        last = Some(name);
    }
    let mut lines = writer.lines;
    // The value is the last line; a constant or an input may have been given before.
    if last.is_some_and(|last| last + 1 != lines.count) {
        let (value, zero) = (writer.names[&printing.model.field.value()], lines.constant(0.0));
        lines.again("add", &[value, zero]);
    }
    let mut warnings = Vec::new();
    if !lines.foreign.is_empty() {
        let list: Vec<String> = lines.foreign.iter().map(|name| format!("`{name}`")).collect();
        let list = list.join(", ");
        warnings.push(format!("other programs may not know {list}: they have no such operation"));
    }
    let text = format!("# Negative inside, z up.\n{}", lines.text);
    Ok(Printed { text, warnings })
}

/// A line, by number.
type Name = usize;

/// The program so far. The same operation on the same operands is written once.
#[derive(Default)]
struct Lines {
    text: String,
    count: usize,
    known: HashMap<String, Name>,
    foreign: BTreeSet<&'static str>,
}

impl Lines {
    fn line(&mut self, body: String) -> Name {
        if let Some(&name) = self.known.get(&body) {
            return name;
        }
        let name = self.count;
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "_{name:x} {body}");
        self.known.insert(body, name);
        self.count += 1;
        name
    }

    fn op(&mut self, op: &'static str, operands: &[Name]) -> Name {
        if !PORTABLE.contains(&op) {
            self.foreign.insert(op);
        }
        self.line(body(op, operands))
    }

    /// The same as [`op`](Self::op), on a new line in any case.
    fn again(&mut self, op: &'static str, operands: &[Name]) {
        self.known.remove(&body(op, operands));
        self.op(op, operands);
    }

    fn constant(&mut self, value: f64) -> Name {
        let number = match value {
            _ if value.is_nan() => "NaN".to_owned(),
            _ if value.is_infinite() => value.to_string(),
            _ => shortest(value),
        };
        self.line(format!("const {number}"))
    }

    /// aⁿ by squares and products, n > 0.
    fn whole_power(&mut self, a: Name, n: u32) -> Name {
        let (mut square, mut rest, mut product) = (a, n, None);
        loop {
            if rest & 1 == 1 {
                product = Some(product.map_or(square, |p| self.op("mul", &[p, square])));
            }
            rest >>= 1;
            match product {
                Some(product) if rest == 0 => return product,
                _ => square = self.op("square", &[square]),
            }
        }
    }

    /// `b` where `c` is not 0, `d` where it is. `and` and `or` give one of their operands.
    fn select(&mut self, [c, b, d]: [Name; 3]) -> Name {
        let if_true = self.op("and", &[c, b]);
        let is_zero = self.op("not", &[c]);
        let if_false = self.op("and", &[is_zero, d]);
        self.op("or", &[if_true, if_false])
    }

    fn unary(&mut self, op: Unary, a: Name) -> Name {
        match op {
            Unary::Recip => {
                let one = self.constant(1.0);
                self.op("div", &[one, a])
            }
            Unary::Sign => {
                let zero = self.constant(0.0);
                self.op("compare", &[a, zero])
            }
            Unary::Trunc => {
                let (sign, size) = (self.unary(Unary::Sign, a), self.op("abs", &[a]));
                let whole = self.op("floor", &[size]);
                self.op("mul", &[sign, whole])
            }
            _ => self.op(op.name(), &[a]),
        }
    }

    fn binary(&mut self, op: Binary, a: Name, b: Name) -> Name {
        match op {
            Binary::RMin | Binary::RMax => {
                let squares = [self.op("square", &[a]), self.op("square", &[b])];
                let radicand = self.op("add", &squares);
                let (root, sum) = (self.op("sqrt", &[radicand]), self.op("add", &[a, b]));
                self.op(if op == Binary::RMin { "sub" } else { "add" }, &[sum, root])
            }
            // `mod` is never negative, so that the sign is given back afterwards.
            Binary::Rem => {
                let (sign, size) = (self.unary(Unary::Sign, a), self.op("abs", &[a]));
                let rest = self.op("mod", &[size, b]);
                self.op("mul", &[sign, rest])
            }
            Binary::Lt | Binary::Le | Binary::Eq => {
                let order = self.op("compare", &[a, b]);
                match op {
                    Binary::Eq => self.op("not", &[order]),
                    Binary::Lt => {
                        let (reversed, zero) = (self.op("neg", &[order]), self.constant(0.0));
                        self.op("max", &[reversed, zero])
                    }
                    _ => {
                        let zero = self.constant(0.0);
                        let above = self.op("max", &[order, zero]);
                        self.op("not", &[above])
                    }
                }
            }
            _ => self.op(op.name(), &[a, b]),
        }
    }
}

fn body(op: &str, operands: &[Name]) -> String {
    operands.iter().fold(op.to_owned(), |body, operand| format!("{body} _{operand:x}"))
}

/// Whether an R-function that is written out becomes the operation `id` again when it is read. It does not where the
/// square of an operand is something simpler; its values would then be less exact.
fn is_recognised(scratch: &mut Graph, id: NodeId, (op, a, b): (Binary, NodeId, NodeId)) -> bool {
    let squares = [a, b].map(|operand| scratch.square(operand));
    let radicand = scratch.add(squares[0], squares[1]);
    let (root, sum) = (scratch.sqrt(radicand), scratch.add(a, b));
    let written_out = if op == Binary::RMin { scratch.sub(sum, root) } else { scratch.add(sum, root) };
    written_out == id
}

struct Writer<'p, 'm> {
    printing: &'p Printing<'m>,
    names: HashMap<NodeId, Name>,
    lines: Lines,
    /// A copy of the graph to try things in.
    scratch: Graph,
}

impl Writer<'_, '_> {
    fn node(&mut self, plan: &Plan, id: NodeId) -> Result<Name, PrintError> {
        let (names, lines) = (&self.names, &mut self.lines);
        Ok(match *self.printing.graph().node(id) {
            Node::Constant(bits) => lines.constant(f64::from_bits(bits)),
            Node::Input(input) => return self.input(input),
            Node::Unary(op, a) => lines.unary(op, names[&a]),
            Node::Powi(a, n) => {
                let power = lines.whole_power(names[&a], n.unsigned_abs().max(1));
                if n < 0 { lines.unary(Unary::Recip, power) } else { power }
            }
            Node::Binary(op @ (Binary::RMin | Binary::RMax), a, b)
                if !is_recognised(&mut self.scratch, id, (op, a, b)) =>
            {
                lines.op(op.name(), &[names[&a], names[&b]])
            }
            Node::Binary(op, a, b) => lines.binary(op, names[&a], names[&b]),
            Node::Select(c, a, b) => lines.select([names[&c], names[&a], names[&b]]),
            _ => {
                let name = plan.called(id).map_or("a function", WholeFunction::name);
                return Err(PrintError::Function { name, syntax: Syntax::Vm });
            }
        })
    }

    fn input(&mut self, input: Input) -> Result<Name, PrintError> {
        const COORDINATES: [&str; 4] = ["var-x", "var-y", "var-z", "var-w"];
        let name = match input {
            Input::Coordinate(k) => {
                *COORDINATES.get(usize::from(k)).ok_or_else(|| self.printing.unknown_coordinate(k))?
            }
            Input::Time => "var-t",
            // Parameters were given their values before.
            Input::Parameter(_) => return Ok(self.lines.constant(0.0)),
        };
        if matches!(name, "var-w" | "var-t") {
            self.lines.foreign.insert(name);
        }
        Ok(self.lines.line(name.to_owned()))
    }
}
