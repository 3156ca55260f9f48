//! Dividing cells.

use super::{Cell, Facet, LEVELS, Node, Octree, Place, Programs};
use fieldstone_field::{F64, Interval, Intervals, LANES, Tape, Workspace};
use rustc_hash::FxHashMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};
use typed_arena::Arena;

/// Programs that keep more than this part of their instructions are not worth a copy of their own.
const WORTH_A_COPY: f64 = 0.9;
/// Cells without slopes are divided, from the second level on, only if their programs get shorter than this part.
const PROGRESS: f64 = 0.7;
/// Slopes are looked at from this level on.
const FACETS_FROM: usize = 1;
/// About how many bytes an instruction takes, in both of its forms.
const INSTRUCTION_BYTES: usize = 112;

/// Divides cells; keeps its memory between calls.
#[derive(Debug, Default)]
pub(super) struct Builder {
    boxes: Workspace<F64, Intervals>,
    slopes: Workspace<F64, Intervals>,
    centres: Workspace<F64, Intervals>,
    /// Evaluations of sets so far.
    pub(super) evaluations: u64,
}

/// Some of the 64 cells of a node, by their numbers.
type Numbers = Vec<u32>;

impl Builder {
    /// The cells of an open cell.
    pub(super) fn node(&mut self, tree: &Octree, cell: &Cell, place: Place) -> Node {
        let value = &cell.programs.value;
        let all: Numbers = (0..64).collect();
        tree.fill_boxes(&mut self.boxes, place, &all);
        self.boxes.run_traced(value, LANES);
        self.evaluations += LANES as u64;
        let (lo, hi) = (self.boxes.output(0, 0), self.boxes.output(0, 1));
        let set = |is: &dyn Fn(usize) -> bool| (0..64).fold(0u64, |set, i| set | u64::from(is(i)) << i);
        let (mut outside, mut inside) = (set(&|i| lo[i] > 0.0), set(&|i| hi[i] < 0.0));
        let open: Numbers = all.into_iter().filter(|&i| (outside | inside) >> i & 1 == 0).collect();
        let facets = self.facets(tree, cell, place, &open);
        let half = tree.half(place);
        for (&number, facet) in open.iter().zip(&facets) {
            match facet.map(|facet| facet.range(half)) {
                Some((lo, _)) if lo > 0.0 => outside |= 1 << number,
                Some((_, hi)) if hi < 0.0 => inside |= 1 << number,
                _ => {}
            }
        }
        let kept: Vec<(usize, Option<Facet>)> = (0..open.len())
            .filter(|&i| (outside | inside) >> open[i] & 1 == 0)
            .map(|i| (i, facets[i]))
            .collect();
        let values = self.shortened(&cell.programs.value, &self.boxes, kept.iter().map(|&(i, _)| open[i]));
        let leaves: Vec<bool> = kept
            .iter()
            .zip(&values)
            .map(|(&(_, facet), shorter)| is_leaf(cell, place.level, facet, shorter))
            .collect();
        let divided = kept.iter().zip(&leaves).filter(|(_, leaf)| !**leaf).map(|(&(i, _), _)| i as u32);
        let mut slopes = match &cell.programs.slopes {
            Some(tape) if place.level >= FACETS_FROM => {
                self.shortened(tape, &self.slopes, divided).into_iter().map(Some).collect()
            }
            kept => vec![kept.clone(); divided.count()],
        }
        .into_iter();
        let cells = kept.iter().zip(values).zip(leaves).map(|((&(_, facet), value), is_leaf)| Cell {
            programs: Programs { value, slopes: if is_leaf { None } else { slopes.next().flatten() } },
            facet,
            is_leaf,
            below: OnceLock::new(),
        });
        let cells: Vec<Cell> = cells.collect();
        Node { outside, inside, open: cells }
    }

    /// What encloses the field in some cells; the slopes of their lanes stay in the workspace.
    fn facets(&mut self, tree: &Octree, cell: &Cell, place: Place, open: &[u32]) -> Vec<Option<Facet>> {
        let Some(tape) = cell.programs.slopes.as_ref().filter(|_| place.level >= FACETS_FROM) else {
            return vec![None; open.len()];
        };
        if open.is_empty() {
            return Vec::new();
        }
        tree.fill_boxes(&mut self.slopes, place, open);
        self.slopes.run_traced(tape, open.len());
        let half = tree.half(place);
        for (lane, &number) in open.iter().enumerate() {
            let centre = tree.centre(place, number);
            for axis in 0..3 {
                self.centres.input(axis, 0)[lane] = centre[axis];
                self.centres.input(axis, 1)[lane] = centre[axis];
            }
        }
        self.centres.run(&cell.programs.value, open.len());
        self.evaluations += 2 * open.len() as u64;
        let range = |workspace: &Workspace<F64, Intervals>, output: usize, lane: usize| Interval {
            lo: workspace.output(output, 0)[lane],
            hi: workspace.output(output, 1)[lane],
        };
        let facet = |(lane, &number): (usize, &u32)| {
            let slopes = [0, 1, 2].map(|axis| range(&self.slopes, axis, lane));
            Facet::new(tree.centre(place, number), half, range(&self.centres, 0, lane), slopes)
        };
        open.iter().enumerate().map(facet).collect()
    }

    /// A program shortened to what some lanes of an evaluation left open; lanes that chose alike share one.
    fn shortened(
        &self,
        tape: &Arc<Tape>,
        traced: &Workspace<F64, Intervals>,
        lanes: impl Iterator<Item = u32>,
    ) -> Vec<Arc<Tape>> {
        let places: Vec<usize> = tape.choices().collect();
        let mut known: FxHashMap<Vec<u8>, Arc<Tape>> = FxHashMap::default();
        let mut choices = Vec::with_capacity(places.len());
        let shortened = |lane: u32| {
            choices.clear();
            choices.extend(places.iter().map(|&place| traced.choice(place, lane as usize)));
            if let Some(same) = known.get(&choices) {
                return same.clone();
            }
            let shorter = tape.shortened(|place| traced.choice(place, lane as usize));
            let worth = |shorter: &Tape| (shorter.len() as f64) < WORTH_A_COPY * tape.len() as f64;
            let shorter = shorter.filter(worth).map_or_else(|| tape.clone(), Arc::new);
            known.insert(choices.clone(), shorter.clone());
            shorter
        };
        lanes.map(shortened).collect()
    }
}

/// Whether a cell need not be divided.
fn is_leaf(parent: &Cell, level: usize, facet: Option<Facet>, shorter: &Arc<Tape>) -> bool {
    let progress = (shorter.len() as f64) < PROGRESS * parent.programs.value.len() as f64;
    match facet {
        _ if level + 1 == LEVELS => true,
        Some(facet) => facet.is_close(),
        // Nothing is known of the slopes, and that will not change.
        None => level >= FACETS_FROM && !progress,
    }
}

impl Octree {
    /// What an open cell is divided into; made anew, in the arena, if there is no more room to keep it.
    pub(super) fn node<'c>(
        &self,
        builder: &mut Builder,
        arena: &'c Arena<Node>,
        cell: &'c Cell,
        place: Place,
    ) -> &'c Node {
        if let Some(node) = cell.below.get() {
            return node;
        }
        if self.memory.load(Ordering::Relaxed) >= self.limit {
            return arena.alloc(builder.node(self, cell, place));
        }
        cell.below.get_or_init(|| {
            let node = Box::new(builder.node(self, cell, place));
            self.memory.fetch_add(node.bytes(&cell.programs), Ordering::Relaxed);
            node
        })
    }

    /// Half the extent of the cells of a node.
    fn half(&self, place: Place) -> [f64; 3] {
        self.step.map(|s| 0.5 * s * f64::from(place.unit()) * (1.0 + 1e-12) + self.slack)
    }

    fn centre(&self, place: Place, number: u32) -> [f64; 3] {
        let (cell, unit) = (place.child(number), place.unit());
        [0, 1, 2].map(|axis| {
            0.5 * (self.face(axis, cell.corner[axis]) + self.face(axis, cell.corner[axis] + unit))
        })
    }

    /// Writes the boxes of cells of a node where an evaluation reads them.
    fn fill_boxes(&self, boxes: &mut Workspace<F64, Intervals>, place: Place, numbers: &[u32]) {
        let unit = place.unit();
        for (lane, &number) in numbers.iter().enumerate() {
            let corner = place.child(number).corner;
            for axis in 0..3 {
                boxes.input(axis, 0)[lane] = self.face(axis, corner[axis]) - self.slack;
                boxes.input(axis, 1)[lane] = self.face(axis, corner[axis] + unit) + self.slack;
            }
        }
    }
}

impl Node {
    /// About how many bytes it takes, with the programs that differ from those of the parent.
    fn bytes(&self, parent: &Programs) -> usize {
        let mut seen: Vec<*const Tape> = vec![Arc::as_ptr(&parent.value)];
        seen.extend(parent.slopes.as_ref().map(Arc::as_ptr));
        let mut instructions = 0;
        for cell in &self.open {
            for tape in [Some(&cell.programs.value), cell.programs.slopes.as_ref()].into_iter().flatten() {
                if !seen.contains(&Arc::as_ptr(tape)) {
                    seen.push(Arc::as_ptr(tape));
                    instructions += tape.len();
                }
            }
        }
        size_of::<Self>() + self.open.len() * size_of::<Cell>() + instructions * INSTRUCTION_BYTES
    }
}
