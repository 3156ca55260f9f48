//! A bracketed solver that asks for one value at a time, so that many solves share their evaluations.

/// The state of a solve: a bracket whose ends differ in sign.
///
/// Chandrupatla's method (1997): inverse quadratic interpolation where the three last points allow it, bisection
/// otherwise. The bracket shrinks from both sides, because no trial comes closer to an end than half the tolerance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solver {
    a: f64,
    fa: f64,
    b: f64,
    fb: f64,
    c: f64,
    fc: f64,
    trial: f64,
    tolerance: f64,
    turns: u32,
    /// The width of the first bracket, and the smaller |f| at its ends.
    first: (f64, f64),
}

/// The smaller |f| of the first bracket grows by more than this at a pole.
const POLE: f64 = 16.0;

impl Solver {
    /// Starts from the bracket \[near, far\] with values of different sign.
    pub(crate) fn new(near: (f64, f64), far: (f64, f64), tolerance: f64) -> Self {
        let (a, b) = (far, near);
        let (fa, fb) = (a.1, b.1);
        let first = ((far.0 - near.0).abs(), fa.abs().min(fb.abs()));
        let mut solver =
            Self { a: a.0, fa, b: b.0, fb, c: b.0, fc: fb, trial: 0.0, tolerance, turns: 0, first };
        // The secant, for a start: brackets are short.
        let fraction = (a.1 / (a.1 - b.1)).clamp(0.0, 1.0);
        solver.trial = solver.place(if fraction.is_nan() { 0.5 } else { fraction });
        solver
    }

    /// Where the next value is wanted; `None` when the bracket is short enough.
    pub(crate) fn wants(&self) -> Option<f64> {
        let width = (self.b - self.a).abs();
        // The midpoint of two neighbours is one of them, and then no bracket can become shorter.
        let middle = self.a + 0.5 * (self.b - self.a);
        (width > self.tolerance && middle != self.a && middle != self.b && self.turns < 200)
            .then_some(self.trial)
    }

    /// Takes the value at the place that [`wants`](Self::wants) named.
    pub(crate) fn supply(&mut self, value: f64) {
        self.turns += 1;
        let x = self.trial;
        if (value < 0.0) == (self.fa < 0.0) {
            (self.c, self.fc) = (self.a, self.fa);
        } else {
            (self.c, self.fc) = (self.b, self.fb);
            (self.b, self.fb) = (self.a, self.fa);
        }
        (self.a, self.fa) = (x, value);
        let xi = (self.a - self.b) / (self.c - self.b);
        let phi = (self.fa - self.fb) / (self.fc - self.fb);
        let interpolates = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        let fraction = if interpolates {
            self.fa / (self.fb - self.fa) * self.fc / (self.fb - self.fc)
                + (self.c - self.a) / (self.b - self.a) * self.fa / (self.fc - self.fa) * self.fb
                    / (self.fc - self.fb)
        } else {
            0.5
        };
        self.trial = self.place(if fraction.is_finite() { fraction } else { 0.5 });
    }

    /// The place at a fraction of the way from a to b, not too near an end.
    fn place(&self, fraction: f64) -> f64 {
        let margin = (0.45 * self.tolerance / (self.b - self.a).abs()).min(0.5);
        self.a + fraction.clamp(margin, 1.0 - margin) * (self.b - self.a)
    }

    /// Whether |f| has grown as it does at a pole of order 1 or more, like the inverse of the width, and neither at a root
    /// nor at a jump.
    pub(crate) fn is_at_pole(&self) -> bool {
        let (width, value) = self.first;
        let growth = self.fa.abs().min(self.fb.abs()) / value;
        growth > POLE && growth * growth > width / (self.b - self.a).abs()
    }

    /// The final bracket, nearer end first, each end with its value.
    pub(crate) fn bracket(&self) -> [(f64, f64); 2] {
        let (p, q) = ((self.a, self.fa), (self.b, self.fb));
        if p.0 < q.0 { [p, q] } else { [q, p] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(f: impl Fn(f64) -> f64, near: f64, far: f64) -> ([(f64, f64); 2], u32) {
        let mut s = Solver::new((near, f(near)), (far, f(far)), 1e-12);
        while let Some(x) = s.wants() {
            s.supply(f(x));
        }
        (s.bracket(), s.turns)
    }

    /// A function, its root between 1 and 2, and how many turns may be needed.
    type Case = (fn(f64) -> f64, f64, u32);

    #[test]
    fn brackets_simple_multiple_and_steep_roots() {
        let cases: [Case; 5] = [
            (|x| x * x - 2.0, 2f64.sqrt(), 12),
            (|x| (x - 1.25).powi(3), 1.25, 130),
            (|x| (x - 1.7).tanh() * 1e3, 1.7, 14),
            (|x| if x < 1.1 { 1.0 } else { -1.0 }, 1.1, 60),
            (|x| (x - 1.0 - 1e-13).cbrt(), 1.0 + 1e-13, 60),
        ];
        for (f, root, most) in cases {
            let ([lo, hi], turns) = solve(f, 1.0, 2.0);
            assert!(lo.0 <= root && root <= hi.0, "{root} is not in [{}, {}]", lo.0, hi.0);
            assert!(hi.0 - lo.0 <= 1e-12 && turns <= most, "{} after {turns} turns", hi.0 - lo.0);
            assert!((lo.1 < 0.0) != (hi.1 < 0.0));
        }
    }

    #[test]
    fn poles_are_told_from_roots_and_jumps() {
        /// A function and whether it has a pole at 1.3.
        type Case = (fn(f64) -> f64, bool);
        let cases: [Case; 5] = [
            (|x| 1.0 / (x - 1.3), true),
            (|x| 1e-3 / (x - 1.3).powi(3) + 0.01, true),
            (|x| (x - 1.3) * 1e6, false),
            (|x| if x < 1.3 { x - 0.999 } else { -1e9 }, false),
            (|x| (x - 1.3).cbrt(), false),
        ];
        for (i, (f, is_pole)) in cases.into_iter().enumerate() {
            let mut s = Solver::new((1.0, f(1.0)), (2.0, f(2.0)), 1e-9);
            while let Some(x) = s.wants() {
                s.supply(f(x));
            }
            assert_eq!(s.is_at_pole(), is_pole, "{i}: {s:?}");
        }
    }
}
