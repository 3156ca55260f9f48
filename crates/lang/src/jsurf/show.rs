//! How a `.jsurf` file wants its surface shown.
//!
//! Four spaces: the *camera* stands at the origin of its space and looks along −z; in *clip* space the unit ball is what
//! is shown; *model* space is that of the equation. The file gives `camera_from_world` (`camera_transform`),
//! `clip_from_world` (`transform_matrix` · `rotation_matrix`) and `model_from_clip` (`surface_transform_matrix` · scale).

use super::reader::Reader;
use crate::presentation::{Finish, Lamp, Lens, Presentation, Viewpoint};
use glam::{DMat4, DVec3};

/// The number of lights.
const LIGHTS: usize = 8;

/// How far a matrix may be from a rotation with a scale, relative to the scale: programs accumulate turns in `f32`.
const SKEW: f64 = 1e-3;

/// The largest power of ten of the scale.
const LARGEST_SCALE: f64 = 30.0;

/// What SURFER's files say of materials where nothing else is said.
const USUAL: Finish = Finish { colour: [0.5; 3], ambient: 0.4, diffuse: 0.8, specular: 0.5, shininess: 30.0 };

/// Reads everything but the surface itself.
pub(super) fn presentation(reader: &mut Reader<'_>) -> Presentation {
    let clip_from_world = matrix(reader, "transform_matrix") * matrix(reader, "rotation_matrix");
    let camera_from_world = camera_transform(reader);
    let model_from_clip = matrix(reader, "surface_transform_matrix") * scale(reader);
    let model_from_camera = model_from_clip * clip_from_world * camera_from_world.inverse();
    let radius = model_from_clip.transform_vector3(DVec3::X).length();
    let centre = model_from_clip.transform_point3(DVec3::ZERO);
    if is_skew(&model_from_clip) {
        let help = "a ball of the size of its first half-axis is taken";
        let message = "what is shown is not a ball".to_owned();
        reader.warn_about("surface_transform_matrix", message, "scales the axes differently", help);
    }
    if is_skew(&(clip_from_world * camera_from_world.inverse())) {
        let help = "the nearest view without a distortion is taken";
        let key =
            if reader.take("rotation_matrix").is_some() { "rotation_matrix" } else { "transform_matrix" };
        reader.warn_about(key, "the view is distorted".to_owned(), "not a rotation", help);
    }
    Presentation {
        surface: true,
        clip_sphere: Some((centre.to_array(), radius)),
        front: finish(reader, "front_material"),
        back: finish(reader, "back_material"),
        background: reader.colour("background_color"),
        view: viewpoint(reader, &model_from_camera, (centre, radius)),
        lamps: lamps(reader, &model_from_camera),
    }
}

/// A matrix written row by row, the identity if there is none.
fn matrix(reader: &mut Reader<'_>, key: &str) -> DMat4 {
    let Some(rows) = reader.numbers::<16>(key) else { return DMat4::IDENTITY };
    let matrix = DMat4::from_cols_array(&rows).transpose();
    let is_affine = rows[12..] == [0.0, 0.0, 0.0, 1.0];
    let determinant = matrix.determinant();
    if is_affine && determinant.is_normal() && matrix.inverse().is_finite() {
        return matrix;
    }
    let (message, label) = match is_affine {
        true => ("the matrix cannot be inverted", "its rows depend on each other"),
        false => ("the matrix is not affine", "its last row is not `0 0 0 1`"),
    };
    reader.fail_about(key, message.to_owned(), label, "write 4 rows of 4 numbers, the last `0 0 0 1`");
    DMat4::IDENTITY
}

/// SURFER's camera stands one radius before the middle if the file does not say where.
fn camera_transform(reader: &mut Reader<'_>) -> DMat4 {
    match reader.take("camera_transform") {
        Some(_) => matrix(reader, "camera_transform"),
        None => DMat4::from_translation(-DVec3::Z),
    }
}

fn scale(reader: &mut Reader<'_>) -> DMat4 {
    let power = reader.number("scale_factor").unwrap_or(0.0);
    if power.abs() > LARGEST_SCALE {
        let message = format!("the scale 10^{power} is out of range");
        let label = format!("not between -{LARGEST_SCALE} and {LARGEST_SCALE}");
        reader.fail_about("scale_factor", message, &label, "it is the logarithm of the radius to base 10");
        return DMat4::IDENTITY;
    }
    DMat4::from_scale(DVec3::splat(10.0_f64.powf(power)))
}

/// Whether a map is not a rotation with one scale for all axes, up to rounding; reflections are skew.
fn is_skew(map: &DMat4) -> bool {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| map.transform_vector3(axis));
    let size = axes[0].length();
    let is_off = |value: f64, expected: f64| (value - expected).abs() > SKEW * size;
    let lengths = axes.iter().any(|axis| is_off(axis.length(), size));
    lengths || is_off((axes[0].cross(axes[1]) / size).dot(axes[2]) / size, size)
}

fn viewpoint(
    reader: &mut Reader<'_>,
    model_from_camera: &DMat4,
    (centre, radius): (DVec3, f64),
) -> Option<Viewpoint> {
    let eye = model_from_camera.transform_point3(DVec3::ZERO);
    let forward = model_from_camera.transform_vector3(-DVec3::Z).try_normalize()?;
    let scaled_up = model_from_camera.transform_vector3(DVec3::Y);
    let up = scaled_up.reject_from_normalized(forward).try_normalize()?;
    let height = positive(reader, "camera_height", 2.0) * scaled_up.length();
    let degrees = positive(reader, "camera_fov_y", 60.0).min(179.0);
    let kind = reader.take("camera_type").map_or("ORTHOGRAPHIC_CAMERA", |value| value.text.trim());
    let lens = match kind {
        "ORTHOGRAPHIC_CAMERA" => Lens::Parallel { height },
        "PERSPECTIVE_CAMERA" => Lens::Perspective { vertical_fov_radians: degrees.to_radians() },
        other => {
            let help = "write `ORTHOGRAPHIC_CAMERA` or `PERSPECTIVE_CAMERA`";
            reader.fail_about("camera_type", format!("unknown camera `{other}`"), "not a camera", help);
            return None;
        }
    };
    // A parallel view from outside of the ball is the same from farther away, with all of the ball before it.
    let is_outside = eye.distance(centre) > radius * (1.0 - SKEW);
    let back = if is_outside && matches!(lens, Lens::Parallel { .. }) { radius } else { 0.0 };
    let eye = eye - forward * back;
    let ahead = (centre - eye).dot(forward).max(radius);
    let target = eye + forward * ahead;
    Some(Viewpoint { eye: eye.to_array(), target: target.to_array(), up: up.to_array(), lens })
}

/// A number above 0.
fn positive(reader: &mut Reader<'_>, key: &str, otherwise: f64) -> f64 {
    let Some(value) = reader.number(key) else { return otherwise };
    if value > 0.0 {
        return value;
    }
    let help = format!("{otherwise} is taken");
    reader.warn_about(key, format!("`{key}` cannot be {value}"), "not above 0", &help);
    otherwise
}

/// A material; nothing if the file says nothing of it.
fn finish(reader: &mut Reader<'_>, side: &str) -> Option<Finish> {
    let colour = reader.colour(&format!("{side}_color"));
    let mut part = |name: &str, least: f64| reader.number_from(&format!("{side}_{name}"), least);
    let (ambient, diffuse) = (part("ambient_intensity", 0.0), part("diffuse_intensity", 0.0));
    let specular = part("specular_intensity", 0.0);
    // So the first versions spelt it.
    let misspelt = part("specular_iIntensity", 0.0);
    let (specular, shininess) = (specular.or(misspelt), part("shininess", 1.0));
    if [ambient, diffuse, specular, shininess].iter().all(Option::is_none) && colour.is_none() {
        return None;
    }
    Some(Finish {
        colour: colour.unwrap_or(USUAL.colour),
        ambient: ambient.unwrap_or(USUAL.ambient),
        diffuse: diffuse.unwrap_or(USUAL.diffuse),
        specular: specular.unwrap_or(USUAL.specular),
        shininess: shininess.unwrap_or(USUAL.shininess),
    })
}

/// The lights that are on; `None` if the file has no word of light.
fn lamps(reader: &mut Reader<'_>, model_from_camera: &DMat4) -> Option<Vec<Lamp>> {
    let mut any = false;
    let mut lamps = Vec::new();
    for number in 0..LIGHTS {
        let status = reader.take(&format!("light_status_{number}")).map(|value| value.text.trim().to_owned());
        let position = reader.numbers::<3>(&format!("light_position_{number}"));
        let colour = reader.colour(&format!("light_color_{number}"));
        let intensity = reader.number_from(&format!("light_intensity_{number}"), 0.0);
        any |= status.is_some();
        if !is_on(reader, number, status.as_deref()) {
            continue;
        }
        let towards = DVec3::from(position.unwrap_or_default());
        let Some(to_light) = model_from_camera.transform_vector3(towards).try_normalize() else {
            let key = format!("light_status_{number}");
            let help = format!("give it a place: `light_position_{number}=-100 100 100`");
            reader.warn_about(&key, format!("light {number} is nowhere"), "left out", &help);
            continue;
        };
        check_distance(reader, number, towards);
        lamps.push(Lamp {
            to_light: to_light.to_array(),
            colour: colour.unwrap_or([1.0; 3]),
            intensity: intensity.unwrap_or(1.0),
        });
    }
    any.then_some(lamps)
}

fn is_on(reader: &mut Reader<'_>, number: usize, status: Option<&str>) -> bool {
    match status {
        Some("ON") => return true,
        Some("OFF") | None => {}
        Some(other) => {
            let key = format!("light_status_{number}");
            let message = format!("a light cannot be `{other}`");
            reader.warn_about(&key, message, "taken as off", "write `ON` or `OFF`");
        }
    }
    false
}

/// In the space of the camera, what is shown is about two units long.
fn check_distance(reader: &mut Reader<'_>, number: usize, position: DVec3) {
    const FAR: f64 = 10.0;
    if position.length() < FAR {
        let key = format!("light_position_{number}");
        let message = format!("light {number} is near");
        let help = format!("its direction is right from a distance of {FAR} on");
        reader.warn_about(&key, message, "taken as infinitely far away", &help);
    }
}
