//! Who may know whom: the edges between the crates, read from `cargo metadata`.

use serde_json::Value;
use std::process::Command;

/// The allowed edges. Whoever is not named knows nobody.
const ALLOWED: [(&str, &[&str]); 11] = [
    ("fieldstone-solids", &["fieldstone-field"]),
    ("fieldstone-lang", &["fieldstone-field", "fieldstone-solids"]),
    ("fieldstone-trace", &["fieldstone-field"]),
    ("fieldstone-space", &["fieldstone-trace", "fieldstone-field"]),
    ("fieldstone-scene", &["fieldstone-field", "fieldstone-texel"]),
    (
        "fieldstone-render",
        &["fieldstone-scene", "fieldstone-space", "fieldstone-trace", "fieldstone-field", "fieldstone-texel"],
    ),
    ("fieldstone-gpu", &["fieldstone-scene", "fieldstone-space", "fieldstone-field", "fieldstone-texel"]),
    (
        "fieldstone",
        &[
            "fieldstone-field",
            "fieldstone-texel",
            "fieldstone-lang",
            "fieldstone-trace",
            "fieldstone-space",
            "fieldstone-scene",
            "fieldstone-solids",
            "fieldstone-render",
            "fieldstone-gpu",
        ],
    ),
    ("fieldstone-bench", &["fieldstone", "fieldstone-field"]),
    ("fieldstone-cli", &["fieldstone", "fieldstone-bench"]),
    ("fieldstone-viewer", &["fieldstone"]),
];

/// The edges of the workspace, those of tests apart: who knows whom.
fn edges(metadata: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().expect("a name").to_owned();
    let list = |value: &Value| value.as_array().expect("a list").clone();
    let packages = list(&metadata["packages"]);
    let ours: Vec<String> = packages.iter().map(|package| text(&package["name"])).collect();
    let mut edges = Vec::new();
    for package in &packages {
        for dependency in list(&package["dependencies"]) {
            let to = text(&dependency["name"]);
            if dependency["kind"] != "dev" && ours.contains(&to) {
                edges.push((text(&package["name"]), to));
            }
        }
    }
    edges
}

fn forbidden(edges: &[(String, String)]) -> Vec<String> {
    let is_allowed = |from: &str, to: &str| ALLOWED.iter().any(|(f, list)| *f == from && list.contains(&to));
    edges
        .iter()
        .filter(|(from, to)| !is_allowed(from, to))
        .map(|(from, to)| format!("{from} -> {to}"))
        .collect()
}

#[test]
fn crates_know_only_whom_they_may() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let edges = edges(&metadata);
    // If nothing was found, nothing was checked.
    let cli = ("fieldstone-cli".to_owned(), "fieldstone".to_owned());
    assert!(edges.len() >= 8 && edges.contains(&cli), "{edges:?}");
    assert_eq!(forbidden(&edges), [""; 0]);
}

#[test]
fn a_forbidden_edge_is_seen() {
    let metadata: Value = serde_json::from_str(
        r#"{"packages": [
            {"name": "fieldstone-field", "dependencies": [
                {"name": "fieldstone-scene", "kind": null},
                {"name": "fieldstone-lang", "kind": "dev"},
                {"name": "rayon", "kind": null}]},
            {"name": "fieldstone-scene", "dependencies": [{"name": "fieldstone-field", "kind": null}]},
            {"name": "fieldstone-lang", "dependencies": [{"name": "fieldstone-scene", "kind": "build"}]}
        ]}"#,
    )
    .expect("JSON");
    let found = forbidden(&edges(&metadata));
    assert_eq!(found, ["fieldstone-field -> fieldstone-scene", "fieldstone-lang -> fieldstone-scene"]);
}
