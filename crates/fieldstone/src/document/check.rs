//! Whether a document has the shape of a scene, by the table of keys.

use super::keys::{FACE, MAPS, MOTION, SCENE, SOLID, STEP, Section, Shape, TEXTURE};
use super::tree::{Entry, Kind, Table, Value};
use fieldstone_lang::Diagnostic;

/// A document with more errors than these has another problem.
const MAX_ERRORS: usize = 20;

/// Every key that is not known and every value of the wrong kind.
pub(super) fn check(root: &Table) -> Vec<Diagnostic> {
    let mut check = Check { errors: Vec::new() };
    check.section(root, &SCENE);
    check.errors.truncate(MAX_ERRORS);
    check.errors
}

/// The candidate that a name is a likely slip for.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Nobody mistypes a long name by a letter or two, and comparing it takes its time.
    if name.len() > 64 {
        return None;
    }
    let lower = name.to_lowercase();
    let distance = |other: &str| strsim::osa_distance(&lower, &other.to_lowercase());
    let allowed = (name.chars().count() / 3).max(1);
    let near = known.into_iter().filter(|other| other.len() <= 64).map(|other| (distance(other), other));
    near.filter(|(d, other)| *d <= allowed && *d < other.chars().count())
        .min_by_key(|(d, _)| *d)
        .map(|(_, n)| n)
}

/// What to do about an unknown name.
pub(super) fn advise<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone, what: &str) -> String {
    const MANY: usize = 30;
    if let Some(near) = nearest(name, known.clone()) {
        return format!("did you mean `{near}`?");
    }
    let names: Vec<&str> = known.into_iter().take(MANY + 1).collect();
    match names.len() {
        0 => format!("there is no {what} yet"),
        n if n > MANY => format!("known are {}, …", names[..MANY].join(", ")),
        _ => format!("known are {}", names.join(", ")),
    }
}

struct Check {
    errors: Vec<Diagnostic>,
}

impl Check {
    fn full(&self) -> bool {
        self.errors.len() >= MAX_ERRORS
    }

    fn section(&mut self, table: &Table, section: &'static Section) {
        for entry in &table.entries {
            if self.full() {
                return;
            }
            match section.key(&entry.key) {
                Some(key) => self.value(&entry.value, &key.shape, &entry.key),
                None => {
                    let message = format!("{} has no key `{}`", section.name, entry.key);
                    let help = advise(&entry.key, section.all().map(|k| k.name), "key");
                    let error = Diagnostic::error(entry.key_span.clone(), message, "unknown key");
                    self.errors.push(error.with_help(help));
                }
            }
        }
    }

    fn expect(&mut self, is_so: bool, value: &Value, key: &str, what: &str) {
        if !is_so {
            let message = format!("`{key}` is {what}, not {}", value.describe());
            self.errors.push(value.error(message, format!("expected {what}")));
        }
    }

    fn value(&mut self, value: &Value, shape: &'static Shape, key: &str) {
        if self.full() {
            return;
        }
        let is_text = value.text().is_some();
        match shape {
            Shape::Number => self.number(value, key),
            Shape::Whole(least, most) => self.whole(value, key, (*least, *most)),
            Shape::Flag => self.expect(value.flag().is_some(), value, key, "true or false"),
            Shape::Text => self.expect(is_text, value, key, "a text in quotes"),
            Shape::Material => self.expect(is_text, value, key, "the name of a material"),
            Shape::File => self.expect(is_text, value, key, "the name of a file"),
            Shape::Formula => {
                let fits = is_text || matches!(value.kind, Kind::Number(_));
                self.expect(fits, value, key, "a formula in quotes");
            }
            Shape::Choice(words) => self.choice(value, key, words),
            Shape::Numbers(count) => self.numbers(value, key, *count),
            Shape::Matrix => {
                let rows = value.list().filter(|rows| rows.len() == 3);
                self.expect(rows.is_some(), value, key, "a list of three rows");
                let width = |row: &Value| if row.list().is_some_and(|r| r.len() == 4) { 4 } else { 3 };
                rows.into_iter().flatten().for_each(|row| self.numbers(row, key, width(row)));
            }
            Shape::Colour => self.colour(value, key),
            Shape::Channel => match value.table() {
                Some(table) if table.get("attributes").is_some() => self.section(table, &TEXTURE),
                _ => self.number(value, key),
            },
            Shape::LightChannel if matches!(value.kind, Kind::Number(_)) => {}
            Shape::ColourChannel | Shape::LightChannel => match value.table() {
                Some(table) if !is_keyed(table) => self.section(table, &TEXTURE),
                _ => self.colour(value, key),
            },
            Shape::Solid => match value.table() {
                Some(table) => self.section(table, &SOLID),
                None => self.expect(is_text, value, key, "the name of a solid, or a table"),
            },
            Shape::Face => match value.table() {
                Some(table) => self.section(table, &FACE),
                None => self.colour(value, key),
            },
            Shape::Motions => self.steps(value, key, &MOTION),
            Shape::Steps => self.steps(value, key, &STEP),
            Shape::Table(section) => match value.table() {
                Some(table) => self.section(table, section),
                None => self.expect(false, value, key, "a table"),
            },
            Shape::List(inner) => {
                let list = value.list();
                match list {
                    None if matches!(inner, Shape::Face) => {
                        let message = format!("`{key}` is a list, not {}", value.describe());
                        let error = value.error(message, "expected a list");
                        self.errors
                            .push(error.with_help("six, in this order: right, left, up, down, front, back"));
                    }
                    None => self.expect(false, value, key, "a list"),
                    Some([]) => {
                        let message = format!("`{key}` is an empty list");
                        self.errors.push(value.error(message, "expected something in it"));
                    }
                    Some(_) => {}
                }
                list.into_iter().flatten().for_each(|element| self.value(element, inner, key));
            }
            Shape::OneOrMany(inner) => {
                value.one_or_many().iter().for_each(|element| self.value(element, inner, key));
            }
            Shape::Named(inner) => match value.table() {
                Some(table) => table.entries.iter().for_each(|e| self.value(&e.value, inner, &e.key)),
                None => self.expect(false, value, key, "a table of names"),
            },
            Shape::Either(first, second) => self.either(value, (first, second), key),
        }
    }

    fn steps(&mut self, value: &Value, key: &str, section: &'static Section) {
        for step in value.one_or_many() {
            let Some(table) = step.table() else {
                self.expect(false, step, key, "a motion such as { translate = [0, 0, 1] }");
                continue;
            };
            let is_map = |entry: &&Entry| MAPS.iter().any(|(map, _)| *map == entry.key);
            match table.entries.iter().find(is_map).filter(|entry| section.key(&entry.key).is_none()) {
                None => self.section(table, section),
                Some(map) => {
                    let (what, help) = match key {
                        "transform" => {
                            ("volumes", "a volume has translate, rotate, reflect, scale and matrix")
                        }
                        _ => ("copies", "put it into `transform`, which holds for all copies"),
                    };
                    let message = format!("{what} are moved, but not mapped by `{}`", map.key);
                    let error = Diagnostic::error(map.key_span.clone(), message, "no motion");
                    self.errors.push(error.with_help(help));
                }
            }
        }
    }

    /// Judged by the one whose kind of value it is.
    fn either(&mut self, value: &Value, (first, second): (&'static Shape, &'static Shape), key: &str) {
        let is_second = match second {
            Shape::Table(_) => !matches!(value.kind, Kind::Text(_) | Kind::Number(_)),
            Shape::Numbers(_) => value.list().is_some(),
            // Colours and files are told apart where they are read.
            _ => value.text().is_some(),
        };
        self.value(value, if is_second { second } else { first }, key);
    }

    fn number(&mut self, value: &Value, key: &str) {
        match &value.kind {
            Kind::Number(_) | Kind::Text(_) => {}
            Kind::Table(table) => self.keyed(table, key, &Shape::Number),
            _ => self.expect(false, value, key, "a number, a formula or keys"),
        }
    }

    fn numbers(&mut self, value: &Value, key: &str, count: usize) {
        match &value.kind {
            Kind::List(list) if list.len() == count => list.iter().for_each(|n| self.number(n, key)),
            Kind::List(list) => {
                let message = format!("`{key}` has {count} numbers, not {}", list.len());
                self.errors.push(value.error(message, format!("expected {count} numbers")));
            }
            Kind::Table(table) => {
                for entry in self.keys(table) {
                    if self.dotted(entry) {
                    } else if entry.value.table().is_some() {
                        self.expect(false, &entry.value, key, "a list of numbers");
                    } else {
                        self.numbers(&entry.value, key, count);
                    }
                }
            }
            _ => self.expect(false, value, key, &format!("a list of {count} numbers")),
        }
    }

    fn colour(&mut self, value: &Value, key: &str) {
        match &value.kind {
            Kind::Text(_) => {}
            Kind::List(_) => self.numbers(value, key, 3),
            Kind::Table(table) if table.get("linear").is_some() => self.section(table, &TEXTURE),
            Kind::Table(table) => self.keyed(table, key, &Shape::Colour),
            _ => self.expect(false, value, key, "a colour such as \"#ff8000\", \"teal\" or [1, 0.5, 0]"),
        }
    }

    fn keyed(&mut self, table: &Table, key: &str, shape: &'static Shape) {
        for entry in self.keys(table) {
            let is_keyed_again = entry.value.table().is_some_and(|t| t.get("linear").is_none());
            if self.dotted(entry) {
            } else if is_keyed_again {
                self.expect(false, &entry.value, key, "a value at this time");
            } else {
                self.value(&entry.value, shape, key);
            }
        }
    }

    /// What may be meant by `0.5 = 2`, which TOML takes for a table under the key 0.
    fn dotted(&mut self, entry: &Entry) -> bool {
        let Some(table) = entry.value.table() else { return false };
        let is_digits = |key: &str| !key.is_empty() && key.bytes().all(|b| b.is_ascii_digit());
        match table.entries.as_slice() {
            [only] if is_digits(&only.key) && is_digits(entry.key.trim_start_matches('-')) => {
                let message = "a time with a point stands in quotes";
                let span = entry.key_span.start..only.key_span.end;
                let error = Diagnostic::error(span, message, "a key of a key in TOML");
                self.errors.push(error.with_help(format!("write \"{}.{}\" = …", entry.key, only.key)));
                true
            }
            _ => false,
        }
    }

    /// The entries of a keyed value that are keys; what is wrong with the others is said.
    fn keys<'t>(&mut self, table: &'t Table) -> Vec<&'t Entry> {
        let mut keys = Vec::new();
        for entry in &table.entries {
            if entry.key == "interpolation" {
                self.choice(&entry.value, &entry.key, &super::number::INTERPOLATIONS);
            } else if entry.key.parse::<f64>().is_ok_and(f64::is_finite) {
                keys.push(entry);
            } else {
                let message = format!("`{}` is not a time", entry.key);
                let error = Diagnostic::error(entry.key_span.clone(), message, "expected seconds");
                self.errors
                    .push(error.with_help("write { 0 = 1.0, \"1.5\" = 2.0, interpolation = \"linear\" }"));
            }
        }
        if keys.is_empty() && !self.full() {
            let message = "there is no key: a value at a time, such as 0 = 1.0";
            self.errors.push(Diagnostic::error(table.span.clone(), message, "expected keys"));
        }
        keys
    }

    fn whole(&mut self, value: &Value, key: &str, (least, most): (u64, u64)) {
        let fits = |n: f64| n.fract() == 0.0 && n >= least as f64 && n <= most as f64;
        match value.kind {
            Kind::Number(n) if fits(n) => {}
            Kind::Number(n) => {
                let what = format!("a whole number from {least} to {most}");
                let message = format!("`{key}` is {what}, not {n}");
                self.errors.push(value.error(message, format!("expected {what}")));
            }
            _ => self.expect(false, value, key, "a whole number"),
        }
    }

    fn choice(&mut self, value: &Value, key: &str, words: &[&'static str]) {
        match value.text() {
            Some(word) if words.contains(&word) => {}
            Some(word) => {
                let message = format!("there is no {key} `{word}`");
                let near = nearest(word, words.iter().copied());
                let list = words.join(", ");
                let help = near.map_or(format!("it is one of {list}"), |n| {
                    format!("did you mean `{n}`? It is one of {list}")
                });
                self.errors.push(value.error(message, "unknown").with_help(help));
            }
            None => self.expect(false, value, key, "a word in quotes"),
        }
    }
}

/// Whether a table holds values at times.
pub(super) fn is_keyed(table: &Table) -> bool {
    let is_key = |key: &str| key == "interpolation" || key.parse::<f64>().is_ok();
    table.entries.iter().any(|entry| is_key(&entry.key))
}
