//! What of a document is used by what.

use super::Document;
use super::tree::{Entry, Kind, Table, Value};
use std::collections::HashSet;

impl Document {
    /// The solids that no other solid uses, in the order of the text.
    pub(super) fn loose_solids(&self) -> Vec<&Entry> {
        let solids = self.root.entries_of("solids");
        let mut names = Vec::new();
        solids.iter().for_each(|entry| collect_names(&entry.value, &mut names));
        let used: HashSet<&str> = names.into_iter().collect();
        solids.iter().filter(|entry| !used.contains(entry.key.as_str())).collect()
    }

    /// Adds the names of all solids that a solid is composed of, directly or through others.
    pub(super) fn reach<'d>(&'d self, solid: &'d Value, reached: &mut HashSet<&'d str>) {
        let mut names = Vec::new();
        collect_names(solid, &mut names);
        while let Some(name) = names.pop() {
            if let (true, Some(entry)) = (reached.insert(name), self.entry("solids", name)) {
                collect_names(&entry.value, &mut names);
            }
        }
    }

    /// What nothing uses, such as "the material `gold`", in the order of the text. A parameter or field is used if any
    /// formula has its name, a solid if an object is composed of it, a material if a solid or an object names it.
    pub fn unused(&self) -> Vec<String> {
        let (mut words, mut materials) = (HashSet::new(), HashSet::new());
        collect_texts(&self.root, &mut words, &mut materials);
        let mut drawn = HashSet::new();
        match self.root.get("objects").and_then(Value::list) {
            Some(objects) => {
                for solid in objects.iter().filter_map(|object| object.table()?.get("solid")) {
                    drawn.extend(solid.text());
                    solid.text().and_then(|name| self.entry("solids", name)).into_iter().for_each(|entry| {
                        self.reach(&entry.value, &mut drawn);
                    });
                    self.reach(solid, &mut drawn);
                }
            }
            None => {
                for entry in self.loose_solids() {
                    drawn.insert(&entry.key);
                    self.reach(&entry.value, &mut drawn);
                }
            }
        }
        let tables = [
            ("parameters", "parameter", &words),
            ("fields", "field", &words),
            ("solids", "solid", &drawn),
            ("materials", "material", &materials),
        ];
        let mut unused = Vec::new();
        for (table, what, used) in tables {
            let left = self.root.entries_of(table).iter().filter(|entry| !used.contains(entry.key.as_str()));
            unused.extend(left.map(|entry| (entry.key_span.start, format!("the {what} `{}`", entry.key))));
        }
        unused.sort();
        unused.into_iter().map(|(_, text)| text).collect()
    }
}

/// The names of solids that a solid is composed of.
fn collect_names<'d>(solid: &'d Value, names: &mut Vec<&'d str>) {
    let Some(table) = solid.table() else { return };
    for entry in &table.entries {
        match entry.key.as_str() {
            "union" | "intersection" | "difference" | "complement" | "from" | "to" | "solids" | "solid"
            | "within" => {
                for operand in entry.value.one_or_many() {
                    names.extend(operand.text());
                    collect_names(operand, names);
                }
            }
            "blend" | "metamorphosis" | "sweep" | "projection" => collect_names(&entry.value, names),
            _ => {}
        }
    }
}

/// The words of all texts, and the names of all materials that are asked for.
fn collect_texts<'d>(table: &'d Table, words: &mut HashSet<&'d str>, materials: &mut HashSet<&'d str>) {
    let mut open: Vec<(&str, &Value)> = table.entries.iter().map(|e| (e.key.as_str(), &e.value)).collect();
    while let Some((key, value)) = open.pop() {
        match &value.kind {
            Kind::Text(text) => {
                words.extend(super::expression::words(text));
                if matches!(key, "material" | "back") {
                    materials.insert(text);
                }
            }
            Kind::List(list) => open.extend(list.iter().map(|value| (key, value))),
            Kind::Table(table) => open.extend(table.entries.iter().map(|e| (e.key.as_str(), &e.value))),
            _ => {}
        }
    }
}
