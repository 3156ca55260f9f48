//! Properties by key, with values of a kind.

use super::properties::{Piece, Property};
use crate::diagnostic::{Diagnostic, MAX_ERRORS};
use crate::suggest::closest;
use std::collections::{HashMap, HashSet};

/// The keys that mean something; `0` stands for the number of a light.
const KEYS: [&str; 25] = [
    "surface_equation",
    "surface_parameter_a",
    "scale_factor",
    "transform_matrix",
    "rotation_matrix",
    "surface_transform_matrix",
    "camera_type",
    "camera_fov_y",
    "camera_height",
    "camera_transform",
    "front_material_color",
    "front_material_ambient_intensity",
    "front_material_diffuse_intensity",
    "front_material_specular_intensity",
    "front_material_shininess",
    "back_material_color",
    "back_material_ambient_intensity",
    "back_material_diffuse_intensity",
    "back_material_specular_intensity",
    "back_material_shininess",
    "light_status_0",
    "light_position_0",
    "light_color_0",
    "light_intensity_0",
    "background_color",
];

/// More warnings than these say nothing new.
const MAX_WARNINGS: usize = 50;

/// The properties of a file. What is asked for counts as known; the rest is reported.
pub(super) struct Reader<'a> {
    properties: &'a [Property],
    by_key: HashMap<&'a str, &'a Property>,
    known: HashSet<&'a str>,
    errors: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    /// Where a key stands twice, the last counts.
    pub(super) fn new(properties: &'a [Property]) -> Self {
        let mut reader = Self {
            properties,
            by_key: HashMap::new(),
            known: HashSet::new(),
            errors: Vec::new(),
            warnings: Vec::new(),
        };
        for property in properties {
            if reader.by_key.insert(&property.key.text, property).is_some() {
                let message = format!("`{}` is given again", property.key.text);
                let warning = Diagnostic::warning(property.key.span(), message, "replaces the earlier line");
                reader.warn(warning.with_help("leave one of the lines out"));
            }
        }
        reader
    }

    pub(super) fn fail(&mut self, error: Diagnostic) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(error);
        }
    }

    pub(super) fn warn(&mut self, warning: Diagnostic) {
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(warning);
        }
    }

    /// The value of a key.
    pub(super) fn take(&mut self, key: &str) -> Option<&'a Piece> {
        let (key, property) = self.by_key.get_key_value(key)?;
        self.known.insert(key);
        Some(&property.value)
    }

    /// The properties whose keys begin so, with the rest of their keys.
    pub(super) fn with_prefix(&mut self, prefix: &str) -> Vec<(&'a str, &'a Property)> {
        let all = self.by_key.iter();
        let found: Vec<_> =
            all.filter_map(|(key, p)| key.strip_prefix(prefix).map(|rest| (*key, rest, *p))).collect();
        self.known.extend(found.iter().map(|(key, ..)| *key));
        found.into_iter().map(|(_, rest, property)| (rest, property)).collect()
    }

    /// So many finite numbers with blanks between them.
    pub(super) fn numbers<const N: usize>(&mut self, key: &str) -> Option<[f64; N]> {
        self.take(key).and_then(|value| self.numbers_of(value))
    }

    pub(super) fn number(&mut self, key: &str) -> Option<f64> {
        self.numbers(key).map(|[value]| value)
    }

    /// A number that is not below `least`.
    pub(super) fn number_from(&mut self, key: &str, least: f64) -> Option<f64> {
        let value = self.number(key)?;
        if value >= least {
            return Some(value);
        }
        let label = format!("below {least}");
        self.warn_about(key, format!("`{key}` cannot be {value}"), &label, &format!("{least} is taken"));
        Some(least)
    }

    /// An sRGB colour; components outside \[0, 1\] are cut off.
    pub(super) fn colour(&mut self, key: &str) -> Option<[f64; 3]> {
        let colour: [f64; 3] = self.numbers(key)?;
        let inside = colour.map(|c| c.clamp(0.0, 1.0));
        if inside != colour {
            let message = "a colour has components from 0 to 1".to_owned();
            self.warn_about(key, message, "outside of that range", "the nearest colour is taken");
        }
        Some(inside)
    }

    pub(super) fn numbers_of<const N: usize>(&mut self, value: &Piece) -> Option<[f64; N]> {
        let mut numbers = Vec::with_capacity(N);
        for word in value.text.split_whitespace() {
            let at = word.as_ptr() as usize - value.text.as_ptr() as usize;
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => {
                    let span = value.in_file(at..at + word.len());
                    let error =
                        Diagnostic::error(span, format!("`{word}` is not a number"), "expected a number");
                    self.fail(error.with_help("a number is written like `0.5` or `-2e-3`"));
                    return None;
                }
            }
        }
        let found = numbers.len();
        let result = <[f64; N]>::try_from(numbers).ok();
        if result.is_none() {
            let needed = if N == 1 { "one number".to_owned() } else { format!("{N} numbers") };
            let message = format!("expected {needed}, found {found}");
            let error = Diagnostic::error(value.span(), message, format!("expected {needed}"));
            self.fail(error.with_help("numbers stand side by side with blanks between them"));
        }
        result
    }

    /// A warning about the value of a key that was taken.
    pub(super) fn warn_about(&mut self, key: &str, message: String, label: &str, help: &str) {
        let span = self.by_key.get(key).map_or(0..0, |property| property.value.span());
        self.warn(Diagnostic::warning(span, message, label).with_help(help));
    }

    /// An error about the value of a key that was taken.
    pub(super) fn fail_about(&mut self, key: &str, message: String, label: &str, help: &str) {
        let span = self.by_key.get(key).map_or(0..0, |property| property.value.span());
        self.fail(Diagnostic::error(span, message, label).with_help(help));
    }

    /// The errors, and the warnings with those about keys that nobody asked for.
    pub(super) fn finish(mut self) -> (Vec<Diagnostic>, Vec<Diagnostic>) {
        let properties = self.properties;
        for property in properties {
            if self.known.contains(property.key.text.as_str()) || self.warnings.len() >= MAX_WARNINGS {
                continue;
            }
            let key = property.key.text.as_str();
            let warning = Diagnostic::warning(
                property.key.span(),
                format!("`{key}` has no meaning here"),
                "not taken into account",
            );
            self.warnings.push(match closest(key, KEYS) {
                Some(known) => warning.with_help(format!("did you mean `{known}`?")),
                None => warning,
            });
        }
        self.warnings.sort_by_key(|warning| warning.span.start);
        (self.errors, self.warnings)
    }
}
