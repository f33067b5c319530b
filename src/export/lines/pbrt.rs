//! Curves of pbrt (version 4), to be included in a scene. A curve of pbrt has one width at each of its
//! ends, so that every span is a curve of its own.

use super::{Lines, WriteError};
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
            for p in bezier(points, i) {
                write!(out, " {} {} {}", p.x, p.y, p.z)?;
            }
            writeln!(out, " ] \"float width0\" {w0} \"float width1\" {w1}")?;
        }
    }
    writeln!(out, "AttributeEnd")?;
    Ok(())
}

/// The span between points `i` and `i + 1` of a Catmull-Rom spline whose ends are pinned by reflected
/// neighbors.
fn bezier(points: &[Vec3], i: usize) -> [Vec3; 4] {
    let (b, c) = (points[i], points[i + 1]);
    let a = if i == 0 { 2.0 * b - c } else { points[i - 1] };
    let d = points.get(i + 2).copied().unwrap_or(2.0 * c - b);
    [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c]
}
