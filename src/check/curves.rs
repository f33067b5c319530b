//! Curves, and rules on their counts and kinds.

use super::consumer::{Consumer, DRAWING};
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::{Item, floats, ints, points};
use crate::usd_file::Property;
use Consumer::{Arnold, Blender, Cycles, Houdini, RenderMan, Storm, Unreal};
use Severity::{Error, Note, Warning};
use std::collections::BTreeMap;

/// What Unreal holds: points a strand, strands and points of a group.
const MOST_OF_STRAND: i64 = 255;
const MOST_STRANDS: usize = 4_194_303;
const MOST_POINTS: usize = 16_777_215;

/// Curves of a stage.
pub(super) struct Curves<'s> {
    pub(super) item: &'s Item<'s>,
    /// Points of each strand; empty if there are none.
    pub(super) counts: &'s [i64],
    /// Three numbers each.
    pub(super) points: &'s [f32],
    pub(super) is_cubic: bool,
    pub(super) basis: &'s str,
    pub(super) wrap: &'s str,
}

impl<'s> Curves<'s> {
    /// The curves of a prim that is such.
    pub(super) fn of(item: &'s Item<'s>) -> Option<Self> {
        let prim = item.prim;
        if prim.type_name != "BasisCurves" {
            return None;
        }
        let word = |name: &str, otherwise: &'static str| prim.text(name).unwrap_or(otherwise);
        Some(Self {
            item,
            counts: ints(prim.value("curveVertexCounts")).unwrap_or_default(),
            points: floats(prim.value("points"), 3).unwrap_or_default(),
            is_cubic: word("type", "cubic") == "cubic",
            basis: word("basis", "bezier"),
            wrap: word("wrap", "nonperiodic"),
        })
    }

    pub(super) fn place(&self, attribute: &'s str) -> Place<'_> {
        Place {
            prim: &self.item.path,
            attribute,
        }
    }

    /// Which of a strand's points is its root: the second where the first only bends the curve.
    pub(super) fn root(&self) -> usize {
        usize::from(self.is_cubic && self.basis != "bezier" && self.wrap == "nonperiodic")
    }

    /// The attribute of the widths, by either of its names.
    pub(super) fn widths(&self) -> Option<&'s Property> {
        let prim = self.item.prim;
        let with_value = |name| prim.property(name).filter(|p| p.any_value().is_some());
        with_value("primvars:widths").or_else(|| with_value("widths"))
    }

    /// Whether all strands have numbers of points that such curves can have, in all those that are there.
    pub(super) fn is_sound(&self) -> bool {
        self.counts.iter().all(|count| self.fits(*count))
            && self.sum() == self.points.len() as i128 / 3
    }

    /// The least number of points of a strand, and how many more there may be at a time.
    fn steps(&self) -> (i64, i64) {
        match (self.is_cubic, self.wrap, self.basis) {
            (false, ..) | (true, "pinned", "catmullRom" | "bspline") => (2, 1),
            (true, "periodic", "bezier") => (3, 3),
            (true, "periodic", _) => (3, 1),
            (true, _, "bezier") => (4, 3),
            (true, ..) => (4, 1),
        }
    }

    fn fits(&self, count: i64) -> bool {
        let (least, step) = self.steps();
        count >= least && (count - least) % step == 0
    }

    fn sum(&self) -> i128 {
        self.counts.iter().map(|count| i128::from(*count)).sum()
    }

    /// Values that an interpolation asks for, if it is one for curves.
    pub(super) fn expected(&self, interpolation: &str) -> Option<usize> {
        let strands = self.counts.len();
        Some(match interpolation {
            "uniform" => strands,
            "vertex" => self.points.len() / 3,
            "varying" => {
                if !self.is_sound() {
                    return None;
                }
                let of_strand = |&count: &i64| match (self.is_cubic, self.basis, self.wrap) {
                    (true, "bezier", "periodic") => count / 3,
                    (true, "bezier", _) => (count - 4) / 3 + 2,
                    (false, ..) | (true, _, "pinned" | "periodic") => count,
                    _ => count - 2,
                };
                self.counts
                    .iter()
                    .map(|c| of_strand(c).max(0) as usize)
                    .sum()
            }
            _ => return None,
        })
    }

    /// All rules on curves.
    ///
    /// * `meters`: a unit of the stage, if it says.
    pub(super) fn check(&self, meters: Option<f64>, findings: &mut Findings<'_>) {
        self.check_counts(findings);
        if self.points.is_empty() {
            return;
        }
        self.check_widths(findings);
        if let Some(meters) = meters {
            self.check_diameters(meters, findings);
        }
        self.check_kind(findings);
        self.check_extent(findings);
    }

    fn check_counts(&self, findings: &mut Findings<'_>) {
        let place = self.place("curveVertexCounts");
        let (found, sum) = (self.points.len() / 3, self.sum());
        if self.counts.is_empty() || found == 0 {
            let message = format!("{} strands of {found} points in all", self.counts.len());
            let remedy = "write points and curveVertexCounts, or leave the prim out";
            findings.add((Rule::C04, Warning), DRAWING, place, message, remedy);
            return;
        }
        if sum != found as i128 {
            let message = format!("the counts sum to {sum}, but there are {found} points");
            let remedy = "write one count a strand, its number of points";
            findings.add((Rule::C04, Error), DRAWING, place, message, remedy);
            return;
        }
        let (least, step) = self.steps();
        let wrong = self.counts.iter().filter(|count| !self.fits(**count));
        let wrong: Vec<i64> = wrong.copied().collect();
        if let Some(first) = wrong.first() {
            let kind = format!(
                "{} {} {}",
                if self.is_cubic { "cubic" } else { "linear" },
                self.basis,
                self.wrap
            );
            let message = format!(
                "{} strands have a number of points that {kind} curves cannot have, such as {first}",
                wrong.len()
            );
            let steps = if step > 1 {
                ", and three more for every further piece"
            } else {
                ""
            };
            let remedy = format!("write {least} points at least{steps}");
            findings.add((Rule::C04, Error), DRAWING, place, message, remedy);
            return;
        }
        let (mut start, mut flat) = (0, 0);
        for &count in self.counts {
            let end = start + 3 * count as usize;
            let strand = &self.points[start..end];
            let first = points(strand).next().unwrap_or_default();
            flat += usize::from(points(strand).all(|p| p == first));
            start = end;
        }
        if flat > 0 {
            let message = format!("{flat} of {} strands have no length", self.counts.len());
            let remedy = "leave strands out whose points are all the same";
            findings.add(
                (Rule::C04, Warning),
                DRAWING,
                self.place("points"),
                message,
                remedy,
            );
        }
    }

    fn check_kind(&self, findings: &mut Findings<'_>) {
        let of_pinned = match findings.names(RenderMan) {
            true => Warning,
            false => Note,
        };
        let mut add = |severity, consumers: &[Consumer], attribute, message, remedy| {
            findings.add(
                (Rule::C09, severity),
                consumers,
                self.place(attribute),
                message,
                remedy,
            );
        };
        match (self.is_cubic, self.basis, self.wrap) {
            (true, "catmullRom" | "bspline", "pinned") => {
                let message = "RenderMan up to 25 takes pinned curves for nonperiodic ones and loses both end pieces";
                let remedy = "write a point beyond each end for it (vair export --curves phantom)";
                add(of_pinned, &[RenderMan], "wrap", message, remedy);
            }
            (true, "catmullRom", "periodic") => {
                let message = "hair is drawn as closed rings";
                add(Warning, DRAWING, "wrap", message, "write pinned");
            }
            // With fewer points they are no curves at all.
            (true, "catmullRom", _) if self.counts.iter().all(|n| *n >= 4) => {
                let message = "Blender, Cycles and Unreal draw the points beyond both ends too: hair is longer there";
                let remedy = "write pinned, unless the file is for RenderMan up to 25 only";
                add(Warning, &[Blender, Cycles, Unreal], "wrap", message, remedy);
            }
            (true, "bezier", _) => {
                let message =
                    "Cycles and Unreal ignore the basis: handles become points of the strand";
                let remedy =
                    "write catmullRom, unless the file is for a reader of Bezier curves only";
                add(Warning, &[Cycles, Unreal], "basis", message, remedy);
            }
            (false, ..) => {
                let message = "Arnold turns straight pieces into Bezier curves and refuses orientations on them";
                add(
                    Note,
                    &[Arnold],
                    "type",
                    message,
                    "write cubic, catmullRom, pinned",
                );
            }
            _ => {}
        }
        if self.is_cubic && self.basis == "bspline" {
            let message = "points of B-splines are off the curve: readers that ignore the basis draw another shape";
            add(
                Warning,
                &[Blender, Cycles, Unreal],
                "basis",
                message,
                "write catmullRom",
            );
        }
        // Found when `vertex` attributes are normals; a ribbon is seldom meant.
        if self.item.prim.value("normals").is_some() {
            let message = "curves with normals are flat ribbons, not round hair";
            add(
                Warning,
                &[Arnold, Houdini, RenderMan, Storm],
                "normals",
                message,
                "leave normals out",
            );
        }
    }
}

/// That Unreal holds all strands and points: each strand, and each group of all curves.
pub(super) fn check_limits(all: &[Curves<'_>], findings: &mut Findings<'_>) {
    let mut groups: BTreeMap<(String, i64), (usize, usize)> = BTreeMap::new();
    for curves in all {
        let too_long = curves
            .counts
            .iter()
            .filter(|c| **c > MOST_OF_STRAND)
            .count();
        if too_long > 0 {
            let message = format!(
                "{too_long} strands have more than {MOST_OF_STRAND} points: Unreal cuts them"
            );
            let remedy = format!("write at most {MOST_OF_STRAND} points a strand");
            findings.add(
                (Rule::C05, Error),
                &[Unreal],
                curves.place("curveVertexCounts"),
                message,
                remedy,
            );
        }
        // Prims of the same group are one in Unreal; levels and purposes are not shown together.
        let group = ints(curves.item.prim.value("primvars:groom_group_id"));
        let group = group.and_then(|ids| ids.first().copied()).unwrap_or(-1);
        let key = match group {
            -1 => (curves.item.path.clone(), -1),
            group => (curves.item.purpose.to_owned(), group),
        };
        let sums = groups.entry(key).or_default();
        sums.0 += curves.counts.len();
        sums.1 += curves.points.len() / 3;
        let (strands, points) = *sums;
        if strands > MOST_STRANDS || points > MOST_POINTS {
            let message = format!(
                "a group has {strands} strands of {points} points; Unreal holds {MOST_STRANDS} and {MOST_POINTS}"
            );
            let remedy = "divide the strands into more groups (groom_group_id)";
            findings.add(
                (Rule::C05, Error),
                &[Unreal],
                curves.place("groom_group_id"),
                message,
                remedy,
            );
        }
    }
}

#[cfg(test)]
#[path = "curves_tests.rs"]
mod tests;
