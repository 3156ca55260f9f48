//! Affine forms without the interval: after every operation the range is what the line says.

use fieldstone_field::{Affine, Domain, Function, Interval};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A form whose range is that of its line, wherever it has one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unmixed(Affine<f64>);

impl Unmixed {
    /// Forgets the interval.
    pub(crate) fn new(form: Affine<f64>) -> Self {
        let reach = form.slope.abs() + form.error;
        let line = Interval::new((form.centre - reach).next_down(), (form.centre + reach).next_up());
        let range = if reach.is_finite() { line } else { form.range };
        Self(Affine { range, ..form })
    }

    /// The range of the line.
    pub(crate) fn range(self) -> Interval<f64> {
        self.0.range
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for Unmixed {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::new($trait::$method(self.0, other.0))
            }
        }
    )*};
}
operator!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Unmixed {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.0)
    }
}

macro_rules! unary {
    ($($method:ident)*) => {$(
        fn $method(self) -> Self {
            Self::new(Domain::$method(self.0))
        }
    )*};
}

macro_rules! binary {
    ($($method:ident)*) => {$(
        fn $method(self, other: Self) -> Self {
            Self::new(Domain::$method(self.0, other.0))
        }
    )*};
}

impl Domain for Unmixed {
    type Real = f64;
    const IS_SET: bool = true;

    fn token(self) {}
    fn constant((): (), k: f64) -> Self {
        Self::new(Domain::constant((), k))
    }
    fn undefined((): ()) -> Self {
        Self(Domain::undefined(()))
    }
    fn truth(self) -> (bool, bool) {
        self.0.truth()
    }
    fn is_undefined(self) -> bool {
        self.0.is_undefined()
    }
    fn choose(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    fn join(self, other: Self) -> Self {
        Self::new(self.0.join(other.0))
    }
    fn call(function: &dyn Function, arguments: &[Self], (): ()) -> Self {
        let forms: Vec<Affine<f64>> = arguments.iter().map(|a| a.0).collect();
        Self::new(Domain::call(function, &forms, ()))
    }
    fn powi(self, n: i32) -> Self {
        Self::new(self.0.powi(n))
    }

    unary!(abs sqrt square recip exp ln sin cos tan asin acos atan sinh cosh tanh atanh floor ceil round trunc sign not);
    binary!(min max rmin rmax pow atan2 rem modulo compare lt le eq);
}
