//! Points for tools that know no curves: a vertex a control point.

use super::{Lines, WriteError, srgb};
use std::io::Write;

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    let has_colors = !lines.colors.is_empty();
    let mut head = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nproperty float width\nproperty uint strand\n",
        lines.origin.replace(['\n', '\r'], " "),
        lines.points.len()
    );
    if has_colors {
        head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    }
    head += "end_header\n";
    out.write_all(head.as_bytes())?;
    let mut block = Vec::new();
    for strand in 0..lines.strands() {
        for i in lines.range(strand) {
            for c in lines.points[i].to_array() {
                block.extend(c.to_le_bytes());
            }
            block.extend(lines.widths[i].to_le_bytes());
            block.extend((strand as u32).to_le_bytes());
            if has_colors {
                block.extend(srgb(lines.colors[i]));
            }
        }
        if block.len() > 1 << 16 || strand + 1 == lines.strands() {
            out.write_all(&block)?;
            block.clear();
        }
    }
    Ok(())
}
