//! What HyperFun texts with mistakes are told. The snapshots are read by people: they must help the writer.

use fieldstone_lang::{HyperFunOptions, Source, parse_hyperfun};

/// All messages for a text.
fn told(text: &str) -> String {
    match parse_hyperfun(&Source::new("model.hf", text), &HyperFunOptions::default()) {
        Err(diagnostics) => diagnostics.to_string(),
        Ok(model) => format!("read without errors, {} warnings", model.warnings.len()),
    }
}

/// The messages for statements of an object.
fn told_each(bodies: &[&str]) -> String {
    let object = |body: &&str| format!("my_model(x[3], a[1]) {{\n  {body}\n  my_model = 1 - x[1];\n}}\n");
    bodies.iter().map(|body| told(&object(body))).collect::<Vec<_>>().join("\n----\n")
}

#[test]
fn slips_of_other_languages() {
    insta::assert_snapshot!(told_each(&[
        "if x[1] == 1 then t = 1; endif;",
        "if x[1] != 1 && x[2] > 0 then t = 1; endif;",
        "t := 1;",
        "// a comment",
        "t = 2 % 3;",
        "t = 2*pi;",
        "t = y;",
        "elseif t = 1;",
        "for i = 1;",
        "return 1;",
        "t = x[1] > 1;",
        "t = 2 x;",
        "t = 2 \u{2212} 1;",
        "if (x[1] = 1) { t = 1; }",
        "hfShift3D(x, 1, 0, 0);",
        "t = \"text\";",
        "if 1 xor 0 then t = 1; endif;",
    ]));
}

#[test]
fn names() {
    insta::assert_snapshot!(told_each(&[
        "radius = 2; t = raduis;",
        "t = later; later = 1;",
        "t = hfSpere(x, x, 1);",
        "t = squareroot(2);",
        "sin = 2;",
        "x = 2;",
        "t = sqrt + 1;",
        "q[1] = 2;",
        "array list[3]; list = [1, 2, 3]; t = lst[1];",
        "t = x;",
        "t = 1; u = t[1];",
        "array q[2], q[3];",
        "array sin[2];",
        "t = my_model(x, a);",
        "_t = 1;",
        "t = hfBezierSplineF(x, 1);",
        "t = hfR(x, 1);",
    ]));
}

#[test]
fn sizes_and_arguments() {
    insta::assert_snapshot!(told_each(&[
        "array q[0];",
        "array q[n];",
        "array q[2*x[1] + a[1]];",
        "n = 2.5; array q[n];",
        "array q[100000];",
        "array q[1e5 + 1];",
        "array q[3]; q = [1, 2];",
        "array q[3]; q = x;",
        "t = x[4];",
        "t = x[0.2];",
        "t = atan2(1);",
        "t = sin(1, 2);",
        "t = sin(x);",
        "t = hfSphere(x, 1, 1);",
        "t = hfSphere(x, a, 1);",
        "t = hfSphere(x + 1, a, 1);",
        "t = sin();",
    ]));
}

#[test]
fn punctuation() {
    insta::assert_snapshot!(told_each(&[
        "t = 1",
        "if x[1] > 0 then t = 1; endif",
        "if x[1] > 0 then t = 1;",
        "while x[1] > 0 loop t = 1;",
        "if x[1] > 0 t = 1; endif;",
        "t = (1 + 2;",
        "t = x[1;",
        "t = 1 + ;",
        "t = sin(1,);",
        "t = 1);",
        "endif;",
        "= 3;",
    ]));
}

#[test]
fn objects() {
    let texts = [
        "",
        "my_model { }",
        "my_model(x[3]) { my_model = 1; }",
        "my_model(x[3], a[1]) { t = 1; }",
        "my_model(x[3], a[1]) { my_model = 1;",
        "a(x[3], a[1]) { a = 1; }",
        "f(x[3], a[1]) { f = 1; } f(x[3], a[1]) { f = 2; }",
        "my_model(x[3], a[1]) { my_model = f(x, a); } f(x[3], a[1]) { f = 1; }",
        "f(x[2], a[1]) { f = 1; } my_model(x[3], a[1]) { my_model = f(x, a); }",
        "f(x[2], a[1]) { f = 1; } my_model(x[3], a[1]) { my_model = f(x); }",
        "f(x[2], a[1]) { f = 1; } my_model(x[3], a[1]) { my_model = f(x[1], a); }",
        "my_model(x[3], a[1]) { my_model = x[4]; }",
        "my_model(x[3], a[1]) { n = 1; array p[n + 1]; p = [1, 2]; my_model = f(p, a); }\nf(x[3], a[1]) { f = 1; }",
        "my_model(x[3], a[1]) { my_model = f(x, a); }\nf(x[3], a[1]) { if x[1] > a[1] then g = my_model(x, a); else g = 1; endif; f = g; }",
        "my_model(x[3], a[1]) { my_model = my_model(x, a) + 1; }",
        "my_model(x[3], a[1]) { t = 1; my_model = t\n\nf(x[3], a[1]) { f = 1; }",
    ];
    insta::assert_snapshot!(texts.map(told).join("\n----\n"));
}

#[test]
fn conditions() {
    insta::assert_snapshot!(told_each(&[
        "if 2*(x[1] = y) > 1 then t = 1; else t = 2; endif;",
        "while x[1] > loop t = 1; endloop;",
        "if 2 + not x[1] > 0 then t = 1; endif;",
        "if x[1] > 0 and then t = 1; endif;",
    ]));
}

#[test]
fn one_run_shows_several_errors_but_not_all() {
    let text = "my_model(x[3], a[1]) {\n  t = u;\n  v = (1;\n  w = hfspher(x);\n  if w then y = 1 endif;\n  my_model = t + v;\n}\n";
    insta::assert_snapshot!(told(text));
    let many = format!("my_model(x[3], a[1]) {{ {} my_model = 1; }}", "t = (1; ".repeat(500));
    assert_eq!(told(&many).matches("error:").count(), 20);
}

#[test]
fn loops_without_end() {
    insta::assert_snapshot!(told_each(&["i = 1; while i < 10 loop t = i; endloop;"]));
}
