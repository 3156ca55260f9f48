//! `fieldstone check --json`. `docs/check-json.md` describes every field; a field is added without notice, but its
//! meaning or absence changes only with [`SCHEMA`].

use fieldstone::{
    Bindings, Diagnostic, Diagnostics, Document, Extent, FileSign, FoundBounds, Input, Inputs, Loaded, Model,
    Projection, ResolvedDocument, Severity, Solid, Source, TexelBox, UpAxis,
};
use serde::Serialize;

use super::warning_of_bounds;

/// The version of the schema.
const SCHEMA: u32 = 1;

/// What is in a model.
#[derive(Serialize)]
pub(super) struct Report {
    schema: u32,
    source: String,
    objects: Vec<Object>,
    chosen: String,
    sign: &'static str,
    up: &'static str,
    parameters: Vec<Parameter>,
    coordinates: Vec<Coordinate>,
    operations: usize,
    bounds: Bounds,
    warnings: Vec<Message>,
}

#[derive(Serialize)]
struct Object {
    name: String,
    coordinates: usize,
    parameters: usize,
    /// `null` if the object declares none.
    attributes: Option<usize>,
}

#[derive(Serialize)]
struct Parameter {
    name: String,
    default: f64,
    value: f64,
}

#[derive(Serialize)]
struct Coordinate {
    number: usize,
    /// `null` for an axis of space that is not fixed.
    value: Option<f64>,
}

#[derive(Serialize)]
struct Bounds {
    found: &'static str,
    /// `null` unless `found` is `bounded`.
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
    proved: bool,
}

/// What is in a scene.
#[derive(Serialize)]
pub(super) struct SceneReport {
    schema: u32,
    source: String,
    /// The names of the parameters.
    parameters: Vec<String>,
    objects: Vec<SceneObject>,
    texels: Vec<SceneTexels>,
    lights: usize,
    environment: bool,
    bounds: SceneBounds,
    camera: SceneCamera,
    size: [u32; 2],
    samples: u32,
    unused: Vec<String>,
    warnings: Vec<Message>,
}

#[derive(Serialize)]
struct SceneObject {
    name: String,
    operations: usize,
    parts: Vec<String>,
    conditions: usize,
    copies: usize,
}

#[derive(Serialize)]
struct SceneTexels {
    name: String,
    edge: u32,
    /// Filled cells of the finest level.
    filled: u64,
    filter: &'static str,
}

#[derive(Serialize)]
struct SceneBounds {
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Serialize)]
struct SceneCamera {
    eye: [f64; 3],
    /// Degrees from the lower to the upper edge; `null` of a parallel view.
    fov: Option<f64>,
    /// The height of a parallel view.
    ortho: Option<f64>,
}

/// Why a model cannot be read.
#[derive(Serialize)]
pub(super) struct Errors {
    schema: u32,
    source: String,
    errors: Vec<Message>,
    warnings: Vec<Message>,
}

#[derive(Serialize)]
struct Message {
    message: String,
    /// The place in the text, if the message is about one.
    line: Option<usize>,
    column: Option<usize>,
    end_line: Option<usize>,
    end_column: Option<usize>,
    label: Option<String>,
    help: Option<String>,
}

impl Report {
    pub(super) fn new(loaded: &Loaded, bindings: &Bindings, inputs: &Inputs, found: &FoundBounds) -> Self {
        let model = &loaded.model;
        let of_text = model.warnings.iter().map(|warning| Message::new(warning, &loaded.source));
        let of_bounds = warning_of_bounds(model, found).map(|warning| Message::without_place(&warning));
        Self {
            schema: SCHEMA,
            source: loaded.source.name.clone(),
            objects: model.objects.iter().map(Object::new).collect(),
            chosen: model.name.clone(),
            sign: match model.sign {
                FileSign::NegativeInside => "negative-inside",
                FileSign::PositiveInside => "positive-inside",
            },
            up: match model.up {
                UpAxis::Y => "y",
                UpAxis::Z => "z",
            },
            parameters: parameters(model, bindings),
            coordinates: coordinates(model, bindings, inputs),
            operations: model.field.operation_count(),
            bounds: Bounds::new(found),
            warnings: of_text.chain(of_bounds).collect(),
        }
    }
}

impl SceneReport {
    pub(super) fn new(document: &Document, found: &ResolvedDocument) -> Self {
        let scene = &found.resolved.scene;
        let mut copies = vec![0; scene.solids().len()];
        scene.instances().iter().for_each(|instance| copies[instance.solid()] += 1);
        let object = |((name, solid), copies): ((&String, &Solid), usize)| SceneObject {
            name: name.clone(),
            operations: solid.field().operation_count(),
            parts: solid.parts().iter().map(|part| part.name.clone()).collect(),
            conditions: solid.conditions().len(),
            copies,
        };
        let texels = |(name, texels): (&String, &TexelBox)| SceneTexels {
            name: name.clone(),
            edge: texels.volume().edge(),
            filled: texels.volume().size().filled,
            filter: crate::texel::name(texels.volume().mode()),
        };
        let (bounds, camera, settings) = (scene.bounds(), scene.camera(), scene.settings());
        let (fov, ortho) = match camera.projection() {
            Projection::Perspective { vertical_fov_radians } => {
                (Some(vertical_fov_radians.to_degrees()), None)
            }
            Projection::Orthographic { height } => (None, Some(height)),
        };
        // What is said of files shows their text below the first line.
        let first_line = |message: &String| {
            let line = message.lines().next().unwrap_or_default();
            Message::without_place(line.strip_prefix("warning: ").unwrap_or(line))
        };
        Self {
            schema: SCHEMA,
            source: document.source().name.clone(),
            parameters: document.parameter_names().map(str::to_owned).collect(),
            objects: found.objects.iter().zip(scene.solids()).zip(copies).map(object).collect(),
            texels: found.volumes.iter().zip(scene.texels()).map(texels).collect(),
            lights: scene.lighting().lights.len(),
            environment: scene.lighting().environment.is_some(),
            bounds: SceneBounds { min: bounds.min().to_array(), max: bounds.max().to_array() },
            camera: SceneCamera { eye: camera.eye().to_array(), fov, ortho },
            size: settings.size.into(),
            samples: settings.samples,
            unused: document.unused(),
            warnings: found.messages.iter().map(first_line).collect(),
        }
    }
}

fn parameters(model: &Model, bindings: &Bindings) -> Vec<Parameter> {
    let parameter = |p: &fieldstone::Parameter| Parameter {
        name: p.name.clone(),
        default: p.default,
        value: bindings.get(p.input),
    };
    model.parameters.iter().map(parameter).collect()
}

fn coordinates(model: &Model, bindings: &Bindings, inputs: &Inputs) -> Vec<Coordinate> {
    let is_open = |number| number <= 3 && !inputs.coordinates.iter().any(|&(fixed, _)| fixed == number);
    let coordinate = |index: u16| {
        let number = usize::from(index) + 1;
        let value = (!is_open(number)).then(|| bindings.get(Input::Coordinate(index)));
        Coordinate { number, value }
    };
    (0..model.coordinates).filter_map(|index| u16::try_from(index).ok()).map(coordinate).collect()
}

impl Object {
    fn new(object: &fieldstone::Object) -> Self {
        let fieldstone::Object { name, coordinates, parameters, attributes } = object.clone();
        Self { name, coordinates, parameters, attributes }
    }
}

impl Bounds {
    fn new(found: &FoundBounds) -> Self {
        let is_bounded = found.extent == Extent::Bounded;
        Self {
            found: match found.extent {
                Extent::Bounded => "bounded",
                Extent::Unbounded => "unbounded",
                Extent::Empty => "empty",
                Extent::NotFound => "not-found",
                Extent::Undefined => "undefined",
            },
            min: is_bounded.then_some(found.min),
            max: is_bounded.then_some(found.max),
            proved: found.proved,
        }
    }
}

impl Errors {
    pub(super) fn new(diagnostics: &Diagnostics) -> Self {
        let of = |severity| {
            let wanted = diagnostics.list.iter().filter(move |message| message.severity == severity);
            wanted.map(|message| Message::new(message, &diagnostics.source)).collect()
        };
        Self {
            schema: SCHEMA,
            source: diagnostics.source.name.clone(),
            errors: of(Severity::Error),
            warnings: of(Severity::Warning),
        }
    }
}

impl Message {
    fn new(diagnostic: &Diagnostic, source: &Source) -> Self {
        let (line, column) = source.line_and_column(diagnostic.span.start);
        let (end_line, end_column) = source.line_and_column(diagnostic.span.end);
        Self {
            message: diagnostic.message.clone(),
            line: Some(line),
            column: Some(column),
            end_line: Some(end_line),
            end_column: Some(end_column),
            label: Some(diagnostic.label.clone()),
            help: diagnostic.help.clone(),
        }
    }

    fn without_place(warning: &(impl ToString + ?Sized)) -> Self {
        let none = None;
        let message = warning.to_string();
        Self { message, line: none, column: none, end_line: none, end_column: none, label: None, help: None }
    }
}
