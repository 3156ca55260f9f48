//! A gear: straight flanks about many axes, bores and a keyway.

use crate::program::{Program, Value};
use std::f64::consts::{PI, TAU};

const TEETH: u32 = 28;
/// The radii of the teeth's tips and feet.
const TIP: f64 = 1.1;
const ROOT: f64 = 0.95;

/// The gear lies in the plane z = 0; its radius is about 1.
pub(super) fn gear(program: &Program) -> Option<Value<'_>> {
    let [x, y, z] = program.point();
    let radius = x.hypot(y);
    let teeth = teeth(program, [x, y])?.max(radius - TIP).min(radius - ROOT);
    let thickness = z.slab(0.0, 0.16);
    // The tips are cut back at 45° on both sides.
    let chamfer = radius + z.abs() - (TIP + 0.11);
    let rim = program.intersection(&[teeth, thickness, chamfer])?;
    let recess = radius.slab(0.58, 0.26).max(-(z.slab(0.0, 0.07)));
    let hub = (radius - 0.3).max(z.slab(0.0, 0.28));
    let bores = bores(program, [x, y])?;
    let body = rim.without(recess).without(bores).min(hub);
    let axle = radius - 0.17;
    let keyway = x.slab(0.0, 0.05).max(y.slab(0.17, 0.06));
    Some(body.without(axle.min(keyway)))
}

/// All teeth, endless towards the middle; two that stand opposite each other are one wedge.
fn teeth<'p>(program: &'p Program, [x, y]: [Value<'p>; 2]) -> Option<Value<'p>> {
    let wedge = |i: u32| {
        let (sine, cosine) = (PI * f64::from(2 * i) / f64::from(TEETH)).sin_cos();
        let along = (x * cosine + y * sine).abs();
        let across = (y * cosine - x * sine).abs();
        across + along * 0.35 - 0.418
    };
    program.union(&(0..TEETH / 2).map(wedge).collect::<Vec<_>>())
}

/// Six round holes in the web.
fn bores<'p>(program: &'p Program, [x, y]: [Value<'p>; 2]) -> Option<Value<'p>> {
    let bore = |i: u32| {
        let (sine, cosine) = (TAU * f64::from(i) / 6.0).sin_cos();
        (x - 0.58 * cosine).hypot(y - 0.58 * sine) - 0.17
    };
    program.union(&(0..6).map(bore).collect::<Vec<_>>())
}
