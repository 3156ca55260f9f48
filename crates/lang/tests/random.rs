//! Texts made by chance: whatever they are, the front ends return, and what they return holds together.

use fieldstone_field::Bindings;
use fieldstone_lang::{Diagnostics, Model, Severity, Source, parse_formula, parse_jsurf, parse_vm};

/// A small generator of numbers (xorshift), so that every run tests the same texts.
struct Chance(u64);

impl Chance {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }

    fn pick<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }
}

type Parse = fn(&Source) -> Result<Model, Diagnostics>;

/// Reads a text and checks the result; whether it was a model.
fn check(parse: Parse, text: String) -> bool {
    let source = Source::new("random", text);
    match parse(&source) {
        Ok(model) => {
            let values = model.field.at(&vec![0.5; model.coordinates], &Bindings::new());
            assert_eq!(values.len(), 1, "{}", source.text);
            model.warnings.iter().for_each(|warning| assert_eq!(warning.severity, Severity::Warning));
            true
        }
        Err(errors) => {
            assert!(errors.list.iter().any(|d| d.severity == Severity::Error), "{}", source.text);
            for diagnostic in &errors.list {
                assert!(
                    source.text.get(diagnostic.span.clone()).is_some(),
                    "{}\n{diagnostic:?}",
                    source.text
                );
            }
            assert!(errors.to_string().contains("error: "), "{}", source.text);
            false
        }
    }
}

/// Replaces, removes, doubles or inserts a few characters.
fn mutate(chance: &mut Chance, text: &str, inserted: &[&str]) -> String {
    let mut letters: Vec<String> = text.chars().map(String::from).collect();
    for _ in 0..=chance.below(3) {
        let at = chance.below(letters.len() + 1);
        let word = chance.pick(inserted).to_owned();
        match chance.below(3) {
            0 => letters.insert(at, word),
            1 if at < letters.len() => letters[at] = word,
            _ if at < letters.len() => drop(letters.remove(at)),
            _ => letters.push(word),
        }
    }
    letters.concat()
}

/// Reads `count` texts; both models and errors must be among them, so that the texts test something.
fn check_many(parse: Parse, count: usize, mut text: impl FnMut(&mut Chance) -> String) {
    let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
    let models = (0..count).filter(|_| check(parse, text(&mut chance))).count();
    assert!(models > 0 && models < count, "{models} models of {count} texts");
}

const FORMULA_WORDS: [&str; 62] = [
    "x", "y", "z", "w", "t", "pi", "e", "r", "abc", "π", "1", "2.5", ".5", "1e3", "1e999", "²", "⁻¹", "⁻",
    "+", "-", "−", "*", "·", "/", "^", "**", "=", "==", "<", "≤", ">=", "!=", "!", "|", "||", "(", "(", ")",
    ")", ",", ";", ";", "let", "and", "or", "not", "&&", "if(", "sin(", "sin", "min(", "clamp(", "foo(",
    "r = ", "r = 2;", "#", "//", "\n", " ", "$", "é", "\u{feff}",
];

const VM_WORDS: [&str; 26] = [
    "_0", "_1", "_2", "a", "var-x", "var-y", "var-w", "var-t", "const", "1.5", "nan", "-inf", "add", "neg",
    "mod", "and", "or", "not", "sqr", "\n", "\n", "\r\n", "#", "\t", "é", "\u{feff}",
];

#[test]
fn random_words_are_read_as_formulas_or_refused() {
    check_many(parse_formula, 6_000, |chance| {
        let glue = chance.pick(&["", " "]);
        (0..=chance.below(12)).map(|_| chance.pick(&FORMULA_WORDS)).collect::<Vec<_>>().join(glue)
    });
}

#[test]
fn mutated_formulas_are_read_or_refused() {
    let formulas = [
        "r = 1; x^2+y^2+z^2-r^2",
        "u=(1+sqrt(5))/2; 2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))",
        "if(|x| > 1 || ||y| - 1| < .5 and not z == 2, max(x, -y), 2x(y + 1)²) # comment\n = mix(x, y, t)",
        "let a = 2; b = a x; // line\nrunion(b, rsub(y, z)) + clamp(w, -1, 1)^-2^x",
    ];
    check_many(parse_formula, 6_000, |chance| {
        let formula = chance.pick(&formulas);
        mutate(chance, formula, &FORMULA_WORDS)
    });
}

#[test]
fn random_words_are_read_as_programs_or_refused() {
    check_many(parse_vm, 6_000, |chance| {
        (0..=chance.below(12)).map(|_| chance.pick(&VM_WORDS)).collect::<Vec<_>>().join(" ")
    });
}

#[test]
fn mutated_programs_are_read_or_refused() {
    let program =
        "_0 var-x\n_1 square _0\n_2 var-y # y\n_3 mod _1 _2\n_4 const 1.5\n_5 or _3 _4\n_6 compare _5 _4\n";
    check_many(parse_vm, 6_000, |chance| mutate(chance, program, &VM_WORDS));
}

const JSURF_WORDS: [&str; 22] = [
    "\n",
    "\n",
    "=",
    ":",
    " ",
    "\\",
    "\\u00",
    "\\=",
    "#",
    "!",
    "x",
    "y^2",
    "a",
    "0.5",
    "-1",
    "nan",
    "1e999",
    "surface_equation=",
    "surface_parameter_a=",
    "light_status_1=ON\n",
    "é",
    "\u{feff}",
];

#[test]
fn mutated_surfaces_are_read_or_refused() {
    let surface = "# a surface\nsurface_equation=x^2+a*y^2-z^3\\\n  -1\nsurface_parameter_a=0.5\nscale_factor=-0.1\n\
        rotation_matrix=1 0 0 0 0 0 -1 0 0 1 0 0 0 0 0 1\ncamera_type=PERSPECTIVE_CAMERA\n\
        front_material_color=0.1 0.2 0.3\nlight_status_0=ON\nlight_position_0=1 2 30\n";
    check_many(parse_jsurf, 6_000, |chance| mutate(chance, surface, &JSURF_WORDS));
}
