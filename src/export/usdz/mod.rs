//! A coat for viewers on phones: a .usdz holds one mesh in place of the strands, which such viewers refuse.

mod shell;

use super::asset::{Frame, Parts, Up, identifier};
use super::error::ExportError;
use super::usd::{self, Array, Attribute, Form, Layer, Prim, Rows, Value};
use super::zip::Archive;
use crate::PROGRAM;
use crate::color::srgb_from_linear;
use crate::io::{AtomicFile, FileError};
use glam::Vec3;
use shell::Shell;
use std::io::{self, Cursor};
use std::path::Path;

/// Name of the picture of colors in the archive.
const PICTURE: &str = "coat.png";
/// Members begin at multiples of so many bytes, so that readers can map them into memory.
const ALIGNMENT: usize = 64;
/// Roughness of the preview surface: fur has no sharp highlight as a whole.
const ROUGHNESS: f32 = 0.9;

/// Writes a groom as a mesh: the skin, moved out to where the hairs end on average, in the colors of the
/// coat, one a triangle.
///
/// * `frame`: Y must be up, which those viewers ask for.
///
/// Returns the number of triangles.
///
/// # Errors
/// As [`check`]; a groom without strands or with points that are not finite, the file.
pub fn write(path: &Path, parts: &Parts<'_>, frame: Frame) -> Result<usize, ExportError> {
    check(path, frame)?;
    super::asset::check(parts.groom)?;
    let color = Vec3::from_array(parts.species.skin_color.map(|c| c as f32));
    let shell = Shell::new(parts.groom, parts.skin, parts.species, color);
    let failed = |e| FileError::new("write", path, e);
    let picture = Picture::of(&shell).map_err(failed)?;
    let mut layer = Cursor::new(Vec::new());
    let scene = scene(parts, &shell, &picture, frame);
    usd::write(&scene, Form::Binary, &mut layer, &mut |_| Ok(())).map_err(failed)?;
    let mut file = AtomicFile::create(path)?;
    let mut archive = Archive::new(&mut file, ALIGNMENT);
    // The first member is what the archive opens as.
    (archive.add("coat.usdc", layer.get_ref()))
        .and_then(|()| archive.add(PICTURE, &picture.png))
        .and_then(|()| archive.finish())
        .map_err(failed)?;
    file.commit()?;
    Ok(shell.triangles.len())
}

/// Refuses what no viewer would show right.
///
/// # Errors
/// [`ExportError::UsdzUp`].
pub fn check(path: &Path, frame: Frame) -> Result<(), ExportError> {
    match frame.up {
        Up::Y => Ok(()),
        Up::Z => Err(ExportError::UsdzUp {
            path: path.to_owned(),
        }),
    }
}

/// A picture with a texel a triangle.
struct Picture {
    side: usize,
    png: Vec<u8>,
}

impl Picture {
    fn of(shell: &Shell) -> io::Result<Self> {
        let side = (shell.triangles.len() as f64).sqrt().ceil().max(1.0) as usize;
        let mut rgb = vec![0u8; 3 * side * side];
        for (texel, triangle) in rgb.chunks_exact_mut(3).zip(&shell.triangles) {
            let sum: Vec3 = triangle.iter().map(|&v| shell.colors[v as usize]).sum();
            let bytes = (sum / 3.0)
                .to_array()
                .map(|c| (255.0 * srgb_from_linear(c)).round() as u8);
            texel.copy_from_slice(&bytes);
        }
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, side as u32, side as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&rgb)?;
        writer.finish()?;
        Ok(Self { side, png })
    }

    /// Texture coordinates of a triangle's texel; v runs upward.
    fn at(&self, triangle: usize) -> [f32; 2] {
        let [x, y] = [triangle % self.side, triangle / self.side].map(|i| i as f32 + 0.5);
        [x / self.side as f32, 1.0 - y / self.side as f32]
    }
}

fn scene<'a>(parts: &Parts<'_>, shell: &Shell, picture: &Picture, frame: Frame) -> Layer<'a> {
    let species = parts.species;
    let name = identifier(&species.id);
    let mut root = Prim::new("Xform", name.as_str());
    root.kind = "component";
    root.documentation = format!(
        "{} as a mesh in place of its strands: {} of them ended at its surface on average",
        species.name,
        parts.groom.strands()
    );
    let material = format!("/{name}/coat");
    root.children.push(mesh(shell, picture, frame, &material));
    root.children.push(coat(&material));
    Layer {
        documentation: format!(
            "Proxy of the fur of {} ({}), by {PROGRAM}",
            species.name, species.id
        ),
        default_prim: name,
        meters_per_unit: frame.meters_per_unit(),
        up_axis: frame.up_axis(),
        custom_data: vec![("creator".to_owned(), Value::string(PROGRAM))],
        prims: vec![root],
    }
}

fn mesh<'a>(shell: &Shell, picture: &Picture, frame: Frame, material: &str) -> Prim<'a> {
    let place = |p: &Vec3| frame.point(*p).to_array();
    let points: Vec<[f32; 3]> = shell.points.iter().map(place).collect();
    let bound = |pick: fn(f32, f32) -> f32, of: f32| {
        std::array::from_fn(|k| points.iter().map(|p| p[k]).fold(of, pick))
    };
    let extent: [[f32; 3]; 2] = [bound(f32::min, f32::MAX), bound(f32::max, f32::MIN)];
    let count = shell.triangles.len();
    let corners: Vec<i32> = shell
        .triangles
        .iter()
        .flatten()
        .map(|&v| v as i32)
        .collect();
    let uvs = (0..count).flat_map(|t| [picture.at(t); 3]).collect();
    let normals = shell.normals.iter().map(|n| n.to_array()).collect();
    let colors = shell.colors.iter().map(|c| c.to_array()).collect();
    let mut mesh = Prim::new("Mesh", "proxy");
    mesh.set(
        "float3[]",
        "extent",
        Array::Vec3(Rows::of(extent.to_vec())).into(),
    );
    let threes = Array::Int(Rows::of(vec![3; count]));
    mesh.set("int[]", "faceVertexCounts", threes.into());
    mesh.set(
        "int[]",
        "faceVertexIndices",
        Array::Int(Rows::of(corners)).into(),
    );
    mesh.set("point3f[]", "points", Array::Vec3(Rows::of(points)).into());
    mesh.add(Attribute {
        name: "normals".to_owned(),
        type_name: "normal3f[]",
        interpolation: "vertex",
        value: Some(Array::Vec3(Rows::of(normals)).into()),
        ..Attribute::default()
    });
    mesh.primvar(
        "color3f[]",
        "displayColor",
        "vertex",
        Array::Vec3(Rows::of(colors)).into(),
    );
    mesh.primvar(
        "texCoord2f[]",
        "st",
        "faceVarying",
        Array::Vec2(Rows::of(uvs)).into(),
    );
    mesh.set_uniform("token", "subdivisionScheme", Value::token("none"));
    mesh.api_schemas.push("MaterialBindingAPI".to_owned());
    mesh.relate("material:binding", material);
    mesh
}

/// A preview surface with the picture as its color.
fn coat<'a>(path: &str) -> Prim<'a> {
    let shader = |name: &str, id: &'static str| {
        let mut shader = Prim::new("Shader", name);
        shader.set_uniform("token", "info:id", Value::token(id));
        shader
    };
    let joined = |type_name, name: &str, target: Option<&str>| Attribute {
        name: name.to_owned(),
        type_name,
        connection: target.map(|target| format!("{path}/{target}")),
        ..Attribute::default()
    };
    let mut place = shader("place", "UsdPrimvarReader_float2");
    place.set("string", "inputs:varname", Value::string("st"));
    place.add(joined("float2", "outputs:result", None));
    let mut picture = shader("picture", "UsdUVTexture");
    picture.set("asset", "inputs:file", Value::Asset(format!("./{PICTURE}")));
    picture.set("token", "inputs:sourceColorSpace", Value::token("sRGB"));
    picture.add(joined("float2", "inputs:st", Some("place.outputs:result")));
    picture.add(joined("float3", "outputs:rgb", None));
    let mut surface = shader("surface", "UsdPreviewSurface");
    surface.add(joined(
        "color3f",
        "inputs:diffuseColor",
        Some("picture.outputs:rgb"),
    ));
    surface.set("float", "inputs:roughness", Value::Float(ROUGHNESS));
    surface.add(joined("token", "outputs:surface", None));
    let mut material = Prim::new("Material", "coat");
    material.add(joined(
        "token",
        "outputs:surface",
        Some("surface.outputs:surface"),
    ));
    material.children = vec![surface, picture, place];
    material
}
