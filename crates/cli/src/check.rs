//! `fieldstone check`.

mod json;
mod scene;

use crate::arguments::CheckArguments;
use crate::failure::Failure;
use fieldstone::{
    Bindings, Extent, FileSign, FoundBounds, Input, Loaded, Model, Object, UpAxis, Warning, solid_bounds,
};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;

/// Prints what is in a model or a scene.
pub(crate) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let tell = |failure: &Failure| {
        if let (true, Failure::Model(diagnostics)) = (arguments.json, failure) {
            // The errors go to standard error too, and decide how the program ends.
            let _ = print_json(&json::Errors::new(diagnostics));
        }
    };
    if let Some(path) = arguments.model.scene() {
        let (document, found) = scene::read(arguments, path).inspect_err(tell)?;
        if arguments.json {
            return print_json(&json::SceneReport::new(&document, &found));
        }
        return print(&scene::report(&document, &found));
    }
    let loaded = arguments.model.load().inspect_err(tell)?;
    let inputs = arguments.model.inputs();
    let bindings = inputs.bindings(&loaded.model)?;
    let found = solid_bounds(&loaded.model.field, &bindings);
    if arguments.json {
        return print_json(&json::Report::new(&loaded, &bindings, &inputs, &found));
    }
    print(&report(&loaded, &bindings, &found))
}

fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Failure::Material(e.to_string()))?;
    print(&(text + "\n"))
}

fn print(text: &str) -> Result<(), Failure> {
    write!(std::io::stdout(), "{text}").map_err(|e| Failure::of_stream("standard output", &e))
}

fn report(loaded: &Loaded, bindings: &Bindings, found: &FoundBounds) -> String {
    let model = &loaded.model;
    let mut lines: Vec<(&str, String)> = model.objects.iter().map(|o| ("object", object(o))).collect();
    lines.push(("chosen", model.name.clone()));
    let sign = match model.sign {
        FileSign::NegativeInside => "f < 0 inside",
        FileSign::PositiveInside => "F >= 0 inside",
    };
    let up = match model.up {
        UpAxis::Y => "y",
        UpAxis::Z => "z",
    };
    lines.push(("sign", format!("{sign}, {up} up")));
    if model.presentation.surface {
        lines.push(("surface", "f = 0 is meant, without an inside".to_owned()));
    }
    if let Some(([x, y, z], radius)) = model.presentation.clip_sphere {
        lines.push(("shown", format!("the ball of radius {radius} around {x},{y},{z}")));
    }
    for parameter in &model.parameters {
        lines.push(("parameter", format!("{} = {}", parameter.name, bindings.get(parameter.input))));
    }
    for index in (3..model.coordinates).filter_map(|k| u16::try_from(k).ok()) {
        let value = bindings.get(Input::Coordinate(index));
        lines.push(("coordinate", format!("{} = {value}", index + 1)));
    }
    lines.push(("operations", model.field.operation_count().to_string()));
    if !model.presentation.surface {
        lines.push(("bounds", bounds(found)));
    }
    let mut report = String::new();
    for (name, text) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(report, "{name:<11}{text}");
    }
    let warnings = loaded.rendered_warnings();
    let of_bounds = warning_of_bounds(model, found).map(|warning| format!("warning: {warning}"));
    for warning in warnings.chain(of_bounds) {
        let _ = writeln!(report, "\n{warning}");
    }
    report
}

/// What is strange about where the solid is; a surface is no solid.
fn warning_of_bounds(model: &Model, found: &FoundBounds) -> Option<Warning> {
    Warning::of_bounds(found).filter(|_| !model.presentation.surface)
}

fn object(object: &Object) -> String {
    let attributes = match object.attributes {
        Some(count) => count.to_string(),
        None => "no".to_owned(),
    };
    let Object { name, coordinates, parameters, .. } = object;
    format!("{name}: {coordinates} coordinates, {parameters} parameters, {attributes} attributes")
}

fn bounds(found: &FoundBounds) -> String {
    if found.extent != Extent::Bounded {
        return "none".to_owned();
    }
    numbers(&found.min, &found.max)
}

/// The corners of a box.
fn numbers(min: &[f64; 3], max: &[f64; 3]) -> String {
    // Four digits of the longest side are more than the bounds have.
    let longest = (0..3).map(|i| max[i] - min[i]).fold(0.0, f64::max);
    let digits = (4.0 - longest.log10()).ceil().clamp(0.0, 17.0) as usize;
    let numbers: Vec<String> = min.iter().chain(max).map(|x| format!("{x:.digits$}")).collect();
    numbers.join(",")
}
