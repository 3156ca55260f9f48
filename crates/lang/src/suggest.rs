//! "Did you mean": the known name nearest to an unknown one.

/// Names longer than this get no suggestion: nobody mistypes them by a letter or two.
const MAX_LENGTH: usize = 32;

/// The candidate that `name` is a likely slip for, if there is one; the first of equals.
///
/// A slip is another case, or up to a third of the letters (at least one, but never all of either name) inserted, left
/// out, exchanged or swapped with their neighbour.
pub(crate) fn closest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = lower_case(name);
    if letters.len() > MAX_LENGTH {
        return None;
    }
    let allowed = (letters.len() / 3).max(1);
    let slip = |candidate: &'a str| {
        let known = lower_case(candidate);
        let distance = distance(&letters, &known);
        (distance <= allowed && distance < known.len().min(letters.len())).then_some((distance, candidate))
    };
    let others = candidates.into_iter().filter(|known| *known != name && known.len() <= MAX_LENGTH);
    others.filter_map(slip).min_by_key(|(distance, _)| *distance).map(|(_, known)| known)
}

fn lower_case(name: &str) -> Vec<char> {
    name.chars().flat_map(char::to_lowercase).collect()
}

/// The number of insertions, deletions, exchanges and swaps of neighbours between two words (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1];
        for j in 0..b.len() {
            let exchange = above[j] + usize::from(a[i] != b[j]);
            let mut cost = exchange.min(above[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                cost = cost.min(before[j - 1] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::closest;

    #[test]
    fn slips_are_found_and_other_words_are_not() {
        let known = ["sin", "sqrt", "x", "min", "smoothstep"];
        let cases = [
            ("sqr", Some("sqrt")),
            ("sqtr", Some("sqrt")),
            ("Sin", Some("sin")),
            ("X", Some("x")),
            ("r", None),
            ("smothstp", Some("smoothstep")),
            ("cosine", None),
            ("mn", Some("min")),
            ("xs", None),
            ("sin", Some("min")),
        ];
        for (name, expected) in cases {
            assert_eq!(closest(name, known), expected, "{name}");
        }
    }

    #[test]
    fn a_swap_of_neighbours_is_one_slip() {
        assert_eq!(super::distance(&['a', 'b', 'c'], &['b', 'a', 'c']), 1);
        assert_eq!(super::distance(&['a', 'b', 'c'], &['c', 'b', 'a']), 2);
        assert_eq!(super::distance(&[], &['a', 'b']), 2);
    }
}
