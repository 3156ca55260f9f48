//! Our side of a contest: certified first hits and normals, or slices of the plane.

use crate::contest::Contestant;
use crate::error::BenchError;
use crate::view::{Lens, Walk};
use fieldstone::{
    Bindings, Lattice, LoadOptions, Octree, OctreeMemory, RenderRequest, Scene, Settings, Sight, Stats,
    Viewer,
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

/// Which points of the plane z = 0 are inside of a shape, in the square from −1 to 1 that moves to the right from frame to
/// frame, by the octree of its field, which is kept.
pub struct Slices {
    tree: Octree,
    operations: usize,
    size: u32,
    pool: ThreadPool,
    setup: f64,
    last: Option<Vec<bool>>,
}

impl Slices {
    /// How far the square moves from one frame to the next.
    pub const STEP: f64 = 0.01;
    /// How far it can move at most.
    const FURTHEST: f64 = 2.0;

    /// Slices of `size` × `size` pixels on so many threads.
    ///
    /// # Errors
    /// A model that cannot be read, threads that cannot be started.
    pub fn read(path: &Path, size: u32, threads: usize) -> Result<Self, BenchError> {
        let start = Instant::now();
        let name = path.display().to_string();
        let loaded = fieldstone::load(path, &LoadOptions::default());
        let loaded = loaded.map_err(|e| BenchError::model(&name, e))?;
        let field = &loaded.model.field;
        let corners = ([-1.0, -1.0, -0.01], [1.0 + Self::FURTHEST, 1.0, 0.01]);
        let tree = Octree::new(field, &Bindings::new(), corners, OctreeMemory::default());
        let operations = field.operation_count();
        let setup = start.elapsed().as_secs_f64();
        Ok(Self { tree, operations, size, pool: pool(threads)?, setup, last: None })
    }

    /// How many operations the model has.
    pub fn operation_count(&self) -> usize {
        self.operations
    }
}

impl Contestant for Slices {
    fn name(&self) -> &'static str {
        "fieldstone"
    }

    fn draw(&mut self, frame: u32) -> Result<(), BenchError> {
        let shift = (Self::STEP * f64::from(frame)) % Self::FURTHEST;
        let step = 2.0 / f64::from(self.size);
        let lattice = Lattice {
            axes: [0, 1],
            at: 0.0,
            first: [shift - 1.0 + 0.5 * step, 0.5 * step - 1.0],
            step: [step; 2],
            size: [self.size; 2],
        };
        self.last = Some(self.pool.install(|| self.tree.inside(&lattice)));
        Ok(())
    }

    /// Rows from top to bottom.
    fn silhouette(&self) -> Option<Vec<bool>> {
        let rows = |inside: &Vec<bool>| inside.chunks(self.size as usize).rev().flatten().copied().collect();
        self.last.as_ref().map(rows)
    }

    fn setup_seconds(&self) -> f64 {
        self.setup
    }
}
