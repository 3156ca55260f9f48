use super::*;
use crate::{Loaded, formula};

fn request(ray: [f64; 6], spans: SpanChoice) -> PlotRequest {
    let [ox, oy, oz, dx, dy, dz] = ray;
    let ray = RayChoice::Line { origin: DVec3::new(ox, oy, oz), direction: DVec3::new(dx, dy, dz) };
    PlotRequest { render: RenderRequest::default(), ray, span: None, spans }
}

fn along_x(text: &str, span: (f64, f64), spans: SpanChoice) -> RayPlot {
    let request = PlotRequest { span: Some(span), ..request([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], spans) };
    request.plot(&formula(text).unwrap()).unwrap()
}

const TANGLE: &str = "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8";

/// The samples that lie outside of what is said of their span.
fn outside(plot: &RayPlot) -> usize {
    let is_outside = |span: &PlottedSpan, (t, value): (f64, f64)| {
        let form = &span.affine;
        let place = (t - 0.5 * (span.start + span.end)) / (0.5 * (span.end - span.start));
        let line = form.centre + form.slope * place;
        let misses = |(lo, hi): (f64, f64)| value < lo || hi < value || (value.is_nan() && !lo.is_nan());
        // The place itself is rounded here.
        let slack = 1e-12 * (line.abs() + form.slope.abs());
        misses(span.interval) || misses(form.range) || (value - line).abs() > form.error + slack
    };
    let samples = |span: &PlottedSpan| {
        let (start, end) = (span.start, span.end);
        plot.samples.iter().copied().filter(move |(t, _)| start <= *t && *t <= end)
    };
    plot.spans.iter().map(|span| samples(span).filter(|&sample| is_outside(span, sample)).count()).sum()
}

#[test]
fn every_sample_lies_in_its_bounds() {
    let texts = [
        TANGLE,
        "sin(20*x)",
        "1/(x - 0.123)",
        "sqrt(x) - 1",
        "(x - 1)^2",
        "max(x - 1, 0.5 - x) + y",
        "exp(5*x)",
    ];
    for text in texts {
        for spans in [SpanChoice::Uniform(13), SpanChoice::Affine, SpanChoice::Interval] {
            let plot = along_x(text, (-2.3, 2.6), spans);
            assert!(!plot.spans.is_empty() && plot.samples.len() == SAMPLES);
            assert_eq!(outside(&plot), 0, "{text} {spans:?}");
        }
    }
}

#[test]
fn a_bound_that_is_wrong_is_seen() {
    let mut plot = along_x(TANGLE, (-2.3, 2.6), SpanChoice::Uniform(13));
    plot.spans[3].interval.1 -= 0.8 * (plot.spans[3].interval.1 - plot.spans[3].interval.0);
    assert!(outside(&plot) > 0);
    let mut plot = along_x(TANGLE, (-2.3, 2.6), SpanChoice::Uniform(13));
    plot.spans[3].affine.error *= 0.1;
    assert!(outside(&plot) > 0);
}

#[test]
fn roots_of_a_sphere() {
    let ball = formula("x^2 + y^2 + z^2 - 1").unwrap();
    // A direction that is no unit vector: t is a length all the same.
    let plot = request([-3.0, 0.6, 0.0, 2.0, 0.0, 0.0], SpanChoice::Affine).plot(&ball).unwrap();
    let [first, second] = plot.roots.as_slice() else { panic!("two roots: {:?}", plot.roots) };
    assert!((first.t - 2.2).abs() < 1e-8 && (second.t - 3.8).abs() < 1e-8, "{:?}", plot.roots);
    assert!(first.entering && !second.entering && !first.jump);
    assert_eq!((first.certificate, second.certificate), (Certificate::Certified, Certificate::Certified));
    for hit in &plot.first_hits {
        assert!((hit.t.unwrap() - 2.2).abs() < 1e-6, "{hit:?}");
        let proves = hit.method != "sampled";
        assert_eq!(hit.certificate == Certificate::Certified, proves, "{hit:?}");
    }
    assert!(plot.start < 2.2 && plot.end > 3.8 && plot.end - plot.start < 2.4);
}

#[test]
fn roots_of_the_tangle_cube() {
    // Along x through the origin: x⁴ − 5x² + 11.8 > 0; along the diagonal: 3(s⁴ − 5s²) + 11.8, t = s√3.
    assert_eq!(along_x(TANGLE, (-3.0, 3.0), SpanChoice::Affine).roots, []);
    let mut diagonal = request([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], SpanChoice::Interval);
    diagonal.span = Some((-4.5, 4.5));
    let plot = diagonal.plot(&formula(TANGLE).unwrap()).unwrap();
    let root = |sign: f64| (3.0 * (5.0 + sign * (25.0 - 4.0 * 11.8 / 3.0f64).sqrt()) / 2.0).sqrt();
    let expected = [-root(1.0), -root(-1.0), root(-1.0), root(1.0)];
    assert_eq!(plot.roots.len(), 4);
    assert!(plot.roots.iter().zip(expected).all(|(root, t)| (root.t - t).abs() < 1e-7), "{:?}", plot.roots);
}

#[test]
fn excluded_spans_hold_no_root() {
    let roots = |plot: &RayPlot, span: &PlottedSpan| {
        plot.roots.iter().filter(|root| span.start < root.t && root.t < span.end).count()
    };
    for text in ["sin(7*x)", "x^3 - x", "1 - x^2"] {
        let plot = along_x(text, (-2.0, 2.5), SpanChoice::Uniform(40));
        for span in &plot.spans {
            match span.verdict {
                Verdict::Excluded => assert_eq!(roots(&plot, span), 0, "{text} {span:?}"),
                Verdict::Left(a, b) => assert_eq!((a, b), (span.start, span.end)),
                Verdict::Undefined => panic!("{text} is defined"),
            }
        }
        assert!(plot.spans.iter().any(|span| span.verdict == Verdict::Excluded));
        assert!(plot.spans.iter().any(|span| roots(&plot, span) == 1));
    }
}

#[test]
fn poles_double_roots_and_gaps() {
    let pole = along_x("1/x", (-1.0, 1.3), SpanChoice::Affine);
    assert!(pole.roots.len() == 1 && pole.roots[0].jump, "{:?}", pole.roots);
    let double = along_x("(x - 0.5)^2", (-1.0, 1.3), SpanChoice::Affine);
    assert_eq!(double.roots, []);
    assert_eq!(double.first_hits[0].t, None);
    assert_ne!(double.first_hits[0].certificate, Certificate::Certified);
    let gap = along_x("sqrt(x) - 0.5", (-1.0, 1.3), SpanChoice::Uniform(10));
    assert!(gap.samples.iter().all(|(t, value)| value.is_nan() == (*t < 0.0)));
    assert_eq!(gap.spans[0].verdict, Verdict::Undefined);
    assert_eq!(gap.spans[9].verdict, Verdict::Excluded);
}

#[test]
fn a_pixel_and_its_ray() {
    let ball = formula("x^2 + y^2 + z^2 - 1").unwrap();
    let pixel = |x, y| {
        let ray = RayChoice::Pixel { x, y };
        let settings = fieldstone_scene::Settings { size: (512, 512), ..Default::default() };
        let render = RenderRequest { settings, ..RenderRequest::default() };
        PlotRequest { ray, render, ..request([0.0; 6], SpanChoice::Affine) }.plot(&ball)
    };
    let plot = pixel(256, 250).unwrap();
    let scene = RenderRequest::default().resolve(&ball.model).unwrap().scene;
    let (origin, direction) = scene.ray(256.5, 250.5);
    assert_eq!((plot.origin, plot.direction), (origin.to_array(), direction.to_array()));
    assert_eq!(plot.roots.len(), 2);
    assert!(matches!(pixel(512, 0), Err(PlotError::Pixel { x: 512, .. })));
}

#[test]
fn what_cannot_be_plotted() {
    let ball = formula("x^2 + y^2 + z^2 - 1").unwrap();
    let of = |request: PlotRequest| request.plot(&ball).map(|_| ());
    let good = || request([-3.0, 0.0, 0.0, 1.0, 0.0, 0.0], SpanChoice::Affine);
    assert!(matches!(of(request([0.0; 6], SpanChoice::Affine)), Err(PlotError::Ray { .. })));
    let nan = [f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0];
    assert!(matches!(of(request(nan, SpanChoice::Affine)), Err(PlotError::Ray { .. })));
    assert_eq!(of(request([-3.0, 9.0, 0.0, 1.0, 0.0, 0.0], SpanChoice::Affine)), Err(PlotError::Misses));
    assert_eq!(of(PlotRequest { span: Some((1.0, 1.0)), ..good() }), Err(PlotError::Span(1.0, 1.0)));
    let far = of(PlotRequest { span: Some((0.0, 1e20)), ..good() }).unwrap_err();
    assert!(far.to_string().starts_with("t = 1e20 is too far away: more than 1e9 times"), "{far}");
    let from_afar = of(request([-1e20, 0.0, 0.0, 1.0, 0.0, 0.0], SpanChoice::Affine));
    assert!(matches!(from_afar, Err(PlotError::Far { .. } | PlotError::Misses)), "{from_afar:?}");
    for count in [0, 5000] {
        assert_eq!(
            of(PlotRequest { spans: SpanChoice::Uniform(count), ..good() }),
            Err(PlotError::Spans(count))
        );
    }
}

/// Plots of all kinds, some of them with values that no frame can hold.
fn plots() -> Vec<RayPlot> {
    let texts = ["sin(20*x) & 1 < 2", "1/x", "sqrt(x)", "exp(300*x)", "0/0 + x", "x^500 - 1", "0*x", TANGLE];
    let models: Vec<Loaded> = texts.iter().filter_map(|text| formula(text).ok()).collect();
    assert!(models.len() >= 7);
    let choices = [SpanChoice::Uniform(7), SpanChoice::Affine, SpanChoice::Interval];
    let both = models.iter().flat_map(|model| choices.map(|choice| (model, choice)));
    both.map(|(model, choice)| {
        let mut request = request([0.0, 0.0, 0.0, 1.0, 0.1, 0.0], choice);
        request.span = Some((-2.0, 3.0));
        request.plot(model).unwrap()
    })
    .collect()
}

#[test]
fn the_svg_is_well_formed_and_has_finite_numbers_only() {
    for plot in plots() {
        let text = plot.to_svg();
        let document = roxmltree::Document::parse(&text).unwrap();
        let mut shapes = 0;
        for node in document.descendants() {
            shapes += usize::from(matches!(node.tag_name().name(), "rect" | "polyline" | "polygon"));
            for attribute in node.attributes() {
                let value = attribute.value();
                assert!(!value.contains("NaN") && !value.contains("inf"), "{}: {value}", plot.title);
            }
        }
        assert!(shapes > plot.spans.len(), "{}", plot.title);
        let words: Vec<&str> = document.descendants().filter_map(|n| n.text()).collect();
        assert!(words.contains(&plot.title.as_str()));
    }
}

#[test]
fn titles_are_text_not_markup() {
    let mut plot = along_x("x", (-1.0, 1.0), SpanChoice::Uniform(2));
    plot.title = "a < b & \"c\" > \u{1} d".to_owned();
    let text = plot.to_svg();
    let document = roxmltree::Document::parse(&text).unwrap();
    assert!(document.descendants().any(|n| n.text() == Some("a < b & \"c\" > \u{fffd} d")));
}

/// Without the fonts of any system: the title's letters leave ink.
#[test]
fn the_png_has_letters() {
    let plot = along_x("x - 0.25", (-1.0, 1.0), SpanChoice::Uniform(4));
    let png = plot.to_png(1.0).unwrap();
    let image = image::load_from_memory(&png).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (1040, 696));
    let ink = |y0: u32, y1: u32| (y0..y1).flat_map(|y| (92..200).map(move |x| (x, y)));
    let dark = |(x, y): (u32, u32)| image.get_pixel(x, y).0.iter().all(|&c| c < 100);
    assert!(ink(10, 30).filter(|&p| dark(p)).count() > 50);
    // Between the title and the next line there is none.
    assert_eq!(ink(0, 9).filter(|&p| dark(p)).count(), 0);
    assert!(plot.to_png(0.0).is_err() && plot.to_png(1e6).is_err() && plot.to_png(f32::NAN).is_err());
}
