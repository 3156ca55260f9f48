//! Volumes of texels of a scene file.

use super::copies::copies;
use super::fault::{Fault, Outcome};
use super::files::VolumeKey;
use super::motion::motions;
use super::number::Numbers;
use super::tree::{EMPTY, Table, Value};
use fieldstone_lang::Diagnostic;
use fieldstone_scene::TexelBox;
use fieldstone_texel::{Mode, Volume};
use glam::DAffine3;
use std::path::Path;

/// How many volumes may stand in a scene, copies counted.
const MAX_BOXES: usize = 1000;

/// The volumes of a scene, with their names.
pub(super) fn volumes(numbers: &Numbers<'_>) -> Outcome<(Vec<TexelBox>, Vec<String>)> {
    let list = numbers.document().root.get("texels").and_then(Value::list).unwrap_or_default();
    let (mut boxes, mut names) = (Vec::new(), Vec::new());
    for value in list {
        let table = value.table().unwrap_or(&EMPTY);
        let source = Source::read(value, table)?;
        let volume = numbers.document().files.volume(source.file, source.wanted)?;
        let base = match table.get("transform") {
            Some(transform) => motions(numbers, transform)?,
            None => DAffine3::IDENTITY,
        };
        for copy in copies(numbers, Some(table))? {
            if boxes.len() == MAX_BOXES {
                let message = format!("at most {MAX_BOXES} volumes of texels stand in a scene");
                return Err(head(value, message, "one too many").into());
            }
            let flat = || head(value, "a motion that cannot be taken back: it flattens space", "here");
            let texels = TexelBox::new(volume.clone(), copy * base).ok_or_else(flat)?;
            boxes.push(dressed(numbers, table, texels)?);
            names.push(source.name.clone());
        }
    }
    Ok((boxes, names))
}

/// Where a volume comes from.
struct Source<'v> {
    name: String,
    file: &'v Value,
    wanted: VolumeKey,
}

impl<'v> Source<'v> {
    fn read(value: &Value, table: &'v Table) -> Outcome<Self> {
        let (file, is_recipe) = match (table.get("file"), table.get("recipe")) {
            (Some(file), None) => (file, false),
            (None, Some(recipe)) => (recipe, true),
            (None, None) => {
                let error = head(value, "a volume of texels has a `file` or a `recipe`", "none is here");
                return Err(error.with_help("write file = \"bush.texel\" or recipe = \"bush.toml\"").into());
            }
            (Some(_), Some(second)) => {
                let message = "a volume of texels has either a `file` or a `recipe`";
                return Err(second.error(message, "one too many").into());
            }
        };
        let edge = table.get("edge");
        if let (Some(edge), false) = (edge, is_recipe) {
            let error = edge.error("`edge` has a meaning with `recipe` only", "without a meaning");
            return Err(error.with_help("the cells of a file are what they are").into());
        }
        let edge = edge.map(power_of_two).transpose()?;
        let mode = table.get("filter").map(|filter| match filter.text() {
            Some("1995") => Mode::Neyret1995,
            _ => Mode::Sggx,
        });
        let stem = Path::new(file.text().unwrap_or_default()).file_stem().unwrap_or_default();
        let name = table.get("name").and_then(Value::text).map(str::to_owned);
        let name = name.unwrap_or_else(|| stem.to_string_lossy().into_owned());
        Ok(Self { name, file, wanted: VolumeKey { is_recipe, edge, mode } })
    }
}

/// An edge that volumes can have.
fn power_of_two(value: &Value) -> Outcome<u32> {
    match value.kind {
        super::tree::Kind::Number(number) if (number as u32).is_power_of_two() => Ok(number as u32),
        _ => Err(value.error("an edge is a power of two, up to 1024", "expected a power of two").into()),
    }
}

/// A volume with what its table says beside its place.
fn dressed(numbers: &Numbers<'_>, table: &Table, texels: TexelBox) -> Outcome<TexelBox> {
    let texels = match table.get("repeat") {
        Some(value) => repeated(value, texels)?,
        None => texels,
    };
    let texels = match table.get("density") {
        Some(value) => {
            let density = numbers.ranged(value, (1e-9, 1e9, "from 1e-9 to 1e9"))?;
            texels.with_density(density).ok_or_else(|| value.error("no density", "out of range"))?
        }
        None => texels,
    };
    Ok(match table.get("level") {
        Some(value) => texels.with_finest_level(numbers.ranged(value, (0.0, 12.0, "from 0 to 12"))? as f32),
        None => texels,
    })
}

fn repeated(value: &Value, texels: TexelBox) -> Outcome<TexelBox> {
    let counts = value.list().unwrap_or_default();
    let counts: Vec<u32> = counts.iter().filter_map(whole).collect();
    let counts: [u32; 3] = counts
        .try_into()
        .map_err(|_| value.error("three numbers are needed: along x, y and z", "not three"))?;
    let cyclic = cyclic_axes(texels.volume());
    texels.with_repeats(counts).ok_or_else(|| -> Fault {
        let message = format!("the volume is cyclic {cyclic}: it fits to itself only there");
        let error = value.error(message, "repeated along another axis");
        error.with_help("a recipe says cyclic = [\"x\", \"y\"]; other axes have 1 here").into()
    })
}

fn whole(value: &Value) -> Option<u32> {
    match value.kind {
        super::tree::Kind::Number(number) => Some(number as u32),
        _ => None,
    }
}

fn cyclic_axes(volume: &Volume) -> String {
    let axes = ["x", "y", "z"].into_iter().zip(volume.cyclic()).filter(|(_, cyclic)| *cyclic);
    let axes: Vec<&str> = axes.map(|(axis, _)| axis).collect();
    if axes.is_empty() { "along no axis".to_owned() } else { format!("along {}", axes.join(" and ")) }
}

/// An error about a whole table, which may be long.
fn head(value: &Value, message: impl Into<String>, label: &str) -> Diagnostic {
    let span = value.span.start..value.span.end.min(value.span.start + 80);
    Diagnostic::error(span, message, label)
}
