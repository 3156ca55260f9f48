//! The search at a point.
//!
//! After stage k the least value so far stands at a place p, and p − h and p + h have been looked at too, or lie beyond
//! the range, with h = range · 2^−(5 + 3k).

use super::{CELLS, Minimum, Scratch};

/// Places between p and p + h in the next stage.
const PARTS: usize = 8;
/// The stages that every search goes through, which enclosures rely on, and the most.
pub(super) const STAGES: [i32; 2] = [7, 14];

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The least value; NaN if there is none.
    pub(super) value: f64,
    /// Where it is taken.
    pub(super) place: f64,
}

impl Minimum {
    /// How far apart the places of a stage are.
    pub(super) fn spacing(&self, stage: i32) -> f64 {
        (self.range[1] - self.range[0]) / CELLS as f64 / (PARTS as f64).powi(stage)
    }

    /// The middles of the cells of the range.
    pub(super) fn middles(&self) -> impl Iterator<Item = f64> {
        let (start, step) = (self.range[0], self.spacing(0));
        (0..CELLS).map(move |i| start + (i as f64 + 0.5) * step)
    }

    /// Searches the minimum at a point.
    pub(super) fn search(&self, scratch: &mut Scratch, arguments: &[f64]) -> Found {
        let mut found = Found { value: f64::INFINITY, place: self.range[0] };
        let mut places: Vec<f64> = self.middles().collect();
        for stage in 0..=STAGES[1] {
            let spread = self.look(scratch, (arguments, &places), &mut found);
            if stage >= STAGES[0] && spread.is_none_or(|s| s <= 1e-15 * found.value.abs().max(1.0)) {
                break;
            }
            let step = self.spacing(stage) / PARTS as f64;
            let sides = (1..PARTS).flat_map(|i| [-(i as f64), i as f64]);
            places.clear();
            places.extend(sides.map(|i| (found.place + i * step).clamp(self.range[0], self.range[1])));
        }
        if found.value == f64::INFINITY {
            found.value = f64::NAN;
        }
        found
    }

    /// Takes values at places, at most as many as there are lanes; returns how far apart they lie, if there are any.
    fn look(
        &self,
        scratch: &mut Scratch,
        (arguments, places): (&[f64], &[f64]),
        found: &mut Found,
    ) -> Option<f64> {
        let values = &mut scratch.values;
        for (k, &argument) in arguments.iter().enumerate() {
            values.input(k, 0)[..places.len()].fill(argument);
        }
        values.input(arguments.len(), 0)[..places.len()].copy_from_slice(places);
        values.run(&self.tape, places.len());
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (&place, &value) in places.iter().zip(values.output(0, 0)) {
            (least, most) = (least.min(value), most.max(value));
            if value < found.value {
                *found = Found { value, place };
            }
        }
        (least <= most).then_some(most - least)
    }

    /// The minimiser near a place that was found, by Newton's method; the place itself where F does not curve upward.
    pub(super) fn refined(&self, scratch: &mut Scratch, arguments: &[f64], place: f64) -> f64 {
        let values = &mut scratch.values;
        let near = self.spacing(STAGES[0] / 2);
        let mut next = place;
        for _ in 0..4 {
            for (k, &argument) in arguments.iter().chain([&next]).enumerate() {
                values.input(k, 0)[0] = argument;
            }
            values.run(&self.newton, 1);
            let (slope, bend) = (values.output(1, 0)[0], values.output(2, 0)[0]);
            let moved = (next - slope / bend).clamp(self.range[0], self.range[1]);
            // NaN fails both.
            let is_near = (moved - place).abs() <= near;
            let is_upward = bend > 0.0;
            if !is_upward || !is_near {
                return place;
            }
            next = moved;
        }
        next
    }
}
