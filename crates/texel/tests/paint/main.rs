//! Painting: what shapes hide, which way they face, and where they stand.

use fieldstone_texel::paint::{Flakes, Form, Frame, Material, PaintError, Scatter, Shape, Solid, paint};
use fieldstone_texel::{Builder, Mode, Texel, Volume};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

fn at(x: f64, y: f64, z: f64) -> Frame {
    Frame { origin: DVec3::new(x, y, z), axes: DMat3::IDENTITY }
}

fn shape(form: Form, frame: Frame) -> Shape {
    Shape { form, frame, material: Material { roughness: 0.0, ..Material::default() } }
}

fn painted(edge: u32, cyclic: [bool; 3], solids: impl IntoIterator<Item = Solid>) -> Volume {
    let mut builder = Builder::new(edge).expect("a power of two").cyclic(cyclic);
    paint(&mut builder, solids).expect("few cells");
    builder.build(Mode::Sggx).expect("few cells")
}

fn one(edge: u32, shape: &Shape) -> Volume {
    painted(edge, [false; 3], [shape.solid(1)])
}

fn whole(volume: &Volume) -> Texel {
    volume.texel(volume.levels() - 1, [0; 3]).expect("filled")
}

/// The share of light that the whole cube stops along x, y and z: the areas of shadows.
fn shadows(volume: &Volume) -> [f64; 3] {
    whole(volume).depth.map(|depth| 1.0 - f64::from(-depth).exp())
}

/// The shadow of a shape is that of geometry, but for cells that its border crosses: those behind each other hide
/// more together than they should. The finer the cells, the less.
#[test]
fn shadows_have_the_areas_of_geometry() {
    let ball = Form::Ellipsoid { radii: DVec3::new(0.3, 0.2, 0.25) };
    let cylinder = Form::Cone { radius: 0.2, top: 0.2, height: 0.6 };
    let cone = Form::Cone { radius: 0.3, top: 0.0, height: 0.6 };
    let disc = Form::Disc { radius: 0.3, thickness: 0.02 };
    let cuboid = Form::Box { size: DVec3::new(0.5, 0.3, 0.2) };
    let cases = [
        (ball, 0.5, [PI * 0.05, PI * 0.075, PI * 0.06]),
        (cylinder, 0.2, [0.24, 0.24, PI * 0.04]),
        (cone, 0.2, [0.18, 0.18, PI * 0.09]),
        (disc, 0.5, [0.012, 0.012, PI * 0.09]),
        (cuboid, 0.5, [0.06, 0.1, 0.15]),
    ];
    for (form, z, areas) in cases {
        for edge in [32, 64] {
            let found = shadows(&one(edge, &shape(form.clone(), at(0.513, 0.487, z + 0.003))));
            for (found, area) in found.into_iter().zip(areas) {
                let allowed = 1.0 / f64::from(edge);
                assert!((found - area).abs() < allowed, "{form:?} at {edge}: {found} beside {area}");
            }
        }
    }
}

/// A body in one cell hides its area, as far as 16 rays can tell: in the mean over many places.
#[test]
fn a_body_within_a_cell_hides_its_area() {
    let radius = 0.15;
    let sum: f64 = (0..200)
        .map(|seed| {
            let frame = at(0.3 + 0.002 * f64::from(seed), 0.6 - 0.001 * f64::from(seed), 0.5);
            let ball = shape(Form::Ellipsoid { radii: DVec3::splat(radius) }, frame);
            let volume = painted(1, [false; 3], [ball.solid(u64::from(seed as u32))]);
            volume.texel(0, [0; 3]).map_or(0.0, |texel| 1.0 - f64::from(-texel.depth[1]).exp())
        })
        .sum();
    assert!((sum / 200.0 / (PI * radius * radius) - 1.0).abs() < 0.15, "{}", sum / 200.0);
}

/// Hairs far thinner than a cell are as transparent as their widths say; those on the border of two cells a bit less.
#[test]
fn thin_hairs_cover_their_widths() {
    let mut hairs = lawn(5);
    hairs.shape.form = Form::Hair { height: 0.8, radius: 0.001, tip: 0.001, curl: 0.0 };
    (hairs.comb, hairs.lean, hairs.size, hairs.count) = (DVec3::ZERO, 0.0, [1.0; 2], 49);
    hairs.curl = 0.0;
    for edge in [16, 32] {
        let found = shadows(&painted(edge, [false; 3], hairs.solids()));
        assert!((found[0] / (49.0 * 0.002 * 0.8) - 1.0).abs() < 0.12, "{edge}: {found:?}");
    }
}

/// Seen along x, a flat blade is a triangle, and its thickness all around.
#[test]
fn blades_cover_their_area() {
    let blade = Form::Blade { height: 0.8, width: 0.1, fold: 0.0, thickness: 0.002, curl: 0.0 };
    let found = shadows(&one(32, &shape(blade, at(0.513, 0.5, 0.1))));
    assert!((found[0] / (0.5 * 0.8 * 0.1 + 0.0017) - 1.0).abs() < 0.04, "{found:?}");
}

/// σ of a closed convex body is its shadow: the flakes of the whole are as anisotropic as the body.
#[test]
fn flakes_of_the_whole_face_as_the_body_does() {
    let ball =
        whole(&one(32, &shape(Form::Ellipsoid { radii: DVec3::splat(0.4) }, at(0.5, 0.5, 0.5)))).flakes;
    for w in [DVec3::X, DVec3::Z, DVec3::ONE.normalize()] {
        assert!((ball.projected_area(w) - 1.0).abs() < 0.02, "{ball:?}");
    }
    let form = Form::Cone { radius: 0.4, top: 0.4, height: 2.0 };
    let wall = whole(&one(32, &shape(form, at(0.5, 0.5, -0.5)))).flakes;
    assert!(wall.projected_area(DVec3::Z) < 0.05 * wall.projected_area(DVec3::X), "{wall:?}");
}

#[test]
fn clouds_have_the_depth_of_their_density() {
    let material = Material { density: Some(2.0), roughness: 1.0, ..Material::default() };
    let slab =
        Shape { form: Form::Box { size: DVec3::new(2.0, 2.0, 0.33) }, frame: at(0.5, 0.5, 0.5), material };
    let texel = whole(&one(16, &slab));
    assert!((f64::from(texel.depth[2]) / (2.0 * 0.33) - 1.0).abs() < 0.06, "{texel:?}");
}

#[test]
fn what_leaves_a_cyclic_volume_comes_in_again() {
    let ball = shape(Form::Ellipsoid { radii: DVec3::splat(0.2) }, at(0.0, 0.5, 0.5)).solid(1);
    let volume = painted(32, [true, false, false], [ball.clone()]);
    assert!(volume.texel(0, [0, 16, 16]).is_some() && volume.texel(0, [31, 16, 16]).is_some());
    let middle = shape(Form::Ellipsoid { radii: DVec3::splat(0.2) }, at(0.5, 0.5, 0.5)).solid(1);
    let expected = shadows(&painted(32, [false; 3], [middle]))[2];
    assert!((shadows(&volume)[2] - expected).abs() < 0.002);
    let open = painted(32, [false; 3], [ball]);
    assert!((shadows(&open)[2] - 0.5 * expected).abs() < 0.002);
}

/// The concentric scratches of aluminium (Fig. 1): light from the side sees fibres in circles.
#[test]
fn micro_primitives_are_independent_of_the_shape() {
    let mut disc = shape(Form::Disc { radius: 0.45, thickness: 0.1 }, at(0.5, 0.5, 0.5));
    disc.material.flakes = Flakes::Concentric(0.0);
    let volume = one(32, &disc);
    let flakes = volume.texel(0, [26, 16, 16]).expect("filled").flakes;
    assert!(flakes.projected_area(DVec3::Y) < 0.15 * flakes.projected_area(DVec3::X), "{flakes:?}");
    disc.material.flakes = Flakes::Radial;
    let flakes = one(32, &disc).texel(0, [26, 16, 16]).expect("filled").flakes;
    assert!(flakes.projected_area(DVec3::X) < 0.15 * flakes.projected_area(DVec3::Y), "{flakes:?}");
    disc.material.flakes = Flakes::Concentric(0.45);
    let volume = one(32, &disc);
    let spread = |x: u32| {
        let flakes = volume.texel(0, [x, 16, 16]).expect("filled").flakes;
        flakes.projected_area(DVec3::Y) / flakes.projected_area(DVec3::X)
    };
    assert!(
        spread(28) < spread(22) && spread(22) < spread(17),
        "{} {} {}",
        spread(28),
        spread(22),
        spread(17)
    );
    assert!(spread(17) > 0.8);
}

#[test]
fn variation_roughens_what_is_filtered() {
    let wall = |variation: f64| {
        let mut wall = shape(Form::Box { size: DVec3::new(2.0, 2.0, 0.2) }, at(0.5, 0.5, 0.5));
        wall.material.variation = variation;
        let flakes = whole(&one(32, &wall)).flakes;
        flakes.projected_area(DVec3::X) / flakes.projected_area(DVec3::Z)
    };
    assert!(wall(0.0) < 0.02 && (0.2..0.4).contains(&wall(0.3)), "{} {}", wall(0.0), wall(0.3));
}

fn lawn(seed: u64) -> Scatter {
    let form = Form::Blade { height: 0.6, width: 0.05, fold: 0.5, thickness: 0.004, curl: 0.4 };
    Scatter {
        shape: shape(form, at(0.0, 0.0, 0.0)),
        count: 60,
        seed,
        region: [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)],
        jitter: 1.0,
        round: false,
        grid: None,
        comb: DVec3::new(0.4, 0.0, 0.0),
        outward: 0.0,
        spin: 1.0,
        lean: 0.1,
        curl: 0.1,
        size: [0.8, 1.2],
        tint: 0.1,
    }
}

/// Fig. 2: a lawn filters to flakes along the mean direction of its blades.
#[test]
fn a_painted_lawn_faces_away_from_its_mean_direction() {
    let mut lawn = lawn(3);
    lawn.shape.form = Form::Hair { height: 0.6, radius: 0.01, tip: 0.01, curl: 0.0 };
    lawn.lean = 0.0;
    let flakes = whole(&painted(32, [true, true, false], lawn.solids())).flakes;
    let mean = (DVec3::Z + lawn.comb).normalize();
    let across = flakes.projected_area(mean.any_orthonormal_vector());
    assert!(flakes.projected_area(mean) < 0.2 * across, "{flakes:?}");
}

#[test]
fn chance_comes_from_seeds_alone() {
    let make = |seed: u64, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| painted(32, [true, true, false], lawn(seed).solids()))
    };
    let first = make(3, 1);
    assert!(first == make(3, 4));
    assert!(first != make(4, 1));
}

#[test]
fn scattered_shapes_stand_each_in_a_part_of_its_own() {
    let mut lawn = lawn(3);
    (lawn.jitter, lawn.count) = (0.0, 16);
    lawn.shape.form = Form::Ellipsoid { radii: DVec3::splat(0.01) };
    lawn.region = [DVec3::new(0.0, 0.0, 0.5), DVec3::new(1.0, 1.0, 0.5)];
    let volume = painted(16, [false; 3], lawn.solids());
    let mut filled = std::collections::BTreeSet::new();
    volume.for_each(2, |cell, _| {
        filled.insert([cell[0], cell[1]]);
    });
    assert_eq!(filled.len(), 16);
}

/// Specks, by where they stand in cells of a sixteenth.
fn specks(change: impl Fn(&mut Scatter)) -> Vec<[u32; 3]> {
    let mut specks = lawn(3);
    specks.shape.form = Form::Ellipsoid { radii: DVec3::splat(0.01) };
    specks.region = [DVec3::ZERO, DVec3::ONE];
    (specks.size, specks.comb) = ([1.0; 2], DVec3::ZERO);
    change(&mut specks);
    let volume = painted(64, [false; 3], specks.solids());
    let mut found = Vec::new();
    volume.for_each(2, |cell, _| found.push(cell));
    found
}

#[test]
fn a_grid_has_the_parts_that_are_asked_for() {
    let found = specks(|specks| {
        (specks.grid, specks.count, specks.jitter) = (Some([2, 1, 4]), 8, 0.0);
        specks.region = [DVec3::splat(0.03), DVec3::splat(1.03)];
    });
    let expected: Vec<[u32; 3]> = (0..8).map(|i| [4 + 8 * (i % 2), 8, 2 + 4 * (i / 2)]).collect();
    assert!(found.len() == 8 && expected.iter().all(|cell| found.contains(cell)), "{found:?}");
}

#[test]
fn round_regions_have_no_corners() {
    let far = |round: bool| {
        let cells = specks(|specks| (specks.round, specks.count) = (round, 500));
        let distance =
            |cell: &[u32; 3]| (DVec3::from_array(cell.map(f64::from)) / 16.0 + 1.0 / 32.0 - 0.5).length();
        (cells.len(), cells.iter().map(distance).fold(0.0, f64::max))
    };
    let ((round, within), (all, beyond)) = (far(true), far(false));
    assert!(round > 400 && all > 400, "{round} {all}");
    assert!(within < 0.5 + 0.06 && beyond > 0.7, "{within} {beyond}");
}

/// Hairs on a ball's inside stand on it: what is above the middle grows up, what is beside it sideways.
#[test]
fn what_grows_outward_grows_away_from_the_middle() {
    let mut hairs = lawn(3);
    hairs.shape.form = Form::Hair { height: 0.2, radius: 0.004, tip: 0.004, curl: 0.0 };
    hairs.shape.material.flakes = Flakes::Along;
    hairs.region = [DVec3::splat(0.3), DVec3::splat(0.7)];
    (hairs.comb, hairs.lean, hairs.curl, hairs.outward) = (DVec3::ZERO, 0.0, 0.0, 100.0);
    let volume = painted(32, [false; 3], hairs.solids());
    let (mut right, mut all) = (0, 0);
    volume.for_each(0, |cell, texel| {
        let way = DVec3::from_array(cell.map(f64::from)) / 32.0 + 1.0 / 64.0 - 0.5;
        if way.length() > 0.25 {
            let along = texel.flakes.projected_area(way.normalize());
            right += u32::from(along < 0.4);
            all += 1;
        }
    });
    assert!(all > 30 && f64::from(right) > 0.9 * f64::from(all), "{right} of {all}");
}

#[test]
fn what_is_not_spun_keeps_its_way() {
    let mut plates = lawn(3);
    plates.shape.form = Form::Box { size: DVec3::new(0.002, 0.1, 0.1) };
    (plates.comb, plates.lean, plates.region) = (DVec3::ZERO, 0.0, [DVec3::splat(0.1), DVec3::splat(0.9)]);
    let ratio = |spin: f64| {
        let plates = Scatter { spin, ..plates.clone() };
        let flakes = whole(&painted(32, [false; 3], plates.solids())).flakes;
        flakes.projected_area(DVec3::Y) / flakes.projected_area(DVec3::X)
    };
    assert!(ratio(0.0) < 0.25 && ratio(1.0) > 0.8, "{} {}", ratio(0.0), ratio(1.0));
}

/// Said before it is painted, not after minutes.
#[test]
fn too_many_cells_are_refused() {
    let mut builder = Builder::new(1024).expect("a power of two");
    let all = shape(Form::Box { size: DVec3::splat(4.0) }, at(0.5, 0.5, 0.5)).solid(0);
    assert_eq!(paint(&mut builder, [all]), Err(PaintError));
    assert!(builder.is_empty());
}
