//! Meshes from files.

use super::Mesh;
use crate::sources::files::{MAX_FILE_BYTES, content, linear, read_file, read_ply};
use crate::sources::{Paint, SourceError};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DMat4, DVec3};
use std::path::{Component, Path, PathBuf};

/// A mesh has at most so many points, triangles, and entries on the way to them.
const MOST: usize = 20_000_000;
/// A glTF file's nodes lie in one another at most so deep.
const DEEPEST: usize = 64;

/// Reads a mesh, by the ending of its name:
/// - `.obj` (Wavefront), with the diffuse colours (sRGB) and shininess of `.mtl` files, and colours behind coordinates;
/// - `.ply`, with colours of vertices;
/// - `.gltf` and `.glb` (glTF 2.0): the triangles of the default scene with base colours, metalness as gloss, and
///   colours of vertices.
///
/// Textures of pictures are not read. Other files that these name are read from their folder, or one below it, alone.
///
/// # Errors
/// Files that cannot be read, are too large, or hold something else.
pub fn read_mesh(path: &Path) -> Result<Mesh, SourceError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mesh = match ending.as_str() {
        "obj" => obj(path, &read_file(path)?)?,
        "ply" => ply(path, &read_file(path)?)?,
        "gltf" | "glb" => gltf(path, &read_file(path)?)?,
        _ => return Err(content(path, None, "meshes are read from .obj, .ply, .gltf and .glb files")),
    };
    checked(path, mesh)
}

/// Refuses meshes whose numbers make no sense.
fn checked(path: &Path, mesh: Mesh) -> Result<Mesh, SourceError> {
    if mesh.triangles.is_empty() {
        return Err(content(path, None, "there is no triangle in it"));
    }
    let count = mesh.points.len();
    if let Some(bad) = mesh.triangles.iter().flatten().find(|i| **i as usize >= count) {
        return Err(content(path, None, format!("a face names point {bad}, and there are {count}")));
    }
    if let Some(bad) = mesh.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(content(path, None, format!("point {bad} is none: a number is not finite")));
    }
    Ok(mesh)
}

/// A file named in another: in the same folder or below it.
fn beside(path: &Path, name: &Path) -> Result<PathBuf, SourceError> {
    let is_plain = name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !is_plain || name.as_os_str().is_empty() {
        let message = format!("it names {}, which is not in its folder", name.display());
        return Err(content(path, None, message));
    }
    Ok(path.with_file_name("").join(name))
}

fn obj(path: &Path, bytes: &[u8]) -> Result<Mesh, SourceError> {
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let materials = |name: &Path| {
        // What is wrong with a file of materials is told below, by its name.
        let place = beside(path, name).map_err(|_| tobj::LoadError::OpenFileFailed)?;
        let bytes = read_file(&place).map_err(|_| tobj::LoadError::OpenFileFailed)?;
        tobj::load_mtl_buf(&mut bytes.as_slice())
    };
    let mut source = bytes;
    let (models, materials) = tobj::load_obj_buf(&mut source, &options, materials)
        .map_err(|error| content(path, None, format!("this is no OBJ file: {error}")))?;
    let materials =
        materials.map_err(|error| content(path, None, format!("its materials are not read: {error}")))?;
    let mut mesh = Mesh { materials: materials.iter().map(obj_paint).collect(), ..Mesh::default() };
    let has_colours = models.iter().any(|model| !model.mesh.vertex_color.is_empty());
    // A triangle without a material gets the one behind all.
    let none = u32::MAX;
    for model in &models {
        let start = mesh.points.len() as u32;
        mesh.points.extend(model.mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]].map(f64::from)));
        if has_colours {
            let colours = model.mesh.vertex_color.chunks_exact(3);
            mesh.colours.extend(colours.map(|c| [c[0], c[1], c[2]].map(|share| linear(f64::from(share)))));
            mesh.colours.resize(mesh.points.len(), [1.0; 3]);
        }
        let material = model.mesh.material_id.map_or(none, |i| i as u32);
        for corners in model.mesh.indices.chunks_exact(3) {
            mesh.triangles.push([0, 1, 2].map(|k| start.saturating_add(corners[k])));
            mesh.material.push(material);
        }
        limited(path, &mesh)?;
    }
    Ok(mesh)
}

fn obj_paint(material: &tobj::Material) -> Paint {
    let mean = |colour: [f32; 3]| colour.iter().sum::<f32>() / 3.0;
    let diffuse = material.diffuse.unwrap_or([0.8; 3]);
    let (matt, mirrored) = (mean(diffuse), mean(material.specular.unwrap_or([0.0; 3])));
    let gloss = if matt + mirrored > 0.0 { (mirrored / (matt + mirrored)).clamp(0.0, 1.0) } else { 0.0 };
    Paint { albedo: diffuse.map(|share| linear(f64::from(share))), gloss }
}

fn limited(path: &Path, mesh: &Mesh) -> Result<(), SourceError> {
    let many = mesh.points.len().max(mesh.triangles.len());
    if many > MOST {
        return Err(content(path, None, format!("it has more than {MOST} points or triangles")));
    }
    Ok(())
}

fn ply(path: &Path, bytes: &[u8]) -> Result<Mesh, SourceError> {
    let ply = read_ply(path, bytes, MOST)?;
    let point = |row: &crate::sources::files::PlyRow| [row.numbers[0], row.numbers[1], row.numbers[2]];
    let mut mesh = Mesh {
        points: ply.vertices.iter().map(point).collect(),
        colours: ply.vertices.iter().filter_map(|row| ply.colour(row)).collect(),
        ..Mesh::default()
    };
    for face in &ply.faces {
        // Faces of more corners as fans.
        for i in 2..face.corners.len() {
            mesh.triangles.push([face.corners[0], face.corners[i - 1], face.corners[i]]);
        }
        limited(path, &mesh)?;
    }
    Ok(mesh)
}

/// The numbers of a glTF file, and what it is made of so far.
struct GltfReader<'p> {
    path: &'p Path,
    buffers: Vec<Vec<u8>>,
    mesh: Mesh,
}

fn gltf(path: &Path, bytes: &[u8]) -> Result<Mesh, SourceError> {
    let mut file = gltf::Gltf::from_slice(bytes)
        .map_err(|error| content(path, None, format!("this is no glTF file: {error}")))?;
    let mut binary = file.blob.take();
    let mut buffers = Vec::new();
    for buffer in file.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => binary.take().unwrap_or_default(),
            gltf::buffer::Source::Uri(uri) => uri_bytes(path, uri)?,
        };
        if bytes.len() < buffer.length() {
            let message =
                format!("a buffer of {} bytes is announced and has {}", buffer.length(), bytes.len());
            return Err(content(path, None, message));
        }
        buffers.push(bytes);
    }
    let total: u64 = buffers.iter().map(|bytes| bytes.len() as u64).sum();
    if total > MAX_FILE_BYTES {
        return Err(content(path, None, format!("it holds more than {} MiB", MAX_FILE_BYTES >> 20)));
    }
    check_accessors(path, &file, &buffers)?;
    let paint = |material: gltf::Material<'_>| {
        let surface = material.pbr_metallic_roughness();
        let [red, green, blue, _] = surface.base_color_factor();
        Paint { albedo: [red, green, blue], gloss: surface.metallic_factor().clamp(0.0, 1.0) }
    };
    let mesh = Mesh { materials: file.materials().map(paint).collect(), ..Mesh::default() };
    let mut reader = GltfReader { path, buffers, mesh };
    if let Some(scene) = file.default_scene().or_else(|| file.scenes().next()) {
        for node in scene.nodes() {
            reader.node(&node, DMat4::IDENTITY, 0)?;
        }
    }
    Ok(reader.mesh)
}

/// The bytes that a URI stands for: base64 after `data:…,`, or a file.
fn uri_bytes(path: &Path, uri: &str) -> Result<Vec<u8>, SourceError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let bytes = text.and_then(|text| STANDARD.decode(text).ok());
        return bytes.ok_or_else(|| content(path, None, "the data of a buffer are no base64"));
    }
    read_file(&beside(path, Path::new(uri))?)
}

/// Refuses accessors that reach beyond their buffers, which the reader would stumble over.
fn check_accessors(path: &Path, file: &gltf::Gltf, buffers: &[Vec<u8>]) -> Result<(), SourceError> {
    let fits = |accessor: &gltf::Accessor<'_>| {
        let Some(view) = accessor.view() else { return accessor.count() <= MOST };
        let step = view.stride().unwrap_or(accessor.size());
        let last = accessor.count().saturating_sub(1).checked_mul(step);
        let end = last.and_then(|last| last.checked_add(accessor.size())?.checked_add(accessor.offset()));
        let view_end = view.offset().checked_add(view.length());
        let size = buffers.get(view.buffer().index()).map_or(0, Vec::len);
        end.is_some_and(|end| end <= view.length()) && view_end.is_some_and(|end| end <= size)
    };
    match file.accessors().find(|accessor| accessor.sparse().is_some() || !fits(accessor)) {
        Some(bad) if bad.sparse().is_some() => Err(content(path, None, "sparse accessors are not read")),
        Some(bad) => {
            let message = format!("accessor {} reaches beyond its buffer", bad.index());
            Err(content(path, None, message))
        }
        None => Ok(()),
    }
}

impl GltfReader<'_> {
    fn node(&mut self, node: &gltf::Node<'_>, parent: DMat4, depth: usize) -> Result<(), SourceError> {
        if depth > DEEPEST {
            return Err(content(self.path, None, format!("nodes lie deeper than {DEEPEST} in one another")));
        }
        let columns = node.transform().matrix().map(|column| column.map(f64::from));
        let world = parent * DMat4::from_cols_array_2d(&columns);
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&primitive, world)?;
            }
        }
        for child in node.children() {
            self.node(&child, world, depth + 1)?;
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &gltf::Primitive<'_>, world: DMat4) -> Result<(), SourceError> {
        let path = self.path;
        if primitive.mode() != gltf::mesh::Mode::Triangles {
            return Err(content(
                path,
                None,
                "it has strips, lines or points, and lists of triangles are read",
            ));
        }
        let buffers = &self.buffers;
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let Some(positions) = reader.read_positions() else { return Ok(()) };
        let start = self.mesh.points.len();
        let place = |p: [f32; 3]| world.transform_point3(DVec3::from_array(p.map(f64::from))).to_array();
        self.mesh.points.extend(positions.map(place));
        let count = self.mesh.points.len() - start;
        if let Some(colours) = reader.read_colors(0) {
            self.mesh.colours.resize(start, [1.0; 3]);
            self.mesh.colours.extend(colours.into_rgb_f32());
        }
        if !self.mesh.colours.is_empty() {
            self.mesh.colours.resize(self.mesh.points.len(), [1.0; 3]);
        }
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..count as u32).collect(),
        };
        let material = primitive.material().index().map_or(u32::MAX, |i| i as u32);
        for corner in corners.chunks_exact(3) {
            self.mesh.triangles.push([0, 1, 2].map(|k| corner[k].saturating_add(start as u32)));
            self.mesh.material.push(material);
        }
        limited(path, &self.mesh)
    }
}
