//! Rules on the boxes that prims are culled by.

use super::consumer::{Consumer, DRAWING};
use super::curves::Curves;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::{Item, bounds, floats};
use crate::usd_file::Property;
use Consumer::{Houdini, Storm, Validators};
use Severity::{Error, Warning};
use glam::Vec3;

/// How far an extent may be off, as a share of its largest coordinate: some roundings.
const EXTENT_TOLERANCE: f32 = 1e-5;

impl Curves<'_> {
    pub(super) fn check_extent(&self, findings: &mut Findings<'_>) {
        let widths = self.widths().and_then(Property::any_value);
        let widest = floats(widths, 1).map(|w| w.iter().fold(0.0f32, |a, b| a.max(*b)));
        check_extent(self.item, widest.map(|w| 0.5 * w), findings);
    }
}

/// That the extent of a prim is the box around its points and so much more, at every time; where it is not
/// known how much more, that all points are inside.
pub(super) fn check_extent(item: &Item<'_>, more: Option<f32>, findings: &mut Findings<'_>) {
    let place = Place {
        prim: &item.path,
        attribute: "extent",
    };
    let remedy =
        "write the box around all points and half the widest width, for each time that has points";
    let (Some(points), extent) = (item.prim.property("points"), item.prim.property("extent"))
    else {
        return;
    };
    let Some(extent) = extent.filter(|e| e.any_value().is_some()) else {
        let message = "there is no extent: readers compute it, or do not show the prim";
        findings.add(
            (Rule::C11, Warning),
            &[Validators, Storm, Houdini],
            place,
            message,
            remedy,
        );
        return;
    };
    let mut times = vec![("".to_owned(), points.any_value(), extent.any_value())];
    for (time, value) in &points.samples {
        let at = extent
            .samples
            .iter()
            .find(|(t, _)| t == time)
            .map(|(_, v)| v);
        times.push((
            format!(" at time {time}"),
            Some(value),
            at.or(extent.value.as_ref()),
        ));
    }
    for (time, points, extent) in times {
        let Some(points) = floats(points, 3).filter(|p| !p.is_empty()) else {
            continue;
        };
        let (lo, hi) = bounds(points);
        let found = floats(extent, 3).filter(|e| e.len() == 6);
        let Some((low, high)) = found.map(|e| (Vec3::from_slice(e), Vec3::from_slice(&e[3..])))
        else {
            let message = match extent {
                None => format!("there is no extent{time}"),
                Some(_) => format!("extent is not two corners{time}"),
            };
            findings.add((Rule::C11, Error), DRAWING, place, message, remedy);
            continue;
        };
        let tolerance = EXTENT_TOLERANCE * lo.abs().max(hi.abs()).max_element().max(1e-6);
        let off = |a: Vec3, b: Vec3| (a - b).abs().max_element();
        if (low - lo).max(hi - high).max_element() > tolerance {
            let message = format!(
                "extent leaves points out{time}: it is {low} to {high}, they reach from {lo} to {hi}"
            );
            findings.add((Rule::C11, Error), DRAWING, place, message, remedy);
        } else if let Some(more) = more
            && off(low, lo - more).max(off(high, hi + more)) > tolerance
        {
            let message = format!(
                "extent is {low} to {high}{time}; points and half the widest width reach from {} to {}",
                lo - more,
                hi + more
            );
            findings.add(
                (Rule::C11, Warning),
                &[Validators, Storm, Houdini],
                place,
                message,
                remedy,
            );
        }
    }
}
