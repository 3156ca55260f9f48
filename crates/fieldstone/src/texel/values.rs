//! Values of recipes that know their ranges.

use crate::document::named_colour;
use fieldstone_scene::srgb_to_linear;
use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

macro_rules! ranged {
    ($($(#[$about:meta])* $name:ident($from:ty as $inner:ty) if $rule:expr, $words:literal, $schema:tt;)*) => {
        $(
        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }

        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
        #[serde(try_from = "f64")]
        pub(super) struct $name(pub(super) $inner);

        impl TryFrom<$from> for $name {
            type Error = String;

            fn try_from(value: $from) -> Result<Self, String> {
                let fits: fn($from) -> bool = $rule;
                if fits(value) { Ok(Self(value as $inner)) } else { Err(format!(concat!("expected ", $words, ", not {}"), value)) }
            }
        })*
    };
}

/// The longest length: a hundred times the volume.
const LONGEST: f64 = 100.0;

ranged! {
    /// A length.
    Length(f64 as f64) if |x| x > 0.0 && x <= LONGEST, "a length above 0, at most 100 edges of the volume",
        { "type": "number", "exclusiveMinimum": 0, "maximum": LONGEST };
    /// A length that may be 0.
    Size(f64 as f64) if |x| (0.0..=LONGEST).contains(&x), "a length from 0 to 100 edges of the volume",
        { "type": "number", "minimum": 0, "maximum": LONGEST };
    /// A place, or a number of any sign.
    Place(f64 as f64) if |x| x.abs() <= LONGEST, "a number from -100 to 100",
        { "type": "number", "minimum": -LONGEST, "maximum": LONGEST };
    /// A share.
    Share(f64 as f64) if |x| (0.0..=1.0).contains(&x), "a number from 0 to 1",
        { "type": "number", "minimum": 0, "maximum": 1 };
    /// An angle in degrees.
    Degrees(f64 as f64) if |x| x.abs() <= 3600.0, "an angle from -3600 to 3600 degrees",
        { "type": "number", "minimum": -3600, "maximum": 3600 };
    /// The angle by which a blade is folded, in degrees.
    Fold(f64 as f64) if |x| (0.0..90.0).contains(&x), "an angle from 0 to 90 degrees, 90 left out",
        { "type": "number", "minimum": 0, "exclusiveMaximum": 90 };
    /// A spread.
    Spread(f64 as f64) if |x| (0.0..=10.0).contains(&x), "a number from 0 to 10",
        { "type": "number", "minimum": 0, "maximum": 10 };
    /// An extinction per edge.
    Extinction(f64 as f64) if |x| x > 0.0 && x <= 1e6, "an extinction above 0, at most 1000000",
        { "type": "number", "exclusiveMinimum": 0, "maximum": 1_000_000 };
    /// An extinction or a width that may be 0.
    Thickness(f64 as f64) if |x| (0.0..=1e6).contains(&x), "a number from 0 to 1000000",
        { "type": "number", "minimum": 0, "maximum": 1_000_000 };
    /// A number above 0.
    Positive(f64 as f64) if |x| x > 0.0 && x <= 1e6, "a number above 0, at most 1000000",
        { "type": "number", "exclusiveMinimum": 0, "maximum": 1_000_000 };
    /// A coordinate of a source.
    Coordinate(f64 as f64) if |x| x.abs() <= 1e6, "a number from -1000000 to 1000000",
        { "type": "number", "minimum": -1_000_000, "maximum": 1_000_000 };
    /// A number of a scan.
    Number(f64 as f64) if |x| x.abs() <= 1e30, "a number from -1e30 to 1e30",
        { "type": "number", "minimum": -1e30, "maximum": 1e30 };
    /// Perlin's bias and gain.
    Bias(f64 as f64) if |x| x > 0.0 && x < 1.0, "a number between 0 and 1",
        { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 };
    /// How many octaves.
    Octaves(f64 as u32) if |x| (1.0..=16.0).contains(&x) && x.fract() == 0.0, "a whole number from 1 to 16",
        { "type": "integer", "minimum": 1, "maximum": 16 };
    /// By how much frequencies rise.
    Lacunarity(f64 as f64) if |x| x > 1.0 && x <= 100.0, "a number above 1, at most 100",
        { "type": "number", "exclusiveMinimum": 1, "maximum": 100 };
    /// How many bytes are left out.
    Skip(f64 as u32) if |x| (0.0..=536_870_912.0).contains(&x) && x.fract() == 0.0, "a whole number from 0 to 536870912",
        { "type": "integer", "minimum": 0, "maximum": 536_870_912 };
    /// Phong's exponent.
    Exponent(f64 as f64) if |x| x > 0.0 && x <= 1e6, "an exponent above 0, at most 1000000",
        { "type": "number", "exclusiveMinimum": 0, "maximum": 1_000_000 };
    /// How many copies.
    Count(f64 as u32) if |x| (1.0..=1e5).contains(&x) && x.fract() == 0.0, "a whole number from 1 to 100000",
        { "type": "integer", "minimum": 1, "maximum": 100_000 };
    /// What chance starts from.
    Seed(f64 as u64) if |x| (0.0..=9e15).contains(&x) && x.fract() == 0.0, "a whole number from 0 on",
        { "type": "integer", "minimum": 0 };
    /// Cells along an edge.
    Edge(f64 as u32) if |x| (1.0..=1024.0).contains(&x) && (x as u32).is_power_of_two() && x.fract() == 0.0, "a power of two from 1 to 1024",
        { "enum": [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024] };
}

/// Three places as a vector.
pub(super) fn vector(places: [Place; 3]) -> DVec3 {
    DVec3::from_array(places.map(|place| place.0))
}

/// A direction: three numbers that are not all 0.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "[f64; 3]")]
#[schemars(with = "[f64; 3]")]
pub(super) struct Direction(pub(super) DVec3);

impl TryFrom<[f64; 3]> for Direction {
    type Error = String;

    fn try_from(numbers: [f64; 3]) -> Result<Self, String> {
        let unit = DVec3::from_array(numbers).try_normalize();
        unit.map(Self).ok_or_else(|| "a direction is finite and not 0, 0, 0".to_owned())
    }
}

/// A colour, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour(pub(super) [f32; 3]);

impl JsonSchema for Colour {
    fn schema_name() -> Cow<'static, str> {
        "Colour".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "\"#ff8000\", a name of CSS, or [r, g, b] in sRGB.",
            "anyOf": [
                { "type": "string" },
                {
                    "type": "array", "minItems": 3, "maxItems": 3,
                    "items": { "type": "number", "minimum": 0, "maximum": 1 },
                },
            ],
        })
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ColourVisitor)
    }
}

struct ColourVisitor;

impl<'de> Visitor<'de> for ColourVisitor {
    type Value = Colour;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a colour: \"#ff8000\", a name of CSS such as \"teal\", or [1, 0.5, 0]")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Colour, E> {
        let colour = named_colour(text).ok_or_else(|| E::invalid_value(de::Unexpected::Str(text), &self))?;
        Ok(Colour(colour.as_vec3().to_array()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Colour, A::Error> {
        let mut colour = [0.0; 3];
        for (index, channel) in colour.iter_mut().enumerate() {
            let share: Share =
                list.next_element()?.ok_or_else(|| de::Error::invalid_length(index, &"three numbers"))?;
            *channel = srgb_to_linear(share.0) as f32;
        }
        match list.next_element::<de::IgnoredAny>()? {
            None => Ok(Colour(colour)),
            Some(_) => Err(de::Error::custom("a colour has three numbers from 0 to 1")),
        }
    }
}
