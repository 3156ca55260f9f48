//! Models written in another language, or in their own, and read again have the values that they had.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use fieldstone_field::Bindings;
use fieldstone_lang::{
    Dialect, FileSign, HyperFunOptions, Model, PrintError, Printed, Source, Syntax, parse_formula,
    parse_hyperfun, parse_vm, print_model,
};
use std::path::{Path, PathBuf};

const SYNTAXES: [Syntax; 3] = [Syntax::HyperFun, Syntax::Formula, Syntax::Vm];

fn read(text: &str, syntax: Syntax) -> Model {
    let source = Source::new("text", text);
    let model = match syntax {
        Syntax::HyperFun => {
            parse_hyperfun(&source, &HyperFunOptions { object: None, dialect: Dialect::Lenient })
        }
        Syntax::Formula => parse_formula(&source),
        Syntax::Vm => parse_vm(&source),
    };
    model.unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn formula(text: &str) -> Model {
    read(text, Syntax::Formula)
}

/// The parameters of `model` with the defaults of `of`, which has the same ones.
fn bindings(model: &Model, of: &Model) -> Bindings {
    let mut bindings = Bindings::new();
    for (parameter, original) in model.parameters.iter().zip(&of.parameters) {
        bindings.set(parameter.input, original.default);
    }
    bindings
}

/// Points in [-2, 2]⁴, and some of the special kind.
fn points() -> Vec<[f64; 4]> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 4.0 - 2.0
    };
    let mut points: Vec<[f64; 4]> = (0..60).map(|_| [next(), next(), next(), next()]).collect();
    points.extend([[0.0; 4], [1.0; 4], [-1.0, 0.0, 0.5, 0.0], [1e-9, -1e-9, 1.5, -2.0]]);
    points
}

fn same(a: f64, b: f64) -> bool {
    let close = (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
    a == b || (a.is_nan() && b.is_nan()) || (close && (a - b).is_finite())
}

/// The first point at which two models differ.
fn difference(a: &Model, b: &Model) -> Option<String> {
    let (of_a, of_b) = (bindings(a, a), bindings(b, a));
    let attributes = a.field.attributes().len().min(b.field.attributes().len());
    points().into_iter().find_map(|point| {
        let (left, right) = (a.field.at(&point, &of_a), b.field.at(&point, &of_b));
        let differs = (0..=attributes).find(|&k| !same(left[k], right[k]))?;
        Some(format!("output {differs} at {point:?}: {} is {}", left[differs], right[differs]))
    })
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    files
}

/// Prints and reads; the languages that it went through, and what differs. Whatever has a text has it in HyperFun too.
fn round_trips(model: &Model, name: &str) -> (Vec<Syntax>, Vec<String>) {
    let (mut done, mut differences) = (Vec::new(), Vec::new());
    for syntax in SYNTAXES {
        let Ok(Printed { text, .. }) = print_model(model, syntax, &[]) else { continue };
        let again = read(&text, syntax);
        done.push(syntax);
        differences.extend(difference(model, &again).map(|d| format!("{name} as {syntax}: {d}")));
        // And back to where it came from.
        if let Ok(back) = print_model(&again, Syntax::HyperFun, &[]) {
            let back = read(&back.text, Syntax::HyperFun);
            let defaults_lost =
                syntax == Syntax::HyperFun && model.parameters.iter().any(|p| p.default != 0.0);
            if !defaults_lost {
                differences.extend(difference(&again, &back).map(|d| format!("{name} from {syntax}: {d}")));
            }
        }
    }
    (done, differences)
}

#[test]
fn golden_models_and_the_gallery_keep_their_values() {
    let lists = [
        (files("tests/golden", "hf"), Syntax::HyperFun),
        (files("../../gallery", "hf"), Syntax::HyperFun),
        (files("../../gallery", "vm"), Syntax::Vm),
        (files("../../gallery/table1", "txt"), Syntax::Formula),
    ];
    let (mut read_files, mut trips, mut differences) = (0, 0, Vec::new());
    for (path, syntax) in lists.iter().flat_map(|(files, syntax)| files.iter().map(move |f| (f, *syntax))) {
        let model = read(&std::fs::read_to_string(path).unwrap(), syntax);
        let (done, different) = round_trips(&model, &path.display().to_string());
        read_files += 1;
        trips += done.len();
        differences.extend(different);
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    // All but the one model with a loop, and in formulas and programs what has no closed form.
    assert!(read_files >= 100 && trips >= 3 * read_files - 20, "{trips} texts of {read_files} models");
}

#[test]
fn every_operation_keeps_its_values() {
    let unary = "neg abs sqrt square recip exp ln sin cos tan asin acos atan sinh cosh tanh floor ceil round trunc sign not";
    let binary = "add sub mul div min max rmin rmax pow atan2 rem mod compare lt le eq and or";
    let mut differences = Vec::new();
    for op in unary
        .split(' ')
        .map(|op| format!("v {op} x"))
        .chain(binary.split(' ').map(|op| format!("v {op} x y")))
    {
        let model = read(&format!("x var-x\ny var-y\n{op}"), Syntax::Vm);
        let (done, different) = round_trips(&model, &op);
        assert_eq!(done, SYNTAXES, "{op}");
        differences.extend(different);
    }
    for n in [-7, -3, -2, 3, 4, 5, 11, 500] {
        differences.extend(round_trips(&formula(&format!("x^{n}")), &format!("x^{n}")).1);
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn random_programs_keep_their_values() {
    // Without the two that a language has to compose with another rounding.
    let unary = "neg abs sqrt square recip exp ln sin cos tan asin acos atan sinh cosh tanh floor ceil trunc sign not";
    let binary = "add sub mul div min max rmin rmax pow atan2 rem mod compare lt le eq and or";
    let (unary, binary): (Vec<&str>, Vec<&str>) = (unary.split(' ').collect(), binary.split(' ').collect());
    let mut state = 7u64;
    let mut below = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % bound
    };
    let mut differences = Vec::new();
    for _ in 0..150 {
        let mut text = "_0 var-x\n_1 var-y\n_2 var-z\n_3 const -0.75\n_4 const 3\n".to_owned();
        for line in 5..40 {
            text += &match below(3) {
                0 => format!("_{line} {} _{}\n", unary[below(unary.len())], below(line)),
                _ => format!("_{line} {} _{} _{}\n", binary[below(binary.len())], below(line), below(line)),
            };
        }
        let (done, different) = round_trips(&read(&text, Syntax::Vm), &text);
        assert_eq!(done, SYNTAXES);
        differences.extend(different);
    }
    assert!(differences.is_empty(), "{} differ: {}", differences.len(), differences[0]);
}

#[test]
fn a_composed_arc_is_close() {
    let model = read("x var-x\nv atanh x", Syntax::Vm);
    let again = read(&print_model(&model, Syntax::HyperFun, &[]).unwrap().text, Syntax::HyperFun);
    for x in [-0.9, -0.1, 1e-9, 0.5, 2.0] {
        let [a, b] = [&model, &again].map(|m| m.field.at(&[x, 0.0, 0.0], &Bindings::new())[0]);
        assert!((a - b).abs() < 1e-15 || (a.is_nan() && b.is_nan()), "{x}: {a} is {b}");
    }
}

#[test]
fn the_comparison_rejects_what_is_wrong() {
    assert!(same(1.0, 1.0 + 1e-13) && same(f64::NAN, f64::NAN) && same(f64::INFINITY, f64::INFINITY));
    assert!(
        !same(1.0, 1.0 + 2e-12) && !same(1.0, f64::NAN) && !same(1e-20, 2e-20) && !same(f64::INFINITY, 1.0)
    );
    assert!(difference(&formula("x"), &formula("x + 1e-9*y")).is_some());
}

#[test]
fn numbers_read_back_exactly() {
    let numbers =
        ["0.1", "1e300", "5e-324", "123456789012345680", "-3", "-2.5e-7", "0.30000000000000004", "1e-16"];
    for number in numbers {
        let value: f64 = number.parse().unwrap();
        for syntax in SYNTAXES {
            let printed = print_model(&formula(&format!("max(x, {number})")), syntax, &[]).unwrap();
            let again = read(&printed.text, syntax).field.at(&[-f64::INFINITY, 0.0, 0.0], &Bindings::new());
            assert_eq!(again[0].to_bits(), value.to_bits(), "{number} in {syntax}");
        }
    }
}

#[test]
fn infinite_and_undefined_constants_survive() {
    for text in ["min(x, 1/0)", "max(x, -1/0)", "if(x < 0, 0/0, x)"] {
        let (done, different) = round_trips(&formula(text), text);
        assert_eq!((done.len(), different), (3, vec![]));
    }
}

#[test]
fn parameters_keep_what_the_language_has_for_them() {
    let model = formula("radius = 2; t1 = 0.5; x^2 + y^2 + w*t - radius^2 + t1");
    insta::assert_snapshot!(all(&model, &[]));
}

#[test]
fn a_fixed_input_is_a_constant() {
    let model = formula("radius = 2; x^2 + z^2 - radius^2");
    let fixed = [(model.parameters[0].input, 3.0), (fieldstone_field::Input::Coordinate(2), 1.0)];
    insta::assert_snapshot!(all(&model, &fixed));
}

#[test]
fn shared_parts_are_variables_and_conditions_statements() {
    let text = "my_model(x[3], a[2], s[3]) { array xt[3]; xt[1] = x[1]; xt[2] = x[2]; xt[3] = x[3];
        t = hfRotate3DY(xt, a[2]); f = hfSphere(xt, xt, 2) | (x[1]^3 + 1)/-(xt[2] - 2);
        if (f > 0) and not (x[3] = 1) then s[1] = f; else s[1] = hfA_NoiseP(xt); endif;
        s[2] = atan2(f, 2); my_model = f & -x[2]; }";
    let model = read(text, Syntax::HyperFun);
    let printed = print_model(&model, Syntax::HyperFun, &[]).unwrap();
    insta::assert_snapshot!(printed.text);
    assert_eq!(difference(&model, &read(&printed.text, Syntax::HyperFun)), None);
}

/// The texts and warnings of all languages.
fn all(model: &Model, fixed: &[(fieldstone_field::Input, f64)]) -> String {
    let texts = SYNTAXES.map(|syntax| match print_model(model, syntax, fixed) {
        Ok(Printed { text, warnings }) => format!("{syntax}:\n{text}{}\n", warnings.join("\n")),
        Err(error) => format!("{syntax}: {error}\n"),
    });
    texts.join("\n")
}

#[test]
fn what_a_language_cannot_say_is_an_error_with_the_reason() {
    let of = |body: &str| {
        read(
            &format!("my_model(x[5], a[1], s[1]) {{ array p[3], o[3]; p = [0,0,0]; o = [0,0,0]; {body} }}"),
            Syntax::HyperFun,
        )
    };
    let loops = of("i = 0; while i < x[1] loop i = i + 1; endloop; my_model = i;");
    let noise = of("p[1] = x[1]; my_model = hfA_NoiseP(p);");
    let fifth = of("my_model = x[5];");
    let error = |model: &Model, syntax| print_model(model, syntax, &[]).unwrap_err();
    for syntax in SYNTAXES {
        assert_eq!(error(&loops, syntax), PrintError::Loop(syntax));
    }
    for syntax in [Syntax::Formula, Syntax::Vm] {
        assert_eq!(error(&fifth, syntax), PrintError::Coordinate { number: 5, syntax });
    }
    let unknown = PrintError::Function { name: "hfA_NoiseP", syntax: Syntax::Vm };
    assert_eq!(error(&noise, Syntax::Vm), unknown);
    assert_eq!(print_model(&noise, Syntax::Formula, &[]).unwrap().text, "a1 = 0;\n-noise(x, 0, 0)\n");
    assert!(
        print_model(&noise, Syntax::HyperFun, &[]).is_ok()
            && print_model(&fifth, Syntax::HyperFun, &[]).is_ok()
    );
}

#[test]
fn the_sign_of_the_language_is_kept() {
    let ball = formula("x^2 + y^2 + z^2 - 1");
    let printed = print_model(&ball, Syntax::HyperFun, &[]).unwrap();
    assert!(printed.text.contains("my_model = 1 - "), "{}", printed.text);
    let again = read(&printed.text, Syntax::HyperFun);
    assert_eq!(again.sign, FileSign::PositiveInside);
    assert_eq!(again.field.at(&[0.0; 3], &Bindings::new()), [-1.0]);
}

#[test]
fn programs_name_the_operations_that_others_do_not_know() {
    let printed = print_model(&formula("tanh(x) + x^y + x^3 + runion(x, y)"), Syntax::Vm, &[]).unwrap();
    assert_eq!(printed.warnings, ["other programs may not know `pow`, `tanh`: they have no such operation"]);
    assert_eq!(print_model(&formula("x^3 + runion(x, y)"), Syntax::Vm, &[]).unwrap().warnings, [""; 0]);
}

#[test]
fn blends_and_patterns_of_formulas_are_written_out() {
    let text = "union_hyperbolic(x - 1, y - 1, 0.1) + fbm(x, y, z, 2)";
    let model = formula(text);
    let formula_text = print_model(&model, Syntax::Formula, &[]).unwrap().text;
    let hyperfun_text = print_model(&model, Syntax::HyperFun, &[]).unwrap().text;
    let p = [0.3, 0.8, -0.4];
    let value = model.field.at(&p, &Bindings::new())[0];
    for (text, syntax) in [(formula_text, Syntax::Formula), (hyperfun_text, Syntax::HyperFun)] {
        let again = read(&text, syntax).field.at(&p, &Bindings::new())[0];
        assert!((again - value).abs() < 1e-14, "{text}");
    }
}
