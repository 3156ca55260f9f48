//! What is in a scene file.

use super::numbers;
use crate::arguments::CheckArguments;
use crate::failure::Failure;
use fieldstone::{Bounds, Document, FileAccess, Projection, ResolvedDocument, Solid, TexelBox};
use std::fmt::Write as _;
use std::path::Path;

/// Reads a scene file and resolves it.
pub(super) fn read(arguments: &CheckArguments, path: &Path) -> Result<(Document, ResolvedDocument), Failure> {
    let access = FileAccess { folders: arguments.allow_read.clone(), outside: arguments.allow_outside };
    let document = arguments.model.load_scene(path, &access)?;
    let found = document.resolve(&arguments.model.scene_request(&document)?)?;
    Ok((document, found))
}

/// The report of a scene file.
pub(super) fn report(document: &Document, found: &ResolvedDocument) -> String {
    let mut lines: Vec<(&str, String)> =
        document.parameter_names().map(|name| ("parameter", name.to_owned())).collect();
    lines.extend(objects(found));
    lines.extend(volumes(found));
    let scene = &found.resolved.scene;
    let lighting = scene.lighting();
    let around = if lighting.environment.is_some() { ", and an environment" } else { "" };
    lines.push(("lights", format!("{}{around}", lighting.lights.len())));
    lines.push(("bounds", bounds(&scene.bounds())));
    let camera = scene.camera();
    let lens = match camera.projection() {
        Projection::Perspective { vertical_fov_radians } => {
            format!("{:.4} degrees", vertical_fov_radians.to_degrees())
        }
        Projection::Orthographic { height } => format!("parallel, {height} high"),
    };
    let eye = camera.eye();
    lines.push(("camera", format!("{:.4},{:.4},{:.4}, {lens}", eye.x, eye.y, eye.z)));
    let (width, height) = scene.settings().size;
    lines.push(("picture", format!("{width}x{height}, {} samples", scene.settings().samples)));
    lines.extend(document.unused().into_iter().map(|what| ("unused", what)));
    let mut report = String::new();
    for (name, text) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(report, "{name:<11}{text}");
    }
    for message in &found.messages {
        let _ = writeln!(report, "\n{message}");
    }
    report
}

fn objects(found: &ResolvedDocument) -> Vec<(&'static str, String)> {
    let scene = &found.resolved.scene;
    let line = |(number, (name, solid)): (usize, (&String, &Solid))| {
        let copies = scene.instances().iter().filter(|instance| instance.solid() == number).count();
        let mut text = format!("{name}: {} operations", solid.field().operation_count());
        if solid.parts().len() > 1 {
            let names: Vec<&str> = solid.parts().iter().map(|part| part.name.as_str()).collect();
            let _ = write!(text, ", {} parts ({})", names.len(), names.join(", "));
        }
        if !solid.conditions().is_empty() {
            let _ = write!(text, ", {} conditions", solid.conditions().len());
        }
        if copies > 1 {
            let _ = write!(text, ", {copies} copies");
        }
        ("object", text)
    };
    found.objects.iter().zip(scene.solids()).enumerate().map(line).collect()
}

fn volumes(found: &ResolvedDocument) -> Vec<(&'static str, String)> {
    let line = |(name, texels): (&String, &TexelBox)| {
        let volume = texels.volume();
        let filter = crate::texel::name(volume.mode());
        let cells = volume.size().filled;
        ("texels", format!("{name}: {} cells along an edge, {cells} filled, filter {filter}", volume.edge()))
    };
    found.volumes.iter().zip(found.resolved.scene.texels()).map(line).collect()
}

fn bounds(bounds: &Bounds) -> String {
    numbers(&bounds.min().to_array(), &bounds.max().to_array())
}
