//! Solids that a field describes, in cells.
//!
//! The volume is divided like an octree; intervals prove cells empty or filled, and what neither can be said of is
//! divided, down to 4 × 4 × 4 parts of each cell of the finest level. In a part that is still open the field is replaced by its
//! tangent at the centre, a plane: the area of its slice is exact, and the side it lies on tells which of
//! 4 × 4 × 4 places are filled. Areas and normals therefore err with the square of a part's width where the surface is smooth
//! (a ball of 8 cells' radius: 10⁻³), and with the width along edges. Coverage is counted on 16 × 16 places of a cell's face.
//!
//! In blocks of 16 × 16 × 16 cells the program is shortened to what matters there.

use super::cell::{Finish, Gathered, ISOTROPIC, opaque};
use super::mask::{Mask, PARTS};
use super::slice::slice_area;
use super::{MAX_CELLS, Paint, Place, SourceError, placed};
use crate::{Builder, Texel};
use fieldstone_field::{
    Bindings, F64, Field, Gradients, Graph, Input, Intervals, LANES, Points, Reading, Tape, TapeOptions,
    Workspace,
};
use glam::DVec3;
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Which of the cells that lie inside of a solid are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Inside {
    /// Those that share a face with a cell of the surface, so that no light gets in.
    #[default]
    Skin,
    /// All.
    Full,
    /// None.
    Empty,
}

/// How a solid is baked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BakeOptions {
    /// How far the flakes spread around the surface's normals, 0 (a mirror) to 1 (all ways alike).
    pub roughness: f64,
    /// What is done with cells inside, which stop all light.
    pub inside: Inside,
    /// Whether the solid is left open where the box cuts it; otherwise it ends there with faces of its own.
    pub open: bool,
    /// The part of the volume that the box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

/// What a baked point is painted with: from the point, in coordinates of the field, and the field's attributes there.
pub type Painter<'a> = &'a (dyn Fn(DVec3, &[f64]) -> Paint + Sync);

/// Adds the part of a solid in the box from `low` to `high`, in coordinates of the field, which is fitted into
/// the volume. Returns where the field's points are in the volume.
///
/// # Errors
/// Boxes that are none, options out of their ranges, and more cells than [`MAX_CELLS`].
pub fn bake(
    builder: &mut Builder,
    (field, bindings): (&Field, &Bindings),
    [low, high]: [[f64; 3]; 2],
    options: &BakeOptions,
    paint: Painter<'_>,
) -> Result<Place, SourceError> {
    let good = (0.0..=1.0).contains(&options.roughness);
    SourceError::check("roughness", options.roughness, good, "a number from 0 to 1")?;
    let place = placed(builder, [Some([low, high]), options.within], || [low, high])?;
    let solid = if options.open { field.clone() } else { capped(field, low, high) };
    let baker = Baker::new(&solid, bindings, place, builder.edge(), (options, paint));
    let (open, inside) = baker.blocks();
    let examined: Vec<Block> = open
        .par_iter()
        .map_init(Engines::default, |engines, (cube, tape)| baker.examine(engines, tape, *cube))
        .collect();
    let count: usize = examined.iter().map(|block| block.surface.len()).sum();
    let too_many = SourceError::TooMany { what: "a solid's cells", most: MAX_CELLS };
    let mut filled = inside;
    filled.extend(examined.iter().flat_map(|block| &block.inside));
    match options.inside {
        Inside::Empty => {}
        Inside::Skin if count > MAX_CELLS / 6 => return Err(too_many),
        Inside::Skin => builder.extend(baker.skin(&examined)),
        Inside::Full => {
            let cells = |cube: &Cube| (u64::from(cube.size) / PARTS as u64).pow(3);
            if filled.iter().map(cells).sum::<u64>() > MAX_CELLS as u64 {
                return Err(too_many);
            }
            let cells: Vec<[u32; 3]> = filled.iter().flat_map(|cube| cube.cells()).collect();
            builder.extend(baker.opaque(&cells));
        }
    }
    builder.extend(examined.into_par_iter().flat_map(|block| block.surface));
    Ok(place)
}

/// The solid, ended by the box.
fn capped(field: &Field, low: [f64; 3], high: [f64; 3]) -> Field {
    let mut graph: Graph = (**field.graph()).clone();
    let mut value = field.value();
    for axis in 0..3 {
        let x = graph.input(Input::Coordinate(axis as u16));
        let (from, to) = (graph.constant(low[axis]), graph.constant(high[axis]));
        let (below, above) = (graph.sub(from, x), graph.sub(x, to));
        let beyond = graph.max(below, above);
        value = graph.max(value, beyond);
    }
    Field::new(graph, value, field.attributes().to_vec()).with_fuel(field.fuel())
}

/// A cube of the octree; lengths count parts of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cube {
    low: [u32; 3],
    size: u32,
}

impl Cube {
    fn halves(self) -> impl Iterator<Item = Self> {
        let size = self.size / 2;
        (0..8).map(move |i| {
            let low = [0, 1, 2].map(|axis| self.low[axis] + size * (i >> axis & 1));
            Self { low, size }
        })
    }

    /// The cells of the finest level in this cube, which is one at least.
    fn cells(self) -> impl Iterator<Item = [u32; 3]> {
        let (n, low) = (self.size / PARTS as u32, self.low.map(|c| c / PARTS as u32));
        (0..n.pow(3)).map(move |i| [low[0] + i % n, low[1] + i / n % n, low[2] + i / n / n])
    }

    /// Its place among the parts of its cell.
    fn part(self) -> [usize; 3] {
        self.low.map(|c| c as usize % PARTS)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Status {
    Inside,
    Outside,
    Open,
}

/// What was found in a block.
#[derive(Default)]
struct Block {
    surface: Vec<([u32; 3], Texel)>,
    inside: Vec<Cube>,
}

/// Memory for evaluations.
#[derive(Default)]
struct Engines {
    intervals: Workspace<F64, Intervals>,
    gradients: Workspace<F64, Gradients>,
    points: Workspace<F64, Points>,
}

/// A cell of the finest level that the surface may go through.
#[derive(Default)]
struct Open {
    mask: Mask,
    gathered: Gathered,
}

/// A piece of the surface in a part of a cell.
struct Piece {
    cell: usize,
    point: DVec3,
    normal: DVec3,
    /// In squares of the volume's edge.
    area: f64,
}

struct Baker<'a> {
    tape: Tape,
    /// Value and attributes, if there are attributes.
    colours: Option<Tape>,
    place: Place,
    edge: u32,
    finish: Finish,
    paint: Painter<'a>,
}

impl<'a> Baker<'a> {
    fn new(
        solid: &Field,
        bindings: &Bindings,
        place: Place,
        edge: u32,
        (options, paint): (&BakeOptions, Painter<'a>),
    ) -> Self {
        let options_of = |attributes, reading| TapeOptions {
            bindings: bindings.clone(),
            attributes,
            reading,
            ..TapeOptions::default()
        };
        let has_colours = !solid.attributes().is_empty();
        Self {
            tape: Tape::new(solid, &options_of(false, Reading::Sign)),
            colours: has_colours.then(|| Tape::new(solid, &options_of(true, Reading::Value))),
            place,
            edge,
            finish: Finish::surface(options.roughness),
            paint,
        }
    }

    /// A point of the grid of parts, in coordinates of the field; `at` counts parts.
    fn model_point(&self, at: DVec3) -> DVec3 {
        self.place.model_from_cube(at / (f64::from(self.edge) * PARTS as f64))
    }

    /// The blocks that the surface may go through, each with a program shortened to it, and cubes inside.
    fn blocks(&self) -> (Vec<(Cube, Tape)>, Vec<Cube>) {
        let mut engines = Engines::default();
        let mut open = vec![Cube { low: [0; 3], size: self.edge * PARTS as u32 }];
        let mut inside = Vec::new();
        while open.first().is_some_and(|cube| cube.size > 16 * PARTS as u32) {
            let halves: Vec<Cube> = open.iter().flat_map(|cube| cube.halves()).collect();
            open = self.sorted(&mut engines, &self.tape, &halves, &mut inside);
        }
        let shortened = open.par_iter().map_init(Engines::default, |engines, cube| {
            self.set_box(&mut engines.intervals, 0, *cube);
            engines.intervals.run_traced(&self.tape, 1);
            let shorter = self.tape.shortened(|place| engines.intervals.choice(place, 0));
            (*cube, shorter.unwrap_or_else(|| self.tape.clone()))
        });
        (shortened.collect(), inside)
    }

    fn set_box(&self, workspace: &mut Workspace<F64, Intervals>, lane: usize, cube: Cube) {
        let low = DVec3::from_array(cube.low.map(f64::from));
        let corners = [low, low + f64::from(cube.size)].map(|corner| self.model_point(corner).to_array());
        for axis in 0..3 {
            for (end, corner) in corners.iter().enumerate() {
                workspace.input(axis, end)[lane] = corner[axis];
            }
        }
    }

    /// What is known of up to 64 cubes.
    fn statuses(&self, engines: &mut Engines, tape: &Tape, cubes: &[Cube]) -> Vec<Status> {
        let workspace = &mut engines.intervals;
        for (lane, cube) in cubes.iter().enumerate() {
            self.set_box(workspace, lane, *cube);
        }
        workspace.run(tape, cubes.len());
        let ends = (0..cubes.len()).map(|lane| (workspace.output(0, 0)[lane], workspace.output(0, 1)[lane]));
        ends.map(|(low, high)| match (low, high) {
            (low, high) if low.is_nan() || high.is_nan() => Status::Open,
            (low, _) if low >= 0.0 => Status::Outside,
            (_, high) if high < 0.0 => Status::Inside,
            _ => Status::Open,
        })
        .collect()
    }

    /// The open ones of some cubes; those inside go to their list.
    fn sorted(
        &self,
        engines: &mut Engines,
        tape: &Tape,
        cubes: &[Cube],
        inside: &mut Vec<Cube>,
    ) -> Vec<Cube> {
        let mut open = Vec::new();
        for some in cubes.chunks(LANES) {
            for (cube, status) in some.iter().zip(self.statuses(engines, tape, some)) {
                match status {
                    Status::Inside => inside.push(*cube),
                    Status::Open => open.push(*cube),
                    Status::Outside => {}
                }
            }
        }
        open
    }

    fn examine(&self, engines: &mut Engines, tape: &Tape, block: Cube) -> Block {
        let mut found = Block::default();
        let mut cells = vec![block];
        while cells.first().is_some_and(|cube| cube.size > PARTS as u32) {
            let halves: Vec<Cube> = cells.iter().flat_map(|cube| cube.halves()).collect();
            cells = self.sorted(engines, tape, &halves, &mut found.inside);
        }
        let numbers: BTreeMap<[u32; 3], usize> =
            cells.iter().enumerate().map(|(number, cell)| (cell.low.map(|c| c / 4), number)).collect();
        let number = |cube: &Cube| numbers[&cube.low.map(|c| c / 4)];
        let mut open: Vec<Open> = cells.iter().map(|_| Open::default()).collect();
        let mut parts = cells.clone();
        while parts.first().is_some_and(|cube| cube.size > 1) {
            let halves: Vec<Cube> = parts.iter().flat_map(|cube| cube.halves()).collect();
            let mut inside = Vec::new();
            parts = self.sorted(engines, tape, &halves, &mut inside);
            for cube in inside {
                fill(&mut open[number(&cube)].mask, cube);
            }
        }
        let mut pieces = Vec::new();
        for some in parts.chunks(LANES) {
            self.cut(engines, tape, some, |cube| number(cube), (&mut open, &mut pieces));
        }
        self.add_pieces(engines, &pieces, &mut open);
        let width = f64::from(self.edge).recip();
        for (cell, open) in cells.iter().zip(open) {
            let mut gathered = open.gathered;
            if gathered.amount == 0.0 && open.mask.is_full() {
                found.inside.push(*cell);
            } else if gathered.amount > 0.0 || !open.mask.is_empty() {
                gathered.cover(open.mask.cover());
                found.surface.push((cell.low.map(|c| c / PARTS as u32), gathered.texel(width)));
            }
        }
        found
    }

    /// Cuts up to 64 parts by the field's tangents.
    fn cut(
        &self,
        engines: &mut Engines,
        tape: &Tape,
        parts: &[Cube],
        number: impl Fn(&Cube) -> usize,
        (open, pieces): (&mut [Open], &mut Vec<Piece>),
    ) {
        let workspace = &mut engines.gradients;
        let centre = |cube: &Cube| self.model_point(DVec3::from_array(cube.low.map(f64::from)) + 0.5);
        self.run_gradients(workspace, tape, &parts.iter().map(centre).collect::<Vec<_>>());
        let part_in_model = (self.place.scale() * f64::from(self.edge) * PARTS as f64).recip();
        let part_in_cube = (f64::from(self.edge) * PARTS as f64).recip();
        for (lane, cube) in parts.iter().enumerate() {
            let value = workspace.output(0, 0)[lane];
            let gradient = DVec3::from_array([1, 2, 3].map(|k| workspace.output(0, k)[lane]));
            let cell = number(cube);
            let (steepness, place) = (gradient.length(), cube.part());
            if !(steepness.is_finite() && steepness > 0.0 && value.is_finite()) {
                if value < 0.0 {
                    open[cell].mask.fill(place);
                }
                continue;
            }
            open[cell].mask.fill_below(place, value, gradient * part_in_model);
            let normal = gradient / steepness;
            let area = slice_area(normal, -value / (steepness * part_in_model)) * part_in_cube.powi(2);
            if area > 0.0 {
                let point = centre(cube) - normal * (value / steepness);
                pieces.push(Piece { cell, point, normal, area });
            }
        }
    }

    /// Paints pieces and gathers them in their cells.
    fn add_pieces(&self, engines: &mut Engines, pieces: &[Piece], open: &mut [Open]) {
        for some in pieces.chunks(LANES) {
            let points: Vec<DVec3> = some.iter().map(|piece| piece.point).collect();
            for (piece, paint) in some.iter().zip(self.paints(&mut engines.points, &points)) {
                let shape = self.finish.around(piece.normal);
                // A body's surface is seen from one side: half of a sheet's ½.
                open[piece.cell].gathered.add(0.25 * piece.area, &shape, &paint);
            }
        }
    }

    /// The paint at up to 64 points.
    fn paints(&self, workspace: &mut Workspace<F64, Points>, points: &[DVec3]) -> Vec<Paint> {
        let Some(tape) = &self.colours else {
            return points.iter().map(|point| (self.paint)(*point, &[])).collect();
        };
        self.run_points(workspace, tape, points);
        let attributes = |lane: usize| -> Vec<f64> {
            (1..tape.output_count()).map(|output| workspace.output(output, 0)[lane]).collect()
        };
        points.iter().enumerate().map(|(lane, point)| (self.paint)(*point, &attributes(lane))).collect()
    }

    fn run_points(&self, workspace: &mut Workspace<F64, Points>, tape: &Tape, points: &[DVec3]) {
        for axis in 0..3 {
            for (lane, point) in points.iter().enumerate() {
                workspace.input(axis, 0)[lane] = point[axis];
            }
        }
        workspace.run(tape, points.len());
    }

    /// The cells inside that share a face with a cell of the surface.
    fn skin(&self, blocks: &[Block]) -> Vec<([u32; 3], Texel)> {
        let mut surface: Vec<[u32; 3]> =
            blocks.iter().flat_map(|block| block.surface.iter().map(|(cell, _)| *cell)).collect();
        surface.par_sort_unstable();
        let last = self.edge - 1;
        let mut beside: Vec<[u32; 3]> = surface
            .par_iter()
            .flat_map_iter(|cell| {
                (0..3).flat_map(move |axis| {
                    let (mut before, mut behind) = (*cell, *cell);
                    before[axis] = cell[axis].saturating_sub(1);
                    behind[axis] = (cell[axis] + 1).min(last);
                    [before, behind]
                })
            })
            .filter(|cell| surface.binary_search(cell).is_err())
            .collect();
        beside.par_sort_unstable();
        beside.dedup();
        // A cell that no surface goes through is inside or outside as a whole.
        let inside: Vec<Vec<[u32; 3]>> = beside
            .par_chunks(LANES)
            .map_init(Workspace::<F64, Points>::new, |workspace, cells| {
                let centres: Vec<DVec3> = cells.iter().map(|cell| self.centre(*cell)).collect();
                self.run_points(workspace, &self.tape, &centres);
                let values = &workspace.output(0, 0)[..cells.len()];
                cells.iter().zip(values).filter(|(_, value)| **value < 0.0).map(|(cell, _)| *cell).collect()
            })
            .collect();
        self.opaque(&inside.concat())
    }

    /// The centre of a cell, in coordinates of the field.
    fn centre(&self, cell: [u32; 3]) -> DVec3 {
        self.model_point((DVec3::from_array(cell.map(f64::from)) + 0.5) * PARTS as f64)
    }

    /// Cells that stop all light, painted as the field is in their middle, with flakes across its slope.
    fn opaque(&self, cells: &[[u32; 3]]) -> Vec<([u32; 3], Texel)> {
        cells
            .par_chunks(LANES)
            .map_init(Engines::default, |engines, cells| {
                let centres: Vec<DVec3> = cells.iter().map(|cell| self.centre(*cell)).collect();
                let paints = self.paints(&mut engines.points, &centres);
                self.run_gradients(&mut engines.gradients, &self.tape, &centres);
                let slopes = &engines.gradients;
                let texel = |(lane, paint): (usize, Paint)| {
                    let slope = DVec3::from_array([1, 2, 3].map(|k| slopes.output(0, k)[lane]));
                    let shape = slope.try_normalize().map_or(ISOTROPIC, |normal| self.finish.around(normal));
                    (cells[lane], opaque(shape, &paint))
                };
                paints.into_iter().enumerate().map(texel).collect::<Vec<_>>()
            })
            .flatten_iter()
            .collect()
    }

    /// Values and slopes at up to 64 points.
    fn run_gradients(&self, workspace: &mut Workspace<F64, Gradients>, tape: &Tape, points: &[DVec3]) {
        for axis in 0..3 {
            for (lane, point) in points.iter().enumerate() {
                workspace.input(axis, 0)[lane] = point[axis];
                for direction in 0..3 {
                    workspace.input(axis, 1 + direction)[lane] = f64::from(u8::from(axis == direction));
                }
            }
        }
        workspace.run(tape, points.len());
    }
}

/// Fills the parts of a cell that a cube of one or eight parts holds.
fn fill(mask: &mut Mask, cube: Cube) {
    let [x, y, z] = cube.part();
    let size = cube.size as usize;
    for i in 0..size.pow(3) {
        mask.fill([x + i % size, y + i / size % size, z + i / size / size]);
    }
}

#[cfg(test)]
mod tests;
