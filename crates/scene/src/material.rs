//! What surfaces are made of: numbers at a point, constant or textured.

use crate::colour::{Rgb, srgb_to_linear};
use crate::text::Number;
use glam::DVec3;

/// How light is scattered.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Shading {
    /// Diffuse·cos θ + specular·(n·h)^shininess (Blinn 1977).
    BlinnPhong {
        /// Whether highlights are scaled by (shininess + 8) / 8π and what is scattered never exceeds what arrives; if
        /// not, `specular` is the brightness of the highlight itself.
        normalised: bool,
    },
    /// Microfacets after Trowbridge and Reitz ("GGX", Walter et al. 2007): rough or smooth, metal or dielectric.
    Ggx {
        /// Whether light that facets throw at each other is added, so that rough metal is not too dark (Turquin 2019); if
        /// not, it is lost.
        compensated: bool,
    },
    /// The direction of the gradient as a colour, for the study of shapes: ½ (n + 1), without light.
    Gradient,
}

/// How a surface looks at a point. Colours are linear RGB.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Appearance {
    /// How light is scattered.
    pub shading: Shading,
    /// The colour of light that is scattered evenly; of metals, that of the mirror. From 0 to 1.
    pub colour: Rgb,
    /// Blinn-Phong: the strength of highlights, from 0 on.
    pub specular: f64,
    /// Blinn-Phong: the exponent of highlights, from 1 on.
    pub shininess: f64,
    /// GGX: from 0 (a mirror) to 1; its square is the α of the distribution.
    pub roughness: f64,
    /// GGX: from 0 (dielectric) to 1 (metal).
    pub metallic: f64,
    /// Blinn-Phong: the part of light that is mirrored where one looks straight at the surface, from 0 to 1; the rest is
    /// scattered. More is mirrored at grazing angles where `fresnel` is set.
    pub reflection: f64,
    /// Blinn-Phong: whether the mirrored part grows towards grazing angles (Schlick 1994).
    pub fresnel: bool,
    /// The part of what is not mirrored that goes through and is refracted, from 0 to 1 (glass). At each surface the light
    /// takes on the square root of `colour`, so that a body, which has two, colours it once. Lamps shine straight through.
    pub transmission: f64,
    /// The refractive index inside relative to outside, from 1 on.
    pub index: f64,
    /// What is absorbed inside, for each unit of length: light fades as e^(−absorption · length). From 0 on.
    pub absorption: Rgb,
    /// 1: what there is, is seen; 0: nothing is. Between, the rest of the light goes straight through.
    pub opacity: f64,
    /// Light that the surface gives off itself, from 0 on.
    pub emission: Rgb,
}

impl Default for Appearance {
    /// Light, warm clay with a soft highlight.
    fn default() -> Self {
        Self {
            shading: Shading::BlinnPhong { normalised: false },
            colour: DVec3::new(0.60, 0.42, 0.27),
            specular: 0.18,
            shininess: 40.0,
            roughness: 0.5,
            metallic: 0.0,
            reflection: 0.0,
            fresnel: false,
            transmission: 0.0,
            index: 1.5,
            absorption: DVec3::ZERO,
            opacity: 1.0,
            emission: DVec3::ZERO,
        }
    }
}

/// Why numbers make no [`Material`].
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum MaterialError {
    /// A number is out of its range.
    #[error("{channel} is a number {range}, not {}", Number(*value))]
    Range {
        /// Which it is.
        channel: Channel,
        /// What it may be, in words.
        range: &'static str,
        /// What it is; of a colour, the first component out of range.
        value: f64,
    },
}

/// A number or colour of an [`Appearance`] that may come from a texture.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Channel {
    /// [`Appearance::colour`].
    Colour,
    /// [`Appearance::specular`].
    Specular,
    /// [`Appearance::shininess`].
    Shininess,
    /// [`Appearance::roughness`].
    Roughness,
    /// [`Appearance::metallic`].
    Metallic,
    /// [`Appearance::reflection`].
    Reflection,
    /// [`Appearance::transmission`].
    Transmission,
    /// [`Appearance::index`].
    Index,
    /// [`Appearance::absorption`].
    Absorption,
    /// [`Appearance::opacity`].
    Opacity,
    /// [`Appearance::emission`].
    Emission,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 11] = [
        Self::Colour,
        Self::Specular,
        Self::Shininess,
        Self::Roughness,
        Self::Metallic,
        Self::Reflection,
        Self::Transmission,
        Self::Index,
        Self::Absorption,
        Self::Opacity,
        Self::Emission,
    ];

    /// How it is called in scene files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Colour => "colour",
            Self::Specular => "specular",
            Self::Shininess => "shininess",
            Self::Roughness => "roughness",
            Self::Metallic => "metallic",
            Self::Reflection => "reflection",
            Self::Transmission => "transmission",
            Self::Index => "index",
            Self::Absorption => "absorption",
            Self::Opacity => "opacity",
            Self::Emission => "emission",
        }
    }

    /// How many numbers it has: 3 for a colour, 1 otherwise.
    pub fn width(self) -> usize {
        match self {
            Self::Colour | Self::Absorption | Self::Emission => 3,
            _ => 1,
        }
    }

    /// The least and the largest value, and the range in words.
    fn range(self) -> (f64, f64, &'static str) {
        match self {
            Self::Specular | Self::Absorption | Self::Emission => (0.0, f64::MAX, "from 0 on"),
            Self::Shininess | Self::Index => (1.0, f64::MAX, "from 1 on"),
            _ => (0.0, 1.0, "from 0 to 1"),
        }
    }
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl Appearance {
    /// The numbers of a channel; those after its [width](Channel::width) are 0.
    pub fn channel(&self, channel: Channel) -> [f64; 3] {
        match channel {
            Channel::Colour => self.colour.to_array(),
            Channel::Absorption => self.absorption.to_array(),
            Channel::Emission => self.emission.to_array(),
            Channel::Specular => [self.specular, 0.0, 0.0],
            Channel::Shininess => [self.shininess, 0.0, 0.0],
            Channel::Roughness => [self.roughness, 0.0, 0.0],
            Channel::Metallic => [self.metallic, 0.0, 0.0],
            Channel::Reflection => [self.reflection, 0.0, 0.0],
            Channel::Transmission => [self.transmission, 0.0, 0.0],
            Channel::Index => [self.index, 0.0, 0.0],
            Channel::Opacity => [self.opacity, 0.0, 0.0],
        }
    }

    /// The same with other numbers in a channel.
    pub fn with_channel(mut self, channel: Channel, numbers: [f64; 3]) -> Self {
        let [number, ..] = numbers;
        match channel {
            Channel::Colour => self.colour = numbers.into(),
            Channel::Absorption => self.absorption = numbers.into(),
            Channel::Emission => self.emission = numbers.into(),
            Channel::Specular => self.specular = number,
            Channel::Shininess => self.shininess = number,
            Channel::Roughness => self.roughness = number,
            Channel::Metallic => self.metallic = number,
            Channel::Reflection => self.reflection = number,
            Channel::Transmission => self.transmission = number,
            Channel::Index => self.index = number,
            Channel::Opacity => self.opacity = number,
        }
        self
    }

    /// Between this (`share` 0) and another (`share` 1), number by number; how light is scattered comes from the one
    /// with the larger share.
    pub fn mix(&self, other: &Self, share: f64) -> Self {
        let major = if share > 0.5 { other } else { self };
        Channel::ALL.into_iter().fold(*major, |mixed, channel| {
            let (a, b) = (self.channel(channel), other.channel(channel));
            mixed.with_channel(channel, std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
        })
    }

    fn check(&self) -> Result<(), MaterialError> {
        for channel in Channel::ALL {
            let (least, largest, range) = channel.range();
            for &value in &self.channel(channel)[..channel.width()] {
                if !(least..=largest).contains(&value) {
                    return Err(MaterialError::Range { channel, range, value });
                }
            }
        }
        Ok(())
    }
}

/// What puts attributes of a field in the place of a channel's numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Texture {
    /// The channel.
    pub channel: Channel,
    /// Which attribute is its first number; colours take the next two too.
    pub first: usize,
    /// Whether the numbers are sRGB, from 0 to 1, and become linear.
    pub srgb: bool,
}

/// A material: what a surface looks like, with what varies over it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Material {
    base: Appearance,
    textures: Vec<Texture>,
}

impl Material {
    /// A Blinn-Phong material: diffuse colour, strength of its white highlights, and their sharpness.
    ///
    /// # Errors
    /// Numbers outside the ranges that [`Appearance`] names.
    pub fn new(diffuse: Rgb, specular: f64, shininess: f64) -> Result<Self, MaterialError> {
        Self::of(Appearance { colour: diffuse, specular, shininess, ..Appearance::default() })
    }

    /// A material that looks the same all over.
    ///
    /// # Errors
    /// Numbers outside the ranges that [`Appearance`] names.
    pub fn of(base: Appearance) -> Result<Self, MaterialError> {
        base.check()?;
        Ok(Self { base, textures: Vec::new() })
    }

    /// With a texture; of several for one channel, the last counts.
    pub fn with_texture(mut self, texture: Texture) -> Self {
        self.textures.retain(|known| known.channel != texture.channel);
        self.textures.push(texture);
        self
    }

    /// What it looks like without its textures.
    pub fn base(&self) -> &Appearance {
        &self.base
    }

    /// The textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// How many attributes a field must have for the textures.
    pub fn attributes_needed(&self) -> usize {
        self.textures.iter().map(|t| t.first + t.channel.width()).max().unwrap_or(0)
    }

    /// What it looks like where the field has these attributes. Numbers are cut to the range of their channel; where one
    /// is undefined, the channel is that of the base.
    pub fn at(&self, attributes: &[f64]) -> Appearance {
        self.textures.iter().fold(self.base, |look, texture| {
            let width = texture.channel.width();
            let numbers = attributes.get(texture.first..texture.first + width);
            let Some(numbers) = numbers.filter(|n| n.iter().all(|v| !v.is_nan())) else { return look };
            let (least, largest, _) = texture.channel.range();
            let mut values = [0.0; 3];
            for (value, &number) in values.iter_mut().zip(numbers) {
                let number = if texture.srgb { srgb_to_linear(number.clamp(0.0, 1.0)) } else { number };
                *value = number.clamp(least, largest);
            }
            look.with_channel(texture.channel, values)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_checked() {
        assert!(Material::new(DVec3::ONE, 0.0, 1.0).is_ok());
        let message = |result: Result<Material, MaterialError>| result.unwrap_err().to_string();
        let bright = Material::new(DVec3::new(0.5, 1.5, 0.0), 0.0, 1.0);
        assert_eq!(message(bright), "colour is a number from 0 to 1, not 1.5");
        assert!(Material::new(DVec3::NAN, 0.0, 1.0).is_err());
        assert_eq!(message(Material::new(DVec3::ONE, -0.1, 1.0)), "specular is a number from 0 on, not -0.1");
        assert_eq!(message(Material::new(DVec3::ONE, 0.1, 0.5)), "shininess is a number from 1 on, not 0.5");
        assert!(Material::of(Appearance { emission: DVec3::INFINITY, ..Appearance::default() }).is_err());
        assert!(Material::of(Appearance::default()).is_ok());
    }

    #[test]
    fn channels_are_what_they_set() {
        for (i, channel) in Channel::ALL.into_iter().enumerate() {
            let numbers = std::array::from_fn(|k| if k < channel.width() { (i + k) as f64 } else { 0.0 });
            assert_eq!(Appearance::default().with_channel(channel, numbers).channel(channel), numbers);
        }
    }

    #[test]
    fn textures_are_cut_off_and_undefined_ones_ignored() {
        let colour = Texture { channel: Channel::Colour, first: 1, srgb: true };
        let rough = Texture { channel: Channel::Roughness, first: 0, srgb: false };
        let material = Material::default().with_texture(colour).with_texture(rough);
        assert_eq!(material.attributes_needed(), 4);
        let look = material.at(&[7.0, 0.5, 7.0, -1.0]);
        assert_eq!(look.roughness, 1.0);
        assert!((look.colour - DVec3::new(0.214_041_14, 1.0, 0.0)).length() < 1e-8);
        let undefined = material.at(&[0.25, 0.5, f64::NAN, 0.5]);
        assert_eq!((undefined.colour, undefined.roughness), (material.base().colour, 0.25));
    }

    #[test]
    fn mixtures_lie_between() {
        let red = Appearance { colour: DVec3::X, roughness: 0.0, ..Appearance::default() };
        let blue = Appearance {
            colour: DVec3::Z,
            roughness: 1.0,
            shading: Shading::Ggx { compensated: true },
            ..red
        };
        assert_eq!((red.mix(&blue, 0.0), red.mix(&blue, 1.0)), (red, blue));
        let mixed = red.mix(&blue, 0.25);
        assert_eq!((mixed.colour, mixed.roughness), (DVec3::new(0.75, 0.0, 0.25), 0.25));
        assert_eq!(mixed.shading, red.shading);
    }
}
