//! What is said of texts that are not formulas.

use crate::diagnostic::MAX_ERRORS;
use crate::{Source, parse_formula};

pub(super) fn messages(text: &str) -> String {
    match parse_formula(&Source::new("formula", text)) {
        Ok(model) => panic!("{text} is read: {model:?}"),
        Err(errors) => errors.to_string(),
    }
}

fn warnings(text: &str) -> String {
    let source = Source::new("formula", text);
    match parse_formula(&source) {
        Ok(model) => model.warnings.iter().map(|warning| warning.render(&source)).collect(),
        Err(errors) => panic!("{text}\n{errors}"),
    }
}

#[test]
fn characters_of_no_formula() {
    insta::assert_snapshot!(messages("x $ y"), @r#"
    error: unexpected character `$`
     --> formula:1:3
      |
    1 | x $ y
      |   ^ not part of a formula
    "#);
    insta::assert_snapshot!(messages("[x]"), @r#"
    error: unexpected character `[`
     --> formula:1:1
      |
    1 | [x]
      | ^ not part of a formula
      |
      = help: group with `(` and `)`

    error: unexpected character `]`
     --> formula:1:3
      |
    1 | [x]
      |   ^ not part of a formula
      |
      = help: group with `(` and `)`
    "#);
    insta::assert_snapshot!(messages("x % 2"), @r#"
    error: unexpected character `%`
     --> formula:1:3
      |
    1 | x % 2
      |   ^ not part of a formula
      |
      = help: write `mod(a, b)` for the remainder
    "#);
    insta::assert_snapshot!(messages("x & y"), @r#"
    error: unexpected character `&`
     --> formula:1:3
      |
    1 | x & y
      |   ^ not part of a formula
      |
      = help: write `and`
    "#);
    insta::assert_snapshot!(messages("√x"), @r#"
    error: unexpected character `√`
     --> formula:1:1
      |
    1 | √x
      | ^ not part of a formula
      |
      = help: write `sqrt(…)`
    "#);
    insta::assert_snapshot!(messages("x := 1"), @r#"
    error: unexpected character `:`
     --> formula:1:3
      |
    1 | x := 1
      |   ^ not part of a formula
      |
      = help: a name is given a value by `name = value;`
    "#);
    insta::assert_snapshot!(messages("1e999x"), @r#"
    error: the number is too large
     --> formula:1:1
      |
    1 | 1e999x
      | ^^^^^ above 1.8e308
    "#);
    insta::assert_snapshot!(messages("x⁻"), @r#"
    error: `⁻` is not a power
     --> formula:1:2
      |
    1 | x⁻
      |  ^ expected a whole number
      |
      = help: write the power as `^(…)`
    "#);
    insta::assert_snapshot!(messages("x²⁻¹"), @r#"
    error: `²⁻¹` is not a power
     --> formula:1:2
      |
    1 | x²⁻¹
      |  ^^^ expected a whole number
      |
      = help: write the power as `^(…)`
    "#);
}

#[test]
fn missing_values() {
    insta::assert_snapshot!(messages("x +"), @r#"
    error: expected a value, found the end of the text
     --> formula:1:4
      |
    1 | x +
      |    ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("x + * y"), @r#"
    error: expected a value, found `*`
     --> formula:1:5
      |
    1 | x + * y
      |     ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("()"), @r#"
    error: expected a value, found `)`
     --> formula:1:2
      |
    1 | ()
      |  ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("x * ) + 1"), @r#"
    error: expected a value, found `)`
     --> formula:1:5
      |
    1 | x * ) + 1
      |     ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("2 * * 3"), @r#"
    error: expected a value, found `*`
     --> formula:1:5
      |
    1 | 2 * * 3
      |     ^ expected a number, a name or `(`
      |
      = help: a power is written `^` or `**`
    "#);
    insta::assert_snapshot!(messages("x => 1"), @r#"
    error: expected a value, found `>`
     --> formula:1:4
      |
    1 | x => 1
      |    ^ expected a number, a name or `(`
      |
      = help: comparisons are written `<=`, `>=`, `==` and `!=`
    "#);
    insta::assert_snapshot!(messages("²x"), @r#"
    error: expected a value, found `²`
     --> formula:1:1
      |
    1 | ²x
      | ^ expected a number, a name or `(`
      |
      = help: a power stands after its base: `x²`
    "#);
    insta::assert_snapshot!(messages("x ^"), @r#"
    error: expected a value, found the end of the text
     --> formula:1:4
      |
    1 | x ^
      |    ^ expected a number, a name or `(`
    "#);
}

#[test]
fn missing_operators() {
    insta::assert_snapshot!(messages("1 2"), @r#"
    error: two numbers side by side
     --> formula:1:3
      |
    1 | 1 2
      |   ^ expected an operator before it
      |
      = help: write `*` between factors
    "#);
    insta::assert_snapshot!(messages("x 1.5.2"), @r#"
    error: two numbers side by side
     --> formula:1:6
      |
    1 | x 1.5.2
      |      ^^ expected an operator before it
      |
      = help: write `*` between factors
    "#);
    insta::assert_snapshot!(messages("x not y"), @r#"
    error: expected an operator, found `not`
     --> formula:1:3
      |
    1 | x not y
      |   ^^^ expected `+`, `*` or the like before it
    "#);
    insta::assert_snapshot!(messages("x let y"), @r#"
    error: expected an operator, found `let`
     --> formula:1:3
      |
    1 | x let y
      |   ^^^ expected `+`, `*` or the like before it
      |
      = help: a definition begins after a `;`
    "#);
}

#[test]
fn unbalanced_parentheses_and_bars() {
    insta::assert_snapshot!(messages("(x + 1"), @r#"
    error: `(` is never closed
     --> formula:1:1
      |
    1 | (x + 1
      | ^ opened here
    "#);
    insta::assert_snapshot!(messages("2*(x; y"), @r#"
    error: `(` is never closed
     --> formula:1:3
      |
    1 | 2*(x; y
      |   ^ opened here
    "#);
    insta::assert_snapshot!(messages("x + 1)"), @r#"
    error: `)` without `(`
     --> formula:1:6
      |
    1 | x + 1)
      |      ^ closes nothing
      |
      = help: leave it out, or write the `(` before its part
    "#);
    insta::assert_snapshot!(messages("sin (x"), @r#"
    error: `(` is never closed
     --> formula:1:5
      |
    1 | sin (x
      |     ^ opened here
    "#);
    insta::assert_snapshot!(messages("|x + 1"), @r#"
    error: `|` is never closed
     --> formula:1:1
      |
    1 | |x + 1
      | ^ opened here
      |
      = help: an absolute value may also be written `abs(x)`
    "#);
    insta::assert_snapshot!(messages("(|x)"), @r#"
    error: `|` is never closed
     --> formula:1:2
      |
    1 | (|x)
      |  ^ opened here
      |
      = help: an absolute value may also be written `abs(x)`
    "#);
    insta::assert_snapshot!(messages("|(x|)"), @r#"
    error: expected a value, found `)`
     --> formula:1:5
      |
    1 | |(x|)
      |     ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("min(x, (y)"), @r#"
    error: `(` is never closed
     --> formula:1:4
      |
    1 | min(x, (y)
      |    ^ opened here
    "#);
    insta::assert_snapshot!(messages("(x = 1)"), @r#"
    error: `=` inside of parentheses
     --> formula:1:4
      |
    1 | (x = 1)
      |    ^ not expected
      |
      = help: a comparison is written `==`
    "#);
}

#[test]
fn commas() {
    insta::assert_snapshot!(messages("1,5x"), @r#"
    error: `,` outside of a call
     --> formula:1:2
      |
    1 | 1,5x
      |  ^ not expected
      |
      = help: write a decimal point: `1.5`
    "#);
    insta::assert_snapshot!(messages("x, y"), @r#"
    error: `,` outside of a call
     --> formula:1:2
      |
    1 | x, y
      |  ^ not expected
      |
      = help: a definition ends with `;`, and arguments stand in parentheses: `min(a, b)`
    "#);
    insta::assert_snapshot!(messages("(x, y)"), @r#"
    error: `,` outside of a call
     --> formula:1:3
      |
    1 | (x, y)
      |   ^ not expected
      |
      = help: a definition ends with `;`, and arguments stand in parentheses: `min(a, b)`
    "#);
    insta::assert_snapshot!(messages("min(x,, y)"), @r#"
    error: expected a value, found `,`
     --> formula:1:7
      |
    1 | min(x,, y)
      |       ^ expected a number, a name or `(`
    "#);
    insta::assert_snapshot!(messages("min(x, )"), @r#"
    error: expected a value, found `)`
     --> formula:1:8
      |
    1 | min(x, )
      |        ^ expected a number, a name or `(`
    "#);
}

#[test]
fn conditions() {
    insta::assert_snapshot!(messages("x^2 + y^2 < 1"), @r#"
    error: the formula is a condition, not a function
     --> formula:1:1
      |
    1 | x^2 + y^2 < 1
      | ^^^^^^^^^^^^^ true or false
      |
      = help: for the solid where f < g, write `f - g`
    "#);
    insta::assert_snapshot!(messages("not x"), @r#"
    error: the formula is a condition, not a function
     --> formula:1:1
      |
    1 | not x
      | ^^^^^ true or false
      |
      = help: for the solid where f < g, write `f - g`
    "#);
    insta::assert_snapshot!(messages("x < 1 and y < 1"), @r#"
    error: the formula is a condition, not a function
     --> formula:1:1
      |
    1 | x < 1 and y < 1
      | ^^^^^^^^^^^^^^^ true or false
      |
      = help: for the solid where f < g, write `f - g`
    "#);
    insta::assert_snapshot!(messages("if(0 < x < 1, x, y)"), @r#"
    error: a chain of comparisons
     --> formula:1:10
      |
    1 | if(0 < x < 1, x, y)
      |          ^ a second comparison
      |
      = help: write `a < b and b < c`
    "#);
}

#[test]
fn equations() {
    insta::assert_snapshot!(messages("x = y = z"), @r#"
    error: a second `=` in one equation
     --> formula:1:7
      |
    1 | x = y = z
      |       ^ not expected
      |
      = help: an equation has two sides: `f = g`; a comparison is written `==`
    "#);
    insta::assert_snapshot!(messages("r = 1 = 2; x"), @r#"
    error: a second `=` in one equation
     --> formula:1:7
      |
    1 | r = 1 = 2; x
      |       ^ not expected
      |
      = help: an equation has two sides: `f = g`; a comparison is written `==`
    "#);
    insta::assert_snapshot!(messages("(x == 1"), @r#"
    error: `(` is never closed
     --> formula:1:1
      |
    1 | (x == 1
      | ^ opened here
    "#);
}

#[test]
fn texts_without_a_formula() {
    insta::assert_snapshot!(messages(""), @r#"
    error: there is no formula
     --> formula:1:1
      |
    1 |
      | ^ expected a formula
      |
      = help: write a function that is negative inside: `x^2 + y^2 + z^2 - 1`
    "#);
    insta::assert_snapshot!(messages("  # nothing"), @r#"
    error: there is no formula
     --> formula:1:1
      |
    1 |   # nothing
      | ^ expected a formula
      |
      = help: write a function that is negative inside: `x^2 + y^2 + z^2 - 1`
    "#);
    insta::assert_snapshot!(messages("r = 5;"), @r#"
    error: there is no formula
     --> formula:1:7
      |
    1 | r = 5;
      |       ^ expected a formula
      |
      = help: write a function that is negative inside: `x^2 + y^2 + z^2 - 1`
    "#);
    insta::assert_snapshot!(messages(";"), @r#"
    error: there is no formula
     --> formula:1:2
      |
    1 | ;
      |  ^ expected a formula
      |
      = help: write a function that is negative inside: `x^2 + y^2 + z^2 - 1`
    "#);
}

#[test]
fn second_formulas() {
    insta::assert_snapshot!(messages("x; y"), @r#"
    error: a second formula
     --> formula:1:4
      |
    1 | x; y
      |    ^ there is one already
      |
      = help: a text is one formula; join solids by `min(f, g)`
    "#);
    insta::assert_snapshot!(messages("x - 1\n; y = 1"), @r#"
    error: a second formula
     --> formula:2:3
      |
    2 | ; y = 1
      |   ^^^^^ there is one already
      |
      = help: a text is one formula; join solids by `min(f, g)`
    "#);
}

#[test]
fn several_errors() {
    insta::assert_snapshot!(messages("r = 5 +; x - r + sine(y) + q"), @r#"
    error: expected a value, found `;`
     --> formula:1:8
      |
    1 | r = 5 +; x - r + sine(y) + q
      |        ^ expected a number, a name or `(`

    error: unknown function `sine`
     --> formula:1:18
      |
    1 | r = 5 +; x - r + sine(y) + q
      |                  ^^^^ not defined
      |
      = help: did you mean `sin`?

    error: unknown name `q`
     --> formula:1:28
      |
    1 | r = 5 +; x - r + sine(y) + q
      |                            ^ not defined
      |
      = help: give it a value: `q = 1; …`
    "#);
    insta::assert_snapshot!(messages("a = (1; b = 2); foo(a) + $ + atan2(b)"), @r#"
    error: `(` is never closed
     --> formula:1:5
      |
    1 | a = (1; b = 2); foo(a) + $ + atan2(b)
      |     ^ opened here

    error: `)` without `(`
     --> formula:1:14
      |
    1 | a = (1; b = 2); foo(a) + $ + atan2(b)
      |              ^ closes nothing
      |
      = help: leave it out, or write the `(` before its part

    error: unknown function `foo`
     --> formula:1:17
      |
    1 | a = (1; b = 2); foo(a) + $ + atan2(b)
      |                 ^^^ not defined
      |
      = help: for a product write `foo*(…)`; functions cannot be defined

    error: unexpected character `$`
     --> formula:1:26
      |
    1 | a = (1; b = 2); foo(a) + $ + atan2(b)
      |                          ^ not part of a formula

    error: `atan2` takes 2 arguments, not 1
     --> formula:1:30
      |
    1 | a = (1; b = 2); foo(a) + $ + atan2(b)
      |                              ^^^^^ wrong number of arguments
      |
      = help: write `atan2(y, x)`
    "#);
}

#[test]
fn too_deep_nesting() {
    let text = format!("x +\n{}", "(".repeat(2_000));
    let errors = parse_formula(&Source::new("formula", text)).unwrap_err();
    let [error] = errors.list.as_slice() else { panic!("{errors}") };
    assert_eq!(
        (error.message.as_str(), error.span.clone()),
        ("more than 1000 parentheses inside one another", 1_004..1_005)
    );
    insta::assert_snapshot!(error.help.as_deref().unwrap_or_default(), @r#"
    give inner parts a name: `part = …;`
    "#);
}

#[test]
fn formulas_that_do_not_vary_are_read_with_a_warning() {
    insta::assert_snapshot!(warnings("r = 5; r^2 - 1 "), @r#"
    warning: the formula is the same everywhere
     --> formula:1:1
      |
    1 | r = 5; r^2 - 1 
      | ^^^^^^^^^^^^^^ depends on no coordinate
      |
      = help: a solid needs a function of x, y, z that is negative inside: `x^2 + y^2 + z^2 - 1`
    "#);
    assert_eq!(warnings("w"), "");
}

#[test]
fn a_name_is_reported_once() {
    assert_eq!(
        parse_formula(&Source::new("formula", "q + q + 2q - foo(x) - foo(x, y)")).unwrap_err().list.len(),
        2
    );
}

#[test]
fn no_more_than_a_screen_of_errors() {
    for text in
        ["$ x ".repeat(1_000), "a = (; ".repeat(1_000), (0..1_000).map(|i| format!("q{i} + ")).collect()]
    {
        let count = parse_formula(&Source::new("formula", text)).unwrap_err().list.len();
        assert_eq!(count, MAX_ERRORS);
    }
}
