//! What the text of a recipe may hold. The JSON Schema is made from it, and the words in it from these documents.

pub(super) mod sources;

use super::values::{
    Colour, Count, Degrees, Direction, Edge, Exponent, Extinction, Fold, Length, Place, Seed, Share, Size,
    Spread,
};
use fieldstone_texel::{Mode, Phong};
use schemars::JsonSchema;
use serde::Deserialize;
use sources::{FieldText, MeshText, NoiseText, PointsText, ScanText};
use toml::Spanned;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RecipeText {
    /// Cells along an edge: a power of two up to 1024.
    pub(super) edge: Edge,
    /// Axes along which the volume goes on with its other side.
    #[serde(default)]
    pub(super) cyclic: Vec<Axis>,
    /// How coarser levels are made; default: sggx.
    pub(super) filter: Option<FilterName>,
    /// The reflection of the rules of 1995, for the whole volume.
    pub(super) phong: Option<PhongText>,
    /// Shapes, each at its place.
    #[serde(default)]
    #[schemars(with = "Vec<ShapeText>")]
    pub(super) shapes: Vec<Spanned<ShapeText>>,
    /// Shapes of which many are spread by chance.
    #[serde(default)]
    #[schemars(with = "Vec<ScatterText>")]
    pub(super) scatters: Vec<Spanned<ScatterText>>,
    /// Solids of formulas and models.
    #[serde(default, alias = "field")]
    #[schemars(with = "Vec<FieldText>")]
    pub(super) fields: Vec<Spanned<FieldText>>,
    /// Meshes of triangles.
    #[serde(default, alias = "mesh")]
    #[schemars(with = "Vec<MeshText>")]
    pub(super) meshes: Vec<Spanned<MeshText>>,
    /// Hair, grass, threads.
    #[serde(default)]
    #[schemars(with = "Vec<PointsText>")]
    pub(super) strands: Vec<Spanned<PointsText>>,
    /// Balls.
    #[serde(default)]
    #[schemars(with = "Vec<PointsText>")]
    pub(super) particles: Vec<Spanned<PointsText>>,
    /// Numbers on a grid, as tomographs make them.
    #[serde(default, alias = "scan")]
    #[schemars(with = "Vec<ScanText>")]
    pub(super) scans: Vec<Spanned<ScanText>>,
    /// Clouds of noise.
    #[serde(default)]
    #[schemars(with = "Vec<NoiseText>")]
    pub(super) noise: Vec<Spanned<NoiseText>>,
}

impl RecipeText {
    /// Whether nothing is in the volume.
    pub(super) fn is_empty(&self) -> bool {
        let is_painted = !(self.shapes.is_empty() && self.scatters.is_empty());
        let has_points = !(self.meshes.is_empty() && self.strands.is_empty() && self.particles.is_empty());
        let has_values = !(self.fields.is_empty() && self.scans.is_empty() && self.noise.is_empty());
        !(is_painted || has_points || has_values)
    }
}

#[derive(Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
pub(super) enum FilterName {
    #[serde(rename = "sggx")]
    Sggx,
    #[serde(rename = "1995")]
    Old,
}

impl FilterName {
    pub(super) fn mode(self) -> Mode {
        match self {
            Self::Sggx => Mode::Sggx,
            Self::Old => Mode::Neyret1995,
        }
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PhongText {
    /// Share of diffuse light.
    pub(super) diffuse: Share,
    /// Share of specular light.
    pub(super) specular: Share,
    /// Exponent of the highlight.
    pub(super) exponent: Exponent,
}

impl PhongText {
    pub(super) fn phong(self) -> Phong {
        let [diffuse, specular, exponent] =
            [self.diffuse.0, self.specular.0, self.exponent.0].map(|x| x as f32);
        Phong { diffuse, specular, exponent }
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeText {
    /// An ellipsoid around its place.
    pub(super) ellipsoid: Option<EllipsoidText>,
    /// A cylinder on its place.
    pub(super) cylinder: Option<CylinderText>,
    /// A cone on its place.
    pub(super) cone: Option<ConeText>,
    /// A disc around its place, across its axis.
    pub(super) disc: Option<DiscText>,
    /// A box around its place.
    #[serde(rename = "box")]
    pub(super) cuboid: Option<BoxText>,
    /// A pointed strip, folded along its middle like a V.
    pub(super) blade: Option<BladeText>,
    /// A rod that bends.
    pub(super) hair: Option<HairText>,
    /// A rod along a curve through points.
    pub(super) tube: Option<TubeText>,
    /// Its place; default: 0, 0, 0.
    pub(super) at: Option<[Place; 3]>,
    /// The direction of its z; default: 0, 0, 1.
    pub(super) axis: Option<Direction>,
    /// A direction near its x: blades and hairs bend that way; default: 1, 0, 0.
    pub(super) toward: Option<Direction>,
    /// Its scale; default: 1.
    pub(super) size: Option<Length>,
    /// What it scatters; default: 0.8, linear.
    #[serde(alias = "color")]
    pub(super) colour: Option<Colour>,
    /// The share of scattered light that it mirrors; default: 0.
    pub(super) gloss: Option<Share>,
    /// How far flakes stray from the surface; default: 0.1.
    pub(super) roughness: Option<Share>,
    /// How far normals stray from cell to cell, by chance; default: 0.
    pub(super) variation: Option<Spread>,
    /// Makes it a cloud: extinction per edge; default: opaque.
    pub(super) density: Option<Extinction>,
    /// Which way its flakes face; default: surface.
    pub(super) flakes: Option<FlakesText>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct EllipsoidText {
    pub(super) radii: [Length; 3],
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CylinderText {
    pub(super) radius: Length,
    pub(super) height: Length,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ConeText {
    pub(super) radius: Length,
    pub(super) top: Option<Size>,
    pub(super) height: Length,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DiscText {
    pub(super) radius: Length,
    pub(super) thickness: Length,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxText {
    pub(super) size: [Length; 3],
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BladeText {
    pub(super) height: Length,
    pub(super) width: Length,
    pub(super) fold: Option<Fold>,
    pub(super) thickness: Option<Length>,
    pub(super) curl: Option<Degrees>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct HairText {
    pub(super) height: Length,
    pub(super) radius: Length,
    pub(super) tip: Option<Size>,
    pub(super) curl: Option<Degrees>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TubeText {
    #[schemars(with = "Vec<[Place; 3]>")]
    pub(super) points: Spanned<Vec<[Place; 3]>>,
    pub(super) radius: Length,
    pub(super) tip: Option<Size>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum FlakesText {
    Surface,
    Along,
    Radial,
    Concentric,
    Smoothed(Place),
    Fibre(Direction),
    Ellipsoid([Length; 3]),
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ScatterText {
    /// What is copied; its place is left out.
    #[schemars(with = "ShapeText")]
    pub(super) shape: Spanned<ShapeText>,
    /// How many; default: all parts of the grid.
    pub(super) count: Option<Count>,
    /// How often the region is divided along each axis.
    pub(super) grid: Option<[Count; 3]>,
    /// What chance starts from; default: 0.
    pub(super) seed: Option<Seed>,
    /// x0, y0, z0, x1, y1, z1: where they stand; default: 0, 0, 0, 1, 1, 0.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(super) region: Option<Spanned<[Place; 6]>>,
    /// Whether they stand in the ellipsoid inside the region alone; default: false.
    #[serde(default)]
    pub(super) round: bool,
    /// 0: on a grid; 1: anywhere in the part that a copy has for its own; default: 1.
    pub(super) jitter: Option<Share>,
    /// Added to the direction up in which they grow; default: 0, 0, 0.
    pub(super) comb: Option<[Place; 3]>,
    /// How much of the way from the middle of the region is added to that direction; default: 0.
    pub(super) outward: Option<Place>,
    /// By which share of a turn, at most, they are turned by chance; default: 1.
    pub(super) spin: Option<Share>,
    /// How far directions stray, degrees; default: 0.
    pub(super) lean: Option<Degrees>,
    pub(super) curl: Option<Degrees>,
    /// The smallest and the greatest scale; default: 1, 1.
    #[schemars(with = "Option<[Length; 2]>")]
    pub(super) size: Option<Spanned<[Length; 2]>>,
    /// How much lighter or darker copies are; default: 0.
    pub(super) tint: Option<Share>,
}

impl ScatterText {
    /// How many copies there are; 0 if nothing says so.
    pub(super) fn copies(&self) -> u64 {
        let parts = self.grid.map(|grid| grid.iter().map(|n| u64::from(n.0)).product::<u64>());
        match (self.count, parts) {
            (Some(count), Some(parts)) => parts.min(u64::from(count.0)),
            (Some(count), None) => u64::from(count.0),
            (None, parts) => parts.unwrap_or(0),
        }
    }
}
