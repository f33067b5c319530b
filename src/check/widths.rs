//! Rules on the widths of curves.

use super::consumer::{Consumer, DRAWING};
use super::curves::Curves;
use super::finding::{Findings, Severity};
use super::rule::Rule;
use super::stage::floats;
use crate::usd_file::{Property, Value};
use Consumer::{Blender, Cycles, Storm, Unreal};
use Severity::{Error, Note, Warning};

/// Diameters that hair has, meters.
const HAIR: std::ops::RangeInclusive<f64> = 1e-6..=5e-3;
/// Mean of a level of detail, whose strands may each stand for many: a fox of 5000 strands has a coarsest level of 15 mm.
const LEVEL: std::ops::RangeInclusive<f64> = 1e-6..=5e-2;

impl Curves<'_> {
    pub(super) fn check_widths(&self, findings: &mut Findings<'_>) {
        let remedy = "write `vertex` widths, the diameter at every control point";
        let Some(widths) = self.widths() else {
            let message = "there are no widths: Arnold draws strands of 0.5 units, Unreal of 1 cm";
            findings.add(
                (Rule::C01, Error),
                DRAWING,
                self.place("widths"),
                message,
                remedy,
            );
            return;
        };
        let place = self.place(&widths.name);
        let found = widths.any_value().and_then(Value::elements).unwrap_or(0);
        let interpolation = match widths.word("interpolation") {
            "" => "vertex",
            authored => authored,
        };
        let (severity, consumers, what): (_, &[Consumer], _) = match interpolation {
            "vertex" | "constant" => (Note, &[], ""),
            "uniform" => (
                Error,
                &[Blender],
                "Blender copies them into the first points",
            ),
            "varying" => (
                Error,
                &[Cycles, Unreal, Storm],
                "Cycles ignores, Unreal refuses and Storm miscounts them",
            ),
            _ => (Error, DRAWING, "curves have no such values"),
        };
        let message = format!("widths are {interpolation}: {what}");
        findings.add((Rule::C01, severity), consumers, place, message, remedy);
        let wanted = match interpolation {
            "constant" => Some(1),
            other => self.expected(other),
        };
        if let Some(wanted) = wanted.filter(|wanted| *wanted != found) {
            let message = format!("{found} {interpolation} widths, {wanted} are wanted");
            findings.add((Rule::C01, Error), DRAWING, place, message, remedy);
        }
        let values = floats(widths.any_value(), 1).unwrap_or_default();
        for (severity, what, count) in [
            (
                Error,
                "below zero",
                values.iter().filter(|w| **w < 0.0).count(),
            ),
            (
                Warning,
                "zero",
                values.iter().filter(|w| **w == 0.0).count(),
            ),
        ] {
            if count > 0 {
                let message = format!("{count} of {} widths are {what}", values.len());
                findings.add((Rule::C01, severity), DRAWING, place, message, remedy);
            }
        }
    }

    pub(super) fn check_diameters(&self, meters: f64, findings: &mut Findings<'_>) {
        let widths = self.widths().and_then(Property::any_value);
        let widths = floats(widths, 1).unwrap_or_default();
        let positive = widths.iter().filter(|w| **w > 0.0 && w.is_finite());
        let (mut least, mut most, mut count, mut sum) = (f64::INFINITY, 0.0f64, 0.0, 0.0);
        for &width in positive {
            let width = f64::from(width) * meters;
            (least, most) = (least.min(width), most.max(width));
            sum += width;
            count += 1.0;
        }
        let mean = sum / count;
        // Strands that stand for many others, in a viewport or on a coarser level, are wider than hair.
        let is_level = findings.view.to_ascii_lowercase().contains("lod=");
        if count == 0.0
            || (HAIR.contains(&least) && HAIR.contains(&most))
            || self.item.purpose == "proxy"
            || (is_level && LEVEL.contains(&mean))
        {
            return;
        }
        let severity = if HAIR.contains(&mean) { Warning } else { Error };
        let message = format!(
            "diameters are {least:.1e} to {most:.1e} m, {mean:.1e} on average; hair has 1e-6 to 5e-3"
        );
        let remedy = "write diameters in the units of the file, or mend metersPerUnit";
        findings.add(
            (Rule::C02, severity),
            DRAWING,
            self.place("widths"),
            message,
            remedy,
        );
    }
}
