//! What the facets of a cell settle about rays that cross it.
//!
//! Along a ray each piece of a cell has a stretch in which its facet leaves a root possible, and certain signs before
//! and behind it. So the signs of all pieces are known but in these stretches, and with them that of their combination.
//! Where it changes in the stretch of a single piece that is monotone along the ray, there is exactly one root, and it is
//! that piece's: no other piece is evaluated.

use super::Cell;
use super::packet::lanes_of;
use super::pieces::{MOST, Piece, Pieces};
use super::solve::{Solve, Target};
use super::walk::{Flock, Pending, Start, Walk, Walker};
use fieldstone_field::{LANES, Tape};
use fieldstone_trace::{Certificate, Hit, Ray};

/// Rays are marched with the program of the node around a cell if it has at most so many times as many instructions, and
/// so many more.
const LONGER: usize = 2;
const FEW_INSTRUCTIONS: usize = 12;

/// Values of longer programs wait for others of the same.
const FEW_TO_WAIT: usize = 64;

/// Whether a value is on the other side of the surface than a ray has been.
fn has_changed(walk: &Walk<'_>, value: f64, inside: bool) -> bool {
    (value < 0.0) != inside && !(walk.settings.surface && value == 0.0)
}

/// What is known of the pieces along all rays of a packet.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// The sets of rays along which each piece is positive, and negative, all over the cell.
    signs: [(u64, u64); MOST],
    /// Those along which it is monotone.
    monotone: [u64; MOST],
}

/// The stretch of a ray in which a piece may change its sign.
#[derive(Clone, Copy, Debug, Default)]
struct Event {
    from: f64,
    to: f64,
    piece: usize,
}

/// What pieces say of one ray.
#[derive(Clone, Copy, Debug)]
enum Finding {
    /// There is no root.
    Nothing,
    /// The ray is on the other side of the surface than it was known to be.
    Wrong,
    /// There may be roots between these; of the piece with this number, if it is one alone.
    Open(f64, f64, Option<u8>),
    /// There is exactly one root, in the stretch of one piece; if it reaches the end of the cell, only if the
    /// piece has changed its sign by then.
    Root(Event),
}

/// A ray with a root in a cell if a piece has changed its sign where it leaves it.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    lane: usize,
    event: Event,
}

/// A ray with the only root that a cell may have for it, and where it leaves the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubtful<'w> {
    root: Root<'w>,
    exit: f64,
}

/// The only root of a ray in a cell.
#[derive(Clone, Copy, Debug)]
struct Root<'w> {
    solve: Solve<'w>,
    /// The gradient there, if it is known already.
    gradient: Option<[f64; 3]>,
    entering: bool,
}

impl<'w> Walk<'w> {
    /// Takes a root, for the first.
    fn take(&mut self, root: Root<'w>) {
        let Root { solve: Solve { target, bracket: (from, to), .. }, gradient, entering } = root;
        let width = self.settings.tolerance * self.settings.size;
        let is_exact = to - from <= width;
        if !is_exact && !self.settings.any_hit {
            return self.solves.push(root.solve);
        }
        let t = 0.5 * (from + to);
        let before = if is_exact { from.min(t - width) } else { from };
        let hit = Hit { t, before, after: to, entering, jump: false, touching: false };
        self.outcomes[target.place].hit = Some(hit);
        match (&mut self.gradients, gradient) {
            (Some(gradients), Some(gradient)) => gradients[target.place] = gradient,
            _ => self.hits.push(target),
        }
    }
}

impl Walker {
    /// Settles what the pieces of an open cell can; the set of rays that need a closer look, where
    /// [`Crossing`](super::packet::Crossing) says.
    pub(super) fn settle<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        (cell, pieces): (&'w Cell, &'w Pieces),
        set: u64,
        flock: &mut Flock,
    ) -> u64 {
        let mut known = Known::default();
        for (k, piece) in pieces.list().iter().enumerate() {
            let [positive, negative, monotone] =
                self.packet.face(self.level, set, &piece.facet, (&self.crossing, &mut self.faces[k]));
            known.signs[k] = (positive, negative);
            known.monotone[k] = monotone;
        }
        let (positive, negative) = pieces.signs(&known.signs);
        // Most rays come from outside, and stay there.
        let stay = positive & flock.known & !flock.inside;
        let set = set & !stay;
        if set == 0 {
            return 0;
        }
        let program: &Tape = &cell.programs.value;
        self.pass(walk, program, (set & positive, false), flock);
        self.pass(walk, program, (set & negative, true), flock);
        let open = set & !(positive | negative) & flock.active;
        lanes_of(open & !flock.known)
            .for_each(|lane| self.meet_start(lane, self.crossing.enter[lane], flock));
        if cell.is_leaf {
            self.find_starts(walk, program, open & !flock.known, flock);
        }
        let mut rest = open & flock.active & !flock.known;
        lanes_of(rest).for_each(|lane| self.crossing.leave_whole(lane));
        self.ends.clear();
        for lane in lanes_of(open & flock.active & flock.known) {
            let inside = flock.inside >> lane & 1 == 1;
            match self.look(pieces, &known, lane, inside) {
                Finding::Nothing => {}
                Finding::Wrong => self.pass(walk, program, (1 << lane, !inside), flock),
                Finding::Open(from, to, piece) => {
                    (self.crossing.from[lane], self.crossing.to[lane]) = (from, to);
                    self.crossing.piece[lane] = piece;
                    rest |= 1 << lane;
                }
                Finding::Root(event) if event.to < self.crossing.exit[lane] => {
                    self.found(walk, &pieces.list()[event.piece], (lane, event), flock);
                }
                Finding::Root(event) => self.ends.push(End { lane, event }),
            }
        }
        self.find_ends(walk, pieces, flock);
        rest
    }

    /// What pieces say of a ray that enters on a known side.
    fn look(&self, pieces: &Pieces, known: &Known, lane: usize, inside: bool) -> Finding {
        let mut events = [Event::default(); MOST];
        let mut count = 0;
        // The pieces that are negative where the ray is.
        let mut negative = 0u32;
        for k in 0..pieces.list().len() {
            let (is_positive, is_negative) =
                (known.signs[k].0 >> lane & 1 == 1, known.signs[k].1 >> lane & 1 == 1);
            let face = &self.faces[k];
            negative |= u32::from(is_negative || !is_positive && face.slope[lane] > 0.0) << k;
            if is_positive || is_negative {
                continue;
            }
            let from = face.from[lane];
            let event = Event { from, to: face.to[lane].max(from), piece: k };
            let mut place = count;
            while place > 0 && events[place - 1].from > from {
                events[place] = events[place - 1];
                place -= 1;
            }
            events[place] = event;
            count += 1;
        }
        let events = &events[..count];
        let mut next = 0;
        while next < count {
            // Events that overlap go together.
            let first = next;
            let (mut to, mut open) = (events[first].to, 1 << events[first].piece);
            next += 1;
            while next < count && events[next].from <= to {
                to = to.max(events[next].to);
                open |= 1 << events[next].piece;
                next += 1;
            }
            let together = &events[first..next];
            match pieces.decided(negative, open) {
                Some(sign) if sign != inside => return Finding::Wrong,
                Some(_) => {}
                None => match self.meet(together, known, lane, inside) {
                    Finding::Nothing => {}
                    Finding::Open(from, ..) => {
                        let end = events[first..].iter().fold(to, |end, event| end.max(event.to));
                        let alone = if first + 1 == count { Some(events[first].piece as u8) } else { None };
                        return Finding::Open(from, end, alone);
                    }
                    found => return found,
                },
            }
            for event in together {
                let falls = self.faces[event.piece].slope[lane] < 0.0;
                negative = negative & !(1 << event.piece) | u32::from(falls) << event.piece;
            }
        }
        Finding::Nothing
    }

    /// What events mean for a ray, any of which may change the sign of the field.
    fn meet(&self, together: &[Event], known: &Known, lane: usize, inside: bool) -> Finding {
        let rises = |event: &Event| self.faces[event.piece].slope[lane] > 0.0;
        let is_monotone = |event: &Event| known.monotone[event.piece] >> lane & 1 == 1;
        let from = together[0].from;
        if !together.iter().all(is_monotone) || together.iter().any(|e| rises(e) != rises(&together[0])) {
            return Finding::Open(from, from, None);
        }
        if rises(&together[0]) != inside {
            // Inside it gets further below 0, and outside further above.
            return Finding::Nothing;
        }
        match together {
            [event] => Finding::Root(*event),
            _ => Finding::Open(from, from, None),
        }
    }

    /// The side on which rays start that start in this cell, by the value there.
    fn find_starts(&mut self, walk: &mut Walk<'_>, program: &Tape, set: u64, flock: &mut Flock) {
        if set == 0 {
            return;
        }
        self.lanes.clear();
        self.lanes.extend(lanes_of(set));
        self.evaluate(program, |walker, lane| walker.packet.start[lane]);
        for (i, &lane) in self.lanes.iter().enumerate() {
            let value = self.points.output(0, 0)[i];
            walk.outcome(lane).cost += 1;
            if value.is_nan() {
                walk.outcome(lane).certificate = Certificate::Undecided;
            }
            flock.start(lane, value < 0.0, walk);
        }
    }

    /// Evaluates a program at one place of each ray in the list of lanes.
    fn evaluate(&mut self, program: &Tape, place: impl Fn(&Self, usize) -> f64) {
        for i in 0..self.lanes.len() {
            let lane = self.lanes[i];
            let t = place(self, lane);
            for axis in 0..3 {
                let x = self.packet.origin[axis][lane] + self.packet.direction[axis][lane] * t;
                self.points.input(axis, 0)[i] = x;
            }
        }
        self.points.run(program, self.lanes.len());
    }

    /// Looks which pieces have changed their signs where rays leave the cell.
    fn find_ends<'w>(&mut self, walk: &mut Walk<'w>, pieces: &'w Pieces, flock: &mut Flock) {
        let mut ends = std::mem::take(&mut self.ends);
        ends.sort_by_key(|end| end.event.piece);
        for same in ends.chunk_by(|a, b| a.event.piece == b.event.piece) {
            let piece = &pieces.list()[same[0].event.piece];
            if piece.program.len() > FEW_TO_WAIT {
                for &End { lane, event } in same {
                    let root = self.root(walk, piece, (lane, event), flock);
                    walk.doubtful.push(Doubtful { root, exit: self.crossing.exit[lane] });
                    flock.active &= !(1 << lane);
                }
                continue;
            }
            self.lanes.clear();
            self.lanes.extend(same.iter().map(|end| end.lane));
            self.evaluate(&piece.program, |walker, lane| walker.crossing.exit[lane]);
            for (i, end) in same.iter().enumerate() {
                let value = self.points.output(0, 0)[i];
                walk.outcome(end.lane).cost += 1;
                let inside = flock.inside >> end.lane & 1 == 1;
                if has_changed(walk, value, inside) {
                    self.found(walk, piece, (end.lane, end.event), flock);
                }
            }
        }
        self.ends = ends;
    }

    /// There is exactly one root, where the facet of a piece leaves it possible.
    fn found<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        piece: &'w Piece,
        (lane, event): (usize, Event),
        flock: &mut Flock,
    ) {
        flock.active &= !(1 << lane);
        walk.take(self.root(walk, piece, (lane, event), flock));
    }

    fn root<'w>(
        &self,
        walk: &Walk<'w>,
        piece: &'w Piece,
        (lane, event): (usize, Event),
        flock: &Flock,
    ) -> Root<'w> {
        let face = &self.faces[event.piece];
        let solve = Solve {
            target: Target { place: walk.places[lane], program: &piece.program },
            bracket: (event.from, event.to),
            slope: face.slope[lane],
            spread: face.spread[lane],
            guess: self.crossing.enter[lane] - face.first[lane] / face.slope[lane],
        };
        Root {
            solve,
            gradient: piece.facet.is_flat().then_some(piece.facet.gradient),
            entering: flock.inside >> lane & 1 == 0,
        }
    }

    /// Looks at the values where doubtful rays leave their cells; those without a root walk on.
    pub(super) fn settle_doubtful(&mut self, walk: &mut Walk<'_>, rays: &[Ray], starts: &mut Vec<Start>) {
        let mut doubtful = std::mem::take(&mut walk.doubtful);
        doubtful.sort_by_key(|doubtful| doubtful.root.solve.target.key());
        let by_program =
            |a: &Doubtful<'_>, b: &Doubtful<'_>| a.root.solve.target.key() == b.root.solve.target.key();
        for same in doubtful.chunk_by(by_program).flat_map(|same| same.chunks(LANES)) {
            for (i, Doubtful { root, exit }) in same.iter().enumerate() {
                let point = rays[root.solve.target.place].at(*exit);
                (0..3).for_each(|axis| self.points.input(axis, 0)[i] = point[axis]);
            }
            self.points.run(same[0].root.solve.target.program, same.len());
            for (i, &Doubtful { root, exit }) in same.iter().enumerate() {
                let (place, inside) = (root.solve.target.place, !root.entering);
                walk.outcomes[place].cost += 1;
                if has_changed(walk, self.points.output(0, 0)[i], inside) {
                    walk.take(root);
                } else if exit < rays[place].end {
                    starts.push(Start { place, t: exit, inside: Some(inside) });
                } else {
                    walk.outcomes[place].ends_inside = inside;
                }
            }
        }
        doubtful.clear();
        walk.doubtful = doubtful;
    }

    /// Has rays marched where roots are possible: with the program of the only piece that has them, or that of the cell
    /// or, so that more of them are marched together, of the one that it is part of.
    pub(super) fn postpone<'w>(
        &mut self,
        walk: &mut Walk<'w>,
        (cell, around): (&'w Cell, &'w Tape),
        set: u64,
        flock: &mut Flock,
    ) {
        let program: &Tape = &cell.programs.value;
        let is_short = around.len() <= LONGER * program.len() + FEW_INSTRUCTIONS;
        let program = if is_short { around } else { program };
        for lane in lanes_of(set) {
            let (enter, exit) = (self.crossing.enter[lane], self.crossing.exit[lane]);
            self.meet_start(lane, enter, flock);
            let crossing = &self.crossing;
            let (part, program) = match &cell.pieces {
                Some(pieces) => {
                    let part = (crossing.from[lane], crossing.to[lane]);
                    let alone = crossing.piece[lane].map(|k| &*pieces.list()[usize::from(k)].program);
                    (part, alone.unwrap_or(program))
                }
                None => ((enter, exit), program),
            };
            if part.0 < part.1 {
                let known = flock.known >> lane & 1 == 1;
                let inside = known.then_some(flock.inside >> lane & 1 == 1);
                let target = Target { place: walk.places[lane], program };
                walk.pending.push(Pending { target, part, exit, inside });
                flock.active &= !(1 << lane);
            }
        }
    }
}
