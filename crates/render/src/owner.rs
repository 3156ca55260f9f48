//! Which part of a solid owns a place on its surface.
//!
//! Boolean evaluation on inclusion intervals (Hijazi et al. 2008, §4.4): over the box of a hit's final bracket each part
//! is certainly inside, certainly outside, or open; if one alone is open, it owns the hit. If several are, the signs of
//! all parts at both ends of the bracket tell which of them changes there so that the solid begins or ends. The paper
//! evaluates long accepted spans; so that these need not be any shorter for the sake of parts, a bracket in which
//! several parts change is first halved at the place where the solid begins, by point signs through the set operations.
//! Surfaces that coincide within a bracket belong to the part that stands first.

use fieldstone_field::{F64, Field, Intervals, LANES, Points, Tape, TapeOptions, Workspace};
use fieldstone_scene::{Solid, Tree};
use glam::DVec3;

/// Where a hit certainly is, between two places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bracket {
    pub(crate) before: DVec3,
    pub(crate) behind: DVec3,
    /// Of a cap, the end that lies in the solid.
    pub(crate) cap: Option<DVec3>,
}

/// What a thread needs to find owners.
#[derive(Default)]
pub(crate) struct Memory {
    boxes: Workspace<F64, Intervals>,
    points: Workspace<F64, Points>,
    evaluations: u64,
}

/// Finds the owners of places on a solid of several parts.
pub(crate) struct Owners {
    /// The fields of the parts.
    fields: Tape,
    tree: Tree,
    parts: usize,
    /// Surfaces closer than this coincide.
    same: f64,
}

/// The values of the fields of all parts at a place.
type Values = Vec<f64>;

impl Memory {
    pub(crate) fn take_evaluations(&mut self) -> u64 {
        std::mem::take(&mut self.evaluations)
    }
}

impl Owners {
    /// For a solid, whose surfaces coincide if they are closer than `same`.
    pub(crate) fn new(solid: &Solid, same: f64) -> Self {
        let field = solid.field();
        let of_part = |attribute: Option<usize>| attribute.map_or(field.value(), |a| field.attributes()[a]);
        let fields: Vec<_> = solid.parts().iter().map(|part| of_part(part.field)).collect();
        let outputs =
            Field::new(field.graph().clone(), fields[0], fields[1..].to_vec()).with_fuel(field.fuel());
        let options =
            TapeOptions { bindings: solid.bindings().clone(), attributes: true, ..TapeOptions::default() };
        let fields = Tape::new(&outputs, &options);
        // A bracket reaches as far behind the place as it is long.
        Self { fields, tree: solid.tree().clone(), parts: solid.parts().len(), same: 4.0 * same }
    }

    /// The number of the part that owns each place.
    pub(crate) fn find(&self, memory: &mut Memory, brackets: &[Bracket]) -> Vec<usize> {
        brackets.chunks(LANES).flat_map(|block| self.find_block(memory, block)).collect()
    }

    fn find_block(&self, memory: &mut Memory, block: &[Bracket]) -> Vec<usize> {
        let mut owners: Vec<Option<usize>> = self.only_open_parts(memory, block);
        let rest: Vec<usize> = (0..block.len()).filter(|&i| owners[i].is_none()).collect();
        let mut ends: Vec<(DVec3, DVec3)> = rest
            .iter()
            .map(|&i| block[i].cap.map_or((block[i].before, block[i].behind), |inside| (inside, inside)))
            .collect();
        let [mut before, mut behind] =
            [self.values(memory, ends.iter().map(|e| e.0)), self.values(memory, ends.iter().map(|e| e.1))];
        self.halve(memory, &mut ends, &mut before, &mut behind);
        for ((&i, before), behind) in rest.iter().zip(&before).zip(&behind) {
            let owner = if block[i].cap.is_some() {
                self.tree.holder(&|part| behind[part] < 0.0)
            } else {
                self.by_signs(before, behind)
            };
            owners[i] = owner.or_else(|| closest(behind));
        }
        owners.into_iter().map(|owner| owner.unwrap_or(0)).collect()
    }

    /// The part that alone is open over each bracket, if there is such a part.
    fn only_open_parts(&self, memory: &mut Memory, block: &[Bracket]) -> Vec<Option<usize>> {
        for (lane, bracket) in block.iter().enumerate() {
            let (lo, hi) = (bracket.before.min(bracket.behind), bracket.before.max(bracket.behind));
            for axis in 0..3 {
                memory.boxes.input(axis, 0)[lane] = lo[axis];
                memory.boxes.input(axis, 1)[lane] = hi[axis];
            }
        }
        memory.boxes.run(&self.fields, block.len());
        memory.evaluations += block.len() as u64;
        let status = |lane: usize, part: usize| {
            let (lo, hi) = (memory.boxes.output(part, 0)[lane], memory.boxes.output(part, 1)[lane]);
            if lo > 0.0 {
                Some(false)
            } else if hi < 0.0 {
                Some(true)
            } else {
                None
            }
        };
        let only = |lane: usize| {
            let mut open = (0..self.parts).filter(|&part| status(lane, part).is_none());
            let first = open.next().filter(|_| open.next().is_none())?;
            // What is open is no boundary where the others decide.
            self.tree.decide(&|part| status(lane, part)).is_none().then_some(first)
        };
        block.iter().enumerate().map(|(lane, b)| if b.cap.is_some() { None } else { only(lane) }).collect()
    }

    /// The values of all parts at each place, at most [`LANES`] of them.
    fn values(&self, memory: &mut Memory, places: impl Iterator<Item = DVec3>) -> Vec<Values> {
        let mut count = 0;
        for place in places {
            for axis in 0..3 {
                memory.points.input(axis, 0)[count] = place[axis];
            }
            count += 1;
        }
        if count == 0 {
            return Vec::new();
        }
        memory.points.run(&self.fields, count);
        memory.evaluations += count as u64;
        (0..count)
            .map(|lane| (0..self.parts).map(|part| memory.points.output(part, 0)[lane]).collect())
            .collect()
    }

    /// Halves long brackets around the place where the solid begins or ends.
    fn halve(
        &self,
        memory: &mut Memory,
        ends: &mut [(DVec3, DVec3)],
        before: &mut [Values],
        behind: &mut [Values],
    ) {
        // Every turn halves: no bracket is longer than the solid, and none shorter than 2⁻⁵² of it.
        for _ in 0..52 {
            let differ = |i: usize| self.contains(&before[i]) != self.contains(&behind[i]);
            let is_long = |i: usize| (ends[i].1 - ends[i].0).length() > self.same;
            let open: Vec<usize> = (0..ends.len()).filter(|&i| is_long(i) && differ(i)).collect();
            if open.is_empty() {
                return;
            }
            let middles: Vec<DVec3> = open.iter().map(|&i| 0.5 * (ends[i].0 + ends[i].1)).collect();
            let values = self.values(memory, middles.iter().copied());
            for ((&i, middle), values) in open.iter().zip(middles).zip(values) {
                if self.contains(&values) == self.contains(&before[i]) {
                    (ends[i].0, before[i]) = (middle, values);
                } else {
                    (ends[i].1, behind[i]) = (middle, values);
                }
            }
        }
    }

    fn contains(&self, values: &[f64]) -> bool {
        self.tree.contains(&|part| values[part] < 0.0)
    }

    /// The first part whose change makes the solid begin or end; of several that do so only together, the first.
    fn by_signs(&self, before: &[f64], behind: &[f64]) -> Option<usize> {
        let changed = |&part: &usize| (before[part] < 0.0) != (behind[part] < 0.0);
        let flips = |values: &[f64], part: usize| {
            let flipped = self.tree.contains(&|p| (values[p] < 0.0) != (p == part));
            flipped != self.contains(values)
        };
        let mut deciding = (0..self.parts).filter(changed);
        let alone = deciding.find(|&part| flips(before, part) || flips(behind, part));
        alone.or_else(|| (0..self.parts).find(changed))
    }
}

/// The part whose field is closest to 0: in a blend none changes its sign.
fn closest(values: &[f64]) -> Option<usize> {
    let size = |part: &usize| if values[*part].is_nan() { f64::INFINITY } else { values[*part].abs() };
    (0..values.len()).min_by(|a, b| size(a).total_cmp(&size(b)))
}
