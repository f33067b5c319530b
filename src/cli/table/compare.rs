//! `vair table compare`: how far apart two tables are.

use super::plot::parse_size;
use super::{at_azimuth, averaged};
use crate::cli::stdout::{print, print_json};
use crate::cli::{Console, Failure, check_output};
use crate::table::{
    Comparison, Difference, DifferencePlot, Provenance, THETA_MAX_DEG, TableFile, compare,
};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Options of `vair table compare`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    vair table compare quick.exr reference.exr\n  \
    vair table compare quick.exr reference.exr --json | jq '.channels[0].debiased'\n  \
    vair table compare small.exr fox.exr -o difference.png --incidence 30\n\n\
    The measure is the relative L2 distance of the scattering function S over all pairs of\n\
    directions with both inclinations below --theta-max, evenly in solid angle. 'noise' is what\n\
    the standard errors in the files make of it, 'debiased' is the distance without that: what the filter\n    takes from each is in it. 'off by' is the largest difference of the albedo.")]
pub(super) struct Args {
    /// The table to judge.
    a: PathBuf,
    /// The reference.
    b: PathBuf,
    /// Leave out inclinations beyond this, degrees.
    #[arg(long, value_name = "DEG", default_value_t = THETA_MAX_DEG)]
    theta_max: f64,
    /// Print JSON: every channel by bin.
    #[arg(long)]
    json: bool,
    /// Also draw both tables and their difference (PNG).
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Inclination of the query direction of the picture, degrees.
    #[arg(long, value_name = "DEG", default_value_t = 30.0)]
    incidence: f64,
    /// Compare at this azimuth of the query only, degrees from the major axis of the section. The picture
    /// shows the mean over azimuths without it.
    #[arg(long, value_name = "DEG")]
    azimuth: Option<f64>,
    /// Absorption level or color channel of the picture, counted from 0.
    #[arg(long, value_name = "K", default_value_t = 0)]
    channel: usize,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "2000x720", value_parser = parse_size)]
    size: (usize, usize),
}

pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    if let Some(output) = &args.output {
        check_output(output, "a picture of the difference", "png")?;
    }
    let (mut a, mut b) = (TableFile::read(&args.a)?, TableFile::read(&args.b)?);
    if let Some(degrees) = args.azimuth {
        if a.azimuths().is_averaged() && b.azimuths().is_averaged() {
            return Err(averaged());
        }
        // A table that averages over azimuths is the same at all.
        (a, b) = (at_azimuth(a, degrees), at_azimuth(b, degrees));
    }
    let compared = compare(&a, &b, args.theta_max)?;
    if let Some(why) = not_independent(a.provenance(), b.provenance()) {
        console.say(format_args!("note: {why}"));
    }
    if let Some(output) = &args.output {
        let name = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let (a, b) = (a.averaged()?, b.averaged()?);
        let plot = DifferencePlot {
            tables: [(&a).into(), (&b).into()],
            names: [name(&args.a), name(&args.b)],
            channel: args.channel,
            incidence_deg: args.incidence,
            size: args.size,
        };
        plot.draw()?.write_png(output)?;
        console.say(format_args!("drawn: {}", output.display()));
    }
    if args.json {
        let mut json = json(&compared);
        json["a"] = json!(args.a.to_string_lossy());
        json["b"] = json!(args.b.to_string_lossy());
        print_json(&json)
    } else {
        print(&text(&compared))
    }
}

/// Why the distance of two tables of a fiber is not what the noise of both makes of it, if so.
pub(super) fn not_independent(a: &Provenance, b: &Provenance) -> Option<&'static str> {
    let fiber = |p: &Provenance| (p.species.clone(), p.class.clone(), p.station.to_bits());
    if fiber(a) != fiber(b) || a.program.is_empty() {
        return None;
    }
    if a.seed != b.seed {
        return Some(
            "the seeds of the fibers differ, so the tables differ by more than noise; \
             --photon-seed flies other photons through the same fiber",
        );
    }
    (a.photon_seed == b.photon_seed).then_some(
        "both have the same photons as far as they go, so their noise is not independent; \
         bake one with another --photon-seed",
    )
}

fn json(compared: &Comparison) -> Value {
    let channels = compared.channels.iter().map(|c| {
        let mut json = difference_json(&c.total);
        json["channel"] = json!(c.name);
        json["level"] = json!(c.level);
        json["albedo_max"] = json!(c.albedo);
        json["largest"] = json!(c.largest);
        json["largest_at_deg"] = json!(c.largest_at_deg);
        let bins = c.bins.iter().map(|bin| {
            let mut json = difference_json(&bin.difference);
            json["theta_deg"] = json!(bin.theta_deg);
            json["albedo"] = json!(bin.albedo);
            json
        });
        json["bins"] = bins.collect();
        let azimuths = c.azimuths.iter().map(|side| {
            let mut json = difference_json(&side.difference);
            json["azimuth_deg"] = json!(side.azimuth_deg);
            json["albedo"] = json!(side.albedo);
            json
        });
        json["azimuths"] = azimuths.collect();
        json
    });
    json!({
        "theta_max_deg": compared.theta_max_deg,
        "method": method(compared),
        "queries": compared.queries,
        "channels": channels.collect::<Vec<_>>(),
    })
}

pub(super) fn difference_json(difference: &Difference) -> Value {
    json!({
        "error": difference.error,
        "noise": difference.noise,
        "debiased": difference.debiased,
    })
}

fn method(compared: &Comparison) -> &'static str {
    if compared.by_texel {
        "texels"
    } else {
        "look-ups"
    }
}

fn text(compared: &Comparison) -> String {
    let mut out = format!(
        "relative L2 of S, |theta| < {} degrees, {} at {} inclinations\n\n\
         channel  level        error    noise  debiased   off by  largest, at query, theta, phi\n",
        compared.theta_max_deg,
        if compared.by_texel {
            "texel by texel"
        } else {
            "by look-up"
        },
        compared.queries
    );
    for c in &compared.channels {
        let level = c.level.map_or_else(String::new, |l| format!("{l:.4}"));
        let [query, theta, phi] = c.largest_at_deg;
        let _ = writeln!(
            out,
            "{:<8} {level:<8} {}   {:.5}  {}  {query:.0} {theta:.0} {phi:.0}",
            c.name,
            percents(&c.total),
            c.albedo,
            percent(c.largest).trim_start(),
        );
    }
    if let Some(c) = compared.headline() {
        let bins = c
            .bins
            .iter()
            .map(|b| (b.theta_deg, &b.difference, b.albedo));
        out.push_str(&rows(&c.name, "bin", "theta  ", bins));
        if !c.azimuths.is_empty() {
            let sides = (c.azimuths.iter()).map(|s| (s.azimuth_deg, &s.difference, s.albedo));
            out.push_str(&rows(&c.name, "azimuth", "azimuth", sides));
        }
    }
    out
}

/// Distances and albedos, angle by angle.
fn rows<'a>(
    channel: &str,
    by: &str,
    angle: &str,
    all: impl Iterator<Item = (f64, &'a Difference, [f64; 2])>,
) -> String {
    let mut out = format!(
        "\n{channel} by {by}\n  {angle}      error    noise  debiased  albedo   albedo of the reference\n"
    );
    for (degrees, difference, [albedo, reference]) in all {
        let _ = writeln!(
            out,
            "{degrees:>7.2}     {}   {albedo:.5}  {reference:.5}",
            percents(difference)
        );
    }
    out
}

fn percents(d: &Difference) -> String {
    format!(
        "{} {}  {}",
        percent(d.error),
        percent(d.noise),
        percent(d.debiased)
    )
}

/// A share in eight columns.
pub(super) fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => format!("{:>8}", "0 %"),
        p if p < 0.1 => format!("{p:>6.4} %"),
        p => format!("{p:>6.2} %"),
    }
}
