//! Objects: solids with all that they need to be drawn, and where they stand.

use super::compose::{Built, Composer, Look, PartDraft, Space};
use super::copies::copies;
use super::fault::{Fault, Outcome};
use super::finish::Attributes;
use super::motion::{Step, steps};
use super::number::Numbers;
use super::tree::{Entry, Table, Value};
use super::{MAX_ALL_INSTANCES, view};
use crate::extent::{Wanted, find_bounds};
use crate::request::Warning;
use fieldstone_field::{Bindings, Field, Graph, NodeId};
use fieldstone_lang::{Diagnostic, Presentation};
use fieldstone_scene::{Ball, Bounds, BoundsError, Condition, Instance, Solid, TexelBox};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::HashSet;

/// The objects of a scene on their way.
pub(super) struct Stage<'n, 'd> {
    numbers: &'n Numbers<'d>,
    pub(super) solids: Vec<Solid>,
    pub(super) instances: Vec<Instance>,
    /// The names of the solids.
    pub(super) objects: Vec<String>,
    /// What is strange about an object.
    pub(super) warnings: Vec<(String, Warning)>,
    ups: (bool, bool),
}

/// An object: its own table and that of its solid, where they are.
struct Placed<'d> {
    name: String,
    object: Option<&'d Table>,
    /// A definition, or a table.
    solid: &'d Value,
}

/// An object whose bounds are not known yet.
struct Draft {
    graph: Graph,
    parts: Vec<PartDraft>,
    fuel: Option<u32>,
    ups: (bool, bool),
    built: Built,
    conditions: Vec<(NodeId, bool)>,
    surface: bool,
    ball: Option<Ball>,
    /// Those that the scene gives.
    bounds: Option<Bounds>,
    /// The motion of each copy.
    copies: Vec<DAffine3>,
}

/// A search for the places where the surface of an object may be seen.
struct Search {
    field: Field,
    surface: bool,
    ball: Option<Ball>,
}

impl Draft {
    /// What has to be searched, if the scene does not give the bounds.
    fn search(&self) -> Option<Search> {
        if self.bounds.is_some() {
            return None;
        }
        let mut graph = self.graph.clone();
        let mut sought = self.built.value;
        if self.surface && !self.conditions.is_empty() {
            let (size, least) = (graph.abs(sought), graph.constant(f64::MIN_POSITIVE));
            sought = graph.sub(size, least);
        }
        for &(node, positive) in &self.conditions {
            let outside = if positive { graph.neg(node) } else { node };
            sought = graph.max(sought, outside);
        }
        let field = Field::new(graph, sought, Vec::new());
        let field = match self.fuel {
            Some(fuel) => field.with_fuel(fuel),
            None => field,
        };
        Some(Search { field, surface: self.surface && self.conditions.is_empty(), ball: self.ball })
    }
}

impl Search {
    fn find(&self) -> Result<(Bounds, Option<Warning>), BoundsError> {
        let (bindings, clip) = (Bindings::new(), self.ball.as_ref());
        find_bounds(&Wanted { field: &self.field, bindings: &bindings, surface: self.surface, clip })
    }
}

impl<'d> Placed<'d> {
    /// A solid that is an object itself.
    fn of_solid(entry: &'d Entry) -> Self {
        Self { name: entry.key.clone(), object: None, solid: &entry.value }
    }

    /// A key of the object, or else of its solid.
    fn get(&self, key: &str) -> Option<&'d Value> {
        let of_solid = || self.solid.table().and_then(|table| table.get(key));
        self.object.and_then(|table| table.get(key)).or_else(of_solid)
    }

    fn flag(&self, key: &str) -> Option<bool> {
        self.get(key).and_then(Value::flag)
    }

    fn error(&self, message: String) -> Fault {
        self.solid.error(message, "here").into()
    }
}

impl<'n, 'd> Stage<'n, 'd> {
    pub(super) fn new(numbers: &'n Numbers<'d>) -> Self {
        let (solids, instances, objects, warnings) = Default::default();
        Self { numbers, solids, instances, objects, warnings, ups: (false, false) }
    }

    /// Whether all models come from languages in which y is up.
    pub(super) fn is_y_up(&self) -> bool {
        self.ups == (true, false)
    }

    /// The box around everything, with these volumes.
    pub(super) fn bounds(&self, texels: &[TexelBox]) -> Outcome<Bounds> {
        let of_solids = self.instances.iter().map(|i| i.world_bounds(self.solids[i.solid()].bounds()));
        let boxes = of_solids.chain(texels.iter().map(TexelBox::bounds));
        let all = boxes.reduce(|all, bounds| all.union(&bounds));
        all.ok_or_else(|| Diagnostic::error(0..0, "there is no solid", "nothing to draw").into())
    }

    /// Composes all objects, finds their bounds, and makes sure that what no object uses means something too.
    pub(super) fn fill(&mut self) -> Outcome<()> {
        let placed = self.objects_of_scene()?;
        let drafts = placed.iter().map(|object| self.draft(object)).collect::<Outcome<Vec<_>>>()?;
        self.check_unused(&placed)?;
        // The search is the dear part of a scene of many solids, and knows nothing of the document.
        let searches: Vec<Option<Search>> = drafts.iter().map(Draft::search).collect();
        let found: Vec<_> = searches.par_iter().map(|search| search.as_ref().map(Search::find)).collect();
        for ((placed, draft), found) in placed.iter().zip(drafts).zip(found) {
            let bounds = match found {
                None => None,
                Some(found) => {
                    let (bounds, warning) = found.map_err(|error| placed.error(error.to_string()))?;
                    self.warnings.extend(warning.map(|warning| (placed.name.clone(), warning)));
                    Some(bounds)
                }
            };
            self.add(placed, draft, bounds)?;
        }
        Ok(())
    }

    /// The objects, or the solids that no other uses.
    fn objects_of_scene(&self) -> Outcome<Vec<Placed<'d>>> {
        let document = self.numbers.document();
        let mut placed = Vec::new();
        match document.root.get("objects").and_then(Value::list) {
            Some(list) => {
                for (i, value) in list.iter().enumerate() {
                    placed.push(self.placed(value, i)?);
                }
            }
            None => {
                placed.extend(document.loose_solids().into_iter().map(Placed::of_solid));
                let solids = document.root.entries_of("solids");
                if let (true, Some(first)) = (placed.is_empty(), solids.first()) {
                    let message = "every solid is part of another: there is a circle among them";
                    return Err(Diagnostic::error(first.key_span.clone(), message, "here").into());
                }
            }
        }
        if placed.is_empty() && document.root.get("texels").is_none() {
            let error = Diagnostic::error(0..0, "there is no solid in this scene", "nothing to draw");
            return Err(error.with_help("write [solids] and below it ball = \"x^2 + y^2 + z^2 - 1\"").into());
        }
        Ok(placed)
    }

    /// Composes the solids that no object uses, so that their mistakes are told.
    fn check_unused(&self, placed: &[Placed<'d>]) -> Outcome<()> {
        let document = self.numbers.document();
        let mut reached = HashSet::new();
        placed.iter().for_each(|object| {
            reached.insert(object.name.as_str());
            document.reach(object.solid, &mut reached);
        });
        // Those that no other uses hold most of the rest; what is left then is in circles.
        let loose = document.loose_solids();
        for entry in loose.into_iter().chain(document.root.entries_of("solids")) {
            if reached.insert(&entry.key) {
                self.draft(&Placed::of_solid(entry))?;
                document.reach(&entry.value, &mut reached);
            }
        }
        Ok(())
    }

    fn placed(&self, value: &'d Value, number: usize) -> Outcome<Placed<'d>> {
        let object = value.table();
        let Some(solid) = object.and_then(|table| table.get("solid")) else {
            let span = value.span.start..value.span.end.min(value.span.start + 80);
            let error = Diagnostic::error(span, "an object has a `solid`", "`solid` is missing");
            return Err(error
                .with_help("write solid = \"name\", or a table such as { formula = \"…\" }")
                .into());
        };
        if solid.table().is_some() {
            return Ok(Placed { name: format!("object {}", number + 1), object, solid });
        }
        let entry = self.numbers.document().named("solids", solid)?;
        Ok(Placed { name: entry.key.clone(), object, solid: &entry.value })
    }

    /// An object but for its bounds.
    fn draft(&self, placed: &Placed<'d>) -> Outcome<Draft> {
        let mut composer = Composer::new(self.numbers);
        let (space, base) = self.place(&mut composer, placed)?;
        let named = self.numbers.document().entry("solids", &placed.name);
        if named.is_some_and(|entry| std::ptr::eq(&raw const entry.value, placed.solid)) {
            composer.begin(&placed.name);
        }
        let look = Look { material: placed.get("material"), back: placed.get("back") };
        let built = match placed.solid.table() {
            Some(table) => composer.body(placed.solid, (table, &placed.name), &space, look)?,
            None => composer.definition(placed.solid, &placed.name, &space, look)?,
        };
        let conditions = conditions(&mut composer, placed, &space)?;
        let shown = composer.shown.as_ref().filter(|_| is_file(placed.solid));
        let ball = self.ball(placed, shown)?;
        let surface = placed.flag("surface").unwrap_or(shown.is_some_and(|s| s.surface));
        let bounds = placed.get("bounds").map(|value| view::bounds(self.numbers, value)).transpose()?;
        let copies = copies(self.numbers, placed.object)?.into_iter().map(|copy| copy * base).collect();
        let Composer { graph, parts, fuel, ups, .. } = composer;
        Ok(Draft { graph, parts, fuel, ups, built, conditions, surface, ball, bounds, copies })
    }

    /// The space in which an object is composed, and the motion of all that stands in it. Where space is mapped by more
    /// than motions, what comes before is part of the program.
    fn place(&self, composer: &mut Composer<'n, 'd>, placed: &Placed<'d>) -> Outcome<(Space, DAffine3)> {
        let tables = [placed.solid.table(), placed.object];
        let transforms = tables.into_iter().flatten().filter_map(|table| table.get("transform"));
        let mut steps = steps(self.numbers, transforms)?;
        let base = match steps.last() {
            Some(&Step::Motion(last)) => {
                steps.pop();
                last
            }
            _ => DAffine3::IDENTITY,
        };
        let space = composer.space();
        Ok((composer.stepped(&space, &steps), base))
    }

    fn add(&mut self, placed: &Placed<'d>, draft: Draft, found: Option<Bounds>) -> Outcome<()> {
        self.ups = (self.ups.0 || draft.ups.0, self.ups.1 || draft.ups.1);
        let number = self.solids.len();
        if self.instances.len() + draft.copies.len() > MAX_ALL_INSTANCES {
            return Err(
                placed.error(format!("a scene has at most {MAX_ALL_INSTANCES} copies of objects in all"))
            );
        }
        for &motion in &draft.copies {
            let is_still = motion == DAffine3::IDENTITY;
            let instance =
                if is_still { Some(Instance::unmoved(number)) } else { Instance::new(number, motion) };
            let flat = || placed.error("a motion that cannot be taken back: it flattens space".to_owned());
            self.instances.push(instance.ok_or_else(flat)?);
        }
        let Some(bounds) = found.or(draft.bounds) else {
            return Err(placed.error("no bounds were found".to_owned()));
        };
        let solid = self.solid(placed, draft, bounds)?;
        self.solids.push(solid);
        self.objects.push(placed.name.clone());
        Ok(())
    }

    fn solid(&self, placed: &Placed<'d>, draft: Draft, bounds: Bounds) -> Outcome<Solid> {
        let Draft { graph, parts, fuel, built, conditions, surface, ball, .. } = draft;
        let mut attributes = Attributes::default();
        let parts =
            finished(&mut attributes, &parts, built.value).map_err(|e| placed.error(e.to_string()))?;
        let conditions = conditions.into_iter().map(|(node, positive)| {
            let attribute = attributes.place(&[node]);
            Condition { attribute, positive }
        });
        let conditions = conditions.collect();
        let field = Field::new(graph, built.value, attributes.nodes);
        let field = match fuel {
            Some(fuel) => field.with_fuel(fuel),
            None => field,
        };
        let get = |key: &str| placed.get(key);
        let method = view::method(self.numbers, get)?;
        let tolerance = get("tolerance").map(|value| self.numbers.number(value)).transpose()?;
        Solid::new(field, Bindings::new(), bounds)
            .with_caps(!placed.flag("open").unwrap_or(false))
            .with_surface(surface)
            .with_clip_ball(ball)
            .with_parts(parts, built.tree)
            .and_then(|solid| solid.with_conditions(conditions))
            .and_then(|solid| solid.with_method(method, tolerance))
            .map_err(|error| placed.error(error.to_string()))
    }

    fn ball(&self, placed: &Placed<'d>, shown: Option<&Presentation>) -> Outcome<Option<Ball>> {
        let Some(value) = placed.get("clip_sphere") else {
            let ball = shown.map_or(Ok(None), crate::presentation::clip_ball);
            return ball.map_err(|error| placed.error(error.to_string()));
        };
        let [x, y, z, radius] = self.numbers.numbers(value)?;
        let ball = Ball::new(DVec3::new(x, y, z), radius);
        Ok(Some(ball.map_err(|error| value.error(error.to_string(), "no sphere"))?))
    }
}

fn is_file(solid: &Value) -> bool {
    solid.table().is_some_and(|table| table.get("file").is_some())
}

fn finished(
    attributes: &mut Attributes,
    parts: &[PartDraft],
    whole: NodeId,
) -> Result<Vec<fieldstone_scene::Part>, fieldstone_scene::MaterialError> {
    parts.iter().map(|part| attributes.part(part, whole)).collect()
}

/// The conditions of an object: what decides, and whether it must be positive.
fn conditions<'d>(
    composer: &mut Composer<'_, 'd>,
    placed: &Placed<'d>,
    space: &Space,
) -> Outcome<Vec<(NodeId, bool)>> {
    let mut conditions = Vec::new();
    let Some(list) = placed.get("where") else { return Ok(conditions) };
    for value in list.one_or_many() {
        let text = value.text().unwrap_or_default();
        let sign = text.find(['<', '>']);
        let Some(at) = sign else {
            let error = value.error("a condition compares two formulas", "there is no < or >");
            return Err(error.with_help("write \"a > 0\", \"a < b\", \"a <= b\" or \"a >= b\"").into());
        };
        let behind = at + if text[at + 1..].starts_with('=') { 2 } else { 1 };
        let left = composer.formula_in(value, &text[..at], space)?;
        // Blanks in the place of the left side keep the places of the right side.
        let right = " ".repeat(behind) + &text[behind..];
        let right = composer.formula_in(value, &right, space)?;
        conditions.push((composer.graph.sub(left, right), text[at..].starts_with('>')));
    }
    Ok(conditions)
}
