//! The prims of an asset.

use super::color::Zones;
use super::levels::{Level, LevelClass, guides, proxy};
use super::look::ClassLook;
use super::profile::{Column, Reader};
use super::provenance::{PROGRAM, asset_info, identifier, recipe, user_properties};
use super::strands::Strands;
use super::{AssetSettings, Parts, material, skin};
use crate::export::usd::{Array, Attribute, Layer, Prim, Rows, Value, VariantSet};
use crate::species::HairClass;
use glam::Vec3;
use std::sync::Arc;

/// A groom as one file.
///
/// * `file`: its name, without a folder.
pub fn layer<'a>(parts: &Parts<'a>, settings: &'a AssetSettings, file: &str) -> Layer<'a> {
    let root = Builder { parts, settings }.root(file);
    Layer {
        documentation: format!(
            "Fur of {} ({}), by {PROGRAM}",
            parts.species.name, parts.species.id
        ),
        default_prim: root.name.clone(),
        meters_per_unit: settings.frame.meters_per_unit(),
        up_axis: settings.frame.up_axis(),
        custom_data: vec![("creator".to_owned(), Value::string(PROGRAM))],
        prims: vec![root],
    }
}

struct Builder<'p, 'a> {
    parts: &'p Parts<'a>,
    settings: &'a AssetSettings,
}

/// What a prim of curves is for.
#[derive(Clone, Copy, PartialEq)]
enum Purpose {
    Render,
    Proxy,
    Guide,
}

impl<'a> Builder<'_, 'a> {
    fn root(&self, file: &str) -> Prim<'a> {
        let species = self.parts.species;
        let mut root = Prim::new("Xform", identifier(&species.id));
        root.documentation = species.summary.clone();
        root.kind = "component";
        root.asset_info = asset_info(self.parts, file);
        root.custom_data = recipe(self.parts);
        if self.settings.profile.has(Reader::Unreal) {
            root.api_schemas.push("GroomAPI".to_owned());
            for (name, value) in [("groom_version_major", 1), ("groom_version_minor", 5)] {
                root.add(custom("int", name, Value::Int(value)));
            }
            root.add(custom("string", "groom_tool", Value::string(PROGRAM)));
        }
        let seed = self.parts.seed.to_string();
        user_properties(
            &mut root,
            &[
                ("species", Value::string(&species.name)),
                ("latin", Value::string(&species.latin)),
                ("program", Value::string(PROGRAM)),
                ("seed", Value::string(seed)),
            ],
        );
        let mut scope = Prim::new("Scope", "mtl");
        scope.children = self.materials();
        root.children.push(self.geometry());
        if !scope.children.is_empty() {
            root.children.push(scope);
        }
        if let [_, _, ..] = self.parts.levels {
            root.selections
                .push(("lod".to_owned(), self.parts.levels[0].name.to_owned()));
            root.variant_sets.push(VariantSet {
                name: "lod".to_owned(),
                variants: self.parts.levels.iter().map(|l| self.variant(l)).collect(),
            });
        }
        root
    }

    /// The color of the skin.
    fn skin_color(&self) -> Vec3 {
        Vec3::from_array(self.parts.species.skin_color.map(|c| c as f32))
    }

    /// Path of the scope of the materials.
    fn material_scope(&self) -> String {
        format!("/{}/mtl", identifier(&self.parts.species.id))
    }

    fn materials(&self) -> Vec<Prim<'a>> {
        let scope = self.material_scope();
        let mut materials = Vec::new();
        for (class, look) in self.parts.looks.iter().enumerate() {
            let hair = self.class(class);
            let zones = Zones::new(hair, &hair.pigment, Some(look));
            let name = identifier(&hair.name);
            materials.extend(material::materials(&scope, &name, hair, look, &zones));
        }
        if !materials.is_empty() {
            materials.push(material::skin(&scope, self.skin_color()));
        }
        materials
    }

    fn look(&self, class: usize) -> Option<&'a ClassLook> {
        self.parts.looks.get(class)
    }

    /// Binds a material, if there are any.
    fn bind(&self, prim: &mut Prim<'a>, material: &str) {
        if !self.parts.looks.is_empty() {
            prim.api_schemas.push("MaterialBindingAPI".to_owned());
            prim.relate(
                "material:binding",
                format!("{}/{material}", self.material_scope()),
            );
        }
    }

    fn geometry(&self) -> Prim<'a> {
        let mut geometry = Prim::new("Scope", "geo");
        let mut mesh = skin::mesh(self.parts.skin, self.settings.frame, self.skin_color());
        self.bind(&mut mesh, "skin");
        geometry.children.push(mesh);
        let full = &self.parts.levels[0];
        let mut render = purpose("render");
        for (class, level) in self.classes(full) {
            let mut curves = self.curves(class);
            if self.parts.levels.len() == 1 {
                self.fill(&mut curves, class, level, Purpose::Render);
            }
            render.children.push(curves);
        }
        geometry.children.push(render);
        if !self.settings.no_proxy {
            let few = proxy(full);
            let mut scope = purpose("proxy");
            for (class, level) in self.classes(&few) {
                let mut curves = self.curves(class);
                self.fill(&mut curves, class, level, Purpose::Proxy);
                scope.children.push(curves);
            }
            geometry.children.push(scope);
        }
        let leading = guides(full);
        if !self.settings.no_guides && !leading.strands.is_empty() {
            let mut scope = purpose("guide");
            let mut curves = self.curves(0);
            self.fill(&mut curves, 0, leading, Purpose::Guide);
            scope.children.push(curves);
            geometry.children.push(scope);
        }
        geometry
    }

    /// Classes with strands, and those strands.
    fn classes(&self, level: &Level) -> Vec<(usize, LevelClass)> {
        let classes = level.classes.iter().cloned().enumerate();
        classes.filter(|(_, c)| !c.strands.is_empty()).collect()
    }

    /// What a level of detail adds to the curves that are there.
    fn variant(&self, level: &Level) -> Prim<'a> {
        let mut render = Prim::over("render");
        for (class, strands) in self.classes(level) {
            let mut curves = Prim::over(identifier(&self.class(class).name));
            self.fill(&mut curves, class, strands, Purpose::Render);
            render.children.push(curves);
        }
        let mut geometry = Prim::over("geo");
        geometry.children.push(render);
        let mut variant = Prim::over(level.name);
        variant.children.push(geometry);
        variant
    }

    fn class(&self, class: usize) -> &'a HairClass {
        &self.parts.species.classes[class]
    }

    /// Curves without their strands.
    fn curves(&self, class: usize) -> Prim<'a> {
        let mut curves = Prim::new("BasisCurves", identifier(&self.class(class).name));
        let (kind, basis, wrap) = self.settings.curves.schema();
        curves.set_uniform("token", "type", Value::token(kind));
        if let Some(basis) = basis {
            curves.set_uniform("token", "basis", Value::token(basis));
        }
        curves.set_uniform("token", "wrap", Value::token(wrap));
        let name = self.class(class).name.clone();
        if let Some(look) = self.look(class)
            && self.settings.profile.has(Reader::Blender)
        {
            let hair = self.class(class);
            let zones = Zones::new(hair, &hair.pigment, Some(look));
            let longest = zones.longest(hair.groom.length_mm as f32);
            user_properties(&mut curves, &material::blender(&look.zones[longest]));
        }
        self.bind(&mut curves, &identifier(&name));
        user_properties(
            &mut curves,
            &[
                ("class", Value::string(name)),
                ("species", Value::string(&self.parts.species.id)),
            ],
        );
        curves
    }

    /// Gives curves their strands.
    fn fill(
        &self,
        prim: &mut Prim<'a>,
        class: usize,
        LevelClass {
            strands: index,
            widening,
        }: LevelClass,
        purpose: Purpose,
    ) {
        let strands = Strands::new(
            self.parts.groom,
            index,
            widening,
            self.settings.curves,
            self.settings.frame,
        );
        let extent = Array::Vec3(Rows::of(strands.extent().to_vec()));
        prim.set("float3[]", "extent", extent.into());
        prim.set("int[]", "curveVertexCounts", strands.counts().into());
        let points: Value<'a> = strands.points().into();
        prim.set("point3f[]", "points", points.clone());
        prim.add(Attribute {
            name: "widths".to_owned(),
            type_name: "float[]",
            interpolation: "vertex",
            value: Some(strands.widths().into()),
            ..Attribute::default()
        });
        if purpose == Purpose::Guide {
            prim.primvar("point3f[]", "rest", "vertex", points);
        }
        self.strand_columns(prim, &strands, class, purpose);
        self.point_columns(prim, &strands, class);
    }

    /// Attributes that a strand has once.
    fn strand_columns(
        &self,
        prim: &mut Prim<'a>,
        strands: &Strands<'a>,
        class: usize,
        purpose: Purpose,
    ) {
        let (groom, profile) = (self.parts.groom, &self.settings.profile);
        let uv: Value<'a> = Array::Vec2(strands.uniform(|i| groom.root_uv[i].to_array())).into();
        for (column, name) in [
            (Column::RootUv, "st"),
            (Column::GroomRootUv, "groom_root_uv"),
            (Column::SurfaceUv, "surface_uv_coordinate"),
        ] {
            if profile.wants(column) {
                prim.primvar("texCoord2f[]", name, "uniform", uv.clone());
            }
        }
        if profile.wants(Column::SkinPrim) {
            let triangle = strands.uniform(|i| groom.root_triangle[i] as i32);
            prim.primvar("int[]", "skinprim", "uniform", Array::Int(triangle).into());
            let place = strands.uniform(|i| groom.root_barycentric[i].extend(0.0).to_array());
            prim.primvar(
                "float3[]",
                "skinprimuv",
                "uniform",
                Array::Vec3(place).into(),
            );
        }
        let id: Value<'a> = Array::Int(strands.uniform(|i| groom.id[i] as i32)).into();
        for (column, name) in [(Column::CurveId, "curve_id"), (Column::GroomId, "groom_id")] {
            if profile.wants(column) {
                prim.primvar("int[]", name, "uniform", id.clone());
            }
        }
        if profile.wants(Column::GroomGroup) {
            let group = strands.uniform(move |_| class as i32);
            prim.primvar(
                "int[]",
                "groom_group_id",
                "uniform",
                Array::Int(group).into(),
            );
            let name = Value::Strings(vec![self.class(class).name.clone()]);
            prim.primvar("string[]", "groom_group_name", "constant", name);
        }
        if profile.wants(Column::GroomGuide) {
            let flag = i32::from(purpose == Purpose::Guide);
            let guide = strands.uniform(move |_| flag);
            prim.primvar("int[]", "groom_guide", "uniform", Array::Int(guide).into());
        }
    }

    /// Attributes that change along a strand.
    fn point_columns(&self, prim: &mut Prim<'a>, strands: &Strands<'a>, class: usize) {
        let (groom, profile) = (self.parts.groom, &self.settings.profile);
        let hair = self.class(class);
        let zones = Arc::new(Zones::new(hair, &hair.pigment, self.look(class)));
        let of = Arc::clone(&zones);
        let color: Value<'a> = strands
            .vertex3(move |i, out| of.along(groom, i, |dye| dye.color, out))
            .into();
        for (column, kind, name) in [
            (Column::DisplayColor, "color3f[]", "displayColor"),
            (Column::GroomColor, "float3[]", "groom_color"),
        ] {
            if profile.wants(column) {
                prim.primvar(kind, name, "vertex", color.clone());
            }
        }
        if profile.wants(Column::Melanin) {
            self.melanin(prim, strands, &zones);
        }
        if profile.wants(Column::Absorption) && !zones.is_even() {
            let of = Arc::clone(&zones);
            let absorption =
                strands.vertex3(move |i, out| of.along(groom, i, |dye| dye.absorption, out));
            prim.primvar("vector3f[]", "absorption", "vertex", absorption.into());
        }
    }

    fn melanin(&self, prim: &mut Prim<'a>, strands: &Strands<'a>, zones: &Arc<Zones>) {
        let groom = self.parts.groom;
        for (part, name) in ["eumelanin", "pheomelanin"].into_iter().enumerate() {
            if zones.is_even() {
                let value = zones.values[0].melanin[part];
                let value = Array::Float(Rows::of(vec![value]));
                prim.primvar("float[]", name, "constant", value.into());
                continue;
            }
            let of = Arc::clone(zones);
            let values = strands.vertex(move |i, out: &mut Vec<f32>| {
                let mut both = Vec::new();
                of.along(groom, i, |dye| dye.melanin, &mut both);
                out.extend(both.iter().map(|m| m[part]));
            });
            prim.primvar("float[]", name, "vertex", Array::Float(values).into());
        }
    }
}

/// A scope whose purpose holds for all below it.
fn purpose(name: &'static str) -> Prim<'static> {
    let mut scope = Prim::new("Scope", name);
    scope.set_uniform("token", "purpose", Value::token(name));
    scope
}

/// An attribute that no schema knows.
fn custom<'a>(type_name: &'static str, name: &str, value: Value<'a>) -> Attribute<'a> {
    Attribute {
        name: name.to_owned(),
        type_name,
        custom: true,
        value: Some(value),
        ..Attribute::default()
    }
}
