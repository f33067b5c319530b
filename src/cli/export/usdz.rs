//! The part of `vair export` that writes a mesh in place of the strands.

use super::super::{Console, Failure};
use crate::export::asset::{Frame, Parts};
use crate::export::usdz;
use std::path::Path;

pub(super) fn run(
    path: &Path,
    parts: &Parts<'_>,
    frame: Frame,
    console: &Console,
) -> Result<(), Failure> {
    let triangles = usdz::write(path, parts, frame)?;
    console.say(format!(
        "{}: a mesh of {triangles} triangles in place of {} strands",
        path.display(),
        parts.groom.strands()
    ));
    Ok(())
}
