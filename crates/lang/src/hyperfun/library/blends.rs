//! Set operations with added or removed material.

use super::call::{Call, Outcome};
use super::expression::Expr;

/// hfBlendUni: the R-union and Pasko's displacement.
pub(super) fn union<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f1, f2] = call.reals(0);
    Ok(f1.rmax(f2) + displacement(call))
}

/// hfBlendInt: the R-intersection and Pasko's displacement.
pub(super) fn intersection<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f1, f2] = call.reals(0);
    Ok(f1.rmin(f2) + displacement(call))
}

/// a₀ / (1 + (f₁/a₁)² + (f₂/a₂)²).
fn displacement<'g>(call: &Call<'g>) -> Expr<'g> {
    let [f1, f2, a0, a1, a2] = call.reals(0);
    a0 / (1.0 + (f1 / a1).square() + (f2 / a2).square())
}
