//! Volumes of texels in the scene.

use fieldstone_texel::{Mode, Model, Volume};
use glam::{DAffine3, DMat3};
use std::sync::Arc;

/// A volume of texels that stands somewhere: an affine image of the unit cube. Optical depths stay the same along the image
/// of a way, so that a volume that is made larger lets as much through.
#[derive(Clone, Debug)]
pub struct TexelBox {
    volume: Arc<Volume>,
    world_from_volume: DAffine3,
    volume_from_world: DAffine3,
    model: Model,
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
        sound.then_some(Self { volume, world_from_volume, volume_from_world, model })
    }

    /// The same with flakes that reflect by another model.
    pub fn with_model(self, model: Model) -> Self {
        Self { model, ..self }
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

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_texel::Builder;
    use glam::DVec3;

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
}
