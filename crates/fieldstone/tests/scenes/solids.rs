//! What solids are composed to.

use crate::{at, document, resolve};
use fieldstone::glam::DVec3;
use fieldstone::{RenderOptions, Rendered, Scene, SceneRequest, Shading, Tree, render};

fn value(scene: &Scene, solid: usize, point: [f64; 3]) -> f64 {
    let solid = &scene.solids()[solid];
    solid.field().at(&point, solid.bindings())[0]
}

/// The colour of the part `part` at a point with a normal along x.
fn colour(scene: &Scene, part: usize, point: [f64; 3]) -> DVec3 {
    let solid = &scene.solids()[0];
    let mut bindings = solid.bindings().clone();
    for (input, value) in fieldstone::NORMAL_INPUTS.into_iter().zip([1.0, 0.0, 0.0]) {
        bindings.set(input, value);
    }
    let values = solid.field().at(&point, &bindings);
    solid.parts()[part].appearance(&values[1..], false).colour
}

fn points() -> impl Iterator<Item = [f64; 3]> {
    (0..200).map(|i| [0.37, 0.61, 0.83].map(|k| (f64::from(i) * k * 7.0).rem_euclid(3.0) - 1.5))
}

const SHAPES: &str = "
    [solids]
    a = \"x^2 + y^2 + z^2 - 1\"
    b = \"max(abs(x), abs(y), abs(z)) - 0.8\"
    c = \"length(x, y) - 0.3\"
";

fn composed(solid: &str) -> Scene {
    resolve(&format!("{SHAPES}[solids.d]\n{solid}\n[[objects]]\nsolid = \"d\"")).resolved.scene
}

#[test]
fn set_operations_are_minima_and_maxima_or_r_functions() {
    let by_hand = |formula: &str| resolve(&format!("[solids]\nd = \"{formula}\"")).resolved.scene;
    let a = "(x^2 + y^2 + z^2 - 1)";
    let b = "(max(abs(x), abs(y), abs(z)) - 0.8)";
    let c = "(length(x, y) - 0.3)";
    for (solid, formula) in [
        ("union = [\"a\", \"b\", \"c\"]", format!("min({a}, {b}, {c})")),
        ("intersection = [\"a\", \"b\"]", format!("max({a}, {b})")),
        ("difference = [\"a\", \"b\", \"c\"]", format!("max({a}, -{b}, -{c})")),
        ("complement = \"a\"", format!("-{a}")),
        ("union = [\"a\", \"b\"]\nset_operations = \"r\"", format!("runion({a}, {b})")),
        ("difference = [\"a\", \"b\"]\nset_operations = \"r\"", format!("rinter({a}, -{b})")),
        ("union = [{ difference = [\"a\", \"c\"] }, \"b\"]", format!("min(max({a}, -{c}), {b})")),
    ] {
        let (scene, other) = (composed(solid), by_hand(&formula));
        for point in points() {
            assert_eq!(value(&scene, 0, point), value(&other, 0, point), "{solid} at {point:?}");
        }
    }
}

#[test]
fn parts_have_their_materials_and_the_tree_their_operations() {
    let scene = composed(
        "difference = [{ union = [\"a\", \"b\"], material = \"red\" }, \"c\"]\nmaterial = \"blue\"
        [materials]\nred = { colour = \"red\" }\nblue = { colour = \"blue\" }",
    );
    let solid = &scene.solids()[0];
    let expected = Tree::Intersection(vec![Tree::Part(0), Tree::Complement(Box::new(Tree::Part(1)))]);
    assert_eq!(solid.tree(), &expected);
    assert_eq!(solid.parts().iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["part", "c"]);
    assert_eq!([0, 1].map(|part| colour(&scene, part, [0.0; 3])), [DVec3::X, DVec3::Z]);
    for point in points() {
        let values = solid.field().at(&point, solid.bindings());
        let inside = |part: usize| values[1 + solid.parts()[part].field.unwrap()] < 0.0;
        assert_eq!(solid.tree().contains(&inside), values[0] < 0.0, "{point:?}");
    }
}

#[test]
fn what_nothing_tells_apart_is_one_part() {
    let scene = composed("difference = [\"a\", { union = [\"b\", \"c\"] }]");
    assert_eq!((scene.solids()[0].parts().len(), scene.solids()[0].tree()), (1, &Tree::Part(0)));
    assert_eq!(scene.solids()[0].parts()[0].field, None);
}

#[test]
fn sections_cut_and_fill() {
    let scene = composed(
        "formula = \"x^2 + y^2 + z^2 - 4\"\nsection = { normal = [2, 0, 0], offset = 0.5, material = \"cut\" }
        [materials]\ncut = { colour = \"lime\" }",
    );
    assert_eq!(value(&scene, 0, [1.0, 0.0, 0.0]), 0.5);
    assert_eq!(value(&scene, 0, [0.0, 0.0, 0.0]), -0.5);
    assert_eq!(scene.solids()[0].parts().len(), 2);
    assert_eq!(colour(&scene, 1, [0.5, 0.0, 0.0]), DVec3::Y);
    assert!(scene.solids()[0].bounds().max().x < 0.6);
}

#[test]
fn motions_are_applied_in_their_order() {
    let text = "[[objects]]\nsolid = { union = [{ formula = \"length(x, y, z) - 0.5\", transform = [
        { translate = [2, 0, 0] }, { rotate = { axis = [0, 0, 1], degrees = 90 } }, { scale = 2 },
        { matrix = [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0]] } ] }] }";
    let scene = resolve(text).resolved.scene;
    assert!((value(&scene, 0, [1.0, 4.0, 0.0]) + 0.5).abs() < 1e-12);
    assert!((value(&scene, 0, [1.0, 5.0, 0.0])).abs() < 1e-12);
    let moved = text.replace("union = [{ ", "").replace("} ] }] }", "} ] }");
    let moved = resolve(&moved).resolved.scene;
    let world_from_object = moved.instances()[0].world_from_object();
    assert!((world_from_object.transform_point3(DVec3::ZERO) - DVec3::new(1.0, 4.0, 0.0)).length() < 1e-12);
    assert_eq!(value(&moved, 0, [0.5, 0.0, 0.0]), 0.0);
}

#[test]
fn textures_move_with_their_solid() {
    let text = "[materials.m]\ncolour = { red = \"x\", green = \"nx\", blue = \"t\" }
        [[objects]]\nmaterial = \"m\"
        solid = { union = [{ formula = \"length(x, y, z) - 1\", transform = [
        { rotate = { axis = [0, 0, 1], degrees = 90 } }, { translate = [0, 0, 5] } ] }] }";
    let scene = at(text, 1.0).unwrap().resolved.scene;
    // The place (0, 1, 5) was (1, 0, 0); the normal (1, 0, 0) was (0, -1, 0).
    assert!((colour(&scene, 0, [0.0, 1.0, 5.0]) - DVec3::new(1.0, 0.0, 1.0)).length() < 1e-9);
}

#[test]
fn attributes_of_models_are_colours() {
    for material in ["", "material = \"m\"\n[materials.m]\ncolour = { attributes = 1 }\n"] {
        let scene = resolve(&format!(
            "[solids.a]\nfile = \"painted.hf\"\nparameters = {{ \"a[1]\" = 1 }}\n{material}"
        ));
        let colour = colour(&scene.resolved.scene, 0, [1.0, 0.0, 0.0]);
        assert!((colour.x - 1.0).abs() < 1e-12 && (colour.y - 0.214_041).abs() < 1e-6);
    }
}

#[test]
fn materials_mix_across_joints() {
    let scene = |share: f64| {
        let text = format!(
            "{SHAPES}[solids.d]\nmetamorphosis = {{ from = {{ formula = \"x\", material = \"red\" }},
            to = {{ formula = \"y\", material = \"blue\" }}, share = {share} }}
            bounds = [-1, -1, -1, 1, 1, 1]
            [materials]\nred = {{ colour = \"red\" }}\nblue = {{ colour = \"blue\" }}
            [[objects]]\nsolid = \"d\""
        );
        resolve(&text).resolved.scene
    };
    assert_eq!(value(&scene(0.25), 0, [1.0, 2.0, 0.0]), 1.25);
    assert_eq!(colour(&scene(0.25), 0, [0.0; 3]), DVec3::new(0.75, 0.0, 0.25));
    assert_eq!(colour(&scene(0.0), 0, [0.0; 3]), DVec3::X);
    assert_eq!(colour(&scene(1.0), 0, [0.0; 3]), DVec3::Z);
}

#[test]
fn conditions_are_differences() {
    let scene = composed("formula = \"x^2 + y^2 + z^2 - 4\"\nwhere = [\"x + 1 > 2 - y\", \"z <= 0.5\"]");
    let solid = &scene.solids()[0];
    let values = solid.field().at(&[0.25, 0.5, 0.125], solid.bindings());
    let found: Vec<(f64, bool)> =
        solid.conditions().iter().map(|c| (values[1 + c.attribute], c.positive)).collect();
    assert_eq!(found, [(-0.25, true), (-0.375, false)]);
    assert!(solid.bounds().max().z < 0.6);
}

#[test]
fn copies_stand_where_they_are_put() {
    let copies = |more: &str| {
        let scene = resolve(&format!("{SHAPES}[[objects]]\nsolid = \"a\"\n{more}")).resolved.scene;
        let place = |i: &fieldstone::Instance| i.world_from_object().translation;
        scene.instances().iter().map(place).collect::<Vec<DVec3>>()
    };
    let listed =
        copies("instances = [[{ translate = [1, 0, 0] }], [{ translate = [0, 2, 0] }, { scale = 2 }]]");
    assert_eq!(listed, [DVec3::X, DVec3::Y * 4.0]);
    let grid = copies("grid = { count = [2, 1, 2], spacing = [3, 3, 3], origin = [1, 0, 0] }");
    assert_eq!(grid, [[1, 0, 0], [4, 0, 0], [1, 0, 3], [4, 0, 3]].map(|p| DVec3::from(p.map(f64::from))));
    let scattered =
        |seed: u32| copies(&format!("scatter = {{ count = 100, seed = {seed}, box = [0, 0, 0, 1, 2, 0] }}"));
    assert_eq!(scattered(1), scattered(1));
    assert_ne!(scattered(1), scattered(2));
    let middle = scattered(3).into_iter().sum::<DVec3>() / 100.0;
    assert!((middle - DVec3::new(0.5, 1.0, 0.0)).length() < 0.2, "{middle}");
}

#[test]
fn solids_that_others_use_are_no_objects() {
    let found = resolve(&format!("{SHAPES}[solids.d]\nunion = [\"a\", {{ complement = \"c\" }}]"));
    assert_eq!(found.objects, ["b", "d"]);
}

#[test]
fn models_of_materials_are_what_they_say() {
    let look = |model: &str| {
        let text = format!(
            "{SHAPES}[materials.m]\nmodel = \"{model}\"\n[[objects]]\nsolid = \"a\"\nmaterial = \"m\""
        );
        *resolve(&text).resolved.scene.solids()[0].parts()[0].materials[0].material.base()
    };
    assert_eq!(look("blinn-phong").shading, Shading::BlinnPhong { normalised: false });
    assert_eq!(look("ggx").shading, Shading::Ggx { compensated: true });
    assert_eq!(look("metal").metallic, 1.0);
    assert_eq!((look("glass").transmission, look("glass").roughness), (1.0, 0.0));
    assert_eq!(look("mirror").reflection, 1.0);
    assert_eq!(look("gradient").shading, Shading::Gradient);
}

fn picture(text: &str, time: f64) -> Rendered {
    let request = SceneRequest { time: Some(time), size: Some((48, 36)), ..SceneRequest::default() };
    let scene = document(text).unwrap().resolve(&request).unwrap().resolved.scene;
    render(&scene, &RenderOptions::default()).unwrap()
}

#[test]
fn a_scene_and_the_same_formula_have_the_same_picture() {
    // A cube and a ball that grows.
    let more = "bounds = [-2, -2, -2, 2, 2, 2]\n[camera]\neye = [5, -6, 4]\n";
    let scene = format!(
        "[parameters]\nr = {{ 0 = 1.0, 2 = 1.6 }}\n[solids]\ncube = \"max(abs(x), abs(y), abs(z)) - 1\"
        ball = \"x^2 + y^2 + z^2 - r^2\"\n[solids.both]\nunion = [\"cube\", \"ball\"]\n{more}"
    );
    let formula = |r: f64| {
        format!(
            "[solids.f]\nformula = \"min(max(abs(x), abs(y), abs(z)) - 1, x^2 + y^2 + z^2 - {r}^2)\"\n{more}"
        )
    };
    let depth = |rendered: &Rendered| rendered.film.layer("Z").unwrap().to_vec();
    let found = depth(&picture(&scene, 1.0));
    assert_eq!(found, depth(&picture(&formula(1.3), 0.0)));
    assert_ne!(found, depth(&picture(&formula(1.2), 0.0)));
}

#[test]
fn solids_and_fields_may_have_one_name() {
    let text = "[fields]\na = \"x^2 + y^2 + z^2 - 1\"\n[solids]\na = \"a\"\n[solids.b]\nunion = [\"a\"]";
    assert_eq!(resolve(text).objects, ["b"]);
}

#[test]
fn sweeps_and_projections_are_unions() {
    let sweep = "[solids.a]\nsweep = { solid = { formula = \"length(x, y, z) - 0.5\" }, polyline = [[0, 0, 0], [2, 0, 0]] }";
    let scene = resolve(sweep).resolved.scene;
    for (point, expected) in [([1.0, 0.5, 0.0], 0.0), ([3.0, 0.0, 0.0], 0.5), ([1.3, 0.0, 2.0], 1.5)] {
        assert!((value(&scene, 0, point) - expected).abs() < 1e-6, "{point:?}");
    }
    let shadow = "[solids.a]\nprojection = { solid = { formula = \"x^2 + y^2 + z^2 + (w - x)^2 - 1\" } }";
    let scene = resolve(shadow).resolved.scene;
    assert!((value(&scene, 0, [0.6, 0.0, 0.0]) + 0.64).abs() < 1e-6);
}

#[test]
fn a_section_without_a_material_shows_what_it_goes_through() {
    let scene = composed(
        "union = [{ formula = \"x^2 + y^2 + z^2 - 0.25\", material = \"core\" },
                  { formula = \"x^2 + y^2 + z^2 - 1\", material = \"shell\" }]
        section = [{ normal = [1, 0, 0], offset = 0.5, material = \"cut\" }, { normal = [0, 1, 0] }]
        [materials]\ncut = { colour = \"lime\" }\ncore = { colour = \"red\" }\nshell = { colour = \"blue\" }",
    );
    let solid = &scene.solids()[0];
    assert_eq!(solid.parts().len(), 3);
    let field = |part: usize, point: [f64; 3]| {
        solid.field().at(&point, solid.bindings())[1 + solid.parts()[part].field.unwrap()]
    };
    for (before, behind, owner) in [
        ([0.0, 0.01, 0.0], [0.0, -0.01, 0.0], 0),
        ([0.0, 0.01, 0.8], [0.0, -0.01, 0.8], 1),
        ([0.51, -0.2, 0.0], [0.49, -0.2, 0.0], 2),
    ] {
        let inside = |point| solid.tree().contains(&|part| field(part, point) < 0.0);
        assert!(!inside(before) && inside(behind), "{owner}");
        let changes = |part: usize| (field(part, before) < 0.0) != (field(part, behind) < 0.0);
        let alone = |&part: &usize| {
            changes(part) && solid.tree().contains(&|p| (field(p, before) < 0.0) != (p == part))
        };
        assert_eq!((0..3).find(alone), Some(owner));
    }
}

#[test]
fn what_is_only_taken_away_is_cut_by_a_part_of_its_own() {
    let scene =
        composed("complement = \"a\"\nsection = { normal = [1, 0, 0] }\nbounds = [-3, -3, -3, 3, 3, 3]");
    let solid = &scene.solids()[0];
    assert_eq!(solid.parts().len(), 2);
    for (x, inside) in [(-2.5, true), (2.5, false)] {
        assert_eq!(value(&scene, 0, [x, 0.0, 0.0]) < 0.0, inside, "{x}");
    }
}
