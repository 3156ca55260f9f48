//! The JSON Schema of scene files, made from the table of keys.

use super::keys::{FACE, MOTION, SCENE, SOLID, STEP, Section, Shape, TEXTURE};
use super::number::INTERPOLATIONS;
use serde_json::{Map, Value, json};

/// A JSON Schema (draft 2020-12) that scene files satisfy when they are read as JSON: editors complete keys with it.
/// What it cannot say, such as that names exist, is checked when a scene is read.
pub fn scene_schema() -> Value {
    let mut schema = section(&SCENE);
    let definitions = json!({
        "number": number(),
        "colour": colour(),
        "formula": { "type": ["string", "number"], "description": "A formula." },
        "keys": keys(&json!({ "$ref": "#/$defs/number" })),
        "solid": section(&SOLID),
        "texture": section(&TEXTURE),
        "motion": section(&MOTION),
        "step": section(&STEP),
    });
    if let Some(object) = schema.as_object_mut() {
        object.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
        object.insert("title".to_owned(), json!("Fieldstone scene"));
        object.insert("$defs".to_owned(), definitions);
    }
    schema
}

fn section(section: &Section) -> Value {
    let mut properties = Map::new();
    for key in section.all() {
        let described = |shape: &Shape| {
            let mut value = shape_of(shape);
            if let Some(object) = value.as_object_mut() {
                object.insert("description".to_owned(), json!(key.about));
            }
            value
        };
        properties.insert(key.name.to_owned(), described(&key.shape));
        if key.name == "colour" {
            properties.insert("color".to_owned(), described(&key.shape));
        }
    }
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn shape_of(shape: &Shape) -> Value {
    let number = || json!({ "$ref": "#/$defs/number" });
    match shape {
        Shape::Number => number(),
        Shape::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        Shape::Flag => json!({ "type": "boolean" }),
        Shape::Text | Shape::File | Shape::Material => json!({ "type": "string" }),
        Shape::Formula => json!({ "$ref": "#/$defs/formula" }),
        Shape::Choice(words) => json!({ "enum": words }),
        Shape::Numbers(count) => numbers(*count),
        Shape::Matrix => json!({
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "array", "items": number(), "minItems": 3, "maxItems": 4 },
        }),
        Shape::Colour => json!({ "$ref": "#/$defs/colour" }),
        Shape::Channel => json!({ "anyOf": [number(), { "$ref": "#/$defs/texture" }] }),
        Shape::ColourChannel => {
            json!({ "anyOf": [{ "$ref": "#/$defs/colour" }, { "$ref": "#/$defs/texture" }] })
        }
        Shape::LightChannel => json!({ "anyOf": [
            { "type": "number" }, { "$ref": "#/$defs/colour" }, { "$ref": "#/$defs/texture" },
        ] }),
        Shape::Face => json!({ "anyOf": [{ "$ref": "#/$defs/colour" }, section(&FACE)] }),
        Shape::Solid => json!({ "anyOf": [{ "type": "string" }, { "$ref": "#/$defs/solid" }] }),
        Shape::Motions => one_or_many(&json!({ "$ref": "#/$defs/motion" })),
        Shape::Steps => one_or_many(&json!({ "$ref": "#/$defs/step" })),
        Shape::Table(inner) if std::ptr::eq(*inner, &raw const SOLID) => json!({ "$ref": "#/$defs/solid" }),
        Shape::Table(inner) => section(inner),
        Shape::List(inner) => json!({ "type": "array", "items": shape_of(inner), "minItems": 1 }),
        Shape::OneOrMany(inner) => one_or_many(&shape_of(inner)),
        Shape::Named(inner) => json!({ "type": "object", "additionalProperties": shape_of(inner) }),
        Shape::Either(first, second) => json!({ "anyOf": [shape_of(first), shape_of(second)] }),
    }
}

fn one_or_many(one: &Value) -> Value {
    json!({ "anyOf": [one, { "type": "array", "items": one }] })
}

fn number() -> Value {
    json!({
        "description": "A number, a formula of t and parameters, or keys: values at times.",
        "anyOf": [{ "type": ["number", "string"] }, { "$ref": "#/$defs/keys" }],
    })
}

fn numbers(count: usize) -> Value {
    let list = json!({
        "type": "array", "items": { "$ref": "#/$defs/number" }, "minItems": count, "maxItems": count,
    });
    json!({ "anyOf": [list, keys(&list)] })
}

fn keys(value: &Value) -> Value {
    json!({
        "type": "object",
        "properties": { "interpolation": { "enum": INTERPOLATIONS } },
        "patternProperties": { "^-?[0-9.]+([eE][-+]?[0-9]+)?$": value },
        "additionalProperties": false,
    })
}

fn colour() -> Value {
    json!({
        "description": "\"#ff8000\", a name of CSS, [r, g, b] in sRGB, { linear = [r, g, b] }, or keys.",
        "anyOf": [
            { "type": "string" },
            { "type": "array", "items": { "$ref": "#/$defs/number" }, "minItems": 3, "maxItems": 3 },
            { "type": "object", "required": ["linear"], "properties": { "linear": numbers(3) },
              "additionalProperties": false },
            keys(&json!({ "$ref": "#/$defs/colour" })),
        ],
    })
}
