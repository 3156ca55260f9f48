//! A field along a ray, with everything that is known of it there: what a ray tracer sees.
//!
//! [`PlotRequest::plot`] gathers plain data, a [`RayPlot`]; [`RayPlot::to_svg`] and [`RayPlot::to_png`] draw it, in the
//! manner of Fig. 1 of Hijazi et al. 2008: the graph of the field as a function of t, and over each span of t the
//! box that its interval makes and the parallelogram of its affine form.

mod draw;
mod scale;
mod svg;

use crate::inputs::InputError;
use crate::load::Loaded;
use crate::request::{RenderRequest, RequestError, Resolved};
use fieldstone_field::{Affines, F64, Intervals, LANES, Points, Reading, Tape, TapeOptions, Workspace};
use fieldstone_trace::{Certificate, Method, Outcome, Ray, Settings, Tracer, visited_spans};
use glam::DVec3;

pub use draw::PictureError;

/// How many samples the graph has.
const SAMPLES: usize = 1500;
/// How many roots are looked for.
const MOST_ROOTS: usize = 64;
/// How far along a ray one can look, relative to the longest side of the bounds.
const FARTHEST: f64 = 1e9;
/// How many spans are shown.
const MOST_SPANS: usize = 4096;
/// The step of the sampled method, relative to the size: what `render` takes.
const SAMPLED_STEP: f64 = 1.0 / 256.0;

/// What to plot.
#[derive(Clone, PartialEq, Debug)]
pub struct PlotRequest {
    /// Values of parameters and coordinates; bounds, camera and size of the picture through whose pixel the ray goes.
    pub render: RenderRequest,
    /// The ray.
    pub ray: RayChoice,
    /// The least and largest t, in model units; `None`: where the ray is in the bounds, and a little more.
    pub span: Option<(f64, f64)>,
    /// Which spans are shown.
    pub spans: SpanChoice,
}

/// Which ray.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum RayChoice {
    /// From a point in a direction, in model space.
    Line {
        /// Where t = 0.
        origin: DVec3,
        /// Of any length but 0.
        direction: DVec3,
    },
    /// Through the centre of a pixel, counted from the upper left corner.
    Pixel {
        /// To the right.
        x: u32,
        /// Down.
        y: u32,
    },
}

/// Which spans.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SpanChoice {
    /// So many of the same length.
    Uniform(u32),
    /// Those that the affine march looks at.
    Affine,
    /// Those that the dichotomy with intervals looks at.
    Interval,
}

/// Why there is no plot.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum PlotError {
    /// The model, its inputs, its bounds or the camera.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// A direction without a length, or numbers that are not finite.
    #[error("the ray from {origin} along {direction} is none: the direction must be finite and not 0")]
    Ray {
        /// The origin.
        origin: DVec3,
        /// The direction.
        direction: DVec3,
    },
    /// There is no such pixel.
    #[error("there is no pixel {x},{y} in a picture of {width} x {height}: they count from 0,0")]
    Pixel {
        /// What was asked for, to the right.
        x: u32,
        /// What was asked for, down.
        y: u32,
        /// The width of the picture.
        width: u32,
        /// Its height.
        height: u32,
    },
    /// A span that is none.
    #[error("a span goes from a lower to a higher finite t, not from {0} to {1}")]
    Span(f64, f64),
    /// A span that reaches farther than rays can be followed.
    #[error(
        "t = {t:e} is too far away: more than {FARTHEST:e} times the size of the solid ({size:.3e}), places on a ray \
         cannot be told from each other"
    )]
    Far {
        /// The end of the span.
        t: f64,
        /// The longest side of the bounds.
        size: f64,
    },
    /// The ray is nowhere in the bounds.
    #[error("the ray passes the solid by, far from its bounds: say with --span t0,t1 where to look along it")]
    Misses,
    /// Too many spans, or none.
    #[error("from 1 to {MOST_SPANS} spans can be shown, not {0}")]
    Spans(u32),
}

impl From<InputError> for PlotError {
    fn from(error: InputError) -> Self {
        Self::Request(error.into())
    }
}

/// A field along a ray. It is negative inside, whatever the sign of the model's file.
#[derive(Clone, PartialEq, Debug)]
pub struct RayPlot {
    /// The formula, or the name of the object.
    pub title: String,
    /// The ray; its direction has the length 1, so that t is a length.
    pub origin: [f64; 3],
    /// The direction of the ray.
    pub direction: [f64; 3],
    /// The least t.
    pub start: f64,
    /// The largest t.
    pub end: f64,
    /// t and the value there, in rising order of t; NaN where it is undefined.
    pub samples: Vec<(f64, f64)>,
    /// Which spans are shown.
    pub choice: SpanChoice,
    /// The spans, in the order in which they were looked at.
    pub spans: Vec<PlottedSpan>,
    /// Where the sign changes.
    pub roots: Vec<Root>,
    /// What each method says of the first crossing.
    pub first_hits: [FirstHit; 3],
}

/// What is known of the field over a span.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PlottedSpan {
    /// The least t.
    pub start: f64,
    /// The largest t.
    pub end: f64,
    /// The interval over the box of the span: lower and upper end, NaN where the field may be undefined.
    pub interval: (f64, f64),
    /// The affine form along the span.
    pub affine: AffineForm,
    /// What that means for roots.
    pub verdict: Verdict,
}

/// centre + slope·ε ± error, where ε goes from −1 to 1 over the span; and at the same time between two numbers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AffineForm {
    /// The value of the line in the middle.
    pub centre: f64,
    /// How much it rises from the middle to the end.
    pub slope: f64,
    /// How far values may lie from the line; infinite or NaN where the line says nothing.
    pub error: f64,
    /// The *mixed* range: lower and upper end of all that form and interval together allow.
    pub range: (f64, f64),
}

/// Whether there may be a root in a span.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Verdict {
    /// There is none.
    Excluded,
    /// There may be one between these values of t only.
    Left(f64, f64),
    /// Nothing can be said, because the field may be undefined.
    Undefined,
}

/// A change of sign.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Root {
    /// Where.
    pub t: f64,
    /// Whether the ray enters the solid.
    pub entering: bool,
    /// Whether the field jumps there, or has a pole.
    pub jump: bool,
    /// What the root rests on, and that there is no other between it and the one before.
    pub certificate: Certificate,
}

/// The first crossing as a method finds it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FirstHit {
    /// The name of the method on the command line.
    pub method: &'static str,
    /// Where it is; `None`: there is none.
    pub t: Option<f64>,
    /// What that rests on.
    pub certificate: Certificate,
    /// How many evaluations it took.
    pub cost: u32,
}

impl PlotRequest {
    /// Evaluates the field of a model along the ray.
    ///
    /// # Errors
    /// Inputs that the model does not have; a ray or a span that is none, or that passes the solid by.
    pub fn plot(&self, loaded: &Loaded) -> Result<RayPlot, PlotError> {
        match self.spans {
            SpanChoice::Uniform(count) if count == 0 || count as usize > MOST_SPANS => {
                return Err(PlotError::Spans(count));
            }
            _ => {}
        }
        let resolved = self.render.resolve(&loaded.model)?;
        let (origin, direction) = self.line(&resolved)?;
        let (start, end) = self.stretch(&resolved, origin, direction)?;
        let ray = Ray { origin: origin.to_array(), direction: direction.to_array(), start, end };
        let bindings = self.render.inputs.bindings(&loaded.model)?;
        let tape = |reading| {
            let options = TapeOptions { bindings: bindings.clone(), reading, ..TapeOptions::default() };
            Tape::new(&loaded.model.field, &options)
        };
        let (values, signs) = (tape(Reading::Value), tape(Reading::Sign));
        let settings = Settings::new(resolved.scene.bounds().longest_side().max(f64::MIN_POSITIVE));
        Ok(RayPlot {
            title: title(loaded),
            origin: ray.origin,
            direction: ray.direction,
            start,
            end,
            samples: samples(&values, &ray),
            choice: self.spans,
            spans: self.spans(&values, &ray, &settings),
            roots: roots(&signs, ray, &settings),
            first_hits: first_hits(&signs, ray, &settings),
        })
    }

    /// Origin and direction of the ray.
    fn line(&self, resolved: &Resolved) -> Result<(DVec3, DVec3), PlotError> {
        match self.ray {
            RayChoice::Line { origin, direction } => {
                let unit = direction.try_normalize().filter(|_| origin.is_finite() && direction.is_finite());
                let unit = unit.ok_or(PlotError::Ray { origin, direction })?;
                Ok((origin, unit))
            }
            RayChoice::Pixel { x, y } => {
                let (width, height) = self.render.settings.size;
                if x >= width || y >= height {
                    return Err(PlotError::Pixel { x, y, width, height });
                }
                Ok(resolved.scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5))
            }
        }
    }

    /// The least and largest t.
    fn stretch(&self, resolved: &Resolved, origin: DVec3, direction: DVec3) -> Result<(f64, f64), PlotError> {
        let bounds = resolved.scene.bounds();
        let size = bounds.longest_side();
        let (start, end) = match self.span {
            Some((start, end)) if start < end && (end - start).is_finite() => (start, end),
            Some((start, end)) => return Err(PlotError::Span(start, end)),
            None => {
                let span = bounds.ray_span(origin, direction).ok_or(PlotError::Misses)?;
                (span.enter - 0.05 * size, span.exit + 0.05 * size)
            }
        };
        match [start, end].into_iter().find(|t| t.abs() > FARTHEST * size) {
            Some(t) => Err(PlotError::Far { t, size }),
            None => Ok((start, end)),
        }
    }

    /// The chosen spans with what the field is over them.
    fn spans(&self, tape: &Tape, ray: &Ray, settings: &Settings) -> Vec<PlottedSpan> {
        let method = match self.spans {
            SpanChoice::Uniform(count) => {
                let cut = |i: u32| {
                    let part = f64::from(i) / f64::from(count);
                    if i == count { ray.end } else { ray.start + (ray.end - ray.start) * part }
                };
                return examined(tape, ray, (0..count).map(|i| (cut(i), cut(i + 1), None)));
            }
            SpanChoice::Affine => Method::Affine,
            SpanChoice::Interval => Method::Interval { accept_epsilon: None },
        };
        let (_, visits) = visited_spans(tape, *ray, &Settings { method, ..*settings });
        let told = visits.into_iter().take(MOST_SPANS).map(|visit| {
            let verdict = visit.left.map_or(Verdict::Excluded, |(a, b)| Verdict::Left(a, b));
            (visit.start, visit.end, Some(verdict))
        });
        examined(tape, ray, told)
    }
}

/// What the plot is called: the text of a formula, or the name of the object.
fn title(loaded: &Loaded) -> String {
    const LONGEST: usize = 90;
    let text: Vec<&str> = loaded.source.text.split_whitespace().collect();
    let text = text.join(" ");
    if loaded.model.name == "formula" && text.chars().count() <= LONGEST {
        return text;
    }
    let file = std::path::Path::new(&loaded.source.name).file_name();
    let file = file.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let name = &loaded.model.name;
    match name.as_str() {
        // That is what texts without a name are called.
        "formula" | "program" => file,
        _ => format!("{name}, {file}"),
    }
}

/// The graph.
fn samples(tape: &Tape, ray: &Ray) -> Vec<(f64, f64)> {
    let last = (SAMPLES - 1) as f64;
    let at = |i: usize| ray.start + (ray.end - ray.start) * (i as f64 / last);
    let places: Vec<f64> = (0..SAMPLES).map(at).collect();
    let mut workspace: Workspace<F64, Points> = Workspace::new();
    let mut samples = Vec::with_capacity(SAMPLES);
    for some in places.chunks(LANES) {
        for (lane, &t) in some.iter().enumerate() {
            for (axis, x) in ray.at(t).into_iter().enumerate() {
                workspace.input(axis, 0)[lane] = x;
            }
        }
        workspace.run(tape, some.len());
        samples.extend(some.iter().copied().zip(workspace.output(0, 0).iter().copied()));
    }
    samples
}

/// What the field is over spans; where there is no verdict yet, the mixed range gives one.
fn examined(
    tape: &Tape,
    ray: &Ray,
    spans: impl Iterator<Item = (f64, f64, Option<Verdict>)>,
) -> Vec<PlottedSpan> {
    let mut intervals: Workspace<F64, Intervals> = Workspace::new();
    let mut affines: Workspace<F64, Affines> = Workspace::new();
    let mut all = Vec::new();
    for (start, end, told) in spans {
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let (centre, slope) = (o + d * (0.5 * (start + end)), d * (0.5 * (end - start)));
            let error = 4.0 * f64::EPSILON * (o.abs() + d.abs() * start.abs().max(end.abs()));
            let reach = slope.abs() + error;
            let form = [centre, slope, error, centre - reach, centre + reach];
            for (component, part) in form.into_iter().enumerate() {
                affines.input(axis, component)[0] = part;
            }
            intervals.input(axis, 0)[0] = centre - reach;
            intervals.input(axis, 1)[0] = centre + reach;
        }
        intervals.run(tape, 1);
        affines.run(tape, 1);
        let part = |component| affines.output(0, component)[0];
        let interval = (intervals.output(0, 0)[0], intervals.output(0, 1)[0]);
        let affine =
            AffineForm { centre: part(0), slope: part(1), error: part(2), range: (part(3), part(4)) };
        let (lo, hi) = affine.range;
        let verdict = match told {
            Some(Verdict::Excluded) => Verdict::Excluded,
            _ if lo.is_nan() || hi.is_nan() => Verdict::Undefined,
            Some(told) => told,
            None if lo > 0.0 || hi < 0.0 => Verdict::Excluded,
            None => Verdict::Left(start, end),
        };
        all.push(PlottedSpan { start, end, interval, affine, verdict });
    }
    all
}

/// All changes of sign, found one behind the other.
fn roots(tape: &Tape, ray: Ray, settings: &Settings) -> Vec<Root> {
    let (mut tracer, mut roots, mut rest) = (Tracer::new(), Vec::new(), ray);
    while roots.len() < MOST_ROOTS {
        let Some(outcome) = tracer.first_hits(tape, &[rest], settings).pop() else { break };
        let Some(hit) = outcome.hit else { break };
        let (t, certificate) = (hit.t, outcome.certificate);
        roots.push(Root { t, entering: hit.entering, jump: hit.jump, certificate });
        // Behind the bracket, where the sign has changed for good.
        let next = hit.after.max(hit.t) + settings.tolerance * settings.size;
        if next >= ray.end || next <= rest.start {
            break;
        }
        rest.start = next;
    }
    roots
}

fn first_hits(tape: &Tape, ray: Ray, settings: &Settings) -> [FirstHit; 3] {
    let methods = [
        ("affine", Method::Affine),
        ("interval", Method::Interval { accept_epsilon: None }),
        ("sampled", Method::Sampled { step: SAMPLED_STEP * settings.size }),
    ];
    methods.map(|(name, method)| {
        let settings = Settings { method, ..*settings };
        let outcome: Outcome = match method {
            // Alone, without the boxes around a bundle, so that the cost is that of the spans shown.
            Method::Affine | Method::Interval { .. } => visited_spans(tape, ray, &settings).0,
            Method::Sampled { .. } => match Tracer::new().first_hits(tape, &[ray], &settings).pop() {
                Some(outcome) => outcome,
                None => visited_spans(tape, ray, &settings).0,
            },
        };
        let Outcome { hit, certificate, cost, .. } = outcome;
        FirstHit { method: name, t: hit.map(|hit| hit.t), certificate, cost }
    })
}

#[cfg(test)]
mod tests;
