//! The field of a cell as a combination of smooth pieces.

use super::Facet;
use fieldstone_field::{CodeKey, Combination, Input, SetStep, Tape, TapeOptions};
use rustc_hash::FxHashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// A cell is taken apart into at most so many pieces.
pub(super) const MOST: usize = 8;

/// A program that set operations combine, and the program of its slopes, if anything can be known of them.
#[derive(Debug)]
pub(super) struct Operand {
    pub(super) value: Arc<Tape>,
    pub(super) slopes: Option<Tape>,
}

impl Operand {
    pub(super) fn new(value: Tape) -> Self {
        let varying: Vec<Input> = (0..3).map(Input::Coordinate).collect();
        let slopes = value.to_field(&varying).map(|field| {
            Tape::new(&super::slopes_of(&field), &TapeOptions { attributes: true, ..TapeOptions::default() })
        });
        Self { value: Arc::new(value), slopes }
    }
}

/// A program of cells, and the set operations with which it ends.
#[derive(Debug)]
pub(super) struct Program {
    pub(super) value: Arc<Tape>,
    /// Its operands and how they are combined, if they are few.
    pub(super) parts: Option<(Vec<Arc<Operand>>, Vec<SetStep>)>,
}

/// Programs and operands by their instructions.
#[derive(Debug, Default)]
pub(super) struct Shared {
    programs: Mutex<FxHashMap<CodeKey, Arc<Program>>>,
    operands: Mutex<FxHashMap<CodeKey, Arc<Operand>>>,
}

/// Cells are not taken apart into operands of more instructions, because a program of slopes is made for each.
const LONGEST_OPERAND: usize = 4096;

impl Shared {
    /// A program taken apart, once for all cells that have it; `take` is told how many instructions were made for it.
    pub(super) fn program(&self, value: &Arc<Tape>, take: impl Fn(usize)) -> Arc<Program> {
        let make =
            |value: &Arc<Tape>| Arc::new(Program { value: value.clone(), parts: self.parts(value, &take) });
        let Some(key) = value.code_key() else { return make(value) };
        shared(&self.programs, key, || {
            take(value.len());
            make(value)
        })
    }

    /// The set operations with which a program ends, if they have few operands of moderate length.
    fn parts(&self, program: &Tape, take: &impl Fn(usize)) -> Option<(Vec<Arc<Operand>>, Vec<SetStep>)> {
        let Combination { operands, steps } = program.combination(MOST)?;
        if operands.iter().any(|operand| operand.len() > LONGEST_OPERAND) {
            return None;
        }
        let operand = |operand: Tape| {
            Some(shared(&self.operands, operand.code_key()?, || {
                let made = Operand::new(operand);
                take(made.value.len() + made.slopes.as_ref().map_or(0, Tape::len));
                Arc::new(made)
            }))
        };
        let operands: Option<Vec<Arc<Operand>>> = operands.into_iter().map(operand).collect();
        Some((operands?, steps))
    }
}

/// What a table has for a key, made if nobody did before.
fn shared<T>(
    table: &Mutex<FxHashMap<CodeKey, Arc<T>>>,
    key: CodeKey,
    make: impl FnOnce() -> Arc<T>,
) -> Arc<T> {
    // A panic of another thread leaves the table as it was.
    let table = || table.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = table().get(&key) {
        return known.clone();
    }
    // Not under the lock: two threads may both make it, and one is kept.
    let made = make();
    table().entry(key).or_insert(made).clone()
}

/// One operand of a cell's set operations between two planes.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) facet: Facet,
    /// The operand.
    pub(super) program: Arc<Tape>,
}

/// Minima and maxima of pieces with the sign of the field in a cell.
#[derive(Clone, Debug)]
pub(super) struct Pieces {
    /// At most [`MOST`].
    pieces: Vec<Piece>,
    steps: Vec<SetStep>,
}

/// What is known of a cell.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// The field is certainly negative (`true`) or certainly positive.
    Decided(bool),
    Pieces(Pieces),
    /// Nothing yet: parts of the cell will show more.
    Later,
    /// Nothing is known of the slopes, and that will not change.
    Rough,
}

/// A combination of which some operands are decided.
enum Partly {
    Decided(bool),
    Open(Vec<SetStep>),
}

impl Shape {
    /// A single facet for the whole field, whose program is given.
    pub(super) fn of_facet(facet: Facet, program: &Arc<Tape>, half: [f64; 3]) -> Self {
        match facet.sign(half) {
            Some(inside) => Self::Decided(inside),
            None => Self::Pieces(Pieces {
                pieces: vec![Piece { facet, program: program.clone() }],
                steps: vec![SetStep::Operand(0)],
            }),
        }
    }

    /// From the facets of all operands in a cell of this size; those that are decided drop out.
    pub(super) fn of_operands(pieces: Vec<Piece>, steps: &[SetStep], half: [f64; 3]) -> Self {
        let signs: Vec<Option<bool>> = pieces.iter().map(|piece| piece.facet.sign(half)).collect();
        let operand = |k: usize| match signs[k] {
            Some(inside) => Partly::Decided(inside),
            None => Partly::Open(vec![SetStep::Operand(k)]),
        };
        // `deciding`: the sign of one operand that makes the other one irrelevant.
        let combine = |a: Partly, b: Partly, step: SetStep| {
            let deciding = step == SetStep::Min;
            match (a, b) {
                (Partly::Decided(sign), other) | (other, Partly::Decided(sign)) => {
                    if sign == deciding {
                        Partly::Decided(sign)
                    } else {
                        other
                    }
                }
                (Partly::Open(mut first), Partly::Open(second)) => {
                    first.extend(second);
                    first.push(step);
                    Partly::Open(first)
                }
            }
        };
        match combined(steps, operand, combine) {
            Some(Partly::Decided(inside)) => Self::Decided(inside),
            Some(Partly::Open(steps)) => Self::Pieces(Pieces { pieces, steps }.compact()),
            None => Self::Later,
        }
    }
}

/// The value of an expression in postfix order; `None` if it is none.
fn combined<T>(
    steps: &[SetStep],
    operand: impl Fn(usize) -> T,
    combine: impl Fn(T, T, SetStep) -> T,
) -> Option<T> {
    let mut stack = Vec::with_capacity(MOST);
    for &step in steps {
        let value = match step {
            SetStep::Operand(k) => operand(k),
            SetStep::Min | SetStep::Max => {
                let (b, a) = (stack.pop()?, stack.pop()?);
                combine(a, b, step)
            }
        };
        stack.push(value);
    }
    stack.pop()
}

impl Pieces {
    /// Without the pieces that no step names.
    fn compact(self) -> Self {
        let mut number = vec![None; self.pieces.len()];
        let mut pieces = Vec::new();
        let mut steps = self.steps;
        for step in &mut steps {
            if let SetStep::Operand(k) = step {
                let known = *number[*k].get_or_insert_with(|| {
                    pieces.push(self.pieces[*k].clone());
                    pieces.len() - 1
                });
                *k = known;
            }
        }
        Self { pieces, steps }
    }

    pub(super) fn list(&self) -> &[Piece] {
        &self.pieces
    }

    /// Whether the field is negative where just those pieces are whose bits are set.
    pub(super) fn is_inside(&self, negative: u32) -> bool {
        // Signs on a stack of bits.
        let mut stack = 0u64;
        for step in &self.steps {
            stack = match step {
                SetStep::Operand(k) => stack << 1 | u64::from(negative >> k & 1),
                SetStep::Min => (stack >> 2 << 1) | ((stack | stack >> 1) & 1),
                SetStep::Max => (stack >> 2 << 1) | (stack & stack >> 1 & 1),
            };
        }
        stack & 1 == 1
    }

    /// The sets of rays along which the field is certainly positive and certainly negative, from the same of the pieces.
    pub(super) fn signs(&self, of_piece: &[(u64, u64); MOST]) -> (u64, u64) {
        if let [_] = self.pieces[..] {
            return of_piece[0];
        }
        let mut stack = [(0, 0); 4 * MOST + 1];
        let mut top = 0;
        for step in &self.steps {
            if let SetStep::Operand(k) = step {
                stack[top] = of_piece[*k];
                top += 1;
                continue;
            }
            let ((ap, an), (bp, bn)) = (stack[top - 2], stack[top - 1]);
            top -= 1;
            stack[top - 1] = if *step == SetStep::Min { (ap & bp, an | bn) } else { (ap | bp, an & bn) };
        }
        stack[0]
    }

    /// Whether the field is certainly negative (`true`) or certainly positive at a point of the cell.
    pub(super) fn side(&self, point: [f64; 3]) -> Option<bool> {
        let (mut negative, mut open) = (0, 0);
        for (k, piece) in self.pieces.iter().enumerate() {
            match piece.facet.side(point) {
                Some(inside) => negative |= u32::from(inside) << k,
                None => open |= 1 << k,
            }
        }
        self.decided(negative, open)
    }

    /// The sign of the field where some pieces are open: bigger pieces never make the field smaller.
    pub(super) fn decided(&self, negative: u32, open: u32) -> Option<bool> {
        let inside = self.is_inside(negative | open);
        (open == 0 || inside == self.is_inside(negative & !open)).then_some(inside)
    }

    /// Whether nearly all rays need nothing but the facets.
    pub(super) fn are_close(&self) -> bool {
        self.pieces.iter().all(|piece| piece.facet.is_close())
    }

    /// About how many bytes they take.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.pieces.len() * size_of::<Piece>() + self.steps.len() * size_of::<SetStep>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SetStep::{Max, Min};

    fn pieces(steps: &[SetStep]) -> Pieces {
        let facet =
            Facet { centre: [0.0; 3], value: 0.0, gradient: [1.0, 0.0, 0.0], radius: [0.0; 3], error: 0.0 };
        let program =
            Arc::new(Tape::new(&fieldstone_field::Field::from_fn(|p| p[0]), &TapeOptions::default()));
        let count = steps.iter().filter(|step| matches!(step, SetStep::Operand(_))).count();
        Pieces { pieces: vec![Piece { facet, program }; count], steps: steps.to_vec() }
    }

    const A: SetStep = SetStep::Operand(0);
    const B: SetStep = SetStep::Operand(1);
    const C: SetStep = SetStep::Operand(2);

    #[test]
    fn signs_are_combined_as_minima_and_maxima_do() {
        // max(min(a, b), c) < 0.
        let pieces = pieces(&[A, B, Min, C, Max]);
        for negative in 0..8u32 {
            let [a, b, c] = [0, 1, 2].map(|k| negative >> k & 1 == 1);
            assert_eq!(pieces.is_inside(negative), (a || b) && c, "{negative:b}");
        }
        // With c open, what a and b say decides only if neither is negative.
        assert_eq!(pieces.decided(0b000, 0b100), Some(false));
        assert_eq!(pieces.decided(0b001, 0b100), None);
        assert_eq!(pieces.decided(0b101, 0b010), Some(true));
    }

    #[test]
    fn sets_of_rays_are_combined_alike() {
        let pieces = pieces(&[A, B, Max, C, Min]);
        // Ray i has the signs of the number i; none is open.
        let of = |k: u32| (0..8u64).filter(|i| i >> k & 1 == 1).fold(0u64, |set, i| set | 1 << i);
        let mut sets = [(0, 0); MOST];
        (0..3).for_each(|k| sets[k as usize] = (!of(k) & 0xff, of(k)));
        let (positive, negative) = pieces.signs(&sets);
        let expected = (0..8).fold(0u64, |set, i| set | u64::from(pieces.is_inside(i)) << i);
        assert_eq!((positive, negative), (!expected & 0xff, expected));
    }

    #[test]
    fn decided_operands_drop_out() {
        let of = |value: f64| {
            let mut piece = pieces(&[A]).pieces[0].clone();
            piece.facet.value = value;
            piece
        };
        let half = [1.0; 3];
        let steps = [A, B, Min, C, Max];
        // b is positive: max(a, c) is left.
        let Shape::Pieces(left) = Shape::of_operands(vec![of(0.0), of(3.0), of(0.5)], &steps, half) else {
            panic!("decided");
        };
        assert_eq!((left.pieces.len(), left.steps.as_slice()), (2, [A, B, Max].as_slice()));
        assert_eq!(left.pieces[1].facet.value, 0.5);
        let all = Shape::of_operands(vec![of(-2.0), of(0.0), of(-3.0)], &steps, half);
        assert!(matches!(all, Shape::Decided(true)));
        let none = Shape::of_operands(vec![of(0.0), of(0.0), of(2.0)], &steps, half);
        assert!(matches!(none, Shape::Decided(false)));
    }
}
