//! Lights, environment and background of a scene file.

use super::fault::{Fault, Outcome};
use super::number::Numbers;
use super::tree::{EMPTY, Table, Value};
use super::view;
use crate::picture::read_picture;
use fieldstone_scene::{
    Background, Camera, Environment, EnvironmentError, Face, Light, LightError, Lighting, Rgb, Surroundings,
};
use glam::DVec3;
use std::sync::Arc;

/// All light of a scene.
pub(super) fn lighting(numbers: &Numbers<'_>, camera: &Camera) -> Outcome<Lighting> {
    let root = &numbers.document().root;
    let usual = Lighting::for_camera(camera);
    let environment = match root.get("environment") {
        Some(value) => Some(environment(numbers, value, camera)?),
        None => None,
    };
    let lights = match root.get("lights").and_then(Value::list) {
        Some(list) => Some(list.iter().map(|value| light(numbers, value)).collect::<Outcome<Vec<Light>>>()?),
        None => None,
    };
    let is_lit = lights.is_some() || environment.is_some();
    let ambient = match root.table("lighting").and_then(|table| table.get("ambient")) {
        Some(value) => numbers.colour(value)?,
        None if is_lit => DVec3::ZERO,
        None => usual.ambient,
    };
    Ok(Lighting {
        lights: if is_lit { lights.unwrap_or_default() } else { usual.lights },
        ambient,
        background: background(numbers)?,
        environment,
    })
}

fn background(numbers: &Numbers<'_>) -> Outcome<Background> {
    let usual = Background::default();
    let Some(table) = numbers.document().root.table("background") else { return Ok(usual) };
    let colour = |key: &str| table.get(key).map(|value| numbers.colour(value)).transpose();
    let all = colour("colour")?;
    Ok(Background {
        top: colour("top")?.or(all).unwrap_or(usual.top),
        bottom: colour("bottom")?.or(all).unwrap_or(usual.bottom),
    })
}

fn light(numbers: &Numbers<'_>, value: &Value) -> Outcome<Light> {
    let table = value.table().unwrap_or(&EMPTY);
    let kind = required(value, table, "kind")?;
    let strength =
        table.get("strength").map_or(Ok(1.0), |v| numbers.ranged(v, (0.0, 1e30, "from 0 to 1e30")))?;
    let colour = strength * table.get("colour").map_or(Ok(DVec3::ONE), |colour| numbers.colour(colour))?;
    let vector =
        |key: &str| -> Outcome<DVec3> { Ok(numbers.numbers::<3>(required(value, table, key)?)?.into()) };
    let name = kind.text().unwrap_or_default();
    let of_kind: &[&str] = match name {
        "directional" => &["towards"],
        "point" => &["position"],
        "sphere" => &["position", "radius", "samples", "visible"],
        _ => &["position", "edges", "samples", "visible"],
    };
    refuse_others(table, (name, of_kind), &["kind", "colour", "strength", "shadows"])?;
    let failed = |error: LightError| -> Fault { kind.error(error.to_string(), "this light").into() };
    let light = match name {
        "directional" => Light::directional(vector("towards")?, colour),
        "point" => Light::point(vector("position")?, colour),
        "sphere" => {
            let radius = numbers.number(required(value, table, "radius")?)?;
            Light::sphere(vector("position")?, radius, colour)
        }
        _ => {
            let edges = required(value, table, "edges")?;
            let [first, second] = edges.list().unwrap_or_default() else {
                return Err(edges.error("a rectangle has two edges", "expected two").into());
            };
            let edges = [numbers.numbers::<3>(first)?.into(), numbers.numbers::<3>(second)?.into()];
            Light::rectangle(vector("position")?, edges, colour)
        }
    };
    let mut light = light.map_err(failed)?;
    if let Some(samples) = table.get("samples") {
        light = light.with_samples(numbers.number(samples)? as u32).map_err(failed)?;
    }
    let flag = |key: &str| table.get(key).and_then(Value::flag);
    light = light.with_visible(flag("visible").unwrap_or(false));
    Ok(if flag("shadows") == Some(false) { light.without_shadow() } else { light })
}

/// A key that must be there.
fn required<'v>(value: &Value, table: &'v Table, key: &str) -> Outcome<&'v Value> {
    table.get(key).ok_or_else(|| {
        let span = value.span.start..value.span.end.min(value.span.start + 80);
        fieldstone_lang::Diagnostic::error(span, format!("`{key}` is missing"), "incomplete").into()
    })
}

/// Says that keys of other kinds have no meaning.
fn refuse_others(table: &Table, (kind, own): (&str, &[&str]), common: &[&str]) -> Outcome<()> {
    let is_known = |key: &str| own.contains(&key) || common.contains(&key) || key == "color";
    match table.entries.iter().find(|entry| !is_known(&entry.key)) {
        None => Ok(()),
        Some(entry) => {
            let message = format!("`{}` has no meaning with kind = \"{kind}\"", entry.key);
            let error =
                fieldstone_lang::Diagnostic::error(entry.key_span.clone(), message, "without a meaning");
            Err(error.with_help(format!("it has {}, {}", own.join(", "), common.join(", "))).into())
        }
    }
}

fn environment(numbers: &Numbers<'_>, value: &Value, camera: &Camera) -> Outcome<Environment> {
    let table = value.table().unwrap_or(&EMPTY);
    let kind = required(value, table, "kind")?;
    let colour = |key: &str| numbers.colour(required(value, table, key)?);
    let name = kind.text().unwrap_or_default();
    let of_kind: &[&str] = match name {
        "uniform" => &["colour"],
        "gradient" => &["zenith", "horizon", "nadir"],
        "image" => &["file"],
        "cube" => &["faces"],
        _ => &["bounds", "faces"],
    };
    refuse_others(table, (name, of_kind), &["kind", "strength", "visible", "rotation", "up", "samples"])?;
    let surroundings = match name {
        "uniform" => {
            Surroundings::Uniform(table.get("colour").map_or(Ok(DVec3::ONE), |c| numbers.colour(c))?)
        }
        "gradient" => Surroundings::Gradient {
            zenith: colour("zenith")?,
            horizon: colour("horizon")?,
            nadir: colour("nadir")?,
        },
        "image" => Surroundings::LatLong(picture(numbers, required(value, table, "file")?)?),
        "cube" => Surroundings::Cube(faces(numbers, required(value, table, "faces")?)?),
        _ => Surroundings::Room {
            bounds: view::bounds(numbers, required(value, table, "bounds")?)?,
            walls: faces(numbers, required(value, table, "faces")?)?,
        },
    };
    let failed =
        |error: EnvironmentError| -> Fault { kind.error(error.to_string(), "this environment").into() };
    let number = |key: &str, usual: f64| table.get(key).map_or(Ok(usual), |v| numbers.number(v));
    let up =
        table.get("up").map(|up| numbers.numbers::<3>(up)).transpose()?.map_or(upright(camera), DVec3::from);
    let made = Environment::new(surroundings)
        .map(|made| made.with_visible(table.get("visible").and_then(Value::flag).unwrap_or(true)))
        .map_err(failed)?;
    let made = made.with_strength(number("strength", 1.0)?).map_err(failed)?;
    let made = made.rotated(up, number("rotation", 0.0)?.to_radians()).map_err(failed)?;
    match table.get("samples") {
        Some(samples) => made.with_samples(numbers.number(samples)? as u32).map_err(failed),
        None => Ok(made),
    }
}

/// The axis that is nearest to what is up in the picture.
fn upright(camera: &Camera) -> DVec3 {
    if camera.up().y.abs() > camera.up().z.abs() { DVec3::Y } else { DVec3::Z }
}

fn faces(numbers: &Numbers<'_>, value: &Value) -> Outcome<Arc<[Face; 6]>> {
    let list = value.list().unwrap_or_default();
    let all = list.iter().map(|face_value| face(numbers, face_value)).collect::<Outcome<Vec<Face>>>()?;
    let count = all.len();
    let six: Result<[Face; 6], _> = all.try_into();
    six.map(Arc::new).map_err(|_| {
        let error = value.error(format!("there are six faces, not {count}"), "expected six");
        error.with_help("right, left, up, down, front, back").into()
    })
}

/// A wall: a colour, a picture, or a checker of two colours.
fn face(numbers: &Numbers<'_>, value: &Value) -> Outcome<Face> {
    let Some(table) = value.table() else { return Ok(Face::Plain(numbers.colour(value)?)) };
    if let Some(file) = table.get("file") {
        return Ok(Face::Picture(picture(numbers, file)?));
    }
    if table.get("linear").is_some() {
        return Ok(Face::Plain(numbers.colour(value)?));
    }
    let Some([first, second]) = table.get("checker").and_then(Value::list) else {
        let error =
            value.error("a face is a colour, { file = … } or { checker = [a, b], count = 8 }", "incomplete");
        return Err(error.into());
    };
    let colours: [Rgb; 2] = [numbers.colour(first)?, numbers.colour(second)?];
    let count = table.get("count").map_or(Ok(8.0), |count| numbers.number(count))? as u32;
    Ok(Face::Checker { colours, count })
}

/// A picture that a scene names.
fn picture(numbers: &Numbers<'_>, value: &Value) -> Outcome<Arc<fieldstone_scene::Image>> {
    let place = numbers.document().files.place(value)?;
    let read = read_picture(&place);
    read.map(Arc::new).map_err(|error| value.error(error.to_string(), "this file").into())
}
