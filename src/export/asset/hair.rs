//! The prims of curves, one a hair class, and their strands.

use super::AssetSettings;
use super::levels::{Level, LevelClass};
use super::material;
use super::profile::Reader;
use super::provenance::{identifier, user_properties};
use super::strands::Strands;
use super::tree::{Builder, Purpose};
use crate::export::usd::{Array, Attribute, Prim, Rows, Value};

impl<'a> Builder<'_, 'a> {
    pub(super) fn strands(&self, class: LevelClass) -> Strands<'a> {
        let AssetSettings { curves, frame, .. } = *self.settings;
        Strands::new(
            self.parts.groom,
            class.strands,
            class.widening,
            curves,
            frame,
        )
    }

    /// The strands of a level as a variant of some name.
    pub(super) fn strands_of(&self, level: &Level, name: &str) -> Prim<'a> {
        let mut render = Prim::over("render");
        for (class, strands) in self.classes(level) {
            let mut curves = Prim::over(identifier(&self.class(class).name));
            self.fill(&mut curves, class, strands, Purpose::Render);
            render.children.push(curves);
        }
        let mut geometry = Prim::over("geo");
        geometry.children.push(render);
        let mut variant = Prim::over(name);
        variant.children.push(geometry);
        variant
    }

    /// Curves without their strands.
    pub(super) fn curves(&self, class: usize) -> Prim<'a> {
        let mut curves = Prim::new("BasisCurves", identifier(&self.class(class).name));
        let (kind, basis, wrap) = self.settings.curves.schema();
        curves.set_uniform("token", "type", Value::token(kind));
        if let Some(basis) = basis {
            curves.set_uniform("token", "basis", Value::token(basis));
        }
        curves.set_uniform("token", "wrap", Value::token(wrap));
        let name = self.class(class).name.clone();
        if let Some(look) = self.parts.looks.get(class)
            && self.settings.profile.has(Reader::Blender)
        {
            let hair = self.class(class);
            let longest = self.coats[class].0[0].longest(hair.groom.length_mm as f32);
            user_properties(&mut curves, &material::blender(&look.parts[0][longest]));
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
    pub(super) fn fill(
        &self,
        prim: &mut Prim<'a>,
        class: usize,
        of_class: LevelClass,
        purpose: Purpose,
    ) {
        let strands = self.strands(of_class);
        if self.content.shape {
            let extent = Array::Vec3(Rows::of(strands.extent().to_vec()));
            prim.set("float3[]", "extent", extent.into());
        }
        if self.content.strands {
            prim.set("int[]", "curveVertexCounts", strands.counts().into());
        }
        if self.content.shape {
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
        }
        if self.content.strands {
            self.strand_columns(prim, &strands, class, purpose);
        }
        if self.content.color {
            self.point_columns(prim, &strands, class);
        }
    }
}
