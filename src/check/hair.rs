//! Rules on Cem Yuksel's hair files.

use super::consumer::Consumer;
use super::finding::{Findings, Place, Severity};
use super::frames::Region;
use super::rule::Rule;
use crate::export::lines::hair::{
    self, Arrays, COLORS, Header, POINTS, SEGMENTS, THICKNESS, TRANSPARENCY,
};
use Consumer::{LuxCore, Pbrt};
use Severity::{Error, Note, Warning};
use glam::{DVec3, Vec3};

/// Texture coordinates, an array of LuxCore's own.
const UVS: u32 = 32;

/// What the converter of pbrt draws nothing of: strands of fewer segments.
const LEAST_SEGMENTS: u64 = 3;

const BOTH: &[Consumer] = &[LuxCore, Pbrt];

/// All rules on a file; returns where its strands lie.
///
/// * `expected`: strands that there should be, if that is known.
///
/// # Errors
/// A file that ends within what it announces, or does not begin as one.
pub(super) fn check(
    file: &str,
    bytes: &[u8],
    expected: Option<u64>,
    findings: &mut Findings<'_>,
) -> Result<Vec<Region>, String> {
    let header = hair::header(bytes)?;
    let arrays = hair::arrays(&header, bytes)?;
    let points = hair::vectors(arrays.points);
    check_flags(&header, &arrays, findings);
    check_strands(&header, &arrays, &points, findings);
    check_numbers(&header, &arrays, &points, findings);
    check_thickness(&header, &arrays, findings);
    if let Some(expected) = expected.filter(|expected| *expected != header.strands) {
        let message = format!(
            "{} strands are there, expected were {expected}",
            header.strands
        );
        let remedy = "export again, and look for what was left out";
        add(findings, (Rule::C18, Error), BOTH, "", message, remedy);
    }
    Ok(region(file, &points))
}

fn add(
    findings: &mut Findings<'_>,
    rule: (Rule, Severity),
    consumers: &[Consumer],
    attribute: &str,
    message: impl Into<String>,
    remedy: &str,
) {
    let place = Place {
        prim: "",
        attribute,
    };
    findings.add(rule, consumers, place, message, remedy);
}

/// The box around all points that are numbers.
fn region(file: &str, points: &[Vec3]) -> Vec<Region> {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let finite = points
        .iter()
        .filter(|p| p.is_finite())
        .map(|p| p.as_dvec3());
    let (lo, hi) = finite.fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let region = Region {
        place: (file.to_owned(), String::new()),
        is_volume: false,
        lo,
        hi,
        frame: None,
    };
    Vec::from_iter(lo.is_finite().then_some(region))
}

/// Arrays that some readers do not take, or none.
fn check_flags(header: &Header, arrays: &Arrays<'_>, findings: &mut Findings<'_>) {
    let kept = "set colors and the like in the program that opens the file";
    for (flag, name) in [
        (COLORS, "colors"),
        (TRANSPARENCY, "transparency"),
        (UVS, "texture coordinates"),
    ] {
        if header.has(flag) {
            let message = format!("there are {name}: pbrt's converter ignores them");
            add(findings, (Rule::C10, Note), &[Pbrt], name, message, kept);
        }
    }
    let unknown = header.flags >> 6 << 6;
    if unknown != 0 {
        let message = format!("arrays are announced that no reader knows ({unknown:#x})");
        let remedy = "write segments, points, thickness, transparency and colors only";
        add(findings, (Rule::C10, Error), BOTH, "flags", message, remedy);
    }
    let known = if header.has(UVS) {
        8 * header.points
    } else {
        0
    };
    let rest = arrays.rest.len() as u64;
    if unknown == 0 && rest != known {
        let message = format!("{rest} bytes follow the arrays, {known} are announced");
        let remedy = "write as many points as the header announces";
        add(findings, (Rule::C04, Warning), BOTH, "", message, remedy);
    }
}

/// Segments of each strand.
fn segments<'h>(header: &'h Header, arrays: &'h Arrays<'_>) -> impl Iterator<Item = u64> + 'h {
    let own = arrays.segments.chunks_exact(2);
    let own = own.map(|b| u64::from(u16::from_le_bytes([b[0], b[1]])));
    // No more than there could be points of, whatever the header says.
    let shared = match header.has(SEGMENTS) {
        true => 0,
        false => header.strands.min(header.points + 1),
    };
    own.chain((0..shared).map(|_| u64::from(header.segments)))
}

fn check_strands(
    header: &Header,
    arrays: &Arrays<'_>,
    points: &[Vec3],
    findings: &mut Findings<'_>,
) {
    let mut counts = |severity, consumers: &[Consumer], message: String, remedy: &str| {
        let rule = (Rule::C04, severity);
        add(findings, rule, consumers, "segments", message, remedy);
    };
    if header.strands == 0 || !header.has(POINTS) {
        let message = "there are no strands, or no points".to_owned();
        counts(Error, BOTH, message, "write strands with their points");
        return;
    }
    let sum: u64 = segments(header, arrays).map(|count| count + 1).sum();
    if sum != header.points {
        let message = format!(
            "the strands have {sum} points, but the header announces {}",
            header.points
        );
        let remedy = "write the segments of each strand, one fewer than its points";
        counts(Error, BOTH, message, remedy);
        return;
    }
    let (mut start, mut flat, mut short, mut none) = (0, 0u64, 0u64, 0u64);
    for count in segments(header, arrays) {
        let strand = &points[start..start + count as usize + 1];
        start += strand.len();
        match count {
            0 => none += 1,
            _ if strand.iter().all(|p| *p == strand[0]) => flat += 1,
            count if count < LEAST_SEGMENTS => short += 1,
            _ => {}
        }
    }
    let of = header.strands;
    if none > 0 {
        let message = format!("{none} of {of} strands have no segments");
        counts(Error, BOTH, message, "leave them out");
    }
    if flat > 0 {
        let message = format!("{flat} of {of} strands have no length");
        counts(Warning, BOTH, message, "leave them out");
    }
    if short > 0 {
        let message = format!(
            "{short} of {of} strands have fewer than {LEAST_SEGMENTS} segments: pbrt's converter drops them"
        );
        counts(
            Warning,
            &[Pbrt],
            message,
            "write four points a strand at least",
        );
    }
}

fn check_numbers(
    header: &Header,
    arrays: &Arrays<'_>,
    points: &[Vec3],
    findings: &mut Findings<'_>,
) {
    let bad = |numbers: &[u8]| hair::floats(numbers).filter(|n| !n.is_finite()).count();
    let coordinates = points.iter().filter(|p| !p.is_finite()).count();
    for (name, count) in [
        ("points", coordinates),
        ("thickness", bad(arrays.thickness)),
        ("transparency", bad(arrays.transparency)),
        ("colors", bad(arrays.colors)),
    ] {
        if count > 0 {
            let message = format!("{count} of {} are infinite or no numbers", header.points);
            let remedy = "leave out the strands that they belong to";
            add(findings, (Rule::C03, Error), BOTH, name, message, remedy);
        }
    }
}

fn check_thickness(header: &Header, arrays: &Arrays<'_>, findings: &mut Findings<'_>) {
    let mut widths = |severity, consumers: &[Consumer], message: String| {
        let remedy = "write the diameter at every point, and their mean into the header";
        let rule = (Rule::C01, severity);
        add(findings, rule, consumers, "thickness", message, remedy);
    };
    let count = |is: fn(f32) -> bool| hair::floats(arrays.thickness).filter(|w| is(*w)).count();
    let (negative, zero) = (count(|w| w < 0.0), count(|w| w == 0.0));
    for (severity, what, count) in [(Error, "below zero", negative), (Warning, "zero", zero)] {
        if count > 0 {
            let message = format!("{count} of {} diameters are {what}", header.points);
            widths(severity, BOTH, message);
        }
    }
    let is_sound = header.thickness > 0.0 && header.thickness.is_finite();
    if !is_sound && !header.has(THICKNESS) {
        let message = format!("all strands have the diameter {}", header.thickness);
        widths(Error, BOTH, message);
    } else if !is_sound {
        let message = format!(
            "the header's diameter is {}: pbrt's converter takes that for all strands",
            header.thickness
        );
        widths(Warning, &[Pbrt], message);
    }
}
