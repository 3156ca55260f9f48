//! Dividing cells.

use super::pieces::{Operand, Piece, Program, Shape};
use super::{Cell, Facet, LEVELS, Node, Octree, Place, Programs};
use fieldstone_field::{F64, Interval, Intervals, LANES, Tape, Workspace};
use rustc_hash::FxHashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use typed_arena::Arena;

/// Programs that keep more than this part of their instructions are not worth a copy of their own.
const WORTH_A_COPY: f64 = 0.9;
/// Cells without slopes are divided, from the second level on, only if their programs get shorter than this part.
const PROGRESS: f64 = 0.7;
/// Cells of nodes from this level on are small: they are not divided if they promise nothing, and slopes that stay long are
/// looked at behind it.
const SMALL_FROM: usize = 1;
/// Slopes of more instructions than this, of which less than one in so many is a choice, are looked at later.
const MANY_SLOPES: usize = 512;
const RARE: usize = 10;
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
/// An operand and the cells that it matters to.
type Users<'p> = (&'p Arc<Operand>, Vec<usize>);

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
        let mut values = Vec::new();
        let shapes = if tree.is_composite {
            let mut known: FxHashMap<*const Tape, Arc<Program>> = FxHashMap::default();
            let shortened = self.shortened(value, &self.boxes, open.iter().copied());
            let program = |value: &Arc<Tape>| {
                known.entry(Arc::as_ptr(value)).or_insert_with(|| tree.program(value)).clone()
            };
            let programs: Vec<Arc<Program>> = shortened.iter().map(program).collect();
            values = programs.iter().map(|program| program.value.clone()).collect();
            self.combinations(tree, place, &open, &programs)
        } else {
            self.facets(tree, cell, place, &open)
        };
        for (&number, shape) in open.iter().zip(&shapes) {
            if let Shape::Decided(is_inside) = shape {
                *(if *is_inside { &mut inside } else { &mut outside }) |= 1 << number;
            }
        }
        let is_kept = |i: &usize| (outside | inside) >> open[*i] & 1 == 0;
        let kept: Vec<usize> = (0..open.len()).filter(is_kept).collect();
        let values: Vec<Arc<Tape>> = if tree.is_composite {
            kept.iter().map(|&i| values[i].clone()).collect()
        } else {
            self.shortened(value, &self.boxes, kept.iter().map(|&i| open[i]))
        };
        let leaves: Vec<bool> = kept
            .iter()
            .zip(&values)
            .map(|(&i, shorter)| is_leaf(cell, place.level, &shapes[i], shorter))
            .collect();
        let donor = cell.donor.lock().unwrap_or_else(PoisonError::into_inner).take();
        let mut slopes = self.slopes_below(cell, place, &kept, &leaves).into_iter();
        let mut shapes: Vec<Option<Shape>> = shapes.into_iter().map(Some).collect();
        let cells = kept.iter().zip(values).zip(leaves).map(|((&i, value), is_leaf)| {
            let slopes = if is_leaf { None } else { slopes.next().flatten() };
            let programs = Programs { value, slopes };
            let (below, donor) = tree.inherited(donor.as_deref(), open[i], &programs);
            let pieces = match shapes[i].take() {
                Some(Shape::Pieces(pieces)) => Some(Box::new(pieces)),
                _ => None,
            };
            Cell { programs, pieces, is_leaf, below, donor: Mutex::new(donor) }
        });
        let cells: Vec<Cell> = cells.collect();
        Node { outside, inside, open: cells }
    }

    /// The slopes for what is divided further, in order; `kept` are lanes of the last evaluation of slopes.
    fn slopes_below(
        &self,
        cell: &Cell,
        place: Place,
        kept: &[usize],
        leaves: &[bool],
    ) -> Vec<Option<Arc<Tape>>> {
        let divided = kept.iter().zip(leaves).filter(|(_, leaf)| !**leaf).map(|(&i, _)| i as u32);
        match &cell.programs.slopes {
            Some(tape) if is_due(tape, place.level) => {
                self.shortened(tape, &self.slopes, divided).into_iter().map(Some).collect()
            }
            kept => vec![kept.clone(); divided.count()],
        }
    }

    /// What the slopes of the whole field say of some cells; those of their lanes stay in the workspace.
    fn facets(&mut self, tree: &Octree, cell: &Cell, place: Place, open: &[u32]) -> Vec<Shape> {
        let Some(tape) = &cell.programs.slopes else {
            return vec![Shape::Rough; open.len()];
        };
        if !is_due(tape, place.level) {
            return vec![Shape::Later; open.len()];
        }
        let value = &cell.programs.value;
        let half = tree.half(place);
        let facets = self.facets_of((tree, place), open, value, tape);
        let shape = |facet: Option<Facet>| facet.map_or(Shape::Rough, |f| Shape::of_facet(f, value, half));
        facets.into_iter().map(shape).collect()
    }

    /// What the operands of the set operations, with which the programs of some cells end, say of them.
    fn combinations(
        &mut self,
        tree: &Octree,
        place: Place,
        open: &[u32],
        programs: &[Arc<Program>],
    ) -> Vec<Shape> {
        let combination = |i: usize| programs[i].parts.as_ref();
        // Each operand is evaluated in all cells that it matters to at once.
        let mut users: FxHashMap<*const Operand, Users<'_>> = FxHashMap::default();
        for i in 0..open.len() {
            for operand in combination(i).into_iter().flat_map(|(operands, _)| operands) {
                users.entry(Arc::as_ptr(operand)).or_insert((operand, Vec::new())).1.push(i);
            }
        }
        let mut facets: FxHashMap<(*const Operand, usize), Option<Facet>> = FxHashMap::default();
        for (key, (operand, cells)) in users {
            let numbers: Numbers = cells.iter().map(|&i| open[i]).collect();
            let found = match &operand.slopes {
                Some(slopes) => self.facets_of((tree, place), &numbers, &operand.value, slopes),
                None => vec![None; cells.len()],
            };
            facets.extend(cells.into_iter().map(|i| (key, i)).zip(found));
        }
        let half = tree.half(place);
        let shape = |i: usize| {
            let Some((operands, steps)) = combination(i) else { return Shape::Later };
            let piece = |operand: &Arc<Operand>| {
                let facet = facets[&(Arc::as_ptr(operand), i)]?;
                Some(Piece { facet, program: operand.value.clone() })
            };
            let pieces: Option<Vec<Piece>> = operands.iter().map(piece).collect();
            pieces.map_or(Shape::Rough, |pieces| Shape::of_operands(pieces, steps, half))
        };
        (0..open.len()).map(shape).collect()
    }

    /// What encloses a program in some cells; its slopes stay in the workspace.
    fn facets_of(
        &mut self,
        (tree, place): (&Octree, Place),
        numbers: &[u32],
        value: &Tape,
        slopes: &Tape,
    ) -> Vec<Option<Facet>> {
        if numbers.is_empty() {
            return Vec::new();
        }
        tree.fill_boxes(&mut self.slopes, place, numbers);
        self.slopes.run_traced(slopes, numbers.len());
        let half = tree.half(place);
        for (lane, &number) in numbers.iter().enumerate() {
            let centre = tree.centre(place, number);
            for (axis, &x) in centre.iter().enumerate() {
                self.centres.input(axis, 0)[lane] = x;
                self.centres.input(axis, 1)[lane] = x;
            }
        }
        self.centres.run(value, numbers.len());
        self.evaluations += 2 * numbers.len() as u64;
        let range = |workspace: &Workspace<F64, Intervals>, output: usize, lane: usize| Interval {
            lo: workspace.output(output, 0)[lane],
            hi: workspace.output(output, 1)[lane],
        };
        let facet = |(lane, &number): (usize, &u32)| {
            let slopes = [0, 1, 2].map(|axis| range(&self.slopes, axis, lane));
            Facet::new(tree.centre(place, number), half, range(&self.centres, 0, lane), slopes)
        };
        numbers.iter().enumerate().map(facet).collect()
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

/// Whether slopes are looked at in the cells of a node of this level: at once if cells decide much of them, so that they
/// become shorter, otherwise only where cells are small.
fn is_due(slopes: &Tape, level: usize) -> bool {
    let is_rigid = slopes.len() > MANY_SLOPES && RARE * slopes.choices().count() < slopes.len();
    !is_rigid || level > SMALL_FROM
}

/// Whether a cell need not be divided.
fn is_leaf(parent: &Cell, level: usize, shape: &Shape, shorter: &Tape) -> bool {
    let progress = (shorter.len() as f64) < PROGRESS * parent.programs.value.len() as f64;
    match shape {
        _ if level + 1 == LEVELS => true,
        Shape::Pieces(pieces) => pieces.are_close(),
        Shape::Rough => level >= SMALL_FROM && !progress,
        Shape::Later | Shape::Decided(_) => false,
    }
}

impl Octree {
    /// A program of a cell taken apart.
    fn program(&self, value: &Arc<Tape>) -> Arc<Program> {
        self.shared.program(value, |instructions| self.take(instructions * INSTRUCTION_BYTES))
    }

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
        if self.memory.is_full() {
            return arena.alloc(builder.node(self, cell, place));
        }
        cell.below.get_or_init(|| {
            let node = Arc::new(builder.node(self, cell, place));
            self.take(node.bytes(&cell.programs, self.is_composite));
            node
        })
    }

    /// What a cell of a node has from that of a tree that this one was made from: what is below it, if that is the same,
    /// or else what it may be taken over from in parts.
    fn inherited(
        &self,
        donor: Option<&Node>,
        number: u32,
        programs: &Programs,
    ) -> (OnceLock<Arc<Node>>, Option<Arc<Node>>) {
        let nothing = (OnceLock::new(), None);
        let Some(old) = donor.and_then(|node| node.open_cell(number)) else { return nothing };
        let Some(below) = old.below.get() else { return nothing };
        let is_same = |new: &Tape, old: &Tape| new.has_code_of(old) && !new.reads(&self.changed);
        let have_same_slopes = match (&programs.slopes, &old.programs.slopes) {
            (Some(new), Some(old)) => is_same(new, old),
            (None, None) => true,
            _ => false,
        };
        if have_same_slopes && is_same(&programs.value, &old.programs.value) {
            (OnceLock::from(below.clone()), None)
        } else {
            (OnceLock::new(), Some(below.clone()))
        }
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
            for (axis, &index) in place.child(number).corner.iter().enumerate() {
                boxes.input(axis, 0)[lane] = self.face(axis, index) - self.slack;
                boxes.input(axis, 1)[lane] = self.face(axis, index + unit) + self.slack;
            }
        }
    }
}

impl Node {
    /// About how many bytes it takes; with the programs that differ from those of the parent, unless these are shared and
    /// counted elsewhere.
    fn bytes(&self, parent: &Programs, are_shared: bool) -> usize {
        let mut seen: Vec<*const Tape> = vec![Arc::as_ptr(&parent.value)];
        seen.extend(parent.slopes.as_ref().map(Arc::as_ptr));
        let mut instructions = 0;
        for cell in self.open.iter().filter(|_| !are_shared) {
            for tape in [Some(&cell.programs.value), cell.programs.slopes.as_ref()].into_iter().flatten() {
                if !seen.contains(&Arc::as_ptr(tape)) {
                    seen.push(Arc::as_ptr(tape));
                    instructions += tape.len();
                }
            }
        }
        let pieces: usize = self.open.iter().flat_map(|cell| &cell.pieces).map(|pieces| pieces.bytes()).sum();
        size_of::<Self>() + self.open.len() * size_of::<Cell>() + pieces + instructions * INSTRUCTION_BYTES
    }
}
