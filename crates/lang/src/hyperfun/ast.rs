//! The parsed program, with names resolved to slots.
//!
//! Expressions are kept as postfix code: however deep or long one is, nothing recurses over it.

use super::builtins::Builtin;
use super::library;
use super::report::Span;

/// An object: a function of x\[\], a\[\] and s\[\].
pub(super) struct Object {
    /// In lower case.
    pub(super) name: String,
    pub(super) span: Span,
    /// Sizes of x\[\], a\[\] and s\[\]; the last only if declared.
    pub(super) coordinates: usize,
    pub(super) parameters: usize,
    pub(super) attributes: Option<usize>,
    /// [`X`], [`A`], [`S`], [`OWN`], then the variables in the order of the text.
    pub(super) slots: Vec<Slot>,
    pub(super) body: Vec<Statement>,
}

impl Object {
    /// The number of values of all slots together.
    pub(super) fn size(&self) -> usize {
        self.slots.last().map_or(0, Slot::end)
    }

    /// The number of arrays whose lengths are computed.
    pub(super) fn computed_count(&self) -> usize {
        self.slots.iter().filter(|slot| matches!(slot.extent, Extent::Computed(_))).count()
    }

    pub(super) fn attribute_count(&self) -> usize {
        self.attributes.unwrap_or(1)
    }
}

/// A variable of an object, by number.
pub(super) type SlotId = usize;
/// The coordinates.
pub(super) const X: SlotId = 0;
/// The parameters.
pub(super) const A: SlotId = 1;
/// The attributes.
pub(super) const S: SlotId = 2;
/// The object's own name, whose value is the object's.
pub(super) const OWN: SlotId = 3;

/// A variable: where its values lie among those of its object.
pub(super) struct Slot {
    pub(super) name: String,
    pub(super) offset: usize,
    pub(super) extent: Extent,
}

/// How many values a variable has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Extent {
    Scalar,
    /// An array of a length that is written out.
    Array(usize),
    /// An array whose length is computed where it is declared; its number among those of the object.
    Computed(usize),
}

impl Slot {
    pub(super) fn is_array(&self) -> bool {
        self.extent != Extent::Scalar
    }

    /// The length of an array, if it is written out.
    pub(super) fn length(&self) -> Option<usize> {
        match self.extent {
            Extent::Array(length) => Some(length),
            _ => None,
        }
    }

    /// Where the values behind it begin; those of an array of computed length lie apart.
    pub(super) fn end(&self) -> usize {
        self.offset
            + match self.extent {
                Extent::Scalar => 1,
                Extent::Array(length) => length,
                Extent::Computed(_) => 0,
            }
    }
}

pub(super) enum Statement {
    /// A scalar, or one element, gets a value.
    Assign {
        target: SlotId,
        index: Option<Code>,
        value: Code,
        span: Span,
    },
    /// All elements get values.
    Fill {
        target: SlotId,
        items: Vec<Code>,
        span: Span,
    },
    /// An array gets its length, which is not written out.
    Declare {
        target: SlotId,
        length: Code,
        span: Span,
    },
    If {
        condition: Code,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
        span: Span,
    },
    While {
        condition: Code,
        body: Vec<Statement>,
        span: Span,
    },
}

/// Postfix code that leaves one value. Operands lie in reverse order: the first is on top of the stack.
pub(super) type Code = Vec<Step>;

pub(super) struct Step {
    pub(super) action: Action,
    pub(super) span: Span,
}

pub(super) enum Action {
    Number(f64),
    Scalar(SlotId),
    /// Takes an index, leaves the element.
    Element(SlotId),
    Operator(Operator),
    Call(Box<Call>),
}

impl Action {
    /// How many values it takes from the stack.
    pub(super) fn arity(&self) -> usize {
        match self {
            Action::Number(_) | Action::Scalar(_) => 0,
            Action::Element(_) | Action::Operator(Operator::Negate | Operator::Not) => 1,
            Action::Operator(_) => 2,
            Action::Call(call) => call.arguments.iter().filter(|array| array.is_none()).count(),
        }
    }
}

/// A call that passed the checks of names, number and kinds.
pub(super) struct Call {
    pub(super) callee: Callee,
    /// For each argument the array that is passed, or `None` for a value taken from the stack.
    pub(super) arguments: Vec<Option<SlotId>>,
}

#[derive(Clone, Copy)]
pub(super) enum Callee {
    Builtin(&'static Builtin),
    Library(&'static library::Function),
    /// An earlier object.
    Object(usize),
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Operator {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Not,
    Add,
    Subtract,
    Union,
    Intersection,
    Difference,
    Product,
    Multiply,
    Divide,
    Power,
    Negate,
}

/// Binding strength, loosest first; operators of one level are read from the left.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Level {
    Logic,
    Relation,
    Not,
    Sum,
    Term,
    Power,
    Sign,
}

impl Operator {
    pub(super) fn level(self) -> Level {
        use Operator::*;
        match self {
            Or | And => Level::Logic,
            Equal | Unequal | Less | LessEqual | Greater | GreaterEqual => Level::Relation,
            Not => Level::Not,
            Add | Subtract | Union | Intersection | Difference | Product => Level::Sum,
            Multiply | Divide => Level::Term,
            Power => Level::Power,
            Negate => Level::Sign,
        }
    }

    /// Whether it combines solids: these share a level with `+` and `-`.
    pub(super) fn is_set_operator(self) -> bool {
        matches!(self, Operator::Union | Operator::Intersection | Operator::Difference | Operator::Product)
    }
}
