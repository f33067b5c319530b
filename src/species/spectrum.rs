//! Measured refractive indices: a table over the wavelength becomes one value a color channel.

use crate::io::{FileError, read_bounded};
use crate::species::Rgb;
use std::path::Path;

/// Dominant wavelengths of the Rec.709 primaries red, green and blue against D65, nanometers.
const PRIMARIES_NM: Rgb = [611.4, 549.1, 464.2];

/// Width of the band around a primary over which indices are averaged, nanometers: a third of the way
/// to the next primary, so that a steep edge of a metal's spectrum is neither missed nor taken for all.
const BAND_NM: f64 = 50.0;

/// Samples of a band.
const SAMPLES: u32 = 25;

/// Longest file, bytes, and most rows.
const FILE_LIMIT: u64 = 1 << 20;
const MOST_ROWS: usize = 20_000;

/// The metals that files may name, with their measurements.
pub(crate) const METALS: [(&str, &str); 4] = [
    ("gold", include_str!("../../procedural/materials/gold.csv")),
    (
        "silver",
        include_str!("../../procedural/materials/silver.csv"),
    ),
    (
        "copper",
        include_str!("../../procedural/materials/copper.csv"),
    ),
    (
        "aluminum",
        include_str!("../../procedural/materials/aluminum.csv"),
    ),
];

/// Optical constants for linear R, G and B: means over 50 nm around the dominant wavelengths of the
/// Rec.709 primaries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Constants {
    /// Real part of the index.
    pub(crate) index: Rgb,
    /// Imaginary part of the index; 0 in a table without a third column.
    pub(crate) extinction: Rgb,
    /// The absorption coefficient that goes with it, `4 pi k / wavelength`, per micrometer.
    pub(crate) absorption_per_um: Rgb,
}

/// A row: wavelength in nanometers, n, k.
type Row = [f64; 3];

/// The constants of a named metal.
pub(crate) fn metal(name: &str) -> Option<Constants> {
    let (_, text) = METALS.iter().find(|(known, _)| *known == name)?;
    parse(text).ok()
}

/// The constants of a table file, or what is wrong with it.
pub(crate) fn read(path: &Path) -> Result<Constants, String> {
    let bytes = read_bounded(path, FILE_LIMIT).map_err(|e: FileError| e.to_string())?;
    let text = String::from_utf8_lossy(&bytes);
    parse(&text).map_err(|what| format!("{}: {what}", path.display()))
}

/// Reads `wavelength, n[, k]`: a row a line, in nanometers or micrometers, ascending; lines that begin
/// with `#` are remarks, and one line of words may head the columns.
fn parse(text: &str) -> Result<Constants, String> {
    let mut rows: Vec<Row> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let place = format!("line {}", number + 1);
        let words = line.split([',', ';', '\t', ' ']).map(str::trim);
        let words: Vec<&str> = words.filter(|w| !w.is_empty()).collect();
        let numbers: Option<Vec<f64>> = words.iter().map(|w| w.parse().ok()).collect();
        let row = match numbers.as_deref() {
            Some(&[wavelength, n]) => [wavelength, n, 0.0],
            Some(&[wavelength, n, k]) => [wavelength, n, k],
            None if rows.is_empty() && words[0].parse::<f64>().is_err() => continue,
            _ => {
                return Err(format!(
                    "{place} is not `wavelength, n` or `wavelength, n, k`"
                ));
            }
        };
        let sound = row[0] > 0.0
            && row[0] < 1e6
            && (0.01..=20.0).contains(&row[1])
            && (0.0..=50.0).contains(&row[2]);
        if !sound {
            return Err(format!("{place}: n must be 0.01 to 20, k 0 to 50"));
        }
        if rows.last().is_some_and(|before| before[0] >= row[0]) {
            return Err(format!("{place}: wavelengths must ascend"));
        }
        if rows.len() == MOST_ROWS {
            return Err(format!("it has more than {MOST_ROWS} rows"));
        }
        rows.push(row);
    }
    in_nanometers(&mut rows);
    let span = rows.first().zip(rows.last()).map(|(a, b)| (a[0], b[0]));
    match span {
        Some((first, last)) if first <= PRIMARIES_NM[2] && last >= PRIMARIES_NM[0] => {}
        Some((first, last)) => {
            return Err(format!(
                "it covers {first} to {last} nm; {} to {} nm are needed",
                PRIMARIES_NM[2], PRIMARIES_NM[0]
            ));
        }
        None => return Err("it has no rows".to_owned()),
    }
    let [index, extinction, absorption_per_um] = [
        |_: f64, row: Row| row[1],
        |_: f64, row: Row| row[2],
        |nm: f64, row: Row| 4.0 * std::f64::consts::PI * row[2] / (1e-3 * nm),
    ]
    .map(|value| PRIMARIES_NM.map(|primary| band_mean(&rows, primary, value)));
    Ok(Constants {
        index,
        extinction,
        absorption_per_um,
    })
}

/// Wavelengths below this are micrometers.
const LONGEST_UM: f64 = 100.0;

fn in_nanometers(rows: &mut [Row]) {
    if rows.first().is_some_and(|row| row[0] < LONGEST_UM) {
        rows.iter_mut().for_each(|row| row[0] *= 1e3);
    }
}

fn band_mean(rows: &[Row], primary: f64, value: fn(f64, Row) -> f64) -> f64 {
    let sum: f64 = (0..SAMPLES)
        .map(|i| {
            let share = (f64::from(i) + 0.5) / f64::from(SAMPLES);
            let nm = primary + BAND_NM * (share - 0.5);
            value(nm, at(rows, nm))
        })
        .sum();
    sum / f64::from(SAMPLES)
}

/// Linear between rows, constant beyond the first and the last.
fn at(rows: &[Row], nm: f64) -> Row {
    let next = rows.partition_point(|row| row[0] <= nm);
    let before = rows[next.saturating_sub(1).min(rows.len() - 1)];
    let after = rows[next.min(rows.len() - 1)];
    let gap = after[0] - before[0];
    let f = if gap > 0.0 {
        ((nm - before[0]) / gap).clamp(0.0, 1.0)
    } else {
        0.0
    };
    std::array::from_fn(|i| before[i] + f * (after[i] - before[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fresnel;

    #[test]
    fn metals_have_their_colors() {
        // Reflectance at normal incidence of the usual reference colors of gold, silver, copper and
        // aluminum, linear, from the same measurements.
        let expected = [
            ("gold", [0.94, 0.78, 0.37]),
            ("silver", [0.985, 0.98, 0.975]),
            ("copper", [0.90, 0.64, 0.56]),
            ("aluminum", [0.91, 0.915, 0.92]),
        ];
        for (name, color) in expected {
            let metal = metal(name).unwrap();
            for (c, expected) in color.into_iter().enumerate() {
                let found = fresnel::conductor(1.0, metal.index[c], metal.extinction[c]);
                assert!((found - expected).abs() < 0.04, "{name} {c}: {found}");
            }
        }
    }

    #[test]
    fn a_line_is_read_in_either_unit_and_averaged() {
        // n is linear in the wavelength, so its mean is its value at the primary.
        let nm = "# a glass\nwavelength,n\n400,1.60\n700;1.54\n";
        let um = "0.4 1.60 0\n0.7\t1.54 0";
        for text in [nm, um] {
            let found = parse(text).unwrap();
            for (n, primary) in found.index.iter().zip(PRIMARIES_NM) {
                let expected = 1.60 - 0.06 * (primary - 400.0) / 300.0;
                assert!((n - expected).abs() < 1e-9, "{n} {expected}");
            }
            assert_eq!(found.absorption_per_um, [0.0; 3]);
        }
    }

    #[test]
    fn bad_tables_are_refused_with_the_line() {
        let cases = [
            ("", "no rows"),
            ("wavelength n k\n", "no rows"),
            ("400 1.5\n700 1.5 0 0\n", "line 2"),
            ("400 1.5\n700 nan\n", "line 2"),
            ("400 1.5\n700 -1\n", "line 2"),
            ("400 1.5\n700 1.5 -1\n", "line 2"),
            ("400 1.5\n700 x\n", "line 2"),
            ("700 1.5\n400 1.5\n", "ascend"),
            ("500 1.5\n700 1.5\n", "covers 500 to 700"),
            ("0.4 1.5\n0.6 1.5\n", "covers 400 to 600"),
            ("-1 1.5\n700 1.5\n", "line 1"),
        ];
        for (text, what) in cases {
            let refusal = parse(text).unwrap_err();
            assert!(refusal.contains(what), "{text:?}: {refusal}");
        }
        assert!(read(Path::new("/nowhere/index.csv")).is_err());
    }
}
