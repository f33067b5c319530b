//! Materials: MaterialX's hair with plain numbers, a preview for viewports, and how well they fit.

use super::color::Coats;
use super::look::{ClassLook, HairLook};
use super::provenance::identifier;
use crate::export::usd::{Attribute, Dictionary, Prim, Value};
use crate::species::HairClass;
use glam::Vec3;

/// Version of MaterialX that has the hair node.
const MATERIALX: &str = "1.39";

/// Roughness of the preview, which is no hair.
const PREVIEW_ROUGHNESS: f32 = 0.6;

/// Materials of one hair class.
///
/// * `scope`: path of the scope that they go to. * `coats`: names of the parts of the coat.
///
/// The first is for all its hair: where pigment changes it reads the absorption from the strands and has
/// the other numbers of the longest zone. Each zone of such hair has a plain one besides.
pub(super) fn materials<'a>(
    scope: &str,
    class: &HairClass,
    coats: &[String],
    look: &ClassLook,
    pigment: &Coats,
) -> Vec<Prim<'a>> {
    let own = &pigment.0[0];
    let longest = own.longest(class.groom.length_mm as f32);
    let name = identifier(&class.name);
    let whole = Hair {
        path: format!("{scope}/{name}"),
        look: &look.parts[0][longest],
        color: own.values[longest].color,
        changes: !pigment.is_even(),
        station: look.station,
    };
    let mut materials = vec![whole.material(&name)];
    if !whole.changes {
        return materials;
    }
    for (part, looks) in look.parts.iter().enumerate() {
        let coat = match coats.get(part) {
            Some(coat) if part > 0 => format!("_{}", identifier(coat)),
            _ => String::new(),
        };
        for (zone, look_of_zone) in looks.iter().enumerate() {
            let name = format!("{name}{coat}_zone_{}", zone + 1);
            let hair = Hair {
                path: format!("{scope}/{name}"),
                look: look_of_zone,
                color: pigment.0[part].values[zone].color,
                changes: false,
                station: look.station,
            };
            materials.push(hair.material(&name));
        }
    }
    materials
}

/// The material of the skin.
pub(super) fn skin<'a>(scope: &str, color: Vec3) -> Prim<'a> {
    let mut material = Prim::new("Material", "skin");
    let path = format!("{scope}/skin");
    output(
        &mut material,
        "outputs:surface",
        &path,
        "preview",
        "surface",
    );
    material.children.extend(preview(&path, color, None));
    material
}

struct Hair<'l> {
    path: String,
    look: &'l HairLook,
    color: Vec3,
    /// Whether the absorption changes along the hair.
    changes: bool,
    station: f64,
}

impl Hair<'_> {
    fn material<'a>(&self, name: &str) -> Prim<'a> {
        let mut material = Prim::new("Material", name);
        material.api_schemas.push("MaterialXConfigAPI".to_owned());
        material.custom_data = self.errors();
        material.set("string", "config:mtlx:version", Value::string(MATERIALX));
        output(
            &mut material,
            "outputs:surface",
            &self.path,
            "preview",
            "surface",
        );
        output(
            &mut material,
            "outputs:mtlx:surface",
            &self.path,
            "surface",
            "out",
        );
        let primvar = self.changes.then_some("displayColor");
        material
            .children
            .extend(preview(&self.path, self.color, primvar));
        material.children.extend(self.materialx());
        material
    }

    fn materialx<'a>(&self) -> Vec<Prim<'a>> {
        let mut surface = shader("surface", "ND_surface");
        connect(
            &mut surface,
            "token",
            "inputs:bsdf",
            &self.path,
            "hair",
            "out",
        );
        surface.add(declared("token", "outputs:out"));

        let look = self.look;
        let [v, s] = look.roughness();
        let mut hair = shader("hair", "ND_chiang_hair_bsdf");
        for tint in ["tint_R", "tint_TT", "tint_TRT"] {
            hair.set("color3f", format!("inputs:{tint}"), Value::Vec3([1.0; 3]));
        }
        hair.set("float", "inputs:ior", Value::Float(look.ior as f32));
        // Marschner's scales of the width of TT and TRT, 0.5 and 2, squared.
        for (lobe, scale) in [("R", 1.0), ("TT", 0.25), ("TRT", 4.0)] {
            let value = [(scale * v) as f32, s as f32];
            hair.set(
                "float2",
                format!("inputs:roughness_{lobe}"),
                Value::Vec2(value),
            );
        }
        hair.set(
            "float",
            "inputs:cuticle_angle",
            Value::Float(look.cuticle_angle() as f32),
        );
        let absorption = Value::Vec3(look.absorption.map(|a| a as f32));
        let name = "inputs:absorption_coefficient";
        hair.add(declared("token", "outputs:out"));
        if !self.changes {
            hair.set("float3", name, absorption);
            return vec![surface, hair];
        }
        connect(&mut hair, "float3", name, &self.path, "absorption", "out");
        let mut reader = shader("absorption", "ND_geompropvalue_vector3");
        reader.set("string", "inputs:geomprop", Value::string("absorption"));
        reader.set("float3", "inputs:default", absorption);
        reader.add(declared("float3", "outputs:out"));
        vec![surface, hair, reader]
    }

    /// What the model loses, as custom data of the material.
    fn errors<'a>(&self) -> Dictionary<'a> {
        let number = |value: f64| Value::Double((value * 1e4).round() / 1e4);
        let entry = |name: &str, value: Value<'a>| (name.to_owned(), value);
        let mut entries = vec![
            entry("error_b", number(self.look.error[2])),
            entry("error_g", number(self.look.error[1])),
            entry("error_r", number(self.look.error[0])),
            entry("model", Value::string("Chiang et al. 2016")),
            entry("station", Value::Double(self.station)),
        ];
        for lobe in &self.look.lobes {
            let name = lobe.name.replace('+', "_and_on");
            entries.push(entry(&format!("lobe_{name}_error"), number(lobe.error)));
            entries.push(entry(&format!("lobe_{name}_of_model"), number(lobe.model)));
            entries.push(entry(&format!("lobe_{name}_of_table"), number(lobe.table)));
        }
        vec![entry("vair_fit", Value::Dictionary(entries))]
    }
}

/// `UsdPreviewSurface` with one color, or that of a primvar.
fn preview<'a>(material: &str, color: Vec3, primvar: Option<&str>) -> Vec<Prim<'a>> {
    let mut preview = shader("preview", "UsdPreviewSurface");
    preview.set("float", "inputs:roughness", Value::Float(PREVIEW_ROUGHNESS));
    preview.add(declared("token", "outputs:surface"));
    let Some(primvar) = primvar else {
        let color = Value::Vec3(color.to_array());
        preview.set("color3f", "inputs:diffuseColor", color);
        return vec![preview];
    };
    connect(
        &mut preview,
        "color3f",
        "inputs:diffuseColor",
        material,
        "color",
        "result",
    );
    let mut reader = shader("color", "UsdPrimvarReader_float3");
    reader.set("string", "inputs:varname", Value::string(primvar));
    reader.set("float3", "inputs:fallback", Value::Vec3(color.to_array()));
    reader.add(declared("float3", "outputs:result"));
    vec![preview, reader]
}

fn shader<'a>(name: &str, id: &str) -> Prim<'a> {
    let mut shader = Prim::new("Shader", name);
    shader.set_uniform("token", "info:id", Value::token(id));
    shader
}

fn declared<'a>(type_name: &'static str, name: &str) -> Attribute<'a> {
    Attribute {
        name: name.to_owned(),
        type_name,
        ..Attribute::default()
    }
}

/// Connects an input to the output of another shader of the material.
fn connect(
    prim: &mut Prim<'_>,
    type_name: &'static str,
    name: &str,
    material: &str,
    shader: &str,
    output: &str,
) {
    prim.add(Attribute {
        connection: Some(format!("{material}/{shader}.outputs:{output}")),
        ..declared(type_name, name)
    });
}

/// Connects an output of a material.
fn output(prim: &mut Prim<'_>, name: &str, material: &str, shader: &str, output: &str) {
    connect(prim, "token", name, material, shader, output);
}

/// The same look in the words of Blender's Principled Hair BSDF, model Chiang.
pub(super) fn blender(look: &HairLook) -> [(&'static str, Value<'static>); 6] {
    [
        ("blender_hair_model", Value::string("CHIANG")),
        (
            "blender_absorption_coefficient",
            Value::Vec3(look.absorption.map(|a| a as f32)),
        ),
        ("blender_roughness", Value::Float(look.longitudinal as f32)),
        (
            "blender_radial_roughness",
            Value::Float(look.azimuthal as f32),
        ),
        ("blender_ior", Value::Float(look.ior as f32)),
        (
            "blender_offset",
            Value::Float(look.tilt_deg.to_radians() as f32),
        ),
    ]
}
