//! Times, their medians, and how two series compare.

use serde::Serialize;

/// Seconds of repeated runs, at least one.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Times {
    seconds: Vec<f64>,
}

/// A median with the quartiles around it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Spread {
    /// A quarter of the values is below.
    pub low: f64,
    /// Half of them is.
    pub median: f64,
    /// Three quarters are.
    pub high: f64,
}

impl Times {
    /// The times of runs in their order.
    pub fn new(seconds: Vec<f64>) -> Self {
        Self { seconds }
    }

    /// In their order.
    pub fn seconds(&self) -> &[f64] {
        &self.seconds
    }

    /// The median and the quartiles; 0 of no runs.
    pub fn spread(&self) -> Spread {
        Spread::of(self.seconds.clone())
    }

    /// How many times as long the other took, pair by pair.
    pub fn ratio(&self, other: &Self) -> Spread {
        Spread::of(other.seconds.iter().zip(&self.seconds).map(|(theirs, ours)| theirs / ours).collect())
    }
}

impl Spread {
    /// Of numbers in any order, with linear interpolation between them; 0 of none.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * values.len().saturating_sub(1) as f64;
            let value = |i: f64| values.get(i as usize).copied().unwrap_or(0.0);
            value(place.floor()) + (value(place.ceil()) - value(place.floor())) * place.fract()
        };
        Self { low: at(0.25), median: at(0.5), high: at(0.75) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_quartiles() {
        let spread = Spread::of(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(spread, Spread { low: 2.0, median: 3.0, high: 4.0 });
        assert_eq!(Spread::of(vec![1.0, 2.0]).median, 1.5);
        assert_eq!(Spread::of(Vec::new()).median, 0.0);
    }

    #[test]
    fn ratios_are_of_pairs() {
        // A machine that slows down slows both: the ratio stays.
        let ours = Times::new(vec![1.0, 2.0, 4.0]);
        let theirs = Times::new(vec![3.0, 6.0, 12.0]);
        assert_eq!(ours.ratio(&theirs), Spread { low: 3.0, median: 3.0, high: 3.0 });
        assert_eq!(theirs.ratio(&ours).median, 1.0 / 3.0);
    }
}
