//! Numbers, cameras, lights and settings.

use crate::{at, document, resolve};
use fieldstone::glam::DVec3;
use fieldstone::{
    Background, LightSource, Method, Projection, SceneRequest, Settings, Surroundings, Tone, ToneCurve, View,
    srgb_to_linear,
};

const BALL: &str = "[solids]\nball = \"x^2 + y^2 + z^2 - 1\"\n";

/// The height of an orthographic view, which may be any number of a scene.
fn number(text: &str, time: f64) -> f64 {
    let scene = at(&format!("{BALL}{text}"), time).unwrap_or_else(|error| panic!("{error}")).resolved.scene;
    let Projection::Orthographic { height } = scene.camera().projection() else { panic!("parallel") };
    height
}

#[test]
fn the_scene_with_everything_is_a_scene() {
    let found = resolve(include_str!("everything.toml"));
    let scene = found.resolved.scene;
    assert_eq!(found.objects, ["form", "wire", "die", "object 4", "model", "blends", "morph"]);
    assert_eq!(scene.instances().len(), 3 + 2 + 5 + 2 + 1);
    assert_eq!(scene.lighting().lights.len(), 4);
    let settings = scene.settings();
    assert_eq!((settings.size, settings.bounces), ((32, 24), 3));
    assert_eq!(settings.tone, Tone::new(0.5, ToneCurve::Aces).unwrap());
    assert_eq!(settings.method, Method::Sampled { step: Some(0.001) });
    assert_eq!((settings.tolerance, settings.shadow_tolerance), (Some(1e-6), Some(1e-5)));
    assert_eq!(scene.camera().aperture().map(|a| (a.radius, a.focus_distance)), Some((0.05, 9.0)));
}

#[test]
fn nothing_but_a_solid_is_framed_and_lit() {
    let scene = resolve(BALL).resolved.scene;
    assert_eq!(*scene.settings(), Settings::default());
    assert_eq!(scene.lighting().lights.len(), 2);
    let middle = scene.camera().project(DVec3::ZERO, 1.0).unwrap();
    assert!((middle.0 - 0.5).abs() < 0.1 && (middle.1 - 0.5).abs() < 0.1);
}

#[test]
fn numbers_are_formulas_of_time_and_parameters() {
    let text = "[parameters]\na = 2\nb = \"a^2 + t\"\n[camera]\northo = \"b + c\"\n";
    assert!(at(&format!("{BALL}{text}"), 0.0).unwrap_err().contains("unknown name `c`"));
    assert_eq!(number(&text.replace("b + c", "b + a"), 3.0), 9.0);
    let given = SceneRequest { parameters: vec![("a".to_owned(), 5.0)], ..SceneRequest::default() };
    let scene = document(&format!("{BALL}{}", text.replace("b + c", "b"))).unwrap().resolve(&given).unwrap();
    let projection = scene.resolved.scene.camera().projection();
    assert_eq!(projection, Projection::Orthographic { height: 25.0 });
}

#[test]
fn keys_are_joined_as_they_say() {
    let keyed = |interpolation: &str, time| {
        number(&format!("[camera]\northo = {{ 0 = 1, 1 = 2, 3 = 6{interpolation} }}"), time)
    };
    for interpolation in ["", ", interpolation = \"linear\"", ", interpolation = \"cubic\""] {
        for (time, value) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 2.0), (3.0, 6.0), (9.0, 6.0)] {
            assert_eq!(keyed(interpolation, time), value);
        }
    }
    assert_eq!(keyed("", 2.0), 4.0);
    assert_eq!(keyed(", interpolation = \"step\"", 2.9), 2.0);
    assert_eq!(keyed(", interpolation = \"smooth\"", 0.25), 1.0 + 0.15625);
    // Slopes 5/3 and 2 over a length of 2.
    let hermite = 0.5 * 2.0 + 0.125 * 2.0 * (5.0 / 3.0) + 0.5 * 6.0 - 0.125 * 2.0 * 2.0;
    assert!((keyed(", interpolation = \"cubic\"", 2.0) - hermite).abs() < 1e-12);
    assert_eq!(number("[camera]\northo = { \"0.5\" = 1, \"1.5\" = \"t\" }", 1.5), 1.5);
}

#[test]
fn cameras_are_where_they_are_put() {
    let text =
        format!("{BALL}[camera]\neye = {{ 0 = [6, 0, 2], 4 = [0, 6, 2] }}\ntarget = [0, 0, 2]\nfov = 30\n");
    let scene = at(&text, 2.0).unwrap().resolved.scene;
    assert_eq!(scene.camera().eye(), DVec3::new(3.0, 3.0, 2.0));
    assert!((scene.camera().forward() - DVec3::new(-1.0, -1.0, 0.0).normalize()).length() < 1e-12);
    let Projection::Perspective { vertical_fov_radians } = scene.camera().projection() else { panic!() };
    assert!((vertical_fov_radians.to_degrees() - 30.0).abs() < 1e-9);
    let view = View { eye: Some(DVec3::X * 9.0), ..View::default() };
    let request = SceneRequest { view, size: Some((8, 4)), samples: Some(1), ..SceneRequest::default() };
    let scene = document(&text).unwrap().resolve(&request).unwrap().resolved.scene;
    assert_eq!(scene.camera().eye(), DVec3::X * 9.0);
    assert_eq!((scene.settings().size, scene.settings().samples), ((8, 4), 1));
}

#[test]
fn lights_and_what_surrounds() {
    let text = r##"
        [[lights]]
        kind = "directional"
        towards = [0, 0, 5]
        colour = "#ff0000"
        strength = 2
        [[lights]]
        kind = "sphere"
        position = [1, 2, 3]
        radius = 0.5
        shadows = false
        [background]
        colour = [0, 0.5, 1]
        [environment]
        kind = "gradient"
        zenith = "blue"
        horizon = "white"
        nadir = "black"
        strength = 3
    "##;
    let scene = resolve(&format!("{BALL}{text}")).resolved.scene;
    let lighting = scene.lighting();
    assert_eq!(lighting.ambient, DVec3::ZERO);
    assert_eq!(lighting.lights[0].source(), LightSource::Directional { to_light: DVec3::Z });
    assert_eq!(lighting.lights[0].colour(), DVec3::X * 2.0);
    assert_eq!(
        lighting.lights[1].source(),
        LightSource::Sphere { centre: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 }
    );
    assert!(!lighting.lights[1].casts_shadow());
    assert_eq!(lighting.background, Background::plain(DVec3::new(0.0, srgb_to_linear(0.5), 1.0)));
    let environment = lighting.environment.as_ref().unwrap();
    let gradient = Surroundings::Gradient { zenith: DVec3::Z, horizon: DVec3::ONE, nadir: DVec3::ZERO };
    assert_eq!((environment.surroundings(), environment.strength()), (&gradient, 3.0));
    assert_eq!(environment.up(), DVec3::Z);
}

#[test]
fn y_is_up_where_all_models_say_so() {
    let file = "[solids.a]\nfile = \"painted.hf\"\nparameters = { \"a[1]\" = 1 }\n";
    assert!(resolve(file).resolved.scene.camera().up().y > 0.8);
    assert!(resolve(BALL).resolved.scene.camera().up().z > 0.8);
}

#[test]
fn eyes_that_see_little_are_told() {
    let room = "[environment]\nkind = \"room\"\nbounds = [-9, -9, -9, 9, 9, 9]
        faces = [\"red\", \"red\", \"red\", \"red\", \"red\", \"red\"]\n";
    let messages = |eye: &str, more: &str| {
        let text = format!(
            "[solids]\nball = \"x^2 + y^2 + z^2 - 4\"\n[camera]\neye = {eye}\ntarget = [0.5, 0, 0]
            [materials]\nglass = {{ model = \"glass\" }}\n{more}"
        );
        resolve(&text).messages
    };
    let inside = "warning: ball: the eye is inside of the solid, which is seen from within (choose `eye`)";
    assert_eq!(messages("[1, 1, 1]", ""), [inside]);
    assert_eq!(messages("[1, 1, 3]", ""), [""; 0]);
    let moved = "[[objects]]\nsolid = \"ball\"\ninstances = [{ scale = 0.1 }, { translate = [9, 9, 9] }]\n";
    assert_eq!(messages("[1, 1, 1]", moved), [""; 0]);
    assert_eq!(messages("[8, 9, 9]", moved), [inside]);
    // One may look out of glass.
    assert_eq!(messages("[1, 1, 1]", "[[objects]]\nsolid = \"ball\"\nmaterial = \"glass\""), [""; 0]);
    assert_eq!(messages("[1, 1, 8]", room), [""; 0]);
    let outside = messages("[1, 1, 9.5]", room);
    assert!(
        outside.len() == 1 && outside[0].contains("camera: the eye is outside of the room"),
        "{outside:?}"
    );
}
