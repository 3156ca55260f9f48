//! Sums of soft balls. The cut-off kernels are polynomials in a clamped radius, written so that each of their terms
//! decreases: over intervals they are then exact.

use super::call::{Call, Outcome};
use super::expression::Expr;
use crate::Dialect;

/// hfBlobby: Σ bᵢ exp(−aᵢ rᵢ²) − T.
pub(super) fn blobby<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let squares = squared_distances(call, 1)?;
    let (a, b) = (call.array_of(4, squares.len())?, call.array_of(5, squares.len())?);
    let balls = (0..squares.len()).map(|i| b[i] * (-(a[i] * squares[i])).exp());
    Ok(call.sum(balls) - call.real(6))
}

/// hfMetaball: Nishimura's kernel with amplitudes b and ranges d. Balls with d ≤ 0 do not count.
///
/// With ρ = min(r/d, 1) both pieces of the kernel, 1 − 3ρ² up to ρ = 1/3 and 3/2·(1 − ρ)² from there, are
/// 3(1/9 − min(ρ², 1/9)) + 3/2·(1 − max(ρ, 1/3))².
pub(super) fn metaball<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let squares = squared_distances(call, 1)?;
    let (b, d) = (call.array_of(4, squares.len())?, call.array_of(5, squares.len())?);
    let balls = (0..squares.len()).map(|i| {
        let ratio_squared = (squares[i] / d[i].square()).min(1.0);
        let core = 3.0 * (1.0 / 9.0 - ratio_squared.min(1.0 / 9.0));
        let skirt = 1.5 * (1.0 - ratio_squared.sqrt().max(1.0 / 3.0)).square();
        d[i].le(0.0).select(0.0, b[i] * (core + skirt))
    });
    Ok(call.sum(balls) - call.real(6))
}

/// hfSoft: the Wyvill kernel 1 − 22/9·t + 17/9·t² − 4/9·t³ of t = (r/d)² up to r = d.
///
/// Written (1 − t)²(1 − 4/9·t), which is 0 at the range.
pub(super) fn soft<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let squares = squared_distances(call, 1)?;
    let d = call.array_of(4, squares.len())?;
    let balls = (0..squares.len()).map(|i| {
        let t = (squares[i] / d[i].square()).min(1.0);
        d[i].le(0.0).select(0.0, (1.0 - t).square() * (1.0 - 4.0 / 9.0 * t))
    });
    Ok(call.sum(balls) - call.real(5))
}

/// hfFMapBlob: an object with dents, f − Σ f₀ᵢ/(1 + rᵢ²/σᵢ²); dents with σ ≤ 10⁻⁶ do not count.
pub(super) fn mapped_blob<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    if call.dialect == Dialect::Strict {
        return Err(String::from("the C interpreter has no such function").into());
    }
    let squares = squared_distances(call, 2)?;
    let (heights, widths) = (call.array_of(5, squares.len())?, call.array_of(6, squares.len())?);
    let dents = (0..squares.len()).map(|i| {
        let dent = heights[i] / (1.0 + squares[i] / widths[i].square());
        widths[i].le(1e-6).select(0.0, dent)
    });
    Ok(call.real(1) - call.sum(dents))
}

/// The squares of the distances of the point from the centres whose coordinates start at argument `first`.
fn squared_distances<'g>(call: &Call<'g>, first: usize) -> Result<Vec<Expr<'g>>, super::call::Failure> {
    let x = call.point(0)?;
    Ok(call.centers(first)?.into_iter().map(|center| (x - center).squared()).collect())
}
