//! Mappings of space that are no motions: steps of a `transform` that twist, taper, bend, mirror, repeat or invert.
//!
//! A solid is evaluated at the place of its own space that lands at a point; its materials are asked there too, with the
//! normal that it has there.

use super::compose::{Composer, Space};
use super::fault::Outcome;
use super::keys::MAPS;
use super::number::Numbers;
use super::primitive::needed;
use super::tree::{EMPTY, Entry, Table, Value};
use fieldstone_field::{Graph, NodeId};
use fieldstone_solids::{
    bend, bend_normal, invert, invert_normal, mirror, mirror_normal, polar_repeat, polar_repeat_normal,
    repeat, repeat_onward, taper, taper_normal, twist, twist_normal,
};
use glam::{DAffine3, DMat3, DVec3};

const ABOVE_ZERO: (f64, f64, &str) = (f64::MIN_POSITIVE, f64::MAX, "above 0");

/// A mapping of space at a time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct SpaceMap {
    /// From the frame in which the mapping is written: its axis is z, what is bent lies along x and bends towards z.
    from_frame: DAffine3,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Kind {
    Nothing,
    /// Radians for each unit of length.
    Twist(f64),
    Taper {
        between: [f64; 2],
        factors: [f64; 2],
    },
    /// One over the radius.
    Bend(f64),
    Mirror,
    Repeat {
        spacing: f64,
        count: Option<f64>,
    },
    RepeatAround(f64),
    /// The radius.
    Invert(f64),
}

impl SpaceMap {
    /// The mapping of an entry of a `transform`; `None` if that is a motion.
    pub(super) fn read(numbers: &Numbers<'_>, entry: &Entry) -> Outcome<Option<Self>> {
        let reader = Reader { numbers, value: &entry.value, key: &entry.key };
        let (turn, kind) = match entry.key.as_str() {
            "twist" => (reader.axis("axis")?, Kind::Twist(reader.number("degrees")?.to_radians())),
            "taper" => (reader.axis("axis")?, reader.taper()?),
            "bend" => {
                let curvature = reader.number("degrees")?.to_radians();
                // As good as straight: the centre would be lost in rounding.
                let is_straight = curvature.abs() < 1e-12;
                (reader.bend_frame()?, if is_straight { Kind::Nothing } else { Kind::Bend(curvature) })
            }
            "mirror" => {
                let plane = Plane::read(numbers, &entry.value)?;
                let from_frame = DAffine3::from_mat3_translation(frame_of(plane.normal), plane.foot());
                return Ok(Some(Self { from_frame, kind: Kind::Mirror }));
            }
            "repeat" => {
                let spacing = numbers.ranged(reader.needed("spacing")?, ABOVE_ZERO)?;
                let count = reader.table().get("count").map(|count| numbers.number(count)).transpose()?;
                (reader.axis("axis")?, Kind::Repeat { spacing, count })
            }
            "repeat_around" => (reader.axis("axis")?, Kind::RepeatAround(reader.number("count")?)),
            "invert" => {
                let radius = numbers.ranged(reader.needed("radius")?, ABOVE_ZERO)?;
                (DMat3::IDENTITY, Kind::Invert(radius))
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { from_frame: DAffine3::from_mat3(turn), kind }))
    }
}

/// A plane normal·p = offset.
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

impl Plane {
    /// The plane of a table with `normal` and `offset`.
    pub(super) fn read(numbers: &Numbers<'_>, value: &Value) -> Outcome<Self> {
        let table = value.table().unwrap_or(&EMPTY);
        let normal = needed(value, table, "normal", "{ normal = [1, 0, 0], offset = 0 }")?;
        let unit = DVec3::from(numbers.numbers::<3>(normal)?).try_normalize();
        let unit = unit.ok_or_else(|| normal.error("a normal has a length", "no direction"))?;
        let offset = table.get("offset").map_or(Ok(0.0), |offset| numbers.number(offset))?;
        Ok(Self { normal: unit, offset })
    }

    /// The point of the plane that is nearest to the origin.
    pub(super) fn foot(&self) -> DVec3 {
        self.normal * self.offset
    }
}

/// What reads the numbers of a mapping.
struct Reader<'n, 'd> {
    numbers: &'n Numbers<'d>,
    value: &'n Value,
    key: &'n str,
}

impl<'n> Reader<'n, '_> {
    fn table(&self) -> &'n Table {
        self.value.table().unwrap_or(&EMPTY)
    }

    fn needed(&self, key: &str) -> Outcome<&'n Value> {
        let example = MAPS.iter().find(|(map, _)| *map == self.key).map_or("", |(_, example)| example);
        needed(self.value, self.table(), key, example)
    }

    fn number(&self, key: &str) -> Outcome<f64> {
        self.numbers.number(self.needed(key)?)
    }

    fn direction(&self, value: &Value) -> Outcome<DVec3> {
        let direction = DVec3::from(self.numbers.numbers::<3>(value)?).try_normalize();
        Ok(direction.ok_or_else(|| value.error("an axis has a length", "no direction"))?)
    }

    /// A frame with an axis as its z.
    fn axis(&self, key: &str) -> Outcome<DMat3> {
        Ok(frame_of(self.direction(self.needed(key)?)?))
    }

    fn taper(&self) -> Outcome<Kind> {
        let between = [self.number("from")?, self.number("to")?];
        let scale = self.needed("scale")?;
        let factors = self.numbers.numbers::<2>(scale)?;
        if between[0] == between[1] {
            let error = self.needed("to")?.error("`from` and `to` are two places", "the same as `from`");
            return Err(error.into());
        }
        if !factors.iter().all(|factor| *factor > 0.0) {
            return Err(scale.error("scales are above 0", "expected two numbers above 0").into());
        }
        Ok(Kind::Taper { between, factors })
    }

    /// A frame with what is bent along x, and the side that it bends to as z.
    fn bend_frame(&self) -> Outcome<DMat3> {
        let direction =
            |key: &str, usual: DVec3| self.table().get(key).map_or(Ok(usual), |value| self.direction(value));
        let (along, towards) = (direction("along", DVec3::X)?, direction("towards", DVec3::Z)?);
        let across = (towards - along * towards.dot(along)).try_normalize();
        let is_across = |across: &DVec3| across.is_finite() && along.cross(towards).length() > 1e-9;
        let Some(across) = across.filter(is_across) else {
            let at = self.table().get("towards").or(self.table().get("along")).unwrap_or(self.value);
            return Err(at
                .error("what is bent does not bend along itself", "the same line as that along which it is")
                .into());
        };
        Ok(DMat3::from_cols(along, across.cross(along), across))
    }
}

/// The right-handed frame with a unit vector as its z, whose x is as near as can be to the coordinate axis that follows
/// the one nearest to the vector: for the coordinate axes the frame is a change of names.
fn frame_of(z: DVec3) -> DMat3 {
    let nearest = z.abs().to_array();
    let largest = (0..3).fold(0, |best, k| if nearest[k] > nearest[best] { k } else { best });
    let next = DVec3::AXES[(largest + 1) % 3];
    let x = (next - z * next.dot(z)).normalize();
    DMat3::from_cols(x, z.cross(x), z)
}

impl Composer<'_, '_> {
    /// The space of a solid that a mapping moves.
    pub(super) fn mapped(&mut self, space: &Space, map: &SpaceMap) -> Space {
        let is_plain = map.from_frame == DAffine3::IDENTITY;
        let local = if is_plain { *space } else { self.moved(space, &map.from_frame) };
        let original = self.original(&local, map.kind);
        if is_plain { original } else { self.moved(&original, &map.from_frame.inverse()) }
    }

    /// The original of a place in the frame of a mapping.
    fn original(&mut self, space: &Space, kind: Kind) -> Space {
        let g = &mut self.graph;
        let (at, place) = (space.point, (space.point, space.normal));
        let (point, normal) = match kind {
            Kind::Nothing => place,
            Kind::Twist(rate) => {
                let rate = g.constant(rate);
                (twist(g, at, 2, rate), twist_normal(g, place, rate))
            }
            Kind::Taper { between, factors } => {
                let [between, factors] = [between, factors].map(|pair| pair.map(|k| g.constant(k)));
                (taper(g, at, 2, between, factors), taper_normal(g, place, between, factors))
            }
            Kind::Bend(curvature) => {
                let curvature = g.constant(curvature);
                (bend(g, at, curvature), bend_normal(g, place, curvature))
            }
            Kind::Mirror => (mirror(g, at, 2), mirror_normal(g, place)),
            Kind::Repeat { spacing, count } => {
                let spacing = g.constant(spacing);
                let point = match count.map(|count| g.constant(count)) {
                    Some(count) => repeat_onward(g, at, 2, spacing, count),
                    None => repeat(g, at, 2, spacing),
                };
                (point, space.normal)
            }
            Kind::RepeatAround(count) => {
                let count = g.constant(count);
                (polar_repeat(g, at, 2, count), polar_repeat_normal(g, place, count))
            }
            Kind::Invert(radius) => {
                let radius = g.constant(radius);
                (invert(g, at, radius), invert_normal(g, place))
            }
        };
        Space { point, normal: unit(g, normal) }
    }
}

/// A direction with length 1.
pub(super) fn unit(graph: &mut Graph, direction: [NodeId; 3]) -> [NodeId; 3] {
    let squares = direction.map(|n| graph.square(n));
    let sum = squares[1..].iter().fold(squares[0], |sum, s| graph.add(sum, *s));
    let length = graph.sqrt(sum);
    direction.map(|n| graph.div(n, length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_those_of_coordinate_axes_are_exact() {
        for (axis, x) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
            for sign in [1.0, -1.0] {
                let frame = frame_of(sign * axis);
                assert_eq!((frame.x_axis, frame.z_axis), (x, sign * axis));
                assert!(frame.to_cols_array().iter().all(|k| [0.0, 1.0, -1.0].contains(k)));
                assert!((frame.determinant() - 1.0).abs() < 1e-15);
            }
        }
        let frame = frame_of(DVec3::new(1.0, -2.0, 2.0) / 3.0);
        assert!((frame.determinant() - 1.0).abs() < 1e-15);
        assert!((frame * DVec3::Z - DVec3::new(1.0, -2.0, 2.0) / 3.0).length() < 1e-15);
    }
}
