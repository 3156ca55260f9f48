//! The table of operations: every operation of a field program is declared here once.
//!
//! A row names the operation, the method of [`Domain`](crate::Domain) that gives it its meaning, and its text name.
//! Enumerations, dispatch, constant folding and the conformance tests are all generated from the rows, so that a
//! new operation is one row here and one method in each domain, which the compiler asks for.

use std::fmt;

/// Calls a macro with the rows of all unary operations.
#[macro_export]
#[doc(hidden)]
macro_rules! for_each_unary {
    ($callback:ident) => {
        $callback! {
            /// −a.
            Neg neg "neg",
            /// |a|.
            Abs abs "abs",
            /// √a; undefined for a < 0.
            Sqrt sqrt "sqrt",
            /// a².
            Square square "square",
            /// 1/a.
            Recip recip "recip",
            /// eᵃ.
            Exp exp "exp",
            /// Natural logarithm; undefined for a < 0, −∞ at 0.
            Ln ln "ln",
            /// Sine of an angle in radians.
            Sin sin "sin",
            /// Cosine of an angle in radians.
            Cos cos "cos",
            /// Tangent of an angle in radians.
            Tan tan "tan",
            /// Arc sine in radians; undefined outside \[−1, 1\].
            Asin asin "asin",
            /// Arc cosine in radians; undefined outside \[−1, 1\].
            Acos acos "acos",
            /// Arc tangent in radians.
            Atan atan "atan",
            /// Hyperbolic sine.
            Sinh sinh "sinh",
            /// Hyperbolic cosine.
            Cosh cosh "cosh",
            /// Hyperbolic tangent.
            Tanh tanh "tanh",
            /// Inverse hyperbolic tangent; undefined outside \[−1, 1\].
            Atanh atanh "atanh",
            /// Largest whole number ≤ a.
            Floor floor "floor",
            /// Smallest whole number ≥ a.
            Ceil ceil "ceil",
            /// Nearest whole number, halves away from zero.
            Round round "round",
            /// Nearest whole number towards zero.
            Trunc trunc "trunc",
            /// −1, 0 or 1.
            Sign sign "sign",
            /// 1 if a = 0, otherwise 0.
            Not not "not",
        }
    };
}

/// Calls a macro with the rows of all binary operations.
#[macro_export]
#[doc(hidden)]
macro_rules! for_each_binary {
    ($callback:ident) => {
        $callback! {
            /// a + b.
            Add add "add",
            /// a − b.
            Sub sub "sub",
            /// a · b.
            Mul mul "mul",
            /// a / b.
            Div div "div",
            /// The smaller; undefined if either is.
            Min min "min",
            /// The larger; undefined if either is.
            Max max "max",
            /// a + b − √(a² + b²): the R-union in the sign f < 0 inside (the R-intersection where f > 0 is inside).
            RMin rmin "rmin",
            /// a + b + √(a² + b²): the R-intersection in the sign f < 0 inside (the R-union where f > 0 is inside).
            RMax rmax "rmax",
            /// aᵇ; undefined for a < 0 and b not whole.
            Pow pow "pow",
            /// Angle of the point (x, y) = (b, a) in radians, in \[−π, π\].
            Atan2 atan2 "atan2",
            /// a − b·trunc(a/b): the remainder with the sign of a.
            Rem rem "rem",
            /// a − |b|·floor(a/|b|): the remainder that is never negative.
            Modulo modulo "mod",
            /// −1, 0 or 1 as a is below, at or above b.
            Compare compare "compare",
            /// 1 if a < b, otherwise 0.
            Lt lt "lt",
            /// 1 if a ≤ b, otherwise 0.
            Le le "le",
            /// 1 if a = b, otherwise 0.
            Eq eq "eq",
        }
    };
}

macro_rules! declare_unary {
    ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
        /// An operation with one operand.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Unary { $($(#[$doc])* $variant,)* }

        impl Unary {
            /// All unary operations, in the order of the table.
            pub const ALL: &[Unary] = &[$(Unary::$variant,)*];

            /// The name in program listings and `.vm` files.
            pub fn name(self) -> &'static str {
                match self { $(Unary::$variant => $name,)* }
            }

            /// The meaning of the operation in a domain.
            #[inline(always)]
            pub fn apply<D: crate::Domain>(self, a: D) -> D {
                match self { $(Unary::$variant => crate::Domain::$method(a),)* }
            }
        }
    };
}
for_each_unary!(declare_unary);

macro_rules! declare_binary {
    ($($(#[$doc:meta])* $variant:ident $method:ident $name:literal,)*) => {
        /// An operation with two operands.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Binary { $($(#[$doc])* $variant,)* }

        impl Binary {
            /// All binary operations, in the order of the table.
            pub const ALL: &[Binary] = &[$(Binary::$variant,)*];

            /// The name in program listings and `.vm` files.
            pub fn name(self) -> &'static str {
                match self { $(Binary::$variant => $name,)* }
            }

            /// The meaning of the operation in a domain.
            #[inline(always)]
            pub fn apply<D: crate::Domain>(self, a: D, b: D) -> D {
                match self { $(Binary::$variant => crate::Domain::$method(a, b),)* }
            }
        }
    };
}
for_each_binary!(declare_binary);

impl Unary {
    /// Whether it takes a few instructions of the processor, and no function of a library.
    pub(crate) fn is_cheap(self) -> bool {
        use Unary::*;
        !matches!(self, Exp | Ln | Sin | Cos | Tan | Asin | Acos | Atan | Sinh | Cosh | Tanh | Atanh)
    }
}

impl Binary {
    /// Whether exchanging the operands changes nothing.
    pub fn is_commutative(self) -> bool {
        use Binary::*;
        matches!(self, Add | Mul | Min | Max | RMin | RMax | Eq)
    }
}

impl fmt::Display for Unary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Binary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
