//! Attributes from tables: entries of as many numbers as the array that receives them has.

use super::attributes::position;
use super::call::{Call, Failure, Outcome};
use super::expression::Expr;
use super::noise::unit_gardner_at;
use crate::Dialect;

/// A table and the ascending positions of its entries.
struct Table<'g> {
    entries: Vec<Vec<Expr<'g>>>,
    map: Vec<Expr<'g>>,
}

impl<'g> Table<'g> {
    /// The table in argument `first` with the map in the argument that follows, for the output in argument `out`;
    /// `spare` positions at the end of the map need no entry.
    fn new(call: &Call<'g>, out: usize, first: usize, spare: usize) -> Result<Self, Failure> {
        let (size, map) = (call.array(out).len(), call.array(first + 1));
        if size == 0 || map.len() <= spare {
            let needed = spare + 1;
            return Err(format!("`{}` must have {needed} elements or more", call.name(first + 1)).into());
        }
        let numbers = call.array_from(first, size * (map.len() - spare))?;
        Ok(Self { entries: numbers.chunks_exact(size).map(<[_]>::to_vec).collect(), map })
    }
}

fn select_all<'g>(condition: Expr<'g>, if_true: &[Expr<'g>], if_false: &[Expr<'g>]) -> Vec<Expr<'g>> {
    if_true.iter().zip(if_false).map(|(&a, &b)| condition.select(a, b)).collect()
}

/// hfA_LookUpTable: the entry of the last position that is not above t. Below the first position: the first entry
/// (lenient), or the last (strict).
pub(super) fn look_up<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let t = call.real(0);
    let table = Table::new(call, 1, 2, 0)?;
    let found = (1..table.map.len())
        .fold(table.entries[0].clone(), |found, i| select_all(table.map[i].le(t), &table.entries[i], &found));
    let found = below_first(call, &table, t, found);
    call.write(1, found);
    Ok(call.number(1.0))
}

/// What the dialect delivers below the first position.
fn below_first<'g>(call: &Call<'g>, table: &Table<'g>, t: Expr<'g>, found: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
    match call.dialect {
        Dialect::Lenient => found,
        Dialect::Strict => select_all(t.lt(table.map[0]), &table.entries[table.map.len() - 1], &found),
    }
}

/// hfA_SmoothLookUpTable: linear between the entries.
pub(super) fn look_up_smoothly<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let t = call.real(0);
    let table = Table::new(call, 1, 2, 0)?;
    let found = (1..table.map.len()).fold(table.entries[0].clone(), |found, i| {
        let (low, high) = (table.map[i - 1], table.map[i]);
        let weight = low.lt(high).select(position([t, low, high]).clamp(0.0, 1.0), high.le(t));
        let step = table.entries[i].iter().zip(&table.entries[i - 1]);
        found.iter().zip(step).map(|(&sum, (&b, &a))| sum + weight * (b - a)).collect()
    });
    let found = below_first(call, &table, t, found);
    call.write(1, found);
    Ok(call.number(1.0))
}

/// hfA_Circles: concentric spheres.
pub(super) fn circles<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let x = call.array(0);
    let radius = call.sum(x.iter().map(|x| x.square())).sqrt();
    write_interval(call, 1, 2, radius - radius.floor())
}

/// hfA_Crackles: a pattern of veins, made of Gardner's series.
pub(super) fn crackles<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let x = call.vector(0)?;
    let frequency = call.real(2);
    let phase = call.sum(x.0.map(Expr::abs)) / 3.0;
    let [x1, x2, x3] = x.0;
    let noises = [[x1, x1, x3], [x2, x2, x1], [x3, x3, x2]]
        .map(|p| 2.0 * unit_gardner_at(super::expression::Vector(p), frequency, phase) - 1.0);
    let sum = call.sum(noises);
    let thousandth = (1000.0 * (sum - sum.floor())).trunc();
    let v = (1.0 + (2.0 * std::f64::consts::PI * thousandth / 1000.0).sin()) * 0.5;
    write_interval(call, 1, 3, v)
}

/// Writes the entry whose interval of the map holds `v`, if any.
///
/// The C library writes 1.1 into the table it reads, behind as many numbers as the map has.
fn write_interval<'g>(call: &mut Call<'g>, out: usize, first: usize, v: Expr<'g>) -> Outcome<'g> {
    if call.dialect == Dialect::Strict {
        let mut table = call.array(first);
        if let Some(spoilt) = table.get_mut(call.array(first + 1).len()) {
            *spoilt = v.number(1.1);
        }
        call.write(first, table);
    }
    let table = Table::new(call, out, first, 1)?;
    for (bounds, entry) in table.map.windows(2).zip(&table.entries) {
        call.write_where(out, bounds[0].le(v).and(v.lt(bounds[1])), entry);
    }
    Ok(call.number(1.0))
}

/// hfA_Spline: a Catmull–Rom spline through the knots but the first and the last, which only shape its ends and are
/// what lies before and behind it.
pub(super) fn spline<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let size = call.array(0).len();
    let list = call.array_from(1, 4 * size.max(1))?;
    let t = position(call.reals(2));
    let knots: Vec<_> = list.chunks_exact(size.max(1)).collect();
    let spans = knots.len() - 3;
    let along = t * spans as f64;
    let curve = (0..size).map(|k| {
        let last = knots[knots.len() - 1][k];
        let inner = (0..spans).rev().fold(last, |rest, i| {
            let u = (along - i as f64).clamp(0.0, 1.0);
            let value = catmull_rom(u, [0, 1, 2, 3].map(|j| knots[i + j][k]));
            let ends = if i + 1 == spans { along.le(spans as f64) } else { along.lt((i + 1) as f64) };
            ends.select(value, rest)
        });
        t.lt(0.0).select(knots[0][k], inner)
    });
    let curve: Vec<_> = curve.collect();
    call.write(0, curve);
    Ok(call.number(1.0))
}

fn catmull_rom<'g>(u: Expr<'g>, [p, q, r, s]: [Expr<'g>; 4]) -> Expr<'g> {
    let linear = r - p;
    let quadratic = 2.0 * p - 5.0 * q + 4.0 * r - s;
    let cubic = 3.0 * (q - r) + s - p;
    0.5 * (2.0 * q + u * (linear + u * (quadratic + u * cubic)))
}
