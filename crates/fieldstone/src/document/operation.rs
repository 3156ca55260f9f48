//! Operations on solids beyond the set operations of lists: blends, and solids on their way into others.
//!
//! New operations are a key in the [table](super::keys), an arm in [`Composer::body`] and a method here, which gives the
//! field and one part whose materials have shares.

use super::compose::{Built, Composer, Look, PartDraft, Space};
use super::expression::Names;
use super::fault::Outcome;
use super::material::MaterialDraft;
use super::tree::{EMPTY, Table, Value};
use fieldstone_field::{Graph, NodeId};
use fieldstone_lang::Diagnostic;
use fieldstone_scene::Tree;
use fieldstone_solids::{Blend, Blended, Joint, gaussian, join, linear, offset, shell, sigmoid};

/// How the set operations of a solid are computed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct SetOperations {
    /// By R-functions; by minima and maxima otherwise.
    smooth: bool,
}

impl SetOperations {
    /// Those that a table of a solid asks for.
    pub(super) fn of(table: &Table) -> Self {
        Self { smooth: table.get("set_operations").and_then(Value::text) == Some("r") }
    }

    pub(super) fn union(self, graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
        if self.smooth { graph.rmin(a, b) } else { graph.min(a, b) }
    }

    pub(super) fn intersection(self, graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
        if self.smooth { graph.rmax(a, b) } else { graph.max(a, b) }
    }
}

/// The materials of a solid, each with its share if there are several.
type Shares = Vec<(MaterialDraft, Option<NodeId>)>;

impl<'d> Composer<'_, 'd> {
    /// (1 − share)·f + share·g; the materials go over into each other likewise.
    pub(super) fn metamorphosis(
        &mut self,
        value: &'d Value,
        name: &str,
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let get = |key: &str| value.table().and_then(|table| table.get(key));
        let (Some(from), Some(to), Some(share)) = (get("from"), get("to"), get("share")) else {
            let error = value.error("a metamorphosis has `from`, `to` and `share`", "incomplete");
            return Err(error.with_help("write { from = \"a\", to = \"b\", share = \"t\" }").into());
        };
        let share = self.numbers.ranged(share, (0.0, 1.0, "from 0 to 1"))?;
        let first = self.parts.len();
        let (from, from_shares) = self.absorbed(from, space, look)?;
        let (to, to_shares) = self.absorbed(to, space, look)?;
        let weight = self.graph.constant(share);
        let one = self.graph.constant(1.0);
        let rest = self.graph.sub(one, weight);
        let field = linear(&mut self.graph, from, to, weight).value;
        let mut shares = self.scaled(from_shares, rest);
        shares.extend(self.scaled(to_shares, weight));
        Ok(self.blended(name, field, (first, shares)))
    }

    /// What `offset` and `shell` of a table make of a solid, one after the other. Its parts become parts of what it is
    /// then: a wall has them on both sides.
    pub(super) fn grown(&mut self, built: Built, table: &Table) -> Outcome<Built> {
        let Built { mut value, mut tree } = built;
        if let Some(distance) = table.get("offset") {
            let distance = self.numbers.number(distance)?;
            let distance = self.graph.constant(distance);
            value = offset(&mut self.graph, value, distance);
            tree = self.moved_out(tree, distance);
        }
        if let Some(thickness) = table.get("shell") {
            let thickness = self.numbers.ranged(thickness, (f64::MIN_POSITIVE, f64::MAX, "above 0"))?;
            let (half, inward) =
                (self.graph.constant(0.5 * thickness), self.graph.constant(-0.5 * thickness));
            let thickness = self.graph.constant(thickness);
            value = shell(&mut self.graph, value, thickness);
            if !matches!(tree, Tree::Part(_)) {
                let inner = self.copied(&tree);
                let inner = Tree::Complement(Box::new(self.moved_out(inner, inward)));
                tree = Tree::Intersection(vec![self.moved_out(tree, half), inner]);
            }
        }
        if let Tree::Part(part) = tree {
            self.parts[part].field = value;
        }
        Ok(Built { value, tree })
    }

    /// A tree whose parts are grown by a distance; what is taken away shrinks.
    fn moved_out(&mut self, tree: Tree, distance: NodeId) -> Tree {
        match tree {
            Tree::Part(part) => {
                self.parts[part].field = offset(&mut self.graph, self.parts[part].field, distance);
                tree
            }
            Tree::Complement(inner) => {
                let inward = self.graph.neg(distance);
                Tree::Complement(Box::new(self.moved_out(*inner, inward)))
            }
            Tree::Union(trees) => {
                Tree::Union(trees.into_iter().map(|tree| self.moved_out(tree, distance)).collect())
            }
            Tree::Intersection(trees) => {
                Tree::Intersection(trees.into_iter().map(|tree| self.moved_out(tree, distance)).collect())
            }
        }
    }

    /// A tree of copies of the parts of another.
    fn copied(&mut self, tree: &Tree) -> Tree {
        match tree {
            Tree::Part(part) => {
                let copy = self.parts[*part].clone();
                self.parts.push(PartDraft { name: format!("{} (inner side)", copy.name), ..copy });
                Tree::Part(self.parts.len() - 1)
            }
            Tree::Complement(inner) => Tree::Complement(Box::new(self.copied(inner))),
            Tree::Union(trees) => Tree::Union(trees.iter().map(|tree| self.copied(tree)).collect()),
            Tree::Intersection(trees) => {
                Tree::Intersection(trees.iter().map(|tree| self.copied(tree)).collect())
            }
        }
    }

    /// A solid whose parts are no parts of what is composed, with its materials.
    fn absorbed(&mut self, value: &'d Value, space: &Space, look: Look<'d>) -> Outcome<(NodeId, Shares)> {
        let first = self.parts.len();
        let built = self.operand(value, space, look)?;
        let parts: Vec<PartDraft> = self.parts.drain(first..).collect();
        let several = parts.len() > 1;
        let mut shares = Vec::new();
        for part in parts {
            let near = if several { Some(self.nearness(part.field)) } else { None };
            for (material, share) in part.materials {
                let share = match (near, share) {
                    (Some(near), Some(share)) => Some(self.graph.mul(near, share)),
                    (near, share) => near.or(share),
                };
                shares.push((material, share));
            }
        }
        Ok((built.value, shares))
    }

    /// How near a place is to the surface of a field: 1/(f² + 10⁻¹²).
    fn nearness(&mut self, field: NodeId) -> NodeId {
        let (square, least, one) =
            (self.graph.square(field), self.graph.constant(1e-12), self.graph.constant(1.0));
        let sum = self.graph.add(square, least);
        self.graph.div(one, sum)
    }

    /// Shares times a weight.
    fn scaled(&mut self, shares: Shares, weight: NodeId) -> Shares {
        let scale = |(material, share): (MaterialDraft, Option<NodeId>)| {
            let share = share.map_or(weight, |share| self.graph.mul(share, weight));
            (material, Some(share))
        };
        shares.into_iter().map(scale).collect()
    }

    /// The one part of a blend, after those before `first`.
    fn blended(&mut self, name: &str, field: NodeId, (first, mut materials): (usize, Shares)) -> Built {
        self.parts.truncate(first);
        if materials.iter().all(|(material, _)| *material == materials[0].0) {
            materials.truncate(1);
            materials.iter_mut().for_each(|(_, share)| *share = None);
        }
        self.parts.push(PartDraft { name: name.to_owned(), field, materials, back: None });
        Built { value: field, tree: Tree::Part(first) }
    }

    /// Solids that flow into one another.
    pub(super) fn blend(
        &mut self,
        value: &'d Value,
        name: &str,
        space: &Space,
        look: Look<'d>,
    ) -> Outcome<Built> {
        let table = value.table().unwrap_or(&EMPTY);
        let solids = table.get("solids").and_then(Value::list).unwrap_or_default();
        let Some(kind) = table.get("kind").filter(|_| solids.len() >= 2) else {
            let error = value.error("a blend has a `kind` and at least two `solids`", "incomplete");
            return Err(error
                .with_help("write { solids = [\"a\", \"b\"], kind = \"hyperbolic\", c = 0.05 }")
                .into());
        };
        let kind_name = kind.text().unwrap_or_default();
        refuse_other_numbers(table, kind_name)?;
        let numbers = BlendTable { kind: kind_name, table };
        let first = self.parts.len();
        let (mut field, mut shares) = self.absorbed(&solids[0], space, look)?;
        for operand in &solids[1..] {
            let (other, others) = self.absorbed(operand, space, look)?;
            let joint = self.joint(&numbers, (field, other), space, value)?;
            let one = self.graph.constant(1.0);
            let rest = self.graph.sub(one, joint.share);
            shares = self.scaled(shares, rest);
            shares.extend(self.scaled(others, joint.share));
            field = joint.value;
        }
        Ok(self.blended(name, field, (first, shares)))
    }

    /// The blend of two fields, and how much of the second material there is.
    fn joint(
        &mut self,
        numbers: &BlendTable<'d>,
        (f, g): (NodeId, NodeId),
        space: &Space,
        value: &'d Value,
    ) -> Outcome<Blended> {
        const SHARE: Range = (0.0, 1.0, "from 0 to 1");
        const FROM_ZERO: Range = (0.0, f64::MAX, "from 0 on");
        const POSITIVE: Range = (f64::MIN_POSITIVE, f64::MAX, "above 0");
        const ANY: Range = (f64::MIN, f64::MAX, "that is finite");
        let mut number = |key: &str, usual: f64, range: Range| -> Outcome<NodeId> {
            let given = numbers.table.get(key);
            let number = given.map_or(Ok(usual), |value| self.numbers.ranged(value, range))?;
            Ok(self.graph.constant(number))
        };
        let blend = match numbers.kind {
            "linear" => {
                let weight = number("weight", 0.5, SHARE)?;
                return Ok(linear(&mut self.graph, f, g, weight));
            }
            "gaussian" => {
                let sigma = number("sigma", 1.0, POSITIVE)?;
                let drive = self.drive(numbers.table, space)?;
                let rest = gaussian(&mut self.graph, sigma, drive);
                let one = self.graph.constant(1.0);
                let weight = self.graph.sub(one, rest);
                return Ok(linear(&mut self.graph, f, g, weight));
            }
            "sigmoid" => {
                let steepness = number("steepness", 10.0, POSITIVE)?;
                let drive = self.drive(numbers.table, space)?;
                let weight = sigmoid(&mut self.graph, steepness, drive);
                return Ok(linear(&mut self.graph, f, g, weight));
            }
            "product" => Blend::Product { c: number("c", 0.01, FROM_ZERO)? },
            "hyperbolic" => Blend::Hyperbolic { c: number("c", 0.01, FROM_ZERO)? },
            "super-elliptic" => {
                let a = number("radius", 1.0, POSITIVE)?;
                Blend::SuperElliptic { a, b: a, p: number("power", 2.0, (1.0, 1e3, "from 1 on"))? }
            }
            "displacement" => Blend::Displacement {
                a0: number("a0", 0.2, ANY)?,
                a1: number("a1", 1.0, POSITIVE)?,
                a2: number("a2", 1.0, POSITIVE)?,
            },
            "bounded" => {
                let (a0, b) = (number("a0", 0.2, ANY)?, number("b", 1.0, POSITIVE)?);
                let Some(within) = numbers.table.get("within") else {
                    return Err(value.error("a bounded blend has a solid `within`", "incomplete").into());
                };
                let (bound, _) = self.absorbed(within, space, Look::default())?;
                Blend::Bounded { a0, b, bound }
            }
            _ => {
                let k = number("k", 0.2, FROM_ZERO)?;
                let is_cubic = numbers.table.get("degree").and_then(Value::text) == Some("cubic");
                if is_cubic { Blend::Cubic { k } } else { Blend::Quadratic { k } }
            }
        };
        let joint = match numbers.table.get("operation").and_then(Value::text) {
            Some("intersection") => Joint::Intersection,
            Some("difference") => Joint::Difference,
            _ => Joint::Union,
        };
        Ok(join(&mut self.graph, joint, &blend, f, g))
    }

    /// What drives the weight of a transition.
    fn drive(&mut self, table: &'d Table, space: &Space) -> Outcome<NodeId> {
        match table.get("drive") {
            Some(drive) => {
                self.formula(drive, space, Names { parameters: true, fields: true, normal: false })
            }
            None => Ok(self.graph.constant(self.numbers.time())),
        }
    }
}

/// The least and the largest value, and the range in words.
type Range = (f64, f64, &'static str);

/// A blend, as a scene file has it.
struct BlendTable<'d> {
    kind: &'d str,
    table: &'d Table,
}

/// The numbers of each kind of blend.
pub(super) const BLEND_NUMBERS: [(&str, &[&str]); 9] = [
    ("product", &["c", "operation"]),
    ("linear", &["weight"]),
    ("hyperbolic", &["c", "operation"]),
    ("super-elliptic", &["radius", "power", "operation"]),
    ("gaussian", &["sigma", "drive"]),
    ("sigmoid", &["steepness", "drive"]),
    ("displacement", &["a0", "a1", "a2", "operation"]),
    ("bounded", &["a0", "b", "within", "operation"]),
    ("smooth-minimum", &["k", "degree", "operation"]),
];

/// Numbers of other kinds of blends have no meaning.
fn refuse_other_numbers(table: &Table, kind: &str) -> Outcome<()> {
    let own = BLEND_NUMBERS.iter().find(|(name, _)| *name == kind).map_or(&[] as &[&str], |(_, own)| own);
    let is_own = |key: &str| own.contains(&key) || key == "solids" || key == "kind";
    match table.entries.iter().find(|entry| !is_own(&entry.key)) {
        None => Ok(()),
        Some(entry) => {
            let message = format!("`{}` has no meaning with kind = \"{kind}\"", entry.key);
            let error = Diagnostic::error(entry.key_span.clone(), message, "without a meaning");
            Err(error.with_help(format!("it has {}", own.join(", "))).into())
        }
    }
}
