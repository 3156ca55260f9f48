//! What is said of texts that are not formulas.

use crate::diagnostic::MAX_ERRORS;
use crate::{Source, parse_formula};

fn messages(text: &str) -> String {
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
fn unknown_names() {
    insta::assert_snapshot!(messages("x^2 - r"), @r#"
    error: unknown name `r`
     --> formula:1:7
      |
    1 | x^2 - r
      |       ^ not defined
      |
      = help: give it a value: `r = 1; …`
    "#);
    insta::assert_snapshot!(messages("r = 5"), @r#"
    error: unknown name `r`
     --> formula:1:1
      |
    1 | r = 5
      | ^ not defined
      |
      = help: to give `r` a value, write `;` after it, and then the formula: `r = 1; …`
    "#);
    insta::assert_snapshot!(messages("radus = 1; radius - x"), @r#"
    error: unknown name `radius`
     --> formula:1:12
      |
    1 | radus = 1; radius - x
      |            ^^^^^^ not defined
      |
      = help: did you mean `radus`? Otherwise give it a value: `radius = 1; …`
    "#);
    insta::assert_snapshot!(messages("radius = 1; x - radus"), @r#"
    error: unknown name `radus`
     --> formula:1:17
      |
    1 | radius = 1; x - radus
      |                 ^^^^^ not defined
      |
      = help: did you mean `radius`? Otherwise give it a value: `radus = 1; …`
    "#);
    insta::assert_snapshot!(messages("X + y"), @r#"
    error: unknown name `X`
     --> formula:1:1
      |
    1 | X + y
      | ^ not defined
      |
      = help: did you mean `x`? Otherwise give it a value: `X = 1; …`
    "#);
    insta::assert_snapshot!(messages("xy + 1"), @r#"
    error: unknown name `xy`
     --> formula:1:1
      |
    1 | xy + 1
      | ^^ not defined
      |
      = help: write `x*y`
    "#);
    insta::assert_snapshot!(messages("2xyz"), @r#"
    error: unknown name `xyz`
     --> formula:1:2
      |
    1 | 2xyz
      |  ^^^ not defined
      |
      = help: write `x*y*z`
    "#);
    insta::assert_snapshot!(messages("x2"), @r#"
    error: unknown name `x2`
     --> formula:1:1
      |
    1 | x2
      | ^^ not defined
      |
      = help: write `x^2` or `2*x`
    "#);
    insta::assert_snapshot!(messages("a = 1; ax"), @r#"
    error: unknown name `ax`
     --> formula:1:8
      |
    1 | a = 1; ax
      |        ^^ not defined
      |
      = help: write `a*x`
    "#);
    insta::assert_snapshot!(messages("x^2 - r; r = 5;"), @r#"
    error: unknown name `r`
     --> formula:1:7
      |
    1 | x^2 - r; r = 5;
      |       ^ not defined
      |
      = help: move the definition `r = …;` above its use
    "#);
    insta::assert_snapshot!(messages("x - foo1"), @r#"
    error: unknown name `foo1`
     --> formula:1:5
      |
    1 | x - foo1
      |     ^^^^ not defined
      |
      = help: give it a value: `foo1 = 1; …`
    "#);
    insta::assert_snapshot!(messages("Pi x"), @r#"
    error: unknown name `Pi`
     --> formula:1:1
      |
    1 | Pi x
      | ^^ not defined
      |
      = help: did you mean `pi`? Otherwise give it a value: `Pi = 1; …`
    "#);
}

#[test]
fn unknown_functions() {
    insta::assert_snapshot!(messages("sine(x)"), @r#"
    error: unknown function `sine`
     --> formula:1:1
      |
    1 | sine(x)
      | ^^^^ not defined
      |
      = help: did you mean `sin`?
    "#);
    insta::assert_snapshot!(messages("foo(x, y)"), @r#"
    error: unknown function `foo`
     --> formula:1:1
      |
    1 | foo(x, y)
      | ^^^ not defined
      |
      = help: for a product write `foo*(…)`; functions cannot be defined
    "#);
    insta::assert_snapshot!(messages("xy(x + 1)"), @r#"
    error: unknown function `xy`
     --> formula:1:1
      |
    1 | xy(x + 1)
      | ^^ not defined
      |
      = help: write `x*y`
    "#);
    insta::assert_snapshot!(messages("r(x + 1)"), @r#"
    error: unknown function `r`
     --> formula:1:1
      |
    1 | r(x + 1)
      | ^ not defined
      |
      = help: for a product write `r*(…)`; functions cannot be defined
    "#);
    insta::assert_snapshot!(messages("foo()"), @r#"
    error: unknown function `foo`
     --> formula:1:1
      |
    1 | foo()
      | ^^^ not defined
      |
      = help: for a product write `foo*(…)`; functions cannot be defined
    "#);
}

#[test]
fn functions_without_parentheses() {
    insta::assert_snapshot!(messages("sin x"), @r#"
    error: `sin` is a function
     --> formula:1:1
      |
    1 | sin x
      | ^^^ expected `(` after it
      |
      = help: write `sin(x)`
    "#);
    insta::assert_snapshot!(messages("sin^2(x)"), @r#"
    error: `sin` is a function
     --> formula:1:1
      |
    1 | sin^2(x)
      | ^^^ expected `(` after it
      |
      = help: a power of its value is written `sin(x)^2`
    "#);
    insta::assert_snapshot!(messages("sin²(x)"), @r#"
    error: `sin` is a function
     --> formula:1:1
      |
    1 | sin²(x)
      | ^^^ expected `(` after it
      |
      = help: a power of its value is written `sin(x)^2`
    "#);
    insta::assert_snapshot!(messages("min"), @r#"
    error: `min` is a function
     --> formula:1:1
      |
    1 | min
      | ^^^ expected `(` after it
      |
      = help: write `min(a, b, …)`
    "#);
    insta::assert_snapshot!(messages("if x"), @r#"
    error: `if` is a function
     --> formula:1:1
      |
    1 | if x
      | ^^ expected `(` after it
      |
      = help: write `if(condition, a, b)`
    "#);
}

#[test]
fn numbers_of_arguments() {
    insta::assert_snapshot!(messages("atan2(y)"), @r#"
    error: `atan2` takes 2 arguments, not 1
     --> formula:1:1
      |
    1 | atan2(y)
      | ^^^^^ wrong number of arguments
      |
      = help: write `atan2(y, x)`
    "#);
    insta::assert_snapshot!(messages("sin(x, y)"), @r#"
    error: `sin` takes 1 argument, not 2
     --> formula:1:1
      |
    1 | sin(x, y)
      | ^^^ wrong number of arguments
      |
      = help: write `sin(x)`
    "#);
    insta::assert_snapshot!(messages("sin()"), @r#"
    error: `sin` takes 1 argument, not 0
     --> formula:1:1
      |
    1 | sin()
      | ^^^ wrong number of arguments
      |
      = help: write `sin(x)`
    "#);
    insta::assert_snapshot!(messages("min(x)"), @r#"
    error: `min` takes at least 2 arguments, not 1
     --> formula:1:1
      |
    1 | min(x)
      | ^^^ wrong number of arguments
      |
      = help: write `min(a, b, …)`
    "#);
    insta::assert_snapshot!(messages("if(x < 1, x)"), @r#"
    error: `if` takes 3 arguments, not 2
     --> formula:1:1
      |
    1 | if(x < 1, x)
      | ^^ wrong number of arguments
      |
      = help: write `if(condition, a, b)`
    "#);
    insta::assert_snapshot!(messages("arctan2(1, 2, 3) + x"), @r#"
    error: `arctan2` takes 2 arguments, not 3
     --> formula:1:1
      |
    1 | arctan2(1, 2, 3) + x
      | ^^^^^^^ wrong number of arguments
      |
      = help: write `arctan2(y, x)`
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
fn definitions_of_what_has_a_meaning() {
    insta::assert_snapshot!(messages("x = 5;"), @r#"
    error: `x` is a coordinate and cannot be defined
     --> formula:1:1
      |
    1 | x = 5;
      | ^ a coordinate
      |
      = help: for the surface `x = …` leave out the `;`; otherwise choose another name
    "#);
    insta::assert_snapshot!(messages("w = 1; x"), @r#"
    error: `w` is a coordinate and cannot be defined
     --> formula:1:1
      |
    1 | w = 1; x
      | ^ a coordinate
      |
      = help: for the surface `w = …` leave out the `;`; otherwise choose another name
    "#);
    insta::assert_snapshot!(messages("t = 1; x"), @r#"
    error: `t` is the time and cannot be defined
     --> formula:1:1
      |
    1 | t = 1; x
      | ^ the time
      |
      = help: choose another name; the time is set when rendering
    "#);
    insta::assert_snapshot!(messages("pi = 3; x"), @r#"
    error: `pi` is a constant and cannot be defined
     --> formula:1:1
      |
    1 | pi = 3; x
      | ^^ a constant
      |
      = help: it is 3.14159; choose another name
    "#);
    insta::assert_snapshot!(messages("e = 2; x"), @r#"
    error: `e` is a constant and cannot be defined
     --> formula:1:1
      |
    1 | e = 2; x
      | ^ a constant
      |
      = help: it is 2.71828; choose another name
    "#);
    insta::assert_snapshot!(messages("sin = 1; x"), @r#"
    error: `sin` is a function and cannot be defined
     --> formula:1:1
      |
    1 | sin = 1; x
      | ^^^ a function
      |
      = help: choose another name
    "#);
    insta::assert_snapshot!(messages("r = 1; r = 2; x - r"), @r#"
    error: `r` is defined twice
     --> formula:1:8
      |
    1 | r = 1; r = 2; x - r
      |        ^ defined again
      |
      = help: choose another name, or leave out one of the definitions
    "#);
}

#[test]
fn broken_definitions() {
    insta::assert_snapshot!(messages("let r = 5"), @r#"
    error: expected `;`, found the end of the text
     --> formula:1:10
      |
    1 | let r = 5
      |          ^ expected `;`
      |
      = help: a definition is written `let name = value;`, and the formula after it
    "#);
    insta::assert_snapshot!(messages("let r 5; x"), @r#"
    error: expected `=`, found `5`
     --> formula:1:7
      |
    1 | let r 5; x
      |       ^ expected `=`
      |
      = help: a definition is written `let name = value;`
    "#);
    insta::assert_snapshot!(messages("let 5 = r; x"), @r#"
    error: expected a name, found `5`
     --> formula:1:5
      |
    1 | let 5 = r; x
      |     ^ expected a name
      |
      = help: a definition is written `let name = value;`
    "#);
    insta::assert_snapshot!(messages("let"), @r#"
    error: expected a name, found the end of the text
     --> formula:1:4
      |
    1 | let
      |    ^ expected a name
      |
      = help: a definition is written `let name = value;`
    "#);
    insta::assert_snapshot!(messages("let x + 1"), @r#"
    error: expected `=`, found `+`
     --> formula:1:7
      |
    1 | let x + 1
      |       ^ expected `=`
      |
      = help: a definition is written `let name = value;`
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
