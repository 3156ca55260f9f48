//! Letters as strokes of one width around centre lines, on a grid six units high.
//!
//! A stroke is a function of (u, v) that is negative inside: none is an exact distance, all have a slope of 1 across the
//! stroke, which is what bevels need.

use crate::program::{Program, Value};

/// The height of a capital between centre lines, in units of the font.
pub const CAP: f64 = 6.0;
/// The distance between the feet of two lines.
pub const LINE_PITCH: f64 = 9.9;

/// Half the width of a stroke.
const HALF_WIDTH: f64 = 0.46;
/// The free space between two letters, between centre lines.
const SPACING: f64 = 1.75;
const WORD_SPACE: f64 = 2.3;

/// A plane with text on it.
#[derive(Clone, Copy, Debug)]
pub struct Page<'p> {
    program: &'p Program,
    u: Value<'p>,
    v: Value<'p>,
}

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

impl<'p> Page<'p> {
    /// A plane whose coordinates are u (to the right) and v (upwards), in units of the font.
    pub fn new(program: &'p Program, u: Value<'p>, v: Value<'p>) -> Self {
        Self { program, u, v }
    }

    /// Lines of text around the origin, each centred; capitals, blanks, full stops and commas. None of nothing.
    pub fn text(self, lines: &[&str]) -> Option<Value<'p>> {
        let middle = (lines.len() as f64 - 1.0) / 2.0;
        let mut all = Vec::new();
        for (i, line) in lines.iter().enumerate() {
            all.extend(self.line(line, (middle - i as f64) * LINE_PITCH - CAP / 2.0));
        }
        self.program.union(&all)
    }

    /// The letters of a line, centred on u = 0, their feet at `v`.
    fn line(self, text: &str, v: f64) -> Option<Value<'p>> {
        let advance = |letter| glyph(letter).map_or(WORD_SPACE, |g| g.width + SPACING);
        let length = text.chars().map(advance).sum::<f64>() - SPACING;
        let mut u = -length / 2.0;
        let mut letters = Vec::new();
        for letter in text.chars() {
            let strokes = glyph(letter).map_or(Vec::new(), |g| g.strokes);
            let strokes: Vec<Value> = strokes.iter().map(|&stroke| self.stroke(stroke, (u, v))).collect();
            letters.extend(self.program.union(&strokes));
            u += advance(letter);
        }
        self.program.union(&letters)
    }

    fn stroke(self, stroke: Stroke, (u, v): (f64, f64)) -> Value<'p> {
        match stroke {
            Line(u0, v0, u1, v1) if u0 == u1 || v0 == v1 => {
                let across = self.u.slab(u + (u0 + u1) / 2.0, (u1 - u0).abs() / 2.0 + HALF_WIDTH);
                let along = self.v.slab(v + (v0 + v1) / 2.0, (v1 - v0).abs() / 2.0 + HALF_WIDTH);
                across.max(along)
            }
            Line(u0, v0, u1, v1) => self.slant([u + u0, v + v0, u + u1, v + v1]),
            Arc(u0, v0, radius, cut) => self.arc([u + u0, v + v0, radius], cut),
        }
    }

    /// A slanted stroke, cut off level above and below.
    fn slant(self, [u0, v0, u1, v1]: [f64; 4]) -> Value<'p> {
        let length = (u1 - u0).hypot(v1 - v0);
        let normal = ((v1 - v0) / length, (u0 - u1) / length);
        let [factor_u, factor_v] = [normal.0, normal.1].map(|n| self.program.constant(n));
        let offset = self.u * factor_u + self.v * factor_v;
        let across = offset.slab(normal.0 * u0 + normal.1 * v0, HALF_WIDTH);
        let level = self.v.slab((v0 + v1) / 2.0, (v1 - v0).abs() / 2.0 + HALF_WIDTH);
        across.max(level)
    }

    fn arc(self, [u0, v0, radius]: [f64; 3], cut: Cut) -> Value<'p> {
        let (u, v) = (self.u - u0, self.v - v0);
        let ring = u.hypot(v).slab(radius, HALF_WIDTH);
        let kept = match cut {
            Right => -u,
            Top => -v,
            Bottom => v,
            TopRight => (-u).max(-v),
            BottomRight => (-u).max(v),
            NotBottomRight => u.min(-v),
            NotTopLeft => (-u).min(v),
        };
        ring.max(kept)
    }
}
