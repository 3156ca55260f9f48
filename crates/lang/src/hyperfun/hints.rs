//! What a writer probably meant.

/// The candidate that `word` is most likely a slip for.
pub(super) fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let limit = 1 + word.chars().count().min(64) / 4;
    let far = limit + 1;
    let close = |candidate: &&str| candidate.len().abs_diff(word.len()) <= limit && *candidate != word;
    let measured = candidates.into_iter().filter(close).map(|c| (distance(word, c).min(far), c));
    measured.filter(|(d, c)| *d <= limit && *d < c.len()).min_by_key(|(d, _)| *d).map(|(_, c)| c)
}

/// How many characters to insert, delete, replace or exchange with a neighbour make `b` of `a`.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut older: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(older[j - 2] + 1);
            }
            row.push(least);
        }
        older = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

/// What to write instead of a name that begins a statement in other languages.
pub(super) fn foreign_statement(word: &str) -> Option<&'static str> {
    Some(match word {
        "elseif" | "elsif" | "elif" => "write `else if … then … endif; endif;`",
        "for" | "do" | "repeat" => "loops are written `while … loop … endloop;`",
        "end" | "fi" => "`if` ends with `endif;`, `while` with `endloop;`",
        "endwhile" | "wend" | "done" => "`while … loop` ends with `endloop;`",
        "return" => "the value of an object is assigned to its own name",
        "var" | "let" | "real" | "float" | "double" | "int" => {
            "variables are not declared: they are assigned"
        }
        _ => return None,
    })
}

/// What to write instead of a name that is a constant in other languages.
pub(super) fn foreign_value(word: &str) -> Option<&'static str> {
    Some(match word {
        "pi" => "there is no constant `pi`: write 3.141592653589793 or assign it first",
        "e" => "there is no constant `e`: write `exp(1)`",
        "y" => "the coordinates are `x[1]`, `x[2]`, `x[3]`",
        "z" => "the coordinates are `x[1]`, `x[2]`, `x[3]`",
        "t" | "time" => "there is no time variable: use a coordinate `x[4]` or a parameter `a[1]`",
        "true" | "false" => "true is any number but 0, false is 0",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        assert_eq!(nearest("hfspere", ["hfsphere", "hfblock"]), Some("hfsphere"));
        assert_eq!(nearest("raduis", ["radius", "height"]), Some("radius"));
        assert_eq!(nearest("foo", ["radius", "height"]), None);
        assert_eq!(nearest("q", ["p"]), None);
    }
}
