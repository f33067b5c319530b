//! `vair table pack`: a table in little space, and what that costs.

use super::compare::{difference_json, not_independent, percent};
use crate::blame::Blame;
use crate::cli::stdout::{print, print_json};
use crate::cli::{Console, Failure, check_output};
use crate::table::{
    Comparison, PackedTable, Packing, THETA_MAX_DEG, TableError, TableFile, TableRef, compare,
};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Options of `vair table pack`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    vair table pack fox.exr -o fox-half.exr --half\n  \
    vair table pack fox-dyed.exr -o fox-small.exr --budget 200KB\n  \
    vair table pack fox-dyed.exr -o fox-tiny.exr --budget 20KB --against other-photons.exr\n  \
    vair table pack fox.exr -o fox-rank8.exr --rank 8\n\n\
    Every command that reads tables reads packed ones. Errors are relative L2 distances of the\n\
    scattering function over inclinations below 73 degrees, as `vair table compare` tells them. The\n\
    error against the input counts its noise that packing took out; a second bake of the same fiber\n\
    with another --photon-seed (--against) tells the error against the truth, before packing and after.\n\
    Best pack the structure table: it serves every pigment and its levels cost little.")]
pub(super) struct Args {
    /// The table to pack.
    file: PathBuf,
    /// The packed table to write (EXR).
    #[arg(long, short)]
    output: PathBuf,
    /// Half floats and the mirror fold alone: no more error than half floats have. The default.
    #[arg(long, conflicts_with_all = ["rank", "budget"])]
    half: bool,
    /// Sums of K images, aligned by the specular cone, for all maps.
    #[arg(long, value_name = "K")]
    rank: Option<usize>,
    /// Largest size of the file, for instance 200KB or 20KB.
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    budget: Option<usize>,
    /// An independent bake of the same fiber, dyed alike, to measure the error against the truth.
    #[arg(long, value_name = "TABLE")]
    against: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// `200KB`, `1.5MB`, `20000`; a kilobyte has 1000 bytes, a KiB 1024.
fn parse_size(text: &str) -> Result<usize, String> {
    let refuse = || format!("`{text}` is not a size such as 200KB");
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[number.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "kib" => 1024.0,
        "m" | "mb" => 1e6,
        "mib" => 1_048_576.0,
        _ => return Err(refuse()),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value * unit >= 1.0 && value * unit <= 1e12 => Ok((value * unit) as usize),
        _ => Err(refuse()),
    }
}

pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    check_output(&args.output, "a table", "exr")?;
    let table = TableFile::read(&args.file)?;
    let other = args.against.as_deref().map(TableFile::read).transpose()?;
    if let (Some(other), Some(path)) = (&other, &args.against)
        && let Some(why) = not_independent(table.provenance(), other.provenance())
    {
        console.say(format_args!("warning: {}: {why}", path.display()));
    }
    let packing = Packing {
        rank: args.rank,
        bytes: args.budget,
    };
    let packed = PackedTable::new(&table, packing).map_err(|error| match error {
        TableError::Request(what) => Failure::new(
            Blame::Input,
            format!("cannot pack {}: {what}", args.file.display()),
        ),
        other => other.into(),
    })?;
    packed.write(&args.output)?;
    let back = TableFile::read(&args.output)?;
    let input = compare(&back, &table, THETA_MAX_DEG)?;
    let truth = match (&other, &args.against) {
        (Some(other), Some(path)) => {
            let against = |table: &TableFile| {
                compare(table, other, THETA_MAX_DEG).map_err(|error| {
                    let message = format!("cannot compare with {}: {error}", path.display());
                    Failure::new(error.blame(), message)
                })
            };
            let share = noise_share(&table, other);
            Some(truths(&against(&back)?, &against(&table)?, share))
        }
        _ => None,
    };
    let sizes = Sizes {
        before: plain_size(&table),
        after: packed.size()?,
        channels: packed.channels(),
    };
    if args.json {
        let mut json = json(&sizes, &input, truth.as_deref());
        json["file"] = json!(args.output.to_string_lossy());
        json["code"] = json!(packed.describe());
        print_json(&json)
    } else {
        print(&text(&sizes, &packed, &input, truth.as_deref()))?;
        console.say(format_args!("packed: {}", args.output.display()));
        Ok(())
    }
}

/// The error of one channel against another bake of the same fiber.
struct Truth {
    /// As measured, noise of the other bake and all.
    error: f64,
    /// Without the noise of the other bake: the distance from what both estimate.
    packed: f64,
    /// The same of the table before packing: its own noise.
    before: f64,
}

/// The share of the other bake's noise in the squared distance of two bakes.
fn noise_share(table: &TableFile, other: &TableFile) -> f64 {
    let [own, others] = [table, other].map(|t| TableRef::from(t).photons().max(1.0));
    own / (own + others)
}

/// Half buffers: two bakes are as far apart as the noise of both, which needs no error estimate to be
/// taken out of the distance of the packed table from the other bake.
fn truths(packed: &Comparison, before: &Comparison, share: f64) -> Vec<Truth> {
    let pairs = packed.channels.iter().zip(&before.channels);
    pairs
        .map(|(packed, before)| {
            let (error, apart) = (packed.total.error, before.total.error);
            Truth {
                error,
                packed: (error * error - share * apart * apart).max(0.0).sqrt(),
                before: apart * (1.0 - share).sqrt(),
            }
        })
        .collect()
}

struct Sizes {
    /// Bytes of the maps as 32-bit floats.
    before: usize,
    after: usize,
    channels: usize,
}

fn plain_size(table: &TableFile) -> usize {
    match TableRef::from(table) {
        TableRef::Structure(t) => 4 * t.flux.len(),
        TableRef::Scatter(t) => 12 * t.rgb.len(),
    }
}

fn json(sizes: &Sizes, input: &Comparison, truth: Option<&[Truth]>) -> Value {
    let channels = input.channels.iter().enumerate().map(|(i, channel)| {
        let of_truth = truth.and_then(|t| t.get(i));
        json!({
            "channel": channel.name,
            "level": channel.level,
            "against_input": difference_json(&channel.total),
            "against_other": of_truth.map(|t| json!({
                "error": t.error,
                "debiased": t.packed,
                "before_packing": t.before,
            })),
        })
    });
    json!({
        "bytes": sizes.after,
        "bytes_per_channel": sizes.after / sizes.channels,
        "bytes_of_floats": sizes.before,
        "channels": channels.collect::<Vec<_>>(),
    })
}

fn text(
    sizes: &Sizes,
    packed: &PackedTable,
    input: &Comparison,
    truth: Option<&[Truth]>,
) -> String {
    let kilobytes = |bytes: usize| format!("{:.1} KB", bytes as f64 / 1000.0);
    let mut out = format!(
        "{}, {} a channel, {:.0} times less than as floats\n{}\n\nchannel  level     against the input",
        kilobytes(sizes.after),
        kilobytes(sizes.after / sizes.channels),
        sizes.before as f64 / sizes.after as f64,
        packed.describe(),
    );
    if truth.is_some() {
        out.push_str("   against the other bake   without its noise   before packing");
    }
    out.push('\n');
    for (i, channel) in input.channels.iter().enumerate() {
        let level = channel
            .level
            .map_or_else(String::new, |l| format!("{l:.4}"));
        let _ = write!(
            out,
            "{:<8} {level:<8}  {:>17}",
            channel.name,
            percent(channel.total.error)
        );
        if let Some(other) = truth.and_then(|t| t.get(i)) {
            let _ = write!(
                out,
                "   {:>22}   {:>17}   {:>14}",
                percent(other.error),
                percent(other.packed),
                percent(other.before)
            );
        }
        out.push('\n');
    }
    out
}
