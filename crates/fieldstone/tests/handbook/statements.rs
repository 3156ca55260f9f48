//! What the handbook states about values: lines `-- value at (0, 0, 0): 1` and `-- attributes at (0, 0, 0): 1 0 0` in
//! examples, and fenced blocks `values` and `conditions` with lines `3 | 4 → 12` or, where the strict dialect says
//! something else, `sign(-3) → -1 / 1`; what a dialect does not read is `refused`.

use crate::blocks::{Example, all, examples, folder, read};
use fieldstone::{Dialect, Evaluator, Inputs, hyperfun_functions};

/// Whether numbers are the same to six digits.
fn agree(expected: &[f64], found: &[f64]) -> bool {
    let close = |(e, f): (&f64, &f64)| (e - f).abs() <= 1e-6 * e.abs().max(1.0) || (e.is_nan() && f.is_nan());
    expected.len() == found.len() && expected.iter().zip(found).all(close)
}

fn number(word: &str) -> f64 {
    let word = word.trim();
    if word == "undefined" { f64::NAN } else { word.parse().unwrap_or_else(|_| panic!("no number: {word}")) }
}

/// A line of an example that states something: about the attributes or the value, at a point.
fn statement(line: &str) -> Option<(bool, Vec<f64>, Vec<f64>)> {
    let line = line.trim();
    let (rest, about_attributes) = match line.strip_prefix("-- value at (") {
        Some(rest) => (rest, false),
        None => (line.strip_prefix("-- attributes at (")?, true),
    };
    let (point, expected) = rest.split_once("):")?;
    let expected = expected.split_whitespace().map(number).collect();
    Some((about_attributes, point.split(',').map(number).collect(), expected))
}

/// What does not hold of what an example states, and how much it states.
fn wrong_statements(example: &Example, dialect: Dialect) -> (Vec<String>, usize) {
    let inputs = Inputs { coordinates: Vec::new(), ..example.request(8).unwrap().inputs };
    let model = example.load(dialect).unwrap().model;
    let mut evaluator = Evaluator::new(&model, &inputs).unwrap();
    let (mut wrong, mut count) = (Vec::new(), 0);
    for (about_attributes, point, expected) in example.text.lines().filter_map(statement) {
        let mut found = Vec::new();
        evaluator.evaluate(&point, &mut found);
        let found = if about_attributes { &found[1..] } else { &found[..1] };
        count += 1;
        if !agree(&expected, found) {
            wrong.push(format!("{} {}: at {point:?}: {found:?}", example.place, example.name));
        }
    }
    (wrong, count)
}

#[test]
fn what_examples_state_holds() {
    let mut faults = Vec::new();
    for example in all().unwrap() {
        let (wrong, count) = wrong_statements(&example, Dialect::Lenient);
        faults.extend(wrong);
        if count == 0 {
            faults.push(format!("{} {}: states nothing", example.place, example.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Examples with values that only the lenient dialect has.
const OTHER_VALUES: [&str; 3] = ["hfA_Cerp", "hfA_Circles", "hfA_Crackles"];

/// Examples that only the lenient dialect reads.
const REFUSED: [&str; 4] = ["hfCylX", "hfFMapBlob", "Menger", "Berry"];

#[test]
fn the_same_holds_in_the_strict_dialect_where_nothing_else_is_said() {
    let mut faults = Vec::new();
    for example in all().unwrap() {
        let name = example.name.as_str();
        if REFUSED.contains(&name) {
            assert!(example.load(Dialect::Strict).is_err(), "{name} is read");
        } else if !OTHER_VALUES.contains(&name) {
            faults.extend(wrong_statements(&example, Dialect::Strict).0);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn wrong_statements_are_noticed() {
    let page = "```hyperfun A\nmy_model(x[3], a[1], s[2])\n{\n-- value at (1, 0, 0): 1\n-- value at (1, 0, 0): 1.00001\n\
                -- attributes at (1, 0, 0): 5 0\n-- attributes at (1, 0, 0): 5\n-- value at (0, 0, 0): undefined\n\
                s[1] = 5; my_model = x[1]; }\n```\n";
    let (wrong, count) = wrong_statements(&examples("page", page).unwrap()[0], Dialect::Lenient);
    assert_eq!((wrong.len(), count), (3, 5), "{wrong:?}");
}

/// The lines of the blocks of a kind in the reference: what stands on the left, and the two dialects' answers.
pub(crate) fn lines(kind: &str) -> Vec<(String, [String; 2])> {
    let text = std::fs::read_to_string(folder().join("hyperfun.md")).unwrap();
    let opening = format!("```{kind}\n");
    let blocks = text.split(&opening).skip(1).map(|rest| rest.split("```").next().unwrap());
    blocks
        .flat_map(str::lines)
        .map(|line| {
            let (left, right) = line.split_once(" → ").unwrap_or_else(|| panic!("no arrow: {line}"));
            let (lenient, strict) = right.split_once(" / ").unwrap_or((right, right));
            (left.to_owned(), [lenient.to_owned(), strict.to_owned()])
        })
        .collect()
}

/// The value of an object with a body; `None` if it is not read.
fn value(body: &str, dialect: Dialect) -> Option<f64> {
    let text = format!("my_model(x[3], a[1])\n{{\n{body}\n}}\n");
    let loaded = read(&text, dialect).ok()?;
    let mut evaluator = Evaluator::new(&loaded.model, &Inputs::default()).unwrap();
    let mut found = Vec::new();
    evaluator.evaluate(&[0.7, -0.4, 1.3], &mut found);
    Some(found[0])
}

/// The value that a line states; `None` if the text is refused.
fn answer(word: &str) -> Option<f64> {
    match word {
        "refused" => None,
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ => Some(number(word)),
    }
}

/// The lines of a kind that do not hold, where `body` makes an object of what stands on the left.
fn wrong_lines(lines: &[(String, [String; 2])], body: fn(&str) -> String) -> Vec<String> {
    let mut wrong = Vec::new();
    for (left, answers) in lines {
        for (dialect, expected) in [Dialect::Lenient, Dialect::Strict].into_iter().zip(answers) {
            let (expected, found) = (answer(expected), value(&body(left), dialect));
            if !agree(expected.as_slice(), found.as_slice()) {
                wrong.push(format!("{left} in {dialect:?}: {found:?}"));
            }
        }
    }
    wrong
}

fn assignment(expression: &str) -> String {
    format!("my_model = {expression};")
}

fn choice(condition: &str) -> String {
    format!("if {condition} then f = 1; else f = 0; endif; my_model = f;")
}

#[test]
fn the_values_of_the_reference_hold() {
    let lines = lines("values");
    assert!(lines.len() > 45, "only {} values found", lines.len());
    assert_eq!(wrong_lines(&lines, assignment), Vec::<String>::new());
}

#[test]
fn the_conditions_of_the_reference_hold() {
    let lines = lines("conditions");
    assert!(lines.len() > 9, "only {} conditions found", lines.len());
    assert_eq!(wrong_lines(&lines, choice), Vec::<String>::new());
}

#[test]
fn wrong_lines_are_noticed() {
    let line = |left: &str, lenient: &str, strict: &str| (left.to_owned(), [lenient.into(), strict.into()]);
    let lines = [
        line("1 + 1", "2", "3"),
        line("01", "1", "1"),
        line("01", "refused", "refused"),
        line("0/0", "undefined", "0"),
    ];
    assert_eq!(wrong_lines(&lines, assignment).len(), 4);
    assert_eq!(wrong_lines(&[line("1 > 2", "true", "false")], choice).len(), 1);
    assert_eq!(wrong_lines(&[line("01", "1", "refused")], assignment).len(), 0);
}

#[test]
fn every_function_of_the_language_is_described_and_has_a_value() {
    let text = std::fs::read_to_string(folder().join("hyperfun.md")).unwrap();
    let section = text.split("## Functions").nth(1).unwrap().split("## ").next().unwrap();
    let table: String = section.lines().filter(|line| line.starts_with("| `")).collect();
    let values = lines("values");
    for function in hyperfun_functions().into_iter().filter(|function| !function.is_library) {
        let call = format!("{}(", function.name);
        assert!(table.contains(&format!("`{call}")), "{} is not described", function.name);
        assert!(values.iter().any(|(e, _)| e.starts_with(&call)), "{} has no value", function.name);
    }
}

/// The words in backquotes of a row of the reference.
fn row(item: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder().join("hyperfun.md")).unwrap();
    let rest = text.split(&format!("| {item} | `")).nth(1).unwrap_or_else(|| panic!("no row {item}"));
    rest.split('`').next().unwrap().replace("\\|", "|").split(' ').map(str::to_owned).collect()
}

#[test]
fn reserved_words_are_reserved_and_others_are_not() {
    let words = row("reserved");
    assert_eq!(words.len(), 15);
    let is_free = |name: &str| {
        read(&format!("my_model(x[3], a[1]) {{ {name} = 1; my_model = 1; }}"), Dialect::Lenient).is_ok()
    };
    let functions = hyperfun_functions();
    for word in words.iter().map(String::as_str).chain(functions.iter().map(|function| function.name)) {
        assert!(!is_free(word), "{word} can be assigned");
    }
    assert!(is_free("pi") && is_free("hfthing"));
}

#[test]
fn the_operators_of_the_reference_are_all_there() {
    let words = row("operators");
    assert_eq!(words.len(), 16);
    for word in words {
        let body = match word.as_str() {
            "=" | "/=" | "<" | "<=" | ">" | ">=" => {
                format!("if x[1] {word} 2 then f = 1; else f = 2; endif; my_model = f;")
            }
            "~" => "my_model = ~x[1];".to_owned(),
            _ => format!("my_model = x[1] {word} 2;"),
        };
        assert!(value(&body, Dialect::Lenient).is_some_and(f64::is_finite), "{word}");
    }
}
