//! From the wishes of a file to the parts of a scene. What the user asks for goes before what the file asks for.

use fieldstone_lang::{Finish, Lens, Presentation};
use fieldstone_scene::{
    Background, Ball, BallError, Camera, Channel, Light, Lighting, Material, Projection, Rgb, SceneError,
    Solid, Texture, View, srgb_to_linear,
};
use glam::DVec3;

/// The ball that is shown.
pub(crate) fn clip_ball(shown: &Presentation) -> Result<Option<Ball>, BallError> {
    shown.clip_sphere.map(|(centre, radius)| Ball::new(DVec3::from(centre), radius)).transpose()
}

/// The view of the file with the wishes of the user; of a camera that stands elsewhere, the file knows only what it
/// looks at.
pub(crate) fn view(wishes: &View, shown: &Presentation) -> View {
    let Some(known) = shown.view else { return *wishes };
    let target = wishes.target.or(Some(DVec3::from(known.target)));
    if wishes.eye.is_some() || wishes.target.is_some() {
        return View { target, ..*wishes };
    }
    let projection = match known.lens {
        Lens::Perspective { vertical_fov_radians } => Projection::Perspective { vertical_fov_radians },
        Lens::Parallel { height } => Projection::Orthographic { height },
    };
    View {
        eye: Some(DVec3::from(known.eye)),
        target,
        up: wishes.up.or(Some(DVec3::from(known.up))),
        projection: wishes.projection.or(Some(projection)),
    }
}

fn linear(colour: [f64; 3]) -> Rgb {
    DVec3::from(colour.map(srgb_to_linear))
}

/// A solid with the materials of the file, whose colour is that of the first three attributes if it is `coloured`. How
/// much of the light they scatter is in the [`lighting`].
pub(crate) fn with_materials(
    solid: Solid,
    shown: &Presentation,
    coloured: bool,
) -> Result<Solid, SceneError> {
    let material = |side: &Finish| Material::new(linear(side.colour), side.specular, side.shininess).ok();
    let front = shown.front.as_ref().and_then(material).unwrap_or_default();
    let attributes = Texture { channel: Channel::Colour, first: 0, srgb: true };
    let solid = solid.with_material(if coloured { front.with_texture(attributes) } else { front })?;
    match shown.back.as_ref().and_then(material) {
        Some(back) => solid.with_back_material(if coloured { back.with_texture(attributes) } else { back }),
        None => Ok(solid),
    }
}

/// The lights of the file, or those that suit the camera.
///
/// Files give the strength of light in sRGB, where programs of their kind add it up; here light is added in linear RGB.
pub(crate) fn lighting(shown: &Presentation, camera: &Camera) -> Lighting {
    let usual = Lighting::for_camera(camera);
    let background = shown.background.map_or(usual.background, |colour| Background::plain(linear(colour)));
    let Some(lamps) = &shown.lamps else { return Lighting { background, ..usual } };
    let (ambient, diffuse) =
        shown.front.map_or((0.4, 0.8), |Finish { ambient, diffuse, .. }| (ambient, diffuse));
    let light = |lamp: &fieldstone_lang::Lamp| {
        let colour = linear(lamp.colour) * lamp.intensity * diffuse;
        Light::directional(DVec3::from(lamp.to_light), colour).map(Light::without_shadow).ok()
    };
    Lighting {
        lights: lamps.iter().filter_map(light).collect(),
        ambient: DVec3::splat(srgb_to_linear(ambient)),
        background,
        environment: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RenderRequest;
    use fieldstone_lang::{Model, Source, parse_jsurf};
    use fieldstone_scene::Bounds;

    fn model(more: &str) -> Model {
        let text = format!("surface_equation=x^2+y^2+z^2-1\nscale_factor=0.30102999566398\n{more}");
        parse_jsurf(&Source::new("a.jsurf", text)).unwrap()
    }

    #[test]
    fn the_file_decides_what_the_user_leaves_open() {
        let model = model(
            "front_material_color=1 0 0\nbackground_color=0 0 1\nlight_status_0=ON\nlight_position_0=0 0 99",
        );
        let scene = RenderRequest::default().resolve(&model).unwrap().scene;
        let solid = &scene.solids()[0];
        assert!(
            solid.is_surface() && solid.clip_ball().map(Ball::radius).is_some_and(|r| (r - 2.0).abs() < 1e-9)
        );
        assert_eq!(scene.camera().forward(), -DVec3::Z);
        let Projection::Orthographic { height } = scene.camera().projection() else { panic!("parallel") };
        assert!((height - 4.0).abs() < 1e-9);
        assert_eq!(scene.solids()[0].parts()[0].appearance(&[], false).colour, DVec3::X);
        assert_eq!(scene.lighting().background, Background::plain(DVec3::Z));
        assert_eq!(scene.lighting().lights.len(), 1);
    }

    #[test]
    fn the_user_goes_first() {
        let bounds = Bounds::new(DVec3::ZERO, DVec3::ONE).unwrap();
        let view = View { eye: Some(DVec3::X * 9.0), ..View::default() };
        let request = RenderRequest { bounds: Some(bounds), view, ..RenderRequest::default() };
        let scene = request.resolve(&model("")).unwrap().scene;
        assert_eq!(scene.bounds(), bounds);
        assert!((scene.camera().forward() + DVec3::X).length() < 1e-9);
        assert!(matches!(scene.camera().projection(), Projection::Perspective { .. }));
    }
}
