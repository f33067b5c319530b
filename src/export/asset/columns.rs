//! What strands are given besides points and widths.

use super::color::Coats;
use super::profile::Column;
use super::strands::Strands;
use super::tree::{Builder, Purpose};
use crate::export::usd::{Array, Prim, Rows, Value};
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
        let coats = Coats::new(self.parts.species, class, self.look(class));
        let zones = Arc::new(coats);
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

    fn melanin(&self, prim: &mut Prim<'a>, strands: &Strands<'a>, zones: &Arc<Coats>) {
        let groom = self.parts.groom;
        for (part, name) in ["eumelanin", "pheomelanin"].into_iter().enumerate() {
            if zones.is_even() {
                let value = zones.0[0].values[0].melanin[part];
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
