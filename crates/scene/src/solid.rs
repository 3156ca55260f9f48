//! Solids: a field, where it is looked at, its parts and what they are made of; and where solids stand.

use crate::ball::Ball;
use crate::bounds::{Bounds, RaySpan};
use crate::material::{Appearance, Material};
use crate::scene::{Method, SceneError, check_lengths};
use fieldstone_field::{Bindings, Field, Input};
use glam::{DAffine3, DVec3};

/// The inputs that stand for the outward unit normal in textures, as coordinates that no model has.
pub const NORMAL_INPUTS: [Input; 3] =
    [Input::Coordinate(u16::MAX - 2), Input::Coordinate(u16::MAX - 1), Input::Coordinate(u16::MAX)];

/// A solid: where its field is negative, within its bounds; or a surface without an inside: where its field is 0.
///
/// The attributes of the field carry everything else that varies over space: the fields of its parts, shares of
/// materials, conditions, and textures refer to them by their index.
#[derive(Clone, Debug)]
pub struct Solid {
    field: Field,
    bindings: Bindings,
    bounds: Bounds,
    clip_ball: Option<Ball>,
    capped: bool,
    surface: bool,
    /// At least one.
    parts: Vec<Part>,
    tree: Tree,
    conditions: Vec<Condition>,
    method: Option<Method>,
    tolerance: Option<f64>,
}

/// A part of a solid, as its materials go.
#[derive(Clone, Debug)]
pub struct Part {
    /// How it is called in the scene.
    pub name: String,
    /// The attribute that is negative inside of the part, if it is not the whole solid.
    pub field: Option<usize>,
    /// What it is made of; the first alone unless there are shares.
    pub materials: Vec<Blended>,
    /// What its surface is made of where it is seen from inside, if that differs.
    pub back: Option<Material>,
}

/// A material with its share at a place where several meet, as in blends.
#[derive(Clone, Debug)]
pub struct Blended {
    /// The material.
    pub material: Material,
    /// The attribute that holds its share, from 0 on; shares need not add up to 1. `None`: always 1.
    pub share: Option<usize>,
}

/// How parts make up a solid. Where surfaces of several parts coincide, the part that stands first owns the place.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Tree {
    /// The part with this number.
    Part(usize),
    /// What lies in any.
    Union(Vec<Tree>),
    /// What lies in all.
    Intersection(Vec<Tree>),
    /// What does not lie in it.
    Complement(Box<Tree>),
}

/// What must hold where a surface is: level-set conditions (Hijazi et al. 2008, §4.4).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Condition {
    /// The attribute that decides.
    pub attribute: usize,
    /// Whether it must be positive; negative otherwise.
    pub positive: bool,
}

impl Tree {
    /// Whether a place is inside; `inside` tells it of the parts.
    pub fn contains(&self, inside: &impl Fn(usize) -> bool) -> bool {
        match self {
            Self::Part(part) => inside(*part),
            Self::Union(trees) => trees.iter().any(|tree| tree.contains(inside)),
            Self::Intersection(trees) => trees.iter().all(|tree| tree.contains(inside)),
            Self::Complement(tree) => !tree.contains(inside),
        }
    }

    /// Whether a region is inside (`Some(true)`), outside, or either for all that is known; `inside` tells it of the
    /// parts.
    pub fn decide(&self, inside: &impl Fn(usize) -> Option<bool>) -> Option<bool> {
        let any = |trees: &[Tree], sought: bool| {
            let mut open = false;
            for tree in trees {
                match tree.decide(inside) {
                    Some(found) if found == sought => return Some(sought),
                    Some(_) => {}
                    None => open = true,
                }
            }
            if open { None } else { Some(!sought) }
        };
        match self {
            Self::Part(part) => inside(*part),
            Self::Union(trees) => any(trees, true),
            Self::Intersection(trees) => any(trees, false),
            Self::Complement(tree) => tree.decide(inside).map(|inside| !inside),
        }
    }

    /// The first part that holds a place of the solid: that it lies in, where it does not stand for what is taken away.
    /// None if the place is not in the solid, or only for being outside of parts.
    pub fn holder(&self, inside: &impl Fn(usize) -> bool) -> Option<usize> {
        self.holder_of(true, inside)
    }

    /// The same where the tree is to contain the place (`sought`), or not to contain it.
    fn holder_of(&self, sought: bool, inside: &impl Fn(usize) -> bool) -> Option<usize> {
        if self.contains(inside) != sought {
            return None;
        }
        match self {
            Self::Part(part) => sought.then_some(*part),
            Self::Union(trees) | Self::Intersection(trees) => {
                trees.iter().filter_map(|tree| tree.holder_of(sought, inside)).min()
            }
            Self::Complement(tree) => tree.holder_of(!sought, inside),
        }
    }

    /// The largest number of a part in it.
    fn largest(&self) -> usize {
        match self {
            Self::Part(part) => *part,
            Self::Union(trees) | Self::Intersection(trees) => {
                trees.iter().map(Tree::largest).max().unwrap_or(0)
            }
            Self::Complement(tree) => tree.largest(),
        }
    }
}

impl Part {
    /// A part of one material that is the whole solid.
    pub fn whole(name: impl Into<String>, material: Material) -> Self {
        let materials = vec![Blended { material, share: None }];
        Self { name: name.into(), field: None, materials, back: None }
    }

    /// What it looks like where the field has these attributes, seen from outside or from inside.
    pub fn appearance(&self, attributes: &[f64], from_inside: bool) -> Appearance {
        if let Some(back) = self.back.as_ref().filter(|_| from_inside) {
            return back.at(attributes);
        }
        let mut total = 0.0;
        let mut mixed = None;
        for Blended { material, share } in &self.materials {
            let share = share.map_or(1.0, |s| attributes.get(s).map_or(0.0, |s| s.max(0.0)));
            if mixed.is_none() || share > 0.0 {
                total += share;
                let look = material.at(attributes);
                let part = if total > 0.0 { (share / total).min(1.0) } else { 0.0 };
                mixed = Some(mixed.map_or(look, |known: Appearance| known.mix(&look, part)));
            }
        }
        mixed.unwrap_or_default()
    }

    fn check(&self, found: usize) -> Result<(), SceneError> {
        let textures = self.materials.iter().map(|m| &m.material).chain(&self.back);
        let textures = textures.map(Material::attributes_needed).max().unwrap_or(0);
        let shares = self.materials.iter().filter_map(|m| m.share).map(|s| s + 1).max().unwrap_or(0);
        let field = self.field.map_or(0, |f| f + 1);
        for (what, needed) in [("a part", field), ("a share", shares), ("a texture", textures)] {
            if needed > found {
                return Err(SceneError::Attributes { what, needed, found });
            }
        }
        Ok(())
    }
}

impl Solid {
    /// The solid of a field, cut off at its bounds, of the default material.
    ///
    /// `bindings` hold the values of all inputs but the first three coordinates.
    pub fn new(field: Field, bindings: Bindings, bounds: Bounds) -> Self {
        Self {
            field,
            bindings,
            bounds,
            clip_ball: None,
            capped: true,
            surface: false,
            parts: vec![Part::whole("solid", Material::default())],
            tree: Tree::Part(0),
            conditions: Vec::new(),
            method: None,
            tolerance: None,
        }
    }

    /// Whether the bounds cut the solid (capped: what is inside ends there with a face) or a window on it (open: one
    /// looks into it where it is cut).
    pub fn with_caps(self, capped: bool) -> Self {
        Self { capped, ..self }
    }

    /// Whether it is a surface without an inside: the places where the field is 0, seen from both sides, those where it
    /// does not change its sign too. Bounds end it and close nothing.
    pub fn with_surface(self, surface: bool) -> Self {
        Self { surface, ..self }
    }

    /// A ball outside of which nothing is drawn: like the bounds it cuts the solid, or is a window on it.
    pub fn with_clip_ball(self, clip_ball: Option<Ball>) -> Self {
        Self { clip_ball, ..self }
    }

    /// Of one material.
    ///
    /// # Errors
    /// A texture that needs more attributes than the field has.
    pub fn with_material(mut self, material: Material) -> Result<Self, SceneError> {
        let back = self.parts.swap_remove(0).back;
        let part = Part { back, ..Part::whole("solid", material) };
        self.with_parts(vec![part], Tree::Part(0))
    }

    /// Another material for the side from which the field is negative, which is seen of surfaces and of open solids.
    ///
    /// # Errors
    /// A texture that needs more attributes than the field has.
    pub fn with_back_material(mut self, back: Material) -> Result<Self, SceneError> {
        for part in &mut self.parts {
            part.back = Some(back.clone());
            part.check(self.field.attributes().len())?;
        }
        Ok(self)
    }

    /// Of several parts, which make up the solid by `tree`; at least one.
    ///
    /// # Errors
    /// No part, a tree that names other parts, parts that refer to attributes that the field does not have.
    pub fn with_parts(self, parts: Vec<Part>, tree: Tree) -> Result<Self, SceneError> {
        if tree.largest() >= parts.len() {
            return Err(SceneError::Part(tree.largest(), parts.len()));
        }
        parts.iter().try_for_each(|part| part.check(self.field.attributes().len()))?;
        Ok(Self { parts, tree, ..self })
    }

    /// Only where conditions hold: a surface that ends there, and that one may look behind. Bounds close nothing then.
    ///
    /// # Errors
    /// A condition on an attribute that the field does not have.
    pub fn with_conditions(self, conditions: Vec<Condition>) -> Result<Self, SceneError> {
        let found = self.field.attributes().len();
        match conditions.iter().map(|c| c.attribute + 1).max() {
            Some(needed) if needed > found => {
                Err(SceneError::Attributes { what: "a condition", needed, found })
            }
            _ => Ok(Self { conditions, ..self }),
        }
    }

    /// With a method and a tolerance of its own instead of those of the scene, where they are given.
    ///
    /// # Errors
    /// Lengths that are not positive and finite.
    pub fn with_method(self, method: Option<Method>, tolerance: Option<f64>) -> Result<Self, SceneError> {
        method.map_or(Ok(()), |method| method.check())?;
        check_lengths(&[("tolerance", tolerance)])?;
        Ok(Self { method, tolerance, ..self })
    }

    /// The field, negative inside.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The values of all inputs but the first three coordinates.
    pub fn bindings(&self) -> &Bindings {
        &self.bindings
    }

    /// Where the solid is, in its own space.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The ball that it is clipped to, if there is one.
    pub fn clip_ball(&self) -> Option<&Ball> {
        self.clip_ball.as_ref()
    }

    /// The part of the line origin + t·direction on which it may be seen, over all t: inside the bounds and the ball.
    pub fn ray_span(&self, origin: DVec3, direction: DVec3) -> Option<RaySpan> {
        let span = self.bounds.ray_span(origin, direction)?;
        match &self.clip_ball {
            None => Some(span),
            Some(ball) => ball.ray_span(origin, direction)?.intersection(&span),
        }
    }

    /// Whether the bounds cut the solid; see [`with_caps`](Self::with_caps). They never cut a surface.
    pub fn is_capped(&self) -> bool {
        self.capped && !self.surface && self.conditions.is_empty()
    }

    /// Whether it is a surface without an inside; see [`with_surface`](Self::with_surface).
    pub fn is_surface(&self) -> bool {
        self.surface
    }

    /// Its parts, at least one.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// How the parts make up the solid.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// What must hold where its surface is; all of them.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Its own method, if it has one.
    pub fn method(&self) -> Option<Method> {
        self.method
    }

    /// Its own tolerance, if it has one, relative to the longest side of its bounds.
    pub fn tolerance(&self) -> Option<f64> {
        self.tolerance
    }
}

/// A solid, moved to a place in the world.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Instance {
    solid: usize,
    world_from_object: DAffine3,
    object_from_world: DAffine3,
}

impl Instance {
    /// The solid with this number where its field puts it.
    pub fn unmoved(solid: usize) -> Self {
        Self { solid, world_from_object: DAffine3::IDENTITY, object_from_world: DAffine3::IDENTITY }
    }

    /// The solid with this number, moved; `None` if the matrix is not finite or cannot be inverted.
    pub fn new(solid: usize, world_from_object: DAffine3) -> Option<Self> {
        let object_from_world = world_from_object.inverse();
        let sound = world_from_object.is_finite() && object_from_world.is_finite();
        sound.then_some(Self { solid, world_from_object, object_from_world })
    }

    /// Which solid it is.
    pub fn solid(&self) -> usize {
        self.solid
    }

    /// From the solid's own space to the world.
    pub fn world_from_object(&self) -> &DAffine3 {
        &self.world_from_object
    }

    /// From the world to the solid's own space.
    pub fn object_from_world(&self) -> &DAffine3 {
        &self.object_from_world
    }

    /// Whether it stands where its field puts it.
    pub fn is_unmoved(&self) -> bool {
        self.world_from_object == DAffine3::IDENTITY
    }

    /// The smallest box in the world around a box in the solid's own space.
    pub fn world_bounds(&self, bounds: &Bounds) -> Bounds {
        let corners = bounds.corners().map(|corner| self.world_from_object.transform_point3(corner));
        let min = corners.iter().fold(DVec3::INFINITY, |m, c| m.min(*c));
        let max = corners.iter().fold(DVec3::NEG_INFINITY, |m, c| m.max(*c));
        // What overflows keeps its old place: it is not to be seen in any case.
        Bounds::new(min, max).unwrap_or(*bounds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Channel, Texture};
    use fieldstone_field::Graph;

    fn unit_box() -> Bounds {
        Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap()
    }

    fn solid(attributes: usize) -> Solid {
        let mut graph = Graph::new();
        let x = graph.input(Input::Coordinate(0));
        Solid::new(Field::new(graph, x, vec![x; attributes]), Bindings::new(), unit_box())
    }

    fn plain(colour: DVec3) -> Material {
        Material::new(colour, 0.0, 1.0).unwrap()
    }

    #[test]
    fn what_refers_to_attributes_is_checked() {
        let texture = Texture { channel: Channel::Colour, first: 0, srgb: true };
        let coloured = Material::default().with_texture(texture);
        let refused = solid(2).with_material(coloured.clone()).map(|_| ());
        assert_eq!(refused, Err(SceneError::Attributes { what: "a texture", needed: 3, found: 2 }));
        assert!(solid(3).with_material(coloured).is_ok());
        let part = Part { field: Some(1), ..Part::whole("a", Material::default()) };
        assert!(solid(1).with_parts(vec![part.clone()], Tree::Part(0)).is_err());
        assert!(matches!(solid(2).with_parts(vec![part], Tree::Part(1)), Err(SceneError::Part(1, 1))));
        assert!(matches!(
            solid(2).with_parts(Vec::new(), Tree::Union(Vec::new())),
            Err(SceneError::Part(0, 0))
        ));
        let condition = Condition { attribute: 2, positive: true };
        assert!(solid(2).with_conditions(vec![condition]).is_err());
        assert!(!solid(3).with_conditions(vec![condition]).unwrap().is_capped());
    }

    #[test]
    fn trees_decide_as_their_parts_do() {
        // a ∪ (b ∩ ¬c)
        let difference = Tree::Intersection(vec![Tree::Part(1), Tree::Complement(Box::new(Tree::Part(2)))]);
        let tree = Tree::Union(vec![Tree::Part(0), difference]);
        for bits in 0..8u32 {
            let inside = |part: usize| bits >> part & 1 == 1;
            let expected = inside(0) || inside(1) && !inside(2);
            assert_eq!(tree.contains(&inside), expected);
            assert_eq!(tree.decide(&|part| Some(inside(part))), Some(expected));
        }
        assert_eq!(tree.decide(&|part| (part == 2).then_some(true)), None);
        assert_eq!(tree.decide(&|part| (part == 0).then_some(true)), Some(true));
        assert_eq!(tree.decide(&|part| (part > 0).then_some(part == 2)), None);
    }

    #[test]
    fn places_are_held_by_the_first_part_that_adds_them() {
        // (a ∪ b) ∩ ¬(c ∩ ¬d)
        let taken = Tree::Intersection(vec![Tree::Part(2), Tree::Complement(Box::new(Tree::Part(3)))]);
        let both = Tree::Union(vec![Tree::Part(1), Tree::Part(0)]);
        let tree = Tree::Intersection(vec![Tree::Complement(Box::new(taken)), both]);
        let holder = |parts: &[usize]| tree.holder(&|part| parts.contains(&part));
        assert_eq!(holder(&[0]), Some(0));
        assert_eq!(holder(&[1]), Some(1));
        assert_eq!(holder(&[0, 1]), Some(0));
        assert_eq!(holder(&[1, 2]), None);
        // What is left of the hole stands for itself: d adds nothing to the outside of b.
        assert_eq!(holder(&[1, 2, 3]), Some(1));
        assert_eq!(holder(&[2]), None);
        assert_eq!(Tree::Complement(Box::new(Tree::Part(0))).holder(&|_| false), None);
    }

    #[test]
    fn shares_mix_materials() {
        let blended = |colour, share| Blended { material: plain(colour), share: Some(share) };
        let materials = vec![blended(DVec3::X, 0), blended(DVec3::Y, 1), blended(DVec3::Z, 2)];
        let part = Part { materials, ..Part::whole("a", Material::default()) };
        let colour = |shares: [f64; 3]| part.appearance(&shares, false).colour;
        assert_eq!(colour([1.0, 0.0, 0.0]), DVec3::X);
        assert_eq!(colour([0.0, 2.0, 0.0]), DVec3::Y);
        assert!((colour([1.0, 1.0, 2.0]) - DVec3::new(0.25, 0.25, 0.5)).length() < 1e-12);
        assert_eq!(colour([0.0, 0.0, f64::NAN]), DVec3::X);
    }

    #[test]
    fn two_sides() {
        let two_sided = solid(0).with_material(plain(DVec3::X)).unwrap();
        let two_sided = two_sided.with_back_material(plain(DVec3::Y)).unwrap();
        let colour = |inside| two_sided.parts()[0].appearance(&[], inside).colour;
        assert_eq!((colour(false), colour(true)), (DVec3::X, DVec3::Y));
    }

    #[test]
    fn instances_move_their_bounds() {
        let quarter_turn = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let moved = DAffine3::from_translation(DVec3::X * 5.0) * quarter_turn;
        let instance = Instance::new(0, moved).unwrap();
        let bounds = Bounds::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).unwrap();
        let found = instance.world_bounds(&bounds);
        assert!((found.min() - DVec3::new(3.0, 0.0, 0.0)).length() < 1e-12);
        assert!((found.max() - DVec3::new(5.0, 1.0, 3.0)).length() < 1e-12);
        assert_eq!(Instance::new(0, DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))), None);
        assert!(Instance::unmoved(0).is_unmoved() && !instance.is_unmoved());
    }
}
