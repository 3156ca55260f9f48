//! How cost grows with operations, pixels and instances.

use crate::contest::Contestant;
use crate::error::BenchError;
use crate::models::MODELS;
use crate::ours::Frames;
use crate::plan::Plan;
use crate::program::{Program, Value};
use crate::report::{GrowthRow, Report};
use crate::timing::Spread;
use crate::view::Lens;
use crate::worker::{self, Work};
use fieldstone::glam::{DAffine3, DQuat, DVec3};
use fieldstone::{
    Bindings, Bounds, Camera, Instance, Lighting, Projection, Scene, Settings, Solid, Stats, Viewer, formula,
};
use std::time::Instant;

/// What grows, and how far.
pub(crate) const CURVES: [(&str, &[u64]); 3] = [
    ("operations", &[10, 100, 1_000, 10_000, 100_000]),
    ("pixels", &[128 * 128, 256 * 256, 512 * 512, 1024 * 1024, 2048 * 2048, 4096 * 4096]),
    ("instances", &[100, 1_000, 10_000, 100_000]),
];

/// Pixels along each side where something else grows.
const SIZE: u32 = 512;
/// Frames of a point, of which the median counts.
const FRAMES: u32 = 3;

/// Measures the curves, each point in a process of its own.
///
/// # Errors
/// A point that could not be measured.
pub(crate) fn measure(
    plan: &Plan,
    report: &mut Report,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let Some(worker) = &plan.worker else {
        report.skipped.push("growth: no program is known that does jobs".to_owned());
        return Ok(());
    };
    for (what, counts) in CURVES.iter().filter(|(what, _)| plan.wants(what)) {
        for count in *counts {
            let job = format!("growth:{what}:{count}");
            progress(&job);
            if let (Work::Growth(row), _) = worker::run(worker::command(worker, None, &job), &job)? {
                report.growth.push(row);
            }
        }
    }
    Ok(())
}

/// Measures a point of a curve in this process, on one thread for each core.
pub(crate) fn point(what: &str, count: u64) -> Result<GrowthRow, BenchError> {
    let start = Instant::now();
    let (setup_seconds, frames, size, drawn) = match what {
        "operations" => {
            let prepared = worker::read(&balls(count)?)?;
            let mut frames = Frames::new(&prepared, Lens::Perspective, SIZE, 0)?;
            let setup = start.elapsed().as_secs_f64();
            let seconds = draw(&mut frames)?;
            let operations = prepared.scene().solids()[0].field().operation_count();
            (setup, (seconds, frames.stats()), SIZE, operations as u64)
        }
        "pixels" => {
            let Some(model) = MODELS.iter().find(|model| model.name == "building") else {
                return unknown(what);
            };
            let prepared = worker::read(&model.text())?;
            let size = (count as f64).sqrt().round().clamp(1.0, 8192.0) as u32;
            let mut frames = Frames::new(&prepared, Lens::Perspective, size, 0)?;
            let setup = start.elapsed().as_secs_f64();
            (setup, (draw(&mut frames)?, frames.stats()), size, count)
        }
        "instances" => {
            let scene = tori(count as usize).map_err(|e| BenchError::model(what, e))?;
            let viewer = Viewer::new(&scene);
            let setup = start.elapsed().as_secs_f64();
            (setup, look(&viewer, scene.camera()), SIZE, count)
        }
        _ => return unknown(what),
    };
    let (seconds, stats) = frames;
    let pixels = u64::from(size) * u64::from(size);
    Ok(GrowthRow {
        what: what.to_owned(),
        count: drawn,
        pixels,
        setup_seconds,
        seconds,
        evaluations_per_pixel: stats.evaluations as f64 / pixels as f64,
        peak_mib: peak_mib(),
    })
}

fn unknown<T>(what: &str) -> Result<T, BenchError> {
    let known = CURVES.map(|(name, _)| name).join(", ");
    Err(BenchError::Unknown { kind: "curve", name: what.to_owned(), known })
}

fn draw(frames: &mut Frames<'_>) -> Result<f64, BenchError> {
    let mut seconds = Vec::new();
    for frame in 0..FRAMES {
        let start = Instant::now();
        frames.draw(frame)?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    Ok(Spread::of(seconds).median)
}

fn look(viewer: &Viewer<'_>, camera: &Camera) -> (f64, Stats) {
    let looks: Vec<(f64, Stats)> = (0..FRAMES)
        .map(|_| {
            let start = Instant::now();
            let sight = viewer.look(camera, (SIZE, SIZE));
            (start.elapsed().as_secs_f64(), sight.stats)
        })
        .collect();
    (Spread::of(looks.iter().map(|look| look.0).collect()).median, looks[0].1)
}

/// Numbers between 0 and 1, evenly and without a pattern (Knuth's generator of 64 bits).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn place(&mut self) -> [f64; 3] {
        [0; 3].map(|_| 2.0 * self.next() - 1.0)
    }
}

/// A union of balls of about so many operations, thrown about by chance in a cube of side 2; they fill a tenth of it,
/// however many they are. The tree of unions halves space.
fn balls(operations: u64) -> Result<String, BenchError> {
    // Nine operations for each, and one that joins it.
    let count = (operations / 10).max(1) as usize;
    let radius = (0.8 / count as f64 / 4.19).cbrt();
    let mut chance = Chance(5);
    let mut places: Vec<[f64; 3]> = (0..count).map(|_| chance.place()).collect();
    let program = Program::new();
    let value = halves(&program, &mut places, 0, radius);
    value.map(|value| program.text(value)).ok_or_else(|| BenchError::model("balls", "there is none"))
}

fn halves<'p>(program: &'p Program, places: &mut [[f64; 3]], axis: usize, radius: f64) -> Option<Value<'p>> {
    if let [centre] = places {
        let [x, y, z] = program.point();
        let squares = (x - centre[0]).square() + (y - centre[1]).square() + (z - centre[2]).square();
        return Some(squares.sqrt() - radius);
    }
    places.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let (low, high) = places.split_at_mut(places.len() / 2);
    let next = (axis + 1) % 3;
    Some(halves(program, low, next, radius)?.min(halves(program, high, next, radius)?))
}

/// Tori in a cube of side 10 that fill a twentieth of it.
fn tori(count: usize) -> Result<Scene, Box<dyn std::error::Error>> {
    let mut chance = Chance(11);
    let radius = (50.0 / count.max(1) as f64 / 2.5).cbrt();
    let mut one = || {
        let place = 5.0 * DVec3::from(chance.place());
        let axis = DVec3::from(chance.place()).normalize_or(DVec3::X);
        let turn = DQuat::from_axis_angle(axis, 6.0 * chance.next());
        Instance::new(0, DAffine3::from_scale_rotation_translation(DVec3::splat(radius), turn, place))
    };
    let instances = (0..count).filter_map(|_| one()).collect();
    let model = formula("(1-sqrt(x^2+y^2))^2+z^2-.125")?.model;
    let half = DVec3::new(1.36, 1.36, 0.36);
    let solid = Solid::new(model.field, Bindings::new(), Bounds::new(-half, half)?);
    let projection = Projection::Perspective { vertical_fov_radians: 0.7 };
    let camera = Camera::look_at(DVec3::new(8.0, -16.0, 7.0), DVec3::ZERO, DVec3::Z, projection)?;
    let lighting = Lighting::default();
    Ok(Scene::with_instances(vec![solid], instances, camera, lighting, Settings::default())?)
}

/// The most memory that this process has had, where the system says.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_operations_as_asked_for() {
        for wanted in [100, 1000, 5000] {
            let prepared = worker::read(&balls(wanted).unwrap()).unwrap();
            let count = prepared.scene().solids()[0].field().operation_count() as f64;
            assert!((0.8..1.2).contains(&(count / wanted as f64)), "{wanted}: {count}");
        }
    }

    #[test]
    fn there_are_as_many_instances() {
        assert_eq!(tori(250).unwrap().instances().len(), 250);
    }

    #[test]
    fn unknown_curves_are_errors() {
        let error = point("colours", 5).unwrap_err().to_string();
        assert_eq!(error, "there is no curve `colours`; there are operations, pixels, instances");
    }
}
