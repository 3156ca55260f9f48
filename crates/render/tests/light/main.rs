//! Light against closed forms: furnaces, Snell's law, mirrors, soft shadows, absorption, order of transparent things.

mod furnace;
mod paths;
mod shadows;
mod volumes;

use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
use fieldstone_render::{RenderOptions, Rendered, render};
use fieldstone_scene::{
    Appearance, Background, Bounds, Camera, Environment, Lighting, Material, Pixel, Projection, Rgb, Scene,
    Settings, Solid, Surroundings,
};
use glam::DVec3;

pub(crate) fn point(g: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|i| g.input(Input::Coordinate(i)))
}

/// A solid of one material in a cube around the origin.
pub(crate) fn solid(half: f64, look: Appearance, build: impl FnOnce(&mut Graph) -> NodeId) -> Solid {
    let mut g = Graph::new();
    let value = build(&mut g);
    let bounds = Bounds::new(DVec3::splat(-half), DVec3::splat(half)).expect("the bounds are sound");
    let solid = Solid::new(Field::new(g, value, Vec::new()), Bindings::new(), bounds);
    solid.with_material(Material::of(look).expect("the numbers are sound")).expect("no textures")
}

/// The unit ball.
pub(crate) fn ball(look: Appearance) -> Solid {
    solid(1.2, look, |g| {
        let squares = point(g).map(|x| g.square(x));
        let (xy, one) = (g.add(squares[0], squares[1]), g.constant(1.0));
        let sum = g.add(xy, squares[2]);
        g.sub(sum, one)
    })
}

/// What lies between two heights, of a cube of side 2·`half`.
pub(crate) fn layer(half: f64, low: f64, high: f64, look: Appearance) -> Solid {
    solid(half, look, |g| {
        let [_, _, z] = point(g);
        let (low, high) = (g.constant(low), g.constant(high));
        let (below, above) = (g.sub(low, z), g.sub(z, high));
        g.max(below, above)
    })
}

pub(crate) fn look() -> Appearance {
    Appearance { colour: DVec3::ONE, specular: 0.0, ..Appearance::default() }
}

pub(crate) fn dark() -> Lighting {
    Lighting { background: Background::plain(DVec3::ZERO), ..Lighting::default() }
}

/// The same light from everywhere.
pub(crate) fn even(light: Rgb) -> Lighting {
    let environment = Environment::new(Surroundings::Uniform(light)).expect("the light is sound");
    Lighting { environment: Some(environment), ..dark() }
}

pub(crate) fn camera(eye: DVec3, target: DVec3) -> Camera {
    let lens = Projection::Perspective { vertical_fov_radians: 0.5 };
    Camera::look_at(eye, target, DVec3::new(0.1, 0.2, 1.0), lens).expect("the camera is sound")
}

pub(crate) fn settings(size: u32, samples: u32, bounces: u32) -> Settings {
    Settings { size: (size, size), samples, bounces, ..Settings::default() }
}

pub(crate) fn draw(
    solids: Vec<Solid>,
    camera: Camera,
    lighting: Lighting,
    settings: Settings,
) -> (Scene, Rendered) {
    let scene = Scene::new(solids, camera, lighting, settings).expect("the scene is sound");
    let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
    (scene, rendered)
}

pub(crate) fn pixels((scene, rendered): &(Scene, Rendered)) -> Vec<(u32, u32, Pixel)> {
    let (width, height) = scene.settings().size;
    (0..width * height)
        .map(|i| (i % width, i / width))
        .map(|(x, y)| (x, y, rendered.film.pixel(x, y).expect("the pixel is there")))
        .collect()
}

pub(crate) fn colour(pixel: &Pixel) -> DVec3 {
    DVec3::from_array(pixel.colour.map(f64::from))
}

/// The mean of a component over all pixels.
pub(crate) fn mean(drawn: &(Scene, Rendered)) -> f64 {
    let pixels = pixels(drawn);
    pixels.iter().map(|(.., p)| colour(p).x).sum::<f64>() / pixels.len() as f64
}
