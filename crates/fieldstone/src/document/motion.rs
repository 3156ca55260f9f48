//! Motions: lists of translations, rotations, reflections, scalings and matrices, and mappings of space between them.

use super::compose::{Composer, Space};
use super::fault::Outcome;
use super::map::{Plane, SpaceMap};
use super::number::Numbers;
use super::tree::{EMPTY, Value};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// The map of a list of motions, applied in their order; it can be inverted.
pub(super) fn motions(numbers: &Numbers<'_>, value: &Value) -> Outcome<DAffine3> {
    let mut all = DAffine3::IDENTITY;
    for step in value.one_or_many() {
        if let Some(table) = step.table() {
            for entry in &table.entries {
                all = motion(numbers, (&entry.key, &entry.value))? * all;
            }
        }
    }
    invertible(all, value)
}

fn invertible(motion: DAffine3, value: &Value) -> Outcome<DAffine3> {
    if motion.is_finite() && motion.inverse().is_finite() {
        return Ok(motion);
    }
    Err(value.error("a motion that cannot be taken back: it flattens space", "scales to nothing").into())
}

/// A step of a `transform`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Step {
    Motion(DAffine3),
    Map(SpaceMap),
}

/// The steps of one `transform` after the other, in their order; motions that follow one another are one.
pub(super) fn steps<'v>(
    numbers: &Numbers<'_>,
    transforms: impl IntoIterator<Item = &'v Value>,
) -> Outcome<Vec<Step>> {
    let mut all: Vec<Step> = Vec::new();
    for transform in transforms {
        for entry in transform.one_or_many().iter().filter_map(Value::table).flat_map(|table| &table.entries)
        {
            if let Some(map) = SpaceMap::read(numbers, entry)? {
                all.push(Step::Map(map));
                continue;
            }
            let next = motion(numbers, (&entry.key, &entry.value))?;
            let before = match all.pop() {
                Some(Step::Motion(before)) => before,
                other => {
                    all.extend(other);
                    DAffine3::IDENTITY
                }
            };
            all.push(Step::Motion(invertible(next * before, transform)?));
        }
    }
    Ok(all)
}

impl Composer<'_, '_> {
    /// The space of a solid that goes through these steps.
    pub(super) fn stepped(&mut self, space: &Space, steps: &[Step]) -> Space {
        steps.iter().rev().fold(*space, |space, step| match step {
            Step::Motion(motion) => self.moved(&space, motion),
            Step::Map(map) => self.mapped(&space, map),
        })
    }
}

fn motion(numbers: &Numbers<'_>, (key, value): (&str, &Value)) -> Outcome<DAffine3> {
    Ok(match key {
        "translate" => DAffine3::from_translation(numbers.numbers(value)?.into()),
        "rotate" => DAffine3::from_quat(rotation(numbers, value)?),
        "reflect" => reflection(&Plane::read(numbers, value)?),
        "scale" if value.list().is_some() => DAffine3::from_scale(numbers.numbers(value)?.into()),
        "scale" => DAffine3::from_scale(DVec3::splat(numbers.number(value)?)),
        _ => matrix(numbers, value)?,
    })
}

fn reflection(plane: &Plane) -> DAffine3 {
    let image = |p: DVec3| p - 2.0 * p.dot(plane.normal) * plane.normal;
    let [x, y, z] = DVec3::AXES.map(image);
    DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), 2.0 * plane.foot())
}

fn rotation(numbers: &Numbers<'_>, value: &Value) -> Outcome<DQuat> {
    let table = value.table().unwrap_or(&EMPTY);
    let (Some(axis), Some(degrees)) = (table.get("axis"), table.get("degrees")) else {
        let error = value.error("a rotation has an axis and degrees", "incomplete");
        return Err(error.with_help("write { rotate = { axis = [0, 0, 1], degrees = 30 } }").into());
    };
    let direction = DVec3::from(numbers.numbers::<3>(axis)?);
    let unit = direction.try_normalize().ok_or_else(|| axis.error("an axis has a length", "no direction"))?;
    Ok(DQuat::from_axis_angle(unit, numbers.number(degrees)?.to_radians()))
}

fn matrix(numbers: &Numbers<'_>, value: &Value) -> Outcome<DAffine3> {
    let mut rows = [[0.0; 4]; 3];
    for (row, list) in rows.iter_mut().zip(value.list().unwrap_or_default()) {
        match list.list().map_or(0, <[Value]>::len) {
            4 => *row = numbers.numbers(list)?,
            _ => row[..3].copy_from_slice(&numbers.numbers::<3>(list)?),
        }
    }
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    Ok(DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3)))
}
