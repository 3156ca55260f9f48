//! Sums and products with their rounding errors (Dekker 1971).

use crate::real::Double;

/// high + low, a few units in the last place of `high`: about twice as many digits.
#[derive(Clone, Copy)]
pub(super) struct Pair<R> {
    pub(super) high: R,
    pub(super) low: R,
}

impl<R: Double> Pair<R> {
    /// Two parts of a constant.
    #[inline(always)]
    pub(super) fn constant(like: R, parts: [f64; 2]) -> Self {
        Self { high: like.like(parts[0]), low: like.like(parts[1]) }
    }

    /// a + b exactly; |a| ≥ |b| or a = 0.
    #[inline(always)]
    pub(super) fn ordered_sum(a: R, b: R) -> Self {
        let high = a + b;
        Self { high, low: (a - high) + b }
    }

    /// a + b exactly (Knuth 1969).
    #[inline(always)]
    pub(super) fn sum(a: R, b: R) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// a·b exactly, where no part of it underflows.
    #[inline(always)]
    pub(super) fn product(a: R, b: R) -> Self {
        let high = a * b;
        Self { high, low: a.product_error(b, high) }
    }

    /// The product of two pairs, to a few units of 2⁻¹⁰⁴.
    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Self { high: product.high, low: product.low + cross }
    }

    /// The quotient of two pairs: a first quotient, and what it leaves over.
    #[inline(always)]
    pub(super) fn over(self, divisor: Self) -> Self {
        let inverse = divisor.high.like(1.0) / divisor.high;
        let high = self.high * inverse;
        let back = Self::product(high, divisor.high);
        let rest = ((self.high - back.high) - back.low) + (self.low - high * divisor.low);
        Self { high, low: rest * inverse }
    }
}
