//! Surfaces without an inside, and solids cut by balls, against closed forms.

use fieldstone_field::{Bindings, Field};
use fieldstone_lang::{Source, parse_formula};
use fieldstone_render::{RenderOptions, Rendered, render};
use fieldstone_scene::{
    Background, Ball, Bounds, Camera, Film, Light, Lighting, Method, Pixel, Projection, Scene, Settings,
    Solid,
};
use glam::DVec3;

const SIZE: u32 = 128;

/// Rays that pass the surface of a ball of radius 1 this closely may hit it or not.
const GRAZING: f64 = 1e-9;

fn solid(formula: &str, half: f64) -> Solid {
    let model = parse_formula(&Source::new("formula", formula)).expect("the formula is sound");
    let bounds = Bounds::new(DVec3::splat(-half), DVec3::splat(half)).expect("the bounds are sound");
    Solid::new(model.field, Bindings::new(), bounds)
}

fn surface(formula: &str, half: f64) -> Solid {
    solid(formula, half).with_surface(true)
}

fn camera(eye: DVec3, height: f64) -> Camera {
    let vertical_fov_radians = 2.0 * (0.5 * height / eye.length()).atan();
    let up = if eye.x == 0.0 && eye.y == 0.0 { DVec3::Y } else { DVec3::Z };
    let lens = Projection::Perspective { vertical_fov_radians };
    Camera::look_at(eye, DVec3::ZERO, up, lens).expect("the camera is sound")
}

fn draw(solid: Solid, camera: Camera, lights: Vec<Light>, method: Method) -> (Scene, Rendered) {
    let settings = Settings { size: (SIZE, SIZE), samples: 1, method, ..Settings::default() };
    let lighting = Lighting {
        lights,
        ambient: DVec3::ZERO,
        background: Background::plain(DVec3::ZERO),
        environment: None,
    };
    let scene = Scene::new(vec![solid], camera, lighting, settings).expect("the scene is sound");
    let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
    (scene, rendered)
}

/// Every pixel with its ray.
fn pixels<'a>(scene: &'a Scene, film: &'a Film) -> impl Iterator<Item = (DVec3, DVec3, Pixel)> + 'a {
    (0..SIZE * SIZE).map(|i| {
        let (x, y) = (i % SIZE, i / SIZE);
        let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        (origin, direction, film.pixel(x, y).expect("the pixel is there"))
    })
}

fn normal(pixel: &Pixel) -> DVec3 {
    DVec3::from_array(pixel.normal.map(f64::from))
}

/// Pixels that differ from the unit sphere: in whether they hit, where, or in their normal.
fn wrong_pixels(scene: &Scene, film: &Film, depth_error: f64) -> Vec<String> {
    let mut wrong = Vec::new();
    for (origin, direction, pixel) in pixels(scene, film) {
        let nearest = -origin.dot(direction);
        let apart = (origin + nearest * direction).length();
        if (apart - 1.0).abs() < GRAZING {
            continue;
        }
        let hit = (apart < 1.0).then(|| nearest - (1.0 - apart * apart).sqrt());
        let found = pixel.depth.is_finite().then_some(f64::from(pixel.depth));
        match (hit, found) {
            (None, None) => {}
            (Some(t), Some(depth)) => {
                let slant = (1.0 - apart * apart).sqrt();
                let off = (normal(&pixel) - (origin + t * direction)).length();
                if (t - depth).abs() > depth_error * t || off > 1e-4 / slant.max(1e-3) {
                    wrong.push(format!("{depth} is not {t}, the normal is {off} off"));
                }
            }
            _ => wrong.push(format!("{found:?} is not {hit:?}, {} from the sphere", apart - 1.0)),
        }
    }
    wrong
}

#[test]
fn double_spheres_are_spheres_from_near_and_far() {
    let squared = "(x^2+y^2+z^2-1)^2";
    // Sign changes; a square; a square multiplied out by hand; a kink; a fourth power.
    let formulas =
        ["x^2+y^2+z^2-1", squared, "0-(x^2+y^2+z^2-1)^2", "abs(x^2+y^2+z^2-1)", "(x^2+y^2+z^2-1)^4"];
    for distance in [4.0, 1000.0] {
        for method in [Method::Affine, Method::Interval { accept_epsilon: None }] {
            for formula in formulas {
                let eye = distance * DVec3::new(0.48, -0.6, 0.64);
                let camera = camera(eye, 2.4 * (1.0 - 1.0 / distance));
                let (scene, rendered) = draw(surface(formula, 1.1), camera, Vec::new(), method);
                let wrong = wrong_pixels(&scene, &rendered.film, 1e-6);
                assert!(wrong.is_empty(), "{formula} from {distance}, {method:?}: {wrong:#?}");
                let touching = rendered.stats.tolerance;
                match (method, formula) {
                    (Method::Affine, "x^2+y^2+z^2-1") => assert_eq!(touching + rendered.stats.undecided, 0),
                    // What touches is never called certified, and nothing is undecided.
                    (Method::Affine, _) => {
                        assert!((rendered.stats.hits..rendered.stats.hits + 20).contains(&touching))
                    }
                    _ => {}
                }
                assert!(rendered.stats.hits > 5000 && rendered.stats.undecided < 10, "{:?}", rendered.stats);
            }
        }
    }
}

/// The comparison must reject what is wrong: another radius, another normal, a hole.
#[test]
fn the_comparison_rejects_other_spheres() {
    let camera = camera(DVec3::new(0.0, -4.0, 0.0), 2.4);
    let (scene, rendered) = draw(surface("(x^2+y^2+z^2-1.01)^2", 1.1), camera, Vec::new(), Method::Affine);
    assert!(wrong_pixels(&scene, &rendered.film, 1e-6).len() > 5000);
    let (scene, mut rendered) = draw(surface("(x^2+y^2+z^2-1)^2", 1.1), camera, Vec::new(), Method::Affine);
    rendered.film.set(64, 64, &Pixel::MISS);
    assert_eq!(wrong_pixels(&scene, &rendered.film, 1e-6).len(), 1);
}

#[test]
fn double_planes_have_two_sides_and_no_thickness() {
    for z in [2.0, -2.0] {
        let camera = camera(DVec3::new(0.5, -3.0, z), 1.5);
        let lamp = |to_light: DVec3| vec![Light::directional(to_light, DVec3::ONE).expect("sound")];
        for (light, lit) in [(DVec3::new(0.2, 0.3, z), true), (DVec3::new(0.2, 0.3, -z), false)] {
            let (scene, rendered) = draw(surface("z^2", 1.0), camera, lamp(light), Method::Affine);
            for (origin, direction, pixel) in pixels(&scene, &rendered.film) {
                let t = -origin.z / direction.z;
                let place = origin + t * direction;
                let off = place.x.abs().max(place.y.abs()) - 1.0;
                if off.abs() < 1e-9 {
                    continue;
                }
                assert_eq!(pixel.depth.is_finite(), off < 0.0, "{place}");
                if off < 0.0 {
                    assert!((f64::from(pixel.depth) - t).abs() < 1e-6);
                    assert!((normal(&pixel) - z.signum() * DVec3::Z).length() < 1e-6);
                    assert_eq!(pixel.colour[0] > 0.0, lit);
                }
            }
        }
    }
}

/// A double sphere of radius ½ casts the shadow of a ball on a double plane, whichever side the light comes from.
#[test]
fn double_roots_cast_shadows() {
    let centre = DVec3::new(0.0, 0.0, 1.0);
    let formula = "z^2*(x^2+y^2+(z-1)^2-.25)^2";
    let to_sun = DVec3::new(0.3, 0.2, 1.0).normalize();
    let lights = vec![Light::directional(to_sun, DVec3::ONE).expect("sound")];
    let camera = camera(DVec3::new(1.0, -5.0, 4.0), 4.0);
    let (scene, rendered) = draw(surface(formula, 2.0), camera, lights, Method::Affine);
    let (mut dark, mut bright) = (0, 0);
    for (origin, direction, pixel) in pixels(&scene, &rendered.film) {
        let place = origin + f64::from(pixel.depth) * direction;
        if !(pixel.depth.is_finite() && place.z.abs() < 1e-4) {
            continue;
        }
        let apart = (centre - place).cross(to_sun).length();
        if (apart - 0.5).abs() < 1e-4 {
            continue;
        }
        let is_dark = pixel.colour.iter().all(|c| *c == 0.0);
        assert_eq!(is_dark, apart < 0.5, "at {place}, {apart} from the axis of light");
        (dark, bright) = (dark + u32::from(is_dark), bright + u32::from(!is_dark));
    }
    assert!(dark > 100 && bright > 1000, "{dark} in shadow, {bright} in light");
}

/// The double lines of Steiner's surface beyond its pinch points are lines: no pixel shows them by chance.
#[test]
fn lines_are_not_drawn_thick() {
    let steiner = "x^2*y^2+y^2*z^2+z^2*x^2+x*y*z";
    let eye = DVec3::new(2.03, -4.01, 2.52);
    let (scene, rendered) = draw(surface(steiner, 2.0), camera(eye, 4.0), Vec::new(), Method::Affine);
    let mut hits = 0;
    for (origin, direction, pixel) in pixels(&scene, &rendered.film).filter(|(.., p)| p.depth.is_finite()) {
        let place = origin + f64::from(pixel.depth) * direction;
        // The surface itself lies in the ball of radius √3/4 around (∓¼, ∓¼, ∓¼), of which 0.87 is the farthest.
        assert!(place.length() < 0.87, "{place}");
        hits += 1;
    }
    assert!(hits > 200, "{hits}");
    assert_eq!(rendered.stats.undecided, 0);
}

#[test]
fn bounds_and_balls_close_no_surface() {
    let eye = DVec3::new(0.0, 0.0, 6.0);
    let clip = Ball::new(DVec3::new(0.0, 0.0, -1.0), 1.5).expect("sound");
    for (formula, touching) in [("x^2+y^2+z^2-1", false), ("(x^2+y^2+z^2-1)^2", true)] {
        let clipped = surface(formula, 1.1).with_clip_ball(Some(clip));
        let (scene, rendered) = draw(clipped, camera(eye, 1.0), Vec::new(), Method::Affine);
        for (origin, direction, pixel) in pixels(&scene, &rendered.film) {
            // The near half is cut off: the far half is seen from inside.
            let nearest = -origin.dot(direction);
            let apart = (origin + nearest * direction).length();
            let t = nearest + (1.0 - apart * apart).sqrt();
            assert!((f64::from(pixel.depth) - t).abs() < 1e-5, "{} is not {t}", pixel.depth);
            assert!((normal(&pixel) + origin + t * direction).length() < 1e-4);
            assert_eq!(pixel.certificate, if touching { 2.0 } else { 1.0 });
        }
    }
}

/// The first span of a line in a ball.
fn span(ball: (DVec3, f64), origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    let nearest = (ball.0 - origin).dot(direction);
    let apart = (origin + nearest * direction - ball.0).length_squared();
    let half = (ball.1 * ball.1 - apart).sqrt();
    (half > 0.0).then_some((nearest - half, nearest + half))
}

/// A ball of radius 1 cut by another: where the second is entered inside the first, there is a cap with its normal; where
/// the first is entered inside the second, the surface itself.
#[test]
fn balls_cut_solids_and_close_them_unless_open() {
    let (unit, other) = ((DVec3::ZERO, 1.0), (DVec3::new(0.3, 0.9, 0.2), 1.2));
    let clip = Ball::new(other.0, other.1).expect("sound");
    for (capped, eye) in [
        (true, DVec3::new(0.5, -5.0, 1.0)),
        (true, DVec3::new(2.0, 5.0, 1.0)),
        (false, DVec3::new(0.5, -5.0, 1.0)),
    ] {
        let solid = solid("x^2+y^2+z^2-1", 1.1).with_clip_ball(Some(clip)).with_caps(capped);
        let (scene, rendered) = draw(solid, camera(eye, 2.5), Vec::new(), Method::Affine);
        let mut caps = 0;
        for (origin, direction, pixel) in pixels(&scene, &rendered.film) {
            let both = span(unit, origin, direction).zip(span(other, origin, direction));
            let both = both.filter(|(a, b)| a.0.max(b.0) < a.1.min(b.1));
            let expected = both.and_then(|(a, b)| match (a.0 < b.0, capped) {
                (false, _) => Some((a.0, DVec3::ZERO, 1.0)),
                (true, true) => Some((b.0, other.0, other.1)),
                // The way out, unless that is cut off too.
                (true, false) => (a.1 < b.1).then_some((a.1, DVec3::ZERO, -1.0)),
            });
            caps += u32::from(both.is_some_and(|(a, b)| a.0 < b.0));
            let found = pixel.depth.is_finite();
            assert_eq!(found, expected.is_some(), "{expected:?} {pixel:?}");
            let Some((t, centre, radius)) = expected else { continue };
            assert!((f64::from(pixel.depth) - t).abs() < 1e-5, "{} is not {t}", pixel.depth);
            let outward = (origin + t * direction - centre) / radius;
            assert!((normal(&pixel) - outward).length() < 1e-3, "{outward} {pixel:?}");
            assert_eq!(pixel.certificate, 1.0);
        }
        assert!(caps > 500 || eye.y > 0.0, "{caps}");
        assert_eq!(rendered.stats.certified, u64::from(SIZE * SIZE));
    }
}

/// Hijazi et al. 2008 draw icos within a sphere.
#[test]
fn icos_in_a_sphere_ends_on_it() {
    let formula = "let u=(1+sqrt(5))/2; \
                   2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))";
    let clip = Ball::new(DVec3::ZERO, 5.0).expect("sound");
    let solid = solid(formula, 5.0).with_clip_ball(Some(clip));
    let field: Field = solid.field().clone();
    let (scene, rendered) =
        draw(solid, camera(DVec3::new(6.0, -14.0, 8.0), 10.4), Vec::new(), Method::Affine);
    let (mut caps, mut hits) = (0, 0);
    for (origin, direction, pixel) in pixels(&scene, &rendered.film).filter(|(.., p)| p.depth.is_finite()) {
        let place = origin + f64::from(pixel.depth) * direction;
        hits += 1;
        assert!(place.length() < 5.0 + 1e-5, "{place}");
        let value = field.at(&place.to_array(), &Bindings::new())[0];
        if place.length() > 5.0 - 1e-6 && value < -1e-3 {
            caps += 1;
            assert!((normal(&pixel) - place / 5.0).length() < 1e-5, "{pixel:?}");
        } else {
            assert!(value.abs() < 1e-3, "{place}: {value}");
        }
    }
    assert!(caps > 20 && hits > 4000, "{caps} on caps, {hits} hits");
    assert_eq!(rendered.stats.undecided, 0);
}
