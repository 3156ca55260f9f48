//! Phase functions.

use crate::chance::{Chance, directions, integral};
use fieldstone_texel::{
    Flakes, Model, Phong, Reflector, Sggx, Texel, VisibleNormals, disc_point, fibre_phase,
};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

fn texel(flakes: Sggx, gloss: f32) -> Texel {
    Texel::even(1.0, flakes, 1.0).coloured([1.0; 3], gloss)
}

fn shapes() -> Vec<Sggx> {
    let mut chance = Chance(11);
    let axes = DMat3::from_diagonal(DVec3::new(0.4, 0.7, 1.0));
    vec![
        Sggx::ISOTROPIC,
        Sggx::surface(DVec3::new(0.6, 0.0, 0.8), 0.4),
        Sggx::fibre(DVec3::new(0.0, 0.8, 0.6), 0.4),
        Sggx::ellipsoid(chance.rotation() * axes),
    ]
}

fn total(texel: &Texel, model: Model, view: DVec3) -> f64 {
    let reflector = Reflector::new(texel, model, view);
    integral(view, PI, 400, |l| reflector.phase(l))
}

#[test]
fn mirrors_send_on_all_light() {
    let mut chance = Chance(12);
    for shape in shapes() {
        let sum = total(&texel(shape, 1.0), Model::Microflakes, chance.direction());
        assert!((sum - 1.0).abs() < 1e-4, "{shape:?}: {sum}");
    }
}

#[test]
fn matt_flakes_send_on_all_light() {
    let mut chance = Chance(13);
    for gloss in [0.0, 0.3] {
        for shape in shapes() {
            let sum = total(&texel(shape, gloss), Model::Microflakes, chance.direction());
            assert!((sum - 1.0).abs() < 1e-4, "{shape:?}: {sum}");
        }
    }
}

#[test]
fn phongs_reflection_sends_on_no_more_than_all_light() {
    let mut chance = Chance(14);
    for exponent in [1.0, 20.0, 200.0] {
        let model = Model::Phong(Phong { diffuse: 0.6, specular: 0.4, exponent });
        for shape in shapes() {
            let sum = total(&texel(shape, 0.0), model, chance.direction());
            assert!(sum > 0.6 && sum < 1.0 + 1e-4, "{shape:?} {exponent}: {sum}");
        }
    }
    let diffuse = Model::Phong(Phong { diffuse: 1.0, specular: 0.0, exponent: 1.0 });
    let sum = total(&texel(Sggx::ISOTROPIC, 0.0), diffuse, DVec3::Z);
    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
}

#[test]
fn mirrors_send_as_much_back_as_forth() {
    let mut chance = Chance(15);
    for shape in shapes() {
        let (texel, a, b) = (texel(shape, 1.0), chance.direction(), chance.direction());
        let area = |w| Flakes::new(&shape).projected_area(w);
        let phase = |from, to| area(from) * Reflector::new(&texel, Model::Microflakes, from).phase(to);
        let (forth, back) = (phase(a, b), phase(b, a));
        assert!((forth - back).abs() < 1e-6 * forth, "{forth} {back}");
    }
}

/// The phase function of matt flakes by many normals.
fn many(flakes: &Flakes, view: DVec3, light: DVec3, count: u32) -> f64 {
    let visible = VisibleNormals::new(flakes, view);
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    let normal = |i: u32| {
        visible.at(disc_point([(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * golden).fract()]))
    };
    (0..count).map(|i| normal(i).dot(light).max(0.0)).sum::<f64>() / (PI * f64::from(count))
}

/// The errors that the number of normals was chosen by.
#[test]
fn the_set_of_normals_is_as_exact_as_stated() {
    let mut chance = Chance(16);
    let (mut squares, mut greatest, mut mean, count) = (0.0, 0.0f64, 0.0, 400);
    for _ in 0..count {
        let areas = [(); 3].map(|()| 10.0f64.powf(chance.between(-4.0, 0.0)));
        let turn = chance.rotation();
        let shape = Sggx::from_matrix(turn * DMat3::from_diagonal(DVec3::from(areas)) * turn.transpose());
        let (view, light) = (chance.direction(), chance.direction());
        let exact = many(&Flakes::new(&shape), view, light, 10_000);
        let error = Reflector::new(&texel(shape, 0.0), Model::Microflakes, view).phase(light) - exact;
        squares += error * error;
        greatest = greatest.max(error.abs());
        mean += exact / f64::from(count);
    }
    let root = (squares / f64::from(count)).sqrt();
    assert!(root < 0.016 * mean, "{}", root / mean);
    assert!(greatest < 0.08 * mean, "{}", greatest / mean);
}

/// A ball of matt flakes is a Lambertian ball: (sin θ + (π − θ) cos θ) 2 / 3π².
#[test]
fn matt_isotropic_flakes_are_a_lambertian_ball() {
    let reflector = Reflector::new(&texel(Sggx::ISOTROPIC, 0.0), Model::Microflakes, DVec3::Z);
    for light in directions(50) {
        let angle = light.z.acos();
        let exact = 2.0 / (3.0 * PI * PI) * (angle.sin() + (PI - angle) * angle.cos());
        assert!((reflector.phase(light) - exact).abs() < 0.003, "{angle}: {exact}");
    }
}

#[test]
fn the_fibre_factor_is_that_of_matt_fibres() {
    let mut chance = Chance(17);
    let tangent = DVec3::new(0.0, 0.6, 0.8);
    let flakes = Flakes::new(&Sggx::fibre(tangent, 0.0));
    for _ in 0..20 {
        let (view, light) = (chance.direction(), chance.direction());
        // Flakes that are thickened show their ends.
        if view.dot(tangent).abs() > 0.99 {
            continue;
        }
        let (closed, summed) = (fibre_phase(tangent, view, light), many(&flakes, view, light, 20_000));
        assert!((closed - summed).abs() < 2e-3, "{closed} {summed}");
    }
}

#[test]
fn the_fibre_factor_sends_on_all_light() {
    let tangent = DVec3::new(0.0, 0.6, 0.8);
    let view = DVec3::new(0.6, 0.8, 0.0);
    let sum = integral(view, PI, 400, |l| fibre_phase(tangent, view, l));
    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    assert_eq!(fibre_phase(tangent, view, tangent), 0.0);
    assert_eq!(fibre_phase(tangent, tangent, view), 0.0);
}

#[test]
fn phase_functions_of_flat_flakes_are_finite() {
    for shape in [Sggx::surface(DVec3::Z, 0.0), Sggx::fibre(DVec3::Z, 0.0)] {
        for gloss in [0.0, 0.5, 1.0] {
            let texel = texel(shape, gloss);
            for view in directions(40).chain([DVec3::X, DVec3::Z]) {
                let reflector = Reflector::new(&texel, Model::Microflakes, view);
                for light in [DVec3::X, DVec3::Z, view, -view] {
                    let phase = reflector.phase(light);
                    assert!(phase.is_finite() && phase >= 0.0, "{shape:?} {view} {light}: {phase}");
                }
            }
        }
    }
}
