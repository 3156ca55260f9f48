//! What recipes say of fields, meshes, strands, particles, scans and noise.

use crate::texel::values::{
    Bias, Colour, Coordinate, Count, Direction, Lacunarity, Number, Octaves, Place, Positive, Seed, Share,
    Skip, Thickness,
};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// A box in the coordinates of a source.
pub(in crate::texel) type BoundsText = Option<Spanned<[Coordinate; 6]>>;
/// A box of the volume.
pub(in crate::texel) type WithinText = Option<Spanned<[Place; 6]>>;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct FieldText {
    /// A formula, negative inside.
    #[schemars(with = "Option<String>")]
    pub(in crate::texel) expr: Option<Spanned<String>>,
    /// A model: .hf, .vm, .jsurf, or a text with a formula.
    #[schemars(with = "Option<String>")]
    pub(in crate::texel) file: Option<Spanned<String>>,
    /// The object of a HyperFun file; default: `my_model`, or the first.
    pub(in crate::texel) object: Option<String>,
    /// Values of parameters by name.
    #[serde(default)]
    pub(in crate::texel) parameters: BTreeMap<String, f64>,
    /// x0, y0, z0, x1, y1, z1: the part of space that is baked; default: the box around the solid, which is found.
    #[schemars(with = "Option<[Coordinate; 6]>")]
    pub(in crate::texel) bounds: BoundsText,
    /// x0, y0, z0, x1, y1, z1: the part of the volume that it is fitted into; default: all but a cell at either end.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(in crate::texel) within: WithinText,
    /// Which cells inside are filled; default: skin.
    pub(in crate::texel) inside: Option<InsideText>,
    /// Whether one looks into it where the bounds cut it; default: false.
    #[serde(default)]
    pub(in crate::texel) open: bool,
    /// Makes its border a medium that noise stirs.
    pub(in crate::texel) hypertexture: Option<HypertextureText>,
    /// What it scatters; default: what the attributes of the model say, or 0.8, linear.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// The share of scattered light that it mirrors; default: 0.
    pub(in crate::texel) gloss: Option<Share>,
    /// How far flakes stray from the surface; default: 0.1.
    pub(in crate::texel) roughness: Option<Share>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::texel) enum InsideText {
    Skin,
    Full,
    Empty,
}

#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct HypertextureText {
    /// Extinction where it is full, per edge of the volume; default: 50.
    pub(in crate::texel) density: Option<Thickness>,
    /// The width of the soft border, in values of the field; default: 0.5.
    pub(in crate::texel) softness: Option<Positive>,
    /// By how much the noise moves the field's values; default: 0.5.
    pub(in crate::texel) amplitude: Option<Thickness>,
    /// What the middle of the border becomes; default: 0.5.
    pub(in crate::texel) bias: Option<Bias>,
    /// Above 0.5 steepens the border; default: 0.5.
    pub(in crate::texel) gain: Option<Bias>,
    /// Over how many cells a change of the density counts as a surface; default: 2.
    pub(in crate::texel) surface: Option<Thickness>,
    /// Lattice points of the first octave in a unit of length; default: 4.
    pub(in crate::texel) frequency: Option<Positive>,
    /// How many octaves are added; default: 4.
    pub(in crate::texel) octaves: Option<Octaves>,
    /// By how much the frequency rises from one to the next; default: 2.
    pub(in crate::texel) lacunarity: Option<Lacunarity>,
    /// By how much the amplitude falls from one to the next; default: 0.5.
    pub(in crate::texel) persistence: Option<Share>,
    /// Whether absolute values are added; default: false.
    #[serde(default)]
    pub(in crate::texel) turbulence: bool,
    /// What chance starts from; default: 0.
    pub(in crate::texel) seed: Option<Seed>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct NoiseText {
    /// x0, y0, z0, x1, y1, z1: the part of space with the noise; default: 0, 0, 0, 1, 1, 1.
    #[schemars(with = "Option<[Coordinate; 6]>")]
    pub(in crate::texel) bounds: BoundsText,
    /// x0, y0, z0, x1, y1, z1: the part of the volume that it is fitted into; default: all but a cell at either end.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(in crate::texel) within: WithinText,
    /// The noise, and how it becomes a density.
    #[serde(default)]
    pub(in crate::texel) hypertexture: HypertextureText,
    /// What it scatters; default: 0.8, linear.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// The share of scattered light that it mirrors; default: 0.
    pub(in crate::texel) gloss: Option<Share>,
    /// How far flakes stray from its surfaces; default: 0.3.
    pub(in crate::texel) roughness: Option<Share>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct MeshText {
    /// Triangles: .obj, .ply, .gltf or .glb.
    #[schemars(with = "String")]
    pub(in crate::texel) file: Spanned<String>,
    /// The direction of its z; default: 0, 0, 1.
    pub(in crate::texel) axis: Option<Direction>,
    /// A direction near its x; default: 1, 0, 0.
    pub(in crate::texel) toward: Option<Direction>,
    /// x0, y0, z0, x1, y1, z1, after it is turned: what is fitted into the volume; default: the box around it.
    #[schemars(with = "Option<[Coordinate; 6]>")]
    pub(in crate::texel) bounds: BoundsText,
    /// x0, y0, z0, x1, y1, z1: the part of the volume that it is fitted into; default: all but a cell at either end.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(in crate::texel) within: WithinText,
    /// What the triangles bound; default: auto, a solid if the mesh is watertight.
    pub(in crate::texel) body: Option<BodyText>,
    /// Which cells inside of a solid are filled; default: skin.
    pub(in crate::texel) inside: Option<InsideText>,
    /// What triangles without a material scatter; default: 0.8, linear.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// The share of scattered light that they mirror; default: 0.
    pub(in crate::texel) gloss: Option<Share>,
    /// How far flakes stray from the triangles; default: 0.1.
    pub(in crate::texel) roughness: Option<Share>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::texel) enum BodyText {
    Auto,
    Solid,
    Sheets,
}

/// Strands and particles have the same keys.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct PointsText {
    /// Strands: .hair, or a text with lines `x y z` or `x y z radius`. Particles: .ply, or a table `x, y, z, radius, red, green, blue`.
    #[schemars(with = "String")]
    pub(in crate::texel) file: Spanned<String>,
    /// The direction of their z; default: 0, 0, 1.
    pub(in crate::texel) axis: Option<Direction>,
    /// A direction near their x; default: 1, 0, 0.
    pub(in crate::texel) toward: Option<Direction>,
    /// x0, y0, z0, x1, y1, z1, after they are turned: what is fitted into the volume; default: the box around them.
    #[schemars(with = "Option<[Coordinate; 6]>")]
    pub(in crate::texel) bounds: BoundsText,
    /// x0, y0, z0, x1, y1, z1: the part of the volume that they are fitted into; default: all but a cell at either end.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(in crate::texel) within: WithinText,
    /// The radius of those without one, in their units; default: 0.001 for strands, 0.01 for particles.
    pub(in crate::texel) radius: Option<Positive>,
    /// What those without a colour scatter; default: brown strands, light grey particles.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// The share of scattered light that they mirror; default: 0.5 for strands, 0 for particles.
    pub(in crate::texel) gloss: Option<Share>,
    /// How far flakes stray; default: 0.1.
    pub(in crate::texel) roughness: Option<Share>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct ScanText {
    /// Numbers on a grid: .nrrd, .nhdr, .nii, .nii.gz, or raw numbers.
    #[schemars(with = "String")]
    pub(in crate::texel) file: Spanned<String>,
    /// Raw numbers: how many there are along x, y and z.
    pub(in crate::texel) size: Option<[Count; 3]>,
    /// Raw numbers: how each is written.
    #[serde(rename = "type")]
    pub(in crate::texel) number: Option<NumberText>,
    /// Raw numbers: the order of the bytes; default: little.
    pub(in crate::texel) endian: Option<EndianText>,
    /// Raw numbers: bytes before the first number; default: 0.
    pub(in crate::texel) skip: Option<Skip>,
    /// The number from which on there is something.
    #[schemars(with = "Option<Number>")]
    pub(in crate::texel) threshold: Option<Spanned<Number>>,
    /// Threshold: extinction above it, per edge of the volume; default: 100.
    pub(in crate::texel) density: Option<Thickness>,
    /// Threshold: what is above it scatters; default: 0.8, linear.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// Threshold: the share of scattered light that is mirrored; default: 0.
    pub(in crate::texel) gloss: Option<Share>,
    /// What numbers look like, by rising numbers, linear in between.
    #[serde(default)]
    #[schemars(with = "Vec<KnotText>")]
    pub(in crate::texel) transfer: Vec<Spanned<KnotText>>,
    /// Over how many cells a change of the density counts as a surface; default: 4.
    pub(in crate::texel) surface: Option<Thickness>,
    /// How far flakes stray from such surfaces; default: 0.2.
    pub(in crate::texel) roughness: Option<Share>,
    /// x0, y0, z0, x1, y1, z1: what is fitted into the volume; the first number is at 0, 0, 0; default: the whole scan.
    #[schemars(with = "Option<[Coordinate; 6]>")]
    pub(in crate::texel) bounds: BoundsText,
    /// x0, y0, z0, x1, y1, z1: the part of the volume that it is fitted into; default: all but a cell at either end.
    #[schemars(with = "Option<[Place; 6]>")]
    pub(in crate::texel) within: WithinText,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::texel) struct KnotText {
    /// A number of the scan.
    pub(in crate::texel) value: Number,
    /// Its extinction, per edge of the volume.
    pub(in crate::texel) density: Thickness,
    /// What it scatters; default: 0.8, linear.
    #[serde(alias = "color")]
    pub(in crate::texel) colour: Option<Colour>,
    /// The share of scattered light that it mirrors; default: 0.
    pub(in crate::texel) gloss: Option<Share>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::texel) enum NumberText {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    F32,
    F64,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::texel) enum EndianText {
    Little,
    Big,
}
