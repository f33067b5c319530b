//! Curves of Mitsuba 3 (`bsplinecurve`).

use super::{Lines, WriteError};
use crate::export::mitsuba::write_strand;
use glam::Vec4;
use std::io::Write;

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    for strand in 0..lines.strands() {
        let points: Vec<Vec4> = (lines.range(strand))
            .map(|i| lines.points[i].extend(0.5 * lines.widths[i]))
            .collect();
        write_strand(out, &points)?;
    }
    Ok(())
}
