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
use fieldstone_scene::Tree;

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
        let (field, rest) = self.mixed(from, to, weight);
        let mut shares = self.scaled(from_shares, rest);
        shares.extend(self.scaled(to_shares, weight));
        Ok(self.blended(name, field, (first, shares)))
    }

    /// a·(1 − weight) + b·weight, exact at both ends, and 1 − weight.
    fn mixed(&mut self, a: NodeId, b: NodeId, weight: NodeId) -> (NodeId, NodeId) {
        let one = self.graph.constant(1.0);
        let rest = self.graph.sub(one, weight);
        let (from, to) = (self.graph.mul(a, rest), self.graph.mul(b, weight));
        (self.graph.add(from, to), rest)
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
        let numbers = BlendNumbers { kind: kind.text().unwrap_or_default(), table };
        let first = self.parts.len();
        let (mut field, mut shares) = self.absorbed(&solids[0], space, look)?;
        for operand in &solids[1..] {
            let (other, others) = self.absorbed(operand, space, look)?;
            let (joint, weights) = self.joint(&numbers, (field, other), (space, kind))?;
            shares = self.scaled(shares, weights[0]);
            shares.extend(self.scaled(others, weights[1]));
            field = joint;
        }
        Ok(self.blended(name, field, (first, shares)))
    }

    /// The blend of two fields, and how much of each material there is.
    fn joint(
        &mut self,
        numbers: &BlendNumbers<'d>,
        (f, g): (NodeId, NodeId),
        (_space, kind): (&Space, &'d Value),
    ) -> Outcome<(NodeId, [NodeId; 2])> {
        match numbers.kind {
            "linear" => {
                let weight = numbers.table.get("weight");
                let weight = weight.map_or(Ok(0.5), |w| self.numbers.ranged(w, (0.0, 1.0, "from 0 to 1")))?;
                let weight = self.graph.constant(weight);
                let (field, rest) = self.mixed(f, g, weight);
                Ok((field, [rest, weight]))
            }
            _ => Err(kind
                .error(format!("blends of the kind `{}` are not there yet", numbers.kind), "here")
                .into()),
        }
    }
}

/// The kind of a blend with its numbers.
struct BlendNumbers<'d> {
    kind: &'d str,
    table: &'d Table,
}

#[allow(dead_code, reason = "for operations whose drive is a formula of space")]
const DRIVE: Names = Names { parameters: true, fields: true, normal: false };
