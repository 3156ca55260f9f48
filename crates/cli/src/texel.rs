//! `fieldstone texel`.

use crate::arguments::{OUTPUT, parse_number, parse_vector};
use crate::failure::Failure;
use crate::render::check_writable;
use clap::{Args, Subcommand, ValueEnum};
use fieldstone::glam::DVec3;
use fieldstone::{
    Cut, CutContent, Fidelity, FileAccess, Mode, Recipe, Size, TexelError, Volume, load_volume, write_rgb,
    write_volume,
};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to do with volumes of texels.
#[derive(Debug, Subcommand)]
pub(crate) enum TexelCommand {
    /// Make a volume from a recipe (docs/texels.md).
    Build(BuildArguments),
    /// Say what is in a volume.
    Info(InfoArguments),
    /// Compare every level with the box-filtered finest, for both filters.
    Compare(CompareArguments),
    /// Draw a plane of a volume, or all planes before each other.
    Slice(SliceArguments),
}

/// The arguments of `texel build`.
#[derive(Debug, Args)]
pub(crate) struct BuildArguments {
    /// The recipe (.toml).
    recipe: PathBuf,
    /// The volume: .texel.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    output: PathBuf,
    /// Cells along an edge, a power of two up to 1024 [default: what the recipe says].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    edge: Option<u32>,
    /// How coarser levels are made [default: what the recipe says].
    #[arg(long, value_enum)]
    filter: Option<FilterName>,
    /// Let the recipe read what lies in this folder, beside its own; may be repeated.
    #[arg(long, help_heading = OUTPUT, value_name = "DIR")]
    allow_read: Vec<PathBuf>,
    /// Let the recipe read every file.
    #[arg(long, help_heading = OUTPUT)]
    allow_outside: bool,
    /// Print nothing but errors.
    #[arg(short, long, help_heading = OUTPUT)]
    quiet: bool,
}

/// The arguments of `texel info`.
#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The volume (.texel).
    volume: PathBuf,
    /// Print JSON.
    #[arg(long, help_heading = OUTPUT)]
    json: bool,
}

/// The arguments of `texel compare`.
#[derive(Debug, Args)]
pub(crate) struct CompareArguments {
    /// The volume (.texel).
    volume: PathBuf,
    /// The direction to the sun that throws the oblique shadow.
    #[arg(long, value_name = "X,Y,Z", default_value = "0.5,-0.4,0.8", allow_hyphen_values = true, value_parser = parse_vector)]
    sun: DVec3,
    /// Print JSON.
    #[arg(long, help_heading = OUTPUT)]
    json: bool,
    /// Print CSV.
    #[arg(long, help_heading = OUTPUT, conflicts_with = "json")]
    csv: bool,
}

/// The arguments of `texel slice`.
#[derive(Debug, Args)]
pub(crate) struct SliceArguments {
    /// The volume (.texel).
    volume: PathBuf,
    /// The picture: .png.
    #[arg(short, long, help_heading = OUTPUT, value_name = "FILE")]
    output: PathBuf,
    /// The axis across the plane.
    #[arg(long, value_enum, default_value_t = AxisName::Y)]
    axis: AxisName,
    /// Where the plane crosses it, from 0 to 1 [default: all planes, one behind the other].
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_number)]
    at: Option<f64>,
    /// The level: 0 is the finest.
    #[arg(long, value_name = "L", default_value_t = 0)]
    level: u32,
    /// What is shown.
    #[arg(long, value_enum, default_value_t = ContentName::Colour)]
    show: ContentName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FilterName {
    /// Means of S, transmittances along the axes.
    Sggx,
    /// Means of inverse quadratic forms and of densities.
    #[value(name = "1995")]
    Old,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AxisName {
    X,
    Y,
    Z,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ContentName {
    /// Colours before a chequered ground.
    Colour,
    /// Opacity across the plane.
    Opacity,
    /// Projected areas of the flakes along x, y and z.
    Flakes,
}

/// Does what is asked for.
pub(crate) fn run(command: &TexelCommand, start: Instant) -> Result<(), Failure> {
    match command {
        TexelCommand::Build(arguments) => build(arguments, start),
        TexelCommand::Info(arguments) => {
            let volume = load_volume(&arguments.volume)?;
            let report = Report::new(&volume);
            print(arguments.json, &report, || report.text())
        }
        TexelCommand::Compare(arguments) => {
            if arguments.sun == DVec3::ZERO {
                return Err(Failure::Usage("--sun: a direction is not 0,0,0".to_owned()));
            }
            let rows = compared(&load_volume(&arguments.volume)?, arguments.sun)?;
            print(arguments.json, &rows, || if arguments.csv { csv(&rows) } else { table(&rows) })
        }
        TexelCommand::Slice(arguments) => slice(arguments),
    }
}

fn build(arguments: &BuildArguments, start: Instant) -> Result<(), Failure> {
    expect_extension(&arguments.output, "texel", "a volume")?;
    check_writable(&arguments.output)?;
    let access = FileAccess { folders: arguments.allow_read.clone(), outside: arguments.allow_outside };
    let mut recipe = Recipe::load(&arguments.recipe, &access)?;
    if !arguments.quiet {
        recipe.warnings().iter().for_each(|warning| eprintln!("{warning}"));
    }
    if let Some(edge) = arguments.edge {
        recipe = recipe.with_edge(edge).map_err(|why| Failure::Usage(format!("--edge: {why}")))?;
    }
    recipe = match arguments.filter {
        Some(FilterName::Sggx) => recipe.with_mode(Mode::Sggx),
        Some(FilterName::Old) => recipe.with_mode(Mode::Neyret1995),
        None => recipe,
    };
    let volume = recipe.build()?;
    write_volume(&volume, &arguments.output)?;
    if arguments.quiet {
        return Ok(());
    }
    let seconds = start.elapsed().as_secs_f64();
    let text = format!("{}built in   {seconds:.2} s (1995: 8 s at 256 cells)\n", Report::new(&volume).text());
    print_text(&text)
}

fn slice(arguments: &SliceArguments) -> Result<(), Failure> {
    expect_extension(&arguments.output, "png", "a picture")?;
    check_writable(&arguments.output)?;
    let cut = Cut {
        level: arguments.level,
        axis: arguments.axis as usize,
        at: arguments.at,
        content: match arguments.show {
            ContentName::Colour => CutContent::Colour,
            ContentName::Opacity => CutContent::Opacity,
            ContentName::Flakes => CutContent::Flakes,
        },
    };
    let picture = cut.draw(&load_volume(&arguments.volume)?)?;
    Ok(write_rgb((picture.side, picture.side), &picture.pixels, &arguments.output)?)
}

fn expect_extension(path: &Path, extension: &str, what: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
        return Ok(());
    }
    Err(Failure::Usage(format!("{}: {what} must be a .{extension} file", path.display())))
}

fn print(json: bool, report: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if json {
        let json = serde_json::to_string_pretty(report);
        return print_text(&(json.map_err(|e| Failure::Material(e.to_string()))? + "\n"));
    }
    print_text(&text())
}

fn print_text(text: &str) -> Result<(), Failure> {
    write!(std::io::stdout(), "{text}").map_err(|e| Failure::of_stream("standard output", &e))
}

/// What is said of a volume.
#[derive(Serialize)]
struct Report {
    edge: u32,
    filter: &'static str,
    /// Along x, y and z.
    cyclic: [bool; 3],
    filled_cells: u64,
    filled_share: f64,
    /// Stored cells of each level, the finest first.
    stored: Vec<usize>,
    stored_bytes: u64,
    dense_bytes: u64,
    /// 1 - stored / dense bytes.
    compression: f64,
}

/// What a filter is called.
pub(crate) fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::Sggx => "sggx",
        Mode::Neyret1995 => "1995",
    }
}

impl Report {
    fn new(volume: &Volume) -> Self {
        let size = volume.size();
        let Size { filled, cells, stored_bytes, dense_bytes } = size;
        Self {
            edge: volume.edge(),
            filter: name(volume.mode()),
            cyclic: volume.cyclic(),
            filled_cells: filled,
            filled_share: filled as f64 / cells as f64,
            stored: (0..volume.levels()).map(|level| volume.stored(level)).collect(),
            stored_bytes,
            dense_bytes,
            compression: size.compression(),
        }
    }

    fn text(&self) -> String {
        let axes: Vec<&str> =
            ["x", "y", "z"].into_iter().zip(self.cyclic).filter(|(_, is)| *is).map(|(a, _)| a).collect();
        let cyclic = if axes.is_empty() { "no".to_owned() } else { format!("along {}", axes.join(", ")) };
        let stored: Vec<String> = self.stored.iter().map(ToString::to_string).collect();
        let lines = [
            ("edge", format!("{} cells, {} levels", self.edge, self.stored.len())),
            ("filter", self.filter.to_owned()),
            ("cyclic", cyclic),
            ("filled", format!("{} cells, {:.2} %", self.filled_cells, 100.0 * self.filled_share)),
            ("stored", format!("{} cells of levels 0 to {}", stored.join(", "), self.stored.len() - 1)),
            ("bytes", format!("{} of {} without compression", self.stored_bytes, self.dense_bytes)),
            ("compressed", format!("{:.1} % (1995: 91 to 93 % at 128 cells)", 100.0 * self.compression)),
        ];
        let mut text = String::new();
        for (name, line) in lines {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:<11}{line}");
        }
        text
    }
}

/// A level beside the finest.
#[derive(Serialize)]
struct Row {
    filter: &'static str,
    level: u32,
    edge: u32,
    rmse: f64,
    drift: f64,
    contrast: Option<f64>,
    sun_rmse: f64,
    sun_drift: f64,
    sun_contrast: Option<f64>,
}

fn compared(volume: &Volume, to_sun: DVec3) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let filtered =
            if volume.mode() == mode { None } else { Some(volume.filtered(mode).map_err(TexelError::from)?) };
        let filtered = filtered.as_ref().unwrap_or(volume);
        let both = filtered.compare().into_iter().zip(filtered.compare_in_sun(to_sun));
        rows.extend(both.map(|(Fidelity { level, rmse, drift, contrast }, sun)| Row {
            filter: name(mode),
            level,
            edge: volume.edge() >> level,
            rmse,
            drift,
            contrast,
            sun_rmse: sun.rmse,
            sun_drift: sun.drift,
            sun_contrast: sun.contrast,
        }));
    }
    Ok(rows)
}

fn table(rows: &[Row]) -> String {
    let mut text = "                   along x, y, z              in the sun\n".to_owned();
    text += "filter level edge   rmse    drift  contrast   rmse    drift  contrast\n";
    for row in rows {
        let Row { filter, level, edge, rmse, drift, sun_rmse, sun_drift, .. } = row;
        let [contrast, in_sun] = [row.contrast, row.sun_contrast]
            .map(|contrast| contrast.map_or("-".to_owned(), |contrast| format!("{contrast:.3}")));
        let _ = writeln!(
            text,
            "{filter:<6} {level:>5} {edge:>4} {rmse:>6.4} {drift:>+8.4} {contrast:>9} {sun_rmse:>6.4} {sun_drift:>+8.4} {in_sun:>9}"
        );
    }
    text + "\nOpacities of shadows beside those of level 0, box-filtered. Contrast: 1 is right, less is haze.\n"
}

fn csv(rows: &[Row]) -> String {
    let mut text = "filter,level,edge,rmse,drift,contrast,sun_rmse,sun_drift,sun_contrast\n".to_owned();
    for row in rows {
        let Row { filter, level, edge, rmse, drift, sun_rmse, sun_drift, .. } = row;
        let [contrast, in_sun] = [row.contrast, row.sun_contrast]
            .map(|contrast| contrast.map_or(String::new(), |contrast| contrast.to_string()));
        let _ = writeln!(
            text,
            "{filter},{level},{edge},{rmse},{drift},{contrast},{sun_rmse},{sun_drift},{in_sun}"
        );
    }
    text
}
