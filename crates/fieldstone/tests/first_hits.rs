//! First hits against the truth: dense sampling in double precision with refined minima.
//!
//! Every solid is drawn from three sides, from near and from 1,000 units away, at 128 × 128, with `affine` and with
//! `interval`, by the renderer itself; the depth, hit and certificate layers are compared with the truth ray by ray.

#![allow(clippy::print_stdout, reason = "the test reports what it measured")]

use fieldstone_field::{Bindings, F64, Field, LANES, Points, Tape, TapeOptions, Workspace};
use fieldstone_lang::{Source, parse_formula};
use fieldstone_render::{RenderOptions, render};
use fieldstone_scene::{Bounds, Camera, Film, Lighting, Method, Scene, Settings, Solid, Up, View};
use glam::DVec3;

const SIZE: u32 = 128;
/// How far a hit may lie from the truth, relative to the longest side of the bounds.
const DEPTH_TOLERANCE: f64 = 1e-4;
/// How many pixels may graze the surface so closely that the truth itself is in doubt.
const GRAZING_SHARE: f64 = 0.001;
/// How many pixels must be certified with `affine`.
const CERTIFIED_SHARE: f64 = 0.999;

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

/// What is true of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Truth {
    Hit(f64),
    Miss,
    /// The surface comes so close to being touched, before any hit, that values cannot tell.
    Grazing,
}

struct Reference {
    tape: Tape,
    workspace: Workspace<F64, Points>,
}

impl Reference {
    fn new(field: &Field) -> Self {
        Self { tape: Tape::new(field, &TapeOptions::default()), workspace: Workspace::new() }
    }

    fn values(&mut self, origin: DVec3, direction: DVec3, places: &[f64]) -> Vec<f64> {
        let mut values = Vec::with_capacity(places.len());
        for block in places.chunks(LANES) {
            for axis in 0..3 {
                for (to, t) in self.workspace.input(axis, 0).iter_mut().zip(block) {
                    *to = origin[axis] + direction[axis] * t;
                }
            }
            self.workspace.run(&self.tape, block.len());
            values.extend_from_slice(&self.workspace.output(0, 0)[..block.len()]);
        }
        values
    }

    fn truth(&mut self, origin: DVec3, direction: DVec3, bounds: &Bounds, step: f64) -> Truth {
        let Some(span) = bounds.ray_span(origin, direction) else { return Truth::Miss };
        let count = ((span.exit - span.enter) / step).ceil().max(2.0) as usize;
        let places: Vec<f64> =
            (0..=count).map(|i| span.enter + (span.exit - span.enter) * i as f64 / count as f64).collect();
        let values = self.values(origin, direction, &places);
        if values[0] < 0.0 {
            return Truth::Hit(span.enter);
        }
        for i in 1..=count {
            if values[i] < 0.0 {
                return Truth::Hit(self.bisect(origin, direction, places[i - 1], places[i]));
            }
            let lowest = i < count && values[i] <= values[i - 1] && values[i] <= values[i + 1];
            if lowest && values[i + 1] >= 0.0 {
                let (t, value) = self.minimum(origin, direction, places[i - 1], places[i + 1]);
                if value < 0.0 {
                    return Truth::Hit(self.bisect(origin, direction, places[i - 1], t));
                }
                // Far below what rounding leaves of so small a difference.
                if value <= 1e-9 * values[i - 1].min(values[i + 1]) {
                    return Truth::Grazing;
                }
            }
        }
        Truth::Miss
    }

    fn at(&mut self, origin: DVec3, direction: DVec3, t: f64) -> f64 {
        self.values(origin, direction, &[t])[0]
    }

    fn bisect(&mut self, origin: DVec3, direction: DVec3, outside: f64, inside: f64) -> f64 {
        let (mut a, mut b) = (outside, inside);
        for _ in 0..50 {
            let middle = 0.5 * (a + b);
            if self.at(origin, direction, middle) < 0.0 {
                b = middle;
            } else {
                a = middle;
            }
        }
        b
    }

    /// The least value between two places, by golden sections; stops where it is negative.
    fn minimum(&mut self, origin: DVec3, direction: DVec3, a: f64, b: f64) -> (f64, f64) {
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let (mut a, mut b) = (a, b);
        let mut best = (a, f64::INFINITY);
        for _ in 0..60 {
            let (p, q) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
            let pair = self.values(origin, direction, &[p, q]);
            for (t, value) in [(p, pair[0]), (q, pair[1])] {
                if value < best.1 {
                    best = (t, value);
                }
            }
            if best.1 < 0.0 {
                break;
            }
            if pair[0] < pair[1] {
                b = q;
            } else {
                a = p;
            }
        }
        best
    }
}

#[derive(Debug, Default)]
struct Report {
    missed: Vec<(u32, u32)>,
    false_hits: Vec<(u32, u32)>,
    displaced: Vec<(u32, u32, f64)>,
    grazing: Vec<(u32, u32)>,
    uncertified: Vec<(u32, u32)>,
    uncertified_off_silhouettes: Vec<(u32, u32)>,
    hits: usize,
}

impl Report {
    fn is_right(&self) -> bool {
        self.missed.is_empty()
            && self.false_hits.is_empty()
            && self.displaced.is_empty()
            && (self.grazing.len() as f64) <= GRAZING_SHARE * f64::from(SIZE * SIZE)
    }

    fn is_certified(&self) -> bool {
        let share = 1.0 - self.uncertified.len() as f64 / f64::from(SIZE * SIZE);
        share >= CERTIFIED_SHARE && self.uncertified_off_silhouettes.is_empty()
    }
}

fn compare(film: &Film, truths: &[Truth], size: f64) -> Report {
    let mut report = Report::default();
    for y in 0..SIZE {
        for x in 0..SIZE {
            let pixel = film.pixel(x, y).expect("the pixel is in the film");
            let depth = f64::from(pixel.depth);
            match (truths[(y * SIZE + x) as usize], depth.is_finite()) {
                (Truth::Grazing, _) => report.grazing.push((x, y)),
                (Truth::Hit(_), false) => report.missed.push((x, y)),
                (Truth::Miss, true) => report.false_hits.push((x, y)),
                (Truth::Hit(t), true) if (t - depth).abs() > DEPTH_TOLERANCE * size => {
                    report.displaced.push((x, y, depth - t));
                }
                _ => {}
            }
            report.hits += usize::from(depth.is_finite());
            if pixel.certificate != 1.0 {
                report.uncertified.push((x, y));
                if !near_silhouette(film, x, y, size) {
                    report.uncertified_off_silhouettes.push((x, y));
                }
            }
        }
    }
    report
}

/// Whether depth breaks off within 2 pixels.
fn near_silhouette(film: &Film, x: u32, y: u32, size: f64) -> bool {
    let range = |c: u32| c.saturating_sub(2)..=(c + 2).min(SIZE - 1);
    let depths: Vec<f64> = range(y)
        .flat_map(|v| range(x).map(move |u| (u, v)))
        .filter_map(|(u, v)| film.pixel(u, v).map(|p| f64::from(p.depth)))
        .collect();
    let (near, far) = depths.iter().fold((f64::INFINITY, 0.0f64), |(n, f), &d| (n.min(d), f.max(d)));
    far - near > 0.02 * size
}

fn views(bounds: &Bounds) -> Vec<(String, Camera)> {
    let directions =
        [DVec3::new(0.62, -1.0, 0.57), DVec3::new(-0.9, 0.31, 0.8), DVec3::new(0.11, 0.17, -1.0)];
    let radius = 0.5 * bounds.size().length();
    let mut views = Vec::new();
    for (i, direction) in directions.into_iter().enumerate() {
        for distance in [2.5 * radius, 1000.0] {
            let eye = bounds.centre() + distance * direction.normalize();
            let view = View { eye: Some(eye), ..View::default() };
            let camera = Camera::framing(bounds, &view, Up::Z, 1.0);
            views.push((format!("view {i} from {distance:.0}"), camera.expect("the view is sound")));
        }
    }
    views
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

fn truths(reference: &mut Reference, scene: &Scene, step: f64) -> Vec<Truth> {
    let bounds = scene.bounds();
    (0..SIZE * SIZE)
        .map(|i| {
            let (origin, direction) = scene.ray(f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
            reference.truth(origin, direction, &bounds, step)
        })
        .collect()
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
