//! `fieldstone plot`.

use crate::arguments::{METHOD, ModelArguments, OUTPUT, VIEW, parse_bounds, parse_numbers, parse_size};
use crate::failure::Failure;
use crate::render::check_writable;
use clap::{Args, ValueEnum};
use fieldstone::glam::DVec3;
use fieldstone::{Bounds, PlotRequest, RayChoice, RenderRequest, Settings, SpanChoice, write_beside};
use std::io::Write;
use std::path::PathBuf;

/// Pixels of a PNG for each unit of the SVG.
const PIXELS: f32 = 1.5;

/// The arguments of `plot`.
#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The ray: a point and a direction in model space; t is the distance from the point.
    #[arg(long, help_heading = VIEW, value_name = "ox,oy,oz,dx,dy,dz", allow_hyphen_values = true, value_parser = parse_numbers::<6>)]
    #[arg(required_unless_present = "through", conflicts_with = "through")]
    ray: Option<[f64; 6]>,
    /// The ray through a pixel of the picture that `render` makes, counted from 0,0 at the upper left.
    #[arg(long, help_heading = VIEW, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse_pixel)]
    through: Option<[u32; 2]>,
    /// The width and height of that picture.
    #[arg(long, help_heading = VIEW, value_name = "WxH", allow_hyphen_values = true, default_value = "512x512", value_parser = parse_size)]
    size: (u32, u32),
    /// The plot: .svg or .png.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    output: PathBuf,
    /// The least and largest t [default: where the ray is in the bounds].
    #[arg(long, help_heading = VIEW, value_name = "t0,t1", allow_hyphen_values = true, value_parser = parse_numbers::<2>)]
    span: Option<[f64; 2]>,
    /// Show so many spans of the same length, instead of those that the method looks at.
    #[arg(long, help_heading = METHOD, value_name = "N", allow_hyphen_values = true, conflicts_with = "method")]
    spans: Option<u32>,
    /// The method whose spans are shown.
    #[arg(long, help_heading = METHOD, value_enum, default_value_t = SpanMethod::Affine)]
    method: SpanMethod,
    /// Where the solid is [default: found].
    #[arg(long, help_heading = VIEW, value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = parse_bounds)]
    bounds: Option<[f64; 6]>,
}

/// The methods that look at spans.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SpanMethod {
    /// Affine forms, from the front on.
    Affine,
    /// Intervals, by halves.
    Interval,
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let hint = || format!("`{text}` is not a pixel: write 256,100, counted from 0,0 at the upper left");
    let (x, y) = text.split_once(',').ok_or_else(hint)?;
    let number = |text: &str| text.trim().parse().map_err(|_| hint());
    Ok([number(x)?, number(y)?])
}

/// Draws a function along a ray.
pub(crate) fn run(arguments: &PlotArguments) -> Result<(), Failure> {
    let path = &arguments.output;
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let is_png = match extension.as_deref() {
        Some("svg") => false,
        Some("png") => true,
        _ => return Err(Failure::Usage(format!("{}: the plot must be a .svg or .png file", path.display()))),
    };
    check_writable(path)?;
    let request = request(arguments)?;
    let loaded = arguments.model.load()?;
    loaded.rendered_warnings().for_each(|warning| eprintln!("{warning}"));
    let plot = request.plot(&loaded)?;
    let bytes = if is_png { plot.to_png(PIXELS)? } else { plot.to_svg().into_bytes() };
    Ok(write_beside(path, |file| file.write_all(&bytes))?)
}

fn request(arguments: &PlotArguments) -> Result<PlotRequest, Failure> {
    let bounds = arguments
        .bounds
        .map(|[x0, y0, z0, x1, y1, z1]| Bounds::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)));
    let ray = match (arguments.ray, arguments.through) {
        (Some([ox, oy, oz, dx, dy, dz]), _) => {
            RayChoice::Line { origin: DVec3::new(ox, oy, oz), direction: DVec3::new(dx, dy, dz) }
        }
        (None, Some([x, y])) => RayChoice::Pixel { x, y },
        (None, None) => return Err(Failure::Usage("there is no ray: use --ray or --through".to_owned())),
    };
    let spans = match (arguments.spans, arguments.method) {
        (Some(count), _) => SpanChoice::Uniform(count),
        (None, SpanMethod::Affine) => SpanChoice::Affine,
        (None, SpanMethod::Interval) => SpanChoice::Interval,
    };
    let settings = Settings { size: arguments.size, ..Settings::default() };
    let inputs = arguments.model.inputs();
    let render = RenderRequest { inputs, bounds: bounds.transpose()?, settings, ..RenderRequest::default() };
    Ok(PlotRequest { render, ray, span: arguments.span.map(|[t0, t1]| (t0, t1)), spans })
}
