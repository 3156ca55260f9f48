//! `fieldstone render`.

use crate::arguments::{MethodName, RenderArguments};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use crate::slice;
use fieldstone::glam::DVec3;
use fieldstone::{
    Ball, Bounds, Document, FileAccess, Frames, Loaded, Method, Projection, RenderOptions, RenderRequest,
    Rendered, Resolved, SceneRequest, Settings, View, Warning, write_beside, write_exr, write_png_toned,
};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// What kind of file a picture becomes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    Png,
    Exr,
}

/// The size of a picture unless another is asked for.
pub(crate) const DEFAULT_SIZE: (u32, u32) = (512, 512);

/// What is drawn.
enum Subject {
    Model(Box<Loaded>),
    Scene(Box<Document>),
}

/// Draws a model or a scene and writes the picture, or the pictures of a film.
pub(crate) fn run(arguments: &RenderArguments, start: Instant) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let kind = output_kind(&arguments.output)?;
    for path in std::iter::once(&arguments.output).chain(&arguments.stats) {
        check_writable(path)?;
    }
    if arguments.stats.as_ref() == Some(&arguments.output) {
        let message = format!("{}: the picture and --stats cannot be one file", arguments.output.display());
        return Err(Failure::Usage(message));
    }
    let frames = match arguments.frames {
        Some(range) => Some(Frames::new(range, arguments.fps.unwrap_or(24.0), &arguments.output)?),
        None => None,
    };
    let request = request(arguments)?;
    let subject = match arguments.model.scene() {
        Some(path) => Subject::Scene(Box::new(scene(arguments, path)?)),
        None => {
            let loaded = arguments.model.load().map_err(|failure| failure.filtered(arguments.quiet))?;
            if slice::is_meant(arguments, &loaded)? {
                return flat(arguments, &loaded, start);
            }
            Subject::Model(Box::new(loaded))
        }
    };
    let work = Work { arguments, subject, request, kind, interrupt };
    match frames {
        None => work.picture(&arguments.output, None, start),
        Some(frames) => {
            for (done, (path, time)) in (0..).zip(frames.iter()) {
                let drawn = work.picture(&path, Some(time), Instant::now());
                drawn.map_err(|failure| match failure {
                    Failure::Interrupted => Failure::InterruptedAfter(done),
                    other => other,
                })?;
            }
            Ok(())
        }
    }
}

fn flat(arguments: &RenderArguments, loaded: &Loaded, start: Instant) -> Result<(), Failure> {
    if arguments.frames.is_some() {
        return Err(Failure::Usage("--frames draws solids: flat pictures are drawn one by one".to_owned()));
    }
    slice::run(arguments, loaded, start)
}

/// Reads a scene file; options that are about one model have no meaning then.
fn scene(arguments: &RenderArguments, path: &Path) -> Result<Document, Failure> {
    let for_models = [
        ("--bounds", arguments.bounds.is_some()),
        ("--open", arguments.open),
        ("--surface", arguments.surface),
        ("--clip-sphere", arguments.clip_sphere.is_some()),
        ("--slice", arguments.slice.is_some()),
        ("--slice-style", arguments.slice_style.is_some()),
    ];
    if let Some((option, _)) = for_models.iter().find(|(_, given)| *given) {
        let message = format!("{option} is for models: a scene file says it with a key of its objects");
        return Err(Failure::Usage(message));
    }
    let access = FileAccess { folders: arguments.allow_read.clone(), outside: arguments.allow_outside };
    arguments.model.load_scene(path, &access).map_err(|failure| failure.filtered(arguments.quiet))
}

/// What there is to do, and for whom.
struct Work<'a> {
    arguments: &'a RenderArguments,
    subject: Subject,
    request: RenderRequest,
    kind: Kind,
    interrupt: Interrupt,
}

impl Work<'_> {
    /// Draws one picture, at a time of its own if it is one of a film.
    fn picture(&self, path: &Path, time: Option<f64>, start: Instant) -> Result<(), Failure> {
        let arguments = self.arguments;
        let (mut resolved, messages) = self.resolve(time)?;
        if !arguments.quiet {
            messages.iter().for_each(|message| eprintln!("{message}"));
        }
        let rendered = draw(arguments, &resolved, &self.interrupt)?;
        if let Some(warning) = Warning::of_picture(&rendered.stats, &resolved) {
            resolved.warnings.push(warning);
            if !arguments.quiet {
                eprintln!("warning: {warning}");
            }
        }
        let summary = Summary::new(&resolved, &rendered, start);
        let background = &resolved.scene.lighting().background;
        self.interrupt.writing(|| {
            match self.kind {
                Kind::Png => {
                    write_png_toned(&rendered.film, background, &resolved.scene.settings().tone, path)?
                }
                Kind::Exr => write_exr(&rendered.film, path)?,
            }
            if let Some(path) = &arguments.stats {
                write_beside(path, |file| {
                    serde_json::to_writer_pretty(&mut *file, &summary)?;
                    writeln!(file)
                })?;
            }
            Ok(())
        })?;
        if arguments.quiet {
            return Ok(());
        }
        let name = if time.is_some() { format!("{}: ", path.display()) } else { String::new() };
        writeln!(std::io::stdout(), "{name}{}", summary.line())
            .map_err(|e| Failure::of_stream("standard output", &e))
    }

    /// The scene, and what is to be said of it.
    fn resolve(&self, time: Option<f64>) -> Result<(Resolved, Vec<String>), Failure> {
        match &self.subject {
            Subject::Model(loaded) => {
                let mut request = self.request.clone();
                request.inputs.time = time.unwrap_or(request.inputs.time);
                let resolved = request.resolve(&loaded.model)?;
                let warnings = resolved.warnings.iter().map(|warning| format!("warning: {warning}"));
                let messages = loaded.rendered_warnings().chain(warnings).collect();
                Ok((resolved, messages))
            }
            Subject::Scene(document) => {
                let arguments = self.arguments;
                let wishes = arguments.model.scene_request(document)?;
                let request = SceneRequest {
                    time: time.or(wishes.time),
                    view: self.request.view,
                    size: arguments.size,
                    samples: arguments.samples,
                    method: arguments.method.map(|_| self.request.settings.method),
                    tolerance: arguments.tolerance,
                    ..wishes
                };
                let found = document.resolve(&request)?;
                Ok((found.resolved, found.messages))
            }
        }
    }
}

fn draw(
    arguments: &RenderArguments,
    resolved: &Resolved,
    interrupt: &Interrupt,
) -> Result<Rendered, Failure> {
    let progress = Progress::new(!arguments.quiet);
    let report = |share| progress.report(share);
    let options = RenderOptions {
        threads: arguments.threads.map(usize::from),
        memory: arguments.memory.map(|mebibytes| (mebibytes as usize).saturating_mul(1 << 20)),
        progress: Some(&report),
        cancel: Some(interrupt.flag()),
    };
    Ok(fieldstone::render(&resolved.scene, &options)?)
}

fn output_kind(path: &Path) -> Result<Kind, Failure> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("png") => Ok(Kind::Png),
        Some("exr") => Ok(Kind::Exr),
        _ => Err(Failure::Usage(format!("{}: the picture must be a .png or .exr file", path.display()))),
    }
}

/// Finds out before the work what would make it futile.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(Failure::Material(format!(
            "cannot write {}: there is no folder {}",
            path.display(),
            folder.display()
        )));
    }
    Ok(fieldstone::check_writable(path)?)
}

/// The bounds that were asked for.
pub(crate) fn bounds(arguments: &RenderArguments) -> Result<Option<Bounds>, Failure> {
    let bounds = arguments
        .bounds
        .map(|[x0, y0, z0, x1, y1, z1]| Bounds::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)));
    Ok(bounds.transpose()?)
}

fn request(arguments: &RenderArguments) -> Result<RenderRequest, Failure> {
    let sphere = arguments.clip_sphere.map(|[x, y, z, radius]| Ball::new(DVec3::new(x, y, z), radius));
    let fov =
        arguments.fov.map(|degrees| Projection::Perspective { vertical_fov_radians: degrees.to_radians() });
    let projection = arguments.ortho.map(|height| Projection::Orthographic { height }).or(fov);
    let view = View { eye: arguments.eye, target: arguments.target, up: arguments.up, projection };
    let usual = Settings::default();
    let settings = Settings {
        size: arguments.size.unwrap_or(DEFAULT_SIZE),
        samples: arguments.samples.unwrap_or(usual.samples),
        method: method(arguments)?,
        tolerance: arguments.tolerance,
        ..usual
    };
    Ok(RenderRequest {
        inputs: arguments.model.inputs(),
        bounds: bounds(arguments)?,
        open: arguments.open,
        surface: arguments.surface,
        clip_sphere: sphere.transpose()?,
        view,
        settings,
    })
}

fn method(arguments: &RenderArguments) -> Result<Method, Failure> {
    let only_for = |option: &str, method: &str| {
        Err(Failure::Usage(format!("{option} has a meaning with --method {method} only")))
    };
    let name = arguments.method.unwrap_or(MethodName::Affine);
    match (name, arguments.step, arguments.accept_epsilon) {
        (MethodName::Affine | MethodName::Interval, Some(_), _) => only_for("--step", "sampled"),
        (MethodName::Affine | MethodName::Sampled, _, Some(_)) => only_for("--accept-epsilon", "interval"),
        (MethodName::Affine, None, None) => Ok(Method::Affine),
        (MethodName::Interval, None, accept_epsilon) => Ok(Method::Interval { accept_epsilon }),
        (MethodName::Sampled, step, None) => Ok(Method::Sampled { step }),
    }
}

/// What is said of a picture.
#[derive(Serialize)]
struct Summary {
    width: u32,
    height: u32,
    /// Pixels by what their centre rays rest on.
    certified: u64,
    tolerance: u64,
    undecided: u64,
    /// Pixels whose centre rays hit.
    hits: u64,
    rays: u64,
    evaluations: u64,
    evaluations_per_ray: f64,
    operations: usize,
    bounds: [f64; 6],
    eye: [f64; 3],
    forward: [f64; 3],
    up: [f64; 3],
    warnings: Vec<String>,
    duration_secs: f64,
}

impl Summary {
    fn new(resolved: &Resolved, rendered: &Rendered, start: Instant) -> Self {
        let (scene, stats) = (&resolved.scene, &rendered.stats);
        let (min, max) = (scene.bounds().min(), scene.bounds().max());
        let camera = scene.camera();
        Self {
            width: rendered.film.width(),
            height: rendered.film.height(),
            certified: stats.certified,
            tolerance: stats.tolerance,
            undecided: stats.undecided,
            hits: stats.hits,
            rays: stats.rays,
            evaluations: stats.evaluations,
            evaluations_per_ray: stats.evaluations as f64 / stats.rays.max(1) as f64,
            operations: scene.solids().iter().map(|solid| solid.field().operation_count()).sum(),
            bounds: [min.x, min.y, min.z, max.x, max.y, max.z],
            eye: camera.eye().to_array(),
            forward: camera.forward().to_array(),
            up: camera.up().to_array(),
            warnings: resolved.warnings.iter().map(ToString::to_string).collect(),
            duration_secs: start.elapsed().as_secs_f64(),
        }
    }

    fn line(&self) -> String {
        let pixels = (u64::from(self.width) * u64::from(self.height)).max(1);
        let share = |count: u64| format!("{count} ({} %)", percent(count, pixels));
        format!(
            "certified {}, tolerance {}, undecided {} of {pixels} pixels; {:.1} evaluations per ray; {:.2} s",
            share(self.certified),
            share(self.tolerance),
            share(self.undecided),
            self.evaluations_per_ray,
            self.duration_secs,
        )
    }
}

/// A share with two digits, which is 100 or 0 only if it is all or nothing.
pub(crate) fn percent(count: u64, of: u64) -> String {
    let exact = 100.0 * count as f64 / of as f64;
    match count {
        0 => "0".to_owned(),
        _ if count == of => "100".to_owned(),
        _ => format!("{:.2}", exact.clamp(0.01, 99.99)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_honest() {
        assert_eq!(percent(0, 10), "0");
        assert_eq!(percent(10, 10), "100");
        assert_eq!(percent(1, 3), "33.33");
        assert_eq!(percent(999_999, 1_000_000), "99.99");
        assert_eq!(percent(1, 1_000_000), "0.01");
    }

    #[test]
    fn the_extension_decides_the_kind() {
        assert_eq!(output_kind(Path::new("a/b.PNG")).ok(), Some(Kind::Png));
        assert_eq!(output_kind(Path::new("b.exr")).ok(), Some(Kind::Exr));
        assert_eq!(output_kind(Path::new("b.jpg")).map_err(|e| e.code()), Err(2));
        assert_eq!(output_kind(Path::new("png")).map_err(|e| e.code()), Err(2));
    }
}
