//! Texts made by chance, and what must hold for whatever the front ends make of them.

use fieldstone_field::{Input, Interval, reference};
use fieldstone_lang::{
    Diagnostics, Dialect, HyperFunOptions, Model, Severity, Source, parse_formula, parse_hyperfun,
    parse_jsurf, parse_vm,
};

/// A small generator of numbers (xorshift), so that every run with a seed makes the same texts.
#[derive(Clone)]
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }

    pub(crate) fn pick<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }
}

/// A front end, with the words of its language and valid texts.
pub(crate) struct Language {
    pub(crate) name: &'static str,
    read: fn(&Source, Dialect) -> Result<Model, Diagnostics>,
    words: &'static [&'static str],
    seeds: Vec<String>,
}

impl Language {
    pub(crate) fn all() -> [Language; 4] {
        [Self::hyperfun(), Self::formula(), Self::vm(), Self::jsurf()]
    }

    fn hyperfun() -> Self {
        let read =
            |source: &Source, dialect| parse_hyperfun(source, &HyperFunOptions { object: None, dialect });
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let models = files.filter(|path| path.extension().is_some_and(|e| e == "hf"));
        let mut seeds: Vec<String> = models.filter_map(|path| std::fs::read_to_string(path).ok()).collect();
        seeds.sort();
        seeds.extend(HYPERFUN_SEEDS.map(str::to_owned));
        Self { name: "hyperfun", read, words: &HYPERFUN_WORDS, seeds }
    }

    fn formula() -> Self {
        let seeds = FORMULA_SEEDS.map(str::to_owned).to_vec();
        Self { name: "formula", read: |source, _| parse_formula(source), words: &FORMULA_WORDS, seeds }
    }

    fn vm() -> Self {
        let seeds = VM_SEEDS.map(str::to_owned).to_vec();
        Self { name: "vm", read: |source, _| parse_vm(source), words: &VM_WORDS, seeds }
    }

    fn jsurf() -> Self {
        let seeds = vec![JSURF_SEED.to_owned()];
        Self { name: "jsurf", read: |source, _| parse_jsurf(source), words: &JSURF_WORDS, seeds }
    }

    /// A text: a valid one with small changes, words in any order, statements made by the grammar, or any characters.
    pub(crate) fn text(&self, chance: &mut Chance) -> String {
        match chance.below(8) {
            0..=3 => {
                let seed = chance.below(self.seeds.len());
                mutated(chance, &self.seeds[seed], self.words)
            }
            4 | 5 if self.name == "hyperfun" => generated(chance),
            6 if chance.below(4) == 0 => characters(chance),
            _ => {
                let glue = chance.pick(&["", " "]);
                (0..=chance.below(14)).map(|_| chance.pick(self.words)).collect::<Vec<_>>().join(glue)
            }
        }
    }

    /// Reads a text and checks what comes of it; whether it was a model.
    pub(crate) fn check(&self, chance: &mut Chance, text: String) -> bool {
        let dialect = if chance.below(3) == 0 { Dialect::Strict } else { Dialect::Lenient };
        let source = Source::new("random", text);
        match (self.read)(&source, dialect) {
            Ok(model) => {
                check_values(&model, &source);
                for warning in &model.warnings {
                    assert_eq!(warning.severity, Severity::Warning);
                    assert!(warning.render(&source).starts_with("warning: "));
                }
                true
            }
            Err(errors) => {
                assert!(errors.list.iter().any(|d| d.severity == Severity::Error), "{}", source.text);
                for diagnostic in &errors.list {
                    let place = source.text.get(diagnostic.span.clone());
                    assert!(place.is_some(), "{}\n{diagnostic:?}", source.text);
                }
                assert!(errors.to_string().contains("error: "), "{}", source.text);
                false
            }
        }
    }
}

/// The values at a point must lie in those over a box around it, as far as these are defined.
fn check_values(model: &Model, source: &Source) {
    const FUEL: u32 = 20;
    const POINT: [f64; 4] = [0.7, -0.4, 1.3, 0.5];
    let (field, half) = (&model.field, 0.01);
    let outputs: Vec<_> = std::iter::once(field.value()).chain(field.attributes().iter().copied()).collect();
    if field.graph().len() > 3_000 {
        return;
    }
    let at = |input| match input {
        Input::Coordinate(k) => POINT[usize::from(k) % 4],
        Input::Parameter(k) => f64::from(k) * 0.5,
        Input::Time => 0.25,
    };
    let around = |input| match input {
        Input::Coordinate(_) => Interval { lo: at(input) - half, hi: at(input) + half },
        _ => Interval { lo: at(input), hi: at(input) },
    };
    let values = reference::evaluate(field.graph(), &outputs, (), at, FUEL);
    let ranges = reference::evaluate(field.graph(), &outputs, (), around, FUEL);
    for (value, range) in values.into_iter().zip(ranges) {
        let holds = range.lo.is_nan() || (range.lo <= value && value <= range.hi);
        assert!(holds, "{value} is not in {} to {}:\n{}", range.lo, range.hi, source.text);
    }
}

/// A text with a few characters replaced, removed, doubled, moved or cut off, and words inserted.
fn mutated(chance: &mut Chance, text: &str, words: &[&str]) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for _ in 0..=chance.below(3) {
        let at = chance.below(letters.len() + 1);
        let length = chance.below(8).min(letters.len() - at);
        match chance.below(7) {
            0 => drop(letters.splice(at..at, chance.pick(words).chars())),
            1 => drop(letters.splice(at..at + length.min(1), chance.pick(words).chars())),
            2 => drop(letters.drain(at..at + length)),
            3 if at.is_multiple_of(4) => letters.truncate(at),
            4 => {
                let digits = [
                    "0",
                    "1",
                    "2",
                    "7",
                    "0.5",
                    "-1",
                    if chance.below(100) == 0 { "1e9" } else { "12" },
                    "65536",
                ];
                let number = (at..letters.len()).find(|&i| letters[i].is_ascii_digit());
                if let Some(i) = number {
                    letters.splice(i..=i, chance.pick(&digits).chars());
                }
            }
            _ => {
                let (from, copied) = (chance.below(letters.len() + 1), chance.below(40));
                let part: Vec<char> = letters.iter().skip(from).take(copied).copied().collect();
                letters.splice(at..at, part);
            }
        }
    }
    letters.into_iter().collect()
}

/// Any characters, those of models more often.
fn characters(chance: &mut Chance) -> String {
    let character = |chance: &mut Chance| match chance.below(4) {
        0 => char::from_u32(chance.below(0x11_0000) as u32).unwrap_or('?'),
        1 => char::from(chance.below(32) as u8),
        _ => char::from(32 + chance.below(95) as u8),
    };
    (0..chance.below(60)).map(|_| character(chance)).collect()
}

/// A HyperFun text made by the grammar: mostly valid.
fn generated(chance: &mut Chance) -> String {
    let mut text = String::new();
    let names = ["f", "g", "my_model"];
    for name in &names[chance.below(3)..] {
        text += &format!(
            "{name}(x[3], a[2], s[3]) {{ array p[3], q[{}]; t = 1; u = x[2];\n",
            1 + chance.below(5)
        );
        text += "p = [1, 2, 3]; q[1] = 2;\n";
        for _ in 0..chance.below(6) {
            statement(chance, &mut text, 3);
        }
        text += &format!("{name} = {}; }}\n", expression(chance, 4));
    }
    text
}

fn statement(chance: &mut Chance, text: &mut String, depth: usize) {
    let targets = ["t", "u", "v", "i", "p[2]", "q[t]", "s[1]", "x[3]", "q[1]", "a[1]"];
    match chance.below(if depth == 0 { 1 } else { 5 }) {
        0 | 1 => *text += &format!("{} = {};\n", chance.pick(&targets), expression(chance, 3)),
        2 => {
            *text += &format!("if {} then\n", condition(chance));
            statement(chance, text, depth - 1);
            *text += chance.pick(&["", "else t = 3;", "else u = t; v = 2;"]);
            *text += "endif;\n";
        }
        3 => {
            // Long loops, and inner ones that count with the variable of the outer one and never end, take thousands of
            // times longer than other texts: a few are enough.
            let is_heavy = chance.below(200) == 0;
            let end = if is_heavy { "1000" } else { chance.pick(&["3", "10", "x[1]*3", "a[1]", "t"]) };
            let i = if is_heavy { "i" } else { ["k", "j", "i", "h"][depth] };
            *text += &format!("{i} = 0; while {i} < {end} loop\n");
            statement(chance, text, depth - 1);
            *text += &format!("{i} = {i} + 1; endloop;\n");
        }
        _ => {
            *text += &format!("array r{}[{}];\n", chance.below(100), chance.pick(&["2", "t", "2*t + 1", "u"]))
        }
    }
}

fn condition(chance: &mut Chance) -> String {
    let relation = chance.pick(&["<", "<=", ">", ">=", "=", "/="]);
    let simple = format!("{} {relation} {}", expression(chance, 2), expression(chance, 1));
    match chance.below(4) {
        0 => format!("not ({simple})"),
        1 => format!("({simple}) {} {}", chance.pick(&["and", "or"]), condition(chance)),
        _ => simple,
    }
}

fn expression(chance: &mut Chance, depth: usize) -> String {
    let leaves =
        ["1", "0.5", "2", "0", "x[1]", "x[2]", "x[3]", "a[1]", "t", "u", "q[1]", "q[x[1]]", "p[t]", "s[2]"];
    if depth == 0 {
        return chance.pick(&leaves).to_owned();
    }
    let operator = chance.pick(&["+", "-", "*", "/", "^", "|", "&", "\\", "@"]);
    let [a, b] = [(); 2].map(|()| expression(chance, depth - 1));
    match chance.below(6) {
        0 => format!("-({a})"),
        1 => format!(
            "{}({a})",
            chance.pick(&["sin", "sqrt", "abs", "exp", "log", "floor", "sign", "tan", "atan"])
        ),
        2 => format!("{}({a}, {b})", chance.pick(&["max", "min", "atan2", "mod"])),
        3 => chance.pick(&CALLS).to_owned(),
        _ => format!("({a}) {operator} ({b})"),
    }
}

const CALLS: [&str; 10] = [
    "hfSphere(x, p, 1)",
    "hfBlock(x, p, 1, 2, 3)",
    "hfShift3D(x, 1, 0, 0)",
    "hfRotate3DX(p, u)",
    "hfNoiseG(x, 1, 2, 3)",
    "hfTorusZ(p, x, 2, t)",
    "hfA_SetColor(u, s, 1, 0, 0)",
    "f(x, q, s)",
    "g(p, a)",
    "hfBlendUni(t, u, 1, 2, 3)",
];

const HYPERFUN_SEEDS: [&str; 3] = [
    "my_model(x[3], a[1], s[3]) { array q[2]; q = [1, 2]; if x[1] > 0 then s[q[1]] = 2; endif; my_model = hfSphere(x, x, 1); }",
    "my_model(x[3], a[1]) { array n[1]; n = [5]; my_model = f(x, n); } f(x[3], a[1]) { v = x[1]; n = a[1]; array q[2*n + 1];
     if n > 0 then a[1] = n - 1; q[2*n] = v; v = f(x, a) | q[x[1]]; endif; f = v; }",
    "my_model(x[3], a[1]) { f = 0; i = 0; while i < 40 and f < 10 loop f = f + x[1]*i; j = 0;
     while j < 3 loop f = f - 0.1; j = j + 1; endloop; i = i + 1; endloop; my_model = f; }",
];

const FORMULA_SEEDS: [&str; 4] = [
    "r = 1; x^2+y^2+z^2-r^2",
    "u=(1+sqrt(5))/2; 2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))",
    "if(|x| > 1 || ||y| - 1| < .5 and not z == 2, max(x, -y), 2x(y + 1)²) # comment\n = mix(x, y, t)",
    "let a = 2; b = a x; // line\nrunion(b, rsub(y, z)) + clamp(w, -1, 1)^-2^x",
];

const VM_SEEDS: [&str; 2] = [
    "_0 var-x\n_1 square _0\n_2 var-y # y\n_3 mod _1 _2\n_4 const 1.5\n_5 or _3 _4\n_6 compare _5 _4\n",
    "a var-x\nb var-t\nc const -inf\nd atan2 a b\ne and d c\nf sqrt e\ng max f a\nh rmin g d\n",
];

const HYPERFUN_WORDS: [&str; 52] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ";",
    ",",
    "if ",
    "then ",
    "else ",
    "endif;",
    "while ",
    "loop ",
    "endloop;",
    "x",
    "s",
    "a[1]",
    "array ",
    "1e",
    "1e999",
    "0",
    "-",
    "--",
    "=",
    "<",
    "|",
    "^",
    "not ",
    "and ",
    "my_model",
    "\"",
    "é",
    "==",
    "/*",
    "my_model(x,a)",
    "my_model(x[3], a[1]) {",
    "sin(",
    "hfSphere(",
    "x[x[1]*9]",
    "0/0",
    "\u{2212}",
    "array q[n];",
    "array q[3*2];",
    "q[x[2]] = 1;",
    "01",
    "1e-05",
    "\r",
    "hfR(",
    "t = t + 1;",
    "~",
    "f(x, a)",
];

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

const JSURF_SEED: &str = "# a surface\nsurface_equation=x^2+a*y^2-z^3\\\n  -1\nsurface_parameter_a=0.5\nscale_factor=-0.1\n\
    rotation_matrix=1 0 0 0 0 0 -1 0 0 1 0 0 0 0 0 1\ncamera_type=PERSPECTIVE_CAMERA\n\
    front_material_color=0.1 0.2 0.3\nlight_status_0=ON\nlight_position_0=1 2 30\n";

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
