//! Noise and waves: Gardner's series of sines, Perlin's gradient noise, and a sawtooth.

use super::call::{Call, Failure, Outcome};
use super::expression::{Expr, Vector};
use fieldstone_solids::gradient_noise;

/// hfNoiseG: Gardner's series.
pub(super) fn gardner<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [amplitude, frequency, phase] = call.reals(1);
    Ok(gardner_series(call.point(0)?, amplitude, frequency, phase))
}

/// The product of a two-term series in each coordinate; the second term's phase is the sine of another coordinate.
fn gardner_series<'g>(p: Vector<'g>, amplitude: Expr<'g>, frequency: Expr<'g>, phase: Expr<'g>) -> Expr<'g> {
    let q = p.map(|x| x * frequency);
    let sines = q.map(Expr::sin).0;
    let second = amplitude / 1.17;
    let [x, y, z] =
        [0, 1, 2].map(|k| amplitude * sines[k] + second * (q.0[k] / 1.35 + phase * sines[(k + 2) % 3]).sin());
    x * y * z
}

/// hfA_NoiseG: Gardner's series of amplitude 1, mapped from its range to \[0, 1\].
pub(super) fn unit_gardner<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    Ok(unit_gardner_at(call.point(0)?, call.real(1), call.real(2)))
}

pub(super) fn unit_gardner_at<'g>(p: Vector<'g>, frequency: Expr<'g>, phase: Expr<'g>) -> Expr<'g> {
    let range = (2.17f64 / 1.17).powi(3);
    (gardner_series(p, frequency.number(1.0), frequency, phase) + range) / (2.0 * range)
}

/// hfA_NoiseP: Perlin's gradient noise.
pub(super) fn perlin<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    Ok(perlin_at(call.point(0)?))
}

fn perlin_at(p: Vector<'_>) -> Expr<'_> {
    let [x, y, z] = p.0;
    x.call(gradient_noise(), &[y, z])
}

/// hfA_Turbulence: Σ |2·NoiseP(F·x) − 1|/F for F = freq, freq/2, … down to 1.
pub(super) fn turbulence<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let x = call.point(0)?;
    let mut frequency = call.constant(1)?;
    if frequency == f64::INFINITY {
        return Err(Failure::Message(format!("`{}` must be finite", call.name(1))));
    }
    let mut octaves = Vec::new();
    while frequency >= 1.0 {
        octaves.push((2.0 * perlin_at(x.map(|x| x * frequency)) - 1.0).abs() / frequency);
        frequency /= 2.0;
    }
    Ok(call.sum(octaves))
}

/// hfSawtooth: the first n − 1 terms of the Fourier series of a sawtooth, (2/πa)(1/2 − Σ sin(2πift)/i).
pub(super) fn sawtooth<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    const MOST_TERMS: f64 = 4096.0;
    let [time, _, amplitude, frequency] = call.reals(0);
    let count = call.constant(1)?.trunc();
    if count <= 1.0 {
        return Ok(call.number(0.0));
    }
    if count.is_nan() || count > MOST_TERMS {
        return Err(format!("`{}` must be at most {MOST_TERMS}, not {count}", call.name(1)).into());
    }
    let turn = time * frequency * std::f64::consts::TAU;
    let waves = (1..count as u32).map(|i| (turn * f64::from(i)).sin() / f64::from(i));
    Ok(2.0 / (amplitude * std::f64::consts::PI) * (0.5 - call.sum(waves)))
}
