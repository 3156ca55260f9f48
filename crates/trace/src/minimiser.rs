//! A search for a minimum that asks for one value at a time, so that many searches share their evaluations.

/// The part of a bracket that a golden section leaves: (3 − √5)/2.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// More turns than golden sections alone need from any bracket to neighbouring numbers.
const MOST_TURNS: u32 = 100;

/// The state of a search: a bracket and the three best places in it.
///
/// Brent's method (1973, chapter 5): a parabola through the best places where it converges, golden sections elsewhere.
/// Values are not negative, and the least that there can be is 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Minimiser {
    a: f64,
    b: f64,
    /// The best place with its value, then the second and the third; the ends of the bracket to begin with.
    best: [(f64, f64); 3],
    /// The last step, and the one before.
    steps: [f64; 2],
    trial: f64,
    tolerance: f64,
    turns: u32,
    done: bool,
    /// Whether an end of the bracket may be the lowest place.
    ends_count: bool,
}

impl Minimiser {
    /// Starts between two places with their values. The search gives up at once if the first value between them is not
    /// below both.
    pub(crate) fn new(near: (f64, f64), far: (f64, f64), tolerance: f64) -> Self {
        let (a, b) = (near.0, far.0);
        let (low, high) = if near.1 <= far.1 { (near, far) } else { (far, near) };
        Self {
            a,
            b,
            best: [low, low, high],
            steps: [b - a; 2],
            trial: a + 0.5 * (b - a),
            tolerance,
            turns: 0,
            done: false,
            ends_count: false,
        }
    }

    /// Starts between two places, from one between them whose value is below both.
    pub(crate) fn around(near: (f64, f64), middle: (f64, f64), far: (f64, f64), tolerance: f64) -> Self {
        let mut minimiser = Self::new(near, far, tolerance);
        let [_, low, high] = minimiser.best;
        (minimiser.best, minimiser.turns) = ([middle, low, high], 1);
        minimiser.choose();
        minimiser
    }

    /// Starts between two places, either of which may be the lowest.
    pub(crate) fn with_ends(near: (f64, f64), far: (f64, f64), tolerance: f64) -> Self {
        let done = near.1 == 0.0 || far.1 == 0.0;
        Self { ends_count: true, done, ..Self::new(near, far, tolerance) }
    }

    /// Where the next value is wanted; `None` at the end of the search.
    pub(crate) fn wants(&self) -> Option<f64> {
        (!self.done).then_some(self.trial)
    }

    /// The best place with its value, if that is below the values at the ends or those count.
    pub(crate) fn minimum(&self) -> Option<(f64, f64)> {
        let is_between = self.turns > 0 && self.best[0].0 != self.best[1].0;
        (is_between || self.ends_count).then_some(self.best[0])
    }

    /// Takes the value at the place that [`wants`](Self::wants) named.
    pub(crate) fn supply(&mut self, value: f64) {
        self.turns += 1;
        let [x, w, v] = self.best;
        let u = (self.trial, value);
        if self.turns == 1 && value < x.1 {
            self.best = [u, w, v];
        } else if self.turns == 1 && !self.ends_count {
            self.done = true;
            return;
        } else if value <= x.1 {
            if u.0 < x.0 {
                self.b = x.0
            } else {
                self.a = x.0
            }
            self.best = [u, x, w];
        } else {
            if u.0 < x.0 {
                self.a = u.0
            } else {
                self.b = u.0
            }
            if value <= w.1 {
                self.best = [x, u, w];
            } else if value <= v.1 {
                self.best = [x, w, u];
            }
        }
        self.choose();
    }

    /// Chooses the next trial, or ends the search.
    fn choose(&mut self) {
        let [(x, fx), (w, fw), (v, fv)] = self.best;
        let middle = self.a + 0.5 * (self.b - self.a);
        let narrow = (x - middle).abs() <= 2.0 * self.tolerance - 0.5 * (self.b - self.a);
        if fx == 0.0 || narrow || self.turns >= MOST_TURNS {
            self.done = true;
            return;
        }
        // The lowest point of the parabola lies at x + p/q.
        let (r, q) = ((x - w) * (fx - fv), (x - v) * (fx - fw));
        let (p, q) = ((x - v) * q - (x - w) * r, 2.0 * (r - q));
        let step = p / q;
        let converges = step.abs() < 0.5 * self.steps[1].abs() && x + step > self.a && x + step < self.b;
        let step = if converges {
            self.steps = [step, self.steps[0]];
            step
        } else {
            let rest = if x >= middle { self.a - x } else { self.b - x };
            self.steps = [GOLDEN * rest, rest];
            GOLDEN * rest
        };
        self.trial = x + step.signum() * step.abs().max(self.tolerance);
        self.done = self.trial == x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minimise(f: impl Fn(f64) -> f64, a: f64, b: f64) -> (Option<(f64, f64)>, u32) {
        let mut m = Minimiser::new((a, f(a)), (b, f(b)), 1e-15);
        while let Some(x) = m.wants() {
            m.supply(f(x));
        }
        (m.minimum(), m.turns)
    }

    /// A function, where it is least between 1 and 2, how closely that can be known, and how many turns may be needed.
    type Case = (fn(f64) -> f64, f64, f64, u32);

    #[test]
    fn finds_the_lowest_points() {
        let cases: [Case; 5] = [
            (|x| (x - 1.3).powi(2), 1.3, 1e-14, 12),
            (|x| (x * x - 2.0).powi(2), 2f64.sqrt(), 1e-14, 40),
            (|x| (x - 1.7).abs(), 1.7, 1e-14, 90),
            (|x| (x - 1.6).powi(4), 1.6, 1e-8, 90),
            // Below 10⁻⁸ from the lowest point the values cannot be told apart.
            (|x| 1.0 + (x - 1.4).powi(2), 1.4, 1e-7, 90),
        ];
        for (i, (f, place, error, most)) in cases.into_iter().enumerate() {
            let (found, turns) = minimise(f, 1.0, 2.0);
            let (x, value) = found.expect("the lowest point lies between the ends");
            assert!((x - place).abs() <= error, "{i}: {x} is not {place}");
            assert!(value == f(x) && turns <= most, "{i}: {turns} turns");
        }
    }

    #[test]
    fn starts_from_what_is_known() {
        let f = |x: f64| (x - 1.3).powi(2);
        let mut m = Minimiser::around((1.0, f(1.0)), (1.5, f(1.5)), (2.0, f(2.0)), 1e-15);
        while let Some(x) = m.wants() {
            m.supply(f(x));
        }
        assert!(m.minimum().is_some_and(|(x, _)| (x - 1.3).abs() < 1e-14) && m.turns < 8, "{m:?}");
    }

    #[test]
    fn ends_count_if_they_may() {
        for (place, low) in [(1.0, 1.0), (2.0, 2.0), (1.0, 0.3), (1.0 + 1e-9, 1.0 + 1e-9)] {
            let f = |x: f64| (x - low).powi(2);
            let mut m = Minimiser::with_ends((1.0, f(1.0)), (2.0, f(2.0)), 1e-15);
            while let Some(x) = m.wants() {
                m.supply(f(x));
            }
            assert!(m.minimum().is_some_and(|(x, _)| (x - place).abs() < 2e-15), "{m:?}");
        }
    }

    #[test]
    fn gives_up_where_nothing_is_lower_than_the_ends() {
        assert_eq!(minimise(|x| x, 1.0, 2.0), (None, 1));
        assert_eq!(minimise(|_| 0.0, 1.0, 2.0), (None, 1));
    }
}
