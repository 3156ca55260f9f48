//! Our side of a contest: certified first hits and normals, or slices of the plane.

use crate::contest::Contestant;
use crate::error::BenchError;
use crate::view::{Lens, Walk};
use fieldstone::{
    LoadOptions, RenderRequest, Scene, Settings, Sight, Slice, SlicePicture, SliceRequest, SliceStyle, Stats,
    Viewer, draw_slice,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::time::Instant;

/// A model that was read, with its bounds found, as a scene.
#[derive(Debug)]
pub struct Prepared {
    scene: Scene,
    seconds: f64,
}

impl Prepared {
    /// Reads a model from a file and finds its bounds.
    ///
    /// # Errors
    /// A model that cannot be read or framed.
    pub fn read(path: &Path) -> Result<Self, BenchError> {
        let start = Instant::now();
        let name = path.display().to_string();
        let loaded = fieldstone::load(path, &LoadOptions::default());
        let loaded = loaded.map_err(|e| BenchError::model(&name, e))?;
        let settings = Settings { samples: 1, ..Settings::default() };
        let request = RenderRequest { settings, ..RenderRequest::default() };
        let resolved = request.resolve(&loaded.model).map_err(|e| BenchError::model(&name, e))?;
        Ok(Self { scene: resolved.scene, seconds: start.elapsed().as_secs_f64() })
    }

    /// The scene, with its default camera and light.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How long that took, in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The walk around it.
    ///
    /// # Errors
    /// Bounds that no camera can look at.
    pub fn walk(&self, lens: Lens) -> Result<Walk, BenchError> {
        Walk::around(self.scene.bounds(), lens)
    }
}

/// A pool of so many threads.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| BenchError::model("threads", e))
}

/// Frames of a walk: **what stands for us in every comparison of frames**.
pub struct Frames<'m> {
    viewer: Viewer<'m>,
    walk: Walk,
    size: u32,
    pool: ThreadPool,
    setup: f64,
    last: Option<Sight>,
}

impl<'m> Frames<'m> {
    /// Frames of `size` × `size` pixels on so many threads.
    ///
    /// # Errors
    /// Threads that could not be started, bounds that no camera can look at.
    pub fn new(model: &'m Prepared, lens: Lens, size: u32, threads: usize) -> Result<Self, BenchError> {
        let walk = model.walk(lens)?;
        let start = Instant::now();
        let viewer = Viewer::new(&model.scene);
        let setup = model.seconds + start.elapsed().as_secs_f64();
        Ok(Self { viewer, walk, size, pool: pool(threads)?, setup, last: None })
    }

    /// What the last frame rests on, and what it took.
    pub fn stats(&self) -> Stats {
        self.last.as_ref().map_or(Stats::default(), |sight| sight.stats)
    }
}

impl Contestant for Frames<'_> {
    fn name(&self) -> &'static str {
        "fieldstone"
    }

    fn draw(&mut self, frame: u32) -> Result<(), BenchError> {
        let camera = self.walk.camera(frame)?;
        let (viewer, size) = (&self.viewer, (self.size, self.size));
        self.last = Some(self.pool.install(|| viewer.look(&camera, size)));
        Ok(())
    }

    fn silhouette(&self) -> Option<Vec<bool>> {
        self.last.as_ref().map(|sight| sight.depth.iter().map(|t| t.is_finite()).collect())
    }

    fn setup_seconds(&self) -> f64 {
        self.setup
    }
}

/// A shape of the plane z = 0 as a slice, in the square from −1 to 1 that moves to the right from frame to frame. Its axes
/// and its smooth edges are drawn as well.
pub struct Slices {
    name: String,
    slice: Slice,
    threads: usize,
    setup: f64,
    last: Option<SlicePicture>,
}

impl Slices {
    /// How far the square moves from one frame to the next.
    pub const STEP: f64 = 0.01;

    /// Slices of `size` × `size` pixels on so many threads.
    ///
    /// # Errors
    /// A model that cannot be read or has no plane z = 0.
    pub fn read(path: &Path, size: u32, threads: usize) -> Result<Self, BenchError> {
        let start = Instant::now();
        let name = path.display().to_string();
        let loaded = fieldstone::load(path, &LoadOptions::default());
        let loaded = loaded.map_err(|e| BenchError::model(&name, e))?;
        let plane = Some(fieldstone::Plane { axis: 2, at: 0.0 });
        let style = SliceStyle::Plain;
        let request = SliceRequest { plane, size: (size, size), style, ..SliceRequest::default() };
        let (slice, _) = request.resolve(&loaded.model).map_err(|e| BenchError::model(&name, e))?;
        Ok(Self { name, slice, threads, setup: start.elapsed().as_secs_f64(), last: None })
    }

    /// How many operations the model has.
    pub fn operation_count(&self) -> usize {
        self.slice.field.operation_count()
    }
}

impl Contestant for Slices {
    fn name(&self) -> &'static str {
        "fieldstone"
    }

    fn draw(&mut self, frame: u32) -> Result<(), BenchError> {
        let shift = Self::STEP * f64::from(frame);
        self.slice.window = fieldstone::Window { min: [shift - 1.0, -1.0], max: [shift + 1.0, 1.0] };
        let picture = draw_slice(&self.slice, Some(self.threads));
        self.last = Some(picture.map_err(|e| BenchError::model(&self.name, e))?);
        Ok(())
    }

    /// None: the axes take some of the picture.
    fn silhouette(&self) -> Option<Vec<bool>> {
        None
    }

    fn setup_seconds(&self) -> f64 {
        self.setup
    }
}
