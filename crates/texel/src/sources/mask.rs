//! Which of a cell's places are filled, to find what is seen of it.

use glam::DVec3;

/// A cell is looked at in 4 × 4 × 4 parts.
pub(super) const PARTS: usize = 4;
/// A part is looked at in 4 × 4 × 4 places.
const PLACES: usize = 4;
const SIDE: usize = PARTS * PLACES;

/// 16 × 16 × 16 places of a cell: bit x of row y of layer z.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mask([[u16; SIDE]; SIDE]);

impl Default for Mask {
    fn default() -> Self {
        Self([[0; SIDE]; SIDE])
    }
}

impl Mask {
    /// Fills a part of a cell.
    pub(super) fn fill(&mut self, part: [usize; 3]) {
        let bits = 0xf << (PLACES * part[0]);
        self.rows(part).for_each(|(row, _)| *row |= bits);
    }

    /// Fills the places of a part where value + slope·p < 0; p is from −½ to ½ in the part.
    pub(super) fn fill_below(&mut self, part: [usize; 3], value: f64, slope: DVec3) {
        let place = |i: usize| (i as f64 + 0.5) / PLACES as f64 - 0.5;
        for (row, [y, z]) in self.rows(part) {
            let start = value + slope.y * place(y) + slope.z * place(z);
            for x in 0..PLACES {
                let is_filled = start + slope.x * place(x) < 0.0;
                *row |= u16::from(is_filled) << (PLACES * part[0] + x);
            }
        }
    }

    /// The rows of a part, with their y and z in it.
    fn rows(&mut self, part: [usize; 3]) -> impl Iterator<Item = (&mut u16, [usize; 2])> {
        let range = |axis: usize| (PLACES * part[axis], PLACES);
        let ((y, height), (z, depth)) = (range(1), range(2));
        self.0.iter_mut().skip(z).take(depth).enumerate().flat_map(move |(z, layer)| {
            layer.iter_mut().skip(y).take(height).enumerate().map(move |(y, row)| (row, [y, z]))
        })
    }

    /// Whether all places are filled.
    pub(super) fn is_full(&self) -> bool {
        self.0.iter().flatten().all(|row| *row == u16::MAX)
    }

    /// Whether no place is filled.
    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().flatten().all(|row| *row == 0)
    }

    /// The shares of the faces across x, y and z behind which something is filled.
    pub(super) fn cover(&self) -> [f64; 3] {
        let ones = |bits: u16| bits.count_ones();
        let x: u32 = self.0.iter().flatten().map(|row| u32::from(*row != 0)).sum();
        let y: u32 = self.0.iter().map(|layer| ones(layer.iter().fold(0, |all, row| all | row))).sum();
        let z: u32 = (0..SIDE).map(|y| ones(self.0.iter().fold(0, |all, layer| all | layer[y]))).sum();
        [x, y, z].map(|count| f64::from(count) / (SIDE * SIDE) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_covers_what_lies_before_it() {
        let mut mask = Mask::default();
        for part in parts() {
            // Filled for x + y < 1 in the unit cell.
            let centre = part.map(|i| (i as f64 + 0.5) / PARTS as f64);
            mask.fill_below(part, centre[0] + centre[1] - 1.0, DVec3::new(0.25, 0.25, 0.0));
        }
        let [x, y, z] = mask.cover();
        assert!((x - 1.0).abs() < 0.07 && (y - 1.0).abs() < 0.07, "{x} {y}");
        assert!((z - 0.5).abs() < 0.04, "{z}");
        assert!(!mask.is_full() && !mask.is_empty());
    }

    #[test]
    fn a_part_covers_a_sixteenth_of_each_face() {
        let mut mask = Mask::default();
        mask.fill([1, 2, 3]);
        assert_eq!(mask.cover(), [1.0 / 16.0; 3]);
        for part in parts() {
            mask.fill(part);
        }
        assert!(mask.is_full());
    }

    fn parts() -> impl Iterator<Item = [usize; 3]> {
        (0..PARTS.pow(3)).map(|i| [i % PARTS, i / PARTS % PARTS, i / PARTS / PARTS])
    }
}
