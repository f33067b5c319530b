//! How values are spelled in the text form.
//!
//! Numbers are written with as few digits as give the same bits back.

use std::fmt::Write as _;

/// Appends values with commas between them; also before the first, unless it is the first of all.
pub(super) fn separated<T>(
    values: &[T],
    first: bool,
    bytes: &mut Vec<u8>,
    push: impl Fn(&T, &mut String),
) {
    let mut text = String::with_capacity(32 * values.len());
    for (index, value) in values.iter().enumerate() {
        if index > 0 || !first {
            text.push_str(", ");
        }
        push(value, &mut text);
    }
    bytes.extend(text.into_bytes());
}

pub(super) fn list(texts: &[String]) -> String {
    let quoted: Vec<String> = texts.iter().map(|text| quoted(text)).collect();
    format!("[{}]", quoted.join(", "))
}

/// A string in quotes, with escapes.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The path of a file between signs that say where it ends; three of them where it has that sign itself.
pub(super) fn asset(path: &str) -> String {
    match path.contains('@') {
        false => format!("@{path}@"),
        true => format!("@@@{}@@@", path.replace("@@@", r"\@@@")),
    }
}

pub(super) fn tuple(values: &[f32]) -> String {
    let mut out = String::new();
    push_tuple(values, &mut out);
    out
}

pub(super) fn push_tuple(values: &[f32], out: &mut String) {
    out.push('(');
    for (index, value) in values.iter().enumerate() {
        if index > 0 {
            out.push_str(", ");
        }
        push(*value, out);
    }
    out.push(')');
}

pub(super) fn float(value: f32) -> String {
    let mut out = String::new();
    push(value, &mut out);
    out
}

/// Shortest digits that give the same bits. Zero keeps its sign.
pub(super) fn push(value: f32, out: &mut String) {
    let size = value.abs();
    let _ = match size {
        0.0 if value.is_sign_negative() => write!(out, "-0.0"),
        _ if !value.is_finite() => write!(out, "{}", special(f64::from(value))),
        _ if size != 0.0 && !(1e-4..1e9).contains(&size) => write!(out, "{value:e}"),
        _ => write!(out, "{value}"),
    };
}

pub(super) fn double(value: f64) -> String {
    if value.is_finite() {
        let size = value.abs();
        if size != 0.0 && !(1e-4..1e15).contains(&size) {
            return format!("{value:e}");
        }
        return format!("{value}");
    }
    special(value).to_owned()
}

/// Pixar's words for what is no number.
fn special(value: f64) -> &'static str {
    if value.is_nan() {
        "nan"
    } else if value > 0.0 {
        "inf"
    } else {
        "-inf"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_may_have_the_sign_that_ends_them() {
        assert_eq!(asset("./fox.usda"), "@./fox.usda@");
        assert_eq!(asset("./fox@2x.usda"), "@@@./fox@2x.usda@@@");
        assert_eq!(asset("./a@@@b@@.usda"), r"@@@./a\@@@b@@.usda@@@");
    }
}
