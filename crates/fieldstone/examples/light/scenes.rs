//! The scenes of the pictures.

use fieldstone::glam::DVec3;
use fieldstone::{
    Aperture, Appearance, Background, Bindings, Bounds, Camera, Channel, Environment, Face, Field, Graph,
    Input, Light, Lighting, Material, NodeId, Projection, Scene, Settings, Shading, Solid, Surroundings,
    Texture, Tone, ToneCurve,
};
use std::error::Error;
use std::sync::Arc;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// All scenes with their names.
pub(crate) fn all() -> Result<Vec<(&'static str, Scene)>> {
    Ok(vec![
        ("glass", glass()?),
        ("mirrors", mirrors()?),
        ("shadow", shadow()?),
        ("roughness", roughness()?),
        ("sheets", sheets()?),
        ("lens", lens()?),
        ("room", room()?),
    ])
}

pub(crate) const SHINY: Shading = Shading::Ggx { compensated: true };

/// |x − centre|² − radius².
fn ball_field(g: &mut Graph, centre: DVec3, radius: f64) -> NodeId {
    let mut sum = g.constant(-radius * radius);
    for axis in 0..3 {
        let (x, c) = (g.input(Input::Coordinate(axis)), g.constant(centre[usize::from(axis)]));
        let d = g.sub(x, c);
        let square = g.square(d);
        sum = g.add(sum, square);
    }
    sum
}

pub(crate) fn ball(centre: DVec3, radius: f64, look: Appearance) -> Result<Solid> {
    let mut g = Graph::new();
    let value = ball_field(&mut g, centre, radius);
    let bounds = Bounds::new(centre - 1.1 * radius, centre + 1.1 * radius)?;
    Ok(Solid::new(Field::new(g, value, Vec::new()), Bindings::new(), bounds)
        .with_material(Material::of(look)?)?)
}

/// The half-space z < 0 with squares of two colours, 6 to each side.
pub(crate) fn floor(dark: f64, light: f64) -> Result<Solid> {
    let mut g = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| g.input(Input::Coordinate(i)));
    let pi = g.constant(std::f64::consts::PI);
    let wave = |g: &mut Graph, x| {
        let turn = g.mul(x, pi);
        g.sin(turn)
    };
    let (a, b) = (wave(&mut g, x), wave(&mut g, y));
    let sign = g.mul(a, b);
    let (zero, one, two) = (g.constant(0.0), g.constant(dark), g.constant(light));
    let even = g.lt(sign, zero);
    let shade = g.select(even, one, two);
    let bounds = Bounds::new(DVec3::new(-6.0, -6.0, -0.2), DVec3::new(6.0, 6.0, 0.2))?;
    let matt = Appearance { specular: 0.0, ..Appearance::default() };
    let texture = Texture { channel: Channel::Colour, first: 0, srgb: false };
    let material = Material::of(matt)?.with_texture(texture);
    Ok(Solid::new(Field::new(g, z, vec![shade; 3]), Bindings::new(), bounds).with_material(material)?)
}

pub(crate) fn camera(eye: DVec3, target: DVec3, degrees: f64) -> Result<Camera> {
    let lens = Projection::Perspective { vertical_fov_radians: degrees.to_radians() };
    Ok(Camera::look_at(eye, target, DVec3::Z, lens)?)
}

fn sky() -> Result<Environment> {
    let gradient = Surroundings::Gradient {
        zenith: DVec3::new(0.25, 0.45, 0.9),
        horizon: DVec3::new(0.9, 0.92, 0.95),
        nadir: DVec3::splat(0.25),
    };
    Ok(Environment::new(gradient)?.rotated(DVec3::Z, 0.0)?.with_strength(0.6)?)
}

pub(crate) fn sun() -> Result<Light> {
    Ok(Light::directional(DVec3::new(-0.5, -0.4, 1.0), DVec3::new(1.0, 0.95, 0.85))?)
}

pub(crate) fn lighting(lights: Vec<Light>, environment: Option<Environment>) -> Lighting {
    Lighting { lights, ambient: DVec3::splat(0.1), background: Background::default(), environment }
}

fn settings(width: u32, height: u32, samples: u32) -> Result<Settings> {
    let tone = Tone::new(0.0, ToneCurve::KhronosNeutral)?;
    Ok(Settings { size: (width, height), samples, tone, bounces: 12, ..Settings::default() })
}

pub(crate) fn clear(index: f64, absorption: DVec3) -> Appearance {
    Appearance {
        shading: SHINY,
        colour: DVec3::ONE,
        roughness: 0.0,
        transmission: 1.0,
        index,
        absorption,
        ..Appearance::default()
    }
}

pub(crate) fn metal(colour: DVec3, roughness: f64) -> Appearance {
    Appearance { shading: SHINY, colour, roughness, metallic: 1.0, ..Appearance::default() }
}

fn glass() -> Result<Scene> {
    let green = clear(1.5, DVec3::new(0.9, 0.15, 0.6));
    let solids = vec![
        floor(0.15, 0.8)?,
        ball(DVec3::new(-1.1, 0.0, 1.0), 1.0, clear(1.5, DVec3::ZERO))?,
        ball(DVec3::new(1.2, 0.4, 1.0), 1.0, green)?,
        ball(
            DVec3::new(0.3, 1.9, 0.6),
            0.6,
            Appearance { colour: DVec3::new(0.7, 0.1, 0.05), ..Appearance::default() },
        )?,
    ];
    let camera = camera(DVec3::new(0.0, -7.0, 2.6), DVec3::new(0.0, 0.3, 0.8), 32.0)?;
    Ok(Scene::new(solids, camera, lighting(vec![sun()?], Some(sky()?)), settings(480, 360, 8)?)?)
}

fn mirrors() -> Result<Scene> {
    let mirror = Appearance {
        colour: DVec3::new(0.05, 0.05, 0.06),
        specular: 0.6,
        shininess: 200.0,
        reflection: 0.85,
        fresnel: true,
        ..Appearance::default()
    };
    let gold = metal(DVec3::new(1.0, 0.71, 0.29), 0.0);
    let lacquer = Appearance {
        shading: SHINY,
        colour: DVec3::new(0.6, 0.02, 0.02),
        roughness: 0.0,
        ..Appearance::default()
    };
    let solids = vec![
        floor(0.1, 0.7)?,
        ball(DVec3::new(-1.15, 0.0, 1.0), 1.0, mirror)?,
        ball(DVec3::new(1.15, 0.0, 1.0), 1.0, gold)?,
        ball(DVec3::new(0.0, -1.3, 0.5), 0.5, lacquer)?,
    ];
    let camera = camera(DVec3::new(0.0, -7.0, 2.6), DVec3::new(0.0, 0.0, 0.8), 32.0)?;
    Ok(Scene::new(solids, camera, lighting(vec![sun()?], None), settings(480, 360, 9)?)?)
}

fn shadow() -> Result<Scene> {
    let white = Appearance { colour: DVec3::splat(0.75), ..Appearance::default() };
    let lamp = Light::sphere(DVec3::new(-2.0, -1.5, 4.0), 0.6, DVec3::splat(18.0))?.with_visible(true);
    let sheet = [DVec3::new(0.0, 1.5, 0.0), DVec3::new(0.5, 0.0, 0.0)];
    let strip =
        Light::rectangle(DVec3::new(2.4, -1.0, 2.5), sheet, DVec3::new(2.0, 4.0, 9.0))?.with_visible(true);
    let solids = vec![
        floor(0.45, 0.6)?,
        ball(DVec3::new(0.0, 0.0, 1.0), 0.7, white)?,
        ball(DVec3::new(1.6, 0.8, 0.5), 0.5, metal(DVec3::splat(0.95), 0.0))?,
    ];
    let camera = camera(DVec3::new(0.0, -8.0, 4.0), DVec3::new(0.0, 0.0, 0.9), 34.0)?;
    let lighting = Lighting { ambient: DVec3::splat(0.02), ..lighting(vec![lamp, strip], None) };
    Ok(Scene::new(solids, camera, lighting, settings(480, 360, 8)?)?)
}

fn roughness() -> Result<Scene> {
    let mut solids = vec![floor(0.2, 0.6)?];
    for (i, roughness) in [0.0, 0.15, 0.3, 0.5, 0.75, 1.0].into_iter().enumerate() {
        let x = -3.0 + 1.2 * i as f64;
        let plastic =
            Appearance { colour: DVec3::new(0.1, 0.25, 0.6), metallic: 0.0, ..metal(DVec3::ONE, roughness) };
        let frosted = Appearance { roughness, ..clear(1.5, DVec3::ZERO) };
        solids.push(ball(DVec3::new(x, 0.0, 0.55), 0.55, plastic)?);
        solids.push(ball(DVec3::new(x, 1.3, 0.55), 0.55, metal(DVec3::new(0.95, 0.6, 0.4), roughness))?);
        solids.push(ball(DVec3::new(x, -1.3, 0.55), 0.55, frosted)?);
    }
    let camera = camera(DVec3::new(0.0, -10.0, 5.2), DVec3::new(0.0, -0.1, 0.4), 25.0)?;
    Ok(Scene::new(solids, camera, lighting(vec![sun()?], Some(sky()?)), settings(640, 384, 9)?)?)
}

fn sheets() -> Result<Scene> {
    let mut solids = vec![floor(0.2, 0.7)?];
    let colours = [DVec3::new(0.9, 0.1, 0.1), DVec3::new(0.1, 0.7, 0.1), DVec3::new(0.1, 0.2, 0.9)];
    for (i, colour) in colours.into_iter().enumerate() {
        let soft = Appearance { colour, opacity: 0.4, ..Appearance::default() };
        solids.push(ball(DVec3::new(-1.0 + i as f64, i as f64 * 0.6 - 0.6, 1.0), 0.8, soft)?);
    }
    let camera = camera(DVec3::new(0.0, -7.0, 2.6), DVec3::new(0.0, 0.0, 0.8), 32.0)?;
    Ok(Scene::new(solids, camera, lighting(vec![sun()?], None), settings(480, 360, 4)?)?)
}

fn lens() -> Result<Scene> {
    let mut solids = vec![floor(0.2, 0.7)?];
    for i in 0..6 {
        let colour = DVec3::new(0.8, 0.15 * f64::from(i), 0.1);
        let place = DVec3::new(-2.0 + 0.8 * f64::from(i), -3.0 + 1.4 * f64::from(i), 0.4);
        solids.push(ball(place, 0.4, Appearance { colour, ..Appearance::default() })?);
    }
    let camera = camera(DVec3::new(0.0, -8.0, 2.0), DVec3::new(0.0, -0.2, 0.4), 32.0)?;
    let camera = camera.with_aperture(Aperture { radius: 0.15, focus_distance: 8.0 })?;
    Ok(Scene::new(solids, camera, lighting(vec![sun()?], Some(sky()?)), settings(480, 360, 16)?)?)
}

/// A glass and a mirror ball in a box with a chequered floor and ceiling.
fn room() -> Result<Scene> {
    let plain = |r, g, b| Face::Plain(DVec3::new(r, g, b));
    let checker = |a: f64, b: f64| Face::Checker { colours: [DVec3::splat(a), DVec3::splat(b)], count: 10 };
    let walls = [
        plain(0.7, 0.2, 0.15),
        plain(0.15, 0.3, 0.7),
        checker(0.9, 1.0),
        checker(0.1, 0.8),
        plain(0.8, 0.75, 0.6),
        plain(0.5, 0.5, 0.45),
    ];
    let bounds = Bounds::new(DVec3::new(-3.0, -7.5, -0.5), DVec3::new(3.0, 3.0, 4.0))?;
    let room = Surroundings::Room { bounds, walls: Arc::new(walls) };
    let room = Environment::new(room)?.rotated(DVec3::Z, 0.0)?;
    let solids = vec![
        ball(DVec3::new(-1.0, 0.0, 1.2), 0.9, clear(1.5, DVec3::ZERO))?,
        ball(DVec3::new(1.0, 0.6, 1.2), 0.9, metal(DVec3::splat(0.95), 0.0))?,
        ball(
            DVec3::new(0.3, -0.8, 0.3),
            0.4,
            Appearance { colour: DVec3::new(0.8, 0.5, 0.1), ..Appearance::default() },
        )?,
    ];
    let camera = camera(DVec3::new(0.0, -7.0, 2.2), DVec3::new(0.0, 0.0, 1.2), 38.0)?;
    Ok(Scene::new(solids, camera, lighting(Vec::new(), Some(room)), settings(480, 360, 8)?)?)
}
