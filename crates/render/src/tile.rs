//! The picture, tile by tile on all cores.

use crate::integrator::{EyeRay, Integrator, Sample, Worker};
use crate::noise::{VISIBLE, shown_error};
use crate::query::{Asker, Prepared};
use crate::refine::{Refiner, needs};
use crate::sampling::Draw;
use crate::sky::Sky;
use fieldstone_scene::{Film, Pixel, Scene};
use fieldstone_space::OctreeMemory;
use fieldstone_trace::Certificate;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The side of a tile, in pixels: small enough for programs to become short, large enough to fill the lanes.
const TILE: u32 = 16;

/// The side of the blocks in which the pixels of a tile follow each other.
pub(crate) const BLOCK: u32 = 8;

/// How to render, without effect on the picture.
#[derive(Clone, Copy, Default)]
pub struct RenderOptions<'a> {
    /// How many threads; `None`: one for each core.
    pub threads: Option<usize>,
    /// About how many bytes the octrees of all solids together may take; `None`: 1 GiB. With less the picture takes
    /// longer.
    pub memory: Option<usize>,
    /// Is told how much is done, from 0 to 1, from any thread.
    pub progress: Option<&'a (dyn Fn(f64) + Sync)>,
    /// Stops the work soon after it becomes true: at the ends of the tiles that are being drawn.
    pub cancel: Option<&'a AtomicBool>,
}

impl RenderOptions<'_> {
    fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }
}

/// What was spent, and what the picture rests on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Pixels whose centre ray is certified, hit or miss.
    pub certified: u64,
    /// Pixels whose centre ray rests on a tolerance.
    pub tolerance: u64,
    /// Pixels whose centre ray is undecided.
    pub undecided: u64,
    /// Pixels whose centre ray hits.
    pub hits: u64,
    /// Rays of all kinds.
    pub rays: u64,
    /// Evaluations of fields, over points and sets.
    pub evaluations: u64,
}

/// A picture and how it came about.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture with its layers.
    pub film: Film,
    /// What was spent, and what the picture rests on.
    pub stats: Stats,
}

/// Why there is no picture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RenderError {
    /// The threads could not be started.
    Threads {
        /// How many were asked for; 0: one for each core.
        threads: usize,
        /// What the system says.
        reason: String,
    },
    /// [`RenderOptions::cancel`] became true.
    Cancelled,
}

impl std::fmt::Display for RenderError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Threads { threads, reason } => write!(f, "could not start {threads} threads: {reason}"),
            Self::Cancelled => f.write_str("the picture was not finished: it was cancelled"),
        }
    }
}

impl std::error::Error for RenderError {}

/// Draws a scene.
///
/// The picture does not depend on the number of threads.
///
/// # Errors
/// The threads could not be started; the work was cancelled.
pub fn render(scene: &Scene, options: &RenderOptions<'_>) -> Result<Rendered, RenderError> {
    let threads = options.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| RenderError::Threads { threads, reason: e.to_string() })?;
    pool.install(|| draw(scene, options)).ok_or(RenderError::Cancelled)
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Tile {
    pub(crate) fn all(width: u32, height: u32) -> Vec<Tile> {
        let columns = (0..width).step_by(TILE as usize);
        (0..height)
            .step_by(TILE as usize)
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .map(|(x, y)| Tile { x, y, width: TILE.min(width - x), height: TILE.min(height - y) })
            .collect()
    }

    /// The pixels, by blocks of 8 × 8, in the order that bundles are split in; those by patches of 4 × 2, which fill a
    /// vector.
    pub(crate) fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        self.blocks().flat_map(|block| block.parts(4, 2).flat_map(Tile::rows))
    }

    /// The blocks of 8 × 8 pixels.
    pub(crate) fn blocks(self) -> impl Iterator<Item = Tile> {
        self.parts(BLOCK, BLOCK)
    }

    /// Its parts of a size, row by row; the last ones may be smaller.
    fn parts(self, width: u32, height: u32) -> impl Iterator<Item = Tile> {
        let starts = |from: u32, length: u32, step: u32| (from..from + length).step_by(step as usize);
        let (right, bottom) = (self.x + self.width, self.y + self.height);
        let part = move |(x, y)| Tile { x, y, width: width.min(right - x), height: height.min(bottom - y) };
        starts(self.y, self.height, height)
            .flat_map(move |y| starts(self.x, self.width, width).map(move |x| part((x, y))))
    }

    /// The pixels row by row.
    fn rows(self) -> impl Iterator<Item = (u32, u32)> {
        (self.y..self.y + self.height).flat_map(move |y| (self.x..self.x + self.width).map(move |x| (x, y)))
    }

    /// The corners in pixels: left and right, top and bottom.
    pub(crate) fn sides(self) -> ([u32; 2], [u32; 2]) {
        ([self.x, self.x + self.width], [self.y, self.y + self.height])
    }
}

/// How many tiles are done before their pixels are put on the film: what is on the way takes little memory, and the
/// cores seldom wait for each other.
const BAND: usize = 4096;

/// A pixel with its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) pixel: Pixel,
    /// Whether chance had a part in its colour that one may see.
    pub(crate) is_noisy: bool,
}

/// The picture; `None` if the work was cancelled.
///
/// The second pass takes more samples of pixels that differ from a neighbour, and of those in whose colour, or in a
/// neighbour's, chance has a part that one may see: in half shadows, under a sky that is partly hidden, where rough
/// surfaces mirror. A lens makes that all pixels.
fn draw(scene: &Scene, options: &RenderOptions<'_>) -> Option<Rendered> {
    let prepared =
        Prepared::new(scene, &options.memory.map_or_else(OctreeMemory::default, OctreeMemory::new));
    let sky = Sky::new(scene);
    let integrator = Integrator::new(&prepared, &sky);
    let (width, height) = scene.settings().size;
    let has_lens = scene.camera().aperture().is_some();
    let passes = if scene.settings().samples > 1 || has_lens { 2 } else { 1 };
    let painter = Painter { tiles: Tile::all(width, height), passes, done: AtomicUsize::new(0), options };
    let mut stats = Stats::default();
    let mut film = Film::new(width, height);
    let mut noisy = vec![has_lens; width as usize * height as usize];
    for band in painter.bands() {
        let done = painter
            .work(band, &mut stats, |worker, tile| look_through_centres(scene, &integrator, worker, tile))?;
        for placed in done.iter().flatten() {
            stats.count(&placed.pixel);
            film.set(placed.x, placed.y, &placed.pixel);
            noisy[placed.y as usize * width as usize + placed.x as usize] |= placed.is_noisy;
        }
    }
    if passes == 2 {
        let needs = needs(&film, &noisy);
        for band in painter.bands() {
            let refiner = Refiner { scene, integrator: &integrator, film: &film, needs: &needs };
            let refine = |worker: &mut Worker, tile: Tile| refiner.refine(worker, tile.pixels());
            let done = painter.work(band, &mut stats, refine)?;
            done.iter().flatten().for_each(|placed| film.set(placed.x, placed.y, &placed.pixel));
        }
    }
    Some(Rendered { film, stats })
}

/// The tiles of a picture, and how much of the work on them is done.
struct Painter<'o> {
    tiles: Vec<Tile>,
    passes: usize,
    /// Tiles done so far, counted in every pass.
    done: AtomicUsize,
    options: &'o RenderOptions<'o>,
}

impl Painter<'_> {
    fn bands(&self) -> impl Iterator<Item = &[Tile]> {
        self.tiles.chunks(BAND)
    }

    /// Works on the tiles of a band; the results come in the order of the tiles, whoever is done first. `None` if the
    /// work was cancelled.
    fn work(
        &self,
        band: &[Tile],
        stats: &mut Stats,
        work: impl Fn(&mut Worker, Tile) -> Vec<Placed> + Sync,
    ) -> Option<Vec<Vec<Placed>>> {
        let results: Option<Vec<(Vec<Placed>, Spent)>> = band
            .par_iter()
            .map_init(Worker::default, |worker, &tile| {
                if self.options.is_cancelled() {
                    return None;
                }
                let spent = Spent::start(&worker.asker);
                let result = work(worker, tile);
                self.report();
                Some((result, spent.end(&worker.asker)))
            })
            .collect();
        let unpack = |(result, spent): (Vec<Placed>, Spent)| {
            spent.add_to(stats);
            result
        };
        Some(results?.into_iter().map(unpack).collect())
    }

    fn report(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(progress) = self.options.progress {
            progress(done as f64 / (self.tiles.len() * self.passes) as f64);
        }
    }
}

/// Rays and evaluations between two moments.
struct Spent {
    rays: u64,
    evaluations: u64,
}

impl Spent {
    fn start(asker: &Asker) -> Self {
        Self { rays: asker.rays, evaluations: asker.evaluations }
    }

    fn end(self, asker: &Asker) -> Self {
        Self { rays: asker.rays - self.rays, evaluations: asker.evaluations - self.evaluations }
    }

    fn add_to(&self, stats: &mut Stats) {
        stats.rays += self.rays;
        stats.evaluations += self.evaluations;
    }
}

impl Stats {
    fn count(&mut self, pixel: &Pixel) {
        self.hits += u64::from(pixel.depth.is_finite());
        match pixel.certificate {
            c if c == Certificate::Certified as u8 as f32 => self.certified += 1,
            c if c == Certificate::Tolerance as u8 as f32 => self.tolerance += 1,
            _ => self.undecided += 1,
        }
    }
}

fn look_through_centres(
    scene: &Scene,
    integrator: &Integrator<'_, '_>,
    worker: &mut Worker,
    tile: Tile,
) -> Vec<Placed> {
    let ray = |(x, y)| {
        let (origin, direction) = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        EyeRay { origin, direction, draw: Draw::new((x, y), 0) }
    };
    let rays: Vec<EyeRay> = tile.pixels().map(ray).collect();
    let samples = integrator.radiance(worker, &rays);
    let place = |((x, y), sample): ((u32, u32), &Sample)| Placed {
        x,
        y,
        pixel: to_pixel(sample),
        is_noisy: is_noisy(scene, sample),
    };
    tile.pixels().zip(&samples).map(place).collect()
}

/// Whether a sample alone is too little, because other choices might have made it visibly different.
fn is_noisy(scene: &Scene, sample: &Sample) -> bool {
    let error = shown_error(&scene.settings().tone, sample.colour, sample.variance.sqrt());
    sample.by_chance || error > VISIBLE
}

fn to_pixel(sample: &Sample) -> Pixel {
    let answer = &sample.answer;
    let seen = Pixel {
        colour: sample.colour.as_vec3().to_array(),
        alpha: sample.alpha as f32,
        certificate: f32::from(answer.certificate as u8),
        cost: answer.cost as f32,
        ..Pixel::MISS
    };
    match (sample.volume, answer.surface) {
        // A volume has no normal.
        (Some((depth, part)), _) => Pixel { depth: depth as f32, part: part as f32, ..seen },
        (None, Some(surface)) => Pixel {
            depth: surface.t as f32,
            normal: sample.normal.as_vec3().to_array(),
            part: surface.part as f32,
            ..seen
        },
        (None, None) => seen,
    }
}

/// The colour of a pixel, linear RGB.
pub(crate) fn colour(pixel: &Pixel) -> DVec3 {
    DVec3::from_array(pixel.colour.map(f64::from))
}
