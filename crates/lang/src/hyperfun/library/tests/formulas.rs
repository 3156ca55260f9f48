//! Kernels, primitives, attributes, and calls that are wrong.

use super::{Dialect, Given, Random, call, value};

fn array(values: &[f64]) -> Given {
    Given::Array(values.to_vec())
}

fn reals(values: &[f64]) -> Vec<Given> {
    values.iter().map(|&v| Given::Real(v)).collect()
}

fn error(name: &str, given: &[Given], point: &[f64]) -> String {
    call(Dialect::Lenient, name, given, point).expect_err("the call is wrong")
}

/// The array with a number after a call in a dialect.
fn written(dialect: Dialect, name: &str, given: &[Given], point: &[f64], array: usize) -> Vec<f64> {
    call(dialect, name, given, point).expect("the call is right").arrays[array].clone()
}

const INVALID: f64 = -1111111111111.0;

#[test]
fn calls_that_describe_nothing_are_invalid() {
    let center = array(&[0.0; 3]);
    let p = [0.1, 0.2, 0.3];
    let call = |name: &str, numbers: &[f64]| {
        let given = [vec![Given::Point, center.clone()], reals(numbers)].concat();
        value(name, &given, &p)
    };
    for name in ["hfEllipsoid", "hfDEllipsoid"] {
        assert_eq!(call(name, &[1.0, 0.0, 1.0]), INVALID);
        assert_ne!(call(name, &[1.0, 1.0, 1.0]), INVALID);
    }
    assert_eq!(call("hfEllCylX", &[1.0, 0.0]), INVALID);
    assert_eq!(call("hfEllConeZ", &[0.0, 1.0]), INVALID);
    assert_eq!(call("hfConeY", &[0.0]), INVALID);
    assert_eq!(call("hfSuperell", &[1.0, 1.0, 1.0, 1.0, 0.0]), INVALID);
    assert_eq!(call("hfBlock", &[1.0, -1.0, 1.0]), INVALID);
    assert_eq!(value("hfSphere", &[Given::Point, center.clone(), Given::Real(1.0)], &[0.1, 0.2]), INVALID);
}

#[test]
fn wrong_arrays_are_errors_with_their_sizes() {
    let p = [0.1, 0.2, 0.3];
    let sphere = [Given::Point, array(&[0.0; 2]), Given::Real(1.0)];
    assert_eq!(error("hfSphere", &sphere, &p), "`center` must have 3 elements, not 2");
    let swapped = [Given::Point, Given::Real(1.0), array(&[0.0; 3])];
    assert_eq!(error("hfSphere", &swapped, &p), "`center` must be an array, not a number");
    assert_eq!(error("hfSphere", &sphere[..2], &p), "3 arguments are needed, not 2");
    let soft = [
        Given::Point,
        array(&[0.0; 2]),
        array(&[0.0; 2]),
        array(&[0.0; 3]),
        array(&[1.0; 2]),
        Given::Real(0.0),
    ];
    assert_eq!(error("hfSoft", &soft, &p), "`z0` must have 2 elements, not 3");
    let shift = [vec![Given::Point], reals(&[1.0, 2.0, 3.0])].concat();
    assert_eq!(error("hfShift3D", &shift, &p[..2]), "`xt` must have 3 elements, not 2");
    let mesh = [Given::Point, array(&[0.0; 9]), array(&[1.0, 2.0, 4.0]), array(&[1.0]), Given::Real(0.0)];
    assert_eq!(error("hfConvMesh", &mesh, &p), "`tri` holds 4, but there are 3 points");
    let bezier =
        [vec![Given::Point], reals(&[2.0, 2.0, 22.0]), vec![array(&[0.0; 6]), array(&[0.0; 8])]].concat();
    assert_eq!(error("hfBezierVolume", &bezier, &p), "`n` must be a whole number from 1 to 21, not 22");
    let endless = error("hfSawtooth", &reals(&[0.0, 1e9, 1.0, 1.0]), &p);
    assert_eq!(endless, "`n` must be at most 4096, not 1000000000");
}

#[test]
fn cut_off_kernels_are_their_pieces() {
    let ball = |name: &str, parameters: &[&[f64]], r: f64| {
        let centers = [array(&[0.0]), array(&[0.0]), array(&[0.0])];
        let arrays: Vec<_> = parameters.iter().map(|p| array(p)).collect();
        let given = [vec![Given::Point], centers.to_vec(), arrays, vec![Given::Real(0.0)]].concat();
        value(name, &given, &[r, 0.0, 0.0])
    };
    let (b, d) = (1.7, 1.3);
    for i in 0..200 {
        let r = f64::from(i) * 0.01;
        let ratio = r / d;
        let metaball = match ratio {
            ratio if ratio <= 1.0 / 3.0 => b * (1.0 - 3.0 * ratio * ratio),
            ratio if ratio < 1.0 => 1.5 * b * (1.0 - ratio).powi(2),
            _ => 0.0,
        };
        assert!((ball("hfMetaball", &[&[b], &[d]], r) - metaball).abs() < 1e-14);
        let t = ratio * ratio;
        let soft =
            if r <= d { 1.0 - 22.0 / 9.0 * t + 17.0 / 9.0 * t * t - 4.0 / 9.0 * t.powi(3) } else { 0.0 };
        assert!((ball("hfSoft", &[&[d]], r) - soft).abs() < 1e-14);
    }
    assert_eq!(ball("hfMetaball", &[&[b], &[d]], 1e6), 0.0);
    assert_eq!(ball("hfMetaball", &[&[b], &[-1.0]], 0.0), 0.0);
    assert_eq!(ball("hfSoft", &[&[0.0]], 0.0), 0.0);
}

#[test]
fn a_mapped_blob_exists_in_the_lenient_dialect_only() {
    let one = array(&[0.0, 0.0]);
    let given = [
        Given::Point,
        Given::Real(5.0),
        one.clone(),
        one.clone(),
        one,
        array(&[2.0, 3.0]),
        array(&[0.5, 1e-7]),
    ];
    // The second dent is too narrow to count.
    assert_eq!(value("hfFMapBlob", &given, &[1.0, 0.0, 0.0]), 5.0 - 2.0 / (1.0 + 1.0 / 0.25));
    assert!(call(Dialect::Strict, "hfFMapBlob", &given, &[1.0, 0.0, 0.0]).is_err());
}

#[test]
fn a_taper_stops_at_its_ends() {
    let taper = |x: f64, k1: f64, k2: f64| {
        let given = [vec![Given::Point], reals(&[k1, k2, 2.0, 4.0])].concat();
        written(Dialect::Lenient, "hfTaperX", &given, &[x, 1.0, -1.0], 0)
    };
    assert_eq!(taper(-9.0, 0.0, 1.0), [-9.0, 0.5, -0.5]);
    assert_eq!(taper(9.0, 0.0, 1.0), [9.0, 0.25, -0.25]);
    assert_eq!(taper(-9.0, 1.0, 1.0), [-9.0, 0.5, -0.5]);
    assert_eq!(taper(9.0, 1.0, 1.0), [9.0, 0.25, -0.25]);
    let flat = [vec![Given::Point], reals(&[0.0, 1.0, 0.0, 0.0])].concat();
    assert_eq!(written(Dialect::Lenient, "hfTaperX", &flat, &[0.5, 1.0, 2.0], 0), [0.5, 1.0, 2.0]);
}

#[test]
fn a_union_of_attributes_asks_which_operand_is_inside() {
    let union = |f: f64, g: f64, op: f64| {
        let arrays = [array(&[9.0, 9.0]), array(&[1.0, 5.0]), array(&[2.0, 3.0])];
        let given = [reals(&[f, g]), arrays.to_vec(), reals(&[op])].concat();
        written(Dialect::Lenient, "hfA_Union", &given, &[], 0)
    };
    assert_eq!(union(1.0, -1.0, 1.0), [1.0, 5.0]);
    assert_eq!(union(-1.0, 1.0, 0.0), [2.0, 3.0]);
    assert_eq!(union(-1.0, -1.0, 0.0), [9.0, 9.0]);
    assert_eq!(union(1.0, 1.0, 2.0), [3.0, 8.0]);
    assert_eq!(union(1.0, 1.0, 3.0), [1.0, 3.0]);
    assert_eq!(union(1.0, 1.0, 4.0), [2.0, 5.0]);
    assert_eq!(union(1.0, 1.0, 7.0), [9.0, 9.0]);
}

#[test]
fn tables_end_with_their_last_entries() {
    let look_up = |dialect: Dialect, name: &str, t: f64| {
        let given = [Given::Real(t), array(&[7.0]), array(&[10.0, 20.0, 40.0]), array(&[1.0, 2.0, 2.0])];
        written(dialect, name, &given, &[], 0)[0]
    };
    for (t, step, slope) in
        [(1.0, 10.0, 10.0), (1.25, 10.0, 12.5), (1.75, 10.0, 17.5), (2.0, 40.0, 40.0), (9.0, 40.0, 40.0)]
    {
        for dialect in [Dialect::Lenient, Dialect::Strict] {
            assert_eq!(look_up(dialect, "hfA_LookUpTable", t), step);
            assert_eq!(look_up(dialect, "hfA_SmoothLookUpTable", t), slope);
        }
    }
    for name in ["hfA_LookUpTable", "hfA_SmoothLookUpTable"] {
        assert_eq!(look_up(Dialect::Lenient, name, 0.0), 10.0);
        assert_eq!(look_up(Dialect::Strict, name, 0.0), 40.0);
    }
}

#[test]
fn a_spline_passes_its_inner_knots() {
    let knots = [9.0, 1.0, 4.0, 2.0, 8.0];
    let spline = |t: f64| {
        let given = [vec![array(&[0.0]), array(&knots)], reals(&[t, 0.0, 2.0])].concat();
        written(Dialect::Lenient, "hfA_Spline", &given, &[], 0)[0]
    };
    assert_eq!([-0.1, 0.0, 1.0, 2.0, 2.1].map(spline), [9.0, 1.0, 4.0, 2.0, 8.0]);
    assert!((spline(1.0 - 1e-9) - 4.0).abs() < 1e-8);
}

#[test]
fn colours_survive_a_round_trip_through_hsv() {
    let mut random = Random(13);
    for _ in 0..1000 {
        let color: [f64; 3] = random.point([(0.0, 1.0); 3]);
        let hsv = written(Dialect::Lenient, "hfA_RGBToHSV", &[Given::Point, array(&[0.0; 3])], &color, 1);
        assert!(hsv[0] >= -60.0 && hsv[0] <= 300.0);
        let back = written(Dialect::Lenient, "hfA_HSVToRGB", &[Given::Point, array(&[0.0; 3])], &hsv, 1);
        assert!((0..3).all(|k| (back[k] - color[k]).abs() < 1e-14), "{color:?} became {back:?}");
    }
    let grey = written(Dialect::Lenient, "hfA_RGBToHSV", &[Given::Point, array(&[9.0; 3])], &[0.0; 3], 1);
    assert_eq!(grey, [0.0, 0.0, 0.0]);
}

#[test]
fn remainders_take_the_sign_of_c() {
    let modulo = |a: f64, b: f64| value("hfA_Modulo", &reals(&[a, b]), &[]);
    assert_eq!(
        [modulo(7.5, 2.0), modulo(-7.5, 2.0), modulo(7.5, -2.0), modulo(-7.5, -2.0)],
        [1.5, 0.5, 1.5, -3.5]
    );
}

#[test]
fn a_checker_board_has_blocks_and_gaps_on_both_sides_of_zero() {
    let board = |x: f64| {
        let arrays = [&[1.0; 3], &[0.5; 3]].map(|a| array(a));
        let rest = [array(&[0.0]), array(&[1.0]), array(&[2.0])];
        let given = [vec![Given::Point], arrays.to_vec(), rest.to_vec()].concat();
        written(Dialect::Lenient, "hfA_CheckerBoard", &given, &[x, 0.5, 0.5], 3)[0]
    };
    assert_eq!([0.5, 1.2, 1.7, -0.2, -0.7, -1.4, -1.7].map(board), [1.0, 2.0, 1.0, 2.0, 1.0, 1.0, 2.0]);
}
