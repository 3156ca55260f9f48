//! What is seen through the centres of pixels, without light: frames of a camera that moves.

use crate::object::{Meeting, Object, ObjectRay, Sought};
use crate::query::{Answer, Asker, Prepared, Surface};
use crate::tile::{Stats, Tile};
use fieldstone_scene::{Camera, Rays, Scene};
use fieldstone_space::OctreeMemory;
use fieldstone_trace::Certificate;
use glam::DVec3;
use rayon::prelude::*;

/// Looks at a scene again and again. Its programs are compiled once, when the viewer is made.
pub struct Viewer<'s> {
    prepared: Prepared<'s>,
    memory: OctreeMemory,
}

/// What one look found: the first hit of the ray through the centre of every pixel. Rows run from top to bottom.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The number of columns and of rows.
    pub size: (u32, u32),
    /// The distance from the eye (orthographic: from its plane) along the ray; +∞ on a miss.
    pub depth: Vec<f32>,
    /// The unit normal in world space, turned against the ray; 0 on a miss.
    pub normals: Vec<[f32; 3]>,
    /// What was spent, and what the hits and misses rest on.
    pub stats: Stats,
}

/// A ray's first hit as a pixel shows it.
#[derive(Clone, Copy)]
struct Seen {
    depth: f32,
    normal: [f32; 3],
    certificate: Certificate,
}

impl<'s> Viewer<'s> {
    /// A viewer of a scene; the scene's own camera and size are not looked at.
    pub fn new(scene: &'s Scene) -> Self {
        Self::with_memory(scene, OctreeMemory::default())
    }

    /// A viewer whose octrees take part in `memory`.
    pub fn with_memory(scene: &'s Scene, memory: OctreeMemory) -> Self {
        Self { prepared: Prepared::new(scene, &memory), memory }
    }

    /// A viewer of a scene whose solids, in their order, have the same fields and bounds, but other values of their inputs:
    /// parameters or the time. Octrees are rebuilt only where this matters; solids that differ otherwise are prepared
    /// anew. What is seen is the same as with a new viewer.
    pub fn changed<'n>(&self, scene: &'n Scene) -> Viewer<'n> {
        Viewer { prepared: self.prepared.changed(scene, &self.memory), memory: self.memory.clone() }
    }

    /// The first hits and normals that `camera` sees in an image of `size` = (width, height), each at least 1, on the
    /// threads of the current `rayon` pool. They do not depend on the number of threads.
    pub fn look(&self, camera: &Camera, size: (u32, u32)) -> Sight {
        let (width, height) = size;
        let pixels = width as usize * height as usize;
        let mut sight = Sight {
            size,
            depth: vec![f32::INFINITY; pixels],
            normals: vec![[0.0; 3]; pixels],
            stats: Stats::default(),
        };
        let tiles = Tile::all(width, height);
        let lens = Lens { rays: camera.rays(f64::from(width) / f64::from(height)), size };
        let found: Vec<Looked> = tiles
            .par_iter()
            .map_init(Asker::default, |asker, tile| {
                let before = asker.evaluations;
                let pixels = self.pixels(asker, *tile, &lens);
                let rays: Vec<(DVec3, DVec3)> =
                    pixels.iter().map(|&(x, y)| lens.ray(f64::from(x) + 0.5, f64::from(y) + 0.5)).collect();
                let seen = self.look_at(asker, &rays);
                Looked { pixels, seen, evaluations: asker.evaluations - before }
            })
            .collect();
        sight.stats.rays = pixels as u64;
        sight.stats.certified = pixels as u64;
        for Looked { pixels, seen, evaluations } in &found {
            sight.stats.evaluations += evaluations;
            for (&(x, y), seen) in pixels.iter().zip(seen) {
                sight.set(y as usize * width as usize + x as usize, seen);
            }
        }
        sight
    }

    /// The pixels of a tile in which there may be something.
    fn pixels(&self, asker: &mut Asker, tile: Tile, lens: &Lens) -> Vec<(u32, u32)> {
        if self.is_clear(asker, tile, lens) {
            return Vec::new();
        }
        let blocks = tile.blocks().filter(|&block| !self.is_clear(asker, block, lens));
        blocks.flat_map(Tile::pixels).collect()
    }

    /// Whether nothing is seen through the pixels of a tile, certainly.
    fn is_clear(&self, asker: &mut Asker, tile: Tile, lens: &Lens) -> bool {
        let hull = lens.hull(tile);
        let moved = &self.prepared.moved;
        let is_clear = |object: &Object<'_>| object.is_clear(asker, &hull);
        moved.iter().all(|moved| !moved) && self.prepared.objects.iter().all(is_clear)
    }

    fn look_at(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Seen> {
        if self.prepared.hierarchy.is_some() {
            return self.look_among_instances(asker, rays);
        }
        if let Some(seen) = self.look_at_one(asker, rays) {
            return seen;
        }
        self.look_at_some(asker, rays)
    }

    /// The same of a single unmoved solid, without what only several, or caps, need.
    fn look_at_one(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Option<Vec<Seen>> {
        let ([object], [false]) = (&self.prepared.objects[..], &self.prepared.moved[..]) else { return None };
        let (outcomes, gradients) = object.first_hits(asker, rays)?;
        asker.rays += rays.len() as u64;
        let see = |i: usize| {
            let (outcome, certificate) = (&outcomes[i], outcomes[i].certificate);
            let normal = DVec3::from_array(gradients[i]).try_normalize().filter(|n| n.is_finite());
            match (outcome.hit, normal) {
                (None, _) if !outcome.ends_inside && !outcome.starts_inside => {
                    Seen { depth: f32::INFINITY, normal: [0.0; 3], certificate }
                }
                (Some(hit), Some(normal)) if !hit.jump && !outcome.starts_inside => {
                    let normal = if normal.dot(rays[i].1) > 0.0 { -normal } else { normal };
                    Seen { depth: hit.t as f32, normal: normal.as_vec3().to_array(), certificate }
                }
                _ => self.look_at_some(asker, &rays[i..=i])[0],
            }
        };
        Some((0..rays.len()).map(see).collect())
    }

    fn look_at_some(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Seen> {
        asker.rays += rays.len() as u64;
        let mut nearest = vec![Nearest::NOTHING; rays.len()];
        let mut rough: Vec<(usize, Surface)> = Vec::new();
        for (number, instance) in self.prepared.scene.instances().iter().enumerate() {
            let object = &self.prepared.objects[instance.solid()];
            let moved: Vec<ObjectRay> = rays
                .iter()
                .zip(&nearest)
                .map(|(&(origin, direction), n)| ObjectRay { origin, direction, start: 0.0, furthest: n.far })
                .collect();
            object.meetings(asker, &moved, Sought::Nearest, |ray, found| {
                let nearest = &mut nearest[ray];
                nearest.certificate = nearest.certificate.max(found.certificate);
                let Some(meeting) = found.meeting.filter(|meeting| nearest.is_behind(meeting)) else {
                    return;
                };
                let normal = if meeting.jump { None } else { meeting.cap.or(meeting.gradient) };
                let normal = normal.and_then(DVec3::try_normalize).filter(|n| n.is_finite());
                if normal.is_none() {
                    rough.push((ray, Surface::unmoved(number, object.first_part, &meeting)));
                }
                let normal = normal.unwrap_or_default();
                let normal = if normal.dot(rays[ray].1) > 0.0 { -normal } else { normal };
                (nearest.t, nearest.near, nearest.far) = (meeting.t, meeting.near, meeting.far);
                nearest.normal = normal;
            });
        }
        // The last one that a ray met is the nearest.
        let hits: Vec<(Surface, DVec3)> =
            rough.iter().map(|&(ray, surface)| (surface, rays[ray].1)).collect();
        for (&(ray, surface), normal) in rough.iter().zip(self.prepared.normals(asker, &hits)) {
            if nearest[ray].t == surface.t {
                nearest[ray].normal = normal;
            }
        }
        nearest.iter().map(Nearest::seen).collect()
    }

    /// The same where instances are moved, or many.
    fn look_among_instances(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Seen> {
        let answers = self.prepared.surfaces(asker, rays);
        let hit = |(answer, ray): (&Answer, &(DVec3, DVec3))| Some((answer.surface?, ray.1));
        let hits: Vec<(Surface, DVec3)> = answers.iter().zip(rays).filter_map(hit).collect();
        let mut normals = self.prepared.normals(asker, &hits).into_iter();
        let seen = |answer: &Answer| {
            let normal = answer.surface.and_then(|_| normals.next());
            Seen {
                depth: answer.surface.map_or(f32::INFINITY, |surface| surface.t as f32),
                normal: normal.map_or([0.0; 3], |normal| normal.as_vec3().to_array()),
                certificate: answer.certificate,
            }
        };
        answers.iter().map(seen).collect()
    }
}

/// What was seen in a tile: the pixels in which there may be something.
struct Looked {
    pixels: Vec<(u32, u32)>,
    seen: Vec<Seen>,
    evaluations: u64,
}

/// The nearest surface that a ray has met so far.
#[derive(Clone, Copy)]
struct Nearest {
    t: f64,
    near: f64,
    far: f64,
    normal: DVec3,
    certificate: Certificate,
}

impl Nearest {
    const NOTHING: Self = Self {
        t: f64::INFINITY,
        near: f64::INFINITY,
        far: f64::INFINITY,
        normal: DVec3::ZERO,
        certificate: Certificate::Certified,
    };

    /// Whether a surface of a later instance goes before it: of two in the same place, that of the first does.
    fn is_behind(&self, meeting: &Meeting) -> bool {
        let together = meeting.near <= self.far && self.near <= meeting.far;
        !together && meeting.t < self.t
    }

    fn seen(&self) -> Seen {
        Seen { depth: self.t as f32, normal: self.normal.as_vec3().to_array(), certificate: self.certificate }
    }
}

impl Sight {
    /// Writes a pixel, which has been counted as certified.
    fn set(&mut self, pixel: usize, seen: &Seen) {
        (self.depth[pixel], self.normals[pixel]) = (seen.depth, seen.normal);
        self.stats.hits += u64::from(seen.depth.is_finite());
        if seen.certificate != Certificate::Certified {
            self.stats.certified -= 1;
        }
        match seen.certificate {
            Certificate::Certified => {}
            Certificate::Tolerance => self.stats.tolerance += 1,
            Certificate::Undecided => self.stats.undecided += 1,
        }
    }
}

/// The rays of an image of a size in pixels.
struct Lens {
    rays: Rays,
    size: (u32, u32),
}

impl Lens {
    /// The ray through a place in the image, in pixels.
    fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        self.rays.at(x / f64::from(self.size.0), y / f64::from(self.size.1))
    }

    /// Four rays between which those through the pixels of a tile lie: all of them are as long along the middle one, since
    /// only so those between are means of them.
    fn hull(&self, tile: Tile) -> [([f64; 3], [f64; 3]); 4] {
        let (x, y) = tile.sides();
        let [x, y] = [x, y].map(|ends| ends.map(f64::from));
        let middle = self.ray(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])).1;
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
            let (origin, direction) = self.ray(x[i], y[j]);
            (origin.to_array(), (direction / direction.dot(middle)).to_array())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tile::{RenderOptions, render};
    use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
    use fieldstone_scene::{Bounds, Lighting, Settings, Solid, Up};
    use std::sync::Arc;

    fn ball() -> Scene {
        let mut graph = Graph::new();
        let squares = [0, 1, 2].map(|k| {
            let x = graph.input(Input::Coordinate(k));
            graph.square(x)
        });
        let sum = graph.add(squares[0], squares[1]);
        let (sum, one) = (graph.add(sum, squares[2]), graph.constant(1.0));
        let value = graph.sub(sum, one);
        let bounds = Bounds::new(DVec3::splat(-1.1), DVec3::splat(1.1)).unwrap();
        let solid = Solid::new(Field::new(graph, value, Vec::new()), Bindings::new(), bounds);
        let camera = Camera::fitted(&bounds, Up::Z, 1.5);
        let settings = Settings { size: (48, 32), samples: 1, ..Settings::default() };
        Scene::new(vec![solid], camera, Lighting::default(), settings).unwrap()
    }

    #[test]
    fn a_look_is_the_picture_without_its_light() {
        let scene = ball();
        let sight = Viewer::new(&scene).look(scene.camera(), (48, 32));
        let film = render(&scene, &RenderOptions::default()).unwrap().film;
        for (i, (x, y)) in (0..32).flat_map(|y| (0..48).map(move |x| (x, y))).enumerate() {
            let pixel = film.pixel(x, y).unwrap();
            assert_eq!((sight.depth[i], sight.normals[i]), (pixel.depth, pixel.normal), "{x}, {y}");
        }
        assert!(sight.stats.hits > 200 && sight.stats.certified == 48 * 32, "{:?}", sight.stats);
    }

    /// A ball beside a cube that the time moves.
    fn moving(time: f64, graph: &Arc<Graph>, value: NodeId) -> Scene {
        let mut bindings = Bindings::new();
        bindings.set(Input::Time, time);
        let bounds = Bounds::new(DVec3::splat(-2.0), DVec3::splat(2.0)).unwrap();
        let solid = Solid::new(Field::new(graph.clone(), value, Vec::new()), bindings, bounds);
        let camera = Camera::fitted(&bounds, Up::Z, 1.0);
        let settings = Settings { size: (40, 40), samples: 1, ..Settings::default() };
        Scene::new(vec![solid], camera, Lighting::default(), settings).unwrap()
    }

    #[test]
    fn a_changed_scene_looks_as_it_does_to_a_new_viewer() {
        let mut graph = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Coordinate(k)));
        let time = graph.input(Input::Time);
        let moved = graph.sub(x, time);
        let squares = [moved, y, z].map(|n| graph.square(n));
        let sum = graph.add(squares[0], squares[1]);
        let (sum, one) = (graph.add(sum, squares[2]), graph.constant(1.0));
        let ball = graph.sub(sum, one);
        let beside = graph.add(x, one);
        let sides = [beside, y, z].map(|n| graph.abs(n));
        let cube = graph.max(sides[0], sides[1]);
        let cube = graph.max(cube, sides[2]);
        let cube = graph.sub(cube, one);
        let value = graph.min(ball, cube);
        let graph = Arc::new(graph);
        let [before, after] = [0.2, 0.7].map(|time| moving(time, &graph, value));
        let viewer = Viewer::new(&before);
        let camera = before.camera();
        let first = viewer.look(camera, (40, 40));
        let changed = viewer.changed(&after).look(camera, (40, 40));
        let anew = Viewer::new(&after).look(camera, (40, 40));
        assert!(changed.depth == anew.depth && changed.normals == anew.normals);
        assert_ne!(first.depth, changed.depth);
    }

    #[test]
    fn the_camera_may_move() {
        let scene = ball();
        let viewer = Viewer::new(&scene);
        let camera = *scene.camera();
        let nearer = Camera::look_at(camera.eye() * 0.8, DVec3::ZERO, DVec3::Z, camera.projection()).unwrap();
        let nearest = |camera: &Camera| {
            let sight = viewer.look(camera, (33, 33));
            sight.depth.iter().copied().fold(f32::INFINITY, f32::min)
        };
        let moved = f64::from(nearest(&camera) - nearest(&nearer));
        assert!((moved - 0.2 * camera.eye().length()).abs() < 1e-3, "{moved}");
    }
}
