//! Texts made by chance: whatever they are, the front ends return, and what they return holds together.
//!
//! `cargo run --release -p fieldstone-lang --example fuzz -- 1 1000000` reads more of them.

mod texts;

use texts::{Chance, Language};

/// Both models and errors must be among the texts, so that they test something.
fn read(language: &Language, count: usize) {
    let mut chance = Chance::new(1);
    let models = (0..count)
        .filter(|_| {
            let text = language.text(&mut chance);
            language.check(&mut chance, text)
        })
        .count();
    assert!(models > count / 50 && models < count, "{models} models of {count} texts");
}

#[test]
fn random_hyperfun_texts_are_read_or_refused() {
    read(&Language::all()[0], 4_000);
}

#[test]
fn random_formulas_are_read_or_refused() {
    read(&Language::all()[1], 12_000);
}

#[test]
fn random_programs_are_read_or_refused() {
    read(&Language::all()[2], 12_000);
}

#[test]
fn random_surfaces_are_read_or_refused() {
    read(&Language::all()[3], 12_000);
}

/// At the point of the check the first loop takes 18 of 20 turns and leaves too few to the second one; in the box around
/// it the condition of the first has no value.
#[test]
fn a_set_trusts_no_loop_behind_one_whose_condition_has_no_value() {
    let text =
        "my_model(x[3], a[1]) { e = 17.9 + sqrt(0.705 - x[1]); i = 0; while i < e loop i = i + 1; endloop;
        j = 0; if x[1] > 5 then j = i; endif; while j < x[3]*4 loop j = j + 1; endloop; my_model = j; }";
    assert!(Language::all()[0].check(&mut Chance::new(1), text.to_owned()));
}
