//! A color as an option.

use super::{Console, Failure};
use crate::assembly::{self, StationTables};
use crate::color::linear_from_srgb;
use crate::groom::GroomSettings;
use crate::skin::Skin;
use crate::species::Species;

/// Help of `--color`, the same for all commands that have it.
pub(super) const HELP: &str = "Dyes all hair, from tip to root: the color that the coat shows on the average in a white room, \
    as #RRGGBB or as linear red, green and blue";

/// `#RRGGBB` (sRGB), or linear Rec.709 `R,G,B` of 0 to 1 each.
pub(super) fn parse(text: &str) -> Result<[f64; 3], String> {
    let refused = || format!("`{text}` is not a color such as #c8642a or 0.58,0.13,0.02");
    let color = match text.strip_prefix('#') {
        Some(digits) if digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit()) => {
            let all = u32::from_str_radix(digits, 16).map_err(|_| refused())?;
            let channel = |shift: u32| linear_from_srgb((all >> shift & 0xff) as f32 / 255.0);
            [16, 8, 0].map(|shift| f64::from(channel(shift)))
        }
        Some(_) => return Err(refused()),
        None => numbers(text).ok_or_else(refused)?,
    };
    match color.iter().all(|c| (0.0..=1.0).contains(c)) {
        true => Ok(color),
        false => Err(format!(
            "`{text}` is no color of a coat: red, green and blue must be 0 to 1"
        )),
    }
}

/// `R,G,B`.
pub(super) fn numbers(text: &str) -> Option<[f64; 3]> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// Gives dyes the strength that their colors need, and says what cannot be shown.
pub(super) fn match_colors(
    species: &mut Species,
    tables: &StationTables<'_>,
    skin: &Skin,
    grown: &GroomSettings,
    console: &Console,
) -> Result<(), Failure> {
    let cancel = console.cancel();
    for missed in assembly::match_colors(species, tables, skin, grown, console, cancel)? {
        console.say(format!("warning: {missed}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn colors_are_hexadecimal_or_linear() {
        assert_eq!(parse("0.5, 0.25,0"), Ok([0.5, 0.25, 0.0]));
        let orange = parse("#ff8000").unwrap();
        assert_eq!((orange[0], orange[2]), (1.0, 0.0));
        assert!((orange[1] - 0.2159).abs() < 1e-4);
        for wrong in [
            "#ff80",
            "#ff80zz",
            "#+f8000",
            "1,1",
            "0.5,0.2,1.1",
            "nan,0,0",
            "red",
            "",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
