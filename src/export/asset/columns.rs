//! What strands are given besides points and widths.

use super::color::Dye;
use super::profile::Column;
use super::strands::Strands;
use super::tree::{Builder, Purpose};
use crate::export::usd::{Array, Prim, Rows, Value};
use glam::Vec3;
use std::sync::Arc;

impl<'a> Builder<'_, 'a> {
    /// Attributes that a strand has once.
    pub(super) fn strand_columns(
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
    pub(super) fn point_columns(&self, prim: &mut Prim<'a>, strands: &Strands<'a>, class: usize) {
        let (groom, profile) = (self.parts.groom, &self.settings.profile);
        let coats = &self.coats[class];
        let along = |of: fn(&Dye) -> Vec3| {
            let coats = Arc::clone(coats);
            move |strand, out: &mut Vec<Vec3>| coats.along(groom, strand, of, out)
        };
        let color = strands.vertex_of(along(|dye| dye.color), Vec3::to_array);
        let color: Value<'a> = Array::Vec3(color).into();
        for (column, kind, name) in [
            (Column::DisplayColor, "color3f[]", "displayColor"),
            (Column::GroomColor, "float3[]", "groom_color"),
        ] {
            if profile.wants(column) {
                prim.primvar(kind, name, "vertex", color.clone());
            }
        }
        if profile.wants(Column::Melanin) {
            for (part, name) in ["eumelanin", "pheomelanin"].into_iter().enumerate() {
                let (interpolation, values) = match coats.is_even() {
                    true => (
                        "constant",
                        Rows::of(vec![coats.0[0].values[0].melanin[part]]),
                    ),
                    false => (
                        "vertex",
                        strands.vertex_of(along(|dye| dye.melanin), move |m| m[part]),
                    ),
                };
                prim.primvar("float[]", name, interpolation, Array::Float(values).into());
            }
        }
        if profile.wants(Column::Absorption) && !coats.is_even() {
            let absorption = strands.vertex_of(along(|dye| dye.absorption), Vec3::to_array);
            let absorption = Array::Vec3(absorption);
            prim.primvar("vector3f[]", "absorption", "vertex", absorption.into());
        }
    }
}
