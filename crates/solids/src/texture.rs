//! Patterns for solid textures: numbers that vary over space, made of gradient noise.

use crate::expression::{Expr, Vector, write};
use crate::noise::gradient_noise;
use fieldstone_field::{Graph, NodeId};

/// No sum has more octaves.
const MAX_OCTAVES: u32 = 12;

fn noise<'g>(p: Vector<'g>) -> Expr<'g> {
    let [x, y, z] = p.0;
    x.call(gradient_noise(), &[y, z])
}

/// Σ clamp(n − k, 0, 1) gᵏ term(2ᵏ p + 0.37 k) over the octaves k = 0, 1, … of at most [`MAX_OCTAVES`]. The argument is
/// moved a little from octave to octave, so that their zeros do not meet; the last one fades in where `count` n is not a
/// whole number.
fn octaves<'g>(
    p: Vector<'g>,
    count: Expr<'g>,
    gain: Expr<'g>,
    term: impl Fn(Expr<'g>) -> Expr<'g>,
) -> Expr<'g> {
    let mut sum = p.0[0].number(0.0);
    let mut amplitude = p.0[0].number(1.0);
    for k in 0..MAX_OCTAVES {
        let part = (count - f64::from(k)).clamp(0.0, 1.0);
        if part.constant_value() == Some(0.0) {
            break;
        }
        let (frequency, moved) = (f64::from(1u32 << k), 0.37 * f64::from(k));
        sum = sum + part * amplitude * term(noise(p.map(|x| x * frequency + moved)));
        amplitude = amplitude * gain;
    }
    sum
}

fn over<'a>(
    graph: &mut Graph,
    at: [NodeId; 3],
    others: &'a [NodeId],
    formula: impl for<'g> FnOnce(Vector<'g>, Vec<Expr<'g>>) -> Expr<'g> + 'a,
) -> NodeId {
    write(graph, |cell| {
        let others = others.iter().map(|&id| Expr::new(cell, id)).collect();
        formula(Vector(at.map(|id| Expr::new(cell, id))), others).id()
    })
}

/// Fractal noise Σ gᵏ N(2ᵏ p + 0.37 k): the more of up to twelve octaves, the rougher; `gain` g is usually ½.
pub fn fractal_noise(graph: &mut Graph, at: [NodeId; 3], count: NodeId, gain: NodeId) -> NodeId {
    over(graph, at, &[count, gain], |p, others| octaves(p, others[0], others[1], |n| n))
}

/// Turbulence Σ gᵏ |N(2ᵏ p + 0.37 k)| (Perlin 1985) of up to twelve octaves.
pub fn turbulence(graph: &mut Graph, at: [NodeId; 3], count: NodeId, gain: NodeId) -> NodeId {
    over(graph, at, &[count, gain], |p, others| octaves(p, others[0], others[1], Expr::abs))
}

/// Veins across x: ½ + ½ sin(2π (x + s T(p))) with the [`turbulence`] T of six octaves; from 0 to 1, one vein a unit.
pub fn marble(graph: &mut Graph, at: [NodeId; 3], strength: NodeId) -> NodeId {
    over(graph, at, &[strength], |p, others| {
        let turbulence = octaves(p, p.0[0].number(6.0), p.0[0].number(0.5), Expr::abs);
        0.5 + 0.5 * (std::f64::consts::TAU * (p.0[0] + others[0] * turbulence)).sin()
    })
}

/// Growth rings around z: ½ − ½ cos(2π (r + s N)) with the distance r from the axis and the noise N, which changes slowly
/// along it; from 0 to 1, one ring a unit.
pub fn wood(graph: &mut Graph, at: [NodeId; 3], strength: NodeId) -> NodeId {
    over(graph, at, &[strength], |p, others| {
        let radius = (p.0[0].square() + p.0[1].square()).sqrt();
        let along = Vector([p.0[0], p.0[1], 0.25 * p.0[2]]);
        0.5 - 0.5 * (std::f64::consts::TAU * (radius + others[0] * noise(along))).cos()
    })
}

/// Cubes with sides of length 1: 0 and 1 by turns.
pub fn checker(graph: &mut Graph, at: [NodeId; 3]) -> NodeId {
    over(graph, at, &[], |p, _| {
        let [i, j, k] = p.map(Expr::floor).0;
        (i + j + k).modulo(2.0)
    })
}
