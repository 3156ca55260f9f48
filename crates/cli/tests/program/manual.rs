//! Help, manual pages and completions.

use crate::place::Place;

const COMMANDS: [&str; 11] = [
    "bench",
    "render",
    "eval",
    "check",
    "measure",
    "plot",
    "texel",
    "convert",
    "schema",
    "completions",
    "man",
];

#[test]
fn the_help_of_every_command_teaches_by_examples() {
    let place = Place::new();
    for command in COMMANDS {
        let run = place.run(&[command, "--help"], "");
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        let (_, examples) = run.out.split_once("Examples:").unwrap();
        assert!(examples.contains(&format!("fieldstone {command}")), "{command}: {examples}");
    }
    let render = place.run(&["render", "--help"], "").out;
    for heading in ["Model:", "View:", "Method:", "Output:"] {
        assert!(render.lines().any(|line| line == heading), "{heading}");
    }
}

#[test]
fn there_is_a_manual_page_for_every_command() {
    let place = Place::new();
    let run = place.run(&["man", "."], "");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
    let mut names: Vec<String> = COMMANDS.iter().map(|command| format!("fieldstone-{command}.1")).collect();
    names.push("fieldstone.1".to_owned());
    names.extend(["build", "info", "compare", "slice"].map(|part| format!("fieldstone-texel-{part}.1")));
    names.sort();
    assert_eq!(place.files(), names);
    let page = std::fs::read_to_string(place.path("fieldstone-render.1")).unwrap();
    for text in [".TH", "Draw a model", "accept\\-epsilon", "Examples:"] {
        assert!(page.contains(text), "{text}: {page}");
    }
    let page = std::fs::read_to_string(place.path("fieldstone-texel-compare.1")).unwrap();
    assert!(page.contains("fieldstone texel compare") && page.contains("\\-\\-sun"), "{page}");
    assert_eq!(place.run(&["man", "no"], "").code, 1);
}

#[test]
fn completions_know_the_options() {
    let place = Place::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let run = place.run(&["completions", shell], "");
        assert_eq!((run.code, run.err.as_str()), (0, ""));
        // Options of commands, and of their commands.
        assert!(run.out.contains("accept-epsilon") && run.out.contains("filter"), "{shell}");
        assert!(run.out.contains("recipe"), "{shell}");
    }
    assert_eq!(place.run(&["completions", "tcsh"], "").code, 2);
}
