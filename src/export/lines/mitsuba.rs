//! Curves of Mitsuba 3 (`bsplinecurve`): a control point and its radius a line, an empty line after each strand.

use super::{Lines, WriteError};
use crate::export::mitsuba::interpolating_b_spline;
use glam::Vec4;
use std::io::Write;

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    for strand in 0..lines.strands() {
        let points: Vec<Vec4> = (lines.range(strand))
            .map(|i| lines.points[i].extend(0.5 * lines.widths[i]))
            .collect();
        for p in interpolating_b_spline(&points) {
            writeln!(out, "{} {} {} {}", p.x, p.y, p.z, p.w.max(0.0))?;
        }
        writeln!(out)?;
    }
    Ok(())
}
