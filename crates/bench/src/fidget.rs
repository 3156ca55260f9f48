//! fidget: an evaluator of `.vm` programs that draws height maps of voxels (M. Keeter, crates.io).
//!
//! It gets the same programs, cameras and sizes. Its picture has as many voxels in depth as it has pixels along a side, over
//! the ball around the bounds. Both of its evaluators take part, and the faster one is its figure: the code that 0.5.1
//! generates is slowed down on processors with AVX-512 where a model has sines, exponentials or the like.

use crate::contest::Contestant;
use crate::error::BenchError;
use crate::ours::{Slices, pool};
use crate::view::Walk;
use ::fidget::context::Context;
use ::fidget::eval::{Function, MathFunction};
use ::fidget::jit::JitFunction;
use ::fidget::raster::{pixel, voxel};
use ::fidget::render::{CancelToken, RenderHints, ThreadPool};
use ::fidget::shape::{Shape, ShapeVars};
use ::fidget::vm::VmFunction;
use fieldstone::{Camera, Projection};
use nalgebra::{Matrix3, Matrix4, Vector2, Vector3, Vector4};
use std::time::Instant;

/// What is drawn.
#[derive(Clone, Copy)]
enum Scene {
    Solid(Walk),
    /// A square of the plane.
    Plane,
}

/// A picture of fidget's.
enum Picture {
    None,
    Voxels(voxel::Image),
    Pixels(pixel::Image),
}

/// One of its evaluators with a model.
struct Fidget<F> {
    name: &'static str,
    shape: Shape<F>,
    scene: Scene,
    size: u32,
    threads: Option<ThreadPool>,
    setup: f64,
    last: Picture,
}

/// Both evaluators: the generated code and the interpreter.
///
/// # Errors
/// A program that it does not read, threads that could not be started.
pub(crate) fn of_solid(
    text: &str,
    walk: Walk,
    size: u32,
    threads: usize,
) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    both(text, Scene::Solid(walk), size, threads)
}

/// The same for the square from −1 to 1 of the plane, which moves as that of [`Slices`] does.
///
/// # Errors
/// As above.
pub(crate) fn of_plane(
    text: &str,
    size: u32,
    threads: usize,
) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    both(text, Scene::Plane, size, threads)
}

fn both(text: &str, scene: Scene, size: u32, threads: usize) -> Result<Vec<Box<dyn Contestant>>, BenchError> {
    Ok(vec![
        Box::new(Fidget::<JitFunction>::new("fidget jit", text, scene, size, threads)?),
        Box::new(Fidget::<VmFunction>::new("fidget vm", text, scene, size, threads)?),
    ])
}

impl<F: MathFunction> Fidget<F> {
    fn new(
        name: &'static str,
        text: &str,
        scene: Scene,
        size: u32,
        threads: usize,
    ) -> Result<Self, BenchError> {
        let start = Instant::now();
        let failed = |reason: String| BenchError::peer("fidget", reason);
        let (context, root) = Context::from_text(text.as_bytes()).map_err(|e| failed(e.to_string()))?;
        let shape = Shape::<F>::new(&context, root).map_err(|e| failed(e.to_string()))?;
        let setup = start.elapsed().as_secs_f64();
        // Without a pool, fidget works on the thread that calls it.
        let threads = if threads > 1 { Some(ThreadPool::Custom(pool(threads)?)) } else { None };
        Ok(Self { name, shape, scene, size, threads, setup, last: Picture::None })
    }
}

impl<F: Function + RenderHints> Contestant for Fidget<F> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn draw(&mut self, frame: u32) -> Result<(), BenchError> {
        let vars = ShapeVars::new();
        let shape = self.shape.bind(&vars).map_err(|e| BenchError::peer("fidget", e))?;
        let threads = self.threads.as_ref();
        let nothing = || BenchError::peer("fidget", "no picture");
        self.last = match self.scene {
            Scene::Solid(walk) => {
                let camera = walk.camera(frame)?;
                // fidget asks at the lower left corners of pixels; rays go through their middles.
                let half_pixel = Vector3::new(1.0, 1.0, 0.0) / self.size as f32;
                let world_to_model =
                    model_from_image(&camera, walk.depths()) * Matrix4::new_translation(&half_pixel);
                let config = voxel::RenderConfig { image_size: self.size.into(), world_to_model };
                let how = voxel::EvalConfig { tile_sizes: None, threads, cancel: CancelToken::new() };
                Picture::Voxels(voxel::render(shape, &config, &how).ok_or_else(nothing)?)
            }
            Scene::Plane => {
                let shift = Vector2::new((Slices::STEP * f64::from(frame)) as f32, 0.0);
                let config = pixel::RenderConfig {
                    world_to_model: Matrix3::new_translation(&shift),
                    ..pixel::RenderConfig::from_size(self.size.into())
                };
                let how = pixel::EvalConfig { tile_sizes: None, threads, cancel: CancelToken::new() };
                Picture::Pixels(pixel::render(shape, &config, &how).ok_or_else(nothing)?)
            }
        };
        Ok(())
    }

    fn silhouette(&self) -> Option<Vec<bool>> {
        match &self.last {
            Picture::None => None,
            Picture::Voxels(image) => Some(image.iter().map(|pixel| pixel.depth > 0).collect()),
            Picture::Pixels(image) => Some(image.iter().map(|pixel| pixel.inside()).collect()),
        }
    }

    fn setup_seconds(&self) -> f64 {
        self.setup
    }
}

/// From fidget's image, in which x, y (upwards) and z (towards the eye) run from −1 to 1, to the space of the model.
///
/// A perspective view is a projective map: the point at depth d along the view is eye + d·(forward + slope), and 1/d is
/// linear in the z of the image.
fn model_from_image(camera: &Camera, (near, far): (f64, f64)) -> Matrix4<f32> {
    let column = |v: fieldstone::glam::DVec3, w: f64| Vector4::new(v.x, v.y, v.z, w);
    let (eye, right, up, forward) = (camera.eye(), camera.right(), camera.up(), camera.forward());
    let matrix = match camera.projection() {
        Projection::Perspective { vertical_fov_radians } => {
            let slope = (0.5 * vertical_fov_radians).tan();
            let (middle, change) = (0.5 * (1.0 / near + 1.0 / far), 0.5 * (1.0 / near - 1.0 / far));
            [
                column(right * slope, 0.0),
                column(up * slope, 0.0),
                column(eye * change, change),
                column(eye * middle + forward, middle),
            ]
        }
        Projection::Orthographic { height } => [
            column(right * (0.5 * height), 0.0),
            column(up * (0.5 * height), 0.0),
            column(forward * (-0.5 * (far - near)), 0.0),
            column(eye + forward * (0.5 * (far + near)), 1.0),
        ],
    };
    Matrix4::from_columns(&matrix).cast()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contest::contest;
    use crate::models::MODELS;
    use crate::ours::{Frames, Prepared};
    use crate::view::Lens;
    use fieldstone::Bounds;
    use fieldstone::glam::DVec3;

    #[test]
    fn corners_of_the_image_are_where_the_camera_looks() {
        let bounds = Bounds::new(DVec3::new(-1.0, -2.0, 0.0), DVec3::new(3.0, 1.0, 1.0)).unwrap();
        for lens in [Lens::Perspective, Lens::Parallel] {
            let walk = Walk::around(bounds, lens).unwrap();
            let camera = walk.camera(5).unwrap();
            let matrix = model_from_image(&camera, walk.depths());
            for (x, y, depth) in [(-1.0, 0.4, 0.0), (0.7, -0.2, 1.0), (0.0, 0.0, -1.0)] {
                let point = matrix.transform_point(&nalgebra::Point3::new(x, y, depth)).cast::<f64>();
                let point = DVec3::new(point.x, point.y, point.z);
                let (u, v) = camera.project(point, 1.0).unwrap();
                assert!((2.0 * u - 1.0 - f64::from(x)).abs() < 1e-4, "{lens:?}: {u}");
                assert!((1.0 - 2.0 * v - f64::from(y)).abs() < 1e-4, "{lens:?}: {v}");
                let distance = (point - camera.eye()).dot(camera.forward());
                let (near, far) = walk.depths();
                assert!(depth != 1.0 || (distance - near).abs() < 1e-3 * far, "{distance}");
                assert!(depth != -1.0 || (distance - far).abs() < 1e-3 * far, "{distance}");
            }
        }
    }

    /// Both see the same solid in the same place: silhouettes differ along edges only.
    #[test]
    fn silhouettes_agree() {
        let model = MODELS.iter().find(|model| model.name == "tangle").unwrap();
        let path = std::env::temp_dir().join(format!("fieldstone-tangle-peer-{}.vm", std::process::id()));
        std::fs::write(&path, model.text()).unwrap();
        let prepared = Prepared::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        for lens in [Lens::Perspective, Lens::Parallel] {
            let ours = Frames::new(&prepared, lens, 96, 1).unwrap();
            let mut all: Vec<Box<dyn Contestant>> = vec![Box::new(ours)];
            all.extend(of_solid(&model.text(), prepared.walk(lens).unwrap(), 96, 1).unwrap());
            for standing in contest(&mut all, 1).unwrap() {
                assert!(
                    standing.different.unwrap() < 0.01,
                    "{lens:?} {}: {:?}",
                    standing.name,
                    standing.different
                );
            }
        }
    }
}
