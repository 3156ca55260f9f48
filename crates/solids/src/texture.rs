//! Patterns for solid textures: numbers that vary over space, made of gradient noise.

use crate::expression::{Expr, Vector, write};
use crate::noise::gradient_noise;
use fieldstone_field::{Graph, NodeId};

/// No sum has more octaves.
const MAX_OCTAVES: u32 = 24;

fn noise<'g>(p: Vector<'g>) -> Expr<'g> {
    let [x, y, z] = p.0;
    x.call(gradient_noise(), &[y, z])
}

/// Σ term(2ᵏ p) gᵏ over the octaves k = 0, 1, …, at most [`MAX_OCTAVES`]; the argument is
/// moved a little from octave to octave, so that their zeros do not meet.
fn octaves<'g>(p: Vector<'g>, count: u32, gain: Expr<'g>, term: impl Fn(Expr<'g>) -> Expr<'g>) -> Expr<'g> {
    let mut sum = p.0[0].number(0.0);
    let mut amplitude = p.0[0].number(1.0);
    for k in 0..count.min(MAX_OCTAVES) {
        let frequency = f64::from(1u32 << k);
        let moved = 0.37 * f64::from(k);
        sum = sum + amplitude * term(noise(p.map(|x| x * frequency + moved)));
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

/// Fractal noise Σ gᵏ N(2ᵏ p + 0.37 k): from soft to rough with the number of octaves; `gain` is usually ½.
pub fn fractal_noise(graph: &mut Graph, at: [NodeId; 3], count: u32, gain: NodeId) -> NodeId {
    over(graph, at, &[gain], |p, others| octaves(p, count, others[0], |n| n))
}

/// Turbulence Σ gᵏ |N(2ᵏ p + 0.37 k)| (Perlin 1985).
pub fn turbulence(graph: &mut Graph, at: [NodeId; 3], count: u32, gain: NodeId) -> NodeId {
    over(graph, at, &[gain], |p, others| octaves(p, count, others[0], Expr::abs))
}

/// Veins across x: ½ + ½ sin(2π (x + s T(p))) with the [`turbulence`] T of six octaves; from 0 to 1, one vein a unit.
pub fn marble(graph: &mut Graph, at: [NodeId; 3], strength: NodeId) -> NodeId {
    over(graph, at, &[strength], |p, others| {
        let turbulence = octaves(p, 6, p.0[0].number(0.5), Expr::abs);
        0.5 + 0.5 * (std::f64::consts::TAU * (p.0[0] + others[0] * turbulence)).sin()
    })
}

/// Growth rings around z: (r + s N(p))'s fraction as a wave, ½ − ½ cos(2π (r + s N)); from 0 to 1, one ring a unit.
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
