//! Rules on where strands and grids lie.

use super::beside::Grids;
use super::consumer::Consumer;
use super::curves::Curves;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::{Item, bounds, floats};
use super::volume::DRAWING;
use crate::usd_file::Value;
use crate::vdb_file::{GridFacts, VdbFacts};
use Consumer::{Storm, Validators};
use Severity::{Error, Warning};
use glam::DVec3;

/// Boxes of one animal are alike: no more times as large, and so much of both in common.
const MOST_LARGER: f64 = 10.0;
const LEAST_COMMON: f64 = 0.3;

/// Whether a prim stands below another.
fn is_below(path: &str, above: &str) -> bool {
    (path.strip_prefix(above)).is_some_and(|rest| rest.starts_with('/'))
}

/// Where strands or grids of a file lie.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// The file, and the prim or grid in it.
    pub(super) place: (String, String),
    pub(super) is_volume: bool,
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
    /// Length of a unit, meters, and whether Z is up; not known of an OpenVDB file by itself.
    pub(super) frame: Option<(f64, bool)>,
}

impl Region {
    /// The corners in meters with Y up.
    fn turned(&self) -> Option<(DVec3, DVec3)> {
        let (meters, z_up) = self.frame?;
        let (lo, hi) = (self.lo * meters, self.hi * meters);
        Some(match z_up {
            true => (DVec3::new(lo.x, lo.z, -hi.y), DVec3::new(hi.x, hi.z, -lo.y)),
            false => (lo, hi),
        })
    }
}

/// Where the strands and the grids of a stage lie.
pub(super) fn regions(
    file: &str,
    items: &[Item<'_>],
    frame: (f64, bool),
    grids: &Grids,
) -> Vec<Region> {
    let mut regions = Vec::new();
    let mut push = |prim: &str, is_volume, (lo, hi): (DVec3, DVec3)| {
        if (hi - lo).min_element() >= 0.0 && lo.is_finite() && hi.is_finite() {
            regions.push(Region {
                place: (file.to_owned(), prim.to_owned()),
                is_volume,
                lo,
                hi,
                frame: Some(frame),
            });
        }
    };
    let all = items.iter().filter(|i| !i.is_moved && i.purpose != "guide");
    let curves: Vec<f32> = all
        .filter_map(Curves::of)
        .flat_map(|c| {
            let (lo, hi) = bounds(c.points);
            [lo.to_array(), hi.to_array()].concat()
        })
        .filter(|v| v.is_finite())
        .collect();
    let (lo, hi) = bounds(&curves);
    push("", false, (lo.as_dvec3(), hi.as_dvec3()));
    for asset in items
        .iter()
        .filter(|i| i.prim.type_name == "OpenVDBAsset" && !i.is_moved)
    {
        let name = asset.prim.text("fieldName");
        if let (Some(Value::Asset(file)), Some(name)) = (asset.prim.value("filePath"), name)
            && let Ok(facts) = grids.open(file)
            && let Some(grid) = facts.grids.iter().find(|g| g.name == name)
            && let Some(bounds) = fog(grid)
        {
            push(&asset.path, true, bounds);
        }
    }
    regions
}

/// Where the grids of a file lie.
pub(super) fn regions_of_file(file: &str, facts: &VdbFacts) -> Vec<Region> {
    let grids = facts
        .grids
        .iter()
        .filter_map(|grid| Some((grid, fog(grid)?)));
    let region = |(grid, (lo, hi)): (&GridFacts, _)| Region {
        place: (file.to_owned(), grid.name.clone()),
        is_volume: true,
        lo,
        hi,
        frame: None,
    };
    grids.map(region).collect()
}

/// The box of a grid that is of the fur, not of the skin below it.
fn fog(grid: &GridFacts) -> Option<(DVec3, DVec3)> {
    grid.world_bounds()
        .filter(|_| grid.text("class") == Some("fog volume"))
}

/// That the extent of a volume is where its grids are.
pub(super) fn check_extents(items: &[Item<'_>], regions: &[Region], findings: &mut Findings<'_>) {
    for volume in items.iter().filter(|i| i.prim.type_name == "Volume") {
        let Some(extent) = floats(volume.prim.value("extent"), 3).filter(|e| e.len() == 6) else {
            let place = Place {
                prim: &volume.path,
                attribute: "extent",
            };
            let message = "there is no extent: readers compute it, or do not show the volume";
            let remedy = "write the box around the active voxels";
            findings.add(
                (Rule::C11, Warning),
                &[Validators, Storm],
                place,
                message,
                remedy,
            );
            continue;
        };
        let (lo, hi) = bounds(extent);
        let own = regions
            .iter()
            .filter(|r| r.is_volume && is_below(&r.place.1, &volume.path));
        for region in own {
            if let Some((severity, what)) =
                apart((lo.as_dvec3(), hi.as_dvec3()), (region.lo, region.hi))
            {
                let place = Place {
                    prim: &volume.path,
                    attribute: "extent",
                };
                let message = format!("the extent and the grid of {}: {what}", region.place.1);
                let remedy = "write the box around the active voxels, in the units of the layer";
                findings.add((Rule::C20, severity), DRAWING, place, message, remedy);
            }
        }
    }
}

/// That strands and grids that are seen together lie in the same place.
pub(super) fn check_frames(strands: &[Region], grids: &[Region], findings: &mut Findings<'_>) {
    for curves in strands.iter().filter(|r| !r.is_volume) {
        for volume in grids.iter().filter(|r| r.is_volume) {
            // Where one does not say its unit, numbers are held against numbers.
            let boxes = curves.turned().zip(volume.turned());
            let (a, b) = boxes.unwrap_or(((curves.lo, curves.hi), (volume.lo, volume.hi)));
            if let Some((severity, what)) = apart(a, b) {
                let place = Place {
                    prim: &volume.place.1,
                    attribute: "transform",
                };
                let message = format!(
                    "strands of {} and grids of {}: {what}",
                    curves.place.0, volume.place.0
                );
                let remedy =
                    "export both with the same --units and --up, or mend the transform of the grid";
                findings.add((Rule::C20, severity), DRAWING, place, message, remedy);
            }
        }
    }
}

/// What is wrong between two boxes that should be about the same.
fn apart(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> Option<(Severity, String)> {
    let size = |(lo, hi): (DVec3, DVec3)| (hi - lo).length().max(1e-12);
    let times = (size(a) / size(b)).max(size(b) / size(a));
    if times > MOST_LARGER {
        return Some((
            Error,
            format!("one box is {times:.0} times as large as the other"),
        ));
    }
    let (lo, hi) = (a.0.max(b.0), a.1.min(b.1));
    if (hi - lo).min_element() < 0.0 {
        return Some((Error, "their boxes do not meet".to_owned()));
    }
    let room = |(lo, hi): (DVec3, DVec3)| (hi - lo).max(DVec3::splat(1e-12)).element_product();
    let common = room((lo, hi));
    let share = common / (room(a) + room(b) - common);
    (share < LEAST_COMMON).then(|| {
        let what = format!(
            "their boxes have {:.0} % of their room in common",
            100.0 * share
        );
        (Warning, what)
    })
}

/// Adds what lies in a view to what was seen before it: strands if there were none, and grids if there were none.
pub(super) fn add_unseen(seen: &mut Vec<Region>, view: Vec<Region>) {
    for is_volume in [false, true] {
        if !seen.iter().any(|region| region.is_volume == is_volume) {
            let new = view.iter().filter(|r| r.is_volume == is_volume);
            seen.extend(new.cloned());
        }
    }
}
