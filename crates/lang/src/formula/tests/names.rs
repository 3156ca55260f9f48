//! What is told about names: unknown ones, functions, definitions.

use super::errors::messages;

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
fn names_of_patterns_and_blends_may_be_defined() {
    use super::value;
    assert_eq!(value("noise = 3; x + noise", &[1.0, 0.0, 0.0]), 4.0);
    assert_eq!(value("let wood = 2; wood*(x + 1)", &[1.0, 0.0, 0.0]), 4.0);
    // Where it is called it is the function.
    let plain = value("checker(x, y, z)", &[0.5, 0.5, 0.5]);
    assert_eq!(value("checker = 7; checker(x, y, z) + checker", &[0.5, 0.5, 0.5]), plain + 7.0);
    assert!(messages("sin = 3; x + sin").contains("cannot be defined"));
}
