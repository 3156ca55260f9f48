//! Distributions of normals.

use crate::chance::{Chance, directions, integral};
use fieldstone_texel::{Flakes, Sggx, VisibleNormals, disc_point};
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Rough enough to be integrated by sums.
fn shapes() -> Vec<Sggx> {
    let mut chance = Chance(1);
    let mut shapes = vec![
        Sggx::ISOTROPIC,
        Sggx::surface(DVec3::new(0.6, 0.0, 0.8), 0.3),
        Sggx::fibre(DVec3::new(0.0, 0.8, 0.6), 0.2),
    ];
    for _ in 0..5 {
        let half_axes =
            DVec3::new(chance.between(0.3, 1.0), chance.between(0.3, 1.0), chance.between(0.3, 1.0));
        shapes.push(Sggx::ellipsoid(chance.rotation() * DMat3::from_diagonal(half_axes)));
    }
    shapes
}

#[test]
fn normals_add_up_to_the_projected_area() {
    let mut chance = Chance(2);
    for shape in shapes() {
        let (flakes, w) = (Flakes::new(&shape), chance.direction());
        let sum = integral(w, FRAC_PI_2, 1600, |n| n.dot(w).max(0.0) * flakes.normal_density(n));
        let area = flakes.projected_area(w);
        assert!((sum - area).abs() < 1e-6, "{shape:?}: {sum} beside {area}");
    }
}

#[test]
fn visible_normals_add_up_to_1() {
    let mut chance = Chance(3);
    for shape in shapes() {
        let (flakes, w) = (Flakes::new(&shape), chance.direction());
        let sum = integral(w, FRAC_PI_2, 1600, |n| flakes.visible_density(w, n));
        assert!((sum - 1.0).abs() < 1e-6, "{shape:?}: {sum}");
    }
}

/// χ² of the normals that stand at random points of the disc, over cells of the hemisphere with equal areas, divided by the degrees
/// of freedom; and these.
fn chi_square(flakes: &Flakes, sampled: &Flakes, w: DVec3, seed: u64) -> (f64, f64) {
    const HEIGHTS: usize = 12;
    const TURNS: usize = 24;
    let (x, y) = w.any_orthonormal_pair();
    let count = 200_000;
    let mut chance = Chance(seed);
    let visible = VisibleNormals::new(sampled, w);
    let mut hits = vec![0.0; HEIGHTS * TURNS];
    for _ in 0..count {
        let n = visible.at(disc_point([chance.unit(), chance.unit()]));
        let turn = n.dot(y).atan2(n.dot(x)) / (2.0 * PI) + 0.5;
        let cell = |share: f64, cells: usize| ((share * cells as f64) as usize).min(cells - 1);
        hits[cell(n.dot(w), HEIGHTS) * TURNS + cell(turn, TURNS)] += 1.0;
    }
    let (mut sum, mut cells) = (0.0, 0.0);
    for (cell, hits) in hits.iter().enumerate() {
        let (height, turn) = (cell / TURNS, cell % TURNS);
        let mut share = 0.0;
        let fine = 24;
        for i in 0..fine * fine {
            let at = |place: usize, part: usize| place as f64 + (part as f64 + 0.5) / fine as f64;
            let z = at(height, i / fine) / HEIGHTS as f64;
            let (sin, cos) = ((at(turn, i % fine) / TURNS as f64 - 0.5) * 2.0 * PI).sin_cos();
            share += flakes.visible_density(w, w * z + (x * cos + y * sin) * (1.0 - z * z).sqrt());
        }
        let expected = f64::from(count) * share * 2.0 * PI / (fine * fine * HEIGHTS * TURNS) as f64;
        if expected > 10.0 {
            sum += (hits - expected) * (hits - expected) / expected;
            cells += 1.0;
        }
    }
    (sum / (cells - 1.0), cells - 1.0)
}

#[test]
fn visible_normals_have_their_density() {
    let mut chance = Chance(4);
    for (seed, shape) in (0..).zip(shapes()) {
        let (flakes, w) = (Flakes::new(&shape), chance.direction());
        let (ratio, freedom) = chi_square(&flakes, &flakes, w, seed);
        // Four deviations of χ².
        let limit = 1.0 + 4.0 * (2.0 / freedom).sqrt();
        assert!(ratio < limit, "{shape:?}: {ratio} beside {limit}");
    }
}

#[test]
fn the_chi_square_test_rejects_other_normals() {
    let flakes = Flakes::new(&Sggx::surface(DVec3::Z, 0.5));
    let other = Flakes::new(&Sggx::surface(DVec3::Z, 0.53));
    let (ratio, freedom) = chi_square(&flakes, &other, DVec3::new(0.6, 0.0, 0.8), 9);
    assert!(ratio > 1.0 + 8.0 * (2.0 / freedom).sqrt(), "{ratio}");
}

fn greatest_difference(a: DMat3, b: DMat3) -> f64 {
    (a - b).to_cols_array().into_iter().fold(0.0, |most: f64, entry| most.max(entry.abs()))
}

#[test]
fn s_is_proportional_to_the_quadratic_form() {
    let mut chance = Chance(5);
    for _ in 0..20 {
        let half_axes =
            DVec3::new(chance.between(0.3, 2.0), chance.between(0.3, 2.0), chance.between(0.3, 2.0));
        let axes = chance.rotation() * DMat3::from_diagonal(half_axes);
        let inverse = axes * axes.transpose();
        let of_axes = Sggx::ellipsoid(axes);
        let of_form = Sggx::from_quadratic_form(inverse.inverse());
        let of_inverse = Sggx::from_inverse_form(inverse);
        assert!(greatest_difference(of_axes.matrix(), of_form.matrix()) < 1e-6, "{of_axes:?} {of_form:?}");
        assert!(
            greatest_difference(of_axes.matrix(), of_inverse.matrix()) < 1e-6,
            "{of_axes:?} {of_inverse:?}"
        );
        // And back.
        let back = Sggx::from_inverse_form(Flakes::new(&of_axes).inverse_form());
        assert!(greatest_difference(of_axes.matrix(), back.matrix()) < 1e-6, "{of_axes:?} {back:?}");
    }
}

/// Gauss's curvature: an ellipsoid with A = Q⁻¹ has det A / (nᵀ A n)² of surface per steradian of normals n.
#[test]
fn an_ellipsoid_has_the_normals_of_its_curvature() {
    let axes = Chance(6).rotation() * DMat3::from_diagonal(DVec3::new(0.4, 0.9, 1.7));
    let flakes = Flakes::new(&Sggx::ellipsoid(axes));
    let inverse = flakes.inverse_form();
    let determinant = inverse.determinant();
    for n in directions(200) {
        let surface = determinant / n.dot(inverse * n).powi(2);
        let density = PI * flakes.normal_density(n);
        assert!((surface - density).abs() < 1e-9 * surface, "{surface} {density}");
    }
}

#[test]
fn a_cylinder_is_the_limit_of_ellipsoids() {
    let form = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
    let flakes = Sggx::from_quadratic_form(form);
    assert!(greatest_difference(flakes.matrix(), Sggx::fibre(DVec3::Z, 0.0).matrix()) < 1e-6);
    let disc = Sggx::from_inverse_form(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)));
    assert!(greatest_difference(disc.matrix(), Sggx::surface(DVec3::Z, 0.0).matrix()) < 1e-6);
}

#[test]
fn flakes_are_fitted_to_their_own_normals() {
    let mut chance = Chance(7);
    // Normals of flakes seen from all directions in proportion to the projected areas: those of D.
    let shape = Sggx::ellipsoid(chance.rotation() * DMat3::from_diagonal(DVec3::new(0.5, 0.8, 1.2)));
    let flakes = Flakes::new(&shape);
    let mut normals = Vec::new();
    while normals.len() < 100_000 {
        let w = chance.direction();
        if chance.unit() < flakes.projected_area(w) / 2.0 {
            normals.push(VisibleNormals::new(&flakes, w).at(disc_point([chance.unit(), chance.unit()])));
        }
    }
    let fitted = Sggx::fitted(normals.iter().copied());
    assert!(greatest_difference(fitted.matrix(), shape.matrix()) < 0.02, "{fitted:?} {shape:?}");
}

#[test]
fn one_normal_is_fitted_by_a_flat_flake() {
    let n = DVec3::new(0.48, -0.6, 0.64);
    let fitted = Sggx::fitted(std::iter::repeat_n(n, 3));
    assert!(greatest_difference(fitted.matrix(), Sggx::surface(n, 0.0).matrix()) < 1e-5, "{fitted:?}");
    assert_eq!(Sggx::fitted(std::iter::empty()), Sggx::ISOTROPIC);
}

#[test]
fn rotations_turn_flakes() {
    let mut chance = Chance(8);
    let (rotation, n) = (chance.rotation(), chance.direction());
    let turned = Sggx::surface(n, 0.2).mapped(rotation);
    assert!(greatest_difference(turned.matrix(), Sggx::surface(rotation * n, 0.2).matrix()) < 1e-6);
}

/// A mapped ellipsoid is an ellipsoid.
#[test]
fn maps_of_space_map_the_surfaces_of_flakes() {
    let mut chance = Chance(9);
    let axes = chance.rotation() * DMat3::from_diagonal(DVec3::new(0.5, 0.8, 1.2));
    let map =
        DMat3::from_cols(DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.3, 0.7, 0.1), DVec3::new(0.0, -0.4, 1.5));
    let image = map * axes;
    let half_axes = Sggx::from_inverse_form(image * image.transpose());
    let mapped = Sggx::ellipsoid(axes).mapped(map).normalised();
    assert!(greatest_difference(half_axes.matrix(), mapped.matrix()) < 1e-5, "{half_axes:?} {mapped:?}");
}

#[test]
fn flat_and_broken_flakes_have_finite_densities() {
    let broken = [
        Sggx::surface(DVec3::Z, 0.0),
        Sggx::fibre(DVec3::X, 0.0),
        Sggx::from_entries([0.0; 6]),
        Sggx::from_entries([f32::NAN; 6]),
        Sggx::from_entries([1.0, 1.0, 1.0, 2.0, 2.0, 2.0]),
    ];
    for shape in broken {
        let flakes = Flakes::new(&shape);
        for w in directions(100).chain([DVec3::X, DVec3::Y, DVec3::Z]) {
            let n = VisibleNormals::new(&flakes, w).at([0.3, -0.6]);
            assert!((n.length() - 1.0).abs() < 1e-9 && n.dot(w) > -1e-9, "{shape:?} {w}: {n}");
            let density = flakes.visible_density(w, n);
            assert!(density.is_finite() && density >= 0.0, "{shape:?} {w}: {density}");
        }
    }
}
