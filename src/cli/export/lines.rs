//! The part of `vair export` that writes plain strands.

use super::super::{Console, Failure};
use crate::PROGRAM;
use crate::export::asset::{self, Frame, Parts};
use crate::export::lines::{self, LineFormat, LineSet};
use std::path::Path;

/// Writes the strands of a groom with their colors.
pub(super) fn run(
    path: &Path,
    format: LineFormat,
    parts: &Parts<'_>,
    frame: Frame,
    console: &Console,
) -> Result<(), Failure> {
    let groom = parts.groom;
    // Those of glTF are always meters, with Y up.
    let frame = if format == LineFormat::Glb {
        Frame::default()
    } else {
        frame
    };
    asset::check(groom)?;
    let set = LineSet {
        points: groom.points.iter().map(|p| frame.point(*p)).collect(),
        widths: groom.widths.iter().map(|w| frame.length(*w)).collect(),
        offsets: groom.offsets.clone(),
        colors: asset::colors(groom, parts.species),
    };
    let origin = format!(
        "{} on {}, seed {}, by {PROGRAM}",
        parts.species.id, parts.skin.name, parts.seed
    );
    lines::write(path, format, &set.lines(&origin))?;
    console.say(format!(
        "{}: {} strands, {} points",
        path.display(),
        groom.strands(),
        groom.points.len()
    ));
    Ok(())
}
