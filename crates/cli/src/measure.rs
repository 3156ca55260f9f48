//! `fieldstone measure`.

use crate::arguments::{METHOD, ModelArguments, OUTPUT, VIEW, parse_bounds, parse_number};
use crate::failure::Failure;
use clap::Args;
use fieldstone::glam::DVec3;
use fieldstone::{Bounds, Enclosure, MeasureOptions, MeasureRequest, Measured};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;

/// The arguments of `measure`.
#[derive(Debug, Args)]
pub(crate) struct MeasureArguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Measure what is in this box only [default: all of the solid].
    #[arg(long, help_heading = VIEW, value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = parse_bounds)]
    bounds: Option<[f64; 6]>,
    /// How close the bounds of volume and area shall be, relative to their values.
    #[arg(long, help_heading = METHOD, value_name = "T", allow_hyphen_values = true, default_value = "1e-3", value_parser = parse_number)]
    tolerance: f64,
    /// How much work to spend at most, in units of some seconds; then the bounds are just wider.
    #[arg(long, help_heading = METHOD, value_name = "N", allow_hyphen_values = true, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1000))]
    effort: u64,
    /// Print JSON.
    #[arg(long, help_heading = OUTPUT)]
    json: bool,
}

/// Measures a model and prints what is proved.
pub(crate) fn run(arguments: &MeasureArguments) -> Result<(), Failure> {
    let bounds = arguments
        .bounds
        .map(|[x0, y0, z0, x1, y1, z1]| Bounds::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)));
    let usual = MeasureOptions::default();
    let request = MeasureRequest {
        inputs: arguments.model.inputs(),
        bounds: bounds.transpose()?,
        options: MeasureOptions {
            tolerance: arguments.tolerance,
            operations: usual.operations.saturating_mul(arguments.effort),
        },
    };
    let loaded = arguments.model.load()?;
    let measured = request.measure(&loaded.model)?;
    let report = if arguments.json {
        let json = serde_json::to_string_pretty(&Report::new(&measured));
        json.map_err(|e| Failure::Material(e.to_string()))? + "\n"
    } else {
        loaded.rendered_warnings().for_each(|warning| eprintln!("{warning}"));
        measured.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
        text(&measured, &request.options)
    };
    write!(std::io::stdout(), "{report}").map_err(|e| Failure::of_stream("standard output", &e))
}

/// What JSON says. Lower bounds come first.
#[derive(Serialize)]
struct Report {
    volume: [f64; 2],
    /// The upper bound is `null` where there is none.
    area: (f64, Option<f64>),
    centroid: Option<[[f64; 2]; 3]>,
    /// x0, y0, z0, x1, y1, z1.
    outer_box: Option<[f64; 6]>,
    inner_box: Option<[f64; 6]>,
    undefined_volume: f64,
    bounds: [f64; 6],
    reached: bool,
    cells: u64,
    warnings: Vec<String>,
}

impl Report {
    fn new(measured: &Measured) -> Self {
        let measures = &measured.measures;
        let pair = |e: &Enclosure| [e.lower, e.upper];
        let area = &measures.area;
        Self {
            volume: pair(&measures.volume),
            area: (area.lower, Some(area.upper).filter(|x| x.is_finite())),
            centroid: measures.centroid.as_ref().map(|c| [0, 1, 2].map(|i| pair(&c[i]))),
            outer_box: measures.outer.map(six),
            inner_box: measures.inner.map(six),
            undefined_volume: measures.undefined,
            bounds: six((measured.bounds.min().to_array(), measured.bounds.max().to_array())),
            reached: measures.reached,
            cells: measures.cells,
            warnings: measured.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

fn six(([x0, y0, z0], [x1, y1, z1]): ([f64; 3], [f64; 3])) -> [f64; 6] {
    [x0, y0, z0, x1, y1, z1]
}

fn text(measured: &Measured, options: &MeasureOptions) -> String {
    let measures = &measured.measures;
    let unit = |power: &str| format!("model units{power}");
    let mut lines = vec![("volume", format!("{} {}", between(&measures.volume), unit("³")))];
    let area = match measures.area {
        Enclosure { lower, upper } if upper.is_infinite() => {
            format!("at least {}, no upper bound,", rounded(lower, lower, false))
        }
        area => between(&area),
    };
    lines.push(("area", format!("{area} {}", unit("²"))));
    match &measures.centroid {
        Some(centroid) => {
            let axes = ["x", "y", "z"].into_iter().zip(centroid);
            let axes: Vec<String> = axes.map(|(axis, c)| format!("{axis} {}", between(c))).collect();
            lines.push(("centroid", axes.join(", ")));
        }
        None => lines.push(("centroid", "unknown: no part of the solid is certain".to_owned())),
    }
    let corners = |corners: Option<([f64; 3], [f64; 3])>, outward: bool| {
        corners.map_or("none".to_owned(), |(lo, hi)| {
            let span = (0..3).map(|i| hi[i] - lo[i]).fold(0.0, f64::max) * 1e-3;
            let numbers = lo.map(|x| rounded(x, span, !outward)).into_iter();
            numbers.chain(hi.map(|x| rounded(x, span, outward))).collect::<Vec<_>>().join(",")
        })
    };
    lines.push(("inside of", corners(measures.outer, true)));
    lines.push(("comes to", corners(measures.inner, false)));
    let mut report = String::new();
    for (name, text) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(report, "{name:<11}{text}");
    }
    let _ = writeln!(report, "\nAll bounds are proved, for the part of the solid in {}.", box_of(measured));
    for note in notes(measured, options) {
        let _ = writeln!(report, "{note}");
    }
    report
}

fn box_of(measured: &Measured) -> String {
    let (min, max) = (measured.bounds.min().to_array(), measured.bounds.max().to_array());
    let span = measured.bounds.longest_side() * 1e-2;
    let outward = min.map(|x| rounded(x, span, false)).into_iter();
    outward.chain(max.map(|x| rounded(x, span, true))).collect::<Vec<_>>().join(",")
}

fn notes(measured: &Measured, options: &MeasureOptions) -> Vec<String> {
    let mut notes = Vec::new();
    let measures = &measured.measures;
    if measures.area.upper > 0.0 {
        notes.push(
            "The area is that of f = 0; faces where the bounds cut the solid are not counted.".to_owned(),
        );
    }
    if measures.area.upper.is_infinite() {
        notes.push(
            "The area has no upper bound, because somewhere near the surface the gradient cannot be told from 0."
                .to_owned(),
        );
    }
    if measures.undefined > 0.0 {
        let volume = rounded(measures.undefined, measures.undefined, true);
        notes
            .push(format!("The function may be undefined in a volume of {volume}: counted as maybe inside."));
    }
    let MeasureOptions { tolerance, .. } = *options;
    let wide = |e: &Enclosure| e.width().is_finite() && e.width() > tolerance * e.lower;
    let late: Vec<&str> = [("volume", &measures.volume), ("area", &measures.area)]
        .into_iter()
        .filter_map(|(name, e)| wide(e).then_some(name))
        .collect();
    if !late.is_empty() {
        let late = late.join(" and of ");
        let why = match measures.full {
            true => "no more cells are kept in memory (with --bounds, parts can be measured one by one)",
            false => "the effort was used up (--effort)",
        };
        notes.push(format!("The bounds of {late} are wider than {tolerance} of the value: {why}."));
    }
    notes
}

/// Both bounds with as many digits as they need to be told apart, and two more.
fn between(e: &Enclosure) -> String {
    let width = e.width();
    format!("{} … {}", rounded(e.lower, width, false), rounded(e.upper, width, true))
}

/// A number with the digits that matter at a scale, rounded up or down so that bounds stay bounds.
fn rounded(x: f64, scale: f64, up: bool) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = 2.0 - scale.abs().log10().floor();
    let digits = if digits.is_finite() { digits.clamp(0.0, 15.0) as usize } else { 6 };
    let unit = 10f64.powi(digits as i32);
    let moved = if up { (x * unit).ceil() } else { (x * unit).floor() } / unit;
    if moved.is_finite() && x.abs() < 1e15 { format!("{moved:.digits$}") } else { format!("{x:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_outward() {
        let enclosure = Enclosure { lower: 4.187_234_5, upper: 4.189_123_4 };
        assert_eq!(between(&enclosure), "4.18723 … 4.18913");
        assert_eq!(between(&Enclosure { lower: -1.0, upper: -1.0 }), "-1.000000 … -1.000000");
        assert_eq!(rounded(-0.123_456, 1e-2, true), "-0.1234");
        assert_eq!(rounded(1e300, 1.0, true), "1e300");
        assert_eq!(rounded(0.0, 0.0, false), "0");
    }
}
