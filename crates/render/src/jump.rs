//! Normals where a field has no gradient: at jumps, and where it is flat. Its signs tell where outside is.

use fieldstone_field::{F64, LANES, Points, Tape, Workspace};
use glam::DVec3;

/// How far from the surface signs are looked at, relative to the size.
const REACH: f64 = 1e-5;
/// The lines on which the surface is located, and the places on each that are looked at together.
const LINES: usize = 4;
const PLACES: usize = LANES / LINES;
/// How often the stretch of a line that holds the surface is cut into as many parts as there are places.
const CUTS: i32 = 4;

/// Looks at the signs of a field around a place on its surface.
pub(crate) struct Probe<'p> {
    pub(crate) points: &'p mut Workspace<F64, Points>,
    pub(crate) tape: &'p Tape,
    /// A place on the surface.
    pub(crate) place: DVec3,
    /// The size of the solid.
    pub(crate) size: f64,
}

impl Probe<'_> {
    /// The outward unit normal; none if signs tell nothing.
    ///
    /// A rough normal comes from where outside is, of 26 directions. Along it, the surface is located on four lines
    /// around the place, which gives the slopes of the surface against the rough normal. Sharp edges keep that.
    pub(crate) fn normal(&mut self) -> Option<DVec3> {
        let rough = self.rough_normal()?;
        let (across, along) = rough.any_orthonormal_pair();
        let reach = REACH * self.size;
        let feet = [across, -across, along, -along].map(|side| self.place + reach * side);
        let heights = self.heights(rough, feet);
        let slope = |i: usize| {
            let slope = (heights[i]? - heights[i + 1]?) / (2.0 * reach);
            slope.is_finite().then_some(slope)
        };
        let (by_across, by_along) = (slope(0).unwrap_or(0.0), slope(2).unwrap_or(0.0));
        (rough - by_across * across - by_along * along).try_normalize()
    }

    fn rough_normal(&mut self) -> Option<DVec3> {
        let around: [DVec3; 26] = std::array::from_fn(|i| {
            let i = if i < 13 { i } else { i + 1 };
            let digit = |place: usize| (i / place % 3) as f64 - 1.0;
            DVec3::new(digit(1), digit(3), digit(9)).normalize()
        });
        let reach = REACH * self.size;
        let places = around.map(|a| self.place + reach * a);
        let inside = self.inside(&places);
        let towards = |i: usize| if inside[i] { -around[i] } else { around[i] };
        (0..around.len()).map(towards).sum::<DVec3>().try_normalize()
    }

    /// How high above each foot, in the direction of the normal, the field changes its sign; none if it does not within
    /// twice the reach.
    fn heights(&mut self, normal: DVec3, feet: [DVec3; LINES]) -> [Option<f64>; LINES] {
        let reach = 2.0 * REACH * self.size;
        // From a place inside to one outside.
        let mut stretches = [(-reach, reach); LINES];
        let mut found = [true; LINES];
        for _ in 0..CUTS {
            let height = |line: usize, k: usize| {
                let (low, high) = stretches[line];
                low + (high - low) * k as f64 / (PLACES - 1) as f64
            };
            let places: [DVec3; LANES] =
                std::array::from_fn(|i| feet[i / PLACES] + height(i / PLACES, i % PLACES) * normal);
            let inside = self.inside(&places);
            let cuts: [Option<usize>; LINES] = std::array::from_fn(|line| {
                let signs = &inside[line * PLACES..(line + 1) * PLACES];
                signs.windows(2).position(|pair| pair[0] && !pair[1])
            });
            let next: [(f64, f64); LINES] = std::array::from_fn(|line| match cuts[line] {
                Some(k) => (height(line, k), height(line, k + 1)),
                None => stretches[line],
            });
            for line in 0..LINES {
                found[line] &= cuts[line].is_some();
            }
            stretches = next;
        }
        std::array::from_fn(|line| found[line].then(|| 0.5 * (stretches[line].0 + stretches[line].1)))
    }

    /// Whether the field is negative at each place; at most 64 of them.
    fn inside(&mut self, places: &[DVec3]) -> Vec<bool> {
        for axis in 0..3 {
            let row = self.points.input(axis, 0);
            row.iter_mut().zip(places).for_each(|(x, place)| *x = place[axis]);
        }
        self.points.run(self.tape, places.len());
        self.points.output(0, 0)[..places.len()].iter().map(|v| *v < 0.0).collect()
    }
}
