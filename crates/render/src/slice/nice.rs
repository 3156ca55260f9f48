//! Numbers that people like to read: 1, 2 or 5 times a power of ten.

/// The smallest nice number that is not below `value`, which is positive and finite.
pub(super) fn above(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    // A little slack, so that a nice number is its own.
    factors.into_iter().map(|f| f * power).find(|&nice| nice >= value * (1.0 - 1e-9)).unwrap_or(value)
}

/// The multiples of `step` from `low` to `high`, at most 100.
pub(super) fn multiples(low: f64, high: f64, step: f64) -> Vec<f64> {
    const MOST: f64 = 100.0;
    let slack = 1e-6;
    let (first, last) = ((low / step - slack).ceil(), (high / step + slack).floor());
    if !(step > 0.0 && last - first < MOST && first.abs() < 1e15) {
        return Vec::new();
    }
    let count = (last - first).max(-1.0) as i64;
    (0..=count).map(|k| (first + k as f64) * step).collect()
}

/// A multiple of `step` with the digits that it needs.
pub(super) fn label(value: f64, step: f64) -> String {
    let value = if value.abs() < 0.5 * step { 0.0 } else { value };
    if !(1e-4..1e5).contains(&step) {
        // The digits from the first of the value to that of the step.
        let digits = (value.abs() / step).log10().max(0.0).ceil() as usize;
        return if value == 0.0 { "0".to_owned() } else { trimmed(format!("{value:.digits$e}")) };
    }
    let digits = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
    format!("{value:.digits$}")
}

/// Without zeros at the end of the fraction.
fn trimmed(text: String) -> String {
    match text.split_once('e') {
        Some((number, power)) if number.contains('.') => {
            format!("{}e{power}", number.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nice_numbers() {
        let cases =
            [(1.0, 1.0), (1.1, 2.0), (0.3, 0.5), (0.05, 0.05), (7.0, 10.0), (2e-7, 2e-7), (4321.0, 5000.0)];
        for (value, nice) in cases {
            assert!((above(value) / nice - 1.0).abs() < 1e-12, "{value}: {}", above(value));
        }
    }

    #[test]
    fn multiples_hold_the_ends() {
        assert_eq!(multiples(-1.0, 1.0, 0.5), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(multiples(0.1, 0.4, 0.5), [0.0; 0]);
        assert_eq!(multiples(0.0, 1e9, 1.0), [0.0; 0]);
    }

    #[test]
    fn labels_have_the_digits_of_the_step() {
        let cases = [
            (0.5, 0.5, "0.5"),
            (2.0, 1.0, "2"),
            (-0.25, 0.05, "-0.25"),
            (1e-17, 0.1, "0.0"),
            (300.0, 100.0, "300"),
        ];
        for (value, step, text) in cases {
            assert_eq!(label(value, step), text);
        }
        assert_eq!(label(1.2e-6, 2e-7), "1.2e-6");
        assert_eq!(label(3e6, 1e6), "3e6");
        assert_eq!(label(0.0, 1e6), "0");
    }
}
