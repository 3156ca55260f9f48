//! Writing `.vm` programs: models as expressions of Rust.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Mul, Neg, Sub};

/// A program in the making. Equal operations are written once.
///
/// ```
/// use fieldstone_bench::Program;
///
/// let program = Program::new();
/// let [x, y, _] = program.point();
/// let disc = (x.square() + y.square()).sqrt() - 1.0;
/// assert!(program.text(disc).ends_with("_7 const 1\n_8 sub _6 _7\n"));
/// ```
#[derive(Debug)]
pub struct Program {
    lines: RefCell<Lines>,
    /// What constants are multiples of: 1 / this.
    precision: f64,
}

#[derive(Debug, Default)]
struct Lines {
    operations: Vec<String>,
    known: HashMap<String, usize>,
}

/// What a line of a [`Program`] gives; negative is inside.
#[derive(Clone, Copy, Debug)]
pub struct Value<'p> {
    program: &'p Program,
    line: usize,
}

impl Default for Program {
    fn default() -> Self {
        Self::new()
    }
}

impl Program {
    /// A program without lines. Its constants are rounded to six decimals, so that files stay readable.
    pub fn new() -> Self {
        Self::with_decimals(6)
    }

    /// A program without lines whose constants have at most so many decimals.
    pub fn with_decimals(decimals: i32) -> Self {
        Self { lines: RefCell::default(), precision: 10.0_f64.powi(decimals) }
    }

    /// The coordinates x, y, z.
    pub fn point(&self) -> [Value<'_>; 3] {
        ["var-x", "var-y", "var-z"].map(|name| self.line(name.to_owned()))
    }

    /// A number, rounded.
    pub fn constant(&self, value: f64) -> Value<'_> {
        // Adding 0 makes a zero of a negative one.
        self.line(format!("const {}", (value * self.precision).round() / self.precision + 0.0))
    }

    /// The least of all, in a tree as flat as can be: short programs for small regions need short ways. None of nothing.
    pub fn union<'p>(&'p self, values: &[Value<'p>]) -> Option<Value<'p>> {
        fold(values, Value::min)
    }

    /// The greatest of all, likewise.
    pub fn intersection<'p>(&'p self, values: &[Value<'p>]) -> Option<Value<'p>> {
        fold(values, Value::max)
    }

    /// The sum of all, likewise.
    pub fn sum<'p>(&'p self, values: &[Value<'p>]) -> Option<Value<'p>> {
        fold(values, |a, b| a + b)
    }

    /// The text of the program whose value is `value`: its last line.
    pub fn text(&self, value: Value<'_>) -> String {
        let lines = self.lines.borrow();
        // What follows takes no part in it: lines take the results of lines above them.
        let taken = lines.operations.iter().take(value.line + 1);
        taken.enumerate().map(|(i, operation)| format!("_{i:x} {operation}\n")).collect()
    }

    fn line(&self, operation: String) -> Value<'_> {
        let Lines { operations, known } = &mut *self.lines.borrow_mut();
        let next = operations.len();
        let line = *known.entry(operation.clone()).or_insert(next);
        if line == next {
            operations.push(operation);
        }
        Value { program: self, line }
    }
}

fn fold<'p>(values: &[Value<'p>], join: fn(Value<'p>, Value<'p>) -> Value<'p>) -> Option<Value<'p>> {
    match values {
        [] => None,
        [one] => Some(*one),
        _ => {
            let (left, right) = values.split_at(values.len() / 2);
            Some(join(fold(left, join)?, fold(right, join)?))
        }
    }
}

macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident)*) => {
        $($(#[$doc])* pub fn $name(self) -> Self { self.unary(stringify!($name)) })*
    };
}

impl<'p> Value<'p> {
    unary! {
        /// |a|
        abs
        /// a²
        square
        /// √a
        sqrt
        /// sin a, in radians
        sin
        /// cos a, in radians
        cos
        /// eᵃ
        exp
        /// ln a
        ln
    }

    /// The smaller of two: the union of solids.
    pub fn min(self, other: Self) -> Self {
        self.binary("min", other)
    }

    /// The larger of two: the intersection of solids.
    pub fn max(self, other: Self) -> Self {
        self.binary("max", other)
    }

    /// What is in this solid and not in the other.
    pub fn without(self, other: Self) -> Self {
        self.max(-other)
    }

    /// |a − centre| − half: negative between two planes.
    pub fn slab(self, centre: f64, half: f64) -> Self {
        (self - centre).abs() - half
    }

    /// √(a² + b²).
    pub fn hypot(self, other: Self) -> Self {
        (self.square() + other.square()).sqrt()
    }

    fn unary(self, name: &str) -> Self {
        self.program.line(format!("{name} _{:x}", self.line))
    }

    fn binary(self, name: &str, other: Self) -> Self {
        self.program.line(format!("{name} _{:x} _{:x}", self.line, other.line))
    }
}

impl Neg for Value<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self.unary("neg")
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident $name:literal;)*) => {
        $(
            impl $trait for Value<'_> {
                type Output = Self;

                fn $method(self, other: Self) -> Self {
                    self.binary($name, other)
                }
            }

            impl $trait<f64> for Value<'_> {
                type Output = Self;

                fn $method(self, constant: f64) -> Self {
                    self.binary($name, self.program.constant(constant))
                }
            }
        )*
    };
}
arithmetic! {
    Add add "add";
    Sub sub "sub";
    Mul mul "mul";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_operations_are_written_once() {
        let program = Program::new();
        let [x, ..] = program.point();
        let sum = x.square() + x.square();
        assert_eq!(program.text(sum), "_0 var-x\n_1 var-y\n_2 var-z\n_3 square _0\n_4 add _3 _3\n");
    }

    #[test]
    fn the_value_is_the_last_line() {
        let program = Program::new();
        let [x, y, _] = program.point();
        let _unused = y.sin();
        assert!(program.text(x).ends_with("_0 var-x\n"));
        assert!(program.text(program.constant(-1e-9)).ends_with("const 0\n"));
    }

    #[test]
    fn folds_are_flat() {
        let program = Program::new();
        let balls: Vec<Value> = (0..8).map(|i| program.constant(f64::from(i))).collect();
        let all = program.union(&balls).unwrap();
        let depth = |value: Value| program.text(value).lines().filter(|line| line.contains(" min ")).count();
        assert_eq!(depth(all), 7);
        assert!(program.text(all).ends_with("min _a _d\n"), "{}", program.text(all));
        assert!(program.union(&[]).is_none());
    }
}
