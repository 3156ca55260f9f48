//! The examples: found, read, solid, and one for every function.

use crate::blocks::{Example, PAGES, all, examples, folder};
use fieldstone::{Dialect, RenderOptions, hyperfun_functions, render};
use std::collections::BTreeSet;

/// What is wrong with an example.
fn fault(example: &Example) -> Option<String> {
    let checked = || {
        let loaded = example.load(Dialect::Lenient)?;
        let resolved = example.request(24)?.resolve(&loaded.model).map_err(|e| e.to_string())?;
        if let Some(warning) = resolved.warnings.first() {
            return Err(warning.to_string());
        }
        let stats = render(&resolved.scene, &RenderOptions::default()).map_err(|e| e.to_string())?.stats;
        match (stats.hits, stats.undecided) {
            (0..20, _) => Err(format!("only {} of 576 rays hit", stats.hits)),
            // Fuel may run out at a few.
            (_, 6..) => Err(format!("{} rays are undecided", stats.undecided)),
            _ => Ok(()),
        }
    };
    checked().err().map(|fault| format!("{} {}: {fault}", example.place, example.name))
}

#[test]
fn every_example_is_a_solid() {
    let faults: Vec<String> = all().unwrap().iter().filter_map(fault).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn one(block: &str) -> Example {
    examples("page", block).unwrap().remove(0)
}

#[test]
fn what_is_no_solid_is_noticed() {
    let model = |value: &str| format!("```hyperfun A\nmy_model(x[3], a[1]) {{ my_model = {value}; }}\n```\n");
    assert_eq!(fault(&one(&model("1 - x[1]^2 - x[2]^2 - x[3]^2"))), None);
    for (value, part) in [
        ("-1 - x[1]^2", "no solid"),
        ("sqrt(-1 - x[1]^2)", "no value anywhere"),
        ("0", "0 everywhere"),
        ("x[1]", "no end"),
        ("x[1", "error"),
    ] {
        let fault = fault(&one(&model(value))).unwrap();
        assert!(fault.contains(part), "{value}: {fault}");
    }
}

#[test]
fn blocks_are_found_with_their_options() {
    let page =
        "text\n```text\nno\n```\n```hyperfun A eye=1,2,3 param=a[1]:2\none\ntwo\n```\n\n```hyperfun B\n```\n";
    let found = examples("page", page).unwrap();
    let seen: Vec<_> = found.iter().map(|e| (e.place.as_str(), e.name.as_str(), e.text.as_str())).collect();
    assert_eq!(seen, [("page:5", "A", "one\ntwo\n"), ("page:10", "B", "")]);
    let request = found[0].request(8).unwrap();
    assert_eq!(request.view.eye.unwrap().to_array(), [1.0, 2.0, 3.0]);
    assert_eq!(request.inputs.parameters, [("a[1]".to_owned(), 2.0)]);
}

#[test]
fn blocks_that_are_wrong_are_errors() {
    for page in
        ["```hyperfun\n```\n", "```hyperfun A\n", "```hyperfun A eye\n```\n", "```hyperfun A\n```text\n```\n"]
    {
        assert!(examples("page", page).is_err(), "{page}");
    }
    for option in ["eye=1,2", "eyes=1,2,3", "bounds=1,0,0,0,1,1", "param=a[1]=2", "coord=w:1"] {
        assert!(one(&format!("```hyperfun A {option}\n```\n")).request(8).is_err(), "{option}");
    }
}

#[test]
fn names_are_given_once() {
    let all = all().unwrap();
    assert!(all.len() > 95, "only {} examples found", all.len());
    let names: BTreeSet<String> = all.iter().map(Example::picture).collect();
    assert_eq!(names.len(), all.len());
}

#[test]
fn no_page_is_left_out() {
    let mut pages = vec!["hyperfun.md".to_owned()];
    for entry in std::fs::read_dir(folder().join("hyperfun")).unwrap() {
        pages.push(format!("hyperfun/{}", entry.unwrap().file_name().into_string().unwrap()));
    }
    pages.sort();
    let mut known = PAGES.to_vec();
    known.sort_unstable();
    assert_eq!(pages, known);
}

/// The signatures in the headings of the pages, which are those with a parenthesis: names and parameters in lower case.
fn described() -> BTreeSet<(String, Vec<String>)> {
    let texts = PAGES.map(|page| std::fs::read_to_string(folder().join(page)).unwrap());
    let headings = texts.iter().flat_map(|text| text.lines()).filter_map(|line| line.strip_prefix("### "));
    let signatures = headings.filter(|heading| heading.contains('(')).flat_map(|h| h.split_inclusive(')'));
    signatures
        .map(|signature| {
            let (name, rest) = signature.trim_start_matches([',', ' ']).split_once('(').unwrap();
            let parameters = rest.trim_end_matches(')').split(',').map(|word| word.trim().to_lowercase());
            (name.to_lowercase(), parameters.collect())
        })
        .collect()
}

#[test]
fn every_function_of_the_library_is_described() {
    let library = hyperfun_functions().into_iter().filter(|function| function.is_library);
    let expected: BTreeSet<(String, Vec<String>)> = library
        .map(|f| (f.name.to_owned(), f.parameters.iter().map(|(name, _)| (*name).to_owned()).collect()))
        .collect();
    assert!(expected.len() > 80);
    assert_eq!(described(), expected);
}

#[test]
fn every_function_of_the_library_has_an_example_and_a_place_in_the_list() {
    let texts: String = all().unwrap().iter().map(|example| example.text.to_lowercase()).collect();
    let reference = std::fs::read_to_string(folder().join("hyperfun.md")).unwrap();
    let list = reference.split("## Library").nth(1).unwrap().to_lowercase();
    for function in hyperfun_functions().into_iter().filter(|function| function.is_library) {
        assert!(texts.contains(&format!("{}(", function.name)), "no example calls {}", function.name);
        assert!(list.contains(&format!("[{}](", function.name)), "{} is not in the list", function.name);
    }
}
