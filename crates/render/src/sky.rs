//! Light from where nothing is hit: looked up by rays, and gathered by matt surfaces.
//!
//! Matt surfaces look into a few directions, by cosine. Where an environment has lamps in it (the sun in a photograph of
//! the sky), half of the directions are chosen by brightness, from a table; where a surface has a highlight, some are
//! chosen by its shape. All kinds count by the density of their mixture (the balance heuristic of Veach and Guibas 1995),
//! so that the result is right whatever the shares are.

use crate::bsdf::Highlight;
use crate::sampling::{at_height, cosine_hemisphere, luminance};
use fieldstone_scene::{Environment, Rgb, Scene, Surroundings};
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// The cells of the table: rows of equal height over the horizon plane, so that all are equally large.
const ROWS: usize = 128;
const COLUMNS: usize = 256;

/// How many directions in a cell are looked at for its brightness, along a side.
const LOOKS: usize = 4;

/// An environment is even enough for the cosine alone if no cell is brighter than this many times the mean.
const EVEN: f64 = 4.0;

/// What rays see that hit nothing.
pub(crate) struct Sky<'s> {
    scene: &'s Scene,
    table: Option<Table>,
}

/// A direction to look into for light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    pub(crate) direction: DVec3,
    /// How often it is chosen, per solid angle.
    pub(crate) density: f64,
}

impl<'s> Sky<'s> {
    pub(crate) fn new(scene: &'s Scene) -> Self {
        let centre = scene.bounds().centre();
        let environment = scene.lighting().environment.as_ref();
        Self { scene, table: environment.and_then(|environment| Table::new(environment, centre)) }
    }

    pub(crate) fn environment(&self) -> Option<&'s Environment> {
        self.scene.lighting().environment.as_ref()
    }

    /// What a ray from the eye sees that hits nothing; nothing is the background of the picture.
    pub(crate) fn seen(&self, origin: DVec3, direction: DVec3) -> Option<Rgb> {
        let environment = self.environment().filter(|environment| environment.is_visible())?;
        Some(environment.light(origin, direction))
    }

    /// What a mirrored or refracted ray brings back that hits nothing.
    pub(crate) fn light(&self, origin: DVec3, direction: DVec3) -> Rgb {
        match self.environment() {
            Some(environment) => environment.light(origin, direction),
            None => {
                let sine = direction.dot(self.scene.camera().up()).clamp(-1.0, 1.0);
                self.scene.lighting().background.at(0.5 - sine.asin() / PI)
            }
        }
    }

    /// A direction from which a surface with this normal gets light; none where the light would come from below it.
    pub(crate) fn look(
        &self,
        normal: DVec3,
        highlight: Option<&Highlight>,
        (u, v): (f64, f64),
    ) -> Option<Look> {
        let share = highlight.map_or(0.0, Highlight::share);
        let direction = match highlight {
            Some(highlight) if u < share => highlight.direction(u / share, v)?,
            _ => self.towards_light(normal, (u - share) / (1.0 - share), v)?,
        };
        let cosine = direction.dot(normal);
        let scattered = match &self.table {
            Some(table) => 0.5 * table.density(direction) + 0.5 * cosine * FRAC_1_PI,
            None => cosine * FRAC_1_PI,
        };
        let density = (1.0 - share) * scattered + share * highlight.map_or(0.0, |h| h.density(direction));
        (cosine > 0.0 && density > 0.0).then_some(Look { direction, density })
    }

    /// A direction from which a matt surface gets light, or one from below it.
    fn towards_light(&self, normal: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let (across, along) = normal.any_orthonormal_pair();
        let by_cosine = |u: f64| DMat3::from_cols(across, along, normal) * cosine_hemisphere((u, v));
        let direction = match &self.table {
            Some(table) if u < 0.5 => table.direction(2.0 * u, v),
            Some(_) => by_cosine(2.0 * u - 1.0),
            None => by_cosine(u),
        };
        direction.try_normalize()
    }
}

/// How bright directions are, in cells of equal solid angle.
struct Table {
    /// Sums of brightness before each cell, row by row; the last is the sum of all.
    before: Vec<f64>,
}

impl Table {
    /// `None` where brightness makes little difference.
    fn new(environment: &Environment, place: DVec3) -> Option<Self> {
        if matches!(environment.surroundings(), Surroundings::Uniform(_) | Surroundings::Gradient { .. }) {
            return None;
        }
        let looks = (0..LOOKS * LOOKS).map(|i| ((i % LOOKS) as f64 + 0.5, (i / LOOKS) as f64 + 0.5));
        let brightness = |cell: usize| -> f64 {
            let at = |(a, b): (f64, f64)| direction_at(cell, a / LOOKS as f64, b / LOOKS as f64);
            looks.clone().map(|look| luminance(environment.light(place, at(look)))).sum()
        };
        let mut cells: Vec<f64> = (0..ROWS * COLUMNS).map(brightness).collect();
        let mean = cells.iter().sum::<f64>() / cells.len() as f64;
        let brightest = cells.iter().copied().fold(0.0, f64::max);
        if !(mean > 0.0 && mean.is_finite() && brightest > EVEN * mean) {
            return None;
        }
        let mut sum = 0.0;
        for cell in &mut cells {
            // What was missed between two looks is found too, if seldom.
            sum += *cell + 0.05 * mean;
            *cell = sum;
        }
        Some(Self { before: std::iter::once(0.0).chain(cells).collect() })
    }

    fn sum(&self) -> f64 {
        self.before.last().copied().unwrap_or(0.0)
    }

    fn direction(&self, u: f64, v: f64) -> DVec3 {
        let wanted = u * self.sum();
        let cell = self.before.partition_point(|&sum| sum <= wanted).clamp(1, ROWS * COLUMNS) - 1;
        let (low, high) = (self.before[cell], self.before[cell + 1]);
        let within = if high > low { ((wanted - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        direction_at(cell, within, v)
    }

    /// Per solid angle.
    fn density(&self, direction: DVec3) -> f64 {
        let row = ((direction.z + 1.0) * 0.5 * ROWS as f64) as usize;
        let turn = (direction.y.atan2(direction.x) / TAU).rem_euclid(1.0);
        let cell = row.min(ROWS - 1) * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let share = (self.before[cell + 1] - self.before[cell]) / self.sum();
        share * (ROWS * COLUMNS) as f64 / (4.0 * PI)
    }
}

/// The direction at (a, b) of a cell, both from 0 to 1.
fn direction_at(cell: usize, a: f64, b: f64) -> DVec3 {
    let (row, column) = ((cell / COLUMNS) as f64, (cell % COLUMNS) as f64);
    at_height((row + b) / ROWS as f64 * 2.0 - 1.0, (column + a) / COLUMNS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::point;
    use fieldstone_field::{Bindings, Field, Graph};
    use fieldstone_scene::{Background, Bounds, Camera, Image, Lighting, Settings, Solid, Surroundings, Up};
    use std::sync::Arc;

    fn scene(environment: Option<Environment>) -> Scene {
        let bounds = Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap();
        let mut graph = Graph::new();
        let one = graph.constant(1.0);
        let solid = Solid::new(Field::new(graph, one, Vec::new()), Bindings::new(), bounds);
        let background = Background { top: DVec3::X, bottom: DVec3::Z };
        let lighting = Lighting { background, environment, ..Lighting::default() };
        Scene::new(vec![solid], Camera::fitted(&bounds, Up::Z, 1.0), lighting, Settings::default()).unwrap()
    }

    /// A dark sky with a small sun, which stands at (u, v) of the picture.
    fn sun() -> Environment {
        let mut pixels = vec![[0.1f32; 3]; 64 * 32];
        pixels[8 * 64 + 40] = [400.0; 3];
        let image = Image::new(64, 32, pixels).unwrap();
        Environment::new(Surroundings::LatLong(Arc::new(image))).unwrap()
    }

    #[test]
    fn directions_by_brightness_have_their_density() {
        let table = Table::new(&sun(), DVec3::ZERO).expect("the sun is bright");
        let all = (0..ROWS * COLUMNS).map(|cell| table.density(direction_at(cell, 0.5, 0.5)));
        assert!((all.sum::<f64>() * 4.0 * PI / (ROWS * COLUMNS) as f64 - 1.0).abs() < 1e-9);
        // The mean of 1/density over what is sampled is the whole sphere.
        let sphere = (0..4096).map(|i| point(i, 5)).map(|(u, v)| 1.0 / table.density(table.direction(u, v)));
        assert!((sphere.sum::<f64>() / 4096.0 / (4.0 * PI) - 1.0).abs() < 0.05);
    }

    /// The light on a matt surface, by quadrature and by directions.
    #[test]
    fn a_sun_lights_as_much_as_it_should() {
        const SIDE: u32 = 2000;
        let (environment, normal) = (sun(), DVec3::new(0.3, 0.8, -0.4).normalize());
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        let mut exact = DVec3::ZERO;
        for i in 0..SIDE * SIDE {
            let direction = at_height(2.0 * place(i / SIDE) - 1.0, place(i % SIDE));
            exact += environment.light(DVec3::ZERO, direction) * direction.dot(normal).max(0.0);
        }
        exact *= 4.0 / f64::from(SIDE * SIDE);
        let scene = scene(Some(environment));
        let sky = Sky::new(&scene);
        let found: DVec3 = (0..1024)
            .filter_map(|i| sky.look(normal, None, point(i, 3)))
            .map(|look| (look, look.direction.dot(normal) * FRAC_1_PI / look.density))
            .map(|(look, weight)| sky.light(DVec3::ZERO, look.direction) * weight)
            .sum();
        assert!((found.x / 1024.0 / exact.x - 1.0).abs() < 0.02, "{} is not {}", found.x / 1024.0, exact.x);
        assert!(exact.x > 0.2, "the sun shines");
    }

    #[test]
    fn without_an_environment_the_background_surrounds() {
        let scene = scene(None);
        let (sky, up) = (Sky::new(&scene), scene.camera().up());
        assert!((sky.light(DVec3::ZERO, up) - DVec3::X).length() < 1e-6);
        assert!((sky.light(DVec3::ZERO, -up) - DVec3::Z).length() < 1e-6);
        assert!(sky.seen(DVec3::ZERO, up).is_none());
    }
}
