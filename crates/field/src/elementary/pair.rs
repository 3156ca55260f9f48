//! Sums and products with their rounding errors (Dekker 1971).

use crate::real::Double;

/// high + low, |low| ≤ ulp(high): about twice as many digits.
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

    /// a·b, to one unit of 2⁻¹⁰⁵, where no part of it underflows.
    #[inline(always)]
    pub(super) fn product(a: R, b: R) -> Self {
        let high = a * b;
        let (a_high, b_high) = (a.high_part(), b.high_part());
        let (a_low, b_low) = (a - a_high, b - b_high);
        let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
        Self { high, low }
    }

    /// The product of two pairs, to a few units of 2⁻¹⁰⁴.
    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Self::ordered_sum(product.high, product.low + cross)
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
