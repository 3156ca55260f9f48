//! Texts that are large, deep or no models at all: they are read, or are errors that say what the limit is.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use fieldstone_lang::{Diagnostics, HyperFunOptions, Model, Source, parse_formula, parse_hyperfun, parse_vm};

type Parse = fn(&Source) -> Result<Model, Diagnostics>;

fn hyperfun(source: &Source) -> Result<Model, Diagnostics> {
    parse_hyperfun(source, &HyperFunOptions::default())
}

fn object(body: &str) -> String {
    format!("my_model(x[3], a[1]) {{ {body} }}")
}

#[track_caller]
fn operations(parse: Parse, text: String) -> usize {
    match parse(&Source::new("large", text)) {
        Ok(model) => model.field.operation_count(),
        Err(errors) => panic!("{errors}"),
    }
}

/// The first error, whose message with its part of the text must not be long.
#[track_caller]
fn error(parse: Parse, text: String) -> String {
    let errors = parse(&Source::new("large", text)).map(|_| ()).unwrap_err();
    let length = errors.to_string().len();
    assert!(length < 300_000, "{length} bytes");
    errors.list[0].message.clone()
}

#[test]
fn many_operations_are_read() {
    let statements = (2..100_000).map(|i| format!("t{i} = (t{}+t{}*0.123456789012);\n", i - 1, i - 2));
    let text =
        object(&format!("t0 = x[1]; t1 = x[2]; {} my_model = t99999;", statements.collect::<String>()));
    assert!(operations(hyperfun, text) > 190_000);
    let lines = (2..100_000).map(|i| format!("_{i} add _{} _{}\n", i - 1, i - 2));
    let text = format!("_0 var-x\n_1 var-y\n{}", lines.collect::<String>());
    assert_eq!(operations(parse_vm, text), 99_998);
    let definitions = (1..100_000).map(|i| format!("a{i} = a{} + y;", i - 1));
    let text = format!("a0 = x; {} a99999", definitions.collect::<String>());
    assert_eq!(operations(parse_formula, text), 99_999);
}

#[test]
fn long_expressions_are_read() {
    let chain = |term: &str, operator: &str, count| vec![term; count].join(operator);
    assert!(operations(hyperfun, object(&format!("my_model = {};", chain("x[1]", "+", 200_000)))) >= 199_999);
    assert!(operations(hyperfun, object(&format!("my_model = {};", chain("x[1]", "^", 100_000)))) >= 99_999);
    assert_eq!(operations(parse_formula, chain("x", "+", 200_000)), 199_999);
    assert_eq!(operations(parse_formula, chain("x", "^", 100_000)), 99_999);
    assert!(operations(parse_formula, format!("{}x", "- ".repeat(300_000))) <= 1);
}

#[test]
fn parentheses_may_be_a_thousand_deep() {
    let nested = |count: usize, inner: &str| format!("{}{inner}{}", "(".repeat(count), ")".repeat(count));
    let in_object = |count| object(&format!("my_model = {};", nested(count, "x[1]")));
    operations(hyperfun, in_object(1000));
    operations(parse_formula, nested(1000, "x"));
    assert!(error(hyperfun, in_object(1001)).contains("more than 1000 parentheses"));
    assert!(error(parse_formula, nested(1001, "x")).contains("more than 1000 parentheses"));
    assert!(error(hyperfun, in_object(200_000)).contains("more than 1000 parentheses"));
    assert!(error(parse_formula, "(".repeat(200_000)).contains("more than 1000 parentheses"));
}

#[test]
fn texts_above_the_limits_are_errors() {
    let words = 5_000_000;
    for text in ["(".repeat(words), "x ".repeat(words), "v = 1; ".repeat(words / 4)] {
        assert!(error(hyperfun, text.clone()).contains("more than 4000000 words"));
        assert!(error(parse_formula, text).contains("more than 4000000 words"));
    }
    assert!(error(parse_vm, "\n".repeat(words)).contains("more than 4000000 lines"));
    let arrays = (0..1000).map(|i| format!("q{i}[65535]")).collect::<Vec<_>>().join(", ");
    assert!(error(hyperfun, object(&format!("array {arrays}; my_model = 1;"))).contains("more than 1000000"));
}

#[test]
fn long_names_and_lines_are_errors_that_are_short() {
    let name = "b".repeat(20 << 20);
    assert!(error(hyperfun, object(&format!("my_model = {name};"))).contains("more than 255"));
    assert!(error(parse_formula, name.clone()).contains("more than 255"));
    assert!(error(parse_vm, format!("{name} var-x")).contains("more than 255"));
    assert!(error(parse_vm, "a ".repeat(10 << 20)).contains("unknown operation"));
    assert!(error(parse_formula, "1".repeat(20 << 20)).contains("too large"));
}

#[test]
fn what_is_no_model_is_an_error() {
    let cut = "my_model(x[3], a[1]) { my_model = hfSph";
    let junk: String =
        (0..200_000_u32).filter_map(|i| char::from_u32(i.wrapping_mul(7919) % 0x3000)).collect();
    for text in ["", "\n\n\n", "--", cut, &junk, &"$ ".repeat(5 << 20), &"\u{1}\u{2}".repeat(5 << 20)] {
        for parse in [hyperfun as Parse, parse_formula, parse_vm] {
            error(parse, text.to_owned());
        }
    }
    for end in 0..cut.len() {
        error(hyperfun, cut[..end].to_owned());
    }
}
