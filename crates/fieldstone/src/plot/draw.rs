//! The picture of a plot.
//!
//! From top to bottom: the title, the graph with a box for each span, a strip that says what became of every t, the
//! axis of t, what each method found, and the legend.

use super::scale::{Scale, Spread, label, nice_ticks};
use super::svg::Svg;
use super::{FirstHit, PlottedSpan, RayPlot, SpanChoice, Verdict};
use fieldstone_trace::Certificate;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

const WIDTH: f64 = 1040.0;
const HEIGHT: f64 = 696.0;
/// The frame of the graph.
const LEFT: f64 = 92.0;
const RIGHT: f64 = WIDTH - 24.0;
const TOP: f64 = 64.0;
const BOTTOM: f64 = 470.0;
/// The strip under it.
const STRIP: (f64, f64) = (BOTTOM + 5.0, BOTTOM + 19.0);

const EXCLUDED: &str = "#2e8b57";
const REMAINS: &str = "#e8851a";
const UNDEFINED: &str = "#8a8a8a";
const AFFINE: &str = "#7b3294";
const GRAPH: &str = "#123a6b";

/// How many changes of sign are named in words.
const NAMED_ROOTS: usize = 5;

/// Why a picture cannot be made of pixels.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the plot cannot be drawn as pixels: {0}")]
pub struct PictureError(String);

impl RayPlot {
    /// The plot as an SVG text.
    pub fn to_svg(&self) -> String {
        let scale = Scale::of(self.samples.iter().map(|s| s.1));
        let mut picture = Picture { plot: self, scale, svg: Svg::default() };
        picture.title();
        picture.axes();
        picture.svg.clip("frame", [LEFT, TOP, RIGHT - LEFT, BOTTOM - TOP]);
        picture.svg.open("clip-path=\"url(#frame)\"");
        picture.boxes();
        picture.zero();
        picture.graph();
        picture.svg.close();
        picture.strip();
        picture.roots();
        picture.words();
        picture.legend();
        picture.svg.finish(WIDTH, HEIGHT)
    }

    /// The plot as a PNG file, `scale` pixels for each unit of the SVG.
    ///
    /// Its letters are DejaVu Sans, which the program carries along: no font of the system is needed.
    ///
    /// # Errors
    /// A scale at which there are no pixels, or too many.
    pub fn to_png(&self, scale: f32) -> Result<Vec<u8>, PictureError> {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
        let tree = usvg::Tree::from_str(&self.to_svg(), &options).map_err(|e| PictureError(e.to_string()))?;
        let pixels = |length: f64| (length as f32 * scale).round().clamp(0.0, 1e5) as u32;
        let no_room = || PictureError(format!("there are no such pictures at scale {scale}"));
        let (width, height) = (pixels(WIDTH), pixels(HEIGHT));
        let fits = u64::from(width) * u64::from(height) <= 64 << 20;
        let pixmap = fits.then(|| tiny_skia::Pixmap::new(width, height)).flatten();
        let mut pixmap = pixmap.ok_or_else(no_room)?;
        resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
        pixmap.encode_png().map_err(|e| PictureError(e.to_string()))
    }
}

/// A picture in the making.
struct Picture<'p> {
    plot: &'p RayPlot,
    scale: Scale,
    svg: Svg,
}

impl Picture<'_> {
    fn x(&self, t: f64) -> f64 {
        let part = (t - self.plot.start) / (self.plot.end - self.plot.start);
        LEFT + (RIGHT - LEFT) * part.clamp(0.0, 1.0)
    }

    fn y(&self, value: f64) -> f64 {
        BOTTOM - (BOTTOM - TOP) * self.scale.fraction(value)
    }

    fn title(&mut self) {
        self.svg.text((LEFT, 26.0), &self.plot.title, "font-size=\"16\"");
        let [ox, oy, oz] = self.plot.origin.map(short);
        let [dx, dy, dz] = self.plot.direction.map(short);
        let spans = match self.plot.choice {
            SpanChoice::Uniform(count) => format!("{count} equal spans"),
            SpanChoice::Affine => "spans of the affine march".to_owned(),
            SpanChoice::Interval => "spans of the dichotomy with intervals".to_owned(),
        };
        let ray = format!("f along ({ox}, {oy}, {oz}) + t ({dx}, {dy}, {dz}), negative inside; {spans}");
        self.svg.text((LEFT, 48.0), &ray, "fill=\"#444444\"");
    }

    fn axes(&mut self) {
        let grid = "stroke=\"#e6e6e6\" stroke-width=\"1\"";
        let ticks = nice_ticks(self.plot.start, self.plot.end, 10);
        let step = if ticks.len() > 1 { ticks[1] - ticks[0] } else { 1.0 };
        for &t in &ticks {
            let x = self.x(t);
            self.svg.line((x, TOP), (x, BOTTOM), grid);
            self.svg.line((x, STRIP.1), (x, STRIP.1 + 5.0), "stroke=\"#444444\"");
            self.svg.text((x, STRIP.1 + 20.0), &label(t, step), "text-anchor=\"middle\"");
        }
        let ticks = self.scale.ticks();
        for (i, &value) in ticks.iter().enumerate() {
            let y = self.y(value);
            // Beside 0 there is no room for what is close to it.
            let is_free = value == 0.0 || (y - self.y(0.0)).abs() > 14.0;
            if !(TOP..=BOTTOM).contains(&y) || !is_free {
                continue;
            }
            let next = ticks.get(i + 1).or(ticks.get(i.wrapping_sub(1))).copied().unwrap_or(value + 1.0);
            let step = match self.scale.spread {
                Spread::Linear => next - value,
                Spread::Symmetric(_) => value,
            };
            self.svg.line((LEFT, y), (RIGHT, y), grid);
            self.svg.text((LEFT - 8.0, y + 4.5), &label(value, step), "text-anchor=\"end\"");
        }
        self.svg.rectangle((LEFT, TOP), (RIGHT, BOTTOM), "fill=\"none\" stroke=\"#444444\"");
        let t = (0.5 * (LEFT + RIGHT), STRIP.1 + 40.0);
        self.svg.text(t, "t (model units)", "text-anchor=\"middle\" fill=\"#444444\"");
        let middle = 0.5 * (TOP + BOTTOM);
        let turned = format!("text-anchor=\"middle\" fill=\"#444444\" transform=\"rotate(-90 20 {middle})\"");
        let name = match self.scale.spread {
            Spread::Linear => "f".to_owned(),
            Spread::Symmetric(unit) => format!("f (logarithmic beyond ±{})", label(unit, unit)),
        };
        self.svg.text((20.0, middle), &name, &turned);
    }

    fn zero(&mut self) {
        let y = self.y(0.0);
        self.svg.line((LEFT, y), (RIGHT, y), "stroke=\"#222222\" stroke-width=\"1.2\"");
    }

    /// The boxes and parallelograms of all spans, the longest at the bottom.
    fn boxes(&mut self) {
        let mut spans: Vec<&PlottedSpan> = self.plot.spans.iter().collect();
        spans.sort_by(|a, b| (b.end - b.start).total_cmp(&(a.end - a.start)));
        for span in &spans {
            self.interval_box(span);
        }
        for span in spans {
            self.affine_form(span);
        }
    }

    fn interval_box(&mut self, span: &PlottedSpan) {
        let (from, to) = (self.x(span.start), self.x(span.end));
        let ((lo, hi), colour) = match span.verdict {
            Verdict::Undefined => ((f64::NEG_INFINITY, f64::INFINITY), UNDEFINED),
            Verdict::Excluded => (span.interval, EXCLUDED),
            Verdict::Left(..) => (span.interval, REMAINS),
        };
        // An interval may be undefined where the affine form is not.
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi };
        // A span that was divided holds others: only its outline.
        let opacity = if self.is_divided(span) { 0.0 } else { 0.13 };
        let style = format!(
            "fill=\"{colour}\" fill-opacity=\"{opacity}\" stroke=\"{colour}\" stroke-opacity=\"0.75\" \
             stroke-width=\"0.9\""
        );
        self.svg.rectangle((from, self.y(lo)), (to, self.y(hi)), &style);
    }

    /// Whether spans of a march lie on top of this one.
    fn is_divided(&self, span: &PlottedSpan) -> bool {
        !matches!(self.plot.choice, SpanChoice::Uniform(_)) && span.verdict != Verdict::Excluded
    }

    fn affine_form(&mut self, span: &PlottedSpan) {
        let form = span.affine;
        let (lo, hi) = form.range;
        let (from, to) = (self.x(span.start), self.x(span.end));
        if lo.is_finite() && hi.is_finite() {
            let style = format!(
                "fill=\"none\" stroke=\"{AFFINE}\" stroke-width=\"0.8\" stroke-dasharray=\"3 3\" \
                 stroke-opacity=\"0.7\""
            );
            self.svg.rectangle((from, self.y(lo)), (to, self.y(hi)), &style);
        }
        // A form without a slope says what the range says.
        let says_more = form.slope != 0.0 && form.slope.is_finite();
        if !(says_more && form.centre.is_finite() && form.error.is_finite()) {
            return;
        }
        // A straight line is curved on a logarithmic axis.
        let parts = if self.scale.spread == Spread::Linear { 1 } else { 24 };
        let along = |i: usize| 2.0 * i as f64 / parts as f64 - 1.0;
        let edge = |error: f64, i: usize| {
            let place = from + (to - from) * i as f64 / parts as f64;
            (place, self.y(form.centre + form.slope * along(i) + error))
        };
        let upper = (0..=parts).map(|i| edge(form.error, i));
        let lower = (0..=parts).rev().map(|i| edge(-form.error, i));
        let points: Vec<(f64, f64)> = upper.chain(lower).collect();
        let opacity = if self.is_divided(span) { 0.0 } else { 0.1 };
        let style =
            format!("fill=\"{AFFINE}\" fill-opacity=\"{opacity}\" stroke=\"{AFFINE}\" stroke-width=\"1.1\"");
        self.svg.polygon(&points, &style);
    }

    /// The graph, with gaps where it is undefined, and where it jumps out of the frame and back on the other side.
    fn graph(&mut self) {
        let style = format!("fill=\"none\" stroke=\"{GRAPH}\" stroke-width=\"2\" stroke-linejoin=\"round\"");
        let mut piece: Vec<(f64, f64)> = Vec::new();
        let mut before = f64::NAN;
        for &(t, value) in &self.plot.samples {
            let (p, q) = (self.scale.fraction(before), self.scale.fraction(value));
            let jumps = (p - q).abs() > 0.55 && (before < 0.0) != (value < 0.0);
            if value.is_nan() || jumps {
                self.graph_piece(&piece, &style);
                piece.clear();
            }
            if !value.is_nan() {
                piece.push((self.x(t), self.y(value)));
            }
            before = value;
        }
        self.graph_piece(&piece, &style);
    }

    fn graph_piece(&mut self, piece: &[(f64, f64)], style: &str) {
        match piece {
            [] => {}
            [point] => self.svg.circle(*point, 1.0, &format!("fill=\"{GRAPH}\"")),
            _ => self.svg.polyline(piece, style),
        }
    }

    /// What became of every t: the last word of all spans that held it.
    fn strip(&mut self) {
        self.svg.rectangle((LEFT, STRIP.0), (RIGHT, STRIP.1), "fill=\"#f4f4f4\" stroke=\"#bbbbbb\"");
        let spans = self.plot.spans.clone();
        for span in &spans {
            match span.verdict {
                Verdict::Excluded => self.stretch(span.start, span.end, EXCLUDED),
                Verdict::Undefined => self.stretch(span.start, span.end, UNDEFINED),
                Verdict::Left(a, b) => {
                    self.stretch(span.start, a, EXCLUDED);
                    self.stretch(b, span.end, EXCLUDED);
                    self.stretch(a, b, REMAINS);
                }
            }
        }
        // What was passed over at a tolerance is shorter than a pixel.
        for span in &spans {
            if let Verdict::Left(a, b) = span.verdict
                && self.x(b) - self.x(a) < 1.0
            {
                let pixel = (self.plot.end - self.plot.start) / (RIGHT - LEFT);
                self.stretch(0.5 * (a + b) - pixel, 0.5 * (a + b) + pixel, REMAINS);
            }
        }
        // A march ends with the first hit, however much it had looked at before.
        let found = match self.plot.choice {
            SpanChoice::Uniform(_) => None,
            SpanChoice::Affine => self.plot.first_hits[0].t,
            SpanChoice::Interval => self.plot.first_hits[1].t,
        };
        if let Some(t) = found {
            self.stretch(t, self.plot.end, "#f4f4f4");
        }
    }

    fn stretch(&mut self, from: f64, to: f64, colour: &str) {
        if from < to {
            let corners = ((self.x(from), STRIP.0 + 1.0), (self.x(to), STRIP.1 - 1.0));
            self.svg.rectangle(corners.0, corners.1, &format!("fill=\"{colour}\""));
        }
    }

    fn roots(&mut self) {
        let y = self.y(0.0);
        for root in &self.plot.roots {
            let x = self.x(root.t);
            let style =
                format!("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.2\"", colour(root.certificate));
            if root.jump {
                let diamond = [(x - 6.0, y), (x, y - 6.0), (x + 6.0, y), (x, y + 6.0)];
                self.svg.polygon(&diamond, &style);
            } else {
                self.svg.circle((x, y), 5.0, &style);
            }
        }
        if let Some(t) = self.plot.first_hits[0].t {
            let x = self.x(t);
            let style = "stroke=\"#222222\" stroke-width=\"1\" stroke-dasharray=\"5 4\"";
            self.svg.line((x, TOP), (x, STRIP.1), style);
        }
    }

    /// What the methods found.
    fn words(&mut self) {
        let y = STRIP.1 + 66.0;
        let hits = self.plot.first_hits;
        for (row, hit) in hits.iter().enumerate() {
            let y = y + 18.0 * row as f64;
            self.svg.text((LEFT, y), &format!("first hit, {}:", hit.method), "");
            self.svg.text((LEFT + 140.0, y), &in_words(hit, 1e-7 * (self.plot.end - self.plot.start)), "");
        }
        let roots = &self.plot.roots;
        let name = |t: f64| place(t, 1e-5 * (self.plot.end - self.plot.start));
        let named: Vec<String> = roots.iter().take(NAMED_ROOTS).map(|root| name(root.t)).collect();
        let more = match roots.len().saturating_sub(NAMED_ROOTS) {
            0 => String::new(),
            count => format!(", and {count} more"),
        };
        let text = match roots.len() {
            0 => "The sign does not change.".to_owned(),
            _ => format!("The sign changes at t = {}{more}.", named.join(", ")),
        };
        self.svg.text((LEFT, y + 58.0), &text, "");
    }

    fn legend(&mut self) {
        let filled = |colour: &str| format!("fill=\"{colour}\" fill-opacity=\"0.3\" stroke=\"{colour}\"");
        let outline = format!("fill=\"none\" stroke=\"{AFFINE}\" stroke-dasharray=\"3 3\"");
        let boxes = [
            (filled(EXCLUDED), "interval, root excluded"),
            (filled(REMAINS), "interval, root possible"),
            (filled(UNDEFINED), "undefined"),
            (filled(AFFINE), "affine form"),
            (outline, "mixed range"),
        ];
        let (mut x, y) = (LEFT, HEIGHT - 40.0);
        for (style, text) in boxes {
            self.svg.rectangle((x, y - 11.0), (x + 20.0, y + 1.0), &style);
            self.svg.text((x + 27.0, y), text, "");
            x += 54.0 + 7.3 * text.len() as f64;
        }
        let dots = [
            (Certificate::Certified, "root, certified"),
            (Certificate::Tolerance, "root, to a tolerance"),
            (Certificate::Undecided, "root, undecided"),
        ];
        let (mut x, y) = (LEFT, HEIGHT - 16.0);
        for (certificate, text) in dots {
            let style = format!("fill=\"{}\"", colour(certificate));
            self.svg.circle((x + 10.0, y - 5.0), 5.0, &style);
            self.svg.text((x + 27.0, y), text, "");
            x += 54.0 + 7.3 * text.len() as f64;
        }
        let diamond = [(x + 4.0, y - 5.0), (x + 10.0, y - 11.0), (x + 16.0, y - 5.0), (x + 10.0, y + 1.0)];
        self.svg.polygon(&diamond, "fill=\"#777777\"");
        self.svg.text((x + 27.0, y), "jump or pole", "");
        x += 54.0 + 7.3 * 12.0;
        self.svg.line((x, y - 5.0), (x + 20.0, y - 5.0), &format!("stroke=\"{GRAPH}\" stroke-width=\"2\""));
        self.svg.text((x + 27.0, y), "f", "");
        x += 62.0;
        self.svg.rectangle((x, y - 11.0), (x + 20.0, y + 1.0), "fill=\"#f4f4f4\" stroke=\"#bbbbbb\"");
        self.svg.text((x + 27.0, y), "left open behind a hit", "");
    }
}

/// A coordinate with three digits behind the point, or fewer.
fn short(x: f64) -> String {
    let text = label(x, 1e-3);
    let has_tail = text.contains('.') && !text.contains('e');
    if has_tail { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn colour(certificate: Certificate) -> &'static str {
    match certificate {
        Certificate::Certified => "#1a7a43",
        Certificate::Tolerance => "#d9730d",
        Certificate::Undecided => "#c0202a",
    }
}

/// A place on the ray with the digits that its resolution allows.
fn place(t: f64, resolution: f64) -> String {
    if t.abs() < 0.5 * resolution { "0".to_owned() } else { label(t, resolution) }
}

fn in_words(hit: &FirstHit, resolution: f64) -> String {
    let place = hit.t.map_or("none".to_owned(), |t| format!("t = {}", place(t, resolution)));
    let certificate = match hit.certificate {
        Certificate::Certified => "certified",
        Certificate::Tolerance => "tolerance",
        Certificate::Undecided => "undecided",
    };
    format!("{place}, {certificate}, {} evaluations", hit.cost)
}
