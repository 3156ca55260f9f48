//! Rays through volumes.

use crate::chance::{Chance, directions};
use fieldstone_texel::{Builder, Footprint, Mode, Ray, Sggx, Texel, Volume};
use glam::DVec3;

const EDGE: u32 = 16;

/// Every third cell or so filled by chance, the lower quarter evenly.
fn scattered(cyclic: [bool; 3]) -> Volume {
    let mut chance = Chance(21);
    let mut builder = Builder::new(EDGE).unwrap().cyclic(cyclic);
    let even = Texel::even(2.0, Sggx::ISOTROPIC, 1.0 / f64::from(EDGE));
    for place in 0..EDGE.pow(3) {
        let cell = [place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE];
        let flakes = Sggx::fibre(chance.direction(), chance.between(0.1, 0.9));
        let texel = Texel::even(chance.between(0.5, 8.0) as f32, flakes, 1.0 / f64::from(EDGE));
        if cell[2] < EDGE / 4 {
            builder.insert(cell, &even);
        } else if chance.unit() < 0.3 {
            builder.insert(cell, &texel);
        }
    }
    builder.build(Mode::Sggx).unwrap()
}

fn rays(count: usize) -> Vec<Ray> {
    let mut chance = Chance(22);
    let mut ray = || {
        let origin = DVec3::splat(0.5) + 2.0 * chance.direction();
        let target = DVec3::new(chance.unit(), chance.unit(), chance.unit());
        Ray { origin, direction: (target - origin) * chance.between(0.2, 3.0) }
    };
    let mut rays: Vec<Ray> = (0..count).map(|_| ray()).collect();
    // Along the faces, edges and diagonals of cells.
    for direction in [DVec3::X, -DVec3::Y, DVec3::Z, DVec3::ONE, DVec3::new(-1.0, 1.0, 0.0)] {
        for origin in [DVec3::splat(0.5), DVec3::new(0.25, 0.5, 0.75), DVec3::new(0.3, 0.4, 0.6)] {
            rays.push(Ray { origin: origin - 3.0 * direction, direction });
        }
    }
    rays
}

/// The optical depth of a ray by the cells of a level, found one by one from the middles between all faces.
fn depth_by_faces(volume: &Volume, ray: &Ray, level: u32) -> f64 {
    let cells = volume.edge() >> level;
    let mut cuts = Vec::new();
    for axis in 0..3 {
        for face in 0..=cells {
            cuts.push((f64::from(face) / f64::from(cells) - ray.origin[axis]) / ray.direction[axis]);
        }
    }
    cuts.retain(|t| t.is_finite());
    cuts.sort_by(f64::total_cmp);
    let piece = |ends: &[f64]| {
        let place = ray.at(0.5 * (ends[0] + ends[1]));
        if place.min_element() < 0.0 || place.max_element() >= 1.0 {
            return 0.0;
        }
        let texel = volume.texel(level, place.to_array().map(|x| (x * f64::from(cells)) as u32));
        let extinction = texel.map_or(0.0, |t| t.extinction(ray.direction, volume.cell_width(level)));
        extinction * (ends[1] - ends[0])
    };
    cuts.windows(2).map(piece).sum()
}

#[test]
fn segments_are_those_between_the_faces_of_cells() {
    let volume = scattered([false; 3]);
    for level in 0..volume.levels() {
        for ray in rays(200) {
            // What grazes faces is of one side or the other.
            if ray.direction.to_array().contains(&0.0) && ray.origin.fract() == ray.origin {
                continue;
            }
            let all = (f64::NEG_INFINITY, f64::INFINITY);
            let walked: f64 = volume.segments(&ray, all, |_| level as f32).map(|s| s.depth(&ray)).sum();
            let expected = depth_by_faces(&volume, &ray, level);
            assert!(
                (walked - expected).abs() < 1e-9 * (1.0 + expected),
                "{level} {ray:?}: {walked} {expected}"
            );
        }
    }
}

#[test]
fn segments_come_front_to_back_and_do_not_overlap() {
    let volume = scattered([false; 3]);
    for ray in rays(200) {
        let (near, far) = ray.span().unwrap();
        let mut last = near - 1e-9;
        for segment in volume.segments(&ray, (0.0, f64::INFINITY), |t| t as f32 % 3.0) {
            assert!(segment.from >= last && segment.to > segment.from, "{ray:?} {segment:?}");
            assert!(segment.to <= far + 1e-9 && !segment.layers().is_empty());
            last = segment.to;
        }
    }
}

#[test]
fn segments_stay_in_their_span() {
    let volume = scattered([false; 3]);
    for ray in rays(100) {
        let (near, far) = ray.span().unwrap();
        let cut = near + 0.37 * (far - near);
        let depth = |from, to| volume.segments(&ray, (from, to), |_| 0.0).map(|s| s.depth(&ray)).sum::<f64>();
        let (whole, parts) = (depth(near, far), depth(near, cut) + depth(cut, far));
        assert!((whole - parts).abs() < 1e-9 * (1.0 + whole), "{ray:?}: {whole} {parts}");
        assert_eq!(depth(far, near), 0.0);
    }
}

#[test]
fn both_ways_are_as_long() {
    let volume = scattered([false; 3]);
    let mut chance = Chance(23);
    for level in [0.0, 0.6, 1.0, 2.5] {
        for _ in 0..100 {
            let a = DVec3::new(chance.between(-0.5, 1.5), chance.unit(), chance.unit());
            let b = DVec3::new(chance.unit(), chance.between(-0.5, 1.5), chance.unit());
            let (forth, back) = (volume.transmittance(a, b, level), volume.transmittance(b, a, level));
            assert!((forth - back).abs() < 1e-9, "{a} {b}: {forth} {back}");
        }
    }
}

#[test]
fn an_even_volume_is_one_segment() {
    let mut builder = Builder::new(EDGE).unwrap();
    let texel = Texel::even(3.0, Sggx::ISOTROPIC, 1.0 / f64::from(EDGE));
    for place in 0..EDGE.pow(3) {
        builder.insert([place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE], &texel);
    }
    let volume = builder.build(Mode::Sggx).unwrap();
    for ray in rays(20) {
        assert_eq!(volume.segments(&ray, (0.0, f64::INFINITY), |_| 0.5).count(), 1);
    }
}

#[test]
fn two_levels_are_blended() {
    let volume = scattered([false; 3]);
    for ray in rays(50) {
        let depth = |level: f32| {
            volume.segments(&ray, (0.0, f64::INFINITY), |_| level).map(|s| s.depth(&ray)).sum::<f64>()
        };
        let (fine, coarse, blend) = (depth(1.0), depth(2.0), depth(1.25));
        assert!((blend - 0.75 * fine - 0.25 * coarse).abs() < 1e-6 * (1.0 + fine), "{fine} {coarse} {blend}");
    }
}

#[test]
fn a_footprint_chooses_the_level() {
    let volume = scattered([false; 3]);
    let footprint = Footprint { width: 1.0 / 16.0, spread: 1.0 / 16.0 };
    assert_eq!(footprint.level(&volume, 0.0), 0.0);
    assert_eq!(footprint.level(&volume, 3.0), 2.0);
    assert_eq!(Footprint { width: 0.0, spread: 0.0 }.level(&volume, 1.0), 0.0);
    // Beyond the top, the whole volume is one cell.
    let ray = Ray { origin: DVec3::new(-1.0, 0.4, 0.6), direction: DVec3::X };
    assert_eq!(volume.segments(&ray, (0.0, 9.0), |t| footprint.level(&volume, 1e9 * t)).count(), 1);
}

#[test]
fn cyclic_volumes_go_on() {
    let (once, again) = (scattered([false; 3]), scattered([true, true, false]));
    let direction = DVec3::new(0.7, 0.4, 0.05);
    let ray = Ray { origin: DVec3::new(0.2, 0.3, 0.4), direction };
    let end = 7.0;
    let walked: f64 = again.segments(&ray, (0.0, end), |_| 0.0).map(|s| s.depth(&ray)).sum();
    let mut summed = 0.0;
    for x in 0..8 {
        for y in 0..8 {
            let moved = Ray { origin: ray.origin - DVec3::new(f64::from(x), f64::from(y), 0.0), direction };
            summed += once.segments(&moved, (0.0, end), |_| 0.0).map(|s| s.depth(&moved)).sum::<f64>();
        }
    }
    assert!((walked - summed).abs() < 1e-9 * summed, "{walked} {summed}");
    // A walk ends also where nothing ends it.
    let endless = Ray { origin: ray.origin, direction: DVec3::X };
    assert!(again.segments(&endless, (0.0, f64::INFINITY), |_| 0.0).count() < 200_000);
}

#[test]
fn a_slab_lets_through_what_the_closed_form_says() {
    // Flakes of three shapes, in the lower half of the cube.
    let shapes = [
        Sggx::ISOTROPIC,
        Sggx::surface(DVec3::new(0.6, 0.0, 0.8), 0.3),
        Sggx::fibre(DVec3::new(0.0, 0.8, -0.6), 0.4),
    ];
    for flakes in shapes {
        let mut builder = Builder::new(EDGE).unwrap().cyclic([true, true, false]);
        let texel = Texel::even(1.5, flakes, 1.0 / f64::from(EDGE));
        for place in 0..EDGE.pow(3) / 2 {
            builder.insert([place % EDGE, place / EDGE % EDGE, place / EDGE / EDGE], &texel);
        }
        let volume = builder.build(Mode::Sggx).unwrap();
        for w in directions(400) {
            let way = 0.5 / w.z.abs();
            let exact = (-1.5 * flakes.projected_area(w) * way).exp();
            let from = DVec3::new(0.3, 0.6, if w.z > 0.0 { -0.1 } else { 0.6 });
            let ray = Ray { origin: from, direction: w };
            let passes = (-volume.depth_along(&ray, (0.0, 1.5 * way + 10.0), |_| 0.0)).exp();
            // Flakes and depths are stored in few bits.
            assert!((passes - exact).abs() < 0.005, "{flakes:?} {w}: {passes} {exact}");
        }
    }
}

#[test]
fn an_even_texel_has_the_extinction_of_its_flakes() {
    let mut chance = Chance(24);
    for _ in 0..50 {
        let flakes = Sggx::surface(chance.direction(), chance.between(0.05, 1.0));
        let texel = Texel::even(2.0, flakes, 0.25);
        let w = chance.direction();
        let (found, exact) = (texel.extinction(w, 0.25), 2.0 * flakes.projected_area(w));
        assert!((found - exact).abs() < 1e-5, "{flakes:?} {w}: {found} {exact}");
    }
}

#[test]
fn rays_that_are_none_meet_nothing() {
    let volume = scattered([true, false, false]);
    let directions = [DVec3::ZERO, DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)];
    for direction in directions {
        let ray = Ray { origin: DVec3::splat(0.1), direction };
        assert_eq!(volume.segments(&ray, (0.0, f64::INFINITY), |_| f32::NAN).count(), 0, "{direction}");
    }
    let ray = Ray { origin: DVec3::splat(0.1), direction: DVec3::Y };
    assert_eq!(volume.segments(&ray, (f64::NAN, f64::NAN), |_| 0.0).count(), 0);
    let empty = Builder::new(8).unwrap().build(Mode::Sggx).unwrap();
    assert_eq!(empty.segments(&ray, (0.0, f64::INFINITY), |_| 0.0).count(), 0);
    let single = Builder::new(1).unwrap().build(Mode::Sggx).unwrap();
    assert_eq!(single.segments(&ray, (0.0, f64::INFINITY), |_| 0.0).count(), 0);
}
