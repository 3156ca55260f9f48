//! The command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use fieldstone::glam::DVec3;
use fieldstone::{
    Dialect, Document, FileAccess, Inputs, LoadOptions, Loaded, LoopError, Plane, SceneRequest, formula,
    load, settle_loops,
};
use std::path::{Path, PathBuf};

use crate::bench::BenchArguments;
use crate::convert::ConvertArguments;
use crate::examples;
use crate::failure::Failure;
use crate::measure::MeasureArguments;
use crate::plot::PlotArguments;
use crate::schema::SchemaArguments;
use crate::texel::TexelCommand;

/// The headings of the options in the help.
pub(crate) const VIEW: &str = "View";
pub(crate) const METHOD: &str = "Method";
pub(crate) const OUTPUT: &str = "Output";

/// See solids that are defined by functions.
#[derive(Debug, Parser)]
#[command(
    name = "fieldstone",
    version,
    about,
    max_term_width = 100,
    after_help = examples::PROGRAM
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw a model or a scene.
    #[command(after_help = examples::RENDER)]
    Render(Box<RenderArguments>),
    /// Print the values of a model at the points on standard input, one a line; empty lines stay empty.
    #[command(after_help = examples::EVAL)]
    Eval(EvalArguments),
    /// Say what is in a model or a scene, and what is strange about it.
    #[command(after_help = examples::CHECK)]
    Check(CheckArguments),
    /// Print bounds of the volume, area, centroid and extent of a solid, all of them proved.
    #[command(after_help = examples::MEASURE)]
    Measure(MeasureArguments),
    /// Draw the function along a ray, with its interval and affine bounds.
    #[command(after_help = examples::PLOT)]
    Plot(PlotArguments),
    /// Write a model in another language: HyperFun, a program or a formula.
    #[command(after_help = examples::CONVERT)]
    Convert(ConvertArguments),
    /// Measure times, side by side with other programs, and how they grow.
    #[command(after_help = examples::BENCH)]
    Bench(Box<BenchArguments>),
    /// Make volumes of texels, and look into them.
    #[command(subcommand, after_help = examples::TEXEL)]
    Texel(TexelCommand),
    /// Print the JSON Schema of scene files, or of recipes, for editors.
    #[command(after_help = examples::SCHEMA)]
    Schema(SchemaArguments),
    /// Print the completions of a shell, for its start-up file.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArguments),
    /// Write the manual pages into a folder.
    #[command(after_help = examples::MAN)]
    Man(ManArguments),
}

/// Which model.
#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelArguments {
    /// The file of the model, or of a scene (.toml).
    #[arg(value_name = "MODEL", required_unless_present = "expression")]
    model: Option<PathBuf>,
    /// A formula instead of a file, negative inside: 'x^2 + y^2 + z^2 - 1'.
    #[arg(short, long, value_name = "EXPR", allow_hyphen_values = true, conflicts_with = "model")]
    expression: Option<String>,
    /// The object of a HyperFun file [default: my_model, or the first].
    #[arg(long, value_name = "NAME")]
    object: Option<String>,
    /// What a HyperFun text means where mathematics and the C interpreter differ.
    #[arg(long, value_enum, default_value_t = DialectName::Lenient)]
    dialect: DialectName,
    /// Set a parameter: a[1]=2 in HyperFun, the name in formulas; may be repeated.
    #[arg(long = "param", value_name = "NAME=V", value_parser = parse_parameter)]
    parameters: Vec<(String, f64)>,
    /// Fix a coordinate, counted from 1: 4=0.5; may be repeated.
    #[arg(long = "coord", value_name = "K=V", value_parser = parse_coordinate)]
    coordinates: Vec<(usize, f64)>,
    /// How many turns loops may take at a point before it counts as undefined [default: up to 1000000].
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..))]
    fuel: Option<u32>,
    /// The time in seconds: `t` in formulas [default: 0].
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_number)]
    time: Option<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DialectName {
    /// Mathematics: what the text says.
    Lenient,
    /// The values of the C interpreter.
    Strict,
}

impl ModelArguments {
    /// Reads the model.
    pub(crate) fn load(&self) -> Result<Loaded, Failure> {
        if let Some(path) = self.scene().filter(|_| self.expression.is_none()) {
            let path = path.display();
            return Err(Failure::Usage(format!(
                "{path} is a scene: render and check read it, here a model is needed"
            )));
        }
        let dialect = match self.dialect {
            DialectName::Lenient => Dialect::Lenient,
            DialectName::Strict => Dialect::Strict,
        };
        let options = LoadOptions { object: self.object.clone(), dialect };
        let mut loaded = match (&self.model, &self.expression, &self.object) {
            (_, Some(_), Some(object)) => {
                return Err(Failure::Usage(format!(
                    "a formula has no objects: leave `--object {object}` out"
                )));
            }
            (_, Some(text), None) => formula(text)?,
            (Some(path), None, _) => load(path, &options)?,
            (None, None, _) => {
                return Err(Failure::Usage("there is no model: name a file, or use -e".to_owned()));
            }
        };
        match settle_loops(&mut loaded, &self.inputs(), self.fuel) {
            Ok(()) => Ok(loaded),
            Err(LoopError::Input(error)) => Err(error.into()),
            Err(LoopError::Endless(error)) => Err(error.into()),
        }
    }

    /// The values of its inputs.
    pub(crate) fn inputs(&self) -> Inputs {
        let time = self.time.unwrap_or(0.0);
        Inputs { parameters: self.parameters.clone(), coordinates: self.coordinates.clone(), time }
    }

    /// The scene file that it is, if it is one.
    pub(crate) fn scene(&self) -> Option<&Path> {
        let is_scene = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        self.model.as_ref().filter(is_scene).map(PathBuf::as_path)
    }

    /// Reads the scene file at `path`; options that are about models have no meaning then.
    pub(crate) fn load_scene(&self, path: &Path, access: &FileAccess) -> Result<Document, Failure> {
        let for_models = [
            ("--object", self.object.is_some()),
            ("--coord", !self.coordinates.is_empty()),
            ("--fuel", self.fuel.is_some()),
        ];
        if let Some((option, _)) = for_models.iter().find(|(_, given)| *given) {
            let message = format!("{option} is for models: a scene file says it with a key of its solids");
            return Err(Failure::Usage(message));
        }
        Ok(Document::load(path, access)?)
    }

    /// What goes before the numbers of a scene file.
    pub(crate) fn scene_request(&self, document: &Document) -> Result<SceneRequest, Failure> {
        let known: Vec<&str> = document.parameter_names().collect();
        if let Some((name, _)) = self.parameters.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            return Err(Failure::Usage(format!("the scene has no parameter `{name}`; it has {known}")));
        }
        let parameters = self.parameters.clone();
        Ok(SceneRequest { time: self.time, parameters, ..SceneRequest::default() })
    }
}

/// The arguments of `eval`.
#[derive(Debug, Args)]
pub(crate) struct EvalArguments {
    #[command(flatten)]
    pub(crate) model: ModelArguments,
}

/// The arguments of `check`.
#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) model: ModelArguments,
    /// Print JSON, for other programs; errors of the model too.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Let a scene file read what lies in this folder, beside its own; may be repeated.
    #[arg(long, help_heading = OUTPUT, value_name = "DIR")]
    pub(crate) allow_read: Vec<PathBuf>,
    /// Let a scene file read every file.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) allow_outside: bool,
}

/// The arguments of `completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArguments {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

/// The arguments of `man`.
#[derive(Debug, Args)]
pub(crate) struct ManArguments {
    /// The folder, which must be there.
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

/// The arguments of `render`.
#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    #[command(flatten)]
    pub(crate) model: ModelArguments,
    /// The picture: .png for the eye, .exr for all layers in linear light.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Width and height in pixels [default: 512x512].
    #[arg(long, help_heading = VIEW, value_name = "WxH", allow_hyphen_values = true, value_parser = parse_size)]
    pub(crate) size: Option<(u32, u32)>,
    /// Where the camera stands [default: in front, to the right and above, as near as fits].
    #[arg(long, help_heading = VIEW, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) eye: Option<DVec3>,
    /// What it looks at [default: the middle of the bounds].
    #[arg(long, help_heading = VIEW, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) target: Option<DVec3>,
    /// What is up in the picture [default: y for HyperFun, z otherwise].
    #[arg(long, help_heading = VIEW, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) up: Option<DVec3>,
    /// The angle from the lower to the upper edge [default: 30, or what fits from the given eye].
    #[arg(long, help_heading = VIEW, value_name = "DEG", allow_hyphen_values = true, conflicts_with = "ortho")]
    pub(crate) fov: Option<f64>,
    /// A parallel view, so high from the lower to the upper edge.
    #[arg(long, help_heading = VIEW, value_name = "H", allow_hyphen_values = true)]
    pub(crate) ortho: Option<f64>,
    /// Where the solid is; it is cut off there [default: found].
    #[arg(long, help_heading = VIEW, value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = parse_bounds)]
    pub(crate) bounds: Option<[f64; 6]>,
    /// Look into the solid where the bounds or the sphere cut it, instead of closing it there.
    #[arg(long, help_heading = VIEW)]
    pub(crate) open: bool,
    /// Draw the surface where the function is 0, from both sides, instead of a solid: for double roots too.
    #[arg(long, help_heading = VIEW)]
    pub(crate) surface: bool,
    /// Draw only what lies in the sphere around a point with this radius; a solid is cut off there.
    #[arg(long, help_heading = VIEW, value_name = "X,Y,Z,R", allow_hyphen_values = true, value_parser = parse_sphere)]
    pub(crate) clip_sphere: Option<[f64; 4]>,
    /// Draw the values on a plane instead: z=0.3, x=0 or y=1; alone where the model does not depend on z. Models with
    /// two coordinates are always drawn so.
    #[arg(long, help_heading = VIEW, value_name = "AXIS=V", num_args = 0..=1, default_missing_value = "",
          value_parser = parse_slice, conflicts_with_all = ["eye", "target", "up", "fov", "ortho", "open", "surface",
          "clip_sphere", "method", "step", "tolerance", "accept_epsilon", "samples"])]
    pub(crate) slice: Option<SlicePlane>,
    /// How `--slice` shows values [default: contours].
    #[arg(long, help_heading = VIEW, value_enum, value_name = "STYLE")]
    pub(crate) slice_style: Option<SliceStyleName>,
    /// How surfaces are found [default: affine].
    #[arg(long, help_heading = METHOD, value_enum)]
    pub(crate) method: Option<MethodName>,
    /// The step of `--method sampled`, relative to the longest side of the bounds.
    #[arg(long, help_heading = METHOD, value_name = "S", allow_hyphen_values = true)]
    pub(crate) step: Option<f64>,
    /// How closely surfaces are located, relative to the longest side of the bounds.
    #[arg(long, help_heading = METHOD, value_name = "T", allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Let `--method interval` accept spans this short without proof, relative to the longest side.
    #[arg(long, help_heading = METHOD, value_name = "E", allow_hyphen_values = true)]
    pub(crate) accept_epsilon: Option<f64>,
    /// The most samples of a pixel where there are edges or noise in it [default: 4].
    #[arg(long, help_heading = METHOD, value_name = "N", allow_hyphen_values = true)]
    pub(crate) samples: Option<u32>,
    /// Draw pictures A to B of a film; `#` in the name of the picture stand for digits.
    #[arg(long, help_heading = OUTPUT, value_name = "A..B", value_parser = parse_frames, conflicts_with_all = ["time", "stats", "slice"])]
    pub(crate) frames: Option<(u32, u32)>,
    /// How many pictures of `--frames` there are in a second [default: 24].
    #[arg(long, help_heading = OUTPUT, value_name = "N", requires = "frames", allow_hyphen_values = true)]
    pub(crate) fps: Option<f64>,
    /// Let a scene file read what lies in this folder, beside its own; may be repeated.
    #[arg(long, help_heading = OUTPUT, value_name = "DIR")]
    pub(crate) allow_read: Vec<PathBuf>,
    /// Let a scene file read every file.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) allow_outside: bool,
    /// How many threads [default: one for each core].
    #[arg(long, help_heading = METHOD, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// About how much memory octrees may take, in MiB [default: 1024]; with less, pictures of large models take longer.
    #[arg(long, help_heading = METHOD, value_name = "MIB", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) memory: Option<u32>,
    /// Write what was spent, and what the picture rests on, as JSON.
    #[arg(long, help_heading = OUTPUT, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,
    /// Print nothing but errors: no warnings, no closing line.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) quiet: bool,
}

/// The methods by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum MethodName {
    /// Affine forms along the ray: misses nothing, fast.
    Affine,
    /// Intervals: misses nothing.
    Interval,
    /// Steps: misses what is thinner than one.
    Sampled,
}

/// The styles of slices by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum SliceStyleName {
    /// The boundary between two tints.
    Plain,
    /// The same with lines of equal values.
    Contours,
    /// Values as colours, with their scale.
    Heat,
}

/// The value of `--slice`: a plane, or none.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct SlicePlane(pub(crate) Option<Plane>);

fn parse_slice(text: &str) -> Result<SlicePlane, String> {
    if text.is_empty() {
        return Ok(SlicePlane(None));
    }
    let hint = || format!("`{text}` is not a plane: write z=0.3 (and the model before --slice)");
    let (axis, at) = text.split_once('=').ok_or_else(hint)?;
    let axis = ["x", "y", "z"].iter().position(|name| *name == axis.trim()).ok_or_else(hint)?;
    Ok(SlicePlane(Some(Plane { axis, at: parse_number(at)? })))
}

pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    text.parse().map_err(|_| format!("`{text}` is not a number"))
}

pub(crate) fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split(',').map(parse_number).collect::<Result<_, _>>()?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("{N} numbers with commas between them are needed, not {count}"))
}

pub(crate) fn parse_vector(text: &str) -> Result<DVec3, String> {
    parse_numbers(text).map(DVec3::from_array)
}

pub(crate) fn parse_bounds(text: &str) -> Result<[f64; 6], String> {
    parse_numbers(text)
}

fn parse_sphere(text: &str) -> Result<[f64; 4], String> {
    parse_numbers(text)
}

pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let hint = || format!("`{text}` is not a size: write 800x600");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(hint)?;
    let number = |text: &str| text.trim().parse().map_err(|_| hint());
    Ok((number(width)?, number(height)?))
}

fn parse_frames(text: &str) -> Result<(u32, u32), String> {
    let hint = || format!("`{text}` is not a range: write 0..47");
    let (first, last) = text.split_once("..").ok_or_else(hint)?;
    let number = |text: &str| text.trim().parse().map_err(|_| hint());
    Ok((number(first)?, number(last)?))
}

fn parse_parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("`{text}` is not of the form NAME=V"))?;
    Ok((name.trim().to_owned(), parse_number(value)?))
}

fn parse_coordinate(text: &str) -> Result<(usize, f64), String> {
    let (number, value) = text.split_once('=').ok_or_else(|| format!("`{text}` is not of the form K=V"))?;
    let index = number.trim().parse().map_err(|_| format!("`{number}` is not the number of a coordinate"))?;
    Ok((index, parse_number(value)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_option_has_a_heading() {
        let mut command = Arguments::command();
        command.build();
        for sub in ["render", "eval", "check"].map(|name| command.find_subcommand(name).unwrap()) {
            for option in sub.get_arguments().filter(|a| !a.is_positional() && a.get_id() != "help") {
                assert!(option.get_help_heading().is_some(), "{}: {}", sub.get_name(), option.get_id());
            }
        }
    }

    #[test]
    fn values() {
        assert_eq!(parse_size("800x600"), Ok((800, 600)));
        for wrong in ["800", "800x", "-8x6", "8.5x6", "x"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_vector("-1, 2.5,1e3"), Ok(DVec3::new(-1.0, 2.5, 1e3)));
        assert!(parse_vector("1,2").unwrap_err().starts_with("3 numbers"));
        assert_eq!(parse_bounds("1,2,x,4,5,6"), Err("`x` is not a number".to_owned()));
        assert_eq!(parse_parameter("a[1]=-2"), Ok(("a[1]".to_owned(), -2.0)));
        assert!(parse_parameter("a[1]").is_err());
        assert_eq!(parse_coordinate("4=.5"), Ok((4, 0.5)));
        assert!(parse_coordinate("w=1").is_err());
        assert_eq!(parse_slice("y=-.5"), Ok(SlicePlane(Some(Plane { axis: 1, at: -0.5 }))));
        assert_eq!(parse_slice(""), Ok(SlicePlane(None)));
        for wrong in ["model.hf", "w=1", "z", "z=top"] {
            assert!(parse_slice(wrong).is_err(), "{wrong}");
        }
    }
}
