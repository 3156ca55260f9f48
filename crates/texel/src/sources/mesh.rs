//! Meshes in cells.
//!
//! Each triangle is cut at the sides of the cells that it goes through, so that areas are exact; normals and colours are
//! means by area. What a cell's triangles hide of its faces is the sum of their projections, which is exact where none
//! is behind another; by how much they overlap is counted on 16 × 16 places.
//!
//! A mesh without holes is a solid: what is [inside](solid) stops light like the inside of a field, so that none comes through where
//! its surface covers cells in part.

mod clip;
mod read;
mod solid;

pub use read::read_mesh;

use super::cell::{Finish, Gathered};
use super::{Inside, MAX_CELLS, Paint, Place, SourceError, hull, placed};
use crate::{Builder, MAX_DEPTH, Texel};
use clip::{Polygon, Shadow};
use glam::DVec3;
use rayon::prelude::*;
use serde::Deserialize;
use solid::{Interior, Joints};
use std::collections::HashSet;

/// Triangles with colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub points: Vec<[f64; 3]>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
    /// The albedo at each point, linear, 0 to 1; or nothing.
    pub colours: Vec<[f32; 3]>,
    /// What triangles are painted with; colours of points are multiplied with it.
    pub materials: Vec<Paint>,
    /// The material of each triangle; or nothing.
    pub material: Vec<u32>,
}

/// What triangles bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Body {
    /// A solid if the mesh is watertight: if at every side of a triangle an even number of them meets. Sheets otherwise.
    #[default]
    Auto,
    /// A solid, also if there are holes: three lines of sight decide by majority what is inside.
    Solid,
    /// Thin sheets, seen from both sides, with nothing inside.
    Sheets,
}

/// How a mesh becomes cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MeshOptions {
    /// How far the flakes spread around the triangles' normals, 0 to 1.
    pub roughness: f64,
    /// Whether the triangles bound a solid, which is seen from outside alone, or are sheets, which are seen from both sides and
    /// count twice as much.
    pub body: Body,
    /// Which cells inside of a solid are filled. `Empty` makes a shell: a little light passes where the surface covers cells in
    /// part.
    pub inside: Inside,
    /// What triangles without a material are painted with.
    pub paint: Paint,
    /// The box that fills the volume, two corners; by default the one around the mesh.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The part of the volume that this box is fitted into, two corners; by default all but one cell at either end.
    pub within: Option<[[f64; 3]; 2]>,
}

/// Adds a mesh. Triangles that refer to points that are not there are left out.
///
/// # Errors
/// Options out of their ranges, points that are no numbers, and more than memory should be spent on.
pub fn add_mesh(builder: &mut Builder, mesh: &Mesh, options: &MeshOptions) -> Result<Place, SourceError> {
    let good = (0.0..=1.0).contains(&options.roughness);
    SourceError::check("roughness", options.roughness, good, "a number from 0 to 1")?;
    let points = mesh.points.iter().map(|point| (*point, 0.0));
    let place = placed(builder, [options.bounds, options.within], || hull(points))?;
    let joints = if options.body == Body::Sheets { None } else { Some(Joints::of(mesh)) };
    let solid = joints.filter(|joints| joints.is_closed || options.body == Body::Solid);
    let mut voxels = Voxels {
        mesh,
        place,
        edge: builder.edge(),
        finish: Finish::surface(options.roughness),
        // Means over all directions: half of a sheet's area, a quarter of a closed surface's.
        share: if solid.is_some() { 0.25 } else { 0.5 },
        paint: options.paint,
        interior: None,
    };
    if let (Some(joints), true) = (solid, options.inside != Inside::Empty) {
        let triangles: Vec<_> = (0..mesh.triangles.len()).filter_map(|i| voxels.corners(i)).collect();
        voxels.interior = Some(Interior::new(&triangles, builder.edge(), joints.is_oriented)?);
    }
    let surface = voxels.texels()?;
    let inner = voxels.inner(&surface, options.inside)?;
    builder.extend(surface);
    builder.extend(inner);
    Ok(place)
}

/// What is smaller, in units of a cell's face, comes from rounding where a triangle ends at the side of a cell.
const SLIVER: f64 = 1e-9;

/// A mesh on its way to cells.
struct Voxels<'m> {
    mesh: &'m Mesh,
    place: Place,
    edge: u32,
    finish: Finish,
    share: f64,
    paint: Paint,
    /// What is inside, if it is filled.
    interior: Option<Interior>,
}

impl Voxels<'_> {
    fn texels(&self) -> Result<Vec<([u32; 3], Texel)>, SourceError> {
        let numbers = 0..self.mesh.triangles.len();
        let count: usize = numbers.clone().into_par_iter().map(|number| self.cells(number).count()).sum();
        if count > MAX_CELLS {
            return Err(SourceError::TooMany { what: "the cells that triangles touch", most: MAX_CELLS });
        }
        let mut entries: Vec<([u32; 3], u32)> = numbers
            .into_par_iter()
            .flat_map_iter(|number| self.cells(number).map(move |cell| (cell, number as u32)))
            .collect();
        entries.par_sort_unstable();
        let cells = entries.par_chunk_by(|a, b| a.0 == b.0);
        Ok(cells.filter_map(|entries| self.texel(entries).map(|texel| (entries[0].0, texel))).collect())
    }

    /// The cells inside: one layer below those of the surface, or all. Each is painted like the one it was reached
    /// from, and has its flakes.
    fn inner(
        &self,
        surface: &[([u32; 3], Texel)],
        inside: Inside,
    ) -> Result<Vec<([u32; 3], Texel)>, SourceError> {
        let Some(interior) = &self.interior else { return Ok(Vec::new()) };
        let mut known: HashSet<[u32; 3]> = surface.iter().map(|(cell, _)| *cell).collect();
        let mut found: Vec<([u32; 3], Texel)> = Vec::new();
        let mut from = 0;
        loop {
            let reached = if from == 0 && found.is_empty() { surface } else { &found[from..] };
            let mut next = Vec::new();
            for (cell, texel) in reached {
                for beside in beside(*cell, self.edge) {
                    if !known.contains(&beside) && interior.holds(beside) {
                        known.insert(beside);
                        next.push((beside, Texel { density: 0.0, depth: [MAX_DEPTH; 3], ..*texel }));
                    }
                }
            }
            if known.len() > MAX_CELLS {
                return Err(SourceError::TooMany { what: "a solid's cells", most: MAX_CELLS });
            }
            from = found.len();
            let is_last = next.is_empty() || inside != Inside::Full;
            found.extend(next);
            if is_last {
                return Ok(found);
            }
        }
    }

    /// The corners of a triangle, counted in cells.
    fn corners(&self, number: usize) -> Option<[DVec3; 3]> {
        let mut corners = [DVec3::ZERO; 3];
        for (corner, point) in corners.iter_mut().zip(self.mesh.triangles[number]) {
            let point = DVec3::from_array(*self.mesh.points.get(point as usize)?);
            *corner = self.place.cube_from_model(point) * f64::from(self.edge);
        }
        Some(corners)
    }

    /// The cells that the plane of a triangle goes through in the box around it.
    fn cells(&self, number: usize) -> impl Iterator<Item = [u32; 3]> {
        self.corners(number)
            .and_then(|corners| Walk::new(&corners, self.edge))
            .into_iter()
            .flat_map(Walk::cells)
    }

    /// What the triangles with these numbers make of their cell.
    fn texel(&self, entries: &[([u32; 3], u32)]) -> Option<Texel> {
        let width = f64::from(self.edge).recip();
        let low = DVec3::from_array(entries[0].0.map(f64::from));
        let (mut gathered, mut shadow) = (Gathered::default(), Shadow::default());
        for (_, number) in entries {
            let number = *number as usize;
            let Some(corners) = self.corners(number) else { continue };
            let polygon = Polygon::new(corners.map(|corner| corner - low)).clipped();
            let area = polygon.area();
            let size = area.length();
            if size > SLIVER {
                let paint = self.paint_at(number, &corners, polygon.middle() + low);
                let amount = self.share * size * width * width;
                gathered.add(amount, &self.finish.around(area / size), &paint);
                shadow.add(&polygon);
            }
        }
        let filled = self.interior.as_ref().map_or([0.0; 3], |interior| interior.filled(entries[0].0));
        let covered = shadow.cover();
        gathered.cover([0, 1, 2].map(|axis| (covered[axis] + filled[axis]).min(1.0)));
        (gathered.amount > 0.0).then(|| gathered.texel(width))
    }

    /// The paint of a triangle at a point.
    fn paint_at(&self, number: usize, corners: &[DVec3; 3], point: DVec3) -> Paint {
        let material = self.mesh.material.get(number).and_then(|i| self.mesh.materials.get(*i as usize));
        let mut paint = *material.unwrap_or(&self.paint);
        let colours = self.mesh.triangles[number].map(|i| self.mesh.colours.get(i as usize));
        if let [Some(a), Some(b), Some(c)] = colours {
            let shares = barycentric(corners, point);
            let base = if material.is_some() { paint.albedo } else { [1.0; 3] };
            paint.albedo = [0, 1, 2].map(|k| {
                let mean =
                    [a, b, c].into_iter().zip(shares).map(|(colour, share)| f64::from(colour[k]) * share);
                base[k] * mean.sum::<f64>().clamp(0.0, 1.0) as f32
            });
        }
        paint
    }
}

/// The cells that share a face with a cell.
fn beside(cell: [u32; 3], edge: u32) -> impl Iterator<Item = [u32; 3]> {
    let step = move |axis: usize, forward: bool| {
        let mut beside = cell;
        beside[axis] = if forward { cell[axis] + 1 } else { cell[axis].checked_sub(1)? };
        (beside[axis] < edge).then_some(beside)
    };
    (0..6).filter_map(move |k| step(k / 2, k % 2 == 1))
}

/// The shares of three corners in a point of their plane.
fn barycentric(corners: &[DVec3; 3], point: DVec3) -> [f64; 3] {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared().max(f64::MIN_POSITIVE);
    let share = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(normal) / whole;
    let (first, second) = (share(b, c), share(c, a));
    [first, second, 1.0 - first - second]
}

/// The cells of a triangle: columns along the axis that its normal is nearest to.
struct Walk {
    axis: usize,
    low: DVec3,
    high: DVec3,
    /// A point of the plane, and how it rises along the other two axes.
    start: DVec3,
    slopes: [f64; 2],
    edge: u32,
}

impl Walk {
    /// Nothing if the triangle has no area or is outside.
    fn new(corners: &[DVec3; 3], edge: u32) -> Option<Self> {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a);
        let axis = (0..3).max_by(|i, j| normal[*i].abs().total_cmp(&normal[*j].abs())).unwrap_or(0);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let is_inside = high.min_element() >= 0.0 && low.max_element() <= f64::from(edge);
        let slopes = [1, 2].map(|k| -normal[(axis + k) % 3] / normal[axis]);
        (is_inside && slopes.iter().all(|slope| slope.is_finite())).then_some(Self {
            axis,
            low,
            high,
            start: a,
            slopes,
            edge,
        })
    }

    fn range(&self, low: f64, high: f64) -> std::ops::RangeInclusive<u32> {
        let last = f64::from(self.edge) - 1.0;
        low.floor().clamp(0.0, last) as u32..=high.floor().clamp(0.0, last) as u32
    }

    fn cells(self) -> impl Iterator<Item = [u32; 3]> {
        let [u, v, w] = [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis];
        let (columns, rows) = (self.range(self.low[u], self.high[u]), self.range(self.low[v], self.high[v]));
        let squares = rows.flat_map(move |j| columns.clone().map(move |i| (i, j)));
        squares.flat_map(move |(i, j)| {
            let [along_u, along_v] = self.slopes;
            let middle = self.start[w]
                + along_u * (f64::from(i) + 0.5 - self.start[u])
                + along_v * (f64::from(j) + 0.5 - self.start[v]);
            // A little more, for rounding.
            let reach = 0.5 * (along_u.abs() + along_v.abs()) + 1e-9;
            let (low, high) = ((middle - reach).max(self.low[w]), (middle + reach).min(self.high[w]));
            let layers = (low <= high + 1e-9).then(|| self.range(low, high.max(low)));
            layers.into_iter().flatten().map(move |k| {
                let mut cell = [0; 3];
                (cell[u], cell[v], cell[w]) = (i, j, k);
                cell
            })
        })
    }
}

#[cfg(test)]
mod tests;
