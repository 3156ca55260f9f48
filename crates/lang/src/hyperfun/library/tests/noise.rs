//! Perlin's noise and what is made of it.

use super::{Dialect, Given, Random, call, check_gradient, check_inclusion, value};
use fieldstone_field::Interval;
use fieldstone_solids::gradient_noise;

const SPACE: [(f64, f64); 3] = [(-300.0, 300.0); 3];

fn perlin(p: [f64; 3]) -> f64 {
    gradient_noise().value(&p)
}

#[test]
fn intervals_of_perlin_noise_hold_its_values() {
    check_inclusion(&**gradient_noise(), SPACE);
    check_inclusion(&**gradient_noise(), [(-1.5, 1.5); 3]);
    let everywhere = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    let interval = gradient_noise().interval(&[everywhere; 3]);
    assert!(interval.hi - interval.lo < 1.74);
}

#[test]
fn gradients_of_perlin_noise_are_exact() {
    check_gradient(&**gradient_noise(), [(-9.0, 9.0); 3]);
}

#[test]
fn perlin_noise_vanishes_at_whole_points_and_varies_between() {
    let mut random = Random(9);
    let (mut low, mut high) = (0f64, 0f64);
    for _ in 0..20_000 {
        let p = random.point(SPACE);
        assert_eq!(perlin(p.map(f64::round)), 0.0);
        low = low.min(perlin(p));
        high = high.max(perlin(p));
    }
    assert!((-0.87..-0.5).contains(&low) && (0.5..0.87).contains(&high), "{low} {high}");
}

#[test]
fn perlin_noise_repeats_after_256_cells() {
    let p = [0.25, -3.5, 7.125];
    assert_ne!(perlin(p), 0.0);
    assert_eq!(perlin([p[0] + 256.0, p[1] - 512.0, p[2]]), perlin(p));
    // The tables never change: pictures depend on them.
    assert!((perlin(p) - PERLIN_AT_P).abs() < 1e-15, "{}", perlin(p));
    assert!(perlin([f64::INFINITY, 0.0, 0.0]).is_nan());
}

const PERLIN_AT_P: f64 = -0.3517760190552075;

#[test]
fn turbulence_adds_octaves_up_to_the_frequency() {
    let p = [0.3, 0.6, -1.7];
    let octave = |f: f64| (2.0 * perlin(p.map(|x| x * f)) - 1.0).abs() / f;
    let turbulence = |f: f64| value("hfA_Turbulence", &[Given::Point, Given::Real(f)], &p);
    assert!((turbulence(5.0) - octave(5.0) - octave(2.5) - octave(1.25)).abs() < 1e-15);
    assert_eq!(turbulence(0.99), 0.0);
    let endless = call(Dialect::Lenient, "hfA_Turbulence", &[Given::Point, Given::Real(f64::INFINITY)], &p);
    assert_eq!(endless.unwrap_err(), "`freq` must be finite");
}
