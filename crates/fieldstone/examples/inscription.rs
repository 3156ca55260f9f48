//! Writes `gallery/text.vm`: an upright stone slab with an inscription in relief, as one program of min and max.
//!
//! ```text
//! cargo run --release -p fieldstone --example inscription > gallery/text.vm
//! ```
//!
//! The letters are strokes of one width around centre lines on a grid six units high. A stroke is a function of (u, v)
//! that is negative inside: none is an exact distance, all have a slope of 1 across the stroke, which is what the bevel
//! needs. The smallest of all is the text; a slab in depth, cut back at 45° towards the edges, makes it a relief.

use std::collections::HashMap;
use std::io::Write;

const TEXT: [&str; 16] = [
    "THIS STONE WAS NEVER QUARRIED.",
    "NO HAND HAS CUT THESE LETTERS.",
    "EACH STROKE IS A FUNCTION THAT",
    "IS NEGATIVE WHERE THERE IS",
    "MATTER, POSITIVE IN THE AIR,",
    "AND ZERO AT THE SKIN OF BOTH.",
    "THE SMALLEST OF THEM ALL IS",
    "THE WHOLE INSCRIPTION. FAR",
    "FROM A WORD ITS STROKES ARE",
    "FORGOTTEN, AND SHORT IS WHAT",
    "IS LEFT TO READ. A RAY OF",
    "LIGHT THAT COMES THIS WAY",
    "ASKS ONLY HOW FAR IT MAY GO",
    "UNTIL THE VALUE CHANGES SIGN,",
    "AND WHAT IT FINDS IS PROVED",
    "TO THE LAST CORNER OF AN X.",
];

/// Half the width of a stroke, in units of the font.
const HALF_WIDTH: f64 = 0.46;
/// The height of a capital between centre lines.
const CAP: f64 = 6.0;
/// The free space between two letters, between centre lines.
const SPACING: f64 = 1.75;
const WORD_SPACE: f64 = 2.3;
const LINE_PITCH: f64 = 9.9;
/// The size of a unit of the font in the model.
const UNIT: f64 = 0.105;

/// What is left of a circle, seen from its centre.
#[derive(Clone, Copy)]
enum Cut {
    /// A half: u ≥ centre, and the same for v.
    Right,
    Top,
    Bottom,
    /// A quarter.
    TopRight,
    BottomRight,
    /// Three quarters: all but the lower right, all but the upper left.
    NotBottomRight,
    NotTopLeft,
}
use Cut::*;

#[derive(Clone, Copy)]
enum Stroke {
    /// From a point to a point.
    Line(f64, f64, f64, f64),
    /// Centre, radius, and what is left of the circle.
    Arc(f64, f64, f64, Cut),
}
use Stroke::{Arc, Line};

struct Glyph {
    width: f64,
    strokes: Vec<Stroke>,
}

fn stem(u: f64) -> Stroke {
    Line(u, 0.0, u, CAP)
}

fn bar(v: f64, from: f64, to: f64) -> Stroke {
    Line(from, v, to, v)
}

/// The strokes of a capital; `None` for what the font does not have.
fn glyph(letter: char) -> Option<Glyph> {
    let round = |r: f64, top, bottom| [Arc(r, CAP - r, r, top), Arc(r, r, r, bottom)];
    let (width, strokes) = match letter {
        'A' => (3.8, vec![Line(0.0, 0.0, 1.9, CAP), Line(1.9, CAP, 3.8, 0.0), bar(1.9, 0.6, 3.2)]),
        'B' => {
            let bows = [Arc(1.5, 4.5, 1.5, Right), Arc(1.5, 1.5, 1.5, Right)];
            (
                3.0,
                [&[stem(0.0), bar(6.0, 0.0, 1.4), bar(3.0, 0.0, 1.4), bar(0.0, 0.0, 1.4)][..], &bows]
                    .concat(),
            )
        }
        'C' => (3.4, [&[Line(0.0, 1.7, 0.0, 4.3)][..], &round(1.7, Top, Bottom)].concat()),
        'D' => {
            let bow = [Arc(1.2, 4.0, 2.0, TopRight), Arc(1.2, 2.0, 2.0, BottomRight)];
            (
                3.2,
                [&[stem(0.0), bar(6.0, 0.0, 1.1), bar(0.0, 0.0, 1.1), Line(3.2, 2.1, 3.2, 3.9)][..], &bow]
                    .concat(),
            )
        }
        'E' => (2.7, vec![stem(0.0), bar(6.0, 0.0, 2.7), bar(3.1, 0.0, 2.3), bar(0.0, 0.0, 2.7)]),
        'F' => (2.6, vec![stem(0.0), bar(6.0, 0.0, 2.6), bar(3.1, 0.0, 2.2)]),
        'G' => {
            let chin = [Line(3.4, 1.7, 3.4, 2.6), bar(2.6, 2.2, 3.4), Line(0.0, 1.7, 0.0, 4.3)];
            (3.4, [&chin[..], &round(1.7, Top, Bottom)].concat())
        }
        'H' => (3.2, vec![stem(0.0), stem(3.2), bar(3.1, 0.0, 3.2)]),
        'I' => (0.0, vec![stem(0.0)]),
        'J' => (2.4, vec![Line(2.4, 1.2, 2.4, CAP), Arc(1.2, 1.2, 1.2, Bottom)]),
        'K' => (3.2, vec![stem(0.0), Line(0.0, 2.4, 3.2, CAP), Line(1.1, 3.4, 3.2, 0.0)]),
        'L' => (2.5, vec![stem(0.0), bar(0.0, 0.0, 2.5)]),
        'M' => (4.2, vec![stem(0.0), Line(0.0, CAP, 2.1, 1.2), Line(2.1, 1.2, 4.2, CAP), stem(4.2)]),
        'N' => (3.3, vec![stem(0.0), Line(0.0, CAP, 3.3, 0.0), stem(3.3)]),
        'O' | 'Q' => {
            let sides = [Line(0.0, 1.8, 0.0, 4.2), Line(3.6, 1.8, 3.6, 4.2)];
            let tail = (letter == 'Q').then_some(Line(2.2, 1.5, 3.8, -0.4));
            (3.6, [&sides[..], &round(1.8, Top, Bottom), tail.as_slice()].concat())
        }
        'P' | 'R' => {
            let bow = [stem(0.0), bar(6.0, 0.0, 1.4), bar(3.0, 0.0, 1.4), Arc(1.5, 4.5, 1.5, Right)];
            let leg = (letter == 'R').then_some(Line(1.2, 3.0, 3.1, 0.0));
            (3.0, [&bow[..], leg.as_slice()].concat())
        }
        'S' => (3.0, vec![Arc(1.5, 4.5, 1.5, NotBottomRight), Arc(1.5, 1.5, 1.5, NotTopLeft)]),
        'T' => (3.4, vec![stem(1.7), bar(6.0, 0.0, 3.4)]),
        'U' => {
            let sides = [Line(0.0, 1.7, 0.0, CAP), Line(3.4, 1.7, 3.4, CAP)];
            (3.4, [&sides[..], &[Arc(1.7, 1.7, 1.7, Bottom)]].concat())
        }
        'V' => (3.8, vec![Line(0.0, CAP, 1.9, 0.0), Line(1.9, 0.0, 3.8, CAP)]),
        'W' => {
            let halves = |u: f64| [Line(u, CAP, u + 1.4, 0.0), Line(u + 1.4, 0.0, u + 2.8, CAP)];
            (5.6, [halves(0.0), halves(2.8)].concat())
        }
        'X' => (3.5, vec![Line(0.0, 0.0, 3.5, CAP), Line(0.0, CAP, 3.5, 0.0)]),
        'Y' => (3.6, vec![Line(0.0, CAP, 1.8, 2.9), Line(1.8, 2.9, 3.6, CAP), Line(1.8, 0.0, 1.8, 2.9)]),
        'Z' => (3.2, vec![bar(6.0, 0.0, 3.2), bar(0.0, 0.0, 3.2), Line(0.0, 0.0, 3.2, CAP)]),
        '.' => (0.0, vec![Line(0.0, 0.0, 0.0, 0.0)]),
        ',' => (0.0, vec![Line(0.1, 0.0, -0.3, -1.3)]),
        _ => return None,
    };
    Some(Glyph { width, strokes })
}

/// A `.vm` program in the making; equal lines are written once.
#[derive(Default)]
struct Program {
    lines: Vec<String>,
    known: HashMap<String, usize>,
}

/// A line of the program.
#[derive(Clone, Copy)]
struct Value(usize);

impl Program {
    fn line(&mut self, operation: String) -> Value {
        let next = self.lines.len();
        let at = *self.known.entry(operation.clone()).or_insert(next);
        if at == next {
            self.lines.push(format!("_{at:x} {operation}"));
        }
        Value(at)
    }

    fn constant(&mut self, value: f64) -> Value {
        // Four decimals are a tenth of a millimetre on a slab of a metre, and keep the file readable.
        self.line(format!("const {}", (value * 1e4).round() / 1e4))
    }

    fn unary(&mut self, name: &str, a: Value) -> Value {
        self.line(format!("{name} _{:x}", a.0))
    }

    fn binary(&mut self, name: &str, a: Value, b: Value) -> Value {
        self.line(format!("{name} _{:x} _{:x}", a.0, b.0))
    }

    fn minus(&mut self, a: Value, constant: f64) -> Value {
        let constant = self.constant(constant);
        self.binary("sub", a, constant)
    }

    /// |a − centre| − half: negative between two planes.
    fn slab(&mut self, a: Value, centre: f64, half: f64) -> Value {
        let shifted = self.minus(a, centre);
        let distance = self.unary("abs", shifted);
        self.minus(distance, half)
    }

    /// Combines all, in a tree as flat as can be: short programs for small regions need short ways.
    fn fold(&mut self, name: &str, values: &[Value]) -> Option<Value> {
        match values {
            [] => None,
            [one] => Some(*one),
            _ => {
                let (left, right) = values.split_at(values.len() / 2);
                let (left, right) = (self.fold(name, left)?, self.fold(name, right)?);
                Some(self.binary(name, left, right))
            }
        }
    }
}

/// The plane of the text, in units of the font.
#[derive(Clone, Copy)]
struct Plane {
    u: Value,
    v: Value,
}

impl Plane {
    fn stroke(self, program: &mut Program, stroke: Stroke, (u, v): (f64, f64)) -> Value {
        match stroke {
            Line(u0, v0, u1, v1) if u0 == u1 || v0 == v1 => {
                let across = program.slab(self.u, u + (u0 + u1) / 2.0, (u1 - u0).abs() / 2.0 + HALF_WIDTH);
                let along = program.slab(self.v, v + (v0 + v1) / 2.0, (v1 - v0).abs() / 2.0 + HALF_WIDTH);
                program.binary("max", across, along)
            }
            Line(u0, v0, u1, v1) => self.slant(program, [u + u0, v + v0, u + u1, v + v1]),
            Arc(u0, v0, radius, cut) => self.arc(program, [u + u0, v + v0, radius], cut),
        }
    }

    /// A slanted stroke, cut off level above and below.
    fn slant(self, program: &mut Program, [u0, v0, u1, v1]: [f64; 4]) -> Value {
        let length = (u1 - u0).hypot(v1 - v0);
        let normal = ((v1 - v0) / length, (u0 - u1) / length);
        let factors = [normal.0, normal.1].map(|n| program.constant(n));
        let along_u = program.binary("mul", self.u, factors[0]);
        let along_v = program.binary("mul", self.v, factors[1]);
        let offset = program.binary("add", along_u, along_v);
        let across = program.slab(offset, normal.0 * u0 + normal.1 * v0, HALF_WIDTH);
        let level = program.slab(self.v, (v0 + v1) / 2.0, (v1 - v0).abs() / 2.0 + HALF_WIDTH);
        program.binary("max", across, level)
    }

    fn arc(self, program: &mut Program, [u0, v0, radius]: [f64; 3], cut: Cut) -> Value {
        let (u, v) = (program.minus(self.u, u0), program.minus(self.v, v0));
        let squares = [u, v].map(|a| program.unary("square", a));
        let sum = program.binary("add", squares[0], squares[1]);
        let distance = program.unary("sqrt", sum);
        let ring = program.slab(distance, radius, HALF_WIDTH);
        let (right, top) = (|p: &mut Program| p.unary("neg", u), |p: &mut Program| p.unary("neg", v));
        let kept = match cut {
            Right => right(program),
            Top => top(program),
            Bottom => v,
            TopRight => {
                let sides = [right(program), top(program)];
                program.binary("max", sides[0], sides[1])
            }
            BottomRight => {
                let side = right(program);
                program.binary("max", side, v)
            }
            NotBottomRight => {
                let side = top(program);
                program.binary("min", u, side)
            }
            NotTopLeft => {
                let side = right(program);
                program.binary("min", side, v)
            }
        };
        program.binary("max", ring, kept)
    }

    /// The letters of a line, centred on u = 0, their feet at `v`.
    fn line(self, program: &mut Program, text: &str, v: f64) -> Vec<Value> {
        let advance = |letter| glyph(letter).map_or(WORD_SPACE, |g| g.width + SPACING);
        let length = text.chars().map(advance).sum::<f64>() - SPACING;
        let mut u = -length / 2.0;
        let mut letters = Vec::new();
        for letter in text.chars() {
            let strokes = glyph(letter).map_or(Vec::new(), |g| g.strokes);
            let strokes: Vec<Value> = strokes.iter().map(|&s| self.stroke(program, s, (u, v))).collect();
            letters.extend(program.fold("min", &strokes));
            u += advance(letter);
        }
        letters
    }
}

/// The slab with its raised frame and its foot; the text stands on the plane y = 0 and comes towards −y.
fn stone(program: &mut Program, text: Value, [x, y, z]: [Value; 3]) -> Option<Value> {
    let height = 0.1;
    // The bevel: the relief is full where the stroke is deep, and loses height towards its edge.
    let relief = {
        let depth = program.unary("neg", y);
        let top = program.minus(depth, height);
        let slope = program.binary("add", text, top);
        let bevel = program.minus(slope, -0.02);
        let behind = program.minus(y, 0.3);
        program.fold("max", &[text, top, bevel, behind])?
    };
    let mut block = |centre: [f64; 3], half: [f64; 3]| {
        let sides = [(x, 0), (y, 1), (z, 2)].map(|(a, i)| program.slab(a, centre[i], half[i]));
        program.fold("max", &sides)
    };
    let slab = block([0.0, 0.5, 0.0], [7.7, 0.5, 8.6])?;
    let frame = block([0.0, 0.4, 0.0], [8.0, 0.65, 8.9])?;
    let window = block([0.0, -1.0, 0.0], [7.6, 1.2, 8.5])?;
    let foot = block([0.0, 0.5, -9.3], [8.5, 1.5, 0.5])?;
    let outside_window = program.unary("neg", window);
    let rim = program.binary("max", frame, outside_window);
    program.fold("min", &[slab, rim, foot, relief])
}

fn main() -> std::io::Result<()> {
    let mut program = Program::default();
    let point = ["var-x", "var-y", "var-z"].map(|name| program.line(name.to_owned()));
    let scale = program.constant(1.0 / UNIT);
    let plane =
        Plane { u: program.binary("mul", point[0], scale), v: program.binary("mul", point[2], scale) };
    let middle = (TEXT.len() - 1) as f64 / 2.0;
    let mut lines = Vec::new();
    for (i, text) in TEXT.iter().enumerate() {
        let v = (middle - i as f64) * LINE_PITCH - CAP / 2.0;
        let letters = plane.line(&mut program, text, v);
        lines.extend(program.fold("min", &letters));
    }
    let Some(text) = program.fold("min", &lines) else { return Ok(()) };
    let unit = program.constant(UNIT);
    let text = program.binary("mul", text, unit);
    stone(&mut program, text, point);

    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "# An inscription in relief on an upright slab. Written by crates/fieldstone/examples/inscription.rs."
    )?;
    program.lines.iter().try_for_each(|line| writeln!(out, "{line}"))
}
