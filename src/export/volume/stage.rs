//! A USD layer that shows the grids of a file.

use super::{Plan, Written};
use crate::export::asset::Frame;
use crate::export::usd::{Array, Layer, Prim, Rows, Value};
use crate::export::vdb::Class;

/// A layer with one `Volume` whose fields are the grids of an OpenVDB file.
///
/// * `file`: path of the OpenVDB file as seen from the layer, `./fox.vdb`.
/// * `name`: of the root prim, an identifier.
pub fn stage<'a>(
    file: &str,
    name: &str,
    written: &[Written],
    plan: &Plan,
    frame: Frame,
) -> Layer<'a> {
    let mut volume = Prim::new("Volume", "volume");
    let root_path = format!("/{name}/volume");
    let extent = extent(written, plan.voxel);
    let extent = Array::Vec3(Rows::of(extent.to_vec()));
    volume.set("float3[]", "extent", extent.into());
    for grid in written {
        let field = grid.field;
        let path = format!("{root_path}/{}", field.name());
        volume.relate(format!("field:{}", field.name()), path);
        let mut asset = Prim::new("OpenVDBAsset", field.name());
        asset.set("asset", "filePath", Value::Asset(file.to_owned()));
        asset.set("token", "fieldName", Value::token(field.name()));
        let (data, role) = match (field.is_vector(), field.name()) {
            (false, _) => ("float", "None"),
            (true, "tangent") => ("float3", "Vector"),
            (true, _) => ("float3", "Color"),
        };
        asset.set("token", "fieldDataType", Value::token(data));
        let class = match field.class() {
            Class::FogVolume => "fogVolume",
            Class::LevelSet => "levelSet",
            Class::Unknown => "unknown",
        };
        asset.set("token", "fieldClass", Value::token(class));
        asset.set("token", "vectorDataRoleHint", Value::token(role));
        volume.children.push(asset);
    }
    let mut root = Prim::new("Xform", name);
    root.kind = "component";
    root.children.push(volume);
    Layer {
        documentation: format!("Grids of {file}"),
        default_prim: name.to_owned(),
        meters_per_unit: frame.meters_per_unit(),
        up_axis: frame.up_axis(),
        custom_data: Vec::new(),
        prims: vec![root],
    }
}

/// The box around all active voxels.
fn extent(written: &[Written], voxel: f64) -> [[f32; 3]; 2] {
    let bounds = written.iter().filter_map(|w| w.bounds);
    let both = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (lo, hi) = both.unwrap_or_default();
    [lo.as_dvec3() - 0.5, hi.as_dvec3() + 0.5].map(|p| (p * voxel).as_vec3().to_array())
}
