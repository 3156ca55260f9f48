//! Functions that give attributes to points, and shaping functions for them.
//!
//! Arrays are written where a condition holds: element by element, the old value stays elsewhere. Most return 1.

use super::call::{Call, Outcome};
use super::expression::Expr;
use crate::Dialect;

/// hfA_SetColor: three attributes inside.
pub(super) fn set_color<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    call.array_from(1, 3)?;
    let color: [_; 3] = call.reals(2);
    call.write_where(1, is_inside(call.real(0)), &color);
    Ok(call.number(1.0))
}

/// hfA_SetAttributes: attributes inside, as many as both arrays have.
pub(super) fn set_attributes<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let attributes = call.array(2);
    call.write_where(1, is_inside(call.real(0)), &attributes);
    Ok(call.number(1.0))
}

fn is_inside(f: Expr<'_>) -> Expr<'_> {
    f.number(0.0).le(f)
}

/// hfA_Union: the R-union; inside it the attributes of the operand whose inside it is, or, where both are or neither
/// is, the first (op 0), the second (1), the sum (2), the smaller (3) or the larger (4) of the two.
pub(super) fn union<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f1, f2] = call.reals(0);
    let first = call.array(3);
    let second = call.array_of(4, first.len())?;
    let op = call.real(5);
    let value = f1.rmax(f2);

    let (in_first, in_second) = (is_inside(f1), is_inside(f2));
    let merged: Vec<_> = call
        .array(2)
        .into_iter()
        .zip(first.iter().zip(&second))
        .map(|(old, (&a, &b))| {
            let both = merge(op, old, a, b);
            let outside_first = in_second.select(b, both);
            in_first.select(in_second.select(both, a), outside_first)
        })
        .collect();
    call.write_where(2, value.number(-1e-6).lt(value), &merged);
    Ok(value)
}

fn merge<'g>(op: Expr<'g>, old: Expr<'g>, a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    let choices = [a, b, a + b, a.min(b), a.max(b)];
    let op = (op + 0.5).floor();
    choices.iter().enumerate().rev().fold(old, |rest, (k, &choice)| op.eq(k as f64).select(choice, rest))
}

/// hfA_Lerp: between two sets of attributes as f goes from fmin to fmax; returns the position.
pub(super) fn linear<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    interpolate(call, |t| t)
}

/// hfA_Cerp: the same with a smooth start and end; the C library has registered hfA_Lerp under this name.
pub(super) fn cubic<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    match call.dialect {
        Dialect::Lenient => interpolate(call, smooth),
        Dialect::Strict => linear(call),
    }
}

fn interpolate<'g>(call: &mut Call<'g>, weight: impl Fn(Expr<'g>) -> Expr<'g>) -> Outcome<'g> {
    let first = call.array(1);
    let second = call.array_of(2, first.len())?;
    let t = position(call.reals(3));
    let w = weight(t.clamp(0.0, 1.0));
    call.write(0, first.iter().zip(&second).map(|(&a, &b)| a + w * (b - a)));
    Ok(t)
}

/// (f − fmin)/(fmax − fmin).
pub(super) fn position([f, low, high]: [Expr<'_>; 3]) -> Expr<'_> {
    (f - low) / (high - low)
}

/// t²(3 − 2t) for t in \[0, 1\].
fn smooth(t: Expr<'_>) -> Expr<'_> {
    t.square() * (3.0 - 2.0 * t)
}

/// hfA_Clamp.
pub(super) fn clamp<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, low, high] = call.reals(0);
    Ok(f.clamp(low, high))
}

/// hfA_Floor, which rounds towards 0.
pub(super) fn floor<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    Ok(call.real(0).trunc())
}

/// hfA_Step: 1 from a on.
pub(super) fn step<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, a] = call.reals(0);
    Ok(a.le(f))
}

/// hfA_Pulse: 1 between two bounds, of which the upper comes first.
pub(super) fn pulse<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [f, upper, lower] = call.reals(0);
    Ok(lower.le(f).and(f.le(upper)))
}

/// hfA_SmoothStep: from 0 to 1 as the fourth argument goes from the fifth to the sixth. The first three do not count.
pub(super) fn smooth_step<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    Ok(smooth(position(call.reals(3)).clamp(0.0, 1.0)))
}

/// hfA_Modulo: a − trunc(a/b)·b, plus b if that is negative.
pub(super) fn modulo<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [a, b] = call.reals(0);
    let remainder = a - (a / b).trunc() * b;
    let for_negative = remainder.lt(0.0).select(remainder + b, remainder);
    Ok(b.lt(0.0).select(for_negative, a.modulo(b)))
}

/// hfA_Wave: a sine between two bounds in any order.
pub(super) fn wave<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [v, b1, b2, frequency] = call.reals(0);
    let (low, high) = (b1.min(b2), b1.max(b2));
    Ok(low + (high - low) * (1.0 + (frequency * v).sin()) * 0.5)
}

/// hfA_CheckerBoard: one set of attributes in the blocks of a grid, another in the gaps.
pub(super) fn checker_board<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, block, gap) = (call.vector(0)?, call.vector(1)?, call.vector(2)?);
    let in_block = call.array(4);
    let in_gap = call.array_of(5, in_block.len())?;
    let [along_x, along_y, along_z] = [0, 1, 2].map(|k| {
        let offset = offset_in_period(x.0[k], block.0[k] + gap.0[k]);
        offset.number(0.0).lt(offset).and(offset.lt(block.0[k]))
    });
    let is_block = along_x.and(along_y).and(along_z);
    call.write(3, in_block.iter().zip(&in_gap).map(|(&b, &g)| is_block.select(b, g)));
    Ok(call.number(1.0))
}

/// x − p·floor(x/p).
fn offset_in_period<'g>(x: Expr<'g>, period: Expr<'g>) -> Expr<'g> {
    period.lt(0.0).select(-(-x).modulo(period), x.modulo(period))
}

/// hfA_RGBToHSV: the hue in degrees, negative between magenta and red; saturation and value in \[0, 1\].
pub(super) fn hsv_from_rgb<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [r, g, b] = call.vector(0)?.0;
    call.array_from(1, 3)?;
    let (low, high) = (r.min(g).min(b), r.max(g).max(b));
    let range = high - low;
    // Which one is the largest is asked of two at a time, which sets of values can answer.
    let (red, green) = (g.le(r).and(b.le(r)), b.le(g));
    let hue = red.select((g - b) / range, green.select(2.0 + (b - r) / range, 4.0 + (r - g) / range));
    let hue = range.eq(0.0).select(0.0, 60.0 * hue);
    let saturation = high.eq(0.0).select(0.0, range / high);
    call.write(1, [hue, saturation, high]);
    Ok(call.number(1.0))
}

/// hfA_HSVToRGB; hues are taken modulo 360 degrees.
pub(super) fn rgb_from_hsv<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let [hue, saturation, value] = call.vector(0)?.0;
    call.array_from(1, 3)?;
    let sextant = (hue / 60.0).modulo(hue.number(6.0));
    let pure_colors = [(sextant - 3.0).abs() - 1.0, 2.0 - (sextant - 2.0).abs(), 2.0 - (sextant - 4.0).abs()];
    call.write(1, pure_colors.map(|c| value * (1.0 - saturation * (1.0 - c.clamp(0.0, 1.0)))));
    Ok(call.number(1.0))
}
