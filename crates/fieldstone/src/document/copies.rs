//! Copies: where an object or a volume stands again.

use super::MAX_INSTANCES;
use super::fault::Outcome;
use super::motion::motions;
use super::number::Numbers;
use super::tree::{Table, Value};
use glam::{DAffine3, DQuat, DVec3};

/// Where copies of what a table describes stand: in one place if it says nothing of copies.
pub(super) fn copies(numbers: &Numbers<'_>, table: Option<&Table>) -> Outcome<Vec<DAffine3>> {
    let get = |key: &str| table.and_then(|table| table.get(key));
    let mut kinds = ["instances", "scatter", "grid"].into_iter().filter_map(get);
    if let (Some(_), Some(second)) = (kinds.next(), kinds.next()) {
        let message = "an object has one of `instances`, `scatter` and `grid`";
        let error = second.error(message, "a second kind of copies");
        return Err(error.with_help("write a second object of the same solid").into());
    }
    let mut all = Vec::new();
    if let Some(list) = get("instances") {
        let copies = list.list().unwrap_or_default();
        check_count(list, copies.len())?;
        for copy in copies {
            all.push(motions(numbers, copy)?);
        }
    }
    if let Some(value) = get("scatter") {
        all.extend(scatter(numbers, value)?);
    }
    if let Some(value) = get("grid") {
        all.extend(grid(numbers, value)?);
    }
    Ok(if all.is_empty() { vec![DAffine3::IDENTITY] } else { all })
}

fn scatter(numbers: &Numbers<'_>, value: &Value) -> Outcome<Vec<DAffine3>> {
    let get = |key: &str| value.table().and_then(|table| table.get(key));
    let (Some(count), Some(place)) = (get("count"), get("box")) else {
        let error = value.error("a scatter has a `count` and a `box`", "incomplete");
        return Err(error.with_help("write { count = 100, box = [-1, -1, 0, 1, 1, 0] }").into());
    };
    let count = numbers.number(count)? as usize;
    let corners = numbers.numbers::<6>(place)?;
    let [low, high] = [DVec3::from_slice(&corners[..3]), DVec3::from_slice(&corners[3..])];
    let [least, most] = get("scale").map_or(Ok([1.0; 2]), |scale| numbers.numbers(scale))?;
    if let Some(scale) = get("scale").filter(|_| !(least > 0.0 && most > 0.0)) {
        return Err(scale.error("scales are above 0", "expected two numbers above 0").into());
    }
    let seed = get("seed").map_or(Ok(0.0), |seed| numbers.number(seed))? as u64;
    let axis = get("rotate").and_then(Value::text).unwrap_or("none");
    let mut random = Random(seed);
    let copy = |_| {
        let at = low + (high - low) * DVec3::from(std::array::from_fn(|_| random.number()));
        let scale = least + (most - least) * random.number();
        let turn = random.rotation(axis);
        DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, at)
    };
    Ok((0..count.min(MAX_INSTANCES)).map(copy).collect())
}

fn grid(numbers: &Numbers<'_>, value: &Value) -> Outcome<Vec<DAffine3>> {
    let get = |key: &str| value.table().and_then(|table| table.get(key));
    let (Some(count), Some(spacing)) = (get("count"), get("spacing")) else {
        let error = value.error("a grid has a `count` and a `spacing`", "incomplete");
        return Err(error.with_help("write { count = [4, 4, 1], spacing = [1, 1, 1] }").into());
    };
    let [columns, rows, layers] = numbers.numbers::<3>(count)?.map(|n| n as usize);
    check_count(count, columns.saturating_mul(rows).saturating_mul(layers))?;
    let spacing = DVec3::from(numbers.numbers::<3>(spacing)?);
    let origin = DVec3::from(get("origin").map_or(Ok([0.0; 3]), |origin| numbers.numbers(origin))?);
    let mut all = Vec::new();
    for (k, j, i) in
        (0..layers).flat_map(|k| (0..rows).flat_map(move |j| (0..columns).map(move |i| (k, j, i))))
    {
        let steps = DVec3::new(i as f64, j as f64, k as f64);
        all.push(DAffine3::from_translation(origin + spacing * steps));
    }
    Ok(all)
}

fn check_count(value: &Value, count: usize) -> Outcome<()> {
    if count <= MAX_INSTANCES {
        return Ok(());
    }
    Err(value.error(format!("an object has at most {MAX_INSTANCES} copies, not {count}"), "too many").into())
}

/// Random numbers: SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    /// From 0 on, below 1.
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly distributed, about an axis or any (Shoemake 1992).
    fn rotation(&mut self, axis: &str) -> DQuat {
        let [u, v, w] = std::array::from_fn(|_| self.number());
        let angle = std::f64::consts::TAU * u;
        match axis {
            "x" => DQuat::from_rotation_x(angle),
            "y" => DQuat::from_rotation_y(angle),
            "z" => DQuat::from_rotation_z(angle),
            "any" => {
                let (a, b) = (std::f64::consts::TAU * v, (1.0 - w).sqrt());
                let c = w.sqrt();
                DQuat::from_xyzw(b * angle.sin(), b * angle.cos(), c * a.sin(), c * a.cos()).normalize()
            }
            _ => DQuat::IDENTITY,
        }
    }
}
