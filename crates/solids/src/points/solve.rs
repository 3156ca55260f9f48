//! The systems of equations behind sums of radial functions.

use super::kernel::Kernel;
use super::sum::{Plane, Sum};
use nalgebra::{DMatrix, DVector};

/// Conjugate gradients end after so many steps.
const MOST_STEPS: usize = 1000;
/// And when the largest error is so small a part of the largest value.
const SMALL: f64 = 1e-9;

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The triharmonic spline with these values; `None` where there is none. Coordinates are scaled to a size of 1 on the
/// way, so that the parts of the matrix are comparable.
pub(super) fn dense(places: &[[f64; 3]], values: &[f64], smoothing: f64) -> Option<Sum> {
    let kernel = Kernel::Triharmonic;
    let count = places.len();
    let origin = [0, 1, 2].map(|k| places.iter().map(|p| p[k]).sum::<f64>() / count as f64);
    let size = places.iter().map(|p| distance(p, &origin)).fold(0.0, f64::max);
    let local: Vec<[f64; 3]> = places.iter().map(|p| [0, 1, 2].map(|k| (p[k] - origin[k]) / size)).collect();
    let plane = |p: &[f64; 3], k: usize| if k == 0 { 1.0 } else { p[k - 1] };
    let matrix = DMatrix::from_fn(count + 4, count + 4, |i, j| match (i < count, j < count) {
        (true, true) if i == j => smoothing,
        (true, true) => kernel.value(distance(&local[i], &local[j])),
        (true, false) => plane(&local[i], j - count),
        (false, true) => plane(&local[j], i - count),
        (false, false) => 0.0,
    });
    let right = DVector::from_fn(count + 4, |i, _| values.get(i).copied().unwrap_or(0.0));
    let solution = matrix.clone().lu().solve(&right)?;
    let error = (&matrix * &solution - &right).amax();
    if error.is_nan() || error > 1e-6 * right.amax() {
        return None;
    }
    let weights = solution.iter().take(count).map(|w| w / size.powi(3)).collect();
    let linear = [1, 2, 3].map(|k| solution[count + k] / size);
    let plane = Plane { constant: solution[count], linear, origin };
    Some(Sum::new(kernel, places.to_vec(), weights, plane))
}

/// The sum of Wendland's functions with these values, as closely as [`SMALL`] says; the matrix is positive definite.
pub(super) fn sparse(places: &[[f64; 3]], values: &[f64], support: f64, smoothing: f64) -> Sum {
    let kernel = Kernel::Wendland { support };
    let sum = |weights: Vec<f64>| Sum::new(kernel, places.to_vec(), weights, Plane::default());
    let empty = sum(vec![0.0; places.len()]);
    let row = |i: usize| {
        let mut row = Vec::new();
        empty.near(places[i], support, |j| {
            let entry = kernel.value(distance(&places[i], &places[j]));
            if i == j {
                row.push((j, 1.0 + smoothing));
            } else if entry > 0.0 {
                row.push((j, entry));
            }
        });
        row
    };
    let rows: Vec<Vec<(usize, f64)>> = (0..places.len()).map(row).collect();
    let times = |v: &[f64]| -> Vec<f64> {
        rows.iter().map(|row| row.iter().map(|(j, entry)| entry * v[*j]).sum()).collect()
    };
    sum(conjugate_gradients(times, values))
}

/// Solves A x = b for a symmetric positive definite A (Hestenes and Stiefel 1952).
fn conjugate_gradients(times: impl Fn(&[f64]) -> Vec<f64>, right: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let largest = |v: &[f64]| v.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let (mut solution, mut residual) = (vec![0.0; right.len()], right.to_vec());
    let mut direction = residual.clone();
    let mut squared = dot(&residual, &residual);
    let enough = SMALL * largest(right);
    for _ in 0..MOST_STEPS {
        if largest(&residual) <= enough {
            break;
        }
        let image = times(&direction);
        let step = squared / dot(&direction, &image);
        if !step.is_finite() {
            break;
        }
        for i in 0..right.len() {
            solution[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = dot(&residual, &residual);
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = r + next / squared * *d;
        }
        squared = next;
    }
    solution
}
