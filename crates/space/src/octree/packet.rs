//! Up to 64 rays side by side, and how they cross cells.

use super::Facet;
use fearless_simd::Level;
use fieldstone_field::LANES;
use fieldstone_trace::Ray;

/// One number for each ray.
pub(super) type Lanes = [f64; LANES];

/// Stands for an infinite slope: its product with 0 is 0.
const STEEP: f64 = 1e300;

/// Rays side by side.
#[derive(Debug)]
pub(super) struct Packet {
    pub(super) origin: [Lanes; 3],
    pub(super) direction: [Lanes; 3],
    /// One over the direction.
    inverse: [Lanes; 3],
    pub(super) start: Lanes,
    pub(super) end: Lanes,
}

/// Where rays cross a cell.
#[derive(Debug)]
pub(super) struct Crossing {
    pub(super) enter: Lanes,
    pub(super) exit: Lanes,
    /// The part of rays in which there may be roots that facets do not settle, and the number of the piece that they are of,
    /// if it is one alone.
    pub(super) from: Lanes,
    pub(super) to: Lanes,
    pub(super) piece: [Option<u8>; LANES],
}

/// What a facet says of rays that cross its cell.
#[derive(Debug)]
pub(super) struct Face {
    /// The part of each ray in the cell where the facet leaves a root possible; not shortened where it knows no slope.
    pub(super) from: Lanes,
    pub(super) to: Lanes,
    /// The slope along each ray is within `spread` of this.
    pub(super) slope: Lanes,
    pub(super) spread: Lanes,
    /// The facet where the ray enters.
    pub(super) first: Lanes,
}

/// What the rays of a packet have in common: bounds of their origins, of one over their directions, and of t.
#[derive(Clone, Copy, Debug)]
pub(super) struct Common {
    origin: [(f64, f64); 3],
    inverse: [(f64, f64); 3],
    start: f64,
    end: f64,
}

/// Runs a loop over lanes with the widest instructions there are.
#[inline(always)]
pub(super) fn wide<R>(level: Level, f: impl FnOnce() -> R) -> R {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        use fearless_simd::Simd;
        if let Some(simd) = level.as_avx512() {
            return simd.vectorize(f);
        }
        if let Some(simd) = level.as_avx2() {
            return simd.vectorize(f);
        }
    }
    let _ = level;
    f()
}

/// Lanes are worked on in chunks of so many, and chunks without a ray are left out.
pub(super) const CHUNK: usize = 8;

/// The lanes of a chunk, as a set, for which a flag is 1.
#[inline(always)]
fn set_of(flags: [u8; CHUNK], chunk: usize) -> u64 {
    // The lowest bits of eight bytes, gathered in the highest one.
    (u64::from_le_bytes(flags).wrapping_mul(0x0102_0408_1020_4080) >> 56) << (CHUNK * chunk)
}

/// Whether a chunk has a lane in a set.
#[inline(always)]
fn is_busy(set: u64, chunk: usize) -> bool {
    set >> (CHUNK * chunk) & 0xff != 0
}

/// One number for each ray of a chunk.
type Eight = [f64; CHUNK];

#[inline(always)]
fn load(lanes: &Lanes, chunk: usize) -> Eight {
    std::array::from_fn(|i| lanes[CHUNK * chunk + i])
}

#[inline(always)]
fn store(lanes: &mut Lanes, chunk: usize, eight: Eight) {
    lanes[CHUNK * chunk..][..CHUNK].copy_from_slice(&eight);
}

/// The lanes in a set, in order.
pub(super) fn lanes_of(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            lane
        })
    })
}

/// The least and the largest number in the lanes of a set.
#[inline(always)]
fn range_of(lanes: &Lanes, set: u64) -> (f64, f64) {
    let (mut least, mut largest) = ([f64::INFINITY; CHUNK], [f64::NEG_INFINITY; CHUNK]);
    for chunk in 0..LANES / CHUNK {
        let (eight, some) = (load(lanes, chunk), set >> (CHUNK * chunk));
        for i in 0..CHUNK {
            let is_in = some >> i & 1 == 1;
            let (low, high) = if is_in { (eight[i], eight[i]) } else { (f64::INFINITY, f64::NEG_INFINITY) };
            least[i] = if low < least[i] { low } else { least[i] };
            largest[i] = if high > largest[i] { high } else { largest[i] };
        }
    }
    let mut range = (least[0], largest[0]);
    for i in 1..CHUNK {
        range = (range.0.min(least[i]), range.1.max(largest[i]));
    }
    range
}

impl Packet {
    pub(super) fn new() -> Self {
        let zero = [0.0; LANES];
        Self { origin: [zero; 3], direction: [zero; 3], inverse: [zero; 3], start: zero, end: zero }
    }

    /// Takes at most 64 rays; the set of those that are not empty.
    pub(super) fn load(&mut self, level: Level, rays: impl ExactSizeIterator<Item = Ray>) -> u64 {
        let count = rays.len();
        for (lane, ray) in rays.enumerate() {
            for axis in 0..3 {
                self.origin[axis][lane] = ray.origin[axis];
                self.direction[axis][lane] = ray.direction[axis];
            }
            self.start[lane] = ray.start;
            self.end[lane] = ray.end;
        }
        // Nobody walks in the other lanes.
        self.start[count..].fill(0.0);
        self.end[count..].fill(0.0);
        wide(
            level,
            #[inline(always)]
            || {
                let mut set = 0;
                for chunk in 0..LANES / CHUNK {
                    for axis in 0..3 {
                        let mut d = load(&self.direction[axis], chunk);
                        for x in &mut d {
                            *x = if x.abs() < 1.0 / STEEP { STEEP.copysign(*x) } else { 1.0 / *x };
                        }
                        store(&mut self.inverse[axis], chunk, d);
                    }
                    let (start, end) = (load(&self.start, chunk), load(&self.end, chunk));
                    let mut flags = [0; CHUNK];
                    for i in 0..CHUNK {
                        flags[i] = u8::from(start[i] < end[i]);
                    }
                    set |= set_of(flags, chunk);
                }
                set
            },
        )
    }

    /// Splits a set by the signs of the directions: bit 0 of the number for x, and so on.
    pub(super) fn octants(&self, set: u64) -> [u64; 8] {
        let negative = [0, 1, 2].map(|axis| {
            let mut negative = 0;
            for (lane, inverse) in self.inverse[axis].iter().enumerate() {
                negative |= u64::from(*inverse < 0.0) << lane;
            }
            negative
        });
        std::array::from_fn(|octant| {
            let side = |axis: usize| if octant >> axis & 1 == 1 { negative[axis] } else { !negative[axis] };
            set & side(0) & side(1) & side(2)
        })
    }

    /// What the rays of a set have in common.
    pub(super) fn common(&self, level: Level, set: u64) -> Common {
        wide(
            level,
            #[inline(always)]
            || Common {
                origin: [
                    range_of(&self.origin[0], set),
                    range_of(&self.origin[1], set),
                    range_of(&self.origin[2], set),
                ],
                inverse: [
                    range_of(&self.inverse[0], set),
                    range_of(&self.inverse[1], set),
                    range_of(&self.inverse[2], set),
                ],
                start: range_of(&self.start, set).0,
                end: range_of(&self.end, set).1,
            },
        )
    }

    /// Finds where the rays of a set cross a box; the set of those that do.
    pub(super) fn cross(
        &self,
        level: Level,
        set: u64,
        (lo, hi): ([f64; 3], [f64; 3]),
        into: &mut Crossing,
    ) -> u64 {
        wide(
            level,
            #[inline(always)]
            || {
                // A plain loop: what adaptors call is not compiled with these instructions.
                let mut found = 0;
                for chunk in 0..LANES / CHUNK {
                    if is_busy(set, chunk) {
                        found |= self.cross_chunk(chunk, (lo, hi), into);
                    }
                }
                found & set
            },
        )
    }

    #[inline(always)]
    fn cross_chunk(&self, chunk: usize, (lo, hi): ([f64; 3], [f64; 3]), into: &mut Crossing) -> u64 {
        let (mut enter, mut exit) = (load(&self.start, chunk), load(&self.end, chunk));
        for axis in 0..3 {
            let (origin, inverse) = (load(&self.origin[axis], chunk), load(&self.inverse[axis], chunk));
            for i in 0..CHUNK {
                let (a, b) = ((lo[axis] - origin[i]) * inverse[i], (hi[axis] - origin[i]) * inverse[i]);
                let (near, far) = if inverse[i] < 0.0 { (b, a) } else { (a, b) };
                enter[i] = if near > enter[i] { near } else { enter[i] };
                exit[i] = if far < exit[i] { far } else { exit[i] };
            }
        }
        store(&mut into.enter, chunk, enter);
        store(&mut into.exit, chunk, exit);
        set_of(std::array::from_fn(|i| u8::from(enter[i] < exit[i])), chunk)
    }

    /// What a facet says of the rays of a set in its cell: the sets of those along which the field is certainly positive,
    /// certainly negative, and certainly monotone.
    pub(super) fn face(
        &self,
        level: Level,
        set: u64,
        facet: &Facet,
        (crossing, into): (&Crossing, &mut Face),
    ) -> [u64; 3] {
        wide(
            level,
            #[inline(always)]
            || {
                let mut sets = [0; 3];
                for chunk in 0..LANES / CHUNK {
                    if is_busy(set, chunk) {
                        let [a, b, c] = self.face_chunk((chunk, set), facet, crossing, into);
                        sets = [sets[0] | a, sets[1] | b, sets[2] | c];
                    }
                }
                sets
            },
        )
    }

    #[inline(always)]
    fn face_chunk(
        &self,
        (chunk, set): (usize, u64),
        facet: &Facet,
        crossing: &Crossing,
        into: &mut Face,
    ) -> [u64; 3] {
        let (mut base, mut slope, mut spread) = ([facet.value; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
        for axis in 0..3 {
            let (g, r, c) = (facet.gradient[axis], facet.radius[axis], facet.centre[axis]);
            let (origin, direction) = (load(&self.origin[axis], chunk), load(&self.direction[axis], chunk));
            for i in 0..CHUNK {
                base[i] += g * (origin[i] - c);
                slope[i] += g * direction[i];
                spread[i] += r * direction[i].abs();
            }
        }
        let (enter, exit) = (load(&crossing.enter, chunk), load(&crossing.exit, chunk));
        let (mut first, mut error) = ([0.0; CHUNK], [0.0; CHUNK]);
        let (mut positive, mut negative, mut monotone) = ([0; CHUNK], [0; CHUNK], [0; CHUNK]);
        for i in 0..CHUNK {
            first[i] = base[i] + slope[i] * enter[i];
            let last = base[i] + slope[i] * exit[i];
            // More than all roundings up to here.
            let size = base[i].abs() + (slope[i] * exit[i]).abs() + (slope[i] * enter[i]).abs();
            error[i] = facet.error + 32.0 * f64::EPSILON * (size + facet.value.abs());
            let (low, high) = if first[i] < last { (first[i], last) } else { (last, first[i]) };
            positive[i] = u8::from(low > error[i]);
            negative[i] = u8::from(high < -error[i]);
        }
        let (positive, negative) = (set_of(positive, chunk), set_of(negative, chunk));
        if set & !(positive | negative) & 0xff << (CHUNK * chunk) == 0 {
            return [positive, negative, 0];
        }
        let (mut from, mut to) = (enter, exit);
        for i in 0..CHUNK {
            monotone[i] = u8::from(slope[i].abs() > spread[i] * (1.0 + 1e-9));
            let inverse = 1.0 / slope[i];
            let (middle, reach) = (-base[i] * inverse, error[i] * inverse.abs());
            let reach = reach * (1.0 + 1e-9) + 2e-15 * middle.abs();
            let (a, b) = (middle - reach, middle + reach);
            // Comparisons with NaN are false: without a slope nothing is shortened.
            from[i] = if a > enter[i] { a } else { enter[i] };
            to[i] = if b < exit[i] { b } else { exit[i] };
        }
        store(&mut into.slope, chunk, slope);
        store(&mut into.spread, chunk, spread);
        store(&mut into.first, chunk, first);
        store(&mut into.from, chunk, from);
        store(&mut into.to, chunk, to);
        [positive, negative, set_of(monotone, chunk)]
    }
}

impl Crossing {
    pub(super) fn new() -> Self {
        let zero = [0.0; LANES];
        Self { enter: zero, exit: zero, from: zero, to: zero, piece: [None; LANES] }
    }

    /// There may be roots in all of the cell.
    pub(super) fn leave_whole(&mut self, lane: usize) {
        (self.from[lane], self.to[lane]) = (self.enter[lane], self.exit[lane]);
        self.piece[lane] = None;
    }
}

impl Face {
    pub(super) fn new() -> Self {
        let zero = [0.0; LANES];
        Self { from: zero, to: zero, slope: zero, spread: zero, first: zero }
    }
}

impl Common {
    /// What all rays origin + direction·t, t ≥ 0, have in common whose origins and directions lie between those given,
    /// with the octant of one of them.
    pub(super) fn of_hull(hull: &[([f64; 3], [f64; 3]); 4]) -> (Self, usize) {
        let (mut common, mut octant) =
            (Self { origin: [(0.0, 0.0); 3], inverse: [(0.0, 0.0); 3], start: 0.0, end: f64::INFINITY }, 0);
        for axis in 0..3 {
            let range = |of: &dyn Fn(usize) -> f64| {
                (0..4).map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |r, x| (r.0.min(x), r.1.max(x)))
            };
            common.origin[axis] = range(&|i| hull[i].0[axis]);
            let (low, high) = range(&|i| hull[i].1[axis]);
            common.inverse[axis] = if low > 1.0 / STEEP || high < -1.0 / STEEP {
                (1.0 / high, 1.0 / low)
            } else {
                (f64::NEG_INFINITY, f64::INFINITY)
            };
            octant |= usize::from(high < 0.0) << axis;
        }
        (common, octant)
    }

    /// Bounds of the t at which rays cross the face of an axis at x.
    fn reach(&self, axis: usize, x: f64) -> (f64, f64) {
        let ((o0, o1), (i0, i1)) = (self.origin[axis], self.inverse[axis]);
        if i0 == f64::NEG_INFINITY {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let (a, b) = (x - o1, x - o0);
        // Otherwise the inverse has one sign.
        if i0 >= 0.0 {
            (a * if a >= 0.0 { i0 } else { i1 }, b * if b >= 0.0 { i1 } else { i0 })
        } else {
            (b * if b >= 0.0 { i0 } else { i1 }, a * if a >= 0.0 { i1 } else { i0 })
        }
    }

    /// Which of the 4³ cells between `faces` rays may cross, given in the order in which they cross them: in it, cells
    /// are numbered along the way of the rays, whose octant is given.
    pub(super) fn crossed(&self, octant: usize, faces: &[[f64; 5]; 3]) -> u64 {
        let mut spans = [[(0.0, 0.0); 4]; 3];
        for axis in 0..3 {
            let reach: [(f64, f64); 5] = std::array::from_fn(|i| self.reach(axis, faces[axis][i]));
            for (i, span) in spans[axis].iter_mut().enumerate() {
                let (near, far) = if octant >> axis & 1 == 1 { (4 - i, 3 - i) } else { (i, i + 1) };
                *span = (reach[near].0, reach[far].1);
            }
        }
        let both = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.min(b.1));
        let mut crossed = 0;
        for (k, &z) in spans[2].iter().enumerate() {
            let z = both(z, (self.start, self.end));
            if z.0 > z.1 {
                continue;
            }
            for (j, &y) in spans[1].iter().enumerate() {
                let yz = both(y, z);
                if yz.0 > yz.1 {
                    continue;
                }
                for (i, &x) in spans[0].iter().enumerate() {
                    let all = both(x, yz);
                    crossed |= u64::from(all.0 <= all.1) << RANK[i + 4 * j + 16 * k];
                }
            }
        }
        crossed
    }
}

/// Cells of a node in an order in which every ray with positive directions crosses them: by the sum of their three
/// numbers, which grows with each face that a ray crosses.
pub(super) const ORDER: [u32; 64] = orders().0;
const RANK: [u32; 64] = orders().1;

const fn orders() -> ([u32; 64], [u32; 64]) {
    let (mut order, mut rank) = ([0; 64], [0; 64]);
    let (mut sum, mut next) = (0, 0);
    while sum <= 9 {
        let mut number = 0;
        while number < 64 {
            if (number & 3) + (number >> 2 & 3) + (number >> 4) == sum {
                order[next] = number as u32;
                rank[number] = next as u32;
                next += 1;
            }
            number += 1;
        }
        sum += 1;
    }
    (order, rank)
}

/// What the numbers of cells are combined with (exclusive or) where some directions are negative.
pub(super) fn flip(octant: usize) -> u32 {
    let of_axis = |axis: usize| ((octant >> axis & 1) as u32 * 3) << (2 * axis);
    of_axis(0) | of_axis(1) | of_axis(2)
}
