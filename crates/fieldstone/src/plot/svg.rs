//! Writing SVG: the few shapes that plots are made of.

use std::fmt::Write as _;

/// A picture in the making.
#[derive(Debug, Default)]
pub(super) struct Svg {
    body: String,
}

/// How a shape is painted, as SVG attributes.
pub(super) type Style<'s> = &'s str;

impl Svg {
    /// The whole picture.
    pub(super) fn finish(self, width: f64, height: f64) -> String {
        let body = self.body;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"13\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
        )
    }

    fn shape(&mut self, name: &str, attributes: &str, style: Style<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "<{name} {attributes} {style}/>");
    }

    /// Opens a group with attributes; [`close`](Self::close) ends it.
    pub(super) fn open(&mut self, attributes: &str) {
        let _ = writeln!(self.body, "<g {attributes}>");
    }

    pub(super) fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// A rectangle outside of which a group with `clip-path="url(#name)"` is not seen.
    pub(super) fn clip(&mut self, name: &str, [x, y, width, height]: [f64; 4]) {
        let _ = writeln!(
            self.body,
            "<clipPath id=\"{name}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>"
        );
    }

    /// A rectangle by two opposite corners.
    pub(super) fn rectangle(&mut self, a: (f64, f64), b: (f64, f64), style: Style<'_>) {
        let (x, y) = (a.0.min(b.0), a.1.min(b.1));
        let (width, height) = ((a.0 - b.0).abs(), (a.1 - b.1).abs());
        let attributes = format!("x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"");
        self.shape("rect", &attributes, style);
    }

    pub(super) fn line(&mut self, a: (f64, f64), b: (f64, f64), style: Style<'_>) {
        let attributes = format!("x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\"", a.0, a.1, b.0, b.1);
        self.shape("line", &attributes, style);
    }

    pub(super) fn polygon(&mut self, points: &[(f64, f64)], style: Style<'_>) {
        self.points("polygon", points, style);
    }

    pub(super) fn polyline(&mut self, points: &[(f64, f64)], style: Style<'_>) {
        self.points("polyline", points, style);
    }

    fn points(&mut self, name: &str, points: &[(f64, f64)], style: Style<'_>) {
        let list: Vec<String> = points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
        self.shape(name, &format!("points=\"{}\"", list.join(" ")), style);
    }

    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: f64, style: Style<'_>) {
        self.shape("circle", &format!("cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\""), style);
    }

    /// A line of text; `style` may say `text-anchor`.
    pub(super) fn text(&mut self, (x, y): (f64, f64), text: &str, style: Style<'_>) {
        let _ = writeln!(self.body, "<text x=\"{x:.2}\" y=\"{y:.2}\" {style}>{}</text>", escaped(text));
    }
}

/// A text without what XML reads as markup, or does not allow at all.
fn escaped(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '&' => all.push_str("&amp;"),
            '"' => all.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => all.push('\u{fffd}'),
            c => all.push(c),
        }
    }
    all
}
