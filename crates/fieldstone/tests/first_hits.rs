//! First hits against the truth: dense sampling in double precision with refined minima.
//!
//! Every solid is drawn from three sides, from near and from 1,000 units away, at 128 × 128, with `affine` and with
//! `interval`, by the renderer itself; the depth, hit and certificate layers are compared with the truth ray by ray.

#![allow(clippy::print_stdout, reason = "the test reports what it measured")]

mod truth;

use fieldstone_field::{Bindings, Field};
use fieldstone_lang::{Source, parse_formula};
use fieldstone_render::{RenderOptions, render};
use fieldstone_scene::{Bounds, Camera, Lighting, Method, Scene, Settings, Solid};
use glam::DVec3;
use truth::{Reference, SIZE, compare, truths, views};

struct Case {
    name: &'static str,
    formula: String,
    half: f64,
    /// A quarter of the thinnest feature, at most.
    step: f64,
}

fn case(name: &'static str, formula: &str, half: f64, step: f64) -> Case {
    Case { name, formula: formula.to_string(), half, step }
}

/// Hijazi et al. 2008, Table 1, with the signs that its text lost.
fn table_1() -> Vec<Case> {
    let decocube =
        "((x^2+y^2-.8^2)^2+(z^2-1)^2)*((y^2+z^2-.8^2)^2+(x^2-1)^2)*((z^2+x^2-.8^2)^2+(y^2-1)^2)-.02";
    let heart = "(2*x^2+y^2+z^2-1)^3-(.1*x^2+y^2)*z^3";
    let torus = "(1-sqrt(x^2+y^2))^2+z^2-.125";
    let icos = "2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))";
    let sc = "x*y+cos(z)+1.741*sin(2*x)*sin(z)*cos(y)+sin(2*y)*sin(x)*cos(z)+sin(2*z)*sin(y)*cos(x)\
              -cos(2*x)*cos(2*y)+cos(2*y)*cos(2*z)+cos(2*z)*cos(2*x)+.05";
    vec![
        case("sphere", "x^2+y^2+z^2-1", 1.1, 0.01),
        case("cylinder", "x^2+y^2-1", 1.3, 0.01),
        case("ellipsoid", ".25*x^2+.25*y^2+z^2-1", 2.2, 0.01),
        case("pseudo-cube", "x^500+y^500+z^500-.25", 1.2, 0.01),
        case("torus", torus, 1.5, 0.01),
        case("bretzel", "1/10*(x^2*(1.21-x^2)^2*(3.8-x^2)^3-10*y^2)^2+60*z^2-2", 2.3, 0.005),
        case("tangle", "x^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8", 2.6, 0.01),
        case("decocube", decocube, 1.4, 0.005),
        case("superquadric", "x^200+(.5*y^4+.5*z^4)^4-1", 1.4, 0.01),
        case("heart", heart, 1.5, 0.002),
        case("citrus", "x^2+z^2-4*y^3*(1-.5*y)^3", 2.2, 0.002),
        case("trigonometric", "(1-sqrt(x^2+y^2))^2+sin(z)^3-.125", 4.0, 0.01),
        case(
            "icos",
            &format!("let u=(1+sqrt(5))/2; max({icos}, x^2+y^2+z^2-36, 20.25-x^2-y^2-z^2)"),
            6.2,
            0.01,
        ),
        case("sesc", &format!("max(x^6+.5*(y^4+z^4)^4-20, -({sc}))"), 2.0, 0.004),
        case(
            "multiple unions",
            &format!(
                "min(x^500+y^500+z^500-.25, (x-1)^2+(y-1)^2+(z-1)^2-.2, {decocube}, {heart}, {torus}, \
                 (x+1)^2+(y+1)^2+(z+1)^2-.1)"
            ),
            1.6,
            0.004,
        ),
    ]
}

fn thin() -> Vec<Case> {
    let r = "sqrt(x^2+y^2+z^2)";
    let needle = |a: &str, b: &str, along: &str| format!("max(sqrt({a}^2+{b}^2)-.01, abs({along})-1)");
    let needles =
        format!("min({}, {}, {})", needle("x", "y", "z"), needle("y", "z", "x"), needle("z", "x", "y"));
    vec![
        case("plate 0.001 thin", "max(abs(z+.3*x)-.0005, x^2+y^2-1)", 1.1, 0.00025),
        case("shell 0.001 thin", &format!("abs({r}-1)-.0005"), 1.1, 0.00025),
        case(
            "shell 0.001 over a ball, gap 0.001",
            &format!("min(abs({r}-1)-.0005, {r}-.9985)"),
            1.1,
            0.00025,
        ),
        case("crossing needles 0.02 thick", &needles, 1.1, 0.004),
    ]
}

fn scene(field: &Field, bounds: Bounds, camera: Camera, method: Method) -> Scene {
    let solid = Solid::new(field.clone(), Bindings::new(), bounds);
    let settings = Settings { size: (SIZE, SIZE), samples: 1, method, ..Settings::default() };
    let lighting = Lighting { lights: Vec::new(), ..Lighting::for_camera(&camera) };
    Scene::new(vec![solid], camera, lighting, settings).expect("the scene is sound")
}

fn field_of(case: &Case) -> (Field, Bounds) {
    let model = parse_formula(&Source::new(case.name, case.formula.as_str())).expect("the formula is sound");
    let half = DVec3::splat(case.half);
    (model.field, Bounds::new(-half, half).expect("the bounds are sound"))
}

fn check(case: &Case) {
    let (field, bounds) = field_of(case);
    let mut reference = Reference::new(&field);
    for (view, camera) in views(&bounds) {
        let affine = scene(&field, bounds, camera, Method::Affine);
        let truths = truths(&mut reference, &affine, case.step);
        for (method, scene) in [
            ("affine", affine),
            ("interval", scene(&field, bounds, camera, Method::Interval { accept_epsilon: None })),
        ] {
            let rendered = render(&scene, &RenderOptions::default()).expect("threads start");
            let report = compare(&rendered.film, &truths, bounds.longest_side());
            let place = format!("{}, {view}, {method}", case.name);
            println!(
                "{place}: {} hits, {} grazing {:?}, {} uncertified, {:.2} evaluations a ray",
                report.hits,
                report.grazing.len(),
                report.grazing,
                report.uncertified.len(),
                rendered.stats.evaluations as f64 / f64::from(SIZE * SIZE)
            );
            assert!(report.hits > 50, "{place}: nothing to be seen");
            assert!(report.is_right(), "{place}: {report:?}");
            assert!(method != "affine" || report.is_certified(), "{place}: {report:?}");
        }
    }
}

#[test]
fn table_1_first_half() {
    table_1().iter().step_by(2).for_each(check);
}

#[test]
fn table_1_second_half() {
    table_1().iter().skip(1).step_by(2).for_each(check);
}

#[test]
fn thin_solids() {
    thin().iter().for_each(check);
}

/// The check must reject what is wrong: sampling that steps over a thin shell, and depths that are a little off.
#[test]
fn the_check_rejects_wrong_pictures() {
    let shell = &thin()[1];
    let (field, bounds) = field_of(shell);
    let (_, camera) = views(&bounds).swap_remove(0);
    let right = scene(&field, bounds, camera, Method::Affine);
    let truths = truths(&mut Reference::new(&field), &right, shell.step);

    let coarse = scene(&field, bounds, camera, Method::Sampled { step: Some(0.01) });
    let stepped = render(&coarse, &RenderOptions::default()).expect("threads start").film;
    let report = compare(&stepped, &truths, bounds.longest_side());
    assert!(!report.missed.is_empty() && !report.is_right() && !report.is_certified());

    let mut film = render(&right, &RenderOptions::default()).expect("threads start").film;
    assert!(compare(&film, &truths, bounds.longest_side()).is_right());
    let mut pixel = film.pixel(64, 64).expect("the pixel is in the film");
    assert!(pixel.depth.is_finite());
    pixel.depth += 3e-4 * bounds.longest_side() as f32;
    film.set(64, 64, &pixel);
    assert_eq!(compare(&film, &truths, bounds.longest_side()).displaced.len(), 1);
}
