//! Light: what comes back along a ray.
//!
//! Rays are followed in waves (Whitted 1980, breadth first): all rays of a tile look for their surfaces together, then
//! ask for shadows together, and what surfaces mirror or let through becomes the rays of later waves. Each ray carries
//! what its light is multiplied by, the pixel's sample that it belongs to, the transparent bodies that it is in, and how
//! often it may still bounce. Mirrored rays start at a place certainly before the surface, refracted ones at a place
//! certainly behind it, so that the next hit inside a body is the way out: no offsets are needed.
//!
//! Smooth surfaces branch; rough ones send one ray on, chosen by chance. A ray that has bounced as often as it may is
//! not followed; of those whose light counts less than [`FAINTEST`] a few are, for all others. Where many surfaces branch,
//! what counts as faint grows with the rays that a sample has had, so that all ends soon and is right on average. Where something is not opaque, light goes straight through
//! in proportion; that is no bounce. Certificates of pixels are about the first hits of their own rays.

use crate::bsdf::{Chance, Meeting, Onward, Scatter};
use crate::lamps::{Known, Lamps, Lit, Seen, Sent, Wishes, choice};
use crate::media::Media;
use crate::query::{Answer, Asker, Prepared, Surface};
use crate::sampling::Draw;
use crate::sky::Sky;
use crate::volumes;
use fieldstone_scene::{Appearance, Rgb};
use glam::DVec3;

/// Of rays whose light is multiplied by less than this, in every component, only some are followed.
const FAINTEST: f64 = 1.0 / 8192.0;

/// From so many rays of a sample on, what counts as faint grows, with their third power: after eight times as many about
/// sixteen are followed at a time, after sixteen times as many two.
const MANY: u32 = 40;

/// How many surfaces a ray passes straight, where they are not opaque, before it ends.
const MOST_PASSED: u16 = 256;

/// About how many rays of a wave look for surfaces together.
const TOGETHER: usize = 4096;

/// The seeds of rays that part from each other.
mod branch {
    pub(super) const STRAIGHT: u32 = 8;
    pub(super) const THROUGH: u32 = 9;
    pub(super) const MIRROR: u32 = 10;
    pub(super) const VOLUMES: u32 = 11;
}

/// A ray from the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EyeRay {
    pub(crate) origin: DVec3,
    /// A unit vector.
    pub(crate) direction: DVec3,
    /// What chance depends on.
    pub(crate) draw: Draw,
}

/// What a ray brings back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) answer: Answer,
    /// Towards the eye; 0 on a miss.
    pub(crate) normal: DVec3,
    /// Linear RGB, without the background of the picture.
    pub(crate) colour: Rgb,
    /// How much of the background is covered.
    pub(crate) alpha: f64,
    /// The variance of its luminance by the choice of places on lamps and of directions of the sky.
    pub(crate) variance: f64,
    /// Where a volume hides half of what is behind, before the first surface: the distance, and its number among the parts.
    pub(crate) volume: Option<(f64, usize)>,
    /// Whether other rays might have been followed, so that its variance is not known.
    pub(crate) by_chance: bool,
    /// How many rays were followed for it.
    followed: u32,
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
struct Path {
    origin: DVec3,
    direction: DVec3,
    /// Which of the rays from the eye it belongs to.
    sample: usize,
    /// What its light is multiplied by.
    throughput: Rgb,
    media: Media,
    bounces_left: u32,
    passed: u16,
    /// Whether it is still the line of sight, straight from the eye.
    of_sight: bool,
    sees_lamps: bool,
    by_chance: bool,
    draw: Draw,
}

/// What a thread needs to follow light.
#[derive(Default)]
pub(crate) struct Worker {
    pub(crate) asker: Asker,
    wishes: Wishes,
}

/// Rays that look for surfaces together.
struct Wave<'w> {
    paths: &'w [Path],
    /// Which of them met a surface, and the surfaces, with the directions from which they are seen.
    hits: Vec<usize>,
    surfaces: Vec<(Surface, DVec3)>,
}

/// Follows light through a scene.
pub(crate) struct Integrator<'s, 'p> {
    prepared: &'p Prepared<'s>,
    sky: &'p Sky<'s>,
    lamps: Lamps<'s, 'p>,
    /// [`MANY`], but in tests.
    many: u32,
}

impl<'s, 'p> Integrator<'s, 'p> {
    pub(crate) fn new(prepared: &'p Prepared<'s>, sky: &'p Sky<'s>) -> Self {
        Self { prepared, sky, lamps: Lamps::new(prepared, sky), many: MANY }
    }

    /// What comes back along each ray from the eye.
    pub(crate) fn radiance(&self, worker: &mut Worker, rays: &[EyeRay]) -> Vec<Sample> {
        let bounces_left = self.prepared.scene.settings().bounces;
        let start = |(sample, ray): (usize, &EyeRay)| Path {
            origin: ray.origin,
            direction: ray.direction,
            sample,
            throughput: DVec3::ONE,
            media: Media::default(),
            bounces_left,
            passed: 0,
            of_sight: true,
            sees_lamps: true,
            by_chance: false,
            draw: ray.draw,
        };
        let mut first: Vec<Path> = rays.iter().enumerate().map(start).collect();
        let answers = self.surfaces(&mut worker.asker, &first);
        let empty = |answer: &Answer| Sample {
            answer: *answer,
            normal: DVec3::ZERO,
            colour: DVec3::ZERO,
            alpha: 0.0,
            variance: 0.0,
            volume: None,
            by_chance: false,
            followed: 1,
        };
        let mut samples: Vec<Sample> = answers.iter().map(empty).collect();
        let mut waiting = self.follow(worker, &mut first, &answers, &mut samples);
        while !waiting.is_empty() {
            // The last ones first: what waits stays little, however rays branch.
            let mut wave = waiting.split_off(waiting.len().saturating_sub(TOGETHER));
            let answers = self.surfaces(&mut worker.asker, &wave);
            waiting.extend(self.follow(worker, &mut wave, &answers, &mut samples));
        }
        samples
    }

    fn surfaces(&self, asker: &mut Asker, paths: &[Path]) -> Vec<Answer> {
        let rays: Vec<(DVec3, DVec3)> = paths.iter().map(|p| (p.origin, p.direction)).collect();
        self.prepared.surfaces(asker, &rays)
    }

    /// Adds what rays bring back from what they met to their samples; the rays from which more light comes.
    fn follow(
        &self,
        worker: &mut Worker,
        paths: &mut [Path],
        answers: &[Answer],
        samples: &mut [Sample],
    ) -> Vec<Path> {
        let (mut hits, mut surfaces) = (Vec::new(), Vec::new());
        for (i, (path, answer)) in paths.iter_mut().zip(answers).enumerate() {
            let surface = answer.surface.map_or(f64::INFINITY, |s| s.t);
            let lamp = self.met_lamp(path, surface);
            // Volumes go before what is met, front to back.
            self.cross_volumes(worker, path, lamp.map_or(surface, |(t, _)| t), samples);
            match (lamp, answer.surface) {
                (Some((t, light)), _) => path.after(t).bring(light, &mut samples[path.sample]),
                (None, Some(surface)) => {
                    hits.push(i);
                    surfaces.push((surface, path.direction));
                }
                (None, None) => self.leaves(path, samples),
            }
        }
        self.scatter(worker, &Wave { paths, hits, surfaces }, samples)
    }

    /// Adds the light that volumes scatter before a ray has gone so far, and takes from the ray what they hide.
    fn cross_volumes(&self, worker: &mut Worker, path: &mut Path, furthest: f64, samples: &mut [Sample]) {
        let Prepared { volumes: boxes, .. } = self.prepared;
        if boxes.is_empty() {
            return;
        }
        let Worker { asker, wishes } = worker;
        let mut passes = 1.0;
        let mut known = Known::default();
        for (number, piece) in (0..).zip(boxes.pieces((path.origin, path.direction), furthest)) {
            let middle = 0.5 * (piece.from + piece.to);
            let lit = Lit {
                piece: &piece,
                flakes: piece.flakes(path.direction),
                ray: (path.origin, path.direction),
                sample: path.sample,
                weight: path.after(middle).throughput * passes,
                draw: path.draw.branch(branch::VOLUMES).branch(number),
            };
            let ambient = self.lamps.ask_in_volume(wishes, &lit, &mut known);
            let sample = &mut samples[path.sample];
            sample.colour += ambient;
            let before = passes;
            passes *= (-piece.depth).exp();
            if path.of_sight && path.passed == 0 && before >= 0.5 && passes < 0.5 {
                sample.volume = Some((piece.half_way(before), piece.part));
            }
            self.lamps.grant(asker, wishes, false, |sample, sent| samples[sample].get(sent));
            if passes < volumes::FAINTEST {
                passes = 0.0;
                break;
            }
        }
        if path.of_sight {
            samples[path.sample].alpha += path.throughput.x * (1.0 - passes);
        }
        path.throughput *= passes;
    }

    /// The nearest lamp that is a body and that a ray meets before it has gone so far, and its light.
    fn met_lamp(&self, path: &Path, furthest: f64) -> Option<(f64, Rgb)> {
        if !path.sees_lamps {
            return None;
        }
        let lamps = self.prepared.scene.lighting().lights.iter().filter(|lamp| lamp.is_visible());
        let met = lamps.filter_map(|lamp| lamp.hit(path.origin, path.direction));
        met.filter(|(t, _)| *t < furthest).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Adds what a ray sees that hits nothing.
    fn leaves(&self, path: &Path, samples: &mut [Sample]) {
        let sample = &mut samples[path.sample];
        if !path.of_sight {
            sample.colour += path.throughput * self.sky.light(path.origin, path.direction);
        } else if let Some(light) = self.sky.seen(path.origin, path.direction) {
            path.bring(light, sample);
        }
    }

    fn scatter(&self, worker: &mut Worker, wave: &Wave<'_>, samples: &mut [Sample]) -> Vec<Path> {
        let Worker { asker, wishes } = worker;
        let normals = self.prepared.normals(asker, &wave.surfaces);
        let looks = self.prepared.appearances(asker, &wave.surfaces);
        let mut onward = Vec::new();
        for (hit, &path) in wave.hits.iter().enumerate() {
            let surface = &wave.surfaces[hit].0;
            let path = wave.paths[path].after(surface.t);
            let crossing = self.crossing(&path, surface, normals[hit], &looks[hit]);
            let ambient = self.lamps.ask(wishes, &crossing.seen());
            let sample = &mut samples[path.sample];
            crossing.shine(ambient, sample);
            let faintest = self.faintest(sample.followed);
            let before = onward.len();
            crossing.go_on(faintest, sample, &mut onward);
            sample.followed += (onward.len() - before) as u32;
            self.lamps.grant(asker, wishes, false, |sample, sent| samples[sample].get(sent));
        }
        self.lamps.grant(asker, wishes, true, |sample, sent| samples[sample].get(sent));
        onward
    }

    /// Of rays whose light is multiplied by less than this only some are followed, after so many.
    fn faintest(&self, followed: u32) -> f64 {
        let excess = f64::from(followed) / f64::from(self.many);
        FAINTEST * excess.powi(3).max(1.0)
    }

    fn crossing<'c>(
        &self,
        path: &'c Path,
        surface: &'c Surface,
        normal: DVec3,
        look: &'c Appearance,
    ) -> Crossing<'c> {
        let solid = &self.prepared.scene.solids()[self.prepared.scene.instances()[surface.instance].solid()];
        // A surface without an inside, or one with holes in it, has the same on both sides.
        let thin = solid.is_surface() || !solid.conditions().is_empty();
        let passage = path.media.passage(surface.instance, look, surface.from_inside);
        let (eta, beyond) = if thin { (look.index, path.media) } else { (passage.eta, passage.beyond) };
        let meeting = Meeting { direction: path.direction, normal, eta, thin };
        let outward = if surface.from_inside { -normal } else { normal };
        let scatter = Scatter::new(look, &meeting, outward);
        Crossing { path, surface, normal, look, scatter, beyond }
    }
}

/// A ray at a surface.
struct Crossing<'c> {
    /// As it arrives.
    path: &'c Path,
    surface: &'c Surface,
    normal: DVec3,
    look: &'c Appearance,
    scatter: Scatter,
    /// The bodies that the ray is in if it goes through.
    beyond: Media,
}

impl Crossing<'_> {
    fn seen(&self) -> Seen<'_> {
        Seen {
            place: self.surface.before,
            normal: self.normal,
            scatter: &self.scatter,
            sample: self.path.sample,
            weight: self.path.throughput * self.look.opacity,
            draw: self.path.draw,
            by_chance: self.path.by_chance,
        }
    }

    /// Adds the light that needs no further ray: ambient light, and what the surface gives off.
    fn shine(&self, ambient: Rgb, sample: &mut Sample) {
        if self.path.of_sight && self.path.passed == 0 {
            sample.normal = self.normal;
        }
        let unlit = if let Scatter::Unlit(colour) = self.scatter { colour } else { DVec3::ZERO };
        self.path.bring_share(ambient + unlit + self.look.emission, self.look.opacity, sample);
    }

    /// Adds the rays from which more light comes; of those fainter than `faintest` only some.
    fn go_on(&self, faintest: f64, sample: &mut Sample, onward: &mut Vec<Path>) {
        let (path, look) = (self.path, self.look);
        if look.opacity < 1.0 && path.passed < MOST_PASSED {
            let throughput = path.throughput * (1.0 - look.opacity);
            let (passed, draw) = (path.passed + 1, path.draw.branch(branch::STRAIGHT));
            let straight = Path { origin: self.surface.behind, throughput, passed, draw, ..*path };
            onward.extend(straight.if_bright(faintest, sample));
        }
        if path.bounces_left == 0 {
            return;
        }
        // Also where the first ray is lost among the facets: another sample will see light there.
        sample.by_chance |= self.scatter.is_rough();
        let chance = Chance { facet: path.draw.point(choice::FACET), kind: path.draw.point(choice::KIND).0 };
        for ray in self.scatter.onward(chance).into_iter().flatten() {
            onward.extend(self.bounced(&ray).if_bright(faintest, sample));
        }
    }

    fn bounced(&self, ray: &Onward) -> Path {
        let path = self.path;
        let (origin, media) = match ray.through {
            true => (self.surface.behind, self.beyond),
            false => (self.surface.before, path.media),
        };
        Path {
            origin,
            direction: ray.direction,
            throughput: path.throughput * ray.weight * self.look.opacity,
            media,
            bounces_left: path.bounces_left - 1,
            of_sight: false,
            sees_lamps: ray.sees_lamps(),
            by_chance: path.by_chance || ray.rough,
            draw: path.draw.branch(if ray.through { branch::THROUGH } else { branch::MIRROR }),
            ..*path
        }
    }
}

impl Sample {
    /// Adds the light of a lamp or of the sky.
    fn get(&mut self, sent: Sent) {
        self.colour += sent.colour;
        self.variance += sent.variance;
    }
}

impl Path {
    /// After a length of its way.
    fn after(&self, length: f64) -> Self {
        Self { throughput: self.throughput * self.media.transmittance(length), ..*self }
    }

    /// The ray, if its light counts enough. Fainter rays are kept by chance, in proportion, and count for those that are
    /// not: so nothing is lost on average.
    fn if_bright(self, faintest: f64, sample: &mut Sample) -> Option<Self> {
        let share = self.throughput.max_element() / faintest;
        if share >= 1.0 {
            return Some(self);
        }
        sample.by_chance |= faintest > FAINTEST;
        (self.draw.unrelated() < share).then(|| Self { throughput: self.throughput / share, ..self })
    }

    /// Adds light that hides all that is behind.
    fn bring(&self, light: Rgb, sample: &mut Sample) {
        self.bring_share(light, 1.0, sample);
    }

    /// Adds light of something that hides this share of what is behind.
    fn bring_share(&self, light: Rgb, share: f64, sample: &mut Sample) {
        sample.colour += self.throughput * light * share;
        if self.of_sight {
            // On the line of sight nothing but what was passed straight has dimmed the light, in all components alike.
            sample.alpha += self.throughput.x * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_field::{Bindings, Field, Graph, Input};
    use fieldstone_scene::{
        Background, Bounds, Camera, Instance, Lighting, Material, Scene, Settings, Solid, Up,
    };
    use glam::DAffine3;

    /// Balls in a row, whose surfaces send every ray on in three directions, under a sky of two colours.
    fn balls(bounces: u32) -> Scene {
        let mut g = Graph::new();
        let mut sum = g.constant(-1.0);
        for axis in 0..3 {
            let x = g.input(Input::Coordinate(axis));
            let square = g.square(x);
            sum = g.add(sum, square);
        }
        let bounds = Bounds::new(DVec3::splat(-1.5), DVec3::splat(1.5)).unwrap();
        let look = Appearance {
            colour: DVec3::ONE,
            reflection: 0.5,
            transmission: 0.5,
            opacity: 0.7,
            ..Appearance::default()
        };
        let solid = Solid::new(Field::new(g, sum, Vec::new()), Bindings::new(), bounds);
        let solid = solid.with_material(Material::of(look).unwrap()).unwrap();
        let at = |x: f64| Instance::new(0, DAffine3::from_translation(DVec3::new(x, 0.0, 0.0))).unwrap();
        let lighting = Lighting {
            ambient: DVec3::splat(0.2),
            background: Background { top: DVec3::ONE, bottom: DVec3::new(0.2, 0.5, 0.8) },
            ..Lighting::default()
        };
        let settings = Settings { bounces, ..Settings::default() };
        let camera = Camera::fitted(&bounds, Up::Z, 1.0);
        Scene::with_instances(vec![solid], vec![at(0.0), at(2.2), at(4.4)], camera, lighting, settings)
            .unwrap()
    }

    fn samples(scene: &Scene, many: u32, rays: u32) -> Vec<Sample> {
        let (prepared, sky) =
            (Prepared::new(scene, &fieldstone_space::OctreeMemory::default()), Sky::new(scene));
        let integrator = Integrator { many, ..Integrator::new(&prepared, &sky) };
        let direction = DVec3::new(1.0, 0.03, 0.05).normalize();
        let draw = |index| Draw { seed: 7, index, is_first: index == 0 };
        let ray = |index| EyeRay { origin: DVec3::new(-4.0, 0.1, 0.2), direction, draw: draw(index) };
        let rays: Vec<EyeRay> = (0..rays).map(ray).collect();
        integrator.radiance(&mut Worker::default(), &rays)
    }

    #[test]
    fn rays_that_are_left_out_change_no_mean() {
        let scene = balls(5);
        let all = samples(&scene, u32::MAX, 1)[0];
        let some = samples(&scene, 4, 4000);
        let mean = some.iter().map(|s| s.colour).sum::<DVec3>() / 4000.0;
        let alpha = some.iter().map(|s| s.alpha).sum::<f64>() / 4000.0;
        assert!((mean - all.colour).abs().max_element() < 0.01, "{mean} is not {}", all.colour);
        assert!((alpha - all.alpha).abs() < 0.01, "{alpha} is not {}", all.alpha);
        let most = some.iter().map(|s| s.followed).max().unwrap();
        assert!(all.followed > 4 * most, "{} and {most}", all.followed);
        assert!(!all.by_chance && some.iter().all(|s| s.by_chance));
    }

    #[test]
    fn the_rays_of_a_sample_are_bounded() {
        let most = samples(&balls(64), MANY, 16).iter().map(|s| s.followed).max().unwrap();
        assert!((MANY..32 * MANY).contains(&most), "{most}");
    }
}
