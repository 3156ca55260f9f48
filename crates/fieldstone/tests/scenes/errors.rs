//! What is said of scenes with a mistake: a snapshot of each.

use crate::{at, document};

const MISTAKES: [(&str, &str); 45] = [
    ("no TOML", "[solids]\nball = x^2"),
    ("unknown table", "[solid]\nball = \"x\""),
    ("unknown key", "[camera]\nfow = 30"),
    ("key of another table", "[render]\neye = [1, 2, 3]"),
    ("wrong type", "[render]\nsamples = \"many\""),
    ("out of range", "[render]\nsamples = 0"),
    ("too few numbers", "[camera]\neye = [1, 2]"),
    ("unknown word", "[render]\nmethod = \"afine\""),
    ("no solid", "[render]\nsize = [9, 9]"),
    ("unknown solid", "[solids]\nball = \"x\"\n[solids.a]\nunion = [\"bal\"]"),
    ("unknown material", "[solids.a]\nformula = \"x\"\nmaterial = \"gold\""),
    ("fault in a formula", "[solids]\nball = \"x^2 + sinn(y)\""),
    ("fault in a long formula", "[solids]\nball = \"\"\"\nx^2 +\n  q*y\"\"\""),
    ("unknown name in a number", "[solids]\na = \"x\"\n[camera]\nfov = \"30 + rr\"\n[parameters]\nr = 1"),
    ("space in a number", "[solids]\na = \"x\"\n[camera]\nfov = \"30 + x\""),
    ("infinite number", "[solids]\na = \"x\"\n[camera]\nfov = \"1/t\""),
    (
        "circle of parameters",
        "[solids]\na = \"x\"\n[parameters]\np = \"q\"\nq = \"p + 1\"\n[camera]\nfov = \"p\"",
    ),
    ("circle of fields", "[fields]\nf = \"g\"\ng = \"x*f\"\n[solids]\na = \"f\""),
    (
        "circle of solids",
        "[solids.a]\nunion = [\"b\"]\n[solids.b]\nunion = [\"a\"]\n[[objects]]\nsolid = \"a\"",
    ),
    ("only circles", "[solids.a]\nunion = [\"b\"]\n[solids.b]\nunion = [\"a\"]"),
    ("name with a meaning", "[parameters]\nt = 1"),
    ("name of a field and a parameter", "[parameters]\nf = 1\n[fields]\nf = \"x\""),
    ("two descriptions", "[solids.a]\nformula = \"x\"\nfile = \"a.hf\""),
    ("no description", "[solids.a]\nmaterial = \"m\""),
    ("key of files", "[solids.a]\nformula = \"x\"\nobject = \"b\""),
    ("key of objects in a part", "[solids.a]\nunion = [{ formula = \"x\", open = true }]"),
    ("unknown parameter of a model", "[solids.a]\nfile = \"painted.hf\"\nparameters = { b = 1 }"),
    ("coordinate of space", "[solids.a]\nfile = \"painted.hf\"\ncoordinates = { 3 = 1 }"),
    ("no such file", "[solids.a]\nfile = \"no/such.hf\""),
    ("no condition", "[solids.a]\nformula = \"x\"\nwhere = \"y\""),
    ("fault in a condition", "[solids.a]\nformula = \"x\"\nwhere = \"y > 2 + k\""),
    ("no colour", "[solids.a]\nformula = \"x\"\nmaterial = \"m\"\n[materials.m]\ncolour = \"blau\""),
    (
        "channel out of range",
        "[solids.a]\nformula = \"x\"\nmaterial = \"m\"\n[materials.m]\nmodel = \"ggx\"\nroughness = 2",
    ),
    ("channel of another model", "[solids]\na = \"x\"\n[materials.m]\nmodel = \"mirror\"\nroughness = 0.2"),
    ("key of another model", "[solids]\na = \"x\"\n[materials.m]\nmodel = \"metal\"\nfresnel = true"),
    ("map of copies", "[[objects]]\nsolid = { formula = \"x\" }\ninstances = [{ bend = { degrees = 9 } }]"),
    ("map without an axis", "[solids.a]\nformula = \"x\"\ntransform = [{ twist = { degrees = 9 } }]"),
    ("wall of nothing", "[solids.a]\nformula = \"x\"\nshell = 0"),
    (
        "attributes of a formula",
        "[solids.a]\nformula = \"x\"\nmaterial = \"m\"\n[materials.m]\ncolour = { attributes = 1 }",
    ),
    ("no time", "[solids]\na = \"x\"\n[camera]\nfov = { zero = 1 }"),
    ("same time twice", "[solids]\na = \"x\"\n[camera]\nfov = { 1 = 1, \"1.0\" = 2 }"),
    ("flat motion", "[solids.a]\nformula = \"x\"\ntransform = { scale = [1, 0, 1] }"),
    (
        "number of another blend",
        "[solids.a]\nblend = { solids = [{ formula = \"x\" }, { formula = \"y\" }], kind = \"product\", k = 1 }",
    ),
    ("light without a place", "[solids]\na = \"x\"\n[[lights]]\nkind = \"point\""),
    ("impossible camera", "[solids]\na = \"x\"\n[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]"),
];

#[test]
fn mistakes_are_shown_in_their_place() {
    let mut all = String::new();
    for (name, text) in MISTAKES {
        let error = match at(text, 0.0) {
            Ok(_) => panic!("{name}: no error"),
            Err(error) => error.replace(env!("CARGO_MANIFEST_DIR"), "."),
        };
        assert!(error.starts_with("error: ") && error.contains("--> "), "{name}: {error}");
        all += &format!("# {name}\n{error}\n\n");
    }
    insta::assert_snapshot!(all);
}

#[test]
fn what_nothing_uses_is_checked_too() {
    let ball = "[solids]\nball = \"x^2 + y^2 + z^2 - 1\"\n";
    for (rest, message) in [
        ("[materials.m]\ncolour = \"tael\"", "`tael` is not a colour"),
        ("[materials.m]\nshininess = \"x + qq\"", "unknown name `qq`"),
        ("[materials.m]\ncolour = { red = \"nx\", green = \"0\", blue = \"0/0\" }", "NaN everywhere"),
        ("[parameters]\na = \"b\"\nb = \"a\"", "depends on itself"),
        ("[parameters]\na = inf", "not a finite number"),
        ("[fields]\na = \"nosuch + 1\"", "unknown name `nosuch`"),
        ("[solids.c]\nunion = [\"nosuch\"]\n[[objects]]\nsolid = \"ball\"", "no solid `nosuch`"),
        ("[solids.a]\ncomplement = \"b\"\n[solids.b]\ncomplement = \"a\"", "part of itself"),
    ] {
        let error = at(&format!("{ball}{rest}"), 0.0).map(|_| ()).unwrap_err();
        assert!(error.contains(message) && error.contains("--> scene.toml:"), "{rest}: {error}");
    }
    assert!(at(&format!("{ball}[materials.m]\ncolour = {{ attributes = 1 }}"), 0.0).is_ok());
}

#[test]
fn what_is_unused_is_told() {
    let text = "[parameters]\nr = 1\nq = 2\n[fields]\nf = \"x*r\"\n[solids]\na = \"f\"\nb = \"y\"\nc = \"z\"
        [solids.d]\nunion = [\"a\", \"b\"]\n[materials]\nm = { }\nn = { }
        [[objects]]\nsolid = \"d\"\nmaterial = \"n\"";
    let unused = document(text).unwrap().unused();
    assert_eq!(unused, ["the parameter `q`", "the solid `c`", "the material `m`"]);
}

#[test]
fn there_are_not_too_many_solids() {
    let solids = |count: usize| (0..count).map(|i| format!("s{i} = \"x\"\n")).collect::<String>();
    let error = document(&format!("[solids]\n{}", solids(10_001))).unwrap_err();
    assert!(error.contains("at most 10000 solids, not 10001"), "{error}");
    assert!(document(&format!("[solids]\n{}", solids(10_000))).is_ok());
}

#[test]
fn several_mistakes_are_told_at_once() {
    let error = document("[camera]\nfow = 30\neyes = [1, 2, 3]\n[solids]\na = 3.5\nb = true\n").unwrap_err();
    assert_eq!(error.matches("error: ").count(), 3, "{error}");
}

#[test]
fn scenes_end() {
    let deep = format!("[solids]\na = {}\"x\"{}", "{ complement = ".repeat(500), " }".repeat(500));
    assert!(at(&deep, 0.0).unwrap_err().contains("too deep"));
    let chain: String = (0..200).map(|i| format!("[solids.s{i}]\ncomplement = \"s{}\"\n", i + 1)).collect();
    assert!(at(&format!("{chain}[solids]\ns200 = \"x\""), 0.0).unwrap_err().contains("64 deep"));
    let double: String =
        (0..40).map(|i| format!("[solids.s{i}]\nunion = [\"s{0}\", \"s{0}\"]\n", i + 1)).collect();
    let error = at(&format!("{double}[solids]\ns40 = \"x\""), 0.0).unwrap_err();
    assert!(error.contains("more than 10000 solids"), "{error}");
    let fields: String = (0..60).map(|i| format!("f{i} = \"f{0} + f{0}*x\"\n", i + 1)).collect();
    let scene =
        format!("[fields]\n{fields}f60 = \"y\"\n[solids.a]\nformula = \"f0\"\nbounds = [0, 0, 0, 1, 1, 1]");
    assert!(at(&scene, 0.0).is_ok());
    let copies = "[[objects]]\nsolid = { formula = \"x^2 + y^2 + z^2 - 1\" }\ngrid = { count = [1000, 1000, 1], spacing = [1, 1, 1] }";
    assert!(at(copies, 0.0).unwrap_err().contains("at most 100000 copies"));
}
