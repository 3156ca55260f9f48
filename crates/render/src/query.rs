//! What rays may ask of a scene.
//!
//! Parts are numbered over all solids: those of the first solid come first, in their order. All instances of a solid have
//! the same parts.

use crate::hierarchy::Hierarchy;
use crate::instances::hierarchy_of;
use crate::object::{Object, Sought};
use crate::owner::Bracket;
use crate::volumes::Volumes;
use fieldstone_field::{F64, Gradients, LANES, Points, Workspace};
use fieldstone_scene::{Appearance, Instance, Scene};
use fieldstone_space::{OctreeMemory, Walker};
use fieldstone_trace::{Certificate, Tracer};
use glam::DVec3;

/// A scene with its programs compiled.
pub(crate) struct Prepared<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) objects: Vec<Object<'s>>,
    /// Of the instances; none if they are few and none is moved.
    pub(crate) hierarchy: Option<Hierarchy>,
    /// Which instances are moved.
    pub(crate) moved: Vec<bool>,
    pub(crate) volumes: Volumes<'s>,
}

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Which part of all solids, counted from 0.
    pub(crate) part: usize,
    /// Which instance, counted from 0.
    pub(crate) instance: usize,
    /// Distance along the ray.
    pub(crate) t: f64,
    /// The bracket around it along the ray: surfaces within it are the same place.
    pub(crate) near: f64,
    pub(crate) far: f64,
    /// The surface, seen from where the ray comes from: the last place that is certainly before it.
    pub(crate) before: DVec3,
    /// A place certainly behind it.
    pub(crate) behind: DVec3,
    /// Whether it is seen from where the field is negative.
    pub(crate) from_inside: bool,
    /// The outward normal of a cap, where the bounds cut the solid, in the solid's space.
    pub(crate) cap: Option<DVec3>,
    /// Whether the sign changes there without a root: the gradient says nothing of the surface.
    pub(crate) jump: bool,
    /// Where the gradient of the field is the normal, in the solid's space.
    pub(crate) gradient_place: DVec3,
    /// The gradient there, if it is known already.
    pub(crate) gradient: Option<DVec3>,
}

/// The answer to a surface query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) surface: Option<Surface>,
    pub(crate) certificate: Certificate,
    pub(crate) cost: u32,
}

/// What a thread needs to ask.
#[derive(Default)]
pub(crate) struct Asker {
    pub(crate) tracer: Tracer,
    pub(crate) walker: Walker,
    gradients: Workspace<F64, Gradients>,
    points: Workspace<F64, Points>,
    pub(crate) owner: crate::owner::Memory,
    pub(crate) conditions: crate::conditions::Memory,
    /// Evaluations of fields so far, over points and sets.
    pub(crate) evaluations: u64,
    /// Rays so far.
    pub(crate) rays: u64,
}

/// Rays, a unit direction from an origin each, and what is sought along them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'q> {
    pub(crate) rays: &'q [(DVec3, DVec3)],
    /// Nothing is sought behind these distances.
    pub(crate) furthest: Option<&'q [f64]>,
    pub(crate) sought: Sought,
}

impl Question<'_> {
    pub(crate) fn furthest(&self, ray: usize) -> f64 {
        self.furthest.map_or(f64::INFINITY, |f| f[ray])
    }
}

impl<'s> Prepared<'s> {
    /// With trees that share `memory`.
    pub(crate) fn new(scene: &'s Scene, memory: &OctreeMemory) -> Self {
        Self::with_former(scene, memory, &[])
    }

    /// The same scene with other values of the inputs of its solids: what does not depend on them is taken over.
    pub(crate) fn changed<'n>(&self, scene: &'n Scene, memory: &OctreeMemory) -> Prepared<'n> {
        Prepared::with_former(scene, memory, &self.objects)
    }

    fn with_former(scene: &'s Scene, memory: &OctreeMemory, former: &[Object<'_>]) -> Self {
        let mut parts = 0;
        let objects = scene.solids().iter().enumerate().map(|(i, solid)| {
            let first = parts;
            parts += solid.parts().len();
            Object::new((solid, first), scene, memory, former.get(i))
        });
        let objects = objects.collect();
        let moved = scene.instances().iter().map(|instance| !instance.is_unmoved()).collect();
        let volumes = Volumes::new(scene, parts);
        Self { scene, objects, hierarchy: hierarchy_of(scene), moved, volumes }
    }

    /// The nearest surface along each ray; rays are a unit direction from an origin, which may lie inside of solids.
    pub(crate) fn surfaces(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)]) -> Vec<Answer> {
        self.ask(asker, &Question { rays, furthest: None, sought: Sought::Nearest })
    }

    /// The nearest surface along each shadow ray that lies before its distance, with the tolerance of shadows: for light
    /// that surfaces let through.
    pub(crate) fn blockers(
        &self,
        asker: &mut Asker,
        rays: &[(DVec3, DVec3)],
        distances: &[f64],
    ) -> Vec<Answer> {
        self.ask(asker, &Question { rays, furthest: Some(distances), sought: Sought::NearestBlocker })
    }

    /// Which rays meet anything before their distances. Undecided rays without a crossing meet nothing.
    pub(crate) fn blocked(&self, asker: &mut Asker, rays: &[(DVec3, DVec3)], distances: &[f64]) -> Vec<bool> {
        let question = Question { rays, furthest: Some(distances), sought: Sought::AnyBlocker };
        self.ask(asker, &question).iter().map(|answer| answer.surface.is_some()).collect()
    }

    fn ask(&self, asker: &mut Asker, question: &Question<'_>) -> Vec<Answer> {
        asker.rays += question.rays.len() as u64;
        let mut answers = self.trace(asker, question);
        if question.sought != Sought::AnyBlocker {
            self.find_owners(asker, &mut answers);
        }
        answers
    }

    /// Finds out which parts of solids surfaces belong to.
    fn find_owners(&self, asker: &mut Asker, answers: &mut [Answer]) {
        for (number, object) in self.objects.iter().enumerate() {
            let Some(owners) = &object.owners else { continue };
            let belongs = |s: &Surface| self.scene.instances()[s.instance].solid() == number;
            let mut surfaces: Vec<&mut Surface> =
                answers.iter_mut().filter_map(|a| a.surface.as_mut().filter(|s| belongs(s))).collect();
            let brackets: Vec<Bracket> = surfaces.iter().map(|s| self.bracket(s)).collect();
            let parts = owners.find(&mut asker.owner, &brackets);
            for (surface, part) in surfaces.iter_mut().zip(parts) {
                surface.part = object.first_part + part;
            }
        }
        asker.evaluations += asker.owner.take_evaluations();
    }

    /// Where a surface certainly is, in the space of its solid.
    fn bracket(&self, surface: &Surface) -> Bracket {
        let place = |p: DVec3| self.frame(surface).place(p);
        let cap = surface.cap.map(|_| place(surface.inside()));
        Bracket { before: place(surface.before), behind: place(surface.behind), cap }
    }

    /// The hits on each solid that is hit.
    fn by_solid(&self, hits: &[(Surface, DVec3)]) -> Vec<(usize, Vec<usize>)> {
        let solid = |i: usize| self.scene.instances()[hits[i].0.instance].solid();
        let mut order: Vec<usize> = (0..hits.len()).collect();
        order.sort_by_key(|&i| solid(i));
        order.chunk_by(|&a, &b| solid(a) == solid(b)).map(|hits| (solid(hits[0]), hits.to_vec())).collect()
    }

    /// How the world and the space of a surface's solid go together.
    fn frame(&self, surface: &Surface) -> Frame<'_> {
        Frame(self.moved[surface.instance].then(|| &self.scene.instances()[surface.instance]))
    }

    /// Unit normals at surfaces, turned against their rays.
    pub(crate) fn normals(&self, asker: &mut Asker, hits: &[(Surface, DVec3)]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; hits.len()];
        for (solid, of_solid) in self.by_solid(hits) {
            let object = &self.objects[solid];
            let (known, unknown): (Vec<usize>, Vec<usize>) =
                of_solid.into_iter().partition(|&i| hits[i].0.gradient.is_some() || hits[i].0.cap.is_some());
            for i in known {
                let gradient = hits[i].0.gradient.unwrap_or_default();
                normals[i] = self.normal(asker, object, &hits[i], gradient);
            }
            for block in unknown.chunks(LANES) {
                for (lane, &i) in block.iter().enumerate() {
                    let point = hits[i].0.gradient_place;
                    for axis in 0..3 {
                        asker.gradients.input(axis, 0)[lane] = point[axis];
                        for direction in 0..3 {
                            let slope = f64::from(u8::from(axis == direction));
                            asker.gradients.input(axis, 1 + direction)[lane] = slope;
                        }
                    }
                }
                asker.gradients.run(&object.roots.sign, block.len());
                asker.evaluations += block.len() as u64;
                for (lane, &i) in block.iter().enumerate() {
                    let slope = |axis: usize| asker.gradients.output(0, 1 + axis)[lane];
                    let gradient = DVec3::new(slope(0), slope(1), slope(2));
                    normals[i] = self.normal(asker, object, &hits[i], gradient);
                }
            }
        }
        normals
    }

    /// The unit normal of a hit with this gradient, turned against its ray.
    fn normal(
        &self,
        asker: &mut Asker,
        object: &Object<'_>,
        (surface, direction): &(Surface, DVec3),
        gradient: DVec3,
    ) -> DVec3 {
        let frame = self.frame(surface);
        let direction = frame.direction(*direction);
        let smooth = || gradient.try_normalize().filter(|n| n.is_finite() && !surface.jump);
        let normal = surface.cap.or_else(smooth);
        let normal = normal.unwrap_or_else(|| {
            let place = frame.place(0.5 * (surface.before + surface.behind));
            object.probe_normal(&mut asker.points, place, direction)
        });
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        frame.world_normal(normal)
    }

    /// How surfaces look.
    pub(crate) fn appearances(&self, asker: &mut Asker, hits: &[(Surface, DVec3)]) -> Vec<Appearance> {
        let mut looks = vec![Appearance::default(); hits.len()];
        for (solid, of_solid) in self.by_solid(hits) {
            let object = &self.objects[solid];
            let count = object.attributes.output_count() - 1;
            for block in of_solid.chunks(LANES) {
                if count > 0 {
                    let normals = if object.reads_normals {
                        self.outward_normals(asker, hits, block)
                    } else {
                        Vec::new()
                    };
                    let place = |i: usize| self.frame(&hits[i].0).place(hits[i].0.inside());
                    fill_points(&mut asker.points, 0, block.iter().map(|&i| place(i)));
                    fill_points(&mut asker.points, 3, normals.into_iter());
                    asker.points.run(&object.attributes, block.len());
                    asker.evaluations += block.len() as u64;
                }
                for (lane, &i) in block.iter().enumerate() {
                    let attributes: Vec<f64> = (1..=count).map(|a| asker.points.output(a, 0)[lane]).collect();
                    let surface = &hits[i].0;
                    let part = &object.solid.parts()[surface.part - object.first_part];
                    looks[i] = part.appearance(&attributes, surface.from_inside);
                }
            }
        }
        looks
    }

    /// The outward unit normals at some of the hits, in the spaces of their solids.
    fn outward_normals(&self, asker: &mut Asker, hits: &[(Surface, DVec3)], some: &[usize]) -> Vec<DVec3> {
        let some: Vec<(Surface, DVec3)> = some.iter().map(|&i| hits[i]).collect();
        let normals = self.normals(asker, &some);
        let outward = |((surface, _), normal): (&(Surface, DVec3), DVec3)| {
            let world = if surface.from_inside { -normal } else { normal };
            self.frame(surface).normal(world)
        };
        some.iter().zip(normals).map(outward).collect()
    }
}

/// Fills three inputs, from `first` on.
fn fill_points(points: &mut Workspace<F64, Points>, first: usize, list: impl Iterator<Item = DVec3>) {
    for (lane, point) in list.enumerate() {
        for axis in 0..3 {
            points.input(first + axis, 0)[lane] = point[axis];
        }
    }
}

/// From the world to the space of a solid, which is the same if nothing moves it.
#[derive(Clone, Copy)]
struct Frame<'i>(Option<&'i Instance>);

impl Frame<'_> {
    fn place(self, world: DVec3) -> DVec3 {
        self.0.map_or(world, |instance| instance.object_from_world().transform_point3(world))
    }

    /// Of unit length, or 0 where the matrix underflows.
    fn direction(self, world: DVec3) -> DVec3 {
        let turn = |i: &Instance| i.object_from_world().transform_vector3(world).normalize_or_zero();
        self.0.map_or(world, turn)
    }

    fn normal(self, world: DVec3) -> DVec3 {
        let turn = |i: &Instance| (i.world_from_object().matrix3.transpose() * world).normalize_or_zero();
        self.0.map_or(world, turn)
    }

    /// The way back.
    fn world_normal(self, normal: DVec3) -> DVec3 {
        let turn = |i: &Instance| (i.object_from_world().matrix3.transpose() * normal).normalize_or_zero();
        self.0.map_or(normal, turn)
    }
}

impl Surface {
    /// Where attributes are looked up: they are those of the solid, and may be unset a hair outside of it.
    fn inside(&self) -> DVec3 {
        if self.from_inside { self.before } else { self.behind }
    }
}

#[cfg(test)]
mod tests;
