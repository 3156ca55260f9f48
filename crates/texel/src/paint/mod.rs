//! Painting shapes into a volume.
//!
//! Every cell that a shape touches is crossed by 4 × 4 parallel rays along each axis, each moved by chance within its
//! sixteenth of the face. The share of rays that are stopped is the cell's true occlusion along that axis, so that a cell at
//! the border, or one that holds a thin blade, is as transparent as it should be. Where rays meet the surface its
//! normals are gathered, each with the weight 1 / (|nx| + |ny| + |nz|): rays along three axes find a surface as often as that sum
//! says, so that the sum of the weights measures its area (Crofton 1868), a quarter of which is the body's mean projected
//! area. Rods thinner than an eighth of a cell are sampled as if they were that thick, and weigh less.
//!
//! The inside of an opaque shape stops all light and holds no surface. It has the normals of the nearest one, by which
//! the rules of 1995 join it; those of SGGX count surfaces alone.

mod crossing;
mod piece;
mod scatter;
mod shape;

pub use piece::Frame;
pub use scatter::{MAX_SHAPES, Scatter};
pub use shape::Form;

use crate::chance::{hash, normal};
use crate::texel::MAX_DEPTH;
use crate::{Builder, Sggx, Texel, morton};
use crossing::{Meets, Stretch, meets};
use glam::{DMat3, DVec3};
use piece::{Body, Nearest, Piece};
use rayon::prelude::*;

/// A shape at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What it is.
    pub form: Form,
    /// Where it is.
    pub frame: Frame,
    /// What it is made of.
    pub material: Material,
}

/// What a shape is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The share of light that is scattered, red, green, blue, linear, 0 to 1.
    pub albedo: [f32; 3],
    /// The share of scattered light that is mirrored, 0 to 1.
    pub gloss: f32,
    /// How far flakes stray from the surface: α of [`Sggx::surface`] and [`Sggx::fibre`], 0 to 1.
    pub roughness: f64,
    /// How far normals stray from cell to cell, by chance: the tangent of the angle (standard deviation).
    pub variation: f64,
    /// Extinction per length of the volume's edge of what is cloudy; nothing for what is opaque.
    pub density: Option<f64>,
    /// Which way flakes face.
    pub flakes: Flakes,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            albedo: [0.8; 3],
            gloss: 0.0,
            roughness: 0.1,
            variation: 0.0,
            density: None,
            flakes: Flakes::Surface,
        }
    }
}

/// The micro-primitive: which way the flakes of a shape face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flakes {
    /// As the surface does.
    Surface,
    /// Fibres along the shape: along its z, or along what is bent.
    Along,
    /// Fibres along a direction of the volume, unit.
    Fibre(DVec3),
    /// Fibres in circles around z of the shape; smoothed to all sides alike from the given radius inward, or outward to it if it
    /// is below 0. Radius 0: nowhere.
    Concentric(f64),
    /// Fibres that lead away from z of the shape.
    Radial,
    /// An ellipsoid with these half axes along x, y and z of the volume.
    Ellipsoid(DVec3),
}

/// A shape as bodies in the volume.
#[derive(Clone, Debug)]
pub struct Solid {
    pieces: Vec<Piece>,
    frame: Frame,
    material: Material,
    seed: u64,
}

impl Shape {
    /// The shape as bodies. What chance decides comes from the seed.
    pub fn solid(&self, seed: u64) -> Solid {
        Solid::new(&self.form, &self.frame, 0.0, self.material.clone(), seed)
    }
}

impl Solid {
    fn new(form: &Form, frame: &Frame, curl: f64, material: Material, seed: u64) -> Self {
        Self { pieces: form.pieces(frame, curl), frame: *frame, material, seed }
    }

    /// Two corners of a box that holds it.
    fn bounds(&self) -> [DVec3; 2] {
        let boxes = self.pieces.iter().map(Piece::bounds);
        boxes.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], [a, b]| [low.min(a), high.max(b)])
    }
}

/// The greatest number of cells that are painted; a cell counts once for each solid that it holds.
pub const MAX_CELLS: usize = 1 << 24;

/// More cells would be filled than are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the shapes fill more than {MAX_CELLS} cells; a smaller edge, or fewer or smaller shapes, need less")]
pub struct PaintError;

/// Paints solids, one after the other: where they meet in a cell their contents are added. In a cyclic volume what leaves it
/// on one side comes in on the other.
///
/// # Errors
/// [`PaintError`] if more cells would be filled than are allowed.
pub fn paint(builder: &mut Builder, solids: impl IntoIterator<Item = Solid>) -> Result<(), PaintError> {
    let mut solids = solids.into_iter().peekable();
    // A batch at a time, so that what waits to be added stays small.
    while solids.peek().is_some() {
        let batch: Vec<Solid> = solids.by_ref().take(BATCH).collect();
        let filled: u64 = batch.iter().map(|solid| least_cells(solid, builder)).sum();
        if filled + builder.len() as u64 > MAX_CELLS as u64 {
            return Err(PaintError);
        }
        for jobs in jobs(&batch, builder).chunks(BATCH) {
            let edge = builder.edge();
            let painted: Vec<_> = jobs.par_iter().map(|job| job.cells(edge)).collect();
            builder.extend(painted.into_par_iter().flatten());
            if builder.len() > MAX_CELLS {
                return Err(PaintError);
            }
        }
    }
    Ok(())
}

/// Solids, and blocks of cells, that are painted at once.
const BATCH: usize = 256;
/// Blocks along an edge.
const BLOCKS: u32 = 8;

/// A solid in a block.
struct Job<'a> {
    solid: &'a Solid,
    shift: DVec3,
    corner: [u32; 3],
    side: u32,
}

impl Job<'_> {
    fn cells(&self, edge: u32) -> Vec<([u32; 3], Texel)> {
        let mut brush = Brush { solid: self.solid, shift: self.shift, edge, cells: Vec::new() };
        let least = 0.125 * brush.cell_width();
        let bodies: Vec<Body> = self.solid.pieces.iter().map(|piece| Body::new(piece, least)).collect();
        let all: Vec<&Body> = bodies.iter().collect();
        brush.descend(self.corner, self.side, &all);
        brush.cells
    }
}

/// Every block that a solid may touch.
fn jobs<'a>(solids: &'a [Solid], builder: &Builder) -> Vec<Job<'a>> {
    let blocks = builder.edge().min(BLOCKS);
    let side = builder.edge() / blocks;
    let mut jobs = Vec::new();
    for solid in solids {
        for shift in shifts(solid, builder.is_cyclic()) {
            for block in touched(solid, shift, blocks) {
                jobs.push(Job { solid, shift, corner: block.map(|b| b * side), side });
            }
        }
    }
    jobs
}

/// A number of cells that a solid certainly fills: those of the blocks that lie inside one of its bodies.
fn least_cells(solid: &Solid, builder: &Builder) -> u64 {
    let parts = builder.edge().min(BLOCKS);
    let half = 0.5 / f64::from(parts);
    let is_full = |shift: DVec3, block: [u32; 3]| {
        let centre = DVec3::from_array(block.map(f64::from)) / f64::from(parts) + half - shift;
        solid.pieces.iter().any(|piece| piece.nearest(centre).distance <= -half * 3f64.sqrt())
    };
    let count = |shift: DVec3| {
        touched(solid, shift, parts).into_iter().filter(|block| is_full(shift, *block)).count()
    };
    let blocks: usize = shifts(solid, builder.is_cyclic()).into_iter().map(count).sum();
    blocks as u64 * u64::from(builder.edge() / parts).pow(3)
}

/// The copies of a solid that reach into the volume.
fn shifts(solid: &Solid, cyclic: [bool; 3]) -> Vec<DVec3> {
    let [low, high] = solid.bounds();
    let along = |axis: usize| -> Vec<f64> {
        let reaches = |shift: &f64| low[axis] + shift < 1.0 && high[axis] + shift > 0.0;
        let all: &[f64] = if cyclic[axis] { &[0.0, -1.0, 1.0] } else { &[0.0] };
        all.iter().copied().filter(reaches).collect()
    };
    let (xs, ys, zs) = (along(0), along(1), along(2));
    let planes = xs.iter().flat_map(|x| ys.iter().map(move |y| (*x, *y)));
    planes.flat_map(|(x, y)| zs.iter().map(move |z| DVec3::new(x, y, *z))).collect()
}

/// The blocks that the box of a solid touches.
fn touched(solid: &Solid, shift: DVec3, blocks: u32) -> Vec<[u32; 3]> {
    let [low, high] = solid.bounds();
    let index = |x: f64| (x * f64::from(blocks)).floor().clamp(0.0, f64::from(blocks - 1)) as u32;
    let [xs, ys, zs] = [0, 1, 2].map(|k| index(low[k] + shift[k])..=index(high[k] + shift[k]));
    let rows = zs.flat_map(|z| ys.clone().map(move |y| (y, z)));
    rows.flat_map(|(y, z)| xs.clone().map(move |x| [x, y, z])).collect()
}

/// Rays along each axis of a cell: these squared.
const RAYS: u32 = 4;

/// A solid on its way into cells.
struct Brush<'a> {
    solid: &'a Solid,
    shift: DVec3,
    edge: u32,
    cells: Vec<([u32; 3], Texel)>,
}

impl Brush<'_> {
    fn cell_width(&self) -> f64 {
        1.0 / f64::from(self.edge)
    }

    /// Divides a cube of cells as long as a body may touch it.
    fn descend(&mut self, corner: [u32; 3], side: u32, bodies: &[&Body]) {
        let half = 0.5 * f64::from(side) * self.cell_width();
        let low = DVec3::from_array(corner.map(f64::from)) * self.cell_width() - self.shift;
        let centre = low + half;
        let slack = 0.2 * self.cell_width();
        let near: Vec<&Body> =
            bodies.iter().copied().filter(|body| !body.piece.misses(centre, half, slack)).collect();
        if near.is_empty() {
            return;
        }
        if side == 1 {
            let texel = if self.solid.material.density.is_some() {
                self.cloudy(corner, centre, &near)
            } else {
                self.opaque(corner, low, &near)
            };
            self.cells.extend(texel.map(|texel| (corner, texel)));
            return;
        }
        let step = side / 2;
        for octant in 0..8u32 {
            let part = std::array::from_fn(|axis| corner[axis] + step * (octant >> axis & 1));
            self.descend(part, step, &near);
        }
    }

    /// What opaque bodies leave of the light through a cell.
    fn opaque(&self, cell: [u32; 3], low: DVec3, bodies: &[&Body]) -> Option<Texel> {
        let width = self.cell_width();
        let centre = low + 0.5 * width;
        let (nearest, axis) = nearest(centre, bodies);
        let stray = self.stray(cell);
        if nearest.distance <= -0.5 * 3f64.sqrt() * width {
            let flakes = self.flakes(stray, centre, nearest.normal, axis);
            return Some(self.filled([1.0; 3], Sggx::from_matrix(flakes).normalised(), 0.0));
        }
        let mut hits = Hits { stray, stopped: [0.0; 3], flakes: DMat3::ZERO, area: 0.0 };
        for axis in 0..3 {
            let w = DVec3::AXES[axis];
            for ray in 0..RAYS * RAYS {
                let start = low + width * self.ray_start(cell, axis, ray);
                let ray = Stretch { start, w, length: width };
                hits.stopped[axis] += self.follow(bodies, ray, &mut hits);
            }
        }
        let rays = f64::from(RAYS * RAYS);
        let covered = hits.stopped.map(|stopped| stopped / rays);
        if covered.iter().all(|share| *share <= 0.0) {
            return None;
        }
        let flakes = if hits.flakes == DMat3::ZERO {
            Sggx::from_matrix(self.flakes(stray, centre, nearest.normal, axis)).normalised()
        } else {
            Sggx::from_matrix(hits.flakes).normalised()
        };
        Some(self.filled(covered, flakes, 0.25 * hits.area / rays))
    }

    /// A cell whose faces are covered by these shares, with surfaces of a mean projected area in units of its face.
    fn filled(&self, covered: [f64; 3], flakes: Sggx, area: f64) -> Texel {
        let depth = covered.map(|share| (-(-share).ln_1p() as f32).min(MAX_DEPTH));
        let density = (area / self.cell_width()) as f32;
        self.coloured(Texel { density, depth, flakes, ..Texel::default() })
    }

    /// The share of a ray that is stopped; adds the surfaces that it meets.
    fn follow(&self, bodies: &[&Body], ray: Stretch, hits: &mut Hits) -> f64 {
        let (met, index) = meets(bodies, ray);
        let (piece, share) = &bodies[index].sampled;
        match met {
            Meets::Nothing => return 0.0,
            Meets::Inside => {}
            Meets::Surface { normal, crossings } => {
                let weight = share / normal.abs().element_sum();
                hits.flakes += self.flakes(hits.stray, ray.start, normal, piece.axis()) * weight;
                hits.area += crossings * weight;
            }
        }
        *share
    }

    /// Where a ray enters a cell, 0 to 1 along each axis.
    fn ray_start(&self, cell: [u32; 3], axis: usize, ray: u32) -> DVec3 {
        let chance = hash(self.solid.seed, &[6 + axis as u64, morton::encode(cell), u64::from(ray)]);
        let place = |index: u32, bits: u64| {
            (f64::from(index) + (bits & 0xffff_ffff) as f64 / 2f64.powi(32)) / f64::from(RAYS)
        };
        let (u, v) = (place(ray % RAYS, chance), place(ray / RAYS, chance >> 32));
        match axis {
            0 => DVec3::new(0.0, u, v),
            1 => DVec3::new(u, 0.0, v),
            _ => DVec3::new(u, v, 0.0),
        }
    }

    /// A cell that a cloud fills, by as much of it as is inside.
    fn cloudy(&self, cell: [u32; 3], centre: DVec3, bodies: &[&Body]) -> Option<Texel> {
        let width = self.cell_width();
        let is_inside = |i: u32| {
            let place = [i % RAYS, i / RAYS % RAYS, i / (RAYS * RAYS)];
            let p = centre
                + width * DVec3::from_array(place.map(|k| (f64::from(k) + 0.5) / f64::from(RAYS) - 0.5));
            bodies.iter().any(|body| body.piece.nearest(p).distance <= 0.0)
        };
        let inside = (0..RAYS.pow(3)).filter(|i| is_inside(*i)).count();
        if inside == 0 {
            return None;
        }
        let share = inside as f64 / f64::from(RAYS.pow(3));
        let (Nearest { normal, .. }, axis) = nearest(centre, bodies);
        let flakes = Sggx::from_matrix(self.flakes(self.stray(cell), centre, normal, axis));
        let density = self.solid.material.density.unwrap_or(0.0) * share;
        Some(self.coloured(Texel::even(density as f32, flakes, width)))
    }

    fn coloured(&self, texel: Texel) -> Texel {
        texel.coloured(self.solid.material.albedo, self.solid.material.gloss)
    }

    /// By how much normals stray in a cell.
    fn stray(&self, cell: [u32; 3]) -> DVec3 {
        let variation = self.solid.material.variation;
        if variation == 0.0 {
            return DVec3::ZERO;
        }
        let [x, y, z] = cell.map(u64::from);
        let part = |k: u64| normal(self.solid.seed, &[9, x, y, z, k]);
        variation * DVec3::new(part(0), part(1), part(2))
    }

    /// S at a place with this normal, on a body with this axis; the mean projected area is the same at all places.
    fn flakes(&self, stray: DVec3, p: DVec3, normal: DVec3, axis: DVec3) -> DMat3 {
        let Material { roughness, flakes, .. } = self.solid.material;
        let strayed = |direction: DVec3| {
            if stray == DVec3::ZERO { direction } else { (direction + stray).normalize_or(direction) }
        };
        let up = self.solid.frame.axes.z_axis.normalize_or(DVec3::Z);
        let from_axis = p - self.solid.frame.origin;
        let out = (from_axis - from_axis.dot(up) * up).normalize_or(normal);
        match flakes {
            Flakes::Surface => Sggx::surface_form(strayed(normal), roughness),
            Flakes::Along => Sggx::fibre_form(strayed(axis), roughness),
            Flakes::Fibre(direction) => Sggx::fibre_form(strayed(direction), roughness),
            Flakes::Radial => Sggx::fibre_form(strayed(out), roughness),
            Flakes::Ellipsoid(radii) => Sggx::ellipsoid(DMat3::from_diagonal(radii)).matrix(),
            Flakes::Concentric(radius) => {
                let distance = from_axis.reject_from_normalized(up).length();
                let share = match radius {
                    r if r > 0.0 => 1.0 - distance / r,
                    r if r < 0.0 => distance / -r,
                    _ => 0.0,
                };
                let smooth = roughness + (1.0 - roughness) * share.clamp(0.0, 1.0);
                Sggx::fibre(strayed(up.cross(out)), smooth).matrix()
            }
        }
    }
}

/// The nearest surface of a place, and the axis of its body.
fn nearest(p: DVec3, bodies: &[&Body]) -> (Nearest, DVec3) {
    let found = bodies.iter().map(|body| (body.piece.nearest(p), &body.piece));
    let nearest = found.min_by(|a, b| a.0.distance.total_cmp(&b.0.distance));
    match nearest {
        Some((nearest, piece)) => (nearest, piece.axis()),
        None => (Nearest { distance: f64::INFINITY, normal: DVec3::Z }, DVec3::Z),
    }
}

/// What the rays of a cell met.
struct Hits {
    /// By how much normals stray in the cell.
    stray: DVec3,
    stopped: [f64; 3],
    flakes: DMat3,
    /// The area of surfaces, in units of the cell's face, times the rays along an axis.
    area: f64,
}
