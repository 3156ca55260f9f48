//! How tight the bounds of the library's functions are: prints the table of `docs/tightness.md`.
//!
//!     cargo run --release -p fieldstone-lang --example tightness > docs/tightness.md
//!
//! For each function, random spans of random rays through \[−2, 2\]³ are bounded by intervals, by affine forms alone
//! and by mixed ones; each width is divided by that of the values at 257 points of the span.
#![allow(clippy::print_stdout, reason = "it prints a table")]

#[path = "../../tests/library/cases.rs"]
mod cases;
mod unmixed;

use cases::Random;
use fieldstone_field::{Affine, Bindings, Domain, Field, Input, Interval, reference};
use fieldstone_lang::Dialect;
use unmixed::Unmixed;

/// Spans are these parts of the side of the box.
const PARTS: [f64; 6] = [4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
/// As [`HEAD`] says.
const RAYS: usize = 100;
const SIDE: f64 = 4.0;

/// What stands above the table.
const HEAD: &str = "\
# Tightness of the library's bounds

How many times wider than the values are the bounds of each function of the HyperFun library? 1 is the best: the bounds are
the least and the greatest value. Rays are traced with *mixed* forms, which carry an affine form (a line along the ray with an
error) and an interval together; *interval* and *affine* are what each would say alone.

The numbers are geometric means over spans of 1/4 … 1/128 of the side of [−2, 2]³, 100 random rays for each length; *at 1/128*:
over the shortest spans alone, which show what is left when a ray has come near the surface. *None*: spans left without a
finite bound by mixed forms. A dash: the value changed on no span. Functions that jump, such as hfA_CheckerBoard and
hfA_Circles, have wide bounds at any length, because a bound knows of both sides of the jump.

The calls are those of `crates/lang/tests/library/cases.txt`; space operations move a block or a ball, attribute functions are
read through a sum of what they write. Made by `cargo run --release -p fieldstone-lang --example tightness`.
";

fn main() -> Result<(), String> {
    println!("{HEAD}");
    println!("| function | interval | affine | mixed | interval at 1/128 | mixed at 1/128 | none |");
    println!("|---|---|---|---|---|---|---|");
    for case in cases::cases() {
        let field = case.field(Dialect::Lenient)?;
        println!("| {} {}", case.name, measure(&field));
    }
    Ok(())
}

/// A row: logarithms of the ratios, summed up.
#[derive(Default, Clone, Copy)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, bound: Interval<f64>, width: f64) {
        let ratio = (bound.hi - bound.lo) / width;
        if ratio.is_finite() {
            self.sum += ratio.ln();
            self.count += 1;
        }
    }

    fn text(self) -> String {
        if self.count == 0 {
            "–".to_owned()
        } else {
            format!("{:.2}", (self.sum / self.count as f64).exp())
        }
    }
}

fn measure(field: &Field) -> String {
    let mut random = Random(7);
    let mut means = [Mean::default(); 5];
    let (mut spans, mut unbounded) = (0, 0);
    for part in PARTS {
        for _ in 0..RAYS {
            let ray = Ray::new(&mut random, SIDE / part);
            let Some(width) = ray.width(field) else { continue };
            spans += 1;
            let interval: Interval<f64> = ray.bound(field, |form| form.range);
            let affine: Unmixed = ray.bound(field, Unmixed::new);
            let mixed: Affine<f64> = ray.bound(field, |form| form);
            means[0].add(interval, width);
            means[1].add(affine.range(), width);
            means[2].add(mixed.range, width);
            if part == 128.0 {
                means[3].add(interval, width);
                means[4].add(mixed.range, width);
            }
            unbounded += usize::from(!(mixed.range.hi - mixed.range.lo).is_finite());
        }
    }
    let [interval, affine, mixed, short_interval, short_mixed] = means.map(Mean::text);
    let none = if spans == 0 {
        "–".to_owned()
    } else {
        format!("{:.0} %", 100.0 * unbounded as f64 / spans as f64)
    };
    format!("| {interval} | {affine} | {mixed} | {short_interval} | {short_mixed} | {none} |")
}

/// A span of a ray.
struct Ray {
    origin: [f64; 3],
    direction: [f64; 3],
    length: f64,
}

impl Ray {
    fn new(random: &mut Random, length: f64) -> Self {
        let origin = [0; 3].map(|_| (random.unit() - 0.5) * SIDE);
        let direction = loop {
            let d = [0; 3].map(|_| 2.0 * random.unit() - 1.0);
            let norm = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                break d.map(|c| c / norm);
            }
        };
        Self { origin, direction, length }
    }

    /// The width of the values; none if they are undefined somewhere, jump, or hardly change.
    fn width(&self, field: &Field) -> Option<f64> {
        let at = |i: i32| {
            let t = self.length * f64::from(i) / 256.0;
            let point = [0, 1, 2].map(|k| self.origin[k] + t * self.direction[k]);
            field.at(&point, &Bindings::new())[0]
        };
        let values: Vec<f64> = (0..=256).map(at).collect();
        if values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let (lo, hi) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        let size = lo.abs().max(hi.abs());
        (hi - lo > 1e-6 * size).then_some(hi - lo)
    }

    fn bound<D: Domain>(&self, field: &Field, lift: impl Fn(Affine<f64>) -> D) -> D
    where
        D::Real: fieldstone_field::Real<Token = ()>,
    {
        let zero = lift(Affine::line(0.0, 0.0, 0.0));
        let input = |input| match input {
            Input::Coordinate(k @ 0..=2) => {
                let k = usize::from(k);
                lift(Affine::along_ray(self.origin[k], self.direction[k], 0.0, self.length))
            }
            _ => zero,
        };
        reference::evaluate(field.graph(), &[field.value()], (), input, 1000)[0]
    }
}
