//! How wrong joined flakes are: the mean of S, and Neyret's mean of inverse quadratic forms, beside the exact projected
//! areas.
//!
//! Shapes are normalised to a mean apparent area of 1 along their three axes, as in the paper of 1995. Errors are those of the
//! projected area over all directions, in per cent of its mean: root mean square, and greatest.

use crate::chance::{Chance, directions};
use fieldstone_texel::{Builder, Mode, Sggx, Texel};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// How thin flat and thin shapes are.
const THIN: f64 = 1e-3;

/// An inverse quadratic form A = Q⁻¹, and how much there is of it.
type Shape = (DMat3, f64);

/// The rules by which shapes are joined.
#[derive(Clone, Copy, Debug)]
enum Rule {
    /// The mean of S.
    Mean,
    /// The same, scaled so that the mean projected area is exact.
    Scaled,
    /// The mean of A.
    Inverse,
    /// The same, normalised again.
    Renormalised,
}

const RULES: [Rule; 4] = [Rule::Mean, Rule::Scaled, Rule::Inverse, Rule::Renormalised];

fn adjugate(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn ellipsoid(turn: DMat3, half_axes: [f64; 3]) -> Shape {
    let axes = turn * DMat3::from_diagonal(DVec3::from(half_axes));
    (normalised(axes * axes.transpose()), 1.0)
}

/// A, with a mean apparent area of 1 along its axes: those are the square roots of the eigenvalues of adj(A).
fn normalised(inverse: DMat3) -> DMat3 {
    let areas = Sggx::from_matrix(adjugate(inverse)).eigenvalues().map(|area| area.max(0.0).sqrt());
    inverse * (3.0 / areas.iter().sum::<f64>())
}

fn area(s: DMat3, w: DVec3) -> f64 {
    w.dot(s * w).max(0.0).sqrt()
}

fn mean(shapes: &[Shape], of: impl Fn(DMat3) -> DMat3) -> DMat3 {
    let total: f64 = shapes.iter().map(|shape| shape.1).sum();
    shapes.iter().fold(DMat3::ZERO, |sum, (inverse, weight)| sum + of(*inverse) * (weight / total))
}

fn exact(shapes: &[Shape], w: DVec3) -> f64 {
    let total: f64 = shapes.iter().map(|shape| shape.1).sum();
    shapes.iter().map(|(inverse, weight)| weight * area(adjugate(*inverse), w)).sum::<f64>() / total
}

/// S by a rule.
fn joined(shapes: &[Shape], rule: Rule) -> DMat3 {
    match rule {
        Rule::Mean => mean(shapes, adjugate),
        Rule::Scaled => {
            let s = mean(shapes, adjugate);
            let sum = |of: &dyn Fn(DVec3) -> f64| directions(2000).map(of).sum::<f64>();
            let scale = sum(&|w| exact(shapes, w)) / sum(&|w| area(s, w));
            s * (scale * scale)
        }
        Rule::Inverse => adjugate(mean(shapes, |inverse| inverse)),
        Rule::Renormalised => adjugate(normalised(mean(shapes, |inverse| inverse))),
    }
}

/// Root mean square and greatest error.
fn errors(shapes: &[Shape], s: DMat3) -> [f64; 2] {
    let (mut squares, mut greatest, mut mean) = (0.0, 0.0f64, 0.0);
    let count = 4000;
    for w in directions(count) {
        let exact = exact(shapes, w);
        let error = area(s, w) - exact;
        squares += error * error;
        greatest = greatest.max(error.abs());
        mean += exact / f64::from(count);
    }
    [100.0 * (squares / f64::from(count)).sqrt() / mean, 100.0 * greatest / mean]
}

/// Within one percentage point or one per cent.
fn assert_row(name: &str, shapes: &[Shape], expected: [Option<[f64; 2]>; 4]) {
    for (rule, expected) in RULES.into_iter().zip(expected) {
        let Some(expected) = expected else { continue };
        let found = errors(shapes, joined(shapes, rule));
        for (found, expected) in found.into_iter().zip(expected) {
            if expected.is_finite() {
                let off = (found - expected).abs();
                assert!(off < f64::max(1.0, 0.01 * expected), "{name}, {rule:?}: {found} for {expected}");
            }
        }
    }
}

/// A greatest error that the table leaves out.
const UNKNOWN: f64 = f64::NAN;

const CROSSED: DMat3 = DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::X);

fn discs() -> [Shape; 2] {
    [ellipsoid(DMat3::IDENTITY, [1.0, 1.0, THIN]), ellipsoid(CROSSED, [1.0, 1.0, THIN])]
}

fn fibres(thickness: f64) -> [Shape; 2] {
    [DMat3::IDENTITY, CROSSED].map(|turn| ellipsoid(turn, [thickness, thickness, 1.0]))
}

/// The wall of a wide upright cylinder: flakes whose normals lie in the plane of x and y.
fn wall() -> Vec<Shape> {
    let flake = |k: u32| {
        let turn = DMat3::from_rotation_z(TAU * f64::from(k) / 64.0);
        ellipsoid(turn * DMat3::from_rotation_y(TAU / 4.0), [1.0, 1.0, THIN])
    };
    (0..64).map(flake).collect()
}

#[test]
fn shapes_that_differ_in_size_alone_join_exactly() {
    let shapes = [ellipsoid(DMat3::IDENTITY, [1.0, 0.5, 0.2]), ellipsoid(DMat3::IDENTITY, [3.0, 1.5, 0.6])];
    for rule in RULES {
        let [root, greatest] = errors(&shapes, joined(&shapes, rule));
        assert!(root < 1e-5 && greatest < 1e-5, "{rule:?}: {root} {greatest}");
    }
}

#[test]
fn fixed_shapes_have_the_errors_of_the_table() {
    let disc_and_fibre =
        [ellipsoid(DMat3::IDENTITY, [1.0, 1.0, THIN]), ellipsoid(DMat3::IDENTITY, [THIN, THIN, 1.0])];
    let row = |root: f64, greatest: f64| Some([root, greatest]);
    assert_row("discs", &discs(), [row(15.0, 41.0), row(10.0, 27.0), row(35.0, 98.0), row(41.0, 67.0)]);
    assert_row(
        "fibres",
        &fibres(THIN),
        [row(6.0, 26.0), row(5.0, 23.0), row(36662.0, UNKNOWN), row(65.0, 127.0)],
    );
    assert_row(
        "fibres of aspect 10",
        &fibres(0.1),
        [row(5.0, 20.0), row(4.5, 18.0), row(283.0, UNKNOWN), row(42.0, 81.0)],
    );
    assert_row(
        "fibres of aspect 3",
        &fibres(1.0 / 3.0),
        [row(3.0, 10.0), row(2.5, 8.0), row(42.0, UNKNOWN), row(15.0, 28.0)],
    );
    assert_row(
        "disc and fibre",
        &disc_and_fibre,
        [row(13.0, 45.0), row(8.5, 32.0), row(1956.0, UNKNOWN), row(46.0, 108.0)],
    );
    assert_row("wall", &wall(), [row(11.5, 14.0), row(0.0, UNKNOWN), row(33.0, 97.0), row(40.0, 53.0)]);
}

/// The row of shapes by chance: the means and deviations over 20 seeds.
fn random_row(make: impl Fn(&mut Chance) -> Vec<Shape>) -> [[f64; 2]; 4] {
    let rows: Vec<[f64; 4]> = (0..20)
        .map(|seed| {
            let shapes = make(&mut Chance(1000 + seed));
            RULES.map(|rule| errors(&shapes, joined(&shapes, rule))[0])
        })
        .collect();
    std::array::from_fn(|rule| {
        let mean = rows.iter().map(|row| row[rule]).sum::<f64>() / 20.0;
        let variance = rows.iter().map(|row| (row[rule] - mean).powi(2)).sum::<f64>() / 19.0;
        [mean, variance.sqrt()]
    })
}

/// The table's rows are of one seed: within one percentage point, one per cent or three deviations.
fn assert_near(found: [[f64; 2]; 4], expected: [f64; 4]) {
    for ((rule, [mean, deviation]), expected) in RULES.into_iter().zip(found).zip(expected) {
        let limit = f64::max(1.0, 0.01 * expected).max(3.0 * deviation);
        assert!((mean - expected).abs() < limit, "{rule:?}: {mean} ± {deviation} for {expected}");
        assert!(deviation < 0.2 * mean + 1.0, "{rule:?}: {mean} ± {deviation}");
    }
}

#[test]
fn isotropic_flakes_have_the_errors_of_the_table() {
    let make = |chance: &mut Chance| -> Vec<Shape> {
        (0..400).map(|_| ellipsoid(chance.rotation(), [1.0, 1.0, THIN])).collect()
    };
    assert_near(random_row(make), [15.5, 0.8, 33.0, 33.0]);
}

#[test]
fn isotropic_fibres_have_the_errors_of_the_table() {
    let make = |chance: &mut Chance| -> Vec<Shape> {
        (0..400).map(|_| ellipsoid(chance.rotation(), [THIN, THIN, 1.0])).collect()
    };
    assert_near(random_row(make), [4.0, 0.4, 42000.0, 15.0]);
}

#[test]
fn grass_has_the_errors_of_the_table() {
    let blade = |chance: &mut Chance| {
        let (tilt, turn) = (0.25 * chance.normal().abs(), TAU * chance.unit());
        let axis = DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos());
        let (x, y) = axis.any_orthonormal_pair();
        ellipsoid(DMat3::from_cols(x, y, axis), [0.05, 0.05, 1.0])
    };
    let make = |chance: &mut Chance| -> Vec<Shape> { (0..400).map(|_| blade(chance)).collect() };
    assert_near(random_row(make), [1.5, 1.4, 274.0, 5.5]);
}

#[test]
fn random_ellipsoids_have_the_errors_of_the_table() {
    let make = |chance: &mut Chance| -> Vec<Shape> {
        let mut one = || {
            let half_axes = [(); 3].map(|()| chance.between(0.1, 1.0));
            (ellipsoid(chance.rotation(), half_axes).0, chance.between(0.1, 1.0))
        };
        (0..64).map(|_| one()).collect()
    };
    assert_near(random_row(make), [3.8, 0.7, 25.0, 5.8]);
}

/// Both rules agree in the plane across an axis that all shapes share.
#[test]
fn shapes_with_a_common_axis_agree_across_it() {
    let mut chance = Chance(41);
    let cylinder = |chance: &mut Chance| {
        let axes = DMat3::from_rotation_z(TAU * chance.unit())
            * DMat3::from_diagonal(DVec3::new(chance.between(0.1, 1.0), chance.between(0.1, 1.0), 1e4));
        (axes * axes.transpose(), 1.0)
    };
    let shapes: Vec<Shape> = (0..5).map(|_| cylinder(&mut chance)).collect();
    let (s, inverse) = (joined(&shapes, Rule::Mean), joined(&shapes, Rule::Inverse));
    for i in 0..50 {
        let (y, x) = f64::from(i).sin_cos();
        let w = DVec3::new(x, y, 0.0);
        assert!((area(s, w) / area(inverse, w) - 1.0).abs() < 1e-9);
    }
}

/// The errors of two equal fibres fall with the square of the angle between them.
#[test]
fn errors_are_of_second_order_in_the_angle() {
    let greatest = |aspect: f64, angle: f64, rule: Rule| {
        let shapes: Vec<Shape> = [0.5, -0.5]
            .map(|half| ellipsoid(DMat3::from_rotation_y(half * angle), [1.0, 1.0, aspect]))
            .into();
        errors(&shapes, joined(&shapes, rule))[1] / 100.0
    };
    for (rule, expected) in
        [(Rule::Mean, [2.1e-3, 5.3e-4, 1.3e-4]), (Rule::Inverse, [1.3e-2, 3.3e-3, 8.2e-4])]
    {
        for (angle, expected) in [0.2, 0.1, 0.05].into_iter().zip(expected) {
            let found = greatest(2.0, angle, rule);
            assert!((found / expected - 1.0).abs() < 0.05, "{rule:?} {angle}: {found}");
        }
    }
    assert!((greatest(50.0, 0.2, Rule::Mean) - 0.04).abs() < 0.005);
    assert!((greatest(50.0, 0.2, Rule::Inverse) - 5.2).abs() < 0.1);
}

/// What a volume of these flakes, one a cell, is joined to: the cell that is all of it.
fn filtered(shapes: &[Shape], edge: u32, mode: Mode) -> Sggx {
    let mut builder = Builder::new(edge).unwrap();
    for (place, (inverse, weight)) in (0..).zip(shapes) {
        let flakes = Sggx::from_inverse_form(*inverse);
        let cell = [place % edge, place / edge % edge, place / edge / edge];
        builder.insert(cell, &Texel::even(*weight as f32, flakes, 1.0 / f64::from(edge)));
    }
    let volume = builder.build(mode).unwrap();
    volume.texel(volume.levels() - 1, [0; 3]).unwrap().flakes
}

/// The errors of normalised flakes beside the mean of shapes that have all the same mean projected area.
fn errors_of(flakes: &Sggx, shapes: &[Shape]) -> f64 {
    let scale = directions(2000).map(|w| exact(shapes, w)).sum::<f64>() / 2000.0;
    errors(shapes, flakes.matrix() * (scale * scale))[0]
}

#[test]
fn volumes_are_joined_by_the_mean_of_s() {
    assert!((errors_of(&filtered(&discs(), 2, Mode::Sggx), &discs()) - 10.0).abs() < 1.0);
    assert!((errors_of(&filtered(&fibres(THIN), 2, Mode::Sggx), &fibres(THIN)) - 5.0).abs() < 1.0);
    assert!(errors_of(&filtered(&wall(), 4, Mode::Sggx), &wall()) < 1.0);
}

/// A wide cylinder filters to a cylinder with S, and to a rather round ellipsoid, of the axes 1 : √2, with inverse forms.
#[test]
fn a_wide_cylinder_filters_to_a_cylinder() {
    let areas = |mode| {
        let flakes = filtered(&wall(), 4, mode);
        [DVec3::X, DVec3::Y, DVec3::Z].map(|w| flakes.projected_area(w))
    };
    let [x, y, z] = areas(Mode::Sggx);
    assert!((x - y).abs() < 0.02 && z < 0.02 && (x - 4.0 / std::f64::consts::PI).abs() < 0.02, "{x} {y} {z}");
    let [x, y, z] = areas(Mode::Neyret1995);
    assert!((x - y).abs() < 0.02 && (z / x - 0.5f64.sqrt()).abs() < 0.02, "{x} {y} {z}");
}

/// Blades of grass filter to an ellipsoid along their mean direction, with both rules.
#[test]
fn a_lawn_filters_to_an_ellipsoid_along_its_mean_direction() {
    let mut chance = Chance(42);
    let mean = DVec3::new(0.2, -0.1, 1.0).normalize();
    let blade = |chance: &mut Chance| {
        let axis = (mean + 0.2 * chance.direction()).normalize();
        let (x, y) = axis.any_orthonormal_pair();
        ellipsoid(DMat3::from_cols(x, y, axis), [0.1, 0.1, 1.0])
    };
    let shapes: Vec<Shape> = (0..400).map(|_| blade(&mut chance)).collect();
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let flakes = filtered(&shapes, 8, mode);
        let least = directions(20_000)
            .min_by(|a, b| flakes.projected_area(*a).total_cmp(&flakes.projected_area(*b)))
            .unwrap();
        assert!(least.dot(mean).abs() > 5.0f64.to_radians().cos(), "{mode:?}: {least}");
        assert!(flakes.projected_area(mean) < 0.45, "{mode:?}");
    }
}
