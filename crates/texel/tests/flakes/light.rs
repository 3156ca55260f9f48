//! Light scattered once.

use crate::chance::{Chance, directions};
use fieldstone_texel::{
    Builder, Gathered, Lamp, Mode, Model, Ray, Reflector, Sggx, Texel, Volume, lit_share,
};
use glam::DVec3;

const EDGE: u32 = 16;

fn cells(edge: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..edge.pow(3)).map(move |place| [place % edge, place / edge % edge, place / edge / edge])
}

/// A slab in the lower half of the cube, without an end sideways.
fn slab(density: f32, flakes: Sggx, gloss: f32) -> (Volume, Texel) {
    let mut builder = Builder::new(EDGE).unwrap().cyclic([true, true, false]);
    let texel = Texel::even(density, flakes, 1.0 / f64::from(EDGE)).coloured([1.0, 0.5, 0.25], gloss);
    for cell in cells(EDGE).filter(|cell| cell[2] < EDGE / 2) {
        builder.insert(cell, &texel);
    }
    let volume = builder.build(Mode::Sggx).unwrap();
    // As stored.
    let texel = volume.texel(0, [0; 3]).unwrap();
    (volume, texel)
}

fn gather(volume: &Volume, ray: &Ray, level: f32, lamps: &[Lamp]) -> Gathered {
    volume.single_scattering(ray, (0.0, 100.0), |_| level, (lamps, Model::Microflakes))
}

/// L = albedo p E σ(v) / μ_v / (σ(v) / μ_v + σ(l) / μ_l) (1 − e^{−(σ(v) / μ_v + σ(l) / μ_l) h}).
#[test]
fn a_slab_scatters_what_the_closed_form_says() {
    let shapes = [
        (Sggx::ISOTROPIC, 0.0),
        (Sggx::surface(DVec3::new(0.6, 0.0, 0.8), 0.5), 0.4),
        (Sggx::fibre(DVec3::Y, 0.4), 1.0),
    ];
    let mut chance = Chance(31);
    let above = |w: DVec3| DVec3::new(w.x, w.y, w.z.abs().max(0.1)).normalize();
    for (flakes, gloss) in shapes {
        let (volume, texel) = slab(1.5, flakes, gloss);
        for _ in 0..20 {
            let (view, light) = (above(chance.direction()), above(chance.direction()));
            let ray = Ray { origin: DVec3::new(0.3, 0.4, 0.5) + view, direction: -view };
            let lamp = Lamp::Directional { to_lamp: light, irradiance: DVec3::new(2.0, 3.0, 4.0) };
            let gathered = gather(&volume, &ray, 0.0, &[lamp]);
            let width = volume.cell_width(0);
            let (out, back) =
                (texel.extinction(view, width) / view.z, texel.extinction(light, width) / light.z);
            let phase = Reflector::new(&texel, Model::Microflakes, view).phase(light);
            let lit = phase * out / (out + back) * (1.0 - (-0.5 * (out + back)).exp());
            let colour = DVec3::new(2.0, 3.0, 4.0) * DVec3::from_array(texel.albedo.map(f64::from));
            let error = (gathered.radiance - colour * lit).abs().max_element();
            assert!(error < 1e-6 * (1.0 + lit), "{view} {light}: {gathered:?} {}", colour * lit);
            assert!((gathered.transmittance - (-0.5 * out).exp()).abs() < 1e-9);
        }
    }
}

#[test]
fn cells_that_hide_nothing_scatter_nothing() {
    let mut builder = Builder::new(EDGE).unwrap();
    let grey = [0.5; 3];
    builder.insert([8, 8, 8], &Texel { density: 0.05, albedo: grey, ..Texel::default() });
    builder.insert([8, 8, 4], &Texel::even(1000.0, Sggx::ISOTROPIC, 1.0 / 16.0).coloured(grey, 0.0));
    let volume = builder.build(Mode::Sggx).unwrap();
    let ray = Ray { origin: DVec3::new(0.53, 0.53, 2.0), direction: -DVec3::Z };
    let lamp = Lamp::Directional { to_lamp: DVec3::Z, irradiance: DVec3::ONE };
    let gathered = gather(&volume, &ray, 0.0, &[lamp]);
    assert!(gathered.radiance.min_element() > 0.01, "{gathered:?}");
    assert_eq!(gathered.transmittance, 0.0);
}

#[test]
fn a_slab_before_its_lamp_scatters_what_passes() {
    // The lamp behind: a homogeneous slab of equal depths both ways has the closed form d e^{−d}.
    let (volume, texel) = slab(1.5, Sggx::ISOTROPIC, 0.0);
    let ray = Ray { origin: DVec3::new(0.3, 0.4, 2.0), direction: -DVec3::Z };
    let lamp = Lamp::Directional { to_lamp: -DVec3::Z, irradiance: DVec3::ONE };
    let depth = 0.5 * texel.extinction(DVec3::Z, volume.cell_width(0));
    let phase = Reflector::new(&texel, Model::Microflakes, DVec3::Z).phase(-DVec3::Z);
    let exact = f64::from(texel.albedo[0]) * phase * depth * (-depth).exp();
    let gathered = gather(&volume, &ray, 0.0, &[lamp]).radiance.x;
    assert!((gathered - exact).abs() < 1e-9, "{gathered} {exact}");
}

#[test]
fn what_is_lit_is_the_integral_along_the_piece() {
    let mut chance = Chance(32);
    for _ in 0..200 {
        let depth = chance.between(0.0, 10.0);
        let (a, b) = (chance.between(0.0, 15.0), chance.between(0.0, 15.0));
        for b in [b, a - depth, a - depth + 1e-7] {
            if b < 0.0 {
                continue;
            }
            let count = 20_000;
            let at = |s: f64| depth * (-depth * s - a - (b - a) * s).exp();
            let sum: f64 = (0..count).map(|i| at((f64::from(i) + 0.5) / f64::from(count))).sum();
            let (sum, exact) = (sum / f64::from(count), lit_share(depth, [a, b]));
            assert!((sum - exact).abs() < 1e-6 * (sum + 1e-9), "{depth} {a} {b}: {sum} {exact}");
        }
    }
    assert_eq!(lit_share(0.0, [1.0, 1.0]), 0.0);
    assert_eq!(lit_share(3.0, [f64::INFINITY, f64::INFINITY]), 0.0);
}

#[test]
fn a_point_lamp_far_away_is_a_directional_one() {
    let (volume, _) = slab(4.0, Sggx::surface(DVec3::Z, 0.5), 0.2);
    let ray = Ray { origin: DVec3::new(0.3, 0.4, 2.0), direction: DVec3::new(0.1, 0.2, -1.0) };
    let to_lamp = DVec3::new(0.2, -0.3, 0.9).normalize();
    let far = 1e4;
    let point = Lamp::Point { place: ray.at(1.6) + far * to_lamp, intensity: DVec3::splat(far * far) };
    // The way to the lamp goes round the cyclic volume only where there is anything.
    let directional = Lamp::Directional { to_lamp, irradiance: DVec3::ONE };
    let (a, b) = (gather(&volume, &ray, 0.0, &[point]), gather(&volume, &ray, 0.0, &[directional]));
    assert!((a.radiance - b.radiance).length() < 1e-3 * b.radiance.length(), "{a:?} {b:?}");
}

#[test]
fn lamps_add_up() {
    let (volume, _) = slab(4.0, Sggx::surface(DVec3::Z, 0.5), 0.2);
    let ray = Ray { origin: DVec3::new(0.3, 0.4, 2.0), direction: DVec3::new(0.1, 0.2, -1.0) };
    let lamp =
        |x: f64| Lamp::Directional { to_lamp: DVec3::new(x, 0.0, 0.8).normalize(), irradiance: DVec3::ONE };
    let both = gather(&volume, &ray, 0.0, &[lamp(0.1), lamp(-0.6)]).radiance;
    let each = gather(&volume, &ray, 0.0, &[lamp(0.1)]).radiance
        + gather(&volume, &ray, 0.0, &[lamp(-0.6)]).radiance;
    assert!((both - each).length() < 1e-12);
}

/// Lit from all sides by a sky of radiance 1, nothing gets brighter than the sky, whatever is looked at.
#[test]
fn no_more_light_leaves_than_arrives() {
    let mut chance = Chance(33);
    let mut builder = Builder::new(EDGE).unwrap();
    for cell in cells(EDGE) {
        let flakes = Sggx::surface(chance.direction(), chance.between(0.2, 1.0));
        let density = chance.between(1.0, 200.0) as f32;
        let texel =
            Texel::even(density, flakes, 1.0 / f64::from(EDGE)).coloured([1.0; 3], chance.unit() as f32);
        if chance.unit() < 0.4 {
            builder.insert(cell, &texel);
        }
    }
    let volume = builder.build(Mode::Sggx).unwrap();
    let count = 400;
    let irradiance = DVec3::splat(4.0 * std::f64::consts::PI / f64::from(count));
    let lamps: Vec<Lamp> =
        directions(count).map(|to_lamp| Lamp::Directional { to_lamp, irradiance }).collect();
    for level in [0.0, 1.5, 3.0] {
        for _ in 0..12 {
            let view = chance.direction();
            let ray = Ray { origin: DVec3::splat(0.5) + 2.0 * view, direction: -view };
            let gathered = gather(&volume, &ray, level, &lamps);
            let sum = gathered.radiance.x + gathered.transmittance;
            assert!(sum > 0.0 && sum < 1.01, "{level} {view}: {gathered:?}");
        }
    }
}

#[test]
fn an_opaque_cell_throws_a_shadow() {
    let mut builder = Builder::new(EDGE).unwrap();
    let wall = Texel::even(1e4, Sggx::ISOTROPIC, 1.0 / f64::from(EDGE));
    for cell in cells(EDGE).filter(|cell| cell[2] == 2 || cell[2] == 10 && cell[0] < 8) {
        builder.insert(cell, &wall);
    }
    let volume = builder.build(Mode::Sggx).unwrap();
    let lamp = Lamp::Directional { to_lamp: DVec3::Z, irradiance: DVec3::ONE };
    let seen = |x: f64| {
        let ray = Ray { origin: DVec3::new(x, 0.5, 0.4), direction: DVec3::new(0.0, 0.1, -1.0) };
        gather(&volume, &ray, 0.0, &[lamp])
    };
    let (dark, bright) = (seen(0.25), seen(0.75));
    assert!(dark.radiance.x < 1e-6 && bright.radiance.x > 0.03, "{dark:?} {bright:?}");
    assert_eq!((dark.transmittance, bright.transmittance), (0.0, 0.0));
}

/// The light runs along the faces of cells, and a ray leaves through a face: both ends of its last piece are in shadow.
#[test]
fn light_along_the_faces_of_cells_stays_in_its_column() {
    let mut builder = Builder::new(EDGE).unwrap();
    let even = Texel::even(2.0, Sggx::ISOTROPIC, 1.0 / f64::from(EDGE));
    for cell in cells(EDGE) {
        builder.insert(cell, &even);
    }
    let volume = builder.build(Mode::Sggx).unwrap();
    let lamp = Lamp::Directional { to_lamp: DVec3::Z, irradiance: DVec3::ONE };
    let texel = volume.texel(0, [0; 3]).unwrap();
    for tilt in [0.0, 0.01, -0.013] {
        let direction = DVec3::new(1.0, tilt, -0.3).normalize();
        let ray = Ray { origin: DVec3::new(-0.1, 0.5, 0.6), direction };
        let found = gather(&volume, &ray, 0.0, &[lamp]).radiance.x;
        let (near, far) = ray.span().unwrap();
        let out = texel.extinction(DVec3::Z, volume.cell_width(0));
        let rise = out * (1.0 - direction.z);
        let phase = Reflector::new(&texel, Model::Microflakes, -direction).phase(DVec3::Z);
        let lit = (-out * (1.0 - ray.at(near).z)).exp() * out / rise * (1.0 - (-rise * (far - near)).exp());
        assert!((found - phase * lit).abs() < 1e-6, "{tilt}: {found} {}", phase * lit);
    }
}
