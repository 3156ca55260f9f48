//! What formulas mean, against the same expressions in Rust.

mod errors;
mod names;

use crate::{FileSign, Model, Source, UpAxis, parse_formula};
use fieldstone_field::{Bindings, Input};
use std::f64::consts::{E, PI};

fn read(text: &str) -> Model {
    match parse_formula(&Source::new("formula", text)) {
        Ok(model) => model,
        Err(errors) => panic!("{text}\n{errors}"),
    }
}

/// The value at a point, with the parameters at their defaults and t = 0.25.
fn value(text: &str, point: &[f64]) -> f64 {
    let model = read(text);
    let mut bindings = Bindings::new();
    bindings.set(Input::Time, 0.25);
    for parameter in &model.parameters {
        bindings.set(parameter.input, parameter.default);
    }
    model.field.at(point, &bindings)[0]
}

const POINTS: [[f64; 4]; 4] =
    [[0.3, -1.2, 2.5, 0.7], [1.5, 0.4, -0.6, -2.0], [-2.0, 3.0, 0.25, 1.0], [0.9, 0.8, 0.7, 0.6]];

/// Compares a formula with a function of x, y, z, w at all points; both undefined counts as equal.
fn agrees(text: &str, expected: impl Fn([f64; 4]) -> f64) {
    for point in POINTS {
        let (found, expected) = (value(text, &point), expected(point));
        let close = (found - expected).abs() <= 1e-12 * expected.abs().max(1.0);
        assert!(
            close || found == expected || found.is_nan() && expected.is_nan(),
            "{text}: {found} is not {expected}"
        );
    }
}

#[test]
fn operations_bind_as_mathematics_writes_them() {
    agrees("x + y*z", |[x, y, z, _]| x + y * z);
    agrees("x - y - z", |[x, y, z, _]| (x - y) - z);
    agrees("x / y / z", |[x, y, z, _]| (x / y) / z);
    agrees("x / y * z", |[x, y, z, _]| (x / y) * z);
    agrees("-x^2", |[x, ..]| -(x * x));
    agrees("(-x)^2", |[x, ..]| x * x);
    agrees("2^3^2 - 0*x", |[..]| 512.0);
    agrees("2**3**2 - 0*x", |[..]| 512.0);
    agrees("2^-1 * x", |[x, ..]| 0.5 * x);
    agrees("2^-x*y", |[x, y, ..]| 2f64.powf(-x) * y);
    agrees("2^-x^2", |[x, ..]| 2f64.powf(-(x * x)));
    agrees("x*-y + +z", |[x, y, z, _]| x * -y + z);
    agrees("x - -y", |[x, y, ..]| x + y);
    agrees("--x", |[x, ..]| x);
    agrees("-x*y - z", |[x, y, z, _]| -x * y - z);
    agrees("-x - y", |[x, y, ..]| -x - y);
    agrees("x·y × z ⋅ w − 1", |[x, y, z, w]| x * y * z * w - 1.0);
}

#[test]
fn factors_side_by_side_are_multiplied() {
    agrees("2x", |[x, ..]| 2.0 * x);
    agrees("x y", |[x, y, ..]| x * y);
    agrees("x 2", |[x, ..]| 2.0 * x);
    agrees("2(x+1)", |[x, ..]| 2.0 * (x + 1.0));
    agrees("x(y+1)", |[x, y, ..]| x * (y + 1.0));
    agrees("(x+1)(y-1)", |[x, y, ..]| (x + 1.0) * (y - 1.0));
    agrees("(x+1)2", |[x, ..]| (x + 1.0) * 2.0);
    agrees("2 sin(x) cos(y)", |[x, y, ..]| 2.0 * x.sin() * y.cos());
    agrees("1/2x", |[x, ..]| 0.5 * x);
    agrees("2x^2", |[x, ..]| 2.0 * x * x);
    agrees("2^3x", |[x, ..]| 8.0 * x);
    agrees("-2x y + z", |[x, y, z, _]| -2.0 * x * y + z);
    agrees("2pi x", |[x, ..]| 2.0 * PI * x);
    agrees("2e x", |[x, ..]| 2.0 * E * x);
    agrees("2e3x", |[x, ..]| 2000.0 * x);
}

#[test]
fn superscripts_are_powers_of_what_stands_before_them() {
    agrees("x² + y³", |[x, y, ..]| x * x + y * y * y);
    agrees("-x²", |[x, ..]| -(x * x));
    agrees("2x²y", |[x, y, ..]| 2.0 * x * x * y);
    agrees("(x+y)² z⁻¹", |[x, y, z, _]| (x + y) * (x + y) / z);
    agrees("2^x²", |[x, ..]| 2f64.powf(x * x));
    agrees("sin(x)²", |[x, ..]| x.sin() * x.sin());
    agrees("x¹⁰", |[x, ..]| x.powi(10));
}

#[test]
fn bars_are_absolute_values() {
    agrees("|x|", |[x, ..]| x.abs());
    agrees("2|x - y|z", |[x, y, z, _]| 2.0 * (x - y).abs() * z);
    agrees("||x| - 1|", |[x, ..]| (x.abs() - 1.0).abs());
    agrees("|1 - |x||", |[x, ..]| (1.0 - x.abs()).abs());
    agrees("|x||y|", |[x, y, ..]| x.abs() * y.abs());
    agrees("|x| + |y|", |[x, y, ..]| x.abs() + y.abs());
    agrees("|x|^2 - |-y|²", |[x, y, ..]| x * x - y * y);
    agrees("max(|x|, |y|)", |[x, y, ..]| x.abs().max(y.abs()));
    agrees("|(|x| - 2)(|y| - 2)|", |[x, y, ..]| ((x.abs() - 2.0) * (y.abs() - 2.0)).abs());
    agrees("if(|x| > 1 || |y| > 1, x, y)", |[x, y, ..]| if x.abs() > 1.0 || y.abs() > 1.0 { x } else { y });
}

#[test]
fn functions_of_one_argument() {
    agrees("sin(x) + cos(x) + tan(x)", |[x, ..]| x.sin() + x.cos() + x.tan());
    agrees("asin(x) + arcsin(x)", |[x, ..]| 2.0 * x.asin());
    agrees("acos(x) + arccos(x)", |[x, ..]| 2.0 * x.acos());
    agrees("atan(x) + arctan(x)", |[x, ..]| 2.0 * x.atan());
    agrees("sinh(x) + cosh(y) + tanh(z)", |[x, y, z, _]| x.sinh() + y.cosh() + z.tanh());
    agrees("asinh(x)", |[x, ..]| x.asinh());
    agrees("acosh(x)", |[x, ..]| x.acosh());
    agrees("atanh(x)", |[x, ..]| x.atanh());
    agrees("exp(x) - e^y", |[x, y, ..]| x.exp() - y.exp());
    agrees("log(x) + ln(z)", |[x, _, z, _]| x.ln() + z.ln());
    agrees("log10(x) - log2(y)", |[x, y, ..]| x.log10() - y.log2());
    agrees("sqrt(x) + cbrt(y)", |[x, y, ..]| x.sqrt() + y.cbrt());
    agrees("square(x) - sqr(y)", |[x, y, ..]| x * x - y * y);
    agrees("abs(x) sign(y)", |[x, y, ..]| x.abs() * y.signum());
    agrees("floor(x) + 10ceil(y) + 100round(z) + 1000trunc(w)", |[x, y, z, w]| {
        x.floor() + 10.0 * y.ceil() + 100.0 * z.round() + 1000.0 * w.trunc()
    });
    agrees("frac(x)", |[x, ..]| x - x.floor());
}

#[test]
fn inverse_hyperbolic_functions_stay_exact_far_below_zero() {
    assert!((value("asinh(x)", &[-1e8]) - (-1e8f64).asinh()).abs() < 1e-13);
    assert!(value("acosh(x)", &[-3.0]).is_nan());
}

#[test]
fn functions_of_several_arguments() {
    agrees("atan2(y, x)", |[x, y, ..]| y.atan2(x));
    agrees("mod(x, y)", |[x, y, ..]| x.rem_euclid(y));
    agrees("min(x, y, z) + 10max(x, y, z, w)", |[x, y, z, w]| {
        x.min(y).min(z) + 10.0 * x.max(y).max(z).max(w)
    });
    agrees("pow(x, 3)", |[x, ..]| x.powi(3));
    agrees("hypot(x, y) + length(x, y, z)", |[x, y, z, _]| x.hypot(y) + x.hypot(y).hypot(z));
    agrees("clamp(x, -1, 1)", |[x, ..]| x.clamp(-1.0, 1.0));
    agrees("mix(x, y, .25)", |[x, y, ..]| 0.75 * x + 0.25 * y);
    agrees("step(.5, x)", |[x, ..]| if x < 0.5 { 0.0 } else { 1.0 });
    agrees("smoothstep(-1, 1, x)", |[x, ..]| {
        let k = ((x + 1.0) / 2.0).clamp(0.0, 1.0);
        k * k * (3.0 - 2.0 * k)
    });
}

#[test]
fn set_operations_are_negative_inside() {
    agrees("runion(x, y)", |[x, y, ..]| x + y - x.hypot(y));
    agrees("rinter(x, y)", |[x, y, ..]| x + y + x.hypot(y));
    agrees("rsub(x, y)", |[x, y, ..]| x - y + x.hypot(y));
    agrees("runion(x, y, z)", |[x, y, z, _]| {
        let u = x + y - x.hypot(y);
        u + z - u.hypot(z)
    });
}

#[test]
fn conditions_choose() {
    agrees("if(x < y, x, y)", |[x, y, ..]| x.min(y));
    agrees("if(x > y, 1, 2) z", |[x, y, z, _]| z * if x > y { 1.0 } else { 2.0 });
    agrees("if(x <= .3, z, w)", |[x, _, z, w]| if x <= 0.3 { z } else { w });
    agrees("if(x ≥ .9, z, w)", |[x, _, z, w]| if x >= 0.9 { z } else { w });
    agrees("if(x == .3, z, w)", |[x, _, z, w]| if x == 0.3 { z } else { w });
    agrees("if(x != .3, z, w)", |[x, _, z, w]| if x != 0.3 { z } else { w });
    agrees(
        "if(x > 0 and y > 0 or z > 0, x, y)",
        |[x, y, z, _]| {
            if (x > 0.0 && y > 0.0) || z > 0.0 { x } else { y }
        },
    );
    agrees(
        "if(x > 0 && (y > 0 || z > 0), x, y)",
        |[x, y, z, _]| {
            if x > 0.0 && (y > 0.0 || z > 0.0) { x } else { y }
        },
    );
    agrees("if(not x > 0 and y > 0, x, y)", |[x, y, ..]| if x <= 0.0 && y > 0.0 { x } else { y });
    agrees("if(!(x > 0), x, y)", |[x, y, ..]| if x <= 0.0 { x } else { y });
    agrees("if(x + 1 < 2y, x, y)", |[x, y, ..]| if x + 1.0 < 2.0 * y { x } else { y });
}

#[test]
fn numbers_are_true_unless_zero_and_truths_are_one() {
    assert_eq!(value("x*0 + (3 and 5)", &[1.0]), 1.0);
    assert_eq!(value("x*0 + (3 or 0)", &[1.0]), 1.0);
    assert_eq!(value("x*0 + (3 and x)", &[7.0]), 1.0);
    assert_eq!(value("x*0 + (x and 3)", &[0.0]), 0.0);
    assert_eq!(value("x*0 + (0 or x)", &[-7.0]), 1.0);
}

#[test]
fn the_right_side_of_and_may_be_undefined_where_it_does_not_count() {
    let text = "if(x > 0 and sqrt(x) < 2, 1, 2) + 0y";
    assert_eq!(value(text, &[-1.0, 0.0]), 2.0);
    assert_eq!(value(text, &[1.0, 0.0]), 1.0);
    assert_eq!(value("if(x <= 0 or ln(x) < 0, 1, 2) + 0y", &[-1.0, 0.0]), 1.0);
}

#[test]
fn equations_are_differences() {
    agrees("x^2 = 1 - y", |[x, y, ..]| x * x - (1.0 - y));
    agrees("z = x y", |[x, y, z, _]| z - x * y);
    agrees("x + y = z;", |[x, y, z, _]| x + y - z);
}

#[test]
fn definitions_with_a_constant_value_are_parameters() {
    let text = "r = 5; let s = 2 sqrt(4); u = r + s; v = x + u; x*v + r*y";
    agrees(text, |[x, y, ..]| x * (x + 9.0) + 5.0 * y);
    let model = read(text);
    let known: Vec<_> = model.parameters.iter().map(|p| (p.name.as_str(), p.input, p.default)).collect();
    assert_eq!(known, [("r", Input::Parameter(0), 5.0), ("s", Input::Parameter(1), 4.0)]);
    let mut bindings = Bindings::new();
    bindings.set(Input::Parameter(0), 1.0);
    bindings.set(Input::Parameter(1), 2.0);
    assert_eq!(model.field.at(&[10.0, 100.0, 0.0], &bindings), [230.0]);
}

#[test]
fn definitions_after_the_formula_do_no_harm() {
    let model = read("x; r = 5; s = x;");
    assert_eq!((model.parameters.len(), model.field.at(&[3.0], &Bindings::new())[0]), (1, 3.0));
}

#[test]
fn the_model_says_what_formulas_mean() {
    let model = read("a = 1; x + a t");
    assert_eq!((model.name.as_str(), model.sign, model.up), ("formula", FileSign::NegativeInside, UpAxis::Z));
    assert_eq!((model.coordinates, model.has_attributes, model.warnings.len()), (3, false, 0));
    assert_eq!((model.objects.len(), model.objects[0].coordinates, model.objects[0].parameters), (1, 3, 1));
    assert_eq!(read("x + w").coordinates, 4);
    assert_eq!(value("x + 2t", &[1.0]), 1.5);
}

#[test]
fn comments_blanks_and_lines_do_not_count() {
    agrees("\u{feff}# a sphere\r\nr = 2; // its radius\n\n  x^2 + # first\n  y^2 - r", |[x, y, ..]| {
        x * x + y * y - 2.0
    });
    agrees("π x + .5 + 1. + 1e-3 + 2E+1 + 3e0", |[x, ..]| PI * x + 24.501);
    agrees("größe = 3; x_1 = 2; größe x + x_1", |[x, ..]| 3.0 * x + 2.0);
}

#[test]
fn powers_may_be_large_fractional_or_parameters() {
    assert_eq!(value("x^500", &[-1.0]), 1.0);
    assert_eq!(value("x^500", &[0.5]), 0.5f64.powi(500));
    assert_eq!(value("x^2.5", &[4.0]), 32.0);
    assert!(value("x^2.5", &[-4.0]).is_nan());
    assert_eq!(value("n = 4; x^n", &[-2.0]), 16.0);
    assert_eq!(value("x^0.5", &[9.0]), 3.0);
}

#[test]
fn a_written_out_r_function_is_recognised() {
    let model = read("f = x - 1; g = y - 2; f + g - sqrt(f^2 + g^2)");
    assert_eq!(model.field.operation_count(), read("runion(x - 1, y - 2)").field.operation_count());
}

/// Table 1 of the paper on constructive solids over implicit primitives: a point inside and one outside of each.
#[test]
fn the_solids_of_the_literature_have_their_insides() {
    let decocube =
        "((x^2+y^2-.8^2)^2+(z^2-1)^2)*((y^2+z^2-.8^2)^2+(x^2-1)^2)*((z^2+x^2-.8^2)^2+(y^2-1)^2)-.02";
    let heart = "(2*x^2+y^2+z^2-1)^3-(.1*x^2+y^2)*z^3";
    let torus = "(1-sqrt(x^2+y^2))^2+z^2-.125";
    let bretzel = "1/10*(x^2*(1.21-x^2)^2*(3.8-x^2)^3-10*y^2)^2+60*z^2-2";
    let union = format!(
        "min(x^500+y^500+z^500-.25, (x-1)^2+(y-1)^2+(z-1)^2-.2, {decocube}, {heart}, {torus},
             (x+1)^2+(y+1)^2+(z+1)^2-.1)"
    );
    let icos = "u=(1+sqrt(5))/2; 2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))";
    let sesc = "se = x^6+.5*(y^4+z^4)^4-20;
        sc = x*y+cos(z)+1.741*sin(2*x)*sin(z)*cos(y)+sin(2*y)*sin(x)*cos(z)+sin(2*z)*sin(y)*cos(x)
            -cos(2*x)*cos(2*y)+cos(2*y)*cos(2*z)+cos(2*z)*cos(2*x)+.05;
        max(se, -sc)";
    let table: [(&str, [f64; 3], [f64; 3]); 15] = [
        ("r = 1; x^2+y^2+z^2-r^2", [0.5, 0.5, 0.5], [0.6, 0.6, 0.6]),
        ("x^2+y^2-1", [0.0, 0.9, 100.0], [0.8, 0.8, 0.0]),
        (".25x^2+.25y^2+z^2-1", [1.9, 0.0, 0.0], [0.0, 0.0, 1.1]),
        ("r = .5; x^500+y^500+z^500-r^2", [0.99, -0.99, 0.99], [0.0, 1.01, 0.0]),
        (torus, [1.0, 0.0, 0.3], [0.0, 0.0, 0.0]),
        (bretzel, [0.0, 0.0, 0.1], [0.0, 0.0, 0.2]),
        ("r = 5; x^4-r*x^2+y^4-5*y^2+z^4-5*z^2+11.8", [1.5, 1.5, 1.5], [0.0, 0.0, 0.0]),
        (decocube, [0.8, 0.0, 1.0], [0.0, 0.0, 0.0]),
        ("x^200+(.5*y^4+.5*z^4)^4-1", [0.99, 0.9, 0.9], [1.01, 0.0, 0.0]),
        (heart, [0.0, 0.5, 1.0], [0.0, 0.0, 1.2]),
        ("x^2+z^2-4*y^3*(1-.5*y)^3", [0.0, 1.0, 0.6], [0.0, 1.0, 0.8]),
        ("(1-sqrt(x^2+y^2))^2+sin(z)^3-.125", [1.0, 0.0, -1.0], [1.0, 0.0, 1.0]),
        (icos, [0.0, 0.0, 0.0], [PI, 0.0, 0.0]),
        (sesc, [0.0, 0.0, 0.0], [3.0, 3.0, 3.0]),
        (&union, [1.0, 1.0, 1.1], [3.0, 0.0, 0.0]),
    ];
    for (text, inside, outside) in table {
        assert!(value(text, &inside) < 0.0, "{text} at {inside:?}: {}", value(text, &inside));
        assert!(value(text, &outside) > 0.0, "{text} at {outside:?}: {}", value(text, &outside));
    }
}

#[test]
fn long_sums_and_chains_need_no_stack() {
    let sum = format!("x{}", " + y".repeat(100_000));
    assert_eq!(value(&sum, &[1.0, 2.0]), 200_001.0);
    let signs = format!("{}x", "-".repeat(100_001));
    assert_eq!(value(&signs, &[3.0]), -3.0);
    let tower = format!("x{}", "^1".repeat(100_000));
    assert_eq!(value(&tower, &[3.0]), 3.0);
    let product = "x ".repeat(100_000);
    assert_eq!(value(&product, &[-1.0]), 1.0);
}

#[test]
fn a_thousand_parentheses_nest() {
    let nested = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert_eq!(value(&nested(1_000), &[3.0]), 3.0);
    assert!(parse_formula(&Source::new("formula", nested(1_001))).is_err());
    assert!(parse_formula(&Source::new("formula", "(".repeat(1_000_000))).is_err());
    assert_eq!(value(&format!("{}x{}", "sin(".repeat(1_000), ")".repeat(1_000)), &[0.0]), 0.0);
}

/// Every function of blends and patterns, with arguments at which it has a known value.
#[test]
fn blends_and_patterns_have_the_values_of_their_formulas() {
    let noise = fieldstone_solids::gradient_noise().value(&[0.3, 0.6, 0.2]);
    for (text, expected) in [
        ("union_product(.5, .25, .1)", 0.025),
        ("inter_product(-.5, -.25, .1)", -0.025),
        ("sub_product(-.5, .25, .1)", -0.025),
        ("union_hyperbolic(.3, .3, .04)", 0.1),
        ("inter_hyperbolic(.3, .3, .04)", 0.5),
        ("sub_hyperbolic(.3, -.3, .04)", 0.5),
        ("union_elliptic(.5, .5, 1, 1, 2)", 0.5),
        ("inter_elliptic(-.5, -.5, 1, 1, 2)", -0.5),
        ("sub_elliptic(-.5, .5, 1, 1, 2)", -0.5),
        ("union_pasko(0, 0, .2, 1, 1)", -0.2),
        ("inter_pasko(0, 0, .2, 1, 1)", -0.2),
        ("sub_pasko(0, 0, .2, 1, 1)", -0.2),
        ("union_bounded(0, 0, -1, .2, 1)", -0.2),
        ("inter_bounded(0, 0, 1, .2, 1)", 0.0),
        ("sub_bounded(3, -4, -5, 2, 1)", 11.0),
        ("union_smooth(1, 1, .4)", 0.9),
        ("inter_smooth(1, 1, .4)", 1.1),
        ("sub_smooth(1, -1, .4)", 1.1),
        ("union_cubic(1, 1, .6)", 0.9),
        ("inter_cubic(1, 1, .6)", 1.1),
        ("sub_cubic(1, -1, .6)", 1.1),
        ("sigmoid(1, 9)", 1.0),
        ("gaussian(1, 1)", (-0.5f64).exp()),
        ("noise(.3, .6, .2)", noise),
        ("fbm(.3, .6, .2, 1)", noise),
        ("turbulence(.3, .6, .2, 1)", noise.abs()),
        ("marble(.25, 5, 5, 0)", 1.0),
        ("wood(.3, .4, 7, 0)", 1.0),
        ("checker(.5, 1.5, -.5)", 0.0),
    ] {
        let value = value(&format!("{text} + 0*x"), &[0.0; 3]);
        assert!((value - expected).abs() < 1e-12, "{text} = {value}");
    }
}
