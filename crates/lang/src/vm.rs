//! The `.vm` text format of libfive and Fidget: one operation a line.

use crate::diagnostic::{Diagnostic, Diagnostics, MAX_ERRORS, MAX_NAME, MAX_WARNINGS, MAX_WORDS, Source};
use crate::model::Model;
use crate::suggest::closest;
use fieldstone_field::{Binary, Field, Graph, Input, NodeId, Unary};
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Reads a `.vm` program, the text format of libfive and Fidget.
///
/// Each line is one operation: the name of its result, the operation, and the results of lines above that it takes.
/// Names are any words without blanks, `#` begins a comment, and the last line is the value of the program.
///
/// `const` takes a number; `var-x`, `var-y`, `var-z`, `var-w` are the coordinates and `var-t` is the time. `and` gives
/// its first operand if that is 0 and otherwise the second, `or` the first if it is not 0. All other operations are
/// those of field programs ([`Unary`] and [`Binary`]), by their names.
///
/// The model has the sign f < 0 inside, z up, no parameters, and three coordinates (four if its value depends on
/// `var-w`). A name that is given again means the later line from there on, with a warning.
///
/// ```
/// use fieldstone_field::Bindings;
/// use fieldstone_lang::{Source, parse_vm};
///
/// let model = parse_vm(&Source::new("slab.vm", "x var-x\nabs abs x\none const 1\nslab sub abs one"))?;
/// assert_eq!(model.field.at(&[-0.25, 0.0, 0.0], &Bindings::new()), [-0.75]);
/// # Ok::<(), fieldstone_lang::Diagnostics>(())
/// ```
///
/// # Errors
/// Every line that cannot be read, up to a limit; a text without operations.
pub fn parse_vm(source: &Source) -> Result<Model, Diagnostics> {
    if let Some((limit, _)) = source.text.match_indices('\n').nth(MAX_WORDS) {
        let message = format!("the program has more than {MAX_WORDS} lines");
        let error = Diagnostic::error(limit..limit, message, "here the limit is reached");
        return Err(Diagnostics::in_order(source, vec![error]));
    }
    let mut reader = Reader { text: &source.text, ..Reader::default() };
    let mut start = 0;
    for line in source.text.split_inclusive('\n') {
        if let Err(error) = reader.line(&words(line, start)) {
            reader.errors.push(error);
        }
        start += line.len();
        if reader.errors.len() >= MAX_ERRORS {
            break;
        }
    }
    match reader.value {
        Some(value) if reader.errors.is_empty() => {
            let field = Field::new(reader.graph, value, Vec::new());
            Ok(Model::plain("program", field, Vec::new(), reader.warnings))
        }
        _ => Err(reader.diagnostics(source)),
    }
}

/// How many words of a line are looked at; none is right with so many.
const MAX_LINE_WORDS: usize = 100;
/// How many lines below an unknown name are searched for the one that gives it.
const MAX_SEARCH: usize = 10_000;

/// A word of a line and its place in the text.
type Word<'a> = (&'a str, Range<usize>);

/// The words of the line that starts at byte `start`, without its comment.
fn words(line: &str, start: usize) -> Vec<Word<'_>> {
    const BYTE_ORDER_MARK: char = '\u{feff}';
    let code = line.split('#').next().unwrap_or_default().trim_start_matches(BYTE_ORDER_MARK);
    let place = |word: &str| word.as_ptr() as usize - line.as_ptr() as usize + start;
    let words = code.split_whitespace().take(MAX_LINE_WORDS);
    words.map(|word| (word, place(word)..place(word) + word.len())).collect()
}

#[derive(Default)]
struct Reader<'a> {
    text: &'a str,
    graph: Graph,
    names: FxHashMap<&'a str, NodeId>,
    /// What the last line gave.
    value: Option<NodeId>,
    errors: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
}

/// What a line asks for; the word says how it is written.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Operation {
    Constant,
    Input(Input),
    Unary(Unary),
    Binary(Binary),
    And,
    Or,
}

/// The operations that the table of field programs does not have.
const OWN_OPERATIONS: [(&str, Operation); 8] = [
    ("const", Operation::Constant),
    ("var-x", Operation::Input(Input::Coordinate(0))),
    ("var-y", Operation::Input(Input::Coordinate(1))),
    ("var-z", Operation::Input(Input::Coordinate(2))),
    ("var-w", Operation::Input(Input::Coordinate(3))),
    ("var-t", Operation::Input(Input::Time)),
    ("and", Operation::And),
    ("or", Operation::Or),
];

fn operation_names() -> impl Iterator<Item = &'static str> {
    let table = Unary::ALL.iter().map(|op| op.name()).chain(Binary::ALL.iter().map(|op| op.name()));
    OWN_OPERATIONS.iter().map(|(name, _)| *name).chain(table)
}

impl Operation {
    fn from_name(name: &str) -> Option<Self> {
        let own = OWN_OPERATIONS.iter().find(|(known, _)| *known == name).map(|(_, op)| *op);
        let unary = || Unary::ALL.iter().find(|op| op.name() == name).map(|op| Operation::Unary(*op));
        let binary = || Binary::ALL.iter().find(|op| op.name() == name).map(|op| Operation::Binary(*op));
        own.or_else(unary).or_else(binary)
    }

    fn operand_count(self) -> usize {
        match self {
            Operation::Input(_) => 0,
            Operation::Constant | Operation::Unary(_) => 1,
            Operation::Binary(_) | Operation::And | Operation::Or => 2,
        }
    }

    /// The operands as a message writes them.
    fn operands(self) -> &'static str {
        match (self, self.operand_count()) {
            (Operation::Constant, _) => "1 number",
            (_, 0) => "no operands",
            (_, 1) => "1 operand",
            _ => "2 operands",
        }
    }
}

impl<'a> Reader<'a> {
    fn line(&mut self, words: &[Word<'a>]) -> Result<(), Diagnostic> {
        let Some(((name, name_span), rest)) = words.split_first() else { return Ok(()) };
        if let Some((_, span)) = words.iter().find(|(word, _)| word.len() > MAX_NAME) {
            let message = format!("a word of more than {MAX_NAME} bytes");
            return Err(Diagnostic::error(span.clone(), message, "too long"));
        }
        let Some(((word, word_span), operands)) = rest.split_first() else {
            return Err(only_one_word(name, name_span.clone()));
        };
        let node = match Operation::from_name(word) {
            Some(operation) => self.operation(operation, (word, word_span.clone()), operands),
            None => Err(unknown_operation(word, word_span.clone())),
        };
        // A line in error still gives its name, so that the lines that read it are not errors too.
        let known = match &node {
            Ok(node) => *node,
            Err(_) => self.graph.constant(f64::NAN),
        };
        if self.names.insert(name, known).is_some() && self.warnings.len() < MAX_WARNINGS {
            let message = format!("`{name}` is given again");
            let warning =
                Diagnostic::warning(name_span.clone(), message, "replaces the earlier line of this name");
            self.warnings
                .push(warning.with_help("lines below read this one; give it another name to keep both"));
        }
        self.value = Some(node?);
        Ok(())
    }

    fn operation(
        &mut self,
        operation: Operation,
        word: Word<'a>,
        operands: &[Word<'a>],
    ) -> Result<NodeId, Diagnostic> {
        if operands.len() != operation.operand_count() {
            return Err(wrong_operands(operation, word, operands));
        }
        if let (Operation::Constant, [(number, span)]) = (operation, operands) {
            let value = number.parse().map_err(|_| bad_number(number, span.clone()))?;
            return Ok(self.graph.constant(value));
        }
        let nodes = operands.iter().map(|operand| self.node(operand)).collect::<Result<Vec<_>, _>>()?;
        let graph = &mut self.graph;
        Ok(match (operation, nodes.as_slice()) {
            (Operation::Input(input), _) => graph.input(input),
            (Operation::Unary(op), &[a]) => graph.unary(op, a),
            (Operation::Binary(op), &[a, b]) => graph.binary(op, a, b),
            (Operation::And, &[a, b]) => graph.select(a, b, a),
            (Operation::Or, &[a, b]) => graph.select(a, a, b),
            _ => return Err(wrong_operands(operation, word, operands)),
        })
    }

    fn node(&self, (name, span): &Word<'a>) -> Result<NodeId, Diagnostic> {
        self.names.get(name).copied().ok_or_else(|| {
            let below = self.text[span.end..].lines().skip(1).take(MAX_SEARCH);
            let later = below.into_iter().any(|line| line.split_whitespace().next() == Some(name));
            let help = if later {
                format!("the line that gives `{name}` must stand above this one")
            } else if name.parse::<f64>().is_ok() {
                format!("an operand is a name; add a line `c const {name}` above and write `c`")
            } else {
                format!("a line above must give it: `{name} operation operands`")
            };
            Diagnostic::error(span.clone(), format!("unknown name `{name}`"), "no line above gives it")
                .with_help(help)
        })
    }

    fn diagnostics(self, source: &Source) -> Diagnostics {
        let mut list = self.errors;
        if list.is_empty() {
            let end = source.text.trim_end().len();
            let error = Diagnostic::error(
                end..end,
                "the program has no operations",
                "expected `name operation operands`",
            );
            list.push(error.with_help("the smallest program is one line: `_0 var-x`"));
        }
        list.extend(self.warnings);
        Diagnostics::in_order(source, list)
    }
}

fn only_one_word(name: &str, span: Range<usize>) -> Diagnostic {
    let end = span.end;
    let help = if Operation::from_name(name).is_some() {
        format!("a line begins with the name of its result: `_0 {name} …`")
    } else {
        "a line is `name operation operands`: `_2 add _0 _1`".to_owned()
    };
    Diagnostic::error(end..end, format!("`{name}` stands alone"), "expected an operation").with_help(help)
}

fn unknown_operation(word: &str, span: Range<usize>) -> Diagnostic {
    let error = Diagnostic::error(span, format!("unknown operation `{word}`"), "not an operation");
    match closest(word, operation_names()) {
        Some(known) => error.with_help(format!("did you mean `{known}`?")),
        None => error.with_help(format!("known are {}", operation_names().collect::<Vec<_>>().join(", "))),
    }
}

fn wrong_operands(operation: Operation, (word, word_span): Word<'_>, operands: &[Word<'_>]) -> Diagnostic {
    let expected = operation.operands();
    let message = format!("`{word}` takes {expected}, not {}", operands.len());
    match operands.get(operation.operand_count()..) {
        Some([(_, first), .., (_, last)]) => Diagnostic::error(first.start..last.end, message, "too many"),
        Some([(_, only)]) => Diagnostic::error(only.clone(), message, "one too many"),
        _ => {
            let end = operands.last().map_or(word_span.end, |(_, span)| span.end);
            Diagnostic::error(end..end, message, format!("expected {expected}"))
        }
    }
}

fn bad_number(word: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::error(span, format!("`{word}` is not a number"), "expected a number")
        .with_help("write it like `1.5`, `-2e-3`, `inf` or `nan`")
}

#[cfg(test)]
mod tests;
