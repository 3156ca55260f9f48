//! Volumes of texels in the scene.

use crate::bounds::Bounds;
use fieldstone_texel::{Mode, Model, Ray, Volume};
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// How often a volume may stand side by side with itself along an axis.
pub const MAX_REPEATS: u32 = 1000;

/// A volume of texels that stands somewhere: an affine image of the unit cube, or of several side by side. Optical depths
/// stay the same along the image of a way, so that a volume that is made larger lets as much through.
#[derive(Clone, Debug)]
pub struct TexelBox {
    volume: Arc<Volume>,
    world_from_volume: DAffine3,
    volume_from_world: DAffine3,
    model: Model,
    repeats: DVec3,
    density: f64,
    finest_level: f32,
    bounds: Bounds,
}

impl TexelBox {
    /// A volume moved from the unit cube; `None` if the matrix is not finite or cannot be inverted. Its flakes are mirrors
    /// and matt, or reflect by Phong's model if it was filtered by the rules of 1995.
    pub fn new(volume: Arc<Volume>, world_from_volume: DAffine3) -> Option<Self> {
        let volume_from_world = world_from_volume.inverse();
        let sound = world_from_volume.is_finite() && volume_from_world.is_finite();
        let model = match volume.mode() {
            Mode::Sggx => Model::Microflakes,
            Mode::Neyret1995 => Model::Phong(volume.phong()),
        };
        let repeats = DVec3::ONE;
        let bounds = world_bounds(&world_from_volume, repeats).filter(|_| sound)?;
        let (density, finest_level) = (1.0, 0.0);
        Some(Self {
            volume,
            world_from_volume,
            volume_from_world,
            model,
            repeats,
            density,
            finest_level,
            bounds,
        })
    }

    /// The same with flakes that reflect by another model.
    pub fn with_model(self, model: Model) -> Self {
        Self { model, ..self }
    }

    /// So many cubes side by side along x, y and z; `None` if a number is not from 1 to [`MAX_REPEATS`], or above 1 along an axis
    /// that is not cyclic, where sides would not fit.
    pub fn with_repeats(self, repeats: [u32; 3]) -> Option<Self> {
        let fits =
            |(count, cyclic): (&u32, bool)| *count == 1 || (cyclic && (1..=MAX_REPEATS).contains(count));
        let sound = repeats.iter().zip(self.volume.cyclic()).all(fits);
        let repeats = DVec3::from(repeats.map(f64::from));
        let bounds = world_bounds(&self.world_from_volume, repeats).filter(|_| sound)?;
        Some(Self { repeats, bounds, ..self })
    }

    /// The same with all optical depths multiplied by a factor; `None` if it is not finite and above 0.
    pub fn with_density(self, density: f64) -> Option<Self> {
        (density > 0.0 && density.is_finite()).then_some(Self { density, ..self })
    }

    /// The same, but no finer level than this is looked at; what is not a number stands for 0.
    pub fn with_finest_level(self, level: f32) -> Self {
        Self { finest_level: level.max(0.0), ..self }
    }

    /// The volume.
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// From the unit cube to the world.
    pub fn world_from_volume(&self) -> &DAffine3 {
        &self.world_from_volume
    }

    /// From the world to the unit cube.
    pub fn volume_from_world(&self) -> &DAffine3 {
        &self.volume_from_world
    }

    /// How flakes reflect.
    pub fn model(&self) -> Model {
        self.model
    }

    /// What optical depths are multiplied by.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// The finest level that is looked at.
    pub fn finest_level(&self) -> f32 {
        self.finest_level
    }

    /// The smallest box around it in the world.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// From where to where a ray in the space of the unit cube is inside.
    pub fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        Ray { origin: ray.origin / self.repeats, direction: ray.direction / self.repeats }.span()
    }

    /// The map of directions to the world, scaled so that it keeps volumes as they are.
    pub fn turn(&self) -> DMat3 {
        let map = self.world_from_volume.matrix3;
        map * map.determinant().abs().cbrt().recip()
    }

    /// The mean width in the unit cube of what is 1 wide in the world.
    pub fn scale(&self) -> f64 {
        self.volume_from_world.matrix3.determinant().abs().cbrt()
    }
}

/// The smallest box around so many unit cubes in the world.
fn world_bounds(world_from_volume: &DAffine3, repeats: DVec3) -> Option<Bounds> {
    let corners = Bounds::new(DVec3::ZERO, repeats).ok()?.corners();
    let corners = corners.map(|corner| world_from_volume.transform_point3(corner));
    let min = corners.iter().fold(DVec3::INFINITY, |m, c| m.min(*c));
    let max = corners.iter().fold(DVec3::NEG_INFINITY, |m, c| m.max(*c));
    Bounds::new(min, max).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_texel::Builder;
    fn empty(mode: Mode) -> Arc<Volume> {
        Arc::new(Builder::new(2).unwrap().build(mode).unwrap())
    }

    #[test]
    fn a_box_can_be_moved_back() {
        let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
        assert!(TexelBox::new(empty(Mode::Sggx), flat).is_none());
        let large =
            TexelBox::new(empty(Mode::Sggx), DAffine3::from_scale(DVec3::new(2.0, 8.0, 4.0))).unwrap();
        assert!((large.scale() - 0.25).abs() < 1e-15);
        assert!((large.turn().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flakes_of_1995_reflect_by_phong() {
        let model = |mode| TexelBox::new(empty(mode), DAffine3::IDENTITY).map(|texels| texels.model());
        assert_eq!(model(Mode::Sggx), Some(Model::Microflakes));
        assert!(matches!(model(Mode::Neyret1995), Some(Model::Phong(_))));
    }

    #[test]
    fn cyclic_volumes_stand_side_by_side() {
        let volume =
            Arc::new(Builder::new(2).unwrap().cyclic([true, false, false]).build(Mode::Sggx).unwrap());
        let single = TexelBox::new(volume, DAffine3::from_scale(DVec3::splat(2.0))).unwrap();
        assert!(single.clone().with_repeats([1, 2, 1]).is_none());
        assert!(single.clone().with_repeats([0, 1, 1]).is_none());
        let row = single.with_repeats([3, 1, 1]).unwrap();
        assert_eq!((row.bounds().min(), row.bounds().max()), (DVec3::ZERO, DVec3::new(6.0, 2.0, 2.0)));
        let ray = Ray { origin: DVec3::new(-1.0, 0.5, 0.5), direction: DVec3::X };
        assert_eq!(row.span(&ray), Some((1.0, 4.0)));
    }

    #[test]
    fn densities_are_positive() {
        let with = |density| {
            let cube = TexelBox::new(empty(Mode::Sggx), DAffine3::IDENTITY).unwrap();
            cube.with_density(density).map(|texels| texels.density())
        };
        assert_eq!(
            (with(0.5), with(0.0), with(f64::NAN), with(f64::INFINITY)),
            (Some(0.5), None, None, None)
        );
    }
}
