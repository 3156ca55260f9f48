//! The links of all documents lead to files that exist, and to headings that are in them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// All documents of the repository but those under `target` and hidden folders.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "target" && !name.starts_with('.') {
                documents(&path, found);
            }
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The lines outside of fenced blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_block = false;
    text.lines().filter(move |line| {
        let is_fence = line.starts_with("```");
        in_block ^= is_fence;
        !in_block && !is_fence
    })
}

/// The targets of the links and images of a document.
fn targets(text: &str) -> Vec<String> {
    let links = prose(text).flat_map(|line| line.split("](").skip(1));
    links.filter_map(|rest| rest.split(')').next()).map(str::to_owned).collect()
}

/// The anchors of the headings of a document, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#'));
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headings
        .map(|heading| {
            let title = heading.trim_start_matches('#').trim().to_lowercase();
            title.chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

/// The links of a document that lead nowhere.
fn dead(document: &Path, text: &str) -> Vec<String> {
    let leads = |target: &str| {
        if target.starts_with("http://") || target.starts_with("https://") {
            return true;
        }
        let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
        let path = if file.is_empty() { document.to_owned() } else { document.parent().unwrap().join(file) };
        match std::fs::read_to_string(&path) {
            _ if anchor.is_empty() => path.exists(),
            Ok(text) => anchors(&text).contains(anchor),
            Err(_) => false,
        }
    };
    targets(text).into_iter().filter(|target| !leads(target)).collect()
}

#[test]
fn every_link_leads_somewhere() {
    let mut found = Vec::new();
    documents(&root(), &mut found);
    assert!(found.len() > 12, "only {} documents found", found.len());
    let mut faults = Vec::new();
    for document in &found {
        let text = std::fs::read_to_string(document).unwrap();
        faults
            .extend(dead(document, &text).into_iter().map(|link| format!("{}: {link}", document.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn dead_links_are_noticed() {
    let text = "[a](no.md) [b](README.md) ![c](README.md#times) [d](README.md#no) [e](https://example.org/)\n\
                [f](#g-h) [i](#j)\n```\n[k](no.md)\n```\n## G h\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("README.md"), "# A\n## Times\n").unwrap();
    let document = folder.path().join("page.md");
    std::fs::write(&document, text).unwrap();
    assert_eq!(dead(&document, text), ["no.md", "README.md#no", "#j"]);
}
