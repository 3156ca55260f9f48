//! Colours of scene files.

use super::fault::Outcome;
use super::number::Numbers;
use super::tree::{Kind, Value};
use fieldstone_lang::Diagnostic;
use fieldstone_scene::{Rgb, srgb_to_linear};
use glam::DVec3;
use std::str::FromStr;

impl Numbers<'_> {
    /// A colour at this time, in linear RGB.
    pub(super) fn colour(&self, value: &Value) -> Outcome<Rgb> {
        let colour = match &value.kind {
            Kind::Text(text) => named(text).ok_or_else(|| no_colour(value, text))?,
            Kind::Table(table) => match table.get("linear") {
                Some(linear) => DVec3::from(self.numbers::<3>(linear)?),
                None => {
                    let numbers = self.keyed(table, |v| Ok(self.colour(v)?.to_array().to_vec()))?;
                    // Smooth curves may leave the range of the keys.
                    DVec3::new(numbers[0], numbers[1], numbers[2]).max(DVec3::ZERO)
                }
            },
            _ => {
                let srgb = self.numbers::<3>(value)?;
                if srgb.iter().any(|c| !(0.0..=1.0).contains(c)) {
                    let error = value.error("a colour has three numbers from 0 to 1", "out of range");
                    return Err(error.with_help("{ linear = [r, g, b] } may be brighter").into());
                }
                DVec3::from(srgb.map(srgb_to_linear))
            }
        };
        if colour.cmpge(DVec3::ZERO).all() {
            return Ok(colour);
        }
        Err(value.error("a colour is not negative", "negative").into())
    }
}

/// The colour of a name of CSS, or of `#rrggbb`.
pub(crate) fn named(text: &str) -> Option<Rgb> {
    // A long text is no name, and need not be looked at.
    let colour = svgtypes::Color::from_str(text).ok().filter(|_| text.len() < 64)?;
    Some(DVec3::from([colour.red, colour.green, colour.blue].map(|c| srgb_to_linear(f64::from(c) / 255.0))))
}

fn no_colour(value: &Value, text: &str) -> Diagnostic {
    let error = value.error(format!("`{}` is not a colour", shortened(text)), "unknown colour");
    error.with_help("write \"#ff8000\", a name of CSS such as \"teal\", or [1, 0.5, 0]")
}

/// The beginning of a text that may be long.
fn shortened(text: &str) -> String {
    const LENGTH: usize = 40;
    if text.chars().count() <= LENGTH {
        text.to_owned()
    } else {
        text.chars().take(LENGTH).chain(['…']).collect()
    }
}
