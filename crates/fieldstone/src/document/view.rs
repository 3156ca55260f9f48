//! Camera and settings of a scene file.

use super::SceneRequest;
use super::fault::Outcome;
use super::number::Numbers;
use super::tree::{EMPTY, Value};
use fieldstone_scene::{
    Aperture, Bounds, Camera, MAX_BOUNCES, MAX_SAMPLES, Method, Projection, Settings, Tone, ToneCurve, Up,
    View,
};
use glam::DVec3;

/// A box: the lower corner, then the upper.
pub(super) fn bounds(numbers: &Numbers<'_>, value: &Value) -> Outcome<Bounds> {
    let corners = numbers.numbers::<6>(value)?;
    let (min, max) = (DVec3::from_slice(&corners[..3]), DVec3::from_slice(&corners[3..]));
    Ok(Bounds::new(min, max).map_err(|error| value.error(error.to_string(), "no box"))?)
}

/// The method of a table; `None` if it has none.
pub(super) fn method<'v>(
    numbers: &Numbers<'_>,
    get: impl Fn(&str) -> Option<&'v Value>,
) -> Outcome<Option<Method>> {
    let name = get("method").and_then(Value::text);
    let lengths = [("step", "sampled"), ("accept_epsilon", "interval")];
    for (key, of) in lengths {
        if let (Some(value), true) = (get(key), name != Some(of)) {
            let message = format!("`{key}` has a meaning with method = \"{of}\" only");
            return Err(value.error(message, "without a meaning").into());
        }
    }
    let positive = (f64::MIN_POSITIVE, f64::MAX, "above 0");
    let length = |key: &str| get(key).map(|value| numbers.ranged(value, positive)).transpose();
    Ok(match name {
        None => None,
        Some("interval") => Some(Method::Interval { accept_epsilon: length("accept_epsilon")? }),
        Some("sampled") => Some(Method::Sampled { step: length("step")? }),
        Some(_) => Some(Method::Affine),
    })
}

/// The settings of a scene, with the wishes of the user before them.
pub(super) fn settings(numbers: &Numbers<'_>, request: &SceneRequest) -> Outcome<Settings> {
    let table = numbers.document().root.table("render").unwrap_or(&EMPTY);
    let get = |key: &str| table.get(key);
    let usual = Settings::default();
    let number = |key: &str| get(key).map(|value| numbers.number(value)).transpose();
    let positive = (f64::MIN_POSITIVE, f64::MAX, "above 0");
    let length = |key: &str| get(key).map(|value| numbers.ranged(value, positive)).transpose();
    let size = match get("size") {
        Some(value) => numbers.numbers::<2>(value)?.map(|side| side as u32),
        None => usual.size.into(),
    };
    let curve = match get("tone_map").and_then(Value::text) {
        Some("khronos-neutral") => ToneCurve::KhronosNeutral,
        Some("aces") => ToneCurve::Aces,
        _ => ToneCurve::Clip,
    };
    let tone = match get("exposure") {
        Some(value) => Tone::new(numbers.number(value)?, curve),
        None => Tone::new(0.0, curve),
    };
    let exposure = || get("exposure").map_or(0..0, |value| value.span.clone());
    let out_of_range = |error: fieldstone_scene::ExposureError| {
        fieldstone_lang::Diagnostic::error(exposure(), error.to_string(), "out of range")
    };
    Ok(Settings {
        size: request.size.unwrap_or(size.into()),
        samples: request
            .samples
            .unwrap_or(number("samples")?.map_or(usual.samples, |n| (n as u32).min(MAX_SAMPLES))),
        method: request.method.or(method(numbers, get)?).unwrap_or(usual.method),
        tolerance: request.tolerance.or(length("tolerance")?),
        shadow_tolerance: length("shadow_tolerance")?,
        bounces: number("bounces")?.map_or(usual.bounces, |n| (n as u32).min(MAX_BOUNCES)),
        tone: tone.map_err(out_of_range)?,
    })
}

/// The camera of a scene, which sees all of `bounds` if nothing else is said.
pub(super) fn camera(
    numbers: &Numbers<'_>,
    request: &SceneRequest,
    (bounds, up): (&Bounds, Up),
    (width, height): (u32, u32),
) -> Outcome<Camera> {
    let table = numbers.document().root.table("camera").unwrap_or(&EMPTY);
    let vector = |key: &str| -> Outcome<Option<DVec3>> {
        Ok(table.get(key).map(|value| numbers.numbers::<3>(value)).transpose()?.map(DVec3::from))
    };
    if let (Some(_), Some(second)) = (table.get("fov"), table.get("ortho")) {
        return Err(second.error("`fov` and `ortho` are two kinds of views", "one too many").into());
    }
    let projection = match (table.get("fov"), table.get("ortho")) {
        (Some(fov), _) => {
            let vertical_fov_radians = numbers.number(fov)?.to_radians();
            Some(Projection::Perspective { vertical_fov_radians })
        }
        (None, Some(height)) => Some(Projection::Orthographic { height: numbers.number(height)? }),
        (None, None) => None,
    };
    let wishes = request.view;
    let view = View {
        eye: wishes.eye.or(vector("eye")?),
        target: wishes.target.or(vector("target")?),
        up: wishes.up.or(vector("up")?),
        projection: wishes.projection.or(projection),
    };
    let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
    let failed =
        |error: fieldstone_scene::CameraError| numbers.document().fault_of("camera", error.to_string());
    let camera = Camera::framing(bounds, &view, up, aspect).map_err(failed)?;
    let radius = table.get("aperture").map_or(Ok(0.0), |value| numbers.number(value))?;
    let focus = table.get("focus").map(|value| numbers.number(value)).transpose()?;
    if radius == 0.0 {
        return Ok(camera);
    }
    let to_target = view.target.unwrap_or(bounds.centre()) - camera.eye();
    let focus_distance = focus.unwrap_or(to_target.dot(camera.forward()));
    camera.with_aperture(Aperture { radius, focus_distance }).map_err(failed)
}
