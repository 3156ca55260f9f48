//! Symmetric 3×3 matrices.

use glam::{DMat3, DVec3};

/// The adjugate of a symmetric matrix: the products of its columns.
pub(crate) fn adjugate(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

/// Unit eigenvectors of a symmetric matrix, as columns at right angles to each other, in no order (Jacobi's method).
pub(crate) fn eigenvectors(symmetric: DMat3) -> DMat3 {
    let mut vectors = DMat3::IDENTITY;
    let mut m = symmetric;
    // The entries beside the diagonal fall quadratically: few turns are needed.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let rotation = jacobi_rotation(m, p, q);
            m = rotation.transpose() * m * rotation;
            vectors *= rotation;
        }
    }
    vectors
}

/// The rotation about the third axis that brings the entry of the axes p and q to 0.
fn jacobi_rotation(m: DMat3, p: usize, q: usize) -> DMat3 {
    let beside = m.col(q)[p];
    let scale = m.col(p)[p].abs().max(m.col(q)[q].abs());
    if beside.abs() <= f64::EPSILON * f64::EPSILON * scale {
        return DMat3::IDENTITY;
    }
    let ratio = (m.col(q)[q] - m.col(p)[p]) / (2.0 * beside);
    let tangent = 1.0f64.copysign(ratio) / (ratio.abs() + ratio.hypot(1.0));
    let cos = tangent.hypot(1.0).recip();
    let sin = tangent * cos;
    let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
    columns[p][p] = cos;
    columns[p][q] = -sin;
    columns[q][p] = sin;
    columns[q][q] = cos;
    DMat3::from_cols(columns[0], columns[1], columns[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_make_a_matrix_diagonal() {
        let rows = [[2.0, 0.3, -0.7], [0.3, 0.9, 0.2], [-0.7, 0.2, 1.1]];
        let m = DMat3::from_cols_array_2d(&rows);
        let vectors = eigenvectors(m);
        let diagonal = vectors.transpose() * m * vectors;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            assert!(diagonal.col(q)[p].abs() < 1e-14, "{diagonal}");
        }
        assert!(
            (vectors.transpose() * vectors - DMat3::IDENTITY)
                .abs()
                .to_cols_array()
                .iter()
                .all(|e| *e < 1e-14)
        );
    }

    #[test]
    fn the_adjugate_times_the_matrix_is_the_determinant() {
        let m = DMat3::from_cols_array_2d(&[[2.0, 0.3, -0.7], [0.3, 0.9, 0.2], [-0.7, 0.2, 1.1]]);
        let product = adjugate(m) * m - DMat3::IDENTITY * m.determinant();
        assert!(product.to_cols_array().iter().all(|e| e.abs() < 1e-14), "{product}");
    }
}
