//! Whether the eye stands where one sees little.

use crate::request::Warning;
use fieldstone_scene::{Channel, Part, Projection, Scene, Solid, Surroundings};
use glam::DVec3;

/// Of so many copies whose bounds hold the eye, more are not looked at.
const MOST_COPIES: usize = 64;

/// What the place of the eye gives reason to say, and of which solid.
pub(crate) fn warning(scene: &Scene) -> Option<(Option<usize>, Warning)> {
    // Rays of parallel views begin outside of everything.
    if matches!(scene.camera().projection(), Projection::Orthographic { .. }) {
        return None;
    }
    let eye = scene.camera().eye();
    let near = scene.instances().iter().filter_map(|instance| {
        let solid = &scene.solids()[instance.solid()];
        let place = instance.object_from_world().transform_point3(eye);
        solid.bounds().contains(place).then_some((instance.solid(), solid, place))
    });
    let inside = near.take(MOST_COPIES).find(|(_, solid, place)| is_opaque(solid) && holds(solid, *place));
    if let Some((number, ..)) = inside {
        return Some((Some(number), Warning::EyeInside));
    }
    let environment = scene.lighting().environment.as_ref()?;
    match environment.surroundings() {
        Surroundings::Room { bounds, .. } if !bounds.contains(eye) => Some((None, Warning::EyeOutsideRoom)),
        _ => None,
    }
}

/// Whether a place in its bounds is inside of a solid that is closed there.
fn holds(solid: &Solid, place: DVec3) -> bool {
    let is_in_ball = solid.clip_ball().is_none_or(|ball| place.distance(ball.centre()) < ball.radius());
    let is_closed = !solid.is_surface() && solid.conditions().is_empty();
    is_in_ball && is_closed && solid.field().at(&place.to_array(), solid.bindings())[0] < 0.0
}

/// Whether one sees nothing through a solid: from inside of glass one does.
fn is_opaque(solid: &Solid) -> bool {
    let is_clear = |part: &Part| {
        part.materials.iter().any(|blended| {
            let material = &blended.material;
            let varies = |channel| material.textures().iter().any(|texture| texture.channel == channel);
            material.base().transmission > 0.0
                || material.base().opacity < 1.0
                || varies(Channel::Transmission)
                || varies(Channel::Opacity)
        })
    };
    !solid.parts().iter().any(is_clear)
}
