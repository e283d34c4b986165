//! Builds one asset at a time: every call to importers, shapes and texture constructors is here.

use super::Loader;
use super::cache::Sampling;
use crate::import::obj::Library;
use crate::import::{self, ImportError, MapRef, MtlMaterial, Note, ObjOptions};
use crate::limits::{Limits, MAX_TRIANGLES};
use crate::math::colour::linear_from_srgb;
use crate::model::build::NONE;
use crate::model::sky::{Picture, PictureSize};
use crate::model::texture::{ColorSpace, Image};
use crate::model::{Corner, Material, Mesh, MeshSource, Part, Texture, normals, shapes};
use crate::scene::compile::SceneError;
use crate::scene::document::{MeshPart, TextureSource, Triangles};
use crate::scene::{Files, Warning};
use bytes::Bytes;
use glam::{DVec2, DVec3, Vec3};
use std::sync::Arc;

/// A mesh with what its file says beside it.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct LoadedMesh {
    pub mesh: Arc<Mesh>,
    /// MTL files that the file names.
    pub libraries: Vec<Library>,
    /// Line where each of the mesh's slots is first named.
    pub slot_lines: Vec<Option<u64>>,
    pub warnings: Vec<Warning>,
}

/// Builds a mesh; `file` is that of an OBJ, and one that is missing makes an empty mesh.
pub(super) fn mesh(
    part: &MeshPart,
    file: Option<&(String, Bytes)>,
    limits: &Limits,
) -> Result<LoadedMesh, SceneError> {
    let mesh = match part {
        MeshPart::Box { size } => shapes::box_(*size),
        MeshPart::Plane { size, uv_repeat } => shapes::plane(*size, *uv_repeat),
        MeshPart::Sphere { radius, segments, rings } => {
            shapes::sphere(*radius, steps(*segments), steps(*rings))
        }
        MeshPart::Torus { radius, tube, segments, sides } => {
            shapes::torus(*radius, *tube, steps(*segments), steps(*sides))
        }
        MeshPart::Cylinder { radius, height, segments } => {
            shapes::cylinder(*radius, *height, steps(*segments))
        }
        MeshPart::Cone { radius, height, segments } => shapes::cone(*radius, *height, steps(*segments)),
        MeshPart::Teapot { height, segments } => shapes::teapot(*height, steps(*segments)),
        MeshPart::Triangles(triangles) => inline(triangles)?,
        MeshPart::Obj { .. } => match file {
            Some((name, bytes)) => return obj(name, bytes, limits),
            None => inline(&Triangles::default())?,
        },
    };
    let (libraries, slot_lines, warnings) = (Vec::new(), Vec::new(), Vec::new());
    Ok(LoadedMesh { mesh: Arc::new(mesh), libraries, slot_lines, warnings })
}

fn steps(n: u64) -> u32 {
    u32::try_from(n).expect("invariant: checked against the limits")
}

fn obj(name: &str, bytes: &Bytes, limits: &Limits) -> Result<LoadedMesh, SceneError> {
    let read = import::obj::read(bytes, &ObjOptions::within(limits))
        .map_err(|error| refused(error.in_file(name)))?;
    Ok(LoadedMesh {
        mesh: Arc::new(read.mesh),
        libraries: read.libraries,
        slot_lines: read.slot_lines,
        warnings: read.notes.into_iter().map(|note| warning(name, note)).collect(),
    })
}

/// Triangles of the document itself.
fn inline(triangles: &Triangles) -> Result<Mesh, SceneError> {
    let indices = match &triangles.indices {
        Some(indices) => indices.clone(),
        None => (0..triangle_count(triangles)?).map(|i| 3 * i).map(|i| [i, i + 1, i + 2]).collect(),
    };
    let corner = |i: u32| Corner {
        position: i,
        uv: triangles.uvs.as_ref().map_or(NONE, |_| i),
        normal: triangles.normals.as_ref().map_or(NONE, |_| i),
    };
    let source = MeshSource {
        positions: triangles.positions.iter().copied().map(DVec3::from_array).collect(),
        colors: triangles.colors.as_ref().map(|colors| colors.iter().map(narrowed).collect()),
        uvs: triangles.uvs.iter().flatten().copied().map(DVec2::from_array).collect(),
        normals: triangles.normals.iter().flatten().map(unit_or_zero).collect(),
        parts: if indices.is_empty() { Vec::new() } else { vec![Part { first_triangle: 0, slot: 0 }] },
        triangles: indices.into_iter().map(|corners| corners.map(corner)).collect(),
        slots: Vec::new(),
    };
    Mesh::build(source).map_err(|refused| too_many(refused.triangles))
}

/// Triangles that positions without indices make.
fn triangle_count(triangles: &Triangles) -> Result<u32, SceneError> {
    let count = triangles.positions.len() / 3;
    u32::try_from(count).ok().filter(|_| count <= MAX_TRIANGLES).ok_or_else(|| too_many(count))
}

fn too_many(triangles: usize) -> SceneError {
    let (limit, value) = (MAX_TRIANGLES as u64, triangles as u64);
    SceneError::TooLarge { what: "triangles of a mesh".to_owned(), limit, value, setting: None }
}

/// Zero stays zero, which asks for a generated normal.
fn unit_or_zero(normal: &[f64; 3]) -> Vec3 {
    normals::unit(DVec3::from_array(*normal)).map_or(Vec3::ZERO, |unit| unit.as_vec3())
}

fn narrowed(color: &[f64; 3]) -> Vec3 {
    DVec3::from_array(*color).as_vec3()
}

/// Decodes an image file.
pub(super) fn image(name: &str, bytes: &Bytes, limits: &Limits) -> Result<Image, SceneError> {
    import::image::decode(bytes, name, limits).map_err(|error| refused(error.in_file(name)))
}

/// The size of an image or a picture of a background, from its header.
pub(super) fn picture_size(name: &str, bytes: &Bytes, limits: &Limits) -> Result<PictureSize, SceneError> {
    import::image::picture_size(bytes, name, limits).map_err(|error| refused(error.in_file(name)))
}

/// Decodes a picture of a background.
pub(super) fn picture(name: &str, bytes: &Bytes, limits: &Limits) -> Result<Picture, SceneError> {
    import::image::decode_picture(bytes, name, limits).map_err(|error| refused(error.in_file(name)))
}

/// Paints the image of a texture that has no file.
pub(super) fn made_image(source: &TextureSource, space: ColorSpace) -> Image {
    let (colors, cells) = match source {
        TextureSource::Checker { colors, cells } => (colors, *cells),
        TextureSource::File(_) => {
            return Image { width: 1, height: 1, texels: vec![[u8::MAX; 4]] };
        }
    };
    let colors = colors.each_ref().map(|color| match space {
        ColorSpace::Srgb => color.to_linear(),
        // The painter encodes; numbers that are read as they are stored must survive that.
        ColorSpace::Linear => decoded(color.to_linear()),
    });
    Image::checker(colors, steps(cells))
}

fn decoded(color: Vec3) -> Vec3 {
    DVec3::from_array(color.clamp(Vec3::ZERO, Vec3::ONE).as_dvec3().to_array().map(linear_from_srgb))
        .as_vec3()
}

/// A texture with its mips.
pub(super) fn texture(image: Arc<Image>, sampling: Sampling) -> Texture {
    let Sampling { color_space, filter, wrap, scale, offset } = sampling;
    Texture::new(image, color_space, filter, wrap).placed(scale, offset)
}

/// The libraries of an OBJ: a line of `mtllib` is one name with blanks, or several without.
pub(super) fn libraries(lines: &[Library], files: &Files) -> Vec<Library> {
    let split = |library: &Library| {
        let several = files.find(&library.name).is_none() && library.name.contains(char::is_whitespace);
        let names: Vec<_> =
            if several { library.name.split_whitespace().collect() } else { vec![&library.name] };
        names
            .into_iter()
            .map(|name| Library { name: name.to_owned(), line: library.line })
            .collect::<Vec<_>>()
    };
    lines.iter().flat_map(split).collect()
}

/// Reads an MTL file.
pub(super) fn mtl(
    name: &str,
    bytes: &Bytes,
    limits: &Limits,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<MtlMaterial>, SceneError> {
    let unreadable = |error: import::TextError| SceneError::Unreadable {
        file: name.to_owned(),
        line: Some(error.line()),
        detail: error.to_string(),
    };
    let read = import::mtl::read(bytes, limits).map_err(unreadable)?;
    warnings.extend(read.notes.into_iter().map(|note| warning(name, note)));
    Ok(read.materials)
}

/// A material of the MTL file `mtl` with its maps looked up.
pub(super) fn mtl_material(
    described: MtlMaterial,
    mtl: &str,
    loader: &mut Loader,
) -> Result<Material, SceneError> {
    let maps = described.maps;
    let mut load = |map: &Option<MapRef>, space| match map {
        Some(map) => loader.mtl_texture(map, mtl, space),
        None => Ok(None),
    };
    Ok(Material {
        diffuse_map: load(&maps.diffuse, ColorSpace::Srgb)?,
        specular_map: load(&maps.specular, ColorSpace::Srgb)?,
        emissive_map: load(&maps.emissive, ColorSpace::Srgb)?,
        normal_map: load(&maps.normal, ColorSpace::Linear)?,
        bump_map: load(&maps.bump, ColorSpace::Linear)?,
        opacity_map: load(&maps.opacity, ColorSpace::Linear)?,
        ..described.material
    })
}

fn warning(file: &str, note: Note) -> Warning {
    Warning { file: Some(file.to_owned()), line: note.line, detail: note.detail }
}

fn refused(error: ImportError) -> SceneError {
    match error {
        ImportError::Unreadable { file, line, detail } => SceneError::Unreadable { file, line, detail },
        ImportError::TooLarge { file, detail, value, limit, setting } => {
            SceneError::TooLarge { what: format!("{file}: {detail}"), limit, value, setting }
        }
    }
}
