//! The gradient of the minimum at a point.
//!
//! Where F is smooth at its minimiser u*, that is ∂F/∂X there (the envelope theorem). On a kink of F, where it falls left of
//! u* and rises right of it, the minimiser moves with X along the kink, and the gradient mixes those on both sides:
//! (1 − λ) g₋ + λ g₊ with (1 − λ) F_u₋ + λ F_u₊ = 0, which is where max(F₋, F₊) is least.

use super::{Found, Minimum, Scratch};

/// Sides of a minimiser are looked at as far from it as the places of this stage of the search lie apart, or farther.
const SIDE: i32 = 9;

/// Slopes that differ by more than this times what the second derivative at the minimiser says belong to a kink.
const KINK: f64 = 2.0;

/// ∂F/∂X and ∂F/∂u at a place.
struct Slopes {
    arguments: Vec<f64>,
    over: f64,
}

impl Minimum {
    /// Writes the derivatives of the minimum along its arguments.
    pub(super) fn slopes_at(&self, scratch: &mut Scratch, arguments: &[f64], gradient: &mut [f64]) {
        let found = self.found(scratch, arguments);
        if let Some(mixed) = self.mixed(scratch, arguments, found) {
            gradient.copy_from_slice(&mixed);
            return;
        }
        let place = self.refined(scratch, arguments, found.place);
        let [at] = self.derivatives(scratch, arguments, [place]);
        gradient.copy_from_slice(&at.arguments);
    }

    /// The gradient on a kink of F, if the minimiser lies on one.
    fn mixed(&self, scratch: &mut Scratch, arguments: &[f64], found: Found) -> Option<Vec<f64>> {
        let reach = (2.0 * found.within).max(self.spacing(SIDE)).max(8.0 * f64::EPSILON * found.place.abs());
        let sides = [found.place - reach, found.place + reach];
        let sides = sides.map(|u| u.clamp(self.range[0], self.range[1]));
        let [left, right] = self.derivatives(scratch, arguments, sides);
        let jump = right.over - left.over;
        // NaN fails all.
        let is_valley = left.over <= 0.0 && right.over >= 0.0 && jump > 0.0;
        if !is_valley {
            return None;
        }
        let [_, bend] = self.slope_and_bend(scratch, arguments, found.place);
        if jump <= KINK * bend * (sides[1] - sides[0]) {
            return None;
        }
        let share = -left.over / jump;
        let pairs = left.arguments.iter().zip(&right.arguments);
        Some(pairs.map(|(before, behind)| (1.0 - share) * before + share * behind).collect())
    }

    /// The derivatives of F at places.
    fn derivatives<const N: usize>(
        &self,
        scratch: &mut Scratch,
        arguments: &[f64],
        places: [f64; N],
    ) -> [Slopes; N] {
        let slopes = &mut scratch.gradients;
        let inputs = arguments.len() + 1;
        let mut found = places.map(|_| Slopes { arguments: Vec::with_capacity(inputs), over: 0.0 });
        for first in (0..inputs).step_by(3) {
            for k in 0..inputs {
                for (lane, place) in places.iter().enumerate() {
                    slopes.input(k, 0)[lane] = *arguments.get(k).unwrap_or(place);
                }
                for seed in 0..3 {
                    slopes.input(k, seed + 1)[..N].fill(f64::from(u8::from(k == first + seed)));
                }
            }
            slopes.run(&self.tape, N);
            for seed in 0..(inputs - first).min(3) {
                for (lane, at) in found.iter_mut().enumerate() {
                    at.arguments.push(slopes.output(0, seed + 1)[lane]);
                }
            }
        }
        // u stands behind the arguments.
        for at in &mut found {
            at.over = at.arguments.pop().unwrap_or(f64::NAN);
        }
        found
    }
}
