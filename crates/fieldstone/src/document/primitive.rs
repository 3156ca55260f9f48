//! Solids from data files, control values, curves and sections of four dimensions.

use super::compose::{Built, Composer, Look, Space};
use super::expression::{self, Names};
use super::fault::{Fault, Outcome};
use super::tree::{EMPTY, Table, Value};
use crate::data::{DataError, NumberType, Placement, RawLayout, load_points, load_voxels};
use fieldstone_field::{Function, Graph, Input, NodeId};
use fieldstone_solids::{
    Basis, CURVE_PARAMETER, Course, Curve, Interpolation, MinimumError, Reconstruction, SplineVolume, least,
    projection,
};
use std::sync::Arc;

/// The sources of solids that this module knows.
pub(super) const PRIMITIVES: [&str; 5] = ["voxels", "points", "spline", "sweep", "projection"];

const ALONG_CURVES: Names = Names { parameters: true, fields: false, normal: false };
const FROM_ZERO: (f64, f64, &str) = (0.0, f64::MAX, "from 0 on");

impl<'d> Composer<'_, 'd> {
    /// The solid that stands under one of [`PRIMITIVES`].
    pub(super) fn primitive(
        &mut self,
        (source, value): (&str, &'d Value),
        name: &str,
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let table = value.table().unwrap_or(&EMPTY);
        let field = match source {
            "voxels" => self.voxels(value, table, space)?,
            "points" => self.points(value, table, space)?,
            "spline" => self.spline(value, table, space)?,
            "sweep" => self.sweep(value, table, space)?,
            _ => self.projection(value, table, space)?,
        };
        self.leaf(name, field, (space, look, &[]))
    }

    /// A number of a table, in a range; `usual` where there is none.
    fn number_of(&self, table: &Table, key: &str, usual: f64, range: (f64, f64, &str)) -> Outcome<f64> {
        table.get(key).map_or(Ok(usual), |value| self.numbers.ranged(value, range))
    }

    /// Two corners of a box.
    fn corners(&self, table: &Table) -> Outcome<Option<[[f64; 3]; 2]>> {
        let Some(value) = table.get("box") else { return Ok(None) };
        let [a, b, c, d, e, f] = self.numbers.numbers(value)?;
        if !(a < d && b < e && c < f) {
            return Err(value
                .error("a box is x0, y0, z0, x1, y1, z1 with x0 < x1 and so on", "empty")
                .into());
        }
        Ok(Some([[a, b, c], [d, e, f]]))
    }

    /// Three whole numbers.
    fn counts(&self, table: &Table) -> Outcome<Option<[usize; 3]>> {
        let Some(value) = table.get("size") else { return Ok(None) };
        Ok(Some(self.numbers.numbers::<3>(value)?.map(|n| n.max(0.0) as usize)))
    }

    fn called(&mut self, function: impl Function + 'static, space: &Space) -> NodeId {
        let function: Arc<dyn Function> = Arc::new(function);
        self.graph.call(&function, &space.point)
    }

    /// What of a field lies in a box.
    fn within(&mut self, field: NodeId, [low, high]: [[f64; 3]; 2], space: &Space) -> NodeId {
        let g = &mut self.graph;
        (0..3).fold(field, |field, k| {
            let [low, high] = [low[k], high[k]].map(|c| g.constant(c));
            let (below, above) = (g.sub(low, space.point[k]), g.sub(space.point[k], high));
            let outside = g.max(below, above);
            g.max(field, outside)
        })
    }

    fn voxels(&mut self, value: &'d Value, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        let file = needed(value, table, "file", "voxels = { file = \"scan.nrrd\", level = 0.5 }")?;
        let path = self.numbers.document().files.place(file)?;
        let text = |key: &str| table.get(key).and_then(Value::text);
        let number = NumberType::NAMES.into_iter().find(|(name, _)| Some(*name) == text("type"));
        let skip = self.number_of(table, "skip", 0.0, FROM_ZERO)? as usize;
        let raw = self.counts(table)?.zip(number).map(|(counts, (_, number))| RawLayout {
            counts,
            number,
            big_endian: text("endian") == Some("big"),
            skip,
        });
        let interpolation = match text("interpolation") {
            Some("catmull-rom") => Interpolation::CatmullRom,
            Some("b-spline") => Interpolation::BSpline,
            _ => Interpolation::Linear,
        };
        let placement = Placement { place: self.corners(table)? };
        let array = load_voxels(&path, raw.as_ref(), &placement, interpolation)
            .map_err(|error| unreadable(file, &error))?;
        let bounds = array.bounds();
        let level = self.number_of(table, "level", 0.0, (f64::MIN, f64::MAX, "that is finite"))?;
        let level = self.graph.constant(level);
        let density = self.called(array, space);
        let is_below = text("inside") == Some("below");
        let field = if is_below { self.graph.sub(density, level) } else { self.graph.sub(level, density) };
        Ok(self.within(field, bounds, space))
    }

    fn points(&mut self, value: &'d Value, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        let file = needed(value, table, "file", "points = { file = \"scan.ply\" }")?;
        let path = self.numbers.document().files.place(file)?;
        let cloud = load_points(&path).map_err(|error| unreadable(file, &error))?;
        let usual = Reconstruction::default();
        let options = Reconstruction {
            smoothing: self.number_of(table, "smoothing", usual.smoothing, FROM_ZERO)?,
            offset: self.number_of(table, "offset", usual.offset, (1e-6, 0.2, "from 0.000001 to 0.2"))?,
        };
        let solid = cloud
            .reconstruct(&options)
            .map_err(|reason| unreadable(file, &DataError::Points { path: path.clone(), reason }))?;
        Ok(self.called(solid, space))
    }

    fn spline(&mut self, value: &'d Value, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        let example = "spline = { size = [2, 2, 2], controls = [−1, 1, 1, 1, 1, 1, 1, 1] }";
        let controls = needed(value, table, "controls", example)?;
        let list = controls.list().unwrap_or_default();
        let numbers: Vec<f64> = list.iter().map(|n| self.numbers.number(n)).collect::<Outcome<_>>()?;
        needed(value, table, "size", example)?;
        let counts = self.counts(table)?.unwrap_or_default();
        let is_b_spline = table.get("basis").and_then(Value::text) == Some("b-spline");
        let basis = if is_b_spline { Basis::BSpline } else { Basis::Bezier };
        let place = self.corners(table)?.unwrap_or([[-1.0; 3], [1.0; 3]]);
        let volume = SplineVolume::new(counts, numbers, basis, place)
            .map_err(|error| value.error(error.to_string(), "no spline"))?;
        let field = self.called(volume, space);
        Ok(self.within(field, place, space))
    }

    fn sweep(&mut self, value: &'d Value, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        let example = "sweep = { solid = \"ball\", polyline = [[0, 0, 0], [1, 0, 0]] }";
        let solid = needed(value, table, "solid", example)?;
        let vectors = |key: &str| -> Outcome<Option<Vec<[f64; 3]>>> {
            let list = table.get(key).and_then(Value::list);
            list.map(|list| list.iter().map(|v| self.numbers.numbers(v)).collect()).transpose()
        };
        let helix = table.get("helix").map(|helix| self.numbers.numbers::<3>(helix)).transpose()?;
        let formulas = table.get("curve").map(|curve| self.curve(curve)).transpose()?;
        let (formulas, range) = formulas.unzip();
        let curves = [
            vectors("polyline")?.map(Curve::Polyline),
            vectors("bezier")?.map(Curve::Bezier),
            helix.map(|[radius, pitch, turns]| Curve::Helix { radius, pitch, turns }),
            formulas,
        ];
        let mut curves = curves.into_iter().flatten();
        let (Some(curve), None) = (curves.next(), curves.next()) else {
            let message = "a sweep has exactly one of polyline, bezier, helix and curve";
            return Err(value.error(message, "no curve").with_help(format!("write {example}")).into());
        };
        let plain = [0, 1, 2].map(|k| self.graph.input(Input::Coordinate(k)));
        let moved = curve
            .moved_back(&mut self.graph, plain)
            .map_err(|error| value.error(error.to_string(), "no curve"))?;
        let inner = self.inner(solid, &Space { point: moved, ..*space }, None)?;
        let course = curve.course();
        let course = Course { range: range.unwrap_or(course.range), ..course };
        self.least(value, (inner, course), space)
    }

    /// A curve by formulas of u, and where u runs.
    fn curve(&mut self, value: &'d Value) -> Outcome<(Curve, [f64; 2])> {
        let table = value.table().unwrap_or(&EMPTY);
        let example = "curve = { x = \"cos(u)\", y = \"sin(u)\", z = \"u/10\", from = 0, to = 18.85 }";
        let finite = (f64::MIN, f64::MAX, "that is finite");
        let range = [self.number_of(table, "from", 0.0, finite)?, self.number_of(table, "to", 1.0, finite)?];
        if range[0] >= range[1] {
            let message = format!("u runs from {} to {}: the first must be the smaller", range[0], range[1]);
            return Err(value.error(message, "no curve").with_help(format!("write {example}")).into());
        }
        let mut program = Graph::new();
        let mut coordinates = [program.constant(0.0); 3];
        for (coordinate, key) in coordinates.iter_mut().zip(["x", "y", "z"]) {
            let formula = needed(value, table, key, example)?;
            *coordinate = self.formula_of_u(&mut program, formula)?;
        }
        Ok((Curve::Program(Box::new(program), coordinates), range))
    }

    /// A formula of u and the parameters of the scene.
    fn formula_of_u(&mut self, program: &mut Graph, value: &'d Value) -> Outcome<NodeId> {
        let Some(text) = value.text() else { return Ok(program.constant(self.numbers.number(value)?)) };
        let read = expression::read_of(self.numbers.document(), value, text, (ALONG_CURVES, &["u"]))?;
        let field = &read.model.field;
        let time = self.numbers.time();
        let mut numbers = Vec::new();
        for name in read.names.iter().filter(|name| *name != "u") {
            numbers.push((name.as_str(), self.numbers.parameter(name, value)?.unwrap_or(0.0)));
        }
        let is_coordinate = |input: &Input| matches!(input, Input::Coordinate(_));
        if field.inputs().iter().any(is_coordinate) {
            let error = value.error("a curve is a formula of u alone", "depends on a coordinate");
            return Err(error.with_help("x, y, z and w have no meaning along a curve").into());
        }
        let nodes = program.import(field.graph(), &[field.value()], |g, input| match read.parameter(input) {
            Some(parameter) if parameter.name == "u" && read.names.contains(&parameter.name) => {
                g.input(CURVE_PARAMETER)
            }
            Some(parameter) => {
                let known = numbers.iter().find(|(name, _)| *name == parameter.name);
                g.constant(known.map_or(parameter.default, |(_, number)| *number))
            }
            None => g.constant(time),
        });
        Ok(nodes[0])
    }

    fn projection(&mut self, value: &'d Value, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        let example = "projection = { solid = { formula = \"x^2 + y^2 + z^2 + w^2 - 1\" } }";
        let solid = needed(value, table, "solid", example)?;
        let finite = (f64::MIN, f64::MAX, "that is finite");
        let from = self.number_of(table, "from", -1.0, finite)?;
        let to = self.number_of(table, "to", 1.0, finite)?;
        let w = Input::Coordinate(3);
        let point = [0, 1, 2].map(|k| self.graph.input(Input::Coordinate(k)));
        let fourth = self.graph.input(w);
        let inner = self.inner(solid, &Space { point, ..*space }, Some(fourth))?;
        self.least(value, (inner, projection(w, [from, to])), space)
    }

    /// The field of a solid that is no part of what is composed, in a space of its own.
    fn inner(&mut self, solid: &'d Value, space: &Space, fourth: Option<NodeId>) -> Outcome<NodeId> {
        let first = self.parts.len();
        // Fields that were copied elsewhere may have had another w.
        let fields = self.change_fourth(fourth);
        let built = self.operand(solid, space, Look::default());
        self.restore_fourth(fields);
        self.parts.truncate(first);
        Ok(built?.value)
    }

    /// The least value of a field along a course, in a space.
    fn least(&mut self, value: &Value, (field, course): (NodeId, Course), space: &Space) -> Outcome<NodeId> {
        let failed = |error: MinimumError| -> Fault { value.error(error.to_string(), "no minimum").into() };
        let program = self.graph.clone();
        let place = |g: &mut Graph, input| match input {
            Input::Coordinate(k) if k < 3 => space.point[usize::from(k)],
            other => g.input(other),
        };
        least(&mut self.graph, (&program, field), &course, place).map_err(failed)
    }
}

/// A value that a table must have; `example` shows such a table.
pub(super) fn needed<'d>(value: &Value, table: &'d Table, key: &str, example: &str) -> Outcome<&'d Value> {
    table.get(key).ok_or_else(|| {
        let error = value.error(format!("`{key}` is missing"), "incomplete");
        error.with_help(format!("write {example}")).into()
    })
}

fn unreadable(file: &Value, error: &DataError) -> Fault {
    file.error(error.to_string(), "cannot be used").into()
}
