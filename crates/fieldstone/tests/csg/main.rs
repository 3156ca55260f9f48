//! Which part of a solid is seen, against dense sampling: who owns a hit is told by which part begins or ends there.

#![allow(clippy::print_stdout, reason = "the tests report what they measured")]

mod conditions;
mod panels;
mod sensitivity;
#[path = "../truth/mod.rs"]
mod truth;

use fieldstone_render::{RenderOptions, render};
use fieldstone_scene::{Camera, Film, Lighting, Method, Scene, Settings, Solid, Tree};
use glam::DVec3;
use panels::{Panel, bounds, not, panels, part};
use truth::{Reference, SIZE, Truth, compare, truths, views};

/// Parts that change closer together than this, relative to the size, are at the same place.
const TOGETHER: f64 = 1e-8;

pub(crate) fn scene(solids: Vec<Solid>, camera: Camera, method: Method) -> Scene {
    let settings = Settings { size: (SIZE, SIZE), samples: 1, method, ..Settings::default() };
    let lighting = Lighting { lights: Vec::new(), ..Lighting::for_camera(&camera) };
    Scene::new(solids, camera, lighting, settings).expect("the scene is sound")
}

pub(crate) fn draw(scene: &Scene) -> Film {
    render(scene, &RenderOptions::default()).expect("threads start").film
}

/// The parts that may own what is truly hit; none on a miss, several where they change at the same place.
fn owners(
    panel: &Panel,
    parts: &mut [Reference],
    ray: (DVec3, DVec3),
    truth: Truth,
    enter: f64,
) -> Vec<usize> {
    let Truth::Hit(t) = truth else { return Vec::new() };
    let hair = TOGETHER * 2.0 * panel.half;
    let mut inside =
        |t: f64| -> Vec<bool> { parts.iter_mut().map(|part| part.at(ray.0, ray.1, t) < 0.0).collect() };
    let (before, behind) = (inside(t - hair), inside(t + hair));
    if t == enter {
        // A face of the bounds.
        return panel.tree.holder(&|part| behind[part]).into_iter().collect();
    }
    (0..parts.len()).filter(|&part| before[part] != behind[part]).collect()
}

/// Pixels of which the part is wrong, and how many are seen where several parts change.
fn wrong_parts(film: &Film, owners: &[Vec<usize>], certified_only: bool) -> (Vec<(u32, u32)>, usize) {
    let (mut wrong, mut shared) = (Vec::new(), 0);
    for (i, owners) in (0..SIZE * SIZE).zip(owners) {
        let pixel = film.pixel(i % SIZE, i / SIZE).expect("the pixel is in the film");
        if pixel.part < 0.0 || owners.is_empty() || (certified_only && pixel.certificate != 1.0) {
            continue;
        }
        shared += usize::from(owners.len() > 1);
        if !owners.iter().any(|&owner| owner as f32 == pixel.part) {
            wrong.push((i % SIZE, i / SIZE));
        }
    }
    (wrong, shared)
}

/// What is true of a view of a panel.
pub(crate) struct True {
    pub(crate) truths: Vec<Truth>,
    pub(crate) owners: Vec<Vec<usize>>,
}

pub(crate) fn true_view(panel: &Panel, scene: &Scene) -> True {
    let field = panel.field();
    let mut parts: Vec<Reference> = field
        .attributes()
        .iter()
        .map(|&part| Reference::new(&fieldstone_field::Field::new(field.graph().clone(), part, Vec::new())))
        .collect();
    let truths = truths(&mut Reference::new(&field), scene, panel.step);
    let owners = (0..).zip(&truths).map(|(i, &truth)| {
        let ray = scene.ray(f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
        let enter = bounds(panel.half).ray_span(ray.0, ray.1).map_or(0.0, |span| span.enter);
        owners(panel, &mut parts, ray, truth, enter)
    });
    let owners = owners.collect();
    True { truths, owners }
}

/// The views from near.
fn near_views(half: f64) -> Vec<(String, Camera)> {
    views(&bounds(half)).into_iter().step_by(2).collect()
}

fn check(panel: &Panel) {
    for (view, camera) in near_views(panel.half) {
        let scene = scene(vec![panel.solid()], camera, Method::Affine);
        let truth = true_view(panel, &scene);
        let film = draw(&scene);
        let report = compare(&film, &truth.truths, 2.0 * panel.half);
        let (wrong, shared) = wrong_parts(&film, &truth.owners, true);
        let place = format!("{}, {view}", panel.name);
        println!(
            "{place}: {} hits, {} grazing, {} uncertified, {} wrong parts, {shared} where parts meet",
            report.hits,
            report.grazing.len(),
            report.uncertified.len(),
            wrong.len()
        );
        assert!(report.hits > 50, "{place}: nothing to be seen");
        assert!(report.is_right() && report.is_certified(), "{place}: {report:?}");
        assert_eq!(wrong, [], "{place}");
        assert!(shared <= 8, "{place}: {shared}");
    }
}

#[test]
fn the_panels_of_the_paper_first_half() {
    panels().iter().step_by(2).for_each(check);
}

#[test]
fn the_panels_of_the_paper_second_half() {
    panels().iter().skip(1).step_by(2).for_each(check);
}

/// The check must reject wrong parts: those of a solid in which two parts have changed places.
#[test]
fn the_check_rejects_wrong_parts() {
    let panel = &panels()[0];
    let (_, camera) = near_views(panel.half).swap_remove(0);
    let right = scene(vec![panel.solid()], camera, Method::Affine);
    let truth = true_view(panel, &right);
    let exchanged = panel.solid();
    let parts = vec![exchanged.parts()[1].clone(), exchanged.parts()[0].clone()];
    let exchanged = exchanged.with_parts(parts, panel.tree.clone()).expect("the parts are there");
    let film = draw(&scene(vec![exchanged], camera, Method::Affine));
    assert!(compare(&film, &truth.truths, 2.0 * panel.half).is_right());
    assert!(wrong_parts(&film, &truth.owners, true).0.len() > 1000);
}

/// Two boxes of very different scales that share a face, as seen on it: the one that stands first owns it.
#[test]
fn coincident_faces_belong_to_the_part_that_stands_first() {
    let small = "max(abs(x)-1, abs(y)-1, abs(z)-1)";
    let scaled = "1000*max(abs(x)-.5, abs(y)-.5, abs(z)^3-1)";
    let lower = "1e-3*max(abs(x)-.5, abs(y)-.5, abs(z+2)-3)";
    let union = |parts: [&str; 2]| Panel {
        name: "boxes",
        parts: parts.map(str::to_owned).to_vec(),
        tree: Tree::Union(vec![part(1), part(0)]),
        half: 1.5,
        step: 0.01,
    };
    let (_, camera) = near_views(1.5).swap_remove(0);
    for second in [scaled, lower] {
        for (first, panel) in [(small, union([small, second])), (second, union([second, small]))] {
            let scene = scene(vec![panel.solid()], camera, Method::Affine);
            let truth = true_view(&panel, &scene);
            let film = draw(&scene);
            let shared: Vec<u32> =
                (0..SIZE * SIZE).filter(|&i| truth.owners[i as usize].len() == 2).collect();
            assert!(shared.len() > 100, "{}", shared.len());
            for i in shared {
                let pixel = film.pixel(i % SIZE, i / SIZE).expect("the pixel is in the film");
                assert_eq!(pixel.part, 0.0, "{first} stands first at {}, {}", i % SIZE, i / SIZE);
            }
        }
    }
}

/// What a face cut by another leaves: of a box and what is taken from it, the box owns the face that both have.
#[test]
fn a_face_that_is_taken_away_exactly_shows_nothing_of_what_takes_it() {
    let panel = Panel {
        name: "flush",
        parts: vec![
            "max(abs(x)-1, abs(y)-1, abs(z)-1)".into(),
            "7*max(abs(x)-.5, abs(y)-.5, abs(z)-1)".into(),
        ],
        tree: Tree::Intersection(vec![part(0), not(part(1))]),
        half: 1.5,
        // Edges of the hole may be cut as closely as this.
        step: 0.0005,
    };
    for (view, camera) in near_views(panel.half) {
        let scene = scene(vec![panel.solid()], camera, Method::Affine);
        let truth = true_view(&panel, &scene);
        let film = draw(&scene);
        assert_eq!(wrong_parts(&film, &truth.owners, true).0, [], "{view}");
    }
}
