//! Voxels, splines, points and patterns: what they interpolate, bounds and gradients.

mod kit;

use fieldstone_field::{Function, Interval};
use fieldstone_solids::{
    Basis, Interpolation, PointCloud, PointError, Reconstruction, SplineError, SplineVolume, VoxelArray,
    VoxelError, checker, fractal_noise, gradient_noise, marble, turbulence, wood,
};
use kit::{Random, check, field, function};

const KINDS: [Interpolation; 3] = [Interpolation::Linear, Interpolation::CatmullRom, Interpolation::BSpline];

fn voxels(counts: [usize; 3], kind: Interpolation, value: impl Fn([f64; 3]) -> f64) -> VoxelArray {
    let steps = [0, 1, 2].map(|k| 4.0 / (counts[k] - 1) as f64);
    let values = (0..counts.iter().product())
        .map(|i| {
            let place = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
            value([0, 1, 2].map(|k| steps[k] * place[k] as f64 - 2.0)) as f32
        })
        .collect();
    VoxelArray::new(counts, values, [[-2.0; 3], steps], kind).expect("an array")
}

fn wavy([x, y, z]: [f64; 3]) -> f64 {
    (1.7 * x).sin() + (2.3 * y + z).cos() * x - 0.5 * z * z
}

#[test]
fn bounds_of_voxels_hold_and_gradients_are_exact() {
    for kind in KINDS {
        let name = format!("{kind:?}");
        let (_, lines) = check(&name, &function(voxels([9, 12, 7], kind, wavy)), 4);
        assert!(lines > 40, "{name}: {lines}");
        check(&name, &function(voxels([2, 2, 3], kind, wavy)), 1);
    }
}

#[test]
fn interpolation_passes_through_the_numbers() {
    for kind in [Interpolation::Linear, Interpolation::CatmullRom] {
        let array = voxels([9, 9, 9], kind, wavy);
        for i in 0..9 {
            let p = [-2.0 + 0.5 * f64::from(i), 0.5, -1.0];
            assert!((array.value(&p) - wavy(p)).abs() < 1e-6);
        }
    }
}

#[test]
fn planes_are_reproduced() {
    let plane = |[x, y, z]: [f64; 3]| 2.0 * x - y + 0.5 * z + 1.0;
    for kind in KINDS {
        let array = voxels([9, 9, 9], kind, plane);
        let mut random = Random(1);
        for _ in 0..100 {
            // Not in the outermost cells, where cubic kinds repeat the numbers of the sides.
            let p = [0; 3].map(|_| 2.8 * random.unit() - 1.4);
            assert!((array.value(&p) - plane(p)).abs() < 1e-5, "{kind:?}");
        }
    }
}

#[test]
fn large_boxes_are_bounded_by_the_numbers_in_them() {
    // One high number in a field of zeros.
    let array = voxels([65, 65, 65], Interpolation::Linear, |p| f64::from(u8::from(p == [1.0; 3])));
    let range = |lo: f64, hi: f64| array.interval(&[Interval::new(lo, hi); 3]);
    assert!(range(-2.0, 2.0).hi >= 1.0 && range(0.5, 1.5).hi >= 1.0);
    assert!(range(-2.0, -0.5).hi < 1e-9 && range(-0.4, 0.3).hi < 1e-9);
    let outside = array.interval(&[Interval::new(-9.0, -3.0); 3]);
    assert!(outside.contains(0.0) && outside.width() < 1e-9);
}

#[test]
fn arrays_that_are_none_are_refused() {
    let new = |counts, values, step| {
        VoxelArray::new(counts, values, [[0.0; 3], [step; 3]], Interpolation::Linear).map(|_| ())
    };
    assert_eq!(new([1, 2, 2], vec![0.0; 4], 1.0), Err(VoxelError::Counts([1, 2, 2])));
    assert_eq!(new([usize::MAX, 2, 2], vec![], 1.0), Err(VoxelError::Counts([usize::MAX, 2, 2])));
    assert_eq!(new([2; 3], vec![0.0; 7], 1.0), Err(VoxelError::Missing { needed: 8, found: 7 }));
    assert_eq!(new([2; 3], vec![f32::NAN; 8], 1.0), Err(VoxelError::NotFinite(0)));
    assert_eq!(new([2; 3], vec![0.0; 8], 0.0), Err(VoxelError::Placement));
}

#[test]
fn spline_volumes_follow_their_control_values() {
    let random_controls = |count: usize| {
        let mut random = Random(9);
        (0..count).map(|_| 2.0 * random.unit() - 1.0).collect::<Vec<f64>>()
    };
    let place = [[-2.0, -1.5, -2.0], [2.0, 2.0, 1.0]];
    for (basis, counts) in [(Basis::Bezier, [4, 3, 5]), (Basis::BSpline, [6, 4, 8])] {
        let volume = SplineVolume::new(counts, random_controls(counts.iter().product()), basis, place)
            .expect("a volume");
        let (_, lines) = check(&format!("{basis:?}"), &function(volume), 4);
        assert!(lines > 20, "{basis:?}: {lines}");
    }
    // Bézier: the corners are control values, and equally spaced values along x give x.
    let controls: Vec<f64> = (0..4 * 2 * 2).map(|i| f64::from(i % 4) / 3.0).collect();
    let line = SplineVolume::new([4, 2, 2], controls, Basis::Bezier, [[0.0; 3], [1.0; 3]]).expect("a volume");
    for x in [0.0, 0.3, 1.0] {
        assert!((line.value(&[x, 0.2, 0.9]) - x).abs() < 1e-15);
    }
    let few = SplineVolume::new([3, 4, 4], vec![0.0; 48], Basis::BSpline, place).err();
    assert!(matches!(few, Some(SplineError::Counts { counts: [3, 4, 4], .. })));
}

/// Points of an ellipsoid, spread like the seeds of a sunflower.
fn ellipsoid(count: usize, half_axes: [f64; 3]) -> PointCloud {
    let mut cloud = PointCloud::default();
    for i in 0..count {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let angle = i as f64 * 2.399_963_229_728_653;
        let radius = (1.0 - z * z).sqrt();
        let unit = [radius * angle.cos(), radius * angle.sin(), z];
        cloud.points.push([0, 1, 2].map(|k| unit[k] * half_axes[k]));
        cloud.normals.push([0, 1, 2].map(|k| unit[k] / half_axes[k]));
    }
    cloud
}

#[test]
fn points_of_an_ellipsoid_make_an_ellipsoid() {
    for count in [150, 3000] {
        let half_axes = [1.4, 1.0, 0.7];
        let cloud = ellipsoid(count, half_axes);
        let solid = cloud.reconstruct(&Reconstruction::default()).expect("a solid");
        for p in &cloud.points {
            assert!(solid.value(p).abs() < 1e-6, "{}", solid.value(p));
        }
        let mut random = Random(2);
        for _ in 0..1000 {
            let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
            let exact = (0..3).map(|k| (p[k] / half_axes[k]).powi(2)).sum::<f64>().sqrt() - 1.0;
            // The sign is right but very near to the surface.
            assert!(exact.abs() < 0.02 || solid.value(&p) * exact > 0.0, "{count}: {p:?} {exact}");
        }
        let (_, lines) = check("points", &function(solid), 1);
        assert!(lines > 20, "{lines}");
    }
}

#[test]
fn points_that_make_no_solid_are_refused() {
    let options = Reconstruction::default();
    let refusal = |cloud: &PointCloud| cloud.reconstruct(&options).err();
    assert_eq!(refusal(&ellipsoid(3, [1.0; 3])), Some(PointError::Count(3)));
    let mut cloud = ellipsoid(20, [1.0; 3]);
    cloud.normals[7] = [0.0; 3];
    assert_eq!(refusal(&cloud), Some(PointError::Point(7)));
    cloud.normals.pop();
    assert_eq!(refusal(&cloud), Some(PointError::Normals { points: 20, normals: 19 }));
    let mut same = ellipsoid(20, [1.0; 3]);
    same.points[1] = same.points[0];
    same.normals[1] = same.normals[0];
    assert_eq!(refusal(&same), Some(PointError::Singular));
    let wrong = Reconstruction { offset: 0.0, ..options };
    assert_eq!(ellipsoid(20, [1.0; 3]).reconstruct(&wrong).err(), Some(PointError::Options));
}

#[test]
fn patterns_keep_their_ranges_and_bounds() {
    let mut random = Random(3);
    let patterns = [
        ("noise", field(|g, [x, y, z]| g.call(gradient_noise(), &[x, y, z])), [-0.87, 0.87]),
        (
            "fractal",
            field(|g, p| {
                let [octaves, gain] = [5.0, 0.5].map(|k| g.constant(k));
                fractal_noise(g, p, octaves, gain)
            }),
            [-1.75, 1.75],
        ),
        (
            "turbulence",
            field(|g, p| {
                let [octaves, gain] = [5.0, 0.5].map(|k| g.constant(k));
                turbulence(g, p, octaves, gain)
            }),
            [0.0, 1.75],
        ),
        (
            "marble",
            field(|g, p| {
                let s = g.constant(1.0);
                marble(g, p, s)
            }),
            [0.0, 1.0],
        ),
        (
            "wood",
            field(|g, p| {
                let s = g.constant(0.3);
                wood(g, p, s)
            }),
            [0.0, 1.0],
        ),
        ("checker", field(checker), [0.0, 1.0]),
    ];
    for (name, pattern, [low, high]) in patterns {
        let mut seen = [f64::INFINITY, f64::NEG_INFINITY];
        for _ in 0..2000 {
            let v = kit::at(&pattern, [0; 3].map(|_| 20.0 * random.unit() - 10.0));
            seen = [seen[0].min(v), seen[1].max(v)];
        }
        assert!(low <= seen[0] && seen[1] <= high, "{name}: {seen:?}");
        assert!(seen[1] - seen[0] > 0.3 * (high - low), "{name}: {seen:?}");
        check(name, &pattern, 1);
    }
}

#[test]
fn octaves_fade_in_one_after_another() {
    let p = [0.3, 0.45, -1.2];
    let of_octaves = |octaves: f64| {
        let fixed = kit::at(
            &field(|g, p| {
                let [octaves, gain] = [octaves, 0.5].map(|k| g.constant(k));
                fractal_noise(g, p, octaves, gain)
            }),
            p,
        );
        // The number of octaves as a value that is not known before.
        let varying = field(|g, p| {
            let [gain, zero, octaves] = [0.5, 0.0, octaves].map(|k| g.constant(k));
            let nothing = g.mul(zero, p[0]);
            let octaves = g.add(octaves, nothing);
            fractal_noise(g, p, octaves, gain)
        });
        assert!((kit::at(&varying, p) - fixed).abs() < 1e-15);
        fixed
    };
    let noise = |scale: f64, shift: f64| gradient_noise().value(&p.map(|x| x * scale + shift));
    assert_eq!(of_octaves(0.0), 0.0);
    assert_eq!(of_octaves(1.0), noise(1.0, 0.0));
    assert_eq!(of_octaves(2.0), noise(1.0, 0.0) + 0.5 * noise(2.0, 0.37));
    assert!((of_octaves(1.5) - noise(1.0, 0.0) - 0.25 * noise(2.0, 0.37)).abs() < 1e-15);
}

/// Numbers and places that are small multiples of powers of two, so that the interpolated value is exact in 128 bits.
#[test]
fn bounds_of_points_hold_exact_values() {
    let counts = [17, 5, 9];
    let mut random = Random(21);
    let numbers: Vec<i32> =
        (0..counts.iter().product()).map(|_| (4e6 * random.unit()) as i32 - 2_000_000).collect();
    let values = numbers.iter().map(|n| *n as f32).collect();
    let array =
        VoxelArray::new(counts, values, [[0.0; 3], [1.0; 3]], Interpolation::Linear).expect("an array");
    let mut widest = 0.0f64;
    for _ in 0..2000 {
        // Places in cells as multiples of 2⁻²⁰.
        let place = [0, 1, 2].map(|k| (random.unit() * (counts[k] - 1) as f64 * f64::from(1 << 20)) as i64);
        let point = place.map(|p| p as f64 / f64::from(1 << 20));
        let (cell, part) = (place.map(|p| (p >> 20) as usize), place.map(|p| i128::from(p & 0xF_FFFF)));
        let exact: i128 = (0..8)
            .map(|c| {
                let i = [0, 1, 2].map(|k| cell[k] + (c >> k & 1));
                let weight = (0..3).map(|k| if c >> k & 1 == 1 { part[k] } else { (1 << 20) - part[k] });
                let weight: i128 = weight.product();
                weight * i128::from(numbers[(i[0] + 17 * (i[1] + 5 * i[2])).min(numbers.len() - 1)])
            })
            .sum();
        let bound = array.interval(&point.map(|x| Interval::new(x, x)));
        // The ends as multiples of 2⁻⁶⁰, rounded inward.
        let [lo, hi] = [bound.lo, bound.hi].map(|end| end * 2f64.powi(60));
        assert!(lo as i128 <= exact && exact <= hi as i128, "{exact} {bound:?}");
        widest = widest.max(bound.width());
    }
    // Of numbers up to two millions.
    assert!(widest < 2e-12 * 2e6, "{widest}");
}
