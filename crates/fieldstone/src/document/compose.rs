//! Solids composed to one program.
//!
//! Every object has a program of its own. Formulas, models and named fields are copied into it with other nodes in the
//! place of their inputs: moved coordinates, the values of parameters, the time. What becomes of the parts of a solid,
//! so that each place of its surface has a material, stands beside it in [`PartDraft`]s and a [`Tree`].

use super::expression::{self, Expression, NORMAL, Names};
use super::fault::{Fault, Outcome};
use super::keys::{OF_OBJECTS, SOURCES};
use super::map::{Plane, unit};
use super::material::MaterialDraft;
use super::motion::steps;
use super::number::Numbers;
use super::operation::SetOperations;
use super::primitive::PRIMITIVES;
use super::tree::{EMPTY, Kind, Table, Value};
use super::{MAX_DEPTH, MAX_SOLIDS};
use crate::load::{LoadOptions, Loaded};
use fieldstone_field::{Graph, Input, NodeId};
use fieldstone_lang::{Diagnostic, Dialect, Presentation, UpAxis};
use fieldstone_scene::{NORMAL_INPUTS, Tree};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;

/// The coordinates of a solid's own space, and the outward normal in it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Space {
    pub(super) point: [NodeId; 3],
    pub(super) normal: [NodeId; 3],
}

/// What a solid is made of unless it says so itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look<'d> {
    pub(super) material: Option<&'d Value>,
    pub(super) back: Option<&'d Value>,
}

/// A part of an object.
#[derive(Clone, Debug)]
pub(super) struct PartDraft {
    pub(super) name: String,
    /// Negative inside of the part.
    pub(super) field: NodeId,
    /// What it is made of, with shares where several materials meet.
    pub(super) materials: Vec<(MaterialDraft, Option<NodeId>)>,
    pub(super) back: Option<MaterialDraft>,
}

/// A composed solid.
#[derive(Clone, Debug)]
pub(super) struct Built {
    /// Negative inside.
    pub(super) value: NodeId,
    /// How its parts make it up.
    pub(super) tree: Tree,
}

/// The copies of named fields, by the coordinates that they were made for.
type Fields = HashMap<(String, [NodeId; 3]), NodeId>;

/// The program of an object on its way.
pub(super) struct Composer<'n, 'd> {
    pub(super) numbers: &'n Numbers<'d>,
    pub(super) graph: Graph,
    pub(super) parts: Vec<PartDraft>,
    /// The fewest turns that loops of a model may take at a point.
    pub(super) fuel: Option<u32>,
    /// The kinds of models that it holds: (y up, z up).
    pub(super) ups: (bool, bool),
    /// How the last model that was read wants to be shown.
    pub(super) shown: Option<Presentation>,
    fields: Fields,
    /// What w stands for; 0 if nothing.
    fourth: Option<NodeId>,
    /// Names of the solids and fields that are being composed.
    open: Vec<String>,
    depth: usize,
    count: usize,
}

impl<'n, 'd> Composer<'n, 'd> {
    pub(super) fn new(numbers: &'n Numbers<'d>) -> Self {
        let (graph, parts, fields, open, shown) = Default::default();
        Self {
            numbers,
            graph,
            parts,
            fuel: None,
            ups: (false, false),
            shown,
            fields,
            fourth: None,
            open,
            depth: 0,
            count: 0,
        }
    }

    /// Says which solid is being composed.
    pub(super) fn begin(&mut self, name: &str) {
        self.open.push(name.to_owned());
    }

    /// The space of the object.
    pub(super) fn space(&mut self) -> Space {
        let point = [0, 1, 2].map(|k| self.graph.input(Input::Coordinate(k)));
        Space { point, normal: NORMAL_INPUTS.map(|input| self.graph.input(input)) }
    }

    /// Gives w another meaning; [`restore_fourth`](Self::restore_fourth) takes what this returns.
    pub(super) fn change_fourth(&mut self, fourth: Option<NodeId>) -> (Fields, Option<NodeId>) {
        let known = std::mem::take(&mut self.fields);
        (known, std::mem::replace(&mut self.fourth, fourth))
    }

    pub(super) fn restore_fourth(&mut self, (fields, fourth): (Fields, Option<NodeId>)) {
        (self.fields, self.fourth) = (fields, fourth);
    }

    /// A solid where one is needed: a name, or a table.
    pub(super) fn operand(&mut self, value: &'d Value, space: &Space, look: Look<'d>) -> Outcome<Built> {
        self.enter(value)?;
        let built = match &value.kind {
            Kind::Table(table) => {
                refuse_object_keys(table)?;
                self.table(value, (table, "part"), space, look)
            }
            _ => self.named(value, space, look),
        };
        self.depth -= 1;
        built
    }

    fn named(&mut self, value: &'d Value, space: &Space, look: Look<'d>) -> Outcome<Built> {
        let entry = self.numbers.document().named("solids", value)?;
        if self.open.contains(&entry.key) {
            let path = format!("{} → {}", self.open.join(" → "), entry.key);
            return Err(value
                .error(format!("the solid `{}` is part of itself: {path}", entry.key), "a circle")
                .into());
        }
        if let Some(table) = entry.value.table() {
            refuse_object_keys(table)?;
        }
        self.open.push(entry.key.clone());
        let built = self.definition(&entry.value, &entry.key, space, look);
        self.open.pop();
        built
    }

    /// What stands behind the name of a solid: a formula, or a table.
    pub(super) fn definition(
        &mut self,
        value: &'d Value,
        name: &str,
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        match &value.kind {
            Kind::Table(table) => self.table(value, (table, name), space, look),
            _ => {
                let field =
                    self.formula(value, space, Names { parameters: true, fields: true, normal: false })?;
                self.leaf(name, field, (space, look, &[]))
            }
        }
    }

    /// Counts what is composed, and how deeply.
    fn enter(&mut self, value: &Value) -> Outcome<()> {
        self.count += 1;
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(value
                .error(format!("solids are nested more than {MAX_DEPTH} deep"), "too deep")
                .into());
        }
        if self.count > MAX_SOLIDS {
            let message =
                format!("an object is composed of more than {MAX_SOLIDS} solids, counted as often as used");
            return Err(value.error(message, "too many").into());
        }
        Ok(())
    }

    fn table(
        &mut self,
        value: &'d Value,
        (table, name): (&'d Table, &str),
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let look =
            Look { material: table.get("material").or(look.material), back: table.get("back").or(look.back) };
        let steps = steps(self.numbers, table.get("transform"))?;
        let moved = self.stepped(space, &steps);
        self.body(value, (table, name), &moved, look)
    }

    /// A solid without its own motion.
    pub(super) fn body(
        &mut self,
        value: &'d Value,
        (table, name): (&'d Table, &str),
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let source = source(value, table)?;
        let first = self.parts.len();
        let set = SetOperations::of(table);
        let built = match (source.key.as_str(), &source.value) {
            ("file", file) => self.model(file, (table, name), space, look),
            ("union", list) => self.operation(list, space, look, |g, a, b| set.union(g, a, b), Tree::Union),
            ("intersection", list) => {
                self.operation(list, space, look, |g, a, b| set.intersection(g, a, b), Tree::Intersection)
            }
            ("difference", list) => self.difference(list, space, look, set),
            ("complement", inner) => {
                let inner = self.operand(inner, space, look)?;
                let value = self.graph.neg(inner.value);
                Ok(Built { value, tree: Tree::Complement(Box::new(inner.tree)) })
            }
            ("blend", blend) => self.blend(blend, name, space, look),
            ("metamorphosis", table) => self.metamorphosis(table, name, space, look),
            (key, table) if PRIMITIVES.contains(&key) => self.primitive((key, table), name, space, look),
            (_, formula) => {
                let names = Names { parameters: true, fields: true, normal: false };
                let field = self.formula_of(formula, table, (space, names))?;
                self.leaf(name, field, (space, look, &[]))
            }
        }?;
        let built = self.merged(built, name, first);
        let built = self.grown(built, table)?;
        match table.get("section") {
            Some(sections) => self.cut(built, sections, space, look),
            None => Ok(built),
        }
    }

    /// A set operation on a list of solids.
    fn operation(
        &mut self,
        list: &'d Value,
        space: &Space,
        look: Look<'d>,
        join: impl Fn(&mut Graph, NodeId, NodeId) -> NodeId,
        tree: impl Fn(Vec<Tree>) -> Tree,
    ) -> Outcome<Built> {
        let mut all: Option<(NodeId, Vec<Tree>)> = None;
        for operand in list.list().unwrap_or_default() {
            let next = self.operand(operand, space, look)?;
            all = Some(match all {
                None => (next.value, vec![next.tree]),
                Some((value, mut trees)) => {
                    trees.push(next.tree);
                    (join(&mut self.graph, value, next.value), trees)
                }
            });
        }
        let (value, trees) =
            all.ok_or_else(|| Fault::from(list.error("a list of solids is needed", "empty")))?;
        Ok(Built { value, tree: tree(trees) })
    }

    fn difference(
        &mut self,
        list: &'d Value,
        space: &Space,
        look: Look<'d>,
        set: SetOperations,
    ) -> Outcome<Built> {
        let mut first = true;
        // What is taken away is turned inside out as it comes.
        let complement = |built: Built, graph: &mut Graph| Built {
            value: graph.neg(built.value),
            tree: Tree::Complement(Box::new(built.tree)),
        };
        let mut all: Option<(NodeId, Vec<Tree>)> = None;
        for operand in list.list().unwrap_or_default() {
            let next = self.operand(operand, space, look)?;
            let next = if first { next } else { complement(next, &mut self.graph) };
            first = false;
            all = Some(match all {
                None => (next.value, vec![next.tree]),
                Some((value, mut trees)) => {
                    trees.push(next.tree);
                    (set.intersection(&mut self.graph, value, next.value), trees)
                }
            });
        }
        let (value, trees) =
            all.ok_or_else(|| Fault::from(list.error("a list of solids is needed", "empty")))?;
        Ok(Built { value, tree: Tree::Intersection(trees) })
    }

    /// Cut by planes. A cut with a material is a part of its own; without, it is of the parts that it goes through.
    fn cut(&mut self, built: Built, sections: &'d Value, space: &Space, look: Look<'d>) -> Outcome<Built> {
        let Built { mut value, mut tree } = built;
        for section in sections.one_or_many() {
            let table = section.table();
            let get = |key: &str| table.and_then(|table| table.get(key));
            let Plane { normal, offset } = Plane::read(self.numbers, section)?;
            let plane = self.linear(space.point, normal, -offset);
            value = self.graph.max(value, plane);
            tree = match get("material") {
                Some(material) => {
                    let look = Look { material: Some(material), back: None };
                    let face = self.leaf("section", plane, (space, look, &[]))?;
                    Tree::Intersection(vec![tree, face.tree])
                }
                None => self.parted(tree, plane, (space, look))?,
            };
        }
        Ok(Built { value, tree })
    }

    /// A tree below a plane in which the parts themselves end at the plane, so that the cut is of what it goes through.
    /// What is only the complement of others has no part of its own that could end: there the plane is one.
    fn parted(&mut self, tree: Tree, plane: NodeId, at: (&Space, Look<'d>)) -> Outcome<Tree> {
        Ok(match tree {
            Tree::Part(part) => {
                self.parts[part].field = self.graph.max(self.parts[part].field, plane);
                tree
            }
            Tree::Union(trees) => {
                let trees = trees.into_iter().map(|tree| self.parted(tree, plane, at));
                Tree::Union(trees.collect::<Outcome<_>>()?)
            }
            Tree::Intersection(mut trees) if trees.iter().any(|tree| !is_complement(tree)) => {
                // One that ends there is enough; the cut is of the first.
                if let Some(first) = trees.iter_mut().find(|tree| !is_complement(tree)) {
                    let whole = std::mem::replace(first, Tree::Union(Vec::new()));
                    *first = self.parted(whole, plane, at)?;
                }
                Tree::Intersection(trees)
            }
            other => {
                let look = Look { back: None, ..at.1 };
                let face = self.leaf("section", plane, (at.0, look, &[]))?;
                Tree::Intersection(vec![other, face.tree])
            }
        })
    }

    /// The parts from `first` on as one, if nothing tells them apart.
    fn merged(&mut self, built: Built, name: &str, first: usize) -> Built {
        let Some((one, others)) = self.parts[first..].split_first() else { return built };
        let same = |part: &PartDraft| part.materials == one.materials && part.back == one.back;
        if others.is_empty() || !others.iter().all(same) {
            return built;
        }
        self.parts.truncate(first + 1);
        self.parts[first].field = built.value;
        name.clone_into(&mut self.parts[first].name);
        Built { tree: Tree::Part(first), ..built }
    }

    /// A solid of one material.
    pub(super) fn leaf(
        &mut self,
        name: &str,
        field: NodeId,
        (space, look, attributes): (&Space, Look<'d>, &[NodeId]),
    ) -> Outcome<Built> {
        let material = self.material(look.material, space, attributes)?;
        let back = look.back.map(|back| self.material(Some(back), space, attributes)).transpose()?;
        let materials = vec![(material, None)];
        self.parts.push(PartDraft { name: name.to_owned(), field, materials, back });
        Ok(Built { value: field, tree: Tree::Part(self.parts.len() - 1) })
    }

    fn model(
        &mut self,
        file: &'d Value,
        (table, name): (&'d Table, &str),
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let dialect = match table.get("dialect").and_then(Value::text) {
            Some("strict") => Dialect::Strict,
            _ => Dialect::Lenient,
        };
        let object = table.get("object").and_then(Value::text).map(str::to_owned);
        let fuel =
            table.get("fuel").map(|fuel| self.numbers.number(fuel)).transpose()?.map(|fuel| fuel as u32);
        let loaded = self.numbers.document().files.model(file, (LoadOptions { object, dialect }, fuel))?;
        let model = &loaded.model;
        let inputs = self.inputs_of(file, table, &loaded)?;
        if model.field.has_loops() {
            let fuel = model.field.fuel();
            self.fuel = Some(self.fuel.map_or(fuel, |known| known.min(fuel)));
        }
        match model.up {
            UpAxis::Y => self.ups.0 = true,
            UpAxis::Z => self.ups.1 = true,
        }
        self.shown = Some(model.presentation.clone());
        let mut outputs = vec![model.field.value()];
        outputs.extend(model.field.attributes());
        let copied = self.graph.import(model.field.graph(), &outputs, |g, input| match input {
            Input::Coordinate(k) if k < 3 => space.point[usize::from(k)],
            other => g.constant(inputs.get(other)),
        });
        let attributes = if model.has_attributes { &copied[1..] } else { &[] };
        self.leaf(name, copied[0], (space, look, attributes))
    }

    /// The values of parameters and coordinates of a model.
    fn inputs_of(&self, file: &Value, table: &Table, loaded: &Loaded) -> Outcome<fieldstone_field::Bindings> {
        let mut inputs = crate::Inputs { time: self.numbers.time(), ..crate::Inputs::default() };
        for entry in table.entries_of("parameters") {
            inputs.parameters.push((entry.key.clone(), self.numbers.number(&entry.value)?));
            inputs.bindings(&loaded.model).map_err(|error| {
                Diagnostic::error(entry.key_span.clone(), error.to_string(), "unknown parameter")
            })?;
        }
        for entry in table.entries_of("coordinates") {
            let wrong = || {
                let message = format!("`{}` is not a coordinate that can be set", entry.key);
                let error = Diagnostic::error(entry.key_span.clone(), message, "expected 4 or more");
                error.with_help("the first three are x, y and z; further ones are counted from 4")
            };
            let number = entry.key.parse::<usize>().ok().filter(|n| *n > 3).ok_or_else(wrong)?;
            inputs.coordinates.push((number, self.numbers.number(&entry.value)?));
            inputs.bindings(&loaded.model).map_err(|_| wrong())?;
        }
        inputs.bindings(&loaded.model).map_err(|error| file.error(error.to_string(), "here").into())
    }

    /// A formula of a space.
    pub(super) fn formula(&mut self, value: &'d Value, space: &Space, names: Names) -> Outcome<NodeId> {
        self.formula_of(value, &EMPTY, (space, names))
    }

    /// A formula of a space with the values of its own parameters, which stand in a table of a solid.
    fn formula_of(&mut self, value: &'d Value, table: &Table, at: (&Space, Names)) -> Outcome<NodeId> {
        match &value.kind {
            Kind::Number(number) => Ok(self.graph.constant(*number)),
            Kind::Text(text) => {
                let mut given = HashMap::new();
                for entry in table.entries_of("parameters") {
                    given.insert(entry.key.clone(), (self.numbers.number(&entry.value)?, &entry.key_span));
                }
                let read = expression::read(self.numbers.document(), value, text, at.1)?;
                let is_own = |name: &String| {
                    read.model.parameters.iter().any(|p| p.name == *name) && !read.names.contains(name)
                };
                if let Some((name, (_, span))) = given.iter().find(|(name, _)| !is_own(name)) {
                    let message = format!("the formula has no parameter `{name}` of its own");
                    let error = Diagnostic::error((*span).clone(), message, "unknown parameter");
                    return Err(error
                        .with_help("parameters of a formula are defined in it: \"r = 1; …\"")
                        .into());
                }
                let given = given.into_iter().map(|(name, (number, _))| (name, number)).collect();
                self.import(value, &read, (at.0, &given))
            }
            _ => Err(value.error("a formula is needed", "expected a formula in quotes").into()),
        }
    }

    /// A part of a text as a formula; what stands around it is left out.
    pub(super) fn formula_in(&mut self, value: &'d Value, part: &str, space: &Space) -> Outcome<NodeId> {
        let names = Names { parameters: true, fields: true, normal: false };
        let read = expression::read(self.numbers.document(), value, part, names)?;
        self.import(value, &read, (space, &HashMap::new()))
    }

    fn import(
        &mut self,
        value: &'d Value,
        read: &Expression,
        (space, given): (&Space, &HashMap<String, f64>),
    ) -> Outcome<NodeId> {
        let mut known: HashMap<&str, NodeId> = HashMap::new();
        for name in &read.names {
            let node = match self.numbers.parameter(name, value)? {
                Some(number) => self.graph.constant(number),
                None => match NORMAL.iter().position(|n| n == name) {
                    Some(axis) if self.numbers.document().field(name).is_none() => space.normal[axis],
                    _ => self.field(name, value, space)?,
                },
            };
            known.insert(name, node);
        }
        let (time, fourth) = (self.numbers.time(), self.fourth);
        let field = &read.model.field;
        let nodes = self.graph.import(field.graph(), &[field.value()], |g, input| match input {
            Input::Coordinate(k) if k < 3 => space.point[usize::from(k)],
            Input::Coordinate(_) => fourth.unwrap_or_else(|| g.constant(0.0)),
            Input::Time => g.constant(time),
            Input::Parameter(_) => match read.parameter(input) {
                Some(parameter) => match known.get(parameter.name.as_str()) {
                    Some(node) => *node,
                    None => {
                        let number = given.get(&parameter.name).copied().unwrap_or(parameter.default);
                        g.constant(number)
                    }
                },
                None => g.constant(0.0),
            },
        });
        Ok(nodes[0])
    }

    /// A named field of the scene in a space.
    pub(super) fn field(&mut self, name: &str, used_at: &Value, space: &Space) -> Outcome<NodeId> {
        let key = (name.to_owned(), space.point);
        if let Some(&node) = self.fields.get(&key) {
            return Ok(node);
        }
        let document = self.numbers.document();
        let Some(entry) = document.field(name) else {
            return Err(used_at.error(format!("there is no field `{name}`"), "unknown").into());
        };
        // A solid may have the name of a field.
        let called = format!("field {name}");
        if self.open.contains(&called) {
            let path = format!("{} → {called}", self.open.join(" → "));
            let message = format!("the field `{name}` depends on itself: {path}");
            return Err(used_at.error(message, "a circle").into());
        }
        if self.open.len() >= MAX_DEPTH {
            let message = format!("fields depend on more than {MAX_DEPTH} others");
            return Err(used_at.error(message, "too deep").into());
        }
        self.open.push(called);
        let node = self.formula(&entry.value, space, Names { parameters: true, fields: true, normal: false });
        self.open.pop();
        let node = node?;
        self.fields.insert(key, node);
        Ok(node)
    }

    /// The space of a solid that is moved.
    pub(super) fn moved(&mut self, space: &Space, outer_from_inner: &DAffine3) -> Space {
        let inner_from_outer = outer_from_inner.inverse();
        let rows = inner_from_outer.matrix3.transpose();
        let shift = inner_from_outer.translation.to_array();
        let point = std::array::from_fn(|k| self.linear(space.point, rows.col(k), shift[k]));
        // Normals go the other way by the transpose of the map.
        let columns = outer_from_inner.matrix3;
        let turned: [NodeId; 3] = std::array::from_fn(|k| self.linear(space.normal, columns.col(k), 0.0));
        Space { point, normal: unit(&mut self.graph, turned) }
    }

    /// factors · x + constant.
    fn linear(&mut self, x: [NodeId; 3], factors: DVec3, constant: f64) -> NodeId {
        let mut sum = self.graph.constant(constant);
        for (x, factor) in x.into_iter().zip(factors.to_array()) {
            if factor != 0.0 {
                let factor = self.graph.constant(factor);
                let term = self.graph.mul(factor, x);
                sum = self.graph.add(sum, term);
            }
        }
        sum
    }
}

/// The entry that says what a solid is.
fn source<'t>(value: &Value, table: &'t Table) -> Outcome<&'t super::tree::Entry> {
    let mut sources = table.entries.iter().filter(|entry| SOURCES.contains(&entry.key.as_str()));
    let one_of = format!("a solid has exactly one of {}", SOURCES.join(", "));
    match (sources.next(), sources.next()) {
        (Some(only), None) => {
            let of_files = ["object", "dialect", "coordinates", "fuel"];
            let stray =
                table.entries.iter().find(|e| of_files.contains(&e.key.as_str()) && only.key != "file");
            match stray {
                None => Ok(only),
                Some(stray) => {
                    let message = format!("`{}` is for solids from a file", stray.key);
                    Err(Diagnostic::error(stray.key_span.clone(), message, "without a meaning").into())
                }
            }
        }
        (Some(_), Some(second)) => {
            let message = format!("a second description of the solid: `{}`", second.key);
            let error = Diagnostic::error(second.key_span.clone(), message, "one too many");
            Err(error.with_help(one_of).into())
        }
        (None, _) => {
            let span = value.span.start..value.span.end.min(value.span.start + 80);
            let error = Diagnostic::error(span, "nothing says what this solid is", "no description");
            Err(error.with_help(one_of).into())
        }
    }
}

/// Whether a tree is the complement of others.
fn is_complement(tree: &Tree) -> bool {
    matches!(tree, Tree::Complement(_))
}

/// Keys of objects have no meaning in parts of others.
fn refuse_object_keys(table: &Table) -> Outcome<()> {
    match table.entries.iter().find(|entry| OF_OBJECTS.contains(&entry.key.as_str())) {
        None => Ok(()),
        Some(entry) => {
            let message =
                format!("`{}` says how an object is drawn; a part of another solid has none", entry.key);
            let error = Diagnostic::error(entry.key_span.clone(), message, "not in a part");
            Err(error.with_help("put it into the solid that is an object itself, or into [[objects]]").into())
        }
    }
}
