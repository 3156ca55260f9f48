//! Surfaces that end where conditions do, against dense sampling.

use crate::panels::{ICOS, Panel, SC, SE, bounds, import, not, part};
use crate::truth::{Reference, SIZE, views};
use crate::{draw, scene};
use fieldstone_field::{Bindings, Field, Graph, NodeId};
use fieldstone_scene::{Condition, Film, Method, Scene, Solid, Tree};
use glam::DVec3;

/// The place of a root whose conditions hold; `None`: none; or in doubt, because it grazes something.
#[derive(Clone, Copy, PartialEq, Debug)]
enum First {
    Root(f64),
    None,
    Doubtful,
}

/// A surface with the fields that must be positive (`true`) or negative on it.
struct Trimmed {
    surface: &'static str,
    conditions: Vec<(&'static str, bool)>,
    half: f64,
    step: f64,
}

impl Trimmed {
    fn solid(&self) -> Solid {
        let mut graph = Graph::new();
        let value = import(&mut graph, self.surface);
        let attributes: Vec<NodeId> = self.conditions.iter().map(|(c, _)| import(&mut graph, c)).collect();
        let conditions = self.conditions.iter().enumerate();
        let conditions =
            conditions.map(|(attribute, &(_, positive))| Condition { attribute, positive }).collect();
        let solid = Solid::new(Field::new(graph, value, attributes), Bindings::new(), bounds(self.half));
        solid.with_conditions(conditions).expect("the attributes are there")
    }

    fn references(&self) -> (Reference, Vec<(Reference, bool)>) {
        let reference = |formula: &str| {
            let mut graph = Graph::new();
            let value = import(&mut graph, formula);
            Reference::new(&Field::new(graph, value, Vec::new()))
        };
        let conditions = self.conditions.iter().map(|(c, positive)| (reference(c), *positive));
        (reference(self.surface), conditions.collect())
    }

    /// The first root along a ray at which the conditions hold.
    fn first(&self, fields: &mut (Reference, Vec<(Reference, bool)>), ray: (DVec3, DVec3)) -> First {
        let Some(span) = bounds(self.half).ray_span(ray.0, ray.1) else { return First::None };
        let count = ((span.exit - span.enter) / self.step).ceil() as usize;
        let places: Vec<f64> =
            (0..=count).map(|i| span.enter + (span.exit - span.enter) * i as f64 / count as f64).collect();
        let values = fields.0.values(ray.0, ray.1, &places);
        for i in 1..=count {
            let (a, b) = (places[i - 1], places[i]);
            if (values[i - 1] < 0.0) != (values[i] < 0.0) {
                let (outside, inside) = if values[i] < 0.0 { (a, b) } else { (b, a) };
                let t = fields.0.bisect(ray.0, ray.1, outside, inside);
                let margins: Vec<f64> = fields
                    .1
                    .iter_mut()
                    .map(|(condition, positive)| {
                        let value = condition.at(ray.0, ray.1, t);
                        if *positive { value } else { -value }
                    })
                    .collect();
                let margin = margins.into_iter().fold(f64::INFINITY, f64::min);
                if margin.abs() < 1e-6 {
                    return First::Doubtful;
                }
                if margin > 0.0 {
                    return First::Root(t);
                }
            } else if i < count && values[i].abs() < values[i - 1].abs().min(values[i + 1].abs()) {
                // A pair of roots between samples, if values fall that far.
                let dip = values[i].abs() < 0.02 * (values[i - 1].abs().max(values[i + 1].abs()));
                if dip && (values[i] < 0.0) == (values[i + 1] < 0.0) {
                    return First::Doubtful;
                }
            }
        }
        First::None
    }
}

/// How many pixels are wrong, and how many are in doubt.
fn faults(film: &Film, scene: &Scene, trimmed: &Trimmed) -> (usize, usize) {
    let mut fields = trimmed.references();
    let (mut wrong, mut doubtful) = (0, 0);
    for i in 0..SIZE * SIZE {
        let pixel = film.pixel(i % SIZE, i / SIZE).expect("the pixel is in the film");
        let ray = scene.ray(f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
        match trimmed.first(&mut fields, ray) {
            First::Doubtful => doubtful += 1,
            First::None => wrong += usize::from(pixel.depth.is_finite()),
            First::Root(t) => {
                let off = (f64::from(pixel.depth) - t).abs() > 1e-4 * 2.0 * trimmed.half;
                wrong += usize::from(!pixel.depth.is_finite() || off);
            }
        }
    }
    (wrong, doubtful)
}

fn icos() -> Trimmed {
    let conditions = vec![("x^2+y^2+z^2-20.25", true), ("x^2+y^2+z^2-36", false)];
    Trimmed { surface: ICOS, conditions, half: 6.2, step: 0.01 }
}

fn certified(film: &Film) -> usize {
    let layer = film.layer("certificate").expect("films have certificates");
    layer.iter().filter(|c| **c == 1.0).count()
}

#[test]
fn icos_is_what_lies_between_two_spheres() {
    let icos = icos();
    for (view, camera) in views(&bounds(icos.half)).into_iter().step_by(2) {
        let scene = scene(vec![icos.solid()], camera, Method::Affine);
        let film = draw(&scene);
        let (wrong, doubtful) = faults(&film, &scene, &icos);
        let certified = certified(&film);
        println!("{view}: {wrong} wrong, {doubtful} doubtful, {certified} certified");
        assert_eq!(wrong, 0, "{view}");
        assert!(doubtful < 40 && certified as f64 >= 0.999 * f64::from(SIZE * SIZE), "{view}");
    }
}

/// The comparer must reject a surface with other conditions.
#[test]
fn the_comparison_rejects_other_conditions() {
    let icos = icos();
    let (_, camera) = views(&bounds(icos.half)).swap_remove(0);
    let wider = Trimmed { conditions: vec![("x^2+y^2+z^2-20.25", true), ("x^2+y^2+z^2-30", false)], ..icos };
    let scene = scene(vec![wider.solid()], camera, Method::Affine);
    assert!(faults(&draw(&scene), &scene, &self::icos()).0 > 100);
}

/// (sc > 0 and on se) or (se < 0 and on sc), as two surfaces with conditions, is se without what lies in sc.
#[test]
fn sesc_is_the_same_with_conditions_and_as_a_difference() {
    let outer = Trimmed { surface: SE, conditions: vec![(SC, true)], half: 2.0, step: 0.004 };
    let inner = Trimmed { surface: SC, conditions: vec![(SE, false)], half: 2.0, step: 0.004 };
    let difference = Panel {
        name: "sesc",
        parts: vec![SE.into(), SC.into()],
        tree: Tree::Intersection(vec![part(0), not(part(1))]),
        half: 2.0,
        step: 0.004,
    };
    for (view, camera) in views(&bounds(2.0)).into_iter().step_by(2) {
        let trimmed = draw(&scene(vec![outer.solid(), inner.solid()], camera, Method::Affine));
        let solid = draw(&scene(vec![difference.solid()], camera, Method::Affine));
        let (mut differ, mut seen) = (Vec::new(), [0, 0]);
        for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)) {
            let [a, b] = [&trimmed, &solid].map(|film| film.pixel(x, y).expect("the pixel is in the film"));
            let depth = a.depth == b.depth || (a.depth - b.depth).abs() < 1e-5;
            if !depth || a.part != b.part {
                differ.push((x, y, a, b));
            }
            if a.part >= 0.0 {
                seen[a.part as usize] += 1;
            }
        }
        println!(
            "{view}: {seen:?} of the parts, {} and {} certified",
            certified(&trimmed),
            certified(&solid)
        );
        assert!(differ.is_empty(), "{view}: {} differ, {:?}", differ.len(), differ.first());
        assert!(seen.iter().all(|n| *n > 500), "{view}: {seen:?}");
    }
}
