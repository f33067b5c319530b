//! Reader of Radiance pictures (.hdr): run-length coded RGBE (Ward 1991).

use crate::color::Rgb;
use crate::io::Decoded;

/// Largest side taken.
const SIDE_LIMIT: usize = 1 << 15;

/// Decodes a picture whose rows run from the top and columns from the left.
pub(super) fn decode(bytes: &[u8]) -> Decoded<Rgb> {
    let mut rest = bytes;
    let signature = line(&mut rest)?;
    if !signature.starts_with("#?") {
        return Err("it does not start with #?RADIANCE".into());
    }
    loop {
        let text = line(&mut rest)?;
        if text.is_empty() {
            break;
        }
        if let Some(format) = text.strip_prefix("FORMAT=")
            && format.trim() != "32-bit_rle_rgbe"
        {
            return Err(format!("its format is {format}, not 32-bit_rle_rgbe"));
        }
    }
    let size = line(&mut rest)?;
    let words: Vec<&str> = size.split_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else {
        return Err(format!(
            "unsupported orientation '{size}', need '-Y height +X width'"
        ));
    };
    let side = |text: &str| match text.parse::<usize>() {
        Ok(n) if (1..=SIDE_LIMIT).contains(&n) => Ok(n),
        _ => Err(format!("bad size '{size}'")),
    };
    let (width, height) = (side(width)?, side(height)?);
    let mut texels = Vec::new();
    let mut row = vec![[0u8; 4]; width];
    for y in 0..height {
        scanline(&mut rest, &mut row).ok_or_else(|| format!("row {y} of {height} is broken"))?;
        texels.extend(row.iter().map(|p| rgb(*p)));
    }
    Ok((width, height, texels))
}

fn line(rest: &mut &[u8]) -> Result<String, String> {
    let end = (rest.iter().take(4096).position(|&b| b == b'\n')).ok_or("its header has no end")?;
    let text = String::from_utf8_lossy(&rest[..end]).trim_end().to_owned();
    *rest = &rest[end + 1..];
    Ok(text)
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (head, tail) = rest.split_at_checked(count)?;
    *rest = tail;
    Some(head)
}

fn scanline(rest: &mut &[u8], row: &mut [[u8; 4]]) -> Option<()> {
    let width = row.len();
    let coded = (8..1 << 15).contains(&width)
        && rest.starts_with(&[2, 2])
        && rest.get(2..4)? == [(width >> 8) as u8, width as u8];
    if !coded {
        let flat = take(rest, 4 * width)?;
        for (pixel, bytes) in row.iter_mut().zip(flat.chunks_exact(4)) {
            pixel.copy_from_slice(bytes);
        }
        return Some(());
    }
    take(rest, 4)?;
    for channel in 0..4 {
        let mut x = 0;
        while x < width {
            let count = usize::from(take(rest, 1)?[0]);
            if count == 0 {
                return None;
            }
            if count > 128 {
                let value = take(rest, 1)?[0];
                let run = row.get_mut(x..x + count - 128)?;
                run.iter_mut().for_each(|p| p[channel] = value);
                x += count - 128;
            } else {
                let values = take(rest, count)?;
                let run = row.get_mut(x..x + values.len())?;
                for (pixel, value) in run.iter_mut().zip(values) {
                    pixel[channel] = *value;
                }
                x += values.len();
            }
        }
    }
    Some(())
}

/// Shared-exponent bytes as radiance.
fn rgb([r, g, b, e]: [u8; 4]) -> Rgb {
    if e == 0 {
        return Rgb::ZERO;
    }
    // The exponent is biased by 128 and the mantissas count 256ths.
    let scale = (f32::from(e) - 136.0).exp2();
    Rgb::new(f32::from(r), f32::from(g), f32::from(b)) * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(rows: &[u8]) -> Vec<u8> {
        let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n".to_vec();
        bytes.extend_from_slice(rows);
        bytes
    }

    #[test]
    fn runs_and_literals() {
        let rows = [
            2, 2, 0, 8, 136, 128, 8, 1, 2, 3, 4, 5, 6, 7, 8, 136, 0, 136, 129,
        ];
        let (w, h, texels) = decode(&file(&rows)).unwrap();
        assert_eq!((w, h), (8, 1));
        assert_eq!(texels[0], Rgb::new(1.0, 1.0 / 128.0, 0.0));
        assert_eq!(texels[7], Rgb::new(1.0, 8.0 / 128.0, 0.0));
    }

    #[test]
    fn flat_pixels() {
        let (_, _, texels) = decode(&file(&[128, 64, 0, 129].repeat(8))).unwrap();
        assert_eq!(texels[3], Rgb::new(1.0, 0.5, 0.0));
    }

    #[test]
    fn truncation_and_overlong_runs_are_refused() {
        assert!(
            decode(&file(&[2, 2, 0, 8, 136]))
                .unwrap_err()
                .contains("row 0")
        );
        assert!(
            decode(&file(&[2, 2, 0, 8, 137, 1]))
                .unwrap_err()
                .contains("row 0")
        );
        assert!(decode(b"#?RADIANCE\n").is_err());
        assert!(decode(b"BM").is_err());
    }
}
