//! Numbers with units as the command line takes them.

use std::time::Duration;

/// `1e9`, `250000` and `2.5e6` are counts.
pub(in crate::cli) fn parse_count(text: &str) -> Result<u64, String> {
    let refuse = || format!("`{text}` is not a count such as 1000000 or 1e6");
    let value: f64 = text.parse().map_err(|_| refuse())?;
    // Beyond 2^53 a floating-point number may not be the one that was written.
    if let Ok(exact) = text.parse() {
        return Ok(exact);
    }
    if value >= 1.8e19 {
        return Err(format!("{text} is too many"));
    }
    match value.fract() == 0.0 && value >= 0.0 {
        true => Ok(value as u64),
        false => Err(refuse()),
    }
}

/// `1%` and `0.01` are the same share.
pub(in crate::cli) fn parse_share(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value * scale < 1.0 => Ok(value * scale),
        _ => Err(format!(
            "`{text}` is not an error such as 1% or 0.01, above 0 and below 100%"
        )),
    }
}

/// `30`, `30s`, `2.5m`, `1h` and `500ms` are times.
pub(in crate::cli) fn parse_time(text: &str) -> Result<Duration, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let seconds = match &text[digits.len()..] {
        "ms" => Some(0.001),
        "" | "s" => Some(1.0),
        "m" | "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let value = digits.trim().parse::<f64>().ok().zip(seconds);
    match value.map(|(value, unit)| value * unit) {
        Some(seconds) if (0.0..1e9).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(format!("`{text}` is not a time such as 30s, 2m or 1.5h")),
    }
}

/// `2G`, `500M` and `64k` are bytes, in powers of 1000.
pub(in crate::cli) fn parse_bytes(text: &str) -> Result<u64, String> {
    let short = text.trim_end_matches(['B', 'b']);
    let digits = short.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &short[digits.len()..] {
        "" => Some(1.0),
        "k" | "K" => Some(1e3),
        "M" => Some(1e6),
        "G" => Some(1e9),
        "T" => Some(1e12),
        _ => None,
    };
    match digits.trim().parse::<f64>().ok().zip(unit) {
        Some((value, unit)) if (0.0..1e18).contains(&(value * unit)) => Ok((value * unit) as u64),
        _ => Err(format!(
            "`{text}` is not an amount of memory such as 500M or 2G"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units() {
        assert_eq!(parse_count("1e10"), Ok(10_000_000_000));
        assert_eq!(parse_count("9007199254740993"), Ok(9_007_199_254_740_993));
        assert!(parse_count("1.5").is_err() && parse_count("-1").is_err());
        assert_eq!(parse_share("1%"), Ok(0.01));
        assert_eq!(parse_share("0.25"), Ok(0.25));
        for wrong in ["0", "100%", "-1%", "nan", "%", "x"] {
            assert!(parse_share(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_time("30"), Ok(Duration::from_secs(30)));
        assert_eq!(parse_time("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(parse_time("1.5h"), Ok(Duration::from_secs(5400)));
        for wrong in ["", "s", "-1s", "1d", "inf", "nan", "1e99h"] {
            assert!(parse_time(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_bytes("2GB"), Ok(2_000_000_000));
        assert_eq!(parse_bytes("64k"), Ok(64_000));
        for wrong in ["", "G", "-1M", "1X", "nan"] {
            assert!(parse_bytes(wrong).is_err(), "{wrong}");
        }
    }
}
