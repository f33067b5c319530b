//! Curves of pbrt (version 4), to be included in a scene. A curve of pbrt has one width at each of its
//! ends, so that every span is a curve of its own.

use super::{Lines, WriteError};
use crate::math::spline::bezier_piece;
use glam::Vec3;
use std::io::Write;

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    let origin = lines.origin.replace(['\n', '\r'], " ");
    let mean: Vec3 = lines.colors.iter().sum::<Vec3>() / lines.colors.len().max(1) as f32;
    writeln!(out, "# {origin}: {} strands", lines.strands())?;
    writeln!(out, "AttributeBegin")?;
    if !lines.colors.is_empty() {
        let [r, g, b] = mean.to_array();
        writeln!(out, "Material \"hair\" \"rgb reflectance\" [{r} {g} {b}]")?;
    }
    for strand in 0..lines.strands() {
        let range = lines.range(strand);
        let points = &lines.points[range.clone()];
        for i in 0..points.len().saturating_sub(1) {
            let [w0, w1] = [0, 1].map(|k| lines.widths[range.start + i + k]);
            write!(
                out,
                "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" ["
            )?;
            for p in bezier_piece::<_, f32>(points.len(), |i| points[i], i) {
                write!(out, " {} {} {}", p.x, p.y, p.z)?;
            }
            writeln!(out, " ] \"float width0\" {w0} \"float width1\" {w1}")?;
        }
    }
    writeln!(out, "AttributeEnd")?;
    Ok(())
}
