//! The table of conformance: a row for every function, and every test it names exists.

use crate::blocks::{all, folder};
use crate::statements::lines;
use fieldstone::hyperfun_functions;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What the names in the column of tests may refer to.
struct Known {
    golden: BTreeSet<String>,
    vectors: BTreeSet<String>,
    values: BTreeSet<String>,
    conditions: BTreeSet<String>,
    examples: BTreeSet<String>,
    tests: BTreeSet<String>,
}

fn lang() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../lang")
}

fn sources(folder: &Path, found: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

/// The names of the functions under `#[test]`.
fn test_names(text: &str) -> BTreeSet<String> {
    let marked = text.split("#[test]\n").skip(1);
    let names = marked.filter_map(|rest| rest.trim_start().strip_prefix("fn ")?.split('(').next());
    names.map(str::to_owned).collect()
}

impl Known {
    fn new() -> Self {
        let golden = std::fs::read_dir(lang().join("tests/golden")).unwrap();
        let golden = golden.filter_map(|entry| {
            let name = entry.unwrap().file_name().into_string().unwrap();
            name.strip_suffix(".hf").map(str::to_owned)
        });
        let vectors = std::fs::read_to_string(lang().join("src/hyperfun/library/tests/vectors.txt")).unwrap();
        let vectors =
            vectors.lines().map(|l| l.split_whitespace().nth(1).unwrap().split('(').next().unwrap().into());
        let mut text = String::new();
        sources(&lang(), &mut text);
        Self {
            golden: golden.collect(),
            vectors: vectors.collect(),
            values: lines("values").into_iter().map(|(left, _)| left).collect(),
            conditions: lines("conditions").into_iter().map(|(left, _)| left).collect(),
            examples: all().unwrap().into_iter().map(|example| example.name).collect(),
            tests: test_names(&text),
        }
    }

    /// Whether `kind name` refers to something that exists.
    fn has(&self, reference: &str) -> bool {
        let Some((kind, name)) = reference.split_once(' ') else { return false };
        let names = match kind {
            "golden" => &self.golden,
            "vector" => &self.vectors,
            "values" => &self.values,
            "conditions" => &self.conditions,
            "example" => &self.examples,
            "test" => &self.tests,
            _ => return false,
        };
        names.contains(name)
    }
}

/// The rows of the tables with tests: the cells.
fn rows(text: &str) -> Vec<Vec<String>> {
    const ESCAPED: char = '\u{1}';
    let text = text.replace("\\|", &ESCAPED.to_string());
    let cells = |line: &str| {
        let cells = line.trim_matches('|').split('|').map(|cell| cell.trim().replace(ESCAPED, "|"));
        cells.collect::<Vec<String>>()
    };
    let rows = text.lines().filter(|line| line.starts_with("| ")).map(cells);
    rows.filter(|row| row.len() == 5 && row[0] != "what").collect()
}

fn table() -> Vec<Vec<String>> {
    rows(&std::fs::read_to_string(folder().join("conformance.md")).unwrap())
}

/// What a row refers to that does not exist; a row must refer to something. Commas part the tests, except in the
/// parentheses of expressions.
fn missing(row: &[String], known: &Known) -> Vec<String> {
    let mut references: Vec<String> = Vec::new();
    for part in row[4].split(", ") {
        match references.last_mut() {
            Some(last) if last.matches('(').count() > last.matches(')').count() => {
                *last += &format!(", {part}")
            }
            _ => references.push(part.to_owned()),
        }
    }
    references.retain(|reference| !known.has(reference));
    references
}

#[test]
fn every_row_is_backed_by_a_test() {
    let known = Known::new();
    let faults: Vec<String> = table()
        .iter()
        .flat_map(|row| missing(row, &known).into_iter().map(|m| format!("{}: {m}", row[0])))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn rows_without_a_test_are_noticed() {
    let known = Known::new();
    let row = |tests: &str| rows(&format!("| `a \\| b` | works | works | | {tests} |")).remove(0);
    assert_eq!(row("x")[0], "`a | b`");
    assert_eq!(missing(&row("golden sphere, values atan2(1, 0), test names"), &known), Vec::<String>::new());
    for tests in ["", "golden no", "test no", "vector hfNo", "values 1", "sphere", "example No"] {
        assert_eq!(missing(&row(tests), &known), [tests]);
    }
}

#[test]
fn every_function_has_one_row() {
    let mut listed: Vec<String> = table().iter().map(|row| row[0].trim_matches('`').to_lowercase()).collect();
    listed.sort();
    for function in hyperfun_functions() {
        let count = listed.iter().filter(|name| *name == function.name).count();
        assert_eq!(count, 1, "{} has {count} rows", function.name);
    }
    let known: Vec<&str> = hyperfun_functions().iter().map(|function| function.name).collect();
    let stale = listed.iter().find(|name| name.starts_with("hf") && !known.contains(&name.as_str()));
    assert_eq!(stale, None);
}
