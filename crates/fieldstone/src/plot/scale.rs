//! Axes: where values lie in a frame, and where their ticks are.

/// Values that are larger than this many times the typical one are drawn on a logarithmic axis.
const WIDE: f64 = 60.0;

/// How much of the range of the values stays free above and below.
const MARGIN: f64 = 0.12;

/// How values are spread over an axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Spread {
    /// Evenly.
    Linear,
    /// Evenly up to about the given size, by the logarithm beyond: roots stay visible under large values.
    Symmetric(f64),
}

/// An axis of values, which always shows 0.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Scale {
    pub(super) spread: Spread,
    /// The ends, spread.
    lo: f64,
    hi: f64,
}

impl Spread {
    /// The place of a value; it rises with the value.
    fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Symmetric(unit) => (value.abs() / unit).ln_1p().copysign(value),
        }
    }
}

impl Scale {
    /// A scale that shows all values that are finite.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).filter(|&v| v > 0.0).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        // A quarter of the values are smaller.
        let typical = sizes.get(sizes.len() / 4).copied().unwrap_or(1.0);
        let largest = sizes.last().copied().unwrap_or(1.0);
        let spread = if largest <= WIDE * typical {
            Spread::Linear
        } else {
            Spread::Symmetric(10f64.powf(typical.max(largest * 1e-30).log10().floor()).max(f64::MIN_POSITIVE))
        };
        let (lo, hi) = values.iter().fold((0.0f64, 0.0f64), |(lo, hi), &v| {
            let place = spread.place(v);
            (lo.min(place), hi.max(place))
        });
        let (lo, hi) = if lo < hi { (lo, hi) } else { (-1.0, 1.0) };
        let margin = MARGIN * (hi - lo);
        Self { spread, lo: lo - margin, hi: hi + margin }
    }

    /// Where a value lies: 0 at the lower end of the axis, 1 at the upper, infinities well beyond them.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        ((self.spread.place(value) - self.lo) / (self.hi - self.lo)).clamp(-2.0, 3.0)
    }

    /// The values at which there are ticks, in rising order.
    pub(super) fn ticks(&self) -> Vec<f64> {
        match self.spread {
            Spread::Linear => nice_ticks(self.lo, self.hi, 7),
            Spread::Symmetric(unit) => {
                let decade = |k: i32| unit * 10f64.powi(k);
                let reach =
                    |end: f64| (0..320).take_while(move |&k| Spread::Symmetric(unit).place(decade(k)) < end);
                let (above, below) = (reach(self.hi).count() as i32, reach(-self.lo).count() as i32);
                let step = ((above + below) as usize / 8).max(1);
                let negative = (0..below).step_by(step).map(|k| -decade(k)).rev();
                let positive = (0..above).step_by(step).map(decade);
                negative.chain([0.0]).chain(positive).collect()
            }
        }
    }
}

/// Round numbers between two ends, about `count` of them.
pub(super) fn nice_ticks(lo: f64, hi: f64, count: usize) -> Vec<f64> {
    let rough = (hi - lo) / count as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|&s| s >= rough);
    let Some(step) = step.filter(|s| s.is_finite() && *s > 0.0) else { return vec![lo, hi] };
    let first = (lo / step).ceil();
    // Ends far from 0 and close together have no round numbers that can be told apart.
    let ticks = (0..=2 * count).map(|k| (first + k as f64) * step).take_while(|&t| t <= hi);
    ticks.map(|t| if t.abs() < 1e-9 * step { 0.0 } else { t }).collect()
}

/// A number as short as its neighbours at a distance of `step` allow.
pub(super) fn label(value: f64, step: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        let text = format!("{value:.2e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}e{exponent}").replace('-', "−");
    }
    let digits = (-step.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(nice_ticks(-1.05, 1.05, 5), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(nice_ticks(0.0, 70.0, 7), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0]);
        assert!(nice_ticks(1e9, 1e9 + 1e-7, 6).len() <= 13);
        assert_eq!(nice_ticks(1.0, 1.0, 5).len(), 2);
    }

    #[test]
    fn zero_is_always_shown() {
        for values in [vec![5.0, 6.0], vec![-3.0, -1.0], vec![], vec![0.0], vec![f64::NAN, f64::INFINITY]] {
            let scale = Scale::of(values.iter().copied());
            assert!((0.0..=1.0).contains(&scale.fraction(0.0)), "{values:?}");
            assert!(values.iter().all(|v| !v.is_finite() || (0.0..=1.0).contains(&scale.fraction(*v))));
            assert!(scale.ticks().contains(&0.0));
        }
    }

    #[test]
    fn huge_values_leave_room_for_roots() {
        let values = |largest: f64| (-50..=50).map(move |k| (f64::from(k) / 50.0).powi(9) * largest);
        let scale = Scale::of(values(1e12));
        assert!(matches!(scale.spread, Spread::Symmetric(_)));
        assert!(scale.fraction(1e9) > scale.fraction(0.0) + 0.1);
        assert!(scale.fraction(f64::INFINITY) > 1.0 && scale.fraction(-1e300) < 0.0);
        let ticks = scale.ticks();
        assert!(ticks.len() > 4 && ticks.len() < 20 && ticks.windows(2).all(|w| w[0] < w[1]), "{ticks:?}");
        assert_eq!(Scale::of([-1.0, 0.5, 1.0].into_iter()).spread, Spread::Linear);
    }

    #[test]
    fn labels_are_short() {
        assert_eq!(label(0.5, 0.5), "0.5");
        assert_eq!(label(-20.0, 10.0), "−20");
        assert_eq!(label(1e7, 1e6), "1e7");
        assert_eq!(label(-2.5e-6, 1e-6), "−2.5e−6");
    }
}
