//! From drafts to solids: what parts, materials and conditions refer to becomes attributes of one field.

use super::compose::PartDraft;
use super::material::MaterialDraft;
use fieldstone_field::NodeId;
use fieldstone_scene::{Blended, Material, MaterialError, Part, Texture};

/// The attributes of a field.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    pub(super) nodes: Vec<NodeId>,
}

impl Attributes {
    /// The place where these stand one after the other.
    pub(super) fn place(&mut self, wanted: &[NodeId]) -> usize {
        let known = self.nodes.windows(wanted.len().max(1)).position(|some| some == wanted);
        known.unwrap_or_else(|| {
            self.nodes.extend(wanted);
            self.nodes.len() - wanted.len()
        })
    }

    fn material(&mut self, draft: &MaterialDraft) -> Result<Material, MaterialError> {
        let material = Material::of(draft.base)?;
        Ok(draft.textures.iter().fold(material, |material, texture| {
            let first = self.place(&texture.nodes);
            material.with_texture(Texture { channel: texture.channel, first, srgb: texture.srgb })
        }))
    }

    /// A part; `whole` is the field of the solid.
    pub(super) fn part(&mut self, draft: &PartDraft, whole: NodeId) -> Result<Part, MaterialError> {
        let mut materials = Vec::new();
        for (material, share) in &draft.materials {
            let share = share.map(|share| self.place(&[share]));
            materials.push(Blended { material: self.material(material)?, share });
        }
        let back = draft.back.as_ref().map(|back| self.material(back)).transpose()?;
        let field = (draft.field != whole).then(|| self.place(&[draft.field]));
        Ok(Part { name: draft.name.clone(), field, materials, back })
    }
}
