//! How finely spans must be cut when they are accepted without proof, as Hijazi et al. 2008 do (§4.6): for the place of
//! the surface, and for the part that owns it.

use crate::panels::{Panel, SC, SE, bounds, import, not, panels, part};
use crate::truth::{Reference, SIZE, Truth, truths, views};
use crate::{draw, scene, true_view};
use fieldstone_field::{Bindings, Field, Graph};
use fieldstone_scene::{Film, Method, Scene, Solid, Tree};

/// The accepted widths, as powers of 2 of the longest side of the bounds.
const WIDTHS: [i32; 6] = [-11, -12, -13, -14, -15, -16];

/// So far from the surface, relative to the longest side of the bounds, a place is wrong.
const FAR: f64 = 1.0 / 1024.0;

/// Counted over the pixels of some views.
#[derive(Clone, Copy, Default, Debug)]
struct Counts {
    pixels: usize,
    /// Seen where there is nothing, or not seen.
    silhouette: usize,
    /// Further from the surface than [`FAR`].
    displaced: usize,
    /// Pixels whose part is told wrongly by boolean evaluation.
    boolean: usize,
    /// The same by whichever field decides a minimum or maximum in the middle of the accepted span.
    winner: usize,
}

impl Counts {
    fn share(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.pixels as f64
    }
}

fn accepting(power: i32) -> Method {
    Method::Interval { accept_epsilon: Some(2f64.powi(power)) }
}

/// The part whose field a tree of minima and maxima hands on.
fn winner(tree: &Tree, values: &[f64]) -> (f64, usize) {
    match tree {
        Tree::Part(part) => (values[*part], *part),
        Tree::Complement(tree) => {
            let (value, part) = winner(tree, values);
            (-value, part)
        }
        Tree::Union(trees) | Tree::Intersection(trees) => {
            let sign = if matches!(tree, Tree::Union(_)) { 1.0 } else { -1.0 };
            let all = trees.iter().map(|tree| winner(tree, values));
            all.min_by(|a, b| (sign * a.0).total_cmp(&(sign * b.0))).unwrap_or((f64::NAN, 0))
        }
    }
}

fn count_depths(film: &Film, truths: &[Truth], width: f64, counts: &mut Counts) {
    for (i, truth) in (0..SIZE * SIZE).zip(truths) {
        let depth = f64::from(film.pixel(i % SIZE, i / SIZE).expect("the pixel is in the film").depth);
        match truth {
            Truth::Grazing => continue,
            Truth::Hit(t) if depth.is_finite() => counts.displaced += usize::from((depth - t).abs() > width),
            truth => counts.silhouette += usize::from(depth.is_finite() != (*truth != Truth::Miss)),
        }
        counts.pixels += usize::from(*truth != Truth::Miss || depth.is_finite());
    }
}

/// Owners told in both ways, where exactly one part begins or ends.
fn count_owners(film: &Film, scene: &Scene, panel: &Panel, owners: &[Vec<usize>], counts: &mut Counts) {
    let field = panel.field();
    for (i, owners) in (0..SIZE * SIZE).zip(owners) {
        let pixel = film.pixel(i % SIZE, i / SIZE).expect("the pixel is in the film");
        let ([owner], true) = (owners.as_slice(), pixel.depth.is_finite()) else { continue };
        let (origin, direction) = scene.ray(f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
        let middle = origin + f64::from(pixel.depth) * direction;
        let values = &field.at(&middle.to_array(), &Bindings::new())[1..];
        counts.boolean += usize::from(pixel.part != *owner as f32);
        counts.winner += usize::from(winner(&panel.tree, values).1 != *owner);
    }
}

/// Counts for each accepted width.
fn sensitivity(panel: &Panel) -> Vec<Counts> {
    let mut all = vec![Counts::default(); WIDTHS.len()];
    for (_, camera) in views(&bounds(panel.half)).into_iter().step_by(2) {
        let truth = true_view(panel, &scene(vec![panel.solid()], camera, Method::Affine));
        for (power, counts) in WIDTHS.into_iter().zip(&mut all) {
            let scene = scene(vec![panel.solid()], camera, accepting(power));
            let film = draw(&scene);
            count_depths(&film, &truth.truths, FAR * 2.0 * panel.half, counts);
            count_owners(&film, &scene, panel, &truth.owners, counts);
        }
    }
    all
}

fn print(name: &str, all: &[Counts], parts: bool) {
    for (power, c) in WIDTHS.into_iter().zip(all) {
        let owners = if parts {
            format!("{:.3} | {:.3}", c.share(c.boolean), c.share(c.winner))
        } else {
            "– | –".to_owned()
        };
        println!(
            "| {name} | 2^{power} | {:.3} | {:.3} | {owners} |",
            c.share(c.silhouette),
            c.share(c.displaced)
        );
    }
}

/// Percent of the pixels in which something is seen: silhouette wrong, depth off by more than 2⁻¹⁰ of the bounds, part
/// wrong by boolean evaluation, part wrong by the field that wins.
#[test]
fn boolean_evaluation_needs_no_finer_spans() {
    println!("| solid | accepted width | silhouette | displaced | part: boolean | part: winner |");
    let sesc = Panel {
        name: "sesc",
        parts: vec![SE.into(), SC.into()],
        tree: Tree::Intersection(vec![part(0), not(part(1))]),
        half: 2.0,
        step: 0.004,
    };
    let shown = ["cube less sphere", "what three cylinders share", "multiple unions", "nested differences"];
    let panels: Vec<Panel> = panels().into_iter().filter(|p| shown.contains(&p.name)).chain([sesc]).collect();
    let mut wrong = [(0, 0); WIDTHS.len()];
    for panel in &panels {
        let all = sensitivity(panel);
        print(panel.name, &all, true);
        for ((boolean, winner), counts) in wrong.iter_mut().zip(&all) {
            *boolean += counts.boolean;
            *winner += counts.winner;
        }
    }
    println!("pixels with a wrong part, by boolean evaluation and by the field that wins: {wrong:?}");
    let [(boolean, winner), .., (_, winner_in_short_spans), _] = wrong;
    assert!(winner > 10 * boolean, "{wrong:?}");
    // By the field that wins no more is told of spans a sixteenth as long.
    assert!(boolean <= winner_in_short_spans, "{wrong:?}");
}

/// Steiner's Roman surface has asymptotic features that need a finer width than joints of solids do.
#[test]
fn the_steiner_surface_needs_finer_spans_than_joints() {
    let mut graph = Graph::new();
    let value = import(&mut graph, "x^2*y^2+y^2*z^2+z^2*x^2+x*y*z");
    let field = Field::new(graph, value, Vec::new());
    let half = 0.6;
    let mut all = vec![Counts::default(); WIDTHS.len()];
    for (_, camera) in views(&bounds(half)).into_iter().step_by(2) {
        let solid = || Solid::new(field.clone(), Bindings::new(), bounds(half));
        let truth =
            truths(&mut Reference::new(&field), &scene(vec![solid()], camera, Method::Affine), 0.0005);
        for (power, counts) in WIDTHS.into_iter().zip(&mut all) {
            let film = draw(&scene(vec![solid()], camera, accepting(power)));
            count_depths(&film, &truth, FAR * 2.0 * half, counts);
        }
    }
    print("Steiner", &all, false);
    assert!(all[0].displaced > 2 * all[5].displaced.max(1), "{all:?}");
}
