//! The command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use fieldstone::glam::DVec3;
use fieldstone::{Dialect, Inputs, LoadOptions, Loaded, formula, load};
use std::path::PathBuf;

use crate::failure::Failure;

/// See solids that are defined by functions.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    max_term_width = 100,
    after_help = "\
Examples:
  fieldstone render model.hf -o model.png
  fieldstone render -e 'x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8' -o tangle.png --size 800x600
  echo '0 0 0' | fieldstone eval -e 'x^2 + y^2 + z^2 - 1'
  fieldstone check model.hf

Models: HyperFun (.hf, .hpf; F >= 0 inside, y up), programs (.vm) and formulas (any other file, or -e;
f < 0 inside, z up)."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw a model.
    Render(Box<RenderArguments>),
    /// Print the values of a model at the points on standard input.
    Eval(EvalArguments),
    /// Say what is in a model, and what is strange about it.
    Check(EvalArguments),
    /// Print bounds of the volume, area, centroid and extent of a solid, all of them proved.
    Measure(crate::measure::MeasureArguments),
    /// Draw the function along a ray, with its interval and affine bounds.
    Plot(crate::plot::PlotArguments),
}

/// Which model.
#[derive(Debug, Args)]
pub(crate) struct ModelArguments {
    /// The file of the model.
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
        let dialect = match self.dialect {
            DialectName::Lenient => Dialect::Lenient,
            DialectName::Strict => Dialect::Strict,
        };
        let options = LoadOptions { object: self.object.clone(), dialect };
        match (&self.model, &self.expression, &self.object) {
            (_, Some(_), Some(object)) => {
                Err(Failure::Usage(format!("a formula has no objects: leave `--object {object}` out")))
            }
            (_, Some(text), None) => Ok(formula(text)?),
            (Some(path), None, _) => Ok(load(path, &options)?),
            (None, None, _) => Err(Failure::Usage("there is no model: name a file, or use -e".to_owned())),
        }
    }

    /// The values of its inputs.
    pub(crate) fn inputs(&self) -> Inputs {
        Inputs { parameters: self.parameters.clone(), coordinates: self.coordinates.clone(), time: 0.0 }
    }
}

/// The arguments of `eval` and `check`.
#[derive(Debug, Args)]
pub(crate) struct EvalArguments {
    #[command(flatten)]
    pub(crate) model: ModelArguments,
}

/// The arguments of `render`.
#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    #[command(flatten)]
    pub(crate) model: ModelArguments,
    /// The picture: .png for the eye, .exr for all layers in linear light.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, default_value = "512x512", value_parser = parse_size)]
    pub(crate) size: (u32, u32),
    /// Where the camera stands [default: in front, to the right and above, as near as fits].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) eye: Option<DVec3>,
    /// What it looks at [default: the middle of the bounds].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) target: Option<DVec3>,
    /// What is up in the picture [default: y for HyperFun, z otherwise].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub(crate) up: Option<DVec3>,
    /// The angle from the lower to the upper edge [default: 30, or what fits from the given eye].
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, conflicts_with = "ortho")]
    pub(crate) fov: Option<f64>,
    /// A parallel view, so high from the lower to the upper edge.
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    pub(crate) ortho: Option<f64>,
    /// Where the solid is; it is cut off there [default: found].
    #[arg(long, value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = parse_bounds)]
    pub(crate) bounds: Option<[f64; 6]>,
    /// Look into the solid where the bounds cut it, instead of closing it there.
    #[arg(long)]
    pub(crate) open: bool,
    /// How surfaces are found.
    #[arg(long, value_enum, default_value_t = MethodName::Affine)]
    pub(crate) method: MethodName,
    /// The step of `--method sampled`, relative to the longest side of the bounds.
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    pub(crate) step: Option<f64>,
    /// How closely surfaces are located, relative to the longest side of the bounds.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Let `--method interval` accept spans this short without proof, relative to the longest side.
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    pub(crate) accept_epsilon: Option<f64>,
    /// Samples of a pixel where there are edges in it.
    #[arg(long, value_name = "N", allow_hyphen_values = true, default_value_t = 4)]
    pub(crate) samples: u32,
    /// How many threads [default: one for each core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// Write what was spent, and what the picture rests on, as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
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

pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    text.parse().map_err(|_| format!("`{text}` is not a number"))
}

pub(crate) fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split(',').map(parse_number).collect::<Result<_, _>>()?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("{N} numbers with commas between them are needed, not {count}"))
}

fn parse_vector(text: &str) -> Result<DVec3, String> {
    parse_numbers(text).map(DVec3::from_array)
}

pub(crate) fn parse_bounds(text: &str) -> Result<[f64; 6], String> {
    parse_numbers(text)
}

pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let hint = || format!("`{text}` is not a size: write 800x600");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(hint)?;
    let number = |text: &str| text.trim().parse().map_err(|_| hint());
    Ok((number(width)?, number(height)?))
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
    }
}
