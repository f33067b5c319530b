//! What is said of an asset: before the work how large it will be, after it what is in it.

use super::{Args, writes_usd};
use crate::blame::Blame;
use crate::cli::{Console, Failure};
use crate::export::Format;
use crate::export::asset::{self, AssetSettings, Layout, Parts};
use crate::export::usd::Form;
use crate::groom::Forecast;
use crate::skin::Skin;

/// Text of more bytes than this is refused, and of more than the other remarked upon.
const MOST_TEXT: u64 = 2_000_000_000;
const MUCH_TEXT: u64 = 50_000_000;

/// Says how large the files will be, and refuses text that nobody could open.
pub(super) fn announce(
    args: &Args,
    settings: &AssetSettings,
    skin: &Skin,
    forecast: &Forecast,
    console: &Console,
) -> Result<(), Failure> {
    /// Bytes of a control point and of a strand in memory.
    const OF_POINT: usize = 16;
    const OF_STRAND: usize = 64;
    let (strands, points) = (forecast.strands, forecast.points);
    let binary = asset::estimate(
        skin,
        [strands, points],
        args.levels,
        args.coats.len(),
        settings,
    );
    // All coats are there at once.
    let memory = 2 * args.coats.len().max(1) * (points * OF_POINT + strands * OF_STRAND);
    if !writes_usd(args)? {
        return Ok(());
    }
    console.say(format!(
        "{strands} strands of {points} points: about {} in binary form, {} of memory",
        megabytes(binary),
        megabytes(memory as u64)
    ));
    for output in &args.output {
        let text = asset::TEXT_FACTOR * binary;
        let is_text =
            Format::of(output)? == Format::Usd(Form::Text) && settings.layout == Layout::Single;
        if !is_text || text <= MUCH_TEXT {
            continue;
        }
        let remark = format!(
            "{} would be about {} of text",
            output.display(),
            megabytes(text)
        );
        let help = "write .usdc, which is a quarter of that and opens in a fraction of the time";
        if text > MOST_TEXT {
            return Err(Failure::with_help(Blame::Input, remark, help));
        }
        console.say(format!("warning: {remark}: {help}"));
    }
    Ok(())
}

fn megabytes(bytes: u64) -> String {
    match bytes {
        b if b >= 10_000_000 => format!("{} MB", b / 1_000_000),
        b => format!("{:.1} MB", b as f64 / 1e6),
    }
}

/// Strands of every class and level.
pub(super) fn described(parts: &Parts<'_>) -> String {
    let levels: Vec<String> = (parts.levels.iter())
        .map(|level| {
            let counts: Vec<String> = (level.classes.iter().zip(&parts.groom.classes))
                .map(|(of_level, class)| format!("{} {class}", of_level.strands.len()))
                .collect();
            format!("{} {}", level.name, counts.join(" + "))
        })
        .collect();
    levels.join(", ")
}
