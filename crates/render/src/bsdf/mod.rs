//! What a surface does with light at a point.
//!
//! A [`Scatter`] is worked out once for each hit. It answers two questions: how much of a lamp's light is sent back along
//! the ray, and from where else light has to be fetched. Smooth mirrors and boundaries branch: a mirrored and a refracted
//! ray. Rough ones are sampled: one ray, whose direction and kind are chosen by chance, and which is right on average.
//!
//! Light is counted as it arrives at the eye, so that no factor of η² appears: radiance over η² is what stays the same
//! along a ray, and a ray that enters glass leaves it again.

mod blinn;
pub(crate) mod fresnel;
pub(crate) mod ggx;
mod microfacets;

pub(crate) use blinn::Highlight;
use fieldstone_scene::{Appearance, Rgb, Shading};
use glam::DVec3;

/// How a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// The unit vector of the ray.
    pub(crate) direction: DVec3,
    /// The unit normal against the ray.
    pub(crate) normal: DVec3,
    /// The refractive index beyond the surface, relative to that before it.
    pub(crate) eta: f64,
    /// Whether nothing is beyond but the same again: light that goes through is not bent.
    pub(crate) thin: bool,
}

impl Meeting {
    fn cosine(&self) -> f64 {
        (-self.direction.dot(self.normal)).clamp(0.0, 1.0)
    }

    /// The direction of light that goes through a boundary with this normal.
    fn beyond(&self, normal: DVec3) -> Option<DVec3> {
        if self.thin { Some(self.direction) } else { fresnel::refracted(self.direction, normal, self.eta) }
    }
}

/// A ray from which more light comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Onward {
    pub(crate) direction: DVec3,
    /// What its light is multiplied by.
    pub(crate) weight: Rgb,
    /// Whether it goes on beyond the surface.
    pub(crate) through: bool,
    /// Whether it was chosen by chance.
    pub(crate) rough: bool,
}

impl Onward {
    /// Whether lamps that are bodies are seen along it. Those that light a rough surface are counted there already.
    pub(crate) fn sees_lamps(&self) -> bool {
        self.through || !self.rough
    }
}

/// Numbers from 0 to 1 for the choices of a rough surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chance {
    /// Which facet.
    pub(crate) facet: (f64, f64),
    /// Whether it mirrors.
    pub(crate) kind: f64,
}

/// What a surface does with light at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scatter {
    /// Blinn-Phong.
    Blinn(blinn::Blinn),
    /// Microfacets, or the smooth limit of them.
    Facets(microfacets::Facets),
    /// A colour that no light changes.
    Unlit(Rgb),
}

impl Scatter {
    /// What a surface that looks like this does where a ray meets it.
    pub(crate) fn new(look: &Appearance, meeting: &Meeting, outward: DVec3) -> Self {
        match look.shading {
            Shading::BlinnPhong { normalised } => Self::Blinn(blinn::Blinn::new(look, meeting, normalised)),
            Shading::Ggx { compensated } => {
                Self::Facets(microfacets::Facets::new(look, meeting, compensated))
            }
            Shading::Gradient => Self::Unlit(0.5 * (outward + DVec3::ONE)),
        }
    }

    /// What is seen of light that comes evenly from everywhere and is scattered evenly: the albedo of that part.
    pub(crate) fn diffuse(&self) -> Rgb {
        match self {
            Self::Blinn(blinn) => blinn.diffuse,
            Self::Facets(facets) => facets.diffuse,
            Self::Unlit(_) => DVec3::ZERO,
        }
    }

    /// The highlight in which a surface reflects the light of an environment; rays onward bring what others reflect.
    pub(crate) fn highlight(&self) -> Option<Highlight> {
        match self {
            Self::Blinn(blinn) => blinn.highlight(),
            Self::Facets(_) | Self::Unlit(_) => None,
        }
    }

    /// What is seen if the light of a lamp comes from `to_light`, on the side of the normal; 1 is a white, matt surface
    /// that faces the lamp.
    pub(crate) fn respond(&self, to_light: DVec3) -> Rgb {
        match self {
            Self::Blinn(blinn) => blinn.respond(to_light),
            Self::Facets(facets) => facets.respond(to_light),
            Self::Unlit(_) => DVec3::ZERO,
        }
    }

    /// Whether lamps may make a difference.
    pub(crate) fn is_lit(&self) -> bool {
        !matches!(self, Self::Unlit(_))
    }

    /// Whether the ray onward is chosen by chance, and perhaps none is.
    pub(crate) fn is_rough(&self) -> bool {
        matches!(self, Self::Facets(facets) if facets.is_rough())
    }

    /// The rays from which more light comes: at most two.
    pub(crate) fn onward(&self, chance: Chance) -> [Option<Onward>; 2] {
        match self {
            Self::Blinn(blinn) => blinn.onward(),
            Self::Facets(facets) => facets.onward(chance),
            Self::Unlit(_) => [None, None],
        }
    }
}

/// What light that goes through a surface is multiplied by for its colour: a body has two surfaces.
pub(crate) fn tint(colour: Rgb) -> Rgb {
    DVec3::new(colour.x.sqrt(), colour.y.sqrt(), colour.z.sqrt())
}

/// The ray of a smooth mirror.
fn mirror_ray(meeting: &Meeting, weight: Rgb) -> Onward {
    let direction = fresnel::mirrored(meeting.direction, meeting.normal);
    Onward { direction, weight, through: false, rough: false }
}

/// The ray through a smooth boundary; none under total reflection.
fn through_ray(meeting: &Meeting, weight: Rgb) -> Option<Onward> {
    let direction = meeting.beyond(meeting.normal)?;
    Some(Onward { direction, weight, through: true, rough: false })
}
