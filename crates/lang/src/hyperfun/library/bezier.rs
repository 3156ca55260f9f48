//! hfBezierVolume: a solid with a polynomial in Bernstein form inside a box.

use super::call::{Call, Outcome};
use super::expression::Expr;

/// The largest number of control points in a direction.
const MOST_POINTS: usize = 21;

/// hfBezierVolume. The first direction of the control points runs along x, the second along z, the third along y.
pub(super) fn volume<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let x = call.point(0)?.0;
    let [l, m, n] = [point_count(call, 1)?, point_count(call, 2)?, point_count(call, 3)?];
    let bounds = call.array_of(4, 6)?;
    let control = call.array_of(5, l * m * n)?;

    let [u, w, v] = [0, 1, 2].map(|k| (x[k] - bounds[k]) / (bounds[k + 3] - bounds[k]));
    let (along_u, along_v, along_w) = (bernstein(u, l), bernstein(v, m), bernstein(w, n));
    let row = |first: usize| call.sum((0..n).map(|k| control[first + k] * along_w[k]));
    let sheet = |first: usize| call.sum((0..m).map(|j| row(first + j * n) * along_v[j]));
    let polynomial = call.sum((0..l).map(|i| sheet(i * m * n) * along_u[i]));

    let [bx, by, bz] = [0, 1, 2].map(|k| (bounds[k + 3] - x[k]) * (x[k] - bounds[k]));
    Ok(bx.rmin(by).rmin(bz).rmin(polynomial))
}

fn point_count(call: &Call<'_>, index: usize) -> Result<usize, String> {
    let count = call.constant(index)?;
    if count.trunc() == count && (1.0..=MOST_POINTS as f64).contains(&count) {
        return Ok(count as usize);
    }
    Err(format!("`{}` must be a whole number from 1 to {MOST_POINTS}, not {count}", call.name(index)))
}

/// The Bernstein polynomials for `count` control points, of degree `count` − 1.
fn bernstein(t: Expr<'_>, count: usize) -> Vec<Expr<'_>> {
    let mut binomial = 1.0;
    let mut basis = Vec::with_capacity(count);
    for i in 0..count {
        let rest = count - 1 - i;
        basis.push(binomial * (t.powi(i) * (1.0 - t).powi(rest)));
        binomial *= rest as f64 / (i + 1) as f64;
    }
    basis
}
