//! The picture, tile by tile on all cores.

use crate::integrator::{Sample, radiance};
use crate::query::{Asker, Prepared};
use fieldstone_scene::{Film, Pixel, Scene};
use fieldstone_trace::Certificate;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The side of a tile, in pixels: small enough for programs to become short, large enough to fill the lanes.
const TILE: u32 = 16;

/// The side of the blocks in which the pixels of a tile follow each other.
const BLOCK: u32 = 8;

/// How to render, without effect on the picture.
#[derive(Clone, Copy, Default)]
pub struct RenderOptions<'a> {
    /// How many threads; `None`: one for each core.
    pub threads: Option<usize>,
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
struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Tile {
    fn all(width: u32, height: u32) -> Vec<Tile> {
        let columns = (0..width).step_by(TILE as usize);
        (0..height)
            .step_by(TILE as usize)
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .map(|(x, y)| Tile { x, y, width: TILE.min(width - x), height: TILE.min(height - y) })
            .collect()
    }

    /// The pixels, by blocks of 8 × 8, in the order that bundles are split in.
    fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        let starts = |from: u32, length: u32| (from..from + length).step_by(BLOCK as usize);
        let (right, bottom) = (self.x + self.width, self.y + self.height);
        starts(self.y, self.height)
            .flat_map(move |v| starts(self.x, self.width).map(move |u| (u, v)))
            .flat_map(move |(u, v)| {
                let row = move |y| (u..right.min(u + BLOCK)).map(move |x| (x, y));
                (v..bottom.min(v + BLOCK)).flat_map(row)
            })
    }
}

/// How many tiles are done before their pixels are put on the film: what is on the way takes little memory, and the
/// cores seldom wait for each other.
const BAND: usize = 4096;

/// About how many samples are taken before they are summed up.
const SAMPLES_TOGETHER: usize = 4096;

/// A pixel with its place.
type Placed = (u32, u32, Pixel);

/// The picture; `None` if the work was cancelled.
fn draw(scene: &Scene, options: &RenderOptions<'_>) -> Option<Rendered> {
    let prepared = Prepared::new(scene);
    let (width, height) = scene.settings().size;
    let passes = if scene.settings().samples > 1 { 2 } else { 1 };
    let painter = Painter { tiles: Tile::all(width, height), passes, done: AtomicUsize::new(0), options };
    let mut stats = Stats::default();
    let mut film = Film::new(width, height);
    for band in painter.bands() {
        let done =
            painter.work(band, &mut stats, |asker, tile| look_through_centres(&prepared, asker, tile))?;
        for (x, y, pixel) in done.iter().flatten() {
            stats.count(pixel);
            film.set(*x, *y, pixel);
        }
    }
    if passes == 2 {
        let edges = edges(&film);
        for band in painter.bands() {
            let seen = Seen { film: &film, edges: &edges };
            let done =
                painter.work(band, &mut stats, |asker, tile| refine_edges(&prepared, asker, tile, &seen))?;
            done.iter().flatten().for_each(|(x, y, pixel)| film.set(*x, *y, pixel));
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
        work: impl Fn(&mut Asker, Tile) -> Vec<Placed> + Sync,
    ) -> Option<Vec<Vec<Placed>>> {
        let results: Option<Vec<(Vec<Placed>, Spent)>> = band
            .par_iter()
            .map_init(Asker::default, |asker, &tile| {
                if self.options.is_cancelled() {
                    return None;
                }
                let spent = Spent::start(asker);
                let result = work(asker, tile);
                self.report();
                Some((result, spent.end(asker)))
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

fn look_through_centres(prepared: &Prepared<'_>, asker: &mut Asker, tile: Tile) -> Vec<Placed> {
    let rays: Vec<_> =
        tile.pixels().map(|(x, y)| prepared.scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5)).collect();
    let samples = radiance(prepared, asker, &rays);
    tile.pixels().zip(&samples).map(|((x, y), sample)| (x, y, to_pixel(sample))).collect()
}

fn to_pixel(sample: &Sample) -> Pixel {
    let answer = &sample.answer;
    let certificate = f32::from(answer.certificate as u8);
    let cost = answer.cost as f32;
    match answer.surface {
        None => Pixel { certificate, cost, ..Pixel::MISS },
        Some(surface) => Pixel {
            colour: sample.colour.as_vec3().to_array(),
            alpha: 1.0,
            depth: surface.t as f32,
            normal: sample.normal.as_vec3().to_array(),
            part: surface.part as f32,
            certificate,
            cost,
        },
    }
}

/// What the first pass saw.
struct Seen<'f> {
    /// Pixels of later bands are as seen through their centres.
    film: &'f Film,
    /// Which pixels differ from a neighbour, row by row.
    edges: &'f [bool],
}

/// Which pixels differ from one of their eight neighbours, row by row.
fn edges(film: &Film) -> Vec<bool> {
    let (width, height) = (film.width(), film.height());
    let mut edges = vec![false; width as usize * height as usize];
    edges.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
        for (is_edge, x) in row.iter_mut().zip(0..width) {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let Some(here) = film.pixel(x, y) else { continue };
            let differs = |u, v| film.pixel(u, v).is_some_and(|there| differ(&here, &there));
            *is_edge = (above..=below).any(|v| (left..=right).any(|u| differs(u, v)));
        }
    });
    edges
}

/// More samples for the pixels of a tile that differ from a neighbour.
fn refine_edges(prepared: &Prepared<'_>, asker: &mut Asker, tile: Tile, seen: &Seen<'_>) -> Vec<Placed> {
    let width = seen.film.width() as usize;
    let is_edge = |x: u32, y: u32| seen.edges[y as usize * width + x as usize];
    let edges: Vec<Placed> = tile
        .pixels()
        .filter(|&(x, y)| is_edge(x, y))
        .filter_map(|(x, y)| seen.film.pixel(x, y).map(|pixel| (x, y, pixel)))
        .collect();
    let extra = prepared.scene.settings().samples as usize - 1;
    let some = (SAMPLES_TOGETHER / extra).max(1);
    edges.chunks(some).flat_map(|edges| refine(prepared, asker, edges, extra)).collect()
}

/// So many more samples for each pixel.
fn refine(prepared: &Prepared<'_>, asker: &mut Asker, edges: &[Placed], extra: usize) -> Vec<Placed> {
    let rays: Vec<_> = edges
        .iter()
        .flat_map(|&(x, y, _)| (1..=extra).map(move |i| (x, y, place_in_pixel(i))))
        .map(|(x, y, (u, v))| prepared.scene.ray(f64::from(x) + u, f64::from(y) + v))
        .collect();
    let samples = radiance(prepared, asker, &rays);
    edges
        .iter()
        .zip(samples.chunks(extra))
        .map(|(&(x, y, centre), samples)| {
            let covered = samples.iter().filter(|s| s.answer.surface.is_some()).count() as f64;
            let weight = 1.0 / (extra + 1) as f64;
            let colour = (colour(&centre) + samples.iter().map(|s| s.colour).sum::<DVec3>()) * weight;
            let alpha = (f64::from(centre.alpha) + covered) * weight;
            (x, y, Pixel { colour: colour.as_vec3().to_array(), alpha: alpha as f32, ..centre })
        })
        .collect()
}

fn colour(pixel: &Pixel) -> DVec3 {
    DVec3::from_array(pixel.colour.map(f64::from))
}

/// Whether an edge runs between two neighbours: of a solid, a part, a crease, or light.
fn differ(a: &Pixel, b: &Pixel) -> bool {
    if a.part != b.part {
        return true;
    }
    if a.part < 0.0 {
        return false;
    }
    let normals: f32 = a.normal.iter().zip(b.normal).map(|(p, q)| p * q).sum();
    let (a, b) = (colour(a), colour(b));
    let brightest = a.max(b) + DVec3::splat(0.02);
    normals < 0.9 || ((a - b).abs() / brightest).max_element() > 0.15
}

/// The place of sample `i` in a pixel: the first in its centre, the others evenly around it (Roberts 2018).
fn place_in_pixel(i: usize) -> (f64, f64) {
    // 1/ρ and 1/ρ² for the root ρ of x³ = x + 1.
    const STEPS: (f64, f64) = (0.754_877_666_246_692_8, 0.569_840_290_998_053_2);
    ((0.5 + STEPS.0 * i as f64).fract(), (0.5 + STEPS.1 * i as f64).fract())
}
