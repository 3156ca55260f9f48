//! Recipes: TOML texts that say what is painted into a volume. `docs/texels.md` describes them.

use super::TexelError;
use super::mend::{self, Mended};
use super::source::{self, Reader, axes};
use super::text::{Axis, FilterName, FlakesText, PhongText, RecipeText, ScatterText, ShapeText, TubeText};
use super::values::{Degrees, Edge, Length, vector};
use crate::access::{FileAccess, Reach, folder_of};
use crate::load::{LoadError, read_text};
use fieldstone_lang::{Diagnostic, Diagnostics, Source};
use fieldstone_texel::paint::{Flakes, Form, Frame, Material, Scatter, Shape, paint};
use fieldstone_texel::{Builder, Mode, Phong, Volume};
use glam::DVec3;
use serde_json::Value;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// A JSON Schema (draft 2020-12) that recipes satisfy when they are read as JSON: editors complete keys with it. What it
/// cannot say, such as that a shape is one thing, is checked when a recipe is read.
pub fn recipe_schema() -> Value {
    let mut schema = schemars::schema_for!(RecipeText);
    schema.insert("title".to_owned(), "Fieldstone recipe of a volume".into());
    schema.into()
}

/// What is painted into a volume.
#[derive(Clone, Debug)]
pub struct Recipe {
    edge: u32,
    cyclic: [bool; 3],
    mode: Mode,
    phong: Phong,
    shapes: Vec<Shape>,
    scatters: Vec<Scatter>,
    sources: Vec<source::Source>,
    warnings: Vec<String>,
    text: Arc<Source>,
}

impl Recipe {
    /// Reads a recipe, and the files that it names.
    ///
    /// # Errors
    /// A file that cannot be read, or holds something else.
    pub fn load(path: &Path, access: &FileAccess) -> Result<Self, LoadError> {
        let source = Source::new(path.display().to_string(), read_text(path)?);
        Ok(Self::parse(source, folder_of(path), access)?)
    }

    /// Reads the text of a recipe, and the files that it names, relative to `folder`.
    ///
    /// # Errors
    /// A text that is no recipe, and files that cannot be read.
    pub fn parse(source: Source, folder: &Path, access: &FileAccess) -> Result<Self, Diagnostics> {
        match read(&source, &Reach::new(folder, access)) {
            Ok(recipe) => Ok(recipe),
            Err(list) => Err(Diagnostics { source, list }),
        }
    }

    /// What the models of the recipe give reason to say.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
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
    /// The shapes or sources fill more cells than are allowed, or a source has no size.
    pub fn build(&self) -> Result<Volume, TexelError> {
        let mut builder = Builder::new(self.edge)?.cyclic(self.cyclic).phong(self.phong);
        let single = self.shapes.iter().zip(0..).map(|(shape, seed)| shape.solid(seed));
        paint(&mut builder, single.chain(self.scatters.iter().flat_map(Scatter::solids)))?;
        let failed = |error| Diagnostics { source: (*self.text).clone(), list: vec![error] };
        for source in &self.sources {
            source.add(&mut builder).map_err(|error| LoadError::from(failed(error)))?;
        }
        Ok(builder.build(self.mode)?)
    }
}

/// What of a recipe makes sense, and all that does not.
fn read(source: &Source, reach: &Reach) -> Result<Recipe, Vec<Diagnostic>> {
    let Mended { value, mut errors, damaged } = mend::read::<RecipeText>(&source.text);
    let Some(mut read) = value else { return Err(errors) };
    let mut list = Vec::new();
    if errors.is_empty() {
        list.extend(check_amounts(&read));
    }
    let mut reader = Reader::new(&source.text, reach);
    let sources = sources(&mut read, &damaged, &mut reader);
    // What is wrong with a shape of which a part was left out follows from that part.
    let is_whole = |span: Range<usize>| !damaged.contains(&span);
    let shapes = read.shapes.into_iter().filter(|shape| is_whole(shape.span()));
    let shapes = shapes.filter_map(|text| shape(text).map_err(|error| list.push(error)).ok()).collect();
    let mut scatters = Vec::new();
    for text in read.scatters {
        if is_whole(text.span()) && is_whole(text.get_ref().shape.span()) {
            scatters.extend(scatter(text, &mut list));
        }
    }
    errors.extend(list);
    errors.append(&mut reader.errors);
    if !errors.is_empty() {
        errors.sort_by_key(|error| error.span.start);
        return Err(errors);
    }
    Ok(Recipe {
        edge: read.edge.0,
        cyclic: [Axis::X, Axis::Y, Axis::Z].map(|axis| read.cyclic.contains(&axis)),
        mode: read.filter.map_or(Mode::default(), FilterName::mode),
        phong: read.phong.map_or(Phong::default(), PhongText::phong),
        shapes,
        scatters,
        sources,
        warnings: reader.warnings,
        text: Arc::new(source.clone()),
    })
}

/// The tables of a list from which nothing was left out.
fn whole<T>(list: &mut Vec<Spanned<T>>, damaged: &[Range<usize>]) -> impl Iterator<Item = Spanned<T>> {
    std::mem::take(list).into_iter().filter(|table| !damaged.contains(&table.span()))
}

/// All sources that make sense, in the order of their kinds.
fn sources(text: &mut RecipeText, damaged: &[Range<usize>], reader: &mut Reader<'_>) -> Vec<source::Source> {
    let mut sources = Vec::new();
    sources.extend(whole(&mut text.fields, damaged).filter_map(|text| reader.field(text)));
    sources.extend(whole(&mut text.meshes, damaged).filter_map(|text| reader.mesh(text)));
    sources.extend(whole(&mut text.strands, damaged).filter_map(|text| reader.strands(text)));
    sources.extend(whole(&mut text.particles, damaged).filter_map(|text| reader.particles(text)));
    sources.extend(whole(&mut text.scans, damaged).filter_map(|text| reader.scan(text)));
    sources.extend(whole(&mut text.noise, damaged).filter_map(|text| reader.noise(text)));
    sources
}

/// Nothing, and too much.
fn check_amounts(read: &RecipeText) -> Option<Diagnostic> {
    if read.is_empty() {
        let error =
            Diagnostic::error(0..0, "nothing is painted", "no [[shapes]], [[scatters]] or other source");
        return Some(error.with_help("begin with [[shapes]] and ellipsoid = { radii = [0.3, 0.3, 0.3] }"));
    }
    let copies: u64 = read.scatters.iter().map(|scatter| scatter.get_ref().copies()).sum();
    let last = read.scatters.last().filter(|_| copies > MAX_COPIES)?;
    let message = format!("{copies} copies are too many, at most {MAX_COPIES} are painted");
    Some(Diagnostic::error(last.span(), message, "the last scatter"))
}

/// The greatest number of copies in a recipe.
const MAX_COPIES: u64 = 100_000;

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
    let size = text.size.map_or(1.0, |size| size.0);
    let origin = text.at.map_or(DVec3::ZERO, vector);
    Frame { origin, axes: axes(text.axis, text.toward) * size }
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

/// A scatter, unless something is wrong with it.
fn scatter(read: Spanned<ScatterText>, errors: &mut Vec<Diagnostic>) -> Option<Scatter> {
    let before = errors.len();
    let span = read.span();
    let text = read.into_inner();
    let copies = text.copies();
    if copies == 0 {
        let error = Diagnostic::error(span, "a scatter has a `count` or a `grid`", "neither is here");
        errors.push(error.with_help("write count = 100, or grid = [4, 4, 1]"));
    }
    let parts = text.grid.map_or(1, |grid| grid.iter().map(|n| u64::from(n.0)).product::<u64>());
    if parts > MAX_COPIES {
        let message = format!("a grid has at most {MAX_COPIES} parts, not {parts}");
        errors.push(Diagnostic::error(text.shape.span(), message, "the scatter of this"));
    }
    let [x0, y0, z0, x1, y1, z1] =
        text.region.as_ref().map_or(USUAL_REGION, |region| region.get_ref().map(|place| place.0));
    let region = [DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)];
    if let Some(text) = text.region.filter(|_| !region[0].cmple(region[1]).all()) {
        let message = "a region is x0, y0, z0, x1, y1, z1 with x0 <= x1 and so on";
        errors.push(Diagnostic::error(text.span(), message, "empty"));
    }
    let size = text.size.as_ref().map_or([1.0; 2], |size| size.get_ref().map(|length| length.0));
    if let Some(text) = text.size.filter(|_| size[0] > size[1]) {
        let message = "sizes are the smallest and the greatest";
        errors.push(Diagnostic::error(text.span(), message, "the other way round"));
    }
    let radians = |angle: Option<Degrees>| angle.map_or(0.0, |degrees| degrees.0.to_radians());
    let shape = shape(text.shape).map_err(|error| errors.push(error)).ok()?;
    let scatter = Scatter {
        shape,
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
    };
    (errors.len() == before).then_some(scatter)
}

/// Where copies stand if nothing is said.
const USUAL_REGION: [f64; 6] = [0.0, 0.0, 0.0, 1.0, 1.0, 0.0];

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        let source = Source::new("bush.toml", text);
        Recipe::parse(source, Path::new("."), &FileAccess::default()).expect_err("no recipe").to_string()
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
        let recipe = Recipe::parse(Source::new("lawn.toml", text), Path::new("."), &FileAccess::default())
            .expect("a recipe");
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
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/scenes/texels");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let recipe = Recipe::load(&path, &FileAccess::default())
                    .expect("a recipe")
                    .with_edge(16)
                    .expect("a power of two");
                assert!(recipe.build().expect("few cells").size().filled > 100, "{}", path.display());
                count += 1;
            }
        }
        assert!(count >= 5, "{count}");
    }

    /// The recipes of the document, with the files of the gallery.
    #[test]
    fn examples_of_the_document_are_built() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let text = std::fs::read_to_string(root.join("docs/texels.md")).expect("a text");
        let validator = jsonschema::validator_for(&recipe_schema()).expect("a schema");
        let (mut recipes, mut is_code) = (Vec::new(), false);
        for line in text.lines() {
            let code = line.strip_prefix("    ");
            match code.or(line.is_empty().then_some("")) {
                Some(code) if code.starts_with("edge = ") => recipes.push(format!("{code}\n")),
                Some(code) if is_code => {
                    recipes.last_mut().into_iter().for_each(|text| *text += &format!("{code}\n"))
                }
                _ => {}
            }
            is_code =
                code.is_some_and(|code| is_code || code.starts_with("edge = ")) || is_code && line.is_empty();
        }
        let mut kinds = String::new();
        for text in &recipes {
            let source = Source::new("docs/texels.md", text);
            let recipe = Recipe::parse(source, &root.join("gallery/scenes/texels"), &FileAccess::default());
            let recipe =
                recipe.unwrap_or_else(|error| panic!("{error}")).with_edge(16).expect("a power of two");
            let filled = recipe.build().expect("few cells").size().filled;
            assert!(filled > 50, "{filled}: {text}");
            assert!(validator.is_valid(&toml::from_str(text).expect("TOML")), "{text}");
            kinds += text;
        }
        for kind in ["scatters", "fields", "meshes", "strands", "particles", "scans", "noise"] {
            assert!(kinds.contains(&format!("[[{kind}]]")), "{kind}");
        }
    }

    #[test]
    fn all_errors_are_told_at_once_and_none_twice() {
        let text = "edge = 12\ncyclic = [\"q\"]\n[[shapes]]\nboll = 1\ndisc = { radius = -1, thickness = 1 }\n\
                    [[shapes]]\nat = [0, 0, 0]\n[[scatters]]\nshape = { hair = { height = 1, radius = 0.01 } }\n\
                    region = [1, 0, 0, 0, 1, 1]\nsize = [2, 1]\n[[scatters]]\nshape = { hair = { height = 1, radius = 0.1 } }\n\
                    grid = [200, 200, 200]\ncount = 1\n[[scatters]]\nshape = { hair = { height = 1 } }\ncount = 1";
        let check = |text: &str, expected: &[&str]| {
            let found = error(text);
            assert_eq!(found.matches("error: ").count(), expected.len(), "{found}");
            expected.iter().for_each(|message| assert!(found.contains(message), "{message}: {found}"));
        };
        let of_values = [
            "unknown variant `q`",
            "unknown field `boll`",
            "expected a length above 0",
            "missing field `radius`",
        ];
        check(text, &[&["expected a power of two"], of_values.as_slice()].concat());
        // With an edge, what the tables say is judged too; what was wrong before is not told again.
        let of_tables = [
            "a shape is one of",
            "a scatter has a `count`",
            "a region is x0",
            "sizes are the smallest and the greatest",
            "a grid has at most 100000 parts, not 8000000",
        ];
        check(
            &text.replace("edge = 12", "edge = 16"),
            &[of_values.as_slice(), of_tables.as_slice()].concat(),
        );
    }

    #[test]
    fn recipes_of_the_gallery_fit_the_schema() {
        let validator = jsonschema::validator_for(&recipe_schema()).expect("a schema");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/scenes/texels");
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                continue;
            }
            let text = std::fs::read_to_string(path).expect("a text");
            let recipe: Value = toml::from_str(&text).expect("TOML");
            assert!(
                validator.is_valid(&recipe),
                "{:?}",
                validator.iter_errors(&recipe).next().map(|e| e.to_string())
            );
        }
        for wrong in [
            "edge = -1",
            "edge = 16\nshapes = [{ disc = { radius = 0, thickness = 1 } }]",
            "edge = 16\nsize = 1",
        ] {
            let recipe: Value = toml::from_str(wrong).expect("TOML");
            assert!(!validator.is_valid(&recipe), "{wrong}");
        }
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
