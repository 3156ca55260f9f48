//! The sources of a recipe: fields, meshes, strands, particles, scans and noise. Files are read when the recipe is.

use super::text::sources::{
    BodyText, BoundsText, EndianText, FieldText, HypertextureText, InsideText, KnotText, MeshText, NoiseText,
    NumberText, PointsText, ScanText, WithinText,
};
use super::values::{Colour, Direction, Share};
use crate::access::{NoFile, Reach};
use crate::data::{NumberType, RawLayout, load_scan};
use crate::document::place_in_text;
use crate::endless::settle_loops;
use crate::extent::find_solid;
use crate::inputs::Inputs;
use crate::load::{LoadError, LoadOptions, Loaded, formula, load};
use crate::request::Warning;
use fieldstone_field::{Bindings, Field};
use fieldstone_lang::{Diagnostic, Diagnostics};
use fieldstone_scene::srgb_to_linear;
use fieldstone_texel::Builder;
use fieldstone_texel::sources::{
    BakeOptions, Body, HypertextureOptions, Inside, Knot, Mesh, MeshOptions, Noise, Paint, Particle,
    ParticleOptions, Place, Scan, ScanOptions, SourceError, Strand, StrandOptions, add_hypertexture,
    add_mesh, add_particles, add_scan, add_strands, bake, read_mesh, read_particles, read_strands,
};
use glam::{DMat3, DVec3};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;

/// Two corners.
type Corners = [[f64; 3]; 2];

/// Something that adds cells to a volume, and where the recipe says so.
#[derive(Clone, Debug)]
pub(super) struct Source {
    span: Range<usize>,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Field(Arc<Solid>),
    Mesh(Arc<Mesh>, MeshOptions),
    Strands(Arc<[Strand]>, StrandOptions),
    Particles(Arc<[Particle]>, ParticleOptions),
    Scan(Arc<Scan>, ScanOptions),
    Noise(Corners, HypertextureOptions),
}

/// A field that is baked.
#[derive(Debug)]
struct Solid {
    field: Field,
    bindings: Bindings,
    bounds: Corners,
    options: BakeOptions,
    hypertexture: Option<HypertextureOptions>,
    paint: Paint,
    /// Whether the first three attributes are the colour, in sRGB.
    is_coloured: bool,
}

impl Source {
    /// Adds the cells.
    pub(super) fn add(&self, builder: &mut Builder) -> Result<(), Diagnostic> {
        let added = match &self.kind {
            Kind::Field(solid) => solid.add(builder),
            Kind::Mesh(mesh, options) => add_mesh(builder, mesh, options),
            Kind::Strands(strands, options) => add_strands(builder, strands, options),
            Kind::Particles(particles, options) => add_particles(builder, particles, options),
            Kind::Scan(scan, options) => add_scan(builder, scan, options),
            Kind::Noise(bounds, options) => add_hypertexture(builder, None, *bounds, options),
        };
        added
            .map(|_| ())
            .map_err(|error| Diagnostic::error(self.span.clone(), error.to_string(), "this source"))
    }
}

impl Solid {
    fn add(&self, builder: &mut Builder) -> Result<Place, SourceError> {
        let field = (&self.field, &self.bindings);
        if let Some(options) = &self.hypertexture {
            return add_hypertexture(builder, Some(field), self.bounds, options);
        }
        bake(builder, field, self.bounds, &self.options, &|_, attributes| match attributes {
            [red, green, blue, ..] if self.is_coloured => {
                let albedo = [*red, *green, *blue].map(|share| srgb_to_linear(share.clamp(0.0, 1.0)) as f32);
                Paint { albedo: albedo.map(|share| if share.is_nan() { 0.0 } else { share }), ..self.paint }
            }
            _ => self.paint,
        })
    }
}

/// Reads sources, and gathers what is wrong with them.
pub(super) struct Reader<'t> {
    text: &'t str,
    reach: &'t Reach,
    pub(super) errors: Vec<Diagnostic>,
    /// What models give reason to say.
    pub(super) warnings: Vec<String>,
}

impl<'t> Reader<'t> {
    pub(super) fn new(text: &'t str, reach: &'t Reach) -> Self {
        Self { text, reach, errors: Vec::new(), warnings: Vec::new() }
    }

    pub(super) fn field(&mut self, read: Spanned<FieldText>) -> Option<Source> {
        let span = read.span();
        let text = read.into_inner();
        let (bounds, within) = (self.corners(text.bounds), self.within(text.within));
        let inputs = Inputs { parameters: text.parameters.into_iter().collect(), ..Inputs::default() };
        let (loaded, place) = match (text.expr, text.file) {
            (Some(expr), None) => {
                if text.object.is_some() {
                    self.fail::<()>(
                        span.clone(),
                        "`object` has a meaning with a HyperFun `file` only",
                        "here",
                    );
                }
                (self.formula(&expr)?, expr.span())
            }
            (None, Some(file)) => (self.model(&file, text.object)?, file.span()),
            (None, None) => {
                let error = Diagnostic::error(span, "a field has an `expr` or a `file`", "neither is here");
                let help = "write expr = \"x^2 + y^2 + z^2 - 1\", or file = \"model.hf\"";
                self.errors.push(error.with_help(help));
                return None;
            }
            (Some(_), Some(file)) => {
                return self.fail(file.span(), "a field has either an `expr` or a `file`", "one too many");
            }
        };
        let (loaded, bindings) = self.settled(loaded, &inputs, &place)?;
        let field = loaded.model.field;
        let bounds = match bounds {
            Some(bounds) => bounds,
            None => self.found_bounds((&field, &bindings), &place)?,
        };
        let paint = paint(text.colour, text.gloss, Paint::default());
        let is_coloured =
            loaded.model.has_attributes && text.colour.is_none() && field.attributes().len() >= 3;
        let roughness = text.roughness.map_or(0.1, |share| share.0);
        let inside = text.inside.map_or(Inside::default(), InsideText::inside);
        let hypertexture = text.hypertexture.map(|texture| HypertextureOptions {
            paint,
            within,
            roughness: text.roughness.map_or(HypertextureOptions::default().roughness, |share| share.0),
            ..texture.options()
        });
        let options = BakeOptions { roughness, inside, open: text.open, within };
        let solid = Solid { field, bindings, bounds, options, hypertexture, paint, is_coloured };
        Some(Source { span, kind: Kind::Field(Arc::new(solid)) })
    }

    pub(super) fn mesh(&mut self, read: Spanned<MeshText>) -> Option<Source> {
        let span = read.span();
        let text = read.into_inner();
        let options = MeshOptions {
            roughness: text.roughness.map_or(0.1, |share| share.0),
            body: text.body.map_or(Body::default(), BodyText::body),
            inside: text.inside.map_or(Inside::default(), InsideText::inside),
            paint: paint(text.colour, text.gloss, Paint::default()),
            bounds: self.corners(text.bounds),
            within: self.within(text.within),
        };
        let mut mesh = self.file(&text.file, |path| read_mesh(&path))?;
        turn(mesh.points.iter_mut(), text.axis, text.toward);
        Some(Source { span, kind: Kind::Mesh(Arc::new(mesh), options) })
    }

    pub(super) fn strands(&mut self, read: Spanned<PointsText>) -> Option<Source> {
        let span = read.span();
        let text = read.into_inner();
        let usual = StrandOptions::default();
        let options = StrandOptions {
            radius: text.radius.map_or(usual.radius, |radius| radius.0),
            roughness: text.roughness.map_or(usual.roughness, |share| share.0),
            paint: paint(text.colour, text.gloss, usual.paint),
            bounds: self.corners(text.bounds),
            within: self.within(text.within),
        };
        let mut strands = self.file(&text.file, |path| read_strands(&path))?;
        if strands.iter().all(|strand| strand.points.len() < 2) {
            return self.fail(text.file.span(), "there is no strand in it", "this file");
        }
        turn(strands.iter_mut().flat_map(|strand| &mut strand.points), text.axis, text.toward);
        Some(Source { span, kind: Kind::Strands(strands.into(), options) })
    }

    pub(super) fn particles(&mut self, read: Spanned<PointsText>) -> Option<Source> {
        let span = read.span();
        let text = read.into_inner();
        let usual = ParticleOptions::default();
        let options = ParticleOptions {
            radius: text.radius.map_or(usual.radius, |radius| radius.0),
            roughness: text.roughness.map_or(0.1, |share| share.0),
            paint: paint(text.colour, text.gloss, usual.paint),
            bounds: self.corners(text.bounds),
            within: self.within(text.within),
        };
        let mut particles = self.file(&text.file, |path| read_particles(&path))?;
        if particles.is_empty() {
            return self.fail(text.file.span(), "there is no particle in it", "this file");
        }
        turn(particles.iter_mut().map(|particle| &mut particle.centre), text.axis, text.toward);
        Some(Source { span, kind: Kind::Particles(particles.into(), options) })
    }

    pub(super) fn scan(&mut self, read: Spanned<ScanText>) -> Option<Source> {
        let span = read.span();
        let mut text = read.into_inner();
        let usual = ScanOptions::default();
        let (bounds, within) = (self.corners(text.bounds.take()), self.within(text.within.take()));
        let raw = self.layout(&text, &span)?;
        let scan = self.file(&text.file, |path| load_scan(&path, raw.as_ref()))?;
        let transfer = self.transfer(&mut text, &scan, &span)?;
        let surface = text.surface.map_or(usual.surface, |cells| cells.0);
        let roughness = text.roughness.map_or(usual.roughness, |share| share.0);
        let options = ScanOptions { transfer, surface, roughness, bounds, within };
        Some(Source { span, kind: Kind::Scan(Arc::new(scan), options) })
    }

    /// How raw numbers stand in the file, if it has such; nothing if what is said of it makes no sense.
    fn layout(&mut self, text: &ScanText, span: &Range<usize>) -> Option<Option<RawLayout>> {
        let is_said = text.endian.is_some() || text.skip.is_some();
        let name = text.file.get_ref().to_ascii_lowercase();
        let has_head = [".nrrd", ".nhdr", ".nii", ".gz"].iter().any(|ending| name.ends_with(ending));
        match (text.size, text.number) {
            (None, None) if !is_said => Some(None),
            (Some(size), Some(number)) if !has_head => Some(Some(RawLayout {
                counts: size.map(|count| count.0 as usize),
                number: number.number(),
                big_endian: text.endian == Some(EndianText::Big),
                skip: text.skip.map_or(0, |skip| skip.0 as usize),
            })),
            _ if has_head => {
                let message =
                    "`size`, `type`, `endian` and `skip` are for raw numbers: this file has a header";
                self.fail(span.clone(), message, "leave them out")
            }
            _ => self.fail(span.clone(), "raw numbers have a `size` and a `type`", "one of them is missing"),
        }
    }

    /// What the numbers of a scan look like.
    fn transfer(&mut self, text: &mut ScanText, scan: &Scan, span: &Range<usize>) -> Option<Vec<Knot>> {
        let Some(threshold) = &text.threshold else {
            if text.density.is_some() || text.colour.is_some() || text.gloss.is_some() {
                let message = "`density`, `colour` and `gloss` of a scan belong to a `threshold`";
                return self.fail(span.clone(), message, "there is none");
            }
            return Some(self.knots(std::mem::take(&mut text.transfer)));
        };
        if !text.transfer.is_empty() {
            let message = "a scan has either a `threshold` or a `transfer` function";
            return self.fail(threshold.span(), message, "one too many");
        }
        let paint = paint(text.colour, text.gloss, Paint::default());
        let [low, high] = scan.range().unwrap_or([0.0, 1.0]).map(f64::from);
        let level = threshold.get_ref().0;
        // As steep as a hundredth of all numbers.
        let step = (0.005 * (high - low)).max(f64::MIN_POSITIVE).max(1e-9 * level.abs());
        let knot = |value, density| Knot { value, density, albedo: paint.albedo, gloss: paint.gloss };
        let density = text.density.map_or(100.0, |density| density.0);
        Some(vec![knot(level - step, 0.0), knot(level + step, density)])
    }

    fn knots(&mut self, list: Vec<Spanned<KnotText>>) -> Vec<Knot> {
        let mut knots: Vec<Knot> = Vec::new();
        for read in list {
            let span = read.span();
            let text = read.into_inner();
            let paint = paint(text.colour, text.gloss, Paint::default());
            if knots.last().is_some_and(|last| last.value >= text.value.0) {
                self.fail::<()>(
                    span,
                    "the values of a transfer function rise",
                    "not above the one before it",
                );
            }
            let (value, density) = (text.value.0, text.density.0);
            knots.push(Knot { value, density, albedo: paint.albedo, gloss: paint.gloss });
        }
        knots
    }

    pub(super) fn noise(&mut self, read: Spanned<NoiseText>) -> Option<Source> {
        let span = read.span();
        let text = read.into_inner();
        let bounds = self.corners(text.bounds).unwrap_or([[0.0; 3], [1.0; 3]]);
        let usual = HypertextureOptions::default();
        let options = HypertextureOptions {
            roughness: text.roughness.map_or(usual.roughness, |share| share.0),
            paint: paint(text.colour, text.gloss, usual.paint),
            within: self.within(text.within),
            ..text.hypertexture.options()
        };
        Some(Source { span, kind: Kind::Noise(bounds, options) })
    }

    fn fail<T>(&mut self, span: Range<usize>, message: impl Into<String>, label: &str) -> Option<T> {
        self.errors.push(Diagnostic::error(span, message, label));
        None
    }

    /// What is read from a file that is named here.
    fn file<T, E: std::fmt::Display>(
        &mut self,
        name: &Spanned<String>,
        read: impl FnOnce(PathBuf) -> Result<T, E>,
    ) -> Option<T> {
        let path = self.path(name)?;
        match read(path) {
            Ok(found) => Some(found),
            Err(error) => self.fail(name.span(), error.to_string(), "this file"),
        }
    }

    fn path(&mut self, name: &Spanned<String>) -> Option<PathBuf> {
        let (message, label, help) = match self.reach.find(name.get_ref()) {
            Ok(path) => return Some(path),
            Err(NoFile::Missing(path)) => {
                let folder = self.reach.folder().display();
                let help = format!("files are named relative to the recipe, here {folder}");
                (format!("there is no file {}", path.display()), "not found", help)
            }
            Err(NoFile::Outside(path)) => {
                let help =
                    "to let the recipe read it, use --allow-read FOLDER, or --allow-outside for all files";
                let message = format!("{} lies outside of the folder of the recipe", path.display());
                (message, "may not be read", help.to_owned())
            }
        };
        self.errors.push(Diagnostic::error(name.span(), message, label).with_help(help));
        None
    }

    fn formula(&mut self, expr: &Spanned<String>) -> Option<Loaded> {
        let text = expr.get_ref();
        match formula(text) {
            Ok(loaded) => Some(loaded),
            Err(errors) => {
                let whole = expr.span();
                let place = |part| place_in_text(self.text, &whole, text, part);
                let here = errors.list.into_iter().map(|d| Diagnostic { span: place(d.span.clone()), ..d });
                self.errors.extend(here.collect::<Vec<_>>());
                None
            }
        }
    }

    fn model(&mut self, file: &Spanned<String>, object: Option<String>) -> Option<Loaded> {
        let path = self.path(file)?;
        match load(&path, &LoadOptions { object, ..LoadOptions::default() }) {
            Ok(loaded) => Some(loaded),
            Err(LoadError::Model(errors)) => self.fail_elsewhere(&file.span(), &errors),
            Err(error) => self.fail(file.span(), error.to_string(), "this file"),
        }
    }

    /// All that is wrong with another text, at the place where it is named.
    fn fail_elsewhere<T>(&mut self, span: &Range<usize>, errors: &Diagnostics) -> Option<T> {
        for error in &errors.list {
            let (line, column) = errors.source.line_and_column(error.span.start);
            let message = format!("{}:{line}:{column}: {}", errors.source.name, error.message);
            let here = Diagnostic::error(span.clone(), message, "in this file");
            self.errors.push(match &error.help {
                Some(help) => here.with_help(help.clone()),
                None => here,
            });
        }
        None
    }

    /// A model with values for all that it leaves open.
    fn settled(
        &mut self,
        mut loaded: Loaded,
        inputs: &Inputs,
        place: &Range<usize>,
    ) -> Option<(Loaded, Bindings)> {
        let bindings = match inputs.bindings(&loaded.model) {
            Ok(bindings) => bindings,
            Err(error) => return self.fail(place.clone(), error.to_string(), "this model"),
        };
        if let Err(error) = settle_loops(&mut loaded, inputs, None) {
            return self.fail(place.clone(), error.to_string(), "this model");
        }
        self.warnings.extend(loaded.rendered_warnings());
        Some((loaded, bindings))
    }

    fn found_bounds(
        &mut self,
        (field, bindings): (&Field, &Bindings),
        place: &Range<usize>,
    ) -> Option<Corners> {
        let (bounds, warning) = match find_solid(field, bindings) {
            Ok(found) => found,
            Err(error) => return self.fail(place.clone(), error.to_string(), "this model"),
        };
        match warning {
            None | Some(Warning::SampledBounds) => {}
            Some(warning) => {
                let error = Diagnostic::error(place.clone(), warning.of_object("no bounds"), "this model");
                let help = "write bounds = [-1, -1, -1, 1, 1, 1]: the part of space that is baked";
                self.errors.push(error.with_help(help));
                return None;
            }
        }
        Some([bounds.min().to_array(), bounds.max().to_array()])
    }

    fn corners(&mut self, bounds: BoundsText) -> Option<Corners> {
        let bounds = bounds?;
        self.nonempty(bounds.span(), bounds.into_inner().map(|coordinate| coordinate.0))
    }

    fn within(&mut self, within: WithinText) -> Option<Corners> {
        let within = within?;
        self.nonempty(within.span(), within.into_inner().map(|place| place.0))
    }

    fn nonempty(&mut self, span: Range<usize>, [x0, y0, z0, x1, y1, z1]: [f64; 6]) -> Option<Corners> {
        if x0 < x1 && y0 < y1 && z0 < z1 {
            return Some([[x0, y0, z0], [x1, y1, z1]]);
        }
        self.fail(span, "a box is x0, y0, z0, x1, y1, z1 with x0 < x1 and so on", "empty")
    }
}

fn paint(colour: Option<Colour>, gloss: Option<Share>, usual: Paint) -> Paint {
    Paint {
        albedo: colour.map_or(usual.albedo, |colour| colour.0),
        gloss: gloss.map_or(usual.gloss, |gloss| gloss.0 as f32),
    }
}

/// The axes of a thing whose z has one direction, and whose x is near another.
pub(super) fn axes(axis: Option<Direction>, toward: Option<Direction>) -> DMat3 {
    let up = axis.map_or(DVec3::Z, |axis| axis.0);
    let toward = toward.map_or(DVec3::X, |toward| toward.0);
    let x = (toward - toward.dot(up) * up).try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
    DMat3::from_cols(x, up.cross(x), up)
}

fn turn<'p>(
    points: impl Iterator<Item = &'p mut [f64; 3]>,
    axis: Option<Direction>,
    toward: Option<Direction>,
) {
    if axis.is_some() || toward.is_some() {
        let axes = axes(axis, toward);
        points.for_each(|point| *point = (axes * DVec3::from_array(*point)).to_array());
    }
}

impl InsideText {
    fn inside(self) -> Inside {
        match self {
            Self::Skin => Inside::Skin,
            Self::Full => Inside::Full,
            Self::Empty => Inside::Empty,
        }
    }
}

impl BodyText {
    fn body(self) -> Body {
        match self {
            Self::Auto => Body::Auto,
            Self::Solid => Body::Solid,
            Self::Sheets => Body::Sheets,
        }
    }
}

impl NumberText {
    fn number(self) -> NumberType {
        match self {
            Self::U8 => NumberType::U8,
            Self::I8 => NumberType::I8,
            Self::U16 => NumberType::U16,
            Self::I16 => NumberType::I16,
            Self::U32 => NumberType::U32,
            Self::I32 => NumberType::I32,
            Self::F32 => NumberType::F32,
            Self::F64 => NumberType::F64,
        }
    }
}

impl HypertextureText {
    /// Paint, roughness and place are the usual ones.
    fn options(self) -> HypertextureOptions {
        let (usual, waves) = (HypertextureOptions::default(), Noise::default());
        HypertextureOptions {
            density: self.density.map_or(usual.density, |x| x.0),
            softness: self.softness.map_or(usual.softness, |x| x.0),
            amplitude: self.amplitude.map_or(usual.amplitude, |x| x.0),
            bias: self.bias.map_or(usual.bias, |x| x.0),
            gain: self.gain.map_or(usual.gain, |x| x.0),
            surface: self.surface.map_or(usual.surface, |x| x.0),
            noise: Noise {
                frequency: self.frequency.map_or(waves.frequency, |x| x.0),
                octaves: self.octaves.map_or(waves.octaves, |x| x.0),
                lacunarity: self.lacunarity.map_or(waves.lacunarity, |x| x.0),
                gain: self.persistence.map_or(waves.gain, |x| x.0),
                turbulence: self.turbulence,
                seed: self.seed.map_or(waves.seed, |x| x.0),
            },
            ..usual
        }
    }
}
