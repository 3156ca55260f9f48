//! Recipes: TOML texts that say what is painted into a volume. `docs/texels.md` describes them.

use super::TexelError;
use super::values::{
    Colour, Count, Degrees, Direction, Edge, Exponent, Extinction, Fold, Length, Place, Seed, Share, Size,
    Spread, vector,
};
use crate::load::{LoadError, read_text};
use fieldstone_lang::{Diagnostic, Diagnostics, Source};
use fieldstone_texel::paint::{Flakes, Form, Frame, Material, Scatter, Shape, paint};
use fieldstone_texel::{Builder, Mode, Phong, Volume};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use std::path::Path;
use toml::Spanned;

/// What is painted into a volume.
#[derive(Clone, Debug)]
pub struct Recipe {
    edge: u32,
    cyclic: [bool; 3],
    mode: Mode,
    phong: Phong,
    shapes: Vec<Shape>,
    scatters: Vec<Scatter>,
}

impl Recipe {
    /// Reads a recipe.
    ///
    /// # Errors
    /// The file cannot be read, or is no recipe.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        Ok(Self::parse(Source::new(path.display().to_string(), read_text(path)?))?)
    }

    /// Reads the text of a recipe.
    ///
    /// # Errors
    /// A text that is no recipe.
    pub fn parse(source: Source) -> Result<Self, Diagnostics> {
        read(&source.text).map_err(|error| Diagnostics { source, list: vec![error] })
    }

    /// Cells along the volume's edge.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// The same with another edge: a power of two up to 1024.
    ///
    /// # Errors
    /// Another edge.
    pub fn with_edge(mut self, edge: u32) -> Result<Self, String> {
        self.edge = Edge::try_from(f64::from(edge))?.0;
        Ok(self)
    }

    /// The same with another filter.
    pub fn with_mode(mut self, mode: Mode) -> Self {
        self.mode = mode;
        self
    }

    /// The volume. All that chance decides comes from the seeds.
    ///
    /// # Errors
    /// The shapes fill more cells than are allowed.
    pub fn build(&self) -> Result<Volume, TexelError> {
        let mut builder = Builder::new(self.edge)?.cyclic(self.cyclic).phong(self.phong);
        let single = self.shapes.iter().zip(0..).map(|(shape, seed)| shape.solid(seed));
        paint(&mut builder, single.chain(self.scatters.iter().flat_map(Scatter::solids)))?;
        Ok(builder.build(self.mode)?)
    }
}

fn read(text: &str) -> Result<Recipe, Diagnostic> {
    let read: RecipeText = toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or(text.len()..text.len());
        let message = error.message().lines().collect::<Vec<_>>().join(": ");
        Diagnostic::error(span, message, "here").with_help("docs/texels.md describes what may stand here")
    })?;
    if read.shapes.is_empty() && read.scatters.is_empty() {
        let error = Diagnostic::error(0..0, "nothing is painted", "no [[shapes]] and no [[scatters]]");
        return Err(error.with_help("begin with [[shapes]] and ball = { radii = [0.3, 0.3, 0.3] }"));
    }
    let copies: u64 = read.scatters.iter().map(|scatter| scatter.get_ref().copies()).sum();
    if let (true, Some(last)) = (copies > MAX_COPIES, read.scatters.last()) {
        let message = format!("{copies} copies are too many, at most {MAX_COPIES} are painted");
        return Err(Diagnostic::error(last.span(), message, "the last scatter"));
    }
    Ok(Recipe {
        edge: read.edge.0,
        cyclic: [Axis::X, Axis::Y, Axis::Z].map(|axis| read.cyclic.contains(&axis)),
        mode: read.filter.map_or(Mode::default(), FilterName::mode),
        phong: read.phong.map_or(Phong::default(), PhongText::phong),
        shapes: read.shapes.into_iter().map(shape).collect::<Result<_, _>>()?,
        scatters: read.scatters.into_iter().map(scatter).collect::<Result<_, _>>()?,
    })
}

/// The greatest number of copies in a recipe.
const MAX_COPIES: u64 = 100_000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RecipeText {
    edge: Edge,
    #[serde(default)]
    cyclic: Vec<Axis>,
    filter: Option<FilterName>,
    phong: Option<PhongText>,
    #[serde(default)]
    shapes: Vec<Spanned<ShapeText>>,
    #[serde(default)]
    scatters: Vec<Spanned<ScatterText>>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Axis {
    X,
    Y,
    Z,
}

#[derive(Clone, Copy, Deserialize)]
enum FilterName {
    #[serde(rename = "sggx")]
    Sggx,
    #[serde(rename = "1995")]
    Old,
}

impl FilterName {
    fn mode(self) -> Mode {
        match self {
            Self::Sggx => Mode::Sggx,
            Self::Old => Mode::Neyret1995,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PhongText {
    diffuse: Share,
    specular: Share,
    exponent: Exponent,
}

impl PhongText {
    fn phong(self) -> Phong {
        let [diffuse, specular, exponent] =
            [self.diffuse.0, self.specular.0, self.exponent.0].map(|x| x as f32);
        Phong { diffuse, specular, exponent }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeText {
    ellipsoid: Option<EllipsoidText>,
    cylinder: Option<CylinderText>,
    cone: Option<ConeText>,
    disc: Option<DiscText>,
    #[serde(rename = "box")]
    cuboid: Option<BoxText>,
    blade: Option<BladeText>,
    hair: Option<HairText>,
    tube: Option<TubeText>,
    at: Option<[Place; 3]>,
    axis: Option<Direction>,
    toward: Option<Direction>,
    size: Option<Length>,
    #[serde(alias = "color")]
    colour: Option<Colour>,
    gloss: Option<Share>,
    roughness: Option<Share>,
    variation: Option<Spread>,
    density: Option<Extinction>,
    flakes: Option<FlakesText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipsoidText {
    radii: [Length; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderText {
    radius: Length,
    height: Length,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConeText {
    radius: Length,
    top: Option<Size>,
    height: Length,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DiscText {
    radius: Length,
    thickness: Length,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxText {
    size: [Length; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BladeText {
    height: Length,
    width: Length,
    fold: Option<Fold>,
    thickness: Option<Length>,
    curl: Option<Degrees>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HairText {
    height: Length,
    radius: Length,
    tip: Option<Size>,
    curl: Option<Degrees>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TubeText {
    points: Spanned<Vec<[Place; 3]>>,
    radius: Length,
    tip: Option<Size>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum FlakesText {
    Surface,
    Along,
    Radial,
    Concentric,
    Smoothed(Place),
    Fibre(Direction),
    Ellipsoid([Length; 3]),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScatterText {
    shape: Spanned<ShapeText>,
    count: Option<Count>,
    grid: Option<[Count; 3]>,
    seed: Option<Seed>,
    region: Option<Spanned<[Place; 6]>>,
    #[serde(default)]
    round: bool,
    jitter: Option<Share>,
    comb: Option<[Place; 3]>,
    outward: Option<Place>,
    spin: Option<Share>,
    lean: Option<Degrees>,
    curl: Option<Degrees>,
    size: Option<Spanned<[Length; 2]>>,
    tint: Option<Share>,
}

const FORMS: &str = "ellipsoid, cylinder, cone, disc, box, blade, hair or tube";

fn shape(read: Spanned<ShapeText>) -> Result<Shape, Diagnostic> {
    let span = read.span();
    let text = read.into_inner();
    let frame = frame(&text);
    let material = material(&text);
    let mut forms = forms(text)?;
    match (forms.pop(), forms.is_empty()) {
        (Some(form), true) => Ok(Shape { form, frame, material }),
        (None, _) => {
            Err(Diagnostic::error(span, format!("a shape is one of {FORMS}"), "none of them is here"))
        }
        _ => Err(Diagnostic::error(span, format!("a shape is only one of {FORMS}"), "several are here")),
    }
}

/// All forms that a shape is said to have.
fn forms(text: ShapeText) -> Result<Vec<Form>, Diagnostic> {
    let radians = |angle: Option<Degrees>| angle.map_or(0.0, |degrees| degrees.0.to_radians());
    let vector = |lengths: [Length; 3]| DVec3::from_array(lengths.map(|length| length.0));
    let mut forms = Vec::new();
    forms.extend(text.ellipsoid.map(|e| Form::Ellipsoid { radii: vector(e.radii) }));
    forms.extend(text.cylinder.map(|c| Form::Cone {
        radius: c.radius.0,
        top: c.radius.0,
        height: c.height.0,
    }));
    forms.extend(text.cone.map(|c| Form::Cone {
        radius: c.radius.0,
        top: c.top.map_or(0.0, |top| top.0),
        height: c.height.0,
    }));
    forms.extend(text.disc.map(|d| Form::Disc { radius: d.radius.0, thickness: d.thickness.0 }));
    forms.extend(text.cuboid.map(|b| Form::Box { size: vector(b.size) }));
    forms.extend(text.blade.map(|b| Form::Blade {
        height: b.height.0,
        width: b.width.0,
        fold: b.fold.map_or(0.0, |fold| fold.0.to_radians()),
        thickness: b.thickness.map_or(0.02 * b.width.0, |thickness| thickness.0),
        curl: radians(b.curl),
    }));
    forms.extend(text.hair.map(|h| Form::Hair {
        height: h.height.0,
        radius: h.radius.0,
        tip: h.tip.map_or(h.radius.0, |tip| tip.0),
        curl: radians(h.curl),
    }));
    if let Some(tube) = text.tube {
        forms.push(self::tube(tube)?);
    }
    Ok(forms)
}

fn tube(text: TubeText) -> Result<Form, Diagnostic> {
    let span = text.points.span();
    let points: Vec<DVec3> = text.points.into_inner().into_iter().map(vector).collect();
    if !(2..=10_000).contains(&points.len()) {
        let message = format!("a tube has from 2 to 10000 points, not {}", points.len());
        return Err(Diagnostic::error(span, message, "points"));
    }
    Ok(Form::Tube { points, radii: [text.radius.0, text.tip.map_or(text.radius.0, |tip| tip.0)] })
}

fn frame(text: &ShapeText) -> Frame {
    let up = text.axis.map_or(DVec3::Z, |axis| axis.0);
    let toward = text.toward.map_or(DVec3::X, |toward| toward.0);
    let x = (toward - toward.dot(up) * up).try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
    let size = text.size.map_or(1.0, |size| size.0);
    let origin = text.at.map_or(DVec3::ZERO, vector);
    Frame { origin, axes: DMat3::from_cols(x, up.cross(x), up) * size }
}

fn material(text: &ShapeText) -> Material {
    let usual = Material::default();
    Material {
        albedo: text.colour.map_or(usual.albedo, |colour| colour.0),
        gloss: text.gloss.map_or(usual.gloss, |gloss| gloss.0 as f32),
        roughness: text.roughness.map_or(usual.roughness, |roughness| roughness.0),
        variation: text.variation.map_or(usual.variation, |variation| variation.0),
        density: text.density.map(|density| density.0),
        flakes: match text.flakes {
            None | Some(FlakesText::Surface) => Flakes::Surface,
            Some(FlakesText::Along) => Flakes::Along,
            Some(FlakesText::Radial) => Flakes::Radial,
            Some(FlakesText::Concentric) => Flakes::Concentric(0.0),
            Some(FlakesText::Smoothed(radius)) => Flakes::Concentric(radius.0),
            Some(FlakesText::Fibre(direction)) => Flakes::Fibre(direction.0),
            Some(FlakesText::Ellipsoid(radii)) => {
                Flakes::Ellipsoid(DVec3::from_array(radii.map(|radius| radius.0)))
            }
        },
    }
}

impl ScatterText {
    fn copies(&self) -> u64 {
        let parts = self.grid.map(|grid| grid.iter().map(|n| u64::from(n.0)).product::<u64>());
        match (self.count, parts) {
            (Some(count), Some(parts)) => parts.min(u64::from(count.0)),
            (Some(count), None) => u64::from(count.0),
            (None, parts) => parts.unwrap_or(0),
        }
    }
}

fn scatter(read: Spanned<ScatterText>) -> Result<Scatter, Diagnostic> {
    let span = read.span();
    let text = read.into_inner();
    let copies = text.copies();
    if copies == 0 {
        let error = Diagnostic::error(span, "a scatter has a `count` or a `grid`", "neither is here");
        return Err(error.with_help("write count = 100, or grid = [4, 4, 1]"));
    }
    let usual_region = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)];
    let region = text.region.map_or(Ok(usual_region), |region| {
        let [x0, y0, z0, x1, y1, z1] = region.get_ref().map(|place| place.0);
        let (low, high) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
        let message = "a region is x0, y0, z0, x1, y1, z1 with x0 <= x1 and so on";
        if low.cmple(high).all() {
            Ok([low, high])
        } else {
            Err(Diagnostic::error(region.span(), message, "empty"))
        }
    })?;
    let size = text.size.map_or(Ok([1.0; 2]), |size| {
        let [least, most] = size.get_ref().map(|length| length.0);
        let message = "sizes are the smallest and the greatest";
        if least <= most {
            Ok([least, most])
        } else {
            Err(Diagnostic::error(size.span(), message, "the other way round"))
        }
    })?;
    let radians = |angle: Option<Degrees>| angle.map_or(0.0, |degrees| degrees.0.to_radians());
    Ok(Scatter {
        shape: shape(text.shape)?,
        count: u32::try_from(copies).unwrap_or(u32::MAX),
        round: text.round,
        grid: text.grid.map(|grid| grid.map(|n| n.0)),
        seed: text.seed.map_or(0, |seed| seed.0),
        region,
        jitter: text.jitter.map_or(1.0, |jitter| jitter.0),
        comb: text.comb.map_or(DVec3::ZERO, vector),
        outward: text.outward.map_or(0.0, |outward| outward.0),
        spin: text.spin.map_or(1.0, |spin| spin.0),
        lean: radians(text.lean),
        curl: radians(text.curl),
        size,
        tint: text.tint.map_or(0.0, |tint| tint.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        let source = Source::new("bush.toml", text);
        Recipe::parse(source).expect_err("no recipe").to_string()
    }

    #[test]
    fn a_recipe_becomes_a_volume() {
        let text = r##"
            edge = 16
            cyclic = ["x", "y"]
            filter = "1995"
            phong = { diffuse = 0.5, specular = 0.5, exponent = 30 }
            [[shapes]]
            cone = { radius = 0.1, height = 0.4 }
            at = [0.5, 0.5, 0]
            colour = "#8b4513"
            [[scatters]]
            shape = { blade = { height = 0.5, width = 0.05, fold = 30 }, color = [0.2, 0.6, 0.1], flakes = { fibre = [0, 0, 1] } }
            count = 9
            lean = 5
            size = [0.8, 1.2]
        "##;
        let recipe = Recipe::parse(Source::new("lawn.toml", text)).expect("a recipe");
        let volume = recipe.build().expect("few cells");
        assert_eq!(
            (volume.edge(), volume.cyclic(), volume.mode()),
            (16, [true, true, false], Mode::Neyret1995)
        );
        assert!(volume.size().filled > 50 && volume.phong().exponent == 30.0);
    }

    /// The recipes of the gallery, in small.
    #[test]
    fn the_gallery_is_built() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/texels");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let recipe = Recipe::load(&path).expect("a recipe").with_edge(16).expect("a power of two");
                assert!(recipe.build().expect("few cells").size().filled > 100, "{}", path.display());
                count += 1;
            }
        }
        assert!(count >= 5, "{count}");
    }

    #[test]
    fn errors_show_their_place() {
        for (text, message, place) in [
            ("edge = 12", "expected a power of two from 1 to 1024, not 12", "bush.toml:1:8"),
            ("edge = 16\n[[shapes]]\nboll = 1", "unknown field `boll`", "bush.toml:3:1"),
            (
                "edge = 16\n[[shapes]]\ndisc = { radius = -1, thickness = 1 }",
                "expected a length above 0",
                "bush.toml:3:19",
            ),
            ("edge = 16\n[[shapes]]\nat = [0, 0, 0]", "a shape is one of ellipsoid", "bush.toml:2:1"),
            ("edge = 16\n[[shapes]]\nat = [0, 0]", "invalid length 2", "bush.toml:3:6"),
            ("edge = 16\n[[shapes]]\ncolour = \"blurple\"", "expected a colour", "bush.toml:3:10"),
            ("edge = = 16", "extra `=`", "bush.toml:1:8"),
            ("edge = 16", "nothing is painted", "bush.toml:1:1"),
        ] {
            let error = error(text);
            assert!(error.contains(message) && error.contains(place), "{text}\n{error}");
        }
    }
}
