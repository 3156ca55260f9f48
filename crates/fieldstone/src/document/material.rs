//! Materials of scene files: constants and textures.

use super::check::is_keyed;
use super::compose::{Composer, Space};
use super::expression::Names;
use super::fault::{Fault, Outcome};
use super::tree::{EMPTY, Entry, Kind, Table, Value};
use fieldstone_field::NodeId;
use fieldstone_lang::Diagnostic;
use fieldstone_scene::{Appearance, Channel, Material, Shading, srgb_to_linear};

/// A material of a part, whose textures are nodes of the program of its object.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct MaterialDraft {
    pub(super) base: Appearance,
    pub(super) textures: Vec<TextureDraft>,
}

/// A texture: a number, or three, in the place of a channel.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct TextureDraft {
    pub(super) channel: Channel,
    pub(super) nodes: Vec<NodeId>,
    pub(super) srgb: bool,
}

/// What a channel of a material holds.
enum Content {
    Constant([f64; 3]),
    Texture(Vec<NodeId>, bool),
}

const OVER_SURFACES: Names = Names { parameters: true, fields: true, normal: true };

impl<'d> Composer<'_, 'd> {
    /// The material of a name in a space; `attributes` are those of the model that it is for. Without a name it is
    /// coloured by the model, or of clay.
    pub(super) fn material(
        &mut self,
        name: Option<&'d Value>,
        space: &Space,
        attributes: &[NodeId],
    ) -> Outcome<MaterialDraft> {
        let Some(name) = name else {
            let coloured = attributes.get(..3).map(<[NodeId]>::to_vec);
            let texture = |nodes| TextureDraft { channel: Channel::Colour, nodes, srgb: true };
            return Ok(MaterialDraft {
                base: Appearance::default(),
                textures: coloured.map(texture).into_iter().collect(),
            });
        };
        let entry = self.numbers.document().named("materials", name)?;
        self.material_of(entry, space, Some(attributes))
    }

    /// A material of the scene in a space; `attributes` are those of the model that it is for, if that is known.
    pub(super) fn material_of(
        &mut self,
        entry: &'d Entry,
        space: &Space,
        attributes: Option<&[NodeId]>,
    ) -> Outcome<MaterialDraft> {
        let table = entry.value.table().unwrap_or(&EMPTY);
        refuse_other_keys(table)?;
        let mut draft = MaterialDraft { base: model(table), textures: Vec::new() };
        for channel in Channel::ALL {
            let Some(value) = table.get(channel.name()) else { continue };
            let takes_attributes = value.table().is_some_and(|table| table.get("attributes").is_some());
            if attributes.is_none() && takes_attributes {
                continue;
            }
            match self.content(value, channel, (space, attributes.unwrap_or_default()))? {
                Content::Constant(numbers) => {
                    draft.base = draft.base.with_channel(channel, numbers);
                    Material::of(draft.base)
                        .map_err(|error| value.error(error.to_string(), "out of range"))?;
                }
                Content::Texture(nodes, srgb) => draft.textures.push(TextureDraft { channel, nodes, srgb }),
            }
        }
        Ok(draft)
    }

    fn content(&mut self, value: &'d Value, channel: Channel, at: (&Space, &[NodeId])) -> Outcome<Content> {
        let is_colour = channel.width() == 3;
        match &value.kind {
            Kind::Table(table) if table.get("attributes").is_some() => self.attributes(table, channel, at.1),
            Kind::Table(table) if is_colour && !is_keyed(table) && table.get("linear").is_none() => {
                self.colour_texture(value, table, (channel, at.0))
            }
            // What is absorbed and given off may be given by linear numbers above 1.
            Kind::List(_) if is_colour && channel != Channel::Colour => {
                Ok(Content::Constant(self.numbers.numbers(value)?))
            }
            Kind::Text(_) if !is_colour => {
                let node = self.texture(value, at.0)?;
                Ok(match self.graph.constant_value(node) {
                    Some(number) => Content::Constant([number, 0.0, 0.0]),
                    None => Content::Texture(vec![node], false),
                })
            }
            // One number for all three is grey.
            Kind::Number(_) if channel != Channel::Colour && is_colour => {
                Ok(Content::Constant([self.numbers.number(value)?; 3]))
            }
            _ if is_colour => Ok(Content::Constant(self.numbers.colour(value)?.to_array())),
            _ => Ok(Content::Constant([self.numbers.number(value)?, 0.0, 0.0])),
        }
    }

    /// A formula over a surface, which has a value somewhere.
    fn texture(&mut self, value: &'d Value, space: &Space) -> Outcome<NodeId> {
        let node = self.formula(value, space, OVER_SURFACES)?;
        match self.graph.constant_value(node) {
            Some(number) if !number.is_finite() => {
                let message = format!("this texture is {number} everywhere, not a finite number");
                Err(value.error(message, "not finite").into())
            }
            _ => Ok(node),
        }
    }

    fn attributes(&mut self, table: &'d Table, channel: Channel, attributes: &[NodeId]) -> Outcome<Content> {
        let Some(value) = table.get("attributes") else { return Ok(Content::Constant([0.0; 3])) };
        let first = self.numbers.number(value)? as usize;
        let found = first.checked_sub(1).and_then(|start| attributes.get(start..start + channel.width()));
        match found {
            Some(nodes) => Ok(Content::Texture(nodes.to_vec(), channel == Channel::Colour)),
            None => {
                let (needed, found) = (first + channel.width() - 1, attributes.len());
                let message = format!("`{channel}` takes attributes up to {needed}, the model has {found}");
                let error = value.error(message, "not there");
                Err(error
                    .with_help("attributes are s[1], s[2], … of HyperFun models; formulas have none")
                    .into())
            }
        }
    }

    fn colour_texture(
        &mut self,
        value: &'d Value,
        table: &'d Table,
        (channel, space): (Channel, &Space),
    ) -> Outcome<Content> {
        let formulas = ["red", "green", "blue"].map(|key| table.get(key));
        if let [Some(red), Some(green), Some(blue)] = formulas {
            let srgb = channel == Channel::Colour;
            let mut nodes = Vec::new();
            for formula in [red, green, blue] {
                nodes.push(self.texture(formula, space)?);
            }
            let constants: Vec<f64> = nodes.iter().filter_map(|n| self.graph.constant_value(*n)).collect();
            return Ok(match constants.try_into() {
                Ok(constants) if srgb => Content::Constant(<[f64; 3]>::map(constants, srgb_to_linear)),
                Ok(constants) => Content::Constant(constants),
                Err(_) => Content::Texture(nodes, srgb),
            });
        }
        let (Some(from), Some(to), Some(by)) = (table.get("from"), table.get("to"), table.get("by")) else {
            let error = value.error("a texture has red, green and blue, or from, to and by", "incomplete");
            let help = "write { from = \"white\", to = \"black\", by = \"0.5 + 0.5*sin(x)\" }";
            return Err(Fault::from(error.with_help(help)));
        };
        let (from, to) = (self.numbers.colour(from)?.to_array(), self.numbers.colour(to)?.to_array());
        let by = self.texture(by, space)?;
        let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
        let above = self.graph.max(by, zero);
        let share = self.graph.min(above, one);
        let nodes: Vec<NodeId> = (0..3)
            .map(|k| {
                let (start, way) = (self.graph.constant(from[k]), self.graph.constant(to[k] - from[k]));
                let part = self.graph.mul(way, share);
                self.graph.add(start, part)
            })
            .collect();
        let constants: Vec<f64> = nodes.iter().filter_map(|n| self.graph.constant_value(*n)).collect();
        Ok(constants.try_into().map_or(Content::Texture(nodes, false), Content::Constant))
    }
}

/// The keys that have a meaning with Blinn-Phong alone, and those that have one with GGX alone.
const OF_BLINN_PHONG: [&str; 5] = ["specular", "shininess", "reflection", "fresnel", "normalised"];
const OF_GGX: [&str; 3] = ["roughness", "metallic", "compensated"];

/// Keys that do nothing with the model of a material are mistakes.
fn refuse_other_keys(table: &Table) -> Outcome<()> {
    let name = table.get("model").and_then(Value::text).unwrap_or("blinn-phong");
    let (strange, help): (&[&str], &str) = match name {
        "ggx" | "metal" | "glass" => {
            (&OF_BLINN_PHONG, "highlights and mirroring follow from its `roughness`")
        }
        "mirror" => (&OF_GGX, "a rough mirror is model = \"metal\" with `roughness`"),
        "gradient" => return Ok(()),
        _ => (&OF_GGX, "model = \"ggx\" has it"),
    };
    match table.entries.iter().find(|entry| strange.contains(&entry.key.as_str())) {
        None => Ok(()),
        Some(entry) => {
            let message = format!("`{}` has no meaning with model = \"{name}\"", entry.key);
            let error = Diagnostic::error(entry.key_span.clone(), message, "does nothing");
            Err(error.with_help(help).into())
        }
    }
}

/// What a material is before its channels are set.
fn model(table: &Table) -> Appearance {
    let flag = |key: &str| table.get(key).and_then(Value::flag);
    let base = Appearance { fresnel: flag("fresnel").unwrap_or(false), ..Appearance::default() };
    let ggx = Shading::Ggx { compensated: flag("compensated").unwrap_or(true) };
    let white = glam::DVec3::ONE;
    match table.get("model").and_then(Value::text) {
        Some("ggx") => Appearance { shading: ggx, ..base },
        Some("metal") => Appearance { shading: ggx, metallic: 1.0, roughness: 0.2, ..base },
        Some("glass") => {
            Appearance { shading: ggx, colour: white, roughness: 0.0, transmission: 1.0, ..base }
        }
        Some("mirror") => Appearance { reflection: 1.0, specular: 0.0, colour: white, ..base },
        Some("gradient") => Appearance { shading: Shading::Gradient, ..base },
        _ => {
            let normalised = flag("normalised").unwrap_or(false);
            Appearance { shading: Shading::BlinnPhong { normalised }, ..base }
        }
    }
}
