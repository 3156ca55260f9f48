//! Mappings of space, offsets and walls.

use crate::{at, document, resolve};
use fieldstone::glam::{DAffine3, DVec3};
use fieldstone::{NORMAL_INPUTS, Scene, Tree};

/// A lopsided solid.
const BLOB: &str = "length(x - 0.4, y - 0.2, z + 0.3) - 0.7 + 0.2*x*y";

fn blob([x, y, z]: [f64; 3]) -> f64 {
    ((x - 0.4).powi(2) + (y - 0.2).powi(2) + (z + 0.3).powi(2)).sqrt() - 0.7 + 0.2 * x * y
}

/// A solid that is part of another, so that all of its steps are in the program.
fn part(transform: &str) -> Scene {
    let text = format!(
        "[[objects]]\nbounds = [-9, -9, -9, 9, 9, 9]\n
        solid = {{ union = [{{ formula = \"{BLOB}\", transform = [{transform}] }}] }}"
    );
    resolve(&text).resolved.scene
}

fn value(scene: &Scene, point: [f64; 3]) -> f64 {
    let solid = &scene.solids()[0];
    solid.field().at(&point, solid.bindings())[0]
}

fn points() -> impl Iterator<Item = [f64; 3]> {
    (0..60).map(|i| [0.37, 0.61, 0.83].map(|k| (f64::from(i) * k * 7.0).rem_euclid(2.0) - 0.9))
}

/// Checks that the solid has at the image of a point the value that it has there without the steps.
fn check(transform: &str, image: impl Fn([f64; 3]) -> [f64; 3]) {
    let scene = part(transform);
    for p in points() {
        let (found, expected) = (value(&scene, image(p)), blob(p));
        assert!((found - expected).abs() < 1e-9, "{transform} at {p:?}: {found}, not {expected}");
    }
}

#[test]
fn maps_carry_values_along() {
    check("{ twist = { axis = [0, 0, 2], degrees = 40 } }", |[x, y, z]| {
        let (sin, cos) = (40.0 * z).to_radians().sin_cos();
        [x * cos - y * sin, x * sin + y * cos, z]
    });
    check("{ twist = { axis = [-1, 0, 0], degrees = 40 } }", |[x, y, z]| {
        let (sin, cos) = (40.0 * x).to_radians().sin_cos();
        [x, y * cos - z * sin, y * sin + z * cos]
    });
    check("{ taper = { axis = [0, 0, 1], from = -0.5, to = 0.5, scale = [1, 2] } }", |[x, y, z]| {
        let factor = (z + 1.5).clamp(1.0, 2.0);
        [x * factor, y * factor, z]
    });
    check("{ taper = { axis = [0, -1, 0], from = 0, to = 1, scale = [1, 3] } }", |[x, y, z]| {
        let factor = 1.0 + 2.0 * (-y).clamp(0.0, 1.0);
        [x * factor, y, z * factor]
    });
    check("{ bend = { degrees = 30 } }", |[x, y, z]| {
        let (radius, angle) = (1.0 / 30f64.to_radians(), (30.0 * x).to_radians());
        [(radius - z) * angle.sin(), y, radius - (radius - z) * angle.cos()]
    });
    check("{ bend = { along = [0, 1, 0], towards = [0, 2, -1], degrees = 20 } }", |[x, y, z]| {
        let (radius, angle) = (1.0 / 20f64.to_radians(), (20.0 * y).to_radians());
        [x, (radius + z) * angle.sin(), (radius + z) * angle.cos() - radius]
    });
    check("{ bend = { degrees = 0 } }", |p| p);
    check("{ invert = { radius = 2 } }", |p| {
        let factor = 4.0 / p.iter().map(|x| x * x).sum::<f64>();
        p.map(|x| x * factor)
    });
    check("{ reflect = { normal = [2, 0, 0], offset = 0.5 } }", |[x, y, z]| [1.0 - x, y, z]);
}

#[test]
fn steps_are_taken_in_their_order() {
    let twisted_then_moved = "{ translate = [0, 0, 1] }, { twist = { axis = [0, 0, 1], degrees = 90 } },
        { translate = [3, 0, 0] }, { scale = 2 }";
    check(twisted_then_moved, |[x, y, z]| {
        let (sin, cos) = (90.0 * (z + 1.0)).to_radians().sin_cos();
        [2.0 * (x * cos - y * sin + 3.0), 2.0 * (x * sin + y * cos), 2.0 * (z + 1.0)]
    });
}

#[test]
fn mirrors_and_repetitions_show_the_original_again() {
    let mirrored = part("{ mirror = { normal = [0, 3, 0], offset = 0.1 } }");
    for p in points() {
        let kept = [p[0], 0.1 + (p[1] - 0.1).abs(), p[2]];
        assert!((value(&mirrored, p) - blob(kept)).abs() < 1e-12);
    }
    let row = part("{ repeat = { axis = [1, 0, 0], spacing = 2, count = 3 } }");
    let endless = part("{ repeat = { axis = [-1, 0, 0], spacing = 2 } }");
    for p in points() {
        for k in -2..5 {
            let q = [p[0] + 2.0 * f64::from(k), p[1], p[2]];
            let beyond = f64::from(k - k.clamp(0, 2));
            let expected = blob([p[0] + 2.0 * beyond, p[1], p[2]]);
            // Half the spacing away from the original, the next one begins.
            if p[0].abs() < 0.99 {
                assert!((value(&row, q) - expected).abs() < 1e-12, "{q:?}");
                assert!((value(&endless, q) - blob(p)).abs() < 1e-12, "{q:?}");
            }
        }
    }
    let around = part("{ repeat_around = { axis = [0, 0, 1], count = 6 } }");
    let p = [1.1, 0.3, 0.2];
    for k in 0..6 {
        let (sin, cos) = (f64::from(k) * 60f64).to_radians().sin_cos();
        let q = [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos, p[2]];
        assert!((value(&around, q) - blob(p)).abs() < 1e-12);
    }
}

#[test]
fn any_axis_will_do() {
    // A turn of the axis about itself and back changes nothing.
    let [about, back] =
        [25, -25].map(|degrees| format!("{{ twist = {{ axis = [1, 2, -2], degrees = {degrees} }} }}"));
    check(&format!("{about}, {back}"), |p| p);
    let axis = DVec3::new(1.0, 2.0, -2.0) / 3.0;
    check(&about, |p| {
        let p = DVec3::from(p);
        let angle = (25.0 * p.dot(axis)).to_radians();
        (fieldstone::glam::DQuat::from_axis_angle(axis, angle) * p).to_array()
    });
}

#[test]
fn what_comes_behind_the_last_map_moves_the_object() {
    let text = "[solids.a]\nformula = \"max(abs(x), abs(y), abs(z) - 1) - 0.5\"
        transform = [{ translate = [1, 0, 0] }, { twist = { axis = [0, 0, 1], degrees = 90 } }, { scale = 2 }]
        [[objects]]\nsolid = \"a\"\ntransform = { translate = [0, 0, 5] }\ninstances = [{ translate = [7, 0, 0] }]";
    let scene = resolve(text).resolved.scene;
    let moved =
        DAffine3::from_translation(DVec3::new(7.0, 0.0, 5.0)) * DAffine3::from_scale(DVec3::splat(2.0));
    assert_eq!(*scene.instances()[0].world_from_object(), moved);
    // Half a turn to the right at the top of the twisted bar.
    assert!(value(&scene, [0.0, 1.0, 1.0]) < 0.0 && value(&scene, [1.0, 0.0, 1.0]) > 0.0);
    let bounds = scene.solids()[0].bounds();
    assert!((1.49..1.7).contains(&bounds.max().z) && bounds.max().x < 1.8, "{bounds:?}");
    // An object maps too, behind its solid.
    let text = text
        .replace("transform = { translate = [0, 0, 5] }", "transform = { mirror = { normal = [1, 0, 0] } }");
    let scene = resolve(&text).resolved.scene;
    assert_eq!(*scene.instances()[0].world_from_object(), DAffine3::from_translation(DVec3::X * 7.0));
    assert_eq!(value(&scene, [-1.2, 0.3, 0.1]), value(&scene, [1.2, 0.3, 0.1]));
}

#[test]
fn parts_and_conditions_are_mapped_with_their_solid() {
    let text = "[solids.a]\nunion = [{ formula = \"length(x - 1, y, z) - 0.5\", material = \"red\" },
        { formula = \"length(x + 1, y, z) - 0.5\", material = \"blue\" }]
        where = \"x > 0\"\nbounds = [-5, -5, -5, 5, 5, 5]
        transform = { twist = { axis = [0, 0, 1], degrees = 90 } }
        [materials]\nred = { colour = \"red\" }\nblue = { colour = \"blue\" }";
    let scene = resolve(text).resolved.scene;
    let solid = &scene.solids()[0];
    // A quarter turn at a height of 1/3, where the balls still are.
    let image = |[x, y, z]: [f64; 3]| {
        let (sin, cos) = (90.0 * z).to_radians().sin_cos();
        [x * cos - y * sin, x * sin + y * cos, z]
    };
    for (p, first) in [([1.2, 0.1, 0.3], true), ([-1.2, 0.1, 0.3], false)] {
        let values = solid.field().at(&image(p), solid.bindings());
        let inside = |part: usize| values[1 + solid.parts()[part].field.unwrap()] < 0.0;
        assert_eq!([inside(0), inside(1)], [first, !first]);
        assert!((values[1 + solid.conditions()[0].attribute] - p[0]).abs() < 1e-12);
    }
}

#[test]
fn textures_and_their_normals_are_mapped_with_their_solid() {
    let text = |transform: &str| {
        format!(
            "[materials.m]\ncolour = {{ red = \"nx\", green = \"ny\", blue = \"x\" }}
            [[objects]]\nmaterial = \"m\"\nbounds = [-3, -3, -3, 3, 3, 3]
            solid = {{ union = [{{ formula = \"x - 0.5\", transform = {transform} }}] }}"
        )
    };
    let scene = resolve(&text("{ twist = { axis = [0, 0, 1], degrees = 90 } }")).resolved.scene;
    let solid = &scene.solids()[0];
    // The place (0.5, 0, 1) of the plane stands at (0, 0.5, 1); its normal lies along y and, by the twist, z.
    let point = [0.0, 0.5, 1.0];
    let gradient = [0, 1, 2].map(|axis| {
        let beside = |step: f64| {
            let mut q = point;
            q[axis] += step;
            value(&scene, q)
        };
        (beside(1e-6) - beside(-1e-6)) / 2e-6
    });
    let mut bindings = solid.bindings().clone();
    for (input, value) in NORMAL_INPUTS.into_iter().zip(DVec3::from(gradient).normalize().to_array()) {
        bindings.set(input, value);
    }
    let values = solid.field().at(&point, &bindings);
    let colour = solid.parts()[0].appearance(&values[1..], false).colour;
    assert!((colour - DVec3::new(1.0, 0.0, 0.214_041)).length() < 1e-5, "{colour}");
}

#[test]
fn copies_are_not_mapped() {
    let text = "[solids]\na = \"length(x, y, z) - 1\"\n[[objects]]\nsolid = \"a\"
        instances = [{ twist = { axis = [0, 0, 1], degrees = 9 } }]";
    let error = document(text).unwrap_err();
    assert!(error.contains("not mapped by `twist`") && error.contains("put it into `transform`"), "{error}");
}

#[test]
fn numbers_of_maps_have_ranges() {
    for (step, message) in [
        ("twist = { degrees = 3 }", "`axis` is missing"),
        ("twist = { axis = [0, 0, 0], degrees = 3 }", "an axis has a length"),
        ("taper = { axis = [0, 0, 1], from = 1, to = 1, scale = [1, 2] }", "`from` and `to` are two places"),
        ("taper = { axis = [0, 0, 1], from = 0, to = 1, scale = [1, 0] }", "scales are above 0"),
        ("bend = { degrees = 9, towards = [-3, 0, 0] }", "does not bend along itself"),
        ("mirror = { }", "`normal` is missing"),
        ("repeat = { axis = [1, 0, 0], spacing = 0 }", "above 0"),
        ("repeat = { axis = [1, 0, 0], spacing = 1, count = 0 }", "from 1 to"),
        ("repeat_around = { axis = [1, 0, 0] }", "`count` is missing"),
        ("invert = { radius = -1 }", "above 0"),
        ("twsit = { axis = [0, 0, 1], degrees = 3 }", "did you mean `twist`?"),
    ] {
        let error = at(&format!("[solids.a]\nformula = \"x\"\ntransform = {{ {step} }}"), 0.0);
        let error = error.map(|_| ()).unwrap_err();
        assert!(error.contains(message) && error.contains("--> scene.toml:3"), "{step}: {error}");
    }
}

#[test]
fn numbers_of_maps_may_depend_on_the_time() {
    let text = "[solids.a]\nformula = \"x\"\nbounds = [-1, -1, -1, 1, 1, 1]
        transform = { twist = { axis = [0, 0, 1], degrees = { 0 = 0, 2 = 180 } } }";
    let value_at = |time: f64| value(&at(text, time).unwrap().resolved.scene, [0.0, 0.5, 1.0]);
    assert!(value_at(0.0).abs() < 1e-12 && (value_at(1.0) - 0.5).abs() < 1e-12);
}

const TWO: &str = "[solids.a]\nunion = [{ formula = \"length(x - 0.6, y, z) - 1\", material = \"red\" },
    { difference = [{ formula = \"length(x + 0.6, y, z) - 1\" }, { formula = \"length(x + 1.4, y, z) - 0.8\" }] }]
    material = \"blue\"\n[materials]\nred = { colour = \"red\" }\nblue = { colour = \"blue\" }\n";

fn two(key: &str) -> Scene {
    resolve(&TWO.replace("material = \"blue\"\n[", &format!("material = \"blue\"\n{key}\n["))).resolved.scene
}

/// Whether the parts make up the solid at some points.
fn check_tree(scene: &Scene) {
    let solid = &scene.solids()[0];
    for p in points() {
        let p = p.map(|x| 1.7 * x);
        let values = solid.field().at(&p, solid.bindings());
        let inside = |part: usize| values[1 + solid.parts()[part].field.unwrap_or(0)] < 0.0;
        assert_eq!(solid.tree().contains(&inside), values[0] < 0.0, "{p:?}");
    }
}

#[test]
fn offsets_move_the_surface_and_the_parts() {
    let plain = two("");
    for distance in [0.2, -0.3] {
        let grown = two(&format!("offset = {distance}"));
        for p in points() {
            assert!((value(&grown, p) - value(&plain, p) + distance).abs() < 1e-12);
        }
        assert_eq!(grown.solids()[0].parts().len(), 2);
        check_tree(&grown);
    }
}

#[test]
fn shells_have_all_parts_on_both_sides() {
    let (plain, wall) = (two(""), two("shell = 0.1"));
    for p in points() {
        assert!((value(&wall, p) - value(&plain, p).abs() + 0.05).abs() < 1e-12);
    }
    let names: Vec<&str> = wall.solids()[0].parts().iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["part", "part", "part (inner side)", "part (inner side)"]);
    check_tree(&wall);
    let alone =
        resolve("[solids.a]\nformula = \"length(x, y, z) - 1\"\nshell = 0.2\noffset = 0.5").resolved.scene;
    assert_eq!((alone.solids()[0].tree(), alone.solids()[0].parts()[0].field), (&Tree::Part(0), None));
    for (x, expected) in [(1.4, 0.0), (1.5, -0.1), (1.6, 0.0), (0.0, 1.4)] {
        assert!((value(&alone, [x, 0.0, 0.0]) - expected).abs() < 1e-12, "{x}");
    }
}

#[test]
fn sections_show_walls_and_are_mapped_with_them() {
    let text = "[solids.a]\nformula = \"length(x, y, z) - 1\"\nshell = 0.2\nsection = { normal = [1, 0, 0] }
        transform = { reflect = { normal = [1, 0, 0] } }";
    let inner = resolve(text).resolved.scene;
    assert!(value(&inner, [-0.1, 1.0, 0.0]) < 0.0);
    assert!(value(&inner, [0.1, 1.0, 0.0]) > 0.0 && value(&inner, [0.0, 0.0, 0.0]) > 0.0);
    let bent = resolve(
        &text.replace("reflect = { normal = [1, 0, 0] }", "twist = { axis = [0, 0, 1], degrees = 180 }"),
    );
    // At a height of 1/2 the plane is turned by a quarter.
    let at_half = |y: f64| value(&bent.resolved.scene, [0.0, y, 0.5]);
    assert!(at_half(-0.86) < 0.0 && at_half(0.86) > 0.0, "{} {}", at_half(-0.86), at_half(0.86));
    let straight = text.replace("section = { normal = [1, 0, 0] }\n", "");
    let straight = straight
        .replace("[solids.a]", "[solids.b]\nunion = [\"a\"]\nsection = { normal = [0, 1, 0] }\n[solids.a]");
    let scene = resolve(&straight).resolved.scene;
    assert!(value(&scene, [0.0, -1.0, 0.0]) < 0.0 && value(&scene, [0.0, 1.0, 0.0]) > 0.0);
}
