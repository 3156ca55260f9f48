//! `fieldstone render --slice`.

use crate::arguments::{RenderArguments, SliceStyleName};
use crate::failure::Failure;
use crate::render::{DEFAULT_SIZE, bounds, percent};
use fieldstone::{
    Loaded, SlicePicture, SliceRequest, SliceStats, SliceStyle, SliceWarning, draw_slice, write_beside,
    write_rgb,
};
use serde::Serialize;
use std::io::Write;
use std::time::Instant;

/// Whether the model is drawn on a plane: if that was asked for, or if it has no third coordinate.
pub(crate) fn is_meant(arguments: &RenderArguments, loaded: &Loaded) -> Result<bool, Failure> {
    let is_flat = loaded.model.coordinates < 3;
    let for_solids = [
        ("--eye", arguments.eye.is_some()),
        ("--target", arguments.target.is_some()),
        ("--up", arguments.up.is_some()),
        ("--fov", arguments.fov.is_some()),
        ("--ortho", arguments.ortho.is_some()),
        ("--open", arguments.open),
    ];
    match for_solids.iter().find(|(_, given)| *given && is_flat) {
        Some((option, _)) => Err(Failure::Usage(format!(
            "{} has fewer than 3 coordinates and is drawn flat: {option} has no meaning",
            loaded.model.name
        ))),
        None if arguments.slice.is_none() && !is_flat && arguments.slice_style.is_some() => {
            Err(Failure::Usage("--slice-style has a meaning with --slice only".to_owned()))
        }
        None => Ok(arguments.slice.is_some() || is_flat),
    }
}

/// Draws a model on a plane and writes the picture.
pub(crate) fn run(arguments: &RenderArguments, loaded: &Loaded, start: Instant) -> Result<(), Failure> {
    let is_png = arguments.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if !is_png {
        let path = arguments.output.display();
        return Err(Failure::Usage(format!("{path}: a flat picture must be a .png file")));
    }
    let request = SliceRequest {
        inputs: arguments.model.inputs(),
        plane: arguments.slice.and_then(|slice| slice.0),
        bounds: bounds(arguments)?,
        size: arguments.size.unwrap_or(DEFAULT_SIZE),
        style: match arguments.slice_style {
            Some(SliceStyleName::Plain) => SliceStyle::Plain,
            Some(SliceStyleName::Contours) | None => SliceStyle::Contours,
            Some(SliceStyleName::Heat) => SliceStyle::Heat,
        },
    };
    let (slice, warning) = request.resolve(&loaded.model)?;
    if !arguments.quiet {
        loaded.rendered_warnings().for_each(|warning| eprintln!("{warning}"));
        if arguments.slice.is_none() {
            eprintln!("warning: the model has fewer than 3 coordinates: drawn flat, as by --slice");
        }
        warning.iter().for_each(|warning| eprintln!("warning: {warning}"));
    }
    let picture = draw_slice(&slice, arguments.threads.map(usize::from))?;
    write_rgb((picture.width, picture.height), &picture.pixels, &arguments.output)?;
    let summary = Summary::new(&picture, warning, start);
    if let Some(path) = &arguments.stats {
        write_beside(path, |file| {
            serde_json::to_writer_pretty(&mut *file, &summary)?;
            writeln!(file)
        })?;
    }
    if !arguments.quiet {
        let line = summary.line();
        writeln!(std::io::stdout(), "{line}").map_err(|e| Failure::of_stream("standard output", &e))?;
    }
    Ok(())
}

/// What is said of a slice.
#[derive(Serialize)]
struct Summary {
    width: u32,
    height: u32,
    /// Pixels without the axes.
    pixels: u64,
    certified_inside: u64,
    certified_outside: u64,
    boundary: u64,
    undefined: u64,
    evaluations: u64,
    warnings: Vec<String>,
    duration_secs: f64,
}

impl Summary {
    fn new(picture: &SlicePicture, warning: Option<SliceWarning>, start: Instant) -> Self {
        let SliceStats { pixels, inside, outside, boundary, undefined, evaluations } = picture.stats;
        Self {
            width: picture.width,
            height: picture.height,
            pixels,
            certified_inside: inside,
            certified_outside: outside,
            boundary,
            undefined,
            evaluations,
            warnings: warning.iter().map(ToString::to_string).collect(),
            duration_secs: start.elapsed().as_secs_f64(),
        }
    }

    fn line(&self) -> String {
        let share = |count: u64| format!("{count} ({} %)", percent(count, self.pixels.max(1)));
        format!(
            "certified inside {}, certified outside {}, boundary {}, undefined {} of {} pixels; {} evaluations; {:.2} s",
            share(self.certified_inside),
            share(self.certified_outside),
            share(self.boundary),
            share(self.undefined),
            self.pixels,
            self.evaluations,
            self.duration_secs,
        )
    }
}
