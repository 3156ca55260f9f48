//! The schema, the documents and the program agree about the keys.

use crate::document;
use serde_json::Value;
use std::collections::BTreeSet;

const DOCUMENTS: &str = include_str!("../../../../docs/scenes.md");
const EVERYTHING: &str = include_str!("everything.toml");

/// The TOML examples of the documents.
fn examples() -> Vec<&'static str> {
    let blocks = DOCUMENTS.split("```toml\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap()).collect()
}

fn json(toml: &str) -> Value {
    fn value(item: &toml::Value) -> Value {
        match item {
            toml::Value::String(text) => text.as_str().into(),
            toml::Value::Integer(number) => (*number).into(),
            toml::Value::Float(number) => (*number).into(),
            toml::Value::Boolean(flag) => (*flag).into(),
            toml::Value::Array(list) => list.iter().map(value).collect(),
            toml::Value::Table(table) => table.iter().map(|(k, v)| (k.clone(), value(v))).collect(),
            toml::Value::Datetime(_) => Value::Null,
        }
    }
    value(&toml::Value::Table(toml.parse().unwrap()))
}

/// The names of all keys in a schema.
fn keys(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                found.extend(properties.keys().cloned());
            }
            object.values().for_each(|inner| keys(inner, found));
        }
        Value::Array(list) => list.iter().for_each(|inner| keys(inner, found)),
        _ => {}
    }
}

fn all_keys() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    keys(&fieldstone::scene_schema(), &mut found);
    // Another spelling.
    found.remove("color");
    assert!(found.len() > 90, "{}", found.len());
    found
}

fn names(text: &str, key: &str) -> bool {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    text.split(|c| !is_letter(c)).any(|word| word == key)
}

#[test]
fn every_key_is_documented() {
    let missing: Vec<String> = all_keys().into_iter().filter(|key| !names(DOCUMENTS, key)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert!(!names(DOCUMENTS, "no_such_key"));
}

#[test]
fn every_key_is_in_the_scene_that_has_everything() {
    let missing: Vec<String> = all_keys().into_iter().filter(|key| !names(EVERYTHING, key)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn the_examples_of_the_documents_are_scenes() {
    assert!(examples().len() >= 10);
    for example in examples() {
        document(example).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn scenes_satisfy_the_schema() {
    let validator = jsonschema::validator_for(&fieldstone::scene_schema()).unwrap();
    for text in examples().into_iter().chain([EVERYTHING]) {
        let errors: Vec<String> = validator.iter_errors(&json(text)).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}\n{text}");
    }
    for wrong in [
        "[render]\nsamples = 0",
        "[rendre]\nsize = [1, 1]",
        "[camera]\neye = [1, 2]",
        "[solids.a]\nunion = []",
        "[materials.a]\nmodel = \"wool\"",
        "[[lights]]\nkind = 3",
    ] {
        assert!(!validator.is_valid(&json(wrong)), "{wrong}");
        assert!(document(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn the_scenes_of_the_gallery_are_scenes() {
    let validator = jsonschema::validator_for(&fieldstone::scene_schema()).unwrap();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(validator.is_valid(&json(&text)), "{}", path.display());
            let document = fieldstone::Document::load(&path, &fieldstone::FileAccess::default()).unwrap();
            assert_eq!(document.resolve(&fieldstone::SceneRequest::default()).unwrap().messages, [""; 0]);
            count += 1;
        }
    }
    assert!(count >= 3);
}
