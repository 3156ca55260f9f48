//! What is true of rays, by dense sampling in double precision with refined minima; and pictures against it.

#![allow(dead_code, reason = "each test uses a part of it")]

use fieldstone_field::{F64, Field, LANES, Points, Tape, TapeOptions, Workspace};
use fieldstone_scene::{Bounds, Camera, Film, Scene, Up, View};
use glam::DVec3;

pub(crate) const SIZE: u32 = 128;
/// How far a hit may lie from the truth, relative to the longest side of the bounds.
const DEPTH_TOLERANCE: f64 = 1e-4;
/// How many pixels may graze the surface so closely that the truth itself is in doubt.
pub(crate) const GRAZING_SHARE: f64 = 0.001;
/// How many pixels must be certified with `affine`.
const CERTIFIED_SHARE: f64 = 0.999;

/// What is true of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Truth {
    Hit(f64),
    Miss,
    /// The surface comes so close to being touched, before any hit, that values cannot tell.
    Grazing,
}

pub(crate) struct Reference {
    tape: Tape,
    workspace: Workspace<F64, Points>,
}

impl Reference {
    pub(crate) fn new(field: &Field) -> Self {
        Self { tape: Tape::new(field, &TapeOptions::default()), workspace: Workspace::new() }
    }

    pub(crate) fn values(&mut self, origin: DVec3, direction: DVec3, places: &[f64]) -> Vec<f64> {
        let mut values = Vec::with_capacity(places.len());
        for block in places.chunks(LANES) {
            for axis in 0..3 {
                for (to, t) in self.workspace.input(axis, 0).iter_mut().zip(block) {
                    *to = origin[axis] + direction[axis] * t;
                }
            }
            self.workspace.run(&self.tape, block.len());
            values.extend_from_slice(&self.workspace.output(0, 0)[..block.len()]);
        }
        values
    }

    pub(crate) fn truth(&mut self, origin: DVec3, direction: DVec3, bounds: &Bounds, step: f64) -> Truth {
        let Some(span) = bounds.ray_span(origin, direction) else { return Truth::Miss };
        let count = ((span.exit - span.enter) / step).ceil().max(2.0) as usize;
        let places: Vec<f64> =
            (0..=count).map(|i| span.enter + (span.exit - span.enter) * i as f64 / count as f64).collect();
        let values = self.values(origin, direction, &places);
        if values[0] < 0.0 {
            return Truth::Hit(span.enter);
        }
        for i in 1..=count {
            if values[i] < 0.0 {
                return Truth::Hit(self.bisect(origin, direction, places[i - 1], places[i]));
            }
            let lowest = i < count && values[i] <= values[i - 1] && values[i] <= values[i + 1];
            if lowest && values[i + 1] >= 0.0 {
                let (t, value) = self.minimum(origin, direction, places[i - 1], places[i + 1]);
                if value < 0.0 {
                    return Truth::Hit(self.bisect(origin, direction, places[i - 1], t));
                }
                // Far below what rounding leaves of so small a difference.
                if value <= 1e-9 * values[i - 1].min(values[i + 1]) {
                    return Truth::Grazing;
                }
            }
        }
        Truth::Miss
    }

    pub(crate) fn at(&mut self, origin: DVec3, direction: DVec3, t: f64) -> f64 {
        self.values(origin, direction, &[t])[0]
    }

    pub(crate) fn bisect(&mut self, origin: DVec3, direction: DVec3, outside: f64, inside: f64) -> f64 {
        let (mut a, mut b) = (outside, inside);
        for _ in 0..50 {
            let middle = 0.5 * (a + b);
            if self.at(origin, direction, middle) < 0.0 {
                b = middle;
            } else {
                a = middle;
            }
        }
        b
    }

    /// The least value between two places, by golden sections; stops where it is negative.
    pub(crate) fn minimum(&mut self, origin: DVec3, direction: DVec3, a: f64, b: f64) -> (f64, f64) {
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let (mut a, mut b) = (a, b);
        let mut best = (a, f64::INFINITY);
        for _ in 0..60 {
            let (p, q) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
            let pair = self.values(origin, direction, &[p, q]);
            for (t, value) in [(p, pair[0]), (q, pair[1])] {
                if value < best.1 {
                    best = (t, value);
                }
            }
            if best.1 < 0.0 {
                break;
            }
            if pair[0] < pair[1] {
                b = q;
            } else {
                a = p;
            }
        }
        best
    }
}

#[derive(Debug, Default)]
pub(crate) struct Report {
    pub(crate) missed: Vec<(u32, u32)>,
    pub(crate) false_hits: Vec<(u32, u32)>,
    pub(crate) displaced: Vec<(u32, u32, f64)>,
    pub(crate) grazing: Vec<(u32, u32)>,
    pub(crate) uncertified: Vec<(u32, u32)>,
    pub(crate) uncertified_off_silhouettes: Vec<(u32, u32)>,
    pub(crate) hits: usize,
}

impl Report {
    pub(crate) fn is_right(&self) -> bool {
        self.missed.is_empty()
            && self.false_hits.is_empty()
            && self.displaced.is_empty()
            && (self.grazing.len() as f64) <= GRAZING_SHARE * f64::from(SIZE * SIZE)
    }

    pub(crate) fn is_certified(&self) -> bool {
        let share = 1.0 - self.uncertified.len() as f64 / f64::from(SIZE * SIZE);
        share >= CERTIFIED_SHARE && self.uncertified_off_silhouettes.is_empty()
    }
}

pub(crate) fn compare(film: &Film, truths: &[Truth], size: f64) -> Report {
    let mut report = Report::default();
    for y in 0..SIZE {
        for x in 0..SIZE {
            let pixel = film.pixel(x, y).expect("the pixel is in the film");
            let depth = f64::from(pixel.depth);
            match (truths[(y * SIZE + x) as usize], depth.is_finite()) {
                (Truth::Grazing, _) => report.grazing.push((x, y)),
                (Truth::Hit(_), false) => report.missed.push((x, y)),
                (Truth::Miss, true) => report.false_hits.push((x, y)),
                (Truth::Hit(t), true) if (t - depth).abs() > DEPTH_TOLERANCE * size => {
                    report.displaced.push((x, y, depth - t));
                }
                _ => {}
            }
            report.hits += usize::from(depth.is_finite());
            if pixel.certificate != 1.0 {
                report.uncertified.push((x, y));
                if !near_silhouette(film, x, y, size) {
                    report.uncertified_off_silhouettes.push((x, y));
                }
            }
        }
    }
    report
}

/// Whether depth breaks off within 2 pixels.
pub(crate) fn near_silhouette(film: &Film, x: u32, y: u32, size: f64) -> bool {
    let range = |c: u32| c.saturating_sub(2)..=(c + 2).min(SIZE - 1);
    let depths: Vec<f64> = range(y)
        .flat_map(|v| range(x).map(move |u| (u, v)))
        .filter_map(|(u, v)| film.pixel(u, v).map(|p| f64::from(p.depth)))
        .collect();
    let (near, far) = depths.iter().fold((f64::INFINITY, 0.0f64), |(n, f), &d| (n.min(d), f.max(d)));
    far - near > 0.02 * size
}

pub(crate) fn views(bounds: &Bounds) -> Vec<(String, Camera)> {
    let directions =
        [DVec3::new(0.62, -1.0, 0.57), DVec3::new(-0.9, 0.31, 0.8), DVec3::new(0.11, 0.17, -1.0)];
    let radius = 0.5 * bounds.size().length();
    let mut views = Vec::new();
    for (i, direction) in directions.into_iter().enumerate() {
        for distance in [2.5 * radius, 1000.0] {
            let eye = bounds.centre() + distance * direction.normalize();
            let view = View { eye: Some(eye), ..View::default() };
            let camera = Camera::framing(bounds, &view, Up::Z, 1.0);
            views.push((format!("view {i} from {distance:.0}"), camera.expect("the view is sound")));
        }
    }
    views
}

pub(crate) fn truths(reference: &mut Reference, scene: &Scene, step: f64) -> Vec<Truth> {
    let bounds = scene.bounds();
    (0..SIZE * SIZE)
        .map(|i| {
            let (origin, direction) = scene.ray(f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
            reference.truth(origin, direction, &bounds, step)
        })
        .collect()
}
