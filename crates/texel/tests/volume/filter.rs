use super::{Chance, scattered};
use fieldstone_texel::{Builder, Mode, Sggx, Texel, Volume};
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// A cube whose cells are filled by a function of their centres.
fn filled(edge: u32, mode: Mode, content: impl Fn(DVec3) -> Option<Texel>) -> Volume {
    let mut builder = Builder::new(edge).expect("a power of two");
    for key in 0..edge.pow(3) {
        let cell = [key % edge, key / edge % edge, key / edge / edge];
        let centre = DVec3::from_array(cell.map(|c| (f64::from(c) + 0.5) / f64::from(edge)));
        if let Some(texel) = content(centre) {
            builder.insert(cell, &texel);
        }
    }
    builder.build(mode).expect("few cells")
}

fn whole(volume: &Volume) -> Texel {
    volume.texel(volume.levels() - 1, [0; 3]).expect("filled")
}

fn transmittance(texel: &Texel, axis: usize) -> f64 {
    f64::from(-texel.depth[axis]).exp()
}

/// Cells of 2³ that are opaque, and the transmittances along x, y and z that follow.
#[test]
fn transmittances_are_products_along_and_means_across() {
    let opaque = Texel { density: 40.0, depth: [20.0; 3], ..Texel::default() };
    let cases: [(&[u32], [f64; 3]); 4] = [
        (&[0], [0.75, 0.75, 0.75]),
        (&[0, 1], [0.75, 0.5, 0.5]),
        (&[0, 2, 4, 6], [0.0, 0.5, 0.5]),
        (&[0, 3, 5, 6], [0.0, 0.0, 0.0]),
    ];
    for (octants, expected) in cases {
        let mut builder = Builder::new(2).expect("a power of two");
        for octant in octants {
            builder.insert([octant & 1, octant >> 1 & 1, octant >> 2], &opaque);
        }
        let texel = whole(&builder.build(Mode::Sggx).expect("few cells"));
        for (axis, expected) in expected.iter().enumerate() {
            assert!((transmittance(&texel, axis) - expected).abs() < 1e-3, "{octants:?}: {texel:?}");
        }
    }
}

/// A cell of any level passes, along an axis, what the columns of finest cells through it pass in the mean.
#[test]
fn no_level_loses_or_gains_light_along_the_axes() {
    let (volume, cells) = scattered(16, 1500, Mode::Sggx);
    for level in 1..=4 {
        let mut columns = BTreeMap::new();
        for (cell, texel) in &cells {
            let node = cell.map(|c| c >> level);
            *columns.entry((node, cell[0], cell[2])).or_insert(0.0) += f64::from(texel.depth[1]);
        }
        let mut absorbed = BTreeMap::new();
        for ((node, _, _), depth) in columns {
            *absorbed.entry(node).or_insert(0.0) += 1.0 - f64::exp(-depth);
        }
        for (node, absorbed) in absorbed {
            let texel = volume.texel(level, node).expect("filled");
            let expected = 1.0 - absorbed / f64::from(4u32.pow(level));
            assert!((transmittance(&texel, 1) - expected).abs() < 2e-3, "{level} {node:?}");
        }
    }
}

/// The extinction that the depths of a cell speak of, an opaque one taken for a depth of 5.
fn occlusion(texel: &Texel, width: f64) -> f64 {
    let depth: f64 = texel.depth.iter().map(|depth| f64::from(*depth).min(5.0)).sum();
    depth / (width * DVec3::AXES.iter().map(|w| texel.flakes.projected_area(*w)).sum::<f64>())
}

#[test]
fn mean_extinction_and_colour_are_kept_exactly() {
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let (volume, cells) = scattered(16, 1500, mode);
        let weight = |texel: &Texel| match mode {
            Mode::Sggx => f64::from(texel.density),
            Mode::Neyret1995 => occlusion(texel, 1.0 / 16.0),
        };
        let total: f64 = cells.iter().map(|(_, texel)| weight(texel)).sum();
        let red: f64 = cells.iter().map(|(_, t)| weight(t) * f64::from(t.albedo[0])).sum();
        let texel = whole(&volume);
        assert!((f64::from(texel.density) / (total / 4096.0) - 1.0).abs() < 0.005);
        assert!((f64::from(texel.albedo[0]) - red / total).abs() < 0.005);
        assert!((texel.flakes.mean_projected_area() - 1.0).abs() < 0.01);
    }
}

/// The mean of S over all leaves is the S of the whole: filtering by steps is filtering at once.
#[test]
fn means_of_s_do_not_depend_on_the_levels_between() {
    let (volume, cells) = scattered(16, 1500, Mode::Sggx);
    let mut sum = DMat3::ZERO;
    for (_, texel) in &cells {
        sum += texel.flakes.matrix() * f64::from(texel.density);
    }
    let expected = Sggx::from_matrix(sum).normalised();
    let found = whole(&volume).flakes;
    for (a, b) in expected.entries().iter().zip(found.entries()) {
        assert!((a - b).abs() < 0.015, "{expected:?} {found:?}");
    }
}

/// Blades of grass filter to a primitive along their mean direction (Fig. 2 of the paper).
#[test]
fn a_lawn_filters_to_an_ellipsoid_along_its_mean_direction() {
    let lean = DVec3::new(0.3, 0.1, 1.0).normalize();
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let mut chance = Chance(8);
        let mut builder = Builder::new(16).expect("a power of two");
        for key in 0..4096 {
            let tangent = (lean + 0.25 * chance.direction()).normalize();
            let (side, _) = tangent.any_orthonormal_pair();
            let axes = DMat3::from_cols(0.05 * side, 0.05 * tangent.cross(side), tangent);
            let texel = Texel::even(3.0, Sggx::ellipsoid(axes), 1.0 / 16.0);
            builder.insert([key & 15, key >> 4 & 15, key >> 8], &texel);
        }
        let flakes = whole(&builder.build(mode).expect("few cells")).flakes;
        let (u, v) = lean.any_orthonormal_pair();
        let along = flakes.projected_area(lean);
        let across = [flakes.projected_area(u), flakes.projected_area(v)];
        assert!(along < 0.45 * across[0] && along < 0.45 * across[1], "{mode:?}: {along} {across:?}");
        assert!((across[0] / across[1] - 1.0).abs() < 0.06, "{mode:?}: {across:?}");
        // The direction in which least is seen is the mean direction, to 4 degrees.
        let least = (0..20_000)
            .map(|_| chance.direction())
            .min_by(|a, b| flakes.projected_area(*a).total_cmp(&flakes.projected_area(*b)));
        let angle = least.expect("directions").dot(lean).abs().min(1.0).acos().to_degrees();
        assert!(angle < 4.0, "{mode:?}: {angle}");
    }
}

/// The wall of a wide cylinder filters to a quasi-cylinder (Fig. 3): nothing is seen of it from above. The rule of
/// 1995 gives a squat ellipsoid instead: its view from above stays at more than half of that from the side.
#[test]
fn a_wide_cylinder_filters_to_a_quasi_cylinder() {
    let wall = |centre: DVec3| {
        let out = DVec3::new(centre.x - 0.5, centre.y - 0.5, 0.0);
        let is_wall = (0.38..0.45).contains(&out.length());
        is_wall.then(|| Texel::even(100.0, Sggx::surface(out.normalize(), 0.0), 1.0 / 32.0))
    };
    let sggx = whole(&filled(32, Mode::Sggx, wall)).flakes;
    let side = sggx.projected_area(DVec3::X);
    assert!(sggx.projected_area(DVec3::Z) < 0.01 * side, "{sggx:?}");
    assert!((sggx.projected_area(DVec3::Y) / side - 1.0).abs() < 0.01);
    let old = whole(&filled(32, Mode::Neyret1995, wall)).flakes;
    let ratio = old.projected_area(DVec3::Z) / old.projected_area(DVec3::X);
    assert!((0.5..0.9).contains(&ratio), "{ratio}");
}

/// What the paper says of itself: opaque things thin out, level by level. Transmittances along the axes do not.
#[test]
fn a_wall_stays_opaque_only_where_transmittances_are_filtered() {
    let wall = |centre: DVec3| {
        let opaque = Texel { density: 100.0, depth: [20.0; 3], ..Texel::default() };
        (centre.x < 1.0 / 32.0).then_some(opaque)
    };
    let sggx = whole(&filled(32, Mode::Sggx, wall));
    let old = whole(&filled(32, Mode::Neyret1995, wall));
    assert!(transmittance(&sggx, 0) < 1e-8, "{sggx:?}");
    assert!((transmittance(&sggx, 1) - 31.0 / 32.0).abs() < 1e-3, "{sggx:?}");
    assert!((transmittance(&old, 0) / f64::exp(-5.0) - 1.0).abs() < 0.05, "{old:?}");
    assert!(transmittance(&old, 1) < 0.01, "{old:?}");
}

#[test]
fn filtering_anew_is_filtering_at_first() {
    let (sggx, _) = scattered(16, 600, Mode::Sggx);
    let (old, _) = scattered(16, 600, Mode::Neyret1995);
    assert!(sggx.filtered(Mode::Neyret1995).expect("few cells") == old);
    assert!(old.filtered(Mode::Sggx).expect("few cells") == sggx);
}
