//! Text: many small shapes, of which few matter anywhere.

use crate::font::Page;
use crate::program::{Program, Value};

const LINES: [&str; 24] = [
    "A PAGE OF LETTERS IS A SOLID TOO,",
    "ONLY THAT IT HAS NO DEPTH. EVERY",
    "STROKE KNOWS ITS OWN DISTANCE AND",
    "NOTHING OF THE OTHERS. TO ASK ALL",
    "OF THEM AT EVERY POINT WOULD TAKE",
    "A LONG TIME. AN INTERVAL ASKS FOR",
    "A WHOLE REGION AT ONCE, AND FINDS",
    "THAT NEARLY ALL STROKES ARE AWAY.",
    "WHAT IS LEFT IS A SHORT PROGRAM,",
    "A CROSSBAR, A BOW, A STEM, AND IT",
    "IS ALL THAT THE POINTS INSIDE THE",
    "REGION NEED TO KNOW. SMALLER ONES",
    "NEED LESS STILL. WHERE NO LETTER",
    "IS NEAR, ONE QUESTION IS ENOUGH,",
    "AND WHERE A STROKE COVERS ALL OF",
    "A REGION, ONE IS ENOUGH AS WELL.",
    "ONLY ALONG THE EDGES ARE THERE",
    "POINTS THAT MUST BE ASKED ONE BY",
    "ONE. THE LENGTH OF ALL EDGES IS",
    "WHAT A PICTURE OF A PAGE COSTS,",
    "NOT THE NUMBER OF ITS LETTERS.",
    "TWICE THE PIXELS ALONG EACH SIDE",
    "ARE TWICE THE WORK, NOT FOUR",
    "TIMES. SO IT SHOULD BE MEASURED.",
];

/// How many units of the font there are in a unit of space.
const UNITS: f64 = 128.0;

/// A page of text on z = 0, from −1 to 1.
pub(super) fn page(program: &Program) -> Option<Value<'_>> {
    let [x, y, _] = program.point();
    Page::new(program, x * UNITS, y * UNITS).text(&LINES)
}

/// The first lines, upright, with a depth.
pub(super) fn extruded(program: &Program) -> Option<Value<'_>> {
    let [x, y, z] = program.point();
    let units = 0.9 * UNITS;
    let text = Page::new(program, x * units, z * units).text(&LINES[..8])?;
    Some((text * (1.0 / units)).max(y.slab(0.0, 0.04)))
}
