//! Which pixels are inside or outside as a whole, by intervals.

use super::{Block, Raster, Verdict};
use fieldstone_field::{F64, Intervals, LANES, Tape, Workspace};
use rayon::prelude::*;

/// The side of the blocks between tiles and pixels: a tile has 64 of them, and each has 64 pixels.
const BLOCK: usize = 8;

/// The verdict of every pixel, row by row, and the number of boxes that were evaluated.
pub(super) fn certify(tape: &Tape, raster: &Raster) -> (Vec<Verdict>, u64) {
    let tiles = raster.tiles();
    let decided: Vec<(Vec<Verdict>, u64)> = tiles
        .par_iter()
        .map_init(Workspace::new, |boxes, tile| certify_tile(tape, raster, boxes, *tile))
        .collect();
    let mut verdicts = vec![Verdict::Open; raster.width * raster.height];
    let mut evaluations = 0;
    for (tile, (of_tile, count)) in tiles.iter().zip(decided) {
        evaluations += count;
        for ((x, y), verdict) in tile.pixels().zip(of_tile) {
            verdicts[y * raster.width + x] = verdict;
        }
    }
    (verdicts, evaluations)
}

type Boxes = Workspace<F64, Intervals>;

/// The verdicts of the pixels of a tile, row by row.
fn certify_tile(tape: &Tape, raster: &Raster, boxes: &mut Boxes, tile: Block) -> (Vec<Verdict>, u64) {
    let mut evaluations = 1;
    fill(raster, boxes, &[tile]);
    boxes.run_traced(tape, 1);
    let verdict = verdict(boxes, 0);
    let mut verdicts = vec![verdict; tile.len()];
    if verdict.is_proof() {
        return (verdicts, evaluations);
    }
    let shortened = tape.shortened(|place| boxes.choice(place, 0));
    let tape = shortened.as_ref().unwrap_or(tape);
    let width = tile.x[1] - tile.x[0];
    let mut decide = |blocks: &[Block]| -> Vec<Block> {
        let mut open = Vec::new();
        for some in blocks.chunks(LANES) {
            fill(raster, boxes, some);
            boxes.run(tape, some.len());
            evaluations += some.len() as u64;
            for (lane, block) in some.iter().enumerate() {
                let verdict = self::verdict(boxes, lane);
                let place = |(x, y): (usize, usize)| (y - tile.y[0]) * width + x - tile.x[0];
                block.pixels().for_each(|pixel| verdicts[place(pixel)] = verdict);
                if !verdict.is_proof() {
                    open.push(*block);
                }
            }
        }
        open
    };
    let open = decide(&tile.divided(BLOCK));
    open.into_iter().for_each(|block| {
        decide(&block.divided(1));
    });
    (verdicts, evaluations)
}

fn fill(raster: &Raster, boxes: &mut Boxes, blocks: &[Block]) {
    for (lane, block) in blocks.iter().enumerate() {
        let [left, right] = block.x.map(|x| raster.across(x as f64));
        let [top, bottom] = block.y.map(|y| raster.upwards(y as f64));
        for (input, component, end) in [(0, 0, left), (0, 1, right), (1, 0, bottom), (1, 1, top)] {
            boxes.input(input, component)[lane] = end;
        }
    }
}

/// Undefined bounds are NaN.
fn verdict(boxes: &Boxes, lane: usize) -> Verdict {
    let (low, high) = (boxes.output(0, 0)[lane], boxes.output(0, 1)[lane]);
    if high < 0.0 {
        Verdict::Inside
    } else if low > 0.0 {
        Verdict::Outside
    } else if low <= 0.0 && high >= 0.0 {
        Verdict::Open
    } else {
        Verdict::Unknown
    }
}
