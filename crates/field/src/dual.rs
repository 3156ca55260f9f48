//! Dual numbers: a value with its partial derivatives, over any domain.

use crate::domain::Domain;
use crate::{Function, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An array of the three values of an expression in `$i`; a closure might not be compiled into the evaluator.
macro_rules! each {
    ($i:ident => $value:expr) => {
        [
            {
                let $i = 0;
                $value
            },
            {
                let $i = 1;
                $value
            },
            {
                let $i = 2;
                $value
            },
        ]
    };
}

/// A value and its derivatives along three directions, exact to rounding.
///
/// Where a function has a kink, the derivative is that of one side; where it is undefined, so is the derivative.
#[derive(Clone, Copy, Debug)]
pub struct Dual<D> {
    /// The value.
    pub value: D,
    /// Its partial derivatives.
    pub gradient: [D; 3],
}

type Token<D> = <<D as Domain>::Real as Real>::Token;

impl<D: Domain> Dual<D> {
    #[inline(always)]
    fn k(self, k: f64) -> D {
        D::constant(self.value.token(), k)
    }

    /// The image of a function with this value and derivative.
    #[inline(always)]
    fn chain(self, value: D, derivative: D) -> Self {
        Self { value, gradient: each!(i => derivative * self.gradient[i]) }
    }

    /// The image of a function of two values.
    #[inline(always)]
    fn chain2(self, other: Self, value: D, by_first: D, by_second: D) -> Self {
        Self { value, gradient: each!(i => by_first * self.gradient[i] + by_second * other.gradient[i]) }
    }

    /// A value that does not change.
    #[inline(always)]
    fn flat(self, value: D) -> Self {
        let zero = self.k(0.0);
        Self { value, gradient: [zero; 3] }
    }

    /// The gradient of this or the other, as the condition says.
    #[inline(always)]
    fn either(self, other: Self, condition: D, value: D) -> Self {
        let t = self.value.token();
        Self { value, gradient: each!(i => condition.select(self.gradient[i], other.gradient[i], t)) }
    }
}

impl<D: Domain> Add for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, gradient: each!(i => self.gradient[i] + other.gradient[i]) }
    }
}

impl<D: Domain> Sub for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, gradient: each!(i => self.gradient[i] - other.gradient[i]) }
    }
}

impl<D: Domain> Mul for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, other.value, self.value)
    }
}

impl<D: Domain> Div for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = Domain::div(self.value, other.value);
        let by_first = other.value.recip();
        self.chain2(other, quotient, by_first, -(quotient * by_first))
    }
}

impl<D: Domain> Neg for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, gradient: each!(i => -self.gradient[i]) }
    }
}

impl<D: Domain> Domain for Dual<D> {
    type Real = D::Real;
    const IS_SET: bool = D::IS_SET;

    #[inline(always)]
    fn token(self) -> Token<D> {
        self.value.token()
    }
    #[inline(always)]
    fn constant(token: Token<D>, k: f64) -> Self {
        Self { value: D::constant(token, k), gradient: [D::constant(token, 0.0); 3] }
    }
    #[inline(always)]
    fn undefined(token: Token<D>) -> Self {
        Self { value: D::undefined(token), gradient: [D::undefined(token); 3] }
    }
    #[inline(always)]
    fn truth(self) -> (<D::Real as Real>::Mask, <D::Real as Real>::Mask) {
        self.value.truth()
    }
    #[inline(always)]
    fn is_undefined(self) -> <D::Real as Real>::Mask {
        self.value.is_undefined()
    }
    #[inline(always)]
    fn choose(mask: <D::Real as Real>::Mask, a: Self, b: Self) -> Self {
        Self {
            value: D::choose(mask, a.value, b.value),
            gradient: each!(i => D::choose(mask, a.gradient[i], b.gradient[i])),
        }
    }
    #[inline(always)]
    fn join(self, other: Self) -> Self {
        Self {
            value: self.value.join(other.value),
            gradient: each!(i => self.gradient[i].join(other.gradient[i])),
        }
    }
    /// Derivatives of called functions are taken lane by lane; over sets they are undefined.
    fn call(function: &dyn Function, arguments: &[Self], token: Token<D>) -> Self {
        let values: Vec<D> = arguments.iter().map(|a| a.value).collect();
        let value = D::call(function, &values, token);
        let gradient = [0, 1, 2].map(|axis| {
            let slopes: Vec<D> = arguments.iter().map(|a| a.gradient[axis]).collect();
            D::call_derivative(function, &values, &slopes, token)
        });
        Self { value, gradient }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.sign())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, (root + root).recip())
    }
    #[inline(always)]
    fn square(self) -> Self {
        self.chain(self.value.square(), self.value + self.value)
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        self.chain(self.value.powi(n), self.k(f64::from(n)) * self.value.powi(n - 1))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let r = self.value.recip();
        self.chain(r, -r.square())
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    #[inline(always)]
    fn tan(self) -> Self {
        let t = self.value.tan();
        self.chain(t, self.k(1.0) + t.square())
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.chain(self.value.asin(), (self.k(1.0) - self.value.square()).sqrt().recip())
    }
    #[inline(always)]
    fn acos(self) -> Self {
        self.chain(self.value.acos(), -(self.k(1.0) - self.value.square()).sqrt().recip())
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.chain(self.value.atan(), (self.k(1.0) + self.value.square()).recip())
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        let t = self.value.tanh();
        self.chain(t, self.k(1.0) - t.square())
    }
    #[inline(always)]
    fn atanh(self) -> Self {
        self.chain(self.value.atanh(), (self.k(1.0) - self.value.square()).recip())
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.flat(self.value.floor())
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        self.flat(self.value.ceil())
    }
    #[inline(always)]
    fn round(self) -> Self {
        self.flat(self.value.round())
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        self.flat(self.value.trunc())
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.flat(self.value.sign())
    }
    #[inline(always)]
    fn not(self) -> Self {
        self.flat(self.value.not())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.either(other, self.value.lt(other.value), self.value.min(other.value))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        other.either(self, self.value.lt(other.value), self.value.max(other.value))
    }
    /// At f = g = 0, where the derivative does not exist, that of f = g.
    #[inline(always)]
    fn rmin(self, other: Self) -> Self {
        let length = (self.value.square() + other.value.square()).sqrt();
        let one = self.k(1.0);
        let (u, v) = (one - self.value / length, one - other.value / length);
        let both_zero = length.not();
        let t = self.value.token();
        let kink = self.k(1.0 - std::f64::consts::FRAC_1_SQRT_2);
        let (u, v) = (both_zero.select(kink, u, t), both_zero.select(kink, v, t));
        self.chain2(other, self.value.rmin(other.value), u, v)
    }
    #[inline(always)]
    fn rmax(self, other: Self) -> Self {
        -Domain::rmin(-self, -other)
    }
    #[inline(always)]
    fn pow(self, other: Self) -> Self {
        let power = self.value.pow(other.value);
        let by_base = other.value * self.value.pow(other.value - self.k(1.0));
        let by_exponent = power * self.value.ln();
        // A constant exponent needs no logarithm of the base, which may be negative.
        let t = self.value.token();
        Self {
            value: power,
            gradient: each!(i => {
                let exponent_part = other.gradient[i].select(by_exponent * other.gradient[i], self.k(0.0), t);
                by_base * self.gradient[i] + exponent_part
            }),
        }
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let scale = (self.value.square() + other.value.square()).recip();
        self.chain2(other, self.value.atan2(other.value), other.value * scale, -(self.value * scale))
    }
    #[inline(always)]
    fn rem(self, other: Self) -> Self {
        let turns = (self.value / other.value).trunc();
        self.chain2(other, self.value.rem(other.value), self.k(1.0), -turns)
    }
    #[inline(always)]
    fn modulo(self, other: Self) -> Self {
        let size = other.value.abs();
        let turns = (self.value / size).floor() * other.value.sign();
        self.chain2(other, self.value.modulo(other.value), self.k(1.0), -turns)
    }
    #[inline(always)]
    fn compare(self, other: Self) -> Self {
        self.flat(self.value.compare(other.value))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        self.flat(self.value.lt(other.value))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self {
        self.flat(self.value.le(other.value))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self {
        self.flat(self.value.eq(other.value))
    }
}
