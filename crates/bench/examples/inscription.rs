//! Writes `gallery/text.vm`: an upright stone slab with an inscription in relief, as one program of min and max.
//!
//! ```text
//! cargo run --release -p fieldstone-bench --example inscription > gallery/text.vm
//! ```
//!
//! The smallest of all strokes is the text; a slab in depth, cut back at 45° towards the edges, makes it a relief.

use fieldstone_bench::{Page, Program, Value};
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

/// The size of a unit of the font in the model.
const UNIT: f64 = 0.105;

/// The slab with its raised frame and its foot; the text stands on the plane y = 0 and comes towards −y.
fn stone<'p>(program: &'p Program, text: Value<'p>, [x, y, z]: [Value<'p>; 3]) -> Option<Value<'p>> {
    let height = 0.1;
    // The bevel: the relief is full where the stroke is deep, and loses height towards its edge.
    let top = -y - height;
    let bevel = text + top - -0.02;
    let behind = y - 0.3;
    let relief = program.intersection(&[text, top, bevel, behind])?;
    let block = |centre: [f64; 3], half: [f64; 3]| {
        let sides = [(x, 0), (y, 1), (z, 2)].map(|(a, i): (Value<'p>, usize)| a.slab(centre[i], half[i]));
        program.intersection(&sides)
    };
    let slab = block([0.0, 0.5, 0.0], [7.7, 0.5, 8.6])?;
    let frame = block([0.0, 0.4, 0.0], [8.0, 0.65, 8.9])?;
    let window = block([0.0, -1.0, 0.0], [7.6, 1.2, 8.5])?;
    let foot = block([0.0, 0.5, -9.3], [8.5, 1.5, 0.5])?;
    let rim = frame.without(window);
    program.union(&[slab, rim, foot, relief])
}

fn main() -> std::io::Result<()> {
    // Four decimals are a tenth of a millimetre on a slab of a metre, and keep the file readable.
    let program = Program::with_decimals(4);
    let point = program.point();
    let scale = program.constant(1.0 / UNIT);
    let page = Page::new(&program, point[0] * scale, point[2] * scale);
    let text = page.text(&TEXT).map(|text| text * UNIT);
    let Some(stone) = text.and_then(|text| stone(&program, text, point)) else { return Ok(()) };
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "# An inscription in relief on an upright slab. Written by crates/bench/examples/inscription.rs."
    )?;
    out.write_all(program.text(stone).as_bytes())
}
