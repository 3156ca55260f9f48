//! The models that are measured: our own, of the kinds that programs of this sort are shown with.
//!
//! They are programs (`.vm`), because that is what all peers but one read. The small ones stand in `gallery/bench`, written
//! by the example `models`; those of thousands of operations are written when they are needed.

mod building;
mod creature;
mod gear;
mod text;

use crate::program::{Program, Value};

/// A model that is measured.
#[derive(Clone, Copy, Debug)]
pub struct BenchModel {
    /// What it is called: `building`.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// Whether it is a shape of the plane z = 0, which depends on x and y alone.
    pub is_flat: bool,
    /// Whether its file stands in `gallery/bench`.
    pub is_kept: bool,
    write: fn(&Program) -> Option<Value<'_>>,
}

/// All models that are measured, the smaller ones first.
pub const MODELS: [BenchModel; 8] = [
    solid("tangle", "tangle cube, a polynomial", |p| Some(tangle(p))),
    solid("gyroid", "ball of a gyroid's shell, of sines and cosines", |p| Some(gyroid(p))),
    solid("sponge", "Menger sponge of depth 4, folded", sponge),
    solid("gear", "gear with 28 teeth, hub and keyway", gear::gear),
    solid("creature", "frog, blended with exponentials and a logarithm", creature::frog),
    solid("building", "temple of fluted columns, by set operations", building::temple),
    BenchModel { is_kept: false, ..solid("letters", "eight lines of letters, extruded", text::extruded) },
    BenchModel { is_kept: false, is_flat: true, ..solid("page", "a page of text in the plane", text::page) },
];

const fn solid(
    name: &'static str,
    about: &'static str,
    write: fn(&Program) -> Option<Value<'_>>,
) -> BenchModel {
    BenchModel { name, about, is_flat: false, is_kept: true, write }
}

impl BenchModel {
    /// The model as a `.vm` program, the same at each call.
    pub fn text(&self) -> String {
        let program = Program::new();
        let text = (self.write)(&program).map(|value| program.text(value));
        format!("# {}. Written by crates/bench/examples/models.rs.\n{}", self.about, text.unwrap_or_default())
    }
}

/// x⁴ − 5x² + y⁴ − 5y² + z⁴ − 5z² + 11.8.
fn tangle(program: &Program) -> Value<'_> {
    let [x, y, z] = program.point().map(|a| a.square().square() - a.square() * 5.0);
    x + y + z + 11.8
}

/// The shell of a gyroid in a ball.
fn gyroid(program: &Program) -> Value<'_> {
    let point = program.point();
    let [x, y, z] = point.map(|a| a * 6.0);
    let gyroid = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
    let [x, y, z] = point.map(Value::square);
    (gyroid.abs() - 0.3).max((x + y + z).sqrt() - 1.0)
}

/// A cube of side 2 without the middles of its 27 parts, without the middles of their 27 parts, and so on.
fn sponge(program: &Program) -> Option<Value<'_>> {
    let mut folded = program.point().map(Value::abs);
    let mut solid = program.intersection(&folded.map(|a| a - 1.0))?;
    for level in 1..=4 {
        let third = 3.0_f64.powi(-level);
        let [x, y, z] = folded.map(|a| a - third);
        let bars = x.max(y).min(y.max(z)).min(z.max(x));
        solid = solid.without(bars);
        // How far a place is from the middle of the nearest of three parts, along each axis.
        folded = folded.map(|a| a.min((a - 2.0 * third).abs()));
    }
    Some(solid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone::glam::DVec3;
    use fieldstone::{Evaluator, Inputs, Model};
    use std::path::Path;

    /// The model, read from a file of its own: that is how users read it.
    fn read(model: &BenchModel) -> Model {
        let path = std::env::temp_dir().join(format!("fieldstone-{}-{}.vm", model.name, std::process::id()));
        std::fs::write(&path, model.text()).unwrap();
        let loaded = fieldstone::load(&path, &Default::default()).unwrap();
        std::fs::remove_file(&path).unwrap();
        loaded.model
    }

    fn named(name: &str) -> &'static BenchModel {
        MODELS.iter().find(|model| model.name == name).unwrap()
    }

    fn inside(name: &str, points: &[[f64; 3]]) -> Vec<bool> {
        let model = read(named(name));
        let mut values = Vec::new();
        Evaluator::new(&model, &Inputs::default()).unwrap().evaluate(points.as_flattened(), &mut values);
        values.iter().map(|&value| value < 0.0).collect()
    }

    #[test]
    fn they_have_the_operations_that_they_stand_for() {
        for (name, least, most) in
            [("building", 600, 2000), ("gear", 200, 900), ("creature", 300, 900), ("page", 7000, 12_000)]
        {
            let count = read(named(name)).field.operation_count();
            assert!((least..most).contains(&count), "{name}: {count} operations");
        }
        let set_operations = named("building").text().matches(" max ").count()
            + named("building").text().matches(" min ").count();
        assert!(set_operations >= 300, "{set_operations}");
        assert!((2000..6000).contains(&read(named("letters")).field.operation_count()));
    }

    #[test]
    fn kept_files_are_as_written() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/bench");
        for model in MODELS.iter().filter(|model| model.is_kept) {
            let kept = std::fs::read_to_string(folder.join(format!("{}.vm", model.name))).unwrap();
            assert!(kept == model.text(), "{}: run the example `models` again", model.name);
        }
    }

    #[test]
    fn the_sponge_has_holes_of_four_sizes() {
        // Along the diagonal of a face: the middles of holes of each size.
        let hole = |level: i32| {
            let x = 1.0 - 3.0_f64.powi(1 - level);
            [x, 0.0, x]
        };
        let holes: Vec<[f64; 3]> = (1..=4).map(hole).collect();
        assert_eq!(inside("sponge", &holes), [false; 4]);
        assert_eq!(inside("sponge", &[[0.999, 0.999, 0.999], [0.5, 0.999, 0.999]]), [true, true]);
        // Of the side of depth 4, (8/9)⁴ are left.
        let n = 162;
        let at = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
        let face: Vec<[f64; 3]> = (0..n * n).map(|i| [at(i % n), at(i / n), 0.9999]).collect();
        let left = inside("sponge", &face).iter().filter(|&&inside| inside).count();
        assert_eq!(left, 8_usize.pow(4) * 4);
    }

    #[test]
    fn the_gear_turns_into_itself() {
        let turn = std::f64::consts::TAU / 28.0;
        let place = |i: usize| {
            let radius = 0.8 + 0.35 * (i % 37) as f64 / 37.0;
            let angle = i as f64 * 0.731;
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let points: Vec<[f64; 3]> = (0..999).map(|i| place(i).to_array()).collect();
        let turned: Vec<[f64; 3]> = (0..999)
            .map(|i| (fieldstone::glam::DQuat::from_rotation_z(turn) * place(i)).to_array())
            .collect();
        let (a, b) = (inside("gear", &points), inside("gear", &turned));
        let different = a.iter().zip(&b).filter(|(a, b)| a != b).count();
        // But for rounding; keyway and bores lie farther in.
        assert!(different <= 2, "{different}");
        assert!(a.contains(&true) && a.contains(&false));
    }
}
