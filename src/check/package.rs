//! Rules on packages, `.usdz`.

use super::consumer::Consumer;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::Item;
use crate::usd_file::Member;
use Consumer::{Ar, Validators};
use Severity::Error;

/// What a package may hold.
const ALLOWED: [&str; 12] = [
    "usd", "usda", "usdc", "usdz", "png", "jpg", "jpeg", "exr", "avif", "m4a", "mp3", "wav",
];

/// Members begin at multiples of so many bytes.
const ALIGNMENT: usize = 64;

/// All rules on the members of a package.
pub(super) fn check(members: &[Member], findings: &mut Findings<'_>) {
    for member in members {
        let mut add = |message: String, remedy: &str| {
            let place = Place {
                prim: &member.name,
                attribute: "",
            };
            findings.add(
                (Rule::C15, Error),
                &[Validators, Ar],
                place,
                message,
                remedy,
            );
        };
        let suffix = member
            .name
            .rsplit('.')
            .next()
            .unwrap_or_default()
            .to_ascii_lowercase();
        if !ALLOWED.contains(&suffix.as_str()) {
            let message = format!("a package may not hold a .{suffix}");
            add(
                message,
                "keep grids and the like beside a .usdc, not in a package",
            );
        }
        if member.is_packed {
            add(
                "it is deflated: readers map packages as they are".to_owned(),
                "store members as they are",
            );
        }
        if member.data.start % ALIGNMENT != 0 {
            let message = format!(
                "it begins at byte {}, no multiple of {ALIGNMENT}",
                member.data.start
            );
            add(message, "align members (usdzip does)");
        }
    }
}

/// What viewers of packages cannot show.
pub(super) fn check_shown(items: &[Item<'_>], findings: &mut Findings<'_>) {
    for item in items {
        let kind = item.prim.type_name.as_str();
        if let "BasisCurves" | "NurbsCurves" | "Volume" | "PointInstancer" = kind {
            let place = Place {
                prim: &item.path,
                attribute: "",
            };
            let message = format!("viewers of packages show no {kind}");
            let remedy = "send them a mesh in its place, and the fur to renderers";
            findings.add((Rule::C15, Error), &[Ar], place, message, remedy);
        }
    }
}
