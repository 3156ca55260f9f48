//! How the values of each domain lie in rows.

use super::LANES;
use crate::affine::Affine;
use crate::domain::Domain;
use crate::dual::Dual;
use crate::interval::Interval;
use crate::real::Real;

/// A domain whose values lie in rows, one for each component.
pub trait Rows: Domain {
    /// How many numbers make a value.
    const COMPONENTS: usize;

    /// Reads the lanes from `lane` on.
    fn load(token: Token<Self>, rows: &[ScalarOf<Self>], lane: usize) -> Self;
    /// Writes the lanes from `lane` on.
    fn store(self, rows: &mut [ScalarOf<Self>], lane: usize);
    /// The range, where the domain records choices.
    fn range(self) -> Option<Interval<Self::Real>> {
        None
    }
}

type Token<D> = <<D as Domain>::Real as Real>::Token;
type ScalarOf<D> = <<D as Domain>::Real as Real>::Scalar;

impl<R: Real> Rows for R {
    const COMPONENTS: usize = 1;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        <R as Real>::load(token, &rows[lane..])
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        Real::store(self, &mut rows[lane..]);
    }
}

#[inline(always)]
fn row<R: Real>(token: R::Token, rows: &[R::Scalar], start: usize) -> R {
    <R as Real>::load(token, &rows[start..])
}

impl<R: Real> Rows for Interval<R> {
    const COMPONENTS: usize = 2;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self { lo: row(token, rows, lane), hi: row(token, rows, lane + LANES) }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        Real::store(self.lo, &mut rows[lane..]);
        Real::store(self.hi, &mut rows[LANES + lane..]);
    }
    #[inline(always)]
    fn range(self) -> Option<Interval<R>> {
        Some(self)
    }
}

impl<R: Real> Rows for Affine<R> {
    const COMPONENTS: usize = 5;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self {
            centre: row(token, rows, lane),
            slope: row(token, rows, lane + LANES),
            error: row(token, rows, lane + 2 * LANES),
            range: Interval {
                lo: row(token, rows, lane + 3 * LANES),
                hi: row(token, rows, lane + 4 * LANES),
            },
        }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        // One by one: a loop over an array of them goes through memory.
        Real::store(self.centre, &mut rows[lane..]);
        Real::store(self.slope, &mut rows[LANES + lane..]);
        Real::store(self.error, &mut rows[2 * LANES + lane..]);
        Real::store(self.range.lo, &mut rows[3 * LANES + lane..]);
        Real::store(self.range.hi, &mut rows[4 * LANES + lane..]);
    }
}

impl<R: Real> Rows for Dual<R> {
    const COMPONENTS: usize = 4;

    #[inline(always)]
    fn load(token: R::Token, rows: &[R::Scalar], lane: usize) -> Self {
        Self {
            value: row(token, rows, lane),
            gradient: [
                row(token, rows, lane + LANES),
                row(token, rows, lane + 2 * LANES),
                row(token, rows, lane + 3 * LANES),
            ],
        }
    }
    #[inline(always)]
    fn store(self, rows: &mut [R::Scalar], lane: usize) {
        let [x, y, z] = self.gradient;
        Real::store(self.value, &mut rows[lane..]);
        Real::store(x, &mut rows[LANES + lane..]);
        Real::store(y, &mut rows[2 * LANES + lane..]);
        Real::store(z, &mut rows[3 * LANES + lane..]);
    }
}
