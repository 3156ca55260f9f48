//! Pictures against closed forms: depth, normals, light and shadow of balls and planes.

use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
use fieldstone_render::{RenderError, RenderOptions, Rendered, render};
use fieldstone_scene::{
    Background, Bounds, Camera, Channel, Film, Light, Lighting, Material, Method, Projection, Scene,
    Settings, Solid, Texture, linear_to_srgb,
};
use glam::DVec3;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

const SIZE: u32 = 96;

fn point(g: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|i| g.input(Input::Coordinate(i)))
}

/// |x − centre|² − radius².
fn ball(g: &mut Graph, centre: DVec3, radius: f64) -> NodeId {
    let mut sum = g.constant(-radius * radius);
    for (axis, x) in point(g).into_iter().enumerate() {
        let c = g.constant(centre[axis]);
        let d = g.sub(x, c);
        let square = g.square(d);
        sum = g.add(sum, square);
    }
    sum
}

fn field(build: impl FnOnce(&mut Graph) -> NodeId) -> Field {
    let mut g = Graph::new();
    let value = build(&mut g);
    Field::new(g, value, Vec::new())
}

fn unit_ball() -> Field {
    field(|g| ball(g, DVec3::ZERO, 1.0))
}

fn cube(half: f64) -> Bounds {
    Bounds::new(DVec3::splat(-half), DVec3::splat(half)).expect("the bounds are sound")
}

fn camera(eye: DVec3, projection: Projection) -> Camera {
    Camera::look_at(eye, DVec3::ZERO, DVec3::Z, projection).expect("the camera is sound")
}

fn perspective(eye: DVec3) -> Camera {
    camera(eye, Projection::Perspective { vertical_fov_radians: 0.6 })
}

fn draw(solids: Vec<Solid>, camera: Camera, lighting: Lighting, method: Method) -> (Scene, Rendered) {
    let settings = Settings { size: (SIZE, SIZE), samples: 1, method, ..Settings::default() };
    let scene = Scene::new(solids, camera, lighting, settings).expect("the scene is sound");
    let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
    (scene, rendered)
}

fn dark() -> Lighting {
    Lighting {
        lights: Vec::new(),
        ambient: DVec3::ZERO,
        background: Background::plain(DVec3::ZERO),
        environment: None,
    }
}

fn pixels(film: &Film) -> impl Iterator<Item = (u32, u32, fieldstone_scene::Pixel)> + '_ {
    (0..SIZE * SIZE)
        .map(|i| (i % SIZE, i / SIZE, film.pixel(i % SIZE, i / SIZE).expect("the pixel is there")))
}

/// The first t at which a ray meets a ball, from outside.
fn meets(origin: DVec3, direction: DVec3, centre: DVec3, radius: f64) -> Option<f64> {
    let (b, c) = ((origin - centre).dot(direction), (origin - centre).length_squared() - radius * radius);
    let discriminant = b * b - c;
    (discriminant > 0.0).then(|| -b - discriminant.sqrt()).filter(|t| *t > 0.0)
}

#[test]
fn depth_and_normals_of_a_ball_are_exact() {
    let eye = DVec3::new(2.0, -4.0, 1.5);
    let cameras = [perspective(eye), camera(eye, Projection::Orthographic { height: 2.6 })];
    for camera in cameras {
        for method in
            [Method::Affine, Method::Interval { accept_epsilon: None }, Method::Sampled { step: None }]
        {
            let solid = Solid::new(unit_ball(), Bindings::new(), cube(1.2));
            let (scene, rendered) = draw(vec![solid], camera, dark(), method);
            let mut hits = 0;
            for (x, y, pixel) in pixels(&rendered.film) {
                let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let Some(t) = meets(origin, direction, DVec3::ZERO, 1.0) else {
                    assert_eq!((pixel.depth, pixel.normal, pixel.part), (f32::INFINITY, [0.0; 3], -1.0));
                    continue;
                };
                hits += 1;
                let normal = origin + t * direction;
                assert!((f64::from(pixel.depth) - t).abs() < 3e-6, "{} is not {t}", pixel.depth);
                let error = DVec3::from_array(pixel.normal.map(f64::from)) - normal;
                assert!(error.length() < 2e-5 / normal.dot(-direction).max(1e-3), "{method:?}: {error}");
                assert_eq!(pixel.part, 0.0);
            }
            assert_eq!(rendered.stats.hits, hits);
            let certified = rendered.stats.certified;
            match method {
                Method::Affine => assert_eq!(certified, u64::from(SIZE * SIZE)),
                Method::Interval { .. } => assert!(certified > 9000, "{certified}"),
                Method::Sampled { .. } => assert_eq!(certified, 0),
            }
        }
    }
}

#[test]
fn light_is_that_of_blinn_and_phong() {
    let eye = DVec3::new(0.0, -5.0, 0.0);
    let to_light = DVec3::new(0.4, -1.0, 0.8).normalize();
    let colour = DVec3::new(1.0, 0.9, 0.7);
    let material = Material::new(DVec3::new(0.5, 0.25, 0.125), 0.3, 20.0).expect("the material is sound");
    let solid = Solid::new(unit_ball(), Bindings::new(), cube(1.2))
        .with_material(material.clone())
        .expect("no textures");
    let light = Light::directional(to_light, colour).expect("the light is sound");
    let ambient = DVec3::splat(0.05);
    let lighting = Lighting { lights: vec![light], ambient, ..dark() };
    let (scene, rendered) = draw(vec![solid], perspective(eye), lighting, Method::Affine);
    for (x, y, pixel) in pixels(&rendered.film) {
        let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let Some(t) = meets(origin, direction, DVec3::ZERO, 1.0) else { continue };
        let normal = origin + t * direction;
        let cosine = normal.dot(to_light);
        let half = (to_light - direction).normalize();
        let mut expected = material.base().colour * ambient;
        if cosine > 0.0 {
            let highlight = 0.3 * half.dot(normal).max(0.0).powf(20.0);
            expected += colour * cosine * (material.base().colour + DVec3::splat(highlight));
        }
        // At the terminator a rounding decides.
        if cosine.abs() > 1e-4 {
            let seen = DVec3::from_array(pixel.colour.map(f64::from));
            assert!((seen - expected).length() < 1e-4, "{seen} is not {expected} at {x}, {y}");
        }
    }
}

/// A ball of radius ½ one unit above the top of a slab, from obliquely above, in the light of a lamp or of the sun.
#[test]
fn the_shadow_of_a_ball_on_a_plane_is_exact() {
    let centre = DVec3::new(0.0, 0.0, 0.8);
    let field = field(|g| {
        let [_, _, z] = point(g);
        let level = g.constant(-0.2);
        let ground = g.sub(z, level);
        let above = ball(g, centre, 0.5);
        g.min(ground, above)
    });
    let to_sun = DVec3::new(0.3, 0.2, 1.0).normalize();
    let lamp = DVec3::new(0.4, -0.3, 3.5);
    let sun = Light::directional(to_sun, DVec3::ONE).expect("the light is sound");
    let bulb = Light::point(lamp, DVec3::splat(20.0)).expect("the light is sound");
    for (light, lamp) in [(sun, None), (bulb, Some(lamp))] {
        let lighting = Lighting { lights: vec![light], ..dark() };
        let solid = Solid::new(field.clone(), Bindings::new(), cube(2.0));
        let (scene, rendered) =
            draw(vec![solid], perspective(DVec3::new(1.0, -5.0, 4.0)), lighting, Method::Affine);
        let (mut in_shadow, mut in_light) = (0, 0);
        for (x, y, pixel) in pixels(&rendered.film) {
            let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let place = origin + f64::from(pixel.depth) * direction;
            if !(pixel.depth.is_finite() && (place.z + 0.2).abs() < 1e-4) {
                continue;
            }
            let to_light = lamp.map_or(to_sun, |lamp| (lamp - place).normalize());
            let toward = (centre - place).dot(to_light);
            let distance = (centre - place - toward * to_light).length();
            if (distance - 0.5).abs() < 1e-4 {
                continue;
            }
            let dark = pixel.colour.iter().all(|c| *c == 0.0);
            assert_eq!(dark, distance < 0.5, "at {place}, {distance} from the axis of light");
            in_shadow += u32::from(dark);
            in_light += u32::from(!dark);
        }
        assert!(in_shadow > 100 && in_light > 1000, "{in_shadow} in shadow, {in_light} in light");
    }
}

/// max(z, z − r/r), r = max(½ − z, 0), is the half-space z < 0, and 0/0 above z = ½, where all light comes through.
#[test]
fn light_arrives_through_places_without_a_value() {
    let field = field(|g| {
        let [_, _, z] = point(g);
        let half = g.constant(0.5);
        let (room, zero) = (g.sub(half, z), g.constant(0.0));
        let positive = g.max(room, zero);
        let quotient = g.div(positive, positive);
        let lower = g.sub(z, quotient);
        g.max(z, lower)
    });
    let sun = Light::directional(DVec3::new(0.3, 0.2, 1.0), DVec3::ONE).expect("the light is sound");
    let lighting = Lighting { lights: vec![sun], ..dark() };
    let solid = Solid::new(field, Bindings::new(), cube(1.0));
    let (_, rendered) = draw(vec![solid], perspective(DVec3::new(0.0, -5.0, 4.0)), lighting, Method::Affine);
    let on_top = pixels(&rendered.film).filter(|(.., p)| p.depth.is_finite() && p.normal[2] > 0.9999);
    let seen = on_top.map(|(.., p)| {
        assert!(p.colour[0] > 0.0, "{p:?}");
        p.certificate
    });
    // They are seen through the same places.
    assert!(seen.filter(|certificate| *certificate == 3.0).count() > 500);
}

/// What stands behind a lamp blocks nothing, however far the lamp is from other places.
#[test]
fn nothing_behind_a_lamp_casts_a_shadow() {
    let field = field(|g| {
        let [_, _, z] = point(g);
        let level = g.constant(-1.0);
        let ground = g.sub(z, level);
        let above = ball(g, DVec3::new(0.0, 0.0, 1.2), 0.3);
        g.min(ground, above)
    });
    let lamp = Light::point(DVec3::new(0.0, 0.0, 0.2), DVec3::splat(5.0)).expect("the light is sound");
    let lighting = Lighting { lights: vec![lamp], ..dark() };
    let solid = Solid::new(field, Bindings::new(), cube(2.0));
    let (_, rendered) = draw(vec![solid], perspective(DVec3::new(0.0, -5.0, 4.0)), lighting, Method::Affine);
    let on_top = pixels(&rendered.film).filter(|(.., p)| p.depth.is_finite() && p.normal[2] > 0.9999);
    assert!(on_top.map(|(.., p)| assert!(p.colour[0] > 0.0, "{p:?}")).count() > 1000);
}

#[test]
fn a_lit_convex_solid_casts_no_shadow_on_itself() {
    // Acne would show as black pixels where the light falls steeply enough.
    let to_light = DVec3::new(-0.5, -0.4, 0.8).normalize();
    let lighting =
        Lighting { lights: vec![Light::directional(to_light, DVec3::ONE).expect("sound")], ..dark() };
    for distance in [4.0, 1000.0] {
        let eye = distance * DVec3::new(0.3, -0.9, 0.4).normalize();
        let view = Projection::Perspective { vertical_fov_radians: 2.5 / distance };
        let solid = Solid::new(unit_ball(), Bindings::new(), cube(1.2));
        let (_, rendered) = draw(vec![solid], camera(eye, view), lighting.clone(), Method::Affine);
        for (x, y, pixel) in pixels(&rendered.film).filter(|(.., p)| p.depth.is_finite()) {
            let cosine = DVec3::from_array(pixel.normal.map(f64::from)).dot(to_light);
            let lit = pixel.colour.iter().any(|c| *c > 0.0);
            assert!(cosine.abs() < 1e-3 || lit == (cosine > 0.0), "{x}, {y} from {distance}: {cosine}");
        }
    }
}

#[test]
fn bounds_cut_solids_and_close_them_unless_open() {
    let bounds = Bounds::new(DVec3::new(-2.0, -0.5, -2.0), DVec3::new(2.0, 2.0, 2.0)).expect("sound");
    let eye = DVec3::new(0.0, -6.0, 0.0);
    for capped in [true, false] {
        let solid = Solid::new(unit_ball(), Bindings::new(), bounds).with_caps(capped);
        let (_, rendered) = draw(vec![solid], perspective(eye), dark(), Method::Affine);
        let pixel = rendered.film.pixel(SIZE / 2, SIZE / 2).expect("the middle");
        let depth = if capped { 5.5 } else { 7.0 };
        assert!((pixel.depth - depth).abs() < 1e-3, "{} with caps {capped}", pixel.depth);
        // Towards the eye: the cap, or the inside of the far half.
        assert!(pixel.normal[1] < -0.999);
        assert_eq!(pixel.certificate, 1.0);
    }
}

#[test]
fn from_inside_the_first_boundary_ahead_is_seen() {
    let solid = Solid::new(unit_ball(), Bindings::new(), cube(1.2));
    let camera = Camera::look_at(
        DVec3::new(0.0, 0.2, 0.0),
        DVec3::Y,
        DVec3::Z,
        Projection::Perspective { vertical_fov_radians: 0.6 },
    );
    let (_, rendered) = draw(vec![solid], camera.expect("sound"), dark(), Method::Affine);
    let pixel = rendered.film.pixel(SIZE / 2, SIZE / 2).expect("the middle");
    assert!((pixel.depth - 0.8).abs() < 1e-3 && pixel.normal[1] < -0.999, "{pixel:?}");
}

#[test]
fn the_nearest_of_several_parts_is_seen() {
    let parts = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0)];
    let solids = parts.map(|c| Solid::new(field(|g| ball(g, c, 0.5)), Bindings::new(), cube(1.6)));
    let (_, rendered) =
        draw(solids.to_vec(), perspective(DVec3::new(0.0, -6.0, 0.0)), dark(), Method::Affine);
    assert_eq!(rendered.film.pixel(SIZE / 2, SIZE / 2).expect("the middle").part, 1.0);
}

#[test]
fn attributes_are_colours() {
    let mut g = Graph::new();
    let value = ball(&mut g, DVec3::ZERO, 1.0);
    let [x, ..] = point(&mut g);
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    // Set inside only, as HyperFun's attribute functions do.
    let inside = g.le(value, zero);
    let right = g.lt(zero, x);
    let red = g.select(right, one, zero);
    let red = g.select(inside, red, zero);
    let green = g.select(inside, one, zero);
    let field = Field::new(g, value, vec![red, green, zero]);
    let solid = Solid::new(field, Bindings::new(), cube(1.2)).with_material(
        Material::default().with_texture(Texture { channel: Channel::Colour, first: 0, srgb: true }),
    );
    let lighting = Lighting { ambient: DVec3::ONE, ..dark() };
    let eye = DVec3::new(0.0, -5.0, 0.0);
    let (_, rendered) =
        draw(vec![solid.expect("three attributes")], perspective(eye), lighting, Method::Affine);
    for (x, _, pixel) in pixels(&rendered.film).filter(|(.., p)| p.depth.is_finite()) {
        let expected = [if x >= SIZE / 2 { 1.0 } else { 0.0f64 }, 1.0, 0.0];
        let seen = pixel.colour.map(|c| linear_to_srgb(f64::from(c)));
        assert!(seen.iter().zip(expected).all(|(s, e)| (s - e).abs() < 1e-6), "{seen:?} at {x}");
    }
}

/// −1 inside of a ball and 1 outside: a jump without a gradient anywhere.
#[test]
fn normals_at_jumps_come_from_signs() {
    let jump = field(|g| {
        let (ball, zero) = (ball(g, DVec3::ZERO, 1.0), g.constant(0.0));
        let (inside, outside) = (g.constant(-1.0), g.constant(1.0));
        let is_inside = g.lt(ball, zero);
        g.select(is_inside, inside, outside)
    });
    let solid = Solid::new(jump, Bindings::new(), cube(1.2));
    let eye = DVec3::new(2.0, -4.0, 1.5);
    let (scene, rendered) = draw(vec![solid], perspective(eye), dark(), Method::Affine);
    let mut hits = 0;
    for (x, y, pixel) in pixels(&rendered.film).filter(|(.., p)| p.depth.is_finite()) {
        let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let place = origin + f64::from(pixel.depth) * direction;
        let error = DVec3::from_array(pixel.normal.map(f64::from)) - place.normalize();
        // A normal that points away from the eye would be turned.
        if place.normalize().dot(direction) < -0.01 {
            assert!(error.length() < 1e-3, "{error} at {place}");
            hits += 1;
        }
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn black_boxes_are_drawn_and_undecided() {
    let field = Field::from_fn(|p| p.iter().map(|c| c * c).sum::<f64>() - 1.0);
    let solid = Solid::new(field, Bindings::new(), cube(1.2));
    let (_, rendered) = draw(vec![solid], perspective(DVec3::new(0.0, -5.0, 0.0)), dark(), Method::Affine);
    let pixel = rendered.film.pixel(SIZE / 2, SIZE / 2).expect("the middle");
    assert!((pixel.depth - 4.0).abs() < 1e-3 && pixel.normal[1] < -0.999, "{pixel:?}");
    assert_eq!(pixel.certificate, 3.0);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let solid = Solid::new(unit_ball(), Bindings::new(), cube(1.2));
    let camera = perspective(DVec3::new(1.0, -4.0, 2.0));
    let settings = Settings { size: (SIZE, SIZE), ..Settings::default() };
    let scene = Scene::new(vec![solid], camera, Lighting::for_camera(&camera), settings).expect("sound");
    let with = |threads| {
        render(&scene, &RenderOptions { threads: Some(threads), ..RenderOptions::default() })
            .expect("threads")
    };
    let (one, three) = (with(1), with(3));
    assert!(one.film == three.film && one.stats == three.stats);
    // Edges are covered in part, and there only.
    let alphas: Vec<f32> = pixels(&one.film).map(|(.., p)| p.alpha).collect();
    let partly = alphas.iter().filter(|a| **a > 0.0 && **a < 1.0).count();
    assert!((50..500).contains(&partly), "{partly} pixels are covered in part");
}

#[test]
fn work_that_is_cancelled_stops() {
    let camera = perspective(DVec3::new(0.0, -5.0, 0.0));
    let solids = vec![Solid::new(unit_ball(), Bindings::new(), cube(1.5))];
    let (scene, _) = draw(solids, camera, dark(), Method::Affine);
    let cancel = AtomicBool::new(false);
    let most = AtomicU64::new(0);
    let progress = |share: f64| {
        most.fetch_max((share * 1000.0) as u64, Ordering::Relaxed);
        cancel.store(true, Ordering::Relaxed);
    };
    let options = RenderOptions {
        threads: Some(1),
        progress: Some(&progress),
        cancel: Some(&cancel),
        ..RenderOptions::default()
    };
    assert_eq!(render(&scene, &options).map(|_| ()), Err(RenderError::Cancelled));
    assert!(most.into_inner() < 500, "only the tiles at work are finished");
}
